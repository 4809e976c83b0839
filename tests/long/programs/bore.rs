//! O1017: the bore, the wheel on its quill, the size that is measured afterwards, the dresser of the internal spindle.
//! Source: spec P4, P6, K4.1; decisions "Shipped programs".

use kt830::defs::signal::Output;
use kt830::io::sim::{BodyFile, BodyKind, SurfaceFile};
use kt830::units::Axis;

use super::shop::{End, Shop, shop, shop_with};

/// Mean diameter of the bore, mm.
fn bore(shop: &Shop) -> f64 {
    let report = shop.rig.machine().measure();
    report.diameters.iter().map(|at| at.d).sum::<f64>() / report.diameters.len() as f64
}

/// Grinds rings and types in the size of each; what they are off by, µm.
fn series(shop: &mut Shop, parts: usize) -> Vec<f64> {
    let mut off = Vec::new();
    for part in 0..parts {
        if part > 0 {
            shop.next_part();
        }
        assert_eq!(shop.run(), End::Finished);
        let size = bore(shop);
        off.push((size - 40.0) * 1_000.0);
        shop.set(895, size);
    }
    off
}

/// The wheel wears 1.5 µm of diameter a ring (754 mm³ by 500·π·32·20/2); the correction keeps pace, before a dressing and
/// behind it, and the wear of a ring is learnt.
#[test]
fn k4_1_o1017_follows_the_wear_of_its_wheel() {
    let mut shop = shop(1017);
    let off = series(&mut shop, 24);
    assert!(off.iter().all(|um| um.abs() < 2.0), "{off:?}");
    let learnt = shop.value(899).unwrap() * 1_000.0;
    assert!((1.0..=2.0).contains(&learnt), "{learnt} µm");
    assert_eq!(shop.events(), []);
    // Before ring 1 0.015; before ring 11 and 21 strokes of 0.01 come first that find the worn rim no more, two at most.
    let dressed = 32.0 - shop.value(799).unwrap();
    assert!((0.045 - 1e-9..0.045 + 2.0 * 0.02 + 1e-9).contains(&dressed), "{dressed}");
    assert!((shop.value(896).unwrap() + 460.0 - dressed).abs() < 1e-9, "the dressing point follows the wheel");
}

/// An offset that is off by 0.1 mm is right from the second ring on; the blank has room for it.
#[test]
fn k4_1_o1017_a_wrong_offset_is_corrected_by_the_first_ring() {
    for wrong in [-0.1, 0.1] {
        let mut shop = shop(1017);
        crate::stories::tell(&mut shop.rig, &format!("mdi G10 D2 U{wrong}\nmode auto"));
        let off = series(&mut shop, 3);
        assert!(off[0].abs() > 90.0, "{off:?}");
        assert!(off[1..].iter().all(|um| um.abs() < 2.0), "{off:?}");
    }
}

/// Nothing is measured: the offset stays.
#[test]
fn k4_1_o1017_without_a_measured_size_leaves_the_offset() {
    let mut shop = shop_with(1017, 1, |part| {
        part.variables.insert(894, 0.0);
    });
    for _ in 0..2 {
        assert_eq!(shop.run(), End::Finished);
        shop.next_part();
    }
    assert!(shop.rig.snapshot().offsets.tools[1].wear[Axis::X].abs() < 1e-9);
}

/// A run that is broken off makes no part, and books no wear of one.
#[test]
fn k4_1_o1017_a_run_that_is_broken_off_books_no_wear() {
    let mut shop = shop_with(1017, 1, |part| {
        part.variables.extend([(899, 0.004), (898, 3.0), (797, 0.012)]);
    });
    let wear = |shop: &mut Shop| shop.rig.snapshot().offsets.tools[1].wear[Axis::X];
    for _ in 0..2 {
        shop.rig.send(kt830::link::Command::Press(kt830::defs::key::Key::CycleStart));
        crate::stories::tell(&mut shop.rig, "wait until Z<40 max 120 s\nwait 5 s\nkey reset\nwait 2 s");
        assert!(wear(&mut shop).abs() < 1e-9);
    }
    assert_eq!(shop.run(), End::Finished);
    assert!((wear(&mut shop) - 0.004).abs() < 1e-9);
    assert!((shop.value(797).unwrap() - 0.016).abs() < 1e-9);
}

/// A bore shorter than the wheel, with a shoulder at its bottom: the overrun at the left stays what the page says.
#[test]
fn p8_o1017_a_short_blind_bore_is_ground_without_overrun() {
    let mut shop = shop_with(1017, 1, |part| {
        part.variables.extend([(882, 25.0), (893, 0.0)]);
        part.bodies = vec![BodyFile { what: BodyKind::Fixture, z_from: -5.0, z_to: 9.9, diameter: 80.0 }];
        let SurfaceFile::Bore { z_to, .. } = &mut part.surfaces[0] else { unreachable!() };
        *z_to = 25.0;
    });
    assert_eq!(shop.run(), End::Finished);
    assert_eq!(shop.events(), []);
    assert!(((bore(&shop) - 40.0) * 1_000.0).abs() < 3.0, "{}", bore(&shop));
}

