//! The magnifier: the contact of wheel and part, stretched to micrometres across the surface, with the finished size.

use egui::epaint::Mesh;
use egui::{Pos2, Rect, Shape, Stroke, pos2, vec2};

use super::camera::{add_quad, add_shaded_quad};
use super::{MachineScene, PartSection};
use crate::defs::page_meaning::SizeKind;
use crate::hmi::{Area, View, theme};
use crate::link::Snapshot;

/// A wheel farther from the part than this has no contact to show, mm.
const NEAR_MM: f64 = 2.5;
/// Half the range that is shown, µm: the least that holds the gap.
const HALF_RANGES_UM: [f64; 8] = [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1_000.0, 4_000.0];
/// Share of half the range up to which the gap may reach.
const USED_SHARE: f64 = 0.75;
/// Stock beyond this does not widen the range, µm.
const STOCK_IN_VIEW_UM: f64 = 200.0;
/// What is shown beside the contact, as a share of its width.
const BESIDE_SHARE: f64 = 0.12;
/// Height of a line of figures, and width of the scale.
const LINE: f32 = 18.0;
const SCALE_WIDTH: f32 = 60.0;
/// Width from which both figures are in one line.
const ONE_LINE_WIDTH: f32 = 260.0;

/// The contact: wheel above, part below, whatever their directions on the machine. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Magnifier {
    /// Surface of the part: place and height.
    surface: Vec<(f64, f64)>,
    /// Surface of the wheel: from, to, height.
    wheel: Vec<(f64, f64, f64)>,
    /// From the highest point of the part under the wheel to the wheel; below zero: what the wheel has still to take.
    gap_mm: f64,
    /// Highest point of the part under the wheel.
    top_mm: f64,
    /// The finished size as a height, if the page names it, and whether it is a diameter.
    finished: Option<(f64, bool)>,
}

impl Magnifier {
    /// The contact that is nearest; none if the wheel is away from the part.
    #[must_use]
    pub fn of(scene: &MachineScene<'_>, snapshot: &Snapshot) -> Option<Self> {
        let sections = scene.workspace.part.iter();
        let contacts =
            sections.filter_map(|section| Self::at_rim(scene, section).or_else(|| Self::at_side(scene, section)));
        let near = contacts.filter(|contact| contact.gap_mm.abs() <= NEAR_MM);
        let mut nearest = near.min_by(|a, b| a.gap_mm.abs().total_cmp(&b.gap_mm.abs()))?;
        nearest.finished = snapshot.size_values().nominal().and_then(|nominal| match nominal.kind {
            Some(SizeKind::Diameter) => Some((nominal.mm / 2.0, true)),
            Some(SizeKind::Height) => Some((nominal.mm, false)),
            Some(SizeKind::Length) | None => None,
        });
        Some(nearest)
    }

    /// The rim over an outside, a plane or a disc, or in a bore.
    fn at_rim(scene: &MachineScene<'_>, section: &PartSection) -> Option<Self> {
        if (section.along, section.height) != (scene.across, scene.infeed) {
            return None;
        }
        let space = &scene.workspace;
        let (left, right) = scene.sides_mm();
        let is_bore = section.samples.iter().all(|sample| sample[1] > 0.0);
        let front = scene.wheel_mm[scene.infeed];
        // In a bore the rim on the far side of the wheel touches.
        let rim = if is_bore { -(front + space.wheel_radius_mm).abs() - space.wheel_radius_mm } else { front };
        let slice = (right - left) / space.rim_wear_mm.len().max(1) as f64;
        let slope = if is_bore { space.swivel_tan } else { -space.swivel_tan };
        let new = [0.0];
        let wears = if space.rim_wear_mm.is_empty() { &new[..] } else { &space.rim_wear_mm };
        let slices = wears.iter().enumerate().map(|(index, wear)| {
            let from = left + index as f64 * slice;
            (from, from + slice.max(f64::EPSILON), rim + wear + slope * (from - left))
        });
        let height = |sample: &[f64; 3]| if is_bore { -sample[1] } else { sample[2] };
        let surface = section.samples.iter().map(|sample| (sample[0], height(sample))).collect();
        Self::between(surface, slices.collect())
    }

    /// A side of the wheel beside a face.
    fn at_side(scene: &MachineScene<'_>, section: &PartSection) -> Option<Self> {
        if (section.along, section.height) != (scene.infeed, scene.across) {
            return None;
        }
        let (left, right) = scene.sides_mm();
        let face = section.samples.first().map(|sample| f64::midpoint(sample[1], sample[2]))?;
        let [at_left, at_right] = scene.workspace.side_wear_mm;
        let faces_plus = face < f64::midpoint(left, right);
        let side = if faces_plus { left + at_left } else { at_right - right };
        let height = |sample: &[f64; 3]| if faces_plus { sample[2] } else { -sample[1] };
        let surface = section.samples.iter().map(|sample| (sample[0], height(sample))).collect();
        let front = scene.front_mm();
        Self::between(surface, vec![(front, front + scene.workspace.wheel_radius_mm, side)])
    }

