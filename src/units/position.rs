//! Positions of the three axes, each in its frame.
//!
//! A position carries its frame in its type: [`MachinePos`] and [`WorkPos`] do not mix. The value that knows the
//! relation of two frames converts: `WorkOffsets` between work and machine, `Axes` between machine and encoder, the
//! diameter mode between work or machine and display. The difference of two positions of a frame is a displacement,
//! `PerAxis<f64>`.

use std::marker::PhantomData;
use std::ops::{Add, Index, IndexMut, Sub};

use serde::{Deserialize, Serialize};

use super::{Axis, PerAxis};

/// Frame of the machine: zero is the machine zero found by homing. Slide travel, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MachineFrame;

/// Frame of the active work offset, G50 shift and tool offset. Slide travel, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorkFrame;

/// Frame of the encoders: zero is where the drive was switched on. Slide travel, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EncoderFrame;

/// Frame of the display and of typed values: X is a diameter where diameter mode is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DisplayFrame;

/// A position of the three axes in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent, bound = "")]
pub struct Position<Frame> {
    coordinates: PerAxis<f64>,
    frame: PhantomData<Frame>,
}

/// A position in machine coordinates.
pub type MachinePos = Position<MachineFrame>;
/// A position in work coordinates.
pub type WorkPos = Position<WorkFrame>;
/// A position in encoder coordinates.
pub type EncoderPos = Position<EncoderFrame>;
/// A position as the display shows it.
pub type DisplayPos = Position<DisplayFrame>;

impl<Frame> Position<Frame> {
    /// A position from its coordinates X, Y, Z.
    #[must_use]
    pub const fn new(coordinates: [f64; 3]) -> Self {
        Self { coordinates: PerAxis(coordinates), frame: PhantomData }
    }

    /// A position from a function of the axis.
    pub fn from_fn(f: impl FnMut(Axis) -> f64) -> Self {
        Self { coordinates: PerAxis::from_fn(f), frame: PhantomData }
    }

    /// The coordinates X, Y, Z without their frame.
    #[must_use]
    pub const fn coordinates(self) -> [f64; 3] {
        self.coordinates.0
    }

    /// The position with one coordinate replaced.
    #[must_use]
    pub fn with(mut self, axis: Axis, value: f64) -> Self {
        self[axis] = value;
        self
    }

    /// Axis and coordinate, in the order X, Y, Z.
    pub fn iter(&self) -> impl Iterator<Item = (Axis, f64)> {
        Axis::ALL.into_iter().zip(self.coordinates.0)
    }

    /// Whether every coordinate is a finite number.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.coordinates.0.iter().all(|value| value.is_finite())
    }
}

impl<Frame> Index<Axis> for Position<Frame> {
    type Output = f64;
    fn index(&self, axis: Axis) -> &f64 {
        &self.coordinates[axis]
    }
}

impl<Frame> IndexMut<Axis> for Position<Frame> {
    fn index_mut(&mut self, axis: Axis) -> &mut f64 {
        &mut self.coordinates[axis]
    }
}

impl<Frame> Sub for Position<Frame> {
    type Output = PerAxis<f64>;
    fn sub(self, other: Self) -> PerAxis<f64> {
        PerAxis::from_fn(|axis| self[axis] - other[axis])
    }
}

impl<Frame> Add<PerAxis<f64>> for Position<Frame> {
    type Output = Self;
    fn add(self, displacement: PerAxis<f64>) -> Self {
        Self::from_fn(|axis| self[axis] + displacement[axis])
    }
}

impl<Frame> Sub<PerAxis<f64>> for Position<Frame> {
    type Output = Self;
    fn sub(self, displacement: PerAxis<f64>) -> Self {
        Self::from_fn(|axis| self[axis] - displacement[axis])
    }
}
