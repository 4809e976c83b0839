//! Running programs: start conditions, hold, single block, frames, variables as executed, bad input.

use kt830::controller::WORK_PER_TICK;
use kt830::defs::alarm;
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::text::{Lang, LocalizedText};
use kt830::host::folders::program_from_bytes;
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;
use kt830::link::snapshot::RunState;
use kt830::motion::MAX_TRAJECTORY_WORK;
use kt830::units::Axis;

use crate::stories::{ready, ready_with, rig, tell};

#[test]
fn b5_cycle_start_without_homing_is_alarm_100_and_moves_nothing() {
    let mut rig = rig();
    tell(&mut rig, "key hydraulic\nwait 4 s\nload O1002\nmode auto\nkey cycle-start\nexpect alarm 100\nwait 1 s");
    tell(&mut rig, "expect machine X 0 ±0.001\nexpect output wheel off\nkey reset\nexpect no alarm");
}

#[test]
fn b5_cycle_start_without_a_program_or_in_another_mode_says_so() {
    let mut rig = ready();
    tell(&mut rig, "mode auto\nkey cycle-start\nexpect message \"没有程序\"\nexpect state idle");
    tell(&mut rig, "load O1002\nmode jog\nkey cycle-start\nexpect message \"自动\"\nexpect state idle");
    assert!(crate::stories::refused(&mut rig, "load O4711").contains("程序目录中没有 O4711"));
}

#[test]
fn b5_cycle_start_with_an_alarm_present_is_refused() {
    let mut rig = ready_with("#100=1\nM30");
    tell(
        &mut rig,
        "fault drive-X\nwait 1 s\nexpect alarm 104\nmode auto\nkey cycle-start\nexpect message \"驱动已断开\"",
    );
    tell(&mut rig, "key cycle-start\nexpect state alarm");
    let mut rig = ready_with("#100=1\nM30");
    tell(
        &mut rig,
        "param P333 60\ninput coolant-flow off\nkey coolant\nwait 10 s\nexpect alarm 192\nmode auto\nkey cycle-start",
    );
    tell(&mut rig, "expect message \"报警\"\nexpect state alarm");
    assert_eq!(rig.snapshot().variables[100], None);
}

#[test]
fn b5_feed_hold_stops_and_cycle_start_goes_on_to_the_same_end() {
    let mut rig = ready_with("G98 G01 X-200 Z-250 F2000\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait until held max 1 s\nwait 0.4 s");
    let held = rig.snapshot().axes;
    tell(&mut rig, "wait 2 s\nexpect state held");
    assert_eq!(rig.snapshot().axes, held, "nothing moves in a hold");
    tell(
        &mut rig,
        "key cycle-start\nwait until idle max 60 s\nwait 0.3 s\nexpect X -200 ±0.0015\nexpect Z -250 ±0.0015",
    );
}

#[test]
fn b5_reset_leaves_the_program_and_the_axes_stand() {
    let mut rig = ready_with("G98 G01 X-200 F500\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nkey reset\nwait 0.5 s\nexpect state idle\nexpect no alarm");
    let stood = rig.snapshot().axes.0[0].machine;
    tell(&mut rig, "wait 1 s");
    assert!((rig.snapshot().axes.0[0].machine - stood).abs() < 1e-9);
}

#[test]
fn b5_single_block_stops_after_each_block() {
    let mut rig = ready_with("#100=1\nG98 G01 U-1 F600\n#100=2\nM30");
    tell(&mut rig, "key single-block\nmode auto\nkey cycle-start\nwait until stopped max 2 s\nexpect #100 1");
    tell(&mut rig, "key cycle-start\nwait until stopped max 2 s\nexpect #100 1\nkey cycle-start\nwait until stopped");
    tell(&mut rig, "expect #100 2\nkey cycle-start\nwait until idle max 2 s");
}

#[test]
fn k3_14_m00_in_single_block_stops_once() {
    let mut rig = ready_with("G04 P100\nM00\n#100=1\n#100=2\nM30");
    tell(&mut rig, "key single-block\nmode auto\nkey cycle-start\nwait until stopped max 2 s");
    tell(&mut rig, "key cycle-start\nwait until stopped max 2 s\nkey cycle-start\nwait until stopped max 2 s");
    tell(&mut rig, "expect #100 1\nkey cycle-start\nwait until stopped max 2 s\nexpect #100 2");
}

