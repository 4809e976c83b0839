//! The machine's units (wheel, workpiece drive, clamping, hydraulics, fluids, gauges) and the interlocks between them.
//!
//! Owns the state of all units; knows neither program nor axes. Every change is a request ([`Machine::ask`]) that the
//! interlock table grants or refuses. [`press`] maps keys to requests, [`phase`] is the state machine of a run.
//! Source: spec K3, K5.

mod cylinder;
pub mod discrete;
mod fluids;
mod gauge;
mod hydraulic;
pub mod interlock;
pub mod kind;
mod magnet;
pub mod phase;
mod ports;
pub mod press;
pub mod rules;
mod stroke;
mod tailstock;
pub(crate) mod turning;
mod units;
mod wheel;

use crate::defs::alarm::{self, Reaction};
use crate::defs::mcode::Request;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet, Output, OutputSet, Terminals};
use crate::defs::text::{Said, Text};
use crate::units::Micros;
use cylinder::Cylinder;
use fluids::Fluids;
use gauge::{Arms, Gears};
use hydraulic::Hydraulic;
use interlock::{Facts, Outcome, Rule};
use kind::KindRow;
use magnet::Magnet;
use ports::{Owner, Ports};
use rules::RULES;
use tailstock::Tailstock;
use turning::{MainSpindle, Post};
use wheel::{Drive, SecondSpindle, Wheel};

/// Result of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Granted: done or in progress until [`Machine::is_settled`].
    Taken,
    /// Ignored with a message; the program continues.
    NoEffect(Text),
    /// Refused with a message; a program waits before the block.
    Denied(Text),
    /// Refused with an alarm: number, reason.
    Refused(u16, Text),
}

/// State of the control that the machine logic needs, updated each tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Around {
    /// A program or an MDI line is open, including held ones.
    pub run_open: bool,
    /// Every axis is homed, or the kind needs no homing to start a program.
    pub homed: bool,
    /// An alarm that blocks cycle start is active.
    pub alarm_blocks: bool,
    /// The drives are off after a stop-all alarm.
    pub drives_off: bool,
    /// An axis oscillates by servo while no run is open.
    pub oscillating: bool,
    /// Machine lock is on.
    pub machine_lock: bool,
    /// Dry run is on.
    pub dry_run: bool,
    /// The current program is a dressing program (P91 to P92).
    pub dressing: bool,
    /// Commanded speed of the wheel, rpm.
    pub wheel_rpm: f64,
}

/// Something that the machine logic detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// An alarm condition occurred.
    Alarm {
        /// Its number.
        number: u16,
        /// Whether it ends the run and stops the wheel.
        stopped: bool,
    },
    /// A self-clearing alarm's condition is gone.
    Gone(u16),
    /// A unit was switched off without a request and without an alarm: the reason.
    Told(Text),
}

/// Effect of an alarm on the run and the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Consequence {
    /// Nothing beyond the alarm.
    Nothing,
    /// The run is held.
    Hold,
    /// The run ends; spindles and fluids stay on.
    Abort,
    /// The run ends; wheel and workpiece drive stop.
    AbortAndStop,
    /// The run ends; outputs go to the safe state, drives off.
    AbortAndMakeSafe,
}

impl Consequence {
    /// The consequence of an alarm. `stopped`: the machine logic has stopped a unit for it, so the run ends too.
    #[must_use]
    pub fn of(number: u16, stopped: bool) -> Self {
        match alarm::reaction(number) {
            Reaction::BlockStart if stopped => Self::Abort,
            Reaction::Show | Reaction::BlockStart => Self::Nothing,
            Reaction::HoldProgram => Self::Hold,
            Reaction::StopProgram => Self::Abort,
            Reaction::StopProgramAndWheel => Self::AbortAndStop,
            Reaction::StopAll => Self::AbortAndMakeSafe,
        }
    }
}

/// The guard door, if the machine has one (P332).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Guard {
    open: bool,
    /// Its alarm is active: it was opened in a run.
    alarm: bool,
    /// It stopped the workpiece drive of a run that is still open.
    stopped_drive: bool,
}

