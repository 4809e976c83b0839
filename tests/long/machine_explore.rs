//! Exhaustive search of the machine logic: every key, every request of a program and every input in every state that can
//! be reached, to a fixed point, with the real code of the machine room.
//!
//! One transition is one tick of the controller: new inputs, then at most one key or one request of the running program,
//! then `Machine::tick` and what its findings do to the run. The delays are parameters and stand at two ticks here; a
//! longer delay only moves the moment. Units that no rule connects with these (lubrication, gauge arms, gears, user outputs, ports)
//! are not multiplied in: in every state it is checked that asking for them changes nothing here.
//! Invariants: spec K2.2, K3, K5, "what stops what". Each is shown to fail when its rule is taken out.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a test driver: a failure is the message")]

use std::collections::{HashMap, VecDeque};

use kt830::defs::key::{Key, Mode};
use kt830::defs::kind::Kind;
use kt830::defs::mcode::{Gauge, Request};
use kt830::defs::param::{self, ParamAddress, Params};
use kt830::defs::signal::{Input, InputSet, Output, OutputSet};
use kt830::machine::discrete::DiscreteState;
use kt830::machine::interlock::Rule;
use kt830::machine::phase::{PhaseEvent, RunPhase};
use kt830::machine::rules::RULES;
use kt830::machine::{Consequence, ControlState, Machine, MachineFinding, OFF_IN_SAFE_STATE, RequestResult, panel_key};
use kt830::units::{Micros, PerAxis};

const TICK: Micros = Micros(1_000);
/// Two ticks for every delay: long enough to be on the way, short enough to search.
const DELAY_MS: f64 = 2.0;

/// K2.2, written out: coolant, lubrication and the run keys. One-key retract acts by P4.4 and is not of this search.
const ALIVE_IN_A_RUN: &[Key] = &[
    Key::Coolant,
    Key::Lubrication,
    Key::CycleStart,
    Key::FeedHold,
    Key::Reset,
    Key::EmergencyStop,
    Key::FeedOverrideUp,
    Key::FeedOverrideDown,
    Key::RapidF0,
    Key::Rapid25,
    Key::Rapid50,
    Key::Rapid100,
    Key::SpindleOverrideUp,
    Key::SpindleOverrideDown,
    Key::SingleBlock,
    Key::BlockSkip,
    Key::OptionalStop,
];

/// The table after K3, written out: off in the tick of the emergency stop.
const ALL_OFF_IN_AN_EMERGENCY: &[Output] = &[
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
];

/// A panic or a lost screen leads to the same outputs as the emergency stop; beside them the lathe's.
#[test]
fn k3_the_safe_state_switches_off_what_the_emergency_stop_does() {
    let of_lathe = [Output::SpindleForward, Output::SpindleReverse, Output::TurretForward, Output::TurretReverse];
    let wanted: Vec<Output> = ALL_OFF_IN_AN_EMERGENCY.iter().copied().chain(of_lathe).collect();
    assert_eq!(OFF_IN_SAFE_STATE, wanted);
}

/// What the search may leave out, to see whether it notices.
#[derive(Clone, Copy, Default)]
struct Without {
    /// Rows of the interlock table by their reasons.
    rules: &'static [&'static str],
    /// K2.2: keys are not active while a program runs.
    dead_keys: bool,
    /// The machine does not see the emergency stop.
    e_stop: bool,
    /// Refusals give no reason.
    reasons: bool,
}

/// A machine to search: its kind, and parameters that differ from the factory's.
struct Plan {
    kind: Kind,
    params: Vec<(&'static str, f64)>,
    without: Without,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct State {
    units: DiscreteState,
    phase: RunPhase,
    drives_off: bool,
}

#[derive(Clone)]
struct Node {
    machine: Machine,
    phase: RunPhase,
    /// An alarm has stopped everything and waits for RESET.
    drives_off: bool,
}

/// A node that is searched, and what all its transitions begin from.
struct Origin<'a> {
    node: &'a Node,
    outputs: OutputSet,
    /// In the tick of its transitions.
    state: State,
    now: Micros,
}

/// What happens in one tick beside the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TickEvent {
    Nothing,
    Key(Key),
    Program(Request),
    ProgramEnds,
    ProgramStops,
    ComesToRest,
    Homed,
}

