//! The part as it is ground, and what holds it.

use egui::epaint::Mesh;
use egui::{Color32, Pos2, Rect, Shape, Stroke, StrokeKind};

use super::camera::add_shaded_quad;
use super::{PART_DRIVES, SceneCanvas};
use crate::defs::grinding_workspace::{Holder, HolderKind, PartSection};
use crate::defs::param;
use crate::defs::signal::Output;
use crate::hmi::theme;
use crate::link::Snapshot;
use crate::units::{Axis, PerAxis};

/// Lines on a part that turns; they move at so many turns a second.
const PART_LINES: u32 = 6;
const PART_TURNS_PER_S: f64 = 0.35;
/// Length of the centre of a tailstock ahead of its sleeve, as a share of the sleeve's radius.
const CENTRE_SHARE: f64 = 1.0;
/// A jaw of a chuck: from and to, and its length, as shares of the radius of the chuck.
const JAW_SHARES: [f64; 2] = [0.45, 0.75];
const JAW_LENGTH_SHARE: f64 = 0.12;
/// Distance of the poles of a magnet, points.
const POLE_PITCH: f32 = 14.0;

impl SceneCanvas<'_> {
    pub(super) fn paint_part(&self) {
        for section in self.scene.workspace.part.iter().filter(|part| part.lies_in(self.plane.0, self.plane.1)) {
            self.paint_section(section, false);
            if section.mirrored.is_some() {
                self.paint_section(section, true);
            }
            self.paint_turning(section);
        }
        if self.scene.workspace.part.iter().any(|part| part.mirrored.is_some()) {
            self.paint_axis_of_rotation();
        }
    }

    /// The two points of a sample.
    fn ends(&self, section: &PartSection, [place, low, high]: [f64; 3], mirrored: bool) -> [Pos2; 2] {
        let flip = |axis: Axis, value: f64| if mirrored && section.mirrored == Some(axis) { -value } else { value };
        let at = |height: f64| {
            self.at((section.along, flip(section.along, place)), (section.height, flip(section.height, height)))
        };
        [at(low), at(high)]
    }

    fn paint_section(&self, section: &PartSection, mirrored: bool) {
        let (lit, shade) = self.view.theme.metal;
        // A round part is lit along its middle, another one at its top.
        let round = section.mirrored == Some(section.height);
        let colours = if round { [lit, shade] } else { [shade, lit.lerp_to_gamma(shade, 0.45)] };
        let (mut mesh, mut outline): (Mesh, Vec<Pos2>) = (Mesh::default(), Vec::new());
        let points: Vec<[Pos2; 2]> =
            section.samples.iter().map(|sample| self.ends(section, *sample, mirrored)).collect();
        for pair in points.windows(2) {
            let [[a, b], [c, d]] = [pair[0], pair[1]];
            add_shaded_quad(&mut mesh, [(a, colours[0]), (b, colours[1]), (d, colours[1]), (c, colours[0])]);
        }
        outline.extend(points.first().map(|ends| ends[0]));
        outline.extend(points.iter().map(|ends| ends[1]));
        outline.extend(points.last().map(|ends| ends[0]));
        self.view.painter.add(Shape::mesh(mesh));
        self.view.painter.add(Shape::line(outline, Stroke::new(theme::FRAME, self.view.theme.text)));
    }

    /// Lines along a round part that move while it turns.
    fn paint_turning(&self, section: &PartSection) {
        let turns = PART_DRIVES.iter().any(|output| self.is_on(*output));
        if section.mirrored != Some(section.height) || !turns {
            return;
        }
        let stroke = Stroke::new(theme::HAIRLINE, self.view.theme.metal.1);
        for line in 0..PART_LINES {
            // Wheel and part turn the same way round: at the contact they run against each other.
            let turn = 1.0 - self.turns(PART_TURNS_PER_S) + f64::from(line) / f64::from(PART_LINES);
            let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
            if sin > 0.0 {
                let at = |sample: &[f64; 3]| self.at((section.along, sample[0]), (section.height, sample[2] * cos));
                self.view.painter.add(Shape::line(section.samples.iter().map(at).collect(), stroke));
            }
        }
    }

    /// The axis of rotation, dash-dotted over the canvas.
    fn paint_axis_of_rotation(&self) {
        let mirrored = self.scene.workspace.part.iter().find_map(|part| part.mirrored);
        let Some(axis) = mirrored.filter(|axis| self.shows(*axis)) else { return };
        let other = if self.plane.0 == axis { self.plane.1 } else { self.plane.0 };
        let middle = self.at((axis, 0.0), (other, 0.0));
        let ends = match self.plane.0 == axis {
            true => [Pos2::new(middle.x, self.rect.min.y), Pos2::new(middle.x, self.rect.max.y)],
            false => [Pos2::new(self.rect.min.x, middle.y), Pos2::new(self.rect.max.x, middle.y)],
        };
        let stroke = Stroke::new(theme::HAIRLINE, self.view.theme.info);
        self.view.painter.extend(Shape::dashed_line(&ends, stroke, 14.0, 5.0));
    }

    pub(super) fn paint_holders(&self) {
        for holder in &self.scene.workspace.holders {
            let place = self.holder_place(&holder.extent);
            if !place.intersects(self.rect) {
                continue;
            }
            let (lit, shade) = self.view.theme.metal;
            self.view.painter.rect_filled(place, 0.0, shade);
            match holder.kind {
                HolderKind::Chuck => self.paint_clamped_stub(holder),
                HolderKind::Tailstock => self.paint_centre(holder),
                HolderKind::Magnet => self.paint_poles(place),
                HolderKind::Fixture => {}
            }
            let frame = Stroke::new(theme::HAIRLINE, lit);
            self.view.painter.rect_stroke(place, 0.0, frame, StrokeKind::Inside);
        }
    }

    /// Where a holder is; along an axis without an end it fills the canvas.
    fn holder_place(&self, extent: &PerAxis<Option<(f64, f64)>>) -> Rect {
        let seen = self.camera.visible_mm(self.rect).map(f64::from);
        let range = |axis: Axis, low: f64, high: f64| extent[axis].unwrap_or((low, high));
        let (right, up) = self.plane;
        let (across, height) = (range(right, seen[0], seen[1]), range(up, seen[2], seen[3]));
        Rect::from_two_pos(self.at((right, across.0), (up, height.0)), self.at((right, across.1), (up, height.1)))
    }

    /// The end of a round part that nobody has measured: the smallest radius and the two ends along the axis.
    fn round_part(&self) -> Option<(f64, f64, f64)> {
        let round = |part: &&PartSection| part.mirrored == Some(part.height) && part.along == self.scene.across;
        let samples = || self.scene.workspace.part.iter().filter(round).flat_map(|part| &part.samples);
        let radius = samples().map(|sample| sample[2]).reduce(f64::min)?;
        let places = || samples().map(|sample| sample[0]);
        Some((0.8 * radius, places().reduce(f64::min)?, places().reduce(f64::max)?))
    }

    /// A cylinder along the axis of the part.
    fn paint_shaft(&self, radius: f64, from: f64, to: f64) {
        let (lit, shade) = self.view.theme.metal;
        let at = |along: f64, height: f64| self.at((self.scene.across, along), (self.scene.infeed, height));
        let mut mesh = Mesh::default();
        for radius in [radius, -radius] {
            let corners =
                [(at(from, 0.0), lit), (at(from, radius), shade), (at(to, radius), shade), (at(to, 0.0), lit)];
            add_shaded_quad(&mut mesh, corners);
        }
        self.view.painter.add(Shape::mesh(mesh));
    }

    /// The stub of the part between the chuck and what is ground.
    fn paint_clamped_stub(&self, chuck: &Holder) {
        let face = chuck.extent[self.scene.across].map(|range| range.1);
        if let Some(((radius, from, _), face)) = self.round_part().zip(face)
            && face < from
        {
            self.paint_shaft(radius, face, from);
        }
        let Some((face, radius)) = face.zip(chuck.extent[self.scene.infeed].map(|range| range.1)) else { return };
        let at = |along: f64, height: f64| self.at((self.scene.across, along), (self.scene.infeed, height));
        for side in [1.0, -1.0] {
            let [inner, outer] = JAW_SHARES.map(|share| side * share * radius);
            let jaw = Rect::from_two_pos(at(face, inner), at(face + JAW_LENGTH_SHARE * radius, outer));
            self.view.painter.rect_filled(jaw, 1.0, self.view.theme.metal.0);
        }
    }

    /// The centre of the tailstock, and the end of the part that it holds.
    fn paint_centre(&self, tailstock: &Holder) {
        let (across, infeed) = (self.scene.across, self.scene.infeed);
        let Some((sleeve, radius)) = tailstock.extent[across].zip(tailstock.extent[infeed]).map(|(z, x)| (z.0, x.1))
        else {
            return;
        };
        let tip = sleeve - CENTRE_SHARE * radius;
        if let Some((stub, _, to)) = self.round_part()
            && to < sleeve
        {
            // The part ends where the centre is when it holds the part: in the centre's cone.
            let advanced = self.is_on(Output::Tailstock);
            let end = if advanced { f64::midpoint(tip, sleeve).max(to) } else { to };
            self.paint_shaft(stub, to, end);
        }
        let at = |along: f64, height: f64| self.at((across, along), (infeed, height));
        let cone = vec![at(tip, 0.0), at(sleeve, 0.6 * radius), at(sleeve, -0.6 * radius)];
        let (lit, shade) = self.view.theme.metal;
        self.view.painter.add(Shape::convex_polygon(cone, lit, Stroke::new(theme::HAIRLINE, shade)));
    }

    /// The poles of a magnet: lit while it holds.
    fn paint_poles(&self, place: Rect) {
        let holds = self.is_on(Output::Magnetise);
        let ink: Color32 = if holds { self.view.theme.run } else { self.view.theme.metal.0 };
        let seen = place.intersect(self.rect);
        let first = ((seen.min.x - place.min.x) / POLE_PITCH).ceil();
        let mut x = place.min.x + first * POLE_PITCH;
        while x < seen.max.x {
            let (top, foot) = (Pos2::new(x, place.min.y + 2.0), Pos2::new(x, (place.min.y + 12.0).min(place.max.y)));
            self.view.painter.line_segment([top, foot], Stroke::new(theme::FRAME, ink));
            x += POLE_PITCH;
        }
    }

    /// The soft limits of the axes of the plane: how far the foremost point of a new wheel goes.
    pub(super) fn paint_soft_limits(&self) {
        if self.view.snapshot.simulated.is_none() {
            return;
        }
        let stroke = Stroke::new(theme::HAIRLINE, self.view.theme.alarm_text);
        for axis in Axis::ALL.into_iter().filter(|axis| self.shows(*axis)) {
            for limit in soft_limits_mm(self.view.snapshot, axis) {
                let at = self.at((axis, limit - self.scene.workspace.zero_mm[axis]), (axis, 0.0));
                let ends = match self.plane.0 == axis {
                    true => [Pos2::new(at.x, self.rect.min.y), Pos2::new(at.x, self.rect.max.y)],
                    false => [Pos2::new(self.rect.min.x, at.y), Pos2::new(self.rect.max.x, at.y)],
                };
                if self.rect.contains(ends[0].lerp(ends[1], 0.5)) {
                    self.view.painter.extend(Shape::dashed_line(&ends, stroke, 6.0, 6.0));
                }
            }
        }
    }
}

