//! The rules of the machine (K2, K3, K5) as stories on the simulated cylindrical grinder.

use crate::stories::{ready, ready_with, refused, story, story_on, tell};
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::param::ParamAddress;
use kt830::defs::signal::{Input, Output};
use kt830::host::folders::program_from_bytes;
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;
use kt830::link::page_command::{PageCommand, PasswordScope, Secret};
use kt830::link::simulation::SimCommand;
use kt830::link::snapshot::RunState;
use kt830::units::Axis;

/// Adds a program.
fn add(rig: &mut HeadlessHost, number: u32, text: &str) {
    let name = format!("O{number}.NC");
    rig.add_program(program_from_bytes(number, &name, text.as_bytes().to_vec(), rig.kind().dialect()));
}

/// Hydraulics on, pressure there, its delay gone by, nothing homed.
const HYDRAULICS: &str = "key hydraulic\nwait 4 s\nexpect no alarm\n";

#[test]
fn b6_an_unlock_by_the_initial_password_asks_to_change_it_until_it_is_changed() {
    let mut rig = story("unlock builder 830830\nexpect message \"仍是出厂密码\"");
    let change = PageCommand::ChangePassword {
        scope: PasswordScope::Builder,
        old: Secret::new("830830".into()),
        new: Secret::new("471100".into()),
    };
    rig.send(Command::Page(change));
    tell(&mut rig, "wait 0.1 s\nunlock builder 471100\nexpect message \"关机前有效\"");
    // The password of programs is the customer's own.
    tell(&mut rig, "unlock program 187350\nexpect message \"关机前有效\"");
}

#[test]
fn k3_7_missing_pressure_after_power_on_is_alarm_180_from_p270_on() {
    // P270 = 3000 ms, then the tick that looks; the input has been off since power-on, so its filter adds nothing.
    let mut rig = story("wait 2.9 s\nexpect no alarm\nwait 0.2 s\nexpect alarm 180\nexpect state alarm");
    // It blocks the wheel, not homing or jogging, and goes by itself when the signal comes.
    tell(&mut rig, "key wheel-start\nexpect output wheel off\nmode jog\nhold X+ 0.5 s\nexpect state alarm");
    tell(&mut rig, "key hydraulic\nwait 4 s\nexpect no alarm");
}

#[test]
fn k3_7_pressure_that_goes_with_a_commanded_off_is_no_alarm_and_the_wheel_still_needs_it() {
    for off in ["key hydraulic", "mdi M15"] {
        let mut rig = story(HYDRAULICS);
        tell(&mut rig, &format!("{off}\nexpect output hydraulic off\nwait 5 s\nexpect no alarm"));
        tell(
            &mut rig,
            "expect input hydraulic-pressure off\nkey wheel-start\nexpect output wheel off\nexpect alarm 180",
        );
        // The refused start clears when it would be granted: pump on, P270 = 3 s, pressure.
        tell(&mut rig, "key hydraulic\nwait 4 s\nexpect no alarm\nkey wheel-start\nexpect output wheel on");
    }
}

#[test]
fn k3_7_a_wheel_that_runs_unsupervised_without_a_pump_stops_once_the_pressure_is_supervised() {
    // P17.0=1: no supervision. The pump was switched off by its key, so its missing pressure alone is no alarm.
    let mut rig = story("param P17.0 1\nkey hydraulic\nwait 4 s\nkey hydraulic\nwait 2 s\nexpect no alarm");
    tell(&mut rig, "key wheel-start\nwait 9.5 s\nexpect output wheel on\nexpect no alarm");
    tell(&mut rig, "param P17.0 0\nwait 0.1 s\nexpect output wheel off\nexpect alarm 180");
}

#[test]
fn k3_7_after_a_deliberate_m15_the_next_m14_is_supervised_from_p270_on() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "mdi M15\nwait 4 s\nexpect no alarm\ninput hydraulic-pressure off\nmdi M14");
    tell(&mut rig, "wait 1.8 s\nexpect no alarm\nwait 1.5 s\nexpect alarm 180");
    tell(&mut rig, "input hydraulic-pressure free\nwait 0.1 s\nexpect no alarm");
}

#[test]
fn k3_7_alarm_180_says_what_is_so() {
    // The wheel is off: there is no pressure. At a wheel start, and when the wheel ran, it is the customer's text.
    tell(&mut story("wait 4 s"), "expect alarm \"没有液压压力\"");
    let start = "key hydraulic\nwait 1 s\nkey wheel-start\nexpect alarm \"砂轮启动时液压异常\"";
    tell(&mut story(""), start);
    let mut rig =
        story("key hydraulic\nwait 4 s\nkey wheel-start\nwait 9.5 s\nexpect output wheel on\nexpect no alarm");
    tell(&mut rig, "fault pressure-loss\nwait until alarm max 3 s\nexpect alarm \"砂轮启动时液压异常\"");
}

#[test]
fn k3_7_a_repaired_pressure_ends_the_alarm_and_the_wheel_starts_by_its_key_alone() {
    let mut rig = story("key hydraulic\nwait 4 s\nkey wheel-start\nwait 9.5 s\nexpect output wheel on");
    tell(&mut rig, "fault pressure-loss\nwait until alarm max 3 s\nexpect alarm 180\nexpect output wheel off");
    // As long as the fault is there, nothing ends the alarm.
    tell(
        &mut rig,
        "wait 5 s\nkey reset\nwait 1 s\nexpect alarm 180\nkey wheel-start\nwait 1 s\nexpect output wheel off",
    );
    tell(&mut rig, "fault pressure-loss off\nwait 4 s\nkey reset\nwait 1 s\nexpect no alarm\nexpect output wheel off");
    tell(&mut rig, "key wheel-start\nwait 9.5 s\nexpect output wheel on\nexpect no alarm");
}

#[test]
fn k3_7_m14_works_under_alarm_180_in_mdi_and_in_a_program() {
    tell(&mut story("wait 4 s\nexpect alarm 180"), "mdi M14\nexpect output hydraulic on\nwait 4 s\nexpect no alarm");
    let mut rig = story("wait 4 s\nexpect alarm 180\nhome all\nexpect alarm 180");
    add(&mut rig, 7_000, "M14\nG04 X4\n#100=7\nM30");
    tell(
        &mut rig,
        "load O7000\nmode auto\nkey cycle-start\nwait 0.5 s\nexpect state running\nexpect output hydraulic on",
    );
    tell(&mut rig, "wait until idle max 20 s\nexpect no alarm\nexpect #100 7");
}

#[test]
fn k3_7_m15_in_a_program_whose_wheel_is_off_is_no_alarm_and_the_part_counts() {
    let mut rig = ready_with("M05\nM15\nG04 X2\nM31\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until idle max 20 s\nexpect no alarm\nexpect output hydraulic off",
    );
    assert_eq!(rig.snapshot().parts_counted, 1);
    // A wheel start without the pump stays refused, in the program as by key.
    let mut rig = ready_with("M15\nG04 X2\nM03\n#100=7\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 20 s\nexpect alarm 180\nexpect output wheel off");
    assert_eq!(rig.snapshot().variables[100], None);
}

