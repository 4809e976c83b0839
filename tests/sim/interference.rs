//! What a turning tool meets: the bar in rapid traverse or standing, its own shank, the chuck (row L9).

use kt830::defs::kind::Kind;
use kt830::defs::param::Params;
use kt830::io::sim::{BarFile, BodyFile, BodyKind, InterferenceCheck, MachineFile, PartFile, SlidePosition};
use kt830::units::WorkPos;

/// What tool 1 meets with its tip at a place (X radius) of a bar of 45 mm that ends at Z0, on `bodies`.
fn met(bodies: &[BodyFile], (x, z): (f64, f64), (rapid, stands): (bool, bool)) -> Option<&'static str> {
    let machine = MachineFile::builtin(Kind::Lathe).unwrap();
    let bar = BarFile { diameter: 45.0, z_from: -100.0, z_to: 0.0, cell: 0.1 };
    let zero = SlidePosition::default();
    let part = PartFile {
        kind: Kind::Lathe,
        g54_mm: zero,
        start_mm: zero,
        bodies: bodies.to_vec(),
        bar: Some(bar),
        ..PartFile::default()
    };
    let params = Params::factory(Kind::Lathe);
    let mut check = InterferenceCheck::new(&part, &machine.tool_post.unwrap(), &params).unwrap();
    let at = WorkPos::new([x, 0.0, z]);
    check.set_coordinate_system(at, at);
    check.set_spindle(!stands);
    check.check_move(at, at, rapid)
}

#[test]
fn l9_rapid_a_standing_spindle_and_the_shank_are_interference() {
    let at = |x: f64, z: f64, how: (bool, bool)| met(&[], (x, z), how);
    assert_eq!(at(20.0, -10.0, (true, false)), Some("part, rapid traverse"));
    assert_eq!(at(20.0, -10.0, (false, true)), Some("part, spindle stopped"));
    // 12 mm deep: the shank is 8.1 mm above the tip.
    assert_eq!(at(10.0, -30.0, (false, false)), Some("part, tool shank"));
    assert_eq!(at(23.0, -10.0, (true, true)), None);
}

#[test]
fn l9_the_outline_meets_the_chuck() {
    let chuck = BodyFile { what: BodyKind::Chuck, z_from: -200.0, z_to: -100.0, diameter: 120.0 };
    let touches = |x: f64, z: f64| met(std::slice::from_ref(&chuck), (x, z), (false, false)) == Some("chuck");
    assert!(touches(55.0, -105.0) && !touches(55.0, -99.0));
    // The shank alone: it extends 25 mm towards plus from the tip.
    assert!(touches(50.0, -120.0) && !touches(61.0, -120.0));
}
