//! The 超人 lathe on its simulated machine: programs run, threads keep step, tools change, what must not be is refused.

use std::path::Path;
use std::sync::Arc;

use crate::stories::{rig_of, tell};
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::param::{ParamAddress, Params};
use kt830::defs::program_error::ProgramError as E;
use kt830::host::bar;
use kt830::host::folders::{Folders, program_from_bytes};
use kt830::host::headless::HeadlessHost;
use kt830::io::sim::EventKind;
use kt830::link::command::Command;
use kt830::nc::{CommonVariables, EmptyLibrary, Library, NcSettings, OfflineMachine, ProgramCheck, Source, check};
use kt830::units::{Axis, PerAxis};

fn folders() -> Folders {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    Folders {
        programs: root.join("programs/lathe"),
        screens: root.join("screens"),
        by_name: true,
        dialect: Dialect::SuperMan,
    }
}

/// A ready lathe with a program of this text and a bar of 45 mm.
fn lathe(text: &str) -> HeadlessHost {
    lathe_with_bar(text, 45.0)
}

/// The same with a bar of another diameter.
fn lathe_with_bar(text: &str, diameter: f64) -> HeadlessHost {
    let mut rig = rig_of(Kind::Lathe, folders());
    rig.add_program(program_from_bytes(7_000, "PART.NC", text.as_bytes().to_vec(), rig.kind().dialect()));
    let mut params = rig.retained().params.clone();
    params.write(ParamAddress::parse("P384").unwrap(), diameter).unwrap();
    let source = rig.program_source(7_000).unwrap();
    if let Some(bar) = bar::bar_of_program(Kind::Lathe, &params, &source) {
        rig.mount_part(&bar);
        rig.step();
        rig.make_ready();
        rig.mount_part(&bar);
    } else {
        rig.make_ready();
    }
    rig.step();
    tell(&mut rig, "load PART\nmode auto");
    rig
}

/// Runs it to its end.
fn run(text: &str) -> HeadlessHost {
    let mut rig = lathe(text);
    tell(&mut rig, "key cycle-start\nwait until idle max 600 s\nexpect no alarm\nexpect no event");
    rig
}

fn params(text: &str, values: &[(&str, f64)]) -> HeadlessHost {
    let mut rig = lathe(text);
    for (at, value) in values {
        rig.send(Command::SetParam(ParamAddress::parse(at).unwrap(), *value));
    }
    rig.step();
    rig
}

#[test]
fn l1_the_manuals_first_example_comes_back_to_where_it_began() {
    let mut rig = rig_of(Kind::Lathe, folders());
    rig.make_ready();
    rig.step();
    // 100 mm of diameter and 200 mm to and fro.
    tell(&mut rig, "load TEST\nmode auto\nkey cycle-start\nwait until idle max 300 s\nexpect no alarm");
    tell(&mut rig, "expect X 0 ±0.001\nexpect Z 0 ±0.001");
}

#[test]
fn l3_a_program_begins_at_its_own_zero_and_g92_names_it_without_a_move() {
    let mut rig = lathe("N0010G04F1\nN0020G92X250Z350\nN0030M00\nN0040M02");
    let before = rig.controller().set_point();
    tell(&mut rig, "key cycle-start\nwait 0.5 s\nexpect X 0 ±0.001\nexpect Z 0 ±0.001\nwait until stopped max 5 s");
    tell(&mut rig, "expect X 250 ±0.001\nexpect Z 350 ±0.001");
    assert_eq!(rig.controller().set_point(), before);
}

#[test]
fn l3_g26_g27_g29_return_to_the_tool_change_point() {
    let text = "N0010G92X100Z50\nN0020G00X60Z20\nN0030G27\nN0035M00\nN0040G00X60\nN0050G29\nN0055M00\nN0060G00Z20\nN0070G26\nN0080M02";
    let mut rig = lathe(text);
    tell(&mut rig, "key cycle-start\nwait until stopped max 20 s\nexpect X 100 ±0.001\nexpect Z 20 ±0.001");
    tell(&mut rig, "key cycle-start\nwait until stopped max 20 s\nexpect X 60 ±0.001\nexpect Z 50 ±0.001");
    tell(&mut rig, "key cycle-start\nwait until idle max 20 s\nexpect X 100 ±0.001\nexpect Z 50 ±0.001");
}

/// The tool-change point is a place in the machine: homing and G92 give it other names, and it stays where it is (L3, L6).
#[test]
fn l3_the_tool_change_point_stays_where_it_is_when_homing_names_the_axes_anew() {
    // The encoders count from where the power came: machine X −150, Z −450; the origin is X 0, Z 0.
    for (text, x, z) in [
        ("N0010G39\nN0018G29\nN0020M02", -150.0, -450.0),
        ("N0010G92X100Z100\nN0020G36\nN0030G26\nN0040M02", -150.0, -450.0),
        ("N0010G92X0Z0\nN0020G37\nN0030G27\nN0040M02", -150.0, -450.0),
        ("N0010G36\nN0020G92X50Z10\nN0030G01U-20W-20F2000\nN0040G26\nN0050M02", -150.0, -450.0),
    ] {
        for ready in [false, true] {
            let mut rig = rig_of(Kind::Lathe, folders());
            rig.add_program(program_from_bytes(7_000, "PART.NC", text.as_bytes().to_vec(), rig.kind().dialect()));
            if ready {
                tell(&mut rig, "home all");
                tell(&mut rig, "mode mdi\nmdi G00X-300Z-450\nwait 10 s");
            }
            let before = rig.machine().slide_mm();
            assert!((before[Axis::X] - x).abs() < 0.002 && (before[Axis::Z] - z).abs() < 0.002, "{before:?}");
            tell(&mut rig, "load PART\nmode auto\nkey cycle-start\nwait until idle max 200 s\nexpect no alarm");
            let after = rig.machine().slide_mm();
            let off = |axis: Axis| (after[axis] - before[axis]).abs();
            assert!(off(Axis::X) < 0.002 && off(Axis::Z) < 0.002, "{text}: {before:?} {after:?}");
        }
    }
}

