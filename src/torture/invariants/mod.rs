//! What holds in every tick of every course, written out once more and apart from the code that keeps it.
//! Source: spec K2, K3, K5, "what stops what"; safety stance.

mod course;
mod motion;
mod outputs;
mod screen;

use super::machine::WatchedMachine;
use super::planted::Reported;
use crate::controller::{Controller, WORK_PER_TICK};
use crate::defs::key::{Key, Lamp};
use crate::defs::signal::{Input, Output, OutputSet};
use crate::defs::soft_key::f1_continues;
use crate::link::command::Command;
use crate::link::snapshot::{RunState, Snapshot};
use crate::units::Micros;
use course::CourseRules;
use motion::MotionRules;
use outputs::OutputRules;
use screen::ScreenRules;

/// Most requests of the control that wait for storage: every variable twice.
const MAX_WAITING_REQUESTS: usize = 2_000;
/// A contour cycle (G70–G73) is computed in one tick; nothing else is above the budget.
const MAX_WORK: usize = 40 * WORK_PER_TICK;
/// Most alarms at once.
const MAX_ALARMS: usize = 64;

/// One tick as seen from outside.
pub struct Moment<'a> {
    /// Time of the tick.
    pub now: Micros,
    /// What the operator has asked for in this tick.
    pub commands: &'a [Command],
    /// The screen has sent its keep-alive in this tick.
    pub screen_heard: bool,
    /// The machine with its images.
    pub machine: &'a WatchedMachine,
    /// The outputs that are on at it.
    pub outputs_on: OutputSet,
    /// The control.
    pub controller: &'a Controller,
    /// What it says of itself.
    pub reported: Reported,
    /// Whether the control has power.
    pub powered: bool,
}

impl Moment<'_> {
    fn pressed(&self, wanted: impl Fn(Key) -> bool) -> bool {
        self.commands.iter().any(|command| matches!(command, Command::Press(key) if wanted(*key)))
    }

    /// The emergency stop at the machine.
    fn is_e_stopped(&self) -> bool {
        self.machine.read.bus_alive && self.machine.is_active(Input::EmergencyStop)
    }
}

/// The outputs that are on at the machine.
pub fn outputs_on(machine: &WatchedMachine, controller: &Controller) -> OutputSet {
    let params = controller.params();
    let (fitted, mut on) = (params.fitted(), OutputSet::NONE);
    // A terminal may belong to an output of another kind of machine, too.
    for output in Output::ALL.iter().filter(|output| fitted.meets(output.needs())) {
        on.set(*output, machine.written.terminals.is_closed(params.output_port(*output)));
    }
    on
}

/// What a rule needs to know of earlier ticks, of all rules.
#[derive(Default)]
pub struct Invariants {
    outputs: OutputRules,
    motion: MotionRules,
    course: CourseRules,
    screen: ScreenRules,
    /// State of the last tick.
    state: RunState,
    /// The last command that may start a run, and when.
    asked_to_start: Option<Micros>,
    external_start: bool,
}

/// Ticks, bus and commands between an input and its effect, beside the input filter.
const REACTION: Micros = Micros::from_millis(30);
/// What only the operator or a program starts, and at once; a cylinder and a turret go on by their own sequence.
const STARTED_BY_HAND: [Output; 8] = [
    Output::Wheel,
    Output::SecondSpindle,
    Output::SecondSpindleCcw,
    Output::HeadstockHigh,
    Output::HeadstockLow,
    Output::DresserRoll,
    Output::TableRotation,
    Output::Coolant,
];

/// What turns the part or the dresser: off by RESET, by the opened guard, at the end of a program.
const WORK_DRIVES: [Output; 4] =
    [Output::HeadstockHigh, Output::HeadstockLow, Output::DresserRoll, Output::TableRotation];

/// Longest time in which axes brake: 166 mm/s at 800 mm/s² is 0.2 s, and jerk, override and the end of a buffer add to it.
const BRAKING: Micros = Micros::from_millis(500);
/// How long after a command a run may start.
const START_TIME: Micros = Micros::from_millis(400);

impl Invariants {
    /// Checks a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn check(&mut self, moment: &Moment<'_>) -> Result<(), String> {
        self.outputs.check(moment)?;
        self.motion.check(moment)?;
        self.course.check(moment)?;
        self.screen.check(moment)?;
        if !moment.powered {
            self.state = RunState::Idle;
            self.asked_to_start = None;
            return Ok(());
        }
        self.check_start_of_run(moment)?;
        let Reported { work, waiting_requests, .. } = moment.reported;
        if work > MAX_WORK {
            return Err(format!("a tick has cost {work} units of work"));
        }
        if waiting_requests > MAX_WAITING_REQUESTS {
            return Err(format!("{waiting_requests} requests wait for storage"));
        }
        Ok(())
    }

    /// A run starts, and goes on after a hold or a stop, by the operator alone.
    fn check_start_of_run(&mut self, moment: &Moment<'_>) -> Result<(), String> {
        let external = moment.machine.is_active(Input::ExternalStart);
        let continues_by_soft_key = f1_continues(moment.controller.kind());
        let asks = |command: &Command| match command {
            Command::Press(Key::CycleStart | Key::WheelRetract) => true,
            // L7: the soft key that goes on.
            Command::Press(Key::F1) => continues_by_soft_key,
            Command::Press(key) => key.jog_direction().is_some(),
            Command::Mdi(_) => true,
            _ => false,
        };
        if moment.commands.iter().any(asks) || external && !self.external_start {
            self.asked_to_start = Some(moment.now);
        }
        self.external_start = external;
        let before = std::mem::replace(&mut self.state, moment.reported.state);
        let asked = self.asked_to_start.is_some_and(|asked| moment.now.since(asked) <= START_TIME);
        match (before.is_active(), self.state.is_active()) {
            (false, true) if !asked => Err(format!("{} after {} without the operator", self.state.id(), before.id())),
            _ => Ok(()),
        }
    }

    /// Checks what pages show; less often, because it costs more.
    ///
    /// # Errors
    /// What does not hold.
    pub fn check_shown(&self, shown: &Snapshot, moment: &Moment<'_>) -> Result<(), String> {
        let on = moment.outputs_on;
        for key in Key::ALL.iter().filter(|key| key.exists_on(shown.fitted())) {
            let wanted = match key.row().lamp {
                // One key for both directions.
                Lamp::Output(Output::SecondSpindle) => {
                    on.has(Output::SecondSpindle) || on.has(Output::SecondSpindleCcw)
                }
                Lamp::Output(output) => on.has(output),
                Lamp::OutputOff(output) => !on.has(output),
                Lamp::None | Lamp::Control => continue,
            };
            let view = shown.key(*key);
            if moment.powered && view.lamp != wanted && !view.pending {
                return Err(format!("K2.4: the lamp of {} does not show its output", key.id()));
            }
        }
        let finite = |axis: &crate::link::snapshot::AxisView| axis.work.is_finite() && axis.machine.is_finite();
        if !shown.axes.0.iter().all(finite) {
            return Err("a position is no number".to_owned());
        }
        if shown.alarms.len() > MAX_ALARMS || shown.alarms.iter().any(|alarm| alarm.text.zh().is_empty()) {
            return Err(format!("{} alarms, or one without a text", shown.alarms.len()));
        }
        Ok(())
    }
}

fn hold(what: &str, holds: bool) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what.to_owned()) }
}

fn hold_output(what: &str, output: Output, holds: bool) -> Result<(), String> {
    if holds { Ok(()) } else { Err(format!("{} {what}", output.id())) }
}
