//! A unit that goes from one end to the other and is seen by a switch at each: gauge arms and gears.
//!
//! Where no switch is assigned nothing is watched: an arm is there at once, a gear after its time.
//! Source: spec K3.9, K3.10, K4.5, B4.

use crate::defs::param::{Number, Params};
use crate::defs::signal::{Input, InputSet};
use crate::units::Micros;

/// Whether it has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// Standing where it was sent.
    There,
    /// On its way.
    Going { since: Micros },
    /// Its switch did not come in time.
    Lost,
}

impl Stroke {
    pub fn send(&mut self, now: Micros) {
        *self = Self::Going { since: now };
    }

    pub const fn is_going(self) -> bool {
        matches!(self, Self::Going { .. })
    }

    /// Looks for the switch; true when it has not come in time. `most` is the time-out.
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
