//! What stands around the wheel on every kind of machine: spindles, magnet, cylinders, gauges, faults (rows P2, P3, P7,
//! P8), and an axis Y that is fitted (P6.6).

use crate::bench::{Rig, cold_of, connect, driven_of, program_of, ready, ready_wired, ready_with};
use kt830::defs::equipment::Equipment;
use kt830::defs::kind::Kind;
use kt830::defs::param::{self, ParamAddress, Params};
use kt830::defs::signal::{Input, Output, Terminals};
use kt830::io::sim::{EventKind, MachineFile, PartFile, SimulatedMachine};
use kt830::units::{Axis, EncoderPos};

/// Whether an input is on after so many seconds more.
fn after(rig: &mut Rig, seconds: f64, input: Input) -> bool {
    rig.wait(seconds);
    rig.input(input)
}

#[test]
fn p2_the_wheel_runs_up_and_coasts_on_every_kind() {
    for kind in Kind::kt830() {
        let mut rig = driven_of(kind);
        rig.switch(Output::Wheel, true);
        rig.wait(7.9);
        assert!(rig.sim.wheel().rpm < 1_000.0, "{kind:?}");
        rig.wait(0.2);
        assert!((rig.sim.wheel().rpm - 1_000.0).abs() < 1e-9, "{kind:?}");
        rig.switch(Output::Wheel, false);
        rig.wait(59.8);
        assert!(rig.sim.wheel().rpm > 0.0, "{kind:?}");
        rig.wait(0.3);
        assert!(rig.sim.wheel().rpm <= 0.0, "{kind:?}");
    }
}

#[test]
fn p2_a_wheel_above_its_rated_speed_is_an_event_once() {
    // 35 m/s over π·0.6: 1114 rpm; 30 over π·0.5: 1146 rpm; 10 V are 1260 rpm.
    for (kind, rpm) in [(Kind::Gc, 1_114.0), (Kind::Gs, 1_145.9), (Kind::Ga, 1_145.9)] {
        let mut rig = driven_of(kind);
        let wheel = rig.sim.wheel();
        let greatest = wheel.rated_m_s * 60_000.0 / (std::f64::consts::PI * wheel.diameter_mm);
        assert!((greatest - rpm).abs() < 0.2, "{kind:?}: {greatest}");
        rig.out.wheel_volts = (rpm - 3.0) / 126.0;
        rig.switch(Output::Wheel, true);
        rig.wait(12.0);
        assert_eq!(rig.events(), [], "{kind:?}");
        rig.out.wheel_volts = (rpm + 3.0) / 126.0;
        rig.wait(2.0);
        assert_eq!(rig.events(), [EventKind::Overspeed], "{kind:?}");
        let event = rig.sim.events()[0];
        assert!(event.wheel_m_s > wheel.rated_m_s && event.place == "wheel", "{event:?}");
        rig.switch(Output::Wheel, false);
        rig.wait(1.0);
        rig.switch(Output::Wheel, true);
        rig.wait(2.0);
        assert_eq!(rig.events(), [EventKind::Overspeed; 2], "{kind:?}: and again the next time");
    }
}

#[test]
fn p2_a_worn_wheel_may_turn_faster() {
    let mut rig = ready_with(1002, |machine, _| machine.wheel.diameter_mm = 500.0);
    rig.out.wheel_volts = 10.0;
    rig.switch(Output::Wheel, true);
    rig.wait(12.0);
    // π·0.5·1260/60 = 33.0 m/s, below 35.
    assert!((rig.sim.wheel().peripheral_m_s - 32.99).abs() < 0.01);
    assert_eq!(rig.events(), []);
}

#[test]
fn p2_each_kind_turns_what_it_has() {
    let speeds = |kind| {
        let mut rig = driven_of(kind);
        rig.switch(Output::TableRotation, true); // the same port as headstock-high and dresser-roll
        rig.wait(4.0);
        (rig.sim.workhead_rpm(), rig.sim.table_rpm(), rig.sim.roll_rpm())
    };
    assert_eq!(speeds(Kind::Gc), (200.0, 0.0, 0.0));
    assert_eq!(speeds(Kind::Gs), (0.0, 0.0, 200.0));
    assert_eq!(speeds(Kind::Ga), (0.0, 60.0, 0.0));
}

