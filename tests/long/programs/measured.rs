//! Sizes that the operator measures and types after a part: O1005, O1008, O1009 and O1016 correct the next part by them.
//! Source: spec P4, P7, K4.5; decisions "Shipped programs".

use kt830::units::Axis;

use super::shop::{End, Shop, part_of, shop};

/// What an operator types after a part: the variable, and mm.
fn measure(shop: &Shop, program: u32) -> Vec<(u16, f64)> {
    let part = part_of(program);
    let report = shop.rig.machine().measure();
    let length = part.typed_length.zip(report.face_distance(&part.drawing));
    report.typed_sizes(&part.drawing).into_iter().chain(length).collect()
}

/// Grinds parts and types the sizes of each; the typed sizes of each.
fn series(shop: &mut Shop, program: u32, parts: usize) -> Vec<Vec<(u16, f64)>> {
    let mut all = Vec::new();
    for part in 0..parts {
        if part > 0 {
            shop.next_part();
        }
        assert_eq!(shop.run(), End::Finished, "part {part}");
        let sizes = measure(shop, program);
        for (variable, mm) in &sizes {
            shop.set(*variable, *mm);
        }
        all.push(sizes);
    }
    all
}

/// The nominal size of each typed variable, mm.
fn nominal(variable: u16) -> f64 {
    match variable {
        676 | 737 | 876 => 30.0,
        715 | 735 => 15.0,
        716 => 5.0,
        717 => 55.0,
        736 => 25.0,
        other => panic!("#{other}"),
    }
}

/// Greatest deviation of a part, µm.
fn worst_um(sizes: &[(u16, f64)]) -> f64 {
    assert!(!sizes.is_empty(), "nothing was measured");
    sizes.iter().map(|(variable, mm)| (mm - nominal(*variable)).abs() * 1_000.0).fold(0.0, f64::max)
}

/// The worst of each part of a series, µm.
fn series_um(shop: &mut Shop, program: u32, parts: usize) -> Vec<f64> {
    series(shop, program, parts).iter().map(|part| worst_um(part)).collect()
}

/// Starts a part that is refused; the number of the alarm.
fn refused(shop: &mut Shop) -> u16 {
    match shop.run() {
        End::Alarm(number, _) => number,
        other => panic!("{other:?}"),
    }
}

/// A side wear on the page that is 3 µm a part too much: the second part is long by that; what is learnt is at most 0.5 µm a
/// part each time.
#[test]
fn k4_5_o1005_learns_the_side_wear_from_the_measured_length() {
    let mut shop = shop(1005);
    shop.set(659, 0.003_9);
    let off = series_um(&mut shop, 1005, 10);
    assert!(off[1] > 1.5, "{off:?}");
    assert!(off[1..].iter().all(|um| *um < 4.0) && off[8..].iter().all(|um| *um < 1.0), "{off:?}");
    let learnt = shop.value(659).unwrap() * 1_000.0;
    assert!((0.4..1.8).contains(&learnt), "{learnt} µm of 0.9");
    assert_eq!(shop.events(), []);
}

/// The first measurement is the set-up: an error of the probe's offset is corrected there, and nothing is learnt from it.
#[test]
fn k4_5_o1005_corrects_a_wrong_probe_offset_by_the_first_length() {
    for wrong in [-0.1, -0.04, 0.1] {
        let mut shop = shop(1005);
        shop.set(656, 14.999 + wrong);
        let off = series_um(&mut shop, 1005, 4);
        assert!(off[0] > 1_000.0 * f64::abs(wrong) - 3.0, "{off:?}");
        assert!(off[1..].iter().all(|um| *um < 2.0), "{off:?}");
        assert!((shop.value(656).unwrap() - 14.999).abs() < 0.002);
        let learnt = shop.value(659).unwrap() * 1_000.0;
        assert!((0.5..1.3).contains(&learnt), "{learnt} µm of 0.9");
    }
}

/// A length that is typed once and never again moves nothing further.
#[test]
fn k4_5_o1005_a_single_measurement_starts_no_drift() {
    let mut shop = shop(1005);
    shop.set(656, 14.959);
    series(&mut shop, 1005, 1);
    for _ in 0..6 {
        shop.next_part();
        assert_eq!(shop.run(), End::Finished);
    }
    assert!(worst_um(&measure(&shop, 1005)) < 2.0);
}