    /// The contact of a surface with a wheel; none if they do not face each other.
    fn between(surface: Vec<(f64, f64)>, wheel: Vec<(f64, f64, f64)>) -> Option<Self> {
        let under = |place: f64| wheel.iter().find(|(from, to, _)| (*from..=*to).contains(&place));
        let met = surface.iter().filter_map(|(place, height)| Some((*height, under(*place)?.2 - height)));
        let (top_mm, gap_mm) = met.fold((f64::NEG_INFINITY, f64::INFINITY), |(top, gap), (height, between)| {
            (top.max(height), gap.min(between))
        });
        top_mm.is_finite().then_some(Self { surface, wheel, gap_mm, top_mm, finished: None })
    }

    /// From the highest point of the part under the wheel to the wheel, µm; below zero: what the wheel has still to take.
    #[must_use]
    pub fn gap_um(&self) -> f64 {
        self.gap_mm * 1_000.0
    }

    /// Half the range that is shown, µm.
    fn half_range_um(&self) -> f64 {
        let stock = self.stock_um().unwrap_or(0.0).clamp(0.0, STOCK_IN_VIEW_UM);
        let needed = (self.gap_mm.abs() * 1_000.0).max(stock) / USED_SHARE;
        HALF_RANGES_UM.into_iter().find(|half| *half >= needed).unwrap_or(HALF_RANGES_UM[7])
    }

    /// What is left above the finished size, µm, measured as a height.
    fn stock_um(&self) -> Option<f64> {
        self.finished.map(|(height, _)| (self.top_mm - height) * 1_000.0)
    }

    /// Paints the contact.
    pub fn paint(&self, rect: Rect, view: &View<'_>) {
        view.card(rect);
        let inside = rect.shrink2(vec2(8.0, 3.0));
        let lines = if inside.width() < ONE_LINE_WIDTH && self.finished.is_some() { 2.0 } else { 1.0 };
        let (head, plot) = inside.split_top(lines * LINE + 2.0);
        self.figures(head, view);
        let (plot, scale) = plot.split_right(SCALE_WIDTH);
        let clipped = &view.clipped(plot);
        self.paint_contact(plot, clipped);
        self.paint_scale(scale, view);
    }

    /// Gap and stock in figures.
    fn figures(&self, rect: Rect, view: &View<'_>) {
        let gap_um = self.gap_um();
        let (name, value, ink) = match gap_um < 0.0 {
            true => (view.text("切入", "engaged"), -gap_um, view.theme.hold),
            false => (view.text("间隙", "gap"), gap_um, view.theme.info),
        };
        let digits = usize::from(value < 100.0);
        let words = format!("{name} {value:.digits$} µm");
        let one_line = rect.width() >= ONE_LINE_WIDTH;
        let (left, right) = if one_line { rect.split_left_right_at_fraction(0.5) } else { rect.split_top(LINE) };
        view.fit_left(left, &words, theme::SMALL, ink);
        let Some(stock) = self.stock_um() else { return };
        let factor = if self.finished.is_some_and(|(_, is_diameter)| is_diameter) { 2.0 } else { 1.0 };
        let sign = if factor > 1.0 { "Ø " } else { "" };
        let words = format!("{} {sign}{:.1} µm", view.text("余量", "stock"), stock * factor);
        match one_line {
            true => view.fit_right(right, &words, theme::SMALL, view.theme.text),
            false => view.fit_left(right, &words, theme::SMALL, view.theme.text),
        };
    }

