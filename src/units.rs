//! Quantities shared by all modules: time, axes and values per axis.
//!
//! Lengths are in millimetres. Feeds are in millimetres per minute where people read them, in millimetres per second
//! inside `motion`. Names end in the unit (`accel_mm_s2`) where no type states it.

mod histogram;
mod position;
mod work_budget;

use std::fmt;
use std::ops::{Add, Index, IndexMut, Sub};

use serde::{Deserialize, Serialize};

pub use histogram::{CHART_CLASSES, Histogram, Percentiles, TimeDistribution};
pub use position::{DisplayPos, EncoderPos, MachinePos, Position, WorkPos};
pub use work_budget::WorkBudget;

/// Millimetres per inch.
pub const MM_PER_INCH: f64 = 25.4;

/// A point in controller time (microseconds since power-on) or a time span in microseconds. Never wall-clock time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Micros(pub u64);

impl Micros {
    /// Power-on, or a zero span.
    pub const ZERO: Self = Self(0);

    /// A span of whole milliseconds.
    #[must_use]
    pub const fn from_millis(millis: u64) -> Self {
        Self(millis * 1_000)
    }

    /// A span from a parameter in milliseconds; negative and non-finite values give zero.
    #[must_use]
    pub fn from_millis_f64(millis: f64) -> Self {
        if millis.is_finite() && millis > 0.0 { Self((millis * 1_000.0).round() as u64) } else { Self::ZERO }
    }

    /// A span in seconds, rounded to the microsecond; negative and non-finite values give zero.
    #[must_use]
    pub fn from_secs_f64(seconds: f64) -> Self {
        Self::from_millis_f64(seconds * 1_000.0)
    }

    /// The span in seconds.
    #[must_use]
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 / 1e6
    }

    /// The time elapsed since `earlier`; zero if `earlier` is later.
    #[must_use]
    pub const fn since(self, earlier: Self) -> Self {
        Self(self.0.saturating_sub(earlier.0))
    }
}

impl Add for Micros {
    type Output = Self;
    fn add(self, span: Self) -> Self {
        Self(self.0 + span.0)
    }
}

impl Sub for Micros {
    type Output = Self;
    fn sub(self, span: Self) -> Self {
        Self(self.0.saturating_sub(span.0))
    }
}

/// A linear axis of the machine. Its direction depends on the kind of machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Axis {
    /// Infeed on GC, table on GS, cross on GA.
    X,
    /// Wheel head down on GS; optional on GC and GA.
    Y,
    /// Table on GC, cross on GS, wheel head down on GA.
    Z,
}

impl Axis {
    /// All axes in the order of their index.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The address letter.
    #[must_use]
    pub const fn letter(self) -> char {
        match self {
            Self::X => 'X',
            Self::Y => 'Y',
            Self::Z => 'Z',
        }
    }

    /// The axis of an address letter, in either case.
    #[must_use]
    pub const fn from_letter(letter: char) -> Option<Self> {
        match letter {
            'X' | 'x' => Some(Self::X),
            'Y' | 'y' => Some(Self::Y),
            'Z' | 'z' => Some(Self::Z),
            _ => None,
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.letter())
    }
}

/// The plane of an arc, seen with the first axis to the right and the second axis up. The order of the axes defines the
/// direction of the arc.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Plane {
    /// G17: first X, second Y.
    Xy,
    /// G18: first Z, second X.
    #[default]
    Zx,
    /// G19: first Y, second Z.
    Yz,
}

impl Plane {
    /// First and second axis.
    #[must_use]
    pub const fn axes(self) -> (Axis, Axis) {
        match self {
            Self::Xy => (Axis::X, Axis::Y),
            Self::Zx => (Axis::Z, Axis::X),
            Self::Yz => (Axis::Y, Axis::Z),
        }
    }

    /// The axis outside the plane.
    #[must_use]
    pub const fn normal_axis(self) -> Axis {
        match self {
            Self::Xy => Axis::Z,
            Self::Zx => Axis::Y,
            Self::Yz => Axis::X,
        }
    }

    /// The G code.
    #[must_use]
    pub const fn g(self) -> u8 {
        match self {
            Self::Xy => 17,
            Self::Zx => 18,
            Self::Yz => 19,
        }
    }
}

/// One value for each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PerAxis<T>(pub [T; 3]);

impl<T> PerAxis<T> {
    /// The value of every axis from a function of the axis.
    #[inline]
    pub fn from_fn(mut f: impl FnMut(Axis) -> T) -> Self {
        // Written out: `[T; 3]::map` is not always inlined.
        Self([f(Axis::X), f(Axis::Y), f(Axis::Z)])
    }

    /// A new value for each axis from the old one.
    #[inline]
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> PerAxis<U> {
        let [x, y, z] = self.0;
        PerAxis([f(x), f(y), f(z)])
    }

    /// Axis and value, in the order X, Y, Z.
    pub fn iter(&self) -> impl Iterator<Item = (Axis, &T)> {
        Axis::ALL.into_iter().zip(self.0.iter())
    }
}

impl<T> Index<Axis> for PerAxis<T> {
    type Output = T;
    fn index(&self, axis: Axis) -> &T {
        &self.0[axis as usize]
    }
}

impl<T> IndexMut<Axis> for PerAxis<T> {
    fn index_mut(&mut self, axis: Axis) -> &mut T {
        &mut self.0[axis as usize]
    }
}
