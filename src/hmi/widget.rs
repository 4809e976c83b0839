//! Widgets of the pages: keys, tabs, small lamps, tables.
//! Source: spec H3, H4.

use egui::{Rect, Response, Stroke, Vec2, pos2, vec2};

use super::{Area, EditKey, View, keycap, pictogram, theme};

/// Height of a row of tabs or page keys, points.
pub const KEYS_HEIGHT: f32 = 46.0;
/// Height of a row of a list that is touched, with the gap below it, points.
pub const ROW_HEIGHT: f32 = 46.0;

/// A key of a page as it is shown.
#[derive(Clone, Copy, Debug)]
pub struct PageKey<'a> {
    /// Accessible name, beside the label.
    name: &'a str,
    label: &'a str,
    on: bool,
    locked: bool,
}

impl<'a> PageKey<'a> {
    /// A key with its accessible name and its label, neither on nor locked.
    pub const fn new(name: &'a str, label: &'a str) -> Self {
        Self { name, label, on: false, locked: false }
    }

    /// Selected or active: it has a bar.
    pub const fn on(self, on: bool) -> Self {
        Self { on, ..self }
    }

    /// Needs a password or is not possible now: it has a lock; pressing it shows the reason.
    pub const fn locked(self, locked: bool) -> Self {
        Self { locked, ..self }
    }
}

/// A table of keys: each with the accessible name and the label.
macro_rules! page_keys {
    ($(#[$outer:meta])* $keys:ident { $($(#[$inner:meta])* $key:ident = $name:literal, $zh:literal, $en:literal;)* }) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $keys { $($(#[$inner])* $key,)* }

        impl $keys {
            /// The accessible name.
            pub const fn id(self) -> &'static str {
                match self { $(Self::$key => $name,)* }
            }

            /// The label.
            pub const fn label(self) -> Text {
                match self { $(Self::$key => Text::new($zh, $en),)* }
            }
        }
    };
}
pub(crate) use page_keys;

/// Draws a key of a page; true if it is touched.
pub fn button(view: &View<'_>, rect: Rect, key: PageKey<'_>) -> bool {
    let PageKey { name, label, on, locked } = key;
    let response = view.touch_row(rect, ("page-key", name), on, format!("{label} {name}"));
    keycap::plate(view, rect, &response);
    let ink = if on { view.theme.info } else { view.theme.text };
    view.fit_centre(rect.trim_sides(if locked { 20.0 } else { 6.0 }), label, theme::TITLE - 1.0, ink);
    if on {
        selected_bar(view, rect);
    }
    if locked {
        let corner = Rect::from_min_size(pos2(rect.max.x - 18.0, rect.min.y + 5.0), vec2(12.0, 12.0));
        pictogram::draw(&view.painter, corner, pictogram::LOCK, view.theme.muted);
    }
    response.clicked()
}

/// Draws why values are locked at the right of a line, behind a lock. Returns what is left of the line.
pub fn lock_note(view: &View<'_>, line: Rect, words: &str) -> Rect {
    let taken = view.fit_right(line, words, theme::LABEL, view.theme.hold);
    let lock = Rect::from_center_size(pos2(taken.min.x - 14.0, line.center().y), vec2(13.0, 13.0));
    pictogram::draw(&view.painter, lock, pictogram::LOCK, view.theme.hold);
    line.with_max_x(lock.min.x - theme::PAD)
}

/// How far a drag moved in this frame. The frame of the press does not count: a touch screen that acts as a mouse comes
/// from where it was touched last.
pub fn drag_delta(response: &Response) -> Vec2 {
    if response.dragged() && !response.drag_started() { response.drag_delta() } else { Vec2::ZERO }
}

/// Paints the bar at the lower edge of a key that is on.
pub fn selected_bar(view: &View<'_>, rect: Rect) {
    let bar = Rect::from_min_size(pos2(rect.min.x + 6.0, rect.max.y - 4.0), vec2(rect.width() - 12.0, 3.0));
    view.painter.rect_filled(bar, 1.0, view.theme.info);
}

/// Draws tabs: accessible name and label of each, the selected one; returns the touched one.
pub fn tabs(view: &View<'_>, rect: Rect, keys: &[(&str, String)], chosen: usize) -> Option<usize> {
    let mut touched = None;
    for (index, (name, label)) in keys.iter().enumerate() {
        if button(view, rect.cell(index, keys.len()), PageKey::new(name, label).on(index == chosen)) {
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

    /// The focused key.
    pub const fn selected(&self) -> Option<usize> {
        self.cursor
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
                _ => {}
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

    /// Draws a key; true if it is touched, or focused and activated.
    pub fn button(&mut self, view: &View<'_>, rect: Rect, key: PageKey<'_>) -> bool {
        let (chosen, entered) = self.item();
        let touched = button(view, rect, key);
        if chosen {
            view.frame(rect, view.theme.focus);
        }
        touched || entered
    }

    /// Draws a row of equal keys; returns the one that is touched, or focused and activated.
    pub fn keys(&mut self, view: &View<'_>, row: Rect, keys: &[PageKey<'_>]) -> Option<usize> {
        let mut touched = None;
        for (index, key) in keys.iter().enumerate() {
            if self.button(view, row.cell(index, keys.len()), *key) {
                touched = Some(index);
            }
        }
        touched
    }
}

/// Draws a small lamp with its value: a filled disc and 1, or a ring and 0.
pub fn lamp(view: &View<'_>, rect: Rect, on: bool) {
    let centre = pos2(rect.min.x + 9.0, rect.center().y);
    if on {
        view.painter.circle_filled(centre, 7.0, view.theme.run);
    } else {
        view.painter.circle_stroke(centre, 6.0, Stroke::new(1.5, view.theme.muted));
    }
    let figure = rect.with_min_x(centre.x + 14.0);
    let ink = if on { view.theme.text } else { view.theme.muted };
    view.fit_left(figure, if on { "1" } else { "0" }, theme::LABEL, ink);
}

/// Paints a bar filled to a share of its width, per mille.
pub fn progress_bar(view: &View<'_>, bar: Rect, share: u16) {
    view.painter.rect_filled(bar, theme::RADIUS, view.theme.line);
    let done = bar.split_left(bar.width() * f32::from(share) / 1_000.0).0;
    view.painter.rect_filled(done, theme::RADIUS, view.theme.focus);
}

/// Draws the header of a table: small text over a hairline.
pub fn table_header<const N: usize>(view: &View<'_>, line: Rect, shares: [f32; N], words: [&str; N]) {
    for (place, word) in line.columns(shares).into_iter().zip(words) {
        view.fit_left(place, word, theme::SMALL, view.theme.muted);
    }
    view.hairline(line, line.max.y - 0.5);
}

/// The rectangle of a list, reduced to whole lines so that no line is cut when the list is at rest.
pub fn round_to_lines(rect: Rect, line: f32) -> Rect {
    rect.band(0.0, (rect.height() / line).floor().max(1.0) * line)
}