/// One tick: the inputs, and what else happens.
#[derive(Clone, Copy)]
struct Tick {
    inputs: InputSet,
    event: TickEvent,
}

struct Search {
    plan: Plan,
    params: Params,
    rules: &'static [Rule],
    inputs: Vec<InputSet>,
    events: Vec<TickEvent>,
    now: Micros,
}

struct Found {
    states: usize,
    transitions: u64,
    broken: Option<String>,
}

fn params(plan: &Plan) -> Params {
    let mut params = Params::factory(plan.kind);
    let mut set = |at: &str, value: f64| params.write(ParamAddress::parse(at).unwrap(), value).unwrap();
    for delay in ["P61", "P62", "P63", "P81", "P82", "P83", "P87", "P88", "P270"] {
        set(delay, DELAY_MS);
    }
    set("P332", 60.0); // a guard door is there
    for (at, value) in &plan.params {
        set(at, *value);
    }
    params
}

/// Every combination of the inputs that the searched units look at.
fn all_inputs(plan: &Plan) -> Vec<InputSet> {
    let mut seen = vec![Input::HydraulicPressure, Input::EmergencyStop, Input::GuardClosed];
    if plan.kind == Kind::Gc {
        seen.extend([Input::TailstockAdvanced, Input::TailstockRetracted]);
    }
    let combine = |bits: u32| {
        let mut set = InputSet::NONE;
        for (bit, input) in seen.iter().enumerate() {
            set.set(*input, bits >> bit & 1 == 1);
        }
        set
    };
    (0..1 << seen.len()).map(combine).collect()
}

fn all_requests() -> Vec<Request> {
    vec![
        Request::WheelStart,
        Request::WheelStop,
        Request::TailstockAdvance,
        Request::TailstockRetract,
        Request::WorkDriveHigh,
        Request::WorkDriveLow,
        Request::WorkDriveStop,
        Request::HydraulicOn,
        Request::HydraulicOff,
        Request::Magnetise,
        Request::Demagnetise,
        Request::SecondSpindleStart(false),
        Request::SecondSpindleStart(true),
        Request::SecondSpindleStop,
        Request::Switch(Output::Coolant, true),
        Request::Switch(Output::Coolant, false),
    ]
}

/// Requests of units that nothing here depends on.
fn foreign_requests() -> Vec<Request> {
    let arms = [Gauge::Radial, Gauge::Axial].into_iter();
    let mut all: Vec<_> = arms.flat_map(|gauge| [Request::Gauge(gauge, true), Request::Gauge(gauge, false)]).collect();
    all.extend((0..4).map(Request::Gear));
    all.extend(Output::USER.into_iter().flat_map(|user| [Request::Switch(user, true), Request::Switch(user, false)]));
    all.extend([true, false].map(|on| Request::Switch(Output::Lubrication, on)));
    all.push(Request::CylinderOff);
    all.extend([Request::Port(40, true), Request::Port(40, false), Request::Pulse(41, 5)]);
    all
}

impl Search {
    fn new(plan: Plan) -> Self {
        let left_out = plan.without.rules;
        let kept: Vec<Rule> = RULES.iter().copied().filter(|rule| !left_out.contains(&rule.reason.en)).collect();
        assert!(kept.len() + left_out.len() <= RULES.len(), "no rule says one of {left_out:?}");
        let mut events = vec![
            TickEvent::Nothing,
            TickEvent::ProgramEnds,
            TickEvent::ProgramStops,
            TickEvent::ComesToRest,
            TickEvent::Homed,
        ];
        events.extend(Key::ALL.iter().copied().map(TickEvent::Key));
        events.extend(all_requests().into_iter().map(TickEvent::Program));
        Self {
            params: params(&plan),
            rules: kept.leak(),
            inputs: all_inputs(&plan),
            events,
            plan,
            // Old enough that every age at the start is the greatest.
            now: Micros::from_millis(1_000),
        }
    }

