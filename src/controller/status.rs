//! Fills the snapshot: lamps, positions, state. Read-only; called whenever a snapshot is needed.
//! Source: spec H5, H7, K2.4.

use std::sync::Arc;

use super::{ControlPhase, Controller};
use crate::defs::key::{Key, Lamp, Mode};
use crate::defs::signal::{Output, OutputSet};
use crate::link::snapshot::{AxisView, KeyView, ProgramView, RunState, Snapshot, VARIABLE_COUNT};
use crate::units::{Axis, Micros, PerAxis};

/// Below this speed an axis is shown as standing, mm/s.
const STANDING_MM_S: f64 = 1e-6;

impl Controller {
    /// The run state.
    #[must_use]
    pub fn state(&self) -> RunState {
        match self.phase {
            ControlPhase::Homing(_) => RunState::Homing,
            ControlPhase::Running if self.is_awaiting_input() => RunState::Waiting,
            ControlPhase::Running => RunState::Running,
            ControlPhase::Holding | ControlPhase::Held => RunState::Held,
            ControlPhase::Stopped => RunState::Stopped,
            ControlPhase::Idle | ControlPhase::Aborting if self.alarms.blocks_start() => RunState::Alarm,
            ControlPhase::Idle | ControlPhase::Aborting => RunState::Idle,
        }
    }

    /// Writes everything that pages show.
    pub fn snapshot(&self, out: &mut Snapshot) {
        out.kind = self.kind;
        out.now = self.now;
        out.mode = self.mode;
        out.state = self.state();
        out.page = self.page;
        (out.coordinates, out.soft_key_row) = (self.pages.coordinates, self.pages.soft_row);
        out.kind_page = self.kind_page();
        out.grinding_sheet = self.grinding_pages();
        out.x_as_diameter = self.is_diameter();
        out.axes = self.axis_views();
        self.program_view(out);
        out.single_block = self.switches.single_block;
        out.handwheel_axis = self.jog.axis;
        out.handwheel_step_mm = self.jog.step_mm;
        out.feed_override = self.overrides.feed;
        out.rapid_override = self.overrides.rapid;
        out.spindle_override = self.overrides.spindle;
        out.feed_mm_min = self.path_speed_mm_s() * super::axes::SECONDS_PER_MINUTE;
        out.wheel_rpm =
            if self.output_set.has(crate::defs::signal::Output::Wheel) { self.output_wheel_rpm() } else { 0.0 };
        if self.kind_row.has_main_spindle {
            out.wheel_rpm = self.lathe.spindle.rpm.abs();
        }
        out.tool_station = self.kind_row.has_main_spindle.then(|| self.turret_station().map_or(0, u32::from));
        self.teach_view(&mut out.teach);
        out.strokes_per_min = self.measured_strokes_min();
        out.parts_counted = self.part_count;
        out.restart = self.restart_view().map(Box::new);
        out.interrupted = self.power_cut.interrupted;
        let cycle = self.run.as_ref().map_or(self.cycle_time, |run| self.now.since(run.started_at));
        out.cycle_seconds = cycle.as_secs_f64();
        out.inputs = self.inputs;
        out.outputs = self.output_set;
        for key in Key::ALL {
            out.keys[*key as usize] = self.key_view(*key);
        }
        for (number, place) in out.variables.iter_mut().enumerate().take(VARIABLE_COUNT) {
            *place = self.memory.get(number as u32).ok().flatten();
        }
        for number in 434..=439 {
            out.variables[number] = self.system_variable(number as u32);
        }
        if out.alarms != self.alarms.present() {
            out.alarms = self.alarms.present().to_vec();
        }
        if out.message != self.message {
            out.message.clone_from(&self.message);
        }
        let told = self.waiting_for.as_ref().or(self.pages.program_message.as_ref());
        if out.waiting_for.as_ref() != told {
            out.waiting_for = told.cloned();
        }
        self.page_view(out);
        self.edit_view(out);
        if !Arc::ptr_eq(&out.screens, &self.screens) {
            out.screens.clone_from(&self.screens);
        }
        if !Arc::ptr_eq(&out.directory, &self.directory) {
            out.directory.clone_from(&self.directory);
        }
    }

    fn axis_views(&self) -> PerAxis<AxisView> {
        let (machine, work, to_go) = (self.axes.actual(), self.work_position(), self.distance_to_go());
        PerAxis::from_fn(|axis: Axis| {
            let factor = self.displayed_per_mm(axis);
            AxisView {
                present: self.axes.is_present(axis),
                work: work[axis] * factor,
                machine: machine[axis] * factor,
                relative: (machine[axis] - self.relative_zero[axis]) * factor,
                to_go: to_go[axis],
                homed: self.axes.is_homed(axis),
                moving: self.is_moving(axis),
            }
        })
    }

    fn program_view(&self, out: &mut Snapshot) {
        let program = self.programs.get(self.current_program);
        match program {
            Some(program) if !out.program.text.is_instance(&program.text) => {
                out.program.text.clone_from(&program.text);
                (out.program.stamp, out.program.has_invalid_bytes) = (program.stamp, program.has_invalid_bytes);
            }
            Some(_) => {}
            None => out.program = ProgramView::default(),
        }
        out.program.number = self.current_program;
        out.program.block_program = self.current_block.program;
        out.program.line = self.current_block.line;
        out.program.block = self.current_block.n;
    }