#[test]
fn k3_7_alarm_180_bars_programs_that_start_the_wheel_and_no_others() {
    let mut rig = ready_with("G98 G00 X-100\n#100=7\nM30");
    add(&mut rig, 7_001, "#101=7\nG01 X-50 F500\nm3 S1200\nM30");
    add(&mut rig, 7_002, "#102=7\nM98 P7001\nM30");
    add(&mut rig, 7_003, "#103=7\nG65 P7002\nM30");
    add(&mut rig, 7_004, "#104=3\nM#104\n#105=7\nM30");
    add(&mut rig, 7_005, "; no M03\n(M03)\nM30\n");
    tell(&mut rig, "input hydraulic-pressure off\nwait 1 s\nexpect alarm 180\nmode auto");
    for program in ["O7001", "O7002", "O7003"] {
        tell(&mut rig, &format!("load {program}\nkey cycle-start\nexpect message \"报警 180\"\nexpect state alarm"));
    }
    assert_eq!(rig.snapshot().variables[101..104], [None; 3], "nothing of them ran");
    tell(&mut rig, "load O7000\nkey cycle-start\nwait until alarm max 60 s\nexpect X -100 ±0.002\nexpect #100 7");
    tell(&mut rig, "load O7005\nkey cycle-start\nexpect alarm 180\nwait 1 s\nexpect state alarm");
    // What no text shows is stopped at its M03.
    tell(&mut rig, "load O7004\nkey cycle-start\nwait 1 s\nexpect alarm 180\nexpect output wheel off\nexpect #104 3");
    assert_eq!(rig.snapshot().variables[105], None);
}

#[test]
fn k3_7_a_pump_that_loses_its_pressure_or_never_gets_it_stops_its_program() {
    let mut rig = ready_with("G04 X5\n#100=7\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 1 s\nfault pressure-loss\nwait until alarm max 3 s\nexpect alarm 180",
    );
    assert_eq!(rig.snapshot().variables[100], None);
    let mut rig = ready_with("M14\nG04 X9\n#100=7\nM30");
    tell(&mut rig, "key hydraulic\nwait 3 s\ninput hydraulic-pressure off\nmode auto\nkey cycle-start\nwait 2.5 s");
    tell(&mut rig, "expect state running\nwait 1 s\nexpect alarm 180\nexpect state alarm");
    assert_eq!(rig.snapshot().variables[100], None);
    // The same when alarm 180 was there before: the new M14 gets its own P270.
    let mut rig = ready_with("M14\nG04 X9\n#100=7\nM30");
    tell(
        &mut rig,
        "input hydraulic-pressure off\nwait 1 s\nexpect alarm 180\nkey hydraulic\nmode auto\nkey cycle-start",
    );
    tell(&mut rig, "wait 2.5 s\nexpect state running\nwait 1 s\nexpect state alarm");
    assert_eq!(rig.snapshot().variables[100], None);
}

#[test]
fn k3_7_the_wheel_needs_the_delay_even_with_pressure() {
    let mut rig = story("key hydraulic\nwait 2 s\nexpect input hydraulic-pressure on\nkey wheel-start");
    tell(&mut rig, "expect alarm 180\nexpect output wheel off\nwait 1.5 s\nexpect no alarm");
    tell(&mut rig, "key wheel-start\nexpect output wheel on");
}

#[test]
fn k3_7_pressure_lost_with_the_wheel_on_stops_it_after_the_filter() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "key wheel-start\nwait 1 s\nexpect output wheel on");
    // Filter 10 ms (P59): nine ticks of a missing signal are not enough, eleven are.
    rig.machine_mut().force_input("hydraulic-pressure", Some(false)).unwrap();
    let lasted = (0..50).take_while(|_| {
        rig.step();
        rig.snapshot().outputs.has(kt830::defs::signal::Output::Wheel)
    });
    let lasted = lasted.count();
    assert!((9..=11).contains(&lasted), "the wheel stayed on for {lasted} ticks");
    tell(&mut rig, "expect alarm 180\ninput hydraulic-pressure free\nwait 1 s\nexpect alarm 180");
    tell(&mut rig, "key reset\nwait 0.1 s\nexpect no alarm\nexpect output wheel off\nexpect output hydraulic on");
}

#[test]
fn k3_7_reset_does_not_clear_it_while_the_pressure_is_missing() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "key wheel-start\ninput hydraulic-pressure off\nexpect alarm 180\nkey reset\nexpect alarm 180");
}

#[test]
fn k3_7_pressure_lost_in_a_run_stops_the_program() {
    let mut rig = ready_with("G98\nM03\nG01 X-200 F100\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 12 s\nexpect state running\nfault pressure-loss");
    tell(&mut rig, "wait until alarm max 5 s\nexpect alarm 180\nexpect output wheel off\nwait 0.5 s\nkey cycle-start");
    tell(&mut rig, "expect state alarm\nexpect output wheel off");
}

#[test]
fn k3_7_with_p270_zero_only_the_pump_counts_and_its_lack_is_a_message() {
    let mut rig = story("param P270 0\nwait 5 s\nexpect no alarm\nkey wheel-start\nexpect output wheel off");
    tell(&mut rig, "expect no alarm\nexpect message \"液压\"");
    tell(
        &mut rig,
        "input hydraulic-pressure off\nkey hydraulic\nkey wheel-start\nexpect output wheel on\nexpect no alarm",
    );
}

#[test]
fn k3_7_with_p17_0_there_is_neither_supervision_nor_condition() {
    story("param P17.0 1\nwait 5 s\nexpect no alarm\nkey wheel-start\nexpect output wheel on\nexpect no alarm");
}

#[test]
fn k3_5_while_the_wheel_runs_the_hydraulic_key_has_no_effect() {
    let mut rig = story(HYDRAULICS);
    tell(
        &mut rig,
        "key wheel-start\nkey hydraulic\nexpect output hydraulic on\nexpect message \"砂轮\"\nexpect no alarm",
    );
}

#[test]
fn k3_5_while_the_wheel_runs_m15_has_no_effect_and_the_program_goes_on() {
    let mut rig = ready_with("M03\nM15\n#100=7\nM30");
    tell(
        &mut rig,
        "param P17.2 1\nmode auto\nkey cycle-start\nwait until idle max 20 s\nexpect #100 7\nexpect output hydraulic on",
    );
}

#[test]
fn k3_6_reset_and_emergency_stop_leave_hydraulics_and_tailstock() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "key tailstock-advance\nwait 3 s\nkey wheel-start\nkey coolant\nkey emergency-stop");
    tell(&mut rig, "expect alarm 0\nexpect output wheel off\nexpect output coolant off");
    tell(&mut rig, "expect output hydraulic on\nexpect output tailstock on\nkey reset\nexpect alarm 0");
    tell(
        &mut rig,
        "key emergency-stop\nkey reset\nexpect no alarm\nexpect output hydraulic on\nexpect output tailstock on",
    );
}