    /// The whole search; ends at the first broken invariant.
    fn run(&self) -> Found {
        let first = Node {
            machine: Machine::with_rules(self.rules, self.plan.kind, self.now),
            phase: RunPhase::Idle,
            drives_off: false,
        };
        let mut seen: HashMap<State, Micros> = HashMap::from([(self.state(&first, self.now), self.now)]);
        let mut open = VecDeque::from([(first, self.now)]);
        let mut transitions = 0;
        while let Some((node, now)) = open.pop_front() {
            let now = now + TICK;
            let (outputs, state) = (self.outputs(&node.machine), self.state(&node, now));
            let origin = Origin { node: &node, outputs, state, now };
            for inputs in &self.inputs {
                for event in &self.events {
                    transitions += 1;
                    let next = match self.step(&origin, Tick { inputs: *inputs, event: *event }) {
                        Ok(Some(next)) => next,
                        Ok(None) => continue,
                        Err(broken) => {
                            let told = format!("{broken}\n  after {event:?} with {inputs:?} in {node:?}");
                            return Found { states: seen.len(), transitions, broken: Some(told) };
                        }
                    };
                    if let std::collections::hash_map::Entry::Vacant(place) = seen.entry(self.state(&next, now)) {
                        place.insert(now);
                        open.push_back((next, now));
                    }
                }
            }
        }
        Found { states: seen.len(), transitions, broken: None }
    }

    fn state(&self, node: &Node, now: Micros) -> State {
        State { units: node.machine.discrete_state(now, TICK), phase: node.phase, drives_off: node.drives_off }
    }

    fn outputs(&self, machine: &Machine) -> OutputSet {
        machine.outputs(&self.params)
    }

    /// One tick; none where the event cannot happen in this state, or changes nothing: then it is the tick of no event.
    fn step(&self, from: &Origin, tick: Tick) -> Result<Option<Node>, String> {
        let (Tick { inputs, event }, now) = (tick, from.now);
        let mut node = from.node.clone();
        let mut seen_by_machine = inputs;
        if self.plan.without.e_stop {
            seen_by_machine.set(Input::EmergencyStop, false);
        }
        match event {
            TickEvent::Nothing => {}
            TickEvent::Key(key) => match self.press(&mut node, key, seen_by_machine, from)? {
                true => {}
                false => return Ok(None),
            },
            TickEvent::Program(request) => {
                if node.phase != RunPhase::Running {
                    return Ok(None);
                }
                let answer = self.ask(&mut node, request, seen_by_machine, from)?;
                if matches!(answer, RequestResult::Denied(_)) {
                    node.phase = node.phase.after(PhaseEvent::Hold);
                }
            }
            TickEvent::ProgramEnds if node.phase == RunPhase::Running => {
                node.machine.program_end(&self.params);
                node.phase = node.phase.after(PhaseEvent::Finish);
            }
            TickEvent::ProgramStops if node.phase == RunPhase::Running => {
                node.phase = node.phase.after(PhaseEvent::Stop)
            }
            TickEvent::ComesToRest if matches!(node.phase, RunPhase::Holding | RunPhase::Aborting) => {
                node.phase = node.phase.after(PhaseEvent::AtRest);
            }
            TickEvent::Homed if node.phase == RunPhase::Homing(()) => node.phase = node.phase.after(PhaseEvent::Homed),
            TickEvent::ProgramEnds | TickEvent::ProgramStops | TickEvent::ComesToRest | TickEvent::Homed => {
                return Ok(None);
            }
        }
        if event != TickEvent::Nothing && self.state(&node, now) == from.state {
            return check_alive(from.node, event).map(|()| None);
        }
        let asked = self.outputs(&node.machine);
        self.tick(&mut node, seen_by_machine, now);
        self.check(from, &node, asked, tick)?;
        Ok(Some(node))
    }

