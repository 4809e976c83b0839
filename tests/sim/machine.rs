//! The machine around the wheel: switches, stops, spindles, hydraulics, faults (rows P1, P2, P3, P8).

use crate::bench::{Rig, cold, ready, ready_with};
use kt830::defs::signal::{Input, Output, Terminals};
use kt830::defs::sim_fault::FAULTS;
use kt830::io::Backend;
use kt830::io::sim::SimulatedMachine;
use kt830::units::{Axis, EncoderPos};

/// Cold machine with its drives on.
fn driven() -> Rig {
    let mut rig = cold();
    rig.out.drives_on = true;
    rig.step();
    rig
}

#[test]
fn p1_at_power_on_the_encoders_read_zero_somewhere_in_mid_travel() {
    let rig = cold();
    assert!(rig.seen.encoder_mm.coordinates().iter().all(|mm| mm.abs() <= 0.0));
    let zero = rig.sim.encoder_zero_mm();
    assert!((zero[Axis::X] + 40.0).abs() < 1e-9 && (zero[Axis::Z] + 150.0).abs() < 1e-9);
    for input in [Input::EmergencyStop, Input::LimitXPlus, Input::LimitZMinus, Input::DriveX, Input::HomeX] {
        assert!(!rig.input(input), "{}", input.id());
    }
    assert!(rig.input(Input::TailstockAdvanced) != rig.input(Input::TailstockRetracted));
}

#[test]
fn p1_the_home_switch_changes_at_machine_zero_and_bounces_five_milliseconds() {
    let mut rig = driven();
    rig.jog(Axis::X, 39.0, 50.0);
    rig.wait(0.2);
    assert!(!rig.input(Input::HomeX));
    let (mut first, mut course) = (None, Vec::new());
    for tick in 1..=2_000 {
        rig.out.set_point_mm[Axis::X] = 39.0 + 0.001 * f64::from(tick); // 60 mm/min
        rig.step();
        if rig.input(Input::HomeX) && first.is_none() {
            first = Some(rig.seen.encoder_mm[Axis::X]);
        }
        if first.is_some() {
            course.push(rig.input(Input::HomeX));
        }
    }
    // Machine 0 is encoder 40; a tick at 1 mm/s is 1 µm.
    assert!((first.unwrap() - 40.0).abs() <= 0.001_5, "{first:?}");
    assert!(course[..6].contains(&false), "it bounces");
    assert!(course[6..].iter().all(|on| *on), "and no longer than 5 ms");
}

#[test]
fn p1_limit_switch_comes_before_the_stop_and_the_stop_at_speed_is_a_crash() {
    let mut rig = driven();
    rig.jog(Axis::X, 46.5, 50.0);
    rig.wait(0.2);
    assert!(rig.input(Input::LimitXPlus) && rig.events().is_empty());
    rig.jog(Axis::X, 5.0, 50.0);
    assert_eq!(rig.sim.events()[0].place, "hard stop X+");
    assert!(rig.sim.events()[0].speed > 600.0);
    assert!(rig.sim.slide_mm()[Axis::X] <= 8.0 && rig.input(Input::DriveX));
}

#[test]
fn p1_without_drives_nothing_moves() {
    let mut rig = cold();
    rig.jog(Axis::X, 5.0, 50.0);
    assert!((rig.sim.slide_mm()[Axis::X] + 40.0).abs() < 1e-12);
}

#[test]
fn p2_the_workhead_has_two_speeds() {
    let mut rig = driven();
    rig.switch(Output::HeadstockHigh, true);
    rig.wait(1.4);
    assert!(rig.sim.workhead_rpm() < 200.0);
    rig.wait(0.2);
    assert!((rig.sim.workhead_rpm() - 200.0).abs() < 1e-9);
    rig.switch(Output::HeadstockHigh, false);
    rig.switch(Output::HeadstockLow, true);
    rig.wait(1.5);
    assert!((rig.sim.workhead_rpm() - 80.0).abs() < 1e-9);
}

#[test]
fn p3_pressure_tailstock_and_their_switches() {
    let mut rig = driven();
    rig.switch(Output::Hydraulic, true);
    rig.wait(1.0);
    assert!(!rig.input(Input::HydraulicPressure), "1.075 s to 2.5 MPa");
    rig.wait(0.1);
    assert!(rig.input(Input::HydraulicPressure));
    rig.switch(Output::Tailstock, true);
    rig.wait(1.1);
    assert!(rig.input(Input::TailstockAdvanced) && !rig.input(Input::TailstockRetracted));
    rig.switch(Output::Tailstock, false);
    rig.wait(0.5);
    assert!(!rig.input(Input::TailstockAdvanced) && !rig.input(Input::TailstockRetracted));
    rig.wait(0.6);
    assert!(rig.input(Input::TailstockRetracted));
}

