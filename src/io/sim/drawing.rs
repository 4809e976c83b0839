//! The drawing of a part: its finished sizes with their tolerances, and how far a measured part is from them.

use serde::{Deserialize, Serialize};

use super::report::PartReport;
use crate::units::Axis;

/// What a size is measured on, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DrawingFeature {
    /// Diameters; `from` and `to` are Z.
    Diameter,
    /// Faces, and discs of a rotary table; `from` and `to` are where the face is found.
    Face,
    /// Heights of planes; `from` and `to` are Z.
    Height,
}

/// One size of the drawing, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawingSize {
    /// What is measured.
    pub feature: DrawingFeature,
    /// Begin of the places that belong to it; a cone's size is told here.
    pub from: f64,
    /// End of these places, on either side.
    pub to: f64,
    /// Size at `from`.
    pub size: f64,
    /// Size at `to`, if it changes evenly; a cone.
    pub size_to: Option<f64>,
    /// Greatest deviation in either direction.
    pub tolerance: f64,
    /// The offset by which an operator corrects it after the first part: number and axis. None where a gauge does.
    pub offset: Option<(u8, Axis)>,
    /// Number of the variable into which the operator types the size that he measures after each part.
    pub typed: Option<u16>,
}

/// How far a part is from its drawing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// The deviation that is greatest by its tolerance, µm, with its sign.
    pub worst_um: f64,
    /// Whether every size keeps its tolerance.
    pub keeps: bool,
}

impl DrawingSize {
    /// Whether a gauge decides it: no offset and no size that is typed does.
    #[must_use]
    pub const fn is_gauged(&self) -> bool {
        self.offset.is_none() && self.typed.is_none()
    }

    /// Whether a place belongs to it, mm.
    #[must_use]
    pub fn covers(&self, place_mm: f64) -> bool {
        (self.from.min(self.to)..=self.from.max(self.to)).contains(&place_mm)
    }

    /// Deviation of a measured value at a place, mm; `None` if it belongs to another size.
    fn deviation_mm(&self, feature: DrawingFeature, place: f64, found: f64) -> Option<f64> {
        if feature != self.feature || !self.covers(place) {
            return None;
        }
        let length = self.to - self.from;
        let share = if length.abs() > f64::EPSILON { (place - self.from) / length } else { 0.0 };
        Some(found - (self.size + share * (self.size_to.unwrap_or(self.size) - self.size)))
    }
}

impl PartReport {
    /// What an operator types after measuring a part: number of the variable and size, mm.
    #[must_use]
    pub fn typed_sizes(&self, drawing: &[DrawingSize]) -> Vec<(u16, f64)> {
        let of_size = |size: &DrawingSize| Some((size.typed?, self.mean_size(drawing, size)?));
        drawing.iter().filter_map(of_size).collect()
    }

    /// Distance between the first two faces of a drawing, mm.
    #[must_use]
    pub fn face_distance(&self, drawing: &[DrawingSize]) -> Option<f64> {
        let mut faces = drawing.iter().filter(|size| size.feature == DrawingFeature::Face);
        let mut next = || self.mean_size(drawing, faces.next()?);
        Some((next()? - next()?).abs())
    }

    /// A size with the mean deviation of what was measured there, mm; none where nothing was.
    fn mean_size(&self, drawing: &[DrawingSize], size: &DrawingSize) -> Option<f64> {
        self.mean_deviation_mm(drawing, size).map(|off| size.size + off)
    }

    /// Mean deviation of what was measured at a size of the drawing, mm, with its sign; none where nothing was.
    #[must_use]
    pub fn mean_deviation_mm(&self, drawing: &[DrawingSize], size: &DrawingSize) -> Option<f64> {
        let off: Vec<f64> =
            self.deviations(drawing).filter(|(of, _)| std::ptr::eq(*of, size)).map(|(_, off)| off).collect();
        (!off.is_empty()).then(|| off.iter().sum::<f64>() / off.len() as f64)
    }

    /// How far the part is from its drawing; `None` if nothing of it was measured. A size that is not there is not kept.
    #[must_use]
    pub fn deviation(&self, drawing: &[DrawingSize]) -> Option<Deviation> {
        let used = |(off, tolerance): &(f64, f64)| off.abs() / tolerance;
        let measured = self.deviations(drawing).map(|(size, off)| (off, size.tolerance));
        let worst = measured.max_by(|a, b| used(a).total_cmp(&used(b)))?;
        let all = self.size_deviations_um(drawing).iter().all(Option::is_some);
        Some(Deviation { worst_um: worst.0 * 1_000.0, keeps: all && used(&worst) <= 1.0 })
    }