#[test]
fn p2_the_second_analog_output_sets_the_speed_of_table_and_roll() {
    for kind in Kind::kt830() {
        let mut rig = driven_of(kind);
        rig.out.analog_2_volts = 4.0;
        rig.switch(Output::HeadstockHigh, true);
        rig.wait(8.0);
        let rpm = rig.sim.workhead_rpm() + rig.sim.table_rpm() + rig.sim.roll_rpm();
        assert!((rpm - 120.0).abs() < 1e-9, "{kind:?}: 4 V of 10 V at 300 rpm: {rpm}");
    }
}

#[test]
fn p2_the_second_spindle_turns_both_ways() {
    for kind in Kind::kt830() {
        let mut rig = driven_of(kind);
        rig.switch(Output::SecondSpindle, true);
        rig.wait(1.1);
        assert!((rig.sim.second_spindle_rpm() - 1_500.0).abs() < 1e-6);
        rig.switch(Output::SecondSpindle, false);
        rig.switch(Output::SecondSpindleCcw, true);
        rig.wait(2.1);
        assert!((rig.sim.second_spindle_rpm() + 1_500.0).abs() < 1e-6);
    }
}

#[test]
fn p2_a_gear_is_in_half_a_second_after_its_output() {
    let gears = [
        (Output::Gear1, Input::Gear1In),
        (Output::Gear2, Input::Gear2In),
        (Output::Gear3, Input::Gear3In),
        (Output::Gear4, Input::Gear4In),
    ];
    for kind in Kind::kt830() {
        let wire =
            |params: &mut Params| gears.into_iter().zip(51..).for_each(|((_, i), port)| connect(params, i, port));
        let mut rig = ready_wired(program_of(kind), wire, |_, _| ());
        for (output, input) in gears {
            rig.switch(output, true);
            assert!(!after(&mut rig, 0.45, input) && after(&mut rig, 0.06, input), "{kind:?} {}", input.id());
            rig.switch(output, false);
            assert!(!after(&mut rig, 0.01, input), "{kind:?} {}", input.id());
        }
    }
}

#[test]
fn p3_gauge_arms_take_a_second_out_and_in() {
    let arms = [
        (Output::RadialGauge, Input::RadialArmOut, Input::RadialArmIn),
        (Output::AxialGauge, Input::AxialArmOut, Input::AxialArmIn),
    ];
    for kind in Kind::kt830() {
        let inputs = arms.iter().flat_map(|(_, out, into)| [*out, *into]);
        let wire = |params: &mut Params| inputs.zip(51..).for_each(|(input, port)| connect(params, input, port));
        let mut rig = ready_wired(program_of(kind), wire, |_, _| ());
        for (output, out, into) in arms {
            assert!(rig.input(into) && !rig.input(out));
            rig.switch(output, true);
            assert!(!after(&mut rig, 0.98, out) && !rig.input(into), "{kind:?} {}", out.id());
            // A second, and the bounce of 5 ms.
            assert!(after(&mut rig, 0.04, out), "{kind:?} {}", out.id());
            rig.switch(output, false);
            assert!(!after(&mut rig, 0.98, into) && !rig.input(out), "{kind:?} {}", into.id());
            assert!(after(&mut rig, 0.04, into), "{kind:?} {}", into.id());
        }
    }
}

#[test]
fn p3_the_oscillation_cylinder_runs_between_its_switches() {
    for kind in Kind::kt830() {
        let mut rig = driven_of(kind);
        assert!(rig.input(Input::OscillationBackwardEnd));
        rig.switch(Output::OscillationForward, true);
        // 100 mm at 0.2 m/s: half a second.
        assert!(!after(&mut rig, 0.48, Input::OscillationForwardEnd) && !rig.input(Input::OscillationBackwardEnd));
        assert!(after(&mut rig, 0.04, Input::OscillationForwardEnd), "{kind:?}");
        rig.switch(Output::OscillationForward, false);
        assert!(after(&mut rig, 1.0, Input::OscillationForwardEnd), "it stays there");
        rig.switch(Output::OscillationBackward, true);
        assert!(after(&mut rig, 0.52, Input::OscillationBackwardEnd), "{kind:?}");
    }
}

