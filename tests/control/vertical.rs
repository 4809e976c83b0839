//! The vertical lathe-grinder: its program grinds the part to size and follows the wheel, and the printed version is
//! stopped before it runs (rows S1–S5).

use crate::command::kt830;
use crate::stories::{ready_of, tell};
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::leadscrew::LeadscrewCompensation;
use kt830::defs::program_number;
use kt830::defs::signal::Output as SignalOutput;
use kt830::host::folders;
use kt830::host::headless::HeadlessHost;
use kt830::io::sim::{MachineFile, PartFile, SurfaceFile, TablePoint};
use kt830::link::command::Command;
use kt830::link::snapshot::RunState;
use kt830::units::{Axis, Micros};

/// The variable of R0.
const R0: u32 = 600;

pub(crate) fn r(rig: &HeadlessHost, number: u32) -> f64 {
    rig.controller().variable(R0 + number).unwrap_or_default()
}

/// A ready machine with the shipped program and its part.
pub(crate) fn vgrind(seed: u64, values: &str) -> HeadlessHost {
    let mut rig = ready_of(Kind::Vertical);
    rig.reseed(seed);
    rig.mount_part(&PartFile::builtin(program_number::from_name("VGRIND")).unwrap().unwrap());
    rig.step();
    rig.make_ready();
    tell(&mut rig, &format!("load VGRIND\nseed {seed}\nmode auto\n{values}"));
    rig
}

/// Runs to the end; looks at the rig in every tick.
pub(crate) fn run(rig: &mut HeadlessHost, mut look: impl FnMut(&HeadlessHost)) {
    rig.send(Command::Press(Key::CycleStart));
    let end = rig.now() + Micros::from_secs_f64(3_600.0);
    rig.step();
    rig.step();
    while rig.controller().state() == RunState::Running {
        assert!(rig.now() < end, "the program does not end");
        rig.step();
        look(rig);
    }
}

/// The set of S5; what is not given is as delivered.
pub(crate) const S5: &str = "set R18 = 200\nset R20 = 200.5\nset R25 = 0.05\nset R42 = 0.1";

#[test]
fn s5_the_corrected_program_ends_at_200_000_on_four_seeds_and_r3_follows_every_dressing() {
    let mut sizes = Vec::new();
    for seed in 1..=4 {
        let mut rig = vgrind(seed, S5);
        let (mut before, mut dressings) = (r(&rig, 3), 0);
        run(&mut rig, |rig| {
            let now = r(rig, 3);
            // L30 N180 puts the position into R3 for the length of a block: it is no diameter of a wheel.
            if now.total_cmp(&before).is_ne() && now < 400.0 {
                dressings += 1;
                let wheel = rig.machine().wheel().diameter_mm;
                assert!((now - wheel).abs() < 0.002, "seed {seed}: R3 {now}, wheel {wheel}");
                assert!((before - now - 0.03).abs() < 1e-9, "R36 off the diameter: {before} {now}");
                before = now;
            }
        });
        // At the start, before finishing, and after every R24 = 4 of the ten finishing strokes of 0.005.
        assert_eq!(dressings, 4, "seed {seed}");
        tell(&mut rig, "expect no alarm\nexpect no event\nexpect output wheel off\nexpect output table-rotation off");
        let diameters = rig.machine().measure().diameters;
        assert_eq!(diameters.len(), 5);
        for at in diameters {
            assert!((at.d - 200.0).abs() <= 0.002, "seed {seed}: {at:?}");
            sizes.push(at.d.to_bits());
        }
    }
    // Another wheel, screw and diamond with every seed: no two parts are the same.
    sizes.sort_unstable();
    sizes.dedup();
    assert_eq!(sizes.len(), 20);
}

/// The diameter that the tapered bore of VBORE is to have at Z: 500 at Z105, 1° narrower downwards.
fn bore_at(z: f64) -> f64 {
    500.0 - 2.0 * (105.0 - z) * 1.0_f64.to_radians().tan()
}

pub(crate) const BORE: &str = "set R18 = 500\nset R20 = 499.5\nset R14 = -1\nset R28 = 0.01\nset R43 = 0.01";

/// A ready machine with the program of the bore and its part.
pub(crate) fn vbore(seed: u64, values: &str) -> HeadlessHost {
    let mut rig = ready_of(Kind::Vertical);
    rig.reseed(seed);
    rig.mount_part(&PartFile::builtin(program_number::from_name("VBORE")).unwrap().unwrap());
    rig.step();
    rig.make_ready();
    tell(&mut rig, &format!("load VBORE\nseed {seed}\nmode auto\n{values}"));
    rig
}

#[test]
fn s6_a_tapered_bore_is_ground_to_size_and_the_wheel_leaves_it_upwards() {
    for seed in [1, 2, 3] {
        let mut rig = vbore(seed, BORE);
        run(&mut rig, |rig| {
            // Inside the ring's height the wheel's far rim never leaves the bore's finished diameter.
            let at = rig.machine().slide_mm();
            let (x, z) = (2.0 * (at[Axis::X] + 450.0), at[Axis::Z] + 500.0);
            let inside = z < 120.0 && x < 500.0;
            assert!(!inside || x + r(rig, 3) < bore_at(z) + 0.05, "seed {seed}: X {x} Z {z}");
        });
        tell(&mut rig, "expect no alarm\nexpect no event\nexpect output wheel off\nexpect R62 0");
        let diameters = rig.machine().measure().diameters;
        assert_eq!(diameters.len(), 5);
        for at in diameters {
            assert!((at.d - bore_at(at.z)).abs() <= 0.003, "seed {seed}: {at:?}, wanted {}", bore_at(at.z));
        }
        // Dressed along its own rim, the wheel is still a cylinder.
        let rims = rig.machine().rim_wear_mm();
        let (least, most) = rims.iter().fold((f64::MAX, f64::MIN), |(a, b), mm| (a.min(*mm), b.max(*mm)));
        assert!(most - least < 0.002, "seed {seed}: {least} to {most}");
    }
}