/// Nothing is measured: wear and offset stay as they are.
#[test]
fn k4_5_o1005_without_a_measured_length_keeps_its_wear() {
    let mut shop = shop(1005);
    shop.grind();
    shop.next_part();
    shop.grind();
    assert!((shop.value(659).unwrap() - 0.000_9).abs() < 1e-12);
    assert!((shop.value(649).unwrap() - 0.001_8).abs() < 1e-12);
    assert!((shop.value(677).unwrap() - 2.0).abs() < 1e-12);
}

/// The wear of a part is the deviation over the parts since the last measurement: 0.3 · 10 µm / 6, at most 0.5.
#[test]
fn k4_5_o1005_divides_by_the_parts_since_the_last_measurement() {
    let mut shop = shop(1005);
    shop.set(677, 6.0).set(676, 29.99).set(678, 30.0).set(679, 1.0).set(659, 0.001);
    assert_eq!(shop.run(), End::Finished);
    assert!((shop.value(659).unwrap() - 0.001_5).abs() < 1e-9, "{:?}", shop.value(659));
    // The whole deviation stands in the total, with the part that follows.
    assert!((shop.value(649).unwrap() - (0.01 + 0.001_5)).abs() < 1e-9, "{:?}", shop.value(649));
    assert_eq!(shop.value(676), None);
}

/// A size counts for the part that was finished, with the values it was ground with: else it is deleted, with an alarm, and
/// nothing has moved; the next start grinds.
#[test]
fn p7_a_size_of_a_part_that_was_not_finished_is_refused() {
    let cases: [(u32, u16, f64, u16, u16); 4] = [
        (1005, 676, 30.01, 640, 3025),
        (1008, 715, 15.01, 701, 3027),
        (1009, 737, 30.01, 728, 3027),
        (1016, 876, 30.01, 861, 3023),
    ];
    for (program, typed, size, target, alarm) in cases {
        // Before the first part.
        let mut first = shop(program);
        first.set(typed, size);
        assert_eq!(refused(&mut first), alarm, "O{program}");
        assert_eq!(first.value(usize::from(typed)), None, "O{program}");
        // After a change of the finished size.
        let mut changed = shop(program);
        assert_eq!(changed.run(), End::Finished, "O{program}");
        changed.next_part();
        let nominal = changed.value(usize::from(target)).unwrap();
        changed.set(target, nominal + 0.001).set(typed, size);
        assert_eq!(refused(&mut changed), alarm, "O{program}");
        crate::stories::tell(&mut changed.rig, "key reset");
        assert_eq!(changed.run(), End::Finished, "O{program}");
    }
}

/// After the first measurement 0.05 mm are a wrong entry: the value stays for correction.
#[test]
fn p7_a_size_far_from_the_last_one_is_refused() {
    let mut shop = shop(1008);
    series(&mut shop, 1008, 2);
    shop.next_part();
    shop.set(715, 15.1);
    assert_eq!(refused(&mut shop), 3023);
    assert_eq!(shop.value(715), Some(15.1));
}

/// Offsets that are off by 0.1 mm in height and across are right after three or four parts.
#[test]
fn p7_o1008_and_o1009_correct_wrong_offsets_by_the_measured_sizes() {
    // The step face of O1009 is not reached from −0.1 on, and its blank says no more than that.
    for (program, last) in [(1008, 3), (1009, 4)] {
        for wrong in [-0.1, 0.1] {
            let mut shop = shop(program);
            crate::stories::tell(&mut shop.rig, &format!("mdi G10 D1 V{wrong} W{wrong}\nmode auto"));
            let mut off = Vec::new();
            for _ in 0..6 {
                assert_eq!(shop.run(), End::Finished, "O{program} {wrong}: {off:?}");
                let sizes = measure(&shop, program);
                off.push(worst_um(&sizes));
                for (variable, mm) in &sizes {
                    // Behind the first, what is further off is refused.
                    if (mm - nominal(*variable)).abs() <= if off.len() > 1 { 0.05 } else { 0.2 } {
                        shop.set(*variable, *mm);
                    }
                }
                shop.next_part();
            }
            assert!(off[0] > 20.0, "O{program}: {off:?}");
            assert!(off[last..].iter().all(|um| *um < 3.0), "O{program} {wrong}: {off:?}");
        }
    }
}

