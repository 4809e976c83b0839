//! The section of the plane that a drawing shows.
//! Source: spec B6, H9.

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Pos2, Rect, Vec2, pos2};

use crate::link::toolpath::BoundingBox;
use crate::units::Axis;

/// View plane: the axis to the right and the axis upwards.
pub type ViewPlane = (Axis, Axis);

/// Limits of the scale, pixels per mm.
const SCALE_RANGE: std::ops::RangeInclusive<f32> = 0.01..=20_000.0;
/// Section of the plane that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Centre of the canvas, mm: to the right, upwards.
    centre: (f32, f32),
    /// Pixels per mm.
    pub scale: f32,
    /// Everything is in view; true until the operator pans or zooms.
    pub fitted: bool,
}

impl Camera {
    /// A camera that shows everything.
    pub fn fit(whole: BoundingBox, plane: ViewPlane, rect: Rect) -> Self {
        let (right, up) = (plane.0 as usize, plane.1 as usize);
        let size = |axis: usize| (whole.high[axis] - whole.low[axis]).max(1.0);
        let scale = (rect.width() * 0.88 / size(right)).min(rect.height() * 0.88 / size(up));
        let scale = scale.clamp(*SCALE_RANGE.start(), *SCALE_RANGE.end());
        let middle = |axis: usize| f32::midpoint(whole.low[axis], whole.high[axis]);
        Self { centre: (middle(right), middle(up)), scale, fitted: true }
    }

    /// Pans by pixels.
    pub fn pan(&mut self, by: Vec2) {
        if by != Vec2::ZERO {
            self.centre.0 -= by.x / self.scale;
            self.centre.1 += by.y / self.scale;
            self.fitted = false;
        }
    }

    /// Zooms around `about`, pixels from the centre.
    pub fn zoom(&mut self, factor: f32, about: Vec2) {
        let scale = (self.scale * factor).clamp(*SCALE_RANGE.start(), *SCALE_RANGE.end());
        if !scale.is_finite() || (scale / self.scale - 1.0).abs() < 1e-4 {
            return;
        }
        self.centre.0 += about.x / self.scale - about.x / scale;
        self.centre.1 -= about.y / self.scale - about.y / scale;
        (self.scale, self.fitted) = (scale, false);
    }

    /// Coordinate to the right at a canvas position, mm.
    pub fn right_at(&self, rect: Rect, at: Pos2) -> f32 {
        self.centre.0 + (at.x - rect.center().x) / self.scale
    }

    /// Canvas position of a point in mm.
    pub fn to_canvas(self, rect: Rect, right: f32, up: f32) -> Pos2 {
        let centre = rect.center();
        pos2(centre.x + (right - self.centre.0) * self.scale, centre.y - (up - self.centre.1) * self.scale)
    }

    /// Visible range, mm: least and greatest to the right, least and greatest upwards.
    pub fn visible_mm(&self, rect: Rect) -> [f32; 4] {
        let (wide, high) = (rect.width() / 2.0 / self.scale, rect.height() / 2.0 / self.scale);
        [self.centre.0 - wide, self.centre.0 + wide, self.centre.1 - high, self.centre.1 + high]
    }
}

/// Adds a quadrilateral to a mesh, as two triangles; corners in order. Inlined: a drawing has a million.
#[inline]
pub fn add_quad(mesh: &mut Mesh, corners: [Pos2; 4], color: Color32) {
    add_shaded_quad(mesh, corners.map(|pos| (pos, color)));
}

/// The same with a colour for each corner.
#[inline]
pub fn add_shaded_quad(mesh: &mut Mesh, corners: [(Pos2, Color32); 4]) {
    let first = mesh.vertices.len() as u32;
    for (pos, color) in corners {
        mesh.vertices.push(Vertex { pos, uv: WHITE_UV, color });
    }
    mesh.indices.extend([first, first + 1, first + 2, first, first + 2, first + 3]);
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    #[test]
    fn h9_zoom_keeps_the_place_under_the_finger() {
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(500.0, 400.0));
        let around = BoundingBox { low: [0.0; 3], high: [100.0; 3] };
        let mut camera = Camera::fit(around, (Axis::Z, Axis::X), rect);
        let finger = vec2(80.0, -50.0);
        let under =
            |camera: &Camera| (camera.centre.0 + finger.x / camera.scale, camera.centre.1 - finger.y / camera.scale);
        let before = under(&camera);
        camera.zoom(3.0, finger);
        let after = under(&camera);
        assert!((before.0 - after.0).abs() < 1e-3 && (before.1 - after.1).abs() < 1e-3);
        // No zoom leaves the range that can be drawn.
        (0..200).for_each(|_| camera.zoom(10.0, finger));
        assert!(camera.scale <= *SCALE_RANGE.end() && camera.centre.0.is_finite());
        camera.zoom(f32::NAN, finger);
        assert!(camera.scale.is_finite());
    }
}