#[test]
fn s6_a_cylindrical_bore_is_ground_as_well() {
    let mut rig = vbore(1, "set R18 = 500\nset R20 = 499.8\nset R28 = 0.01\nset R43 = 0.01");
    let mut part = PartFile::builtin(program_number::from_name("VBORE")).unwrap().unwrap();
    part.head_deg = 0.0;
    part.surfaces = vec![SurfaceFile::Bore {
        z_from: 60.0,
        z_to: 120.0,
        stock_from: 499.8,
        stock_to: 499.8,
        thickness: 60.0,
        cell: 1.0,
        runout: 0.02,
        waviness: 0.003,
    }];
    rig.mount_part(&part);
    rig.step();
    run(&mut rig, |_| ());
    tell(&mut rig, "expect no alarm\nexpect no event");
    for at in rig.machine().measure().diameters {
        assert!((at.d - 500.0).abs() <= 0.002, "{at:?}");
    }
}

/// A bore that the wheel does not fit into, wrong allowances, and a wheel led sideways into the ring.
#[test]
fn s6_wrong_values_of_a_bore_are_refused_and_a_wrong_way_is_a_crash() {
    for (values, message, flag) in [
        ("set R18 = 300.3\nset R20 = 300.15", "错误06:砂轮进不了孔", 6.0),
        ("set R18 = 302\nset R20 = 301\nset R14 = -1", "错误06:砂轮进不了孔", 6.0), // 301 − 2.44 at the bottom
        ("set R18 = 499\nset R20 = 499.5\nset R14 = -1", "错误10:粗磨参数错误", 10.0),
        ("set R18 = 500\nset R20 = 499.5\nset R14 = -1\nset R43 = 0", "错误03:安全让刀参数错误", 3.0),
        ("set R18 = 500\nset R20 = 499.5\nset R37 = 0", "错误04:砂轮参数错误", 4.0),
    ] {
        let mut rig = vbore(1, values);
        run(&mut rig, |_| ());
        tell(
            &mut rig,
            &format!("expect message \"{message}\"\nexpect R62 {flag}\nexpect output wheel off\nexpect no alarm"),
        );
    }
    let mut rig = vbore(1, "mode mdi\nmdi G0 X197\nwait 2 s\nmdi G0 Z90\nwait 3 s\nexpect no event");
    // X + R3 = 500.2 is 0.1 mm and more inside the wall everywhere.
    tell(&mut rig, "mdi G0 X201\nwait 2 s\nexpect event crash");
}

#[test]
fn s6_the_check_stops_a_bore_that_would_become_too_large() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("VBORE.MPF", include_str!("../../programs/802d/VBORE.MPF").replace("R50=(R18-R25)-R60", "R50=R18-R60+R25")),
        ("L1.SPF", include_str!("../../programs/802d/L1.SPF").to_owned()),
        ("L3.SPF", include_str!("../../programs/802d/L3.SPF").to_owned()),
        ("L11.SPF", include_str!("../../programs/802d/L11.SPF").to_owned()),
        ("L21.SPF", include_str!("../../programs/802d/L21.SPF").to_owned()),
        ("L31.SPF", include_str!("../../programs/802d/L31.SPF").to_owned()),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let values = ["--set", "R18=500", "--set", "R20=499.5", "--set", "R14=-1"];
    let main = folder.path().join("VBORE.MPF");
    let call = ["check", "--kind", "vertical", "--simulate", "--lang", "en", main.to_str().unwrap()];
    let out = kt830(&[&call[..], &values[..]].concat());
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("N400 infeed goes past R18: R50=") && said.contains("above R18="), "{said}");
}

#[test]
fn s4_an_even_division_of_the_dressing_still_updates_r3_and_comes_back() {
    // R39 + R36 = 0.1 + 0.02 = 6 · R37.
    let mut rig = vgrind(1, "set R36 = 0.02\nset R37 = 0.02\nset R20 = 200.06\nset R24 = 50");
    let part = rig.machine().measure();
    assert!(!part.diameters.is_empty());
    let (mut seen, mut away) = (Vec::new(), false);
    run(&mut rig, |rig| {
        let now = r(rig, 3);
        if now < 400.0 && seen.last().is_none_or(|last: &f64| last.total_cmp(&now).is_ne()) {
            seen.push(now);
        }
        away |= seen.len() == 2 && rig.controller().actual()[Axis::X] < -190.0;
    });
    // 300, then 0.02 less after each of the two dressings.
    assert_eq!(seen.len(), 3, "{seen:?}");
    assert!((seen[1] - 299.98).abs() < 1e-9 && (seen[2] - 299.96).abs() < 1e-9, "{seen:?}");
    assert!(away, "the wheel came back to the part after the first dressing");
    tell(&mut rig, "expect no alarm");
}

#[test]
fn s4_every_wrong_value_is_named_and_every_exit_stops_the_wheel() {
    for (values, message, flag) in [
        ("set R7 = 36", "错误01:转速过高", 1.0),   // above the wheel's 35 m/s
        ("set R6 = 1900", "错误01:转速过高", 1.0), // 60000 · 30 / (π · 300) = 1910
        ("set R5 = 1920", "错误02:转速过低", 2.0),
        ("set R43 = 0", "错误03:安全让刀参数错误", 3.0),
        ("set R37 = 0", "错误04:砂轮参数错误", 4.0),
        ("set R3 = 210", "错误05:砂轮直径超出范围", 5.0),
        ("set R20 = 200", "错误10:粗磨参数错误", 10.0),
        ("set R22 = 0", "错误11:精磨参数错误", 11.0),
    ] {
        let mut rig = vgrind(1, values);
        run(&mut rig, |_| ());
        tell(
            &mut rig,
            &format!("expect message \"{message}\"\nexpect R62 {flag}\nexpect output wheel off\nexpect no alarm"),
        );
        assert_eq!(rig.snapshot().waiting_for.as_ref().map(|said| said.zh()).as_deref(), Some(message), "{values}");
        tell(&mut rig, "mode mdi\nmdi MSG()");
        assert!(rig.snapshot().waiting_for.is_none());
    }
}

