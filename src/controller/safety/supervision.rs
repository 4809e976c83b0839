//! Supervision: findings of the machine logic, and the control's own checks of drives, limits, bus and screen.
//! Source: spec B5, B8, K3.7, table "what stops what".

use super::alarms::AlarmWords;
use crate::controller::plant::Plant;
use crate::defs::alarm;
use crate::defs::param;
use crate::defs::signal::Input;
use crate::defs::text::{LocalizedText, phrase};
use crate::link::snapshot::Tone;
use crate::machine::{Consequence, MachineFinding};
use crate::units::Micros;

impl Plant {
    /// One tick of the machine logic.
    pub fn supervise_machine(&mut self) {
        let state = self.control_state();
        for finding in self.machine.tick(self.now, self.inputs.filtered, &self.params, state).into_iter().flatten() {
            match finding {
                MachineFinding::Alarm { number, stopped, title } => {
                    self.raise_with_reaction(number, title.into(), stopped)
                }
                MachineFinding::Cleared(number) => self.alarms.clear(number),
                MachineFinding::Message(why) => self.refuse(why),
            }
        }
    }

    /// Drives, limit switches, bus and following errors.
    pub fn supervise_axes(&mut self) {
        if !self.inputs.image.bus_alive {
            self.raise(alarm::BUS_LOST, None);
            // Nobody has watched the encoders meanwhile, and a drive without power starts to count anew.
            self.axes.clear_homed();
        }
        if self.inputs.image.station_silent {
            self.raise(alarm::STATION_SILENT, None);
        }
        if self.inputs.image.inverter_tripped {
            self.raise(alarm::INVERTER_FAULT, None);
        }
        let limits = [
            (Input::LimitXPlus, Input::LimitXMinus),
            (Input::LimitYPlus, Input::LimitYMinus),
            (Input::LimitZPlus, Input::LimitZMinus),
        ];
        self.supervise_drives();
        for axis in self.axes.present() {
            let name = || Some(phrase!("{axis}", "{axis}", axis));
            let (plus, minus) = limits[axis as usize];
            for (bit, switch) in [(0, plus), (1, minus)] {
                let mask = 1 << (2 * axis as u8 + bit);
                let pressed = self.inputs.filtered.has(switch);
                // Only the edge counts: after RESET the axis must be able to leave the switch.
                if pressed && self.inputs.limit_switches & mask == 0 {
                    self.alarms.clear(alarm::HARD_LIMIT);
                    self.raise(alarm::HARD_LIMIT, name());
                    self.axes.clear_homed();
                    // A homed axis cannot get there: its soft limit is before it.
                    self.axes.doubt(axis);
                }
                if pressed { self.inputs.limit_switches |= mask } else { self.inputs.limit_switches &= !mask }
            }
        }
        if self.drives_follow()
            && let Some(axis) = self.axes.first_following_error(&self.params)
        {
            self.raise(alarm::FOLLOWING_ERROR, Some(phrase!("{axis}", "{axis}", axis)));
            self.axes.clear_homed();
        }
        self.adopt_absolute_positions();
    }

    /// Keep-alive of the screen.
    pub fn supervise_screen(&mut self) {
        if self.is_screen_silent() {
            self.raise(alarm::HMI_LOST, None);
        }
    }

    /// The screen was there and has not been heard for the time P76.
    fn is_screen_silent(&self) -> bool {
        let longest = Micros::from_millis_f64(self.params.get(param::HMI_KEEP_ALIVE));
        self.operator.screen_alive_at.is_some_and(|heard| self.now.since(heard) > longest)
    }

    /// RESET: clears the alarms whose cause is gone and resets what tripped; the drives go on if nothing forbids it.
    pub fn reset(&mut self) {
        self.reset_alarms();
        self.begin_fault_reset();
    }

