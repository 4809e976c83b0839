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
    Retracted,
    /// Valve on, advancing.
    Advancing { since: Micros },
    /// Valve on, part clamped.
    Clamped,
    /// Valve off, retracting.
    Retracting { since: Micros },
    /// The end-switch signal did not come or was lost: neither clamped nor retracted.
    Lost { valve: bool },
}

impl Tailstock {
    pub fn advance(&mut self, now: Micros) {
        *self = match *self {
            Self::Retracted | Self::Lost { .. } | Self::Retracting { .. } => Self::Advancing { since: now },
            there @ (Self::Advancing { .. } | Self::Clamped) => there,
        };
    }

    pub fn retract(&mut self, now: Micros) {
        *self = match *self {
            Self::Clamped | Self::Lost { .. } | Self::Advancing { .. } => Self::Retracting { since: now },
            there @ (Self::Retracting { .. } | Self::Retracted) => there,
        };
    }

    pub const fn is_moving(self) -> bool {
        matches!(self, Self::Advancing { .. } | Self::Retracting { .. })
    }

    pub const fn is_advanced(self) -> bool {
        matches!(self, Self::Clamped)
    }

    /// The switch signal went or did not come: the part may be loose, or the quill stands somewhere on its way.
    pub const fn is_lost(self) -> bool {
        matches!(self, Self::Lost { .. })
    }

    /// The valve output.
    pub const fn output(self) -> bool {
        matches!(self, Self::Advancing { .. } | Self::Clamped | Self::Lost { valve: true })
    }

    /// Feedback and time-out. Without an assigned end switch, the elapsed time counts as feedback.
    pub fn supervise(&mut self, now: Micros, inputs: InputSet, params: &Params) -> Option<u16> {
        let (since, switch, there) = match *self {
            Self::Advancing { since } => (since, Input::TailstockAdvanced, Self::Clamped),
            Self::Retracting { since } => (since, Input::TailstockRetracted, Self::Retracted),
            Self::Clamped
                if params.input_port(Input::TailstockAdvanced) != 0 && !inputs.has(Input::TailstockAdvanced) =>
            {
                *self = Self::Lost { valve: true };
                return Some(alarm::TAILSTOCK_SIGNAL_LOST);
            }
            Self::Clamped | Self::Retracted | Self::Lost { .. } => return None,
        };
        let late = now.since(since) >= Micros::from_millis_f64(params.get(param::TAILSTOCK_TIMEOUT));
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
