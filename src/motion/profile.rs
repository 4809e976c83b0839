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
            build(low)
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
    // The final velocity if the acceleration only drops to zero decides the direction.
    let settled = velocity + acceleration * acceleration.abs() / (2.0 * jerk);
    let way = if target >= settled { 1.0 } else { -1.0 };
    let (rise, first) = (way * (target - velocity), way * acceleration);
    let peak = (jerk * rise + first * first / 2.0).max(0.0).sqrt();
    if peak <= most {
        let up = (peak - first).max(0.0) / jerk;
        return [
            JerkSegment { seconds: up, jerk: way * jerk },
            JerkSegment::default(),
            JerkSegment { seconds: peak / jerk, jerk: -way * jerk },
        ];
    }
    // An acceleration above its limit (limits lowered at rest, or after an emergency stop) is first reduced to it.
    let bend = if first > most { -jerk } else { jerk };
    let gained = (most * most - first * first) / (2.0 * bend) + most * most / (2.0 * jerk);
    [
        JerkSegment { seconds: (most - first) / bend, jerk: way * bend },
        JerkSegment { seconds: (rise - gained).max(0.0) / most, jerk: 0.0 },
        JerkSegment { seconds: most / jerk, jerk: -way * jerk },
    ]
}

#[cfg(test)]
mod tests {
    use super::{AxisLimits, AxisState, MotionProfile};
    use proptest::prelude::*;

    const LIMITS: AxisLimits = AxisLimits { velocity_mm_s: 100.0, acceleration_mm_s2: 500.0, jerk_mm_s3: 5_000.0 };

    fn check_time(distance: f64, limits: AxisLimits, seconds: f64) {
        let profile = MotionProfile::to_position(AxisState::at_rest(1.0), 1.0 + distance, limits);
        assert!((profile.seconds() - seconds).abs() < 1e-9, "{distance} mm took {} s", profile.seconds());
        assert_eq!(profile.at(profile.seconds() + 1.0), AxisState::at_rest(1.0 + distance));
    }

    #[test]
    fn all_seven_segments() {
        // Ramp v/a + a/j = 0.2 + 0.1 s over 15 mm, twice; the other 70 mm at 100 mm/s.
        check_time(100.0, LIMITS, 1.3);
        check_time(-100.0, LIMITS, 1.3);
    }

    #[test]
    fn short_move_reaches_neither_velocity_nor_acceleration() {
        // Four equal segments of t: distance = 2 j t³, so 2 µm takes 4 (0.002 / 10000)^(1/3) s.
        check_time(0.002, LIMITS, 4.0 * (0.002_f64 / 10_000.0).cbrt());
        check_time(0.0, LIMITS, 0.0);
    }

    #[test]
    fn short_move_that_reaches_its_acceleration() {
        // Peak velocity w: distance = w (w/a + a/j); 30 mm is the full ramp pair, so 12 mm: w² / 500 + w / 10 = 12.
        let peak = (-0.1 + (0.01_f64 + 4.0 * 12.0 / 500.0).sqrt()) * 250.0;
        check_time(12.0, LIMITS, 2.0 * (peak / 500.0 + 0.1));
    }

    #[test]
    fn a_target_too_near_is_overshot_and_taken_back() {
        let profile =
            MotionProfile::to_position(AxisState { position: 0.0, velocity: 100.0, acceleration: 0.0 }, 1.0, LIMITS);
        // 0.1 s until the acceleration is -500 at 75 mm/s after 100 · 0.1 - 5000 · 0.1³ / 6 mm, then 75² / 1000 mm.
        let farthest = (0..2_000).map(|k| profile.at(f64::from(k) * 1e-3).position).fold(0.0, f64::max);
        assert!((farthest - (10.0 - 5.0 / 6.0 + 5.625)).abs() < 1e-3, "{farthest}");
        assert_eq!(profile.at(10.0), AxisState::at_rest(1.0));
    }

    proptest! {
        #[test]
        fn from_any_state_every_limit_is_kept_and_the_target_met(
            target in -200.0..200.0_f64, velocity in -1.0..1.0_f64, push in -1.0..1.0_f64, scale in 0.05..20.0_f64,
        ) {
            let limits = AxisLimits { velocity_mm_s: 100.0, acceleration_mm_s2: 500.0 * scale, jerk_mm_s3: 5_000.0 * scale };
            let acceleration = push * limits.acceleration_mm_s2;
            // A state reachable within the limits: reducing the acceleration to zero stays below the velocity limit.
            let room = limits.velocity_mm_s - acceleration * acceleration / (2.0 * limits.jerk_mm_s3);
            prop_assume!(room > 0.0);
            let start = AxisState { position: 3.0, velocity: velocity * room, acceleration };
            let profile = MotionProfile::to_position(start, target, limits);
            let mut before = profile.at(0.0);
            for step in 1..=1_000 {
                let now = profile.at(profile.seconds() * f64::from(step) / 1_000.0);
                let dt = profile.seconds() / 1_000.0;
                prop_assert!(now.velocity.abs() <= limits.velocity_mm_s * (1.0 + 1e-9));
                prop_assert!(now.acceleration.abs() <= limits.acceleration_mm_s2 * (1.0 + 1e-9));
                prop_assert!((now.acceleration - before.acceleration).abs() <= limits.jerk_mm_s3 * dt * (1.0 + 1e-6) + 1e-9);
                prop_assert!((now.position - before.position).abs() <= limits.velocity_mm_s * dt * (1.0 + 1e-6) + 1e-9);
                before = now;
            }
            prop_assert!((profile.at(profile.seconds() * (1.0 - 1e-12)).position - target).abs() < 1e-9);
        }
    }
}
