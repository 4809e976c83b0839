//! Tailstock: one valve with two end switches.
//! Source: spec K3.3. The output stays on while the part is clamped; reset and e-stop do not switch it.

use crate::defs::alarm;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet};
use crate::units::Micros;

/// State of the quill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tailstock {
    /// Valve off, retracted.
    Resting,
    /// Valve on, advancing.
    Advancing { since: Micros },
    /// Valve on, part clamped.
    Holding,
    /// Valve off, retracting.
    Retracting { since: Micros },
    /// The end-switch signal did not come or was lost: neither clamped nor retracted.
    Lost { valve: bool },
}

impl Tailstock {
    pub fn advance(&mut self, now: Micros) {
        *self = match *self {
            Self::Resting | Self::Lost { .. } | Self::Retracting { .. } => Self::Advancing { since: now },
            Self::Advancing { since } => Self::Advancing { since },
            Self::Holding => Self::Holding,
        };
    }

    pub fn retract(&mut self, now: Micros) {
        *self = match *self {
            Self::Holding | Self::Lost { .. } | Self::Advancing { .. } => Self::Retracting { since: now },
            Self::Retracting { since } => Self::Retracting { since },
            Self::Resting => Self::Resting,
        };
    }

    pub const fn is_moving(self) -> bool {
        matches!(self, Self::Advancing { .. } | Self::Retracting { .. })
    }

    pub const fn is_advanced(self) -> bool {
        matches!(self, Self::Holding)
    }

    /// The switch signal went or did not come while the valve is on: the part may be loose.
    pub const fn is_lost(self) -> bool {
        matches!(self, Self::Lost { valve: true })
    }

    /// The valve output.
    pub const fn output(self) -> bool {
        matches!(self, Self::Advancing { .. } | Self::Holding | Self::Lost { valve: true })
    }

    /// Feedback and time-out. Without an assigned end switch, the elapsed time counts as feedback.
    pub fn watch(&mut self, now: Micros, inputs: InputSet, params: &Params) -> Option<u16> {
        let (since, switch, there) = match *self {
            Self::Advancing { since } => (since, Input::TailstockAdvanced, Self::Holding),
            Self::Retracting { since } => (since, Input::TailstockRetracted, Self::Resting),
            Self::Holding => {
                if params.input_port(Input::TailstockAdvanced) != 0 && !inputs.has(Input::TailstockAdvanced) {
                    *self = Self::Lost { valve: true };
                    return Some(alarm::TAILSTOCK_LOST);
                }
                return None;
            }
            Self::Resting | Self::Lost { .. } => return None,
        };
        let late = now.since(since) >= Micros::from_millis_f64(params.get(param::TAILSTOCK_TIME));
        let has_switch = params.input_port(switch) != 0;
        let arrived = inputs.has(switch) || late && !has_switch;
        if arrived {
            *self = there;
        } else if late {
            *self = Self::Lost { valve: self.output() };
        }
        (late && !arrived).then_some(alarm::TAILSTOCK_TIMEOUT)
    }
}
