//! The shipped O9000 and O9001 in the middle of a cut, on every kind: the wheel goes off along its own axis, comes back, and
//! the part gets its size (K6.4).

use kt830::units::Axis;

use super::shop::shop;
use crate::stories::tell;

#[test]
fn k6_4_the_wheel_goes_off_and_comes_back_in_the_middle_of_a_cut() {
    // The axis that takes the wheel off, where the cut is under way, the size.
    let cases = [
        (1002, Axis::X, "wait until X<40.2 max 60 s", 40.0),
        (1007, Axis::Y, "wait until Y<20.09 max 120 s", 20.0),
        (1010, Axis::Z, "wait until Z<25.04 max 300 s", 25.0),
    ];
    for (program, axis, cut, size) in cases {
        let mut shop = shop(program);
        let rig = &mut shop.rig;
        tell(rig, &format!("param P4.4 1\nmode auto\nkey cycle-start\n{cut}"));
        tell(rig, "key wheel-retract\nwait until held max 10 s\nwait 1 s\nexpect lamp wheel-retract on");
        let off = rig.machine().slide_mm();
        tell(rig, "key wheel-retract\nwait 0.1 s\nwait until held max 10 s\nwait 1 s\nexpect lamp wheel-retract off");
        let back = rig.machine().slide_mm();
        for (of, there) in back.iter() {
            let gone = off[of] - there;
            let wanted = if of == axis { 5.0 } else { 0.0 };
            assert!((gone - wanted).abs() < 0.002, "O{program} {of}: {gone} mm");
        }
        tell(rig, "key cycle-start\nwait until idle max 900 s\nexpect no alarm\nexpect no event");
        let worst = shop.worst_um(|_| size);
        assert!(worst.abs() < 3.0, "O{program}: off by {worst} µm");
    }
}
