//! Input line of the pages that take values: the typed text, what it is for, its range or why it was refused.
//! Source: spec H6.

use egui::{Color32, Rect, vec2};

use crate::hmi::{Area, FieldEditor, View, theme};

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
pub fn split(rect: Rect) -> (Rect, Rect) {
    rect.split_bottom(theme::INPUT)
}

/// Paints the bar of the line; returns the place of its texts.
pub fn bar(view: &View<'_>, rect: Rect) -> Rect {
    view.painter.rect_filled(rect, 0.0, view.theme.surface);
    view.hairline(rect, rect.min.y + 0.5);
    rect.shrink2(vec2(theme::PAD, 2.0))
}

/// Paints what the value is for and the typed text; returns the colour of the range or of the reason beside it.
pub fn typed_text(view: &View<'_>, rect: Rect, label: &str, typing: &FieldEditor) -> Color32 {
    let words = format!("{} {label}{}", view.text("数据输入:", "INPUT:"), typing.text);
    let refused = typing.refused.is_some();
    view.fit_left(rect, &words, theme::TITLE, if refused { view.theme.alarm_text } else { view.theme.text });
    if refused { view.theme.alarm_text } else { view.theme.muted }
}

/// Draws the line.
pub fn ui(view: &View<'_>, rect: Rect, typing: &FieldEditor, told: &InputPrompt<'_>) {
    let (left, rest) = bar(view, rect).split_left_right_at_fraction(0.38);
    let ink = typed_text(view, left.trim_right(theme::PAD), told.label, typing);
    if let Some(reason) = typing.refusal(view.lang) {
        view.fit_right(rest, &reason, theme::LABEL, ink);
        return;
    }
    let range = view.fit_right(rest, told.range, theme::LABEL, ink);
    view.fit_left(rest.with_max_x(range.min.x - theme::PAD), told.name, theme::LABEL, ink);
}
