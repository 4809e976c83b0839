//! The oscillation cylinder: one valve per direction, one switch per end.
//! Source: spec K4.4. Reset and e-stop switch both valves off.

use crate::defs::alarm;
use crate::defs::param::{self, NumberParam, Params};
use crate::defs::signal::{Input, InputSet, Output, OutputSet};
use crate::units::Micros;

/// Unit of P235 and P236, ms.
const DWELL_UNIT_MS: f64 = 4.0;

/// Step of the cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cylinder {
    /// Both valves off.
    #[default]
    Off,
    /// Moving to the forward end.
    Forward { since: Micros },
    /// Dwell at the forward end.
    DwellForward { since: Micros },
    /// Moving to the backward end.
    Backward { since: Micros },
    /// Dwell at the backward end.
    DwellBackward { since: Micros },
}

impl Cylinder {
    pub fn start(&mut self, now: Micros) {
        if *self == Self::Off {
            *self = Self::Forward { since: now };
        }
    }

    pub fn is_on(self) -> bool {
        self != Self::Off
    }

    pub fn write_outputs(self, on: &mut OutputSet) {
        on.set(Output::OscillationForward, matches!(self, Self::Forward { .. }));
        on.set(Output::OscillationBackward, matches!(self, Self::Backward { .. }));
    }

    /// One tick; `flags` are #438 and #439. Returns an alarm, which ends the cycle.
    pub fn tick(&mut self, now: Micros, inputs: InputSet, params: &Params, flags: &mut (bool, bool)) -> Option<u16> {
        let (ahead, back) = (inputs.has(Input::OscillationForwardEnd), inputs.has(Input::OscillationBackwardEnd));
        let late = |since: Micros| now.since(since) >= params.millis(param::CYLINDER_TIMEOUT);
        let dwelt = |since: Micros, row: NumberParam| {
            now.since(since) >= Micros::from_millis_f64(DWELL_UNIT_MS * params.get(row))
        };
        let next = match *self {
            Self::Off => {
                *flags = (false, false);
                return None;
            }
            _ if ahead && back => None,
            Self::Forward { .. } if ahead => {
                *flags = (true, false);
                Some(Self::DwellForward { since: now })
            }
            Self::Backward { .. } if back => {
                *flags = (false, true);
                Some(Self::DwellBackward { since: now })
            }
            Self::Forward { since } | Self::Backward { since } if late(since) => None,
            Self::DwellForward { since } if dwelt(since, param::OSCILLATION_DWELL_FORWARD) => {
                Some(Self::Backward { since: now })
            }
            Self::DwellBackward { since } if dwelt(since, param::OSCILLATION_DWELL_BACKWARD) => {
                Some(Self::Forward { since: now })
            }
            same @ (Self::Forward { .. } | Self::Backward { .. }) => Some(same),
            same @ (Self::DwellForward { .. } | Self::DwellBackward { .. }) => Some(same),
        };
        *self = next.unwrap_or(Self::Off);
        next.is_none().then_some(alarm::CYLINDER_SWITCHES)
    }
}
