//! The grinding functions of K4 as stories: wear, dressing point, oscillation, gauge positioning.

use crate::stories::{ready, ready_of, ready_with, tell};
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::signal::Output;
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;
use kt830::units::Axis;

#[test]
fn k4_1_g10_adds_to_the_wear_at_once() {
    let mut rig = ready_with("G10 D04 U0.1 W-0.1\nG10 D4 U0.05\nM00\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until stopped max 2 s\nexpect wear 4 X 0.15\nexpect wear 4 Z -0.1",
    );
    // In force, it shifts the work coordinate: X + 0.15 of diameter.
    let mut rig = ready_with("T0104\nG10 D4 U0.1\nG00 X-70\nM00\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until stopped max 9 s\nexpect X -70 ±0.001\nexpect machine X -69.9 ±0.001",
    );
}

#[test]
fn k4_1_a_wrong_or_missing_d_changes_nothing() {
    for text in ["G10 D17 U0.1", "G10 D0 U0.1", "G10 U0.1", "G10 D1.5 U0.1", "G10 D4"] {
        let mut rig = ready_with(&format!("{text}\nM30"));
        tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm any\nexpect wear 4 X 0");
    }
}

#[test]
fn k4_2_the_point_is_set_on_the_position_page_and_outlives_reset_and_power() {
    let mut rig = ready();
    tell(
        &mut rig,
        "mode jog\npage position\nkey f1\nkey address-x\nexpect message \"是否设置 X 轴修整点\"\nkey cancel",
    );
    tell(&mut rig, "key address-x\nkey input\nexpect message \"设置成功\"\nhold X+ 2 s\nwait 0.5 s");
    // The lamp is the state: lit, one press of an axis key of either sign runs to the point.
    tell(
        &mut rig,
        "key reset\nkey dress-return\nexpect lamp dress-return on\nkey x-plus\nwait 6 s\nexpect machine X -80 ±0.001",
    );
    tell(&mut rig, "mode auto\nexpect lamp dress-return off");
    tell(
        &mut rig,
        "power cut\nwait 1 s\npower on\nkey hydraulic\nmode jog\nkey dress-return\nkey x-plus\nexpect message \"未回零\"\nexpect alarm 100\nkey reset",
    );
    tell(&mut rig, "home all\nmode jog\nkey dress-return\nkey x-minus\nwait 8 s\nexpect machine X -80 ±0.001");
    tell(&mut rig, "key reset\nexpect lamp dress-return off");
}

#[test]
fn k4_2_the_question_comes_in_the_relative_view_alone() {
    // Seed: 位置界面-相对坐标页面, not on the main view, against mistakes; K2.4: elsewhere the key says why and what to do.
    let mut rig = ready();
    tell(&mut rig, "mode jog\npage position");
    for elsewhere in ["", "key f2\n", "key f3\n"] {
        tell(&mut rig, &format!("{elsewhere}key address-x\nexpect message \"不是相对坐标\"\nexpect message \"F1\""));
        tell(&mut rig, "key input\nexpect message \"没有要输入\"");
    }
    tell(&mut rig, "page grinding\nkey address-x\nexpect message \"不在位置页面\"");
    // The view is kept while another page is open.
    tell(&mut rig, "page position\nkey f1\npage alarm\npage position\nkey address-x\nexpect message \"是否设置 X\"");
    // Asked there and answered elsewhere is not answered.
    tell(&mut rig, "key f3\nkey input\nexpect message \"没有要输入\"");
    tell(&mut rig, "key f1\nkey address-z\npage alarm\nkey input\nexpect message \"没有要输入\"");
    assert!(rig.snapshot().dressing_point.iter().all(|(_, point)| point.is_none()));
    // Answered while the axis still brakes: the question stays until it stands.
    tell(&mut rig, "page position\nhold X+ 0.5 s\nkey address-x\nkey input\nexpect message \"还在运动\"\nwait 0.5 s");
    tell(&mut rig, "key input\nexpect message \"X 轴修整点设置成功\"");
    // The power comes back to the main view.
    tell(
        &mut rig,
        "page position\npower cut\npower on\nhome all\nmode jog\nkey address-x\nexpect message \"不是相对坐标\"",
    );
}