    fn tick(&self, node: &mut Node, inputs: InputSet, now: Micros) {
        for finding in node.machine.tick(now, inputs, &self.params, control_state(node)).into_iter().flatten() {
            let MachineFinding::Alarm { number, stopped, .. } = finding else { continue };
            match Consequence::of(number, stopped) {
                Consequence::Nothing => {}
                Consequence::Hold => node.phase = node.phase.after(PhaseEvent::Hold),
                Consequence::Abort => node.phase = abort(node.phase),
                Consequence::AbortAndStop => {
                    node.machine.stop_wheel_and_drive();
                    node.phase = abort(node.phase);
                }
                Consequence::AbortAndMakeSafe => {
                    node.drives_off = true;
                    node.machine.safe_stop();
                    node.phase = abort(node.phase);
                }
            }
        }
    }

    /// A key as the controller takes it; false when it is not on the panel.
    fn press(&self, node: &mut Node, key: Key, inputs: InputSet, from: &Origin) -> Result<bool, String> {
        let fitted = self.params.fitted();
        if let Some(reason) = panel_key::inactive_reason(key, fitted, fitted.axes(), node.phase) {
            self.reasoned(reason.en)?;
            let by_run = node.phase.is_automatic() && key.exists_on(fitted);
            if !(by_run && self.plan.without.dead_keys) {
                return Ok(false);
            }
        }
        match key {
            Key::FeedHold => node.phase = node.phase.after(PhaseEvent::Hold),
            Key::Reset => {
                node.phase = abort(node.phase);
                node.machine.reset();
                node.drives_off = node.machine.is_e_stopped();
            }
            key => {
                let Some(request) = panel_key::machine_request(key, Mode::Auto, from.outputs) else {
                    return Ok(false);
                };
                let answer = self.ask(node, request, inputs, from)?;
                if request == Request::CycleStart && answer == RequestResult::Accepted {
                    node.phase = node.phase.after(PhaseEvent::Start);
                }
            }
        }
        Ok(true)
    }

    fn ask(&self, node: &mut Node, request: Request, inputs: InputSet, from: &Origin) -> Result<RequestResult, String> {
        node.machine.set_control_state(control_state(node));
        let answer = node.machine.request(request, from.now, inputs, &self.params);
        match answer {
            RequestResult::Accepted => return Ok(answer),
            RequestResult::NoEffect(reason) | RequestResult::Denied(reason) => self.reasoned(reason.en)?,
            RequestResult::Alarm(number, reason) => {
                self.reasoned(reason.en)?;
                match Consequence::of(number, false) {
                    Consequence::Nothing => {}
                    Consequence::Hold => node.phase = node.phase.after(PhaseEvent::Hold),
                    Consequence::Abort | Consequence::AbortAndStop | Consequence::AbortAndMakeSafe => {
                        node.phase = abort(node.phase);
                    }
                }
            }
        }
        if from.outputs == self.outputs(&node.machine) {
            Ok(answer)
        } else {
            Err(format!("{request:?} refused, but did it"))
        }
    }

    fn reasoned(&self, reason: &str) -> Result<(), String> {
        if reason.is_empty() || self.plan.without.reasons { Err("a refusal without a reason".into()) } else { Ok(()) }
    }