#[test]
fn p3_coolant_flow_and_lubrication_level_have_switches_that_can_fail() {
    for kind in Kind::kt830() {
        let wire = |params: &mut Params| {
            connect(params, Input::CoolantFlow, 51);
            connect(params, Input::LubricationLevel, 52);
        };
        let mut rig = ready_wired(program_of(kind), wire, |_, _| ());
        assert!(!rig.input(Input::CoolantFlow) && rig.input(Input::LubricationLevel), "{kind:?}");
        rig.switch(Output::Coolant, true);
        assert!(after(&mut rig, 0.6, Input::CoolantFlow), "{kind:?}");
        rig.sim.inject_fault("coolant-missing").unwrap();
        rig.sim.inject_fault("lubrication-missing").unwrap();
        rig.step();
        assert!(!rig.input(Input::CoolantFlow) && !rig.input(Input::LubricationLevel), "{kind:?}");
        rig.sim.clear_fault("coolant-missing").unwrap();
        rig.sim.clear_fault("lubrication-missing").unwrap();
        rig.step();
        assert!(rig.input(Input::CoolantFlow) && rig.input(Input::LubricationLevel), "{kind:?}");
    }
}

#[test]
fn p3_a_machine_without_a_tailstock_shows_none() {
    for kind in [Kind::Gs, Kind::Ga] {
        let mut rig = ready(program_of(kind));
        rig.wait(2.0);
        assert!(!rig.input(Input::TailstockAdvanced) && !rig.input(Input::TailstockRetracted), "{kind:?}");
    }
}

#[test]
fn t3_a_ready_machine_has_pressure_and_is_magnetised() {
    for kind in Kind::kt830() {
        let mut rig = ready(program_of(kind));
        assert!(rig.input(Input::HydraulicPressure), "{kind:?}");
        let magnet = f64::from(u8::from(kind.row().has(Equipment::MagneticChuck)));
        assert!((rig.sim.magnet_force() - magnet).abs() < 1e-9, "{kind:?}");
        rig.wait(1.0);
        assert!(rig.input(Input::HydraulicPressure) && (rig.sim.magnet_force() - magnet).abs() < 1e-9, "{kind:?}");
        assert!(rig.seen.encoder_mm.coordinates().iter().all(|mm| mm.abs() <= 0.0) && rig.events().is_empty());
    }
}

#[test]
fn p7_the_radial_gauge_tells_the_diameter_in_four_stages_while_its_arm_is_out() {
    let mut rig = ready(1002);
    rig.spin();
    rig.go(60.0, 29.0, 6_000.0);
    rig.switch(Output::RadialGauge, true);
    rig.wait(1.1);
    rig.go(40.35, 29.0, 6_000.0);
    let stages = [(Input::Gauge1, 0.1), (Input::Gauge2, 0.02), (Input::Gauge3, 0.005), (Input::Gauge4, 0.0)];
    let mut seen = [None; 4];
    // 0.3 mm/min: 10 µm of diameter a second.
    let zero = rig.sim.encoder_zero_mm()[Axis::X];
    for tick in 0..45_000 {
        rig.out.set_point_mm[Axis::X] = 20.175 - 0.000_005 * f64::from(tick) - 230.0 - zero;
        rig.step();
        for (seen, (input, _)) in seen.iter_mut().zip(stages) {
            if rig.input(input) && seen.is_none() {
                *seen = rig.sim.diameter_at(39.0);
            }
        }
    }
    for (seen, (input, over)) in seen.into_iter().zip(stages) {
        // 0.5 µm of noise early, 0.1 µm in the 10 ms late.
        let off = (seen.unwrap() - 40.0 - over) * 1_000.0;
        assert!((-0.65..=0.5).contains(&off), "{}: {off} µm", input.id());
    }
    rig.switch(Output::RadialGauge, false);
    rig.wait(0.02);
    assert!(stages.iter().all(|(input, _)| !rig.input(*input)), "with the arm on its way in it tells nothing");
}

