//! The end of a control in every state: axes brake within their limits, outputs become safe, the place of a program is kept.
//! Source: safety stance; spec B5 (restart after an interruption), alarm 403.

use kt830::defs::alarm;
use kt830::defs::signal::Output;
use kt830::host::headless::HeadlessHost;
use kt830::link::command::Command;
use kt830::units::Axis;

use crate::stories::{ready_with, tell};

/// Acceleration limit as delivered (P34 …), mm/s², in micrometres per tick squared.
const MOST_UM_PER_TICK2: f64 = 0.8;

const PROGRAM: &str = "M03\nG98 G01 Z-170 F1500\nX-82 F60\nG04 X20\nM30";

/// Ends the control; gives the number of ticks until the axes stand.
fn end(rig: &mut HeadlessHost) -> usize {
    let place = |rig: &HeadlessHost| Axis::ALL.map(|axis| rig.controller().set_point()[axis] * 1_000.0);
    let mut past = [place(rig); 3];
    rig.step();
    past = [past[1], past[2], place(rig)];
    rig.step();
    past = [past[1], past[2], place(rig)];
    rig.begin_end();
    let mut ticks = 0;
    while !rig.controller().is_at_rest() {
        rig.step();
        ticks += 1;
        past = [past[1], past[2], place(rig)];
        // At rest the drives go off, and the set-points follow the encoders.
        for axis in (0..3).filter(|_| !rig.controller().is_at_rest()) {
            let change = past[2][axis] - 2.0 * past[1][axis] + past[0][axis];
            assert!(change.abs() <= MOST_UM_PER_TICK2 * 1.001, "axis {axis}, tick {ticks}: {change} µm per tick²");
        }
        assert!(ticks < 3_000, "the axes never stand");
    }
    rig.leave_safe();
    rig.close();
    ticks
}

fn assert_safe(rig: &HeadlessHost) {
    let outputs = rig.trace_row().outputs;
    assert!(!outputs.drives_on && outputs.wheel_volts.abs() < 1e-12, "{outputs:?}");
    for output in [Output::Wheel, Output::Coolant, Output::HeadstockHigh] {
        let port = rig.controller().params().output_port(output);
        assert!(port == 0 || !outputs.terminals.is_closed(port), "{output:?}");
    }
}

/// Starts the program and lets it run for 0.1 s in a line.
fn run_to(rig: &mut HeadlessHost, line: u32) {
    tell(rig, "mode auto\nkey cycle-start");
    while rig.controller().current_block().line != line {
        rig.step();
    }
    tell(rig, "wait 0.1 s\nexpect state running");
}

fn has_ended_alarm(rig: &HeadlessHost) -> bool {
    rig.retained().alarm_history.iter().any(|past| past.number == alarm::CONTROL_ENDED)
}

#[test]
fn b5_an_end_in_a_run_brakes_makes_safe_and_keeps_the_place() {
    // The first move at 25 mm/s, the infeed, the dwell: lines 2, 3 and 4.
    for line in [2, 3, 4] {
        let mut rig = ready_with(PROGRAM);
        run_to(&mut rig, line);
        let wheel = rig.controller().params().output_port(Output::Wheel);
        assert!(wheel > 0 && rig.trace_row().outputs.terminals.is_closed(wheel), "the wheel turns before the end");
        let ticks = end(&mut rig);
        assert!(ticks < 500, "{ticks} ticks");
        assert_safe(&rig);
        assert!(has_ended_alarm(&rig));
        assert_eq!(rig.retained().interrupted, Some((7_000, line)));
    }
}

#[test]
fn b5_an_end_in_a_pause_keeps_the_place_too() {
    let mut rig = ready_with(PROGRAM);
    run_to(&mut rig, 2);
    tell(&mut rig, "key feed-hold\nwait 0.5 s\nexpect state held");
    assert_eq!(end(&mut rig), 0, "nothing moves");
    assert_safe(&rig);
    assert_eq!(rig.retained().interrupted, Some((7_000, 2)));
}

#[test]
fn b5_an_end_without_a_run_raises_nothing_and_stores_no_place() {
    let mut rig = ready_with(PROGRAM);
    tell(&mut rig, "mode jog");
    assert_eq!(end(&mut rig), 0);
    assert_safe(&rig);
    assert!(!has_ended_alarm(&rig));
    assert_eq!(rig.retained().interrupted, None);
}

#[test]
fn b5_an_end_in_a_jog_brakes_the_axis() {
    let mut rig = ready_with(PROGRAM);
    tell(&mut rig, "mode jog\npress Z-\nwait 0.5 s");
    assert!(!rig.controller().is_at_rest());
    assert!(end(&mut rig) > 0);
    assert_safe(&rig);
    assert!(has_ended_alarm(&rig));
}

/// Its drive went off in full stroke.
#[test]
fn b5_an_end_while_an_axis_oscillates_brakes_it() {
    let mut rig = ready_with(PROGRAM);
    tell(&mut rig, "param P239 -20\nkey oscillation\nwait 0.3 s\nexpect lamp oscillation on");
    assert!(end(&mut rig) > 0);
    assert_safe(&rig);
    assert!(has_ended_alarm(&rig));
}

/// A screen that hangs: after P76 all is as in an emergency stop, and it must be heard again before RESET clears the alarm.
#[test]
fn k3_a_lost_screen_stops_as_the_emergency_stop_does_and_must_come_back_before_reset() {
    let mut rig = ready_with(PROGRAM);
    let alive = |rig: &mut HeadlessHost, ms: usize| {
        for tick in 0..ms {
            if tick % 100 == 0 {
                rig.send(Command::KeepAlive);
            }
            rig.step();
        }
    };
    run_to(&mut rig, 2);
    alive(&mut rig, 3_000);
    tell(&mut rig, "expect state running\nexpect no alarm\nexpect output wheel on");
    // The last keep-alive was 100 ms ago: 1.9 s later P76 is over.
    tell(&mut rig, "wait 1.89 s\nexpect no alarm\nwait 20 ms\nexpect alarm 400\nexpect output wheel off");
    tell(&mut rig, "expect output hydraulic on\nexpect output tailstock on\nwait 0.4 s");
    assert!(rig.controller().is_at_rest());
    assert_safe(&rig);
    tell(&mut rig, "key reset\nwait 0.1 s\nexpect alarm 400\nkey cycle-start\nwait 0.1 s\nexpect output wheel off");
    assert!(rig.controller().is_at_rest());
    alive(&mut rig, 100);
    tell(&mut rig, "expect alarm 400\nkey reset");
    alive(&mut rig, 300);
    tell(&mut rig, "expect no alarm\nexpect state idle");
}