#[test]
fn k5_5_the_wheel_is_off_in_the_tick_of_the_emergency_stop() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "key wheel-start\nwait 1 s");
    rig.send(kt830::link::Command::Press(kt830::defs::key::Key::EmergencyStop));
    rig.step(); // the command is taken
    rig.step(); // the input it stands for is read
    assert!(!rig.snapshot().outputs.has(kt830::defs::signal::Output::Wheel));
}

#[test]
fn k3_3_the_tailstock_does_not_move_while_the_headstock_turns() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "key tailstock-advance\nwait 2 s\nkey headstock-high\nwait 1 s\nkey tailstock-retract");
    tell(
        &mut rig,
        "expect alarm 181\nexpect output tailstock on\nkey reset\nexpect no alarm\nexpect output headstock-high off",
    );
    tell(&mut rig, "key tailstock-retract\nexpect output tailstock off\nexpect no alarm");
}

#[test]
fn k3_4_the_headstock_does_not_start_while_the_tailstock_moves() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "key tailstock-advance\nkey headstock-low\nexpect alarm 181\nexpect output headstock-low off");
    tell(&mut rig, "key reset\nwait 2 s\nkey headstock-low\nexpect output headstock-low on\nexpect no alarm");
}

#[test]
fn k3_3_with_p16_2_zero_code_and_key_have_no_effect() {
    let mut rig = story(HYDRAULICS);
    tell(
        &mut rig,
        "param P16.2 0\nkey tailstock-advance\nexpect output tailstock off\nexpect no alarm\nexpect message \"尾座\"",
    );
}

#[test]
fn k3_4_high_low_and_stop_exclude_each_other() {
    let mut rig = story(HYDRAULICS);
    tell(
        &mut rig,
        "key headstock-high\nexpect output headstock-high on\nkey headstock-low\nexpect output headstock-high off",
    );
    tell(
        &mut rig,
        "expect output headstock-low on\nexpect lamp headstock-low on\nkey headstock-stop\nexpect output headstock-low off",
    );
}

#[test]
fn k2_2_in_a_run_only_fluids_and_run_keys_act() {
    let mut rig = ready_with("G98 G01 X-200 F20\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.5 s\nexpect state running");
    tell(
        &mut rig,
        "key wheel-start\nexpect output wheel off\nexpect message \"运行\"\nkey hydraulic\nexpect output hydraulic on",
    );
    tell(
        &mut rig,
        "key headstock-high\nexpect output headstock-high off\nmode jog\nexpect state running\nexpect lamp mode-auto on",
    );
    tell(&mut rig, "key coolant\nexpect output coolant on\nkey lubrication\nexpect output lubrication on");
    // Held: all keys act.
    tell(&mut rig, "key feed-hold\nwait until held\nkey wheel-start\nexpect output wheel on");
}

#[test]
fn k3_14_m30_switches_coolant_headstock_and_wheel_off_and_m31_counts() {
    let mut rig = ready_with("M03\nM63\nM08\nM31\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 10 s\nexpect output wheel on\nwait until idle max 20 s");
    tell(&mut rig, "expect output wheel off\nexpect output headstock-high off\nexpect output coolant off");
    assert_eq!(rig.snapshot().parts_counted, 1);
}

#[test]
fn k3_14_with_p17_2_the_wheel_keeps_running() {
    let mut rig = ready_with("M03\nM08\nM30");
    tell(&mut rig, "param P17.2 1\nmode auto\nkey cycle-start\nwait until idle max 20 s");
    tell(&mut rig, "expect output wheel on\nexpect output coolant off");
}

#[test]
fn k3_14_m03_and_m63_end_after_their_delays() {
    let mut rig = ready_with("M03\n#100=1\nM63\n#101=1\nM30");
    // P61 = 9 s for the wheel, P62 = 2 s for the headstock.
    tell(&mut rig, "set #100 =\nset #101 =\nmode auto\nkey cycle-start\nwait 8.9 s");
    assert_eq!(rig.snapshot().variables[100], None);
    tell(&mut rig, "wait 0.2 s\nexpect #100 1\nwait 1.7 s");
    assert_eq!(rig.snapshot().variables[101], None);
    tell(&mut rig, "wait 0.3 s\nwait until idle max 1 s\nexpect #101 1");
}

#[test]
fn k3_14_m00_stops_and_cycle_start_goes_on() {
    let mut rig = ready_with("#100=1\nM00\n#100=2\nM01\n#100=3\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until stopped max 2 s\nexpect #100 1\nwait 1 s\nexpect #100 1");
    tell(&mut rig, "key cycle-start\nwait until idle max 2 s\nexpect #100 3");
    tell(
        &mut rig,
        "key optional-stop\nkey cycle-start\nwait until stopped\nkey cycle-start\nwait until stopped max 2 s",
    );
    tell(&mut rig, "expect #100 2\nkey reset\nwait 0.1 s\nexpect state idle");
}

#[test]
fn k3_13_m80_waits_for_its_input_and_reset_ends_it() {
    let mut rig = ready_with("M80\n#100=1\nM81\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until waiting max 2 s\ninput user-1 on\nexpect #100 1\nexpect state waiting",
    );
    assert!(rig.snapshot().waiting_for.as_ref().is_some_and(|text| text.zh().contains("14")), "M81 waits for port 14");
    tell(&mut rig, "key reset\nwait 0.1 s\nexpect state idle");
}

#[test]
fn k3_12_user_outputs_are_switched_in_pairs() {
    let mut rig = ready_with("M50\nM58\nM00\nM51\nM59\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until stopped\nexpect output user-1 on\nexpect output user-5 on");
    tell(&mut rig, "key cycle-start\nwait until idle max 2 s\nexpect output user-1 off\nexpect output user-5 off");
}

#[test]
fn k3_15_an_unknown_m_code_is_an_error_before_its_block() {
    let mut rig = ready_with("#100=1\nG00 X300 M77\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until alarm max 2 s\nexpect alarm \"M77\"\nexpect #100 1");
}

#[test]
fn p8_every_kind_of_axis_trouble_stops_everything_and_says_why() {
    for (trouble, number) in [("drive-x", 104), ("stuck-on limit-z-minus", 102), ("bus-silent 50", 402)] {
        let mut rig = ready_with("M08\nG98 G01 X-200 F100\nM30");
        tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.5 s\nexpect state running\nexpect output coolant on");
        tell(&mut rig, &format!("fault {trouble}\nwait 0.5 s\nexpect alarm {number}\nexpect state alarm"));
        assert!(!rig.snapshot().outputs.has(kt830::defs::signal::Output::Coolant));
    }
}

#[test]
fn b5_a_held_jog_key_that_falls_silent_stops_after_its_keep_alive() {
    let mut rig = ready();
    tell(&mut rig, "mode jog");
    // A finger that the screen has lost: a story's would be heard of.
    rig.send(kt830::link::Command::Press(kt830::defs::key::Key::XPlus));
    tell(&mut rig, "wait 0.15 s");
    let moving = rig.snapshot().axes.0[0].moving;
    // P66 = 200 ms of silence, then braking from 1000 mm/min at 800 mm/s²: 21 ms + 40 ms of jerk.
    tell(&mut rig, "wait 0.15 s");
    assert!(moving && !rig.snapshot().axes.0[0].moving);
    tell(&mut rig, "expect message \"按键\"");
}

