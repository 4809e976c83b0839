//! The dressing programs: the wheel has the asked form and is sharp, the control knows its size, and a part that is ground
//! afterwards has the size as before.

use kt830::defs::param;
use kt830::io::sim::PartFile;
use kt830::units::Axis;

use super::shop::{End, Measured, PROGRAMS, Shop, part_of, shop, shop_with, shop_with_wheel};

/// Dresses a dull wheel: all of the rim back by the depth, mm, and the control told.
fn dresses(program: u32, depth_mm: f64) {
    let mut shop = shop(program);
    shop.rig.machine_mut().set_wheel_dullness(0.7);
    let before = shop.rig.controller().system_variable(5_801).unwrap();
    for times in 1..=2 {
        shop.grind();
        let wanted = depth_mm * f64::from(times);
        for (slice, mm) in shop.rig.machine().rim_wear_mm().iter().enumerate() {
            assert!((mm - wanted).abs() < 0.000_5, "O{program}, {times} times: slice {slice} is {mm} mm back");
        }
        assert!(shop.rig.machine().wheel().dullness < 0.01, "O{program}: the wheel is sharp");
        let booked = shop.rig.controller().system_variable(5_801).unwrap();
        assert!((before - booked - 2.0 * wanted).abs() < 1e-9, "O{program}: the control has {booked}");
    }
    assert_eq!(shop.rig.controller().system_variable(5_805), Some(2.0));
}

#[test]
fn p6_o1011_dresses_the_rim_of_the_cylindrical_grinder() {
    // 2 · 0.02 + 0.01 of diameter.
    dresses(1011, 0.025);
}

#[test]
fn p6_o1013_dresses_by_the_roll_of_the_surface_grinder() {
    dresses(1013, 0.03);
}

#[test]
fn p6_o1014_dresses_the_rim_of_the_rotary_grinder() {
    // 2 · 0.01 + 0.005.
    dresses(1014, 0.025);
}

/// Deepest place of the form over a slice of 1 mm: radius 2 on the left, chamfer 1 by 30° on the right.
fn form_mm(from: f64) -> f64 {
    let left = if from < 2.0 { 2.0 - (4.0 - (2.0 - from).powi(2)).sqrt() } else { 0.0 };
    let right = if from >= 19.0 { (from + 1.0 - 19.0) * 30.0_f64.to_radians().tan() } else { 0.0 };
    left.max(right)
}

#[test]
fn p6_o1012_dresses_radius_and_chamfer() {
    // Layers of 0.1 mm of diameter: the same form in less time.
    let mut shop = shop_with(1012, 1, |part| {
        part.variables.insert(784, 0.1);
    });
    shop.grind();
    for (slice, mm) in shop.rig.machine().rim_wear_mm().iter().enumerate() {
        // 0.02 of diameter off the highest place. A tick of 5 µm along the arc's steep foot is 0.14 mm deep.
        let wanted = 0.01 + form_mm(slice as f64);
        let tolerance = if slice == 0 { 0.15 } else { 0.006 };
        assert!((mm - wanted).abs() < tolerance, "slice {slice}: {mm} mm, wanted {wanted}");
    }
    assert_eq!(shop.value(787), Some(2.0), "the next time it only dresses again");
    let before = shop.rig.machine().rim_wear_mm().to_vec();
    shop.grind();
    for (before, after) in before.iter().zip(shop.rig.machine().rim_wear_mm()) {
        assert!((after - before - 0.01).abs() < 0.15, "{before} {after}");
    }
}

/// Deepest place over a slice of 1 mm of the wheel of O1020 as shipped, as the tip of 0.5 mm leaves it: lands at 0 and 1,
/// slopes of 45° from 0 to 1, 8 to 9 and 15 to 16. Corners that stand out stay sharp; the tip fills those in hollows by
/// its fillet, which ends within 0.5·tan(22.5°) = 0.21 mm of the corner.
fn polyline_mm(slice: f64) -> f64 {
    match slice as u32 {
        0 | 8 | 15 | 9..15 => 1.0,
        _ => 0.0,
    }
}

