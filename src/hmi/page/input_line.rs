//! Input line of the pages that take values: the typed text, what it is for, its range or why it was refused.
//! Source: spec H6.

use egui::{Color32, Rect, vec2};

use crate::hmi::{Area, FieldEditor, View, theme};
use crate::link::edit::LOCKED_IN_RUN;

/// What the line shows beside the typed text.
pub struct InputPrompt<'a> {
    /// What the value is for, with an operator: `#500=`, `磨耗 04 X +=`.
    pub label: &'a str,
    /// Name of the value.
    pub name: &'a str,
    /// Range and old value.
    pub range: &'a str,
}

/// Range and old value of a value that P6.3 locks in a run, with the colour: in a run the lock in its place, or from
/// when on the value acts (K7.7).
pub fn range_in_run(view: &View<'_>, range: &str) -> (String, Option<Color32>) {
    match (view.snapshot.program.is_open, view.snapshot.values_locked()) {
        (false, _) => (range.to_owned(), None),
        (true, true) => (LOCKED_IN_RUN.get(view.lang).to_owned(), Some(view.theme.hold)),
        (true, false) => {
            let words = view.text("从下一个读入的段起有效", "acts from the next block read");
            (format!("{words} · {range}"), None)
        }
    }
}

/// Splits a page into body and input line.
pub fn split(rect: Rect) -> (Rect, Rect) {
    rect.split_bottom(theme::INPUT)
}

/// The room above the line for the numeric pad.
pub fn pad_room(rect: Rect) -> Rect {
    split(rect).0.shrink(theme::GAP)
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
    let reason = typing.refusal(view.lang).map_or_else(String::new, |reason| format!(" · {reason}"));
    *view.prompt.borrow_mut() = format!("{label}{}{reason}", typing.text);
    view.fit_left(rect, &words, theme::TITLE, if refused { view.theme.alarm_text } else { view.theme.text });
    if refused { view.theme.alarm_text } else { view.theme.muted }
}

/// Draws the line.
pub fn ui(view: &View<'_>, rect: Rect, typing: &FieldEditor, told: &InputPrompt<'_>) {
    draw(view, rect, typing, told, None);
}

/// Draws the line of a value that P6.3 locks in a run.
pub fn ui_in_run(view: &View<'_>, rect: Rect, typing: &FieldEditor, told: &InputPrompt<'_>) {
    let (range, ink) = range_in_run(view, told.range);
    draw(view, rect, typing, &InputPrompt { range: &range, ..*told }, ink);
}

fn draw(view: &View<'_>, rect: Rect, typing: &FieldEditor, told: &InputPrompt<'_>, range_ink: Option<Color32>) {
    let (left, rest) = bar(view, rect).split_left_right_at_fraction(0.38);
    let ink = typed_text(view, left.trim_right(theme::PAD), told.label, typing);
    if let Some(reason) = typing.refusal(view.lang) {
        view.fit_right(rest, &reason, theme::LABEL, ink);
        return;
    }
    if !told.range.is_empty() {
        view.prompt.borrow_mut().push_str(&format!(" · {}", told.range));
    }
    let range = view.fit_right(rest, told.range, theme::LABEL, range_ink.unwrap_or(ink));
    view.fit_left(rest.with_max_x(range.min.x - theme::PAD), told.name, theme::LABEL, ink);
}
