//! Every grinding program on its part: to size within 3 µm, whatever runout, sharpness of the wheel and noise of the gauges.
//!
//! A seed changes where the waviness lies and what the gauges' noise is; runout goes from the part's own to nothing, the
//! wheel from as dull as it gets, where it burns some parts, to sharp. `KT830_SEEDS=20 cargo test --release --test programs` tries more than the ends.

use kt830::io::sim::EventKind;

use super::shop::{End, Measured, shop_with, with_runout};

/// What the shop asks of fine-ground diameters and faces, µm.
const TOLERANCE_UM: f64 = 3.0;

/// Up to this dullness no part burns; the dressing intervals leave 0.1 to 0.2.
const DULL_FROM: f64 = 0.3;

/// Grinds the part once for each seed; `runout` is the greatest. The first seed has it, and the dullest wheel.
fn to_size(program: u32, seeds: u64, runout: f64, wanted: impl Fn(Measured) -> f64 + Copy) {
    let seeds = std::env::var("KT830_SEEDS").map_or(seeds, |text| text.parse().unwrap());
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    for seed in 0..seeds {
        // From 1 to 0; runout in another order, from 1 as well.
        let share = |seed: u64| 1.0 - (seed % seeds) as f64 / (seeds - 1).max(1) as f64;
        let mut shop = shop_with(program, seed, |part| with_runout(part, runout * share(7 * seed)));
        shop.rig.machine_mut().set_wheel_dullness(share(seed));
        assert_eq!(shop.run(), End::Finished);
        let may_burn = share(seed) > DULL_FROM;
        assert!(shop.events().iter().all(|event| may_burn && *event == EventKind::Burn), "{:?}", shop.events());
        let worst = shop.worst_um(wanted);
        assert!(worst.abs() < TOLERANCE_UM, "O{program} seed {seed}: off by {worst} µm");
        (least, greatest) = (least.min(worst), greatest.max(worst));
    }
    println!("O{program}: {seeds} seeds, worst from {least:.2} to {greatest:.2} µm");
}

#[test]
fn k7_9_o1001_grinds_both_jaws() {
    // 10 − (0.20 + 0.05) and 50 + (0.20 + 0.05).
    to_size(1001, 1, 0.0, |at| match at {
        Measured::Face(z) if z < 30.0 => 9.75,
        _ => 50.25,
    });
}

#[test]
fn k7_10_o1002_plunges_to_the_diameter() {
    to_size(1002, 5, 0.02, |_| 40.0);
}

#[test]
fn k4_3_o1003_traverses_with_infeed_at_the_reversals() {
    to_size(1003, 1, 0.02, |_| 40.0);
}

#[test]
fn p7_o1004_grinds_to_the_gauge() {
    to_size(1004, 5, 0.02, |_| 40.0);
}

#[test]
fn k4_5_o1005_grinds_a_face_to_its_length_from_the_reference() {
    to_size(1005, 3, 0.0, |at| match at {
        Measured::Face(z) if z > 65.0 => 80.0,
        _ => 50.0,
    });
}

#[test]
fn p4_o1006_grinds_a_cone() {
    // 40 at Z30, 40.8 at Z70.
    to_size(1006, 1, 0.02, |at| match at {
        Measured::Diameter(z) => 40.0 + 0.02 * (z - 30.0),
        Measured::Face(..) | Measured::Height(_) => f64::NAN,
    });
}

/// The four seats of O1015 by the Z where they are measured.
pub fn seat_diameter(z: f64) -> f64 {
    match z {
        ..40.0 => 50.0,
        ..62.0 => 46.0,
        ..84.0 => 42.0,
        _ => 36.0,
    }
}

#[test]
fn p4_o1015_grinds_four_seats_and_two_shoulders() {
    let wanted = |at| match at {
        Measured::Diameter(z) => seat_diameter(z),
        Measured::Face(z) if z < 42.0 => 20.0,
        Measured::Face(..) => 64.0,
        Measured::Height(_) => f64::NAN,
    };
    to_size(1015, 3, 0.02, wanted);
}

#[test]
fn p4_o1015_without_gauge_grinds_to_the_offset() {
    let mut shop = shop_with(1015, 1, |part| {
        part.seat_gauges.clear();
        part.variables.insert(847, 0.0);
    });
    shop.grind();
    let worst = shop.worst_um(|at| match at {
        Measured::Diameter(z) => seat_diameter(z),
        Measured::Face(z) if z < 42.0 => 20.0,
        _ => 64.0,
    });
    assert!(worst.abs() < TOLERANCE_UM, "off by {worst} µm");
}

#[test]
fn p4_o1016_grinds_diameter_and_face_together() {
    let wanted = |at| match at {
        Measured::Diameter(_) => 40.0,
        _ => 30.0,
    };
    to_size(1016, 3, 0.02, wanted);
    let mut shop = shop_with(1016, 1, |part| {
        part.gauge = None;
        part.variables.insert(872, 0.0);
    });
    shop.grind();
    let worst = shop.worst_um(wanted);
    assert!(worst.abs() < TOLERANCE_UM, "without gauge off by {worst} µm");
}

#[test]
fn p4_o1017_grinds_a_bore() {
    to_size(1017, 3, 0.02, |_| 40.0);
}

#[test]
fn p5_o1007_grinds_a_plane() {
    to_size(1007, 1, 0.0, |_| 20.0);
}

#[test]
fn p5_o1008_grinds_a_slot() {
    to_size(1008, 1, 0.0, |at| match at {
        Measured::Face(z) if z < 30.0 => 5.0,
        Measured::Face(..) => 55.0,
        Measured::Diameter(_) | Measured::Height(_) => 15.0,
    });
}

#[test]
fn p5_o1009_grinds_a_step() {
    to_size(1009, 1, 0.0, |at| match at {
        Measured::Face(..) => 30.0,
        Measured::Height(z) if z > 30.0 => 25.0,
        Measured::Diameter(_) | Measured::Height(_) => 15.0,
    });
}

#[test]
fn p5_o1010_grinds_a_ring() {
    to_size(1010, 1, 0.006, |_| 25.0);
}
