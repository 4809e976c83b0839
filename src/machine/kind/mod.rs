//! What each kind of machine is made of: one file a kind. No other room asks which kind it is.
//! Source: spec K1.

mod gc;

use crate::defs::kind::Kind;
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

/// One kind.
#[derive(Debug)]
pub struct KindRow {
    /// The axes it has.
    pub axes: PerAxis<bool>,
    /// Whether programs follow G-code system A of lathes (U, V, W incremental) or G90/G91.
    pub lathe_system: bool,
    /// The order of homing: the wheel axis first, away from the part (K5.16).
    pub home_order: &'static [Axis],
    /// What M63 drives.
    pub drive_high: Output,
    /// What M64 drives; the same as M63 where there is one speed.
    pub drive_low: Output,
    /// Whether it has a tailstock.
    pub tailstock: bool,
    /// The axis whose minus direction is slow while the wheel turns (K5.9).
    pub slow_axis: Axis,
}

impl KindRow {
    /// The output of a drive speed.
    #[must_use]
    pub const fn drive_output(&self, fast: bool) -> Output {
        if fast { self.drive_high } else { self.drive_low }
    }
}

/// The row of a kind, if this version drives it.
#[must_use]
pub const fn find(kind: Kind) -> Option<&'static KindRow> {
    match kind {
        Kind::Gc => Some(&gc::ROW),
        Kind::Gs | Kind::Ga => None,
    }
}