#[test]
fn p7_the_thickness_gauge_measures_on_the_magnet_too() {
    for (program, stock) in [(1007, 20.1), (1010, 25.05)] {
        for (over_um, wanted) in [(110.0, 0), (60.0, 1), (12.0, 2), (2.9, 3), (-5.0, 4)] {
            let mut rig = ready_with(program, |_, part| {
                part.gauge.as_mut().unwrap().set = stock;
            });
            let found = rig.sim.height_at(if program == 1007 { 100.0 } else { 95.0 }, 30.0).unwrap();
            rig = ready_with(program, |_, part| {
                part.gauge.as_mut().unwrap().set = found - over_um / 1_000.0;
            });
            rig.switch(Output::RadialGauge, true);
            rig.wait(1.1);
            let given = [Input::Gauge1, Input::Gauge2, Input::Gauge3, Input::Gauge4].map(|input| rig.input(input));
            assert_eq!(given.iter().filter(|on| **on).count(), wanted, "O{program} {over_um} µm: {given:?}");
            assert!(given.is_sorted_by(|a, b| a >= b));
        }
    }
}

#[test]
fn p7_the_plane_gauge_gives_signal_four_at_the_touch_and_six_at_the_second_stage() {
    let mut rig = ready(1007);
    rig.switch(Output::AxialGauge, true);
    rig.wait(1.1);
    // The tip is 20 mm below the wheel and 25 mm beside it: over the plate at Z 55 it stands at Z 30.
    rig.go_xyz(100.0, 60.0, 55.0, 6_000.0);
    rig.go_xyz(100.0, 40.2, 55.0, 3_000.0);
    let touch = rig.sim.height_at(100.0, 30.0).unwrap() + 20.0;
    let zero = rig.sim.encoder_zero_mm()[Axis::Y];
    let (mut four, mut six) = (None, None);
    // 60 mm/min: 10 µm in the delay of 10 ms.
    for tick in 0..2_400 {
        rig.out.set_point_mm[Axis::Y] = 40.2 - 0.001 * f64::from(tick) - 280.0 - zero;
        rig.step();
        let y = rig.sim.slide_mm()[Axis::Y] + 280.0;
        four = four.or(rig.input(Input::Gauge4).then_some(y));
        six = six.or(rig.input(Input::Gauge6).then_some(y));
        assert!(!rig.input(Input::Gauge1), "the thickness gauge's arm is in");
    }
    let (four, six) = (touch - four.unwrap(), touch - six.unwrap());
    assert!((0.009..=0.0115).contains(&four), "{four}");
    assert!((2.009..=2.0115).contains(&six), "{six}");
    rig.go_xyz(100.0, 60.0, 55.0, 3_000.0);
    rig.wait(0.02);
    assert!(!rig.input(Input::Gauge4) && !rig.input(Input::Gauge6) && rig.events().is_empty());
}

#[test]
fn p7_the_axial_gauge_touches_a_face_of_a_cylindrical_part() {
    let mut rig = ready(1001);
    // Tip 40 mm ahead (of radius) and 15 mm to the left: at X 120 it stands on X 40, the left face is at Z 9.98.
    rig.go(120.0, 30.0, 6_000.0);
    rig.switch(Output::AxialGauge, true);
    rig.wait(1.1);
    rig.go(120.0, 25.1, 1_000.0);
    rig.wait(0.2);
    assert!(!rig.input(Input::Gauge4));
    rig.go(120.0, 24.9, 60.0);
    rig.wait(0.2);
    assert!(rig.input(Input::Gauge4) && !rig.input(Input::Gauge6));
    rig.go(120.0, 22.9, 60.0);
    rig.wait(0.2);
    assert!(rig.input(Input::Gauge6) && rig.events().is_empty());
}

