//! The wheels of the shop: what is written on them, what has become of them. Retained data.
//! Source: spec K5.17, P2; issue "the face", part 6.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::date::DateTime;

/// Most wheels in the list.
pub const MAX_WHEELS: usize = 20;
/// Numbers of wheels, as written on them.
pub const WHEEL_NUMBERS: RangeInclusive<u16> = 1..=99;

/// A wheel, on the machine or beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WheelRecord {
    /// Its number.
    pub number: u16,
    /// Diameter, mm.
    pub diameter_mm: f64,
    /// Width, mm.
    pub width_mm: f64,
    /// Rated surface speed, m/s.
    pub rated_m_s: f64,
    /// Diameter down to which it is used, mm; 0: not given.
    pub smallest_mm: f64,
    /// Times it was dressed in earlier mountings; those of the present one are P97.
    pub dressings: u32,
    /// It is the one on the machine.
    pub is_mounted: bool,
    /// When it was last mounted.
    pub mounted: Option<DateTime>,
    /// When it was last balanced.
    pub balanced: Option<DateTime>,
    /// Times that it has hit something.
    pub crashes: u32,
    /// When it has last hit something.
    pub crashed: Option<DateTime>,
    /// It has hit something since it was last balanced: it is to be looked at and sounded before it turns.
    pub is_suspect: bool,
}

impl WheelRecord {
    /// Whether it is worn down.
    #[must_use]
    pub fn is_worn(&self) -> bool {
        self.smallest_mm > 0.0 && self.diameter_mm <= self.smallest_mm
    }
}
