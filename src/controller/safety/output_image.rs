//! Writes the outputs: functions to terminals, the analog outputs, the drives.
//! Source: spec K5.15, K6.1, K2.4, table "what stops what".

use crate::controller::plant::{ControlPhase, Plant};
use crate::defs::alarm::Reaction;
use crate::defs::param;
use crate::defs::signal::{Output, OutputSet, Terminals};

/// Full scale of the analog outputs, V.
const FULL_SCALE_VOLTS: f64 = 10.0;

impl Plant {
    /// The outputs that are on now, and their terminals.
    pub fn outputs_now(&self) -> (OutputSet, Terminals) {
        let mut on = self.machine.outputs(&self.params);
        // K5.15: red for an alarm that stops or blocks, yellow for a program that waits, green for work.
        on.set(Output::TowerRed, self.alarms.has_reaction(Reaction::BlockWheel));
        on.set(Output::TowerGreen, matches!(self.execution.phase, ControlPhase::Running | ControlPhase::Homing(_)));
        let waits = matches!(self.execution.phase, ControlPhase::Holding | ControlPhase::Held | ControlPhase::Stopped);
        on.set(Output::TowerYellow, waits);
        // K6.1, K2.4: an output without a port of its own stays off, and so does its lamp.
        let on = on.without(self.outputs.unusable);
        let mut terminals = self.machine.port_terminals();
        for output in on.iter() {
            terminals.set(self.params.output_port(output), true);
        }
        (on, terminals)
    }

    pub fn write_outputs(&mut self) {
        let on;
        (on, self.outputs.image.terminals) = self.outputs_now();
        self.outputs.on = on;
        let volts = |rpm: f64, most: f64| (FULL_SCALE_VOLTS * rpm / most).clamp(0.0, FULL_SCALE_VOLTS);
        let turns = on.has(Output::Wheel) || self.machine.spindle_direction().is_some();
        let wheel = if turns { self.output_wheel_rpm() } else { 0.0 };
        self.outputs.image.wheel_volts = volts(wheel, self.params.get(param::WHEEL_RPM_MAX));
        let drive = if self.machine.drive_is_on() { self.spindles.analog_2_rpm } else { 0.0 };
        self.outputs.image.analog_2_volts = volts(drive, self.params.get(param::ANALOG_2_RPM_MAX));
        // Braking needs the drives even while they are to be off.
        self.outputs.image.drives_on = self.outputs.drives_on || matches!(self.execution.phase, ControlPhase::Aborting);
        self.outputs.image.awaited_signal = self.execution.awaited_signal;
        self.outputs.image.fault_reset = std::mem::take(&mut self.outputs.fault_reset);
        self.outputs.image.set_point_mm = self.axes.encoder_set_points();
    }

    /// Finds the outputs that have no port or share one with another function.
    pub fn update_unusable_outputs(&mut self) {
        let mut dead = OutputSet::NONE;
        for output in Output::ALL {
            let lost = self.params.output_port(*output) == 0;
            dead.set(*output, lost || self.params.output_conflict(*output).is_some());
        }
        self.outputs.unusable = dead;
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
