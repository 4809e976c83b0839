//! One-key retract: the key holds the run and executes O9000, pressed again O9001 brings the wheel back (K6.4).

use crate::stories::{ready_with, tell};
use kt830::defs::kind::Dialect;
use kt830::host::folders::{Folders, program_from_bytes};
use kt830::host::headless::HeadlessHost;

/// X -80 (diameter), Z -150 at the start of a ready machine.
const GRIND: &str = "G98 G01 W-10 F300\nU-1 F60\nW10 F300\nM00\nG00 X-70\nM30";

/// A ready machine in automatic mode with the retract enabled, and the two programs as given.
fn retractable(away: &str, back: &str) -> HeadlessHost {
    let mut rig = ready_with(GRIND);
    rig.add_program(program_from_bytes(9_000, "O9000.NC", away.as_bytes().to_vec(), rig.kind().dialect()));
    rig.add_program(program_from_bytes(9_001, "O9001.NC", back.as_bytes().to_vec(), rig.kind().dialect()));
    tell(&mut rig, "param P4.4 1\nmode auto");
    rig
}

fn plain() -> HeadlessHost {
    retractable("G00 U40\nM99", "G98 G01 U-40 F2000\nM99")
}

#[test]
fn k6_4_the_key_stops_the_run_withdraws_and_brings_back_and_the_run_goes_on() {
    let mut rig = plain();
    tell(&mut rig, "key cycle-start\nwait 1 s\nkey wheel-retract\nexpect lamp wheel-retract on");
    tell(&mut rig, "wait until held max 10 s\nwait 0.1 s\nexpect X -40 ±0.001\nexpect state held");
    tell(&mut rig, "key cycle-start\nexpect state held\nexpect message \"一键回退\"\nexpect X -40 ±0.001");
    tell(&mut rig, "key wheel-retract\nwait 0.1 s\nwait until held max 10 s\nwait 0.1 s\nexpect X -80 ±0.001");
    tell(&mut rig, "expect lamp wheel-retract off\nkey cycle-start\nwait until stopped max 20 s");
    tell(&mut rig, "expect X -81 ±0.001\nexpect Z -150 ±0.001\nexpect no alarm");
    tell(&mut rig, "key cycle-start\nwait until idle max 20 s\nexpect X -70 ±0.001");
}

#[test]
fn k6_4_the_block_shown_is_that_of_the_held_program_again() {
    let mut rig = plain();
    tell(&mut rig, "key cycle-start\nwait 1 s\nkey wheel-retract\nwait 0.1 s\nwait until held max 10 s");
    assert_eq!((rig.controller().current_block().program, rig.controller().current_block().line), (7_000, 1));
}

#[test]
fn k6_4_in_a_hold_at_m00_and_with_nothing_running_it_works_too() {
    let mut rig = plain();
    tell(&mut rig, "key wheel-retract\nwait until idle max 10 s\nwait 0.1 s\nexpect X -40 ±0.001");
    tell(&mut rig, "key cycle-start\nexpect state idle\nexpect message \"一键回退\"");
    tell(&mut rig, "key wheel-retract\nwait 0.1 s\nwait until idle max 10 s\nwait 0.1 s\nexpect X -80 ±0.001");
    tell(&mut rig, "key cycle-start\nwait until stopped max 20 s\nkey wheel-retract\nwait 0.1 s\nwait until held");
    tell(&mut rig, "wait 0.1 s\nexpect X -41 ±0.001\nkey wheel-retract\nwait 0.1 s\nwait until held\nwait 0.1 s");
    tell(&mut rig, "key cycle-start\nwait until idle max 20 s\nexpect X -70 ±0.001\nexpect no alarm");
}

#[test]
fn k6_4_without_p4_4_the_key_is_dead_and_the_run_goes_on() {
    let mut rig = plain();
    tell(&mut rig, "param P4.4 0\nkey wheel-retract\nexpect message \"P4.4\"\nexpect state idle");
    tell(&mut rig, "key cycle-start\nwait 1 s\nkey wheel-retract\nwait 0.5 s\nexpect state running");
    tell(&mut rig, "wait until stopped max 20 s\nexpect X -81 ±0.001");
}

#[test]
fn k6_4_without_its_program_the_run_is_held_and_the_wheel_stays() {
    // A folder without programs.
    let Folders { screens, by_name: named, .. } = crate::stories::folders();
    let mut rig = crate::stories::rig_in(Folders {
        programs: screens.clone(),
        screens,
        by_name: named,
        dialect: Dialect::LatheA,
    });
    rig.make_ready();
    rig.add_program(program_from_bytes(7_000, "O7000.NC", GRIND.as_bytes().to_vec(), rig.kind().dialect()));
    tell(&mut rig, "load O7000\nparam P4.4 1\nmode auto");
    tell(&mut rig, "key cycle-start\nwait 3 s\nkey wheel-retract\nwait 0.5 s");
    tell(&mut rig, "expect state held\nexpect message \"O9000\"\nexpect lamp wheel-retract off");
    tell(&mut rig, "key cycle-start\nwait until stopped max 20 s\nexpect X -81 ±0.001");
}

