//! The machine's units (wheel, workpiece drive, clamping, hydraulics, fluids, gauges) and the interlocks between them.
//!
//! Owns the state of all units; knows neither program nor axes. Every change is a request ([`Machine::request`]) that the
//! interlock table grants or refuses. [`panel_key`] maps keys to requests, [`phase`] is the state machine of a run.
//! Source: spec K3, K5.

mod actuation;
mod cylinder;
pub mod discrete;
mod fluids;
mod gauge_arms;
mod hydraulic;
pub mod interlock;
pub(crate) mod lathe;
mod magnetic_chuck;
pub mod panel_key;
pub mod phase;
mod ports;
pub mod rules;
mod tailstock;
mod two_position_actuator;
mod wheel;

use crate::defs::alarm::{self, Reaction};
use crate::defs::equipment::Equipment;
use crate::defs::kind::Kind;
use crate::defs::mcode::Request;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet, Output, OutputSet, Terminals};
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::units::Micros;
use cylinder::Cylinder;
use fluids::Fluids;
use gauge_arms::{GaugeArms, GearBox};
use hydraulic::Hydraulic;
use interlock::{InterlockInputs, Rule, RuleOutcome};
use lathe::{MainSpindle, ToolTurret};
use magnetic_chuck::MagneticChuck;
use ports::{PortOwner, Ports};
use rules::RULES;
use tailstock::Tailstock;
use wheel::{SecondSpindleContactor, WheelContactor, WorkpieceDrive};

/// Result of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestResult {
    /// Granted: done or in progress until [`Machine::is_settled`].
    Accepted,
    /// Ignored with a message; the program continues.
    NoEffect(Text),
    /// Refused with a message; a program waits before the block.
    Denied(Text),
    /// Refused with an alarm: number, reason.
    Alarm(u16, &'static Text),
}

/// State of the control that the machine logic needs, updated each tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ControlState {
    /// A program or an MDI line is open, including held ones.
    pub run_open: bool,
    /// Every axis is homed, or the kind needs no homing to start a program.
    pub homed: bool,
    /// An alarm that blocks cycle start is active.
    pub alarm_blocks: bool,
    /// The drives are off after a stop-all alarm.
    pub drives_off: bool,
    /// The drives are to be on, and not every one follows yet.
    pub drives_switching: bool,
    /// An axis oscillates by servo while no run is open; in an open run, by the key.
    pub oscillating: bool,
    /// Machine lock is on.
    pub machine_lock: bool,
    /// Dry run is on.
    pub dry_run: bool,
    /// The current program is a dressing program (P91 to P92).
    pub dressing_program: bool,
    /// The current program or one that it calls starts the wheel.
    pub starts_wheel: bool,
    /// Commanded speed of the wheel, rpm.
    pub wheel_rpm: f64,
}

/// Something that the machine logic detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MachineFinding {
    /// An alarm condition occurred.
    Alarm {
        /// Its number.
        number: u16,
        /// Whether it ends the run and stops the wheel.
        stopped: bool,
        /// What is so, where the text of the table says more than that.
        title: Option<Text>,
    },
    /// A self-clearing alarm's condition is gone.
    Cleared(u16),
    /// A unit was switched off without a request and without an alarm: the reason.
    Message(Text),
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
            Reaction::BlockWheel | Reaction::BlockStart if stopped => Self::Abort,
            Reaction::Show | Reaction::BlockWheel | Reaction::BlockStart => Self::Nothing,
            Reaction::HoldProgram => Self::Hold,
            Reaction::StopProgram => Self::Abort,
            Reaction::StopProgramAndWheel => Self::AbortAndStop,
            Reaction::StopAll => Self::AbortAndMakeSafe,
        }
    }
}

/// The guard door, if the machine has one (P332).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct GuardDoor {
    open: bool,
    /// Its alarm is active: it was opened in a run.
    alarm: bool,
    /// It stopped the workpiece drive of a run that is still open.
    stopped_drive: bool,
}

/// All units of one machine.
#[derive(Clone, Debug)]
pub struct Machine {
    kind: Kind,
    rules: &'static [Rule],
    wheel: WheelContactor,
    workpiece_drive: WorkpieceDrive,
    second_spindle: SecondSpindleContactor,
    tailstock: Tailstock,
    magnet: MagneticChuck,
    hydraulic: Hydraulic,
    cylinder: Cylinder,
    /// #438 and #439 of the cylinder.
    cylinder_flags: (bool, bool),
    fluids: Fluids,
    /// Start of the last lubrication interval.
    last_lubrication: Micros,
    gauge_arms: GaugeArms,
    gears: GearBox,
    main_spindle: MainSpindle,
    turret: ToolTurret,
    /// The last tick, for pulses.
    now: Micros,
    user_outputs: OutputSet,
    ports: Ports,
    guard: GuardDoor,
    e_stop: bool,
    control_state: ControlState,
}

