//! Fills the snapshot: lamps, positions, state. Read-only; called whenever a snapshot is needed.
//! Source: spec H5, H7, K2.4.

use std::sync::Arc;

use super::{Controller, Phase};
use crate::defs::key::{Key, Lamp, Mode};
use crate::defs::signal::{Output, OutputSet};
use crate::link::snapshot::{AxisView, KeyView, ProgramView, RunState, Snapshot, VARIABLES};
use crate::units::{Axis, Micros, PerAxis};

/// Below this speed an axis is shown as standing, mm/s.
const STANDING_MM_S: f64 = 1e-6;

impl Controller {
    /// The run state.
    #[must_use]
    pub fn state(&self) -> RunState {
        match self.phase {
            Phase::Homing(_) => RunState::Homing,
            Phase::Running if self.is_waiting() => RunState::Waiting,
            Phase::Running => RunState::Running,
            Phase::Holding | Phase::Held => RunState::Held,
            Phase::Stopped => RunState::Stopped,
            Phase::Idle | Phase::Aborting if self.alarms.block_start() => RunState::Alarm,
            Phase::Idle | Phase::Aborting => RunState::Idle,
        }
    }

    /// Writes everything that pages show.
    pub fn snapshot(&self, out: &mut Snapshot) {
        out.kind = self.kind;
        out.now = self.now;
        out.mode = self.mode;
        out.state = self.state();
        out.page = self.page;
        (out.coordinates, out.soft_row) = (self.pages.coordinates, self.pages.soft_row);
        out.own_page = self.own_page();
        out.grinding_pages = self.grinding_pages();
        out.diameter = self.is_diameter();
        out.axes = self.axis_views();
        self.program_view(out);
        out.single_block = self.switches.single_block;
        out.handwheel_axis = self.hand.axis;
        out.step_mm = self.hand.step_mm;
        out.feed_override = self.overrides.feed;
        out.rapid_override = self.overrides.rapid;
        out.spindle_override = self.overrides.spindle;
        out.feed_mm_min = self.path_speed_mm_s() * super::axes::MINUTE;
        out.wheel_rpm =
            if self.output_set.has(crate::defs::signal::Output::Wheel) { self.wheel_rpm_given() } else { 0.0 };
        if self.row.turns_part {
            out.wheel_rpm = self.lathe.spindle.rpm.abs();
        }
        out.station = self.row.turns_part.then(|| self.station().map_or(0, u32::from));
        self.teach_view(&mut out.teach);
        out.strokes_min = self.measured_strokes_min();
        out.parts = self.parts;
        out.restart = self.restart_view().map(Box::new);
        out.interrupted = self.kept.interrupted;
        let cycle = self.run.as_ref().map_or(self.cycle_time, |run| self.now.since(run.since));
        out.cycle_seconds = cycle.as_secs_f64();
        out.inputs = self.inputs;
        out.outputs = self.output_set;
        for key in Key::ALL {
            out.keys[*key as usize] = self.key_view(*key);
        }
        for (number, place) in out.variables.iter_mut().enumerate().take(VARIABLES) {
            *place = self.memory.get(number as u32).ok().flatten();
        }
        for number in 434..=439 {
            out.variables[number] = self.system_value(number as u32);
        }
        if out.alarms != self.alarms.present() {
            out.alarms = self.alarms.present().to_vec();
        }
        if out.message != self.message {
            out.message.clone_from(&self.message);
        }
        let told = self.waiting_for.as_ref().or(self.pages.note.as_ref());
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
        let (machine, work, to_go) = (self.axes.actual(), self.work(), self.distance_to_go());
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
        let program = self.programs.get(self.current);
        match program {
            Some(program) if !out.program.text.is_instance(&program.text) => {
                out.program.text.clone_from(&program.text);
                (out.program.stamp, out.program.mistaken) = (program.stamp, program.mistaken);
            }
            Some(_) => {}
            None => out.program = ProgramView::default(),
        }
        out.program.number = self.current;
        out.program.block_program = self.place.program;
        out.program.line = self.place.line;
        out.program.block = self.place.n;
    }

