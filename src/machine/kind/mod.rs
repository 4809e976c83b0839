//! Description of each kind of machine: one file per kind. Other modules use these rows and do not ask for the kind.
//! Source: spec K1.

mod ga;
mod gc;
mod gs;
mod lathe;
mod vertical;

use crate::defs::kind::{Dialect, Kind};
use crate::defs::param::{self, Params};
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

/// One kind.
#[derive(Debug)]
pub struct KindRow {
    /// The kind.
    pub kind: Kind,
    /// The standard axes; Y can be fitted to any kind (P6.6).
    pub axes: PerAxis<bool>,
    /// The dialect of its programs.
    pub dialect: Dialect,
    /// The order of homing: the wheel axis first, away from the part (K5.16).
    pub home_order: &'static [Axis],
    /// Output of M63.
    pub drive_high: Output,
    /// Output of M64; the same as for M63 where there is one speed.
    pub drive_low: Output,
    /// Whether it has a tailstock.
    pub tailstock: bool,
    /// Whether it clamps with a magnet.
    pub magnet: bool,
    /// Whether the M63 drive carries the part on the magnet (K3.11: the table turns only when magnetised).
    pub drive_needs_magnet: bool,
    /// File numbers of its grinding pages (C0801 …); empty where each program has its own page (K7.2).
    pub page_files: &'static [u32],
    /// Factory values of common variables: number, value.
    pub variables: &'static [(u16, f64)],
    /// The axis whose minus direction is slow while the wheel turns (K5.9).
    pub wheel_axis: Axis,
    /// Whether it has a main spindle that turns the part and a tool post (L7, L8).
    pub has_main_spindle: bool,
    /// Folder of its own programs below `programs`; they are identified by name there.
    pub program_folder: Option<&'static str>,
}

impl KindRow {
    /// The axes of a machine of this kind with these parameters.
    #[must_use]
    pub fn fitted(&self, params: &Params) -> PerAxis<bool> {
        PerAxis::from_fn(|axis| self.axes[axis] || axis == Axis::Y && params.bit(param::Y_FITTED))
    }

    /// Whether homing passes the switch and returns onto its far edge (L6).
    #[must_use]
    pub const fn homes_over_switch(&self) -> bool {
        self.has_main_spindle
    }

    /// Whether a program may start before homing: a lathe program homes the axes itself (L6).
    #[must_use]
    pub const fn may_start_unhomed(&self) -> bool {
        self.has_main_spindle
    }

    /// The output of a drive speed.
    #[must_use]
    pub const fn drive_output(&self, fast: bool) -> Output {
        if fast { self.drive_high } else { self.drive_low }
    }
}

/// The row of a kind.
#[must_use]
pub const fn find(kind: Kind) -> &'static KindRow {
    match kind {
        Kind::Gc => &gc::ROW,
        Kind::Gs => &gs::ROW,
        Kind::Ga => &ga::ROW,
        Kind::Vertical => &vertical::ROW,
        Kind::Lathe => &lathe::ROW,
    }
}