    /// Greatest deviation of each size of a drawing, µm, with its sign; none where nothing of it was measured.
    #[must_use]
    pub fn size_deviations_um(&self, drawing: &[DrawingSize]) -> Vec<Option<f64>> {
        let of_size = |size: &DrawingSize| {
            let found = self.deviations(drawing).filter(|(of, _)| std::ptr::eq(*of, size));
            found.map(|(_, off)| off * 1_000.0).max_by(|a, b| a.abs().total_cmp(&b.abs()))
        };
        drawing.iter().map(of_size).collect()
    }

    /// Deviation of every measured place, with its sign, and the tolerance there, µm.
    #[must_use]
    pub fn place_deviations_um(&self, drawing: &[DrawingSize]) -> Vec<(f64, f64)> {
        self.deviations(drawing).map(|(size, off)| (off * 1_000.0, size.tolerance * 1_000.0)).collect()
    }

    /// What an operator adds to the offsets after measuring the first part: number, axis and mm as displayed.
    #[must_use]
    pub fn corrections(&self, drawing: &[DrawingSize]) -> Vec<(u8, Axis, f64)> {
        let mut offsets: Vec<(u8, Axis)> = drawing.iter().filter_map(|size| size.offset).collect();
        offsets.sort_unstable();
        offsets.dedup();
        let correction = |(number, axis): (u8, Axis)| {
            let off: Vec<f64> = self
                .deviations(drawing)
                .filter_map(|(size, off)| (size.offset == Some((number, axis))).then_some(off))
                .collect();
            (!off.is_empty()).then(|| (number, axis, -off.iter().sum::<f64>() / off.len() as f64))
        };
        offsets.into_iter().filter_map(correction).collect()
    }

    /// Each measured value that belongs to a size, with its deviation, mm.
    fn deviations<'a>(&self, drawing: &'a [DrawingSize]) -> impl Iterator<Item = (&'a DrawingSize, f64)> {
        let diameters = self.diameters.iter().map(|at| (DrawingFeature::Diameter, at.z, at.d));
        let faces = self.faces.iter().map(|at| (DrawingFeature::Face, at.z, at.z));
        let heights = self.heights.iter().map(|at| (DrawingFeature::Height, at.z, at.y));
        let measured = diameters.chain(faces).chain(heights);
        let of_size = move |(feature, place, found): (DrawingFeature, f64, f64)| {
            drawing.iter().find_map(|size| Some((size, size.deviation_mm(feature, place, found)?)))
        };
        measured.filter_map(of_size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::sim::{DiameterAt, FaceAt};

    const CONE: DrawingSize = DrawingSize {
        feature: DrawingFeature::Diameter,
        from: 30.0,
        to: 70.0,
        size: 40.0,
        size_to: Some(40.8),
        tolerance: 0.003,
        offset: None,
        typed: None,
    };

    #[test]
    fn p5_the_size_nearest_to_the_end_of_its_tolerance_decides() {
        let face =
            DrawingSize { feature: DrawingFeature::Face, from: 0.0, to: 20.0, size: 9.75, size_to: None, ..CONE };
        let face = DrawingSize { tolerance: 0.02, ..face };
        // The middle of the cone is 40.4: 2 of 3 µm; the face is off by 10 of 20 µm; a diameter elsewhere does not count.
        let report = PartReport {
            diameters: vec![DiameterAt { z: 50.0, d: 40.398 }, DiameterAt { z: 90.0, d: 12.0 }],
            faces: vec![FaceAt { x: 50.0, z: 9.76 }],
            ..PartReport::default()
        };
        let found = report.deviation(&[CONE, face]).unwrap();
        assert!((found.worst_um + 2.0).abs() < 1e-6 && found.keeps, "{found:?}");
        // The operator takes 2 µm back.
        let corrected = DrawingSize { offset: Some((1, Axis::X)), ..CONE };
        let corrections = report.corrections(&[corrected, face]);
        assert!(matches!(corrections[..], [(1, Axis::X, mm)] if (mm - 0.002).abs() < 1e-9), "{corrections:?}");
        let tight = DrawingSize { tolerance: 0.001, ..CONE };
        assert!(!report.deviation(&[tight, face]).unwrap().keeps);
        assert_eq!(report.deviation(&[]), None);
        // The same cone, told from its other end.
        let turned = DrawingSize { from: 70.0, to: 30.0, size: 40.8, size_to: Some(40.0), ..CONE };
        assert!((report.deviation(&[turned, face]).unwrap().worst_um + 2.0).abs() < 1e-6);
        let missing = DrawingSize { from: 80.0, to: 85.0, ..CONE };
        assert!(!report.deviation(&[CONE, missing, face]).unwrap().keeps, "a size that is not there");
        let sizes = report.size_deviations_um(&[CONE, missing, face]);
        assert!(
            matches!(sizes[..], [Some(a), None, Some(b)] if (a + 2.0).abs() < 1e-6 && (b - 10.0).abs() < 1e-6),
            "{sizes:?}"
        );
    }
}
