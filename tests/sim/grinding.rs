//! The part under the wheel: size, lag and spark-out, wear, burning, crashing, dressing (rows P2, P4, P5, P6).

use crate::bench::{Rig, ready, ready_with};
use kt830::defs::signal::{Input, Output};
use kt830::io::sim::{EventKind, FaceDirection, SurfaceFile};
use kt830::units::Axis;

/// O1002 by hand: approach, rough, fine, spark-out, retract.
fn plunge(rig: &mut Rig, spark_out_s: f64) {
    rig.spin();
    rig.go(60.0, 29.0, 6_000.0);
    rig.go(40.4, 29.0, 6_000.0);
    rig.go(40.05, 29.0, 1.2);
    rig.go(40.0, 29.0, 0.3);
    rig.wait(spark_out_s);
    rig.go(60.0, 29.0, 6_000.0);
    rig.wait(0.5);
}

/// Deviation of the measured diameters from 40 mm, least and greatest, µm.
fn size_um(rig: &Rig) -> (f64, f64) {
    let off = rig.sim.measure().diameters.iter().map(|at| (at.d - 40.0) * 1_000.0).collect::<Vec<_>>();
    assert_eq!(off.len(), 5);
    (off.iter().copied().fold(f64::INFINITY, f64::min), off.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

#[test]
fn p5_a_plunge_with_spark_out_comes_to_size_within_a_micrometre() {
    let mut rig = ready(1002);
    plunge(&mut rig, 6.0);
    let (least, greatest) = size_um(&rig);
    // Lag 2·5 µm/s·0.8 s = 8 µm, after 6 s: 8·exp(-7.5) = 0.004 µm; wheel wear 2·V/(40·π·600·b), V = π·40·b·0.15:
    // 0.5 µm. Nothing else is in it.
    assert!(least > 0.0 && greatest < 1.0, "{least} {greatest}");
    assert_eq!(rig.events(), []);
}

#[test]
fn p5_a_plunge_without_spark_out_stays_larger() {
    let mut rig = ready(1002);
    plunge(&mut rig, 0.0);
    let (least, greatest) = size_um(&rig);
    // 8 µm of lag; retracting at once sparks out a little.
    assert!(least > 4.0 && greatest < 9.0, "{least} {greatest}");
}

#[test]
fn p6_a_dull_wheel_needs_longer() {
    let mut rig = ready(1002);
    rig.sim.set_wheel_dullness(1.0);
    plunge(&mut rig, 4.0);
    let (least, greatest) = size_um(&rig);
    // 2·5 µm/s·2 s = 20 µm, after 2 τ: 2.7 µm and 0.5 µm of wear.
    assert!(least > 2.0 && greatest < 4.0, "{least} {greatest}");
}

#[test]
fn p5_the_same_seed_and_the_same_outputs_give_the_same_bits() {
    let course = || {
        let mut rig = ready(1002);
        rig.sim.inject_fault("bounce coolant-flow").unwrap();
        plunge(&mut rig, 1.0);
        (rig.sim.measure(), rig.sim.wheel(), rig.seen, rig.sim.slide_mm())
    };
    assert_eq!(course(), course());
}

#[test]
fn p5_a_tick_of_two_milliseconds_grinds_the_same_part() {
    let size = |tick_us| {
        let mut rig = ready(1002);
        rig.tick.0 = tick_us;
        plunge(&mut rig, 2.0);
        rig.sim.diameter_at(39.0).unwrap()
    };
    // The lag is f·(τ − dt/2): 5 µm/s·1.5 ms apart before the spark-out.
    assert!((size(500) - size(4_000)).abs() < 0.000_05);
}

#[test]
fn p2_the_wheel_wears_by_volume_over_g_and_its_load_follows_the_removal() {
    let mut rig = ready(1002);
    let new = rig.sim.wheel().diameter_mm;
    rig.spin();
    rig.go(60.0, 29.0, 6_000.0);
    rig.go(40.4, 29.0, 6_000.0);
    let idle = rig.sim.wheel().load_percent;
    rig.go(40.1, 29.0, 1.2);
    // 20 µm/s: π·40.1·18·0.02 = 45.4 mm³/s · 40 J/mm³ = 1814 W of 7500: 24 % above idle; the lag costs a little.
    let load = rig.sim.wheel().load_percent - idle;
    assert!((23.0..=24.5).contains(&load), "{load}");
    rig.wait(5.0);
    let worn = new - rig.sim.wheel().diameter_mm;
    // Ø40.3 to 40.1 on 18 mm: 227.4 mm³; over 40·π·600·20/2: 0.000302 mm of diameter (mean over 20 mm).
    assert!((worn - 0.000_302).abs() < 0.000_01, "{worn}");
    assert!((rig.sim.wheel().peripheral_m_s - 31.4).abs() < 0.1);
}

#[test]
fn p4_runout_and_waviness_are_ground_away() {
    let mut rig = ready(1002);
    let before = rig.sim.measure().diameters;
    let spread = |d: &[kt830::io::sim::DiameterAt]| {
        d.iter().map(|at| at.d).fold(f64::NEG_INFINITY, f64::max)
            - d.iter().map(|at| at.d).fold(f64::INFINITY, f64::min)
    };
    assert!(spread(&before) > 0.001, "raw stock is wavy");
    assert!(before.iter().all(|at| (at.d - 40.3).abs() < 0.01), "and its mean is the stock diameter");
    plunge(&mut rig, 6.0);
    assert!(spread(&rig.sim.measure().diameters) < 0.000_1);
}

#[test]
fn p5_too_much_infeed_burns_once_a_contact() {
    let mut rig = ready(1002);
    rig.spin();
    rig.go(40.6, 29.0, 6_000.0);
    // 6 mm/min = 100 µm/s: π·40·0.1 = 12.6 mm³/(mm·s), above 8; overlap 80 µm is no crash.
    rig.go(40.1, 29.0, 6.0);
    assert_eq!(rig.events(), [EventKind::Burn]);
    rig.wait(5.0);
    assert_eq!(rig.events(), [EventKind::Burn]);
}

#[test]
fn p8_rapid_into_the_part_is_a_crash_with_place_and_speed_and_stops_the_machine() {
    let mut rig = ready(1002);
    rig.spin();
    rig.go(38.0, 29.0, 6_000.0);
    let crash = *rig.sim.events().last().unwrap();
    assert_eq!((crash.kind, crash.place), (EventKind::Crash, "part"));
    assert!(crash.speed > 1_000.0 && (crash.x - 39.7).abs() < 0.3, "{crash:?}");
    assert!(rig.input(Input::DriveX) && rig.input(Input::DriveZ));
    rig.wait(0.2);
    let stands = rig.sim.slide_mm();
    rig.wait(0.2);
    assert_eq!(stands, rig.sim.slide_mm());
    assert!(rig.input(Input::DriveX), "it lasts as long as the drives are on");
    rig.out.drives_on = false;
    rig.step();
    rig.step();
    assert!(!rig.input(Input::DriveX), "switching the drives off ends it");
    rig.out.set_point_mm = rig.seen.encoder_mm;
    rig.out.drives_on = true;
    rig.step();
    rig.step();
    rig.go(60.0, 29.0, 6_000.0);
    assert_eq!(rig.events(), [EventKind::Burn, EventKind::Crash], "the wheel comes free without another");
    rig.wait(0.2);
    assert!((rig.sim.slide_mm()[Axis::X] - (30.0 - 230.0)).abs() < 1e-6);
}

#[test]
fn p8_a_standing_wheel_pressed_onto_the_part_is_a_crash() {
    let mut rig = ready(1002);
    rig.switch(Output::HeadstockHigh, true);
    rig.wait(2.0);
    rig.go(40.4, 29.0, 6_000.0);
    rig.go(40.2, 29.0, 1.2);
    assert_eq!(rig.events(), [EventKind::Crash]);
    assert_eq!(rig.sim.events()[0].place, "part, wheel stopped");
}

#[test]
fn p5_a_part_that_stands_gets_a_flat_and_keeps_its_size() {
    let mut rig = ready(1002);
    rig.switch(Output::Wheel, true);
    rig.wait(9.0);
    rig.go(40.4, 29.0, 6_000.0);
    rig.go(40.2, 29.0, 1.2);
    assert_eq!(rig.events(), [EventKind::Flat]);
    assert!((rig.sim.diameter_at(39.0).unwrap() - 40.3).abs() < 0.01);
}

#[test]
fn p8_chuck_and_tailstock_are_in_the_way_only_where_they_are() {
    let mut rig = ready(1002);
    rig.spin();
    rig.go(100.0, 95.0, 6_000.0);
    rig.go(45.0, 95.0, 6_000.0);
    // The wheel reaches from 95 to 115, the tailstock begins at 110, diameter 50.
    assert_eq!((rig.events(), rig.sim.events()[0].place), (vec![EventKind::Crash], "tailstock"));

    let mut rig = ready(1002);
    rig.switch(Output::Tailstock, false);
    rig.wait(2.0);
    rig.spin();
    rig.go(100.0, 95.0, 6_000.0);
    rig.go(45.0, 95.0, 6_000.0);
    assert_eq!(rig.events(), [], "retracted it begins at 140");
    rig.go(145.0, 95.0, 6_000.0);
    rig.go(145.0, -20.0, 6_000.0);
    rig.go(120.0, -20.0, 6_000.0);
    assert_eq!(rig.sim.events()[0].place, "chuck");
}

/// Strokes of O1001 on one face: there and back between X70 and X10, with infeed at both ends, then spark-out.
/// `side` +1 feeds towards +Z. Returns at X70.
fn jaw(rig: &mut Rig, from_z: f64, stages: &[(f64, f64, f64)], side: f64, spark_out: u32) {
    rig.go(70.0, from_z, 6_000.0);
    let (mut z, mut inside) = (from_z, false);
    for &(allowance, step, feed) in stages {
        let to = z + side * allowance;
        while (to - z) * side > 1e-9 {
            z += side * step.min((to - z) * side);
            rig.go(if inside { 10.0 } else { 70.0 }, z, 100.0);
            inside = !inside;
            rig.go(if inside { 10.0 } else { 70.0 }, z, feed);
        }
    }
    for _ in 0..spark_out {
        inside = !inside;
        rig.go(if inside { 10.0 } else { 70.0 }, z, 800.0);
    }
    rig.go(70.0, z, 6_000.0);
}

#[test]
fn p5_jaw_faces_come_to_their_place_within_three_micrometres() {
    for dull in [0.0, 1.0] {
        let mut rig = ready(1001);
        rig.sim.set_wheel_dullness(dull);
        rig.switch(Output::Coolant, true);
        rig.switch(Output::Wheel, true);
        rig.wait(9.0);
        let stages = [(0.2, 0.02, 1_500.0), (0.05, 0.005, 800.0)];
        jaw(&mut rig, 10.0, &stages, -1.0, 4);
        rig.go(70.0, 20.0, 6_000.0);
        // Right corner at 50: the reference point 20 mm towards -Z.
        jaw(&mut rig, 30.0, &stages, 1.0, 4);
        rig.go(120.0, 20.0, 6_000.0);
        let faces = rig.sim.measure().faces;
        assert_eq!(faces.len(), 6);
        for face in &faces {
            let wanted = if face.z < 30.0 { 9.75 } else { 50.25 };
            let off = (face.z - wanted) * 1_000.0;
            assert!(off.abs() < 1.0, "dull {dull}: X{} off by {off} µm", face.x);
        }
        // With 2.5 times the energy it comes to size as well, but burns.
        assert_eq!(rig.events().contains(&EventKind::Burn), dull > 0.0, "dull {dull}");
    }
}

#[test]
fn p5_a_face_is_not_done_in_one_pass() {
    let mut rig = ready(1001);
    rig.switch(Output::Wheel, true);
    rig.wait(9.0);
    rig.go(70.0, 9.96, 6_000.0);
    // The corner comes 1 mm beyond the cell at X22: exp(-1)·20 µm and the contact time leave more than 5 µm there.
    rig.go(20.0, 9.96, 1_500.0);
    rig.go(70.0, 9.96, 6_000.0);
    let (inner, outer) = (rig.sim.face_at(20.5, None).unwrap(), rig.sim.face_at(58.0, None).unwrap());
    assert!(inner - 9.96 > 0.002, "{inner}");
    assert!(outer - 9.96 < 0.001, "{outer}");
}

#[test]
fn p4_a_face_looking_the_other_way_is_touched_by_the_other_side() {
    let mut rig = ready(1001);
    rig.switch(Output::Wheel, true);
    rig.wait(9.0);
    rig.go(70.0, 30.05, 6_000.0);
    rig.go(10.0, 30.05, 800.0);
    rig.go(70.0, 30.05, 800.0);
    let left = rig.sim.face_at(40.0, Some(FaceDirection::PlusZ)).unwrap();
    let right = rig.sim.face_at(40.0, Some(FaceDirection::MinusZ)).unwrap();
    assert!((left - 9.98).abs() < 0.005, "the left face is as it was");
    assert!((right - 50.05).abs() < 0.001, "{right}");
    assert_eq!(rig.sim.face_at(70.0, None), None);
}

#[test]
fn p8_moving_sideways_into_a_jaw_is_a_crash() {
    let mut rig = ready(1001);
    rig.switch(Output::Wheel, true);
    rig.wait(9.0);
    rig.go(40.0, 20.0, 6_000.0);
    rig.go(40.0, 5.0, 3_000.0);
    assert_eq!(rig.events(), [EventKind::Crash]);
    assert!((rig.sim.events()[0].z - 9.68).abs() < 0.06, "{:?}", rig.sim.events()[0]);
}

#[test]
fn p5_a_traverse_along_a_cylinder_grinds_all_of_it() {
    let mut rig = ready_with(1002, |_, part| {
        let SurfaceFile::Diameter { z_from, z_to, .. } = &mut part.surfaces[0] else { unreachable!() };
        (*z_from, *z_to) = (30.0, 90.0);
    });
    rig.spin();
    // Strokes that leave the land on the left and reach its end on the right, 10 µm of diameter each, six to spark out.
    rig.go(60.0, 8.0, 6_000.0);
    for stroke in 0..21 {
        let x = (40.32 - 0.01 * f64::from(stroke)).max(40.2);
        rig.go(x, if stroke % 2 == 0 { 8.0 } else { 84.0 }, 100.0);
        rig.go(x, if stroke % 2 == 0 { 84.0 } else { 8.0 }, 3_000.0);
    }
    rig.go(60.0, 84.0, 6_000.0);
    for at in rig.sim.measure().diameters {
        assert!((at.d - 40.2).abs() < 0.002, "{at:?}");
    }
    assert_eq!(rig.events(), []);
}

/// Past the diamond at a depth of so many mm below the new wheel's front.
fn dress(rig: &mut Rig, depth: f64) {
    dress_at(rig, depth, 200.0);
}

/// The same with a traverse feed, mm/min.
fn dress_at(rig: &mut Rig, depth: f64, feed: f64) {
    // Diamond at machine X-160 Z-60: part radius 70, part Z 340; the wheel reaches 20 mm towards plus.
    rig.go(160.0, 345.0, 6_000.0);
    rig.go(140.0 - 2.0 * depth, 345.0, 1_000.0);
    rig.go(140.0 - 2.0 * depth, 315.0, feed);
    rig.go(160.0, 315.0, 6_000.0);
}

#[test]
fn p6_dressing_takes_the_rim_back_and_sharpens_it() {
    let mut rig = ready(1002);
    rig.spin();
    rig.sim.set_wheel_dullness(0.8);
    dress(&mut rig, 0.02);
    let wheel = rig.sim.wheel();
    assert!((600.0 - wheel.diameter_mm - 0.04).abs() < 0.000_1, "{}", wheel.diameter_mm);
    assert!(wheel.dullness <= 0.0);
    dress(&mut rig, 0.02);
    assert!((600.0 - rig.sim.wheel().diameter_mm - 0.04).abs() < 0.000_1, "the second pass finds nothing");
    assert_eq!(rig.events(), []);
    // The part is then larger by the dressing, as the control has not been told: 40 + 0.04.
    plunge(&mut rig, 6.0);
    let (least, greatest) = size_um(&rig);
    assert!(least > 40.0 && greatest < 41.0, "{least} {greatest}");
}

/// 0.02 mm of Ø600 by 20 mm are π·600·20·0.02 = 754 mm³; at 2 µm/cm³ the first stroke wears the diamond by 1.5 µm: the next one,
/// 0.02 mm deeper, takes that much less. The control books both as 0.02 mm.
#[test]
fn p6_a_diamond_that_wears_leaves_a_larger_wheel() {
    let mut rig = ready_with(1002, |machine, _| machine.dresser.as_mut().unwrap().wear_um_cm3 = 2.0);
    rig.spin();
    dress(&mut rig, 0.02);
    dress(&mut rig, 0.04);
    let larger = 1_000.0 * (rig.sim.wheel().diameter_mm - (600.0 - 0.08));
    // Each stroke wears while it cuts: the mean of what was lost on its way, 1.51/2 behind the first, all of that and the half
    // of the second behind the second: 2.2 µm of radius.
    assert!((larger - 2.0 * 2.2).abs() < 0.2, "{larger} µm");
    assert!((rig.sim.process().diamond_wear_um - 2.9).abs() < 0.15, "{}", rig.sim.process().diamond_wear_um);
}

/// 200 mm/min at 1000 rpm: lead 0.2 mm, 0.02 mm deep; 6 s of spark-out at v_s = π·0.6·1000/60 = 31.4 m/s:
/// Ra = 113.3·√0.2·0.02^¼·(0.05/31416)^0.3 = 113.3·0.44721·0.37606·0.018220 = 0.347 µm. A quarter of the lead: a half.
#[test]
fn p6_the_lead_of_the_dressing_decides_the_roughness() {
    let ra = |feed: f64, spark_out_s: f64| {
        let mut rig = ready(1002);
        rig.spin();
        dress_at(&mut rig, 0.02, feed);
        assert_eq!(rig.sim.measure().roughness, [], "the blank is not ground");
        plunge(&mut rig, spark_out_s);
        let found = rig.sim.measure().roughness;
        assert_eq!((found.len(), found[0].surface), (1, 0), "{found:?}");
        found[0].ra_um
    };
    let sparked_out = ra(200.0, 6.0);
    assert!((sparked_out - 0.347).abs() < 0.007, "{sparked_out}");
    assert!((ra(50.0, 6.0) / sparked_out - 0.5).abs() < 0.01);
    // Without spark-out the last turns still remove π·40·0.005 = 0.63 mm²/s: (0.63/0.05)^0.3 = 2.14.
    let fresh = ra(200.0, 0.0) / sparked_out;
    assert!((fresh - 2.14).abs() < 0.05, "{fresh}");
}

#[test]
fn p6_too_deep_a_dressing_pass_is_a_crash() {
    let mut rig = ready(1002);
    rig.spin();
    dress(&mut rig, 0.15);
    assert_eq!((rig.events(), rig.sim.events()[0].place), (vec![EventKind::Crash], "dresser"));
}