#[test]
fn k2_3_a_detent_moves_the_displayed_diameter_by_the_step() {
    let mut rig = ready();
    let x = rig.snapshot().axes.0[0].work;
    tell(&mut rig, "handwheel X 25 x0.01\nwait 0.5 s");
    assert!((rig.snapshot().axes.0[0].work - x - 0.25).abs() < 0.0015, "25 detents of 0.01 on the diameter");
}

#[test]
fn b5_soft_limits_stop_a_jog_in_time() {
    let mut rig = ready();
    // From wherever it stands to the plus limit P39 = +1 mm: never beyond it, and not an alarm.
    tell(&mut rig, "mode jog\nkey rapid\nhold X+ 6 s\nwait 0.5 s\nexpect no alarm\nexpect machine X 2.000 ±0.002");
}

#[test]
fn b5_with_the_drives_off_nothing_moves_until_reset() {
    for trouble in ["key emergency-stop\nwait 100 ms\nkey emergency-stop", "fault drive-z\nwait 100 ms"] {
        let mut rig = ready();
        tell(&mut rig, &format!("{trouble}\nwait 0.2 s"));
        let before = rig.snapshot().axes;
        tell(&mut rig, "mode jog\nhold Z- 1 s\nhold X- 1 s\nhandwheel Z 10 x0.1\nmode home\nkey x-plus\nwait 1 s");
        assert_eq!(rig.snapshot().axes.map(|view| view.machine.to_bits()), before.map(|view| view.machine.to_bits()));
    }
}

#[test]
fn b5_a_limit_switch_is_left_the_other_way_only() {
    let mut rig = ready();
    tell(&mut rig, "mode jog\nhold Z- 0.5 s\ninput limit-z-minus on\nwait 0.5 s\nexpect alarm 102");
    let stood = rig.snapshot().axes.0[2].machine;
    tell(&mut rig, "hold Z- 1 s\nkey reset\nexpect alarm 102\nhold Z- 1 s\nexpect message \"反方向\"\nwait 0.2 s");
    assert!((rig.snapshot().axes.0[2].machine - stood).abs() < 0.002, "not further onto the switch");
    tell(&mut rig, "hold Z+ 1 s\nwait 0.3 s");
    assert!(rig.snapshot().axes.0[2].machine > stood + 5.0, "off the switch");
    assert!(!rig.snapshot().axes.0[2].homed, "homing has to be done again");
    tell(&mut rig, "input limit-z-minus off\nkey reset\nexpect no alarm");
}

#[test]
fn k3_7_a_latched_alarm_180_blocks_the_wheel_until_reset() {
    let mut rig = story(HYDRAULICS);
    tell(
        &mut rig,
        "key wheel-start\nwait 1 s\ninput hydraulic-pressure off\ninput hydraulic-pressure free\nwait 0.1 s",
    );
    tell(
        &mut rig,
        "expect alarm 180\nkey wheel-start\nexpect output wheel off\nkey reset\nkey wheel-start\nexpect output wheel on",
    );
}

#[test]
fn k3_7_switching_the_pump_anew_does_not_take_the_alarm_away() {
    let mut rig = story(HYDRAULICS);
    tell(
        &mut rig,
        "input hydraulic-pressure off\nwait 0.1 s\nexpect alarm 180\nkey hydraulic\nkey hydraulic\nwait 0.1 s",
    );
    tell(&mut rig, "expect alarm 180\ninput hydraulic-pressure free\nwait 1.5 s\nexpect no alarm");
}

#[test]
fn k3_4_a_tailstock_that_timed_out_is_not_advanced() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "param P6.5 1\ninput tailstock-advanced off\nkey tailstock-advance\nwait 4 s\nexpect alarm 185");
    tell(&mut rig, "key reset\nkey headstock-high\nexpect output headstock-high off\nexpect alarm 184");
}

#[test]
fn k3_4_the_headstock_waits_while_nobody_knows_where_the_quill_stands() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "key tailstock-advance\nwait 2 s\nexpect no alarm\ninput tailstock-retracted off");
    tell(&mut rig, "key tailstock-retract\nwait 4 s\nexpect alarm 185\nkey reset\nexpect no alarm");
    tell(&mut rig, "key headstock-high\nwait 0.1 s\nexpect output headstock-high off\nexpect alarm 184\nkey reset");
    tell(&mut rig, "input tailstock-retracted free\nkey tailstock-retract\nwait 2 s\nkey headstock-high\nwait 0.1 s");
    tell(&mut rig, "expect no alarm\nexpect output headstock-high on");
}

#[test]
fn k3_4_m63_s_drives_the_second_analog_output_until_the_drive_changes() {
    let mut rig = ready_with("M63 S250\nM00\nM64\nM00\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait until stopped max 5 s");
    // P65: 300 rpm at 10 V.
    assert!((rig.analog_2_volts() - 250.0 / 30.0).abs() < 1e-9);
    tell(&mut rig, "key cycle-start\nwait until stopped max 5 s");
    assert!(rig.analog_2_volts().abs() < 1e-12);
}

#[test]
fn k5_9_with_the_wheel_on_the_wheel_axis_takes_fine_steps_only() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "key wheel-start\nhandwheel X -5 x0.1\nexpect X 0 ±0.001\nexpect message \"0.01\"");
    tell(&mut rig, "handwheel X -5 x0.01\nexpect X -0.05 ±0.0015\nhandwheel Z -5 x0.1\nexpect Z -0.5 ±0.0015");
    // Away from the part the handwheel is refused too; a step is not: only the slow direction is limited.
    tell(&mut rig, "handwheel X 1 x0.1\nexpect X -0.05 ±0.0015\nmode step\nkey step-0.1\nkey x-minus\nwait 1 s");
    tell(&mut rig, "expect X -0.05 ±0.0015\nexpect message \"0.01\"\nkey x-plus\nwait 1 s\nexpect X 0.05 ±0.0015");
}

#[test]
fn k5_13_an_open_guard_stops_every_start() {
    let mut rig = ready_with("G04 X5\nM30");
    tell(&mut rig, "param P332 60\ninput guard-closed off\nexpect no alarm\nmode jog");
    for (key, output) in
        [("wheel-start", "wheel"), ("headstock-high", "headstock-high"), ("second-spindle", "second-spindle")]
    {
        tell(&mut rig, &format!("key {key}\nexpect output {output} off\nexpect message \"防护门\""));
    }
    tell(&mut rig, "mode auto\nkey cycle-start\nexpect state idle\nexpect message \"防护门\"");
    // Closed, all of them start.
    tell(&mut rig, "input guard-closed on\nkey wheel-start\nexpect output wheel on\nkey cycle-start");
    tell(&mut rig, "expect state running\nexpect no alarm");
}

