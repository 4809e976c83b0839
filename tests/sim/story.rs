//! Control and simulated machine together on GS and GA: a plane and a ring ground by hand, an axis Y that is fitted.

use crate::stories::{story_on, tell};
use kt830::defs::kind::Kind;

#[test]
fn p5_an_operator_grinds_a_plane_on_a_surface_grinder() {
    story_on(
        Kind::Gs,
        "power on\npart assets/parts/O1007.ron\nhome all\nkey hydraulic\nwait 4 s\nkey magnetise\nwait 2 s
key wheel-start\nwait 10 s\nexpect output wheel on\nmode mdi
mdi G90 G00 Y60\nwait until idle\nmdi G00 X-60 Z10\nwait until idle\nmdi G01 Y20.09 F3000\nwait until idle
expect part height at X100 Z30 20.1 ±0.006
mdi G01 X260 F12000\nwait until idle
#! One pass leaves 26 % of 10 µm and of what the stock is wavy (5 µm): 1.3 to 3.9 µm.
expect part height at X100 Z30 20.0926 ±0.0014
expect part height at X100 Z5 20.1 ±0.006
expect no event",
    );
}

#[test]
fn p5_an_operator_grinds_a_ring_on_a_rotary_table_grinder() {
    story_on(
        Kind::Ga,
        "power on\npart assets/parts/O1010.ron\nhome all\nkey hydraulic\nwait 4 s\nkey magnetise\nwait 2 s
key wheel-start\nkey table-rotation\nwait 10 s\nmode mdi
mdi G90 G00 X75 Z60\nwait until idle\nmdi G01 Z25.06 F1000\nwait until idle
mdi G01 Z25.03 F0.3\nwait until idle\nwait 8 s
expect part height at X100 Z0 25.03 ±0.001
expect part face at X90 25.03 ±0.001
expect part height at X130 Z0 25.05 ±0.005
expect no event",
    );
}

#[test]
fn p8_the_arc_of_the_wheel_meets_the_plate_before_its_lowest_point_does_and_the_control_sees_it() {
    let mut rig = story_on(
        Kind::Gs,
        "power on\npart assets/parts/O1007.ron\nhome all\nkey hydraulic\nwait 4 s\nkey magnetise\nwait 2 s
mode mdi\nmdi G90 G00 Y60\nwait until idle\nmdi G00 X-80 Z10\nwait until idle\nmdi G01 Y-2 F3000\nwait 3 s
expect event crash\nexpect alarm any",
    );
    let crash = rig.machine().events()[0];
    // The nearest cell is at X 0.5; without the 1 mm that lies flat the arc stands 250 − √(250² − 79.5²) = 12.97 mm higher
    // there: it meets the top of 20.1 at Y 7.13, a tick of 0.05 mm and the 0.02 mm of a standing wheel later.
    assert_eq!(crash.place, "part, wheel stopped");
    assert!((crash.y.unwrap() - 7.1).abs() < 0.06, "{crash:?}");
    tell(&mut rig, "wait 1 s");
    let stands = rig.machine().slide_mm();
    tell(&mut rig, "wait 1 s");
    assert_eq!(rig.machine().slide_mm(), stands);
}

#[test]
fn k1_an_axis_y_that_is_fitted_is_homed_and_driven() {
    for kind in [Kind::Gc, Kind::Ga] {
        story_on(
            kind,
            "power on\nparam P6.6 1\npower cut\nwait 1 s\npower on\nkey hydraulic\nwait 4 s\nhome all
expect machine Y 0 ±0.001\nmode mdi\nmdi G00 Y-20\nwait until idle\nexpect machine Y -20 ±0.001",
        );
    }
}