#[test]
fn p6_o1020_dresses_the_contour_whatever_the_radius_of_the_diamond() {
    for radius in [0.0, 0.2, 0.5] {
        let mut shop = shop_with(1020, 1, |part| {
            part.diamond_radius_mm = radius;
            part.variables.insert(941, radius);
            part.variables.insert(942, 0.1);
        });
        shop.grind();
        for (slice, mm) in shop.rig.machine().rim_wear_mm().iter().enumerate() {
            // 0.02 of diameter off the highest place.
            // At the foot of a slope, at r·tan(22.5°) from the middle of the tip: r − √(r² − (0.414 r)²) = 0.0898 r left.
            let fillet = if [8, 15].contains(&slice) { 0.089_8 * radius } else { 0.0 };
            let wanted = 0.01 + polyline_mm(slice as f64) - fillet;
            assert!((mm - wanted).abs() < 0.006, "radius {radius}, slice {slice}: {mm} mm, wanted {wanted}");
        }
        assert_eq!(shop.value(940), Some(2.0), "the next time it only dresses again");
        let before = shop.rig.machine().rim_wear_mm().to_vec();
        shop.grind();
        for (before, after) in before.iter().zip(shop.rig.machine().rim_wear_mm()) {
            assert!((after - before - 0.01).abs() < 0.006, "{before} {after}");
        }
    }
}

/// Without compensation a tip of 0.5 mm takes 0.5·(1 − tan 22.5°) too much beside a slope that rises.
#[test]
fn p6_o1020_with_a_wrong_radius_spoils_the_contour() {
    let mut shop = shop_with(1020, 1, |part| {
        part.variables.insert(941, 0.0);
        part.variables.insert(942, 0.1);
    });
    shop.grind();
    let wear = shop.rig.machine().rim_wear_mm();
    let worst = wear.iter().enumerate().map(|(slice, mm)| (mm - 0.01 - polyline_mm(slice as f64)).abs());
    assert!(worst.fold(0.0, f64::max) > 0.1, "{wear:?}");
}

/// A hollow that is narrower than the tip needs.
#[test]
fn p6_o1020_refuses_a_hollow_that_the_diamond_does_not_reach() {
    let mut shop = shop(1020);
    // Between the slopes 1 mm is left at the bottom: enough for a tip of 1/(2·tan(22.5°)) = 1.2 mm.
    shop.set(954, 10.0).set(956, 11.0).set(941, 1.3);
    let before = shop.rig.machine().slide_mm();
    assert!(matches!(shop.run(), End::Alarm(3_054, _)));
    assert_eq!(shop.rig.machine().slide_mm(), before);
}

#[test]
fn p6_o1012_wants_an_offset_in_force_and_one_form() {
    for (variable, value, alarm) in
        [(783, 0.02, 3043), (780, 30.0, 3041), (782, 80.0, 3042), (784, 0.5, 3045), (787, 3.0, 3010)]
    {
        let mut shop = shop(1012);
        shop.set(variable, value);
        let End::Alarm(number, text) = shop.run() else { panic!("#{variable}={value} was not refused") };
        assert_eq!(number, alarm, "#{variable}={value}: {text}");
    }
}

/// A part of another program goes into the machine, with its frame and values.
fn change_over(shop: &mut Shop, program: u32) {
    shop.part = part_of(program);
    shop.load(program);
    shop.rig.mount_part(&shop.part);
    shop.rig.step();
}

#[test]
fn k4_1_a_part_has_its_size_after_every_dressing() {
    for (dressing, program, wanted) in [(1011, 1002, 40.0), (1014, 1010, 25.0)] {
        let mut shop = shop(dressing);
        shop.grind();
        change_over(&mut shop, program);
        shop.grind();
        let worst = shop.worst_um(|_| wanted);
        assert!(worst.abs() < 3.0, "O{program} after O{dressing}: {worst} µm");
    }
}

