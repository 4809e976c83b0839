//! The controller: one call a tick, in a fixed order; time, inputs and commands are arguments.
//!
//! Order of [`Controller::tick`]: inputs (filter, encoders) → commands → machine logic and its alarms → program
//! (actions, moves, read-ahead) → jog and homing → axes → outputs. The controller uses no clock, file or thread: the
//! same inputs and commands give the same outputs, bit for bit.

mod acts;
mod alarms;
pub mod axes;
mod by_hand;
mod calendar;
mod commands;
mod cycle;
mod dress;
mod edits;
mod effect;
mod executor;
pub mod files;
mod filter;
pub mod foresight;
mod gauge;
mod hand;
mod hold;
mod homing;
mod keys;
mod library;
mod mdi;
mod offsets;
mod oscillation;
mod page_files;
mod pages;
mod planned;
mod restart;
mod retract;
mod run;
mod screw;
mod settle;
mod status;
mod switches;
mod system;
mod teach;
mod turning;
mod watch;
mod wheel_change;
mod wheel_size;

pub use alarms::Alarms;
pub use effect::Effect;
pub use library::{Program, Programs};
pub use planned::references;
pub use system::{PARAM_VARIABLES, nc_settings};

use std::sync::Arc;

use crate::defs::history::PastAlarm;
use crate::defs::key::Mode;
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::param::{self, ParamAddress, Params};
use crate::defs::screw::ScrewTable;
use crate::defs::signal::{Input, InputSet, Output, OutputSet};
use crate::defs::text::Said;
use crate::io::{InputImage, OutputImage};
use crate::link::command::{Command, Screens};
use crate::link::snapshot::{DirectoryRow, Message, Tone};
use crate::machine::kind::KindRow;
use crate::machine::{Machine, phase};
pub use crate::nc::Frames;
use crate::nc::{Memory, Modals, Place, SpeedMode};
use crate::units::{Axis, Micros, PerAxis};
use axes::Axes;
use dress::Dress;
use filter::Filter;
use hand::Hand;
use homing::AxisHoming;
use oscillation::Oscillation;
use pages::Pages;
use run::Run;

/// Factor from mm/min to mm/s.
const MINUTE_HZ: f64 = 1.0 / axes::MINUTE;
/// Full scale of the analog outputs, V.
const FULL_SCALE_VOLTS: f64 = 10.0;
/// Capacity for disk requests between two calls of [`Controller::drain_effects`].
const EFFECTS: usize = 256;

/// Homing in progress: the present axis and the axes still to home.
#[derive(Clone, Debug)]
struct Homing {
    now: AxisHoming,
    next: PerAxis<bool>,
}

/// The control phase.
type Phase = phase::Phase<Homing>;
/// An event that may change the phase.
type Event = phase::Event<Homing>;

