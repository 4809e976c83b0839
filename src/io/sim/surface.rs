//! The surfaces of the part as height fields (P4, P5): `profile` holds the one-dimensional ones, `plane` the
//! two-dimensional ones. `contact_law` says what a tick removes.

use super::contact_law::{Cut, WheelMotion};
use super::machine_sections::LayoutFile;
use super::part_file::{FaceDirection, SurfaceFile};
use super::plane::PlaneSurface;
use super::profile::ProfileSurface;
use super::report::PartReport;
use super::roughness::GroundFinish;
use super::wheel::GrindingWheel;
use crate::defs::grinding_workspace::PartSection;
use crate::io::random::SplitMix64;

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
    pub(super) finish: GroundFinish,
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
        Some(Self { cells, contact: ContactFlags::default(), finish: GroundFinish::of_blank() })
    }

    /// The cells of a surface with one dimension.
    const fn profile(&self) -> Option<&ProfileSurface> {
        if let Cells::Profile(line) = &self.cells { Some(line) } else { None }
    }

    /// Whether the part must rotate for this surface to be ground.
    pub(super) fn needs_rotation(&self) -> bool {
        self.profile().is_some_and(ProfileSurface::needs_rotation)
    }

    /// Whether the rim grinds it, not a side of the wheel.
    pub(super) fn is_ground_by_rim(&self) -> bool {
        self.profile().is_none_or(ProfileSurface::is_ground_by_rim)
    }

    /// Event text for a part that is stopped but should rotate.
    pub(super) fn place_when_stopped(&self, on_table: bool) -> &'static str {
        let turns = |_: &ProfileSurface| if on_table { "part, table stopped" } else { "part, workhead stopped" };
        self.profile().map_or("part", turns)
    }

    /// Position along the infeed below which the wheel can touch the surface, mm.
    pub(super) fn reach_mm(&self) -> f64 {
        match &self.cells {
            Cells::Profile(line) => line.reach_mm(),
            Cells::Plane(field) => field.highest_mm,
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
        self.profile()?.diameter_at(z)
    }

    /// Z of the face at X, of the given direction if one is given; `None` if there is no such face.
    pub(super) fn face_at(&self, x: f64, looks: Option<FaceDirection>) -> Option<f64> {
        self.profile()?.face_at(x, looks)
    }

    /// Height of a plane at X and Z, or of a disc at the radius X, mm; `None` if there is neither.
    pub(super) fn height_at(&self, x: f64, z: f64) -> Option<f64> {
        match &self.cells {
            Cells::Profile(line) => line.height_at(x),
            Cells::Plane(field) => field.height_at(x, z),
        }
    }

    /// Sections for the drawing, the wheel being at `at`.
    pub(super) fn sections(&self, layout: LayoutFile, at: &WheelMotion, wheel: &GrindingWheel) -> Vec<PartSection> {
        match &self.cells {
            Cells::Profile(line) => vec![line.section(layout)],
            Cells::Plane(field) => field.sections(layout, at.stroke_mm, at.left_mm + wheel.width_mm / 2.0),
        }
    }

    /// Adds the measurements at the two ends of a turned surface to the report.
    pub(super) fn report_ends(&self, report: &mut PartReport) {
        if let Some(line) = self.profile() {
            line.report_ends(report);
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