/// Outputs that a panic, loss of screen or loss of bus switch off in that tick; in an emergency stop
/// [`Machine::safe_stop`] and the guards of the motions switch off the same. All others keep their state: the part must
/// stay clamped while the wheel coasts (table after K3).
pub const OFF_IN_SAFE_STATE: &[Output] = &[
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
    Output::TurretForward,
    Output::TurretReverse,
];

const GUARD_STOPPED: Text =
    Text::new("防护门打开，头架/滚轮/台面已停", "the guard is open: headstock, roll or table stopped");

/// Maximum findings per tick.
pub const MAX_FINDINGS: usize = 11;
/// Findings of one tick.
pub type Findings = [Option<MachineFinding>; MAX_FINDINGS];

impl Machine {
    /// A machine at power-on: everything off.
    #[must_use]
    pub fn new(kind: Kind, now: Micros) -> Self {
        Self::with_rules(RULES, kind, now)
    }

    /// The same with another rule table, for tests that search for the use of each rule.
    #[must_use]
    pub fn with_rules(rules: &'static [Rule], kind: Kind, now: Micros) -> Self {
        Self {
            kind,
            rules,
            wheel: WheelContactor::Off,
            workpiece_drive: WorkpieceDrive::Off,
            second_spindle: SecondSpindleContactor::Off,
            tailstock: Tailstock::Retracted,
            magnet: MagneticChuck::Off,
            hydraulic: Hydraulic::new(now),
            cylinder: Cylinder::Off,
            cylinder_flags: (false, false),
            fluids: Fluids::default(),
            last_lubrication: now,
            gauge_arms: GaugeArms::default(),
            gears: GearBox::default(),
            main_spindle: MainSpindle::Off,
            turret: ToolTurret::Clamped,
            now,
            user_outputs: OutputSet::NONE,
            ports: Ports::default(),
            guard: GuardDoor::default(),
            e_stop: false,
            control_state: ControlState::default(),
        }
    }

    /// Prepares a headless run (tools.md T3): hydraulics on and settled, part clamped.
    pub fn make_ready(&mut self, params: &Params) {
        let row = self.kind.row();
        if !row.is_lathe() {
            self.hydraulic.make_ready();
        }
        if params.bit(param::TAILSTOCK_ENABLED) && row.has(Equipment::Tailstock) {
            self.tailstock = Tailstock::Clamped;
        }
        if params.bit(param::MAGNET_ENABLED) && params.fitted().has(Equipment::MagneticChuck) {
            self.magnet = MagneticChuck::Holding;
        }
    }

    /// Updates the control state within a tick.
    pub const fn set_control_state(&mut self, state: ControlState) {
        self.control_state = state;
    }

    /// The inputs of the interlock rules.
    #[must_use]
    pub fn interlock_inputs(&self, now: Micros, inputs: InputSet, params: &Params) -> InterlockInputs {
        let row = self.kind.row();
        let supervised = !params.bit(param::NO_HYDRAULIC_CHECK);
        let rim_m_s =
            std::f64::consts::PI * params.get(param::WHEEL_DIAMETER) * self.control_state.wheel_rpm / 60_000.0;
        InterlockInputs {
            e_stop: self.e_stop,
            wheel_on: self.wheel.is_on(),
            wheel_too_fast: rim_m_s > params.get(param::WHEEL_RATED_SPEED),
            wheel_undressed: params.bit(param::WHEEL_UNDRESSED),
            drive_on: self.workpiece_drive.is_on(),
            drive_carries_part: row.drive_needs_magnet(),
            drive_stopped_by_guard: self.guard.stopped_drive,
            tailstock_on_kind: row.has(Equipment::Tailstock),
            tailstock_enabled: params.bit(param::TAILSTOCK_ENABLED) && row.has(Equipment::Tailstock),
            tailstock_moving: self.tailstock.is_moving(),
            tailstock_lost: self.tailstock.is_lost(),
            tailstock_needed: params.bit(param::TAILSTOCK_BEFORE_HEADSTOCK),
            tailstock_advanced: self.tailstock.is_advanced(),
            hydraulic_needed: supervised,
            hydraulic_checked: supervised && params.get(param::HYDRAULIC_DELAY) > 0.0,
            hydraulic_on: self.hydraulic.is_on(),
            hydraulic_alarm: self.hydraulic.has_alarm(),
            hydraulic_latched: self.hydraulic.is_latched(),
            hydraulic_settled: self.hydraulic.is_settled(now, params),
            pressure: inputs.has(Input::HydraulicPressure),
            magnet_on_kind: params.fitted().has(Equipment::MagneticChuck),
            magnet_enabled: params.bit(param::MAGNET_ENABLED),
            magnet_needed: params.bit(param::WHEEL_NEEDS_MAGNET),
            magnetised: self.magnet.is_holding(),
            cylinder_on: self.cylinder.is_on(),
            has_main_spindle: row.is_lathe(),
            turret_moving: self.turret.is_moving(),
            guard_open: is_guard_open(inputs, params),
            external_hold: inputs.has(Input::ExternalHold),
            control_state: self.control_state,
            ..InterlockInputs::default()
        }
    }

