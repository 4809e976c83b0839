//! Obstacles of the wheel: chuck, tailstock, fixture, magnet plate (P8 crash). Any contact is a crash, reported once
//! until the wheel is clear.

use super::contact_law::WheelMotion;
use super::machine_sections::{LayoutFile, PlateFile};
use super::part_file::{BlockFile, BodyFile, BodyKind, TailstockFile};
use super::wheel::GrindingWheel;
use crate::defs::grinding_workspace::{Holder, HolderKind};
use crate::units::PerAxis;

/// How far a block or a plate is drawn below its highest point, mm; where it stands on the zero it ends there.
const DRAWN_DEPTH_MM: f64 = 25.0;

/// An obstacle, part coordinates in wheel directions, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Obstacle {
    kind: HolderKind,
    across: (f64, f64),
    /// From and to along the stroke; `None` if it rotates, or on a machine without stroke axis.
    stroke: Option<(f64, f64)>,
    /// Its highest point along the infeed.
    pub(super) top_mm: f64,
    /// The wheel has been in it since it was last clear.
    pub(super) touched: bool,
    /// It is round about the axis of the part.
    is_round: bool,
}

const fn kind_of(what: BodyKind) -> HolderKind {
    match what {
        BodyKind::Chuck => HolderKind::Chuck,
        BodyKind::Fixture => HolderKind::Fixture,
    }
}

impl Obstacle {
    const fn new(kind: HolderKind, across: (f64, f64), stroke: Option<(f64, f64)>, top_mm: f64) -> Self {
        Self { kind, across, stroke, top_mm, touched: false, is_round: false }
    }

    /// Its name in events.
    pub(super) const fn name(&self) -> &'static str {
        match self.kind {
            HolderKind::Chuck => "chuck",
            HolderKind::Fixture => "fixture",
            HolderKind::Tailstock => "tailstock",
            HolderKind::Magnet => "magnet",
        }
    }

    pub(super) const fn of_body(body: &BodyFile) -> Self {
        let across = (body.z_from, body.z_to);
        Self { is_round: true, ..Self::new(kind_of(body.what), across, None, body.diameter / 2.0) }
    }

    pub(super) fn of_tailstock(file: &TailstockFile) -> Self {
        let across = (file.z, file.z + file.length);
        Self { is_round: true, ..Self::new(HolderKind::Tailstock, across, None, file.diameter / 2.0) }
    }

    /// A block on a table: with Z, X is along the stroke; without Z, X is the radius of a ring.
    pub(super) fn of_block(block: &BlockFile) -> [Self; 2] {
        let ring = |across| Self::new(kind_of(block.what), across, None, block.top);
        match block.z {
            Some(z) => [Self::new(kind_of(block.what), z, Some(block.x), block.top); 2],
            None => [ring(block.x), ring((-block.x.1, -block.x.0))],
        }
    }

    /// The plate of the magnet; `zero` is the work zero in wheel directions.
    pub(super) fn of_plate(plate: &PlateFile, zero: &WheelMotion) -> Self {
        let shifted = |(from, to): (f64, f64), by: f64| (from - by, to - by);
        let stroke = plate.stroke_mm.map(|stroke| shifted(stroke, zero.stroke_mm));
        Self::new(HolderKind::Magnet, shifted(plate.across_mm, zero.left_mm), stroke, plate.top_mm - zero.front_mm)
    }

    /// How far it has moved away from the part.
    fn retracted_mm(&self, tailstock_back_mm: f64) -> f64 {
        if self.kind == HolderKind::Tailstock { tailstock_back_mm } else { 0.0 }
    }

    /// Its bounding box for the drawing.
    pub(super) fn holder(&self, layout: LayoutFile, tailstock_back_mm: f64) -> Holder {
        let back = self.retracted_mm(tailstock_back_mm);
        let base = if self.top_mm > 0.0 { 0.0 } else { self.top_mm - DRAWN_DEPTH_MM };
        let mut extent = PerAxis([None; 3]);
        extent[layout.infeed] = Some((if self.is_round { -self.top_mm } else { base }, self.top_mm));
        extent[layout.across] = Some((self.across.0 + back, self.across.1 + back));
        if let Some((axis, range)) = layout.stroke.zip(self.stroke) {
            extent[axis] = Some(range);
        }
        Holder { kind: self.kind, extent }
    }

    /// Whether the wheel has newly entered it in this tick.
    pub(super) fn newly_touched(&mut self, pass: &WheelMotion, wheel: &GrindingWheel, tailstock_back_mm: f64) -> bool {
        let back = self.retracted_mm(tailstock_back_mm);
        let half = || wheel.half_chord_mm(self.top_mm - pass.front_mm);
        let inside = pass.front_mm < self.top_mm
            && pass.left_mm < self.across.1 + back
            && pass.left_mm + wheel.width_mm > self.across.0 + back
            && self.stroke.is_none_or(|(from, to)| pass.stroke_mm + half() > from && pass.stroke_mm - half() < to);
        let newly = inside && !self.touched;
        self.touched = inside;
        newly
    }
}