#[test]
fn l3_g26_by_mdi_leads_to_where_the_last_program_began() {
    let mut rig = lathe("N0010G92X100Z50\nN0020G00X60Z20\nN0030M02");
    let before = rig.machine().slide_mm();
    // None has run yet: the tool is not led to a place that nobody named.
    tell(&mut rig, "mode mdi\nmdi G26\nwait 1 s");
    assert_eq!(rig.machine().slide_mm(), before);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 20 s\nexpect X 60 ±0.001");
    tell(&mut rig, "mode mdi\nmdi G26\nwait 3 s\nexpect X 100 ±0.001\nexpect Z 50 ±0.001\nexpect no alarm");
}

#[test]
fn l7_m03_and_m05_are_pulses_and_m08_switches_the_coolant_off() {
    let mut rig = lathe("N0010M03\nN0020M07\nN0030G04F1\nN0040M08\nN0050G04F1\nN0060M05\nN0070M00\nN0080M02");
    tell(&mut rig, "key cycle-start\nwait 0.2 s\nexpect output spindle-forward on\nwait 0.3 s");
    tell(
        &mut rig,
        "expect output spindle-forward off\nexpect lamp spindle-forward on\nwait 2 s\nexpect output coolant on",
    );
    assert!((rig.machine().main_spindle_rpm() - 200.0).abs() < 1.0);
    tell(&mut rig, "wait 1 s\nexpect output coolant off\nwait until stopped max 5 s\nexpect lamp spindle-stop on");
    assert!(rig.machine().main_spindle_rpm().abs() < 150.0);
}

#[test]
fn l7_reset_stops_the_spindle_by_its_pulse() {
    let mut rig = lathe("N0010M04\nN0020G04F100\nN0030M02");
    tell(
        &mut rig,
        "key cycle-start\nwait 3 s\nexpect lamp spindle-reverse on\nkey reset\nexpect output spindle-stop on",
    );
    tell(&mut rig, "wait 2 s\nexpect output spindle-stop off");
    assert!(rig.machine().main_spindle_rpm().abs() < 1.0);
}

#[test]
fn l5_threads_keep_their_lead_within_five_micrometres_at_the_limit_speed() {
    // N = 1200/T − 80: 720 rpm at 1.5 mm, 220 at 4, 520 at 2; over 50 mm.
    for (lead, rpm) in [(1.5, 720), (4.0, 220), (2.0, 520)] {
        let text = format!("N0010G92X100Z20\nN0020M03S{rpm}\nN0030G01U-2F300\nN0040G33W-66F{lead}\nN0050M02");
        let rig = run(&text);
        let cut = rig.controller().threads()[0];
        assert!(cut.length_mm > 60.0 && cut.error_mm < 0.005, "{cut:?}");
    }
}

/// Note 5: behind three leads the run-up is over; so it is with the finest threads at their limit speed.
#[test]
fn l5_fine_threads_are_in_step_after_three_leads() {
    // N = 1200/T − 80: 4720 rpm at 0.25 mm, 3348 at 0.35, 2320 at 0.5; 20 at 12.
    for (lead, rpm) in [(0.25, 4_720), (0.35, 3_300), (0.5, 2_320), (12.0, 20)] {
        let text =
            format!("N0010G92X100Z50\nN0020M03S{rpm}\nN0025G04F5\nN0030G01U-2F300\nN0040G33W-40F{lead}\nN0050M02");
        let rig = run(&text);
        let cut = rig.controller().threads()[0];
        // All of it is measured but the three leads and the run-out.
        assert!(cut.length_mm > 40.0 - 1.2 - 0.5, "{cut:?}");
        assert!(cut.error_mm < 0.005, "{cut:?}");
    }
}

/// The printed two-start thread begins at Z6 with lead 4 at 200 rpm, 13.3 mm/s. A lead of 2 at 400 rpm has the same run-up and
/// is measured from three leads = 6 mm on: Z is in step there.
#[test]
fn l5_the_printed_two_start_thread_is_in_step_at_the_part() {
    let cut = run("N0010G92X100Z50\nN0020M03S400\nN0025G04F5\nN0030G01U-2F300\nN0040G33W-40F2\nN0050M02")
        .controller()
        .threads()[0];
    assert!(cut.length_mm > 40.0 - 1.2 - 0.5 && cut.error_mm < 0.005, "{cut:?}");
    let text = std::fs::read_to_string(crate::stories::folders_of(Kind::Lathe).programs.join("TWOSTART.NC")).unwrap();
    // Its bar is 20 mm thick.
    let mut rig = lathe_with_bar(&text, 20.0);
    tell(&mut rig, "key cycle-start\nwait until idle max 600 s\nexpect no alarm\nexpect no event");
    let threads = rig.controller().threads();
    assert!(threads.len() == 2 && threads.iter().all(|cut| cut.error_mm < 0.005), "{threads:?}");
}