/// A value that the program can judge is judged before anything starts or moves: the way of a wrong one ends in the diamond
/// or the part.
pub(crate) fn refused_at_the_start(rig: &mut HeadlessHost, values: &str, (message, flag): (&str, f64)) {
    let kept: Vec<_> =
        (R0 as u16 + 1..R0 as u16 + 48).map(|number| (number, rig.controller().variable(number.into()))).collect();
    tell(rig, values);
    let from = rig.controller().set_point();
    run(rig, |rig| {
        let output = |output: SignalOutput| rig.controller().output_set().has(output);
        let any = output(SignalOutput::Wheel) || output(SignalOutput::TableRotation) || output(SignalOutput::Coolant);
        assert!(!any, "{values}: something has been started");
        assert_eq!(rig.controller().set_point(), from, "{values}: something has moved");
    });
    tell(rig, &format!("expect message \"{message}\"\nexpect R62 {flag}\nexpect no alarm\nexpect no event"));
    assert_eq!(rig.snapshot().waiting_for.as_ref().map(|said| said.zh()).as_deref(), Some(message), "{values}");
    for (number, value) in kept {
        rig.send(Command::SetVariable(number, value));
    }
    rig.step();
}

/// Wrong values of L1, which both programs begin with.
const WRONG_VALUES: [(&str, (&str, f64)); 27] = [
    ("set R7 = 36", ("错误01:转速过高", 1.0)),   // above the wheel's 35 m/s
    ("set R6 = 1900", ("错误01:转速过高", 1.0)), // 60000 · 30 / (π · 300) = 1910
    ("set R5 = 1920", ("错误02:转速过低", 2.0)),
    ("set R5 = 0\nset R7 = 0", ("错误02:转速过低", 2.0)), // no lower limit, and yet it must turn
    ("set R42 = -0.1", ("错误03:安全让刀参数错误", 3.0)),
    ("set R43 = 0", ("错误03:安全让刀参数错误", 3.0)),
    ("set R44 = 0", ("错误03:安全让刀参数错误", 3.0)),
    ("set R4 = 0", ("错误04:砂轮参数错误", 4.0)),
    ("set R10 = -1", ("错误04:砂轮参数错误", 4.0)),
    ("set R36 = -0.03", ("错误04:砂轮参数错误", 4.0)),
    ("set R37 = 0", ("错误04:砂轮参数错误", 4.0)),
    ("set R38 = 0", ("错误04:砂轮参数错误", 4.0)),
    ("set R39 = -1", ("错误04:砂轮参数错误", 4.0)),
    ("set R3 = 210", ("错误05:砂轮直径超出范围", 5.0)),
    ("set R3 = 400", ("错误05:砂轮直径超出范围", 5.0)),
    ("set R1 = 299.99", ("错误05:砂轮直径超出范围", 5.0)), // 300 − 0.03 once dressed
    ("set R15 = -1", ("错误07:行程参数错误", 7.0)),
    ("set R14 = 90", ("错误07:行程参数错误", 7.0)),
    ("set R28 = 0", ("错误10:粗磨参数错误", 10.0)),
    ("set R29 = 0", ("错误10:粗磨参数错误", 10.0)),
    ("set R22 = 0", ("错误11:精磨参数错误", 11.0)),
    ("set R23 = -5", ("错误11:精磨参数错误", 11.0)),
    ("set R25 = -0.1", ("错误11:精磨参数错误", 11.0)),
    ("set R32 = -1", ("错误12:光磨参数错误", 12.0)),
    ("set R32 = 2.5", ("错误12:光磨参数错误", 12.0)),
    ("set R33 = 0", ("错误12:光磨参数错误", 12.0)),
    ("set R22 = 0\nset R43 = 0", ("错误03:安全让刀参数错误", 3.0)), // the first of two
];

#[test]
fn s4_values_that_can_be_judged_are_judged_before_anything_starts() {
    let own = [
        ("set R20 = 200", ("错误10:粗磨参数错误", 10.0)),
        ("set R18 = 201", ("错误10:粗磨参数错误", 10.0)),
        ("set R46 = 500", ("错误07:行程参数错误", 7.0)), // 200.5 + 0.1 + 300: the wheel's centre beside the part
    ];
    let mut rig = vgrind(1, "");
    for (values, told) in WRONG_VALUES.into_iter().chain(own) {
        refused_at_the_start(&mut rig, values, told);
    }
}

#[test]
fn s6_values_of_a_bore_that_can_be_judged_are_judged_before_anything_starts() {
    let own = [
        ("set R20 = 500", ("错误10:粗磨参数错误", 10.0)),
        ("set R47 = 100", ("错误07:行程参数错误", 7.0)), // R21 = 105
    ];
    let mut rig = vbore(1, BORE);
    for (values, told) in WRONG_VALUES.into_iter().chain(own) {
        refused_at_the_start(&mut rig, values, told);
    }
}

/// The checks of L20 and L30 stay as a second line: a value changed in the run still ends it.
#[test]
fn s4_a_value_that_goes_wrong_in_the_run_is_still_found() {
    let mut rig = vgrind(1, "");
    tell(&mut rig, "param P6.3 1\nkey cycle-start\nwait 3 s\nset R43 = 0\nwait until idle max 600 s");
    tell(
        &mut rig,
        "expect message \"错误03:安全让刀参数错误\"\nexpect R62 3\nexpect output wheel off\nexpect no alarm",
    );
}

