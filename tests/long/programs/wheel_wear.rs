//! O1002: the wheel is measured at the diamond (O9013), the blank is found by contact (G31 P9).

use kt830::io::sim::{EventKind, PartFile, SurfaceFile};
use kt830::units::Axis;

use super::batch::TOLERANCE_UM;
use super::shop::{End, Shop, shop, shop_with_wheel};
use crate::stories::tell;

/// Wear of a wheel of G 10 on the diameter by a part of O1002: 340 mm³/10 over π·600·18 mm, twice, mm.
const SOFT_WEAR_MM: f64 = 2.0 * 34.0 / (std::f64::consts::PI * 600.0 * 18.0);

/// O1002 on a machine whose wheel has this grinding ratio, freshly dressed.
fn dressed(ratio: f64) -> Shop {
    dressed_for(ratio, |_| ())
}

fn dressed_for(ratio: f64, change: impl FnOnce(&mut PartFile)) -> Shop {
    let mut shop = shop_with_wheel(1002, ratio, change);
    shop.load(1011);
    assert_eq!(shop.run(), End::Finished, "the wheel is dressed once");
    shop.load(1002);
    shop
}

/// Grinds parts; each keeps ±3 µm of a diameter.
fn grind_parts(shop: &mut Shop, parts: usize, diameter: f64) {
    for number in 0..parts {
        shop.next_part();
        shop.grind();
        let worst = shop.worst_um(|_| diameter);
        assert!(worst.abs() < TOLERANCE_UM, "part {number}: off by {worst} µm");
    }
}

/// The land of the part: stock diameter, Z from and to.
fn land(part: &mut PartFile, diameter: f64, from: f64, to: f64) {
    for surface in &mut part.surfaces {
        if let SurfaceFile::Diameter { stock, z_from, z_to, .. } = surface {
            (*stock, *z_from, *z_to) = (diameter, from, to);
        }
    }
}

/// What the wheel loses on a part becomes the correction. With the 0.5 µm of the page alone a wheel of G 10 was 15 µm off
/// after ten parts.
#[test]
fn p6_the_size_of_o1002_holds_with_wheels_that_wear_twenty_times_as_much_as_others() {
    for ratio in [10.0, 25.0, 200.0] {
        let mut shop = dressed(ratio);
        grind_parts(&mut shop, 25, 40.0);
        let wear = SOFT_WEAR_MM * 10.0 / ratio;
        // An encoder step of 1 µm is 2 µm of diameter, over ten parts and three places; the blank's runout adds to what
        // is removed.
        let learnt = shop.value(775).unwrap();
        assert!((learnt - wear).abs() < 0.000_3, "G {ratio}: {learnt} for {wear}");
    }
}

#[test]
fn p6_without_a_dressing_by_count_the_wheel_is_measured_all_the_same() {
    let mut shop = dressed(10.0);
    shop.set(531, 0.0);
    grind_parts(&mut shop, 45, 40.0);
    assert_eq!(shop.rig.controller().system_variable(5_803), Some(45.0), "not dressed");
}

/// What another part wears is learnt anew: with the rate of the old one the size ran away by 0.2 µm a part.
#[test]
fn p6_another_stock_is_another_wear() {
    let mut shop = dressed(10.0);
    grind_parts(&mut shop, 9, 40.0);
    let before = shop.value(775).unwrap();
    shop.set(520, 40.1).set(531, 0.0);
    land(&mut shop.part, 40.1, 30.0, 48.0);
    grind_parts(&mut shop, 12, 40.0);
    // A third of the stock.
    let ratio = shop.value(775).unwrap() / before;
    assert!((0.2..0.5).contains(&ratio), "{ratio}");
}

/// Dressed before every part or every second one, the wear is never learnt: the operator's correction stays, and nothing is
/// divided by parts that were not ground.
#[test]
fn p6_a_dressing_before_every_part_leaves_the_correction_as_it_is() {
    for interval in [1.0, 2.0] {
        let mut shop = dressed(10.0);
        shop.set(531, interval).set(530, 0.003);
        for part in 0..5 {
            shop.next_part();
            assert_eq!(shop.run(), End::Finished, "interval {interval}, part {part}");
            // After one part the wheel is measured, and its wear averaged with what was entered.
            let kept = shop.value(530).unwrap();
            let averaged = f64::midpoint(0.003, SOFT_WEAR_MM);
            let least = if interval < 2.0 { 0.003 } else { averaged.min(0.003) - 0.001 };
            assert!(kept >= least, "interval {interval}, part {part}: {kept}");
        }
    }
}