#[test]
fn k5_13_the_guard_opened_in_a_run_holds_it_and_stops_the_headstock() {
    let mut rig = ready_with("M03\nM63\nG98 G01 X-200 F60\nM30");
    tell(&mut rig, "param P332 60\ninput guard-closed on\nmode auto\nkey cycle-start\nwait 12 s\nexpect state running");
    tell(&mut rig, "input guard-closed off\nwait 1 s\nexpect state held\nexpect alarm 191");
    // The wheel coasts for a minute anyway; the headstock stops.
    tell(&mut rig, "expect output headstock-high off\nexpect output wheel on");
    tell(&mut rig, "key cycle-start\nexpect state held\ninput guard-closed on\nexpect no alarm");
    // The workpiece stands: going on would grind a flat.
    tell(&mut rig, "key cycle-start\nexpect state held\nexpect message \"头架\"\nkey headstock-high\nkey cycle-start");
    tell(&mut rig, "expect state running");
}

#[test]
fn k5_13_the_guard_opened_in_a_run_stops_an_axis_that_oscillates_until_the_run_goes_on() {
    let mut rig = ready_with("G35 Z-170 Q200\nG98 G01 U-4 F4\nG36\nM30");
    tell(
        &mut rig,
        "param P332 60\ninput guard-closed on\nmode auto\nkey cycle-start\nwait 2.2 s\nexpect state running",
    );
    let place = |rig: &HeadlessHost| rig.controller().set_point();
    let moving = place(&rig);
    tell(&mut rig, "input guard-closed off\nwait 1 s\nexpect state held\nexpect alarm 191");
    let at = place(&rig);
    assert!((at[Axis::Z] - moving[Axis::Z]).abs() > 1e-3, "Z moved before");
    // Neither time nor the closed door lets it move.
    tell(&mut rig, "wait 3 s\ninput guard-closed on\nwait 3 s\nexpect no alarm");
    assert_eq!(place(&rig), at);
    tell(&mut rig, "key cycle-start\nwait 1 s\nexpect state running\nexpect lamp oscillation on");
    assert!((place(&rig)[Axis::Z] - at[Axis::Z]).abs() > 1e-3);
    // RESET at rest ends it, too.
    tell(
        &mut rig,
        "input guard-closed off\nwait 1 s\ninput guard-closed on\nkey reset\nwait 1 s\nexpect lamp oscillation off",
    );
}

#[test]
fn k3_3_a_part_that_may_be_loose_stops_an_axis_that_oscillates() {
    let mut rig = ready_with("G35 Z-170 Q200\nG98 G01 U-4 F4\nG36\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 2.2 s\nexpect state running\nexpect lamp oscillation on");
    tell(&mut rig, "input tailstock-advanced off\nwait 1 s\nexpect alarm 201\nexpect lamp oscillation off");
    let at = rig.controller().set_point();
    tell(&mut rig, "wait 2 s");
    assert_eq!(rig.controller().set_point(), at);
}

#[test]
fn k5_14_missing_coolant_flow_holds_the_program_and_its_return_lets_it_go_on() {
    let mut rig = ready_with("M08\nG98 G01 X-200 F60\nM30");
    // P83: 3 s of missing flow; without coolant on the switch does not matter.
    tell(
        &mut rig,
        "param P333 60\ninput coolant-flow off\nwait 5 s\nexpect no alarm\nmode auto\nkey cycle-start\nwait 2.8 s\nexpect no alarm",
    );
    tell(&mut rig, "wait 0.4 s\nexpect alarm 192\nexpect state held\nexpect output coolant on");
    tell(&mut rig, "key cycle-start\nexpect state held\ninput coolant-flow on\nexpect no alarm\nkey cycle-start");
    tell(&mut rig, "expect state running");
}

#[test]
fn k5_14_a_low_lubrication_level_is_an_alarm_after_its_delay() {
    let mut rig = ready_with("G98 G01 X-200 F60\nM30");
    tell(
        &mut rig,
        "param P334 61\ninput lubrication-level off\nwait 4.8 s\nexpect no alarm\nwait 0.4 s\nexpect alarm 193",
    );
    tell(&mut rig, "mode auto\nkey cycle-start\nexpect output wheel off\ninput lubrication-level on\nexpect no alarm");
    tell(&mut rig, "key cycle-start\nexpect state running\ninput lubrication-level off\nwait 5.2 s\nexpect state held");
}

#[test]
fn k5_14_lubrication_runs_by_interval_and_time() {
    // Every minute for 10 s (P85, P86).
    let mut rig = story("param P85 1\nparam P86 10\nwait 59 s\nexpect output lubrication off\nwait 2 s");
    tell(&mut rig, "expect output lubrication on\nexpect lamp lubrication on\nwait 10 s");
    tell(&mut rig, "expect output lubrication off\nwait 50 s\nexpect output lubrication on");
    tell(&mut rig, "key lubrication\nexpect output lubrication off");
}

#[test]
fn k5_15_the_tower_light_shows_the_state() {
    let mut rig = ready_with("G98 G01 X-200 F60\nM30");
    tell(&mut rig, "expect output tower-green off\nmode auto\nkey cycle-start\nexpect output tower-green on");
    tell(&mut rig, "key feed-hold\nwait 0.5 s\nexpect output tower-yellow on\nexpect output tower-green off");
    tell(&mut rig, "key emergency-stop\nwait 0.5 s\nexpect output tower-red on\nexpect output tower-yellow off");
}

