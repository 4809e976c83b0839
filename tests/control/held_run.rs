//! A held run and the hand: moved axes shift what is programmed as distances, and nothing else (K2.2, K6.3, K5.18).

use crate::stories::{ready_with, tell};

/// X -80 (diameter), Z -150 at the start. Stroke, infeed, stroke back, all as distances; then a place.
const INCREMENTAL: &str = "G98 G01 W-10 F300\nU-1 F60\nW10 F300\nM00\nG00 X-70\nM30";

#[test]
fn k6_3_the_handwheel_shifts_the_remainder_and_all_later_distances() {
    let mut rig = ready_with(INCREMENTAL);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s\nexpect state held");
    // Five clicks of 0.01 mm: the diameter shown is 0.05 mm less.
    tell(&mut rig, "handwheel X -5 x0.01\nexpect X -80.05 ±0.001\nexpect state held");
    // It goes on from handwheel mode. The stroke ends where it was programmed to: X was moved, not Z.
    tell(&mut rig, "key cycle-start\nwait until stopped max 20 s\nexpect X -81.05 ±0.001\nexpect Z -150 ±0.001");
    // A place is a place.
    tell(&mut rig, "key cycle-start\nwait until idle max 5 s\nexpect X -70 ±0.001\nexpect Z -150 ±0.001");
}

#[test]
fn k6_3_without_moving_anything_the_run_goes_on_as_if_nothing_had_been() {
    let mut rig = ready_with(INCREMENTAL);
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s\nmode handwheel\nmode jog\nmode auto",
    );
    tell(&mut rig, "key cycle-start\nwait until stopped max 20 s\nexpect X -81 ±0.001\nexpect Z -150 ±0.001");
}

#[test]
fn k6_3_an_axis_moved_to_and_fro_and_moved_twice_counts_where_it_was_left() {
    let mut rig = ready_with(INCREMENTAL);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s");
    tell(
        &mut rig,
        "handwheel X -30 x0.01\nhandwheel X 25 x0.01\nkey cycle-start\nwait 0.3 s\nkey feed-hold\nwait 0.3 s",
    );
    tell(&mut rig, "handwheel X -5 x0.01\nkey cycle-start\nwait until stopped max 20 s\nexpect X -81.1 ±0.001");
}

#[test]
fn k6_3_a_place_is_reached_from_wherever_the_axis_was_moved() {
    let mut rig = ready_with("G98 G01 Z-170 F300\nX-84 F60\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s\nhandwheel Z 10 x0.1");
    tell(&mut rig, "mode jog\nhold X+ 0.5 s\nwait 0.3 s\nmode auto\nkey cycle-start\nwait until idle max 60 s");
    tell(&mut rig, "expect Z -170 ±0.001\nexpect X -84 ±0.001\nexpect no alarm");
}

#[test]
fn k6_3_an_arc_with_a_place_is_met_where_it_was_left() {
    // A quarter of 10 mm radius about Z -140, X radius -40: from Z -150, X -40 to Z -140, X -50, all radius.
    let mut rig = ready_with("G98 G03 X-100 Z-140 I0 K10 F120\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 2 s\nexpect state running\nkey feed-hold\nwait 0.3 s\nexpect state held",
    );
    tell(&mut rig, "handwheel X 20 x0.1\nkey cycle-start\nwait until idle max 60 s\nexpect no alarm");
    tell(&mut rig, "expect X -100 ±0.001\nexpect Z -140 ±0.001");
}

#[test]
fn k6_3_single_block_and_m00_are_pauses_too() {
    let mut rig = ready_with("G98 G01 W-10 F300\nM00\nU-1 F60\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until stopped max 20 s\nhandwheel X -10 x0.01");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 20 s\nexpect X -81.1 ±0.001");
}

#[test]
fn k6_3_a_shift_that_leaves_the_soft_limits_is_refused_and_the_run_stays_held() {
    // X- ends at -300 mm of slide, 600 of diameter: 20 mm further it is out of its travel.
    let mut rig = ready_with("G98 G00 X-580\nG01 W-10 F120\nU-15 F60\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 5 s\nkey feed-hold\nwait 0.3 s\nexpect state held\nhandwheel X -100 x0.1\nwait 1 s",
    );
    tell(&mut rig, "expect X -590 ±0.001\nmode auto\nkey cycle-start\nexpect state held\nexpect message \"软限位\"");
    tell(&mut rig, "handwheel X 60 x0.1\nwait 1 s\nkey cycle-start\nwait until idle max 30 s\nexpect X -599 ±0.001");
}

#[test]
fn k2_2_while_it_still_brakes_or_runs_the_hand_moves_nothing() {
    let mut rig = ready_with("G98 G01 W-100 F3000\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 1 s\nkey x-minus\nexpect message \"程序运行中\"\nexpect X -80 ±0.001",
    );
}