#[test]
fn p8_a_plane_gauge_pressed_beyond_its_travel_is_a_crash() {
    for (program, x, y, z) in [(1007, 100.0, 36.0, 55.0), (1010, 120.0, 0.0, 40.0)] {
        let mut rig = ready(program);
        rig.switch(Output::AxialGauge, true);
        rig.wait(1.1);
        let up = if program == 1007 { (60.0, z) } else { (y, 60.0) };
        rig.go_xyz(x, up.0, up.1, 6_000.0);
        rig.go_xyz(x, y, z, 3_000.0);
        assert_eq!((rig.events(), rig.sim.events()[0].place), (vec![EventKind::Crash], "gauge"), "O{program}");
    }
}

#[test]
fn p8_a_dead_gauge_tells_nothing() {
    for kind in Kind::kt830() {
        let mut rig = ready_with(program_of(kind), |_, part| part.gauge.as_mut().unwrap().set = 100.0);
        rig.switch(Output::RadialGauge, true);
        rig.wait(1.1);
        let all = [Input::Gauge1, Input::Gauge2, Input::Gauge3, Input::Gauge4];
        assert!(all.iter().all(|input| rig.input(*input)), "{kind:?}: far below the set size");
        rig.sim.inject_fault("gauge-dead").unwrap();
        rig.step();
        assert!(all.iter().all(|input| !rig.input(*input)), "{kind:?}");
        rig.sim.clear_fault("gauge-dead").unwrap();
        rig.step();
        assert!(all.iter().all(|input| rig.input(*input)), "{kind:?}");
    }
}

/// The rest of the switch without and with a fault, on every kind.
#[test]
fn p8_every_switch_can_stick_and_chatter_on_every_kind() {
    for kind in Kind::kt830() {
        let free: Vec<Input> =
            Input::ALL.iter().copied().filter(|input| Params::factory(kind).input_port(*input) == 0).collect();
        let wire = |params: &mut Params| {
            // Ports 41 to 64 are free by factory.
            free.iter().zip(41..).for_each(|(input, port)| connect(params, *input, port));
        };
        let mut rig = ready_wired(program_of(kind), wire, |_, _| ());
        for input in Input::ALL {
            for (fault, on) in [("stuck-on", true), ("stuck-off", false)] {
                let text = format!("{fault} {}", input.id());
                let before = rig.input(*input);
                rig.sim.inject_fault(&text).unwrap();
                rig.step();
                assert_eq!(rig.input(*input), on, "{kind:?} {text}");
                rig.sim.clear_fault(&text).unwrap();
                rig.step();
                assert_eq!(rig.input(*input), before, "{kind:?} {text}");
            }
            let text = format!("bounce {}", input.id());
            rig.sim.inject_fault(&text).unwrap();
            let on = (0..100).filter(|_| {
                rig.step();
                rig.input(*input)
            });
            let on = on.count();
            assert!((20..=80).contains(&on), "{kind:?} {text}: {on} of 100");
            rig.sim.clear_fault(&text).unwrap();
        }
    }
}

#[test]
fn p8_drives_fault_and_lose_their_axis_on_every_kind() {
    for kind in Kind::kt830() {
        for axis in Axis::ALL {
            let mut rig = driven_of(kind);
            if !rig.sim.axes()[axis] {
                continue;
            }
            let letter = axis.letter().to_ascii_lowercase();
            let drive = [Input::DriveX, Input::DriveY, Input::DriveZ][axis as usize];
            rig.sim.inject_fault(&format!("drive-{letter}")).unwrap();
            rig.jog(axis, -1.0, 50.0);
            rig.wait(0.2);
            assert!(rig.input(drive) && rig.seen.encoder_mm[axis].abs() < 0.002, "{kind:?} {axis}");
            let mut rig = driven_of(kind);
            rig.sim.inject_fault(&format!("following-{letter}")).unwrap();
            rig.jog(axis, -1.0, 50.0);
            rig.wait(0.2);
            assert!(!rig.input(drive) && rig.seen.encoder_mm[axis].abs() < 0.002, "{kind:?} {axis}");
        }
    }
}

