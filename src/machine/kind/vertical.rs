//! Vertical lathe-grinder (a vertical lathe with a grinding head on its right carriage): X wheel carriage (diameter),
//! Z along the table's axis; the table turns with the part clamped on it. Y by parameter. SINUMERIK 802D programs.
//! Source: spec sinumerik-802d.md, seed 002.

use super::KindRow;
use crate::defs::kind::Kind;
use crate::defs::signal::Output;
use crate::defs::variable_name;
use crate::units::{Axis, PerAxis};

/// The variable of R0.
const R0: u16 = match variable_name::variable_of_r(0) {
    Some(number) => number as u16,
    None => 0,
};

/// Factory R parameters of the grinding program: table of seed 002, a ring of 200.5 mm ground to 200 mm (S4, S5).
/// R11 and R12 follow from the machine data: the wheel touches the diamond at X machine −50, Z machine −300; G54 is
/// X −450, Z −500.
const R: &[(u16, f64)] = &[
    (R0 + 1, 220.0),    // least wheel diameter
    (R0 + 2, 300.0),    // greatest
    (R0 + 3, 300.0),    // wheel diameter
    (R0 + 4, 40.0),     // wheel width
    (R0 + 5, 0.0),      // least speed, rpm; 0 none
    (R0 + 6, 2_200.0),  // greatest speed, rpm
    (R0 + 7, 30.0),     // rim speed, m/s
    (R0 + 9, 0.0),      // radius of the wheel's edge
    (R0 + 10, 0.5),     // radius of the diamond
    (R0 + 11, 1_100.0), // 2 · (450 − 50) + 300
    (R0 + 12, 200.0),   // 500 − 300
    (R0 + 13, 40.0),    // height of the blocks under the part
    (R0 + 14, 0.0),     // angle of the grinding carriage
    (R0 + 15, 0.2),     // dwell at the ends, s
    (R0 + 16, 35.0),    // rim speed that the wheel is made for, m/s (P79)
    (R0 + 18, 200.0),
    (R0 + 19, 35.0),
    (R0 + 20, 200.5),
    (R0 + 21, 105.0),
    (R0 + 22, 0.005),
    (R0 + 23, 1_200.0),
    (R0 + 24, 4.0),
    (R0 + 25, 0.05),
    (R0 + 28, 0.02),
    (R0 + 29, 800.0),
    (R0 + 30, 25.0),
    (R0 + 32, 3.0),
    (R0 + 33, 1_200.0),
    (R0 + 36, 0.03),
    (R0 + 37, 0.02),
    (R0 + 38, 600.0),
    (R0 + 39, 0.1),
    (R0 + 42, 0.1),
    (R0 + 43, 0.1),
    (R0 + 44, 1_500.0),
    (R0 + 46, 700.0),
    (R0 + 47, 250.0),
];

pub(super) static ROW: KindRow = KindRow {
    kind: Kind::Vertical,
    axes: PerAxis([true, false, true]),
    dialect: Kind::Vertical.dialect(),
    home_order: &[Axis::X, Axis::Z, Axis::Y],
    drive_high: Output::TableRotation,
    drive_low: Output::TableRotation,
    tailstock: false,
    magnet: false,
    drive_needs_magnet: false,
    page_files: &[801, 802, 803],
    variables: R,
    wheel_axis: Axis::X,
    has_main_spindle: false,
    program_folder: None,
};