/// A thread of lead 4 at its limit speed of 1200/4 − 80 = 220 rpm runs at 14.67 mm/s. A lead of 0.75 mm at that speed is
/// measured from 2.25 mm, three leads, on.
#[test]
fn l5_z_is_in_step_behind_three_leads() {
    let cut = run("N0010G92X100Z50\nN0020M03S1173\nN0025G04F5\nN0030G01U-2F300\nN0040G33W-40F0.75\nN0050M02")
        .controller()
        .threads()[0];
    assert!(cut.length_mm > 40.0 - 1.2 - 0.5 && cut.error_mm < 0.005, "{cut:?}");
}

/// L7: the manual's F1 beside 循环启动. Nothing else than a stopped program gives F1 this meaning.
#[test]
fn l7_after_m00_f1_continues() {
    let mut rig = lathe("N0010M00\nN0015M00\nN0020G04F1\nN0030M02");
    tell(&mut rig, "key f1\nwait 0.5 s\nexpect state idle\nkey cycle-start\nwait until stopped max 5 s\nkey f1");
    tell(&mut rig, "wait until stopped max 5 s\nkey next-row\nkey f1\nwait 0.2 s\nexpect state running");
    tell(&mut rig, "key f1\nexpect state running\nwait until idle max 5 s\nexpect no alarm");
    // A grinder keeps its soft keys in M00.
    let mut rig = crate::stories::ready_with("M00\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until stopped max 5 s\nkey f1\nwait 0.5 s\nexpect state stopped");
}

/// A legal S turns the spindle at S, however slow; one that the spindle cannot turn at is refused with its range.
#[test]
fn l5_every_legal_s_turns_at_its_speed() {
    for rpm in [1.0, 5.0, 20.0, 25.0, 26.0, 200.0, 5_000.0] {
        let mut rig = lathe(&format!("N0010M03S{rpm}\nN0020G04F60\nN0030M02"));
        tell(&mut rig, "key cycle-start\nwait 40 s");
        let turns = rig.machine().main_spindle_rpm();
        assert!((turns - rpm).abs() < 0.001 * rpm, "S{rpm}: {turns}");
    }
    for (s, most) in [("S0", "5000"), ("S5001", "5000"), ("S-1", "5000")] {
        let mut rig = lathe(&format!("N0010M03{s}\nN0030M02"));
        tell(&mut rig, "key cycle-start\nwait 1 s\nexpect alarm any\nexpect output spindle-forward off");
        assert!(rig.snapshot().alarms[0].text.en().contains(&format!("1–{most} r/min (P64)")), "{s}");
    }
}

/// The run-out draws a tool of 8 mm edge out of the bar at the speed of its axis: that is no rapid traverse into it.
#[test]
fn l5_the_run_out_of_a_legal_thread_is_no_crash() {
    for lead in [1.5, 4.0, 12.0] {
        let rpm = (1_200.0 / lead - 80.0_f64).floor();
        let mut rig = params(
            &format!(
                "N0005G92X60Z50\nN0006M03S{rpm}\nN0010G00X46Z40\nN0020G01X43F300\nN0030G33W-70F{lead}\nN0040G26\nN0050M02"
            ),
            &[],
        );
        tell(&mut rig, "key cycle-start\nwait until idle max 600 s\nexpect no alarm\nexpect no event");
    }
}

/// Forward first, then a thread in reverse: the phase counts the way the spindle turns.
#[test]
fn l5_a_thread_in_reverse_after_forward_keeps_its_lead() {
    let text = "N0010G92X100Z20\nN0020M03S300\nN0022G04F3\nN0024M05\nN0026G04F3\nN0028M04S300\nN0030G01U-2F300\n\
                N0040G33W-30F2\nN0050M02";
    let rig = run(text);
    let cut = rig.controller().threads()[0];
    assert!(cut.length_mm > 28.0 && cut.error_mm < 0.005, "{cut:?}");
}

#[test]
fn l5_the_block_ends_drawn_back_by_two_leads_and_two_millimetres() {
    let mut rig = lathe("N0010G92X100Z20\nN0020M03\nN0030G01U-2F300\nN0040G33W-30F3\nN0050M00\nN0060M02");
    // X 98 after the infeed; 2·3 + 2 = 8 mm of diameter against it.
    tell(&mut rig, "key cycle-start\nwait until stopped max 60 s\nexpect X 106 ±0.001\nexpect Z -10 ±0.001");
}