#[test]
fn k4_2_setting_needs_manual_mode_and_homing() {
    let mut rig = ready();
    tell(
        &mut rig,
        "mode auto\npage position\nkey address-x\nexpect message \"手动方式\"\nkey input\nexpect message \"没有要输入\"",
    );
    let mut rig = crate::stories::rig();
    tell(&mut rig, "mode jog\npage position\nkey f1\nkey address-z\nexpect message \"未回零\"");
}

#[test]
fn k4_2_the_return_by_key_without_a_point_is_the_alarm_of_g27() {
    let mut rig = ready();
    tell(&mut rig, "mode jog\nkey dress-return\nkey x-plus\nexpect alarm 196\nexpect message \"X 轴没有设置修整点\"");
    let by_key = rig.snapshot().alarms.clone();
    tell(&mut rig, "expect lamp dress-return on\nwait 1 s\nexpect machine X -80 ±0.001\nexpect machine Z -150 ±0.001");
    // Pressed again it says so again (K2.4).
    tell(&mut rig, "key z-minus\nexpect message \"Z 轴没有设置修整点\"\nwait 1 s\nexpect machine Z -150 ±0.001");
    tell(&mut rig, "key reset\nexpect no alarm\nexpect lamp dress-return off\nhold X+ 0.5 s\nexpect no alarm");
    let mut rig = ready_with("G27 X\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 2 s");
    let by_program = rig.snapshot().alarms.clone();
    assert_eq!((by_key.len(), by_program.len()), (1, 1));
    // The program's has its place before the same words.
    assert_eq!(by_program[0].text.zh().replace("O7000 第1行 ", ""), by_key[0].text.zh());
    assert_eq!(by_program[0].remedy, by_key[0].remedy);
    assert_eq!((by_program[0].number, by_key[0].number), (196, 196));
}

#[test]
fn k6_3_a_held_run_survives_a_return_that_has_no_point() {
    let mut rig = ready_with("M00\n#100=1\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until stopped max 2 s\nmode jog\nkey dress-return\nkey x-plus");
    tell(&mut rig, "expect no alarm\nexpect message \"修整点\"\nkey dress-return\nmode auto\nkey cycle-start");
    tell(&mut rig, "wait until idle max 2 s\nexpect #100 1");
}

#[test]
fn k4_2_g27_goes_to_the_point_in_machine_coordinates() {
    // G50 and G55 change nothing about it; F is its own; P243 = 1000 mm/min without F: 20 mm of slide in 1.2 s.
    let mut rig = ready_with("G50 X500\nG55\nG27 X\nM00\nG27 Z X F3000\nM00\nG27 F60\nM30");
    tell(
        &mut rig,
        "mode jog\npage position\nkey f1\nkey address-x\nkey input\nkey address-z\nkey input\nhold X+ 1 s\nhold Z- 1 s\nwait 0.5 s",
    );
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until stopped max 3 s\nexpect machine X -80 ±0.001");
    tell(
        &mut rig,
        "key cycle-start\nwait until stopped max 3 s\nexpect machine Z -150 ±0.001\nkey cycle-start\nwait until idle max 2 s",
    );
}

#[test]
fn k4_2_g27_without_a_point_or_with_a_number_is_an_alarm() {
    let mut rig = ready_with("G27 X\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm 196\nexpect X -80 ±0.001");
    let mut rig = ready_with("G27 X10\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm 49");
}

/// Set-points of an axis, tick by tick.
fn course(rig: &mut HeadlessHost, axis: Axis, ticks: usize) -> Vec<f64> {
    (0..ticks)
        .map(|_| {
            rig.step();
            rig.controller().set_point()[axis]
        })
        .collect()
}