/// L10 grinds a cone along R14: 2 · 70 · tan 1° = 2.4437 mm of diameter between R21 and R19.
#[test]
fn s6_the_stroke_follows_the_cone() {
    let mut rig = vgrind(1, "");
    let text = "N10 G90 G94\nN20 R14=1 R50=0.02 R51=1200 R15=0 R21=105 R19=35\nN30 G0 X700 Z105\nN40 L10\nN50 M2";
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("CONE"),
        "CONE.MPF",
        text.as_bytes().to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load CONE\nmode auto");
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    rig.send(Command::Press(Key::CycleStart));
    for _ in 0..30_000 {
        rig.step();
        let at = rig.snapshot().axes;
        if rig.controller().current_block().program == program_number::from_l(10) {
            low = low.min(at[Axis::X].work);
            high = high.max(at[Axis::X].work);
        }
    }
    let rise = 2.0 * 70.0 * 1.0_f64.to_radians().tan();
    // The encoder reads in steps of 1 µm, 2 µm on a diameter.
    assert!((low - 699.98).abs() < 0.003 && (high - 699.98 - rise).abs() < 0.003, "{low} {high}");
    tell(&mut rig, "expect X 699.98 ±0.001\nexpect Z 105 ±0.001");
}

/// Field problem 2: a loop of 30 blocks is read ahead, and R1 shows what is executed all the same.
#[test]
fn s2_r_parameters_are_shown_as_executed_in_every_tick() {
    let mut rig = vgrind(1, "");
    let text = "N10 R1=0\nN15 G90 G94 F600 G0 X690\nAA1:R1=R1+1\nN30 G1 G91 X-0.2\nN40 IF R1<30 GOTOB AA1\nN50 M2";
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("LOOP"),
        "LOOP.MPF",
        text.as_bytes().to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load LOOP\nmode auto");
    let mut before = None;
    let mut seen = 0;
    run(&mut rig, |rig| {
        let now = r(rig, 1);
        if before.is_some_and(|before: f64| before.total_cmp(&now).is_ne()) {
            assert!((now - f64::from(seen) - 1.0).abs() < 1e-12, "one after the other: {now}");
            // R1 = k is executed when k − 1 moves of 0.1 mm of slide are done: X 690 is machine −105.
            let stands = rig.controller().set_point()[Axis::X];
            assert!((stands - (-105.0 - 0.1 * f64::from(seen))).abs() < 0.1, "R1 {now} at {stands}");
            seen += 1;
        }
        before = Some(now);
    });
    assert_eq!(seen, 30);
}

const SETS: [&str; 8] = ["--set", "R18=200", "--set", "R20=200.5", "--set", "R25=0.05", "--set", "R42=0.1"];

#[test]
fn s5_the_printed_program_is_stopped_by_the_check_at_n340_and_not_run() {
    let words = ["check", "--kind", "vertical", "--simulate", "--lang", "en", "programs/802d/as-printed/PRINTED.MPF"];
    let out = kt830(&[&words[..], &SETS[..]].concat());
    assert_eq!(out.status.code(), Some(2), "{out:?}");
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    // R60 = 200.06 after 22 strokes of 0.02; 200.06 − 200 + 0.05 = 0.11.
    let reason = "N340 infeed goes past R18: R50=0.110 gives diameter 199.950, below R18=200.000; not executed";
    assert!(said.contains(&format!("PRINTED.MPF:35:10: {reason}")), "{said}");
    assert!(!said.contains("part diameter"), "it has not run: {said}");
}

/// The infeed leads to the diameter, the feed does not: named is what the axis words were calculated with.
#[test]
fn s5_the_check_names_the_infeed_and_not_the_feed() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["L3", "L10", "L20", "L30"] {
        let text = std::fs::read(format!("{}/programs/802d/{name}.SPF", env!("CARGO_MANIFEST_DIR"))).unwrap();
        std::fs::write(folder.path().join(format!("{name}.SPF")), text).unwrap();
    }
    // Without the checks of L1 an allowance below 0 grinds to 199.9: by the R50 of the rough strokes.
    std::fs::write(folder.path().join("L1.SPF"), "N10 R8=1900\nN20 RET\n").unwrap();
    let main = folder.path().join("VGRIND.MPF");
    std::fs::write(&main, include_str!("../../programs/802d/VGRIND.MPF")).unwrap();
    let call = ["check", "--kind", "vertical", "--simulate", "--lang", "en", main.to_str().unwrap()];
    let out = kt830(&[&call[..], &SETS[..], &["--set", "R25=-0.1"]].concat());
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(said.contains("N325 infeed goes past R18: R50=0.020 gives") || said.contains("N340 infeed"), "{said}");
    assert!(!said.contains("R51="), "{said}");
    // As printed with no allowance, the let-off behind the last rough stroke goes past the size: R43 in N390.
    let printed = "programs/802d/as-printed/PRINTED.MPF";
    let call = ["check", "--kind", "vertical", "--simulate", "--lang", "en", printed];
    let out = kt830(&[&call[..], &SETS[..], &["--set", "R25=0"]].concat());
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(said.contains("infeed goes past R18: R50=") && !said.contains("R51="), "{said}");
}

/// A subprogram of the 802D has a name: a report says L53, the text as the JSON.
#[test]
fn s1_an_alarm_in_a_subprogram_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let main = folder.path().join("TEST.MPF");
    std::fs::write(&main, "L53\nM2\n").unwrap();
    std::fs::write(folder.path().join("L53.SPF"), "G4 F0.1\nG0 X=R98/R99\nRET\n").unwrap();
    let call = ["run", "--kind", "vertical", "--lang", "en", "--format", "json", main.to_str().unwrap()];
    let out = kt830(&call);
    let told: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((&told["alarms"][0]["program"], &told["alarms"][0]["line"]), (&"L53".into(), &2.into()), "{told}");
}