    /// The invariants. `asked` are the outputs after the event, before the machine's own tick.
    fn check(&self, origin: &Origin, to: &Node, asked: OutputSet, tick: Tick) -> Result<(), String> {
        let (Tick { inputs, event }, from, now) = (tick, origin.node, origin.now);
        let (before, after) = (origin.outputs, self.outputs(&to.machine));
        let turns = |on: OutputSet| {
            [Output::HeadstockHigh, Output::HeadstockLow, Output::DresserRoll, Output::TableRotation]
                .iter()
                .any(|drive| on.has(*drive))
        };
        if !before.has(Output::Wheel) && asked.has(Output::Wheel) {
            let interlock = from.machine.interlock_inputs(now, inputs, &self.params);
            let hydraulics = !interlock.hydraulic_needed
                || interlock.hydraulic_on
                    && (!interlock.hydraulic_checked || interlock.hydraulic_settled && interlock.pressure);
            held("the wheel starts without its hydraulics", hydraulics)?;
            held("the wheel starts unmagnetised", !interlock.magnet_needed || interlock.magnetised)?;
            held("the wheel starts with the guard open", !interlock.guard_open)?;
            held("the wheel starts in an emergency stop", !interlock.e_stop)?;
            held("the wheel starts with alarm 180 latched", !interlock.hydraulic_latched)?;
        }
        let starts = |output| !before.has(output) && asked.has(output);
        for output in ALL_OFF_IN_AN_EMERGENCY {
            held("something starts before RESET", !(from.drives_off && starts(*output)))?;
        }
        let moving = || to.machine.interlock_inputs(now, inputs, &self.params).tailstock_moving;
        held("headstock and tailstock move together", !(turns(after) && moving()))?;
        if self.plan.kind == Kind::Ga && self.params.bit(param::MAGNET_ENABLED) {
            let holding = || to.machine.interlock_inputs(now, inputs, &self.params).magnetised;
            held("the table turns unmagnetised", !turns(after) || holding())?;
            held("demagnetised while the table turns", !(turns(after) && after.has(Output::Demagnetise)))?;
        }
        if self.plan.kind != Kind::Gc {
            let released = before.has(Output::Magnetise) && !asked.has(Output::Magnetise);
            held("demagnetised while the wheel runs", !(before.has(Output::Wheel) && released))?;
        }
        let pump = before.has(Output::Hydraulic) != after.has(Output::Hydraulic);
        held("hydraulics switch while the wheel runs", !(pump && before.has(Output::Wheel)))?;
        check_alive(from, event)?;
        if inputs.has(Input::EmergencyStop) {
            for output in ALL_OFF_IN_AN_EMERGENCY {
                held("an output runs on in the tick of the emergency stop", !after.has(*output))?;
            }
            for output in [Output::Hydraulic, Output::Magnetise, Output::Tailstock] {
                held("the emergency stop changes what clamps", asked.has(output) == after.has(output))?;
            }
        }
        if event == TickEvent::Key(Key::Reset) {
            for output in [Output::Wheel, Output::Hydraulic, Output::Coolant, Output::Magnetise, Output::Tailstock] {
                held("reset changes what must stay", before.has(output) == asked.has(output))?;
            }
            held("reset leaves the workpiece drive on", !turns(asked))?;
        }
        self.check_foreign(to, inputs, event, now)
    }

    /// Units that are not searched: asking for them changes nothing here, and nothing here but the emergency stop and
    /// the run decides about them.
    fn check_foreign(&self, node: &Node, inputs: InputSet, event: TickEvent, now: Micros) -> Result<(), String> {
        if event != TickEvent::Nothing {
            return Ok(());
        }
        for request in foreign_requests() {
            let mut machine = node.machine.clone();
            if machine.request(request, now, inputs, &self.params) != RequestResult::Accepted {
                return Err(format!("{request:?} depends on the searched units"));
            }
            if machine.discrete_state(now, TICK) != node.machine.discrete_state(now, TICK) {
                return Err(format!("{request:?} changes the searched units"));
            }
        }
        Ok(())
    }
}

impl std::fmt::Debug for Node {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}, {:#?}", self.phase, self.machine)
    }
}

fn held(what: &str, holds: bool) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what.to_owned()) }
}

/// K2.2, of a key that was taken.
fn check_alive(from: &Node, event: TickEvent) -> Result<(), String> {
    let TickEvent::Key(key) = event else { return Ok(()) };
    held("a dead key acts while the program runs", ALIVE_IN_A_RUN.contains(&key) || !from.phase.is_automatic())
}

/// What the controller tells the machine.
fn control_state(node: &Node) -> ControlState {
    ControlState {
        run_open: node.phase.is_run_open(),
        homed: true,
        drives_off: node.drives_off,
        ..ControlState::default()
    }
}

/// The run ends; nothing to end when nothing runs.
fn abort(phase: RunPhase) -> RunPhase {
    match phase {
        RunPhase::Idle => RunPhase::Idle,
        phase => phase.after(PhaseEvent::Abort),
    }
}