#[test]
fn k6_4_a_way_back_that_ends_elsewhere_keeps_the_run_held_until_the_hand_has_mended_it() {
    let mut rig = retractable("G00 U40\nM99", "G98 G01 U-40.1 F2000\nM99");
    tell(&mut rig, "key cycle-start\nwait 1 s\nkey wheel-retract\nwait 0.1 s\nwait until held\nwait 0.1 s");
    tell(&mut rig, "key wheel-retract\nwait 0.1 s\nwait until held\nwait 0.1 s\nexpect X -80.1 ±0.001");
    tell(&mut rig, "expect message \"-0.100\"\nkey cycle-start\nexpect state held\nexpect message \"-0.100\"");
    tell(&mut rig, "key wheel-retract\nwait 0.3 s\nexpect X -80.1 ±0.001\nexpect state held");
    tell(&mut rig, "handwheel X 10 x0.01\nmode auto\nkey cycle-start\nwait until stopped max 20 s");
    tell(&mut rig, "expect X -81 ±0.001\nexpect no alarm");
}

#[test]
fn k6_4_hand_moves_before_the_key_still_count_and_m30_does_not_end_the_run() {
    let mut rig = retractable("#150=#150+1\nG00 U40\nM30", "G98 G01 U-40 F2000\nM30");
    tell(&mut rig, "set #150 = 4\nkey coolant\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s");
    tell(&mut rig, "handwheel X -5 x0.01\nmode auto\nkey wheel-retract\nwait 0.1 s\nwait until held\nwait 0.1 s");
    tell(&mut rig, "expect X -40.05 ±0.001\nexpect output coolant on\nexpect #150 5 ±0");
    tell(&mut rig, "key wheel-retract\nwait 0.1 s\nwait until held\nwait 0.1 s\nkey cycle-start");
    tell(&mut rig, "wait until stopped max 20 s\nexpect X -81.05 ±0.001");
}

#[test]
fn k6_4_reset_ends_the_held_run_and_darkens_the_lamp() {
    let mut rig = plain();
    tell(&mut rig, "key cycle-start\nwait 1 s\nkey wheel-retract\nwait 0.1 s\nwait until held\nkey reset\nwait 0.5 s");
    tell(&mut rig, "expect lamp wheel-retract off\nexpect state idle\nkey wheel-retract\nwait 0.05 s\nkey reset");
    tell(&mut rig, "wait 1 s\nexpect lamp wheel-retract off\nexpect state idle\nexpect no alarm");
    // From wherever RESET has stopped it the program runs anew: 1 mm of diameter, whole.
    tell(&mut rig, "mode mdi\nmdi G00 X-60 Z-150\nwait 1 s\nmode auto\nkey cycle-start\nwait until stopped max 20 s");
    tell(&mut rig, "expect X -61 ±0.001");
}

#[test]
fn k6_4_a_hold_during_the_retract_and_an_unhomed_machine() {
    let mut rig = retractable("G98 G01 U40 F600\nM99", "G98 G01 U-40 F600\nM99");
    tell(&mut rig, "key cycle-start\nwait 1 s\nkey wheel-retract\nwait 0.5 s\nkey feed-hold\nwait 0.5 s");
    tell(&mut rig, "expect state held\nkey wheel-retract\nexpect message \"正在执行\"\nkey cycle-start");
    tell(&mut rig, "wait 0.1 s\nwait until held max 10 s\nwait 0.1 s\nexpect X -40 ±0.001");
    let mut cold = crate::stories::story("power on\nparam P4.4 1\nkey wheel-retract\nexpect message \"回零\"");
    tell(&mut cold, "expect state idle\nexpect lamp wheel-retract off");
}

/// Away and back again.
const THERE_AND_BACK: &str = "key wheel-retract\nwait 0.1 s\nwait until held max 10 s\nwait 0.1 s\nkey wheel-retract\nwait 0.1 s\n\
                              wait until held max 10 s\nwait 0.1 s";