/// Greatest speed, mm/min, by differences over a tick.
fn greatest_speed(course: &[f64]) -> f64 {
    course.windows(2).map(|pair| (pair[1] - pair[0]).abs() * 60_000.0).fold(0.0, f64::max)
}

#[test]
fn k4_3_the_cruise_speed_is_two_l_q_of_slide_travel() {
    // Z: L = 100, Q = 10: 2000 mm/min. X-180 from X-80 is 50 mm of slide: 1000 mm/min.
    for (block, axis, expected) in [("G35 Z-250 D400 Q10", Axis::Z, 2_000.0), ("G35 X-180 D400 Q10", Axis::X, 1_000.0)]
    {
        let mut rig = ready_with(&format!("{block}\nG04 X60\nM30"));
        tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect lamp oscillation on");
        let course = course(&mut rig, axis, 8_000);
        let speed = greatest_speed(&course);
        assert!((speed - expected).abs() < 0.01 * expected, "{block}: {speed} mm/min");
        // D400: 10 m/min in 400 ms are 416.7 mm/s².
        let acceleration = course.windows(3).map(|p| (p[2] - 2.0 * p[1] + p[0]).abs() * 1e6).fold(0.0, f64::max);
        assert!(acceleration <= 416.7 * 1.001 && acceleration > 400.0, "{block}: {acceleration} mm/s²");
    }
}

#[test]
fn k4_3_dwells_flags_and_measured_frequency() {
    let mut rig = ready_with("G35 Z-200 D400 Q10\nG04 X100\nM30");
    tell(&mut rig, "param P235 250\nparam P236 125\nmode auto\nkey cycle-start\nwait 0.05 s");
    let flags = |rig: &HeadlessHost| rig.controller().oscillation_flags();
    assert_eq!(flags(&rig), (false, false));
    let mut edges = Vec::new();
    let mut last = (false, false);
    for tick in 0..40_000_u32 {
        rig.step();
        let now = flags(&rig);
        if now != last {
            edges.push((tick, now, rig.controller().set_point()[Axis::Z]));
            last = now;
        }
    }
    // Forward, backward, forward …: never both, never none, each at its very end.
    for (number, (_, flag, at)) in edges.iter().enumerate() {
        let forward = number % 2 == 0;
        assert_eq!(*flag, (forward, !forward), "edge {number}");
        let end = if forward { -200.0 } else { -150.0 };
        assert!((at - end).abs() < 1e-9, "edge {number} at {at}");
    }
    // One way: 50 mm at 1000 mm/min = 16.667 mm/s with 416.7 mm/s² and 20 000 mm/s³:
    // 50 / 16.667 + 16.667 / 416.7 + 416.7 / 20 000 = 3.0000 + 0.0400 + 0.0208 = 3.0608 s; in position some 60 ms later.
    // Dwells 250 × 4 ms and 125 × 4 ms: a cycle of 2 × 3.06 + 1.5 + 0.12 = 7.74 s or 7.75 strokes a minute, below Q.
    let forward: Vec<u32> = edges.iter().step_by(2).map(|(tick, ..)| *tick).collect();
    for pair in forward.windows(2) {
        let cycle = pair[1] - pair[0];
        assert!((7_680..=7_800).contains(&cycle), "a cycle of {cycle} ms");
    }
    let shown = rig.snapshot().strokes_per_min.unwrap();
    assert!((7.69..=7.82).contains(&shown), "{shown} strokes a minute");
}

#[test]
fn k4_3_g36_ends_at_the_starting_end_then_the_next_block_runs() {
    let mut rig = ready_with("G35 Z-200 Q20\nG04 X2\nG36\nM00\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 3 s\nexpect lamp oscillation on\nwait until stopped max 10 s");
    tell(&mut rig, "expect Z -150 ±0.001\nexpect lamp oscillation off\nexpect #438 0\nexpect #439 0");
}