    /// The first rule that forbids a request now, if any.
    #[must_use]
    pub fn blocking_rule(
        &self,
        request: Request,
        now: Micros,
        inputs: InputSet,
        params: &Params,
    ) -> Option<&'static Rule> {
        let inputs = self.inputs_of_request(request, now, inputs, params);
        interlock::first_blocking_rule(self.rules, request, &inputs)
    }

    /// The rules that forbid a request now and check a condition of a cycle start, from the top of the table.
    pub fn unmet_start_rules(
        &self,
        request: Request,
        now: Micros,
        inputs: InputSet,
        params: &Params,
    ) -> impl Iterator<Item = &'static Rule> {
        let inputs = self.inputs_of_request(request, now, inputs, params);
        self.rules.iter().filter(move |rule| rule.step.is_some() && (rule.forbids)(request) && (rule.applies)(&inputs))
    }

    fn inputs_of_request(&self, request: Request, now: Micros, inputs: InputSet, params: &Params) -> InterlockInputs {
        let mut inputs = self.interlock_inputs(now, inputs, params);
        let output = self.output_of(request);
        inputs.port_missing = output.is_some_and(|output| params.output_port(output) == 0);
        inputs.port_conflict = output.is_some_and(|output| params.output_conflict(output).is_some());
        if let Request::Port(port, _) | Request::Pulse(port, _) = request {
            inputs.port_owned = matches!(ports::port_owner(port, params), PortOwner::Interlocked(_));
        }
        inputs
    }

    /// The reason of a rule; for requests by port number with the port and the function that owns it.
    #[must_use]
    pub fn reason_text(&self, reason: &'static Text, request: Request, params: &Params) -> LocalizedText {
        if let Request::Port(port, _) | Request::Pulse(port, _) = request
            && let PortOwner::Interlocked(output) = ports::port_owner(port, params)
        {
            return phrase!(
                "{reason} (输出口 {port}：{output})",
                "{reason} (port {port}: {output})",
                reason,
                port,
                output
            );
        }
        (*reason).into()
    }

    /// Requests a change. The interlock table decides; a refused request changes nothing.
    pub fn request(&mut self, request: Request, now: Micros, inputs: InputSet, params: &Params) -> RequestResult {
        if let Some(rule) = self.blocking_rule(request, now, inputs, params) {
            return match rule.outcome {
                RuleOutcome::NoEffect => RequestResult::NoEffect(rule.reason),
                RuleOutcome::Deny => RequestResult::Denied(rule.reason),
                RuleOutcome::Alarm(number) => {
                    if number == alarm::HYDRAULIC_PRESSURE {
                        self.hydraulic.note_refused_start();
                    }
                    RequestResult::Alarm(number, &rule.reason)
                }
            };
        }
        self.execute(request, now, inputs, params)
    }

    /// One tick: delays, feedback and supervision of all units.
    pub fn tick(&mut self, now: Micros, inputs: InputSet, params: &Params, state: ControlState) -> Findings {
        self.control_state = state;
        self.now = now;
        let e_stop = inputs.has(Input::EmergencyStop);
        let pressed = e_stop && !self.e_stop;
        self.e_stop = e_stop;
        if e_stop {
            self.safe_stop();
        }
        self.wheel.tick(now, params);
        self.workpiece_drive.tick(now, params);
        self.second_spindle.tick(now, params);
        self.main_spindle.tick(now, params);
        self.magnet.tick(now, params);
        self.ports.tick(now);
        let hydraulic = self.hydraulic.supervise(now, inputs, params, self.wheel.is_on(), state.run_open);
        if let Some(MachineFinding::Alarm { stopped: true, .. }) = hydraulic {
            self.wheel = WheelContactor::Off; // K3.7: in the tick of the filtered edge
        }
        let alarm = |number| MachineFinding::Alarm { number, stopped: true, title: None };
        let pressed = pressed.then(|| alarm(alarm::EMERGENCY_STOP));
        let tailstock = self.tailstock.supervise(now, inputs, params);
        if tailstock == Some(alarm::TAILSTOCK_SIGNAL_LOST) {
            self.workpiece_drive = WorkpieceDrive::Off; // the part may come loose
        }
        let tailstock = tailstock.map(alarm);
        let [radial, axial] = self.gauge_arms.supervise(now, inputs, params).map(|late| late.map(alarm));
        let gears = self.gears.supervise(now, inputs, params).map(alarm);
        let [flow, level] = self.fluids.tick(now, inputs, params, &mut self.last_lubrication);
        let cylinder = self.cylinder.tick(now, inputs, params, &mut self.cylinder_flags).map(alarm);
        let guard = self.supervise_guard(inputs, params);
        let turret = self.turret.supervise(now, inputs, params).map(alarm);
        [pressed, hydraulic, tailstock, radial, axial, gears, cylinder, flow, level, guard, turret]
    }

    /// K5.13: an open guard stops the workpiece drive; opening it in a run also holds the program.
    fn supervise_guard(&mut self, inputs: InputSet, params: &Params) -> Option<MachineFinding> {
        let (was_open, mut stopped) = (self.guard.open, false);
        self.guard.open = is_guard_open(inputs, params);
        if self.guard.open && self.workpiece_drive.is_on() {
            self.workpiece_drive = WorkpieceDrive::Off;
            self.guard.stopped_drive = self.control_state.run_open;
            stopped = true;
        }
        self.guard.stopped_drive &= self.control_state.run_open && !self.workpiece_drive.is_on();
        match (self.guard.open, self.guard.alarm) {
            (true, false) if !was_open && self.control_state.run_open => {
                self.guard.alarm = true;
                Some(MachineFinding::Alarm { number: alarm::GUARD_OPEN, stopped: false, title: None })
            }
            (false, true) => {
                self.guard.alarm = false;
                Some(MachineFinding::Cleared(alarm::GUARD_OPEN))
            }
            (true | false, true | false) => stopped.then_some(MachineFinding::Message(GUARD_STOPPED)),
        }
    }

    /// E-stop, panic, lost HMI or bus: spindles and fluids off, clamps hold (table after K3).
    pub fn safe_stop(&mut self) {
        self.stop_wheel_and_drive();
        self.second_spindle = SecondSpindleContactor::Off;
        self.fluids.coolant = false;
        self.cylinder = Cylinder::Off;
        self.ports.end_pulses();
    }

    /// Reset: workpiece drive and oscillation stop; wheel, fluids, hydraulics and clamping stay (table after K3).
    pub fn reset(&mut self) {
        self.workpiece_drive = WorkpieceDrive::Off;
        self.cylinder = Cylinder::Off;
        self.stop_lathe_units();
        self.ports.end_pulses();
        self.hydraulic.acknowledge();
    }

    /// Alarm reaction: stops wheel, workpiece drive and lathe units.
    pub fn stop_wheel_and_drive(&mut self) {
        self.wheel = WheelContactor::Off;
        self.workpiece_drive = WorkpieceDrive::Off;
        self.stop_lathe_units();
    }

    /// M30 (K3.14): coolant and workpiece drive off; wheel and second spindle too, unless P17.2 keeps them running.
    pub fn program_end(&mut self, params: &Params) {
        self.fluids.coolant = false;
        self.workpiece_drive = WorkpieceDrive::Off;
        self.stop_lathe_units();
        if !params.bit(param::WHEEL_RUNS_AFTER_M30) {
            self.wheel = WheelContactor::Off;
            self.second_spindle = SecondSpindleContactor::Off;
        }
    }

    /// Stops the main spindle by its pulse, and a turning tool post.
    fn stop_lathe_units(&mut self) {
        if self.main_spindle.direction().is_some() {
            self.main_spindle.stop(self.now);
        }
        self.turret = ToolTurret::Clamped;
    }

    /// Direction of the main spindle, true counter-clockwise; `None` while it is off.
    #[must_use]
    pub const fn spindle_direction(&self) -> Option<bool> {
        self.main_spindle.direction()
    }

    /// Whether the tool post is indexing.
    #[must_use]
    pub const fn turret_is_moving(&self) -> bool {
        self.turret.is_moving()
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
        self.workpiece_drive.is_on()
    }

    /// Whether the emergency stop is pressed.
    #[must_use]
    pub const fn is_e_stopped(&self) -> bool {
        self.e_stop
    }
}

/// Whether P332 is assigned and the guard is not closed.
fn is_guard_open(inputs: InputSet, params: &Params) -> bool {
    params.input_port(Input::GuardClosed) != 0 && !inputs.has(Input::GuardClosed)
}
