//! Motion: turns moves into set-points and keeps every axis limit in every tick.
//!
//! Computes the position of each axis at each tick from the programmed moves. It knows nothing of blocks, sequences,
//! drives or time of day. It is deterministic: the same calls give the same set-points bit for bit. Machine
//! coordinates, millimetres (radius), seconds.
//!
//! A move passes through [`TrajectoryPlanner`]: `push` queues it. The [`setpoint_planner`] turns the moves at the front of
//! the queue into *nominal* set-points, one per tick at 100 % override, and appends them to the [`setpoint_buffer`]. A
//! move from rest to rest is a [`point_to_point`] move. Moves at a grinding feed are a [`slow_run`]. Faster moves that
//! blend into each other ([`blending`]) are planned as a sequence of look-ahead windows ([`lookahead_window`]), each in
//! slices to an end at rest; the next window takes over before it brakes. `tick` follows the buffer: one set-point per tick at full rate, slower under an override or a hold
//! ([`feed_scaling`]). A change of rate starts only after it has been simulated to its end and keeps every limit.
//! [`ThreadMover`] moves Z in step with a spindle, [`AxisMover`] moves one axis; both use the seven-segment [`profile`].

mod axis_mover;
mod blending;
mod feed_scaling;
mod lookahead_window;
mod path_segment;
mod point_to_point;
pub mod profile;
mod queued_move;
mod setpoint_buffer;
mod setpoint_planner;
mod slow_run;
mod smoother;
mod speed_optimizer;
mod thread;
mod tolerance_band;
mod trajectory;

pub use axis_mover::{AxisMover, EMERGENCY_JERK_FACTOR};
pub use profile::AxisLimits;
pub use queued_move::MAX_QUEUED_MOVES;
pub use setpoint_planner::MAX_WORK_PER_TICK;
pub use thread::{ThreadMover, ThreadPass};
pub use trajectory::{MAX_FINISHED_TAGS, MAX_TRAJECTORY_WORK, TrajectoryPlanner};

use crate::units::{MachinePos, PerAxis, Plane};

/// A value for each of the three coordinates. `[T; 3]::map` is not always inlined, and it is called for every set-point.
#[inline]
fn per_coordinate<T>(mut f: impl FnMut(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}

/// The scalar product. Written out, as above.
#[inline]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Limits of the machine's axes and the length of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionLimits {
    /// Limits of each axis; all positive. An axis that is not fitted may repeat the limits of another.
    pub axes: PerAxis<AxisLimits>,
    /// Length of a tick, s; 0.001 by default (P58).
    pub tick_s: f64,
}

impl MotionLimits {
    /// The least limits of all axes: what holds in every direction.
    fn least(&self) -> AxisLimits {
        let least = |of: fn(&AxisLimits) -> f64| self.axes.iter().map(|(_, l)| of(l)).fold(f64::INFINITY, f64::min);
        AxisLimits {
            velocity_mm_s: least(|l| l.velocity_mm_s),
            acceleration_mm_s2: least(|l| l.acceleration_mm_s2),
            jerk_mm_s3: least(|l| l.jerk_mm_s3),
        }
    }
}

/// The direction of an arc in its [`Plane`], in coordinates; independent of how a machine draws or mirrors its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcDirection {
    /// From the plus side of the plane's first axis towards the plus side of the second: in ZX from Z+ to X+.
    Ccw,
    /// The opposite direction.
    Cw,
}

/// The shape of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MoveShape {
    /// A straight line.
    Line,
    /// An arc in a plane; the third axis moves in proportion (helix). If the end equals the start in the plane, it is a
    /// full turn. If start and end radius differ, the radius changes linearly with the angle.
    Arc {
        /// Centre, mm; the value of the axis outside the plane is ignored.
        center: MachinePos,
        /// The plane of the arc.
        plane: Plane,
        /// Its direction.
        direction: ArcDirection,
    },
}

/// The programmed speed of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionSpeed {
    /// As fast as the axes allow, in a straight line; the rapid override applies.
    Rapid,
    /// A feed along the path; the feed override applies.
    Feed {
        /// Feed, mm/s; at least [`MIN_FEED_MM_S`] is used.
        mm_s: f64,
    },
}

/// Minimum feed, mm/s: a move with feed zero would never end. Source: our choice; 0.006 mm/min.
pub const MIN_FEED_MM_S: f64 = 1e-4;

/// How the corner at the end of a move is passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CornerMode {
    /// Stop at the end point before the next move.
    ExactStop,
    /// Round the corner within a tolerance. Between a rapid and a feed move the axes stop in any case.
    Continuous {
        /// Maximum distance from the programmed contour, mm.
        tolerance_mm: f64,
    },
}

/// One programmed move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// End point, mm.
    pub to: MachinePos,
    /// Its shape.
    pub shape: MoveShape,
    /// Its speed.
    pub speed: MotionSpeed,
    /// How the corner at its end is passed.
    pub corner: CornerMode,
    /// The caller's tag, reported while the move is active and when it is finished.
    pub tag: u32,
}

/// Overrides as factors: `feed` 0 to 1.5, `rapid` 0 to 1. Values beyond are clamped; NaN counts as 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Override {
    /// Factor on the programmed feed.
    pub feed: f64,
    /// Factor on rapid moves.
    pub rapid: f64,
}

impl Override {
    /// 100 % feed and rapid.
    pub const FULL: Self = Self { feed: 1.0, rapid: 1.0 };
}

/// The set-point of all axes at the end of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// Position, mm.
    pub position: MachinePos,
    /// Velocity, mm/s.
    pub velocity_mm_s: PerAxis<f64>,
}

/// The move queue is full; try again after a move has finished ([`TrajectoryPlanner::free_slots`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the queue of moves is full")]
pub struct MoveQueueFull;