/// Homed after a power cut, the wheel starts from the far ends of its axes.
#[test]
fn p8_o1017_homes_in_front_of_the_bore_and_starts_from_there() {
    let mut shop = shop(1017);
    assert_eq!(shop.run(), End::Finished);
    crate::stories::tell(&mut shop.rig, "mode jog\nhome all\nmode auto");
    shop.next_part();
    shop.set(894, 0.0);
    assert_eq!(shop.run(), End::Finished);
    assert_eq!(shop.events(), []);
}

/// Without a contact monitor the dressing begins at the rim that the wear has left.
#[test]
fn p6_o1017_dresses_below_the_wear_without_a_monitor() {
    let mut shop = shop(1017);
    crate::stories::tell(&mut shop.rig, "param P358 0");
    shop.set(894, 20.0).set(898, 30.0);
    let off = series(&mut shop, 22);
    assert!(off[1..].iter().all(|um| um.abs() < 3.0), "{off:?}");
}

/// Without sparking out the bore is left as the quill springs: too small.
#[test]
fn p5_o1017_without_spark_out_the_quill_leaves_the_bore_small() {
    let off = |strokes: f64| {
        let mut shop = shop_with(1017, 1, |part| {
            part.variables.extend([(891, strokes), (886, 0.0)]);
        });
        assert_eq!(shop.run(), End::Finished);
        (bore(&shop) - 40.0) * 1_000.0
    };
    let (sprung, sparked_out) = (off(0.0), off(12.0));
    assert!(sprung < sparked_out - 2.0 && sparked_out > -2.0, "{sprung} {sparked_out} µm");
}

/// A bore that is too large already, a part that is not there: an alarm, and the wheel is in front of the bore.
#[test]
fn p8_o1017_without_a_touch_is_an_alarm() {
    for wide in [true, false] {
        let mut shop = shop_with(1017, 1, |part| match &mut part.surfaces[0] {
            SurfaceFile::Bore { stock_from, stock_to, .. } if wide => (*stock_from, *stock_to) = (39.97, 39.97),
            _ => part.surfaces.clear(),
        });
        let end = shop.run();
        assert!(matches!(end, End::Alarm(3_061, _)), "{end:?}");
        // Z75 of the part is -325 of the machine.
        crate::stories::tell(&mut shop.rig, "wait 1 s");
        let z = shop.rig.machine().slide_mm()[Axis::Z];
        assert!((z + 325.0).abs() < 0.01, "{z}, wide {wide}");
        assert_eq!(shop.events(), []);
    }
}

/// The diamond is lost: after ten strokes without a touch an alarm, and nothing is booked.
#[test]
fn p6_o1017_a_dressing_that_touches_nothing_is_not_booked() {
    let mut shop = shop_with(1017, 1, |part| {
        part.internal_spindle.as_mut().unwrap().dresser_infeed_mm = -220.0;
    });
    let end = shop.run();
    assert!(matches!(end, End::Alarm(3_064, _)), "{end:?}");
    assert_eq!((shop.value(896), shop.value(799)), (Some(-460.0), Some(32.0)));
    assert!(shop.rig.snapshot().offsets.tools[1].wear[Axis::X].abs() < 1e-9);
}

/// The wheel beside the bore's Z without being inside it: no move.
#[test]
fn k7_5_o1017_does_not_move_from_beside_the_bore() {
    let mut shop = shop_with(1017, 1, |part| {
        // X100 Z30: beside the ring.
        (part.start_mm.x, part.start_mm.z) = (-212.0, -370.0);
        part.surfaces.clear();
        part.bodies.clear();
    });
    let before = shop.rig.machine().slide_mm();
    let end = shop.run();
    assert!(matches!(end, End::Alarm(3_025, _)), "{end:?}");
    assert_eq!(shop.rig.machine().slide_mm(), before);
    let wheel = shop.rig.retained().params.output_port(Output::Wheel);
    assert!(!shop.rig.controller().outputs().terminals.is_closed(wheel));
}

/// After an alarm in the bore the next start draws the wheel to the middle before it leaves.
#[test]
fn p8_o1017_leaves_the_bore_through_its_middle() {
    let mut shop = shop(1017);
    shop.rig.send(kt830::link::Command::Press(kt830::defs::key::Key::CycleStart));
    crate::stories::tell(&mut shop.rig, "wait until Z<40 max 120 s\nwait 30 s\nkey reset\nwait 2 s");
    assert!(shop.rig.machine().slide_mm()[Axis::Z] < -350.0, "in the bore");
    assert_eq!(shop.run(), End::Finished);
    assert_eq!(shop.events(), []);
    assert!(((bore(&shop) - 40.0) * 1_000.0).abs() < 3.0);
}
