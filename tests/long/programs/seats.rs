//! O1015 and O1016: several seats, shoulders, diameter and face together, on parts and offsets that they were not made on.
//! Source: spec P4, P7, K7.6; decisions "Grinding" and "Shipped programs".

use kt830::defs::key::Key;
use kt830::defs::signal::Output;
use kt830::io::sim::SurfaceFile;
use kt830::link::command::Command;
use kt830::link::snapshot::RunState;
use kt830::units::Axis;

use super::shop::{End, Measured, Shop, shop, shop_with};
use super::sizes::seat_diameter;

fn with_offset(shop: &mut Shop, mm: f64) {
    crate::stories::tell(&mut shop.rig, &format!("mdi G10 D1 U{mm}\nmode auto"));
}

/// Diameters of O1015 only.
fn worst_seat_um(shop: &Shop) -> f64 {
    shop.worst_um(|at| match at {
        Measured::Diameter(z) => seat_diameter(z),
        Measured::Face(z) | Measured::Height(z) => z,
    })
}

/// The shoulder is ground clear of the seat as the gauge has found it, not as the offset has it.
#[test]
fn p7_o1015_the_shoulder_does_not_spoil_a_seat_whose_offset_is_wrong() {
    for off in [-0.3, -0.2] {
        let mut shop = shop(1015);
        with_offset(&mut shop, off);
        assert_eq!(shop.run(), End::Finished, "{off}");
        let worst = worst_seat_um(&shop);
        assert!(worst.abs() < 3.0, "{off}: {worst} µm");
    }
}

/// Seats that the wheel would touch while it grinds another one.
#[test]
fn k7_5_o1015_refuses_a_larger_seat_under_the_wheel() {
    for values in [
        // 46.2 beside 46, nearer than the width of the wheel.
        [(850, 46.0), (851, 20.0), (852, 46.2), (853, 35.0)],
        // 20 of wheel, 1 of shoulder stock and 0.1: the wheel covers Z20 to 41.1.
        [(850, 42.0), (851, 20.0), (853, 41.0), (859, 1.0)],
    ] {
        let mut shop = shop_with(1015, 1, |part| {
            part.variables.extend([(854, 0.0), (856, 0.0), (858, 1.0)]);
            part.variables.extend(values);
        });
        let before = shop.rig.machine().slide_mm();
        let end = shop.run();
        assert!(matches!(end, End::Alarm(3_010, _)), "{values:?}: {end:?}");
        assert_eq!(shop.rig.machine().slide_mm(), before);
    }
}

/// The gauge sits on the wheel head: after an alarm it is drawn back before Z moves.
#[test]
fn p7_the_gauge_is_in_before_z_moves() {
    for program in [1015, 1016] {
        let mut shop = shop(program);
        shop.rig.machine_mut().inject_fault("gauge-dead").unwrap();
        assert!(matches!(shop.run(), End::Alarm(3_094, _)), "O{program}");
        crate::stories::tell(&mut shop.rig, "fault gauge-dead off\nkey reset\nwait 1 s");
        shop.next_part();
        let gauge = shop.rig.retained().params.output_port(Output::RadialGauge);
        assert!(shop.rig.controller().outputs().terminals.is_closed(gauge), "O{program}: it is out after the alarm");
        shop.rig.send(Command::Press(Key::CycleStart));
        let (mut last, mut moved) = (shop.rig.controller().set_point()[Axis::Z], 0);
        for _ in 0..600_000 {
            shop.rig.step();
            let now = shop.rig.controller().set_point()[Axis::Z];
            // Faster than 600 mm/min: no infeed along a slope, and no way off a shoulder.
            if (now - last).abs() > 0.01 {
                assert!(!shop.rig.controller().outputs().terminals.is_closed(gauge), "O{program} at Z {now}");
                moved += 1;
            }
            last = now;
            if moved > 0 && shop.rig.controller().state() != RunState::Running {
                break;
            }
        }
        assert!(moved > 100, "O{program}");
    }
}

/// Stock beyond what was entered is taken off along X before the slope begins.
#[test]
fn p4_o1016_a_blank_that_is_too_large_does_not_shift_the_face() {
    for (stock, end) in [(41.0, None), (42.0, Some(3_063))] {
        let mut shop = shop_with(1016, 1, |part| {
            if let SurfaceFile::Diameter { stock: diameter, .. } = &mut part.surfaces[0] {
                *diameter = stock;
            }
        });
        let found = shop.run();
        match end {
            Some(number) => assert!(matches!(found, End::Alarm(alarm, _) if alarm == number), "{stock}: {found:?}"),
            None => {
                assert_eq!(found, End::Finished, "{stock}");
                let worst = shop.worst_um(|at| if let Measured::Diameter(_) = at { 40.0 } else { 30.0 });
                assert!(worst.abs() < 3.0, "{stock}: {worst} µm");
            }
        }
        assert_eq!(shop.events(), [], "{stock}");
    }
}

/// A shoulder that stands out farther than entered meets the side of the wheel far outside of the diameter.
#[test]
fn p8_a_shoulder_with_too_much_stock_is_an_alarm_and_no_crash() {
    for (program, face) in [(1015, 4), (1016, 1)] {
        let mut shop = shop_with(program, 1, |part| {
            if let SurfaceFile::Face { stock, .. } = &mut part.surfaces[face] {
                *stock += 0.3;
            }
        });
        let end = shop.run();
        assert!(matches!(end, End::Alarm(3_063, _)), "O{program}: {end:?}");
        assert!(!shop.events().contains(&kt830::io::sim::EventKind::Crash), "O{program}");
    }
}

/// The face follows the offset, and a dressing does not give back what was wrong with it.
#[test]
fn p7_o1016_the_face_stays_over_a_dressing() {
    let mut shop = shop_with(1016, 1, |part| {
        part.variables.insert(869, 4.0);
    });
    with_offset(&mut shop, -0.15);
    let mut faces = Vec::new();
    for part in 0..11 {
        if part > 0 {
            shop.next_part();
        }
        assert_eq!(shop.run(), End::Finished);
        let report = shop.rig.machine().measure();
        faces.push(report.faces.iter().map(|at| at.z).sum::<f64>() / report.faces.len() as f64);
    }
    // From the second part on: the first one finds the error.
    let (least, most) = faces[2..].iter().fold((f64::INFINITY, 0.0_f64), |(a, b), z| (a.min(*z), b.max(*z)));
    assert!(most - least < 0.004, "{faces:?}");
}