/// The values of the page are off the dresser; the points are set by key where the new wheel touches it.
fn dresses_at_the_key(program: u32, off: [u16; 3], to_dresser: &str, keys: &str, depth_mm: f64) {
    let mut shop = shop_with(program, 1, |part| {
        for variable in off.into_iter().filter(|variable| *variable > 0) {
            *part.variables.get_mut(&variable).unwrap() += 25.0;
        }
    });
    crate::stories::tell(
        &mut shop.rig,
        &format!("mode mdi\n{to_dresser}\nwait 0.5 s\nmode jog\npage position\nkey f1"),
    );
    crate::stories::tell(&mut shop.rig, &format!("{keys}\nmode auto"));
    for times in 1..=2 {
        shop.grind();
        for mm in shop.rig.machine().rim_wear_mm() {
            let wanted = depth_mm * f64::from(times);
            assert!((mm - wanted).abs() < 0.001, "O{program}, {times} times: {mm} mm");
        }
    }
}

#[test]
fn k4_2_every_dressing_program_uses_the_point_that_was_set_by_key() {
    let go = |blocks: &[&str]| -> String {
        blocks.iter().map(|block| format!("mdi G53 {block}\nwait until idle\n")).collect()
    };
    let keys = |axes: &[&str]| -> String {
        axes.iter().map(|axis| format!("key address-{axis}\nkey input\nexpect message \"成功\"\n")).collect()
    };
    let gc = go(&["G00 X0", "G00 Z-60", "G00 X-318", "G01 X-320 F200"]);
    dresses_at_the_key(1011, [760, 761, 0], &gc, &keys(&["x", "z"]), 0.025);
    let value = |program: u32, variable: u16| part_of(program).variables[&variable];
    let (x, z, y) = (value(1013, 800), value(1013, 801), value(1013, 802));
    let gs = go(&["G00 Y0", &format!("G00 X{x} Z{z}"), &format!("G01 Y{y} F1000")]);
    dresses_at_the_key(1013, [800, 801, 802], &gs, &keys(&["x", "y", "z"]), 0.03);
    let (x, z) = (value(1014, 820), value(1014, 821));
    let ga = go(&["G00 Z0", &format!("G00 X{x}"), &format!("G01 Z{z} F1000")]);
    dresses_at_the_key(1014, [820, 821, 0], &ga, &keys(&["x", "z"]), 0.025);
}

#[test]
fn k5_17_the_factory_range_of_dressing_programs_is_that_of_the_kind() {
    for (program, kind) in PROGRAMS.into_iter().filter(|(program, _)| (1011..=1014).contains(program)) {
        let params = kt830::defs::param::Params::factory(kind);
        let range = params.get(param::DRESSING_PROGRAM_FIRST)..=params.get(param::DRESSING_PROGRAM_LAST);
        assert!(range.contains(&f64::from(program)), "O{program} on {kind:?}");
        assert_eq!(PartFile::builtin(program).unwrap().unwrap().kind, kind);
    }
}

/// The dressing point is wrong by more than the depth: the diamond or roll is not touched.
fn misses(program: u32, point: u16, off: f64) -> Shop {
    let mut shop = shop(program);
    let right = shop.value(usize::from(point)).unwrap();
    shop.set(point, right + off);
    shop
}

