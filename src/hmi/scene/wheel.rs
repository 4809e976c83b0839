//! The wheel with its worn outline, the dresser, coolant and sparks.

use egui::epaint::Mesh;
use egui::{Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, vec2};

use super::camera::add_shaded_quad;
use super::{Magnifier, SceneCanvas, frame_at};
use crate::defs::signal::Output;
use crate::hmi::theme;

/// Lines on a turning wheel, all around, and turns a second at which they move: slow enough to be seen.
const RIM_LINES: u32 = 96;
const WHEEL_TURNS_PER_S: f64 = 0.06;
/// Spokes of the wheel seen from its side; their turns a second.
const SPOKES: u32 = 6;
const SPOKE_TURNS_PER_S: f64 = 0.5;
/// Depth over which the rim gets darker, points.
const RIM_DEPTH: f32 = 60.0;
/// Radius of the hub, as a share of the wheel's.
const HUB_SHARE: f32 = 0.3;
/// Number of sparks in a picture, and their greatest length, points.
const SPARKS: u64 = 26;
const SPARK_LENGTH: f32 = 64.0;
/// Size of a diamond, mm, and the least size at which it is drawn, points.
const DIAMOND_MM: f32 = 6.0;
const DIAMOND_POINTS: f32 = 9.0;
/// Greatest radius of a disc, points; a larger one is drawn as its front alone.
const DISC_LIMIT: f32 = 6_000.0;

