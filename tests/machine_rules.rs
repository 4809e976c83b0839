//! The rules of the machine (K2, K3, K5) as stories on the simulated cylindrical grinder.

mod told;

use told::{ready, ready_with, story, tell};

/// Hydraulics on, pressure there, its delay gone by, nothing homed.
const HYDRAULICS: &str = "key hydraulic\nwait 4 s\nexpect no alarm\n";

#[test]
fn k3_7_missing_pressure_after_power_on_is_alarm_180_from_p270_on() {
    // P270 = 3000 ms, then the tick that looks; the input has been off since power-on, so its filter adds nothing.
    let mut rig = story("wait 2.9 s\nexpect no alarm\nwait 0.2 s\nexpect alarm 180\nexpect state alarm");
    // It blocks wheel and cycle start, not homing or jogging, and goes by itself when the signal comes.
    tell(&mut rig, "key wheel-start\nexpect output wheel off\nmode jog\nhold X+ 0.5 s\nexpect state alarm");
    tell(&mut rig, "key hydraulic\nwait 4 s\nexpect no alarm");
}

#[test]
fn k3_7_a_deliberate_m15_brings_the_alarm_and_the_signal_takes_it_away() {
    let mut rig = story(HYDRAULICS);
    tell(&mut rig, "key hydraulic\nexpect output hydraulic off\nwait 4 s\nexpect alarm 180");
    tell(&mut rig, "key hydraulic\nwait 2 s\nexpect no alarm");
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
    assert_eq!(rig.snapshot().parts, 1);
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
    assert!(rig.snapshot().waiting_for.as_ref().is_some_and(|text| text.zh.contains("14")), "M81 waits for port 14");
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
    tell(&mut rig, "mode jog\npress X+\nwait 0.15 s");
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
}