#[test]
fn b3_an_output_reads_as_the_block_before_has_switched_it() {
    let text = "M50\nIF[#1120 EQ 1]GOTO 20\n#100=9\nN20 M51\n#101=#1120\nM08\n#102=#1101\nM09\n#103=#1101\n\
                #1139=1\nIF[#1139 EQ 1]THEN #104=1\nM21 P40\n#105=#1139\nM22 P40\n#106=#1139\nM30";
    let mut rig = ready_with(text);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 5 s\nexpect no alarm");
    let values = rig.snapshot().variables[100..107].to_vec();
    let numbers = [0.0, 1.0, 0.0, 1.0, 1.0, 0.0].map(Some);
    assert_eq!(values[0], None, "the jump was taken");
    assert_eq!(values[1..], numbers);
}

#[test]
fn b3_in_inches_places_read_in_inches() {
    // 25.4 mm are an inch; X by its diameter, from X 50.8 to X 25.4.
    let text = "G21 G00 X-50.8 Z-127\nG20\n#100=#5041\n#101=#5043\nG00 X[#5041+1]\nG21\n#102=#5041\nM30";
    let mut rig = ready_with(text);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 60 s\nexpect no alarm\nexpect X -25.4 ±0.0015");
    for (number, inches) in [(100, -2.0), (102, -25.4)] {
        let value = rig.snapshot().variables[number].unwrap();
        assert!((value - inches).abs() < 0.0005, "#{number} {value}");
    }
}

#[test]
fn b5_single_block_switched_on_in_a_run_stops_at_the_end_of_that_block() {
    // Thirty short blocks, all of them read ahead; the first stop is far from the end.
    let text: String = (0..30).map(|n| format!("N{n} G98 G01 U-0.5 F300\n")).collect();
    let mut rig = ready_with(&format!("{text}M30"));
    let start = rig.snapshot().axes.0[0].work;
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.2 s\nkey single-block\nwait until stopped max 3 s\nwait 0.3 s");
    let blocks = (start - rig.snapshot().axes.0[0].work) / 0.5;
    assert!((blocks - blocks.round()).abs() < 0.01 && blocks < 10.0, "stopped after {blocks} blocks");
    tell(&mut rig, "key single-block\nkey cycle-start\nwait until idle max 20 s\nwait 0.3 s");
    let blocks = (start - rig.snapshot().axes.0[0].work) / 0.5;
    assert!((blocks - 30.0).abs() < 0.01, "all thirty blocks were executed, not {blocks}");
}

#[test]
fn b3_variables_are_shown_as_executed() {
    // 30 blocks of 1 mm at 600 mm/min; #100 counts them. The reader is far ahead, the page is not.
    let mut rig = ready_with("#100=0\nWHILE[#100 LT 30]DO1\nG98 G01 W-1 F600\n#100=#100+1\nEND1\nM30");
    let z = rig.snapshot().axes.0[2].work;
    tell(&mut rig, "mode auto\nkey cycle-start");
    for _ in 0..4_000 {
        rig.step();
        let snapshot = rig.snapshot();
        let (count, gone) = (snapshot.variables[100].unwrap_or(0.0), z - snapshot.axes.0[2].work);
        // The set-point is at most 20 ms × 10 mm/s = 0.2 mm ahead of the axis, and a corner 0.01 mm.
        assert!(count <= gone + 0.25, "#100 = {count} after {gone} mm");
    }
    tell(&mut rig, "wait until idle max 5 s\nexpect #100 30");
}

#[test]
fn b3_reading_a_position_waits_for_the_motion_by_itself() {
    let mut rig = ready_with("G98 G01 W-10 F3000\n#100=#5042\nM30");
    let z = rig.snapshot().axes.0[2].work;
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 5 s");
    let seen = rig.snapshot().variables[100].unwrap();
    // In position is 0.6 µm (P54); the encoder counts micrometres.
    assert!((seen - (z - 10.0)).abs() < 0.0015, "{seen}");
}

#[test]
fn b2_g54_to_g59_g50_and_g53_place_the_axes() {
    let mut rig = ready_with("G00 X-200 Z-200\nG50 X0 Z0\nG00 X50 Z-20\nM00\nG53 X-400 Z-300\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until stopped max 20 s\nwait 0.3 s\nexpect X 50 ±0.0015\nexpect Z -20 ±0.0015",
    );
    tell(&mut rig, "expect machine X -150 ±0.0015\nexpect machine Z -220 ±0.0015");
}

