//! The discrete state of all units as small numbers, with short ages only.
//!
//! Two machines with equal discrete states answer every request alike and have the same future, if no delay is
//! longer than [`MAX_AGE_TICKS`] ticks. The exhaustive search in `tests/long/machine_explore.rs` relies on this.

use super::Machine;
use super::magnetic_chuck::MagneticChuck;
use super::tailstock::Tailstock;
use super::wheel::{SecondSpindleContactor, WheelContactor, WorkpieceDrive};
use crate::units::Micros;

/// Ages are counted in ticks and saturate here.
pub const MAX_AGE_TICKS: u64 = 3;

/// One number per unit that takes part in interlocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DiscreteState(pub [u8; 10]);

impl Machine {
    /// The discrete state at a moment, for ticks of this length.
    #[must_use]
    pub fn discrete_state(&self, now: Micros, tick: Micros) -> DiscreteState {
        let age = |since: Micros| (now.since(since).0 / tick.0.max(1)).min(MAX_AGE_TICKS) as u8;
        let wheel = match self.wheel {
            WheelContactor::Off => 0,
            WheelContactor::Running => 1,
            WheelContactor::RunUp { since } => 2 + age(since),
        };
        let drive = match self.workpiece_drive {
            WorkpieceDrive::Off => 0,
            WorkpieceDrive::Running { fast } => 1 + u8::from(fast),
            WorkpieceDrive::RunUp { fast, since } => 4 + 4 * u8::from(fast) + age(since),
        };
        let second = match self.second_spindle {
            SecondSpindleContactor::Off => 0,
            SecondSpindleContactor::Turning { ccw } => 1 + u8::from(ccw),
            SecondSpindleContactor::Reversing { ccw, since } => 4 + 4 * u8::from(ccw) + age(since),
        };
        let tailstock = match self.tailstock {
            Tailstock::Retracted => 0,
            Tailstock::Clamped => 1,
            Tailstock::Lost { valve } => 2 + u8::from(valve),
            Tailstock::Advancing { since } => 4 + age(since),
            Tailstock::Retracting { since } => 8 + age(since),
        };
        let magnet = match self.magnet {
            MagneticChuck::Off => 0,
            MagneticChuck::Holding => 1,
            MagneticChuck::Magnetising { since } => 4 + age(since),
            MagneticChuck::Demagnetising { since } => 8 + age(since),
        };
        let guard = &self.guard;
        let flags = [self.e_stop, guard.open, guard.alarm, guard.stopped_drive, self.fluids.coolant];
        let flags = flags.iter().fold(0, |all, flag| all << 1 | u8::from(*flag));
        let (spindle, turret) = (self.main_spindle.discrete(age), self.turret.discrete(age));
        let [pump, pump_flags] = self.hydraulic.discrete(age);
        DiscreteState([wheel, drive, second, tailstock, magnet, flags, pump, pump_flags, spindle, turret])
    }
}