    pub(super) fn key_view(&self, key: Key) -> KeyView {
        let (lamp, working) = match key.row().lamp {
            Lamp::None => (false, false),
            Lamp::Output(Output::SecondSpindle) => {
                let both = [Output::SecondSpindle, Output::SecondSpindleCcw];
                (
                    both.iter().any(|output| self.output_set.has(*output)),
                    self.machine.awaits_feedback(Output::SecondSpindle),
                )
            }
            Lamp::Output(output) => (self.output_set.has(output), self.machine.awaits_feedback(output)),
            Lamp::OutputOff(output) => (!self.output_set.has(output), false),
            Lamp::Control => (self.control_lamp(key), key == Key::WheelRetract && self.retract.is_moving()),
        };
        KeyView { lamp, pending: working, blocked: self.key_blocked(key) }
    }

    fn control_lamp(&self, key: Key) -> bool {
        let step = |mm: f64| self.jog.step_mm.total_cmp(&mm).is_eq();
        match key {
            Key::SingleBlock => self.switches.single_block,
            Key::BlockSkip => self.switches.block_skip,
            Key::OptionalStop => self.switches.optional_stop,
            Key::MachineLock => self.switches.machine_lock,
            Key::AuxFunctionLock => self.switches.aux_function_lock,
            Key::DryRun => self.switches.dry_run,
            Key::Oscillation => self.oscillation_lamp(),
            Key::DressReturn => self.dressing.return_active,
            Key::WheelRetract => self.retract.lamp_on(),
            Key::CycleStart => matches!(self.phase, ControlPhase::Running),
            Key::FeedHold => matches!(self.phase, ControlPhase::Holding | ControlPhase::Held),
            Key::EmergencyStop => self.machine.is_e_stopped(),
            Key::Rapid => self.jog.rapid,
            Key::RapidF0 => self.overrides.rapid == 0,
            Key::Rapid25 => self.overrides.rapid == 25,
            Key::Rapid50 => self.overrides.rapid == 50,
            Key::Rapid100 => self.overrides.rapid == 100,
            Key::HandwheelX => self.jog.axis == Axis::X,
            Key::HandwheelY => self.jog.axis == Axis::Y,
            Key::HandwheelZ => self.jog.axis == Axis::Z,
            Key::Step0001 => step(0.001),
            Key::Step001 => step(0.01),
            Key::Step01 => step(0.1),
            Key::HeadstockStop => !self.machine.drive_is_on(),
            Key::SpindleForward => self.machine.spindle_direction() == Some(false),
            Key::SpindleReverse => self.machine.spindle_direction() == Some(true),
            Key::SpindleStop => self.machine.spindle_direction().is_none(),
            Key::ToolTurret => self.machine.turret_is_moving(),
            _ => Mode::ALL.into_iter().any(|mode| mode.key() == key && mode == self.mode),
        }
    }

    pub(super) fn is_moving(&self, axis: Axis) -> bool {
        self.axes.velocity_mm_s()[axis].abs() > STANDING_MM_S
    }

    fn path_speed_mm_s(&self) -> f64 {
        let velocity = self.axes.velocity_mm_s();
        velocity.iter().map(|(_, v)| v * v).sum::<f64>().sqrt()
    }

    /// Outputs by function, as of the last tick.
    #[must_use]
    pub const fn output_set(&self) -> OutputSet {
        self.output_set
    }

    /// The value of a common variable as executed.
    #[must_use]
    pub fn variable(&self, number: u32) -> Option<f64> {
        self.memory.get(number).ok().flatten()
    }

    /// The present block: program, line, N.
    #[must_use]
    pub const fn current_block(&self) -> crate::nc::BlockLocation {
        self.current_block
    }

    /// The output image of the last tick.
    #[must_use]
    pub const fn outputs(&self) -> &crate::io::OutputImage {
        &self.outputs
    }

    /// The parameters in force.
    #[must_use]
    pub const fn params(&self) -> &crate::defs::param::Params {
        &self.params
    }

    /// The kind of machine.
    #[must_use]
    pub const fn kind(&self) -> crate::defs::kind::Kind {
        self.kind
    }

    /// Tick time.
    #[must_use]
    pub const fn tick_time(&self) -> Micros {
        self.tick_time
    }

    /// Blocks executed since power-on.
    #[must_use]
    pub const fn block_count(&self) -> u64 {
        self.block_count
    }

    /// Whether the axes are braking to a hold or a reset.
    #[must_use]
    pub const fn is_braking(&self) -> bool {
        matches!(self.phase, ControlPhase::Holding | ControlPhase::Aborting)
    }

    /// Whether the axes stand in position.
    #[must_use]
    pub fn is_in_position(&self) -> bool {
        self.axes.is_at_rest() && self.axes.is_in_position(&self.params)
    }

    /// Whether no set-point moves.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.axes.is_at_rest()
    }

    /// The axes of the machine.
    pub fn axes_present(&self) -> impl Iterator<Item = Axis> + use<> {
        self.axes.present()
    }

    /// Machine set-point, radius mm.
    #[must_use]
    pub const fn set_point(&self) -> PerAxis<f64> {
        self.axes.set_point()
    }

    /// Machine position from the encoders, radius mm.
    #[must_use]
    pub const fn actual(&self) -> PerAxis<f64> {
        self.axes.actual()
    }

    /// Wear of an offset (1 to 16), mm as displayed.
    #[must_use]
    pub fn wear(&self, number: usize, axis: Axis) -> Option<f64> {
        let wear = self.work_offsets.wear.get(number.checked_sub(1)?)?;
        Some(wear[axis] * self.displayed_per_mm(axis))
    }

    /// Controller time.
    #[must_use]
    pub const fn now(&self) -> Micros {
        self.now
    }
}
