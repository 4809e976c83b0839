//! A two-position actuator with a switch at each end: gauge arms and gears.
//!
//! Without an assigned switch nothing is supervised: an arm arrives at once, a gear after its time.
//! Source: spec K3.9, K3.10, K4.5, B4.

use crate::defs::param::{NumberParam, Params};
use crate::defs::signal::{Input, InputSet};
use crate::units::Micros;

/// State of the actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TwoPositionActuator {
    /// At the commanded position.
    InPosition,
    /// Moving.
    Moving { since: Micros },
    /// The switch did not respond in time.
    TimedOut,
}

impl TwoPositionActuator {
    pub fn start(&mut self, now: Micros) {
        *self = Self::Moving { since: now };
    }

    pub const fn is_moving(self) -> bool {
        matches!(self, Self::Moving { .. })
    }

    /// Checks the switch; true on time-out. `most` is the time-out, `unseen` the time without a switch.
    pub fn supervise(
        &mut self,
        now: Micros,
        (switch, inputs): (Input, InputSet),
        params: &Params,
        most: NumberParam,
        unseen: Micros,
    ) -> bool {
        let Self::Moving { since } = *self else { return false };
        let gone = now.since(since);
        if params.input_port(switch) == 0 {
            if gone >= unseen {
                *self = Self::InPosition;
            }
            return false;
        }
        if inputs.has(switch) {
            *self = Self::InPosition;
        } else if gone >= params.millis(most) {
            *self = Self::TimedOut;
            return true;
        }
        false
    }
}