#[test]
fn b5_a_target_beyond_the_soft_limit_is_an_alarm_before_its_block() {
    let mut rig = ready_with("#100=1\nG00 Z-100\nG00 Z-2000\n#100=2\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until alarm max 60 s\nexpect alarm 101\nexpect alarm \"第3行\"\nwait 0.5 s",
    );
    tell(&mut rig, "expect Z -100 ±0.0015\nexpect #100 1");
}

#[test]
fn b1_a_wrong_block_is_one_alarm_with_program_line_and_column() {
    let mut rig = ready_with("#100=1\nG01 X1..5 F100\n#100=2\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm \"O7000 第2行\"\nexpect #100 1");
}

#[test]
fn k7_5_570_to_579_take_0_or_1_only_from_a_program_too() {
    let mut rig = ready_with("#570=1\n#570=2\n#100=1\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm \"570\"\nexpect #570 1");
    assert_eq!(rig.snapshot().variables[100], None);
}

#[test]
fn b2_g31_latches_the_position_of_the_edge_and_stops() {
    let mut rig = ready_with("G98 G31 W-100 F600 P1\n#100=#5062\nM30");
    let z = rig.snapshot().axes.0[2].work;
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 2 s\ninput gauge-1 on\nwait until idle max 5 s");
    let latched = z - rig.snapshot().variables[100].unwrap();
    // 600 mm/min for about 2 s is about 20 mm, far from 100.
    assert!((15.0..25.0).contains(&latched), "latched after {latched} mm");
}

#[test]
fn b2_g31_without_a_signal_latches_its_end_point() {
    // 1500 mm/min with a lag of 20 ms would be 0.5 mm short.
    let mut rig = ready_with("G98 G31 W-20 F1500 P1\n#100=#5062\nM30");
    let z = rig.snapshot().axes.0[2].work;
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 5 s");
    let latched = z - rig.snapshot().variables[100].unwrap();
    assert!((latched - 20.0).abs() < 1e-6, "latched after {latched} mm");
}

/// The slide touches on its last way, when its set-point stands at the end already.
#[test]
fn b2_g31_takes_a_contact_that_comes_while_the_axis_still_lags() {
    let mut rig = ready_with("G98 G31 W-20 F1500 P1\n#100=#5062\nM30");
    let z = rig.snapshot().axes.0[2].work;
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.2 s");
    for _ in 0..3_000 {
        if rig.controller().is_at_rest() {
            break;
        }
        rig.step();
    }
    // 20 mm from 1500 mm/min with a lag of 20 ms: the slide is on its way still, if its set-point is not.
    let on_its_way = z - rig.trace_row().inputs.encoder_mm[Axis::Z];
    tell(&mut rig, "input gauge-1 on\nwait until idle max 5 s\nexpect no alarm");
    let latched = z - rig.snapshot().variables[100].unwrap();
    assert!(latched < 19.995 && latched > 19.0, "latched after {latched} mm, encoder {on_its_way}");
}

#[test]
fn b3_the_position_of_an_axis_that_is_not_there_is_null() {
    // GC has X and Z.
    let mut rig = ready_with("#100=1\nIF[#5043 EQ #0]THEN #100=2\nIF[#5042 EQ #0]THEN #100=3\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 2 s\nexpect no alarm\nexpect #100 2");
}

#[test]
fn b3_3000_is_an_alarm_with_the_programs_text() {
    let mut rig = ready_with("#100=1\n#3000=5(没有夹紧)\n#100=2\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm 3005\nexpect alarm \"没有夹紧\"\nexpect #100 1",
    );
}

#[test]
fn b5_overrides_act_on_a_running_block() {
    let mut rig = ready_with("G98 G01 W-100 F600\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s");
    let full = rig.snapshot().feed_mm_min;
    for _ in 0..5 {
        tell(&mut rig, "key feed-override-down");
    }
    tell(&mut rig, "wait 0.5 s");
    let half = rig.snapshot().feed_mm_min;
    assert!((full - 600.0).abs() < 1.0 && (half - 300.0).abs() < 1.0, "{full}, then {half}");
}

