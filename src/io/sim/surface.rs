//! The surfaces of the part as height fields, and how the wheel wears them down (P4, P5). Lines of heights stand in
//! `profile`, planes in `plane`.
//!
//! Contact law. A cell of the surface stands at the height h along its normal, the wheel's own surface over it at p.
//! Their overlap o = h − p is what the infeed has asked for and the contact has not yet given: o = infeed − d. P5
//! says ḋ = (infeed − d)/τ, so ȯ = ḟ − o/τ with the feed ḟ, and over a tick of dt
//!
//!   o ← o · exp(−dt · (1/τ + |v|/λ)),   h ← p + o.
//!
//! The first term is the plunge: at the feed f the size lags by f·τ, and sparks out with τ. The second is the
//! traverse: when the wheel is drawn along the surface at the speed v, ever new grains of its corner pass over the
//! cell, and a cell that was passed over on the length n·λ keeps exp(−n) of its overlap, however fast the pass.
//! λ is `traverse_face_mm` across a face (the corner does the work, so a stroke with a few millimetres of overrun
//! leaves little), `traverse_cylinder_mm` along the wheel's own axis, `traverse_plane_mm` under a plane's stroke; it
//! grows with τ as the wheel gets dull.
//! Removed volume wears the wheel (`wheel.rs`), loads its motor and, per width of contact, may burn the part.

use super::part_file::{Looks, SurfaceFile};
use super::plane::Plane;
use super::profile::Profile;
use super::report::PartReport;
use super::wheel::Wheel;
use crate::io::random::SplitMix64;

/// Where the wheel is and how it moves in this tick, part coordinates, radius.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pass {
    /// Front of a new wheel, along the infeed.
    pub front_mm: f64,
    /// Left side of a new wheel, along its axis.
    pub left_mm: f64,
    /// The wheel's middle along the stroke, now and a tick before.
    pub stroke_mm: f64,
    pub stroke_before_mm: f64,
    /// Speeds without sign: along the infeed, the wheel's axis, the stroke.
    pub infeed_mm_s: f64,
    pub across_mm_s: f64,
    pub stroke_mm_s: f64,
    pub dt_s: f64,
    /// How much the rim goes back towards the infeed's minus side for each millimetre along the wheel's axis: the tangent
    /// of the swivelled head.
    pub lean: f64,
    pub traverse: Traverse,
}

impl Pass {
    /// Where the wheel was along the stroke in this tick, from the least to the greatest place.
    pub(super) fn sweep_mm(&self) -> (f64, f64) {
        (self.stroke_mm.min(self.stroke_before_mm), self.stroke_mm.max(self.stroke_before_mm))
    }
}

/// λ of a sharp wheel, mm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Traverse {
    /// Along the wheel's axis.
    pub across_mm: f64,
    /// Across a face.
    pub face_mm: f64,
    /// Along the stroke of a plane.
    pub plane_mm: f64,
    /// Length on which the rim lies flat on a plane.
    pub contact_mm: f64,
}

/// What came of a cut.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cut {
    pub volume_mm3: f64,
    /// Volume over the width of contact, mm².
    pub specific_mm2: f64,
}

/// What a surface has told about its present contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Touch {
    pub burnt: bool,
    pub flat: bool,
    pub crashed: bool,
}

/// One surface of the part.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    cells: Cells,
    /// Contact as it was in the tick before.
    pub(super) touch: Touch,
}

#[derive(Clone, Debug)]
enum Cells {
    Line(Profile),
    Field(Plane),
}

impl Surface {
    /// The surface before grinding; its waviness begins by chance.
    pub(super) fn new(file: &SurfaceFile, chance: &mut SplitMix64) -> Option<Self> {
        let line = Profile::new(file, chance).map(Cells::Line);
        let cells = line.or_else(|| Plane::new(file, chance).map(Cells::Field))?;
        Some(Self { cells, touch: Touch::default() })
    }

    /// Whether the part must turn for this surface to be ground.
    pub(super) const fn turns(&self) -> bool {
        match &self.cells {
            Cells::Line(line) => line.turns(),
            Cells::Field(_) => false,
        }
    }

    /// What is told of a part that should turn and stands.
    pub(super) const fn stands(&self) -> &'static str {
        match &self.cells {
            Cells::Line(line) => line.stands(),
            Cells::Field(_) => "part",
        }
    }

    /// Place along the infeed from which the wheel can touch it, mm.
    pub(super) fn reach_mm(&self) -> f64 {
        match &self.cells {
            Cells::Line(line) => line.reach_mm(),
            Cells::Field(field) => field.highest_mm(),
        }
    }

    /// Greatest overlap with the wheel, mm; zero or less is none.
    pub(super) fn overlap_mm(&mut self, pass: &Pass, wheel: &Wheel) -> f64 {
        match &mut self.cells {
            Cells::Line(line) => line.overlap_mm(pass, wheel),
            Cells::Field(field) => field.overlap_mm(pass, wheel),
        }
    }

    /// Grinds what overlaps for one tick.
    pub(super) fn grind(&mut self, pass: &Pass, wheel: &mut Wheel) -> Cut {
        match &mut self.cells {
            Cells::Line(line) => line.grind(pass, wheel),
            Cells::Field(field) => field.grind(pass, wheel),
        }
    }

    /// How far a point (the wheel's place of `at`) is inside the surface along its normal, mm.
    pub(super) fn inside_mm(&self, at: &Pass) -> Option<f64> {
        match &self.cells {
            Cells::Line(line) => line.inside_mm(at),
            Cells::Field(field) => field.height_at(at.stroke_mm, at.left_mm).map(|h| h - at.front_mm),
        }
    }

    /// Mean diameter at a place along Z; `None` where no diameter is.
    pub(super) fn diameter_at(&self, z: f64) -> Option<f64> {
        match &self.cells {
            Cells::Line(line) => line.diameter_at(z),
            Cells::Field(_) => None,
        }
    }

    /// Z of the face at X, for a face that looks as asked; `None` where no face is.
    pub(super) fn face_at(&self, x: f64, looks: Option<Looks>) -> Option<f64> {
        match &self.cells {
            Cells::Line(line) => line.face_at(x, looks),
            Cells::Field(_) => None,
        }
    }

    /// Height of a plane at X and Z, or of a disc at the radius X; `None` where neither is.
    pub(super) fn height_at(&self, x: f64, z: f64) -> Option<f64> {
        match &self.cells {
            Cells::Line(line) => line.height_at(x),
            Cells::Field(field) => field.height_at(x, z),
        }
    }

    /// Adds what the report wants of this surface.
    pub(super) fn report(&self, report: &mut PartReport) {
        match &self.cells {
            Cells::Line(line) => line.report(report),
            Cells::Field(field) => field.report(report),
        }
    }
}

/// Share of the overlap that goes in a tick: 1 − exp(−dt·(1/τ + v/λ)).
pub(super) fn taken(dt_s: f64, tau_s: f64, passes_per_s: f64) -> f64 {
    -(-dt_s * (tau_s.recip() + passes_per_s)).exp_m1()
}