#[test]
fn l5_a_spindle_that_stands_or_turns_too_fast_ends_the_run() {
    let mut rig = lathe("N0010G92X100Z20\nN0030G01U-2F300\nN0040G33W-30F3\nN0060M02");
    tell(
        &mut rig,
        "key cycle-start\nwait until alarm max 20 s\nexpect alarm 212\nexpect Z 20 ±0.001\nexpect X 98 ±0.001",
    );
    let told = &rig.snapshot().alarms[0].text;
    assert_eq!(told.en().to_string(), "the spindle is not turning: O7000 line 3, column 6");
    let mut rig = lathe("N0010G92X100Z20\nN0020M03S400\nN0030G01U-2F300\nN0040W-30G33F3\nN0060M02");
    // 1200/3 − 80 = 320 rpm.
    tell(
        &mut rig,
        "key cycle-start\nwait until alarm max 20 s\nexpect alarm 211\nexpect Z 20 ±0.001\nexpect X 98 ±0.001",
    );
    let told = &rig.snapshot().alarms[0].text;
    let (en, zh) = (told.en().to_string(), told.zh().to_string());
    assert_eq!(
        en,
        "spindle too fast for the thread: O7000 line 4, column 10: 400 rpm, lead 3.000 mm allows at most 320 rpm"
    );
    assert!(zh.starts_with("螺纹加工主轴转速过高：O7000 第4行 第10列："), "{zh}");
}

#[test]
fn l5_a_hold_waits_for_the_end_of_the_thread_and_reset_brakes_it() {
    let text = "N0010G92X100Z20\nN0020M03\nN0030G01U-2F300\nN0040G33W-60F3\nN0050G00W60\nN0060M02";
    let mut rig = lathe(text);
    tell(&mut rig, "key cycle-start\nwait until Z<10 max 60 s\nkey feed-hold\nwait 10 s\nexpect state held");
    tell(&mut rig, "expect Z -40 ±0.001\nexpect X 106 ±0.001\nkey cycle-start\nwait until idle max 60 s");
    tell(&mut rig, "expect Z 20 ±0.001\nexpect no alarm");
    let mut rig = lathe(text);
    tell(&mut rig, "key cycle-start\nwait until Z<10 max 60 s\nkey reset\nwait 1 s\nexpect state idle");
    let z = rig.snapshot().axes[Axis::Z].work;
    assert!((8.0..10.0).contains(&z), "{z}");
}

#[test]
fn l8_t20_after_tool_3_moves_by_what_their_tips_differ() {
    let text = "N0010G92X100Z20\nN0020T03\nN0030M00\nN0040T20\nN0050M00\nN0060T2\nN0070M02";
    let mut rig = lathe(text);
    // Tips as the offset page keeps them: u2 4, u3 10 on the diameter, w2 1.5, w3 −2.
    for (number, u, w) in [(2, 4.0, 1.5), (3, 10.0, -2.0)] {
        rig.send(Command::SetGeometry(number, PerAxis([u / 2.0, 0.0, w])));
    }
    rig.step();
    tell(&mut rig, "key cycle-start\nwait until stopped max 20 s\nexpect input station-3 on");
    let before = rig.controller().set_point();
    tell(&mut rig, "key cycle-start\nwait until stopped max 20 s\nexpect input station-2 on");
    let after = rig.controller().set_point();
    // (u3 − u2)/2 = 3 mm of slide, w3 − w2 = −3.5 mm; the coordinates stay.
    assert!((after[Axis::X] - before[Axis::X] - 3.0).abs() < 1e-6, "{before:?} {after:?}");
    assert!((after[Axis::Z] - before[Axis::Z] + 3.5).abs() < 1e-6, "{before:?} {after:?}");
    tell(&mut rig, "expect X 100 ±0.001\nexpect Z 20 ±0.001\nkey cycle-start\nwait until idle max 20 s");
    assert_eq!(rig.controller().set_point(), after, "T2 without compensation moves nothing");
}

/// The first T of a program is compensated against the tool in front, T1 before it or not.
#[test]
fn l8_the_first_compensated_tool_counts_from_the_one_in_front() {
    for text in ["N0010T20\nN0020M02", "N0010T1\nN0020T20\nN0030M02", "N0010T01\nN0020T2\nN0025T1\nN0030T20\nN0040M02"]
    {
        let mut rig = lathe(text);
        for (number, u, w) in [(1, 0.5, 0.5), (2, 1.5, 2.0)] {
            rig.send(Command::SetGeometry(number, PerAxis([u / 2.0, 0.0, w])));
        }
        rig.step();
        let before = rig.controller().set_point();
        tell(&mut rig, "expect input station-1 on\nkey cycle-start\nwait until idle max 60 s\nexpect no alarm");
        let after = rig.controller().set_point();
        // (u1 − u2)/2 = −0.5 mm of slide, w1 − w2 = −1.5 mm.
        assert!((after[Axis::X] - before[Axis::X] + 0.5).abs() < 1e-6, "{text}: {before:?} {after:?}");
        assert!((after[Axis::Z] - before[Axis::Z] + 1.5).abs() < 1e-6, "{text}: {before:?} {after:?}");
    }
    // Station 2 is in front now: the same T20 once more moves nothing.
    let mut rig = lathe("N0010T20\nN0020M02");
    rig.send(Command::SetGeometry(2, PerAxis([0.75, 0.0, 2.0])));
    tell(&mut rig, "key cycle-start\nwait until idle max 60 s");
    let before = rig.controller().set_point();
    tell(&mut rig, "key cycle-start\nwait until idle max 60 s\nexpect X 0 ±0.001");
    assert_eq!(rig.controller().set_point(), before);
}

#[test]
fn l8_a_station_that_does_not_come_is_an_alarm() {
    let mut rig = lathe("N0010T3\nN0020G01U-10F300\nN0030M02");
    tell(&mut rig, "input station-3 off\nkey cycle-start\nwait 4 s\nexpect output post-forward on\nexpect no alarm");
    tell(&mut rig, "wait 2 s\nexpect alarm 210\nexpect output post-forward off\nexpect X 0 ±0.001");
    assert_eq!(rig.snapshot().alarms[0].place, Some((7_000, 1)));
}