/// All units of one machine.
#[derive(Clone, Debug)]
pub struct Machine {
    row: &'static KindRow,
    rules: &'static [Rule],
    wheel: Wheel,
    drive: Drive,
    second_spindle: SecondSpindle,
    tailstock: Tailstock,
    magnet: Magnet,
    hydraulic: Hydraulic,
    cylinder: Cylinder,
    /// #438 and #439 of the cylinder.
    cylinder_flags: (bool, bool),
    fluids: Fluids,
    /// Start of the last lubrication interval.
    last_dose: Micros,
    arms: Arms,
    gears: Gears,
    spindle: MainSpindle,
    post: Post,
    /// The last tick, for pulses.
    now: Micros,
    user: OutputSet,
    ports: Ports,
    guard: Guard,
    e_stop: bool,
    around: Around,
}

/// Outputs that emergency stop, panic, loss of screen or loss of bus switch off in that tick. All others keep their
/// state: the part must stay clamped while the wheel coasts (table after K3).
pub const OFF_WHEN_SAFE: &[Output] = &[
    Output::Wheel,
    Output::SecondSpindle,
    Output::SecondSpindleCcw,
    Output::HeadstockHigh,
    Output::HeadstockLow,
    Output::DresserRoll,
    Output::TableRotation,
    Output::Coolant,
    Output::OscillationForward,
    Output::OscillationBackward,
    Output::SpindleForward,
    Output::SpindleReverse,
    Output::PostForward,
    Output::PostReverse,
];

const GUARD_STOPPED: Text =
    Text::new("防护门打开，头架/滚轮/台面已停", "the guard is open: headstock, roll or table stopped");

/// Maximum findings per tick.
pub const FINDINGS: usize = 11;
/// Findings of one tick.
pub type Findings = [Option<Finding>; FINDINGS];

impl Machine {
    /// A machine at power-on: everything off.
    #[must_use]
    pub fn new(row: &'static KindRow, now: Micros) -> Self {
        Self::governed_by(RULES, row, now)
    }

    /// The same with another rule table, for tests that search for the use of each rule.
    #[must_use]
    pub fn governed_by(rules: &'static [Rule], row: &'static KindRow, now: Micros) -> Self {
        Self {
            row,
            rules,
            wheel: Wheel::Off,
            drive: Drive::Off,
            second_spindle: SecondSpindle::Off,
            tailstock: Tailstock::Resting,
            magnet: Magnet::Off,
            hydraulic: Hydraulic::new(now),
            cylinder: Cylinder::Off,
            cylinder_flags: (false, false),
            fluids: Fluids::default(),
            last_dose: now,
            arms: Arms::default(),
            gears: Gears::default(),
            spindle: MainSpindle::Off,
            post: Post::Standing,
            now,
            user: OutputSet::NONE,
            ports: Ports::default(),
            guard: Guard::default(),
            e_stop: false,
            around: Around::default(),
        }
    }

    /// Prepares a headless run (tools.md T3): hydraulics on and settled, part clamped.
    pub fn make_ready(&mut self, params: &Params) {
        if !self.row.turns_part {
            self.hydraulic.make_ready();
        }
        if params.bit(param::TAILSTOCK_ENABLED) && self.row.tailstock {
            self.tailstock = Tailstock::Holding;
        }
        if params.bit(param::MAGNET_ENABLED) && self.row.magnet {
            self.magnet = Magnet::Holding;
        }
    }

    /// Updates the control state within a tick.
    pub const fn inform(&mut self, around: Around) {
        self.around = around;
    }

    /// The inputs of the interlock rules.
    #[must_use]
    pub fn facts(&self, now: Micros, inputs: InputSet, params: &Params) -> Facts {
        let supervised = !params.bit(param::NO_HYDRAULIC_CHECK);
        let rim_m_s = std::f64::consts::PI * params.get(param::WHEEL_DIAMETER) * self.around.wheel_rpm / 60_000.0;
        Facts {
            e_stop: self.e_stop,
            wheel_on: self.wheel.is_on(),
            wheel_too_fast: rim_m_s > params.get(param::WHEEL_RATED_SPEED),
            wheel_undressed: params.bit(param::WHEEL_UNDRESSED),
            drive_on: self.drive.is_on(),
            drive_carries_part: self.row.drive_needs_magnet,
            drive_stopped_by_guard: self.guard.stopped_drive,
            tailstock_on_kind: self.row.tailstock,
            tailstock_enabled: params.bit(param::TAILSTOCK_ENABLED) && self.row.tailstock,
            tailstock_moving: self.tailstock.is_moving(),
            tailstock_lost: self.tailstock.is_lost(),
            tailstock_needed: params.bit(param::TAILSTOCK_BEFORE_HEADSTOCK),
            tailstock_advanced: self.tailstock.is_advanced(),
            hydraulic_needed: supervised,
            hydraulic_checked: supervised && params.get(param::HYDRAULIC_DELAY) > 0.0,
            hydraulic_on: self.hydraulic.is_on(),
            hydraulic_latched: self.hydraulic.is_latched(),
            hydraulic_settled: self.hydraulic.is_settled(now, params),
            pressure: inputs.has(Input::HydraulicPressure),
            magnet_on_kind: self.row.magnet || params.bit(param::MAGNET_ENABLED),
            magnet_enabled: params.bit(param::MAGNET_ENABLED),
            magnet_needed: params.bit(param::WHEEL_NEEDS_MAGNET),
            magnetised: self.magnet.is_holding(),
            cylinder_on: self.cylinder.is_on(),
            turns_part: self.row.turns_part,
            post_moving: self.post.is_moving(),
            guard_open: params.input_port(Input::GuardClosed) != 0 && !inputs.has(Input::GuardClosed),
            external_hold: inputs.has(Input::ExternalHold),
            port_owned: false,
            port_missing: false,
            port_conflict: false,
            around: self.around,
        }
    }

