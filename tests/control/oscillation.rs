//! Servo oscillation of one axis between two reversal points.

use kt830::controller::axes::oscillation::{MIN_STROKE_MM, Oscillation, OscillationStatus, OscillationStroke};
use kt830::defs::kind::Kind;
use kt830::defs::param::Params;
use kt830::defs::text::LocalizedText;
use kt830::units::{Axis, Micros};

fn begin(strokes_min: f64) -> (Oscillation, Option<LocalizedText>, Params) {
    let params = Params::factory(Kind::Gc);
    let stroke = OscillationStroke { axis: Axis::Z, to: 5.0, ramp_ms: None, strokes_min: Some(strokes_min) };
    let (oscillation, limited) = Oscillation::new(stroke, true, 0.0, &params, 0.001);
    (oscillation, limited, params)
}

/// Ticks until it is over; the positions of the way.
fn run(oscillation: &mut Oscillation, params: &Params, from: u64, ticks: u64) -> Vec<f64> {
    let mut way = Vec::new();
    for tick in from..from + ticks {
        if oscillation.tick(Micros(1_000 * tick), true, params) == OscillationStatus::Finished {
            return way;
        }
        way.push(oscillation.mover.position());
    }
    way
}

#[test]
fn k4_3_g36_ends_the_oscillation_at_its_start_point() {
    let (mut oscillation, _, params) = begin(30.0);
    let way = run(&mut oscillation, &params, 0, 3_000);
    assert_eq!(way.len(), 3_000, "it goes on");
    assert!(way.iter().any(|at| (at - 5.0).abs() < MIN_STROKE_MM), "it comes to the reversal point");
    oscillation.end_at_start();
    let way = run(&mut oscillation, &params, 3_000, 10_000);
    assert!(way.len() < 10_000 && oscillation.mover.position().abs() < MIN_STROKE_MM);
}

#[test]
fn k4_3_less_than_one_stroke_a_minute_is_taken_as_one_and_says_so() {
    assert!(begin(0.5).1.is_some_and(|message| message.en().contains("replaced by 1")));
    let (mut oscillation, ..) = begin(30.0);
    let params = Params::factory(Kind::Gc);
    run(&mut oscillation, &params, 0, 200);
    oscillation.stop();
    assert!(run(&mut oscillation, &params, 200, 5_000).len() < 5_000, "reset stops it anywhere");
}
