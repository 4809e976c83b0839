//! The controller: one call a tick, in a fixed order; time, inputs and commands are arguments.
//!
//! Order of [`Controller::tick`]: inputs (filter, encoders) → commands → machine logic and its alarms → program
//! (actions, moves, read-ahead) → jog and homing → axes → outputs. The controller uses no clock, file or thread: the
//! same inputs and commands give the same outputs, bit for bit.

pub mod axes;
pub mod interlock_check;
mod manual;
mod panel;
mod plant;
mod power_on;
mod program;
mod queries;
mod safety;
mod storage_request;

use std::sync::Arc;

use crate::defs::alarm;
use crate::defs::kind::Kind;
use crate::defs::text::LocalizedText;
use crate::io::{InputImage, OutputImage};
use crate::link::command::Command;
use crate::link::snapshot::{DirectoryRow, Snapshot};
use crate::units::{Micros, PerAxis};
use manual::Manual;
use panel::{Panel, Parts, PartsView};
use plant::Plant;
use program::Program;

pub use crate::nc::WorkOffsets;
pub use axes::soft_limits;
pub use panel::files;
pub use plant::WORK_PER_TICK;
pub use plant::system_variables::{nc_settings, stored_system_variables};
pub use power_on::PowerOnState;
pub use program::library::{FilePart, Programs, StoredProgram};
pub use program::lookahead_state::reference_points;
pub use safety::alarms::{AlarmList, AlarmWords};
pub use storage_request::StorageRequest;

/// The core of one control: its parts and the order of a tick.
pub struct Controller {
    plant: Plant,
    program: Program,
    manual: Manual,
    panel: Panel,
}

impl Controller {
    /// A control at power-on.
    #[must_use]
    pub fn new(kind: Kind, retained: PowerOnState, image: InputImage, now: Micros) -> Self {
        let (program, panel) = (Program::new(kind, retained.interrupted), Panel::new(kind, &retained, now));
        let mut plant = Plant::new(kind, retained, image, now);
        program.announce_interrupted(&mut plant);
        Self { plant, program, manual: Manual::default(), panel }
    }

    /// Prepares a headless run (tools.md T3): homed, with the encoder zero at machine coordinates `encoder_zero_mm`,
    /// hydraulics on, part clamped, mode AUTO.
    pub fn make_ready(&mut self, encoder_zero_mm: PerAxis<f64>) {
        self.plant.make_ready(encoder_zero_mm);
    }

    /// One tick. `now` increases by the tick time from call to call.
    pub fn tick(&mut self, now: Micros, image: &InputImage, commands: &[Command]) -> &OutputImage {
        let Self { plant, program, manual, panel } = self;
        plant.begin_tick(now, panel.calendar.timestamp(now), image);
        if image.handwheel_detents != 0 {
            manual::turn_handwheel(plant, program, image.handwheel_detents);
        }
        plant.outbox.refusal = None;
        plant.execution.starts_void = commands.iter().any(panel::voids_starts);
        let mut parts = Parts { plant, program, manual };
        for command in commands {
            panel.handle_command(&mut parts, command);
        }
        let refused = parts.plant.outbox.refusal.take();
        parts.plant.supervise_machine();
        for key in parts.plant.inputs.external_keys() {
            panel.press_key(&mut parts, key);
        }
        let Parts { plant, program, manual } = parts;
        plant.supervise_axes();
        program.supervise_supply(plant);
        plant.supervise_screen();
        plant.supervise_storage();
        program.step_restart(plant);
        program.step_run(plant);
        program.step_start_check(plant);
        program.store_run_position(plant);
        manual::step_jog(plant);
        plant.step_oscillation();
        plant.step_axes();
        manual.teach.step(plant, program.is_open());
        program.finish_braking(plant);
        plant.write_outputs();
        plant.store_alarm_changes();
        panel.follow_cycle(plant, program.started_at());
        panel.follow_hours(&mut Parts { plant, program, manual });
        panel.scope.record(plant);
        plant.outbox.refusal = refused; // later refusals in this tick do not answer a command
        &plant.outputs.image
    }

    /// Replaces the programs after the folder changed.
    pub fn set_programs(&mut self, programs: Arc<Programs>, directory: Arc<Vec<DirectoryRow>>) {
        self.program.abandon_restart();
        self.program.forget_start_check();
        self.plant.work.programs = programs;
        self.panel.directory = directory;
    }

    /// Programs run for the time of one pass: P390 and M99 in the main program do not repeat them.
    pub const fn set_runs_once(&mut self, once: bool) {
        self.plant.execution.runs_once = once;
    }

    /// Raises an alarm detected outside the core (damaged data, late ticks).
    pub fn report_alarm(&mut self, number: u16, detail: Option<LocalizedText>) {
        self.plant.raise(number, detail);
    }

    /// The computer has held the control up: what moves stops, and a program is held.
    pub fn report_stall(&mut self) {
        if self.state().is_active() || self.plant.is_moved_by_hand() || self.plant.is_oscillating() {
            self.plant.raise(alarm::CONTROL_STALLED, None);
            self.plant.stop_manual_motion();
        }
    }

    /// The bus is lost, or differs from its description: what is wrong is the detail of the alarm, the newest counts.
    pub fn report_bus_fault(&mut self, number: u16, detail: LocalizedText) {
        self.plant.alarms.complete(number, detail.clone());
        self.plant.raise(number, Some(detail));
    }

    /// The control is to end. What moves brakes by an alarm that stops everything; the place of an open run is kept as
    /// at a power cut.
    pub fn begin_end(&mut self) {
        let Self { plant, program, .. } = self;
        program.keep_run_position(plant);
        if plant.execution.phase.is_run_open() || plant.is_oscillating() || !plant.axes.is_at_rest() {
            plant.raise(alarm::CONTROL_ENDED, None);
            plant.store_alarm_changes();
        }
    }

    /// The control ends: what waits for its commit is stored with the next requests.
    pub fn store_everything(&mut self) {
        self.panel.store_hours(&mut self.plant);
        self.plant.store_gathered();
    }

    /// Moves the pending disk requests to `out`. What programs write is gathered for a quarter of a second.
    pub fn drain_storage_requests(&mut self, out: &mut Vec<StorageRequest>) {
        self.plant.store_gathered_when_due();
        let outbox = &mut self.plant.outbox;
        if outbox.requests.iter().any(StorageRequest::is_retained) {
            let mark = outbox.unstored.send(self.plant.now);
            outbox.requests.push(StorageRequest::Mark(mark));
        }
        out.append(&mut outbox.requests);
    }

    /// Writes everything that pages show.
    pub fn snapshot(&self, out: &mut Snapshot) {
        self.panel.snapshot(self.view(), out);
    }

    const fn view(&self) -> PartsView<'_> {
        PartsView { plant: &self.plant, program: &self.program, manual: &self.manual }
    }
}
