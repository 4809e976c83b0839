//! What the pages are made of beside text: keys, tabs, small lamps, tables of lines.
//! Source: spec H3, H4.

use egui::accesskit::Role;
use egui::{Align2, Id, Painter, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::entry::Edit;
use super::keycap::{self, Face};
use super::pictogram;
use super::theme;
use super::view::{View, fit, frame};

/// Height of a row of tabs or page keys.
pub const TABS: f32 = 46.0;

/// How a key of a page looks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Look {
    /// Chosen or in force.
    pub on: bool,
    /// Asks for a password or is not possible now; pressing says why.
    pub locked: bool,
}

/// A key of a page: plate and label, a bar when it is on. `name` is what it is known by beside its label.
pub fn push(ui: &Ui, view: &View<'_>, rect: Rect, name: &str, label: &str, look: Look) -> bool {
    let response = ui.interact(rect, Id::unique(("page-key", name)), Sense::CLICK);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, look.on, format!("{label} {name}")));
    let face = Face { pressed: response.is_pointer_button_down_on(), ..Face::default() };
    let painter = ui.painter();
    keycap::plate(painter, view.theme, rect, face);
    let ink = if look.on { view.theme.info } else { view.theme.text };
    let room = if look.locked { 20.0 } else { 6.0 };
    fit(painter, rect.shrink2(vec2(room, 0.0)), Align2::CENTER_CENTER, label, theme::TITLE - 1.0, ink);
    if look.on {
        let bar = Rect::from_min_size(pos2(rect.min.x + 6.0, rect.max.y - 4.0), vec2(rect.width() - 12.0, 3.0));
        painter.rect_filled(bar, 1.0, view.theme.info);
    }
    if look.locked {
        let corner = Rect::from_min_size(pos2(rect.max.x - 18.0, rect.min.y + 5.0), vec2(12.0, 12.0));
        pictogram::draw(painter, corner, pictogram::LOCK, view.theme.quiet);
    }
    response.clicked()
}

/// Keys side by side of which one is chosen: accessible name and label of each; gives the one that was touched.
pub fn tabs(ui: &Ui, view: &View<'_>, rect: Rect, keys: &[(&str, String)], chosen: usize) -> Option<usize> {
    let width = (rect.width() - (keys.len() as f32 - 1.0) * theme::GAP) / keys.len() as f32;
    let mut touched = None;
    for (index, (name, label)) in keys.iter().enumerate() {
        let left = rect.min.x + index as f32 * (width + theme::GAP);
        let place = Rect::from_min_size(pos2(left, rect.min.y), vec2(width, rect.height()));
        if push(ui, view, place, name, label, Look { on: index == chosen, locked: false }) {
            touched = Some(index);
        }
    }
    touched
}

/// Walks over the keys of a page by keyboard: each key that is drawn asks whether it is the chosen one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Walk {
    /// The chosen key, once the keyboard was used.
    cursor: Option<usize>,
    drawn: usize,
    enter: bool,
}

impl Walk {
    /// Chooses a key of so many.
    pub const fn choose(&mut self, key: usize, count: usize) {
        (self.cursor, self.drawn) = (Some(key), count);
    }

    /// Begins a frame: what was typed moves the choice among the keys of the last frame, or acts.
    pub fn begin(&mut self, edits: &[Edit]) {
        let count = self.drawn.max(1);
        self.enter = false;
        for edit in edits {
            match edit {
                Edit::Down | Edit::Right | Edit::Next => {
                    self.cursor = Some(self.cursor.map_or(0, |at| (at + 1) % count))
                }
                Edit::Up | Edit::Left | Edit::Previous => {
                    self.cursor = Some(self.cursor.map_or(count - 1, |at| (at + count - 1) % count));
                }
                Edit::Enter => self.enter = true,
                Edit::Cancel => self.cursor = None,
                Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Delete | Edit::LineStart | Edit::LineEnd => {}
            }
        }
        self.drawn = 0;
    }

    /// Something else that the keyboard can choose: whether it is chosen, and entered.
    pub const fn pass(&mut self) -> (bool, bool) {
        let chosen = matches!(self.cursor, Some(at) if at == self.drawn);
        self.drawn += 1;
        (chosen, chosen && self.enter)
    }

    /// A key of the page by its name and label, touched or chosen and entered.
    pub fn push(&mut self, ui: &Ui, view: &View<'_>, rect: Rect, words: (&str, &str), look: Look) -> bool {
        let (name, label) = words;
        let chosen = self.cursor == Some(self.drawn);
        self.drawn += 1;
        let touched = push(ui, view, rect, name, label, look);
        if chosen {
            frame(ui.painter(), rect, view.theme.focus);
        }
        touched || (chosen && self.enter)
    }
}

/// A small lamp with its figure: a filled disc and 1, or a ring and 0.
pub fn lamp(painter: &Painter, view: &View<'_>, rect: Rect, on: bool) {
    let centre = pos2(rect.min.x + 9.0, rect.center().y);
    if on {
        painter.circle_filled(centre, 7.0, view.theme.run);
    } else {
        painter.circle_stroke(centre, 6.0, Stroke::new(1.5, view.theme.quiet));
    }
    let figure = Rect::from_min_max(pos2(centre.x + 14.0, rect.min.y), rect.max);
    let ink = if on { view.theme.text } else { view.theme.quiet };
    fit(painter, figure, Align2::LEFT_CENTER, if on { "1" } else { "0" }, theme::LABEL, ink);
}

/// The rectangles of a line's columns, by their shares.
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

/// The head of a table: small words over a hairline.
pub fn head<const N: usize>(painter: &Painter, view: &View<'_>, line: Rect, shares: [f32; N], words: [&str; N]) {
    for (place, word) in columns(line, shares).into_iter().zip(words) {
        fit(painter, place, Align2::LEFT_CENTER, word, theme::SMALL, view.theme.quiet);
    }
    painter.hline(line.x_range(), line.max.y - 0.5, Stroke::new(theme::HAIR, view.theme.line));
}

/// A list's rectangle, cut to whole lines: at rest nothing is cut in half.
#[must_use]
pub fn whole_lines(rect: Rect, line: f32) -> Rect {
    let lines = (rect.height() / line).floor().max(1.0);
    Rect::from_min_size(rect.min, vec2(rect.width(), lines * line))
}