/// The slides tremble where they stand: the wheel that has run into the diamond has done so once, until it has left it.
#[test]
fn p8_one_crash_is_one_event_until_its_place_is_left() {
    let mut rig = vgrind(1, "");
    let text = "N10 G90 G94 M63 S1500 M3\nN20 G0 X=R46 Z=R47\nN30 R80=R11-R3+1\nN40 G0 X=R80 Z=R12\nN50 M2";
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("RAM"),
        "RAM.MPF",
        text.as_bytes().to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load RAM\nmode auto\nkey cycle-start\nwait until alarm max 60 s\nwait 20 s\nexpect event crash");
    let places = |rig: &HeadlessHost| rig.machine().events().iter().map(|event| event.place).collect::<Vec<_>>();
    assert_eq!(places(&rig), ["dresser"]);
    // Away and back again is another one.
    tell(&mut rig, "key reset\nmode jog\nhold X- 1 s\nwait 2 s");
    assert_eq!(places(&rig), ["dresser"]);
    tell(&mut rig, "hold X+ 3 s\nwait 5 s");
    assert_eq!(places(&rig), ["dresser", "dresser"]);
}

#[test]
fn s1_a_feed_per_revolution_without_a_turning_part_says_so() {
    let mut rig = vgrind(1, "");
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("TURN"),
        "TURN.MPF",
        b"G95 G1 X690 F0.2\nM2\n".to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load TURN\nmode auto\nkey cycle-start\nwait 2 s\nexpect alarm \"每转进给需要工件转动\"");
    assert!(!rig.snapshot().alarms[0].text.zh().contains("需要头架"));
}

