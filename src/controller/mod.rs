//! The controller: one call a tick, in a fixed order; time, inputs and commands are arguments.
//!
//! Order of [`Controller::tick`]: inputs (filter, encoders) → commands → machine logic and its alarms → program
//! (actions, moves, read-ahead) → jog and homing → axes → outputs. The controller uses no clock, file or thread: the
//! same inputs and commands give the same outputs, bit for bit.

mod actions;
mod alarms;
pub mod axes;
mod calendar;
mod commands;
mod cycle;
mod dressing;
mod edits;
mod executor;
pub mod files;
mod filter;
mod gauge;
mod hold;
mod homing;
pub mod interlock_check;
mod jog;
mod jog_state;
mod keys;
mod lathe;
mod leadscrew;
mod library;
mod lookahead_state;
mod mdi;
mod offsets;
mod oscillation;
mod page_files;
mod pages;
mod restart;
mod retract;
mod run;
mod status;
mod storage_request;
mod supervision;
mod switches;
mod system_variables;
mod teach;
mod tick_end;
mod wheel_change;
mod wheel_size;

pub use alarms::AlarmList;
pub use library::{Programs, StoredProgram};
pub use lookahead_state::reference_points;
pub use storage_request::StorageRequest;
pub use system_variables::{PARAM_VARIABLES, nc_settings};

use std::sync::Arc;

use crate::defs::alarm_history::PastAlarm;
use crate::defs::key::Mode;
use crate::defs::kind::Kind;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::page::Page;
use crate::defs::param::{self, ParamAddress, Params};
use crate::defs::signal::{Input, InputSet, Output, OutputSet};
use crate::defs::text::LocalizedText;
use crate::io::{InputImage, OutputImage};
use crate::link::command::{Command, Screens};
use crate::link::snapshot::{DirectoryRow, Message, Tone};
use crate::machine::kind::KindRow;
use crate::machine::{Machine, phase};
pub use crate::nc::WorkOffsets;
use crate::nc::{BlockLocation, CommonVariables, ModalState, SpeedMode};
use crate::units::{Axis, Micros, PerAxis};
use axes::Axes;
use dressing::DressingPoints;
use filter::Filter;
use homing::AxisHoming;
use jog_state::Jog;
use oscillation::Oscillation;
use pages::PageState;
use run::ProgramRun;

/// Factor from mm/min to mm/s.
const MM_S_PER_MM_MIN: f64 = 1.0 / axes::SECONDS_PER_MINUTE;
/// Full scale of the analog outputs, V.
const FULL_SCALE_VOLTS: f64 = 10.0;
/// Capacity for disk requests between two calls of [`Controller::drain_effects`].
const STORAGE_REQUESTS: usize = 256;

/// Homing in progress: the present axis and the axes still to home.
#[derive(Clone, Debug)]
struct Homing {
    current: AxisHoming,
    queued: PerAxis<bool>,
}

/// The control phase.
type ControlPhase = phase::RunPhase<Homing>;
/// An event that may change the phase.
type ControlEvent = phase::PhaseEvent<Homing>;

/// The panel switches that change how a program runs.
#[derive(Clone, Copy, Debug, Default)]
struct PanelSwitches {
    single_block: bool,
    block_skip: bool,
    optional_stop: bool,
    machine_lock: bool,
    aux_function_lock: bool,
    dry_run: bool,
}

/// Overrides in percent.
#[derive(Clone, Copy, Debug)]
struct Overrides {
    feed: u16,
    rapid: u16,
    spindle: u16,
}

/// State of the control at power-on, from the retained store.
#[derive(Clone, Debug)]
pub struct PowerOnState {
    /// Parameters.
    pub params: Params,
    /// Macro variables.
    pub variables: CommonVariables,
    /// Work offsets and tool offsets.
    pub work_offsets: WorkOffsets,
    /// Dressing points, machine coordinates, radius mm (K4.2); `None` where not set.
    pub dress_points: PerAxis<Option<f64>>,
    /// Leadscrew compensation tables of the axes (B7).
    pub leadscrew_tables: PerAxis<LeadscrewCompensation>,
    /// Number of the current program; 0 for none.
    pub current_program: u32,
    /// Workpiece count.
    pub part_count: u32,
    /// Program and line (from 1) of a run that a power failure interrupted.
    pub interrupted: Option<(u32, u32)>,
    /// Alarm history.
    pub alarm_history: Vec<PastAlarm>,
    /// Date set at the machine minus the system clock, s.
    pub clock_offset_s: i64,
}

