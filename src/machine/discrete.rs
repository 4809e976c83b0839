//! The discrete state of all units as small numbers, with short ages only.
//!
//! Two machines with equal discrete states answer every request alike and have the same future, if no delay is
//! longer than [`AGE_MOST`] ticks. The exhaustive search in `tests/long/machine_explore.rs` relies on this.

use super::Machine;
use super::magnet::Magnet;
use super::tailstock::Tailstock;
use super::wheel::{Drive, SecondSpindle, Wheel};
use crate::units::Micros;

/// Ages are counted in ticks and saturate here.
pub const AGE_MOST: u64 = 3;

/// One number per unit that takes part in interlocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Discrete(pub [u8; 9]);

impl Machine {
    /// The discrete state at a moment, for ticks of this length.
    #[must_use]
    pub fn discrete(&self, now: Micros, tick: Micros) -> Discrete {
        let age = |since: Micros| (now.since(since).0 / tick.0.max(1)).min(AGE_MOST) as u8;
        let wheel = match self.wheel {
            Wheel::Off => 0,
            Wheel::Running => 1,
            Wheel::RunUp { since } => 2 + age(since),
        };
        let drive = match self.drive {
            Drive::Off => 0,
            Drive::Running { fast } => 1 + u8::from(fast),
            Drive::RunUp { fast, since } => 4 + 4 * u8::from(fast) + age(since),
        };
        let second = match self.second_spindle {
            SecondSpindle::Off => 0,
            SecondSpindle::Turning { ccw } => 1 + u8::from(ccw),
            SecondSpindle::Reversing { ccw, since } => 4 + 4 * u8::from(ccw) + age(since),
        };
        let tailstock = match self.tailstock {
            Tailstock::Resting => 0,
            Tailstock::Holding => 1,
            Tailstock::Lost { valve } => 2 + u8::from(valve),
            Tailstock::Advancing { since } => 4 + age(since),
            Tailstock::Retracting { since } => 8 + age(since),
        };
        let magnet = match self.magnet {
            Magnet::Off => 0,
            Magnet::Holding => 1,
            Magnet::Magnetising { since } => 4 + age(since),
            Magnet::Demagnetising { since } => 8 + age(since),
        };
        let guard = &self.guard;
        let flags = [self.e_stop, guard.open, guard.alarm, guard.stopped_drive, self.fluids.coolant];
        let flags = flags.iter().fold(0, |all, flag| all << 1 | u8::from(*flag));
        let (spindle, post) = (self.spindle.discrete(age), self.post.discrete(age));
        Discrete([wheel, drive, second, tailstock, magnet, flags, self.hydraulic.discrete(age), spindle, post])
    }
}
