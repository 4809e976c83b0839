//! What the drawing page paints through its camera. Source: spec B6, L10.

use std::sync::Arc;

use egui::{Pos2, Rect};

use crate::hmi::scene::{Camera, ViewPlane};
use crate::link::toolpath::Toolpath;

/// What is painted.
pub struct GraphicScene<'a> {
    pub drawing: Option<&'a Arc<Toolpath>>,
    pub plane: ViewPlane,
    pub camera: Camera,
    pub actual_path: &'a [[f32; 3]],
    /// Touched Z positions to measure, mm (L10).
    pub measured_at: &'a [f32],
}

impl GraphicScene<'_> {
    /// Canvas position of a point X Y Z, mm.
    pub fn place(&self, rect: Rect, at: [f32; 3]) -> Pos2 {
        self.camera.to_canvas(rect, at[self.plane.0 as usize], at[self.plane.1 as usize])
    }
}
