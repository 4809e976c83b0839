//! The programs that grind to a gauge: the size is the gauge's, whatever the offset says; a part that is under size is
//! never a finished one. Source: spec P7, K4.3, K7.6 (programs of the customer's machine); decisions "Grinding".

use kt830::io::sim::{PartFile, SurfaceFile};

use super::shop::{End, Measured, Shop, shop_with, shop_with_wheel, with_runout};

/// What the shop asks of parts with a gauge, µm.
const TOLERANCE_UM: f64 = 2.0;
/// Parts until a wrong offset is corrected.
const PARTS: usize = 3;
/// Beyond the part at which O1003 ended with an alarm once.
const PARTS_OF_A_SERIES: usize = 45;

/// The wheel's offset is off by this much, mm: diameter on X, height on Y and Z.
fn with_wrong_offset(shop: &mut Shop, program: u32, mm: f64) {
    let letter = match program {
        1007 => "V",
        1010 => "W",
        _ => "U",
    };
    crate::stories::tell(&mut shop.rig, &format!("mdi G10 D1 {letter}{mm}\nmode auto"));
}

fn nominal(program: u32, at: Measured) -> f64 {
    match (program, at) {
        (1006, Measured::Diameter(z)) => 40.0 + 0.02 * (z - 30.0),
        (1006, _) => f64::NAN,
        (1015, Measured::Diameter(z)) => super::sizes::seat_diameter(z),
        (1015, Measured::Face(z)) if z < 42.0 => 20.0,
        (1015, _) => 64.0,
        (1016, Measured::Face(_)) => 30.0,
        (1007, _) => 20.0,
        (1010, _) => 25.0,
        _ => 40.0,
    }
}

/// Takes so much off the blank, mm.
fn with_less_stock(part: &mut PartFile, mm: f64) {
    for surface in &mut part.surfaces {
        match surface {
            SurfaceFile::Diameter { stock, .. }
            | SurfaceFile::Disc { stock, .. }
            | SurfaceFile::Plane { stock, .. } => {
                *stock -= mm;
            }
            SurfaceFile::Cone { stock_from, stock_to, .. } => {
                *stock_from -= mm;
                *stock_to -= mm;
            }
            _ => {}
        }
    }
}

#[test]
fn p7_a_wrong_offset_does_not_change_the_size_of_a_part_with_a_gauge() {
    for (program, offsets) in [
        (1003, &[-0.1, -0.005, 0.1][..]),
        (1004, &[-0.1, 0.05]),
        (1006, &[-0.1, 0.05]),
        (1007, &[-0.03, 0.03]),
        (1010, &[-0.03, 0.03]),
        (1015, &[-0.1, 0.1]),
    ] {
        for off in offsets {
            let mut shop = shop_with(program, 3, |part| with_runout(part, 0.005));
            with_wrong_offset(&mut shop, program, *off);
            let mut events = 0;
            for number in 1..=PARTS {
                if number > 1 {
                    shop.next_part();
                }
                assert_eq!(shop.run(), End::Finished, "O{program}, offset off by {off}, part {number}");
                // The first pass of the first part may be too deep: nothing tells where its surface is.
                if number > 1 {
                    assert_eq!(shop.events()[events..], [], "O{program}, offset off by {off}, part {number}");
                }
                events = shop.events().len();
                let worst = shop.worst_um(|at| nominal(program, at));
                assert!(worst.abs() < TOLERANCE_UM, "O{program}, offset off by {off}, part {number}: {worst} µm");
            }
        }
    }
}

/// With 0.05 of stock and 0.01 of clearance the first pass of a wheel that is 0.1 too near cuts below the size.
#[test]
fn p7_a_size_that_is_passed_in_roughing_is_an_alarm_and_the_part_is_not_counted() {
    let mut shop = shop_with(1010, 1, |_| ());
    with_wrong_offset(&mut shop, 1010, -0.1);
    let end = shop.run();
    assert!(matches!(&end, End::Alarm(3_022, _)), "{end:?}");
    assert_eq!(shop.rig.retained().part_count, 0);
}

