//! Input line of the pages that take values: the typed text, what it is for, its range or why it was refused.
//! Source: spec H6.

use egui::{Align2, Rect, Stroke, Ui, pos2, vec2};

use crate::hmi::field_editor::FieldEditor;
use crate::hmi::theme;
use crate::hmi::view::{View, fit_text};

/// What the line shows beside the typed text.
pub struct InputPrompt<'a> {
    /// What the value is for, with an operator: `#500=`, `磨耗 04 X +=`.
    pub label: &'a str,
    /// Name of the value.
    pub name: &'a str,
    /// Range and old value.
    pub range: &'a str,
}

/// Splits a page into body and input line.
#[must_use]
pub fn split(rect: Rect) -> (Rect, Rect) {
    rect.split_top_bottom_at_y(rect.max.y - theme::INPUT)
}

/// Draws the line.
pub fn ui(ui: &Ui, view: &View<'_>, rect: Rect, typing: &FieldEditor, told: &InputPrompt<'_>) {
    let painter = ui.painter();
    painter.rect_filled(rect, 0.0, view.theme.surface);
    painter.hline(rect.x_range(), rect.min.y + 0.5, Stroke::new(theme::HAIRLINE, view.theme.line));
    let line = rect.shrink2(vec2(theme::PAD, 2.0));
    let (left, rest) = line.split_left_right_at_fraction(0.38);
    let left = Rect::from_min_max(left.min, left.max - vec2(theme::PAD, 0.0));
    let words = format!("{} {}{}", view.text("数据输入:", "INPUT:"), told.label, typing.text);
    if let Some(reason) = typing.refusal(view.lang) {
        fit_text(painter, left, Align2::LEFT_CENTER, &words, theme::TITLE, view.theme.alarm_text);
        fit_text(painter, rest, Align2::RIGHT_CENTER, &reason, theme::LABEL, view.theme.alarm_text);
        return;
    }
    fit_text(painter, left, Align2::LEFT_CENTER, &words, theme::TITLE, view.theme.text);
    let range = fit_text(painter, rest, Align2::RIGHT_CENTER, told.range, theme::LABEL, view.theme.muted);
    let name = Rect::from_min_max(rest.min, pos2(range.min.x - theme::PAD, rest.max.y));
    fit_text(painter, name, Align2::LEFT_CENTER, told.name, theme::LABEL, view.theme.muted);
}