#[test]
fn b5_mdi_executes_a_line_and_says_what_is_wrong_with_another() {
    let mut rig = ready();
    tell(
        &mut rig,
        "mdi G00 X-200 Z-100\nwait until idle max 20 s\nwait 0.3 s\nexpect X -200 ±0.0015\nexpect Z -100 ±0.0015",
    );
    tell(&mut rig, "mdi G77 X1\nexpect alarm any");
}

#[test]
fn power_cut_keeps_variables_and_forgets_homing() {
    let mut rig = ready();
    tell(&mut rig, "set #500 = 40.2\nset #100 = 3\npower cut\nwait 1 s\npower on\nexpect #500 40.2");
    assert_eq!(rig.snapshot().variables[100], None, "#100 is null at power-on");
    assert!(!rig.snapshot().axes.0[0].homed);
}

#[test]
fn the_same_story_gives_the_same_course() {
    let course = || {
        let mut rig = ready_with("M03\nG98 G01 W-20 F900\nM30");
        tell(&mut rig, "mode auto\nkey cycle-start\nwait 10 s\nkey feed-hold\nwait 0.3 s\nkey cycle-start\nwait 3 s");
        let snapshot = rig.snapshot();
        snapshot.axes.0.map(|view| (view.machine.to_bits(), view.work.to_bits()))
    };
    assert_eq!(course(), course());
}

#[test]
fn b2_a_frame_of_an_mdi_line_does_not_reach_into_the_next_program() {
    let mut rig = ready_with("#100=#4014\n#101=#5041\nM30");
    tell(&mut rig, "mdi G55\nmode auto\nkey cycle-start\nwait until idle max 2 s\nexpect #100 54");
    tell(&mut rig, "mdi G55\nmdi #100=#4014\nexpect #100 55");
}

#[test]
fn b5_mdi_goes_on_with_the_codes_of_its_last_line() {
    let mut rig = ready();
    tell(&mut rig, "mdi G98 G01 W-0.1 F60\nwait until idle\nmdi W-10\nwait 1 s\nexpect state running");
    assert!((rig.snapshot().feed_mm_min - 60.0).abs() < 1.0, "at the feed, not in rapid");
}

#[test]
fn b2_a_dwell_does_not_run_on_in_a_hold() {
    let mut rig = ready_with("G04 X5\n#100=1\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 10 s\nkey cycle-start\nwait 3.5 s");
    assert_eq!(rig.snapshot().variables[100], None);
    tell(&mut rig, "wait 1 s\nexpect #100 1");
}

#[test]
fn b7_a_new_tick_time_holds_from_the_next_power_on() {
    let mut rig = ready_with("G98 G01 W-10 F600\nM30");
    let z = rig.snapshot().axes.0[2].work;
    tell(&mut rig, "param P58 4000\nmode auto\nkey cycle-start\nwait 0.5 s");
    // 600 mm/min = 10 mm/s: about 5 mm in half a second, less the start and the lag.
    let gone = z - rig.snapshot().axes.0[2].work;
    assert!((3.5..5.0).contains(&gone), "{gone} mm");
}

#[test]
fn b5_the_second_run_moves_like_the_first() {
    let mut rig = ready_with("G98 G01 W-1 F600\nM30");
    let z = rig.snapshot().axes.0[2].work;
    for run in 1..=3 {
        tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 5 s\nwait 0.3 s");
        assert!((z - rig.snapshot().axes.0[2].work - f64::from(run)).abs() < 0.0015, "run {run}");
    }
}

#[test]
fn k6_3_a_held_run_survives_a_change_of_mode() {
    let mut rig = ready_with("G98 G01 W-20 F600\nM30");
    let z = rig.snapshot().axes.0[2].work;
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.5 s\nmode handwheel\nexpect lamp mode-auto on\nkey feed-hold");
    tell(&mut rig, "mode handwheel\nexpect lamp mode-handwheel on\nexpect state held\nmode jog\nmode handwheel");
    tell(&mut rig, "key cycle-start\nexpect state running\nwait until idle max 5 s\nwait 0.3 s");
    assert!((z - rig.snapshot().axes.0[2].work - 20.0).abs() < 0.0015);
}

