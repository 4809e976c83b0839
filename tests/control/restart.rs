//! Running from a chosen block, and going on after a power cut (B5).

use std::path::Path;

use crate::stories::{ready_with, rig_of, tell};
use kt830::defs::kind::{Dialect, Kind};
use kt830::host::folders::{Folders, program_from_bytes};
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;
use kt830::units::{Axis, PerAxis};

/// X -80 (diameter), Z -150 at the start of a ready machine.
const TEXT: &str = "G98 T0101\n#100=3\nM03\nG00 X-70 Z-140\nG01 X-72 F100\nW-20\n#101=#100+1\nM30";

fn choose(rig: &mut HeadlessHost, line: u32) {
    rig.send(Command::RestartAt(line));
    tell(rig, "wait 0.1 s");
}

#[test]
fn b5_a_run_from_a_block_shows_its_codes_and_place_and_waits_for_the_wheel() {
    let mut rig = ready_with(TEXT);
    tell(&mut rig, "mode auto");
    choose(&mut rig, 6);
    let view = rig.snapshot().restart.clone().unwrap();
    assert_eq!((view.program, view.line, view.modals.g[0], view.modals.feed), (7_000, 6, 1, Some(100.0)));
    assert_eq!((view.modals.tool, view.wheel_turns, view.workpiece_turns), ((1, 1), true, false));
    assert_eq!((view.start[Axis::X], view.start[Axis::Z]), (Some(-72.0), Some(-140.0)));
    tell(
        &mut rig,
        "expect message \"X-72.000\"\nexpect X -80 ±0.001\nkey cycle-start\nexpect state idle\nexpect message \"砂轮\"",
    );
    tell(&mut rig, "key wheel-start\nwait 10 s\nkey cycle-start\nwait until Z>-145 max 10 s\nexpect X -80 ±0.01");
    tell(&mut rig, "wait until idle max 60 s\nexpect X -72 ±0.001\nexpect Z -160 ±0.001\nexpect #100 3\nexpect #101 4");
}

#[test]
fn b5_what_cannot_be_reckoned_is_refused_with_its_reason() {
    for (text, line, why) in [
        ("G50 X0 Z0\nG01 W-1 F60\nM30", 2, "G50"),
        ("G35 Z-160 Q20\nG01 U-1 F60\nM30", 2, "G35"),
        ("N10 IF[#1012 EQ 0]GOTO 10\nG01 W-1 F60\nM30", 2, "等待机床"),
        ("G01 W-1 F60\nM30\nG00 X0", 3, "运行不到"),
        ("#2905=2\nG42 D5 G01 U-10 W-5 F100\nW-20\nW-5\nG40 U10\nM30", 4, "半径补偿"),
        ("G01 U-10 F100 ,R2\nW-20\nM30", 2, "倒圆角"),
        ("G01 W-1 F60\nM30", 9, "没有第 9 行"),
        ("G01 Q7\nM30", 2, "第1行"),
    ] {
        let mut rig = ready_with(text);
        tell(&mut rig, "mode auto");
        rig.send(Command::RestartAt(line));
        tell(&mut rig, "wait 6 s");
        tell(&mut rig, &format!("expect message \"{why}\""));
        assert!(rig.snapshot().restart.is_none(), "{text}");
    }
}

#[test]
fn b5_a_block_is_chosen_in_automatic_mode_and_forgotten_with_reset_mode_and_program() {
    let mut rig = ready_with(TEXT);
    tell(&mut rig, "mode jog");
    choose(&mut rig, 6);
    tell(&mut rig, "expect message \"自动方式\"");
    for leave in ["key reset", "mode jog\nmode auto", "load O7000"] {
        tell(&mut rig, "mode auto");
        choose(&mut rig, 6);
        assert!(rig.snapshot().restart.is_some());
        tell(&mut rig, leave);
        assert!(rig.snapshot().restart.is_none(), "{leave}");
    }
}

#[test]
fn b5_what_the_skipped_blocks_switch_off_again_is_not_asked_for() {
    let mut rig = ready_with("G98 M03\nM63\nG01 Z-160 F600\nM05\nM65\nG01 W-10 F600\nM30");
    tell(&mut rig, "mode auto");
    choose(&mut rig, 6);
    let view = rig.snapshot().restart.clone().unwrap();
    assert!(!view.wheel_turns && !view.workpiece_turns);
    tell(&mut rig, "key cycle-start\nwait until idle max 20 s\nexpect Z -170 ±0.001");
}