/// `run O1011 --set '#760=-319.95'` booked 0.05 mm that nobody had cut; four parts of O1002 came out −49, −98 and −99 µm.
#[test]
fn p6_a_dressing_that_touches_nothing_is_an_alarm_and_books_nothing() {
    for (program, point, total, off) in
        [(1011, 760, 772, 0.11), (1020, 760, 772, 2.5), (1013, 802, 806, 0.5), (1014, 821, 828, 0.2)]
    {
        let mut shop = misses(program, point, off);
        let (before, dressed) = (shop.rig.controller().system_variable(5_801), shop.value(total));
        let end = shop.run();
        assert!(matches!(&end, End::Alarm(3_025, _)), "O{program}: {end:?}");
        assert_eq!(shop.rig.controller().system_variable(5_801), before, "O{program}");
        assert_eq!((shop.value(total), shop.rig.controller().system_variable(5_805)), (dressed, Some(0.0)));
        assert!(shop.rig.machine().rim_wear_mm().iter().all(|mm| *mm < 1e-12), "O{program} has cut");
    }
    // A program that dresses before its part grinds none.
    let mut shop = misses(1002, 760, 0.2);
    shop.set(531, 1.0).grind();
    shop.next_part();
    let end = shop.run();
    assert!(matches!(&end, End::Alarm(3_025, _)), "{end:?}");
    assert_eq!(shop.rig.retained().part_count, 1);
}

/// Grinds parts until the least worn slice of the rim is back by this much, mm.
fn wear_out(shop: &mut Shop, mm: f64) -> f64 {
    let least = |shop: &Shop| shop.rig.machine().rim_wear_mm().iter().copied().fold(f64::INFINITY, f64::min);
    for part in 0..24 {
        if least(shop) > mm {
            break;
        }
        shop.next_part();
        assert_eq!(shop.run(), End::Finished, "part {part}");
    }
    let worn = least(shop);
    assert!(worn > mm, "{worn} mm of wear");
    worn
}

/// A wheel that has lost more than the dressing depth is dressed from its worn surface on. The roll stood in the air:
/// alarm 3025 after eleven parts with a soft wheel.
#[test]
fn p6_a_wheel_that_has_worn_more_than_the_depth_is_dressed_from_its_surface_on() {
    for (part, dressing, depth_mm, ratio, key) in [(1010, 1014, 0.025, 6.0, 754), (1008, 1013, 0.03, 0.55, 812)] {
        let mut shop = shop_with_wheel(part, ratio, |_| ());
        shop.set(key, 0.0);
        let (mut booked, mut dressed) = (500.0, 0.0);
        // The first dressing finds the dressing point, the second measures the wear.
        for dressings in 1..=2 {
            // O1008 has no gauge and follows no wear: it grinds less each time.
            let more = if dressings == 1 { depth_mm + 0.005 } else { 0.012 };
            let worn = wear_out(&mut shop, dressed + more);
            shop.load(dressing);
            assert_eq!(shop.run(), End::Finished, "O{dressing}");
            let before = std::mem::replace(&mut booked, shop.rig.controller().system_variable(5_801).unwrap());
            let wear = if dressings == 1 { 0.0 } else { worn - dressed };
            let smaller = (before - booked) / 2.0;
            assert!((smaller - wear - depth_mm).abs() < 0.003, "O{dressing}: {smaller} after {wear} of wear");
            dressed = worn + depth_mm;
            let rim = shop.rig.machine().rim_wear_mm();
            assert!(rim.iter().all(|mm| *mm > dressed - 0.002), "O{dressing}: {rim:?}, {dressed}");
            shop.load(part);
        }
    }
}