#[test]
fn k3_15_m91_and_m92_jump_on_a_real_input() {
    let text = "M91 P13 L20\n#500=1\nGOTO 30\nN20 #500=2\nN30 M92 P14 L40\n#501=1\nM30\nN40 #501=2\nM30";
    for (first, second, expected) in [("off", "off", [1.0, 2.0]), ("on", "on", [2.0, 1.0])] {
        let mut rig = ready_with(text);
        tell(&mut rig, &format!("input user-1 {first}\ninput user-2 {second}\nmode auto\nkey cycle-start\nwait 0.5 s"));
        tell(&mut rig, &format!("expect state idle\nexpect #500 {}\nexpect #501 {}", expected[0], expected[1]));
    }
    // Without L: P is the block, P93 the input.
    let mut rig = ready_with("M91 P20\n#500=1\nM30\nN20 #500=2\nM30");
    tell(&mut rig, "param P93 13\ninput user-1 on\nmode auto\nkey cycle-start\nwait 0.5 s\nexpect #500 2");
}

#[test]
fn damaged_data_are_told_at_every_power_on_and_nothing_moves_before_homing() {
    let mut rig = rig();
    rig.report_standing(alarm::RETAINED_DATA_DAMAGED, &LocalizedText::same(&"retained.redb"));
    tell(&mut rig, "expect alarm 300\npower cut\npower on\nexpect alarm 300\nmode auto\nkey cycle-start");
    tell(&mut rig, "expect state alarm\nkey reset\nexpect alarm 300");
}

#[test]
fn b2_a_roughing_cycle_and_its_finish_run_to_their_start() {
    // From X -80 the contour lies at X -100: radius 10 mm in strokes of 4, then once along; a live value in it is read late.
    let text = "G98 G00 X-80 Z-150\nG71 U4 R1\nG71 P10 Q30 U0.4 F600\nN10 G00 X-100\nN20 G01 W-10\nN30 X[#5041+20] W-10\n\
                G70 P10 Q30\n#100=#5041\nM30";
    let mut rig = ready_with(text);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 120 s\nexpect no alarm\nexpect #100 -80 ±0.001");
    tell(&mut rig, "expect X -80 ±0.001\nexpect Z -150 ±0.001");
}

#[test]
fn b2_g30_goes_over_the_via_point_to_a_reference_point_of_the_parameters() {
    // P161 is slide travel: machine X -35 is shown as -70.
    let mut rig = ready_with("G30 P2 U2 W0\nM00\nG30 P3 X-90\nM30");
    tell(
        &mut rig,
        "param P161 -35\nparam P163 -120\nparam P164 -45\nmode auto\nkey cycle-start\nwait until stopped max 60 s",
    );
    tell(&mut rig, "expect machine X -70 ±0.001\nexpect machine Z -120 ±0.001");
    tell(
        &mut rig,
        "key cycle-start\nwait until idle max 60 s\nexpect machine X -90 ±0.001\nexpect machine Z -120 ±0.001",
    );
}

#[test]
fn k3_6_an_emergency_stop_pressed_twice_in_one_tick_stays_pressed() {
    use kt830::defs::key::Key;
    use kt830::link::command::Command;
    let mut rig = ready();
    rig.send(Command::Press(Key::EmergencyStop));
    rig.send(Command::Press(Key::EmergencyStop));
    tell(&mut rig, "wait 0.1 s\nexpect alarm 0\nkey reset\nexpect alarm 0");
    rig.send(Command::EmergencyStop(true));
    tell(&mut rig, "wait 0.1 s\nkey reset\nexpect alarm 0");
    // Its key turns it out; only then RESET clears the alarm.
    tell(&mut rig, "key emergency-stop\nwait 0.1 s\nkey reset\nexpect no alarm");
}

#[test]
fn k2_2_nothing_starts_in_the_tick_of_a_reset_or_an_emergency_stop() {
    use kt830::defs::key::Key;
    use kt830::link::command::Command;
    use kt830::link::snapshot::RunState;
    let start = || Command::Press(Key::CycleStart);
    let line = || Command::Mdi("G98 G01 W-1 F300".to_owned());
    for (mode, start) in [("auto", &start as &dyn Fn() -> Command), ("mdi", &line)] {
        for stop in [Command::Press(Key::Reset), Command::EmergencyStop(true)] {
            for stop_first in [true, false] {
                let mut rig = ready_with("G98 G01 W-10 F300\nM30");
                tell(&mut rig, &format!("mode {mode}"));
                let both = if stop_first { [stop.clone(), start()] } else { [start(), stop.clone()] };
                both.into_iter().for_each(|command| rig.send(command));
                rig.step();
                assert_eq!(rig.controller().block_count(), 0, "{mode}, {stop:?}");
                assert!(!rig.snapshot().state.is_active(), "{mode}, {stop:?}, first: {stop_first}");
                for _ in 0..100 {
                    rig.step();
                    assert_ne!(rig.controller().state(), RunState::Running, "{mode}, {stop:?}, first: {stop_first}");
                }
            }
        }
        // In the next tick a start counts again.
        let mut rig = ready_with("G98 G01 W-10 F300\nM30");
        tell(&mut rig, &format!("mode {mode}"));
        rig.send(Command::Press(Key::Reset));
        rig.step();
        rig.send(start());
        rig.step();
        assert_eq!(rig.controller().state(), RunState::Running, "{mode}");
    }
}