fn search(kind: Kind, params: &[(&'static str, f64)], without: Without) -> Found {
    Search::new(Plan { kind, params: params.to_vec(), without }).run()
}

fn holds(kind: Kind, params: &[(&'static str, f64)]) {
    let found = search(kind, params, Without::default());
    println!("{}: {} states, {} transitions", kind.id(), found.states, found.transitions);
    assert_eq!(found.broken, None);
    assert!(found.states > 1_000, "{} states are no search", found.states);
}

fn fails(kind: Kind, without: Without, expected: &str) {
    let found = search(kind, &[], without);
    let broken = found.broken.unwrap_or_else(|| panic!("nothing broke in {} states: {expected}", found.states));
    assert!(broken.starts_with(expected), "expected {expected:?}, got {broken}");
}

fn fails_without(kind: Kind, rules: &'static [&'static str], expected: &str) {
    fails(kind, Without { rules, ..Without::default() }, expected);
}

#[test]
fn k3_every_state_of_gc_keeps_the_invariants() {
    holds(Kind::Gc, &[]);
}

#[test]
fn k3_every_state_of_gs_keeps_the_invariants() {
    holds(Kind::Gs, &[]);
}

#[test]
fn k3_every_state_of_ga_keeps_the_invariants() {
    holds(Kind::Ga, &[]);
}

#[test]
fn s5_every_state_of_the_vertical_grinder_keeps_the_invariants() {
    holds(Kind::Vertical, &[]);
}

#[test]
fn k3_7_every_state_keeps_the_invariants_without_supervision() {
    holds(Kind::Gc, &[("P270", 0.0)]);
    holds(Kind::Gs, &[("P17.0", 1.0)]);
}

#[test]
fn the_search_notices_each_rule_that_is_taken_out() {
    const HYDRAULICS: &str = "hydraulics off, delay not elapsed, or no pressure: the wheel cannot start";
    const STOPPED: &str = "an alarm that stopped the machine waits for RESET: nothing can start";
    let without: [(Kind, &[&str], &str); 12] = [
        (Kind::Gc, &[HYDRAULICS], "the wheel starts without"),
        (Kind::Gc, &["alarm 180 waits for RESET: the wheel cannot start"], "the wheel starts with alarm 180"),
        (Kind::Gs, &["the part is not magnetised: the wheel cannot start"], "the wheel starts unmagnetised"),
        (Kind::Gc, &[STOPPED], "something starts before RESET"),
        // The emergency stop itself is covered twice.
        (Kind::Gc, &[STOPPED, "emergency stop: nothing can start"], "something starts before RESET"),
        (Kind::Gc, &["the guard is open: close it first"], "the wheel starts with the guard open"),
        (Kind::Gc, &["the headstock is turning: the tailstock cannot move"], "headstock and tailstock"),
        (Kind::Gc, &["the tailstock is moving: the headstock cannot start"], "headstock and tailstock"),
        (Kind::Ga, &["the part is not magnetised: the table cannot start"], "the table turns unmagnetised"),
        (Kind::Ga, &["the table is turning: no demagnetising"], "the table turns unmagnetised"),
        (Kind::Gs, &["the wheel is running: no demagnetising"], "demagnetised while the wheel"),
        (Kind::Gc, &["the wheel is running: hydraulics cannot be switched"], "hydraulics switch"),
    ];
    for (kind, rule, expected) in without {
        fails_without(kind, rule, expected);
    }
}

#[test]
fn the_search_notices_what_stands_outside_the_table() {
    let all = Without::default();
    fails(Kind::Gc, Without { dead_keys: true, ..all }, "a dead key acts");
    fails(Kind::Gc, Without { e_stop: true, ..all }, "an output runs on");
    fails(Kind::Gc, Without { reasons: true, ..all }, "a refusal without a reason");
}

#[test]
fn fitted_axes_are_those_of_the_kind() {
    assert_eq!(Params::factory(Kind::Gs).fitted().axes(), PerAxis([true; 3]));
    assert_eq!(Params::factory(Kind::Gc).fitted().axes(), PerAxis([true, false, true]));
}
