//! Coolant and lubrication: outputs, and supervision by flow and level switches.
//! Source: spec K3.2, K3.8, K5.14.

use super::MachineFinding;
use crate::defs::alarm;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet};
use crate::units::Micros;

/// A supervised switch: its alarm is raised when the signal is missing for a delay, and clears itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SupervisedSwitch {
    /// The signal is there, or not needed.
    #[default]
    Present,
    /// The signal is missing, the delay is not over.
    Missing { since: Micros },
    /// The alarm is active.
    Alarm,
}

impl SupervisedSwitch {
    fn tick(&mut self, now: Micros, missing: bool, delay: Micros, number: u16) -> Option<MachineFinding> {
        let next = match *self {
            _ if !missing => Self::Present,
            Self::Present => Self::Missing { since: now },
            Self::Missing { since } if now.since(since) >= delay => Self::Alarm,
            same @ (Self::Missing { .. } | Self::Alarm) => same,
        };
        let before = std::mem::replace(self, next);
        match (before, next) {
            (before, next) if before == next => None,
            (_, Self::Alarm) => Some(MachineFinding::Alarm { number, stopped: false, title: None }),
            (Self::Alarm, _) => Some(MachineFinding::Cleared(number)),
            (Self::Present | Self::Missing { .. }, Self::Present | Self::Missing { .. }) => None,
        }
    }
}

/// Coolant pump, lubrication pump and their switches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fluids {
    pub coolant: bool,
    pub lubrication: Lubrication,
    flow: SupervisedSwitch,
    level: SupervisedSwitch,
}

/// The lubrication pump: switched by key or code, and by interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lubrication {
    /// Off.
    #[default]
    Off,
    /// Switched on by key or code.
    On,
    /// Switched on by the interval, for P86.
    Dose { since: Micros },
}

impl Lubrication {
    pub fn is_on(self) -> bool {
        self != Self::Off
    }
}

impl Fluids {
    /// One tick. `last_dose`: when the interval last started the pump, or power-on.
    pub fn tick(
        &mut self,
        now: Micros,
        inputs: InputSet,
        params: &Params,
        last_dose: &mut Micros,
    ) -> [Option<MachineFinding>; 2] {
        let interval = Micros::from_secs_f64(60.0 * params.get(param::LUBRICATION_INTERVAL));
        let time = Micros::from_secs_f64(params.get(param::LUBRICATION_TIME));
        match self.lubrication {
            Lubrication::Off if interval > Micros::ZERO && now.since(*last_dose) >= interval => {
                self.lubrication = Lubrication::Dose { since: now };
                *last_dose = now;
            }
            Lubrication::Dose { since } if now.since(since) >= time => self.lubrication = Lubrication::Off,
            Lubrication::Off | Lubrication::On | Lubrication::Dose { .. } => {}
        }
        let absent = |input: Input| params.input_port(input) != 0 && !inputs.has(input);
        let (flow_delay, level_delay) =
            (params.millis(param::COOLANT_FLOW_DELAY), params.millis(param::LUBRICATION_LEVEL_DELAY));
        let (no_flow, low) = (self.coolant && absent(Input::CoolantFlow), absent(Input::LubricationLevel));
        [
            self.flow.tick(now, no_flow, flow_delay, alarm::COOLANT_FLOW),
            self.level.tick(now, low, level_delay, alarm::LUBRICATION_LEVEL),
        ]
    }
}