/// The panel switches that change how a program runs.
#[derive(Clone, Copy, Debug, Default)]
struct Switches {
    single_block: bool,
    block_skip: bool,
    optional_stop: bool,
    machine_lock: bool,
    mst_lock: bool,
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
pub struct Retained {
    /// Parameters.
    pub params: Params,
    /// Macro variables.
    pub variables: Memory,
    /// Work offsets and tool offsets.
    pub frames: Frames,
    /// Dressing points, machine coordinates, radius mm (K4.2); `None` where not set.
    pub dress_points: PerAxis<Option<f64>>,
    /// Leadscrew compensation tables of the axes (B7).
    pub screws: PerAxis<ScrewTable>,
    /// Number of the current program; 0 for none.
    pub current_program: u32,
    /// Workpiece count.
    pub parts: u32,
    /// Program and line (from 1) of a run that a power failure interrupted.
    pub interrupted: Option<(u32, u32)>,
    /// Alarm history.
    pub alarms: Vec<PastAlarm>,
    /// Date set at the machine minus the system clock, s.
    pub clock_offset_s: i64,
}

impl Retained {
    /// Factory state of a kind of machine.
    #[must_use]
    pub fn factory(kind: Kind) -> Self {
        let mut variables = Memory::default();
        for (number, value) in crate::machine::kind::find(kind).variables {
            let _ = variables.set(u32::from(*number), Some(*value)); // the rows name common variables only
        }
        Self {
            params: Params::factory(kind),
            variables,
            frames: Frames::default(),
            dress_points: PerAxis::default(),
            screws: PerAxis::default(),
            current_program: 0,
            parts: 0,
            interrupted: None,
            alarms: Vec::new(),
            clock_offset_s: 0,
        }
    }
}

/// The core of one control.
pub struct Controller {
    kind: Kind,
    row: &'static KindRow,
    params: Params,
    now: Micros,
    image: InputImage,
    filter: Filter,
    inputs: InputSet,
    raw: InputSet,
    /// Inputs of the previous tick, for edge detection.
    last_inputs: InputSet,
    machine: Machine,
    axes: Axes,
    hand: Hand,
    oscillation: Option<Oscillation>,
    phase: Phase,
    run: Option<Box<Run>>,
    retract: retract::Retract,
    restart: Option<Box<restart::Restart>>,
    kept: restart::Kept,
    mode: Mode,
    page: Page,
    switches: Switches,
    overrides: Overrides,
    frames: Frames,
    dress: Dress,
    memory: Memory,
    programs: Arc<Programs>,
    current: u32,
    place: Place,
    alarms: Alarms,
    calendar: calendar::Calendar,
    message: Message,
    /// Why a command of the last tick was refused, if one was.
    refused: Option<Said>,
    waiting_for: Option<Said>,
    screens: Arc<Screens>,
    directory: Arc<Vec<DirectoryRow>>,
    effects: Vec<Effect>,
    outputs: OutputImage,
    output_set: OutputSet,
    /// Outputs without a port of their own: they cannot be switched.
    dead_outputs: OutputSet,
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
    gauge_found: gauge::Found,
    parts: u32,
    cycle_time: Micros,
    /// Blocks executed since power-on.
    blocks: u64,
    screen_heard: Option<Micros>,
    /// Tick time, as read at power-on (P58).
    tick: Micros,
    /// Pressed limit switches: two bits per axis, plus then minus.
    limits: u8,
    /// Modal state kept from one MDI line to the next.
    mdi_modals: Option<Modals>,
    pages: Pages,
    edits: edits::Edits,
    files: files::Files,
    lathe: turning::Lathe,
    teach: teach::Teach,
    /// Remaining automatic repetitions of the program (P390).
    runs_left: u32,
}

impl Controller {
    /// A control at power-on.
    #[must_use]
    pub fn new(kind: Kind, retained: Retained, image: InputImage, now: Micros) -> Self {
        let row = crate::machine::kind::find(kind);
        let params = retained.params;
        let mut control = Self {
            kind,
            row,
            now,
            image,
            filter: Filter::new(&params, image.terminals),
            inputs: InputSet::NONE,
            raw: InputSet::NONE,
            last_inputs: InputSet::NONE,
            machine: Machine::new(row, now),
            axes: Axes::new(&params, row, &image, retained.screws),
            hand: Hand::default(),
            oscillation: None,
            phase: Phase::Idle,
            run: None,
            retract: retract::Retract::default(),
            restart: None,
            kept: restart::Kept::new(retained.interrupted),
            mode: Mode::Manual,
            page: Page::Position,
            switches: Switches::default(),
            overrides: Overrides { feed: 100, rapid: 100, spindle: 100 },
            frames: retained.frames,
            dress: Dress::new(retained.dress_points),
            memory: retained.variables,
            programs: Arc::default(),
            current: retained.current_program,
            place: Place::default(),
            alarms: Alarms::new(retained.alarms),
            calendar: calendar::Calendar::new(retained.clock_offset_s),
            message: Message::default(),
            refused: None,
            waiting_for: None,
            screens: Arc::default(),
            directory: Arc::default(),
            effects: Vec::with_capacity(EFFECTS),
            outputs: OutputImage::default(),
            output_set: OutputSet::NONE,
            dead_outputs: OutputSet::NONE,
            soft_e_stop: false,
            drives_on: true,
            wheel_speed: (params.get(param::WHEEL_RPM), SpeedMode::Rpm),
            wheel_rpm_limit: None,
            timer_offset: [0.0; 2],
            analog_2_rpm: 0.0,
            relative_zero: PerAxis::default(),
            skip_position: PerAxis::default(),
            gauge_found: gauge::Found::default(),
            parts: retained.parts,
            cycle_time: Micros::ZERO,
            blocks: 0,
            screen_heard: None,
            tick: Micros(params.get(param::TICK_TIME) as u64),
            limits: 0,
            mdi_modals: None,
            pages: Pages::new(kind, &params),
            edits: edits::Edits::default(),
            files: files::Files::default(),
            lathe: turning::Lathe::default(),
            teach: teach::Teach::default(),
            runs_left: 0,
            params,
        };
        control.find_dead_outputs();
        control.tell_interrupted();
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
        self.alarms.at(now, self.calendar.stamp(now));
        self.read_inputs(image);
        self.refused = None;
        for command in commands {
            self.take(command);
        }
        let refused = self.refused.take();
        self.watch();
        self.step_restart();
        self.step_run();
        self.keep_place();
        self.step_hand();
        self.step_oscillation();
        let rate = self.rate();
        self.axes.tick(rate, self.lathe.spindle.turns);
        self.step_teach();
        self.settle();
        self.write_outputs();
        self.keep_alarms();
        self.refused = refused; // later refusals in this tick do not answer a command
        &self.outputs
    }

