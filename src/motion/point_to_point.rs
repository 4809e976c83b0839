//! Point-to-point motion: one move from rest to rest along its own contour.
//!
//! Evaluates a seven-segment profile along a single line or arc at each tick. Knows nothing of the moves before and
//! after. It starts on a tick, so that its end point is a set-point.

use super::path_segment::PathSegment;
use super::profile::{AxisLimits, AxisState, MotionProfile};

/// A profile end this close after a tick counts as on the tick, in ticks.
const TICK_TOLERANCE: f64 = 1e-6;

/// One active move from rest to rest.
#[derive(Clone, Copy, Debug)]
pub struct PointToPointMove {
    segment: PathSegment,
    limits: AxisLimits,
    profile: MotionProfile,
    tick_s: f64,
    ticks: u32,
}

impl PointToPointMove {
    /// A move along `segment`, starting at distance `from`, mm, within `limits` along the path.
    #[must_use]
    pub fn new(segment: PathSegment, from: f64, limits: AxisLimits, tick_s: f64) -> Self {
        let profile = MotionProfile::to_position(AxisState::at_rest(from), segment.length(), limits);
        Self { segment, limits, profile, tick_s, ticks: 0 }
    }

    /// Changes the maximum speed, mm/s, from the next tick on.
    pub fn set_speed(&mut self, velocity_mm_s: f64) {
        if (velocity_mm_s - self.limits.velocity_mm_s).abs() > 0.0 && !self.is_finished() {
            let state = self.profile.at(f64::from(self.ticks) * self.tick_s);
            self.limits.velocity_mm_s = velocity_mm_s;
            self.profile = MotionProfile::to_position(state, self.segment.length(), self.limits);
            self.ticks = 0;
        }
    }

    /// Whether the end point has been output.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        f64::from(self.ticks) + TICK_TOLERANCE >= self.profile.seconds() / self.tick_s
    }

    /// The set-point of the next tick.
    pub fn next_setpoint(&mut self) -> [f64; 3] {
        self.ticks += 1;
        let along = if self.is_finished() {
            self.segment.length()
        } else {
            self.profile.at(f64::from(self.ticks) * self.tick_s).position
        };
        self.segment.at(along)
    }
}
