//! The vertical lathe-grinder's programs correct the next part by the measured size of the last one (row S4).

use crate::stories::tell;
use crate::vertical::{BORE, S5, r, refused_at_the_start, run, vbore, vgrind};
use kt830::defs::program_number;
use kt830::host::headless::HeadlessHost;
use kt830::io::sim::PartFile;

/// R3 and R11 as delivered.
const DELIVERED: (f64, f64) = (300.0, 1_100.0);

/// Starts a program with values of its own; 0.5 s later the correction is made, and the wheel is on its way to the diamond.
fn started(program: &str, values: &str) -> HeadlessHost {
    let mut rig = match program {
        "VBORE" => vbore(1, &format!("{BORE}\n{values}")),
        _ => vgrind(1, values),
    };
    tell(&mut rig, "key cycle-start\nwait 0.5 s");
    rig
}

#[test]
fn s4_a_measured_size_corrects_wheel_and_diamond_small_errors_in_part() {
    let cases = [
        // A ring 10 µm too large: the wheel is 10 µm smaller than R3, and the diamond nearer than R11.
        ("VGRIND", "set R65 = 200.01\nset R66 = 200\nset R68 = 1\nset R69 = 0", -0.010),
        ("VGRIND", "set R65 = 200.003\nset R66 = 200\nset R68 = 1\nset R69 = 0", -0.003),
        // Later 0.7 of what may be an error of measuring, and all of what is more.
        ("VGRIND", "set R65 = 200.003\nset R66 = 200\nset R68 = 1\nset R69 = 1", -0.002_1),
        ("VGRIND", "set R65 = 200.01\nset R66 = 200\nset R68 = 1\nset R69 = 1", -0.010),
        ("VGRIND", "set R65 = 0\nset R66 = 200\nset R68 = 1\nset R69 = 1", 0.0),
        // R18 of the next part may be another.
        ("VGRIND", "set R65 = 205.01\nset R66 = 205\nset R68 = 1\nset R69 = 0", -0.010),
        // A bore that is too large: the wheel is larger than R3.
        ("VBORE", "set R65 = 500.01\nset R66 = 500\nset R68 = -1\nset R69 = 0", 0.010),
        // A ring was measured, and a bore comes next: the wheel is the same.
        ("VBORE", "set R65 = 200.01\nset R66 = 200\nset R68 = 1\nset R69 = 0", -0.010),
    ];
    for (program, values, change) in cases {
        let rig = started(program, &format!("{values}\nset R3 = 299.95"));
        assert!(r(&rig, 62).abs() < 1e-9 && r(&rig, 65).abs() < 1e-9, "{program} {values}");
        assert!((r(&rig, 3) - 299.95 - change).abs() < 1e-9, "{program} {values}: R3 {}", r(&rig, 3));
        assert!((r(&rig, 11) - DELIVERED.1 - change).abs() < 1e-9, "{program} {values}: R11 {}", r(&rig, 11));
    }
}

/// In single block with RESET the program begins anew between the correction and its end.
#[test]
fn s4_an_error_is_corrected_once_wherever_the_program_is_left() {
    for blocks in 1..16 {
        let mut rig = vgrind(1, "set R3 = 299.95\nset R65 = 200.01\nset R66 = 200\nset R68 = 1\nkey single-block");
        tell(&mut rig, &"key cycle-start\nwait 0.05 s\n".repeat(blocks));
        tell(&mut rig, "key reset\nwait 0.5 s\nkey single-block\nkey cycle-start\nwait 0.5 s");
        assert!((r(&rig, 11) - 1_099.99).abs() < 1e-9, "{blocks} blocks: R11 {}", r(&rig, 11));
    }
}

#[test]
fn s4_a_measured_size_that_cannot_be_right_corrects_nothing_and_nothing_starts() {
    let cases = [
        ("set R65 = 200.01\nset R66 = 0", ("错误13:没有磨完的工件可量", 13.0)),
        ("set R65 = 200.21\nset R66 = 200\nset R68 = 1\nset R69 = 0", ("错误14:实测尺寸相差太多", 14.0)),
        ("set R65 = 199.94\nset R66 = 200\nset R68 = 1\nset R69 = 1", ("错误14:实测尺寸相差太多", 14.0)),
    ];
    for program in ["VGRIND", "VBORE"] {
        for (values, told) in cases {
            let values =
                if program == "VBORE" { values.replace("200", "500").replace("199", "499") } else { values.to_owned() };
            let mut rig = if program == "VBORE" { vbore(1, BORE) } else { vgrind(1, "") };
            refused_at_the_start(&mut rig, &values, told);
            let rig = started(program, &values);
            assert_eq!((r(&rig, 3), r(&rig, 11)), DELIVERED, "{program} {values}");
        }
    }
}

#[test]
fn s4_a_size_measured_after_a_part_broken_off_is_deleted_and_the_next_start_grinds() {
    let mut rig = vgrind(1, S5);
    tell(&mut rig, "set R66 = 200\nkey cycle-start\nwait 5 s\nkey reset\nwait 60 s\nexpect R66 0");
    tell(&mut rig, "set R65 = 200.3\nkey cycle-start\nwait 1 s\nexpect R62 13\nexpect R65 0\nexpect no alarm");
    tell(&mut rig, "key cycle-start\nwait 5 s\nexpect output wheel on\nexpect R62 0");
}

#[test]
fn s4_the_part_after_a_measured_one_is_to_size() {
    let mut rig = vgrind(1, S5);
    // A diamond 16 µm from where R11 says: the parts are 16 µm too small.
    tell(&mut rig, "set R11 = 1099.984\nset R3 = 299.984");
    run(&mut rig, |_| {});
    tell(&mut rig, "expect no alarm\nexpect R62 0\nexpect R66 200");
    let part = PartFile::builtin(program_number::from_name("VGRIND")).unwrap().unwrap();
    let off_um = |rig: &HeadlessHost| rig.machine().measure().deviation(&part.drawing).unwrap().worst_um;
    // S5 keeps 2 µm with a diamond in its place.
    assert!((14.0..18.0).contains(&off_um(&rig).abs()), "{}", off_um(&rig));
    rig.type_measured_size(&part);
    rig.mount_part(&part);
    run(&mut rig, |_| {});
    tell(&mut rig, "expect no alarm\nexpect R65 0\nexpect R62 0");
    assert!(off_um(&rig).abs() < 2.0, "{}", off_um(&rig));
}
