//! O1019: parts are measured after grinding, and the next one is corrected; matched grinding to a measured bore.
//! Source: spec K4.1, K7.6 (programs of the customer's machine); decisions "Grinding".

use kt830::units::Axis;

use super::shop::{End, Shop, shop, shop_with};

/// Measures the part that was ground, as the operator does at the bench, mm.
fn measured(shop: &Shop) -> f64 {
    let report = shop.rig.machine().measure();
    report.diameters.iter().map(|at| at.d).sum::<f64>() / report.diameters.len() as f64
}

/// Grinds parts and types in the size of each; the deviations from a target, µm.
fn series(shop: &mut Shop, parts: usize, target: f64) -> Vec<f64> {
    let mut off = Vec::new();
    for part in 0..parts {
        if part > 0 {
            shop.next_part();
        }
        let mut end = shop.run();
        // The part before is out of tolerance: it is put aside, and the machine started again.
        if matches!(end, End::Alarm(3_069, _)) {
            crate::stories::tell(&mut shop.rig, "key reset");
            end = shop.run();
        }
        assert_eq!(end, End::Finished);
        let size = measured(shop);
        off.push((size - target) * 1_000.0);
        shop.set(930, size);
    }
    off
}

#[test]
fn k4_1_o1019_a_wrong_offset_is_corrected_by_the_first_part() {
    for wrong in [-0.1, 0.1] {
        let mut shop = shop(1019);
        crate::stories::tell(&mut shop.rig, &format!("mdi G10 D1 U{wrong}\nmode auto"));
        let off = series(&mut shop, 3, 40.0);
        assert!(off[0].abs() > 90.0, "{off:?}");
        assert!(off[1..].iter().all(|um| um.abs() < 2.0), "{off:?}");
        assert_eq!(shop.value(938), Some(2.0));
        assert_eq!(shop.events(), []);
    }
}

/// The wheel of the file wears 0.5 µm of diameter a part; the correction keeps pace, before a dressing and behind it.
#[test]
fn k4_1_o1019_follows_the_wear_of_the_wheel() {
    let mut shop = shop(1019);
    let off = series(&mut shop, 25, 40.0);
    assert!(off[2..].iter().all(|um| um.abs() < 2.0), "{off:?}");
    // 22 parts at 0.5 µm are 11 µm without correction.
    let total = shop.value(939).unwrap();
    assert!(total > 0.005, "{total}");
}

/// Nothing is measured: nothing is corrected.
#[test]
fn k4_1_o1019_without_a_measured_size_leaves_the_offset() {
    let mut shop = shop(1019);
    shop.grind();
    shop.next_part();
    shop.grind();
    assert_eq!(shop.rig.controller().system_variable(2_001), Some(0.0));
    assert_eq!(shop.value(938), Some(0.0));
}

#[test]
fn k4_1_o1019_refuses_a_typing_error_and_tells_a_part_out_of_tolerance() {
    let mut shop = shop(1019);
    shop.grind();
    shop.next_part();
    shop.set(930, 4.0);
    assert!(matches!(shop.run(), End::Alarm(3_068, _)));
    assert_eq!(shop.rig.controller().system_variable(2_001), Some(0.0), "nothing was corrected");
    crate::stories::tell(&mut shop.rig, "key reset");
    shop.set(930, 40.02);
    assert!(matches!(shop.run(), End::Alarm(3_069, _)));
    // The whole deviation of the first measured part: 0.02 of diameter towards the part.
    assert!((shop.rig.controller().system_variable(2_001).unwrap() + 0.02).abs() < 1e-9);
    assert_eq!(shop.value(930), None, "the size is taken once");
}

#[test]
fn k4_1_o1019_grinds_each_pin_to_its_bore() {
    let mut shop = shop_with(1019, 1, |part| {
        part.variables.insert(936, 0.008);
    });
    for bore in [40.004, 40.011, 39.998] {
        shop.set(935, bore);
        assert_eq!(shop.run(), End::Finished);
        let clearance = bore - measured(&shop);
        assert!((clearance - 0.008).abs() < 0.002, "bore {bore}: clearance {clearance}");
        let size = measured(&shop);
        shop.next_part();
        shop.set(930, size);
    }
    assert_eq!(shop.events(), []);
    assert!(shop.rig.machine().slide_mm()[Axis::X] > -230.0, "the wheel is clear");
}

/// What the first part corrects is the set-up, no wear: a dressing does not give it back.
#[test]
fn k4_1_o1019_a_dressing_keeps_the_correction_of_the_set_up() {
    let mut shop = shop_with(1019, 1, |part| {
        part.variables.insert(929, 4.0);
    });
    crate::stories::tell(&mut shop.rig, "mdi G10 D1 U0.1\nmode auto");
    let off = series(&mut shop, 10, 40.0);
    assert!(off[1..].iter().all(|um| um.abs() < 2.0), "{off:?}");
}

/// A part that was broken off has no size that belongs to its target.
#[test]
fn k4_1_o1019_a_part_that_was_broken_off_is_not_compared() {
    let mut shop = shop(1019);
    shop.grind();
    shop.next_part();
    shop.set(921, 40.2);
    crate::stories::tell(&mut shop.rig, "mode auto\nkey cycle-start\nwait 20 s\nkey reset\nwait 1 s");
    shop.set(930, 40.25);
    shop.next_part();
    assert_eq!(shop.run(), End::Finished);
    assert_eq!(shop.rig.controller().system_variable(2_001), Some(0.0));
    assert!((measured(&shop) - 40.2).abs() < 0.002, "{}", measured(&shop));
}
