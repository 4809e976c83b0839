//! Surface and rotary-table grinder: planes, slots, steps and rings on the magnet (rows P2, P3, P4, P5, P6, P8).

use crate::bench::{Rig, ready, ready_with};
use kt830::defs::signal::{Input, Output};
use kt830::io::sim::{EventKind, SurfaceFile};
use kt830::units::Axis;

/// One layer on the plate of O1007: strokes of 260 mm at 12 m/min, a cross step of 15 mm after each.
fn layer(rig: &mut Rig, y: f64, to_z: f64) {
    let from = rig.sim.slide_mm();
    // G54 of the part: -400, -280, -190.
    let (mut x, mut z) = (from[Axis::X] + 400.0, from[Axis::Z] + 190.0);
    rig.go_xyz(x, y, z, 500.0);
    let step = if to_z > z { 15.0 } else { -15.0 };
    for _ in 0..8 {
        x = 200.0 - x;
        rig.go_xyz(x, y, z, 12_000.0);
        if (to_z - z).abs() < 1e-6 {
            return;
        }
        z += step;
        rig.go_xyz(x, y, z, 3_000.0);
    }
    panic!("the slides are not where the hand left them: {:?}", rig.sim.events());
}

fn plate(rig: &mut Rig, spark_out: u32) {
    rig.spin();
    rig.go_xyz(-30.0, 60.0, -35.0, 6_000.0);
    rig.go_xyz(-30.0, 20.12, -35.0, 6_000.0);
    let mut to_z = 55.0;
    for step in 1..=10 {
        layer(rig, 20.1 - 0.01 * f64::from(step), to_z);
        to_z = 20.0 - to_z;
    }
    for _ in 0..spark_out {
        layer(rig, 20.0, to_z);
        to_z = 20.0 - to_z;
    }
}

