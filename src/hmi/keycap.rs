//! Draws a key: lamp, pictogram, label, lock. No state is shown by colour alone.
//! Source: spec H3. Off · on (lit bar, bright) · working (half bar blinks) · blocked (dim, lock) · pressed (inset).

use std::fmt::Debug;
use std::hash::Hash;

use egui::{Color32, CornerRadius, Rect, Response, Stroke, StrokeKind, pos2, vec2};

use super::pictogram::{self, PictogramShape};
use super::theme::{self, Theme};
use super::{Area, View};
use crate::defs::key::{Key, KeyGroup, Lamp};

/// The visible state of a key.
#[derive(Clone, Copy, Debug, Default)]
pub struct KeycapState {
    /// Lamp on.
    pub on: bool,
    /// The feedback is still missing.
    pub pending: bool,
    /// Pressing it would be refused.
    pub blocked: bool,
    /// The finger is on it.
    pub pressed: bool,
}

/// The accessible name of a key, for screen readers and tests.
pub fn accessible_name(key: Key, lang: crate::defs::text::Lang) -> String {
    format!("{} {}", key.label().get(lang), key.id())
}

/// A key and how it looks now.
#[derive(Clone, Copy, Debug)]
pub struct Keycap {
    /// The key.
    pub key: Key,
    /// Its visible state.
    pub state: KeycapState,
    /// Its pictogram; empty for keys labelled with a number or letter.
    pub shapes: &'static [PictogramShape],
}

/// Draws a key of the panel.
pub fn paint(view: &View<'_>, rect: Rect, keycap: Keycap) {
    match keycap.key {
        Key::CycleStart | Key::FeedHold => paint_run_key(view, rect, keycap),
        Key::EmergencyStop => paint_emergency_stop(view, rect, keycap.state),
        _ => paint_standard(view, rect, keycap),
    }
}

fn paint_standard(view: &View<'_>, rect: Rect, keycap: Keycap) {
    let (theme, Keycap { key, state: face, shapes: marks }) = (view.theme, keycap);
    paint_body(view, rect, face);
    let body = if face.pressed { rect.translate(vec2(0.0, 1.5)) } else { rect };
    let ink = label_colour(theme, face);
    let has_lamp = key.row().lamp != Lamp::None;
    if has_lamp {
        paint_lamp(view, rect, face, lamp_colour(theme, key));
    }
    let inner = body.trim_sides(2.0);
    let short = key.short_label(view.snapshot.kind).get(view.lang);
    let elided = view.layout_line(short, theme::SMALL, ink, inner.width()).elided;
    let text = if elided { key.narrow_label(view.snapshot.kind).get(view.lang) } else { short };
    if text.is_empty() {
        pictogram::draw(&view.painter, Rect::from_center_size(body.center(), vec2(24.0, 24.0)), marks, ink);
    } else if marks.is_empty() {
        let size = if matches!(key.row().group, KeyGroup::Override) { theme::SECONDARY } else { theme::LABEL };
        let size = if text.chars().count() <= 1 { theme::SECONDARY } else { size.min(theme::LABEL) };
        // Below the lamp and the lock.
        let down = if has_lamp { 2.0 } else { 0.0 } + if face.blocked { 6.0 } else { 0.0 };
        let below = inner.translate(vec2(0.0, down));
        view.fit_centre(below, text, size, ink);
    } else {
        let picture = (rect.height() * 0.40).min(26.0);
        let top = body.min.y + if has_lamp { 7.0 } else { 5.0 } + (rect.height() - 44.0).max(0.0) * 0.2;
        let square = Rect::from_center_size(pos2(body.center().x, top + picture / 2.0), vec2(picture, picture));
        pictogram::draw(&view.painter, square, marks, ink);
        let bottom = Rect::from_min_max(pos2(inner.min.x, square.max.y - 1.0), pos2(inner.max.x, body.max.y - 2.0));
        view.fit_centre(bottom, text, theme::LABEL, ink);
    }
    if face.blocked {
        let corner = Rect::from_min_size(pos2(body.max.x - 13.0, body.min.y + 7.0), vec2(10.0, 10.0));
        pictogram::draw(&view.painter, corner, pictogram::LOCK, theme.disabled);
    }
}

/// The colour of text and pictogram.
fn label_colour(theme: &Theme, face: KeycapState) -> Color32 {
    if face.blocked && !face.on {
        theme.disabled
    } else if face.on || face.pending {
        theme.text
    } else {
        theme.muted
    }
}

/// Lamps of outputs are green; lamps of selections (mode, switch, step) are cyan.
fn lamp_colour(theme: &Theme, key: Key) -> Color32 {
    match key.row().lamp {
        Lamp::Output(_) => theme.run,
        Lamp::None | Lamp::OutputOff(_) | Lamp::Control => match key {
            Key::Oscillation | Key::DressReturn | Key::WheelRetract => theme.run,
            Key::MachineLock | Key::AuxFunctionLock | Key::DryRun => theme.hold,
            _ => theme.info,
        },
    }
}

/// Paints the body of a key: raised, or inset while the finger is on it.
pub fn paint_body(view: &View<'_>, rect: Rect, face: KeycapState) {
    let theme = view.theme;
    if face.pressed {
        view.filled_card(rect, theme.background, theme.focus);
        view.outline(rect.shrink(1.0), theme.line);
    } else {
        view.filled_card(rect, if face.blocked { theme.background } else { theme.raised }, theme.line);
    }
}

