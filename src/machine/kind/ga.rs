//! KT-830GA, rotary-table grinder: X cross slide, Z wheel head (down is minus), rotary table, magnet. Y by parameter.
//! Source: spec K1, column GA.

use super::KindRow;
use crate::defs::kind::Kind;
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

pub(super) static ROW: KindRow = KindRow {
    kind: Kind::Ga,
    axes: PerAxis([true, false, true]),
    dialect: Kind::Ga.dialect(),
    home_order: &[Axis::Z, Axis::X, Axis::Y],
    drive_high: Output::TableRotation,
    drive_low: Output::TableRotation,
    tailstock: false,
    magnet: true,
    drive_needs_magnet: true,
    page_files: &[],
    variables: &[],
    wheel_axis: Axis::Z,
    has_main_spindle: false,
    program_folder: None,
};
