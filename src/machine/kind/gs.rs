//! KT-830GS, surface grinder: X table, Y wheel head (down is minus), Z cross slide; magnet and dresser roll.
//! Source: spec K1, column GS.

use super::KindRow;
use crate::defs::kind::Kind;
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

pub(super) static ROW: KindRow = KindRow {
    kind: Kind::Gs,
    axes: PerAxis([true, true, true]),
    system: Kind::Gs.system(),
    home_order: &[Axis::Y, Axis::Z, Axis::X],
    drive_high: Output::DresserRoll,
    drive_low: Output::DresserRoll,
    tailstock: false,
    magnet: true,
    drive_needs_magnet: false,
    page_files: &[],
    variables: &[],
    slow_axis: Axis::Y,
    turns_part: false,
    own_programs: None,
};