#[test]
fn k5_17_after_a_wheel_change_the_first_program_is_a_dressing_program() {
    let mut rig = ready_with("G04 X5\nM30");
    rig.add_program(kt830::host::folders::program_from_bytes(
        1_011,
        "O1011.NC",
        b"G04 X1\nM30".to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "param P6.7 1\nmode auto\nkey cycle-start\nexpect state idle\nexpect message \"修整\"");
    tell(&mut rig, "load O1011\nkey cycle-start\nexpect state running\nwait until idle max 5 s");
    tell(&mut rig, "load O7000\nkey cycle-start\nexpect state running");
}

#[test]
fn k3_11_p16_0_takes_no_port_that_is_in_use() {
    // The ports of 充磁 (P304) and 退磁 (P305) are free until the magnet is fitted.
    for row in [304, 305] {
        let mut rig = story_on(Kind::Gc, "expect no alarm");
        let port = rig.snapshot().params.read(ParamAddress { number: row, bit: None }).unwrap();
        tell(&mut rig, &format!("param P301 {port}\nmode jog\nkey coolant\nexpect output coolant on"));
        assert!(refused(&mut rig, "param P16.0 1").contains("先关闭"), "P{row}");
        tell(&mut rig, "expect output coolant on\nkey coolant\nexpect output coolant off\nparam P301 2\nparam P16.0 1");
        tell(&mut rig, "mdi M94\nwait 1.2 s\nexpect no alarm\nexpect output magnetise on");
        // With the magnet on, it stays.
        assert!(refused(&mut rig, "param P16.0 0").contains("先关闭"));
    }
}

#[test]
fn k3_11_the_magnet_cases() {
    for (kind, drive) in [(Kind::Gs, "dresser-roll"), (Kind::Ga, "table-rotation")] {
        // From a cold start: hydraulics, then the wheel needs the magnet (P16.1), its second included (P81).
        let mut rig =
            story_on(kind, "key hydraulic\nwait 4 s\nkey wheel-start\nexpect alarm 187\nexpect output wheel off");
        tell(&mut rig, "key reset\nexpect no alarm\nkey magnetise\nexpect output magnetise on\nkey wheel-start");
        tell(&mut rig, "expect alarm 187\nkey reset\nwait 1.1 s\nkey wheel-start\nexpect output wheel on");
        // The magnet stays as long as the wheel runs: neither demagnetised nor switched off.
        tell(&mut rig, "key demagnetise\nexpect alarm 187\nexpect output magnetise on\nexpect output demagnetise off");
        tell(&mut rig, "key reset\nkey magnetise\nexpect alarm 187\nexpect output magnetise on\nkey reset");
        // The emergency stop takes the wheel, not the part.
        tell(&mut rig, "key emergency-stop\nexpect output wheel off\nexpect output magnetise on");
        tell(&mut rig, "key emergency-stop\nkey reset\nexpect no alarm");
        tell(&mut rig, &format!("key {drive}\nexpect output {drive} on\nkey demagnetise"));
        if kind == Kind::Ga {
            tell(&mut rig, "expect alarm 187\nexpect output magnetise on\nkey reset\nkey demagnetise");
        }
        // Six seconds of reversals (P82), then both outputs are off.
        tell(&mut rig, "expect output magnetise off\nwait 5.8 s\nexpect output demagnetise on\nwait 0.3 s");
        tell(&mut rig, "expect output demagnetise off\nexpect no alarm");
    }
}

#[test]
fn k3_11_the_table_turns_magnetised_only() {
    let mut rig = story_on(Kind::Ga, "key hydraulic\nwait 4 s\nkey table-rotation\nexpect alarm 187");
    tell(&mut rig, "expect output table-rotation off\nkey reset\nkey magnetise\nwait 1.1 s\nkey table-rotation");
    tell(&mut rig, "expect output table-rotation on\nexpect no alarm");
}

#[test]
fn k4_5_a_gauge_arm_whose_switch_does_not_come_is_an_alarm() {
    // Watched only where its switch is assigned (P337); P80 = 3 s.
    let mut rig = story(&format!("{HYDRAULICS}key radial-gauge\nwait 5 s\nexpect no alarm\nkey radial-gauge"));
    tell(
        &mut rig,
        "param P337 60\nwait 0.1 s\ninput radial-arm-out off\nkey radial-gauge\nwait 2.8 s\nexpect no alarm",
    );
    tell(&mut rig, "wait 0.4 s\nexpect alarm 189");
}

#[test]
fn b4_gears_wait_for_their_switch_where_they_have_one() {
    let mut rig = ready_with("M41\nM42\nM00\nM30");
    tell(
        &mut rig,
        "param P350 60\nparam P351 61\ninput gear-1-in off\ninput gear-2-in off\nmode auto\nkey cycle-start",
    );
    tell(&mut rig, "wait 1 s\nexpect output gear-1 on\nexpect state running\ninput gear-1-in on\nwait 0.1 s");
    tell(&mut rig, "expect output gear-1 off\nexpect output gear-2 on\nwait 2.1 s\nexpect alarm 194");
}

#[test]
fn b4_the_second_spindle_pauses_before_it_reverses() {
    let mut rig = ready_with("M26\nM27\nM00\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.5 s");
    // P87: 1 s between the directions, never both.
    tell(&mut rig, "expect output second-spindle off\nexpect output second-spindle-ccw off\nexpect state running");
    tell(&mut rig, "wait 0.7 s\nexpect output second-spindle-ccw on\nexpect state stopped\nkey second-spindle");
    tell(&mut rig, "expect output second-spindle-ccw off\nkey second-spindle\nexpect output second-spindle on");
}

#[test]
fn b4_m20_pulses_a_free_port_for_its_milliseconds() {
    let mut rig = ready_with("M20 P40 L500\nM00\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start");
    let level = |rig: &HeadlessHost| rig.controller().outputs().terminals.is_closed(40);
    let mut lasted = 0;
    for _ in 0..1_000 {
        rig.step();
        lasted += u32::from(level(&rig));
    }
    // Two to fifty ticks went by while the key was answered.
    assert!((450..=500).contains(&lasted), "{lasted} ms");
    tell(&mut rig, "expect state stopped");
    assert!(!level(&rig));
    // RESET ends a pulse.
    let mut rig = ready_with("M20 P40 L5000\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 0.2 s");
    assert!(level(&rig));
    tell(&mut rig, "key reset");
    assert!(!level(&rig));
}

#[test]
fn k6_1_two_functions_on_one_port_do_nothing_and_say_so() {
    let mut rig = ready();
    tell(&mut rig, "mode jog\nparam P301 1\nkey coolant\nexpect message \"同一个输出口\"\nexpect output coolant off");
    assert!(!rig.controller().outputs().terminals.is_closed(1));
    tell(&mut rig, "key wheel-start\nexpect message \"同一个输出口\"\nexpect output wheel off");
    // The port of an output that is on is not taken from under it.
    tell(&mut rig, "param P301 2\nkey coolant\nexpect output coolant on");
    assert!(refused(&mut rig, "param P300 2").contains("先关闭"));
    assert!(rig.snapshot().outputs.has(Output::Coolant) && !rig.snapshot().outputs.has(Output::Wheel));
    assert!(refused(&mut rig, "param P301 9").contains("先关闭"));
    tell(&mut rig, "expect output coolant on");
}

#[test]
fn k6_1_a_port_out_of_range_is_refused() {
    let mut rig = ready();
    assert!(refused(&mut rig, "param P301 65").contains("P301"));
    tell(&mut rig, "mode jog\nkey coolant\nexpect output coolant on");
    assert!(rig.controller().outputs().terminals.is_closed(2));
}

#[test]
fn b5_machine_lock_counts_the_positions_and_moves_nothing() {
    let mut rig = ready_with("G98 G00 X-120 Z-40\nM30");
    let before = rig.machine().slide_mm();
    tell(
        &mut rig,
        "mode auto\nkey machine-lock\nexpect lamp machine-lock on\nkey cycle-start\nwait until idle max 30 s",
    );
    tell(&mut rig, "expect X -120 ±0.001\nexpect Z -40 ±0.001");
    assert_eq!(rig.machine().slide_mm(), before);
    tell(&mut rig, "key machine-lock\nexpect lamp machine-lock off\nwait 1 s\nexpect no alarm");
    assert_eq!(rig.machine().slide_mm(), before);
}

#[test]
fn b5_mst_lock_leaves_codes_out_and_keeps_the_flow() {
    let mut rig = ready_with("M03\nM08\nM80\nM31\nM00\nM30");
    tell(&mut rig, "mode auto\nkey mst-lock\nkey cycle-start\nwait until stopped max 2 s");
    tell(&mut rig, "expect output wheel off\nexpect output coolant off");
    assert_eq!(rig.snapshot().parts_counted, 1);
}

#[test]
fn b5_dry_run_moves_at_its_own_feed_with_the_wheel_off() {
    // 60 mm of slide at 6 mm/min would take ten minutes; at P89 = 3000 mm/min 1.2 s and the ramps.
    let mut rig = ready_with("M03\nG98 G01 W-60 F6\nM30");
    tell(&mut rig, "mode auto\nkey dry-run\nkey cycle-start\nexpect output wheel off\nexpect message \"空运行\"");
    tell(
        &mut rig,
        "wait until idle max 3 s\nexpect output wheel off\nkey dry-run\nmode jog\nkey wheel-start\nmode auto",
    );
    tell(&mut rig, "key dry-run\nkey cycle-start\nexpect state idle\nexpect message \"先停砂轮\"");
}

#[test]
fn b5_external_start_and_hold_act_as_the_keys_do() {
    let mut rig = ready_with("G98 G01 X-200 F60\nM30");
    tell(&mut rig, "param P335 60\nparam P336 61\nmode auto\ninput external-start on\nexpect state running");
    tell(&mut rig, "input external-start off\ninput external-hold on\nwait 0.3 s\nexpect state held");
    tell(&mut rig, "key cycle-start\nexpect state held\nexpect message \"外接暂停\"\ninput external-hold off");
    tell(&mut rig, "key cycle-start\nexpect state running");
}

/// RESET voids every start of its tick (B5), also the one from outside that comes after it in the tick.
#[test]
fn b5_reset_voids_an_external_start_of_its_tick() {
    let pressed = || {
        let mut rig = ready_with("G98 G01 X-200 F60\nM30");
        tell(&mut rig, "param P335 60\nmode auto");
        rig.send(Command::Simulate(SimCommand::Force(Input::ExternalStart, Some(true))));
        rig
    };
    let mut rig = pressed();
    let ticks = (1..100).find(|_| {
        rig.step();
        rig.controller().state() == RunState::Running
    });
    let mut rig = pressed();
    (1..ticks.unwrap()).for_each(|_| rig.step());
    assert_eq!(rig.controller().state(), RunState::Idle);
    rig.send(Command::Press(Key::Reset));
    rig.step();
    tell(&mut rig, "expect message \"启动无效\"\nwait 0.2 s\nexpect state idle");
}

#[test]
fn p2_a_speed_above_the_wheels_rating_is_refused_at_the_start_and_not_reached_later() {
    // 600 mm: 35 m/s are 35 × 60 / (π × 0.6) = 1114.1 rpm; 10 V are 1260 rpm, so 8.842 V.
    let mut rig = ready_with("M03\nS1200\nM00\nM05\nS1200\nM03\nM30");
    tell(&mut rig, "param P61 100\nparam P79 35\nmode auto\nkey cycle-start\nwait until stopped max 5 s");
    tell(&mut rig, "expect message \"额定\"\nexpect output wheel on");
    assert!((rig.controller().outputs().wheel_volts - 8.842).abs() < 0.001);
    tell(&mut rig, "key cycle-start\nwait until alarm max 5 s\nexpect alarm 186\nexpect output wheel off");
}

#[test]
fn b2_s_is_revolutions_or_metres_a_second_by_parameter() {
    // 30 m/s at 600 mm are 954.93 rpm: 7.579 V of 10 V at 1260 rpm. G96 S in m/min: 1800 m/min are the same 30 m/s.
    for (setup, text) in [("param P5.3 1\n", "S30\nM03\nM00\nM30"), ("", "G96 S1800\nM03\nM00\nM30")] {
        let mut rig = ready_with(text);
        tell(&mut rig, &format!("{setup}param P61 100\nmode auto\nkey cycle-start\nwait until stopped max 5 s"));
        let volts = rig.controller().outputs().wheel_volts;
        assert!((volts - 7.579).abs() < 0.001, "{volts}");
    }
}

#[test]
fn b5_the_emergency_stop_with_machine_lock_in_a_run_stops_and_shows_the_real_positions() {
    let mut rig = ready_with("G98 G01 W-100 F3000\nM30");
    tell(
        &mut rig,
        "mode auto\nkey machine-lock\nkey cycle-start\nwait 1 s\nkey emergency-stop\nwait 0.5 s\nexpect alarm 0",
    );
    tell(
        &mut rig,
        "expect Z -150 ±0.001\nexpect lamp machine-lock off\nkey emergency-stop\nkey reset\nexpect no alarm",
    );
}

#[test]
fn b8_after_a_stop_of_everything_nothing_starts_before_reset() {
    for cause in ["key emergency-stop\nkey emergency-stop", "fault drive-X", "fault bus-silent 5"] {
        let mut rig = ready();
        tell(&mut rig, &format!("mode jog\n{cause}\nwait 0.1 s\nexpect alarm any"));
        for key in ["wheel-start", "headstock-high", "second-spindle", "coolant"] {
            tell(&mut rig, &format!("key {key}\nexpect message \"复位\""));
        }
        tell(&mut rig, "expect output wheel off\nexpect output headstock-high off\nexpect output coolant off");
    }
}

#[test]
fn k6_1_a_tower_lamp_on_the_wheels_port_never_switches_the_wheel() {
    let mut rig = ready();
    tell(
        &mut rig,
        "param P312 1\nmode jog\nkey emergency-stop\nwait 0.1 s\nexpect alarm 0\nexpect output tower-red off",
    );
    assert!(!rig.controller().outputs().terminals.is_closed(1));
    let mut rig = ready();
    tell(&mut rig, "param P302 1\nparam P85 1\nwait 61 s\nexpect output lubrication off");
    assert!(!rig.controller().outputs().terminals.is_closed(1));
}

#[test]
fn k6_3_a_detent_and_cycle_start_in_one_tick_leave_nothing_to_move_later() {
    use kt830::defs::key::Key;
    use kt830::link::command::Command;
    let mut rig = ready_with("G98 G01 W-10 F300\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 1 s\nkey feed-hold\nwait 0.3 s\nhandwheel X 1 x0.1");
    rig.send(Command::Handwheel(-50));
    rig.send(Command::Press(Key::CycleStart));
    tell(&mut rig, "wait until idle max 10 s\nexpect X -79.9 ±0.001\nwait 2 s\nexpect X -79.9 ±0.001");
}

#[test]
fn b5_a_program_begins_once_the_jogged_axis_stands() {
    use kt830::defs::key::{Key, Mode};
    use kt830::link::command::Command;
    let mut rig = ready_with("G98 G00 W-5\nM30");
    tell(&mut rig, "mode jog\nkey rapid\nhold Z- 0.5 s\npress z-minus\nwait 0.15 s");
    rig.send(Command::Release(Key::ZMinus));
    rig.send(Command::Press(Mode::Auto.key()));
    rig.send(Command::Press(Key::CycleStart));
    // 10 m/min are 0.167 mm a tick; at 800 mm/s² a tick changes that by 0.0008 mm, at full braking by four times as much.
    let mut at = rig.controller().set_point();
    let mut step = None;
    for _ in 0..3_000 {
        rig.step();
        let now = rig.controller().set_point();
        let moved = now[kt830::units::Axis::Z] - at[kt830::units::Axis::Z];
        if let Some(before) = step.replace(moved) {
            assert!((moved - before).abs() < 0.004, "from {before} to {moved} mm a tick");
        }
        at = now;
    }
    tell(&mut rig, "expect state idle\nexpect no alarm");
}

#[test]
fn b5_homing_does_not_run_further_onto_a_pressed_limit_switch() {
    let mut rig = story(
        "mode home\ninput limit-x-plus on\nkey reset\nmode home\nkey x-plus\nwait 0.5 s\nexpect machine X 0 ±0.01",
    );
    tell(&mut rig, "expect message \"限位方向\"");
}

#[test]
fn k5_14_an_alarm_that_holds_does_not_reach_into_the_next_program() {
    let mut rig = ready_with("G98 G01 W-5 F600\nM30");
    tell(
        &mut rig,
        "param P334 61\ninput lubrication-level off\nwait 6 s\nexpect alarm 193\ninput lubrication-level on",
    );
    tell(&mut rig, "expect no alarm\nmode auto\nkey cycle-start\nwait until idle max 5 s\nexpect Z -155 ±0.001");
}

#[test]
fn k3_14_a_unit_switched_by_key_in_a_hold_is_asked_again() {
    // The wheel is stopped while M03 waits: cycle start starts it again, the program does not go on without it.
    let mut rig = ready_with("M03\nM00\nM30");
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 2 s\nkey feed-hold\nkey wheel-stop\nkey cycle-start");
    tell(&mut rig, "expect output wheel on\nwait until stopped max 12 s\nexpect output wheel on");
    let mut rig = ready_with("M11\nM10\nM00\nM30");
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait 1.3 s\nkey feed-hold\nkey tailstock-retract\nwait 2 s\nkey cycle-start",
    );
    tell(&mut rig, "wait until stopped max 12 s\nexpect output tailstock on");
}

