//! Servo oscillation of one axis between two reversal points.

use kt830::controller::axes::oscillation::{MIN_STROKE_MM, Oscillation, OscillationStatus, OscillationStroke};
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::param::Params;
use kt830::defs::text::LocalizedText;
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;
use kt830::link::snapshot::OwnMotion;
use kt830::units::{Axis, Micros};

use crate::stories::{folders_of, rig_of, tell};

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

/// A tick of 1 ms at the rapid speed of 6 m/min is 0.1 mm. The axis jumped by 2.4 mm with RESET, and its drive went off
/// while it moved at 58 mm/s.
#[test]
fn b5_an_emergency_stop_brakes_an_oscillating_axis_and_reset_moves_nothing() {
    for kind in [Kind::Gs, Kind::Ga] {
        let mut rig = rig_of(kind, folders_of(kind));
        tell(&mut rig, "param P239 -20\nhome all\nkey oscillation\nwait 280 ms\nexpect lamp oscillation on");
        let mut before = rig.trace_row().outputs;
        let mut step_before = f64::INFINITY;
        let mut tick = |rig: &mut HeadlessHost| {
            rig.step();
            let now = rig.trace_row().outputs;
            let step = (now.set_point_mm[Axis::X] - before.set_point_mm[Axis::X]).abs();
            assert!(step < 0.1 * 1.05, "{}: X steps {step} mm", kind.id());
            let goes_off = before.drives_on && !now.drives_on;
            assert!(!goes_off || step_before < 1e-3, "{}: the drives go off at {step_before} mm a tick", kind.id());
            (before, step_before) = (now, step);
        };
        rig.machine_mut().force_input("emergency-stop", Some(true)).unwrap();
        (0..500).for_each(|_| tick(&mut rig));
        assert!(!rig.trace_row().outputs.drives_on, "{}: the drives go off at last", kind.id());
        rig.machine_mut().force_input("emergency-stop", None).unwrap();
        (0..100).for_each(|_| tick(&mut rig));
        rig.send(Command::Press(Key::Reset));
        (0..500).for_each(|_| tick(&mut rig));
        assert!(rig.trace_row().outputs.drives_on, "{}: RESET switches them on", kind.id());
    }
}

/// An axis moves: header and status line say so, whoever began it.
#[test]
fn k4_3_an_oscillation_that_outlives_its_mdi_line_is_shown() {
    let mut rig = rig_of(Kind::Gs, folders_of(Kind::Gs));
    tell(&mut rig, "param P270 0\nparam P239 -20\nhome all\nmdi M35\nwait 3 s\nexpect state idle");
    assert_eq!(rig.snapshot().own_motion, Some(OwnMotion::Oscillation));
    tell(&mut rig, "key reset\nwait 1 s");
    assert_eq!(rig.snapshot().own_motion, None);
}

/// The set-point of the drive stopped dead at 58 mm/s.
#[test]
fn b5_machine_lock_is_refused_while_an_axis_oscillates() {
    let mut rig = rig_of(Kind::Gs, folders_of(Kind::Gs));
    tell(&mut rig, "param P239 -20\nhome all\nkey oscillation\nwait 280 ms\nkey machine-lock");
    assert!(!rig.snapshot().key(Key::MachineLock).lamp && rig.controller().is_oscillating());
    tell(&mut rig, "expect message \"程序未结束\"");
}