/// The wear that one program has corrected is given back by the dressing of another one: they share offset and wheel. A
/// floor of O1008 was 9 µm too deep behind six parts of O1007.
#[test]
fn p6_the_dressing_gives_back_the_wear_whoever_has_corrected_it() {
    let mut shop = shop_with_wheel(1007, 10.0, |_| ());
    shop.load(1013);
    assert_eq!(shop.run(), End::Finished);
    shop.load(1007);
    shop.set(811, 0.0);
    for _ in 0..4 {
        shop.next_part();
        shop.grind();
    }
    let worn = shop.value(814).unwrap();
    assert!(worn < -0.003, "{worn}");
    let wear = |shop: &mut Shop| shop.rig.snapshot().offsets.tools[0].wear[Axis::Y];
    let (before, diameter) = (wear(&mut shop), shop.rig.controller().system_variable(5_801).unwrap());
    shop.load(1013);
    assert_eq!(shop.run(), End::Finished);
    // The offset follows the diameter. At most what was measured is given back, in steps of the encoder.
    let smaller = (diameter - shop.rig.controller().system_variable(5_801).unwrap()) / 2.0;
    let given_back = wear(&mut shop) - before + smaller;
    assert!((-worn - 0.001..=-worn + 1e-9).contains(&given_back), "{given_back} of {worn}");
    assert_eq!(shop.value(814), Some(0.0));
    // The size stays, at once.
    shop.load(1007);
    shop.next_part();
    shop.grind();
    let worst = shop.worst_um(|_| 20.0);
    assert!(worst.abs() < 2.0, "{worst} µm");
}

/// A dressing point that was set anew is found by the contact, and the offset changes by the depth alone: 0.1 mm of it stood
/// for wear, and the next floor was 0.1 mm too deep.
#[test]
fn p6_a_dressing_point_that_was_set_anew_is_no_wear() {
    for (part, dressing, point, right) in [(1008, 1013, 802, -240.0), (1010, 1014, 821, -200.0)] {
        let mut shop = shop(part);
        for off in [-0.04, 0.1, 0.07] {
            shop.set(point, right + off).load(dressing);
            assert_eq!(shop.run(), End::Finished, "O{dressing}");
            shop.load(part);
            shop.next_part();
            shop.grind();
            let worst = shop.worst_um(|at| nominal(part, at));
            assert!(worst.abs() < 3.0, "O{part}, point {off} mm off: {worst} µm");
        }
    }
}

/// A wheel that stands 0.3 mm before its booked place is not fed into the roll or the diamond: it was, and crashed.
#[test]
fn p6_a_wheel_that_is_larger_than_booked_is_an_alarm_at_the_first_touch() {
    for (dressing, point, right) in [(1013, 802, -240.0), (1014, 821, -200.0)] {
        let mut shop = shop(dressing);
        shop.set(point, right - 0.3);
        let end = shop.run();
        assert!(matches!(&end, End::Alarm(3_028, _)), "O{dressing}: {end:?}");
        assert_eq!((shop.events(), shop.rig.controller().system_variable(5_805)), (Vec::new(), Some(0.0)));
    }
}

/// RESET in the dwell of a dressing: the next one takes what was cut already for no wear, and books it.
#[test]
fn p6_a_dressing_that_was_broken_off_is_done_again() {
    let mut shop = shop(1013);
    assert_eq!(shop.run(), End::Finished);
    crate::stories::tell(&mut shop.rig, "key cycle-start");
    let least = |shop: &Shop| shop.rig.machine().rim_wear_mm().iter().copied().fold(f64::INFINITY, f64::min);
    for _ in 0..60_000 {
        shop.rig.step();
        if least(&shop) > 0.055 {
            break;
        }
    }
    crate::stories::tell(&mut shop.rig, "key reset\nwait 2 s");
    let cut = least(&shop);
    assert!((0.055..0.061).contains(&cut), "{cut}");
    assert_eq!(shop.run(), End::Finished);
    let back = (500.0 - shop.rig.controller().system_variable(5_801).unwrap()) / 2.0;
    assert!((back - least(&shop)).abs() < 0.003 && (back - cut - 0.03).abs() < 0.003, "{back} of {cut}");
}

