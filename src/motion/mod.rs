//! Motion: moves in, set-points out, every limit kept in every tick.
//!
//! Owns the way from a programmed move to the position of each axis at each tick. Knows nothing of blocks, sequences,
//! drives or time of day; a tick is an argument's worth of motion, and the same calls give the same set-points bit for
//! bit. Machine frame, radius millimetres, seconds.
//!
//! The way of a move through [`Path`]: `push` queues it; the [`planner`] turns the moves at the front of the queue into
//! *nominal* set-points, one for each tick at 100 % override, and lays them on the [`trail`]: a [`stroke`] for a move that
//! ends at rest, for a [`run`] of moves that flow into each other one [`window`] after another, each planned in slices to
//! an end at rest and handed over to the next before it brakes; `tick`
//! goes along the trail, one place a tick at full rate and slower under an override or a hold ([`warp`]); a change of
//! rate is only begun once it has been run ahead to its end and every limit found kept.
//! [`ThreadMover`] leads Z in step with a spindle. [`AxisMover`] moves one axis by itself; both rest on the seven-segment [`profile`].

mod budget;
mod contour;
mod mover;
mod path;
mod planner;
pub mod profile;
mod run;
mod smooth;
mod speed;
mod stroke;
mod thread;
mod trail;
mod tube;
mod warp;
mod window;

pub use mover::{AxisMover, EMERGENCY_JERK_FACTOR};
pub use path::{FINISHED_KEPT, MOVES, Path};
pub use planner::WORK_MOST;
pub use profile::AxisLimits;
pub use thread::{Thread, ThreadMover};

use crate::units::{Axis, PerAxis};

/// Limits of the machine's axes and the length of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Limits of each axis; all positive. An axis that is not there may repeat another's.
    pub axes: PerAxis<AxisLimits>,
    /// Length of a tick, seconds; 0.001 unless the parameter says otherwise.
    pub tick_s: f64,
}

/// The two axes an arc turns in, in the order that defines its sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// First X, second Y (G17).
    Xy,
    /// First Z, second X (G18).
    Zx,
    /// First Y, second Z (G19).
    Yz,
}

impl Plane {
    /// First axis, second axis, and the one that stays linear.
    #[must_use]
    pub const fn axes(self) -> (Axis, Axis, Axis) {
        match self {
            Self::Xy => (Axis::X, Axis::Y, Axis::Z),
            Self::Zx => (Axis::Z, Axis::X, Axis::Y),
            Self::Yz => (Axis::Y, Axis::Z, Axis::X),
        }
    }
}

/// The sense of an arc in its [`Plane`], by coordinates alone: how a machine draws or mirrors its axes changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// From the plus side of the plane's first axis towards the plus side of the second: in ZX from Z+ to X+.
    Ccw,
    /// The other way.
    Cw,
}

/// The form of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A straight line.
    Line,
    /// An arc in a plane while the third axis moves in proportion (a helix). Start and end on the same radius line make
    /// a full turn. Where start and end differ in radius, the radius changes evenly with the angle.
    Arc {
        /// Centre, mm; the value of the axis outside the plane is not looked at.
        center: PerAxis<f64>,
        /// The two axes it turns in.
        plane: Plane,
        /// Its sense.
        turn: Turn,
    },
}

/// How fast a move is meant to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rate {
    /// As fast as the axes allow, in a straight line, under the rapid override.
    Rapid,
    /// At this speed along the path, under the feed override.
    Feed {
        /// Speed, mm/s; below [`LEAST_FEED_MM_S`] it is raised to that.
        mm_s: f64,
    },
}

/// The slowest feed, mm/s: a feed of nothing would never end. Source: our choice; 0.006 mm/min.
pub const LEAST_FEED_MM_S: f64 = 1e-4;

/// How the corner at the end of a move may be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Stand at the end point before going on.
    ExactStop,
    /// Go on through the corner, never farther than this from the programmed contour. Between a rapid and a feed the
    /// axes stop all the same.
    Continuous {
        /// Greatest distance from the contour, mm.
        tolerance_mm: f64,
    },
}

/// One programmed move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// End point, mm.
    pub to: PerAxis<f64>,
    /// Its form.
    pub shape: Shape,
    /// Its speed.
    pub rate: Rate,
    /// How its end may be taken.
    pub end: End,
    /// The caller's mark, reported when the move is active and when it is finished.
    pub tag: u32,
}

/// Overrides as factors: `feed` 0 to 1.5, `rapid` 0 to 1; anything beyond is cut, not-a-number is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Override {
    /// Factor of the programmed feed.
    pub feed: f64,
    /// Factor of the rapid.
    pub rapid: f64,
}

impl Override {
    /// Everything as programmed.
    pub const FULL: Self = Self { feed: 1.0, rapid: 1.0 };
}

/// Where every axis is to be at the end of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetPoint {
    /// Position, mm.
    pub position: PerAxis<f64>,
    /// Velocity, mm/s.
    pub velocity_mm_s: PerAxis<f64>,
}

/// The queue of moves is full; try again once a move has finished ([`Path::room`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the queue of moves is full")]
pub struct PathFull;