#[test]
fn p3_a_ready_machine_has_pressure_and_its_tailstock_advanced() {
    let mut rig = ready(1002);
    assert!(rig.input(Input::HydraulicPressure) && rig.input(Input::TailstockAdvanced));
    rig.wait(1.0);
    assert!(rig.input(Input::HydraulicPressure) && rig.input(Input::TailstockAdvanced));
    // X100 Z29: machine -230 + 50, -400 + 29.
    let stands = rig.sim.slide_mm();
    assert!((stands[Axis::X] + 180.0).abs() < 1e-9 && (stands[Axis::Z] + 371.0).abs() < 1e-9);
}

#[test]
fn p8_pressure_loss_drops_the_switch_in_two_tenths_of_a_second() {
    let mut rig = ready(1002);
    rig.sim.inject_fault("pressure-loss").unwrap();
    // 0.6·ln(3/2.2) = 0.186 s.
    rig.wait(0.15);
    assert!(rig.input(Input::HydraulicPressure));
    rig.wait(0.1);
    assert!(!rig.input(Input::HydraulicPressure));
    rig.sim.clear_fault("pressure-loss").unwrap();
    rig.wait(1.2);
    assert!(rig.input(Input::HydraulicPressure));
}

#[test]
fn p8_a_drive_fault_tells_and_stops_its_axis_only() {
    let mut rig = driven();
    rig.sim.inject_fault("drive-x").unwrap();
    rig.jog(Axis::X, -1.0, 50.0);
    rig.jog(Axis::Z, -1.0, 50.0);
    rig.wait(0.2);
    assert!(rig.input(Input::DriveX) && !rig.input(Input::DriveZ));
    assert!(rig.seen.encoder_mm[Axis::X].abs() < 0.002);
    assert!((rig.seen.encoder_mm[Axis::Z] + 1.0).abs() < 1e-9);
}

#[test]
fn p8_an_axis_that_does_not_follow_tells_nothing() {
    let mut rig = driven();
    rig.sim.inject_fault("following-z").unwrap();
    rig.jog(Axis::Z, -10.0, 50.0);
    assert!(!rig.input(Input::DriveZ), "the control has to see it from the encoder");
    assert!(rig.seen.encoder_mm[Axis::Z].abs() < 0.002, "{}", rig.seen.encoder_mm[Axis::Z]);
}

#[test]
fn p8_switches_stick_and_chatter() {
    let mut rig = driven();
    rig.sim.inject_fault("stuck-on home-x").unwrap();
    rig.step();
    assert!(rig.input(Input::HomeX));
    rig.sim.clear_fault("stuck-on home-x").unwrap();
    rig.sim.inject_fault("bounce tailstock-retracted").unwrap();
    let (mut on, mut off) = (0, 0);
    for _ in 0..100 {
        rig.step();
        if rig.input(Input::TailstockRetracted) { on += 1 } else { off += 1 }
    }
    assert!(on > 20 && off > 20 && !rig.input(Input::HomeX), "{on} {off}");
}

#[test]
fn p8_a_forced_input_goes_before_the_machine_and_a_fault() {
    let mut rig = ready(1002);
    rig.sim.inject_fault("stuck-on hydraulic-pressure").unwrap();
    rig.sim.force_input("hydraulic-pressure", Some(false)).unwrap();
    rig.step();
    assert!(!rig.input(Input::HydraulicPressure));
    rig.sim.force_input("hydraulic-pressure", None).unwrap();
    rig.sim.force_input("13", Some(true)).unwrap();
    rig.step();
    assert!(rig.input(Input::HydraulicPressure) && rig.input(Input::User1));
    assert!(rig.sim.force_input("wheel", Some(true)).is_err());
    assert!(rig.sim.force_input("65", Some(true)).is_err());
}

#[test]
fn p8_a_silent_bus_keeps_the_last_image_and_hears_nothing() {
    let mut rig = driven();
    rig.jog(Axis::Z, -1.0, 50.0);
    let before = rig.seen;
    rig.sim.inject_fault("bus-silent 3").unwrap();
    rig.out.terminals.set(10, true);
    for _ in 0..3 {
        rig.step();
        assert!(!rig.seen.bus_alive);
        assert_eq!(rig.seen.encoder_mm, before.encoder_mm);
    }
    assert!(rig.sim.pressure_mpa() <= 0.0, "the hydraulic output never arrived");
    rig.step();
    rig.step();
    assert!(rig.seen.bus_alive && rig.seen.encoder_mm != before.encoder_mm);
    assert!(rig.sim.pressure_mpa() > 0.0);
}

