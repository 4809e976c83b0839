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
    /// The finished size as a height, if the page names one for this surface, and whether it is a diameter.
    finished: Option<(f64, bool)>,
    /// Where the part comes nearest to the wheel: across and infeed.
    point: (f64, f64),
}

impl Magnifier {
    /// The contact that is nearest; none if the wheel is away from the part.
    #[must_use]
    pub fn of(scene: &MachineScene<'_>, snapshot: &Snapshot) -> Option<Self> {
        let (mut nearest, of) = Self::nearest(scene)?;
        // The size of the page is that of an outside or a bore, or of a plane; a face has none here.
        let nominal =
            snapshot.size_values().nominal().filter(|_| (of.along, of.height) == (scene.across, scene.infeed));
        let finished = nominal.and_then(|nominal| match nominal.kind {
            Some(SizeKind::Diameter) if is_bore(of) => Some((-nominal.mm / 2.0, true)),
            Some(SizeKind::Diameter) if of.mirrored.is_some() => Some((nominal.mm / 2.0, true)),
            Some(SizeKind::Height) if of.mirrored != Some(of.height) => Some((nominal.mm, false)),
            Some(SizeKind::Diameter | SizeKind::Height | SizeKind::Length) | None => None,
        });
        // A size far from this surface is that of another one.
        nearest.finished = finished.filter(|(height, _)| (nearest.top_mm - height).abs() <= NEAR_MM);
        Some(nearest)
    }