#[test]
fn k6_4_the_block_goes_on_to_its_end_before_the_next_act() {
    let mut rig = ready_with("G98 G01 X-82 F60\nM08\nM00\nM30");
    rig.add_program(program_from_bytes(9_000, "O9000.NC", b"G00 U40\nM99".to_vec(), rig.kind().dialect()));
    rig.add_program(program_from_bytes(
        9_001,
        "O9001.NC",
        b"G98 G01 U-20 F2000\nU-20\nM99".to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "param P4.4 1\nmode auto\nkey cycle-start\nwait 0.5 s");
    tell(&mut rig, THERE_AND_BACK);
    // 1 mm of slide at 60 mm/min: a second, half of it done.
    tell(
        &mut rig,
        "key cycle-start\nwait 0.2 s\nexpect output coolant off\nwait until stopped max 10 s\nexpect X -82 ±0.001",
    );
}

#[test]
fn k6_4_a_wheel_stopped_while_it_is_away_must_turn_before_the_run_goes_on() {
    let mut rig = ready_with("M03\nG98 G01 W-10 F60\nM00\nM30");
    rig.add_program(program_from_bytes(9_000, "O9000.NC", b"G00 U40\nM99".to_vec(), rig.kind().dialect()));
    rig.add_program(program_from_bytes(9_001, "O9001.NC", b"G98 G01 U-40 F2000\nM99".to_vec(), rig.kind().dialect()));
    tell(
        &mut rig,
        "param P4.4 1\nmode auto\nkey cycle-start\nwait until Z<-151 max 30 s\nkey wheel-retract\nwait 0.1 s",
    );
    tell(
        &mut rig,
        "wait until held max 10 s\nwait 0.1 s\nkey wheel-stop\nkey wheel-retract\nwait 0.1 s\nwait until held max 10 s",
    );
    tell(&mut rig, "wait 0.1 s\nkey cycle-start\nexpect state held\nexpect message \"砂轮已停\"");
}

#[test]
fn k6_4_beside_an_oscillation_of_the_program_it_works_too() {
    let mut rig = ready_with("G98 G35 Z-160 D300 Q30\nG01 U-1 F10\nG36\nM00\nM30");
    rig.add_program(program_from_bytes(9_000, "O9000.NC", b"G00 U40\nM99".to_vec(), rig.kind().dialect()));
    rig.add_program(program_from_bytes(9_001, "O9001.NC", b"G98 G01 U-40 F2000\nM99".to_vec(), rig.kind().dialect()));
    tell(&mut rig, "param P4.4 1\nmode auto\nkey cycle-start\nwait 1.3 s");
    tell(&mut rig, THERE_AND_BACK);
    tell(
        &mut rig,
        "expect lamp wheel-retract off\nkey cycle-start\nwait until stopped max 30 s\nexpect X -81 ±0.001\nexpect Z -150 ±0.001",
    );
}

#[test]
fn k6_4_the_way_back_begins_only_where_the_wheel_was_left() {
    let mut rig = plain();
    tell(&mut rig, "key cycle-start\nwait 1 s\nkey wheel-retract\nwait 0.1 s\nwait until held max 10 s\nwait 0.1 s");
    tell(
        &mut rig,
        "handwheel X -100 x0.01\nmode auto\nkey wheel-retract\nwait 1 s\nexpect X -41 ±0.001\nexpect message \"-1.000\"",
    );
    tell(
        &mut rig,
        "handwheel X 100 x0.01\nmode auto\nkey wheel-retract\nwait 0.1 s\nwait until held\nwait 0.1 s\nexpect X -80 ±0.001",
    );
    // Without a run the same: an MDI line waits too.
    let mut rig = plain();
    tell(
        &mut rig,
        "key wheel-retract\nwait until idle max 10 s\nwait 0.1 s\nkey machine-lock\nexpect lamp machine-lock off",
    );
    tell(&mut rig, "mode mdi\nmdi G00 X-50\nwait 0.5 s\nexpect X -40 ±0.001");
}

#[test]
fn k6_4_a_dwell_waits_for_the_retract_and_reset_leaves_no_interrupted_run() {
    let mut rig = ready_with("G04 X5\nM00\nM30");
    rig.add_program(program_from_bytes(9_000, "O9000.NC", b"G00 U40\nM99".to_vec(), rig.kind().dialect()));
    rig.add_program(program_from_bytes(9_001, "O9001.NC", b"G98 G01 U-40 F2000\nM99".to_vec(), rig.kind().dialect()));
    tell(&mut rig, "param P4.4 1\nmode auto\nkey cycle-start\nwait 1 s");
    tell(&mut rig, THERE_AND_BACK);
    // 4 s are left, less the ticks between.
    tell(&mut rig, "key cycle-start\nwait 3.8 s\nexpect state running\nwait until stopped max 1 s\nkey reset");
    tell(
        &mut rig,
        "key cycle-start\nwait 1 s\nkey wheel-retract\nwait 0.3 s\nkey reset\nwait 1 s\npower cut\npower on",
    );
    assert_eq!(rig.snapshot().interrupted, None);
}