#[test]
fn l6_g36_homes_x_then_z_and_the_coordinate_is_the_parameters() {
    let mut rig = rig_of(Kind::Lathe, folders());
    rig.add_program(program_from_bytes(7_000, "PART.NC", b"N0010G36\nN0020M02".to_vec(), rig.kind().dialect()));
    // A cold machine that was never homed: a lathe may begin a program so.
    tell(
        &mut rig,
        "param P39 6\nparam P41 3\nparam P45 5\nparam P47 2\nload PART\nmode auto\nkey cycle-start\nwait 1 s\nexpect state running",
    );
    tell(&mut rig, "wait until idle max 120 s\nexpect no alarm\nexpect X 10 ±0.001\nexpect Z 2 ±0.001");
    assert!(rig.snapshot().axes[Axis::X].homed && rig.snapshot().axes[Axis::Z].homed);
}

/// The origin may lie beyond a soft limit: homing ends there all the same, and from there the axis goes inside only.
#[test]
fn l6_an_origin_beyond_the_soft_limit_is_homed_and_left_towards_the_inside() {
    for (code, set, x, z) in [
        ("G39", "param P47 2", 0.0, 2.0),
        ("G39", "param P47 50", 0.0, 50.0),
        ("G36", "param P45 120\nparam P47 3", 240.0, 3.0),
    ] {
        let mut rig = rig_of(Kind::Lathe, folders());
        let text = format!("N0010{code}\nN0020M02");
        rig.add_program(program_from_bytes(7_000, "PART.NC", text.into_bytes(), rig.kind().dialect()));
        tell(&mut rig, &format!("{set}\nload PART\nmode auto\nkey cycle-start\nwait until idle max 120 s"));
        tell(&mut rig, &format!("expect no alarm\nexpect X {x} ±0.001\nexpect Z {z} ±0.001"));
    }
    let mut rig = rig_of(Kind::Lathe, folders());
    tell(&mut rig, "param P47 50\nhome all\nexpect no alarm\nexpect machine Z 50 ±0.001");
    // Not outwards, by key, step or program; inwards by as much as is asked and no more.
    tell(&mut rig, "mode jog\nhold Z+ 0.5 s\nwait 1 s\nexpect machine Z 50 ±0.001");
    tell(
        &mut rig,
        "handwheel Z -10 x0.1\nwait 1 s\nexpect machine Z 49 ±0.001\nhandwheel Z 10 x0.1\nwait 1 s\nexpect machine Z 49 ±0.001",
    );
    tell(&mut rig, "mode mdi\nmdi G01W-100F2000\nwait 6 s\nexpect machine Z -51 ±0.001\nexpect no alarm");
    tell(&mut rig, "mdi G01W53F2000\nwait 1 s\nexpect alarm 101\nexpect machine Z -51 ±0.001");
}

/// A switch that never comes, or is never left, is an alarm.
#[test]
fn l6_a_home_switch_that_never_comes_or_never_goes_is_an_alarm() {
    // Without its switch the axis comes to the limit switch behind it.
    for (fault, most, alarm) in [("stuck-off home-z", 60, 102), ("stuck-on home-z", 200, 105)] {
        let mut rig = rig_of(Kind::Lathe, folders());
        rig.add_program(program_from_bytes(7_000, "PART.NC", b"N0010G39\nN0020M02".to_vec(), rig.kind().dialect()));
        tell(&mut rig, &format!("fault {fault}\nload PART\nmode auto\nkey cycle-start\nwait until alarm max {most} s"));
        tell(&mut rig, &format!("wait 1 s\nexpect alarm {alarm}"));
        let z = &rig.snapshot().axes[Axis::Z];
        assert!(!z.homed && !z.moving, "{fault}");
    }
}

/// An axis whose homing was broken off has no soft limits: it does not count as homed.
#[test]
fn l6_b5_an_axis_counts_as_homed_when_it_is_at_its_zero_point() {
    let mut rig = rig_of(Kind::Lathe, folders());
    // The zero is found 50 mm away from where the axis is to go.
    tell(&mut rig, "param P47 50\nmode home\nkey z-plus");
    let mut ticks = 0;
    while rig.snapshot().axes[Axis::Z].machine < 1.0 {
        rig.step();
        ticks += 1;
        assert!(ticks < 60_000, "no zero");
    }
    tell(&mut rig, "key reset\nwait 1 s");
    assert!(!rig.snapshot().axes[Axis::Z].homed, "broken off on its way to the zero point");
    tell(&mut rig, "home all\nexpect no alarm\nexpect machine Z 50 ±0.001");
    assert!(rig.snapshot().axes[Axis::Z].homed);
}

