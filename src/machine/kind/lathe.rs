//! 超人 (SuperMan) lathe: X cross slide (diameter), Z carriage, main spindle with encoder, tool post with four stations.
//! No wheel, no hydraulics, no gauges.
//! Source: spec superman-lathe.md, seed 001.

use super::KindRow;
use crate::defs::kind::Kind;
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

pub(super) static ROW: KindRow = KindRow {
    kind: Kind::Lathe,
    axes: PerAxis([true, false, true]),
    dialect: Kind::Lathe.dialect(),
    home_order: &[Axis::X, Axis::Z, Axis::Y],
    drive_high: Output::SpindleForward,
    drive_low: Output::SpindleForward,
    tailstock: false,
    magnet: false,
    drive_needs_magnet: false,
    page_files: &[],
    variables: &[],
    wheel_axis: Axis::X,
    has_main_spindle: true,
    program_folder: Some("lathe"),
};