impl PowerOnState {
    /// Factory state of a kind of machine.
    #[must_use]
    pub fn factory(kind: Kind) -> Self {
        let mut variables = CommonVariables::default();
        for (number, value) in crate::machine::kind::find(kind).variables {
            let _ = variables.set(u32::from(*number), Some(*value)); // the rows name common variables only
        }
        Self {
            params: Params::factory(kind),
            variables,
            work_offsets: WorkOffsets::default(),
            dress_points: PerAxis::default(),
            leadscrew_tables: PerAxis::default(),
            current_program: 0,
            part_count: 0,
            interrupted: None,
            alarm_history: Vec::new(),
            clock_offset_s: 0,
        }
    }
}

/// The core of one control.
pub struct Controller {
    kind: Kind,
    kind_row: &'static KindRow,
    params: Params,
    now: Micros,
    image: InputImage,
    filter: Filter,
    inputs: InputSet,
    raw_inputs: InputSet,
    /// Inputs of the previous tick, for edge detection.
    last_inputs: InputSet,
    machine: Machine,
    axes: Axes,
    jog: Jog,
    oscillation: Option<Oscillation>,
    phase: ControlPhase,
    run: Option<Box<ProgramRun>>,
    retract: retract::Retract,
    restart: Option<Box<restart::Restart>>,
    power_cut: restart::PowerCutPosition,
    mode: Mode,
    page: Page,
    switches: PanelSwitches,
    overrides: Overrides,
    work_offsets: WorkOffsets,
    dressing: DressingPoints,
    memory: CommonVariables,
    programs: Arc<Programs>,
    current_program: u32,
    current_block: BlockLocation,
    alarms: AlarmList,
    calendar: calendar::Calendar,
    message: Message,
    /// Why a command of the last tick was refused, if one was.
    refusal: Option<LocalizedText>,
    waiting_for: Option<LocalizedText>,
    screens: Arc<Screens>,
    directory: Arc<Vec<DirectoryRow>>,
    storage_requests: Vec<StorageRequest>,
    outputs: OutputImage,
    output_set: OutputSet,
    /// Outputs without a port of their own: they cannot be switched.
    unusable_outputs: OutputSet,
    /// The emergency stop on the screen is pressed.
    soft_e_stop: bool,
    drives_on: bool,
    /// Programmed S, in the unit of its mode.
    wheel_speed: (f64, SpeedMode),
    /// G50 S: maximum wheel speed under G96, rpm.
    wheel_rpm_limit: Option<f64>,
    /// Offsets added to the time since power-on in #3001 (ms) and #3002 (h).
    timer_offset: [f64; 2],
    analog_2_rpm: f64,
    relative_zero: PerAxis<f64>,
    skip_position: PerAxis<f64>,
    gauge_positions: gauge::GaugePositions,
    part_count: u32,
    cycle_time: Micros,
    /// Blocks executed since power-on.
    block_count: u64,
    screen_alive_at: Option<Micros>,
    /// Tick time, as read at power-on (P58).
    tick_time: Micros,
    /// Pressed limit switches: two bits per axis, plus then minus.
    limit_switches: u8,
    /// Modal state kept from one MDI line to the next.
    mdi_modals: Option<ModalState>,
    pages: PageState,
    edits: edits::EditState,
    files: files::FileRequests,
    lathe: lathe::Lathe,
    teach: teach::TeachRecorder,
    /// Remaining automatic repetitions of the program (P390).
    repeats_left: u32,
}