/// The soft limits of an axis, machine coordinates of the slide (X as radius); none before it is homed.
fn soft_limits_mm(snapshot: &Snapshot, axis: Axis) -> impl Iterator<Item = f64> {
    let limits = match axis {
        Axis::X => [param::SOFT_MINUS_X, param::SOFT_PLUS_X],
        Axis::Y => [param::SOFT_MINUS_Y, param::SOFT_PLUS_Y],
        Axis::Z => [param::SOFT_MINUS_Z, param::SOFT_PLUS_Z],
    };
    limits.into_iter().filter(move |_| snapshot.axes[axis].homed).map(|limit| snapshot.params.get(limit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;

    #[test]
    fn b5_soft_limits_are_slide_travel_and_act_on_homed_axes() {
        let mut machine = Snapshot::new(Kind::Gc);
        machine.x_as_diameter = true;
        assert_eq!(soft_limits_mm(&machine, Axis::X).count(), 0);
        machine.axes[Axis::X].homed = true;
        // P42 and P39 of the factory: -300 and 2 mm of slide, shown as diameters of -600 and 4.
        let found: Vec<f64> = soft_limits_mm(&machine, Axis::X).collect();
        assert_eq!(found, [machine.params.get(param::SOFT_MINUS_X), machine.params.get(param::SOFT_PLUS_X)]);
        assert!((found[0] + 300.0).abs() < 1e-9, "{found:?}");
    }
}