/// The signal comes while Z is in the middle of its stroke. What Z has left of it is no part of the next stage's path:
/// F0.6 in diameter is 0.005 mm/s of radius.
#[test]
fn k4_3_a_stage_after_a_skip_runs_at_its_feed_while_z_oscillates() {
    for (tail, millis) in [("G31 X-85 F0.6 P2", 1_200), ("G01 X-85 F0.6", 1_450), ("G31 X-85 F0.6 P2", 1_700)] {
        let text = format!("G98\nG35 Z-160 D300 Q60\nG31 X-90 F60 P1\n{tail}\nM30");
        let mut rig = ready_with(&text);
        tell(&mut rig, &format!("mode auto\nkey cycle-start\nwait {millis} ms\ninput gauge-1 on\nwait 0.5 s"));
        tell(&mut rig, "expect state running");
        let x = |rig: &HeadlessHost| rig.controller().set_point()[Axis::X];
        let before = x(&rig);
        tell(&mut rig, "wait 2 s");
        let feed = (before - x(&rig)) / 2.0 * 60.0;
        assert!((feed / 0.6 - 1.0).abs() < 0.005, "{tail} at {millis} ms: {feed} mm/min");
    }
}

#[test]
fn k4_3_infeed_at_the_reversal_by_438_neither_misses_nor_doubles_a_stroke() {
    // Ten strokes; at every forward end the wheel goes 0.01 mm of diameter in.
    let text = "G98\nG35 Z-160 D300 Q60\n#1=0\nWHILE[#1 LT 10]DO1\nN10 IF[#438 EQ 0]GOTO 10\nG01 U-0.01 F60\n#1=#1+1\n\
                N20 IF[#439 EQ 0]GOTO 20\nEND1\nG36\n#500=#1\nM30";
    let mut rig = ready_with(text);
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until idle max 60 s\nexpect #500 10\nexpect X -80.1 ±0.001\nexpect Z -150 ±0.001",
    );
}

#[test]
fn k4_3_what_is_too_little_is_clamped_and_said() {
    let mut rig = ready_with("G35 Z-160 D400 Q-4\nG04 X5\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect message \"Q-4\"\nexpect lamp oscillation on");
    let mut rig = ready_with("G35 Z-160 D400 Q0.5\nG04 X5\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect message \"Q0.5\"\nexpect lamp oscillation on");
    // P237 = 3000 mm/min: 2 × 100 × 60 = 12 000 is too fast.
    let mut rig = ready_with("G35 Z-250 Q60\nG04 X5\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect message \"3000\"");
    let course = course(&mut rig, Axis::Z, 5_000);
    assert!((greatest_speed(&course) - 3_000.0).abs() < 30.0);
    // 10 m/min at 800 mm/s² take 208 ms.
    let mut rig = ready_with("G35 Z-160 D50 Q10\nG04 X5\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s\nexpect message \"208\"");
}

#[test]
fn k4_3_wrong_strokes_are_alarms_before_anything_moves() {
    for (block, alarm) in
        [("G35 X-90 Z-160 Q5", 34), ("G35 Q5", 33), ("G35 Z-150 Q5", 197), ("G35 Z-2000 Q5", 101), ("G35 U-5 Q5", 33)]
    {
        let mut rig = ready_with(&format!("{block}\nM30"));
        tell(&mut rig, &format!("mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm {alarm}"));
        tell(&mut rig, "expect Z -150 ±0.001\nexpect lamp oscillation off");
    }
}

#[test]
fn k4_3_words_for_the_oscillating_axis_are_refused_before_their_block() {
    for block in ["G01 Z-155 F60", "G00 W-1", "G90 X-90 Z-155 F60", "G53 Z-10", "G28 W0", "G50 Z0"] {
        let mut rig = ready_with(&format!("G98 G35 Z-160 Q20\nG01 X-82 F300\n{block}\nM30"));
        tell(
            &mut rig,
            "mode auto\nkey cycle-start\nwait until alarm max 10 s\nexpect alarm 198\nwait 0.3 s\nexpect X -82 ±0.001",
        );
    }
}

