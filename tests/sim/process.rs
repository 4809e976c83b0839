//! What grinding does beside removing stock: forces, heat, and what bends under them (rows P2, P5; issue "a good part,
//! always", part B). The figures are calculated from the formulas of `io/sim/bending.rs` and `io/sim/heat.rs`.

use kt830::defs::signal::{Input, Output};
use kt830::io::sim::{EventKind, PartHeatFile, ShaftFile, SurfaceFile, ThermalFile, VibrationFile};

use crate::bench::{Rig, ready, ready_with};

/// Diameter at Z.
fn diameter(rig: &Rig, z: f64) -> f64 {
    rig.sim.diameter_at(z).unwrap()
}

/// Feeds from 40.4 to 40.1 at a rate, mm/min of radius, with coolant or without.
fn plunge_at(feed: f64, dull: f64, coolant: bool) -> Rig {
    let mut rig = ready(1002);
    rig.switch(Output::Coolant, coolant);
    rig.spin();
    rig.sim.set_wheel_dullness(dull);
    rig.go(40.4, 29.0, 6_000.0);
    rig.go(40.1, 29.0, feed);
    rig
}

/// The part turns with `spin` at 200 rpm: 8 mm²/s, sharp and wet. 1.8 mm/min are π·40.2·0.03 = 3.79 mm²/s, 2.9 mm/min 6.10.
/// Dull: 8·(33.8/93.8)^(4/3) = 2.05; dry: 5.29.
#[test]
fn p5_a_dull_wheel_and_a_dry_contact_burn_at_less() {
    let burns = |rig: &Rig| rig.events().contains(&EventKind::Burn);
    assert!(!burns(&plunge_at(2.9, 0.0, true)));
    assert!(burns(&plunge_at(2.9, 0.0, false)), "without coolant");
    assert!(!burns(&plunge_at(1.8, 0.0, false)));
    assert!(burns(&plunge_at(1.8, 1.0, true)), "dull");
    assert!(!burns(&plunge_at(0.9, 1.0, true)), "at half the feed a dull wheel does not");
}

/// 30 % of 1814 W warm the land of 82.7 J/K; at 5000 W/(m²·K) it loses 11.4 W/K: 47.8 K in the end, time constant 7.26 s. From the
/// touch at 40.3 to 40.1 the feed of 0.02 mm/s takes 5 s, the power follows in 0.8 s: 47.8·(1 − e^(−4.2/7.26)) = 21 K, 9.7 µm
/// of the diameter; the size is behind by 0.8 s of that growth, 0.8·3.7 K = 1.4 µm. So much smaller the cold part is.
#[test]
fn p5_a_part_that_is_ground_hot_is_smaller_when_it_is_cold() {
    let size = |share: f64| {
        let mut rig = ready_with(1002, |machine, _| {
            machine.part_heat = Some(PartHeatFile { heat_share: share, cooling_w_m2_k: 5_000.0 });
        });
        rig.switch(Output::Coolant, true);
        rig.spin();
        rig.go(40.4, 29.0, 6_000.0);
        rig.go(40.1, 29.0, 1.2);
        diameter(&rig, 39.0)
    };
    let smaller = (size(0.0) - size(0.3)) * 1_000.0;
    assert!((smaller - 8.3).abs() < 0.8, "{smaller}");
}

/// A headstock at 80 rpm in place of 200: 8·(80/200)^(1/3) = 5.89 mm²/s. 3.2 mm/min make 6.7, less the 2 % that the lag has not reached.
#[test]
fn p5_a_part_that_turns_slowly_burns_at_less() {
    let mut rig = ready(1002);
    rig.switch(Output::Coolant, true);
    rig.switch(Output::Wheel, true);
    rig.switch(Output::HeadstockLow, true);
    rig.wait(9.0);
    rig.go(40.4, 29.0, 6_000.0);
    rig.go(40.1, 29.0, 3.2);
    assert_eq!(rig.events(), [EventKind::Burn]);
}

/// 1.2 mm/min: Q = π·40.1·18·0.02 = 45.35 mm³/s; 40 J/mm³ are 1814 W, at 31.4 m/s (1000 rpm) 57.8 N, over 0.4 144 N;
/// the lag of 0.8 s, 0.01 mm, is 16 µm and has been reached after the 9 s of the feed. A dull wheel of 2.5 times the energy
/// removes as much and needs 2.5 times the force.
#[test]
fn p2_force_and_power_grow_with_dullness() {
    let sharp = plunge_at(1.2, 0.0, true).sim.wheel();
    assert!((sharp.tangential_n - 57.8).abs() < 1.5, "{}", sharp.tangential_n);
    assert!((sharp.normal_n / sharp.tangential_n - 2.5).abs() < 1e-9);
    let dull = plunge_at(1.2, 1.0, true).sim.wheel();
    let ratio = dull.tangential_n / sharp.tangential_n;
    assert!((2.3..=2.55).contains(&ratio), "{ratio}: a little is behind by the lag of 2 s");
    // Above the idle 8 %.
    let loads = (dull.load_percent - 8.0) / (sharp.load_percent - 8.0);
    assert!((loads - ratio).abs() < 1e-6, "{loads} {ratio}");
}