/// A program that is refused has not even called its start zero.
#[test]
fn l3_a_refused_program_changes_no_work_zero() {
    let mut rig = rig_of(Kind::Lathe, folders());
    rig.add_program(program_from_bytes(
        7_000,
        "PART.NC",
        b"N0010G01W1F600\nN0020G99\nN0030M02".to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "home all\nmode mdi\nmdi G00W-50\nwait 4 s\nexpect Z -50 ±0.001\nload PART\nmode auto");
    tell(&mut rig, "key cycle-start\nwait until alarm max 5 s\nexpect Z -50 ±0.001\nexpect machine Z -50 ±0.001");
    // From a block too the whole text is looked at, and the axes stay.
    tell(&mut rig, "key reset\nexpect no alarm");
    rig.send(kt830::link::Command::RestartAt(1));
    tell(&mut rig, "wait 0.2 s\nkey cycle-start\nwait until alarm max 5 s\nexpect machine Z -50 ±0.001");
}

#[test]
fn l10_the_bar_is_cut_and_can_be_measured() {
    let mut rig = rig_of(Kind::Lathe, folders());
    let number = rig.find_program("SHAFT").unwrap();
    let bar = rig.bar_of_program(number).unwrap();
    rig.mount_part(&bar);
    rig.step();
    rig.make_ready();
    rig.mount_part(&bar);
    rig.step();
    tell(
        &mut rig,
        "load SHAFT\nmode auto\nkey cycle-start\nwait until idle max 600 s\nexpect no alarm\nexpect no event",
    );
    // The step of 30, the bar behind it, the neck behind the thread; its root: 24 − 4.4 − 3 · 0.4.
    tell(&mut rig, "expect part diameter at Z-50 30 ±0.02\nexpect part diameter at Z-65 45 ±0.001");
    tell(&mut rig, "expect part diameter at Z-34 20 ±0.02\nexpect part diameter at Z-20 18.4 ±0.02");
}

#[test]
fn l9_interference_of_tool_with_bar_and_chuck_is_a_crash() {
    // Rapid into the bar, cutting with the spindle standing, the shank in the bar, the chuck.
    let into = |blocks: &str| {
        let mut rig = lathe(&format!("N0010G92X60Z20\n{blocks}\nN0090M02"));
        tell(&mut rig, "key cycle-start\nwait until alarm max 120 s\nexpect event crash");
        let event = *rig.machine().events().first().unwrap();
        assert_eq!(event.kind, EventKind::Crash);
        event.place
    };
    assert_eq!(into("N0020M03\nN0030G00X40\nN0040Z-30"), "part, rapid traverse");
    assert_eq!(into("N0030G01X40F300\nN0040Z-30"), "part, spindle stopped");
    assert_eq!(into("N0020M03\nN0030G00X20\nN0040G01Z-30F300"), "part, tool shank");
    assert_eq!(into("N0020M03\nN0030G01Z-125F2000"), "chuck");
}

#[test]
fn l4_l9_two_hundred_fifty_five_levels_of_loops_run_and_one_more_is_an_error() {
    let nested = |levels: usize| {
        let open = "N0001G22L0001\n".repeat(levels);
        let close = "N0002G80\n".repeat(levels);
        let text = format!("{open}N0003G01U-0.02F300\n{close}N0004M02\n");
        let source = Arc::new(Source::new(1, "", text.into_bytes(), Dialect::SuperMan));
        let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
        check(&source, &library, &NcSettings::for_dialect(Dialect::SuperMan))
    };
    let deep = nested(255);
    assert!(deep.faults.is_empty() && deep.finished && deep.blocks == 2, "{:?}", deep.faults);
    let deeper = nested(256);
    assert_eq!(deeper.faults[0].location.line, 256);
}

#[test]
fn l9_a_million_blocks_are_checked_and_loops_do_not_grow() {
    let mut text = String::with_capacity(24_000_000);
    for block in 0..500_000 {
        text.push_str(if block % 2 == 0 { "N0010G01U-10W-5F300\n" } else { "N0020U10W5\n" });
    }
    // And as many again by loops: 500 × 1000.
    text.push_str("N0030G22L0500\nN0040G22L0500\nN0050W-1\nN0060W1\nN0070G80\nN0080G80\nN0090M02\n");
    let source = Arc::new(Source::new(1, "", text.into_bytes(), Dialect::SuperMan));
    let library: Arc<dyn Library + Send + Sync> = Arc::new(EmptyLibrary);
    let settings = NcSettings::for_dialect(Dialect::SuperMan);
    let mut world = OfflineMachine::new(&settings);
    let checked =
        ProgramCheck::new(&source, &library, &settings, CommonVariables::default()).run(&mut world, &mut |_| {});
    assert!(checked.faults.is_empty() && checked.finished);
    // 500 000 lines, 500 · 500 · 2 in the loops, M02.
    assert_eq!(checked.blocks, 1_000_001);
}

#[test]
fn l2_speeds_and_places_come_from_the_parameters() {
    let mut rig = params("N0010G01U-10\nN0020M02", &[("P380", 600.0)]);
    // U−10: 5 mm of slide at half of 600 mm/min: 1 s and the ramps.
    tell(
        &mut rig,
        "key cycle-start\nwait 0.6 s\nexpect state running\nwait 0.8 s\nexpect state idle\nexpect X -10 ±0.001",
    );
}

/// L2: rapids of 2000 to 6000 mm/min along Z, half of that along X.
#[test]
fn l2_the_rapids_of_the_parameters_keep_the_range() {
    let mut values = Params::factory(Kind::Lathe);
    let mut write = |at: &str, value: f64| values.write(ParamAddress::parse(at).unwrap(), value).is_ok();
    for (at, low, high) in [("P30", 1_000.0, 3_000.0), ("P32", 2_000.0, 6_000.0)] {
        assert!(write(at, low) && write(at, high) && !write(at, low - 1.0) && !write(at, high + 1.0), "{at}");
    }
    assert!(Params::factory(Kind::Gc).write(ParamAddress::parse("P32").unwrap(), 10_000.0).is_ok());
}

/// A file of any name is reported by it.
#[test]
fn l1_files_of_one_letter_are_reported_by_their_names() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["A", "P1", "G22_X", "22"] {
        let path = folder.path().join(format!("{name}.NC"));
        std::fs::write(&path, "N0010G04F1\nN0020G33W-20F2\nN0030M02\n").unwrap();
        let out = std::process::Command::new(env!("CARGO_BIN_EXE_kt830"))
            .args(["run", "--kind", "lathe", "--format", "json", "--data"])
            .arg(folder.path().join("data"))
            .arg(&path)
            .output()
            .unwrap();
        let told: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
        assert_eq!(told["alarms"][0]["program"], name, "{told}");
        assert!(told["alarms"][0]["text"].as_str().unwrap().contains(&format!("{name} ")), "{told}");
    }
}

