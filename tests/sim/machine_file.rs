//! Machine files: the figures of the built-in ones, and those refused.

use kt830::defs::kind::Kind;
use kt830::defs::param::{self, Params};
use kt830::io::sim::{MachineFile, SimFileError, SimulatedMachine};

#[test]
fn p1_the_built_in_machine_has_the_figures_of_the_specification() {
    let gc = MachineFile::builtin(Kind::Gc).unwrap();
    assert_eq!(gc.kind, Kind::Gc);
    assert!(gc.y.is_none());
    let figures = [
        (2.0 / gc.x.following_rad_s, 0.020),
        (gc.x.resolution_mm, 0.001),
        (gc.bounce_s, 0.005),
        (gc.wheel.run_up_s, 8.0),
        (gc.wheel.coast_down_s, 60.0),
        (gc.wheel.grinding_ratio, 40.0),
        (gc.hydraulics.pressure_mpa, 3.0),
        (gc.hydraulics.switch_on_mpa, 2.5),
        (gc.hydraulics.switch_off_mpa, 2.2),
        (gc.cutting.sharp_s, 0.8),
        (gc.cutting.dull_s, 2.0),
    ];
    for (is, wanted) in figures {
        assert!((is - wanted).abs() < 1e-12, "{is} {wanted}");
    }
    assert!(gc.x.accel_mm_s2 > 800.0 && gc.x.jerk_mm_s3 > 20_000.0);
}

#[test]
fn p3_p7_every_kind_has_the_figures_of_the_specification() {
    for file in Kind::ALL.map(|kind| MachineFile::builtin(kind).unwrap()) {
        let (w, h, g) = (&file.wheel, &file.hydraulics, &file.gauges);
        assert_eq!((w.run_up_s, w.coast_down_s, w.grinding_ratio), (8.0, 60.0, 40.0));
        assert_eq!((h.gauge_arm_s, h.oscillation_mm_s), (1.0, 200.0));
        assert_eq!((g.stages_um, g.noise_um, g.delay_s), ([100.0, 20.0, 5.0, 0.0], 0.5, 0.01));
        if let Some(quill) = &h.tailstock {
            assert_eq!((quill.travel_mm, quill.travel_s), (30.0, 1.0));
        }
        if let Some(magnet) = &file.magnet {
            assert_eq!((magnet.magnetise_s, magnet.demagnetise_s), (1.0, 6.0));
        }
    }
}

#[test]
fn p1_every_kind_has_its_own_axes_and_gear() {
    let [gc, gs, ga] = [Kind::Gc, Kind::Gs, Kind::Ga].map(|kind| MachineFile::builtin(kind).unwrap());
    let there = |file: &MachineFile, fitted: bool| {
        let mut params = Params::factory(file.kind);
        params.write(param::Y_FITTED.address(), f64::from(u8::from(fitted))).unwrap();
        SimulatedMachine::new(file.clone(), None, &params, 1).axes().0
    };
    assert_eq!((there(&gc, false), there(&gc, true)), ([true, false, true], [true; 3]));
    assert_eq!((there(&gs, false), there(&gs, true)), ([true; 3], [true; 3]));
    assert_eq!((there(&ga, false), there(&ga, true)), ([true, false, true], [true; 3]));
    assert!(gc.workhead.is_some() && gc.table.is_none() && gc.magnet.is_none() && gc.hydraulics.tailstock.is_some());
    assert!(gs.workhead.is_none() && gs.table.is_none() && gs.magnet.is_some() && gs.hydraulics.tailstock.is_none());
    assert!(ga.workhead.is_none() && ga.table.is_some() && ga.magnet.is_some() && ga.hydraulics.tailstock.is_none());
    assert!(gs.dresser.unwrap().roll.is_some());
}

#[test]
fn p1_a_layout_without_its_axis_is_refused() {
    let wrong = Kind::Gc.row().machine_file.replacen("infeed: X", "infeed: Y", 1);
    let said = MachineFile::parse(&wrong).unwrap_err().to_string();
    assert_eq!(said, "layout: axis Y: the machine has no such axis");
    let twice = Kind::Gc.row().machine_file.replacen("infeed: X", "infeed: Z", 1);
    let said = MachineFile::parse(&twice).unwrap_err().to_string();
    assert_eq!(said, "layout: infeed, across and stroke must be three different axes");
}

#[test]
fn p1_a_wrong_machine_file_is_refused_with_its_place() {
    let unknown = Kind::Gc.row().machine_file.replacen("bounce_s", "bounce", 1);
    assert!(matches!(MachineFile::parse(&unknown), Err(SimFileError::Syntax(_))));
    let zero = Kind::Gc.row().machine_file.replacen("grinding_ratio: 40.0", "grinding_ratio: 0.0", 1);
    let said = MachineFile::parse(&zero).unwrap_err().to_string();
    assert_eq!(said, "wheel.grinding_ratio is 0: must be above zero");
    for kind in Kind::ALL {
        assert_eq!(MachineFile::builtin(kind).map(|file| file.kind), Ok(kind));
    }
}

/// What the builtin file leaves at its default, out of its range.
#[test]
fn p8_a_wrong_variation_is_refused_with_its_value() {
    for (text, said) in [
        ("(chip_j_mm3: Some(41.0))", "cutting.chip_j_mm3 is 41: must not exceed energy_j_mm3"),
        ("(chip_j_mm3: Some(-1.0))", "cutting.chip_j_mm3 is -1: must not be below zero"),
        ("(ploughing_n_mm: Some(-1.0))", "cutting.ploughing_n_mm is -1: must not be below zero"),
        ("(corner_wear: Some(0.0))", "wheel.corner_wear is 0: must be above zero"),
        ("(diamond_wear_um_cm3: Some(-0.1))", "dresser.wear_um_cm3 is -0.1: must not be below zero"),
        ("(coolant_noise: Some(-1.0))", "gauges.coolant_noise is -1: must not be below zero"),
        (
            "(gauge_drift: Some((growth_um: 1.0, time_constant_s: 0.0)))",
            "gauges.drift.time_constant_s is 0: must be above zero",
        ),
    ] {
        let refused = MachineFile::of_text(text, Kind::Gc).unwrap_err().to_string();
        assert_eq!(refused, said, "{text}");
    }
}