    /// The first rule that forbids a request now, if any.
    #[must_use]
    pub fn forbidding(
        &self,
        request: Request,
        now: Micros,
        inputs: InputSet,
        params: &Params,
    ) -> Option<&'static Rule> {
        let mut facts = self.facts(now, inputs, params);
        let output = self.output_of(request);
        facts.port_missing = output.is_some_and(|output| params.output_port(output) == 0);
        facts.port_conflict = output.is_some_and(|output| params.output_conflict(self.row.kind, output).is_some());
        if let Request::Port(port, _) | Request::Pulse(port, _) = request {
            facts.port_owned = matches!(ports::owner(port, params, self.row.kind), Owner::Interlocked(_));
        }
        interlock::forbidding(self.rules, request, &facts)
    }

    /// The reason of a rule; for requests by port number with the port and the function that owns it.
    #[must_use]
    pub fn reason(&self, reason: Text, request: Request, params: &Params) -> Said {
        let (Request::Port(port, _) | Request::Pulse(port, _)) = request else { return reason.into() };
        let Owner::Interlocked(output) = ports::owner(port, params, self.row.kind) else { return reason.into() };
        let name = output.name();
        Said::new(
            format!("{} (输出口 {port}：{})", reason.zh, name.zh),
            format!("{} (port {port}: {})", reason.en, name.en),
        )
    }

    /// Requests a change. The interlock table decides; a refused request changes nothing.
    pub fn ask(&mut self, request: Request, now: Micros, inputs: InputSet, params: &Params) -> Answer {
        if let Some(rule) = self.forbidding(request, now, inputs, params) {
            return match rule.outcome {
                Outcome::NoEffect => Answer::NoEffect(rule.reason),
                Outcome::Deny => Answer::Denied(rule.reason),
                Outcome::Alarm(number) => {
                    if number == alarm::HYDRAULIC {
                        self.hydraulic.note_refused_start();
                    }
                    Answer::Refused(number, rule.reason)
                }
            };
        }
        self.carry_out(request, now, inputs, params)
    }

    /// One tick: delays, feedback and supervision of all units.
    pub fn tick(&mut self, now: Micros, inputs: InputSet, params: &Params, around: Around) -> Findings {
        self.around = around;
        self.now = now;
        let e_stop = inputs.has(Input::EmergencyStop);
        let pressed = e_stop && !self.e_stop;
        self.e_stop = e_stop;
        if e_stop {
            self.safe_stop();
        }
        self.wheel.tick(now, params);
        self.drive.tick(now, params);
        self.second_spindle.tick(now, params);
        self.spindle.tick(now, params);
        self.magnet.tick(now, params);
        self.ports.tick(now);
        let hydraulic = self.hydraulic.supervise(now, inputs, params, self.wheel.is_on(), around.run_open);
        if let Some(Finding::Alarm { stopped: true, .. }) = hydraulic {
            self.wheel = Wheel::Off; // K3.7: in the tick of the filtered edge
        }
        let alarm = |number| Finding::Alarm { number, stopped: true };
        let pressed = pressed.then(|| alarm(alarm::EMERGENCY_STOP));
        let tailstock = self.tailstock.watch(now, inputs, params);
        if tailstock == Some(alarm::TAILSTOCK_LOST) {
            self.drive = Drive::Off; // the part may come loose
        }
        let tailstock = tailstock.map(alarm);
        let [radial, axial] = self.arms.watch(now, inputs, params).map(|late| late.map(alarm));
        let gears = self.gears.watch(now, inputs, params).map(alarm);
        let [flow, level] = self.fluids.tick(now, inputs, params, &mut self.last_dose);
        let cylinder = self.cylinder.tick(now, inputs, params, &mut self.cylinder_flags).map(alarm);
        let guard = self.watch_guard(inputs, params);
        let post = self.post.watch(now, inputs, params).map(alarm);
        [pressed, hydraulic, tailstock, radial, axial, gears, cylinder, flow, level, guard, post]
    }

    /// K5.13: an open guard stops the workpiece drive; opening it in a run also holds the program.
    fn watch_guard(&mut self, inputs: InputSet, params: &Params) -> Option<Finding> {
        let (was_open, mut stopped) = (self.guard.open, false);
        self.guard.open = params.input_port(Input::GuardClosed) != 0 && !inputs.has(Input::GuardClosed);
        if self.guard.open && self.drive.is_on() {
            self.drive = Drive::Off;
            self.guard.stopped_drive = self.around.run_open;
            stopped = true;
        }
        self.guard.stopped_drive &= self.around.run_open && !self.drive.is_on();
        match (self.guard.open, self.guard.alarm) {
            (true, false) if !was_open && self.around.run_open => {
                self.guard.alarm = true;
                Some(Finding::Alarm { number: alarm::GUARD_OPEN, stopped: false })
            }
            (false, true) => {
                self.guard.alarm = false;
                Some(Finding::Gone(alarm::GUARD_OPEN))
            }
            (true | false, true | false) => stopped.then_some(Finding::Told(GUARD_STOPPED)),
        }
    }

    /// E-stop, panic, lost HMI or bus: spindles and fluids off, clamps hold (table after K3).
    pub fn safe_stop(&mut self) {
        self.wheel = Wheel::Off;
        self.drive = Drive::Off;
        self.second_spindle = SecondSpindle::Off;
        self.stop_turning();
        self.fluids.coolant = false;
        self.cylinder = Cylinder::Off;
        self.ports.end_pulses();
    }

    /// Reset: workpiece drive and oscillation stop; wheel, fluids, hydraulics and clamping stay (table after K3).
    pub fn reset(&mut self) {
        self.drive = Drive::Off;
        self.cylinder = Cylinder::Off;
        self.stop_turning();
        self.ports.end_pulses();
        self.hydraulic.acknowledge();
    }

    /// Alarm reaction: stops wheel, workpiece drive and lathe units.
    pub fn stop_wheel_and_drive(&mut self) {
        self.wheel = Wheel::Off;
        self.drive = Drive::Off;
        self.stop_turning();
    }

    /// M30 (K3.14): coolant and workpiece drive off; wheel and second spindle too, unless P17.2 keeps them running.
    pub fn program_end(&mut self, params: &Params) {
        self.fluids.coolant = false;
        self.drive = Drive::Off;
        self.stop_turning();
        if !params.bit(param::WHEEL_RUNS_AFTER_M30) {
            self.wheel = Wheel::Off;
            self.second_spindle = SecondSpindle::Off;
        }
    }

    /// Stops the main spindle by its pulse, and a turning tool post.
    fn stop_turning(&mut self) {
        if self.spindle.direction().is_some() {
            self.spindle.stop(self.now);
        }
        self.post = Post::Standing;
    }

    /// Direction of the main spindle, true counter-clockwise; `None` while it is off.
    #[must_use]
    pub const fn spindle_direction(&self) -> Option<bool> {
        self.spindle.direction()
    }

    /// Whether the tool post is indexing.
    #[must_use]
    pub const fn post_is_moving(&self) -> bool {
        self.post.is_moving()
    }

    /// Ports switched by number by programs.
    #[must_use]
    pub const fn port_terminals(&self) -> Terminals {
        self.ports.terminals()
    }

    /// Whether the oscillation cylinder is running.
    #[must_use]
    pub fn cylinder_is_on(&self) -> bool {
        self.cylinder.is_on()
    }

    /// #438 and #439 of the cylinder: at the forward end, at the backward end.
    #[must_use]
    pub const fn cylinder_flags(&self) -> (bool, bool) {
        self.cylinder_flags
    }

    /// Whether headstock, roll or table is switched on.
    #[must_use]
    pub fn drive_is_on(&self) -> bool {
        self.drive.is_on()
    }

    /// Whether the emergency stop is pressed.
    #[must_use]
    pub const fn is_e_stopped(&self) -> bool {
        self.e_stop
    }
}