#[test]
fn b5_after_a_power_cut_the_interrupted_block_is_offered_once_the_axes_are_homed() {
    let mut rig = ready_with("G98 G00 X-70 Z-140\nG01 X-72 F100\nW-60 F100\n#101=1\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until Z<-160 max 60 s\npower cut\npower on");
    assert_eq!(rig.snapshot().interrupted, Some((7_000, 3)));
    tell(&mut rig, "expect message \"第 3 行\"\nmode auto");
    rig.send(Command::ResumeInterrupted);
    tell(&mut rig, "wait 0.1 s\nexpect message \"回零\"\nkey hydraulic\nwait 4 s\nhome all\nmode auto");
    rig.send(Command::ResumeInterrupted);
    tell(&mut rig, "wait 0.1 s\nkey cycle-start\nwait until idle max 120 s\nexpect #101 1");
    // W-60 from Z -140, whatever had been done of it.
    tell(&mut rig, "expect Z -200 ±0.001\nexpect X -72 ±0.001\nexpect no alarm");
    assert_eq!(rig.snapshot().interrupted, None);
}

#[test]
fn b5_a_run_that_ended_leaves_nothing_to_resume() {
    let mut rig = ready_with("G98 G01 W-5 F600\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until idle max 20 s\npower cut\npower on");
    assert_eq!(rig.snapshot().interrupted, None);
    tell(&mut rig, "mode auto");
    rig.send(Command::ResumeInterrupted);
    tell(&mut rig, "wait 0.1 s\nexpect message \"没有断电中断\"");
}

/// A ready lathe with a program of this text, in automatic mode.
fn ready_lathe(text: &str) -> HeadlessHost {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = Folders {
        programs: root.join("programs/lathe"),
        screens: root.join("screens"),
        by_name: true,
        dialect: Dialect::SuperMan,
    };
    let mut rig = rig_of(Kind::Lathe, folders);
    rig.add_program(program_from_bytes(7_000, "PART.NC", text.as_bytes().to_vec(), rig.kind().dialect()));
    rig.make_ready();
    rig.step();
    tell(&mut rig, "load PART\nmode auto");
    rig
}

/// M03 and M04 start the main spindle, M07 switches the coolant on and M08 off (L7).
#[test]
fn l7_b5_a_run_from_a_block_on_the_lathe_reads_its_own_m_codes() {
    let text = "N0010M03\nN0020M07\nN0030G01W-5F1000\nN0040M08\nN0050G01W-5F1000\nN0060M05\nN0070G01W-5F1000\nN0080M02";
    for (line, turns, coolant) in [(3, true, true), (5, true, false), (7, false, false)] {
        let mut rig = ready_lathe(text);
        // Without a start since power-on the start point is not known (L3).
        choose(&mut rig, line);
        assert!(rig.snapshot().restart.is_none());
        tell(&mut rig, "expect message \"起点不知道\"");
        tell(&mut rig, "key cycle-start\nwait 0.01 s\nkey reset\nwait 3 s");
        let z = rig.controller().set_point()[Axis::Z];
        choose(&mut rig, line);
        let view = rig.snapshot().restart.clone().unwrap();
        assert_eq!((view.wheel_turns, view.workpiece_turns, view.coolant_on), (false, turns, coolant), "line {line}");
        if turns {
            tell(&mut rig, "key cycle-start\nexpect state idle\nexpect message \"该段之前工件已转动\"");
            tell(&mut rig, "key spindle-forward\nwait 3 s");
        }
        tell(&mut rig, "key cycle-start\nwait 0.2 s\nwait until idle max 60 s\nexpect no alarm");
        let moved = rig.controller().set_point()[Axis::Z] - z;
        assert!((moved + 15.0).abs() < 1e-6, "line {line}: {moved}");
    }
}

#[test]
fn k3_b5_a_run_from_a_block_on_the_grinder_reads_coolant_and_workpiece_drive() {
    for (line, turns, coolant) in [(4, true, true), (6, false, false)] {
        let mut rig = ready_with("G98 M63\nM08\nG01 Z-151 F600\nW-1\nM09 M65\nW-1\nM30");
        tell(&mut rig, "mode auto");
        choose(&mut rig, line);
        let view = rig.snapshot().restart.clone().unwrap();
        assert_eq!((view.wheel_turns, view.workpiece_turns, view.coolant_on), (false, turns, coolant), "line {line}");
    }
}

/// An axis that the blocks before have only moved by increments: from where the program was started, if that is known.
#[test]
fn b5_increments_count_from_the_start_of_the_program_or_the_run_is_refused() {
    const TEXT: &str = "G98 G01 W-10 F3000\nU-1 F60\nW10 F3000\nU-1 F60\nW-10 F300\nM30";
    let mut rig = ready_with(TEXT);
    tell(&mut rig, "mode auto");
    choose(&mut rig, 3);
    assert!(rig.snapshot().restart.is_none());
    tell(&mut rig, "expect message \"增量\"");
    // X-80 Z-150 at the start; interrupted at line 2 near Z-160: at line 3 X is -81, Z -160.
    tell(&mut rig, "key cycle-start\nwait until Z<-159.9 max 20 s\nwait 0.3 s\nkey reset\nwait 1 s");
    choose(&mut rig, 3);
    let view = rig.snapshot().restart.clone().unwrap();
    assert_eq!((view.start[Axis::X], view.start[Axis::Z]), (Some(-81.0), Some(-160.0)));
    tell(&mut rig, "key cycle-start\nwait until idle max 60 s\nexpect X -82 ±0.001\nexpect Z -160 ±0.001");
    // Begun anew by M99 it starts elsewhere.
    let mut rig = ready_with("G98 G01 W-10 F3000\nW5 F3000\nM99");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until Z<-162 max 30 s\nkey reset\nwait 1 s");
    choose(&mut rig, 2);
    assert!(rig.snapshot().restart.is_none());
}

