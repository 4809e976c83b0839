//! Drawing style of all page pictures (H10): outlines, hatched sections, centre lines, dimensions and variable numbers.

use std::cell::RefCell;

use egui::epaint::PathShape;
use egui::{Align2, Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2};
use kt830::defs::variable_name;
use kt830::hmi::theme::{self, Theme};

/// The name of a variable, and its place: left, top, right, bottom.
pub type NamedPlace = (String, (u16, u16, u16, u16));

/// A picture: its painter and colours, and where it names variables.
pub struct Sheet {
    pub painter: Painter,
    pub theme: Theme,
    pub labels: RefCell<Vec<NamedPlace>>,
}

impl Sheet {
    pub fn outline(&self) -> Stroke {
        Stroke::new(1.8, self.theme.paper_ink)
    }

    pub fn thin(&self) -> Stroke {
        Stroke::new(1.0, self.theme.paper_muted)
    }

    pub fn accent(&self) -> Stroke {
        Stroke::new(1.0, self.theme.paper_accent)
    }

    pub fn shape(&self, points: &[(f32, f32)], fill: Color32) {
        let points: Vec<Pos2> = points.iter().map(|(x, y)| pos2(*x, *y)).collect();
        self.painter.add(PathShape { points, closed: true, fill, stroke: self.outline().into() });
    }

    pub fn line(&self, points: &[(f32, f32)], stroke: Stroke) {
        self.painter.add(Shape::line(points.iter().map(|(x, y)| pos2(*x, *y)).collect(), stroke));
    }

    pub fn dashed(&self, from: (f32, f32), to: (f32, f32), stroke: Stroke) {
        self.painter.extend(Shape::dashed_line(&[pos2(from.0, from.1), pos2(to.0, to.1)], stroke, 5.0, 3.0));
    }

    /// An arrow head with its tip at `at`; `direction` is a unit vector.
    pub fn arrow_head(&self, at: (f32, f32), direction: (f32, f32), colour: Color32) {
        let (dx, dy) = direction;
        let side =
            |forward: f32, across: f32| pos2(at.0 + dx * forward - dy * across, at.1 + dy * forward + dx * across);
        let points = vec![side(0.0, 0.0), side(-7.0, 2.8), side(-7.0, -2.8)];
        self.painter.add(PathShape::convex_polygon(points, colour, Stroke::NONE));
    }