/// A land of 18 mm in the middle of a shaft Ø12 of 200 mm between centres: E·I = 210000·π·12⁴/64 = 2.1375·10⁸ N·mm²; in the
/// middle 200³/48/E·I = 0.000780 mm/N, 9 mm beside it (91·109)²/(3·200·E·I) = 0.000767. u·b·π·d/(µ·v_s·τ) with d = 12.3 mm and
/// v_s = 31.4 m/s: 40000·18·38.64/(0.4·31416·0.8) = 2767 N/mm. The time constant is 0.8·(1 + 2.158) = 2.53 s in the middle.
/// At 0.3 mm/min the size is 2·0.005·2.53 = 25 µm behind; after two of the time constants 3.4 µm are left.
#[test]
fn p5_a_slender_part_lags_longer_and_becomes_a_barrel() {
    let mut rig = ready_with(1002, |_, part| {
        part.shaft = Some(ShaftFile { diameter: 12.0, z_from: -61.0, z_to: 139.0, centred: true });
        part.tailstock = None;
        part.surfaces = vec![SurfaceFile::Diameter {
            z_from: 30.0,
            z_to: 48.0,
            stock: 12.3,
            cell: 1.0,
            runout: 0.0,
            waviness: 0.0,
        }];
    });
    rig.spin();
    rig.go(12.4, 29.0, 6_000.0);
    rig.go(12.0, 29.0, 0.3);
    let behind = (diameter(&rig, 38.5) - 12.0) * 1_000.0;
    assert!((behind - 25.3).abs() < 1.5, "{behind}");
    let barrel = (diameter(&rig, 38.5) - diameter(&rig, 30.5)) * 1_000.0;
    // The end of the land, 8.5 mm from the middle: 2·0.005·0.8·2767·(0.000780 − 0.000769) = 0.25 µm.
    assert!((0.1..0.5).contains(&barrel), "{barrel}");
    rig.wait(2.0 * 2.53);
    let left = (diameter(&rig, 38.5) - 12.0) * 1_000.0;
    assert!((left - 0.135 * behind).abs() < 0.7, "{left}");
}

/// Strokes along a shaft Ø5, 60 mm between centres: in the middle 1 + 0.000698·u·b·π·d/(µ·v_s·τ), by the 20 mm of the wheel
/// 40000·20·16/(0.4·31416·0.8) = 1273 N/mm: at most 1.89 times as slow as at the centres. It is thicker in the middle, and sparks out.
#[test]
fn p5_strokes_along_a_slender_shaft_leave_a_barrel() {
    let mut rig = ready_with(1002, |_, part| {
        part.shaft = Some(ShaftFile { diameter: 5.0, z_from: 25.0, z_to: 85.0, centred: true });
        part.tailstock = None;
        part.bodies.clear();
        part.surfaces =
            vec![SurfaceFile::Diameter { z_from: 26.0, z_to: 84.0, stock: 5.1, cell: 1.0, runout: 0.0, waviness: 0.0 }];
    });
    rig.spin();
    let stroke = |rig: &mut Rig, x: f64, index: u32| {
        rig.go(x, if index.is_multiple_of(2) { 0.0 } else { 90.0 }, 200.0);
        rig.go(x, if index.is_multiple_of(2) { 90.0 } else { 0.0 }, 3_000.0);
    };
    rig.go(20.0, 0.0, 6_000.0);
    for index in 0..12 {
        stroke(&mut rig, 5.11 - 0.01 * f64::from(index), index);
    }
    let barrel = |rig: &Rig| (diameter(rig, 55.0) - 0.5 * (diameter(rig, 28.0) + diameter(rig, 82.0))) * 1_000.0;
    let fresh = barrel(&rig);
    assert!((0.2..6.0).contains(&fresh), "{fresh} µm");
    for index in 12..20 {
        stroke(&mut rig, 5.0, index);
    }
    assert!(barrel(&rig) < 0.1 * fresh, "{} of {fresh} µm", barrel(&rig));
}