impl Controller {
    /// A control at power-on.
    #[must_use]
    pub fn new(kind: Kind, retained: PowerOnState, image: InputImage, now: Micros) -> Self {
        let row = crate::machine::kind::find(kind);
        let params = retained.params;
        let mut control = Self {
            kind,
            kind_row: row,
            now,
            image,
            filter: Filter::new(&params, image.terminals),
            inputs: InputSet::NONE,
            raw_inputs: InputSet::NONE,
            last_inputs: InputSet::NONE,
            machine: Machine::new(row, now),
            axes: Axes::new(&params, row, &image, retained.leadscrew_tables),
            jog: Jog::default(),
            oscillation: None,
            phase: ControlPhase::Idle,
            run: None,
            retract: retract::Retract::default(),
            restart: None,
            power_cut: restart::PowerCutPosition::new(retained.interrupted),
            mode: Mode::Manual,
            page: Page::Position,
            switches: PanelSwitches::default(),
            overrides: Overrides { feed: 100, rapid: 100, spindle: 100 },
            work_offsets: retained.work_offsets,
            dressing: DressingPoints::new(retained.dress_points),
            memory: retained.variables,
            programs: Arc::default(),
            current_program: retained.current_program,
            current_block: BlockLocation::default(),
            alarms: AlarmList::new(retained.alarm_history),
            calendar: calendar::Calendar::new(retained.clock_offset_s),
            message: Message::default(),
            refusal: None,
            waiting_for: None,
            screens: Arc::default(),
            directory: Arc::default(),
            storage_requests: Vec::with_capacity(STORAGE_REQUESTS),
            outputs: OutputImage::default(),
            output_set: OutputSet::NONE,
            unusable_outputs: OutputSet::NONE,
            soft_e_stop: false,
            drives_on: true,
            wheel_speed: (params.get(param::WHEEL_RPM), SpeedMode::Rpm),
            wheel_rpm_limit: None,
            timer_offset: [0.0; 2],
            analog_2_rpm: 0.0,
            relative_zero: PerAxis::default(),
            skip_position: PerAxis::default(),
            gauge_positions: gauge::GaugePositions::default(),
            part_count: retained.part_count,
            cycle_time: Micros::ZERO,
            block_count: 0,
            screen_alive_at: None,
            tick_time: Micros(params.get(param::TICK_TIME) as u64),
            limit_switches: 0,
            mdi_modals: None,
            pages: PageState::new(kind, &params),
            edits: edits::EditState::default(),
            files: files::FileRequests::default(),
            lathe: lathe::Lathe::default(),
            teach: teach::TeachRecorder::default(),
            repeats_left: 0,
            params,
        };
        control.update_unusable_outputs();
        control.announce_interrupted();
        control
    }

    /// Prepares a headless run (tools.md T3): homed, with the encoder zero at machine coordinates `encoder_zero_mm`,
    /// hydraulics on, part clamped, mode AUTO.
    pub fn make_ready(&mut self, encoder_zero_mm: PerAxis<f64>) {
        for axis in Axis::ALL {
            let at = self.axes.actual()[axis];
            self.axes.set_zero(axis, at, self.image.encoder_mm[axis] + encoder_zero_mm[axis]);
            self.axes.finish_homing(axis, &self.params);
        }
        self.machine.make_ready(&self.params);
        self.mode = Mode::Auto;
    }

    /// One tick. `now` increases by the tick time from call to call.
    pub fn tick(&mut self, now: Micros, image: &InputImage, commands: &[Command]) -> &OutputImage {
        self.now = now;
        self.alarms.set_time(now, self.calendar.timestamp(now));
        self.read_inputs(image);
        self.refusal = None;
        for command in commands {
            self.handle_command(command);
        }
        let refused = self.refusal.take();
        self.supervise();
        self.step_restart();
        self.step_run();
        self.store_run_position();
        self.step_jog();
        self.step_oscillation();
        let rate = self.override_factors();
        self.axes.tick(rate, self.lathe.spindle.turns);
        self.step_teach();
        self.finish_braking();
        self.write_outputs();
        self.store_alarm_changes();
        self.refusal = refused; // later refusals in this tick do not answer a command
        &self.outputs
    }

    fn read_inputs(&mut self, image: &InputImage) {
        self.image = *image;
        self.raw_inputs = self.filter.unfiltered(image.terminals);
        self.inputs = self.filter.tick(image.terminals);
        // The emergency stop acts at its first edge; only its release is debounced.
        if self.soft_e_stop || self.raw_inputs.has(Input::EmergencyStop) {
            self.inputs.set(Input::EmergencyStop, true);
        }
        self.axes.read(image);
        self.lathe.spindle.read(image.spindle_turns, self.now);
        self.measure_thread();
        if image.handwheel_detents != 0 {
            self.turn_handwheel(image.handwheel_detents);
        }
    }

    /// Replaces the programs after the folder changed.
    pub fn set_programs(&mut self, programs: Arc<Programs>, directory: Arc<Vec<DirectoryRow>>) {
        self.restart = None;
        self.programs = programs;
        self.directory = directory;
    }

    /// Raises an alarm detected outside the core (damaged data, late ticks).
    pub fn report_alarm(&mut self, number: u16, detail: Option<LocalizedText>) {
        self.raise(number, detail);
    }