/// A seat that is narrower than the wheel wears it beside the middle.
#[test]
fn p6_the_wheel_is_measured_where_the_part_wears_it() {
    let mut shop = dressed_for(10.0, |part| land(part, 40.3, 42.0, 48.0));
    // A wear of 2 µm on one side is no more than a step of the encoder: after six parts it is known.
    for _ in 0..6 {
        shop.next_part();
        shop.grind();
    }
    grind_parts(&mut shop, 20, 40.0);
    let learnt = shop.value(775).unwrap();
    assert!((learnt - SOFT_WEAR_MM).abs() < 0.000_3, "{learnt}");
}

#[test]
fn p6_the_correction_that_the_operator_entered_stays_where_nothing_is_measured() {
    // Never dressed: no point on the diamond to measure at.
    let mut shop = shop(1002);
    shop.set(530, 0.003);
    shop.grind();
    shop.next_part();
    shop.grind();
    assert_eq!(shop.value(530), Some(0.003));
}

/// The way to the diamond leaves the part before it goes along Z. It went down to the X of the diamond beside the part.
#[test]
fn p8_the_way_to_the_diamond_keeps_clear_of_a_part_that_is_larger() {
    let mut shop = dressed_for(40.0, |part| land(part, 160.3, 30.0, 48.0));
    shop.set(520, 160.3).set(521, 160.0).set(522, 180.0).set(531, 3.0);
    // Measured before part 2 and before the dressing after three.
    for part in 0..4 {
        shop.next_part();
        assert_eq!(shop.run(), End::Finished);
        assert!(!shop.events().contains(&EventKind::Crash), "{:?}", shop.rig.machine().events());
        assert_eq!(shop.value(157), Some(f64::from(u8::from(part == 1))), "measured before part 2 of {part}");
    }
}

/// The dressing point is off by 0.1 mm after the wheel was dressed: that was a part of −100 µm without a word.
#[test]
fn k4_2_a_wrong_dressing_point_is_no_wear() {
    for (point, alarm) in [(-319.9, 3_029), (-320.1, 3_028)] {
        let mut shop = dressed(40.0);
        shop.next_part();
        shop.grind();
        shop.set(760, point);
        shop.next_part();
        let end = shop.run();
        assert!(matches!(&end, End::Alarm(number, _) if *number == alarm), "{point}: {end:?}");
        assert_eq!((shop.events(), shop.rig.retained().part_count), (Vec::new(), 1));
    }
}

#[test]
fn p5_a_contact_signal_that_stays_on_is_an_alarm_and_no_measurement() {
    // With one part since the dressing the wheel would be measured, with two it would not.
    for (parts, alarm) in [(1, 3_023), (2, 3_014)] {
        let mut shop = dressed(40.0);
        grind_parts(&mut shop, parts, 40.0);
        let booked = shop.value(774);
        tell(&mut shop.rig, "input wheel-contact on");
        shop.next_part();
        let end = shop.run();
        assert!(matches!(&end, End::Alarm(number, _) if *number == alarm), "{end:?}");
        assert_eq!((shop.value(774), shop.events()), (booked, Vec::<EventKind>::new()));
    }
}

/// A5: the approach finds the part, whatever was ground before.
#[test]
fn p5_o1002_finds_a_blank_that_is_larger_than_entered_and_refuses_one_without_stock() {
    let mut one = shop(1002);
    for more in [0.0, 5.0, 0.3, 15.0] {
        land(&mut one.part, 40.3 + more, 30.0, 48.0);
        one.next_part();
        one.grind();
    }
    let mut shop = shop(1002);
    land(&mut shop.part, 39.9, 30.0, 48.0);
    shop.next_part();
    let end = shop.run();
    assert!(matches!(&end, End::Alarm(3_013, _)), "{end:?}");
    assert_eq!((shop.events(), shop.rig.retained().part_count), (Vec::new(), 0));
    // #522: the wheel has left the part before it stops.
    tell(&mut shop.rig, "wait 1 s");
    let x = shop.rig.snapshot().axes[Axis::X].work;
    assert!((x - 60.0).abs() < 0.001, "{x}");
}

#[test]
fn p5_without_a_contact_monitor_o1002_grinds_as_entered() {
    let mut shop = shop(1002);
    tell(&mut shop.rig, "param P358 0");
    shop.grind();
    assert!(shop.worst_um(|_| 40.0).abs() < TOLERANCE_UM);
    assert_eq!(shop.value(157), Some(0.0), "not measured");
}
