//! One axis of the machine: drive, leadscrew, stops and brake (row P1).

use crate::bench::{Rig, driven_with};
use kt830::defs::kind::Kind;
use kt830::io::sim::{AxisFile, TablePoint};
use kt830::units::Axis;

/// A machine with its drives on and another axis X. A set-point that is written acts in the step after it.
fn axis(change: impl FnOnce(&mut AxisFile)) -> Rig {
    driven_with(Kind::Gc, |file| change(&mut file.x))
}

/// The same set-point for a number of ticks.
fn drive(rig: &mut Rig, set_point_mm: f64, ticks: u32) {
    rig.out.set_point_mm[Axis::X] = set_point_mm;
    (0..=ticks).for_each(|_| rig.step());
}

/// Set-points along X at a speed for a number of ticks; the last one acts in the next step.
fn run(rig: &mut Rig, speed_mm_s: f64, ticks: u32) {
    for tick in 1..=ticks {
        rig.out.set_point_mm[Axis::X] = speed_mm_s * 0.001 * f64::from(tick);
        rig.step();
    }
}

#[test]
fn p1_lag_at_constant_speed_is_twenty_milliseconds() {
    let mut rig = axis(|_| ());
    run(&mut rig, -50.0, 1_000);
    rig.step();
    // 2/ω = 20 ms at 50 mm/s: 1 mm, and up to a tick (0.05 mm) for the held set-point.
    let lag = rig.sim.slide_mm()[Axis::X] - (rig.sim.encoder_zero_mm()[Axis::X] - 50.0);
    assert!((0.95..=1.0).contains(&lag), "{lag}");
}

#[test]
fn p1_an_axis_that_has_arrived_reads_its_set_point_exactly() {
    let mut rig = axis(|_| ());
    drive(&mut rig, -0.123_456_7, 400);
    assert_eq!(rig.seen.encoder_mm[Axis::X].to_bits(), (-0.123_456_7_f64).to_bits());
}

#[test]
fn p1_backlash_and_pitch_error_move_the_slide_not_the_encoder() {
    let mut rig = axis(|file| {
        file.backlash_mm = vec![TablePoint(-300.0, 0.02)];
        file.pitch_error_mm = vec![TablePoint(-100.0, 0.01), TablePoint(0.0, 0.0)];
    });
    drive(&mut rig, -10.0, 400);
    // Motor at -50: a minus move leaves the backlash of 0.02; the error at -49.98 is 0.01 · 49.98/100.
    let slide_mm = rig.sim.slide_mm()[Axis::X];
    assert!((slide_mm - (-50.0 + 0.02 + 0.004_998)).abs() < 1e-6, "{slide_mm}");
    assert_eq!(rig.seen.encoder_mm[Axis::X].to_bits(), (-10.0_f64).to_bits());
}

#[test]
fn p1_the_stop_holds_and_tells_the_speed() {
    let mut rig = axis(|_| ());
    run(&mut rig, 100.0, 1_000);
    let struck = rig.sim.events()[0];
    assert!(struck.place == "hard stop X+" && struck.speed > 99.0 * 60.0, "{struck:?}");
    assert!(rig.sim.slide_mm()[Axis::X] <= 8.0);
}

#[test]
fn p1_drives_off_the_brake_stops_the_axis_where_it_stands() {
    let mut rig = axis(|_| ());
    run(&mut rig, -100.0, 500);
    rig.out.drives_on = false;
    rig.out.set_point_mm[Axis::X] = -80.0;
    rig.step();
    let from = rig.sim.slide_mm()[Axis::X];
    (0..100).for_each(|_| rig.step());
    // v²/2a = 100²/8000 = 1.25 mm.
    let braked = from - rig.sim.slide_mm()[Axis::X];
    assert!((braked - 1.25).abs() < 0.01, "{braked}");
    let stands = rig.sim.slide_mm();
    rig.step();
    assert_eq!(rig.sim.slide_mm(), stands);
}