    /// Moves the pending disk requests to `out`.
    pub fn drain_storage_requests(&mut self, out: &mut Vec<StorageRequest>) {
        out.append(&mut self.storage_requests);
    }

    fn show_note(&mut self, text: impl Into<LocalizedText>) {
        self.message = Message { text: text.into(), tone: Tone::Info, since: self.now };
    }

    /// Refuses a command and shows the reason.
    fn refuse(&mut self, text: impl Into<LocalizedText>) {
        self.warn(text);
        self.refusal = Some(self.message.text.clone());
    }

    /// Shows a warning that no command caused.
    fn warn(&mut self, text: impl Into<LocalizedText>) {
        self.message = Message { text: text.into(), tone: Tone::Refused, since: self.now };
    }

    /// Why a command of the last tick was refused; `None` if all were executed.
    #[must_use]
    pub const fn refusal(&self) -> Option<&LocalizedText> {
        self.refusal.as_ref()
    }

    /// Changes a parameter on behalf of the control and stores it.
    fn store_param(&mut self, at: ParamAddress, value: f64) {
        if self.params.write(at, value).is_ok() {
            self.pages.set_params(&self.params);
            self.storage_requests.push(StorageRequest::Param(at, value));
        }
    }

    fn set_param(&mut self, at: ParamAddress, value: f64) {
        if self.run.is_some() {
            return self
                .refuse(LocalizedText::new("运行中不能修改参数", "parameters are not changed while a program runs"));
        }
        if self.is_in_use(at, value) {
            return self.refuse(LocalizedText::new(
                format!("{at}：该功能正在工作，先关闭再修改"),
                format!("{at}: the function is on; switch it off before this is changed"),
            ));
        }
        match self.params.write(at, value) {
            Ok(()) => {
                self.storage_requests.push(StorageRequest::Param(at, value));
                self.pages.set_params(&self.params);
                self.filter.configure(&self.params);
                self.axes.configure(&self.params);
                self.update_unusable_outputs();
                self.show_note(LocalizedText::new(format!("{at} = {value}"), format!("{at} = {value}")));
            }
            Err(error) => self.refuse(LocalizedText::new(error.zh(), error.to_string())),
        }
    }

    /// Whether a change would drop an active output, take over an active terminal, change an input while a spindle
    /// turns, or disable a clamp that is in use.
    fn is_in_use(&self, at: ParamAddress, value: f64) -> bool {
        let on = |output: Output| self.output_set.has(output);
        if at == param::TAILSTOCK_ENABLED.address() {
            return on(Output::Tailstock);
        }
        if at == param::MAGNET_ENABLED.address() {
            return on(Output::Magnetise) || on(Output::Demagnetise);
        }
        if at.bit.is_some() {
            return false;
        }
        let turns = on(Output::Wheel) || on(Output::SecondSpindle) || on(Output::SecondSpindleCcw);
        if Input::ALL.iter().any(|input| input.port_param() == at.number) {
            return turns || self.machine.drive_is_on();
        }
        let of = |output: &Output| output.port_param() == at.number && output.exists_on(self.kind);
        let port = value as u8; // truncated: the range is checked when it is written
        Output::ALL.iter().any(|output| of(output) && (on(*output) || self.outputs.terminals.level(port)))
    }

    /// X is programmed and shown as a diameter.
    fn is_diameter(&self) -> bool {
        !self.params.bit(param::RADIUS_PROGRAMMING)
    }

    /// Displayed millimetres per millimetre of slide travel.
    fn displayed_per_mm(&self, axis: Axis) -> f64 {
        if axis == Axis::X && self.is_diameter() { 2.0 } else { 1.0 }
    }

    /// The actual work position, radius mm.
    fn work_position(&self) -> PerAxis<f64> {
        self.work_offsets.work_from_machine(self.axes.actual())
    }

    /// Workpiece speed, rpm; 0 while the drive is off.
    fn workpiece_rpm(&self) -> f64 {
        if !self.machine.drive_is_on() {
            0.0
        } else if self.analog_2_rpm > 0.0 {
            self.analog_2_rpm
        } else if self.output_set.has(self.kind_row.drive_high) {
            self.params.get(param::HEADSTOCK_RPM_HIGH)
        } else {
            self.params.get(param::HEADSTOCK_RPM_LOW)
        }
    }
}
