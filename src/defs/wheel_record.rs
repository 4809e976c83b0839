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
    /// Times it was dressed.
    pub dressings: u32,
    /// When it was last mounted.
    pub mounted: Option<DateTime>,
    /// When it was last balanced.
    pub balanced: Option<DateTime>,
    /// Times that it has hit something, and when last.
    pub crashes: u32,
    /// When it has last hit something.
    pub crashed: Option<DateTime>,
}

impl WheelRecord {
    /// Whether it is worn down.
    #[must_use]
    pub fn is_worn(&self) -> bool {
        self.smallest_mm > 0.0 && self.diameter_mm <= self.smallest_mm
    }

    /// Whether it has hit something since it was last balanced: it is to be looked at and sounded before it turns.
    #[must_use]
    pub fn is_suspect(&self) -> bool {
        self.crashed.is_some_and(|crashed| self.balanced.is_none_or(|balanced| balanced < crashed))
    }
}
