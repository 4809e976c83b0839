//! Jerk-limited profiles of one coordinate: seven segments of constant jerk, evaluated exactly.
//!
//! Computes the time-optimal motion from any position, velocity and acceleration to rest at a position, or to
//! a constant velocity, within the limits. Knows nothing of axes, ticks or paths.
//! Source: the seven-segment form follows from the minimum principle. A profile is a change of velocity to a peak, a
//! cruise phase and a change of velocity to zero. Its travel grows with the peak, so the peak is found by bisection.

/// Limits of one coordinate, all positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Maximum velocity, mm/s.
    pub velocity_mm_s: f64,
    /// Maximum acceleration and deceleration, mm/s².
    pub acceleration_mm_s2: f64,
    /// Maximum jerk, mm/s³.
    pub jerk_mm_s3: f64,
}

impl AxisLimits {
    /// Time between rest and a speed in mm/s, s; the distance is speed · time / 2.
    #[must_use]
    pub fn ramp_s(self, speed_mm_s: f64) -> f64 {
        let Self { acceleration_mm_s2: most, jerk_mm_s3: jerk, .. } = self;
        // Up to a²/j the acceleration does not reach its limit.
        if speed_mm_s * jerk <= most * most {
            2.0 * (speed_mm_s / jerk).sqrt()
        } else {
            speed_mm_s / most + most / jerk
        }
    }
}

/// Position, velocity and acceleration at a point in time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisState {
    /// Position, mm.
    pub position: f64,
    /// Velocity, mm/s.
    pub velocity: f64,
    /// Acceleration, mm/s².
    pub acceleration: f64,
}

impl AxisState {
    /// At rest at a position in mm.
    #[must_use]
    pub const fn at_rest(position: f64) -> Self {
        Self { position, velocity: 0.0, acceleration: 0.0 }
    }

    /// The state after `time` seconds of constant jerk.
    fn after(self, time: f64, jerk: f64) -> Self {
        let Self { position, velocity, acceleration } = self;
        Self {
            position: position + time * (velocity + time * (acceleration / 2.0 + time * jerk / 6.0)),
            velocity: velocity + time * (acceleration + time * jerk / 2.0),
            acceleration: acceleration + time * jerk,
        }
    }
}

/// A segment of constant jerk: duration in s, jerk in mm/s³.
#[derive(Clone, Copy, Debug, Default)]
struct JerkSegment {
    seconds: f64,
    jerk: f64,
}

/// Bisection steps for the peak velocity; more than the 53 bits of the mantissa gain nothing.
const BISECTION_STEPS: usize = 64;
/// Number of segments of a profile.
const SEGMENTS: usize = 7;

/// A jerk-limited motion of one coordinate over time, starting at 0 s.
#[derive(Clone, Copy, Debug)]
pub struct MotionProfile {
    start: AxisState,
    segments: [JerkSegment; SEGMENTS],
    seconds: f64,
    end: AxisState,
}

impl MotionProfile {
    /// At rest at a position in mm.
    #[must_use]
    pub fn resting_at(position: f64) -> Self {
        let start = AxisState::at_rest(position);
        Self { start, segments: [JerkSegment::default(); SEGMENTS], seconds: 0.0, end: start }
    }

    /// The fastest motion from a state to rest at `target` mm.
    ///
    /// The velocity exceeds its limit only if `start` already does or must, and then decreases at once.
    #[must_use]
    pub fn to_position(start: AxisState, target: f64, limits: AxisLimits) -> Self {
        let need = target - start.position;
        let top = limits.velocity_mm_s;
        let build = |peak: f64| {
            let [a, b, c] = velocity_change(start.velocity, start.acceleration, peak, limits);
            let [e, f, g] = velocity_change(peak, 0.0, 0.0, limits);
            [a, b, c, JerkSegment::default(), e, f, g]
        };
        let from = AxisState { position: 0.0, ..start };
        let travel = |legs: &[JerkSegment; SEGMENTS]| run(from, legs).position;
        let (mut up, mut down) = (build(top), build(-top));
        let (farthest, nearest) = (travel(&up), travel(&down));
        let legs = if farthest <= need {
            up[3].seconds = (need - farthest) / top;
            up
        } else if nearest >= need {
            down[3].seconds = (nearest - need) / top;
            down
        } else {
            let (mut low, mut high) = (-top, top);
            for _ in 0..BISECTION_STEPS {
                let middle = f64::midpoint(low, high);
                if travel(&build(middle)) <= need {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            // The end is approached from its own side: rounding never leads beyond it.
            build(if low < 0.0 { high } else { low })
        };
        Self::of(start, legs, AxisState::at_rest(target))
    }

    /// The fastest motion from a state to the constant velocity `target` mm/s; the velocity limit is not checked.
    #[must_use]
    pub fn to_velocity(start: AxisState, target: f64, limits: AxisLimits) -> Self {
        let [a, b, c] = velocity_change(start.velocity, start.acceleration, target, limits);
        let none = JerkSegment::default();
        let legs = [a, b, c, none, none, none, none];
        let reached = run(start, &legs);
        Self::of(start, legs, AxisState { velocity: target, acceleration: 0.0, ..reached })
    }

    fn of(start: AxisState, legs: [JerkSegment; SEGMENTS], end: AxisState) -> Self {
        Self { start, segments: legs, seconds: legs.iter().map(|leg| leg.seconds).sum(), end }
    }

    /// Time until the target is reached, s.
    #[must_use]
    pub const fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The state at the end; a constant velocity continues from here.
    #[must_use]
    pub const fn end(&self) -> AxisState {
        self.end
    }

    /// The state `time` seconds after the start; exactly the target after the end.
    #[must_use]
    pub fn at(&self, time: f64) -> AxisState {
        if time >= self.seconds {
            return self.end.after(time - self.seconds, 0.0);
        }
        let mut state = self.start;
        let mut left = time.max(0.0);
        for leg in &self.segments {
            if left <= leg.seconds {
                return state.after(left, leg.jerk);
            }
            state = state.after(leg.seconds, leg.jerk);
            left -= leg.seconds;
        }
        state
    }
}

fn run(start: AxisState, legs: &[JerkSegment]) -> AxisState {
    legs.iter().fold(start, |state, leg| state.after(leg.seconds, leg.jerk))
}

/// The fastest change from a velocity and an acceleration to another velocity at zero acceleration.
fn velocity_change(velocity: f64, acceleration: f64, target: f64, limits: AxisLimits) -> [JerkSegment; 3] {
    let (most, jerk) = (limits.acceleration_mm_s2, limits.jerk_mm_s3);
    let leg = |seconds: f64, jerk: f64| JerkSegment { seconds, jerk };
    // The final velocity if the acceleration only drops to zero decides the direction.
    let settled = velocity + acceleration * acceleration.abs() / (2.0 * jerk);
    let way = if target >= settled { 1.0 } else { -1.0 };
    let (rise, first) = (way * (target - velocity), way * acceleration);
    let peak = (jerk * rise + first * first / 2.0).max(0.0).sqrt();
    if peak <= most {
        let up = (peak - first).max(0.0) / jerk;
        return [leg(up, way * jerk), JerkSegment::default(), leg(peak / jerk, -way * jerk)];
    }
    // An acceleration above its limit (limits lowered at rest, or after an emergency stop) is first reduced to it.
    let bend = if first > most { -jerk } else { jerk };
    let gained = (most * most - first * first) / (2.0 * bend) + most * most / (2.0 * jerk);
    [leg((most - first) / bend, way * bend), leg((rise - gained).max(0.0) / most, 0.0), leg(most / jerk, -way * jerk)]
}