#[test]
fn k4_3_reset_and_emergency_stop_end_it_at_once() {
    for key in ["reset", "emergency-stop"] {
        let mut rig = ready_with("G35 Z-250 Q10\nG04 X60\nM30");
        tell(
            &mut rig,
            &format!("mode auto\nkey cycle-start\nwait 2 s\nkey {key}\nwait 0.5 s\nexpect lamp oscillation off"),
        );
        let course = course(&mut rig, Axis::Z, 200);
        assert!(greatest_speed(&course) < 1e-9 && (course[0] + 150.0).abs() > 1.0, "{key}: stands at {}", course[0]);
    }
}

#[test]
fn k4_3_a_feed_hold_holds_the_program_and_the_strokes_go_on() {
    let mut rig = ready_with("G98 G35 Z-160 Q30\nG01 X-90 F30\nG36\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 2 s\nkey feed-hold\nwait 0.5 s\nexpect state held\nexpect lamp oscillation on",
    );
    assert!(greatest_speed(&course(&mut rig, Axis::Z, 2_000)) > 100.0);
    assert!(greatest_speed(&course(&mut rig, Axis::X, 500)) < 1e-9);
    // Its own program goes on: no alarm 182.
    tell(
        &mut rig,
        "key cycle-start\nexpect no alarm\nwait until idle max 60 s\nexpect X -90 ±0.001\nexpect Z -150 ±0.001",
    );
}

#[test]
fn k4_3_m30_leaves_it_and_the_next_start_is_alarm_182() {
    let mut rig = ready_with("G35 Z-160 Q30\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 2 s\nexpect lamp oscillation on\nkey cycle-start");
    tell(
        &mut rig,
        "expect alarm 182\nexpect state alarm\nkey reset\nwait 0.5 s\nexpect lamp oscillation off\nkey cycle-start",
    );
    tell(&mut rig, "expect no alarm");
}

#[test]
fn k4_3_the_key_oscillates_by_its_parameters_and_jogging_that_axis_is_refused() {
    let mut rig = ready();
    tell(
        &mut rig,
        "param P238 1\nparam P239 -160\nparam P241 30\nmode jog\nkey oscillation\nexpect lamp oscillation on\nwait 1 s",
    );
    tell(&mut rig, "key z-plus\nexpect message \"振荡中\"\nhold X+ 0.5 s\nwait 0.5 s");
    assert!(rig.controller().set_point()[Axis::X] > -39.9, "the other axis jogs");
    tell(&mut rig, "mode mdi\nmdi G36\nwait 3 s\nexpect lamp oscillation off\nexpect Z -150 ±0.001");
    // Not homed, or no stroke: said, nothing moves.
    tell(
        &mut rig,
        "param P239 -150\nmode jog\nkey oscillation\nexpect message \"没有振荡行程\"\nexpect lamp oscillation off",
    );
}

#[test]
fn k4_3_m35_and_m36_are_aliases() {
    let mut rig = ready_with("M35 Z-160 D400 Q30\nG04 X3\nM36\nM00\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 2 s\nexpect lamp oscillation on\nwait until stopped max 10 s\nexpect Z -150 ±0.001",
    );
}

/// P238 X, P239, P240, P241 as the key has them (K4.3).
#[test]
fn k4_3_m35_alone_oscillates_by_the_parameters_and_m36_ends_it() {
    let mut rig = ready();
    tell(&mut rig, "param P239 -120\nparam P241 30\nmode mdi\nmdi G00 X-100\nwait 1 s\nexpect X -100 ±0.002\nmdi M35");
    tell(&mut rig, "expect no alarm\nexpect lamp oscillation on\nwait until X<-119 max 5 s\nwait until X>-101 max 5 s");
    tell(&mut rig, "mdi M36\nwait 4 s\nexpect lamp oscillation off\nexpect X -100 ±0.002");
    // In a program; the other axes go on.
    let mut rig = ready_with("M35\nG98 G01 X-90 F300\nM36\nM00\nM30");
    tell(&mut rig, "param P238 1\nparam P239 -160\nparam P241 30\nmode auto\nkey cycle-start\nwait 1 s");
    tell(&mut rig, "expect lamp oscillation on\nwait until stopped max 30 s\nexpect lamp oscillation off");
    tell(&mut rig, "expect Z -150 ±0.001\nexpect X -90 ±0.001");
}