#[test]
fn p8_pressure_supply_and_bus_fail_on_every_kind() {
    for kind in Kind::kt830() {
        let mut rig = ready(program_of(kind));
        rig.sim.inject_fault("pressure-loss").unwrap();
        // 0.6·ln(3/2.2) = 0.186 s.
        assert!(after(&mut rig, 0.15, Input::HydraulicPressure), "{kind:?}");
        assert!(!after(&mut rig, 0.1, Input::HydraulicPressure), "{kind:?}");
        rig.sim.inject_fault("bus-silent 2").unwrap();
        let alive: Vec<bool> = (0..3)
            .map(|_| {
                rig.step();
                rig.seen.bus_alive
            })
            .collect();
        assert_eq!(alive, [false, false, true], "{kind:?}");
        rig.sim.inject_fault("bus-late 2").unwrap();
        rig.step();
        assert!(!rig.seen.bus_alive, "{kind:?}");
        rig.step();
        assert!(rig.seen.bus_alive, "{kind:?}");
        rig.wait(0.01);
        rig.sim.inject_fault("supply-loss").unwrap();
        rig.step();
        assert_eq!(rig.seen.terminals, Terminals(0), "{kind:?}");
    }
}

#[test]
fn p8_a_hard_stop_at_speed_is_a_crash_on_every_axis() {
    for kind in Kind::kt830() {
        for axis in Axis::ALL {
            let mut rig = driven_of(kind);
            if !rig.sim.axes()[axis] {
                continue;
            }
            let way = 20.0 - rig.sim.slide_mm()[axis];
            rig.jog(axis, way, 50.0);
            let crash = rig.sim.events()[0];
            assert_eq!((crash.kind, crash.place), (EventKind::Crash, format!("hard stop {axis}+").as_str()));
            // 50 mm/s.
            assert!((crash.speed - 3_000.0).abs() < 60.0 && rig.sim.slide_mm()[axis] <= 8.0, "{kind:?} {crash:?}");
            assert!(rig.input(Input::DriveX) && rig.input(Input::DriveZ), "all drives trip");
        }
    }
}

#[test]
fn p8_a_standing_wheel_pressed_onto_the_part_is_a_crash_on_every_kind() {
    for (program, above, below) in
        [(1007, [100.0, 20.12, 10.0], [100.0, 20.0, 10.0]), (1010, [95.0, 0.0, 25.07], [95.0, 0.0, 25.0])]
    {
        let mut rig = ready(program);
        rig.switch(Output::HeadstockHigh, true);
        rig.wait(4.0);
        rig.go_xyz(above[0], above[1], above[2], 3_000.0);
        rig.go_xyz(below[0], below[1], below[2], 3.0);
        let places: Vec<_> = rig.sim.events().iter().map(|event| event.place).collect();
        assert_eq!(places, ["part, wheel stopped"], "O{program}");
    }
}

#[test]
fn p4_a_part_for_another_kind_of_machine_does_not_fit_in() {
    let mut rig = ready(1007);
    assert!(rig.sim.height_at(100.0, 30.0).is_some());
    rig.sim.set_part(PartFile::builtin(1002).unwrap().as_ref());
    assert!(rig.sim.measure().diameters.is_empty() && rig.sim.height_at(100.0, 30.0).is_none());
}

#[test]
fn k1_an_axis_y_is_there_where_it_is_fitted() {
    let mut fitted = Params::factory(Kind::Gc);
    fitted.write(ParamAddress { number: param::Y_FITTED.number, bit: Some(param::Y_FITTED.bit) }, 1.0).unwrap();
    for kind in [Kind::Gc, Kind::Ga] {
        let machine = || MachineFile::builtin(kind).unwrap();
        let mut sim = SimulatedMachine::new(machine(), None, &Params::factory(kind), 1);
        assert_eq!(sim.axes().0, [true, false, true], "{kind:?}");
        // Fitted, it comes with the next power-on and goes again without the parameter; the others stay where they are.
        sim.power_on(&fitted);
        assert_eq!(sim.axes().0, [true, true, true], "{kind:?}");
        assert!((sim.slide_mm()[Axis::Y] + 100.0).abs() < 1e-9);
        sim.power_on(&Params::factory(kind));
        assert_eq!(sim.axes().0, [true, false, true], "{kind:?}");
    }
    let mut rig = ready_wired(1002, |params| *params = fitted, |_, _| ());
    rig.jog(Axis::Y, -5.0, 20.0);
    rig.wait(0.3);
    assert!((rig.seen.encoder_mm[Axis::Y] + 5.0).abs() < 1e-9);
    assert!(!rig.input(Input::LimitYMinus) && !rig.input(Input::DriveY));
    rig.sim.inject_fault("drive-y").unwrap();
    rig.step();
    assert!(rig.input(Input::DriveY));
    assert_eq!(rig.events(), []);
}

