//! Vertical lathe-grinder (a vertical lathe whose right carriage carries a grinding head): X wheel carriage (diameter), Z
//! along the table's axis, the table turns with the part clamped on it. Y by parameter. Programs of the SINUMERIK 802D.
//! Source: spec sinumerik-802d.md, seed 002.

use super::KindRow;
use crate::defs::kind::Kind;
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

pub(super) static ROW: KindRow = KindRow {
    kind: Kind::Vertical,
    axes: PerAxis([true, false, true]),
    home_order: &[Axis::X, Axis::Z, Axis::Y],
    drive_high: Output::TableRotation,
    drive_low: Output::TableRotation,
    tailstock: false,
    magnet: false,
    drive_needs_magnet: false,
    slow_axis: Axis::X,
};