    fn read_inputs(&mut self, image: &InputImage) {
        self.image = *image;
        self.raw = self.filter.unfiltered(image.terminals);
        self.inputs = self.filter.tick(image.terminals);
        // The emergency stop acts at its first edge; only its release is debounced.
        if self.soft_e_stop || self.raw.has(Input::EmergencyStop) {
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
    pub fn deliver_programs(&mut self, programs: Arc<Programs>, directory: Arc<Vec<DirectoryRow>>) {
        self.restart = None;
        self.programs = programs;
        self.directory = directory;
    }

    /// Raises an alarm detected outside the core (damaged data, late ticks).
    pub fn report(&mut self, number: u16, detail: Option<Said>) {
        self.raise(number, detail);
    }

    /// Moves the pending disk requests to `out`.
    pub fn drain_effects(&mut self, out: &mut Vec<Effect>) {
        out.append(&mut self.effects);
    }

    fn say(&mut self, text: impl Into<Said>) {
        self.message = Message { text: text.into(), tone: Tone::Note, since: self.now };
    }

    /// Refuses a command and shows the reason.
    fn refuse(&mut self, text: impl Into<Said>) {
        self.warn(text);
        self.refused = Some(self.message.text.clone());
    }

    /// Shows a warning that no command caused.
    fn warn(&mut self, text: impl Into<Said>) {
        self.message = Message { text: text.into(), tone: Tone::Refused, since: self.now };
    }

    /// Why a command of the last tick was refused; `None` if all were executed.
    #[must_use]
    pub const fn refusal(&self) -> Option<&Said> {
        self.refused.as_ref()
    }

    /// Changes a parameter on behalf of the control and stores it.
    fn keep_param(&mut self, at: ParamAddress, value: f64) {
        if self.params.write(at, value).is_ok() {
            self.pages.show(&self.params);
            self.effects.push(Effect::Param(at, value));
        }
    }

    fn set_param(&mut self, at: ParamAddress, value: f64) {
        if self.run.is_some() {
            return self.refuse(Said::new("运行中不能修改参数", "parameters are not changed while a program runs"));
        }
        if self.is_in_use(at, value) {
            return self.refuse(Said::new(
                format!("{at}：该功能正在工作，先关闭再修改"),
                format!("{at}: the function is on; switch it off before this is changed"),
            ));
        }
        match self.params.write(at, value) {
            Ok(()) => {
                self.effects.push(Effect::Param(at, value));
                self.pages.show(&self.params);
                self.filter.configure(&self.params);
                self.axes.configure(&self.params);
                self.find_dead_outputs();
                self.say(Said::new(format!("{at} = {value}"), format!("{at} = {value}")));
            }
            Err(error) => self.refuse(Said::new(error.zh(), error.to_string())),
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
        let of = |output: &Output| output.port_param() == at.number && output.is_of(self.kind);
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
    fn work(&self) -> PerAxis<f64> {
        self.frames.work_from_machine(self.axes.actual())
    }

    /// Workpiece speed, rpm; 0 while the drive is off.
    fn drive_rpm(&self) -> f64 {
        if !self.machine.drive_is_on() {
            0.0
        } else if self.analog_2_rpm > 0.0 {
            self.analog_2_rpm
        } else if self.output_set.has(self.row.drive_high) {
            self.params.get(param::HEADSTOCK_RPM_HIGH)
        } else {
            self.params.get(param::HEADSTOCK_RPM_LOW)
        }
    }
}