#[test]
fn l9_loop_run_begins_again_as_often_as_the_parameter_says() {
    let mut rig = params("N0010G01U-10F600\nN0020U10\nN0030M02", &[("P390", 3.0)]);
    let before = rig.controller().block_count();
    tell(&mut rig, "key cycle-start\nwait 3 s\nexpect state running\nwait until idle max 30 s\nexpect X 0 ±0.001");
    // Three blocks, three times.
    assert_eq!(rig.controller().block_count() - before, 9);
    // The part of a pass stays in sight while the next one runs; a cycle start by the operator clears it.
    let part = |rig: &mut HeadlessHost| rig.snapshot().cycle.part.map(|part| part.ended_at);
    tell(&mut rig, "wait 1 s\nkey cycle-start\nwait 0.1 s\nexpect state running");
    assert_eq!(part(&mut rig), None);
    tell(&mut rig, "wait 3 s\nexpect state running");
    assert!(part(&mut rig).is_some());
    tell(&mut rig, "wait until idle max 30 s");
    // RESET ends it for good.
    tell(&mut rig, "key cycle-start\nwait 1 s\nkey reset\nwait 3 s\nexpect state idle");
}

#[test]
fn l1_every_example_of_the_manual_runs_to_its_end() {
    let programs = std::fs::read_dir(folders().programs).unwrap();
    for path in programs.map(|entry| entry.unwrap().path()) {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let mut rig = rig_of(Kind::Lathe, folders());
        rig.make_ready();
        rig.step();
        tell(&mut rig, &format!("load {name}\nmode auto\nkey cycle-start\nwait until idle max 600 s"));
        tell(&mut rig, "expect no alarm\nexpect no event");
    }
}

#[test]
fn l5_k6_3_a_thread_begins_where_the_hand_has_left_the_tool() {
    let mut rig = lathe("N0010G92X100Z20\nN0020M03\nN0030G01U-2F300\nN0035M00\nN0040G33W-30F3\nN0050M00\nN0060M02");
    tell(&mut rig, "key cycle-start\nwait until stopped max 60 s\nhandwheel X -5 x0.1\nhandwheel Z 10 x0.1");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until stopped max 60 s");
    // X 98 − 0.5 + 8, Z 20 + 1 − 30.
    tell(&mut rig, "expect X 105.5 ±0.001\nexpect Z -9 ±0.001");
}

#[test]
fn l7_a_spindle_stopped_in_a_pause_must_turn_again_before_the_run_goes_on() {
    let mut rig = lathe("N0010M03\nN0020M00\nN0030G04F1\nN0040M02");
    tell(&mut rig, "key cycle-start\nwait until stopped max 20 s\nkey spindle-stop\nwait 1 s\nkey cycle-start");
    tell(&mut rig, "wait 0.2 s\nexpect state stopped\nkey spindle-forward\nwait 3 s\nkey cycle-start");
    tell(&mut rig, "wait until idle max 20 s\nexpect no alarm");
}

/// Starts the program and tells its alarm in English and Chinese; nothing may have moved.
fn refused(text: &str) -> (u16, [String; 2]) {
    let mut rig = lathe(text);
    let places = |rig: &mut HeadlessHost| rig.snapshot().axes.0.each_ref().map(|axis| (axis.work, axis.machine));
    let before = (rig.controller().set_point(), places(&mut rig));
    tell(&mut rig, "key cycle-start\nwait until alarm max 20 s\nwait 1 s");
    assert_eq!((rig.controller().set_point(), places(&mut rig)), before, "{text}");
    tell(&mut rig, "expect output spindle-forward off");
    let alarms = &rig.snapshot().alarms;
    assert_eq!(alarms.len(), 1, "{text}: {alarms:?}");
    (alarms[0].number, [alarms[0].text.en().to_string(), alarms[0].text.zh().to_string()])
}