/// The quill of O1017: 1 + 0.0001692·K/τ in the middle of the wheel with K/τ = 40000·20·π·39.8/(0.4·30159·0.8) = 10365 N/mm:
/// 2.75. Its tip, 10 mm farther, 3.13; its other end 2.38. At a plunge the bore is narrower at the far end.
#[test]
fn p5_a_quill_leaves_a_bore_narrower_at_its_far_end_until_it_has_sparked_out() {
    let mut rig = ready(1017);
    rig.spin();
    rig.go(36.0 - 64.0, 20.0, 6_000.0);
    rig.go(39.6 - 64.0, 20.0, 100.0);
    rig.go(39.9 - 64.0, 20.0, 0.6);
    let taper = |rig: &Rig| (diameter(rig, 38.0) - diameter(rig, 22.0)) * 1_000.0;
    // 2·0.01 mm/s·0.8 s·(3.05 − 2.46) between the places 8 mm from the middle: 9.4 µm.
    let fresh = taper(&rig);
    assert!((fresh - 9.4).abs() < 1.5, "{fresh} µm");
    let behind = (39.9 - diameter(&rig, 30.0)) * 1_000.0;
    // 2·0.01·0.8·2.75 = 44 µm.
    assert!((behind - 44.0).abs() < 3.0, "{behind} µm");
    rig.wait(25.0);
    assert!(taper(&rig).abs() < 0.2, "{} µm", taper(&rig));
}

/// The small wheel turns 18 times as fast and wears by its own volume; the wheel of the head is as it was.
#[test]
fn p2_the_internal_spindle_has_a_wheel_of_its_own() {
    let mut rig = ready(1017);
    rig.spin();
    let inner = rig.sim.wheel();
    assert!((inner.diameter_mm - 32.0).abs() < 1e-9 && (inner.rpm - 18_000.0).abs() < 1.0);
    // π·0.032·18000/60.
    assert!((inner.peripheral_m_s - 30.16).abs() < 0.01, "{}", inner.peripheral_m_s);
    rig.go(36.0 - 64.0, 20.0, 6_000.0);
    rig.go(39.9 - 64.0, 20.0, 3.0);
    rig.wait(20.0);
    let worn = (32.0 - rig.sim.wheel().diameter_mm) * 1_000.0;
    // π·39.8·0.1·20 = 250 mm³ over 500·π·32·20/2 = 0.50 µm of diameter.
    assert!((worn - 0.50).abs() < 0.05, "{worn} µm");
    let ring = kt830::io::sim::PartFile::builtin(1017).unwrap().unwrap();
    rig.sim.set_part(Some(&ring));
    assert!((32.0 - rig.sim.wheel().diameter_mm) * 1_000.0 > 0.4, "the next ring meets the same wheel");
    let shaft = kt830::io::sim::PartFile::builtin(1002).unwrap().unwrap();
    rig.sim.set_part(Some(&shaft));
    assert!((rig.sim.wheel().diameter_mm - 600.0).abs() < 1e-9);
    rig.sim.set_wheel_dullness(0.5);
    rig.sim.set_part(Some(&ring));
    let kept = rig.sim.wheel();
    assert!((32.0 - kept.diameter_mm) * 1_000.0 > 0.4 && kept.dullness < 0.1, "the inner wheel waited: {kept:?}");
    rig.sim.set_part(Some(&shaft));
    assert!((rig.sim.wheel().dullness - 0.5).abs() < 1e-9, "so did the outer one");
}

/// 10 µm of chatter at 100 Hz: the rim comes 10 µm nearer than it is told, in ten steps of a wave at least 10·cos 18° = 9.5 µm. What is
/// left at the gap g of the peak cuts for a part of the wave only: ġ = −0.3·g^1.5/(τ·√a), so that g^−½ = 0.3·t/(2·τ·√a) + a^−½ =
/// 1.5 after 20 s: 0.4 µm. The land is 18.1 to 19.1 µm smaller; the formula holds for small gaps, so half a micrometre more.
#[test]
fn p5_a_chattering_wheel_leaves_a_smaller_and_wavy_part() {
    let ground = |amplitude_um: f64| {
        let mut rig = ready_with(1002, |machine, _| {
            machine.vibration = Some(VibrationFile {
                eccentricity_um: 0.0,
                stiffness_n_um: 50.0,
                chatter_um: amplitude_um,
                chatter_growth: 0.0,
                natural_hz: 100.0,
            });
        });
        rig.spin();
        rig.go(40.4, 29.0, 6_000.0);
        rig.go(40.1, 29.0, 1.2);
        rig.wait(20.0);
        assert_eq!(rig.events(), []);
        (1_000.0 * diameter(&rig, 39.0), rig.sim.measure().roughness[0].waviness_um)
    };
    let (still, wavy) = (ground(0.0), ground(10.0));
    let smaller = still.0 - wavy.0;
    assert!((17.6..=19.6).contains(&smaller), "{smaller} µm");
    assert!(still.1.abs() < 1e-12 && (wavy.1 - 20.0).abs() < 0.1, "{} {}", still.1, wavy.1);
}

