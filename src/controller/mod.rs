//! The controller: one call a tick, in a fixed order; time, inputs and commands are arguments.
//!
//! The way through [`Controller::tick`]: inputs (filter, encoders) → commands → machine logic and its alarms → program
//! (acts, feeding, reading) → hand and homing → axes → outputs. Nothing in here knows a clock, a file or a thread; the
//! same story gives the same outputs, bit for bit.

mod alarms;
pub mod axes;
mod effect;
mod executor;
mod filter;
mod frames;
mod hand;
mod homing;
mod keys;
mod library;
mod pages;
mod run;
mod status;
mod system;

pub use alarms::Alarms;
pub use effect::Effect;
pub use frames::Frames;
pub use library::{Program, Programs};
pub use system::nc_settings;

use std::sync::Arc;

use crate::defs::alarm::{self, Reaction};
use crate::defs::key::Mode;
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::param::{self, ParamAddress, Params};
use crate::defs::signal::{Input, InputSet, Output, OutputSet};
use crate::defs::text::Said;
use crate::io::{InputImage, OutputImage};
use crate::link::command::{Command, Screens};
use crate::link::snapshot::{DirectoryRow, Message, Tone};
use crate::machine::kind::KindRow;
use crate::machine::{Around, Finding, Machine};
use crate::nc::{Memory, Modals, Place};
use crate::units::{Axis, Micros, PerAxis};
use axes::Axes;
use filter::Filter;
use hand::Hand;
use homing::Homing;
use pages::Pages;
use run::Run;

/// mm/min to mm/s.
const MINUTE_HZ: f64 = 1.0 / axes::MINUTE;
/// Full scale of the analog outputs.
const FULL_SCALE_VOLTS: f64 = 10.0;
/// Most wishes to the disk kept between two calls of [`Controller::drain_effects`].
const EFFECTS: usize = 256;

/// Where the control stands in its work.
#[derive(Debug)]
enum Cycle {
    Idle,
    Running,
    /// Feed hold, still braking.
    Holding,
    /// Feed hold, at rest.
    Held,
    /// M00, M01, a message or the end of a single block.
    Stopped,
    /// Reset or an alarm: braking, then the run is left.
    Aborting,
    /// Homing; the axes still to come after this one.
    Homing {
        now: Homing,
        next: PerAxis<bool>,
    },
}

/// The switches of the panel.
#[derive(Clone, Copy, Debug, Default)]
struct Switches {
    single_block: bool,
    block_skip: bool,
    optional_stop: bool,
}

/// Overrides in percent.
#[derive(Clone, Copy, Debug)]
struct Overrides {
    feed: u16,
    rapid: u16,
    spindle: u16,
}

/// What a control begins with.
#[derive(Clone, Debug)]
pub struct Retained {
    /// Parameters.
    pub params: Params,
    /// Macro variables.
    pub variables: Memory,
    /// Work frames and tool offsets.
    pub frames: Frames,
    /// Number of the current program, 0 none.
    pub current_program: u32,
    /// Workpieces counted.
    pub parts: u32,
}