#[test]
fn k4_3_m35_alone_without_a_stroke_is_refused() {
    // Z stands at P239 already.
    let mut rig = ready_with("M35\n#100=7\nM30");
    tell(&mut rig, "param P238 1\nparam P239 -150\nmode auto\nkey cycle-start\nwait until alarm max 5 s");
    tell(&mut rig, "expect alarm 197\nexpect lamp oscillation off\nexpect Z -150 ±0.001");
    assert_eq!(rig.snapshot().variables[100], None);
    // P17.1: the cylinder needs no words.
    tell(
        &mut ready(),
        "param P17.1 1\nmode mdi\nmdi M35\nexpect output oscillation-forward on\nmdi M36\nwait 1 s\nexpect lamp oscillation off",
    );
}

#[test]
fn k4_4_the_cylinder_goes_to_and_fro_between_its_switches() {
    let mut rig = ready();
    tell(
        &mut rig,
        "param P17.1 1\nparam P235 100\nparam P236 100\nmode mdi\nmdi G35\nexpect output oscillation-forward on",
    );
    tell(&mut rig, "expect lamp oscillation on");
    let mut seen = [0_u32; 2];
    let mut before = [true, false];
    for _ in 0..6_000 {
        rig.step();
        let on = rig.controller().output_set();
        let now = [on.has(Output::OscillationForward), on.has(Output::OscillationBackward)];
        assert!(!(now[0] && now[1]), "both valves");
        for way in 0..2 {
            seen[way] += u32::from(now[way] && !before[way]);
        }
        before = now;
    }
    // 100 mm at 200 mm/s and 0.4 s of dwell a way: some 1 s a way, three times there and back in 6 s.
    assert!(seen[0] >= 2 && seen[1] >= 2, "{seen:?}");
    tell(&mut rig, "mdi G36\nexpect output oscillation-forward off\nexpect output oscillation-backward off");
    tell(&mut rig, "mode jog\nkey oscillation\nexpect lamp oscillation on\nkey reset\nexpect lamp oscillation off");
}

#[test]
fn k4_4_both_switches_at_once_or_none_in_time_is_an_alarm() {
    let mut rig = ready();
    tell(
        &mut rig,
        "param P17.1 1\nmode jog\nkey oscillation\ninput oscillation-forward-end off\nwait 3.2 s\nexpect alarm 199",
    );
    tell(&mut rig, "expect output oscillation-forward off\nkey reset\ninput oscillation-forward-end free\nwait 1 s");
    tell(
        &mut rig,
        "input oscillation-forward-end on\ninput oscillation-backward-end on\nkey oscillation\nexpect alarm 199",
    );
}

#[test]
fn k4_5_without_a_signal_it_is_alarm_183_and_the_gauge_goes_back() {
    let mut rig = ready_with("M78\nG78 Z-160 F600 J60 P4 L3\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until alarm max 10 s\nexpect alarm 183\nexpect output axial-gauge off",
    );
    tell(&mut rig, "expect Z -160 ±0.001");
}

#[test]
fn k4_5_a_signal_that_is_there_before_is_an_alarm_and_nothing_moves() {
    let mut rig = ready_with("M78\nG78 Z-160 F600 J60 P4 L3\nM30");
    tell(
        &mut rig,
        "input gauge-4 on\nmode auto\nkey cycle-start\nwait until alarm max 10 s\nexpect alarm 200\nexpect Z -150 ±0.001",
    );
}