    pub(super) fn key_view(&self, key: Key) -> KeyView {
        let (lamp, working) = match key.row().lamp {
            Lamp::None => (false, false),
            Lamp::Output(Output::SecondSpindle) => {
                let both = [Output::SecondSpindle, Output::SecondSpindleCcw];
                (both.iter().any(|output| self.output_set.has(*output)), self.machine.is_working(Output::SecondSpindle))
            }
            Lamp::Output(output) => (self.output_set.has(output), self.machine.is_working(output)),
            Lamp::OutputOff(output) => (!self.output_set.has(output), false),
            Lamp::Control => (self.control_lamp(key), key == Key::WheelRetract && self.retract.is_working()),
        };
        KeyView { lamp, working, blocked: self.blocked(key) }
    }

    fn control_lamp(&self, key: Key) -> bool {
        let step = |mm: f64| self.hand.step_mm.total_cmp(&mm).is_eq();
        match key {
            Key::SingleBlock => self.switches.single_block,
            Key::BlockSkip => self.switches.block_skip,
            Key::OptionalStop => self.switches.optional_stop,
            Key::MachineLock => self.switches.machine_lock,
            Key::MstLock => self.switches.mst_lock,
            Key::DryRun => self.switches.dry_run,
            Key::Oscillation => self.oscillation_lamp(),
            Key::DressReturn => self.dress.returning,
            Key::WheelRetract => self.retract.is_lit(),
            Key::CycleStart => matches!(self.phase, Phase::Running),
            Key::FeedHold => matches!(self.phase, Phase::Holding | Phase::Held),
            Key::EmergencyStop => self.machine.is_e_stopped(),
            Key::Rapid => self.hand.rapid,
            Key::RapidF0 => self.overrides.rapid == 0,
            Key::Rapid25 => self.overrides.rapid == 25,
            Key::Rapid50 => self.overrides.rapid == 50,
            Key::Rapid100 => self.overrides.rapid == 100,
            Key::HandwheelX => self.hand.axis == Axis::X,
            Key::HandwheelY => self.hand.axis == Axis::Y,
            Key::HandwheelZ => self.hand.axis == Axis::Z,
            Key::Step0001 => step(0.001),
            Key::Step001 => step(0.01),
            Key::Step01 => step(0.1),
            Key::HeadstockStop => !self.machine.drive_is_on(),
            Key::SpindleForward => self.machine.spindle_direction() == Some(false),
            Key::SpindleReverse => self.machine.spindle_direction() == Some(true),
            Key::SpindleStop => self.machine.spindle_direction().is_none(),
            Key::ToolPost => self.machine.post_is_moving(),
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
    pub const fn place(&self) -> crate::nc::Place {
        self.place
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
        self.tick
    }

    /// Blocks executed since power-on.
    #[must_use]
    pub const fn blocks(&self) -> u64 {
        self.blocks
    }

    /// Whether the axes are braking to a hold or a reset.
    #[must_use]
    pub const fn is_braking(&self) -> bool {
        matches!(self.phase, Phase::Holding | Phase::Aborting)
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
        self.axes.set()
    }

    /// Machine position from the encoders, radius mm.
    #[must_use]
    pub const fn actual(&self) -> PerAxis<f64> {
        self.axes.actual()
    }

    /// Wear of an offset (1 to 16), mm as displayed.
    #[must_use]
    pub fn wear(&self, number: usize, axis: Axis) -> Option<f64> {
        let wear = self.frames.wear.get(number.checked_sub(1)?)?;
        Some(wear[axis] * self.displayed_per_mm(axis))
    }

    /// Controller time.
    #[must_use]
    pub const fn now(&self) -> Micros {
        self.now
    }
}