    /// Clears the alarms whose cause is gone; the drives go on if nothing forbids it.
    pub(super) fn reset_alarms(&mut self) {
        let e_stop = self.machine.is_e_stopped();
        let bus = self.inputs.image.bus_alive;
        let silent = self.inputs.image.station_silent;
        let inverter = self.inputs.image.inverter_tripped;
        let limits = self.inputs.limit_switches;
        let screen = self.is_screen_silent();
        let supply = self.inputs.filtered.has(Input::PowerFail);
        let drives = self.has_drive_fault();
        self.alarms.reset(|number| match number {
            alarm::EMERGENCY_STOP => e_stop,
            alarm::POWER_FAIL => supply,
            alarm::BUS_LOST => !bus,
            alarm::STATION_SILENT => silent,
            alarm::INVERTER_FAULT => inverter,
            alarm::DRIVE_FAULT => drives,
            alarm::HMI_LOST => screen,
            alarm::HARD_LIMIT => limits != 0,
            _ => false,
        });
        self.outputs.drives_on = !(e_stop || !bus || silent || inverter || drives || supply);
    }

    /// Raises an alarm and executes its reaction.
    pub fn raise(&mut self, number: u16, detail: Option<LocalizedText>) {
        self.raise_with_reaction(number, detail.into(), false);
    }

    fn raise_with_reaction(&mut self, number: u16, words: AlarmWords, stopped: bool) {
        if !self.alarms.has(number) {
            let block = self.execution.current_block;
            let place = self.execution.phase.is_run_open().then_some((block.program, block.line));
            self.alarms.raise(number, words, place);
            if let Some(alarm) = self.alarms.present().last().filter(|_| self.outbox.message.since < self.now) {
                let text = alarm.text.clone();
                self.show(text, Tone::Refused);
            }
        } else if !stopped {
            return;
        }
        if number == alarm::TAILSTOCK_SIGNAL_LOST {
            self.stop_oscillation(); // the part may be loose
        }
        match Consequence::of(number, stopped) {
            Consequence::Nothing => {}
            Consequence::Hold => self.hold_run(),
            Consequence::Abort => self.abort_run(),
            Consequence::AbortAndStop => {
                self.machine.stop_wheel_and_drive();
                self.abort_run();
            }
            Consequence::AbortAndMakeSafe => {
                self.stop_oscillation();
                self.machine.safe_stop();
                self.abort_run();
                self.outputs.drives_on = false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controller::PowerOnState;
    use crate::controller::plant::ControlPhase;
    use crate::defs::kind::Kind;
    use crate::io::InputImage;
    use crate::units::Axis;

    fn plant(bus_alive: bool) -> Plant {
        let image = InputImage { bus_alive, ..InputImage::default() };
        Plant::new(Kind::Gc, PowerOnState::factory(Kind::Gc), image, Micros::ZERO)
    }

    #[test]
    fn b8_a_lost_bus_takes_the_drives_until_it_is_back_and_reset() {
        let mut plant = plant(false);
        plant.jog.press_jog_key(Axis::X, 1.0, Micros::ZERO);
        plant.supervise_axes();
        assert!(plant.alarms.has(alarm::BUS_LOST) && !plant.outputs.drives_on && !plant.jog.is_active());
        assert!(matches!(plant.execution.phase, ControlPhase::Idle), "nothing moved: nothing has to brake");
        plant.reset_alarms();
        assert!(plant.alarms.has(alarm::BUS_LOST) && !plant.outputs.drives_on, "its cause is still there");
        plant.inputs.image.bus_alive = true;
        plant.reset_alarms();
        assert!(!plant.alarms.has(alarm::BUS_LOST) && plant.outputs.drives_on);
    }

    #[test]
    fn b5_a_limit_switch_counts_at_its_edge() {
        let mut plant = plant(true);
        plant.inputs.filtered.set(Input::LimitZMinus, true);
        plant.supervise_axes();
        assert!(plant.alarms.has(alarm::HARD_LIMIT) && plant.is_on_limit_switch(Axis::Z, -1.0));
        assert!(!plant.is_on_limit_switch(Axis::Z, 1.0) && !plant.is_on_limit_switch(Axis::X, -1.0));
        plant.alarms.clear(alarm::HARD_LIMIT);
        plant.supervise_axes();
        assert!(!plant.alarms.has(alarm::HARD_LIMIT), "the axis must be able to leave it");
    }
}