    /// The contact that is nearest, and the section that it is on; none if the wheel is away from the part, or nobody
    /// knows where it is.
    fn nearest<'a>(scene: &'a MachineScene<'_>) -> Option<(Self, &'a PartSection)> {
        let sections = scene.workspace.part.iter().filter(|_| scene.wheel_is_known);
        let contacts = sections.filter_map(|section| {
            let contact = Self::at_rim(scene, section).or_else(|| Self::at_side(scene, section))?;
            Some((contact, section))
        });
        let near = contacts.filter(|(contact, _)| contact.gap_mm.abs() <= NEAR_MM);
        near.min_by(|(a, _), (b, _)| a.gap_mm.abs().total_cmp(&b.gap_mm.abs()))
    }

    /// Where the part comes nearest to the wheel: across and infeed, mm.
    pub(super) fn contact_point(scene: &MachineScene<'_>) -> Option<(f64, f64)> {
        Self::nearest(scene).map(|(contact, _)| contact.point)
    }

    /// The rim over an outside, a plane or a disc, or in a bore.
    fn at_rim(scene: &MachineScene<'_>, section: &PartSection) -> Option<Self> {
        if (section.along, section.height) != (scene.across, scene.infeed) {
            return None;
        }
        let space = &scene.workspace;
        let (left, right) = scene.sides_mm();
        let is_bore = is_bore(section);
        let front = scene.wheel_mm[scene.infeed];
        // In a bore the rim on the far side of the wheel touches.
        let rim = if is_bore { -(front + space.wheel_radius_mm).abs() - space.wheel_radius_mm } else { front };
        let slice = (right - left) / space.rim_wear_mm.len().max(1) as f64;
        let slope = if is_bore { space.swivel_tan } else { -space.swivel_tan };
        let lift = scene.overrun_lift_mm()?;
        let new = [0.0];
        let wears = if space.rim_wear_mm.is_empty() { &new[..] } else { &space.rim_wear_mm };
        let slices = wears.iter().enumerate().map(|(index, wear)| {
            let from = left + index as f64 * slice;
            (from, from + slice.max(f64::EPSILON), rim + lift + wear + slope * (from - left))
        });
        let height = |sample: &[f64; 3]| if is_bore { -sample[1] } else { sample[2] };
        let surface = section.samples.iter().map(|sample| (sample[0], height(sample))).collect();
        let mut contact = Self::between(surface, slices.collect())?;
        if is_bore {
            // The bore is touched on the side on which the axis of the wheel is.
            contact.point.1 *= -(front + space.wheel_radius_mm).signum();
        }
        Some(contact)
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
        let front = scene.front_mm() + scene.overrun_lift_mm()?;
        let mut contact = Self::between(surface, vec![(front, front + scene.workspace.wheel_radius_mm, side)])?;
        let (infeed, height) = contact.point;
        contact.point = (if faces_plus { height } else { -height }, infeed);
        Some(contact)
    }

    /// The contact of a surface with a wheel; none if they do not face each other.
    fn between(surface: Vec<(f64, f64)>, wheel: Vec<(f64, f64, f64)>) -> Option<Self> {
        let under = |place: f64| wheel.iter().find(|(from, to, _)| (*from..=*to).contains(&place));
        let met = || surface.iter().filter_map(|(place, height)| Some((*place, *height, under(*place)?.2 - height)));
        let (place, height, gap_mm) = met().min_by(|a, b| a.2.total_cmp(&b.2))?;
        let top_mm = met().map(|(_, height, _)| height).fold(f64::NEG_INFINITY, f64::max);
        Some(Self { surface, wheel, gap_mm, top_mm, finished: None, point: (place, height) })
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

/// Whether a section is the wall of a bore: it is round, and nothing of it is near the axis.
fn is_bore(section: &PartSection) -> bool {
    section.mirrored == Some(section.height) && section.samples.iter().all(|sample| sample[1] > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::grinding_workspace::GrindingWorkspace;
    use crate::units::{Axis, PerAxis};
    use std::borrow::Cow;

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

    fn scene(part: Vec<PartSection>, wheel_mm: [f64; 3]) -> MachineScene<'static> {
        let workspace = GrindingWorkspace {
            part,
            wheel_radius_mm: 100.0,
            wheel_width_mm: 20.0,
            rim_wear_mm: vec![0.0; 4],
            ..GrindingWorkspace::default()
        };
        let (workspace, wheel_mm) = (Cow::Owned(workspace), PerAxis(wheel_mm));
        MachineScene { workspace, infeed: Axis::X, across: Axis::Z, wheel_mm, wheel_is_known: true }
    }

    fn section(along: Axis, height: Axis, mirrored: Option<Axis>, samples: &[[f64; 3]]) -> PartSection {
        PartSection { along, height, mirrored, samples: samples.to_vec() }
    }

    #[test]
    fn h8_the_contact_is_where_wheel_and_part_are_nearest() {
        // An outside of radius 20 from Z 0 to 30, its front 10 µm away; the part has a hill at Z 25.
        let outside =
            section(Axis::Z, Axis::X, Some(Axis::X), &[[0.0, 0.0, 20.0], [25.0, 0.0, 20.005], [30.0, 0.0, 20.0]]);
        let near = scene(vec![outside], [20.015, 0.0, 10.0]);
        assert!((Magnifier::nearest(&near).unwrap().0.gap_mm - 0.01).abs() < 1e-9);
        assert_eq!(Magnifier::contact_point(&near), Some((25.0, 20.005)));
        // A bore of radius 150: the axis of the wheel is 49.99 above that of the bore, its far rim 10 µm from the wall.
        let bore = section(Axis::Z, Axis::X, Some(Axis::X), &[[0.0, 150.0, 170.0], [20.0, 150.0, 170.0]]);
        let inside = scene(vec![bore], [-50.01, 0.0, 0.0]);
        let (contact, _) = Magnifier::nearest(&inside).unwrap();
        assert!((contact.gap_mm - 0.01).abs() < 1e-9, "{}", contact.gap_mm);
        assert_eq!(Magnifier::contact_point(&inside), Some((0.0, 150.0)));
        // A face at Z 5, the left side of the wheel 20 µm beside it, from X 10 on.
        let face = section(Axis::X, Axis::Z, None, &[[10.0, 0.0, 5.0], [60.0, 0.0, 5.0]]);
        let beside = scene(vec![face], [40.0, 0.0, 5.02]);
        assert!((Magnifier::nearest(&beside).unwrap().0.gap_mm - 0.02).abs() < 1e-9);
        assert!((Magnifier::contact_point(&beside).unwrap().0 - 5.0).abs() < 1e-9);
    }

    #[test]
    fn b5_before_homing_there_is_no_contact() {
        let outside = section(Axis::Z, Axis::X, Some(Axis::X), &[[0.0, 0.0, 20.0], [30.0, 0.0, 20.0]]);
        let mut unknown = scene(vec![outside], [20.015, 0.0, 10.0]);
        unknown.wheel_is_known = false;
        assert!(Magnifier::nearest(&unknown).is_none());
    }

    #[test]
    fn h8_beyond_the_end_of_the_stroke_the_rim_is_off_the_part() {
        // A plane at height 15, 200 long (Y), 20 wide; the wheel is fed in by 10 µm 30 mm beyond its end.
        let plane = || {
            vec![
                section(Axis::Z, Axis::X, None, &[[0.0, 0.0, 15.0], [20.0, 0.0, 15.0]]),
                section(Axis::Y, Axis::X, None, &[[0.0, 0.0, 15.0], [200.0, 0.0, 15.0]]),
            ]
        };
        let over = scene(plane(), [14.99, 100.0, 0.0]);
        assert!((Magnifier::nearest(&over).unwrap().0.gap_mm + 0.01).abs() < 1e-9);
        // 3 mm beyond: 100 - sqrt(100² - 3²) = 0.045 mm of lift.
        let edge = scene(plane(), [14.99, -3.0, 0.0]);
        let lift = 100.0 - (100.0_f64 * 100.0 - 9.0).sqrt();
        assert!((Magnifier::nearest(&edge).unwrap().0.gap_mm - (lift - 0.01)).abs() < 1e-9);
        assert!(Magnifier::nearest(&scene(plane(), [14.99, -30.0, 0.0])).is_none(), "4.6 mm of lift");
        assert!(Magnifier::nearest(&scene(plane(), [14.99, -120.0, 0.0])).is_none(), "clear of the part");
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
