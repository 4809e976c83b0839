//! KT-830GC, cylindrical grinder: X infeed (diameter), Z table, headstock with two speeds, tailstock.
//! Source: spec K1, column GC.

use super::KindRow;
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

pub(super) static ROW: KindRow = KindRow {
    axes: PerAxis([true, false, true]),
    lathe_system: true,
    home_order: &[Axis::X, Axis::Z],
    drive_high: Output::HeadstockHigh,
    drive_low: Output::HeadstockLow,
    tailstock: true,
    slow_axis: Axis::X,
};
