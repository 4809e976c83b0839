//! The surfaces of the part as height fields, and the contact law that removes stock (P4, P5). `profile` holds the
//! one-dimensional surfaces, `plane` the two-dimensional ones.
//!
//! Contact law. A cell of the surface has the height h along its normal; the wheel's surface over it is at p.
//! The overlap o = h − p is the infeed not yet removed: o = infeed − d, with d the depth removed. P5 gives
//! ḋ = (infeed − d)/τ, so ȯ = ḟ − o/τ with the feed ḟ, and over a tick of dt
//!
//!   o ← o · exp(−dt · (1/τ + |v|/λ)),   h ← p + o.
//!
//! The first term is the plunge: at the feed rate f the size lags by f·τ, and spark-out decays with τ. The second is
//! the traverse: the wheel moves along the surface at the speed v, and a cell passed over for the length n·λ keeps
//! exp(−n) of its overlap, at any speed.
//! λ is `traverse_face_mm` across a face (the wheel corner cuts, so a stroke with a few millimetres of overrun
//! leaves little), `traverse_cylinder_mm` along the wheel's axis, `traverse_plane_mm` along the stroke over a plane.
//! λ grows with τ as the wheel gets dull.
//! The removed volume wears the wheel (`wheel.rs`), loads its motor and, per width of contact, may burn the part.

use super::part_file::{FaceDirection, SurfaceFile};
use super::plane::PlaneSurface;
use super::profile::ProfileSurface;
use super::report::PartReport;
use super::wheel::GrindingWheel;
use crate::io::random::SplitMix64;

/// Position and motion of the wheel in this tick, part coordinates, radius.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WheelMotion {
    /// Front of a new wheel along the infeed.
    pub front_mm: f64,
    /// Left side of a new wheel, along its axis.
    pub left_mm: f64,
    /// Centre of the wheel along the stroke, now and one tick ago.
    pub stroke_mm: f64,
    pub previous_stroke_mm: f64,
    /// Unsigned speeds along the infeed, the wheel's axis and the stroke.
    pub infeed_mm_s: f64,
    pub across_mm_s: f64,
    pub stroke_mm_s: f64,
    pub dt_s: f64,
    /// Tangent of the head's swivel angle: offset of the rim towards the infeed's minus side per millimetre along the
    /// wheel's axis.
    pub swivel_tan: f64,
    pub traverse: TraverseLengths,
}

impl WheelMotion {
    /// Interval covered along the stroke in this tick, mm: least, greatest.
    pub(super) fn sweep_mm(&self) -> (f64, f64) {
        (self.stroke_mm.min(self.previous_stroke_mm), self.stroke_mm.max(self.previous_stroke_mm))
    }
}

/// Lengths λ of a sharp wheel, mm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TraverseLengths {
    /// Along the wheel's axis.
    pub across_mm: f64,
    /// Across a face.
    pub face_mm: f64,
    /// Along the stroke of a plane.
    pub plane_mm: f64,
    /// Contact length of the rim on a plane.
    pub contact_mm: f64,
}

/// Material removed in one tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cut {
    pub volume_mm3: f64,
    /// Volume per width of contact, mm².
    pub specific_mm2: f64,
}

/// Events already logged for the present contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ContactFlags {
    pub burnt: bool,
    pub flat: bool,
    pub crashed: bool,
}

/// One surface of the part.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    cells: Cells,
    /// Flags of the present contact.
    pub(super) contact: ContactFlags,
}

#[derive(Clone, Debug)]
enum Cells {
    Profile(ProfileSurface),
    Plane(PlaneSurface),
}

impl Surface {
    /// The surface before grinding; the phase of its waviness is random.
    pub(super) fn new(file: &SurfaceFile, chance: &mut SplitMix64) -> Option<Self> {
        let line = ProfileSurface::new(file, chance).map(Cells::Profile);
        let cells = line.or_else(|| PlaneSurface::new(file, chance).map(Cells::Plane))?;
        Some(Self { cells, contact: ContactFlags::default() })
    }

    /// Whether the part must rotate for this surface to be ground.
    pub(super) const fn needs_rotation(&self) -> bool {
        match &self.cells {
            Cells::Profile(line) => line.needs_rotation(),
            Cells::Plane(_) => false,
        }
    }

    /// Event text for a part that is stopped but should rotate.
    pub(super) const fn place_when_stopped(&self) -> &'static str {
        match &self.cells {
            Cells::Profile(line) => line.place_when_stopped(),
            Cells::Plane(_) => "part",
        }
    }

    /// Position along the infeed below which the wheel can touch the surface, mm.
    pub(super) fn reach_mm(&self) -> f64 {
        match &self.cells {
            Cells::Profile(line) => line.reach_mm(),
            Cells::Plane(field) => field.highest_mm(),
        }
    }

    /// Greatest overlap with the wheel, mm; zero without contact.
    pub(super) fn overlap_mm(&mut self, pass: &WheelMotion, wheel: &GrindingWheel) -> f64 {
        match &mut self.cells {
            Cells::Profile(line) => line.overlap_mm(pass, wheel),
            Cells::Plane(field) => field.overlap_mm(pass, wheel),
        }
    }

    /// Grinds the overlap for one tick.
    pub(super) fn grind(&mut self, pass: &WheelMotion, wheel: &mut GrindingWheel) -> Cut {
        match &mut self.cells {
            Cells::Profile(line) => line.grind(pass, wheel),
            Cells::Plane(field) => field.grind(pass, wheel),
        }
    }

    /// Depth of a point (the wheel position of `at`) inside the surface along its normal, mm.
    pub(super) fn penetration_mm(&self, at: &WheelMotion) -> Option<f64> {
        match &self.cells {
            Cells::Profile(line) => line.penetration_mm(at),
            Cells::Plane(field) => field.height_at(at.stroke_mm, at.left_mm).map(|h| h - at.front_mm),
        }
    }

    /// Mean diameter at Z, mm; `None` if there is no diameter at Z.
    pub(super) fn diameter_at(&self, z: f64) -> Option<f64> {
        match &self.cells {
            Cells::Profile(line) => line.diameter_at(z),
            Cells::Plane(_) => None,
        }
    }

    /// Z of the face at X, of the given direction if one is given; `None` if there is no such face.
    pub(super) fn face_at(&self, x: f64, looks: Option<FaceDirection>) -> Option<f64> {
        match &self.cells {
            Cells::Profile(line) => line.face_at(x, looks),
            Cells::Plane(_) => None,
        }
    }

    /// Height of a plane at X and Z, or of a disc at the radius X, mm; `None` if there is neither.
    pub(super) fn height_at(&self, x: f64, z: f64) -> Option<f64> {
        match &self.cells {
            Cells::Profile(line) => line.height_at(x),
            Cells::Plane(field) => field.height_at(x, z),
        }
    }

    /// Adds the measurements of this surface to the report.
    pub(super) fn report(&self, report: &mut PartReport) {
        match &self.cells {
            Cells::Profile(line) => line.report(report),
            Cells::Plane(field) => field.report(report),
        }
    }
}

/// Share of the overlap removed in a tick: 1 − exp(−dt·(1/τ + v/λ)).
pub(super) fn removed_share(dt_s: f64, tau_s: f64, passes_per_s: f64) -> f64 {
    -(-dt_s * (tau_s.recip() + passes_per_s)).exp_m1()
}
