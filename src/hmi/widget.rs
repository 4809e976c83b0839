//! Widgets of the pages: keys, tabs, small lamps, tables.
//! Source: spec H3, H4.

use egui::accesskit::Role;
use egui::{Align2, Id, Painter, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::edit_key::EditKey;
use super::keycap::{self, KeycapState};
use super::pictogram;
use super::theme;
use super::view::{View, fit_text, focus_frame};

/// Height of a row of tabs or page keys, points.
pub const TABS_HEIGHT: f32 = 46.0;

/// The visible state of a key of a page.
#[derive(Clone, Copy, Debug, Default)]
pub struct ButtonState {
    /// Selected or active.
    pub on: bool,
    /// Needs a password or is not possible now; pressing it shows the reason.
    pub locked: bool,
}

/// Draws a key of a page: body, label, a bar when it is on. `name` is its accessible name beside the label.
pub fn button(ui: &Ui, view: &View<'_>, rect: Rect, name: &str, label: &str, look: ButtonState) -> bool {
    let response = ui.interact(rect, Id::unique(("page-key", name)), Sense::CLICK);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, look.on, format!("{label} {name}")));
    let face = KeycapState { pressed: response.is_pointer_button_down_on(), ..KeycapState::default() };
    let painter = ui.painter();
    keycap::paint_body(painter, view.theme, rect, face);
    let ink = if look.on { view.theme.info } else { view.theme.text };
    let room = if look.locked { 20.0 } else { 6.0 };
    fit_text(painter, rect.shrink2(vec2(room, 0.0)), Align2::CENTER_CENTER, label, theme::TITLE - 1.0, ink);
    if look.on {
        let bar = Rect::from_min_size(pos2(rect.min.x + 6.0, rect.max.y - 4.0), vec2(rect.width() - 12.0, 3.0));
        painter.rect_filled(bar, 1.0, view.theme.info);
    }
    if look.locked {
        let corner = Rect::from_min_size(pos2(rect.max.x - 18.0, rect.min.y + 5.0), vec2(12.0, 12.0));
        pictogram::draw(painter, corner, pictogram::LOCK, view.theme.muted);
    }
    response.clicked()
}

/// Draws tabs: accessible name and label of each, the selected one; returns the touched one.
pub fn tabs(ui: &Ui, view: &View<'_>, rect: Rect, keys: &[(&str, String)], chosen: usize) -> Option<usize> {
    let width = (rect.width() - (keys.len() as f32 - 1.0) * theme::GAP) / keys.len() as f32;
    let mut touched = None;
    for (index, (name, label)) in keys.iter().enumerate() {
        let left = rect.min.x + index as f32 * (width + theme::GAP);
        let place = Rect::from_min_size(pos2(left, rect.min.y), vec2(width, rect.height()));
        if button(ui, view, place, name, label, ButtonState { on: index == chosen, locked: false }) {
            touched = Some(index);
        }
    }
    touched
}

/// Keyboard focus on the keys of a page. Every key that is drawn checks whether it has the focus.
#[derive(Clone, Copy, Debug, Default)]
pub struct KeyboardFocus {
    /// The focused key; none until the keyboard is used.
    cursor: Option<usize>,
    item_count: usize,
    enter: bool,
}

impl KeyboardFocus {
    /// Focuses one of `count` keys.
    pub const fn select(&mut self, key: usize, count: usize) {
        (self.cursor, self.item_count) = (Some(key), count);
    }

    /// Starts a frame: the typed keys move the focus among the keys of the last frame, or activate the focused key.
    pub fn begin_frame(&mut self, edits: &[EditKey]) {
        let count = self.item_count.max(1);
        self.enter = false;
        for edit in edits {
            match edit {
                EditKey::Down | EditKey::Right | EditKey::Next => {
                    self.cursor = Some(self.cursor.map_or(0, |at| (at + 1) % count))
                }
                EditKey::Up | EditKey::Left | EditKey::Previous => {
                    self.cursor = Some(self.cursor.map_or(count - 1, |at| (at + count - 1) % count));
                }
                EditKey::Enter => self.enter = true,
                EditKey::Cancel => self.cursor = None,
                EditKey::Char(_)
                | EditKey::Sign
                | EditKey::Backspace
                | EditKey::Delete
                | EditKey::LineStart
                | EditKey::LineEnd => {}
            }
        }
        self.item_count = 0;
    }

    /// Adds an item other than a key; returns whether it is focused and whether it is activated.
    pub const fn item(&mut self) -> (bool, bool) {
        let chosen = matches!(self.cursor, Some(at) if at == self.item_count);
        self.item_count += 1;
        (chosen, chosen && self.enter)
    }

    /// Draws a key by its name and label; true if it is touched, or focused and activated.
    pub fn button(&mut self, ui: &Ui, view: &View<'_>, rect: Rect, words: (&str, &str), look: ButtonState) -> bool {
        let (name, label) = words;
        let chosen = self.cursor == Some(self.item_count);
        self.item_count += 1;
        let touched = button(ui, view, rect, name, label, look);
        if chosen {
            focus_frame(ui.painter(), rect, view.theme.focus);
        }
        touched || (chosen && self.enter)
    }
}

/// Draws a small lamp with its value: a filled disc and 1, or a ring and 0.
pub fn lamp(painter: &Painter, view: &View<'_>, rect: Rect, on: bool) {
    let centre = pos2(rect.min.x + 9.0, rect.center().y);
    if on {
        painter.circle_filled(centre, 7.0, view.theme.run);
    } else {
        painter.circle_stroke(centre, 6.0, Stroke::new(1.5, view.theme.muted));
    }
    let figure = Rect::from_min_max(pos2(centre.x + 14.0, rect.min.y), rect.max);
    let ink = if on { view.theme.text } else { view.theme.muted };
    fit_text(painter, figure, Align2::LEFT_CENTER, if on { "1" } else { "0" }, theme::LABEL, ink);
}

/// Cell of a row of `count` equal keys.
#[must_use]
pub fn cell(row: Rect, index: usize, count: usize) -> Rect {
    let width = (row.width() - (count as f32 - 1.0) * theme::GAP) / count as f32;
    Rect::from_min_size(row.min + vec2(index as f32 * (width + theme::GAP), 0.0), vec2(width, row.height()))
}

/// The rectangles of the columns of a line, by their shares of the width.
pub fn columns<const N: usize>(line: Rect, shares: [f32; N]) -> [Rect; N] {
    let whole: f32 = shares.iter().sum();
    let mut left = line.min.x;
    shares.map(|share| {
        let width = line.width() * share / whole;
        let column = Rect::from_min_size(pos2(left, line.min.y), vec2(width - theme::GAP, line.height()));
        left += width;
        column
    })
}

/// Draws the header of a table: small text over a hairline.
pub fn table_header<const N: usize>(
    painter: &Painter,
    view: &View<'_>,
    line: Rect,
    shares: [f32; N],
    words: [&str; N],
) {
    for (place, word) in columns(line, shares).into_iter().zip(words) {
        fit_text(painter, place, Align2::LEFT_CENTER, word, theme::SMALL, view.theme.muted);
    }
    painter.hline(line.x_range(), line.max.y - 0.5, Stroke::new(theme::HAIRLINE, view.theme.line));
}

/// The rectangle of a list, reduced to whole lines so that no line is cut when the list is at rest.
#[must_use]
pub fn round_to_lines(rect: Rect, line: f32) -> Rect {
    let lines = (rect.height() / line).floor().max(1.0);
    Rect::from_min_size(rect.min, vec2(rect.width(), lines * line))
}
