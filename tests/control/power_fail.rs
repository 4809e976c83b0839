//! A supply that fails (P369): everything stops, the wheel leaves the part (P379), the place of the run is kept.
//! Source: spec B5, K5.18; safety stance.

use kt830::defs::alarm;
use kt830::defs::signal::Output;
use kt830::host::headless::HeadlessHost;
use kt830::link::snapshot::RunState;
use kt830::units::Axis;

use crate::stories::{ready_with, tell};

/// A plunge at 6 mm/min of slide, 5 s after its start.
const PLUNGE: &str = "M03\nG98 G01 X-84 F6\nM30";
const GRINDING: &str = "param P61 200\nparam P369 45\nmode auto\nkey cycle-start\nwait 5 s\nexpect state running";
/// Acceleration limit as delivered (P34), µm per tick squared.
const MOST_UM_PER_TICK2: f64 = 0.8;

fn x_mm(rig: &HeadlessHost) -> f64 {
    rig.controller().set_point()[Axis::X]
}

/// Runs until the drives are off; gives the ticks, and the highest acceleration of X in µm per tick squared.
fn until_drives_off(rig: &mut HeadlessHost) -> (usize, f64) {
    let (mut past, mut highest) = ([x_mm(rig) * 1_000.0; 3], 0.0_f64);
    for tick in 0..2_000 {
        rig.step();
        if !rig.trace_row().outputs.drives_on {
            return (tick, highest);
        }
        past = [past[1], past[2], x_mm(rig) * 1_000.0];
        // Three positions make an acceleration.
        if tick >= 3 {
            highest = highest.max((past[2] - 2.0 * past[1] + past[0]).abs());
        }
    }
    panic!("the drives stay on");
}

#[test]
fn b5_a_failing_supply_stops_everything_withdraws_the_wheel_and_keeps_the_place() {
    let mut rig = ready_with(PLUNGE);
    tell(&mut rig, &format!("param P379 2\n{GRINDING}"));
    let from = x_mm(&rig);
    tell(&mut rig, "input power-fail on\nexpect alarm 107");
    let (ticks, highest) = until_drives_off(&mut rig);
    // 2 mm with 20 000 mm/s³ take 4 · ∛(2 / (2 · 20 000)) = 147 ms; braking from 0.1 mm/s and the filter come before.
    assert!((100..200).contains(&ticks), "{ticks} ticks");
    assert!(highest <= MOST_UM_PER_TICK2 * 1.001, "{highest} µm per tick²");
    // The drives go off with the last set-point: the axis is behind by what it lags, and its brake stops it.
    assert!((1.8..2.0).contains(&(x_mm(&rig) - from)), "{from} to {}", x_mm(&rig));
    let wheel = rig.controller().params().output_port(Output::Wheel);
    assert!(!rig.trace_row().outputs.terminals.is_closed(wheel));
    assert_eq!(rig.retained().interrupted, Some((7_000, 2)));
    // RESET does nothing as long as the supply is gone; then the run can go on from its place.
    tell(&mut rig, "key reset\nexpect alarm 107\ninput power-fail off\nkey reset\nwait 1 s\nexpect no alarm");
    assert_eq!(rig.snapshot().interrupted, Some((7_000, 2)));
    assert!(rig.trace_row().outputs.drives_on && rig.controller().state() == RunState::Idle);
}

#[test]
fn b5_the_place_of_the_next_run_is_its_own() {
    let mut rig = ready_with(PLUNGE);
    tell(&mut rig, &format!("{GRINDING}\ninput power-fail on\nwait 1 s\ninput power-fail off\nkey reset\nwait 1 s"));
    tell(&mut rig, "param P61 2000\nkey cycle-start\nwait until idle max 60 s\nexpect no alarm");
    assert_eq!((rig.retained().interrupted, rig.snapshot().interrupted), (None, None));
}

#[test]
fn b5_nothing_is_withdrawn_without_a_distance_a_turning_wheel_or_a_zero() {
    // P379 = 0, as delivered.
    let mut rig = ready_with(PLUNGE);
    tell(&mut rig, GRINDING);
    let from = x_mm(&rig);
    tell(&mut rig, "input power-fail on\nwait 1 s\nexpect alarm 107");
    assert!((x_mm(&rig) - from).abs() < 0.01 && !rig.trace_row().outputs.drives_on);
    // No wheel.
    let mut rig = ready_with("G98 G01 X-84 F6\nM30");
    tell(&mut rig, &format!("param P379 2\n{GRINDING}"));
    let from = x_mm(&rig);
    tell(&mut rig, "input power-fail on\nwait 1 s\nexpect alarm 107");
    assert!((x_mm(&rig) - from).abs() < 0.01, "{from} to {}", x_mm(&rig));
    assert_eq!(rig.retained().interrupted, Some((7_000, 1)));
}

#[test]
fn b5_an_emergency_stop_stops_the_withdrawal() {
    let mut rig = ready_with(PLUNGE);
    tell(&mut rig, &format!("param P379 40\n{GRINDING}"));
    let from = x_mm(&rig);
    tell(&mut rig, "input power-fail on\nwait 0.15 s\nkey emergency-stop\nwait 1 s");
    let moved = x_mm(&rig) - from;
    // 40 mm take 0.7 s; from 0.15 s it brakes within v²/2a and the jerk.
    assert!((0.5..20.0).contains(&moved), "{moved} mm");
    assert!(!rig.trace_row().outputs.drives_on);
}

#[test]
fn b5_the_withdrawal_ends_at_the_soft_limit() {
    // From X -40.5: 50 mm would end at 9.5.
    let mut rig = ready_with(PLUNGE);
    tell(&mut rig, &format!("param P379 50\n{GRINDING}\ninput power-fail on\nwait 2 s"));
    let (_, high) = kt830::controller::soft_limits(rig.controller().params(), Axis::X);
    // The drives go off with the last set-point: the axis is behind by what it lags, and its brake stops it.
    assert!((high - 0.2..high).contains(&x_mm(&rig)), "{} for a limit of {high}", x_mm(&rig));
    assert!(rig.snapshot().alarms.iter().all(|present| present.number == alarm::POWER_FAIL));
}
