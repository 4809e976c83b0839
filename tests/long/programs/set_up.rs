//! O1018: the wheel finds diamond, diameter and face by touch; the gauge is looked at on the master part.
//! Source: spec K4.2 (dressing point), K7.6 (programs of the customer's machine), P7; decisions "Grinding".

use kt830::defs::signal::Output;

use super::shop::{End, Shop, shop, shop_with};

/// Error of a touch, mm: a tick of 0.01 µm, and the few µm that the wheel is in before the signal comes.
const TOUCH_MM: f64 = 0.003;

fn found(shop: &mut Shop, mode: f64, variable: usize) -> f64 {
    shop.set(900, mode);
    assert_eq!(shop.run(), End::Finished);
    assert_eq!(shop.events(), []);
    assert_eq!(shop.rig.retained().part_count, 0, "no part was ground");
    shop.value(variable).unwrap()
}

/// The part file has the offset off by 0.6 in X and by -0.2 in Z; the diamond stands at -320 (machine file: -160 · 2).
#[test]
fn k4_2_o1018_finds_diamond_diameter_and_face() {
    let mut shop = shop(1018);
    let diamond = found(&mut shop, 1.0, 916);
    assert!((diamond + 320.0).abs() < TOUCH_MM, "{diamond}");
    assert_eq!(shop.value(760), Some(diamond));
    let diameter = found(&mut shop, 2.0, 914);
    assert!((diameter + 0.6).abs() < TOUCH_MM, "{diameter}");
    let face = found(&mut shop, 3.0, 915);
    assert!((face - 0.2).abs() < TOUCH_MM, "{face}");
    // What was found is in the geometry of the active offset: a second touch finds nothing.
    for (mode, variable) in [(2.0, 914), (3.0, 915)] {
        let rest = found(&mut shop, mode, variable);
        assert!(rest.abs() < TOUCH_MM, "mode {mode}: {rest}");
    }
    let off = |port: Output| {
        let params = &shop.rig.retained().params;
        !shop.rig.controller().outputs().terminals.is_closed(params.output_port(port))
    };
    assert!(off(Output::Wheel), "the set-up ends with the wheel off");
}

/// What O1018 has found is good for grinding and dressing.
#[test]
fn k4_1_a_part_has_its_size_after_the_set_up() {
    let mut shop = shop(1018);
    for mode in [1.0, 2.0, 3.0] {
        found(&mut shop, mode, 900);
    }
    // The land of 40.12 to 40 by O1002, with a dressing before it.
    for (variable, value) in [
        (520, 40.12),
        (521, 40.0),
        (522, 60.0),
        (523, 33.0),
        (524, 0.2),
        (525, 0.05),
        (526, 1.2),
        (527, 0.3),
        (528, 6.0),
    ] {
        shop.set(variable, value);
    }
    shop.load(1011);
    shop.grind();
    shop.load(1002);
    shop.grind();
    let report = shop.rig.machine().measure();
    let ground = report.diameters.iter().filter(|at| (34.0..52.0).contains(&at.z));
    let worst = ground.map(|at| (at.d - 40.0).abs() * 1_000.0).fold(0.0, f64::max);
    assert!(worst > 0.0 && worst < 6.0, "{worst} µm");
}

#[test]
fn k4_2_o1018_without_a_touch_is_an_alarm_and_changes_nothing() {
    for (mode, result) in [(1.0, 916), (2.0, 914), (3.0, 915)] {
        let mut shop = shop_with(1018, 1, |part| {
            part.surfaces.clear();
            part.bodies.clear();
            part.variables.insert(912, -300.0);
            part.variables.insert(900, mode);
        });
        let end = shop.run();
        assert!(matches!(end, End::Alarm(3_066, _)), "mode {mode}: {end:?}");
        assert_eq!(shop.events(), [], "mode {mode}");
        assert_eq!(shop.value(result), None, "mode {mode}");
        assert_eq!(shop.value(760), Some(-319.0));
        assert_eq!(shop.rig.controller().system_variable(2_701), Some(0.6), "mode {mode}");
    }
}

#[test]
fn p7_o1018_refuses_a_gauge_that_is_not_set_to_the_master_part() {
    let mut shop = shop_with(1018, 1, |part| {
        part.variables.insert(900, 4.0);
    });
    assert_eq!(shop.run(), End::Finished);
    let mut shop = shop_with(1018, 1, |part| {
        part.variables.insert(900, 4.0);
        // Set 20 µm below the master: the part looks too large.
        part.gauge.as_mut().unwrap().set -= 0.02;
    });
    assert!(matches!(shop.run(), End::Alarm(3_067, _)));
}

#[test]
fn k4_2_a_dressing_point_by_key_is_not_overruled() {
    let mut shop = shop_with(1018, 1, |part| {
        part.variables.insert(900, 1.0);
    });
    crate::stories::tell(&mut shop.rig, "mode jog\npage position\nkey f1\nkey address-x\nkey input\nmode auto");
    assert!(matches!(shop.run(), End::Alarm(3_017, _)));
}

/// What is farther off than the search range is touched slowly, and nothing is changed.
#[test]
fn k4_2_o1018_with_a_value_far_off_is_an_alarm_and_no_crash() {
    for (mode, variable, value) in [(1.0, 912, -322.6), (2.0, 902, 37.0), (3.0, 909, 27.3)] {
        let mut shop = shop_with(1018, 1, |part| {
            part.variables.insert(900, mode);
            part.variables.insert(variable, value);
        });
        let end = shop.run();
        assert!(matches!(end, End::Alarm(3_063, _)), "mode {mode}: {end:?}");
        assert_eq!(shop.events(), [], "mode {mode}");
        assert_eq!(shop.rig.controller().system_variable(2_701), Some(0.6));
        assert_eq!(shop.value(760), Some(-319.0));
    }
}

/// A wheel that has worn 0.01 since its last dressing touches the diamond so much later; a new one has lost nothing.
#[test]
fn k4_2_o1018_counts_what_the_wheel_has_lost() {
    for (dressings, lost) in [(3.0, 0.06), (0.0, 0.0)] {
        let mut shop = shop(1018);
        shop.set(772, 0.05).set(774, 0.01);
        crate::stories::tell(&mut shop.rig, &format!("param P97 {dressings}"));
        let touched = found(&mut shop, 1.0, 916);
        let value = shop.value(760).unwrap();
        assert!((value - touched - lost).abs() < 1e-9, "{dressings} dressings: {touched} {value}");
    }
}