#[test]
fn p8_whatever_the_control_does_table_machines_stay_in_their_bounds() {
    for (program, travel) in [(1007, [608.0, 308.0, 308.0]), (1008, [608.0, 308.0, 308.0]), (1010, [408.0, 0.0, 308.0])]
    {
        let mut rig = ready(program);
        let mut bits = 0x9E37_79B9_7F4A_7C15_u64;
        for tick in 0..30_000 {
            // xorshift64: wild set-points and outputs, drives mostly on.
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            if tick % 40 == 0 {
                rig.out.terminals = Terminals(bits);
                rig.out.drives_on = bits & 0xF != 0;
                rig.out.wheel_volts = (bits >> 8 & 0xF) as f64 - 2.0;
                let wild = [16, 26, 36].map(|shift| (bits >> shift & 0x1FF) as f64 - 300.0);
                rig.out.set_point_mm = EncoderPos::new(if bits & 0xF0 == 0 { [f64::NAN; 3] } else { wild });
            }
            rig.tick.0 = [500, 1_000, 4_000, 30_000][(bits >> 60) as usize % 4];
            rig.step();
            let (slide, wheel) = (rig.sim.slide_mm(), rig.sim.wheel());
            assert!(slide.coordinates().iter().zip(travel).all(|(at, most)| (-most..=8.0).contains(at)), "{slide:?}");
            assert!(
                (0.0..=1_260.0).contains(&wheel.rpm) && wheel.diameter_mm > 400.0 && wheel.load_percent.is_finite()
            );
            assert!((0.0..=1.0).contains(&rig.sim.magnet_force()));
            assert!(rig.sim.measure().heights.iter().all(|at| at.y.is_finite() && at.y < 25.2));
        }
        assert!(!rig.events().is_empty());
    }
}

#[test]
fn p1_a_cold_machine_of_every_kind_stands_in_mid_travel_with_nothing_pressed() {
    for kind in Kind::kt830() {
        let rig = cold_of(kind);
        assert!(rig.seen.encoder_mm.coordinates().iter().all(|mm| mm.abs() <= 0.0));
        for input in [Input::HomeX, Input::HomeZ, Input::LimitXMinus, Input::LimitZPlus, Input::DriveX, Input::Gauge4] {
            assert!(!rig.input(input), "{kind:?} {}", input.id());
        }
        assert_eq!(rig.sim.axes()[Axis::Y], kind == Kind::Gs);
    }
}

#[test]
fn p3_a_demagnetising_that_is_broken_off_leaves_its_share() {
    let mut rig = cold_of(Kind::Gs);
    rig.switch(Output::Magnetise, true);
    rig.wait(1.0);
    rig.switch(Output::Magnetise, false);
    rig.switch(Output::Demagnetise, true);
    rig.wait(3.0);
    rig.switch(Output::Demagnetise, false);
    rig.wait(1.0);
    // Half of the time: half of 0.15.
    assert!((rig.sim.magnet_force() - 0.075).abs() < 1e-3, "{}", rig.sim.magnet_force());
}

#[test]
fn p3_both_outputs_at_once_give_no_current() {
    let mut rig = cold_of(Kind::Gs);
    rig.switch(Output::Magnetise, true);
    rig.wait(1.0);
    rig.switch(Output::Demagnetise, true);
    rig.wait(0.3);
    // Only the remanence is left, and no reversal.
    assert!((rig.sim.magnet_force() - 0.15).abs() < 1e-9, "{}", rig.sim.magnet_force());
    rig.switch(Output::Magnetise, false);
    rig.wait(0.25);
    assert!(rig.sim.magnet_force() > 0.9, "Demagnetise alone reverses the current");
}
