//! Draws the row of soft keys and handles its touches.
//! Source: spec K7.1, K7.2.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::keycap::{self, KeycapState};
use super::theme;
use super::view::{View, fit_text, text_line};
use crate::defs::soft_key::{self, SoftKey, SoftKeyAction};

/// Which soft key was pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoftKeyPress {
    /// One of F1–F5.
    Act(SoftKeyAction),
    /// ▶
    Next,
}

/// Number of soft key rows of this machine.
#[must_use]
pub const fn row_count(view: &View<'_>) -> usize {
    soft_key::row_count(view.snapshot.simulated.is_some())
}

fn label(soft: &SoftKey, view: &View<'_>) -> &'static str {
    soft.label_on(view.snapshot.kind).get(view.lang)
}

/// Draws a row; `chosen` tells whether the page of a key is the open one.
pub fn ui(
    ui: &Ui,
    view: &View<'_>,
    rect: Rect,
    row: usize,
    chosen: impl Fn(SoftKeyAction) -> bool,
) -> Option<SoftKeyPress> {
    let mut pressed = None;
    let inner = rect.shrink2(vec2(theme::GAP, 3.0));
    let next_width = 52.0;
    let width = (inner.width() - next_width - 5.0 * theme::GAP) / 5.0;
    let rows = row_count(view);
    for (index, soft) in soft_key::row(view.snapshot.kind, row).enumerate() {
        let left = inner.min.x + index as f32 * (width + theme::GAP);
        let place = Rect::from_min_size(pos2(left, inner.min.y), vec2(width, inner.height()));
        let name = format!("F{}", index + 1);
        if soft_key_ui(ui, view, place, &SoftKeyView { name: &name, soft, chosen: chosen(soft.action) }) {
            pressed = Some(SoftKeyPress::Act(soft.action));
        }
    }
    let place = Rect::from_min_max(pos2(inner.max.x - next_width, inner.min.y), inner.max);
    let response = ui.interact(place, Id::unique("soft-next"), Sense::CLICK);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, "▶ next-row"));
    let face = KeycapState { pressed: response.is_pointer_button_down_on(), ..KeycapState::default() };
    keycap::paint_body(ui.painter(), view.theme, place, face);
    let (sign, count) = place.split_top_bottom_at_fraction(0.6);
    text_line(ui.painter(), sign, Align2::CENTER_CENTER, "▶", theme::TITLE, view.theme.text);
    let which = format!("{}/{}", row + 1, rows);
    text_line(ui.painter(), count, Align2::CENTER_CENTER, &which, theme::SMALL, view.theme.muted);
    if response.clicked() { Some(SoftKeyPress::Next) } else { pressed }
}

/// A soft key as it is shown.
struct SoftKeyView<'a> {
    /// `F1` to `F5`.
    name: &'a str,
    soft: &'a SoftKey,
    /// Its page is open.
    chosen: bool,
}

fn soft_key_ui(ui: &Ui, view: &View<'_>, place: Rect, key: &SoftKeyView<'_>) -> bool {
    let SoftKeyView { name: key, soft, chosen } = *key;
    let response = ui.interact(place, Id::unique(("soft", key)), Sense::CLICK);
    let name = format!("{} {}", label(soft, view), key.to_lowercase());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, &name));
    let face = KeycapState { pressed: response.is_pointer_button_down_on(), ..KeycapState::default() };
    let painter = ui.painter();
    keycap::paint_body(painter, view.theme, place, face);
    let ink = if chosen { view.theme.info } else { view.theme.text };
    let tag = Rect::from_min_size(place.min + vec2(7.0, 3.0), vec2(30.0, 16.0));
    text_line(painter, tag, Align2::LEFT_CENTER, key, theme::SMALL, view.theme.muted);
    let words = Rect::from_min_max(pos2(place.min.x + 4.0, place.min.y + 16.0), place.max - vec2(4.0, 2.0));
    fit_text(painter, words, Align2::CENTER_CENTER, label(soft, view), theme::TITLE, ink);
    if chosen {
        let bar = Rect::from_min_size(pos2(place.min.x + 6.0, place.max.y - 4.0), vec2(place.width() - 12.0, 3.0));
        painter.rect_filled(bar, 1.0, view.theme.info);
    }
    response.clicked()
}
