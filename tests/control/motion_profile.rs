//! Profiles of a single axis: times by hand, limits from any state.

use kt830::motion::profile::{AxisLimits, AxisState, MotionProfile};
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