fn heights_um(rig: &Rig, wanted: f64) -> (f64, f64) {
    let off: Vec<f64> = rig.sim.measure().heights.iter().map(|at| (at.y - wanted) * 1_000.0).collect();
    assert_eq!(off.len(), 15);
    (off.iter().copied().fold(f64::INFINITY, f64::min), off.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

#[test]
fn p5_a_plate_comes_to_its_thickness_by_reciprocation() {
    let mut rig = ready(1007);
    plate(&mut rig, 2);
    let (least, greatest) = heights_um(&rig, 20.0);
    // Wheel wear: 1200 mm³/40 over π·500·40 mm: 0.48 µm. A pass leaves exp(-2.0/1.5) = 26 %, and every place is passed
    // over twice or thrice a layer: nothing else is left after two layers.
    assert!(least > 0.2 && greatest < 0.8, "{least} {greatest}");
    assert_eq!(rig.events(), []);
    assert!((rig.sim.height_at(100.0, 30.0).unwrap() - 20.0).abs() < 0.001);
    assert_eq!(rig.sim.height_at(201.0, 30.0), None);
}

#[test]
fn p5_one_pass_over_a_plane_leaves_a_quarter_whatever_the_speed_and_the_tick() {
    for (tick_us, feed) in [(1_000, 12_000.0), (4_000, 12_000.0), (1_000, 6_000.0), (500, 20_000.0)] {
        let mut rig = ready_with(1007, |_, part| {
            let SurfaceFile::Plane { waviness, .. } = &mut part.surfaces[0] else { unreachable!() };
            *waviness = 0.0;
        });
        rig.tick.0 = tick_us;
        rig.spin();
        rig.go_xyz(-60.0, 20.09, 10.0, 6_000.0);
        rig.go_xyz(260.0, 20.09, 10.0, feed);
        // 10 µm · exp(-2.0/1.5) = 2.64 µm, less the contact time: with the arc before the contact, √(2·250·0.01) = 2.2 mm,
        // at most 6.4 mm at 100 mm/s, 64 ms of 0.8 s, are 8 % of it.
        let left = (rig.sim.height_at(100.0, 30.0).unwrap() - 20.09) * 1_000.0;
        assert!((2.3..=2.66).contains(&left), "{tick_us} {feed}: {left}");
    }
}

#[test]
fn p6_a_dull_wheel_leaves_more_of_a_plane() {
    let mut rig = ready(1007);
    rig.sim.set_wheel_dullness(1.0);
    rig.spin();
    rig.go_xyz(-60.0, 20.09, 10.0, 6_000.0);
    rig.go_xyz(260.0, 20.09, 10.0, 12_000.0);
    // 2.5 times as long: exp(-2.0/(1.5·2.5)) = 59 % of 10 µm, the stock is wavy by 5 µm.
    let left = (rig.sim.height_at(100.0, 30.0).unwrap() - 20.09) * 1_000.0;
    assert!(left > 2.0, "{left}");
}

#[test]
fn p4_the_wheel_touches_a_plane_only_where_it_is() {
    let mut rig = ready(1007);
    rig.spin();
    rig.go_xyz(-60.0, 20.05, 10.0, 6_000.0);
    let (before, beside) = (rig.sim.height_at(150.0, 30.0).unwrap(), rig.sim.height_at(50.0, 5.0).unwrap());
    rig.go_xyz(100.0, 20.05, 10.0, 6_000.0);
    rig.go_xyz(-60.0, 20.05, 10.0, 6_000.0);
    // The wheel covers Z 10 to 50 and came as far as X 100; its arc 50 µm deep is √(2·250·0.05) = 5 mm long.
    assert!(rig.sim.height_at(50.0, 30.0).unwrap() < 20.06);
    assert_eq!(rig.sim.height_at(50.0, 5.0), Some(beside));
    assert_eq!(rig.sim.height_at(150.0, 30.0), Some(before));
    assert!(rig.sim.height_at(100.5, 30.0).unwrap() < rig.sim.height_at(104.5, 30.0).unwrap());
}

#[test]
fn p4_a_plunge_with_the_table_standing_leaves_the_arc_of_the_wheel() {
    let mut rig = ready_with(1007, |_, part| {
        let SurfaceFile::Plane { waviness, .. } = &mut part.surfaces[0] else { unreachable!() };
        *waviness = 0.0;
    });
    rig.spin();
    rig.go_xyz(100.0, 20.11, 10.0, 6_000.0);
    rig.go_xyz(100.0, 20.05, 10.0, 1.0);
    rig.wait(10.0);
    // Flat within 1 mm, then 250 − √(250² − d²) with d from there: 3.5 mm make 24.5 µm, 5 mm would come to the stock.
    for (x, arc) in [(100.5, 0.0), (104.5, 0.024_5), (95.5, 0.024_5), (103.5, 0.012_5), (106.5, 0.05)] {
        let off = rig.sim.height_at(x, 30.0).unwrap() - 20.05 - arc;
        assert!(off.abs() < 0.000_5, "X{x}: {off}");
    }
}

#[test]
fn p2_the_wheel_of_a_surface_grinder_wears_and_loads_its_motor() {
    let mut rig = ready_with(1007, |_, part| {
        let SurfaceFile::Plane { waviness, .. } = &mut part.surfaces[0] else { unreachable!() };
        *waviness = 0.0;
    });
    let new = rig.sim.wheel().diameter_mm;
    rig.spin();
    rig.go_xyz(-60.0, 20.09, 10.0, 6_000.0);
    let idle = rig.sim.wheel().load_percent;
    rig.go_xyz(100.0, 20.09, 10.0, 6_000.0);
    rig.go_xyz(-60.0, 20.09, 10.0, 6_000.0);
    rig.go_xyz(60.0, 20.085, 10.0, 6_000.0);
    let worn = new - rig.sim.wheel().diameter_mm;
    // 40 · 102 · 0.01 = 41 mm³ and half of 40 · 60 · 0.007; over 40·π·500·40/2: about 0.000_036 mm.
    assert!((0.000_025..0.000_05).contains(&worn), "{worn}");
    assert!(idle > 7.9 && rig.sim.wheel().load_percent >= idle);
    assert!((rig.sim.wheel().peripheral_m_s - 26.18).abs() < 0.01, "π·0.5·1000/60");
}

#[test]
fn p5_too_deep_a_pass_burns_the_plane() {
    let mut rig = ready(1007);
    rig.spin();
    rig.go_xyz(-60.0, 19.95, 10.0, 6_000.0);
    // 0.15 mm at 200 mm/s: 30 mm³/(mm·s), above 8.
    rig.go_xyz(260.0, 19.95, 10.0, 12_000.0);
    assert_eq!(rig.events(), [EventKind::Burn]);
}

#[test]
fn p8_a_crash_into_the_plate_tells_its_place_in_three_axes() {
    let mut rig = ready(1007);
    rig.spin();
    rig.go_xyz(100.0, 60.0, 10.0, 6_000.0);
    rig.go_xyz(100.0, 10.0, 10.0, 6_000.0);
    let crash = *rig.sim.events().last().unwrap();
    assert_eq!((crash.kind, crash.place), (EventKind::Crash, "part"));
    assert!((crash.x - 100.0).abs() < 1e-6 && (crash.z - 10.0).abs() < 1e-6 && crash.speed > 1_000.0, "{crash:?}");
    assert!((crash.y.unwrap() - 19.8).abs() < 0.2, "0.3 mm below 20.1 and a tick of 0.1 mm: {crash:?}");
    assert!(rig.input(Input::DriveX) && rig.input(Input::DriveY) && rig.input(Input::DriveZ));
}

#[test]
fn p8_the_magnet_is_in_the_way_only_where_it_is() {
    let mut rig = ready(1007);
    rig.spin();
    // Beside the plate along Z: the magnet ends at machine -220, part -30; the wheel covers 40 mm from its place.
    rig.go_xyz(100.0, 60.0, -75.0, 6_000.0);
    rig.go_xyz(100.0, -5.0, -75.0, 3_000.0);
    assert_eq!(rig.events(), [], "Z -75 to -35 is beside it");
    rig.go_xyz(100.0, 60.0, -75.0, 3_000.0);
    rig.go_xyz(100.0, 60.0, -65.0, 3_000.0);
    rig.go_xyz(100.0, -5.0, -65.0, 3_000.0);
    assert_eq!((rig.events(), rig.sim.events()[0].place), (vec![EventKind::Crash], "magnet"));
}

#[test]
fn p3_a_part_that_is_ground_without_the_magnet_flies_off() {
    let mut rig = ready(1007);
    rig.spin();
    rig.go_xyz(-60.0, 20.09, 10.0, 6_000.0);
    rig.switch(Output::Magnetise, false);
    rig.wait(0.3);
    rig.go_xyz(100.0, 20.09, 10.0, 6_000.0);
    assert_eq!((rig.events(), rig.sim.events()[0].place), (vec![EventKind::Crash], "part, not held"));
    assert!(rig.input(Input::DriveX), "it stops the machine");
    assert_eq!(rig.sim.height_at(100.0, 30.0), None, "the part is gone");
}

#[test]
fn p3_a_part_flies_off_a_table_that_turns_without_the_magnet() {
    let mut rig = ready(1010);
    rig.switch(Output::Magnetise, false);
    rig.switch(Output::Demagnetise, true);
    rig.wait(6.1);
    rig.switch(Output::Demagnetise, false);
    assert!(rig.sim.magnet_force() < 0.001 && rig.events().is_empty(), "a part may lie there");
    rig.switch(Output::TableRotation, true);
    rig.wait(1.0);
    assert_eq!((rig.events(), rig.sim.events()[0].place), (vec![EventKind::Crash], "part, not held on the table"));
}

#[test]
fn p3_the_magnet_holds_after_a_second_and_a_ready_machine_is_magnetised() {
    let mut rig = ready(1007);
    assert!(rig.sim.magnet_force() >= 1.0);
    rig.switch(Output::Magnetise, false);
    rig.wait(1.0);
    assert!((rig.sim.magnet_force() - 0.15).abs() < 1e-9, "the remanence");
    rig.switch(Output::Magnetise, true);
    rig.wait(0.9);
    assert!(rig.sim.magnet_force() < 1.0);
    rig.wait(0.11);
    assert!(rig.sim.magnet_force() >= 1.0);
}

#[test]
fn p5_a_slot_gets_its_floor_by_the_rim_and_its_walls_by_the_sides() {
    let mut rig = ready(1008);
    rig.spin();
    rig.go_xyz(-150.0, 60.0, 10.0, 6_000.0);
    rig.go_xyz(-150.0, 15.06, 10.0, 6_000.0);
    let mut x = -150.0;
    let mut stroke = |rig: &mut Rig, y: f64, z: f64| {
        rig.go_xyz(x, y, z, 500.0);
        x = 100.0 - x;
        rig.go_xyz(x, y, z, 6_000.0);
    };
    for step in 0..=6 {
        stroke(&mut rig, 15.06 - 0.01 * f64::from(step), 10.0);
    }
    // The floor to the foot of either wall, then the walls; 5 µm a stroke, three to spark out.
    for z in [5.05, 14.95] {
        (0..6).for_each(|step| stroke(&mut rig, 15.06 - 0.012 * f64::from(step), z));
    }
    for (first, side) in [(14.97, 1.0), (5.03, -1.0)] {
        stroke(&mut rig, 15.0, 10.0);
        (0..=6).for_each(|step| stroke(&mut rig, 15.0, first + side * 0.005 * f64::from(step)));
        (0..3).for_each(|_| stroke(&mut rig, 15.0, first + side * 0.03));
    }
    assert_eq!(rig.events(), []);
    let faces = rig.sim.measure().faces;
    assert_eq!(faces.len(), 2);
    assert!((faces[0].z - 5.0).abs() < 0.001 && (faces[1].z - 55.0).abs() < 0.001, "{faces:?}");
    let (least, greatest) = heights_um(&rig, 15.0);
    assert!(least > -0.1 && greatest < 1.0, "{least} {greatest}");
}

#[test]
fn p8_the_shoulder_of_a_slot_is_a_crash() {
    let mut rig = ready(1008);
    rig.spin();
    rig.go_xyz(50.0, 60.0, 0.0, 6_000.0);
    rig.go_xyz(50.0, 20.0, 0.0, 3_000.0);
    let places: Vec<_> = rig.sim.events().iter().map(|event| event.place).collect();
    assert!(places.contains(&"fixture"), "{places:?}");
    // Outside its length the wheel goes down beside it: X 300 is 200 mm from its end, the chord 5 mm deep is 50 mm.
    let mut rig = ready(1008);
    rig.spin();
    rig.go_xyz(180.0, 60.0, 0.0, 6_000.0);
    rig.go_xyz(180.0, 20.0, 0.0, 3_000.0);
    assert_eq!(rig.events(), []);
}

#[test]
fn p4_a_step_has_two_heights_and_a_shoulder() {
    let mut rig = ready(1009);
    let report = rig.sim.measure();
    assert_eq!((report.heights.len(), report.faces.len()), (30, 1));
    assert!((rig.sim.height_at(50.0, 15.0).unwrap() - 15.06).abs() < 0.004);
    assert!((rig.sim.height_at(50.0, 45.0).unwrap() - 25.06).abs() < 0.004);
    rig.spin();
    // The plus side stands at -10.02 + 40 = 29.98, 10 µm into the shoulder; the rim above the lower plane.
    rig.go_xyz(-150.0, 15.5, -10.02, 6_000.0);
    rig.go_xyz(250.0, 15.5, -10.02, 6_000.0);
    rig.go_xyz(-150.0, 15.5, -10.02, 6_000.0);
    let shoulder = rig.sim.face_at(50.0, None).unwrap();
    assert!((shoulder - 29.98).abs() < 0.001, "{shoulder}");
    assert!((rig.sim.height_at(50.0, 15.0).unwrap() - 15.06).abs() < 0.004, "the lower plane is as it was");
    assert_eq!(rig.events(), []);
}

/// Passes over the ring of O1010, from X 15 to 135 and back, with infeed at both ends.
fn ring(rig: &mut Rig, spark_out: u32) {
    rig.spin();
    rig.go(135.0, 60.0, 6_000.0);
    rig.go(135.0, 25.06, 3_000.0);
    let (mut z, mut x) = (25.06_f64, 135.0);
    for pass in 0..24 + spark_out {
        z = if pass < 24 { z - 0.002_5 } else { z };
        rig.go(x, z, 100.0);
        x = 150.0 - x;
        rig.go(x, z, 600.0);
    }
    rig.go(x, 60.0, 3_000.0);
}

#[test]
fn p5_a_ring_on_the_turning_table_comes_to_its_thickness() {
    let mut rig = ready(1010);
    assert!((rig.sim.height_at(95.0, 0.0).unwrap() - 25.05).abs() < 0.005);
    ring(&mut rig, 2);
    let faces = rig.sim.measure().faces;
    assert_eq!(faces.len(), 3);
    for face in &faces {
        // Wheel wear: π·(150² − 40²)·0.05 = 3283 mm³ over 40·π·500·40: 1.3 µm when all of it has been ground.
        let off = (face.z - 25.0) * 1_000.0;
        assert!((0.0..=1.7).contains(&off), "X{}: {off} µm", face.x);
    }
    assert_eq!(rig.events(), []);
    // Twice 3283 mm³/(40·π·500·40) of diameter: 2.6 µm, less the micrometre that is not taken.
    let worn = (500.0 - rig.sim.wheel().diameter_mm) * 1_000.0;
    assert!((2.5..=2.65).contains(&worn), "{worn}");
    assert_eq!(rig.sim.height_at(-95.0, 0.0), rig.sim.height_at(95.0, 0.0), "X is a radius");
    assert_eq!(rig.sim.height_at(30.0, 0.0), None);
}

#[test]
fn p5_a_ring_on_a_standing_table_gets_a_flat() {
    let mut rig = ready(1010);
    rig.switch(Output::Wheel, true);
    rig.wait(9.0);
    rig.go(95.0, 25.06, 6_000.0);
    rig.go(95.0, 25.0, 3.0);
    assert_eq!((rig.events(), rig.sim.events()[0].place), (vec![EventKind::Flat], "part, table stopped"));
}

#[test]
fn p4_beyond_the_middle_of_the_table_the_wheel_covers_the_other_side() {
    let mut rig = ready_with(1010, |_, part| {
        part.surfaces =
            vec![SurfaceFile::Disc { x_from: 0.0, x_to: 60.0, stock: 25.0, cell: 0.5, runout: 0.0, waviness: 0.0 }];
    });
    rig.spin();
    // The wheel covers -30 to 10: all radii to 30, none beyond.
    rig.go(-30.0, 25.1, 6_000.0);
    rig.go(-30.0, 24.98, 0.3);
    rig.wait(8.0);
    for (x, wanted) in [(2.0, 24.98), (15.0, 24.98), (28.0, 24.98), (35.0, 25.0)] {
        let z = rig.sim.height_at(x, 0.0).unwrap();
        assert!((z - wanted).abs() < 0.001, "X{x}: {z}");
    }
    assert_eq!(rig.events(), []);
}

#[test]
fn p8_crashes_of_a_rotary_table_grinder() {
    let mut rig = ready(1010);
    rig.spin();
    rig.go(95.0, 30.0, 6_000.0);
    rig.go(95.0, 20.0, 6_000.0);
    assert_eq!(rig.sim.events().last().map(|event| event.place), Some("part"));
    let mut rig = ready(1010);
    rig.spin();
    // Outside the ring, over the plate of 200 mm radius.
    rig.go(155.0, 30.0, 6_000.0);
    rig.go(155.0, -2.0, 6_000.0);
    assert_eq!(rig.sim.events().last().map(|event| event.place), Some("magnet"));
    let mut rig = ready(1010);
    rig.spin();
    // Diamond: machine X -60, Z -200: part 290, 80.
    rig.go(200.0, 85.0, 6_000.0);
    rig.go(270.0, 85.0, 6_000.0);
    rig.go(270.0, 75.0, 6_000.0);
    assert_eq!(rig.sim.events().last().map(|event| event.place), Some("dresser"));
}

#[test]
fn p6_the_diamond_of_a_rotary_table_grinder_sharpens_slice_by_slice() {
    let mut rig = ready(1010);
    rig.spin();
    rig.sim.set_wheel_dullness(1.0);
    rig.go(200.0, 85.0, 6_000.0);
    rig.go(295.0, 85.0, 6_000.0);
    rig.go(295.0, 79.98, 1_000.0);
    rig.go(245.0, 79.98, 200.0);
    let wheel = rig.sim.wheel();
    assert!((500.0 - wheel.diameter_mm - 0.04).abs() < 0.000_1 && wheel.dullness <= 0.0, "{wheel:?}");
}

#[test]
fn p6_the_roll_dresses_the_whole_width_at_once_while_it_turns() {
    let mut rig = ready(1007);
    rig.spin();
    rig.sim.set_wheel_dullness(1.0);
    assert!((rig.sim.roll_rpm() - 200.0).abs() < 1e-9);
    // Roll: machine X -15, Y -240, Z -150 to -90: part 385, 40, 40 to 100.
    rig.go_xyz(385.0, 60.0, 50.0, 6_000.0);
    rig.go_xyz(385.0, 40.1, 50.0, 3_000.0);
    rig.go_xyz(385.0, 39.98, 50.0, 1.0);
    rig.wait(0.2);
    let wheel = rig.sim.wheel();
    assert!((500.0 - wheel.diameter_mm - 0.04).abs() < 0.000_1 && wheel.dullness <= 0.0, "{wheel:?}");
    assert_eq!(rig.events(), []);
    // 10 mm off along the stroke the two circles of 250 and 40 mm leave 10²/(2·290) = 0.17 mm.
    rig.go_xyz(385.0, 50.0, 50.0, 3_000.0);
    rig.go_xyz(375.0, 50.0, 50.0, 3_000.0);
    rig.go_xyz(375.0, 39.85, 50.0, 1_000.0);
    assert!((500.0 - rig.sim.wheel().diameter_mm - 0.04).abs() < 0.000_1);
}

#[test]
fn p8_a_standing_roll_or_too_deep_a_feed_is_a_crash_into_the_dresser() {
    let mut rig = ready(1007);
    rig.switch(Output::Wheel, true);
    rig.wait(9.0);
    rig.go_xyz(385.0, 40.1, 50.0, 6_000.0);
    rig.go_xyz(385.0, 39.95, 50.0, 10.0);
    assert_eq!((rig.events(), rig.sim.events()[0].place), (vec![EventKind::Crash], "dresser, roll stopped"));
    let mut rig = ready(1007);
    rig.spin();
    rig.go_xyz(385.0, 60.0, 50.0, 6_000.0);
    rig.go_xyz(385.0, 38.0, 50.0, 6_000.0);
    assert_eq!((rig.events(), rig.sim.events()[0].place), (vec![EventKind::Crash], "dresser"));
}

#[test]
fn p5_the_same_seed_gives_the_same_bits_on_every_kind() {
    let gs = || {
        let mut rig = ready(1007);
        plate(&mut rig, 0);
        (rig.sim.measure(), rig.sim.wheel(), rig.seen)
    };
    let ga = || {
        let mut rig = ready(1010);
        ring(&mut rig, 0);
        (rig.sim.measure(), rig.sim.wheel(), rig.seen)
    };
    assert_eq!(gs(), gs());
    assert_eq!(ga(), ga());
}