/// The run that was interrupted has changed the origin already: an increment would be added twice.
#[test]
fn b5_origins_that_the_blocks_before_change_are_not_changed_again() {
    let mut rig = ready_with("G98 G00 X-65 Z-110\nG10 L2 P1 U4\nG01 X-66 F300\nW-1\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until Z>-110.01 max 60 s\nwait 2 s\nkey reset\nwait 1 s");
    let origin = rig.controller().work_offsets().work[0];
    choose(&mut rig, 4);
    assert!(rig.snapshot().restart.is_none());
    tell(&mut rig, "expect message \"工件原点 (#5221)\"");
    assert_eq!(rig.controller().work_offsets().work[0], origin);
    // One that sets it to what it is does not stand in the way.
    let mut rig = ready_with("G98 G00 X-65 Z-110\nG10 L2 P1 X4\nG01 X-66 F300\nG01 Z-111\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until Z>-110.01 max 60 s\nwait 2 s\nkey reset\nwait 1 s");
    choose(&mut rig, 4);
    assert!(rig.snapshot().restart.is_some(), "{:?}", rig.snapshot().message);
}

/// The frame, the compensation and the station of a tool called before the block are those of the full run.
#[test]
fn l8_b5_a_run_from_a_block_on_the_lathe_has_the_tool_of_the_block() {
    let text = "N0010G01W-10F1500\nN0020T20\nN0030G01U-10F1500\nN0040W-5\nN0050M02";
    let mut rig = ready_lathe(text);
    rig.send(Command::SetGeometry(2, PerAxis([5.0, 0.0, 5.0])));
    tell(&mut rig, "key cycle-start\nwait until idle max 120 s\nexpect no alarm");
    let full = rig.controller().set_point();
    choose(&mut rig, 3);
    tell(&mut rig, "key cycle-start\nwait 0.2 s\nwait until idle max 120 s\nexpect no alarm");
    let restarted = rig.controller().set_point();
    for axis in [Axis::X, Axis::Z] {
        assert!((restarted[axis] - full[axis]).abs() < 1e-6, "{axis}: {restarted:?} {full:?}");
    }
    // The post was turned away by its key.
    tell(&mut rig, "key tool-post\nwait 6 s");
    choose(&mut rig, 3);
    assert!(rig.snapshot().restart.is_none());
    tell(&mut rig, "expect message \"2 号刀\"");
}

/// `M63 S100`, the drive stopped and started again by its keys in a stop of the program: the part turns at S100 (3.33 V).
#[test]
fn k3_4_the_programmed_speed_of_the_workpiece_survives_a_restart_by_key_within_a_program() {
    let mut rig = ready_with("G98 M63 S100\nM00\nG01 W-1 F60\nM65\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until stopped max 20 s\nwait 3 s");
    let volts = rig.analog_2_volts();
    assert!(volts > 1.0, "{volts}");
    tell(&mut rig, "key headstock-stop\nwait 3 s\nkey headstock-high\nwait 3 s\nkey cycle-start\nwait 0.2 s");
    assert!((rig.analog_2_volts() - volts).abs() < 1e-9, "{}", rig.analog_2_volts());
    // By key alone it is the drive's own speed.
    tell(&mut rig, "wait until idle max 60 s\nkey headstock-high\nwait 3 s");
    assert!(rig.analog_2_volts().abs() < 1e-12);
}

/// A search for a block takes the whole reading budget; a retract meanwhile reads its program first.
#[test]
fn b5_k6_4_a_retract_does_not_wait_for_the_search_for_a_block() {
    let mut rig = ready_with("N10 #1=#1+1\nIF[#1 LT 2000000]GOTO 10\nG98 G01 W-5 F600\nM30");
    rig.add_program(program_from_bytes(9_000, "O9000.NC", b"G00 U4\nM99".to_vec(), rig.kind().dialect()));
    tell(&mut rig, "param P4.4 1\nmode auto");
    rig.send(Command::RestartAt(3));
    tell(&mut rig, "wait 0.1 s\nkey wheel-retract\nwait 0.5 s\nexpect X -76 ±0.001");
}