impl SceneCanvas<'_> {
    pub(super) fn paint_wheel(&self) {
        if self.shows_disc() { self.paint_disc() } else { self.paint_rim() }
    }

    /// The foremost point of the wheel on the canvas: of the disc, or of the middle of the rim.
    fn contact(&self) -> Pos2 {
        let (scene, front) = (self.scene, self.scene.front_mm());
        let (left, right) = scene.sides_mm();
        let other = match self.shows_disc() {
            true => {
                if self.plane.0 == scene.infeed {
                    self.plane.1
                } else {
                    self.plane.0
                }
            }
            false => scene.across,
        };
        let place = if other == scene.across { f64::midpoint(left, right) } else { scene.wheel_mm[other] };
        self.at((scene.infeed, front), (other, place))
    }

    /// Direction on the canvas from the part to the wheel's centre.
    fn away(&self) -> Vec2 {
        if self.plane.0 == self.scene.infeed { vec2(1.0, 0.0) } else { vec2(0.0, -1.0) }
    }

    /// The wheel along its spindle: every slice of the rim where it is, and the body behind it.
    fn paint_rim(&self) {
        let (scene, (rim, body)) = (self.scene, self.view.theme.abrasive);
        let (infeed, across) = (scene.infeed, scene.across);
        if !self.shows(infeed) {
            return self.paint_from_above();
        }
        let (left, right) = scene.sides_mm();
        let wears = &scene.workspace.rim_wear_mm;
        let wears = if wears.is_empty() { &[0.0][..] } else { wears };
        let slice = (right - left) / wears.len() as f64;
        let (mut mesh, mut outline): (Mesh, Vec<Pos2>) = (Mesh::default(), Vec::new());
        // Worn or dressed, the axis of the wheel stays: both rims come nearer to it.
        let far = scene.wheel_mm[infeed] + 2.0 * scene.workspace.wheel_radius_mm - scene.least_wear_mm();
        let at = |place: f64, height: f64| self.at((across, place), (infeed, height));
        outline.push(at(left, far));
        for (index, wear) in wears.iter().enumerate() {
            let (from, to) = (left + index as f64 * slice, left + (index + 1) as f64 * slice);
            let back = |place: f64| scene.wheel_mm[infeed] + wear - scene.workspace.swivel_tan * (place - left);
            let (a, b) = (at(from, back(from)), at(to, back(to)));
            let deep = self.away() * RIM_DEPTH;
            add_shaded_quad(&mut mesh, [(a, rim), (b, rim), (b + deep, body), (a + deep, body)]);
            add_shaded_quad(
                &mut mesh,
                [(a + deep, body), (b + deep, body), (at(to, far), body), (at(from, far), body)],
            );
            outline.extend([a, b]);
        }
        outline.push(at(right, far));
        self.view.painter.add(Shape::mesh(mesh));
        self.paint_rim_lines();
        self.view.painter.add(Shape::line(outline, Stroke::new(theme::FRAME, self.view.theme.hold)));
    }

    /// Lines across the rim, which move while the wheel turns.
    fn paint_rim_lines(&self) {
        let scene = self.scene;
        let radius = scene.workspace.wheel_radius_mm;
        let turned = if self.is_on(Output::Wheel) { self.turns(WHEEL_TURNS_PER_S) } else { 0.0 };
        let stroke = Stroke::new(theme::HAIRLINE, self.view.theme.abrasive.1);
        let (left, right) = scene.sides_mm();
        let front = scene.front_mm();
        for line in 0..RIM_LINES {
            let angle = (turned + f64::from(line) / f64::from(RIM_LINES)).fract() * std::f64::consts::TAU;
            if angle.sin() <= 0.0 {
                continue;
            }
            let height = front + radius * (1.0 - angle.cos());
            let at = |place: f64| self.at((scene.across, place), (scene.infeed, height));
            let ends = [at(left), at(right)];
            if self.rect.expand(2.0).contains(ends[0].lerp(ends[1], 0.5)) {
                self.view.painter.line_segment(ends, stroke);
            }
        }
    }

    /// The wheel from its side: a disc with a hub, and spokes that turn.
    fn paint_disc(&self) {
        let (rim, body) = self.view.theme.abrasive;
        let radius = (self.scene.workspace.wheel_radius_mm - self.scene.least_wear_mm()) as f32 * self.camera.scale;
        let centre = self.contact() + self.away() * radius;
        let stroke = Stroke::new(theme::FRAME, self.view.theme.hold);
        if radius > DISC_LIMIT {
            let front = self.contact();
            let side = self.away().rot90() * self.rect.width();
            self.view.painter.line_segment([front - side, front + side], stroke);
            return;
        }
        self.view.painter.circle(centre, radius, rim, stroke);
        self.view.painter.circle_filled(centre, radius * 0.93, body);
        let turned = if self.is_on(Output::Wheel) { self.turns(SPOKE_TURNS_PER_S) } else { 0.0 };
        for spoke in 0..SPOKES {
            let turn = turned + f64::from(spoke) / f64::from(SPOKES);
            let direction = Vec2::angled((turn * std::f64::consts::TAU) as f32);
            let ends = [centre + direction * radius * HUB_SHARE, centre + direction * radius * 0.9];
            self.view.painter.line_segment(ends, Stroke::new(theme::FRAME, rim));
        }
        let (lit, shade) = self.view.theme.metal;
        self.view.painter.circle(centre, radius * HUB_SHARE, shade, Stroke::new(theme::FRAME, lit));
        self.view.painter.circle_filled(centre, radius * HUB_SHARE * 0.25, lit);
    }

    /// Seen along the infeed: the outline of the wheel over the part.
    fn paint_from_above(&self) {
        let scene = self.scene;
        let Some(stroke_axis) = scene.stroke() else { return };
        let (left, right) = scene.sides_mm();
        let (centre, radius) = (scene.wheel_mm[stroke_axis], scene.workspace.wheel_radius_mm);
        let at = |stroke: f64, across: f64| self.at((stroke_axis, stroke), (scene.across, across));
        let place = Rect::from_two_pos(at(centre - radius, left), at(centre + radius, right));
        let fill = self.view.theme.abrasive.1.gamma_multiply(0.6);
        let stroke = Stroke::new(theme::FRAME, self.view.theme.hold);
        self.view.painter.rect(place, 0.0, fill, stroke, StrokeKind::Inside);
        self.view.painter.line_segment([at(centre, left), at(centre, right)], stroke);
    }

    /// The diamond on its shank, or the dressing roll.
    pub(super) fn paint_dresser(&self) {
        let Some(dresser) = self.scene.workspace.dresser else { return };
        let infeed = self.scene.infeed;
        if !self.shows(infeed) {
            return;
        }
        let other = if self.plane.0 == infeed { self.plane.1 } else { self.plane.0 };
        let at = |along: f64, height: f64| self.at((other, along), (infeed, height));
        let (lit, shade) = self.view.theme.metal;
        let frame = Stroke::new(theme::HAIRLINE, lit);
        let (tip, way) = (dresser.at_mm[infeed], if dresser.behind { 1.0 } else { -1.0 });
        if let Some((diameter, width)) = dresser.roll_mm {
            let centre = at(dresser.at_mm[other], tip + way * diameter / 2.0);
            if self.shows_disc() {
                self.view.painter.circle(centre, (diameter / 2.0) as f32 * self.camera.scale, shade, frame);
            } else {
                let from = dresser.at_mm[other];
                let place = Rect::from_two_pos(at(from, tip), at(from + width, tip + way * diameter));
                self.view.painter.rect(place, 1.0, shade, frame, StrokeKind::Inside);
            }
            return;
        }
        let point = at(dresser.at_mm[other], tip);
        let size = (DIAMOND_MM * self.camera.scale).clamp(DIAMOND_POINTS, 40.0);
        let deep = self.away() * (way as f32) * size;
        let side = deep.rot90() * 0.5;
        let cone = vec![point, point + deep + side, point + deep - side];
        self.view.painter.add(Shape::convex_polygon(cone, self.view.theme.info, frame));
        let shank = Rect::from_two_pos(point + deep + side, point + deep * 3.0 - side);
        self.view.painter.rect(shank, 0.0, shade, frame, StrokeKind::Inside);
    }

    /// A jet from the nozzle to the contact.
    pub(super) fn paint_coolant(&self) {
        if !self.is_on(Output::Coolant) || !self.shows(self.scene.infeed) {
            return;
        }
        let (contact, away) = (self.contact(), self.away());
        let side = away.rot90() * if self.shows_disc() { -1.0 } else { 1.0 };
        let half = match self.shows_disc() {
            true => 0.0,
            false => (self.scene.workspace.wheel_width_mm / 2.0) as f32 * self.camera.scale,
        };
        let nozzle = contact + side * (half + 42.0) + away * 34.0;
        let ink = self.view.theme.coolant;
        let drop = self.turns(2.0) as f32 * 12.0;
        for (index, spread) in [-5.0_f32, -1.5, 2.0, 5.5].into_iter().enumerate() {
            let ends = [nozzle + away * spread * 0.4, contact + side * half * 0.8 + away * spread];
            let gaps = (&[9.0_f32][..], &[3.0_f32][..]);
            let offset = -drop + index as f32 * 5.0;
            let stroke = Stroke::new(1.6, ink.gamma_multiply(0.75));
            let shapes = Shape::dashed_line_with_offset(&ends, stroke, gaps.0, gaps.1, offset);
            self.view.painter.extend(shapes);
        }
        let pipe = [nozzle, nozzle + side * 14.0 + away * 12.0];
        self.view.painter.line_segment(pipe, Stroke::new(5.0, self.view.theme.metal.0));
    }

    /// Sparks fly from the contact while the wheel grinds.
    pub(super) fn paint_sparks(&self) {
        if !self.scene.workspace.grinds || !self.shows(self.scene.infeed) {
            return;
        }
        let Some((across, infeed)) = Magnifier::contact_point(self.scene) else { return };
        let (contact, away) = match self.shows_disc() {
            true => (self.contact(), self.away()),
            false => (self.at((self.scene.across, across), (self.scene.infeed, infeed)), self.away()),
        };
        let along = away.rot90();
        let frame = frame_at(self.view.snapshot.now);
        for spark in 0..SPARKS {
            let [a, b, c] = [0, 1, 2].map(|what| unit(frame, spark * 3 + what));
            // From the side they fly on with the rim, from above to both sides.
            let direction = match self.shows_disc() {
                true => along + away * (0.5 * b - 0.15),
                false => along * (2.0 * b - 1.0) * 1.2 + away * (0.9 * a - 0.25),
            };
            let from = contact + direction * SPARK_LENGTH * 0.4 * c;
            let to = from + direction * SPARK_LENGTH * 0.35 * (0.3 + c);
            let ink = self.view.theme.spark.gamma_multiply(1.0 - 0.6 * c);
            self.view.painter.line_segment([from, to], Stroke::new(1.0 + 0.8 * (1.0 - c), ink));
        }
        self.view.painter.circle_filled(contact, 2.5, self.view.theme.spark);
    }
}

/// A number from 0 to 1 that is the same for the same picture.
fn unit(frame: u64, index: u64) -> f32 {
    let mixed = (frame.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ index.wrapping_mul(0xD1B5_4A32_D192_ED03))
        .wrapping_mul(0x94D0_49BB_1331_11EB);
    (mixed >> 40) as f32 / (1_u64 << 24) as f32
}