    /// A dimension line with an arrow at each end.
    pub fn dimension(&self, from: (f32, f32), to: (f32, f32)) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy).max(1.0);
        let direction = (dx / length, dy / length);
        self.line(&[from, to], self.accent());
        self.arrow_head(to, direction, self.theme.paper_accent);
        self.arrow_head(from, (-direction.0, -direction.1), self.theme.paper_accent);
    }

    /// The number of a macro variable on a blank background.
    pub fn variable_label(&self, at: (f32, f32), align: Align2, variable: u16) {
        self.label(at, align, &format!("#{variable}"));
    }

    /// A label on a blank background.
    pub fn label(&self, at: (f32, f32), align: Align2, words: &str) {
        let galley = self.painter.layout_no_wrap(words.to_owned(), theme::font(theme::SMALL), self.theme.paper_accent);
        let place = align.anchor_size(pos2(at.0, at.1), galley.size());
        self.painter.rect_filled(place.shrink2(vec2(-1.0, 3.0)), 0.0, self.theme.paper);
        self.painter.galley(place.min, galley, self.theme.paper_accent);
        self.note(place, words);
    }

    /// Notes the variables that a label names: `#520`, `R28 R22`. Digits and letters are taken for equally wide.
    fn note(&self, place: Rect, words: &str) {
        let width = place.width() / words.chars().count().max(1) as f32;
        let mut at = 0;
        for word in words.split(' ') {
            let from = at as f32;
            at += word.chars().count() + 1;
            if variable_name::parse(word).is_none() {
                continue;
            }
            let x = |chars: f32| (place.min.x + chars * width).round().clamp(0.0, 200.0) as u16;
            let y = |y: f32| y.round().clamp(0.0, 400.0) as u16;
            let area = (x(from), y(place.min.y), x((at - 1) as f32), y(place.max.y));
            self.labels.borrow_mut().push((word.to_owned(), area));
        }
    }

    /// An axis letter on a blank background.
    pub fn letter(&self, at: (f32, f32), word: &str) {
        let galley = self.painter.layout_no_wrap(word.into(), theme::font(theme::LABEL), self.theme.paper_accent);
        let place = Align2::CENTER_CENTER.anchor_size(pos2(at.0, at.1), galley.size());
        self.painter.rect_filled(place.shrink2(vec2(-2.0, 3.0)), 0.0, self.theme.paper);
        self.painter.galley(place.min, galley, self.theme.paper_accent);
    }

    /// The number of a macro variable at the start of a leader; the leader ends in a dot.
    pub fn leader(&self, label: (f32, f32), align: Align2, variable: u16, way: &[(f32, f32)]) {
        self.line(way, self.accent());
        if let Some((x, y)) = way.last() {
            self.painter.circle_filled(pos2(*x, *y), 2.2, self.theme.paper_accent);
        }
        self.variable_label(label, align, variable);
    }

    pub fn hatch(&self, area: Rect, step: f32) {
        let clipped = self.painter.with_clip_rect(area);
        let mut x = area.min.x - area.height();
        while x < area.max.x {
            let ends = [pos2(x, area.max.y), pos2(x + area.height(), area.min.y)];
            clipped.line_segment(ends, self.thin());
            x += step;
        }
    }

    /// The coordinate axes of a cylindrical grinder: X up, Z to the right.
    pub fn axes(&self, at: (f32, f32)) {
        self.cross(at, "X", "Z");
    }

    /// Two coordinate axes.
    pub fn cross(&self, at: (f32, f32), up: &str, right: &str) {
        let (x, y) = at;
        let ink = self.theme.paper_ink;
        self.line(&[(x, y - 22.0), (x, y), (x + 22.0, y)], Stroke::new(1.2, ink));
        self.arrow_head((x, y - 26.0), (0.0, -1.0), ink);
        self.arrow_head((x + 26.0, y), (1.0, 0.0), ink);
        let letter =
            |at: Pos2, word: &str| self.painter.text(at, Align2::CENTER_CENTER, word, theme::font(theme::SMALL), ink);
        letter(pos2(x + 10.0, y - 23.0), up);
        letter(pos2(x + 24.0, y - 10.0), right);
    }

    pub fn ink(&self) -> Stroke {
        Stroke::new(1.6, self.theme.paper_ink)
    }

    /// A rectangle with an outline.
    pub fn block(&self, from: (f32, f32), to: (f32, f32), fill: Color32) {
        let area = Rect::from_min_max(pos2(from.0, from.1), pos2(to.0, to.1));
        self.painter.rect(area, 0.0, fill, self.outline(), StrokeKind::Middle);
    }

    /// A hatched rectangle with an outline: a section of the part.
    pub fn section(&self, from: (f32, f32), to: (f32, f32)) {
        self.hatch(Rect::from_min_max(pos2(from.0, from.1), pos2(to.0, to.1)), 9.0);
        self.block(from, to, Color32::TRANSPARENT);
    }

    /// The wheel seen from the rim, with hub and axis.
    pub fn wheel(&self, from: (f32, f32), to: (f32, f32)) {
        self.block(from, to, self.theme.paper);
        let hub = from.1 + 22.0;
        self.painter.rect_filled(
            Rect::from_min_max(pos2(from.0, hub), pos2(to.0, hub + 22.0)),
            0.0,
            self.theme.paper_muted,
        );
        self.dashed((from.0 - 12.0, hub + 11.0), (to.0 + 12.0, hub + 11.0), self.thin());
    }

    /// A dashed rectangle: another position of the wheel, or stock.
    pub fn dashed_block(&self, from: (f32, f32), to: (f32, f32)) {
        let corners = [from, (to.0, from.1), to, (from.0, to.1)];
        for side in 0..4 {
            self.dashed(corners[side], corners[(side + 1) % 4], self.thin());
        }
    }

    /// A move of the wheel: a line with an arrow at its end.
    pub fn arrow(&self, from: (f32, f32), to: (f32, f32)) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy).max(1.0);
        self.line(&[from, to], self.ink());
        self.arrow_head(to, (dx / length, dy / length), self.theme.paper_ink);
    }

    /// A move to and fro: a line with an arrow at each end.
    pub fn double_arrow(&self, from: (f32, f32), to: (f32, f32)) {
        self.arrow(from, to);
        self.arrow(to, from);
    }

    pub fn circle(&self, at: (f32, f32), radius: f32, fill: Color32) {
        self.painter.circle(pos2(at.0, at.1), radius, fill, self.outline());
    }
}