#[test]
fn p7_a_blank_that_is_under_size_is_an_alarm_before_the_wheel_touches_it() {
    // Stock on the blanks as they come.
    let blanks = [
        (1003, 0.3, 3_021),
        (1004, 0.3, 3_098),
        (1006, 0.3, 3_021),
        (1007, 0.1, 3_023),
        (1010, 0.05, 3_023),
        (1015, 0.3, 3_060),
        (1016, 0.3, 3_060),
    ];
    for (program, stock, number) in blanks {
        let mut shop = shop_with(program, 1, |part| with_less_stock(part, stock + 0.02));
        let end = shop.run();
        assert!(matches!(&end, End::Alarm(alarm, _) if *alarm == number), "O{program}: {end:?}");
        assert_eq!(shop.rig.retained().part_count, 0, "O{program}");
        // Not ground: 20 µm under size, less what the simulated blank is out of round.
        let worst = shop.worst_um(|at| match (program, at) {
            // The shoulder has its stock.
            (1015 | 1016, Measured::Face(z)) => z,
            _ => nominal(program, at),
        });
        assert!((-40.0..-10.0).contains(&worst), "O{program}: {worst} µm");
    }
}

/// O1003 of a worn wheel ended with alarm 3019 at part 40, and took 450 s in place of 139 s by then.
#[test]
fn p7_the_offset_follows_the_wear_of_the_wheel_and_the_cycle_stays_short() {
    let mut shop = shop_with(1003, 1, |_| ());
    let mut seconds = Vec::new();
    for number in 1..=PARTS_OF_A_SERIES {
        if number > 1 {
            shop.next_part();
        }
        let begun = shop.rig.now();
        shop.grind();
        seconds.push(shop.rig.now().since(begun).as_secs_f64());
        let worst = shop.worst_um(|_| 40.0);
        assert!(worst.abs() < TOLERANCE_UM, "part {number}: {worst} µm");
    }
    let (first, last) = (seconds[0], seconds[PARTS_OF_A_SERIES - 1]);
    assert!(last < 1.3 * first, "{first} s, then {last} s");
}

/// The worn sides of a soft wheel left the plate 2 to 4 µm hollow after a few parts; and a blank that lies within P1 was
/// roughed at the fine infeed, 630 s in place of 390 s.
#[test]
fn p7_o1007_grinds_flat_with_worn_sides_and_a_blank_within_p1_slows_nothing() {
    let mut shop = shop_with_wheel(1007, 10.0, |_| ());
    for part in 1..=5 {
        shop.next_part();
        let begun = shop.rig.now();
        shop.grind();
        let seconds = shop.rig.now().since(begun).as_secs_f64();
        assert!(seconds < 520.0, "part {part}: {seconds} s");
        let heights = shop.rig.machine().measure().heights;
        let (low, high) = heights.iter().fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at.y), high.max(at.y)));
        assert!(high - low < 0.001_5 && shop.worst_um(|_| 20.0).abs() < 2.0, "part {part}: {low} … {high}");
    }
}

/// A gauge whose signals do not come: the limit is an alarm, the part is not counted.
#[test]
fn p8_a_dead_gauge_ends_in_an_alarm_at_the_limit() {
    for (program, number) in
        [(1003, 3_019), (1004, 3_094), (1006, 3_020), (1007, 3_020), (1010, 3_020), (1015, 3_094), (1016, 3_094)]
    {
        let mut shop = shop_with(program, 1, |_| ());
        crate::stories::tell(&mut shop.rig, "fault gauge-dead");
        let end = shop.run();
        assert!(matches!(&end, End::Alarm(alarm, _) if *alarm == number), "O{program}: {end:?}");
        assert_eq!(shop.rig.retained().part_count, 0, "O{program}");
    }
}
