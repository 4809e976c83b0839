//! KT-830GS, surface grinder: X table, Y wheel head (down is minus), Z cross slide; magnet and dresser roll.
//! Source: spec K1, column GS.

use super::KindRow;
use crate::defs::kind::Kind;
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

pub(super) static ROW: KindRow = KindRow {
    kind: Kind::Gs,
    axes: PerAxis([true, true, true]),
    dialect: Kind::Gs.dialect(),
    home_order: &[Axis::Y, Axis::Z, Axis::X],
    drive_high: Output::DresserRoll,
    drive_low: Output::DresserRoll,
    tailstock: false,
    magnet: true,
    drive_needs_magnet: false,
    page_files: &[],
    variables: &[],
    wheel_axis: Axis::Y,
    has_main_spindle: false,
    program_folder: None,
};