/// The gauge of O1002's part shows 1.5 µm too much once it is warm: its signals come when the part is 1.5 µm smaller. 0.6 mm/min are
/// 20 µm of diameter a second; stage 2 lies 20 µm above the set size.
#[test]
fn p7_the_signals_of_a_gauge_that_drifts_come_late() {
    let at_stage = |drift: Option<ThermalFile>| {
        let mut rig = ready_with(1002, |machine, _| {
            machine.gauges.drift = drift;
            machine.gauges.noise_um = 0.0;
        });
        rig.switch(Output::RadialGauge, true);
        rig.spin();
        rig.wait(20.0);
        rig.go(40.4, 29.0, 6_000.0);
        for step in 0..2_500 {
            rig.go(40.4 - 0.000_2 * f64::from(step), 29.0, 0.6);
            if rig.input(Input::Gauge2) {
                return 1_000.0 * diameter(&rig, 39.0);
            }
        }
        panic!("no signal");
    };
    let drift = Some(ThermalFile { growth_um: 1.5, time_constant_s: 1.0 });
    let late = at_stage(None) - at_stage(drift);
    // It is looked at every 0.2 µm.
    assert!((late - 1.5).abs() < 0.21, "{late} µm");
}

/// Ploughing takes 31.4 W/mm, down to removal rates of 0.05 mm³/(mm·s), where it fades: in a spark-out it takes hundreds of
/// J/mm³ for next to no volume, and burns nothing. 2.51 mm³/(mm·s) fall to an e-th in 0.8 s.
#[test]
fn p5_ploughing_does_not_burn_a_part_that_sparks_out() {
    let mut rig = ready_with(1002, |machine, _| {
        (machine.cutting.chip_j_mm3, machine.cutting.ploughing_n_mm) = (13.8, 1.0);
    });
    rig.switch(Output::Coolant, true);
    rig.spin();
    rig.go(40.4, 29.0, 6_000.0);
    rig.go(40.1, 29.0, 1.2);
    rig.wait(3.5);
    let found = rig.sim.process();
    // 2.51·e^(−3.5/0.8) = 0.0316 mm³/(mm·s): 31.4·(1 − e^−0.63) = 14.7 W/mm; chips 13.8 and sliding 26.2 J/mm³, by
    // the 227 mm³ so far, 0.57 % of the way from sharp to dull (0.8 to 2 s), 1.0085 times as much.
    assert!((found.ploughing_w / 18.0 - 14.7).abs() < 2.0, "{found:?}");
    assert!((found.sliding_w / found.chip_w - 1.008_5 * 26.2 / 13.8).abs() < 0.002, "{found:?}");
    rig.wait(8.5);
    assert!(rig.sim.process().ploughing_w < 1.0, "{:?}", rig.sim.process());
    assert_eq!(rig.events(), []);
}

/// G 4 and corners that wear three times as much: 0.2 mm of Ø40 by 18 mm are π·40.2·0.1·18 = 227 mm³; over 4·π·600·20 they wear the rim by
/// 1.5 µm, its corners by 4.5: the part is 6 µm thicker at its ends, less what the higher rim takes from them.
#[test]
fn p2_a_wheel_without_corners_leaves_a_thicker_part_at_its_ends() {
    let bulge = |corner_wear: f64| {
        let mut rig = ready_with(1002, |machine, _| {
            (machine.wheel.grinding_ratio, machine.wheel.corner_wear) = (4.0, corner_wear);
        });
        rig.spin();
        rig.go(40.4, 29.0, 6_000.0);
        rig.go(40.1, 29.0, 1.2);
        rig.wait(10.0);
        1_000.0 * (diameter(&rig, 30.5) - diameter(&rig, 39.5))
    };
    let (even, round) = (bulge(1.0), bulge(3.0));
    assert!(even.abs() < 0.3 && (4.0..=6.5).contains(&round), "{even} {round}");
}

/// The gauge of O1002's part shows the diameter above 40 mm, and its drift.
#[test]
fn p7_a_gauge_shows_the_size_while_its_arm_is_out() {
    let mut rig = ready_with(1002, |machine, _| {
        machine.gauges.drift = Some(ThermalFile { growth_um: 1.5, time_constant_s: 1.0 });
        machine.gauges.noise_um = 0.0;
    });
    rig.spin();
    assert_eq!(rig.sim.process().gauge_um, None);
    rig.switch(Output::RadialGauge, true);
    rig.go(40.35, 29.0, 6_000.0);
    rig.wait(5.0);
    let (shown, is) = (rig.sim.process().gauge_um.unwrap(), 1_000.0 * (diameter(&rig, 39.0) - 40.0));
    assert!((shown - is - 1.5).abs() < 0.05, "{shown} {is}");
    rig.switch(Output::RadialGauge, false);
    rig.wait(1.1);
    assert_eq!(rig.sim.process().gauge_um, None);
}
