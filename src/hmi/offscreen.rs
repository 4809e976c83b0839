//! Pages without a display: as a picture, and as the painted text.
//! Source: tools.md T6, the story line `expect page … shows`.

use egui::{Color32, Context, Pos2, RawInput, Rect, Shape, Ui, ViewportId, vec2};
use image::RgbaImage;

use super::app::Hmi;
use super::rasterizer::Rasterizer;
use super::theme;
use crate::defs::text::Lang;
use crate::link::Snapshot;

/// Display size for [`page_text`], px.
const TEXT_SIZE: (u32, u32) = (1_024, 768);

/// A picture of the screen with the panel. The same snapshot gives the same bytes.
#[must_use]
pub fn screenshot(snapshot: &Snapshot, lang: Lang, size: (u32, u32)) -> RgbaImage {
    let mut stage = OffscreenHmi::new(Hmi::new(lang), size);
    stage.frame(snapshot);
    stage.frame(snapshot);
    stage.picture()
}

/// Every text that the open page, its frame and the panel paint, in the order of painting. Line breaks are removed.
#[must_use]
pub fn page_text(snapshot: &Snapshot, lang: Lang) -> Vec<String> {
    let mut stage = OffscreenHmi::new(Hmi::new(lang), TEXT_SIZE);
    stage.frame(snapshot);
    stage.texts().into_iter().map(|(text, ..)| text).collect()
}

/// An egui context without a window; its frames are painted in software.
pub struct OffscreenContext {
    ctx: Context,
    raster: Rasterizer,
    /// Pixels, and pixels per point.
    size: (u32, u32),
    scale: f32,
    shapes: Vec<egui::epaint::ClippedShape>,
    time: f64,
}

impl OffscreenContext {
    /// A context of `size` pixels.
    #[must_use]
    pub fn new(size: (u32, u32)) -> Self {
        let scale = theme::scale(vec2(size.0 as f32, size.1 as f32));
        Self { ctx: Context::default(), raster: Rasterizer::default(), size, scale, shapes: Vec::new(), time: 0.0 }
    }

    /// The egui context.
    #[must_use]
    pub const fn ctx(&self) -> &Context {
        &self.ctx
    }

    /// Shows everything larger by a factor than the size of the display asks for.
    pub fn zoom(&mut self, factor: f32) {
        self.scale = factor * theme::scale(vec2(self.size.0 as f32, self.size.1 as f32));
    }

    /// Runs one frame, 1/60 s after the last.
    pub fn frame(&mut self, events: Vec<egui::Event>, ui: impl FnMut(&mut Ui)) {
        let logical = vec2(self.size.0 as f32, self.size.1 as f32) / self.scale;
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, logical)),
            time: Some(self.time),
            focused: true,
            events,
            ..RawInput::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&ViewportId::ROOT) {
            viewport.native_pixels_per_point = Some(self.scale);
        }
        self.time += 1.0 / 60.0;
        let mut output = self.ctx.run_ui(input, ui);
        let mut delta = std::mem::take(&mut output.textures_delta);
        self.raster.update(&delta);
        self.raster.free(&delta);
        delta.clear();
        self.shapes = std::mem::take(&mut output.shapes);
        output.drop_without_applying_deltas();
    }

    /// The last frame as a picture.
    #[must_use]
    pub fn picture(&self, ground: Color32) -> RgbaImage {
        let primitives = self.ctx.tessellate(self.shapes.clone(), self.scale);
        self.raster.paint(&primitives, self.scale, self.size, ground)
    }
}

/// The user interface without a window.
pub struct OffscreenHmi {
    /// The user interface; public for tests.
    pub hmi: Hmi,
    screen: OffscreenContext,
    /// Input of the next frame.
    pub events: Vec<egui::Event>,
}

impl OffscreenHmi {
    /// A screen of `size` pixels.
    #[must_use]
    pub fn new(hmi: Hmi, size: (u32, u32)) -> Self {
        let screen = OffscreenContext::new(size);
        hmi.install(screen.ctx());
        Self { hmi, screen, events: Vec::new() }
    }

    /// The egui context; tests change its options.
    #[must_use]
    pub const fn ctx(&self) -> &Context {
        self.screen.ctx()
    }

    /// Runs one frame, 1/60 s after the last; returns its commands.
    pub fn frame(&mut self, snapshot: &Snapshot) -> Vec<crate::link::Command> {
        self.screen.zoom(self.hmi.zoom());
        let hmi = &mut self.hmi;
        let mut commands = Vec::new();
        self.screen.frame(std::mem::take(&mut self.events), |ui| commands.extend(hmi.ui(ui, snapshot)));
        commands
    }

    /// Tessellates the shapes of the last frame; returns the number of triangles.
    pub fn triangles(&self) -> usize {
        let primitives = self.ctx().tessellate(self.screen.shapes.clone(), self.screen.scale);
        let count = |primitive: &egui::epaint::ClippedPrimitive| match &primitive.primitive {
            egui::epaint::Primitive::Mesh(mesh) => mesh.indices.len() / 3,
            egui::epaint::Primitive::Callback(_) => 0,
        };
        primitives.iter().map(count).sum()
    }

    /// The last frame as a picture.
    #[must_use]
    pub fn picture(&self) -> RgbaImage {
        self.screen.picture(self.hmi.background())
    }

    /// The shapes of the last frame, in the order of painting.
    #[must_use]
    pub fn shapes(&self) -> &[egui::epaint::ClippedShape] {
        &self.screen.shapes
    }

    /// Every text of the last frame with the bounds of its glyphs, its clip rectangle, and whether it was truncated.
    #[must_use]
    pub fn texts(&self) -> Vec<(String, Rect, Rect, bool)> {
        let mut found = Vec::new();
        for clipped in &self.screen.shapes {
            collect_texts(&clipped.shape, clipped.clip_rect, &mut found);
        }
        found
    }
}

fn collect_texts(shape: &Shape, clip: Rect, found: &mut Vec<(String, Rect, Rect, bool)>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect_texts(shape, clip, found)),
        Shape::Text(text) => {
            let ink = text.galley.mesh_bounds.translate(text.pos.to_vec2());
            let words = text.galley.job.text.replace('\n', "");
            if clip.intersects(ink) && !words.trim().is_empty() {
                found.push((words, ink, clip, text.galley.elided));
            }
        }
        _ => {}
    }
}