/// As printed, L30 sets R60 back with every dressing: it never ends, and the check counts up to there and says so.
#[test]
fn s5_the_check_of_the_printed_program_names_the_loop_that_does_not_end() {
    let file = "programs/802d/as-printed/PRINTED.MPF";
    for (lang, loops, up_to) in [
        ("zh", ":57:1: 警告：检查没有把这个循环走到底：", "74 行  没有走到底的循环只算到开始重复为止："),
        (
            "en",
            ":57:1: warning: this loop is not followed to the end: ",
            "74 lines  loops that are not followed to the end count until they repeat: ",
        ),
    ] {
        let out = kt830(&[&["check", "--kind", "vertical", "--lang", lang, file], &SETS[..]].concat());
        let (said, warned) = (String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
        // N560 IF R61>0 GOTOB BB1 is line 57.
        assert!(warned.contains(&format!("{file}{loops}")), "{warned}");
        assert!(said.contains(up_to), "{said}");
    }
    let out = kt830(&[&["check", "--kind", "vertical", "--format", "json", file], &SETS[..]].concat());
    let told: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(told["finished"], false);
    // 22 + 1 rough and 10 fine strokes of 2 · 70 mm at 1200 mm/min, 7 s each, and the dressings between: not hours.
    let seconds = told["seconds"].as_f64().unwrap();
    assert!((231.0..900.0).contains(&seconds), "{seconds}");
}

#[test]
fn s5_the_corrected_program_passes_the_same_check_and_runs() {
    let words = ["check", "--kind", "vertical", "--simulate", "--lang", "en", "programs/802d/VGRIND.MPF"];
    let out = kt830(&[&words[..], &SETS[..]].concat());
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(out.status.code(), Some(0), "{said}");
    assert!(said.contains("finished") && said.contains("R60 = 200\n"), "{said}");
}

#[test]
fn s1_a_subprogram_is_looked_for_beside_the_file_first() {
    let folder = tempfile::tempdir().unwrap();
    let main = folder.path().join("test.mpf");
    std::fs::write(&main, "L10 P2\nL77\nM2\n").unwrap();
    std::fs::write(folder.path().join("l10.spf"), "G91 G0 X1\nRET\n").unwrap();
    let out = kt830(&["check", "--kind", "vertical", "--ops", "--lang", "en", main.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(said.starts_with("rapid x=0.5 y=0 z=0 [X+]\nrapid x=1 y=0 z=0 [X+]\n"), "{said}");
    assert!(said.contains("test.mpf:2:1: there is no program L77"), "{said}");
}

/// What each line of a program took off the part, as the sum of diameters at every millimetre.
fn removed_by_line(rig: &mut HeadlessHost, lines: [u32; 2]) -> [Vec<f64>; 2] {
    let sum = |rig: &HeadlessHost| (62..118).filter_map(|z| rig.machine().diameter_at(f64::from(z))).sum::<f64>();
    let (mut line, mut before) = (0, sum(rig));
    let mut removed = [Vec::new(), Vec::new()];
    run(rig, |rig| {
        let now = rig.controller().current_block().line;
        if now != line {
            let after = sum(rig);
            if let Some(index) = lines.iter().position(|of| *of == line) {
                removed[index].push(before - after);
            }
            (line, before) = (now, after);
        }
    });
    removed
}

/// A cone of 2 · 70 · 0.02 = 2.8 mm between Z 105 and 35, ready for strokes: the part is a stair of its steps.
fn cone(screw: &[(f64, f64)], table: &str) -> HeadlessHost {
    let mut machine = MachineFile::builtin(Kind::Vertical).unwrap();
    machine.x.backlash_mm = screw.iter().map(|(at, play)| TablePoint(*at, *play)).collect();
    let mut part = PartFile::builtin(program_number::from_name("VGRIND")).unwrap().unwrap();
    part.finished = None;
    // A slim wheel grinds the cone true enough; its lower edge stands at Z. On the cone X is 499.32 at Z 122.
    machine.wheel.width_mm = 4.0;
    part.surfaces = (60..120)
        .map(|z| {
            let stock = 200.0 + 0.04 * (105.0 - f64::from(z));
            SurfaceFile::Diameter {
                z_from: f64::from(z),
                z_to: f64::from(z) + 1.0,
                stock,
                cell: 1.0,
                runout: 0.0,
                waviness: 0.0,
            }
        })
        .collect();
    let mut rig = ready_of(Kind::Vertical);
    rig.swap_machine(machine, 1);
    rig.mount_part(&part);
    rig.step();
    if !table.is_empty() {
        rig.send(Command::SetLeadscrew(Axis::X, LeadscrewCompensation::parse(table).unwrap()));
        rig.step();
    }
    rig.make_ready();
    let text = "N10 G90 G94 M63 M3\nN20 R1=40\nN30 G0 X499.4 Z122\nAA1:G91 G1 X=-0.01 F600\nG1 X=0.04*70 Z=-70\nG4 F0.5\n\
                G1 X=-0.01\nG1 X=-0.04*70 Z=70\nG4 F0.5\nR1=R1-1\nIF R1>0 GOTOB AA1\nG90 G0 X700\nM5 M65\nM2";
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("TAPER"),
        "TAPER.MPF",
        text.as_bytes().to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load TAPER\nmode auto");
    rig.mount_part(&part);
    rig.step();
    rig
}

/// Field problem 1: with a play of 0.02 to 0.03 mm one direction of a taper stroke does not reach the part; with the
/// table of that play in the control both directions take their share.
#[test]
fn s6_the_backlash_table_makes_both_directions_of_a_taper_stroke_cut() {
    let screw = [(-300.0, 0.04), (-200.0, 0.02), (-100.0, 0.0)];
    let table: String = screw.iter().map(|(at, play)| format!("{at},{play}\n")).collect();
    let shares = |rig: &mut HeadlessHost| {
        // Lines 5 (X plus, Z minus) and 8 (X minus, Z plus); the last ten strokes, when the cone is under way.
        let [down, up] = removed_by_line(rig, [5, 8]);
        assert_eq!((down.len(), up.len()), (40, 40));
        (down[30..].iter().sum::<f64>(), up[30..].iter().sum::<f64>())
    };
    let (down, up) = shares(&mut cone(&screw, ""));
    assert!(down > 5.0 && up < 0.02 * down, "before: down {down}, up {up}");
    let (down, up) = shares(&mut cone(&screw, &table));
    assert!(up > 0.5 * down && down > 0.5 * up, "after: down {down}, up {up}");
    let (true_down, true_up) = shares(&mut cone(&[], ""));
    assert!((down / true_down - 1.0).abs() < 0.1 && (up / true_up - 1.0).abs() < 0.1, "as a true screw: {down} {up}");
}

/// Field problem 3: 0.005 is 0.005 and not 0.004, in the position and in the distance to go.
#[test]
fn b7_a_diameter_of_0_005_is_shown_as_0_005() {
    let shown = |value: f64| format!("{value:.3}");
    let mut rig = vgrind(1, "");
    let text = "G90 G94 F30\nG0 X700\nG91 G1 X-0.005\nG1 X-0.001\nM2";
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("FINE"),
        "FINE.MPF",
        text.as_bytes().to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load FINE\nmode auto\nkey single-block\nkey cycle-start\nwait until stopped");
    rig.send(Command::Press(Key::CycleStart));
    let mut to_go = Vec::new();
    for _ in 0..1_000 {
        rig.step();
        to_go.push(shown(rig.snapshot().axes[Axis::X].to_go.abs()));
    }
    assert!(to_go.contains(&"0.005".to_owned()));
    assert_eq!(shown(rig.snapshot().axes[Axis::X].work), "699.995");
    tell(&mut rig, "key cycle-start\nwait until stopped\nwait 0.5 s");
    assert_eq!(shown(rig.snapshot().axes[Axis::X].work), "699.994");
}

/// A worn screw and its table, by story: the slide stands where it should, whichever way it came.
#[test]
fn b7_a_worn_screw_is_put_right_by_its_table_in_both_directions() {
    let folder = tempfile::tempdir().unwrap();
    // 0.05 mm at the stop −458, none at the stop 8.
    std::fs::write(folder.path().join("x.csv"), "位置,间隙\n-458,0.05\n8,0\n").unwrap();
    let off = |rig: &HeadlessHost| rig.machine().slide_mm()[Axis::X] - rig.controller().actual()[Axis::X];
    let mut rig = vgrind(1, "fault worn-screw-x\nmode mdi\nmdi G90 G0 X600\nwait 0.5 s");
    // Machine −150 from above: the motor is there, the slide hangs back by 0.05 · 158/466 = 0.01695 mm.
    assert!((off(&rig) - 0.016_95).abs() < 0.000_1, "{}", off(&rig));
    rig.send(Command::SetLeadscrew(
        Axis::X,
        LeadscrewCompensation::parse(&std::fs::read_to_string(folder.path().join("x.csv")).unwrap()).unwrap(),
    ));
    tell(&mut rig, "wait 0.5 s\nexpect X 600 ±0.001");
    assert!(off(&rig).abs() < 0.000_1, "{}", off(&rig));
    tell(&mut rig, "mdi G0 X610\nwait 0.5 s\nexpect X 610 ±0.001");
    assert!(off(&rig).abs() < 0.000_1, "from below: {}", off(&rig));
    tell(&mut rig, "mdi G0 X500\nwait 0.5 s");
    assert!(off(&rig).abs() < 0.000_1, "elsewhere: {}", off(&rig));
    tell(&mut rig, "power cut\nwait 1 s\npower on\nkey hydraulic\nhome all\nmode mdi\nmdi G90 G0 X600\nwait 0.5 s");
    assert!(off(&rig).abs() < 0.000_5, "retained, and homed with it: {}", off(&rig));
    tell(&mut rig, "expect no alarm");
}

#[test]
fn b7_a_screw_table_is_imported_from_csv_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data").to_string_lossy().into_owned();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_string_lossy().into_owned()
    };
    let (good, bad) = (file("good.csv", "-300,0.04,0.002\n-100,0\n"), file("bad.csv", "-300,0.04\n-400,0\n"));
    let at = ["--data", &data, "--kind", "vertical", "--lang", "en"];
    let call = |words: &[&str]| kt830(&[words, &at].concat());
    assert_eq!(call(&["screw", "x", &good]).status.code(), Some(0));
    let refused = call(&["screw", "X", &bad]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    assert!(said.contains("bad.csv:2: positions must rise from line to line"), "{said}");
    let shown = String::from_utf8_lossy(&call(&["screw", "x"]).stdout).into_owned();
    assert!(shown.ends_with("mm\n-300,0.04,0.002\n-100,0,0\n"), "{shown}");
    assert_eq!(call(&["screw", "x", "--clear"]).status.code(), Some(0));
    assert!(String::from_utf8_lossy(&call(&["screw", "x"]).stdout).ends_with("mm\n\n"));
}

/// The seed's table stands on three sheets, edited like the grinding page; a value that no sheet shows is refused.
#[test]
fn s3_the_r_page_shows_the_table_of_the_seed_and_takes_values() {
    let mut rig = vgrind(1, "page grinding\nexpect no alarm");
    for (number, sheet) in [(1_801, 0), (1_802, 1), (1_803, 2)] {
        rig.send(Command::ShowGrindingSheet(sheet));
        rig.step();
        let shown = rig.snapshot().clone();
        assert_eq!((shown.grinding_page_number(), shown.grinding_sheet), (Some(number), (sheet, 3)));
        let files = shown.page_files().unwrap();
        assert!(files.text.is_ok() && files.picture.is_ok(), "{number}");
    }
    let screens = rig.snapshot().screens.clone();
    let rows = |number| screens.find(number).unwrap().text.clone().unwrap();
    let mut shown: Vec<u16> = [1_801, 1_802, 1_803]
        .into_iter()
        .flat_map(|n| rows(n).rows().map(|row| row.variable).collect::<Vec<_>>())
        .collect();
    shown.sort_unstable();
    // R1–R15, R18–R25, R28–R30, R32, R33, R36–R39, R42–R44, R46, R47, R50–R54, R56–R58, R60–R62 of the seed; R16, R59,
    // R65 to R69 and R80 are this program's.
    let of_pages =
        [1..=16, 18..=25, 28..=30, 32..=33, 36..=39, 42..=44, 46..=47, 50..=54, 56..=62, 65..=67, 69..=69, 80..=80];
    let expected: Vec<u16> = of_pages.into_iter().flatten().map(|n| 600 + n).collect();
    assert_eq!(shown, expected);
    tell(
        &mut rig,
        "type R18 199.5\nexpect R18 199.5\nexpect message \"R18 = 199.500\"\nsheet 2\ntype R3 298\nexpect R3 298",
    );
    tell(&mut rig, "type R100 1\nexpect message \"当前页面没有 R100\"");
    tell(&mut rig, "power cut\nwait 1 s\npower on\nexpect R18 199.5\nexpect R3 298");
}

/// A page text names R parameters as well as variables.
#[test]
fn s3_page_texts_name_r_parameters() {
    let left = ";".repeat(8);
    let text = kt830::defs::page_text::parse(&format!("题;\nR1 砂轮 R18;\n余量 #500;\n{left}\n%")).unwrap();
    let rows: Vec<_> = text.rows().map(|row| (row.label.as_str(), row.variable)).collect();
    assert_eq!(rows, [("R1 砂轮", 618), ("余量", 500)]);
    let wrong = kt830::defs::page_text::parse(&format!("题;\n砂轮 R300;\n{}\n%", ";".repeat(9))).unwrap_err();
    assert_eq!((wrong.line, wrong.column), (2, 1));
}

/// A block that is written wrong is an alarm with program, line and column before the program moves; what only its
/// values make wrong is one when the machine gets there, and nothing of the block is done.
#[test]
fn s1_a_wrong_block_is_an_alarm_with_its_place_and_nothing_of_it_moves() {
    for (block, said) in [
        ("G0 X=R[300*R1]", "WRONG 第3行 第6列：没有参数 R300"),
        ("R2=1/(R1-R1)", "WRONG 第3行 第5列：除数为零"),
        ("G2 X=R1*600 CR=R1 F600", "WRONG 第3行 第13列：圆弧半径 CR=1 无效"),
    ] {
        let mut rig = wrong(block);
        let alarms = rig.snapshot().alarms.clone();
        assert!(alarms[0].text.zh().contains(said), "{block}: {}", alarms[0].text.zh());
        tell(&mut rig, "expect X 690 ±0.001\nexpect output wheel off");
    }
    for (block, said) in [
        ("R1=5 G0 X=R300", "WRONG 第3行 第11列：没有参数 R300"),
        ("R1=5 G0 X600 GOTOF AA1", "WRONG 第3行 第14列：无法识别的字 'GOTOF'"),
        ("IF R1<5 GOTOF AA9", "WRONG 第3行 第15列：找不到标号 AA9"),
        ("IF R1<5 GOTOB AA1", "WRONG 第3行 第15列：标号 AA1 不在跳转方向上"),
        ("MSG(\"abc)", "WRONG 第3行 第5列：引号不匹配"),
        ("G0 X600 L10", "WRONG 第3行 第1列：L10 与 G0 不能同段"),
        ("L99", "WRONG 第3行 第1列：找不到程序 L99"),
        ("G2 X650 Z-5 CR=50 I-2", "WRONG 第3行 第19列：CR 与 I 不能同段"),
        ("G1 X650 F100 RND=1 CHF=2", "WRONG 第3行 第14列：CHF 与 RND 不能同段"),
        ("R[999]=5", "WRONG 第3行 第1列：没有参数 R999"),
        ("G53 X=IC(-1)", "WRONG 第3行 第5列：G53 与 G91 / IC 不能同段"),
        ("G91 G53 X-1", "WRONG 第3行 第9列：G53 与 G91 / IC 不能同段"),
    ] {
        let mut rig = wrong(block);
        let alarms = rig.snapshot().alarms.clone();
        assert!(alarms[0].text.zh().contains(said), "{block}: {}", alarms[0].text.zh());
        tell(&mut rig, "expect X 700 ±0.000001\nexpect output wheel off");
    }
}

/// Has started a program of a move to X690 and this block.
fn wrong(block: &str) -> HeadlessHost {
    let mut rig = vgrind(1, "");
    let text = format!("; 错误\nG90 G0 X690\n{block}\nG0 X600\nAA1:M2\n");
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("WRONG"),
        "WRONG.MPF",
        text.into_bytes(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load WRONG\nmode auto\nset R1 = 1\nkey cycle-start\nwait 3 s\nexpect alarm any\nexpect R1 1");
    rig
}

/// `R[…]` is read with the values of the run, not refused at the start with all of them 0.
#[test]
fn s1_a_computed_parameter_number_is_that_of_the_run() {
    let mut rig = vgrind(1, "");
    let text = "R1=10\nR[R1-1]=5\nR2=R[R1-1]\nR1=-1\nR[R1+300]=4\nM2\n";
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("INDEX"),
        "INDEX.MPF",
        text.as_bytes().to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load INDEX\nmode auto\nkey cycle-start\nwait until idle max 20 s\nexpect no alarm");
    tell(&mut rig, "expect R9 5\nexpect R2 5\nexpect R299 4");
}

/// Jumps and conditions in a run as in the check; a message stays until MSG().
#[test]
fn s1_a_message_stays_until_the_next_and_repeats_are_counted() {
    let mut rig = vgrind(1, "");
    let text = "R1=0\nMSG(“粗磨”)\nG4 F1\nMSG()\nG4 F1\nMSG(\"精磨\")\nM2";
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("TELL"),
        "TELL.MPF",
        text.as_bytes().to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load TELL\nmode auto\nkey cycle-start\nwait 0.5 s");
    let told = |rig: &mut HeadlessHost| rig.snapshot().waiting_for.as_ref().map(|said| said.zh().into_owned());
    assert_eq!(told(&mut rig).as_deref(), Some("粗磨"));
    tell(&mut rig, "wait 1 s");
    assert_eq!(told(&mut rig), None);
    tell(&mut rig, "wait until idle");
    assert_eq!(told(&mut rig).as_deref(), Some("精磨"));
    tell(&mut rig, "key reset");
    assert_eq!(told(&mut rig).as_deref(), Some("精磨"));
}

/// What the language's rules forbid is told at its place before anything moves, in subprograms too.
#[test]
fn s1_a_program_with_a_mistake_does_not_start() {
    #[rustfmt::skip]
    const ROWS: &[(&str, u32, u16, &str, &str)] = &[
        ("IF R1>5 GOTOF AA9", 15, 91, "there is no label AA9", "找不到标号 AA9"),
        ("GOTOF AA1", 7, 92, "label AA1 is not in this direction", "标号 AA1 不在跳转方向上"),
        ("GOTOB BB1", 7, 92, "label BB1 is not in this direction", "标号 BB1 不在跳转方向上"),
        ("MSG(\"abc)", 5, 93, "the quotes do not match", "引号不匹配"),
        ("MSG(“abc\")", 5, 93, "the quotes do not match", "引号不匹配"),
        ("R300=1", 1, 90, "there is no parameter R300", "没有参数 R300"),
        ("R1=R301", 4, 90, "there is no parameter R301", "没有参数 R301"),
        ("G77", 1, 55, "unknown code G77", "没有 G77 指令"),
        ("GOTO AA1", 1, 63, "there is no GOTO", "没有 GOTO 指令"),
    ];
    for (block, column, alarm, en, zh) in ROWS {
        let mut rig = vgrind(1, "");
        let text = format!("N10 G90 G94 F600 G0 X650\nAA1:M3\n{block}\nBB1:M2\n");
        rig.add_program(folders::program_from_bytes(
            program_number::from_name("WRONG"),
            "WRONG.MPF",
            text.into_bytes(),
            rig.kind().dialect(),
        ));
        tell(&mut rig, "load WRONG\nmode auto");
        let before = rig.controller().set_point();
        tell(&mut rig, "key cycle-start\nwait until alarm max 20 s\nwait 1 s\nexpect output wheel off");
        assert_eq!(rig.controller().set_point(), before, "{block}");
        let told = &rig.snapshot().alarms[0];
        let (said_en, said_zh) = (told.text.en().to_string(), told.text.zh().to_string());
        assert_eq!(said_en, format!("WRONG line 3, column {column}: {en}"), "{block}");
        assert_eq!(said_zh, format!("WRONG 第3行 第{column}列：{zh}"), "{block}");
        assert!(!told.remedy.is_blank() && told.cause.is_blank(), "{block}");
        assert_eq!(told.number, *alarm, "{block}");
    }
    let mut rig = vgrind(1, "");
    let main = "N10 G90 G94 F600 G0 X650\nL77\nM2\n";
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("WRONG"),
        "WRONG.MPF",
        main.as_bytes().to_vec(),
        rig.kind().dialect(),
    ));
    rig.add_program(folders::program_from_bytes(
        program_number::from_name("L77"),
        "L77.SPF",
        b"G0 X600\nGOTOF AA1\nRET\n".to_vec(),
        rig.kind().dialect(),
    ));
    tell(&mut rig, "load WRONG\nmode auto");
    let before = rig.controller().set_point();
    tell(&mut rig, "key cycle-start\nwait until alarm max 20 s\nwait 1 s");
    assert_eq!(rig.controller().set_point(), before);
    let said = rig.snapshot().alarms[0].text.en().to_string();
    assert!(said.starts_with("L77 line 2, column 7: there is no label AA1"), "{said}");
}
