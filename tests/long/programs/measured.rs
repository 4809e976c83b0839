//! Sizes that the operator measures and types after a part: O1005, O1008, O1009 and O1016 correct the next part by them.
//! Source: spec P4, P7, K4.5; decisions "Shipped programs".

use kt830::units::Axis;

use super::shop::{End, Shop, part_of, shop};

/// What a part is off by at each typed size: the variable, and mm.
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
    sizes.iter().map(|(variable, mm)| (mm - nominal(*variable)).abs() * 1_000.0).fold(0.0, f64::max)
}

/// A side wear on the page that is 3 µm a part too much: the second part is long by that, and a half is learnt each time.
#[test]
fn k4_5_o1005_learns_the_side_wear_from_the_measured_length() {
    let mut shop = shop(1005);
    shop.set(659, 0.003_9);
    let sizes = series(&mut shop, 1005, 8);
    let off: Vec<f64> = sizes.iter().map(|part| worst_um(part)).collect();
    assert!(off[1] > 1.5, "{off:?}");
    assert!(off[4..].iter().all(|um| *um < 1.5), "{off:?}");
    let learnt = shop.value(659).unwrap() * 1_000.0;
    assert!((0.4..1.5).contains(&learnt), "{learnt} µm of 0.9");
    assert!(shop.value(676).is_some(), "the last size waits for the next part");
    assert_eq!(shop.events(), []);
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

/// A length of several parts ago: the wear of a part is what the deviation is over the parts since.
#[test]
fn k4_5_o1005_divides_by_the_parts_since_the_last_measurement() {
    let mut shop = shop(1005);
    shop.set(677, 5.0).set(676, 29.99).set(659, 0.001);
    assert_eq!(shop.run(), End::Finished);
    // 10 µm short over 5 parts, a half of it: 1 + 0.5 · 10/5 µm.
    assert!((shop.value(659).unwrap() - 0.002).abs() < 1e-9, "{:?}", shop.value(659));
    // The whole of it stands in the total, with the part that follows.
    assert!((shop.value(649).unwrap() - (0.01 + 0.002)).abs() < 1e-9, "{:?}", shop.value(649));
    assert_eq!(shop.value(676), None);
}

/// Offsets that are off by 0.05 mm in height and across are right from the second or third part on.
#[test]
fn p7_o1008_and_o1009_correct_wrong_offsets_by_the_measured_sizes() {
    for program in [1008, 1009] {
        for wrong in [-0.05, 0.05] {
            let mut shop = shop(program);
            crate::stories::tell(&mut shop.rig, &format!("mdi G10 D1 V{wrong} W{wrong}\nmode auto"));
            let off: Vec<f64> = series(&mut shop, program, 4).iter().map(|part| worst_um(part)).collect();
            assert!(off[0] > 40.0, "O{program}: {off:?}");
            assert!(off[2..].iter().all(|um| *um < 3.0), "O{program}: {off:?}");
        }
    }
}

/// The slot's walls are corrected one by one, the floor by the offset.
#[test]
fn p7_o1008_corrects_each_wall_for_itself() {
    let mut shop = shop(1008);
    shop.set(715, 15.01).set(716, 5.02).set(717, 55.03);
    assert_eq!(shop.run(), End::Finished);
    assert!((shop.rig.snapshot().offsets.tools[0].wear[Axis::Y] + 0.01).abs() < 1e-9);
    assert!((shop.value(718).unwrap() + 0.02).abs() < 1e-9);
    assert!((shop.value(719).unwrap() + 0.03).abs() < 1e-9);
    // Within 2 µm a part of it, so that noise of the measurement is not followed: 0.7 · 0.001.
    shop.next_part();
    shop.set(716, 5.001);
    assert_eq!(shop.run(), End::Finished);
    assert!((shop.value(718).unwrap() + 0.020_7).abs() < 1e-9);
}

/// The gauge corrects X after each part; the face follows the slope of the infeed and is corrected with it.
#[test]
fn p7_o1016_keeps_its_face_while_the_gauge_corrects_the_diameter() {
    let mut shop = shop(1016);
    crate::stories::tell(&mut shop.rig, "mdi G10 D1 U0.04 W0.03\nmode auto");
    let off: Vec<f64> = series(&mut shop, 1016, 6).iter().map(|part| worst_um(part)).collect();
    // 30 µm of Z, less what the infeed ends earlier by for 40 µm of diameter, 0.1 in Z to 0.3 in X: 30 − 40/3.
    assert!((off[0] - 16.7).abs() < 1.0, "{off:?}");
    assert!(off[1..].iter().all(|um| *um < 3.0), "{off:?}");
    assert_eq!(shop.events(), []);
}