/// What both walls are off by goes into the offset, what the wheel's width is off by to each wall, the floor into the offset.
#[test]
fn p7_o1008_corrects_offset_and_width_of_the_wheel() {
    let mut shop = shop(1008);
    assert_eq!(shop.run(), End::Finished);
    shop.next_part();
    shop.set(715, 15.01).set(716, 5.02).set(717, 55.03);
    assert_eq!(shop.run(), End::Finished);
    let wear = |shop: &mut Shop, axis: Axis| shop.rig.snapshot().offsets.tools[0].wear[axis];
    assert!((wear(&mut shop, Axis::Y) + 0.01).abs() < 1e-9);
    // −20 and −30 µm: −25 in common, 5 to either side.
    assert!((wear(&mut shop, Axis::Z) + 0.025).abs() < 1e-9);
    assert!((shop.value(718).unwrap() - 0.005).abs() < 1e-9);
    assert!((shop.value(719).unwrap() + 0.005).abs() < 1e-9);
    // Behind the first, within 5 µm a part of it, so that noise of the measurement is not followed: 0.7 · 0.001.
    shop.next_part();
    shop.set(716, 5.001);
    assert_eq!(shop.run(), End::Finished);
    assert!((shop.value(718).unwrap() - 0.004_3).abs() < 1e-9);
}

/// The gauge corrects X after each part; the face follows the slope of the infeed and is corrected with it.
#[test]
fn p7_o1016_keeps_its_face_while_the_gauge_corrects_the_diameter() {
    let mut shop = shop(1016);
    crate::stories::tell(&mut shop.rig, "mdi G10 D1 U0.04 W0.03\nmode auto");
    let off = series_um(&mut shop, 1016, 6);
    // 30 µm of Z, less what the infeed ends earlier by for 40 µm of diameter, 0.1 in Z to 0.3 in X: 30 − 40/3.
    assert!((off[0] - 16.7).abs() < 1.0, "{off:?}");
    assert!(off[1..].iter().all(|um| *um < 3.0), "{off:?}");
    assert_eq!(shop.events(), []);
}

/// A face that was off by 3.5 µm once is no wear of that much: what is learnt is at most 0.5 µm a part.
#[test]
fn p7_o1016_learns_little_from_one_measurement() {
    let mut shop = shop(1016);
    series(&mut shop, 1016, 1);
    shop.next_part();
    assert_eq!(shop.run(), End::Finished);
    shop.next_part();
    let before = shop.value(873).unwrap();
    shop.set(876, 30.003_5);
    assert_eq!(shop.run(), End::Finished);
    let learnt = shop.value(873).unwrap() - before;
    assert!((0.000_3..=0.000_5 + 1e-12).contains(&learnt), "{learnt}");
}

/// A face that the wheel has not reached says nothing about the offset: blank 30 + 0.1.
#[test]
fn p7_o1016_refuses_the_face_of_a_blank() {
    let mut shop = shop(1016);
    series(&mut shop, 1016, 1);
    let blank = 30.0 + shop.value(863).unwrap();
    shop.next_part();
    // The first size again, so that 0.1 mm are within what is taken.
    shop.set(879, 0.0).set(876, blank);
    assert_eq!(refused(&mut shop), 3024);
    assert_eq!(shop.value(876), Some(blank));
}

/// A height that was measured before a dressing says nothing of the dressed rim.
#[test]
fn p7_o1008_and_o1009_do_not_correct_a_dressed_rim_by_an_older_size() {
    for (program, typed, state, marks, dressed) in [
        (1008, &[(715, 15.004)][..], 697, &[(696, 15.0), (698, 5.0), (699, 55.0)], 808),
        (1009, &[(735, 15.004), (736, 25.004)], 756, &[(757, 15.0), (758, 25.0), (759, 30.0)], 810),
        (1009, &[(735, 15.004)], 756, &[(757, 15.0), (758, 25.0), (759, 30.0)], 810),
    ] {
        for diameter in [500.0, 500.06] {
            let mut shop = shop(program);
            shop.set(state, 2.0).set(dressed, diameter);
            for (variable, value) in typed.iter().chain(marks) {
                shop.set(*variable, *value);
            }
            assert_eq!(shop.run(), End::Finished, "O{program}");
            // The same wheel: 0.7 of 4 µm, and booked as wear.
            let wanted = if diameter > 500.0 { 0.0 } else { -0.002_8 };
            let wear = shop.rig.snapshot().offsets.tools[0].wear[Axis::Y];
            assert!((wear - wanted).abs() < 1e-9, "O{program} {typed:?} at {diameter}: {wear}");
            assert!((shop.value(814).unwrap() - wanted).abs() < 1e-9, "O{program}");
            assert!(shop.value(738).unwrap_or(0.0).abs() < 1e-12, "O{program}");
        }
    }
}
