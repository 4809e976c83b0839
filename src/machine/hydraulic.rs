//! Hydraulics: pump output and pressure supervision.
//! Source: spec K3.5–K3.7. Reset and e-stop do not switch the pump.

use super::MachineFinding;
use crate::defs::alarm;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet};
use crate::defs::text::Text;
use crate::units::Micros;

/// Alarm 180 where no wheel is concerned.
const NO_PRESSURE: Text = Text::new("没有液压压力", "no hydraulic pressure");

/// State of alarm 180.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum PressureAlarm {
    #[default]
    Clear,
    /// Clears itself when the signal returns.
    Present,
    /// A wheel start was refused: clears when the start would be granted.
    StartRefused,
    /// Stopped the wheel or a program: cleared by RESET once the signal is back.
    Latched,
}

/// The pump and its pressure switch.
#[derive(Clone, Debug, Default)]
pub struct Hydraulic {
    on: bool,
    /// Power-on or last switching-on; the pressure is due `HYDRAULIC_DELAY` later. `None`: already due.
    since: Option<Micros>,
    alarm: PressureAlarm,
    refused_start: bool,
    acknowledged: bool,
    /// A running pump was switched off by key or M15: its pressure may go.
    commanded_off: bool,
    /// The pressure was missing before the open run began; the pump has not been switched on since.
    missing_before_run: bool,
}

impl Hydraulic {
    pub fn new(power_on: Micros) -> Self {
        Self { since: Some(power_on), ..Self::default() }
    }

    pub fn make_ready(&mut self) {
        self.on = true;
        self.since = None;
    }

    pub const fn is_on(&self) -> bool {
        self.on
    }

    /// Alarm 180 is active.
    pub fn has_alarm(&self) -> bool {
        self.alarm != PressureAlarm::Clear
    }

    /// Alarm 180 stopped the wheel or a program and waits for RESET.
    pub fn is_latched(&self) -> bool {
        self.alarm == PressureAlarm::Latched
    }

    pub fn switch_on(&mut self, now: Micros) {
        if !self.on {
            (self.on, self.commanded_off) = (true, false);
            self.since = Some(now);
        }
    }

    pub fn switch_off(&mut self) {
        self.commanded_off |= self.on;
        self.on = false;
    }

    /// On for at least the hydraulic delay P270.
    pub fn is_settled(&self, now: Micros, params: &Params) -> bool {
        self.on && self.is_due(now, params.millis(param::HYDRAULIC_DELAY))
    }

    fn is_due(&self, now: Micros, delay: Micros) -> bool {
        self.since.is_none_or(|since| now.since(since) >= delay)
    }

    pub fn note_refused_start(&mut self) {
        self.refused_start = true;
    }

    /// The state as small numbers; `age` returns the ticks since a moment.
    pub fn discrete(&self, age: impl Fn(Micros) -> u8) -> [u8; 2] {
        let since = self.since.map_or(4, age);
        let flags = [self.on, self.refused_start, self.acknowledged, self.commanded_off, self.missing_before_run];
        let flags = flags.iter().fold(0, |all, flag| all << 1 | u8::from(*flag));
        [since * 4 + self.alarm as u8, flags]
    }

    /// RESET: the next tick clears a latched alarm if its cause is gone.
    pub fn acknowledge(&mut self) {
        self.acknowledged = true;
    }

    /// K3.7, each tick. Supervised from P270 after power-on and after each switching-on; pressure that goes because a
    /// running pump was switched off is no alarm, unless the wheel runs. A run that does not need the wheel stops when its pump loses the
    /// pressure or does not get it, not because of an alarm that was there before.
    pub fn supervise(
        &mut self,
        now: Micros,
        inputs: InputSet,
        params: &Params,
        wheel_on: bool,
        run_open: bool,
    ) -> Option<MachineFinding> {
        let delay = params.millis(param::HYDRAULIC_DELAY);
        let looked_at = !params.bit(param::NO_HYDRAULIC_CHECK) && delay > Micros::ZERO;
        let due = self.is_due(now, delay);
        let missing = looked_at && due && (wheel_on || !self.commanded_off) && !inputs.has(Input::HydraulicPressure);
        self.missing_before_run = missing && (!run_open || self.missing_before_run);
        let stops = missing && (wheel_on || run_open && self.on && !self.missing_before_run);
        let pressure_ok = !looked_at || inputs.has(Input::HydraulicPressure);
        let refused = std::mem::take(&mut self.refused_start);
        let acknowledged = std::mem::take(&mut self.acknowledged);
        let granted = self.on && due && pressure_ok;
        let next = match self.alarm {
            PressureAlarm::Latched if acknowledged && pressure_ok => PressureAlarm::Clear,
            PressureAlarm::Latched => PressureAlarm::Latched,
            PressureAlarm::Clear | PressureAlarm::Present | PressureAlarm::StartRefused
                if stops || refused && run_open =>
            {
                PressureAlarm::Latched
            }
            PressureAlarm::Clear | PressureAlarm::Present if refused => PressureAlarm::StartRefused,
            PressureAlarm::Clear | PressureAlarm::Present if missing => PressureAlarm::Present,
            // Switching the pump again does not clear the alarm: only the signal does.
            PressureAlarm::Present if !pressure_ok => PressureAlarm::Present,
            PressureAlarm::Clear | PressureAlarm::Present => PressureAlarm::Clear,
            PressureAlarm::StartRefused if granted || !looked_at => PressureAlarm::Clear,
            PressureAlarm::StartRefused => PressureAlarm::StartRefused,
        };
        let before = std::mem::replace(&mut self.alarm, next);
        match (before, next) {
            (before, next) if before == next => None,
            (_, PressureAlarm::Clear) => Some(MachineFinding::Cleared(alarm::HYDRAULIC_PRESSURE)),
            (_, PressureAlarm::Present | PressureAlarm::StartRefused | PressureAlarm::Latched) => {
                // The text of the table speaks of the wheel.
                let of_wheel = wheel_on || refused || next == PressureAlarm::StartRefused;
                let (number, stopped) = (alarm::HYDRAULIC_PRESSURE, next == PressureAlarm::Latched);
                Some(MachineFinding::Alarm { number, stopped, title: (!of_wheel).then_some(NO_PRESSURE) })
            }
        }
    }
}
