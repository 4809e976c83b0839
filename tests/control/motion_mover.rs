//! Stories of a single axis: jog, handwheel, software limits, stops, at any moment.

use kt830::motion::{AxisLimits, AxisMover, EMERGENCY_JERK_FACTOR};
use proptest::prelude::*;

const LIMITS: AxisLimits = AxisLimits { velocity_mm_s: 50.0, acceleration_mm_s2: 500.0, jerk_mm_s3: 10_000.0 };
const TICK_S: f64 = 0.001;
/// Rounding of positions to 100 mm, 1.4e-14 mm, differenced three times over 1 ms: 1e-4 mm/s³, 1e-8 of the jerk.
const SLACK: f64 = 1e-6;

/// Runs a mover and asserts its limits by differences of its positions.
struct Watched {
    axis: AxisMover,
    past: [f64; 4],
    jerk_mm_s3: f64,
}

impl Watched {
    fn new() -> Self {
        Self { axis: AxisMover::new(LIMITS, 0.0, TICK_S), past: [0.0; 4], jerk_mm_s3: LIMITS.jerk_mm_s3 }
    }

    fn ticks(&mut self, count: u32) {
        for _ in 0..count {
            let (position, _) = self.axis.tick();
            let [_, b, c, d] = self.past;
            self.past = [b, c, d, position];
            let [p, q, r, s] = self.past;
            let (v, a) = ((s - r) / TICK_S, (s - 2.0 * r + q) / TICK_S.powi(2));
            let j = (s - 3.0 * (r - q) - p) / TICK_S.powi(3);
            assert!(v.abs() <= LIMITS.velocity_mm_s * (1.0 + SLACK), "velocity {v}");
            assert!(a.abs() <= LIMITS.acceleration_mm_s2 * (1.0 + SLACK), "acceleration {a}");
            assert!(j.abs() <= self.jerk_mm_s3 * (1.0 + SLACK), "jerk {j}");
        }
    }

    fn run_to_rest(&mut self) -> f64 {
        for _ in 0..100_000 {
            if self.axis.is_at_rest() {
                return self.axis.position();
            }
            self.ticks(1);
        }
        panic!("never at rest");
    }
}

#[test]
fn jog_runs_until_let_go() {
    let mut w = Watched::new();
    w.axis.set_velocity_target(-20.0);
    w.ticks(1_000);
    assert!((w.axis.velocity_mm_s() + 20.0).abs() < 1e-12);
    w.axis.set_velocity_target(0.0);
    w.run_to_rest();
    assert!(w.axis.velocity_mm_s().abs() < 1e-12);
}

#[test]
fn jog_lands_on_the_software_limit_and_outward_is_refused_there() {
    let mut w = Watched::new();
    w.axis.set_bounds(Some((-5.0, 12.5)));
    w.axis.set_velocity_target(50.0);
    assert!((w.run_to_rest() - 12.5).abs() < 1e-12);
    w.axis.set_velocity_target(10.0);
    assert!((w.run_to_rest() - 12.5).abs() < 1e-12);
    w.axis.set_velocity_target(-50.0);
    assert!((w.run_to_rest() + 5.0).abs() < 1e-12);
}

#[test]
fn from_beyond_a_limit_only_the_way_back_is_open() {
    let mut w = Watched::new();
    w.axis.set_bounds(Some((3.0, 10.0)));
    w.axis.set_velocity_target(-5.0);
    w.ticks(100);
    assert!(w.axis.position().abs() < 1e-12);
    w.axis.set_velocity_target(5.0);
    assert!((w.run_to_rest() - 10.0).abs() < 1e-12);
}

#[test]
fn handwheel_detents_at_every_moment_end_exactly_on_the_last() {
    let mut w = Watched::new();
    for detent in 1..=40 {
        w.axis.set_position_target(f64::from(detent) * 0.01, 50.0);
        w.ticks(7);
    }
    assert!((w.run_to_rest() - 0.4).abs() < 1e-15);
    w.axis.set_position_target(0.399, 50.0);
    assert!((w.run_to_rest() - 0.399).abs() < 1e-15);
}

#[test]
fn emergency_stop_brakes_with_more_jerk_but_no_more_deceleration() {
    let mut w = Watched::new();
    w.axis.set_velocity_target(50.0);
    w.ticks(500);
    w.jerk_mm_s3 = LIMITS.jerk_mm_s3 * EMERGENCY_JERK_FACTOR;
    let from = w.axis.position();
    w.axis.emergency_stop();
    // v²/2a and v/2 of the 5 ms that the deceleration takes to build up.
    let braking = w.run_to_rest() - from;
    assert!((braking - (2.5 + 0.125)).abs() < 0.01, "{braking}");
}

#[derive(Clone, Copy, Debug)]
enum Ask {
    Velocity(f64),
    Position(f64, f64),
    Stop,
}

impl Ask {
    fn of(self, axis: &mut AxisMover) {
        match self {
            Self::Velocity(v) => axis.set_velocity_target(v),
            Self::Position(p, v) => axis.set_position_target(p, v),
            Self::Stop => axis.stop(),
        }
    }
}

fn ask() -> impl Strategy<Value = (u32, Ask)> {
    let what = prop_oneof![
        (-60.0..60.0_f64).prop_map(Ask::Velocity),
        (-20.0..20.0_f64, 0.5..60.0_f64).prop_map(|(p, v)| Ask::Position(p, v)),
        Just(Ask::Stop),
    ];
    (0..150_u32, what)
}

/// A search at random has found these: the last move ended 3.4e-9 mm beyond the bound.
#[test]
fn a_move_in_minus_ends_on_its_own_side_of_the_bound() {
    let asks = [
        (121, Ask::Velocity(-46.366_895_867_392_195)),
        (45, Ask::Velocity(0.0)),
        (135, Ask::Velocity(33.491_948_447_392_33)),
        (37, Ask::Velocity(0.0)),
        (126, Ask::Stop),
        (72, Ask::Position(-12.321_363_956_137_315, 49.920_892_408_920_466)),
        (105, Ask::Velocity(-32.209_885_770_532_76)),
        (114, Ask::Position(-18.822_622_990_928_284, 28.956_033_124_353_23)),
    ];
    let mut w = Watched::new();
    w.axis.set_bounds(Some((-8.0, 9.0)));
    for (wait, ask) in asks {
        ask.of(&mut w.axis);
        for _ in 0..wait {
            w.ticks(1);
            assert!(w.axis.position() >= -8.0 - 1e-9, "{}", w.axis.position());
        }
    }
}

proptest! {
    #[test]
    fn whatever_is_asked_limits_and_bounds_are_kept(asks in prop::collection::vec(ask(), 1..12)) {
        let mut w = Watched::new();
        w.axis.set_bounds(Some((-8.0, 9.0)));
        for (wait, ask) in asks {
            ask.of(&mut w.axis);
            for _ in 0..wait {
                w.ticks(1);
                // The bisection of the profile ends within rounding of the bound.
                prop_assert!((-8.0 - 1e-9..=9.0 + 1e-9).contains(&w.axis.position()), "{}", w.axis.position());
            }
        }
        w.axis.set_position_target(1.25, 50.0);
        prop_assert!((w.run_to_rest() - 1.25).abs() < 1e-12);
    }
}