/// At the same point more than 0.01 mm a part is no wear but another wheel: nothing is dressed. A wheel of G 0.05 loses
/// 300 mm³/0.05 over π·500·40 mm, 95 µm, on a slot.
#[test]
fn p6_a_wear_that_cannot_be_is_an_alarm_and_nothing_is_dressed() {
    let mut shop = shop_with_wheel(1008, 0.05, |_| ());
    shop.load(1013);
    assert_eq!(shop.run(), End::Finished);
    shop.load(1008);
    shop.next_part();
    assert_eq!(shop.run(), End::Finished);
    let (booked, rim) = (shop.rig.controller().system_variable(5_801), shop.rig.machine().rim_wear_mm().to_vec());
    shop.load(1013);
    let end = shop.run();
    assert!(matches!(&end, End::Alarm(3_029, _)), "{end:?}");
    assert_eq!((shop.rig.controller().system_variable(5_801), shop.events()), (booked, Vec::new()));
    let cut = rim.iter().zip(shop.rig.machine().rim_wear_mm()).map(|(before, after)| after - before);
    assert!(cut.fold(0.0, f64::max) < 0.001, "touched, not dressed");
}

/// The finished sizes of the parts of the surface and rotary grinders.
fn nominal(program: u32, at: Measured) -> f64 {
    match (program, at) {
        (1007, _) => 20.0,
        (1010, _) => 25.0,
        (1008, Measured::Face(z)) if z < 30.0 => 5.0,
        (1008, Measured::Face(_)) => 55.0,
        (1009, Measured::Height(z)) if z > 30.0 => 25.0,
        (1009, Measured::Face(_)) => 30.0,
        _ => 15.0,
    }
}

/// O1007 to O1010 dress after their interval before they grind, and the size stays.
#[test]
fn k7_10_surface_and_rotary_programs_dress_after_their_interval() {
    for (program, interval, tolerance_um) in [(1007, 811, 2.0), (1008, 812, 3.0), (1009, 813, 3.0), (1010, 754, 2.0)] {
        let mut shop = shop(program);
        shop.set(interval, 2.0);
        for part in 1..=3_u32 {
            if part > 1 {
                shop.next_part();
            }
            shop.grind();
            let worst = shop.worst_um(|at| nominal(program, at));
            assert!(worst.abs() < tolerance_um, "O{program}, part {part}: {worst} µm");
            let dressings = f64::from((part - 1) / 2);
            assert_eq!(shop.rig.controller().system_variable(5_805), Some(dressings), "O{program}, part {part}");
        }
    }
}

/// A monitor that is dead says the same; without one (P358=0) the program books what it has fed in.
#[test]
fn p6_a_dead_contact_monitor_books_nothing_and_without_a_monitor_the_infeed_counts() {
    let mut dead = shop(1011);
    crate::stories::tell(&mut dead.rig, "input wheel-contact off");
    assert!(matches!(dead.run(), End::Alarm(3_025, _)));
    let mut without = misses(1011, 760, 0.11);
    crate::stories::tell(&mut without.rig, "param P358 0");
    assert_eq!(without.run(), End::Finished);
    assert_eq!(without.rig.controller().system_variable(5_827), None);
    assert!((without.rig.controller().system_variable(5_801).unwrap() - 599.95).abs() < 1e-9);
}

/// Before it dresses a worn wheel, O1011 measures it at the diamond; a monitor that is dead by then measures nothing.
#[test]
fn p6_a_wheel_that_cannot_be_measured_is_an_alarm_and_books_nothing() {
    let mut shop = shop(1011);
    assert_eq!(shop.run(), End::Finished);
    shop.load(1002);
    let part = super::shop::part_of(1002);
    shop.rig.mount_part(&part);
    assert_eq!(shop.run(), End::Finished);
    let (diameter, wear) = (shop.rig.controller().system_variable(5_801), shop.value(774));
    shop.load(1011);
    crate::stories::tell(&mut shop.rig, "input wheel-contact off");
    let end = shop.run();
    assert!(matches!(&end, End::Alarm(3_024, _)), "{end:?}");
    assert_eq!((shop.rig.controller().system_variable(5_801), shop.value(774)), (diameter, wear));
}