impl Retained {
    /// A new machine of a kind.
    #[must_use]
    pub fn factory(kind: Kind) -> Self {
        Self {
            params: Params::factory(kind),
            variables: Memory::default(),
            frames: Frames::default(),
            current_program: 0,
            parts: 0,
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
    machine: Machine,
    axes: Axes,
    hand: Hand,
    cycle: Cycle,
    run: Option<Box<Run>>,
    mode: Mode,
    page: Page,
    switches: Switches,
    overrides: Overrides,
    frames: Frames,
    memory: Memory,
    programs: Arc<Programs>,
    current: u32,
    place: Place,
    alarms: Alarms,
    message: Message,
    waiting_for: Option<Said>,
    screens: Arc<Screens>,
    directory: Arc<Vec<DirectoryRow>>,
    effects: Vec<Effect>,
    outputs: OutputImage,
    output_set: OutputSet,
    /// The mushroom on the screen is in.
    soft_e_stop: bool,
    drives_on: bool,
    wheel_rpm: f64,
    analog_2_rpm: f64,
    relative_zero: PerAxis<f64>,
    skip_position: PerAxis<f64>,
    parts: u32,
    cycle_time: Micros,
    /// Blocks executed since power-on.
    blocks: u64,
    screen_heard: Option<Micros>,
    /// Length of a tick: as it was at power-on (P58).
    tick: Micros,
    /// Limit switches pressed, two bits an axis.
    limits: u8,
    /// What is modal in MDI, from line to line.
    mdi_modals: Option<Modals>,
    pages: Pages,
}

impl Controller {
    /// A control at power-on.
    #[must_use]
    pub fn new(kind: Kind, retained: Retained, image: InputImage, now: Micros) -> Self {
        let row = crate::machine::kind::find(kind);
        let params = retained.params;
        Self {
            kind,
            row,
            now,
            image,
            filter: Filter::new(&params, image.terminals),
            inputs: InputSet::NONE,
            raw: InputSet::NONE,
            machine: Machine::new(row, now),
            axes: Axes::new(&params, row, &image),
            hand: Hand::default(),
            cycle: Cycle::Idle,
            run: None,
            mode: Mode::Manual,
            page: Page::Position,
            switches: Switches::default(),
            overrides: Overrides { feed: 100, rapid: 100, spindle: 100 },
            frames: retained.frames,
            memory: retained.variables,
            programs: Arc::default(),
            current: retained.current_program,
            place: Place::default(),
            alarms: Alarms::default(),
            message: Message::default(),
            waiting_for: None,
            screens: Arc::default(),
            directory: Arc::default(),
            effects: Vec::with_capacity(EFFECTS),
            outputs: OutputImage::default(),
            output_set: OutputSet::NONE,
            soft_e_stop: false,
            drives_on: true,
            wheel_rpm: params.get(param::WHEEL_RPM),
            analog_2_rpm: 0.0,
            relative_zero: PerAxis::default(),
            skip_position: PerAxis::default(),
            parts: retained.parts,
            cycle_time: Micros::ZERO,
            blocks: 0,
            screen_heard: None,
            tick: Micros(params.get(param::TICK_TIME) as u64),
            limits: 0,
            mdi_modals: None,
            pages: Pages::new(kind, &params),
            params,
        }
    }

    /// Puts the control where a headless run begins (tools.md T3): homed with the encoders' zero at `encoder_zero_mm`
    /// machine coordinates, hydraulics on, part clamped.
    pub fn make_ready(&mut self, encoder_zero_mm: PerAxis<f64>) {
        for axis in Axis::ALL {
            let at = self.axes.actual()[axis];
            self.axes.set_zero(axis, at, self.image.encoder_mm[axis] + encoder_zero_mm[axis], &self.params);
        }
        self.machine.make_ready(&self.params);
        self.mode = Mode::Auto;
    }

    /// One tick. `now` grows by the tick time from call to call.
    pub fn tick(&mut self, now: Micros, image: &InputImage, commands: &[Command]) -> &OutputImage {
        self.now = now;
        self.alarms.at(now);
        self.read_inputs(image);
        for command in commands {
            self.take(command);
        }
        self.watch();
        self.step_run();
        self.step_hand();
        let rate = self.rate();
        self.axes.tick(rate);
        self.settle();
        self.write_outputs();
        &self.outputs
    }

    fn read_inputs(&mut self, image: &InputImage) {
        self.image = *image;
        self.raw = self.filter.unfiltered(image.terminals);
        self.inputs = self.filter.tick(image.terminals);
        if self.soft_e_stop {
            self.inputs.set(Input::EmergencyStop, true);
        }
        self.axes.read(image);
        if image.handwheel_detents != 0 {
            self.turn_handwheel(image.handwheel_detents);
        }
    }

    /// Machine logic, and what the control watches itself.
    fn watch(&mut self) {
        let around = Around {
            run_open: self.run.is_some(),
            homed: self.axes.all_homed(),
            alarm_blocks: self.alarms.block_start(),
            drives_off: !self.drives_on,
            oscillating: false,
        };
        for finding in self.machine.tick(self.now, self.inputs, &self.params, around).into_iter().flatten() {
            match finding {
                Finding::Alarm { number, stopped } => {
                    self.raise(number, None);
                    if stopped && alarm::reaction(number) == Reaction::BlockStart {
                        self.abort_run();
                    }
                }
                Finding::Gone(number) => self.alarms.clear(number),
            }
        }
        self.watch_axes();
        self.watch_screen();
    }

    fn watch_axes(&mut self) {
        if !self.image.bus_alive {
            self.raise(alarm::BUS_LOST, None);
        }
        let drives = [Input::DriveX, Input::DriveY, Input::DriveZ];
        let limits = [
            (Input::LimitXPlus, Input::LimitXMinus),
            (Input::LimitYPlus, Input::LimitYMinus),
            (Input::LimitZPlus, Input::LimitZMinus),
        ];
        for axis in self.axes.present() {
            let name = || Some(Said::new(axis.to_string(), axis.to_string()));
            if self.inputs.has(drives[axis as usize]) {
                self.raise(alarm::DRIVE_FAULT, name());
                self.axes.forget_zero();
            }
            let (plus, minus) = limits[axis as usize];
            for (bit, switch) in [(0, plus), (1, minus)] {
                let mask = 1 << (2 * axis as u8 + bit);
                let pressed = self.inputs.has(switch);
                // The edge counts: after RESET the axis must be able to leave the switch.
                if pressed && self.limits & mask == 0 {
                    self.alarms.clear(alarm::HARD_LIMIT);
                    self.raise(alarm::HARD_LIMIT, name());
                    self.axes.forget_zero();
                }
                if pressed { self.limits |= mask } else { self.limits &= !mask }
            }
        }
        if let Some(axis) = self.axes.lost(&self.params)
            && self.drives_on
        {
            self.raise(alarm::FOLLOWING_ERROR, Some(Said::new(axis.to_string(), axis.to_string())));
            self.axes.forget_zero();
        }
    }

    fn watch_screen(&mut self) {
        let silence = Micros::from_millis_f64(self.params.get(param::HMI_KEEP_ALIVE));
        if let Some(heard) = self.screen_heard
            && self.now.since(heard) > silence
        {
            self.raise(alarm::HMI_LOST, None);
            self.screen_heard = None;
        }
    }

    /// Raises an alarm and carries out its reaction.
    fn raise(&mut self, number: u16, detail: Option<Said>) {
        if self.alarms.has(number) {
            return;
        }
        let running = !matches!(self.cycle, Cycle::Idle | Cycle::Homing { .. });
        let place = running.then_some((self.place.program, self.place.line));
        self.alarms.raise(number, detail, self.now, place);
        match alarm::reaction(number) {
            Reaction::Show | Reaction::BlockStart => {}
            Reaction::StopProgram => self.abort_run(),
            Reaction::StopProgramAndWheel => {
                self.machine.stop_wheel_and_drive();
                self.abort_run();
            }
            Reaction::StopAll => {
                self.machine.safe_stop();
                self.abort_run();
                self.drives_on = false;
            }
        }
    }

    /// Brakes whatever moves; the run is left once the axes stand.
    fn abort_run(&mut self) {
        self.hand.let_go();
        self.waiting_for = None;
        match self.cycle {
            Cycle::Idle if self.axes.is_at_rest() => {}
            Cycle::Aborting => {}
            Cycle::Idle | Cycle::Running | Cycle::Holding | Cycle::Held | Cycle::Stopped | Cycle::Homing { .. } => {
                self.axes.brake();
                self.cycle = Cycle::Aborting;
            }
        }
    }

    /// Drives, and the end of braking.
    fn settle(&mut self) {
        let rest = self.axes.is_at_rest();
        match self.cycle {
            Cycle::Holding if rest => self.cycle = Cycle::Held,
            Cycle::Aborting if rest => {
                self.close_run();
                self.cycle = Cycle::Idle;
            }
            Cycle::Idle
            | Cycle::Running
            | Cycle::Holding
            | Cycle::Held
            | Cycle::Stopped
            | Cycle::Aborting
            | Cycle::Homing { .. } => {}
        }
        self.axes.set_drives(self.drives_on);
        if !self.drives_on && rest {
            self.axes.follow_actual();
        }
    }

    /// Leaves the run: what was read ahead and not executed is forgotten.
    fn close_run(&mut self) {
        if let Some(run) = self.run.take() {
            self.cycle_time = self.now.since(run.since);
            self.mdi_modals = run.mdi.then(|| *run.interpreter.modals());
        }
        self.waiting_for = None;
        self.axes.give_to_hand();
    }

    fn write_outputs(&mut self) {
        let mut on = self.machine.outputs();
        on.set(Output::TowerRed, self.alarms.block_start());
        on.set(Output::TowerGreen, matches!(self.cycle, Cycle::Running | Cycle::Homing { .. }));
        let waits = matches!(self.cycle, Cycle::Holding | Cycle::Held | Cycle::Stopped);
        on.set(Output::TowerYellow, waits);
        self.output_set = on;
        self.outputs.terminals = crate::defs::signal::Terminals::default();
        for output in on.iter() {
            self.outputs.terminals.set(self.params.output_port(output), true);
        }
        let volts = |rpm: f64, most: f64| (FULL_SCALE_VOLTS * rpm / most).clamp(0.0, FULL_SCALE_VOLTS);
        let wheel = self.wheel_rpm * f64::from(self.overrides.spindle) / 100.0;
        let wheel = if on.has(Output::Wheel) { wheel } else { 0.0 };
        self.outputs.wheel_volts = volts(wheel, self.params.get(param::WHEEL_RPM_MAX));
        let drive = if self.machine.drive_is_on() { self.analog_2_rpm } else { 0.0 };
        self.outputs.analog_2_volts = volts(drive, self.params.get(param::ANALOG_2_RPM_MAX));
        // Braking needs the drives; nothing else moves without them.
        self.outputs.drives_on = self.drives_on || matches!(self.cycle, Cycle::Aborting);
        self.outputs.set_point_mm = self.axes.set_points(&self.params);
    }

    /// The terminals that stay as they are in the safe output image: what clamps, lubricates or shows. What turns or
    /// flows is off (table after K3).
    #[must_use]
    pub fn kept_when_safe(&self) -> crate::defs::signal::Terminals {
        let mut kept = crate::defs::signal::Terminals::default();
        for output in crate::machine::KEPT_WHEN_SAFE {
            kept.set(self.params.output_port(*output), true);
        }
        kept
    }

    /// Other programs are in the folder.
    pub fn deliver_programs(&mut self, programs: Arc<Programs>, directory: Arc<Vec<DirectoryRow>>) {
        self.programs = programs;
        self.directory = directory;
    }

    /// Raises an alarm that was found outside the core (damaged data, late ticks).
    pub fn report(&mut self, number: u16, detail: Option<Said>) {
        self.raise(number, detail);
    }

    /// Hands over what the disk is to keep.
    pub fn drain_effects(&mut self, out: &mut Vec<Effect>) {
        out.append(&mut self.effects);
    }

    fn say(&mut self, text: impl Into<Said>) {
        self.message = Message { text: text.into(), tone: Tone::Note, since: self.now };
    }

    fn refuse(&mut self, text: impl Into<Said>) {
        self.message = Message { text: text.into(), tone: Tone::Refused, since: self.now };
    }

    fn set_param(&mut self, at: ParamAddress, value: f64) {
        if self.run.is_some() {
            return self.refuse(Said::new("运行中不能修改参数", "parameters are not changed while a program runs"));
        }
        match self.params.write(at, value) {
            Ok(()) => {
                self.effects.push(Effect::Param(at, value));
                self.pages.show(&self.params);
                self.filter.configure(&self.params);
                self.axes.configure(&self.params);
                self.say(Said::new(format!("{at} = {value}"), format!("{at} = {value}")));
            }
            Err(error) => self.refuse(Said::new(format!("{at} 超出范围或不存在：{error}"), error.to_string())),
        }
    }

    /// X is programmed and shown as a diameter.
    fn is_diameter(&self) -> bool {
        !self.params.bit(param::RADIUS_PROGRAMMING)
    }

    /// How many displayed millimetres a millimetre of slide travel is.
    fn displayed_per_mm(&self, axis: Axis) -> f64 {
        if axis == Axis::X && self.is_diameter() { 2.0 } else { 1.0 }
    }

    /// The work position, radius mm.
    fn work(&self) -> PerAxis<f64> {
        self.frames.work_from_machine(self.axes.actual())
    }

    /// Speed of the workpiece, rpm.
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