#[test]
fn k5_18_a_hold_in_contact_withdraws_the_wheel_and_cycle_start_brings_it_back() {
    let mut rig = ready_with("M03\nG98 G01 X-84 F6\nM00\nM30");
    tell(&mut rig, "param P61 200\nparam P90 2\nmode auto\nkey cycle-start\nwait 5 s\nkey feed-hold\nwait 2 s");
    let held = rig.snapshot().axes[kt830::units::Axis::X].work;
    // 4.8 s at 6 mm/min of slide are 0.96 mm of diameter; P90 = 2 mm of slide are 4.
    assert!((-77.0..=-76.9).contains(&held), "held at {held}");
    tell(
        &mut rig,
        "handwheel X -5 x0.01\nkey cycle-start\nwait until stopped max 60 s\nexpect X -84 ±0.001\nexpect no alarm",
    );
}

#[test]
fn k5_18_a_hold_in_a_rapid_or_without_the_wheel_withdraws_nothing() {
    let mut rig = ready_with("G98 G01 X-84 F6\nM30");
    tell(&mut rig, "param P90 2\nmode auto\nkey cycle-start\nwait 5 s\nkey feed-hold\nwait 2 s");
    let held = rig.snapshot().axes[kt830::units::Axis::X].work;
    // 5 s at 6 mm/min of slide are 1 mm of diameter.
    assert!((-81.05..=-80.95).contains(&held), "held at {held}");
}

#[test]
fn k6_3_g50_after_a_shifted_block_calls_the_place_where_the_machine_stands() {
    let mut rig = ready_with("G98 G01 W-10 F300\nG50 Z0\nG01 Z-5 F600\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s\nhandwheel Z -10 x0.01\nkey cycle-start",
    );
    tell(&mut rig, "wait until idle max 10 s\nexpect machine Z -165.1 ±0.001");
}

#[test]
fn k6_3_an_arc_that_would_bulge_over_a_soft_limit_is_refused() {
    // From X -20 to X -20 with R25 over 40 mm: the bulge of 10 mm reaches X radius 0; the limit is +1 mm, 2 of diameter.
    let mut rig = ready_with("G98 G00 X-20\nG04 X3\nG03 U0 W-40 R25 F3000\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 2.5 s\nkey feed-hold\nwait 0.3 s\nexpect state held\nhandwheel X 50 x0.1",
    );
    tell(&mut rig, "wait 1 s\nkey cycle-start\nwait 0.2 s\nexpect state held\nexpect message \"软限位\"");
}

#[test]
fn k6_3_what_was_stopped_in_a_pause_must_turn_again_before_the_run_goes_on() {
    let mut rig = ready_with("M03\nM63\nG98 G01 W-10 F300\nM00\nM05\nM65\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until Z<-151 max 30 s\nkey feed-hold\nwait until held");
    tell(&mut rig, "key wheel-stop\nkey cycle-start\nexpect state held\nexpect message \"砂轮已停\"\nkey wheel-start");
    tell(
        &mut rig,
        "key headstock-stop\nkey cycle-start\nexpect state held\nexpect message \"停转\"\nkey headstock-high",
    );
    tell(&mut rig, "wait 2 s\nkey cycle-start\nwait until stopped max 20 s\nexpect output wheel on");
    // M00 is a pause as well; what the program itself has stopped is not asked for.
    tell(
        &mut rig,
        "key wheel-stop\nkey cycle-start\nexpect state stopped\nkey wheel-start\nkey cycle-start\nwait until idle max 20 s",
    );
}

#[test]
fn k3_4_m63_s_above_the_second_analog_output_is_said() {
    let mut rig = ready_with("M63 S1000\nG04 X1\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.2 s\nexpect message \"S1000\"\nexpect output headstock-high on");
}

#[test]
fn k4_3_in_a_hold_the_strokes_of_the_program_shift_nothing() {
    // Net nothing by hand, and a withdrawal by P90: Z ends at its starting end and goes on from there.
    for pause in ["handwheel X 10 x0.01\nhandwheel X -10 x0.01\nmode auto", "wait 1 s"] {
        let mut rig = ready_with("G98 M03\nG35 Z-160 D300 Q30\nG01 U-1 F10\nG36\nG01 W-5 F300\nM30");
        tell(
            &mut rig,
            "param P90 1\nmode auto\nkey cycle-start\nwait until X<-80.05 max 30 s\nkey feed-hold\nwait 1.3 s",
        );
        tell(&mut rig, pause);
        tell(
            &mut rig,
            "key cycle-start\nwait until idle max 60 s\nexpect Z -155 ±0.001\nexpect X -81 ±0.001\nexpect no alarm",
        );
    }
}

