//! Designed empty states: what is missing, and what to do about it.
//! Source: spec H8.

use egui::{Align2, Rect, Ui, pos2, vec2};

use crate::hmi::pictogram::{self, Mark};
use crate::hmi::theme;
use crate::hmi::view::{View, fit, paragraph};

/// A sign, a sentence, and the remedy below it.
pub fn show(ui: &Ui, view: &View<'_>, rect: Rect, marks: &[Mark], what: &str, remedy: &str) {
    let painter = ui.painter();
    let middle = pos2(rect.center().x, rect.min.y + rect.height() * 0.34);
    let sign = Rect::from_center_size(middle, vec2(72.0, 72.0));
    pictogram::draw(painter, sign, marks, view.theme.quiet);
    let line = Rect::from_center_size(middle + vec2(0.0, 68.0), vec2(rect.width() - 24.0, 30.0));
    fit(painter, line, Align2::CENTER_CENTER, what, theme::SECONDARY, view.theme.text);
    let width = (rect.width() - 24.0).min(440.0);
    let below = Rect::from_min_size(pos2(rect.center().x - width / 2.0, line.max.y + 10.0), vec2(width, 120.0));
    paragraph(painter, below, remedy, theme::LABEL, view.theme.quiet);
}
