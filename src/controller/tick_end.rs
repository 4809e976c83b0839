//! End of a tick: completed stops, drives and outputs.
//! Source: spec B5, K5.15, table "what stops what".

use super::actions::ActionStatus;
use super::run::Origin;
use super::{ControlEvent, ControlPhase, Controller, FULL_SCALE_VOLTS};
use crate::defs::param;
use crate::defs::signal::{Output, OutputSet, Terminals};
use crate::defs::text::LocalizedText;

impl Controller {
    /// Applies an event to the phase; the phase changes only here (homing updates its own state in place).
    pub(super) fn transition(&mut self, event: ControlEvent) {
        let before = self.phase.is_pause();
        self.phase = std::mem::take(&mut self.phase).after(event);
        if self.phase.is_pause() && !before {
            self.record_running_spindles();
        }
    }

    /// Brakes all motion; the run ends once the axes are at rest.
    pub(super) fn abort_run(&mut self) {
        self.jog.stop_all();
        self.waiting_for = None;
        self.repeats_left = 0;
        if matches!(self.phase, ControlPhase::Aborting)
            || matches!(self.phase, ControlPhase::Idle) && self.axes.is_at_rest()
        {
            return;
        }
        self.axes.brake();
        self.transition(ControlEvent::Abort);
    }

    /// Handles the end of braking and the drive state.
    pub(super) fn finish_braking(&mut self) {
        let rest = self.axes.is_at_rest();
        if rest && matches!(self.phase, ControlPhase::Holding | ControlPhase::Aborting) {
            if matches!(self.phase, ControlPhase::Aborting) {
                self.close_run();
                self.abandon_retract();
            }
            let held = matches!(self.phase, ControlPhase::Holding);
            self.transition(ControlEvent::AtRest);
            if held && !self.retract_if_requested() {
                self.withdraw_wheel();
            }
        }
        self.axes.set_drives(self.drives_on);
        if !self.drives_on && rest {
            self.release_machine_lock();
            self.axes.follow_actual();
        }
    }

    /// MSG: shown until replaced; an empty text ends it.
    pub(super) fn show_program_message(&mut self, text: &LocalizedText) -> ActionStatus {
        self.pages.program_message = (!text.zh.is_empty()).then(|| text.clone());
        if self.pages.program_message.is_some() {
            self.show_note(text.clone());
        }
        ActionStatus::Done
    }

    /// A program start clears the program message; an MDI line keeps it.
    pub(super) fn clear_program_message(&mut self, mdi: bool) {
        self.pages.program_message = self.pages.program_message.take().filter(|_| mdi);
    }

    /// Closes the run and discards items not yet executed.
    pub(super) fn close_run(&mut self) {
        if let Some(run) = self.run.take().filter(|run| run.origin != Origin::Retract) {
            if run.origin == Origin::Program {
                self.clear_run_position();
            }
            self.cycle_time = self.now.since(run.started_at);
            self.mdi_modals = (run.origin == Origin::Mdi).then(|| *run.interpreter.modals());
        }
        self.waiting_for = None;
        self.lathe.homing = None;
        self.axes.switch_to_manual();
    }

    /// The outputs that are on now, and their terminals.
    pub(super) fn outputs_now(&self) -> (OutputSet, Terminals) {
        let mut on = self.machine.outputs(&self.params);
        // K5.15: red for an alarm that stops or blocks, yellow for a program that waits, green for work.
        on.set(Output::TowerRed, self.alarms.blocks_start());
        on.set(Output::TowerGreen, matches!(self.phase, ControlPhase::Running | ControlPhase::Homing(_)));
        on.set(
            Output::TowerYellow,
            matches!(self.phase, ControlPhase::Holding | ControlPhase::Held | ControlPhase::Stopped),
        );
        // K6.1, K2.4: an output without a port of its own stays off, and so does its lamp.
        let on = on.without(self.unusable_outputs);
        let mut terminals = self.machine.port_terminals();
        for output in on.iter() {
            terminals.set(self.params.output_port(output), true);
        }
        (on, terminals)
    }

    pub(super) fn write_outputs(&mut self) {
        let on;
        (on, self.outputs.terminals) = self.outputs_now();
        self.output_set = on;
        let volts = |rpm: f64, most: f64| (FULL_SCALE_VOLTS * rpm / most).clamp(0.0, FULL_SCALE_VOLTS);
        let wheel = if on.has(Output::Wheel) || self.machine.spindle_direction().is_some() {
            self.output_wheel_rpm()
        } else {
            0.0
        };
        self.outputs.wheel_volts = volts(wheel, self.params.get(param::WHEEL_RPM_MAX));
        let drive = if self.machine.drive_is_on() { self.analog_2_rpm } else { 0.0 };
        self.outputs.analog_2_volts = volts(drive, self.params.get(param::ANALOG_2_RPM_MAX));
        // Braking needs the drives even while they are to be off.
        self.outputs.drives_on = self.drives_on || matches!(self.phase, ControlPhase::Aborting);
        self.outputs.set_point_mm = self.axes.encoder_set_points();
    }

    /// Finds the outputs that have no port or share one with another function.
    pub(super) fn update_unusable_outputs(&mut self) {
        let mut dead = OutputSet::NONE;
        for output in Output::ALL {
            let lost = self.params.output_port(*output) == 0;
            dead.set(*output, lost || self.params.output_conflict(self.kind, *output).is_some());
        }
        self.unusable_outputs = dead;
    }

    /// Terminals that keep their level in the safe state: spindles and fluids off, clamps hold (table after K3).
    #[must_use]
    pub fn kept_in_safe_state(&self) -> Terminals {
        let mut kept = Terminals(u64::MAX);
        for output in crate::machine::OFF_IN_SAFE_STATE {
            kept.set(self.params.output_port(*output), false);
        }
        kept
    }
}