#[test]
fn k4_5_single_contact_latches_both_approaches() {
    let mut rig = ready_with("M78\nG78 Z-170 F600 J60 P4 L3\nM00\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.5 s");
    // The story plays the part: a contact at Z -155.
    touch(&mut rig, -155.0, None);
    tell(&mut rig, "expect state stopped\nexpect no alarm\nexpect output axial-gauge off");
    // 10 mm/s a tick are 0.01 mm; 1 mm/s are 0.001 mm. #437 = #436 − #435.
    tell(&mut rig, "expect #435 -155.005 ±0.012\nexpect #436 -155 ±0.002\nexpect #434 -80 ±0.001");
    let [fast, fine, off] = [435, 436, 437].map(|number| rig.controller().system_variable(number).unwrap());
    assert!((off - (fine - fast)).abs() < 1e-12);
    // Retracted by L from where it stood: -155 and a little, plus 3.
    assert!((rig.snapshot().axes[Axis::Z].work + 152.0).abs() < 0.1);
}

/// The axis stops 0.43 mm behind the touch; a retract of 0.6 mm leaves it near its end: a gauge that takes its signal back 100 ms after the touch still holds it then. One that
/// holds it 0.5 s is stuck.
#[test]
fn k4_5_a_late_signal_may_outlast_the_retract_a_stuck_one_is_alarm_200() {
    for (late_ms, says) in
        [(100, "expect state stopped\nexpect no alarm\nexpect #436 -155 ±0.002"), (500, "expect alarm 200")]
    {
        let mut rig = ready_with("M78\nG78 Z-170 F600 J60 P4 L0.6\nM00\nM30");
        tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.5 s");
        let mut left = u32::MAX;
        for _ in 0..10_000 {
            let touches = rig.controller().actual()[Axis::Z] <= -155.0;
            left = if touches { 0 } else { left.saturating_add(1) };
            rig.machine_mut().force_input("gauge-4", Some(left < late_ms)).unwrap();
            rig.step();
            if rig.controller().state() != kt830::link::snapshot::RunState::Running {
                break;
            }
        }
        tell(&mut rig, says);
    }
}

#[test]
fn k4_5_two_stages_go_on_in_the_same_direction() {
    let mut rig = ready_with("M78\nG78 Z-170 F600 J60 P4 Q6 L3\nM00\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.5 s");
    touch(&mut rig, -155.0, Some(-156.0));
    tell(&mut rig, "expect state stopped\nexpect no alarm\nexpect #435 -155.005 ±0.012\nexpect #436 -156 ±0.002");
}

/// The customer's sample, F1500 and J60: the axis needs 25²/(2·800) mm to brake, with its jerk 2·√(25/20000) s · 25/2 mm/s
/// = 0.88 mm, and the drive lags 20 ms · 25 mm/s = 0.5 mm behind. A second stage 1 mm behind the first comes on in that.
#[test]
fn k4_5_an_edge_of_q_before_speed_j_is_alarm_205_and_no_measurement() {
    for (second, what) in [(-155.0, "with P"), (-156.0, "while it brakes"), (-154.0, "before P")] {
        let mut rig = ready_with("M78\nG78 Z-170 F1500 J60 P4 Q6 L3\nM00\nM30");
        tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s");
        touch(&mut rig, -155.0, Some(second));
        tell(&mut rig, "wait until alarm max 2 s\nexpect alarm 205\nexpect output axial-gauge off");
        assert_eq!(rig.controller().system_variable(436), None, "{what}");
        let stands = rig.snapshot().axes[Axis::Z].work;
        // From the edge of P or Q: 0.88 mm of braking and 0.5 mm of lag.
        let first = second.max(-155.0);
        assert!((first - 1.5..first).contains(&stands), "{what}: it stands at {stands}");
    }
    // A second stage 2 mm behind the first is measured at J.
    let mut rig = ready_with("M78\nG78 Z-170 F1500 J60 P4 Q6 L3\nM00\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.1 s");
    touch(&mut rig, -155.0, Some(-157.0));
    tell(&mut rig, "expect state stopped\nexpect no alarm\nexpect #436 -157 ±0.002");
}

