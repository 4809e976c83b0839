//! Draws the row of soft keys and handles its touches.
//! Source: spec K7.1, K7.2.

use egui::{Rect, vec2};

use super::{Area, View, keycap, theme, widget};
use crate::defs::soft_key::{self, SoftKey, SoftKeyAction};

/// Width of the key ▶, points.
const NEXT_WIDTH: f32 = 52.0;

/// Which soft key was pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoftKeyPress {
    /// One of F1–F5.
    Act(SoftKeyAction),
    /// ▶
    Next,
}

/// Number of soft key rows of this machine.
pub const fn row_count(view: &View<'_>) -> usize {
    soft_key::row_count(view.snapshot.simulated.is_some())
}

/// Draws a row; `chosen` tells whether the page of a key is the open one.
pub fn ui(view: &View<'_>, rect: Rect, row: usize, chosen: impl Fn(SoftKeyAction) -> bool) -> Option<SoftKeyPress> {
    let mut pressed = None;
    let (keys, next) = rect.shrink2(vec2(theme::GAP, 3.0)).split_right(NEXT_WIDTH);
    for (index, soft) in soft_key::row(view.snapshot.kind, row).enumerate() {
        if soft_key_ui(view, keys.trim_right(theme::GAP).cell(index, 5), index, soft, chosen(soft.action)) {
            pressed = Some(SoftKeyPress::Act(soft.action));
        }
    }
    let response = keycap::plain(view, next, "soft-next", "▶ next-row");
    let (sign, count) = next.split_top_bottom_at_fraction(0.6);
    view.line_centre(sign, "▶", theme::TITLE, view.theme.text);
    view.line_centre(count, &format!("{}/{}", row + 1, row_count(view)), theme::SMALL, view.theme.muted);
    if response.clicked() { Some(SoftKeyPress::Next) } else { pressed }
}

fn soft_key_ui(view: &View<'_>, place: Rect, index: usize, soft: &SoftKey, chosen: bool) -> bool {
    let (key, label) = (format!("F{}", index + 1), soft.label_on(view.snapshot.kind).get(view.lang));
    let response = view.touch_row(place, ("soft", &key), chosen, format!("{label} f{}", index + 1));
    keycap::plate(view, place, &response);
    let ink = if chosen { view.theme.info } else { view.theme.text };
    let tag = Rect::from_min_size(place.min + vec2(7.0, 3.0), vec2(30.0, 16.0));
    view.line_left(tag, &key, theme::SMALL, view.theme.muted);
    view.fit_centre(place.trim_sides(4.0).trim_top(16.0).trim_bottom(2.0), label, theme::TITLE, ink);
    if chosen {
        widget::selected_bar(view, place);
    }
    response.clicked()
}