/// Reading, look-ahead and feed scaling share one budget; a loop that only calculates cannot exceed it.
#[test]
fn t5_the_work_of_a_tick_is_bounded() {
    let text = "G98 G01 W-9 F600\nN10 #1=#1+1\nIF[#1 LT 20000]GOTO 10\nG01 W-9\n#500=#1\nM30";
    let mut rig = ready_with(text);
    tell(&mut rig, "mode auto");
    rig.send(Command::Press(Key::CycleStart));
    let mut work = Vec::new();
    while work.len() < 2 || rig.controller().state() != RunState::Idle {
        // The loop is read in the first 156 ticks; the axis moves for 1.8 s.
        if work.len() == 1_000 {
            rig.send(Command::Press(Key::FeedOverrideDown));
        }
        rig.step();
        work.push(rig.controller().work_of_last_tick());
        assert!(work.len() < 10_000, "the program does not end");
    }
    assert_eq!(rig.snapshot().variables[500], Some(20_000.0));
    // 40 000 blocks of 500 units do not fit in a tick. Reading leaves the share of the planner, and ends with a block.
    assert!(work.iter().all(|units| *units <= WORK_PER_TICK), "{:?}", work.iter().max());
    let busiest = work.iter().filter(|units| **units >= WORK_PER_TICK - MAX_TRAJECTORY_WORK).count();
    // 128 160 units a tick are 257 blocks: 40 000 blocks take 155 or 156 ticks.
    assert!((152..162).contains(&busiest), "{busiest} ticks");
    // The change of rate is charged, too: no block is read and the plan is complete by then.
    assert!(work[900..1_000].iter().all(|units| *units == 0) && work[1_000] > 0, "{:?}", &work[990..1_010]);
}

/// Whatever is wrong with the next line, the one before does not start in its place.
#[test]
fn b6_a_refused_mdi_line_takes_back_the_one_before() {
    for wrong in ["G01 Q", "G00 Z99999", &*"G04 ".repeat(126)] {
        let mut rig = ready();
        tell(&mut rig, "mode mdi");
        rig.send(Command::PrepareMdi("G00 W-5".to_owned()));
        rig.step();
        assert_eq!(rig.snapshot().prepared_mdi, "G00 W-5");
        rig.send(Command::PrepareMdi(wrong.to_owned()));
        rig.step();
        assert!(rig.controller().refusal().is_some(), "{wrong}");
        tell(&mut rig, "key cycle-start\nexpect message \"先输入一行\"\nwait 0.1 s\nexpect state idle");
    }
}

/// H7: what a key began is named in header and status line, and its way counts.
#[test]
fn h7_what_moves_by_itself_has_its_name_and_its_distance_to_go() {
    // The return to the dressing point at machine X -80, a diameter.
    let mut host = ready();
    tell(&mut host, "mode jog\npage position\nkey f1\nkey address-x\nkey input\nhold X+ 2 s\nwait 0.5 s");
    tell(&mut host, "key dress-return\nkey x-plus\nwait 0.5 s");
    let commanded = 2.0 * host.controller().set_point()[Axis::X];
    let shown = host.snapshot();
    assert_eq!((shown.state, shown.state_name().zh), (RunState::Idle, "回修整点"));
    assert!((shown.axes[Axis::X].to_go - (-80.0 - commanded)).abs() < 1e-6, "{commanded} {:?}", shown.axes[Axis::X]);
    tell(&mut host, "wait 20 s\nexpect machine X -80 ±0.001");
    assert_eq!((host.snapshot().state_name().zh, host.snapshot().axes[Axis::X].to_go), ("停止", 0.0));
    // The oscillation by its key: from the first half stroke on its strokes per minute show.
    let mut host = ready();
    tell(&mut host, "param P238 1\nparam P239 -140\nmode jog\nkey oscillation\nwait 0.2 s");
    let shown = host.snapshot();
    assert_eq!((shown.state_name().en, shown.strokes_per_min), ("OSCILL.", None));
    assert!(shown.axes[Axis::Z].to_go.abs() > 1.0);
    // P241: 5 strokes a minute, half a stroke is 6 s and its ramps.
    tell(&mut host, "wait 9 s");
    assert!(host.snapshot().strokes_per_min.is_some_and(|strokes| (3.0..=5.5).contains(&strokes)));
    tell(&mut host, "key oscillation\nwait 20 s\nexpect lamp oscillation off");
    assert_eq!(host.snapshot().state_name().zh, "停止");
}