/// Marks the key that comes next in the start guide; cycle start, which ends it, steadily.
pub fn mark_next(view: &View<'_>, rect: Rect, key: Key) {
    let (colour, lit) = match key {
        Key::CycleStart => (view.theme.run, true),
        _ => (view.theme.hold, view.blink),
    };
    let width = if lit { 3.0 } else { theme::HAIRLINE };
    view.painter.rect_stroke(
        rect.shrink(1.0),
        CornerRadius::same(theme::RADIUS as u8),
        Stroke::new(width, colour),
        StrokeKind::Inside,
    );
}

/// Draws the body of a key without a lamp and takes its touches.
pub fn plain(view: &View<'_>, rect: Rect, id: impl Hash + Debug, name: impl ToString) -> Response {
    let response = view.touch(rect, id, name);
    plate(view, rect, &response);
    response
}

/// Paints the body of a key without a lamp, as it is touched now.
pub fn plate(view: &View<'_>, rect: Rect, response: &Response) {
    let pressed = response.is_pointer_button_down_on();
    paint_body(view, rect, KeycapState { pressed, ..KeycapState::default() });
}

/// Paints the body of a value that P6.3 locks in a run, as it is touched now (K7.7).
pub fn field(view: &View<'_>, rect: Rect, response: &Response) {
    let (pressed, blocked) = (response.is_pointer_button_down_on(), view.snapshot.values_locked());
    paint_body(view, rect, KeycapState { pressed, blocked, ..KeycapState::default() });
}

fn paint_lamp(view: &View<'_>, rect: Rect, face: KeycapState, colour: Color32) {
    let bar = Rect::from_min_size(rect.min + vec2(5.0, 3.0), vec2(rect.width() - 10.0, 3.0));
    let radius = CornerRadius::same(1);
    view.painter.rect_filled(bar, radius, view.theme.line);
    if face.pending {
        if view.blink {
            let half = Rect::from_center_size(bar.center(), vec2(bar.width() / 2.0, bar.height()));
            view.painter.rect_filled(half, radius, colour);
        }
    } else if face.on {
        view.painter.rect_filled(bar, radius, colour);
    }
}

/// Paints cycle start or feed hold: large, framed in its colour, filled with it while lit.
fn paint_run_key(view: &View<'_>, rect: Rect, keycap: Keycap) {
    let (theme, Keycap { key, state: face, shapes }) = (view.theme, keycap);
    let colour = if key == Key::CycleStart { theme.run } else { theme.hold };
    let radius = CornerRadius::same(2 * theme::RADIUS as u8);
    let lit = face.on && (!face.pending || view.blink);
    let fill = if lit { colour } else { theme.raised };
    let fill = if face.pressed { theme.background } else { fill };
    view.painter.rect(rect, radius, fill, Stroke::new(theme::FRAME, colour), StrokeKind::Inside);
    let ink = if lit && !face.pressed { theme.on_accent } else { colour };
    let ink = if face.blocked && !lit { theme.disabled } else { ink };
    let body = if face.pressed { rect.translate(vec2(0.0, 2.0)) } else { rect };
    let size = (rect.height() * 0.36).min(34.0);
    let centre = pos2(body.center().x, body.min.y + rect.height() * 0.36);
    pictogram::draw(&view.painter, Rect::from_center_size(centre, vec2(size, size)), shapes, ink);
    let below =
        Rect::from_min_max(pos2(body.min.x + 3.0, centre.y + size / 2.0), pos2(body.max.x - 3.0, body.max.y - 4.0));
    view.fit_centre(below, key.label().get(view.lang), theme::LABEL, ink);
    if face.blocked {
        let corner = Rect::from_min_size(pos2(body.max.x - 18.0, body.min.y + 6.0), vec2(12.0, 12.0));
        pictogram::draw(&view.painter, corner, pictogram::LOCK, theme.disabled);
    }
}

/// Paints the emergency stop: a red mushroom button on yellow, pushed in while it is active.
fn paint_emergency_stop(view: &View<'_>, rect: Rect, face: KeycapState) {
    let theme = view.theme;
    view.painter.rect_filled(rect, CornerRadius::same(2 * theme::RADIUS as u8), theme.stop_background);
    let centre = pos2(rect.center().x, rect.min.y + rect.height() * 0.41);
    let pushed = face.pressed || face.on;
    let outer = (rect.height() * 0.34).min(rect.width() * 0.42);
    view.painter.circle_filled(centre, outer, theme.stop_text);
    view.painter.circle_filled(centre, if pushed { outer - 6.0 } else { outer - 1.5 }, theme.alarm);
    let groove = Stroke::new(theme::FRAME, theme.stop_text.gamma_multiply(0.35));
    view.painter.circle_stroke(centre, (outer - 9.0).max(3.0), groove);
    if face.on && view.blink {
        view.painter.circle_stroke(centre, outer + 2.5, Stroke::new(3.0, theme.alarm));
    }
    let below = Rect::from_min_max(pos2(rect.min.x + 2.0, centre.y + outer), rect.max - vec2(2.0, 1.0));
    view.fit_centre(below, Key::EmergencyStop.label().get(view.lang), theme::LABEL, theme.stop_text);
}
