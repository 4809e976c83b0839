//! Batches: fifty parts one after the other, the wheel dressed after every ten, nobody at the panel but for cycle start.

use kt830::io::sim::SurfaceFile;

use super::shop::{Shop, shop};

const PARTS: usize = 50;
/// What the shop asks, µm.
pub const TOLERANCE_UM: f64 = 3.0;

/// Grinds the batch; the least and the greatest deviation from 40, µm.
fn batch(shop: &mut Shop) -> (f64, f64) {
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    for number in 0..PARTS {
        if number > 0 {
            shop.next_part();
        }
        shop.grind();
        let worst = shop.worst_um(|_| 40.0);
        assert!(worst.abs() < TOLERANCE_UM, "part {number}: off by {worst} µm");
        (least, greatest) = (least.min(worst), greatest.max(worst));
    }
    println!("{PARTS} parts: {least:.2} to {greatest:.2} µm");
    (least, greatest)
}

/// Diameter of the wheel as the control has it, mm.
fn booked(shop: &Shop) -> f64 {
    shop.rig.controller().system_variable(5_801).unwrap()
}

#[test]
fn k4_1_fifty_parts_of_o1002_with_a_dressing_every_ten_hold_their_size() {
    let mut shop = shop(1002);
    batch(&mut shop);
    // Before parts 11, 21, 31 and 41: 2 · 0.02 + 0.01 mm of diameter each.
    assert!((booked(&shop) - (600.0 - 4.0 * 0.05)).abs() < 1e-9, "{}", booked(&shop));
    // What the diamond leaves is what the control reckons with, but for the wear of the last ten parts.
    let real = shop.rig.machine().wheel().diameter_mm;
    assert!((0.0..0.008).contains(&(booked(&shop) - real)), "{real}");
    assert_eq!(shop.rig.retained().part_count, 50);
}

#[test]
fn k4_1_without_the_wear_correction_ten_parts_grow_out_of_tolerance() {
    let mut shop = shop(1002);
    shop.set(530, 0.0).set(531, 0.0);
    let sizes: Vec<f64> = (0..10)
        .map(|_| {
            shop.next_part();
            shop.grind();
            shop.worst_um(|_| 40.0)
        })
        .collect();
    // 340 mm³/40 over π·600·18 mm: 0.25 µm of radius a part.
    let grown = sizes[9] - sizes[0];
    assert!((4.0..5.5).contains(&grown), "{sizes:?}");
}

#[test]
fn p7_fifty_parts_of_o1004_hold_their_size_by_the_gauge() {
    let mut shop = shop(1004);
    let (least, greatest) = batch(&mut shop);
    // The gauge's noise of 0.5 µm, and what the wheel still takes in the 10 ms of the signal and until it is off.
    assert!(least > -1.5 && greatest < 1.5, "{least} {greatest}");
    assert!((booked(&shop) - (600.0 - 4.0 * 0.05)).abs() < 1e-9);
}

#[test]
fn k4_5_o1005_follows_parts_that_lie_elsewhere_along_their_axis() {
    let mut shop = shop(1005);
    for (number, off) in [0.0, 0.12, -0.15, 0.05].into_iter().enumerate() {
        let mut part = super::shop::part_of(1005);
        for surface in &mut part.surfaces {
            if let SurfaceFile::Face { stock, .. } = surface {
                *stock += off;
            }
        }
        shop.rig.machine_mut().set_part(Some(&part));
        shop.grind();
        let faces = shop.rig.machine().measure().faces;
        let reference = faces.iter().find(|face| face.z > 65.0).unwrap().z;
        for face in faces.iter().filter(|face| face.z < 65.0) {
            let length = reference - face.z;
            assert!((length - 30.0).abs() < 0.003, "part {number}: length {length}");
        }
    }
    // From −0.15 to 0.05.
    assert!((shop.value(658).unwrap() - 0.2).abs() < 0.002, "{:?}", shop.value(658));
}