#[test]
fn k4_5_q_that_is_on_at_the_start_or_comes_in_a_hold_is_alarm_205() {
    let mut rig = ready_with("G78 Z-170 F1500 J60 P4 Q6 L3\nM30");
    tell(&mut rig, "input gauge-6 on\nmode auto\nkey cycle-start\nwait until alarm max 5 s\nexpect alarm 205");
    tell(&mut rig, "expect Z -150 ±0.001");
    let mut rig = ready_with("G78 Z-250 F1500 J60 P4 Q6 L3\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until Z<-160 max 30 s\nkey feed-hold\ninput gauge-4 on");
    tell(&mut rig, "input gauge-6 on\ninput gauge-6 off\nwait until held max 5 s\nexpect no alarm\nkey cycle-start");
    tell(&mut rig, "wait until alarm max 5 s\nexpect alarm 205");
}

#[test]
fn k4_5_speed_j_under_the_feed_override_is_reached_too() {
    let mut rig = ready_with("M78\nG78 Z-170 F600 J60 P4 Q6 L3\nM00\nM30");
    tell(
        &mut rig,
        "mode auto\nkey feed-override-down\nkey feed-override-down\nkey feed-override-down\nkey cycle-start\nwait 0.1 s",
    );
    touch(&mut rig, -155.0, Some(-156.0));
    tell(&mut rig, "expect state stopped\nexpect no alarm\nexpect #436 -156 ±0.002");
}

/// Gives the gauge's signals as a part at these places would, until the run stands.
fn touch(rig: &mut HeadlessHost, first: f64, second: Option<f64>) {
    for _ in 0..60_000 {
        let z = rig.controller().actual()[Axis::Z];
        rig.machine_mut().force_input("gauge-4", Some(z <= first)).unwrap();
        if let Some(second) = second {
            rig.machine_mut().force_input("gauge-6", Some(z <= second)).unwrap();
        }
        rig.step();
        if rig.controller().state() != kt830::link::snapshot::RunState::Running {
            return;
        }
    }
}

#[test]
fn k4_5_missing_words_are_named_before_anything_moves() {
    for block in [
        "G78 F600 J60 P4 L3",
        "G78 Z-160 J60 P4 L3",
        "G78 Z-160 F600 P4 L3",
        "G78 Z-160 F600 J60 L3",
        "G78 Z-160 F600 J60 P4",
    ] {
        let mut rig = ready_with(&format!("{block}\nM30"));
        tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm 33\nexpect Z -150 ±0.001");
    }
    let mut rig = ready_of(Kind::Gs);
    rig.add_program(kt830::host::folders::program_from_bytes(
        7_000,
        "O7000.NC",
        b"G78 Y-110 F600 J60 P4 L3\nM30".to_vec(),
        rig.kind().dialect(),
    ));
    tell(
        &mut rig,
        "load O7000\nmode auto\nkey cycle-start\nwait until alarm max 10 s\nexpect alarm 183\nexpect Y -110 ±0.001",
    );
}

#[test]
fn k4_5_a_contact_while_the_axis_brakes_in_a_hold_is_latched_at_its_edge() {
    // At 3000 mm/min the axis needs 50² / (2·800) mm = 1.6 mm and some jerk to stand: the contact comes on the way.
    let mut rig = ready_with("G78 Z-250 F3000 J60 P4 L3\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until Z<-160 max 30 s");
    rig.send(Command::Press(Key::FeedHold));
    (0..20).for_each(|_| rig.step());
    let before = rig.controller().actual()[Axis::Z];
    tell(&mut rig, "input gauge-4 on");
    let after = rig.controller().actual()[Axis::Z];
    tell(&mut rig, "wait until held max 5 s\nwait 0.3 s");
    let stands = rig.controller().actual()[Axis::Z];
    assert!(after - stands > 0.2, "it went on from {after} to {stands}");
    tell(&mut rig, "input gauge-4 off\nkey cycle-start\nwait 1 s");
    let latched = rig.controller().system_variable(435).unwrap();
    assert!(latched <= before && latched >= after, "latched {latched}, the edge came between {before} and {after}");
}
