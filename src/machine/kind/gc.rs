//! KT-830GC, cylindrical grinder: X infeed (diameter), Z table, headstock with two speeds, tailstock. Y by parameter.
//! Source: spec K1, column GC.

use super::KindRow;
use crate::defs::kind::Kind;
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

pub(super) static ROW: KindRow = KindRow {
    kind: Kind::Gc,
    axes: PerAxis([true, false, true]),
    dialect: Kind::Gc.dialect(),
    home_order: &[Axis::X, Axis::Z, Axis::Y],
    drive_high: Output::HeadstockHigh,
    drive_low: Output::HeadstockLow,
    tailstock: true,
    magnet: false,
    drive_needs_magnet: false,
    page_files: &[],
    variables: &[],
    wheel_axis: Axis::X,
    has_main_spindle: false,
    program_folder: None,
};