    fn paint_contact(&self, rect: Rect, view: &View<'_>) {
        let first = self.wheel.first().map_or(0.0, |slice| slice.0);
        let last = self.wheel.last().map_or(1.0, |slice| slice.1);
        // Of a side only the depth to which it faces the part is shown.
        let ends = self.surface.iter().map(|point| point.0);
        let (least, most) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), place| (a.min(place), b.max(place)));
        let (from, to) = (first.max(least - (last - first)), last.min(most + (last - first)));
        let beside = (to - from) * BESIDE_SHARE;
        let (from, to) = (from - beside, to + beside);
        let half_um = self.half_range_um();
        let at = |place: f64, height: f64| {
            let across = ((place - from) / (to - from)) as f32;
            let up = ((height - self.top_mm) * 1_000.0 / half_um) as f32;
            pos2(rect.min.x + across * rect.width(), rect.center().y - (up * rect.height() / 2.0).clamp(-1e4, 1e4))
        };
        self.paint_part(rect, view, &at);
        self.paint_wheel(rect, view, &at);
        if let Some((height, _)) = self.finished {
            let y = at(from, height).y;
            if rect.y_range().contains(y) {
                let ends = [pos2(rect.min.x, y), pos2(rect.max.x, y)];
                view.painter.extend(Shape::dashed_line(&ends, Stroke::new(theme::FRAME, view.theme.run), 7.0, 4.0));
            }
        }
    }

    fn paint_part(&self, rect: Rect, view: &View<'_>, at: &impl Fn(f64, f64) -> Pos2) {
        let (lit, shade) = view.theme.metal;
        let mut mesh = Mesh::default();
        let points: Vec<Pos2> = self.surface.iter().map(|(place, height)| at(*place, *height)).collect();
        for pair in points.windows(2) {
            let foot = |point: Pos2| pos2(point.x, rect.max.y.max(point.y));
            let corners = [(pair[0], lit), (pair[1], lit), (foot(pair[1]), shade), (foot(pair[0]), shade)];
            add_shaded_quad(&mut mesh, corners);
        }
        view.painter.add(Shape::mesh(mesh));
        view.painter.add(Shape::line(points, Stroke::new(theme::FRAME, view.theme.text)));
    }

    fn paint_wheel(&self, rect: Rect, view: &View<'_>, at: &impl Fn(f64, f64) -> Pos2) {
        let (rim, body) = view.theme.abrasive;
        let (mut mesh, mut outline) = (Mesh::default(), Vec::new());
        for (from, to, height) in &self.wheel {
            let (a, b) = (at(*from, *height), at(*to, *height));
            let top = |point: Pos2| pos2(point.x, rect.min.y.min(point.y));
            add_quad(&mut mesh, [a, b, top(b), top(a)], body.gamma_multiply(0.8));
            outline.extend([a, b]);
        }
        view.painter.add(Shape::mesh(mesh));
        view.painter.add(Shape::line(outline, Stroke::new(theme::FRAME, rim)));
    }

    /// The scale: a bar of half the range.
    fn paint_scale(&self, rect: Rect, view: &View<'_>) {
        let half_um = self.half_range_um();
        let (top, foot) = (rect.center().y - rect.height() / 4.0, rect.center().y + rect.height() / 4.0);
        let x = rect.min.x + 8.0;
        let stroke = Stroke::new(theme::FRAME, view.theme.muted);
        view.painter.line_segment([pos2(x, top), pos2(x, foot)], stroke);
        for y in [top, foot] {
            view.painter.line_segment([pos2(x - 4.0, y), pos2(x + 4.0, y)], stroke);
        }
        let words =
            if half_um < 1_000.0 { format!("{half_um:.0} µm") } else { format!("{:.0} mm", half_um / 1_000.0) };
        let place = Rect::from_min_max(pos2(x + 3.0, rect.center().y - 10.0), pos2(rect.max.x, rect.center().y + 10.0));
        view.fit_left(place, &words, theme::SMALL, view.theme.muted);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SURFACE: [(f64, f64); 3] = [(0.0, 20.0), (10.0, 20.1), (20.0, 20.05)];

    #[test]
    fn h8_the_gap_is_that_of_the_highest_point_under_the_wheel() {
        let contact = Magnifier::between(SURFACE.to_vec(), vec![(5.0, 15.0, 20.15)]).unwrap();
        assert!((contact.gap_mm - 0.05).abs() < 1e-12 && (contact.top_mm - 20.1).abs() < 1e-12);
        // 50 µm in 75 % of half the range.
        assert!((contact.half_range_um() - 100.0).abs() < 1e-9);
        let engaged = Magnifier::between(SURFACE.to_vec(), vec![(5.0, 15.0, 20.09)]).unwrap();
        assert!((engaged.gap_mm + 0.01).abs() < 1e-12);
        assert_eq!(Magnifier::between(SURFACE.to_vec(), vec![(30.0, 40.0, 20.0)]), None, "beside the part");
    }

    #[test]
    fn h8_the_stock_is_what_stands_above_the_finished_size() {
        let mut contact = Magnifier::between(SURFACE.to_vec(), vec![(5.0, 15.0, 20.15)]).unwrap();
        assert_eq!(contact.stock_um(), None);
        contact.finished = Some((20.0, true));
        assert!((contact.stock_um().unwrap() - 100.0).abs() < 1e-6);
        // The stock of 100 µm is in view, one of a millimetre is not.
        assert!((contact.half_range_um() - 200.0).abs() < 1e-9);
        contact.finished = Some((19.0, true));
        assert!((contact.half_range_um() - 500.0).abs() < 1e-9);
    }
}
