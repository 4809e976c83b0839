//! Invariants of the outputs. Source: spec K3, K5, "what stops what".

use super::{Moment, REACTION, STARTED_BY_HAND, WORK_DRIVES, hold, hold_output};
use crate::defs::equipment::Equipment;
use crate::defs::key::Key;
use crate::defs::param;
use crate::defs::signal::{Input, Output, OutputSet};
use crate::link::command::Command;
use crate::link::snapshot::RunState;
use crate::units::Micros;

/// Off in the tick of the emergency stop.
pub(super) const OFF_IN_AN_EMERGENCY: [Output; 14] = [
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

/// Never both.
const EXCLUSIVE: [(Output, Output); 6] = [
    (Output::HeadstockHigh, Output::HeadstockLow),
    (Output::Magnetise, Output::Demagnetise),
    (Output::SecondSpindle, Output::SecondSpindleCcw),
    (Output::OscillationForward, Output::OscillationBackward),
    (Output::SpindleForward, Output::SpindleReverse),
    (Output::TurretForward, Output::TurretReverse),
];

/// What clamps or holds: the emergency stop leaves it as it is.
const CLAMPS: [Output; 3] = [Output::Hydraulic, Output::Magnetise, Output::Tailstock];

/// How long after a key something may start.
const START_TIME: Micros = Micros::from_millis(200);

/// Since when the inputs of a rule are as they are.
#[derive(Default)]
pub struct OutputRules {
    before: OutputSet,
    was_powered: bool,
    /// A key or line of the operator, and when; a run counts while it lasts.
    asked: Option<Micros>,
    /// Commands since power-on.
    asked_since_power_on: bool,
    /// The screen's emergency stop is latched.
    screen_e_stop: bool,
    was_e_stopped: bool,
    /// An emergency stop that RESET has not ended.
    waits_for_reset: bool,
    hydraulic_since: Option<Micros>,
    /// Power-on, or the last start of the pump: P270 later the pressure is supervised.
    pump_asked: Option<Micros>,
    /// P17.0 and P270 ask for supervision.
    supervised_since: Option<Micros>,
    magnet_since: Option<Micros>,
    /// The valve of the tailstock has changed since power-on.
    tailstock_moved: bool,
    pressure_seen: Option<Micros>,
    guard_seen: Option<Micros>,
    end_switch_seen: Option<Micros>,
}

impl OutputRules {
    pub(super) fn check(&mut self, moment: &Moment<'_>) -> Result<(), String> {
        if !moment.powered {
            *self = Self { screen_e_stop: false, ..Self::default() };
            return hold("an output is on without power", moment.machine.written.terminals.0 == 0);
        }
        let on = moment.outputs_on;
        self.note(moment);
        let before = std::mem::replace(&mut self.before, on);
        if self.was_powered {
            self.check_changes(moment, before, on)?;
        }
        self.was_powered = true;
        self.note_sequences(moment, before, on);
        Ok(())
    }

    /// What this tick tells before its outputs are looked at.
    fn note(&mut self, moment: &Moment<'_>) {
        for command in moment.commands {
            match command {
                Command::EmergencyStop(latched) => self.screen_e_stop = *latched,
                Command::Press(Key::Reset) if !moment.is_e_stopped() && !self.screen_e_stop => {
                    self.waits_for_reset = false;
                }
                _ => {}
            }
            if matches!(command, Command::Press(_) | Command::Mdi(_)) {
                (self.asked, self.asked_since_power_on) = (Some(moment.now), true);
            }
        }
        if matches!(moment.reported.state, RunState::Running | RunState::Waiting) {
            self.asked = Some(moment.now);
        }
        self.waits_for_reset |= moment.is_e_stopped() || self.screen_e_stop;
        for (input, seen) in
            [(Input::HydraulicPressure, &mut self.pressure_seen), (Input::GuardClosed, &mut self.guard_seen)]
        {
            if moment.machine.is_active(input) {
                *seen = Some(moment.now);
            }
        }
        let params = moment.controller.params();
        let supervised = !params.bit(param::NO_HYDRAULIC_CHECK) && params.millis(param::HYDRAULIC_DELAY) > Micros::ZERO;
        self.supervised_since = supervised.then(|| self.supervised_since.unwrap_or(moment.now));
        let end = if self.before.has(Output::Tailstock) { Input::TailstockAdvanced } else { Input::TailstockRetracted };
        if moment.machine.is_active(end) {
            self.end_switch_seen = Some(moment.now);
        }
    }

    /// Since when pump and magnet are on.
    fn note_sequences(&mut self, moment: &Moment<'_>, before: OutputSet, on: OutputSet) {
        for (output, since) in
            [(Output::Hydraulic, &mut self.hydraulic_since), (Output::Magnetise, &mut self.magnet_since)]
        {
            *since = if on.has(output) { since.or(Some(moment.now)) } else { None };
        }
        if self.pump_asked.is_none() || on.has(Output::Hydraulic) && !before.has(Output::Hydraulic) {
            self.pump_asked = Some(moment.now);
        }
        if before.has(Output::Tailstock) != on.has(Output::Tailstock) {
            (self.tailstock_moved, self.end_switch_seen) = (true, None);
        }
    }

    fn check_changes(&mut self, moment: &Moment<'_>, before: OutputSet, on: OutputSet) -> Result<(), String> {
        let starts = |output: Output| on.has(output) && !before.has(output);
        let stopped = moment.is_e_stopped() || self.screen_e_stop;
        let first = stopped && !std::mem::replace(&mut self.was_e_stopped, stopped);
        for output in OFF_IN_AN_EMERGENCY {
            hold_output("is on in an emergency stop", output, !(stopped && on.has(output)))?;
            hold_output("starts before RESET", output, !(starts(output) && self.waits_for_reset))?;
        }
        for clamp in CLAMPS.into_iter().filter(|_| first && moment.commands.is_empty()) {
            hold_output("changes by the emergency stop", clamp, before.has(clamp) == on.has(clamp))?;
        }
        for (one, other) in EXCLUSIVE {
            hold_output("is on together with its opposite", one, !(on.has(one) && on.has(other)))?;
        }
        let asked = self.asked.is_some_and(|asked| moment.now.since(asked) <= START_TIME);
        for output in STARTED_BY_HAND {
            hold_output("starts by itself", output, asked || !starts(output))?;
        }
        if !self.asked_since_power_on {
            let quiet = STARTED_BY_HAND.into_iter().chain(CLAMPS).all(|output| !starts(output));
            hold("an output comes on by power-on alone", quiet)?;
        }
        if starts(Output::Wheel) {
            self.check_wheel_start(moment)?;
        }
        self.check_running_wheel(moment, before, on)?;
        self.check_guard(moment, before, on)?;
        self.check_workpiece(moment, before, on)
    }

    /// K3.1, K3.7, K3.11, K5.13.
    fn check_wheel_start(&self, moment: &Moment<'_>) -> Result<(), String> {
        let params = moment.controller.params();
        let filter = params.millis(param::INPUT_FILTER) + REACTION;
        let recent = |seen: Option<Micros>| seen.is_some_and(|seen| moment.now.since(seen) <= filter);
        if !params.bit(param::NO_HYDRAULIC_CHECK) {
            let delay = params.millis(param::HYDRAULIC_DELAY);
            let on_for = self.hydraulic_since.map(|since| moment.now.since(since));
            hold("the wheel starts without hydraulics", on_for.is_some_and(|on_for| on_for >= delay))?;
            hold("the wheel starts without pressure", delay == Micros::ZERO || recent(self.pressure_seen))?;
        }
        let fitted = params.fitted();
        if fitted.has(Equipment::MagneticChuck) && params.bit(param::WHEEL_NEEDS_MAGNET) {
            let held_for = self.magnet_since.map(|since| moment.now.since(since));
            let needed = params.millis(param::MAGNETISE_TIME);
            hold("the wheel starts unmagnetised", held_for.is_some_and(|held_for| held_for >= needed))?;
        }
        let door = params.input_port(Input::GuardClosed) != 0;
        hold("the wheel starts with the guard open", !door || recent(self.guard_seen))
    }

    /// K3.5, K3.7, K3.11.
    fn check_running_wheel(&self, moment: &Moment<'_>, before: OutputSet, on: OutputSet) -> Result<(), String> {
        let runs = before.has(Output::Wheel) && on.has(Output::Wheel);
        let changes = |output: Output| before.has(output) != on.has(output);
        hold("the pump switches while the wheel runs", !(runs && changes(Output::Hydraulic)))?;
        let releases = on.has(Output::Demagnetise) && changes(Output::Demagnetise)
            || !on.has(Output::Magnetise) && changes(Output::Magnetise);
        hold("the part is released while the wheel runs", !(runs && releases))?;
        let params = moment.controller.params();
        let latest = params.millis(param::INPUT_FILTER) + REACTION;
        let for_longer = |since: Option<Micros>, time| since.is_some_and(|since| moment.now.since(since) > time);
        let supervised = for_longer(self.supervised_since, latest)
            && for_longer(self.pump_asked, latest + params.millis(param::HYDRAULIC_DELAY));
        let lost =
            moment.machine.read.bus_alive && self.pressure_seen.is_none_or(|seen| moment.now.since(seen) > latest);
        hold("the wheel runs on without pressure", !(supervised && lost && on.has(Output::Wheel)))
    }

    /// K5.13: what turns the part neither starts nor goes on in a run.
    fn check_guard(&self, moment: &Moment<'_>, before: OutputSet, on: OutputSet) -> Result<(), String> {
        let params = moment.controller.params();
        let latest = params.millis(param::INPUT_FILTER) + REACTION;
        let open = params.input_port(Input::GuardClosed) != 0
            && self.guard_seen.is_none_or(|seen| moment.now.since(seen) > latest);
        let runs = matches!(moment.reported.state, RunState::Running | RunState::Waiting);
        for output in WORK_DRIVES {
            hold_output("starts with the guard open", output, !(open && on.has(output) && !before.has(output)))?;
            hold_output("turns in a run with the guard open", output, !(open && runs && on.has(output)))?;
        }
        Ok(())
    }

    /// K3.3, K3.4, K3.11.
    fn check_workpiece(&self, moment: &Moment<'_>, before: OutputSet, on: OutputSet) -> Result<(), String> {
        let turns = |set: OutputSet| set.has(Output::HeadstockHigh) || set.has(Output::HeadstockLow);
        let valve = before.has(Output::Tailstock) != on.has(Output::Tailstock);
        hold("the tailstock moves while the headstock turns", !(valve && turns(before) && turns(on)))?;
        let params = moment.controller.params();
        let filter = params.millis(param::INPUT_FILTER) + REACTION;
        let in_place = self.end_switch_seen.is_some_and(|seen| moment.now.since(seen) <= filter);
        let starts = turns(on) && !turns(before);
        let supervised = params.bit(param::TAILSTOCK_ENABLED) && self.tailstock_moved;
        hold("the headstock starts while the tailstock moves", !(starts && supervised && !in_place))?;
        let table_starts = on.has(Output::TableRotation) && !before.has(Output::TableRotation);
        let held_for = self.magnet_since.map(|since| moment.now.since(since));
        let magnetised = held_for.is_some_and(|held_for| held_for >= params.millis(param::MAGNETISE_TIME));
        let needs_magnet = params.fitted().has(Equipment::MagneticChuck);
        hold("the table starts unmagnetised", !(table_starts && needs_magnet && !magnetised))?;
        let table = before.has(Output::TableRotation) && on.has(Output::TableRotation);
        let released = on.has(Output::Demagnetise) && !before.has(Output::Demagnetise);
        hold("the part is released while the table turns", !(table && released))
    }
}
