//! Invariants of a course: what a run leaves to the operator, and what RESET, a lost bus and the end of a program
//! stop. Source: spec K2.2, K3.14, K5.8, "what stops what".

use super::{BRAKING, Moment, REACTION, STARTED_BY_HAND, WORK_DRIVES, hold, hold_output};
use crate::defs::key::{Key, Mode};
use crate::defs::param;
use crate::defs::signal::{Input, Output, OutputSet};
use crate::link::command::Command;
use crate::link::snapshot::RunState;
use crate::units::Micros;

/// RESET leaves them as they are.
const LEFT_BY_RESET: [Output; 4] = [Output::Hydraulic, Output::Magnetise, Output::Tailstock, Output::Coolant];
/// What these rules know of earlier ticks.
#[derive(Default)]
pub struct CourseRules {
    before: Option<(RunState, Mode, OutputSet)>,
    oscillated: bool,
    bus_seen: Micros,
    reset_at: Option<Micros>,
}

impl CourseRules {
    pub(super) fn check(&mut self, moment: &Moment<'_>) -> Result<(), String> {
        if !moment.powered {
            *self = Self::default();
            return Ok(());
        }
        let controller = moment.controller;
        let now = (moment.reported.state, moment.reported.mode, moment.outputs_on);
        let oscillated = std::mem::replace(&mut self.oscillated, moment.reported.oscillates_by_key);
        if moment.machine.read.bus_alive {
            self.bus_seen = moment.now;
        }
        let Some(before) = self.before.replace(now) else { return Ok(()) };
        let late = moment.now.since(self.bus_seen) > REACTION;
        for output in STARTED_BY_HAND {
            hold_output("is on without the bus", output, !(late && now.2.has(output)))?;
        }
        self.check_run(moment, before, oscillated)?;
        self.check_reset(moment, before.2)?;
        let ended = controller.part_finished_at() == Some(moment.now) && !now.0.is_active();
        for output in WORK_DRIVES.into_iter().chain([Output::Coolant]) {
            hold_output("stays on after M30", output, !(ended && now.2.has(output)))?;
        }
        let keeps = controller.params().bit(param::WHEEL_RUNS_AFTER_M30);
        hold_output("stays on after M30", Output::Wheel, !ended || keeps || !now.2.has(Output::Wheel))
    }

    /// K2.2: the mode stays. K5.8: what the key has set in oscillation must end first.
    fn check_run(
        &self,
        moment: &Moment<'_>,
        before: (RunState, Mode, OutputSet),
        oscillated: bool,
    ) -> Result<(), String> {
        let (state, mode) = (moment.reported.state, moment.reported.mode);
        let runs_on = before.0 == RunState::Running && state == RunState::Running;
        hold("the mode changes in a run", !runs_on || mode == before.1)?;
        let starts =
            !before.0.is_active() && state == RunState::Running && moment.pressed(|key| key == Key::CycleStart);
        hold("a run starts while an axis oscillates by the key", !(starts && oscillated))
    }

    /// "What stops what", row of RESET.
    fn check_reset(&mut self, moment: &Moment<'_>, before: OutputSet) -> Result<(), String> {
        let on = moment.outputs_on;
        let starts = |command: &Command| matches!(command, Command::Press(_) | Command::Mdi(_));
        if matches!(moment.commands, [Command::Press(Key::Reset)]) {
            self.reset_at = Some(moment.now);
            for output in WORK_DRIVES {
                hold_output("is on after RESET", output, !on.has(output))?;
            }
            // An alarm of the same tick stops more than RESET does.
            let undisturbed =
                !moment.is_e_stopped() && moment.machine.read.bus_alive && moment.reported.state != RunState::Alarm;
            for output in LEFT_BY_RESET.into_iter().filter(|_| undisturbed) {
                hold_output("changes by RESET", output, before.has(output) == on.has(output))?;
            }
        } else if moment.commands.iter().any(starts) || moment.machine.is_active(Input::ExternalStart) {
            self.reset_at = None;
        }
        let over = self.reset_at.is_none_or(|at| moment.now.since(at) <= BRAKING);
        hold("a run goes on after RESET", over || !moment.reported.state.is_active())
    }
}