#[test]
fn k3_3_a_tailstock_that_loses_its_switch_stops_the_headstock_and_says_so() {
    let mut rig = ready();
    tell(
        &mut rig,
        "mode jog\nkey headstock-low\nwait 1 s\nfault stuck-off tailstock-advanced\nwait 0.1 s\nexpect alarm 201",
    );
    tell(
        &mut rig,
        "expect output headstock-low off\nkey reset\nkey headstock-low\nexpect output headstock-low off\nexpect alarm 184",
    );
}

#[test]
fn k5_17_only_a_real_dressing_run_counts() {
    let mut rig = ready();
    rig.add_program(kt830::host::folders::program_from_bytes(
        1_011,
        "O1011.NC",
        b"G04 X1\nM30".to_vec(),
        rig.kind().dialect(),
    ));
    tell(
        &mut rig,
        "load O1011\nparam P6.7 1\nmdi M30\nwait 0.5 s\nmode auto\nkey machine-lock\nkey cycle-start\nwait 2 s",
    );
    tell(&mut rig, "key machine-lock\nload O1002\nkey cycle-start\nexpect state idle\nexpect message \"修整\"");
}

#[test]
fn k3_13_an_input_without_a_port_is_an_alarm() {
    let mut rig = ready_with("M80\nM30");
    tell(&mut rig, "param P279 0\nmode auto\nkey cycle-start\nwait until alarm max 1 s\nexpect alarm 202");
}

