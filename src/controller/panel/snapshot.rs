//! Fills the snapshot: positions, state, values. Read-only; called whenever a snapshot is needed.
//! Source: spec H5, H7, K2.4.

use super::{Panel, PartsView, start_guide};
use crate::controller::axes::SECONDS_PER_MINUTE;
use crate::controller::plant::{ControlPhase, OperatorState};
use crate::defs::alarm::Reaction;
use crate::defs::key::Key;
use crate::defs::signal::Output;
use crate::link::program_view::ProgramView;
use crate::link::snapshot::{AxisView, RunState, Snapshot, VARIABLE_COUNT};
use crate::units::{Axis, PerAxis};
use std::sync::Arc;

impl Panel {
    /// Writes everything that pages show.
    pub fn snapshot(&self, parts: PartsView<'_>, out: &mut Snapshot) {
        (out.kind, out.now) = (parts.plant.kind, parts.plant.now);
        out.state = run_state(parts);
        out.own_motion = parts.program.own_motion(parts.plant);
        (out.coordinates, out.soft_key_row) = (self.pages.coordinates, self.pages.soft_row);
        out.kind_page = self.kind_page(parts);
        out.grinding_sheet = self.grinding_pages(parts);
        out.x_as_diameter = parts.plant.is_diameter();
        out.axes = self.axis_views(parts);
        self.program_view(parts, out);
        operator_view(&parts.plant.operator, out);
        out.feed_mm_min = parts.plant.path_speed_mm_s() * SECONDS_PER_MINUTE;
        out.wheel_rpm = if parts.plant.outputs.on.has(Output::Wheel) { parts.plant.output_wheel_rpm() } else { 0.0 };
        if parts.plant.kind.is_lathe() {
            out.wheel_rpm = parts.plant.spindles.encoder.rpm.abs();
        }
        out.tool_station = parts.plant.kind.is_lathe().then(|| parts.plant.turret_station().map_or(0, u32::from));
        parts.manual.teach.write_view(&mut out.teach);
        out.strokes_per_min = parts.plant.measured_strokes_min();
        out.is_storing = parts.plant.is_storing();
        out.parts_counted = parts.plant.work.part_count;
        out.restart = parts.program.restart_view(parts.plant).map(Box::new);
        out.interrupted = parts.program.power_cut.interrupted;
        out.cycle = self.cycle_view(parts);
        out.inputs = parts.plant.inputs.filtered;
        out.outputs = parts.plant.outputs.on;
        for key in Key::ALL {
            out.keys[*key as usize] = self.key_view(parts, *key);
        }
        for (number, place) in out.variables.iter_mut().enumerate().take(VARIABLE_COUNT) {
            *place = parts.plant.work.variables.get(number as u32).ok().flatten();
        }
        for number in 434..=439 {
            out.variables[number] = parts.plant.system_variable(number as u32);
        }
        if out.alarms != parts.plant.alarms.present() {
            out.alarms = parts.plant.alarms.present().to_vec();
        }
        if out.message != parts.plant.outbox.message {
            out.message.clone_from(&parts.plant.outbox.message);
        }
        let awaited = parts.program.awaited_event(parts.plant);
        let told = awaited.as_ref().or(parts.plant.outbox.program_message.as_ref());
        if out.waiting_for.as_ref() != told {
            out.waiting_for = told.cloned();
        }
        if out.scope != *self.scope.view() {
            out.scope.clone_from(self.scope.view());
        }
        self.production.write_view(&self.wheels, &mut out.production);
        start_guide::fill(parts, &mut out.start_guide);
        self.page_view(parts, out);
        self.edit_view(parts, out);
        if !Arc::ptr_eq(&out.screens, &self.screens) {
            out.screens.clone_from(&self.screens);
        }
        if !Arc::ptr_eq(&out.directory, &self.directory) {
            out.directory.clone_from(&self.directory);
        }
    }

    fn axis_views(&self, parts: PartsView<'_>) -> PerAxis<AxisView> {
        let (machine, work, to_go) =
            (parts.plant.axes.actual(), parts.plant.work_position(), parts.program.distance_to_go(parts.plant));
        PerAxis::from_fn(|axis: Axis| {
            let factor = parts.plant.displayed_per_mm(axis);
            AxisView {
                present: parts.plant.axes.is_present(axis),
                work: work[axis] * factor,
                machine: machine[axis] * factor,
                relative: (machine[axis] - self.relative_zero[axis]) * factor,
                to_go: to_go[axis],
                homed: parts.plant.axes.is_homed(axis),
                moving: parts.plant.is_moving(axis),
                decimals: parts.plant.params.length_decimals(),
            }
        })
    }

    fn program_view(&self, parts: PartsView<'_>, out: &mut Snapshot) {
        let program = parts.plant.work.programs.get(parts.plant.execution.current_program);
        match program {
            Some(program) if !out.program.text.is_instance(&program.text) => {
                out.program.text.clone_from(&program.text);
                out.program.bounds.clone_from(program.source.value_bounds());
                (out.program.stamp, out.program.has_invalid_bytes) = (program.stamp, program.has_invalid_bytes);
            }
            Some(_) => {}
            None => out.program = ProgramView::default(),
        }
        out.program.is_open = parts.program.is_open();
        out.program.is_completed = parts.plant.execution.is_completed;
        out.program.number = parts.plant.execution.current_program;
        out.program.block_program = parts.plant.execution.current_block.program;
        let subprogram = Some(out.program.block_program).filter(|_| out.program.in_subprogram());
        let text = subprogram.and_then(|number| parts.plant.work.programs.get(number)).map(|called| &called.text);
        let is_known =
            out.program.subprogram_text.as_ref().zip(text).is_some_and(|(known, text)| known.is_instance(text));
        if !is_known {
            out.program.subprogram_text = text.cloned();
        }
        out.program.line = parts.plant.execution.current_block.line;
        out.program.block = parts.plant.execution.current_block.n;
    }
}

/// The run state.
#[must_use]
pub fn run_state(parts: PartsView<'_>) -> RunState {
    match parts.plant.execution.phase {
        ControlPhase::Homing(_) => RunState::Homing,
        ControlPhase::Running if parts.program.is_awaiting_input() => RunState::Waiting,
        ControlPhase::Running => RunState::Running,
        ControlPhase::Holding | ControlPhase::Held => RunState::Held,
        ControlPhase::Stopped => RunState::Stopped,
        ControlPhase::Idle | ControlPhase::Aborting if parts.plant.alarms.has_reaction(Reaction::BlockWheel) => {
            RunState::Alarm
        }
        ControlPhase::Idle | ControlPhase::Aborting => RunState::Idle,
    }
}

/// Selections of the panel.
fn operator_view(operator: &OperatorState, out: &mut Snapshot) {
    (out.mode, out.page) = (operator.mode, operator.page);
    out.handwheel.axis = operator.handwheel_axis;
    out.handwheel.step_mm = operator.step_mm;
    out.overrides = operator.overrides;
}
