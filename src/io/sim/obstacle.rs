//! Obstacles of the wheel: chuck, tailstock, fixture, magnet plate (P8 crash). Any contact is a crash, reported once
//! until the wheel is clear.

use super::contact_law::WheelMotion;
use super::machine_sections::PlateFile;
use super::part_file::{BlockFile, BodyFile, BodyKind, TailstockFile};
use super::wheel::GrindingWheel;

/// An obstacle, part coordinates in wheel directions, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Obstacle {
    pub(super) name: &'static str,
    across: (f64, f64),
    /// From and to along the stroke; `None` if it rotates, or on a machine without stroke axis.
    stroke: Option<(f64, f64)>,
    /// Its highest point along the infeed.
    pub(super) top_mm: f64,
    /// The wheel has been in it since it was last clear.
    pub(super) touched: bool,
    /// It moves with the tailstock.
    on_tailstock: bool,
}

const fn name(what: BodyKind) -> &'static str {
    match what {
        BodyKind::Chuck => "chuck",
        BodyKind::Fixture => "fixture",
    }
}

impl Obstacle {
    const fn new(name: &'static str, across: (f64, f64), stroke: Option<(f64, f64)>, top_mm: f64) -> Self {
        Self { name, across, stroke, top_mm, touched: false, on_tailstock: false }
    }

    pub(super) const fn of_body(body: &BodyFile) -> Self {
        Self::new(name(body.what), (body.z_from, body.z_to), None, body.diameter / 2.0)
    }

    pub(super) fn of_tailstock(file: &TailstockFile) -> Self {
        let across = (file.z, file.z + file.length);
        Self { on_tailstock: true, ..Self::new("tailstock", across, None, file.diameter / 2.0) }
    }

    /// A block on a table: with Z, X is along the stroke; without Z, X is the radius of a ring.
    pub(super) fn of_block(block: &BlockFile) -> [Self; 2] {
        let ring = |across| Self::new(name(block.what), across, None, block.top);
        match block.z {
            Some(z) => [Self::new(name(block.what), z, Some(block.x), block.top); 2],
            None => [ring(block.x), ring((-block.x.1, -block.x.0))],
        }
    }

    /// The plate of the magnet; `zero` is the work zero in wheel directions.
    pub(super) fn of_plate(plate: &PlateFile, zero: &WheelMotion) -> Self {
        let shifted = |(from, to): (f64, f64), by: f64| (from - by, to - by);
        let stroke = plate.stroke_mm.map(|stroke| shifted(stroke, zero.stroke_mm));
        Self::new("magnet", shifted(plate.across_mm, zero.left_mm), stroke, plate.top_mm - zero.front_mm)
    }

    /// Whether the wheel has newly entered it in this tick.
    pub(super) fn newly_touched(&mut self, pass: &WheelMotion, wheel: &GrindingWheel, tailstock_back_mm: f64) -> bool {
        let back = if self.on_tailstock { tailstock_back_mm } else { 0.0 };
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