#[test]
fn p8_a_late_bus_answers_a_tick_late() {
    let mut rig = driven();
    rig.sim.inject_fault("bus-late 5").unwrap();
    let mut alive = Vec::new();
    for tick in 1..=8 {
        rig.out.set_point_mm[Axis::Z] = -0.5 * f64::from(tick);
        rig.step();
        alive.push(rig.seen.bus_alive);
    }
    assert_eq!(alive, [false, true, true, true, true, true, true, true]);
    rig.wait(0.3);
    assert!((rig.seen.encoder_mm[Axis::Z] + 4.0).abs() < 1e-9, "nothing was lost");
}

#[test]
fn p8_supply_loss_makes_every_terminal_low() {
    let mut rig = ready(1002);
    rig.sim.inject_fault("supply-loss").unwrap();
    rig.step();
    assert_eq!(rig.seen.terminals, Terminals(0));
    assert!(rig.input(Input::EmergencyStop) && rig.input(Input::LimitXPlus), "broken wires stop the machine");
    rig.sim.clear_fault("supply-loss").unwrap();
    rig.step();
    assert!(!rig.input(Input::EmergencyStop));
}

#[test]
fn p8_an_unknown_fault_is_refused() {
    let mut rig = cold();
    assert!(rig.sim.inject_fault("earthquake").is_err());
    assert!(rig.sim.inject_fault("stuck-on wheel").is_err());
}

#[test]
fn p1_the_machines_own_handwheel_arrives_once() {
    let mut rig = cold();
    rig.sim.turn_handwheel(3);
    rig.step();
    assert_eq!(rig.seen.handwheel_detents, 3);
    assert_eq!(rig.sim.read(rig.now).handwheel_detents, 0);
}

#[test]
fn p8_whatever_the_control_does_the_machine_stays_in_its_bounds() {
    let mut rig = ready(1002);
    let mut bits = 0x9E37_79B9_7F4A_7C15_u64;
    for tick in 0..60_000 {
        // xorshift64: wild set-points and outputs, drives mostly on.
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        if tick % 40 == 0 {
            rig.out.terminals = Terminals(bits);
            rig.out.drives_on = bits & 0xF != 0;
            rig.out.wheel_volts = (bits >> 8 & 0xF) as f64 - 2.0;
            let wild = [(bits >> 16 & 0x3FF) as f64 - 500.0, f64::NAN, (bits >> 32 & 0x7FF) as f64 - 1_200.0];
            rig.out.set_point_mm = EncoderPos::new(if bits & 0xF0 == 0 { [f64::NAN; 3] } else { wild });
        }
        rig.tick.0 = [500, 1_000, 4_000, 30_000][(bits >> 60) as usize % 4];
        rig.step();
        let (slide, wheel) = (rig.sim.slide_mm(), rig.sim.wheel());
        assert!((-308.0..=8.0).contains(&slide[Axis::X]) && (-908.0..=8.0).contains(&slide[Axis::Z]), "{slide:?}");
        assert!(rig.seen.encoder_mm.coordinates().iter().all(|mm| mm.is_finite()));
        assert!((0.0..=1_260.0).contains(&wheel.rpm) && wheel.diameter_mm > 500.0 && wheel.load_percent.is_finite());
        assert!(rig.sim.measure().diameters.iter().all(|at| (0.0..=40.4).contains(&at.d)));
    }
    assert!(!rig.events().is_empty());
}

fn run(rig: &mut Rig, ticks: u32) {
    (0..ticks).for_each(|_| rig.step());
}

#[test]
fn p3_pressure_comes_after_its_time_constant() {
    let mut rig = cold();
    rig.switch(Output::Hydraulic, true);
    // 2.5 of 3.0 MPa: 0.6·ln(3/0.5) = 1.075 s.
    run(&mut rig, 1_074);
    assert!(!rig.input(Input::HydraulicPressure));
    run(&mut rig, 2);
    assert!(rig.input(Input::HydraulicPressure));
    run(&mut rig, 10_000);
    rig.sim.inject_fault("pressure-loss").unwrap();
    // Down to 2.2: 0.6·ln(3/2.2) = 0.186 s.
    run(&mut rig, 185);
    assert!(rig.input(Input::HydraulicPressure));
    run(&mut rig, 3);
    assert!(!rig.input(Input::HydraulicPressure));
}