/// Every mistake that the manual names: its own number and text, line and column; nothing has moved, not even the block
/// before it.
#[test]
fn l1_to_l7_a_program_with_a_mistake_does_not_start() {
    // A block, its column, the alarm, and what is said of it.
    #[rustfmt::skip]
    const ROWS: &[(&str, u32, E, &str, &str)] = &[
        ("G00X10U5", 12, E::AbsoluteAndIncremental, "X and U name the same axis", "X 与 U 指同一轴"),
        ("G01Z10W5F300", 12, E::AbsoluteAndIncremental, "Z and W name the same axis", "Z 与 W 指同一轴"),
        ("M97L0100", 9, E::SeveralTargets, "N0100 is not unique", "程序段 N0100 不唯一"),
        ("M98L0100", 9, E::SeveralTargets, "N0100 is not unique", "程序段 N0100 不唯一"),
        ("M97L0990", 9, E::MissingTarget, "there is no block N0990", "找不到程序段 N0990"),
        ("M98L0990", 9, E::MissingTarget, "there is no block N0990", "找不到程序段 N0990"),
        ("M97L0020", 9, E::JumpToItself, "N0020 jumps to itself", "N0020 跳转到本段"),
        ("G92X100", 6, E::MissingWord, "G92 needs Z", "G92 缺少 Z"),
        ("G92Z100", 6, E::MissingWord, "G92 needs X", "G92 缺少 X"),
        ("G92U5Z100", 9, E::G92WithDistances, "G92 cannot be used with U W", "G92 不能用 U W"),
        ("G23U0W-50F240", 9, E::RectangleSide, "the side of the rectangle along X is zero", "矩形循环 X 方向边长为零"),
        ("G23U-5W0F240", 12, E::RectangleSide, "the side of the rectangle along Z is zero", "矩形循环 Z 方向边长为零"),
        ("G02U0W0R100", 13, E::FullCircleByRadius, "a full circle cannot be written with R", "整圆不能用 R 编程"),
        ("G02U0W-100.05I0K-50F300", 19, E::ArcEndOffCircle, "the arc end point is 0.050 mm off the circle", "圆弧终点偏离圆周 0.050 mm"),
        ("G02U0.4W0I0.4K0", 15, E::ArcTooSmall, "the arc radius of 0.200 mm must be greater than 0.2 mm", "圆弧半径 0.200 mm 应大于 0.2 mm"),
        ("G03U0W0.2R0.15", 15, E::ArcTooSmall, "the arc radius of 0.150 mm must be greater than 0.2 mm", "圆弧半径 0.150 mm 应大于 0.2 mm"),
        ("G00U-2F1999", 12, E::OutOfRange, "F1999 is out of range 2000–6000 mm/min", "F1999 超出范围 2000–6000 mm/min"),
        ("G01U-2F2001", 12, E::OutOfRange, "F2001 is out of range 6–2000 mm/min", "F2001 超出范围 6–2000 mm/min"),
        ("G02U20W-10R10F601", 19, E::OutOfRange, "F601 is out of range 6–600 mm/min", "F601 超出范围 6–600 mm/min"),
        ("G04F0", 9, E::OutOfRange, "F0 is out of range 0.01–9999.99 s", "F0 超出范围 0.01–9999.99 s"),
        ("G33W-50F12.5", 13, E::OutOfRange, "F12.5 is out of range 0.25–12 mm", "F12.5 超出范围 0.25–12 mm"),
        ("G33Z-50F1.5", 9, E::IncrementalOnly, "program a thread with U and W, not with Z", "螺纹必须用增量 U、W 编程，不能用 Z"),
        ("G80", 6, E::LoopUnpaired, "G80 has no matching G22", "G80 没有配对的 G22"),
        ("G22L2", 6, E::LoopUnpaired, "G22 has no matching G80", "G22 没有配对的 G80"),
        ("M99", 6, E::ReturnWithoutCall, "M99 without M98", "M99 没有对应的 M98"),
        ("G54", 6, E::UnknownCode, "unknown code G54", "没有 G54 指令"),
    ];
    let mut wrong = Vec::new();
    for (block, column, error, en, zh) in ROWS {
        let text = format!("N0010G01U-2W-1F300\nN0015M03\nN0020{block}\nN0100G04F1\nN0100G04F1\nN0900M02\n");
        let (number, said) = refused(&text);
        if said[0] != format!("O7000 line 3, column {column}: {en}")
            || said[1] != format!("O7000 第3行 第{column}列：{zh}")
            || number != error.number()
        {
            wrong.push(format!("{block}: {number} {said:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // No X infeed anywhere before the thread.
    let (number, said) = refused("N0010G00W5\nN0015M03\nN0020G33W-50F1.5\nN0030M02\n");
    assert!(said[0].starts_with("O7000 line 3, column 6: no X move before the thread"), "{said:?}");
    assert_eq!(number, E::ThreadWithoutInfeed.number());
    // A mistake in a block that the run would not come to, and in a subprogram.
    let (_, said) = refused("N0010G00W5\nN0020M97L0040\nN0030X5U5\nN0040M02\n");
    assert!(said[0].starts_with("O7000 line 3, column 8: X and U"), "{said:?}");
    let (_, said) = refused("N0010G00W5\nN0020M98L0040\nN0030M02\nN0040G02U0W0R100\nN0050M99\n");
    assert!(said[0].starts_with("O7000 line 4, column 13: a full circle"), "{said:?}");
}

/// A loop that does not end is started: its operator will end it.
#[test]
fn l7_a_program_that_never_ends_starts_after_its_proof() {
    let mut rig = lathe("N0010G01U-2F600\nN0020U2\nN0030M97L0010\nN0040M02\n");
    tell(
        &mut rig,
        "key cycle-start\nwait 3 s\nexpect state running\nexpect no alarm\nwait until X<-1 max 5 s\nkey reset",
    );
}