/// M00 says that the program waits and for what; a single block has nothing to say; #3006 says its own text, too.
#[test]
fn h7_a_stopped_program_says_what_it_waits_for() {
    let waiting = |host: &mut HeadlessHost| host.snapshot().waiting_for.as_ref().map(|text| text.zh().into_owned());
    let mut host = ready_with("M00\n#3006=1(CHECK SIZE)\nG04 X0.1\nM30");
    tell(&mut host, "mode auto\nkey cycle-start\nwait until stopped max 2 s\nwait 10 s");
    assert_eq!(waiting(&mut host).as_deref(), Some("M00 程序暂停：按循环启动继续"));
    tell(&mut host, "key cycle-start\nwait until stopped max 2 s\nwait 10 s");
    assert_eq!(waiting(&mut host).as_deref(), Some("CHECK SIZE：按循环启动继续"));
    tell(&mut host, "key single-block\nkey cycle-start\nwait until stopped max 2 s\nwait 1 s");
    assert_eq!(waiting(&mut host), None);
    tell(&mut host, "key cycle-start\nwait until idle max 2 s");
    assert_eq!(waiting(&mut host), None);
}

#[test]
fn k4_3_the_refusal_of_the_oscillation_key_names_the_one_that_is_true() {
    let mut host = rig();
    tell(&mut host, "power on\nwait 4 s\nkey hydraulic\nparam P238 1\nparam P239 -140\nmode jog\nkey oscillation");
    assert_eq!(host.snapshot().message.text.zh(), "先回零");
    let mut host = ready();
    let z = host.snapshot().axes[Axis::Z].work;
    tell(&mut host, &format!("param P238 1\nparam P239 {z}\nmode jog\nkey oscillation"));
    assert_eq!(host.snapshot().message.text.zh(), "Z 轴没有振荡行程：终点就是现在的位置");
}

/// B8: what the program says of its alarm, and the value that is wrong.
#[test]
fn b8_a_program_alarm_has_cause_remedy_and_the_variable_that_is_wrong() {
    let mut rig = ready();
    let values = [(520, 41.0), (521, 40.0), (522, 60.0), (524, 0.4), (525, 0.05), (526, 1.2), (527, 0.0)];
    values.iter().for_each(|(number, value)| tell(&mut rig, &format!("set #{number} = {value}")));
    tell(&mut rig, "load O1002\nmode auto\nkey cycle-start\nwait 0.3 s\nexpect alarm 3005");
    let alarm = rig.snapshot().alarms[0].clone();
    assert_eq!(alarm.variable, Some(527), "the roughing feed #526 is right");
    assert_eq!(alarm.text.zh(), "速度 #526 #527 必须大于 0");
    assert_eq!(alarm.text.en(), "roughing feed and finishing feed #526 #527 must be above 0");
    assert!(alarm.cause.zh().contains("没有输入") && alarm.cause.en().contains("missing"));
    assert!(alarm.remedy.zh().contains("磨削页面") && alarm.remedy.en().contains("grinding page"));
    // The disk has both languages of the history, too.
    let past = rig.snapshot().alarm_history.last().unwrap().clone();
    assert_eq!((past.text.en(), past.cause.get(Lang::En)), (alarm.text.en(), &*alarm.cause.en()));
    assert_eq!(past.remedy.get(Lang::Zh), alarm.remedy.zh());
    // Of a called program.
    tell(&mut rig, "key reset\nwait 0.1 s\nload O1011\nkey cycle-start\nwait 0.5 s\nexpect alarm 3032");
    assert_eq!(rig.snapshot().alarms[0].variable, Some(763));
}