#[test]
fn p3_the_tailstock_takes_a_second_and_needs_pressure() {
    let ends = |rig: &Rig| (rig.input(Input::TailstockAdvanced), rig.input(Input::TailstockRetracted));
    let mut rig = cold();
    rig.switch(Output::Tailstock, true);
    run(&mut rig, 3_000);
    assert_eq!(ends(&rig), (false, true), "no pressure, no movement");
    // With pressure, retracted; it has moved for one tick.
    let mut rig = ready_with(1002, |_, part| part.tailstock_advanced = false);
    run(&mut rig, 997);
    assert_eq!(ends(&rig), (false, false));
    run(&mut rig, 10);
    assert_eq!(ends(&rig), (true, false));
}

#[test]
fn p3_the_oscillation_cylinder_runs_at_two_tenths_of_a_metre_a_second() {
    let mut rig = cold();
    rig.switch(Output::OscillationForward, true);
    run(&mut rig, 490);
    assert!(!rig.input(Input::OscillationForwardEnd));
    run(&mut rig, 20);
    assert!(rig.input(Input::OscillationForwardEnd) && !rig.input(Input::OscillationBackwardEnd));
}

#[test]
fn p2_a_voltage_sets_the_speed_and_none_is_the_mains() {
    let mut rig = cold();
    let wheel_rpm = |rig: &mut Rig, volts: f64| {
        rig.out.wheel_volts = volts;
        rig.switch(Output::Wheel, true);
        rig.wait(60.0);
        rig.sim.wheel().rpm
    };
    assert!((wheel_rpm(&mut rig, 5.0) - 630.0).abs() < 1e-9);
    assert!((wheel_rpm(&mut rig, 0.0) - 1_000.0).abs() < 1e-9);
    rig.out.wheel_volts = 5.0;
    rig.switch(Output::Wheel, false);
    rig.wait(61.0);
    assert!(rig.sim.wheel().rpm <= 0.0);
    rig.out.analog_2_volts = 0.5;
    rig.switch(Output::HeadstockLow, true);
    rig.wait(2.0);
    assert!((rig.sim.workhead_rpm() - 30.0).abs() < 1e-9, "15 rpm is below its least");
    rig.out.analog_2_volts = 0.0;
    rig.switch(Output::HeadstockLow, false);
    rig.switch(Output::HeadstockHigh, true);
    rig.wait(2.0);
    assert!((rig.sim.workhead_rpm() - 200.0).abs() < 1e-9);
}

#[test]
fn p2_the_second_spindle_turns_both_ways_and_neither_at_once() {
    let mut rig = cold();
    rig.switch(Output::SecondSpindle, true);
    run(&mut rig, 1_000);
    assert!((rig.sim.second_spindle_rpm() - 1_500.0).abs() < 1e-6);
    // Down to rest and up the other way: 2 s. The change of the outputs takes a tick.
    rig.out.terminals.set(rig.params.output_port(Output::SecondSpindle), false);
    rig.switch(Output::SecondSpindleCcw, true);
    run(&mut rig, 1_990);
    assert!(rig.sim.second_spindle_rpm() < 0.0 && rig.sim.second_spindle_rpm() > -1_500.0);
    run(&mut rig, 11);
    assert!((rig.sim.second_spindle_rpm() + 1_500.0).abs() < 1e-6);
    rig.switch(Output::SecondSpindle, true);
    run(&mut rig, 1_001);
    assert!(rig.sim.second_spindle_rpm().abs() <= 1e-9);
}

#[test]
fn p8_every_name_listed_can_be_said() {
    for row in FAULTS {
        let text = row.usage().replace("NAME", "home-x").replace(" N", " 3");
        assert!(SimulatedMachine::check_fault(&text).is_ok(), "{text}");
    }
    let mut rig = cold();
    rig.sim.inject_fault("Drive-X").unwrap();
    rig.step();
    assert!(rig.input(Input::DriveX) && !rig.input(Input::DriveZ));
}

#[test]
fn p8_a_wrong_fault_says_what_is_wrong() {
    let said = |text| SimulatedMachine::check_fault(text).unwrap_err().to_string();
    assert_eq!(said("earthquake"), "there is no fault 'earthquake'; `fault list` shows all of them");
    assert_eq!(said("stuck-on wheel"), "'wheel' is not the id of an input");
    assert_eq!(said("bus-late"), "'' is not a number of ticks from 1 to 1000000");
    assert_eq!(said("supply-loss now"), "'supply-loss' has no argument, but 'now' is given");
    assert_eq!(cold().sim.clear_fault("bus-late"), Ok(()), "the number is not needed to end a fault");
}
