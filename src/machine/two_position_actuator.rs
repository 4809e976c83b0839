//! A two-position actuator with a switch at each end: gauge arms and gears.
//!
//! Without an assigned switch nothing is supervised: an arm arrives at once, a gear after its time.
//! Source: spec K3.9, K3.10, K4.5, B4.

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

    /// Checks the end switch (`None`: not assigned); true on time-out. `most` is the time-out, `unseen` the time
    /// without a switch.
    pub fn supervise(&mut self, now: Micros, at_end: Option<bool>, most: Micros, unseen: Micros) -> bool {
        let Self::Moving { since } = *self else { return false };
        let gone = now.since(since);
        if at_end.unwrap_or(gone >= unseen) {
            *self = Self::InPosition;
        } else if at_end.is_some() && gone >= most {
            *self = Self::TimedOut;
            return true;
        }
        false
    }
}