/// A contour of O1020: distances from the left edge and depths, mm (radius).
type Contour = Vec<(f64, f64)>;

/// Random points from edge to edge, of which one at least is not deep.
fn random_contour(chance: &mut impl FnMut() -> f64) -> Contour {
    let points = 2 + (chance() * 6.0) as usize;
    let mut contour: Contour = (0..points).map(|_| (0.5 + 19.0 * chance(), (chance() * 8.0).floor() / 10.0)).collect();
    contour.sort_by(|a, b| a.0.total_cmp(&b.0));
    let last = points - 1;
    (contour[0].0, contour[last].0) = (0.0, 20.0);
    contour[(chance() * points as f64) as usize].1 = 0.0;
    contour
}

/// Distance of a place beyond a contour from it, mm; negative inside of the wheel.
fn clearance_mm(contour: &Contour, z: f64, out: f64) -> f64 {
    let mut least = f64::INFINITY;
    let mut inside = false;
    for pair in contour.windows(2) {
        let ((z0, d0), (z1, d1)) = (pair[0], pair[1]);
        let (along, rise) = (z1 - z0, d0 - d1);
        let share = (((z - z0) * along + (out + d0) * rise) / (along * along + rise * rise)).clamp(0.0, 1.0);
        least = least.min((z - z0 - share * along).hypot(out + d0 - share * rise));
        inside |= (z0..=z1).contains(&z) && out < -(d0 + (d1 - d0) * (z - z0) / along);
    }
    if inside { -least } else { least }
}

/// Whatever the contour: the round tip touches it and never goes deeper.
#[test]
fn p6_o1020_no_contour_is_cut_too_deep() {
    let mut state = 20_u64;
    let mut chance = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut dressed, mut refused) = (0, 0);
    for _ in 0..40 {
        let contour = random_contour(&mut chance);
        let radius = [0.2, 0.5, 1.0, 2.0][(chance() * 4.0) as usize];
        let mut shop = shop_with(1020, 1, |part| {
            part.diamond_radius_mm = radius;
            part.variables.extend([(941, radius), (942, 0.08), (943, 0.08), (944, 300.0), (945, contour.len() as f64)]);
            for ((z, depth), variable) in contour.iter().zip((946..).step_by(2)) {
                part.variables.extend([(variable, *z), (variable + 1, 2.0 * depth)]);
            }
        });
        shop.rig.send(kt830::link::Command::Press(kt830::defs::key::Key::CycleStart));
        let (mut least, mut touched) = (f64::INFINITY, 0_u32);
        for _ in 0..20 {
            shop.rig.step();
        }
        while shop.rig.controller().state() == kt830::link::snapshot::RunState::Running {
            shop.rig.step();
            // The tip's centre as the last layer sees it: 0.04 beyond the rim of before, the dresser at (-160, -60).
            let at = shop.rig.controller().set_point();
            let (z, out) = (-60.0 - at[Axis::Z], at[Axis::X] + 160.04 + radius);
            let clearance = clearance_mm(&contour, z, out) - radius;
            least = least.min(clearance);
            touched += u32::from(clearance < 0.001);
        }
        if shop.rig.snapshot().alarms.iter().any(|alarm| (3_021..=3_054).contains(&alarm.number)) {
            refused += 1;
            continue;
        }
        assert!(
            shop.rig.snapshot().alarms.is_empty(),
            "{contour:?}, radius {radius}: {:?}",
            shop.rig.snapshot().alarms
        );
        // The path is followed to 10 µm at the most (exact stop: to the micrometre).
        assert!(least > -0.001, "{contour:?}, radius {radius}: {least} mm too deep");
        assert!(touched > 100, "{contour:?}, radius {radius}: {touched} ticks in touch");
        dressed += 1;
    }
    assert!(dressed >= 20 && refused >= 2, "{dressed} dressed, {refused} refused");
}