#[test]
fn b8_a_program_alarm_without_texts_says_what_it_said() {
    let mut rig = ready_with("#3000=7(尺寸 #521 不对)\nM30\n");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.3 s\nexpect alarm 3007");
    let alarm = rig.snapshot().alarms[0].clone();
    assert_eq!((&*alarm.text.en(), alarm.variable, alarm.cause.is_empty()), ("尺寸 #521 不对", Some(521), true));
    assert!(!alarm.remedy.is_empty(), "the remedy of every program alarm");
    // Faults of the machine and of the program's text name no variable.
    let mut rig = ready_with("G01 X\nM30\n");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.3 s");
    assert!(rig.snapshot().alarms.iter().all(|alarm| alarm.variable.is_none()) && !rig.snapshot().alarms.is_empty());
}

/// A loop that changes F alone is no endless loop.
#[test]
fn b3_a_loop_over_the_feed_ends_and_the_program_goes_on() {
    let mut rig = ready_with("G98 F100\nN10 F[#4109+10]\nIF[#4109 LT 200]GOTO 10\nG01 X-81\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 10 s\nexpect X -81 ±0.001\nexpect no alarm");
    let text = "G98 F100\nN10 F[#4109+10]\nIF[#4109 LT 200]GOTO 10\nG01 X-81\nM30";
    let source = std::sync::Arc::new(kt830::nc::Source::new(1, "O1.NC", text, kt830::defs::kind::Dialect::LatheA));
    let library: kt830::nc::SharedLibrary = std::sync::Arc::new(kt830::nc::EmptyLibrary);
    let report = kt830::nc::check(&source, &library, &kt830::nc::NcSettings::lathe_a());
    assert!(report.finished && report.warnings.is_empty(), "{:?}", report.warnings);
}

/// A quarter of radius 5 mm in XY of a surface grinder while Z goes 3 mm: at half of the angle at half of the way, and the
/// length of the path is √((5·π/2)² + 3²) = 8.407 mm, 8.4 s at 60 mm/min.
#[test]
fn b2_a_helix_of_a_surface_grinder_ends_in_all_three_axes() {
    let mut rig = crate::stories::ready_of(Kind::Gs);
    let text = "G98 G91 G17 F60\nG02 X5 Y5 Z3 I5 J0\nM30\n";
    rig.add_program(program_from_bytes(7_000, "O7000.NC", text.as_bytes().to_vec(), rig.kind().dialect()));
    let start = rig.snapshot().axes;
    tell(&mut rig, "load O7000\nmode auto\nkey cycle-start");
    let from = rig.now();
    let mut half = None;
    while half.is_none() || rig.controller().state() != RunState::Idle {
        rig.step();
        let z = rig.snapshot().axes.0[2].machine - start.0[2].machine;
        if half.is_none() && z >= 1.5 {
            half = Some([0, 1].map(|axis| rig.snapshot().axes.0[axis].machine - start.0[axis].machine));
        }
    }
    // 45° before the end: 5 − 5·cos 45° and 5·sin 45°.
    let [x, y] = half.unwrap();
    let root = std::f64::consts::FRAC_1_SQRT_2;
    assert!((x - 5.0 * (1.0 - root)).abs() < 0.02 && (y - 5.0 * root).abs() < 0.02, "{x} {y}");
    let seconds = rig.now().since(from).as_secs_f64();
    assert!((8.4..9.0).contains(&seconds), "{seconds}");
    for (axis, way) in [5.0, 5.0, 3.0].into_iter().enumerate() {
        assert!((rig.snapshot().axes.0[axis].machine - start.0[axis].machine - way).abs() < 0.002);
    }
}

#[test]
fn b2_g31_p9_stops_at_the_contact_of_the_wheel_and_refuses_without_a_monitor() {
    let program = "G98 G31 W-20 F60 P9\n#100=#5062\nM30";
    let mut rig = ready_with(program);
    tell(&mut rig, "input wheel-contact off\nmode auto\nkey cycle-start\nwait 2 s\nexpect state running");
    tell(&mut rig, "input wheel-contact on\nwait until idle max 2 s");
    // 1 mm/s for two seconds.
    let z = rig.snapshot().variables[100].unwrap();
    assert!((-153.0..-151.5).contains(&z), "{z}");
    let mut rig = ready_with(program);
    tell(&mut rig, "param P358 0\nmode auto\nkey cycle-start\nwait 1 s\nexpect alarm 202");
}