#[test]
fn k4_3_strokes_begun_by_the_key_in_a_hold_must_end_before_cycle_start() {
    let mut rig = ready_with("G98 G01 Z-170 F120\nM00\nM30");
    tell(&mut rig, "param P238 1\nparam P239 -140\nmode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s");
    tell(
        &mut rig,
        "key oscillation\nwait 3 s\nkey cycle-start\nexpect state held\nexpect message \"振荡\"\nexpect alarm 182",
    );
    // K4.3: the alarm goes with the oscillation, and the run goes on.
    tell(&mut rig, "key cycle-start\nexpect state held\nkey oscillation");
    tell(
        &mut rig,
        "wait 20 s\nexpect lamp oscillation off\nexpect no alarm\nkey cycle-start\nwait until stopped max 60 s\nexpect Z -170 ±0.001",
    );
    tell(
        &mut rig,
        "key reset\nmode auto\nmdi G00 Z-150\nwait 1 s\nmode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s",
    );
    tell(&mut rig, "key oscillation\nwait 1.3 s\nkey reset\nwait 2 s\nexpect no alarm\nexpect lamp oscillation off");
}

#[test]
fn k4_3_the_cylinder_begun_by_the_key_in_a_hold_is_alarm_182_the_programs_own_is_not() {
    let mut rig = ready_with("G98 G01 Z-170 F120\nM00\nM30");
    tell(&mut rig, "param P17.1 1\nmode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s\nkey oscillation");
    tell(&mut rig, "expect lamp oscillation on\nkey cycle-start\nexpect alarm 182\nexpect state held\nkey oscillation");
    tell(&mut rig, "wait 1 s\nexpect no alarm\nkey cycle-start\nexpect state running");
    let mut rig = ready_with("G98 G35\nG01 Z-170 F120\nM00\nM30");
    tell(&mut rig, "param P17.1 1\nmode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s");
    tell(&mut rig, "expect lamp oscillation on\nkey cycle-start\nexpect no alarm\nexpect state running");
}

#[test]
fn b5_after_a_stall_of_the_computer_a_run_waits_for_the_operator() {
    let mut rig = ready_with(INCREMENTAL);
    tell(&mut rig, "stall\nwait 0.1 s\nexpect no alarm");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nexpect state running\nstall\nwait 2 s\nexpect alarm 404");
    let held = rig.controller().set_point();
    tell(&mut rig, "wait 5 s\nexpect alarm 404");
    assert_eq!(rig.controller().set_point(), held);
    tell(&mut rig, "key reset\nwait 1 s\nexpect no alarm\nwait 5 s\nexpect state idle");
}

/// A hold alone does not end the oscillation of a program (K4.3); after a standstill of the computer nobody has watched it.
#[test]
fn b5_after_a_stall_of_the_computer_a_held_run_does_not_oscillate_on() {
    for hold in ["", "key feed-hold\nwait 0.5 s\nexpect state held\nexpect no alarm\n"] {
        let mut rig = ready_with("G35 Z-170 Q2000\nG98 G01 U-4 F4\nG36\nM30");
        tell(&mut rig, &format!("mode auto\nkey cycle-start\nwait 2 s\n{hold}stall\nwait 2 s\nexpect alarm 404"));
        let stopped = rig.controller().set_point();
        tell(&mut rig, "wait 3 s\nexpect alarm 404");
        assert_eq!(rig.controller().set_point(), stopped, "{hold}");
        tell(&mut rig, "key reset\nwait 3 s\nexpect no alarm\nexpect state idle");
        assert_eq!(rig.controller().set_point(), stopped, "RESET alone moves nothing");
    }
}

#[test]
fn b5_after_a_stall_of_the_computer_nothing_moves_on_by_hand() {
    for (what, begin) in [
        ("jog", "mode jog\npress z-minus\nwait 0.5 s"),
        ("homing", "mode home\nkey x-plus\nwait 0.3 s"),
        ("oscillation", "mode jog\nkey oscillation\nwait 1.3 s"),
    ] {
        let mut rig = ready_with("M30");
        tell(&mut rig, &format!("{begin}\nexpect no alarm\nstall\nwait 2 s\nexpect alarm 404"));
        let stopped = rig.controller().set_point();
        tell(&mut rig, "wait 3 s\nexpect alarm 404");
        assert_eq!(rig.controller().set_point(), stopped, "{what} has stopped");
        tell(&mut rig, "key reset\nwait 1 s\nexpect no alarm");
        assert_eq!(rig.controller().set_point(), stopped, "{what}: RESET alone moves nothing");
    }
}