#[test]
fn k2_4_a_function_without_a_port_lights_nothing() {
    let mut rig = ready();
    tell(&mut rig, "mode jog\nparam P301 0\nkey coolant\nexpect lamp coolant off\nexpect message \"没有分配\"");
    let mut rig = ready_with("M08\nM03\nM00\nM30");
    tell(
        &mut rig,
        "param P301 0\nparam P61 100\nmode auto\nkey cycle-start\nwait until stopped max 3 s\nexpect output wheel on",
    );
}

#[test]
fn b5_an_mdi_line_may_switch_before_homing_and_not_move() {
    let mut rig = story(
        "mdi M14\nwait 0.2 s\nexpect output hydraulic on\nexpect no alarm\nmdi G00 X1\nwait 0.2 s\nexpect alarm 100",
    );
    tell(&mut rig, "expect machine X 0 ±0.01");
}

#[test]
fn k6_1_ports_are_whole_numbers_and_are_not_moved_under_a_turning_wheel() {
    let mut rig = story(HYDRAULICS);
    assert!(refused(&mut rig, "param P300 1.5").contains("整数"));
    tell(&mut rig, "key wheel-start\nexpect output wheel on");
    assert!(refused(&mut rig, "param P320 0").contains("先关闭"));
    tell(&mut rig, "input emergency-stop on\nexpect output wheel off");
}

/// tools.md: `release`/`press` for the halves. P65 = 1000 mm/min for 3 s are 50 mm of slide, 100 mm of diameter.
#[test]
fn k2_1_a_key_that_a_story_presses_stays_held_until_it_is_let_go() {
    let mut rig = story("power on\nhome all\nmode jog\nexpect machine X 0 ±0.01");
    tell(&mut rig, "press x-minus\nwait 3 s\nrelease x-minus\nexpect machine X -100 ±5");
    let at = rig.snapshot().axes.0[0].machine;
    tell(&mut rig, &format!("wait 1 s\nexpect machine X {at} ±2"));
    // Two at once: the other axis goes on when one is let go. A power cut takes every finger off.
    let z = |rig: &mut kt830::host::headless::HeadlessHost| rig.snapshot().axes.0[2].machine;
    let before = z(&mut rig);
    tell(&mut rig, "press x-minus\npress z-minus\nwait 1 s\nkey coolant\nwait 1 s\nrelease x-minus\nwait 1 s");
    assert!(!rig.snapshot().message.text.zh().contains("按键"), "no finger was lost");
    assert!((z(&mut rig) - before + 50.0).abs() < 2.5, "3 s at 1000 mm/min");
    tell(&mut rig, "wait 1 s\npress z-minus\nwait 1 s\npower cut\npower on\nmode jog\nwait 0.1 s");
    let before = z(&mut rig);
    tell(&mut rig, &format!("wait 1 s\nexpect machine Z {before} ±0.01"));
    // The end of the story lets go, without the message of a lost finger.
    tell(&mut rig, "press z-minus\nwait 0.5 s");
    let before = rig.snapshot().message.clone();
    (0..1_000).for_each(|_| rig.step());
    assert_eq!(rig.snapshot().message, before);
    assert!(!rig.snapshot().axes[kt830::units::Axis::Z].moving);
}

/// K7.5, H6: the range that the field shows holds in the control, whoever types.
#[test]
fn k7_5_a_value_beyond_the_range_of_a_field_is_refused() {
    let mut rig = story("kind gc\npower on\nload O1001\npage grinding\ntype #500 12.5");
    for typed in ["123456789", "-100000", "99999.9995"] {
        tell(&mut rig, &format!("type #500 {typed}\nwait 0.1 s\nexpect message \"99999.999\"\nexpect #500 12.5"));
    }
    tell(&mut rig, "type #500 -99999.999\nwait 0.1 s\nexpect #500 -99999.999");
}
