//! What each kind of machine is made of: one file a kind. No other room asks which kind it is.
//! Source: spec K1.

mod ga;
mod gc;
mod gs;
mod lathe;
mod vertical;

use crate::defs::kind::{Kind, System};
use crate::defs::param::{self, Params};
use crate::defs::signal::Output;
use crate::units::{Axis, PerAxis};

/// One kind.
#[derive(Debug)]
pub struct KindRow {
    /// Which one.
    pub kind: Kind,
    /// The axes it always has; Y can be fitted to any kind (P6.6).
    pub axes: PerAxis<bool>,
    /// The language of its programs.
    pub system: System,
    /// The order of homing: the wheel axis first, away from the part (K5.16).
    pub home_order: &'static [Axis],
    /// What M63 drives.
    pub drive_high: Output,
    /// What M64 drives; the same as M63 where there is one speed.
    pub drive_low: Output,
    /// Whether it has a tailstock.
    pub tailstock: bool,
    /// Whether it clamps by a magnet.
    pub magnet: bool,
    /// Whether what M63 drives carries the part on the magnet (K3.11: the table turns magnetised only).
    pub drive_needs_magnet: bool,
    /// Numbers of the files of its grinding pages (C0801 …); empty where each program has a page of its own (K7.2).
    pub page_files: &'static [u32],
    /// Values that common variables have on a new machine, by number.
    pub variables: &'static [(u16, f64)],
    /// The axis whose minus direction is slow while the wheel turns (K5.9).
    pub slow_axis: Axis,
    /// Whether its main spindle turns the part and a tool post carries the tools (L7, L8).
    pub turns_part: bool,
    /// Folder of its own programs below `programs`; they go by name there.
    pub own_programs: Option<&'static str>,
}

impl KindRow {
    /// The axes of a machine of this kind with these parameters.
    #[must_use]
    pub fn fitted(&self, params: &Params) -> PerAxis<bool> {
        PerAxis::from_fn(|axis| self.axes[axis] || axis == Axis::Y && params.bit(param::Y_FITTED))
    }

    /// Whether homing goes over its switch and back onto the far edge (L6).
    #[must_use]
    pub const fn homes_past_switch(&self) -> bool {
        self.turns_part
    }

    /// Whether a program may begin before homing: on a lathe it homes by itself (L6).
    #[must_use]
    pub const fn starts_unhomed(&self) -> bool {
        self.turns_part
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
