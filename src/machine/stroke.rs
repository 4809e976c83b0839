//! A two-position actuator with a switch at each end: gauge arms and gears.
//!
//! Without an assigned switch nothing is supervised: an arm arrives at once, a gear after its time.
//! Source: spec K3.9, K3.10, K4.5, B4.

use crate::defs::param::{Number, Params};
use crate::defs::signal::{Input, InputSet};
use crate::units::Micros;

/// State of the actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// At the commanded position.
    There,
    /// Moving.
    Going { since: Micros },
    /// The switch did not respond in time.
    Lost,
}

impl Stroke {
    pub fn send(&mut self, now: Micros) {
        *self = Self::Going { since: now };
    }

    pub const fn is_going(self) -> bool {
        matches!(self, Self::Going { .. })
    }

    /// Checks the switch; true on time-out. `most` is the time-out, `unseen` the time without a switch.
    pub fn watch(
        &mut self,
        now: Micros,
        (switch, inputs): (Input, InputSet),
        params: &Params,
        most: Number,
        unseen: Micros,
    ) -> bool {
        let Self::Going { since } = *self else { return false };
        let gone = now.since(since);
        if params.input_port(switch) == 0 {
            if gone >= unseen {
                *self = Self::There;
            }
            return false;
        }
        if inputs.has(switch) {
            *self = Self::There;
        } else if gone >= params.millis(most) {
            *self = Self::Lost;
            return true;
        }
        false
    }
}
