//! The operator panel: all keys of the kind with their lamps, the overrides, the handwheel.
//! Source: spec K2, H2, H3.

pub mod layout;

use egui::accesskit::Role;
use egui::{Id, Rect, Sense, WidgetInfo, vec2};

use self::layout::PanelLayout;
use crate::defs::key::Key;
use crate::defs::text::Text;
use crate::hmi::key_press::{self, KeyPresses};
use crate::hmi::keycap::{self, Keycap};
use crate::hmi::page::start_strip;
use crate::hmi::pictogram::{self, PictogramShape};
use crate::hmi::{Area, KeycapState, View, theme, widget};
use crate::link::Command;
use crate::link::snapshot::KeyView;
use crate::units::Axis;

/// Drag distance per handwheel detent, points.
const DETENT: f32 = 10.0;

/// The keys beside the page, and the state of the on-screen handwheel between frames, points.
#[derive(Debug, Default)]
pub struct OperatorPanel {
    drag_points: f32,
    rib_offset: f32,
}

impl OperatorPanel {
    /// Draws the panel and handles touches; returns why the key that was just pressed is blocked, if it is.
    pub fn ui(
        &mut self,
        layout: &PanelLayout,
        view: &View<'_>,
        presses: &mut KeyPresses,
        out: &mut Vec<Command>,
    ) -> Option<Text> {
        for group in &layout.groups {
            view.filled_card(group.frame, view.theme.background, view.theme.line);
            if let Some((rect, text)) = &group.caption {
                view.fit_left(
                    rect.trim_sides(if rect.width() < 52.0 { 1.0 } else { 4.0 }),
                    text.get(view.lang),
                    theme::SMALL,
                    view.theme.muted,
                );
            }
        }
        override_value(view, layout.feed_value, view.text("进给", "FEED"), view.snapshot.overrides.feed);
        override_value(view, layout.spindle_value, view.text("主轴", "SPIN"), view.snapshot.overrides.spindle);
        let mut reason = None;
        for (key, rect) in &layout.keys {
            let Some(rect) = visible_rect(layout, view, *key, *rect) else { continue };
            reason = reason.or(key_ui(view, *key, rect, presses, out));
        }
        self.handwheel(view, layout.handwheel, out);
        reason
    }

    /// Draws a thumb wheel, turned by drag or scroll; one command carries all detents of a frame.
    fn handwheel(&mut self, view: &View<'_>, rect: Rect, out: &mut Vec<Command>) {
        let response = view.ui.interact(rect, Id::unique("handwheel"), Sense::DRAG | Sense::HOVER);
        // The step is shown without trailing zeros.
        let step = format!("{:.3}", view.snapshot.handwheel.step_mm);
        let step = step.trim_end_matches('0').trim_end_matches('.');
        let text = format!("{} {} ×{step}", view.text("手轮", "HANDWHEEL"), view.snapshot.handwheel.axis);
        let name = view.text("手轮 handwheel", "handwheel handwheel");
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
        let dragged = widget::drag_delta(&response).x;
        self.drag_points += dragged;
        self.rib_offset = (self.rib_offset + dragged).rem_euclid(DETENT);
        if response.hovered() {
            let scroll = view.ui.input(|input| input.smooth_scroll_delta());
            self.drag_points += (scroll.y + scroll.x) * 0.5;
            self.rib_offset = (self.rib_offset + (scroll.y + scroll.x) * 0.5).rem_euclid(DETENT);
        }
        if response.drag_stopped() {
            self.drag_points = 0.0;
        }
        let detents = (self.drag_points / DETENT).trunc();
        if detents.abs() >= 1.0 {
            self.drag_points -= detents * DETENT;
            out.push(Command::Handwheel(detents as i32));
        }
        self.paint_wheel(view, rect, &text);
    }

    fn paint_wheel(&self, view: &View<'_>, rect: Rect, text: &str) {
        let active = view.snapshot.mode == crate::defs::key::Mode::Handwheel;
        let view = &view.clipped(rect);
        view.filled_card(rect, view.theme.surface, if active { view.theme.info } else { view.theme.line });
        let (words, ribs) = rect.shrink2(vec2(6.0, 3.0)).split_top_bottom_at_fraction(0.5);
        view.fit_centre(words, text, theme::LABEL, if active { view.theme.text } else { view.theme.muted });
        let ribs = ribs.shrink2(vec2(0.0, 2.0));
        let half = ribs.width() / 2.0;
        let mut x = ribs.min.x + self.rib_offset;
        while x < ribs.max.x {
            // Ribs of a wheel: shorter towards its sides.
            let out_there = ((x - ribs.center().x) / half).abs();
            let reach = ribs.height() / 2.0 * (1.0 - 0.6 * out_there * out_there);
            let rib = ribs.center().y - reach..=ribs.center().y + reach;
            view.painter.vline(x, rib, egui::Stroke::new(2.0, view.theme.muted));
            x += DETENT;
        }
    }
}

fn override_value(view: &View<'_>, rect: Rect, name: &str, percent: u16) {
    let (top, bottom) = rect.split_top_bottom_at_fraction(0.46);
    view.line_centre(top, name, theme::SMALL, view.theme.muted);
    view.fit_centre(bottom, &percent.to_string(), theme::TITLE, view.theme.text);
}

/// The axis of a panel key.
const fn axis_of(key: Key) -> Option<Axis> {
    match key {
        Key::HandwheelX | Key::XPlus | Key::XMinus => Some(Axis::X),
        Key::HandwheelY | Key::YPlus | Key::YMinus => Some(Axis::Y),
        Key::HandwheelZ | Key::ZPlus | Key::ZMinus => Some(Axis::Z),
        _ => None,
    }
}

/// Where a key is painted; none for an axis that the machine does not have. Without Y, the handwheel keys X and Z share
/// the height of three keys.
fn visible_rect(layout: &PanelLayout, view: &View<'_>, key: Key, rect: Rect) -> Option<Rect> {
    let present = |axis: Axis| view.snapshot.axes[axis].present;
    if axis_of(key).is_some_and(|axis| !present(axis)) {
        return None;
    }
    if present(Axis::Y) {
        return Some(rect);
    }
    let of = |key: Key| layout.keys.iter().find(|(found, _)| *found == key).map(|(_, rect)| *rect);
    let (Some(x), Some(y), Some(z)) = (of(Key::HandwheelX), of(Key::HandwheelY), of(Key::HandwheelZ)) else {
        return Some(rect);
    };
    let half_gap = (y.min.y - x.max.y) / 2.0;
    Some(match key {
        Key::HandwheelX => Rect::from_min_max(x.min, egui::pos2(x.max.x, y.center().y - half_gap)),
        Key::HandwheelZ => Rect::from_min_max(egui::pos2(z.min.x, y.center().y + half_gap), z.max),
        _ => rect,
    })
}

/// The state of a key on the panel; keys of an axis that the machine does not have are blocked.
#[must_use]
pub fn key_state(view: &View<'_>, key: Key) -> KeyView {
    let mut state = view.snapshot.key(key);
    let axis = axis_of(key);
    if axis.is_some_and(|axis| !view.snapshot.axes[axis].present) && state.blocked.is_none() {
        state.blocked = Some(Text::new("机床没有这个轴", "the machine does not have this axis"));
    }
    state
}

/// Draws one key and handles its touches. Returns the reason if a blocked key was pressed.
pub fn key_ui(view: &View<'_>, key: Key, rect: Rect, presses: &mut KeyPresses, out: &mut Vec<Command>) -> Option<Text> {
    // Senses drag as well as click: egui drops a click after 0.8 s, but a jog key is held for minutes.
    let response = view.ui.interact(rect, Id::unique(("key", key as u8)), Sense::CLICK | Sense::DRAG);
    let state = key_state(view, key);
    let name = || keycap::accessible_name(key, view.lang);
    response.widget_info(|| WidgetInfo::selected(Role::Button, state.blocked.is_none(), state.lamp, name()));
    if key_press::is_explained(key, state.lamp) {
        presses.explain_long(view.ui.input(|input| input.time), key);
    }
    let before = out.len();
    let touched = rect.intersect(view.ui.clip_rect());
    let pressed = presses.track_touch(view.ui, &response, touched, key, out) || presses.is_down(key);
    let face = KeycapState { on: state.lamp, pending: state.pending, blocked: state.blocked.is_some(), pressed };
    keycap::paint(view, rect, Keycap { key, state: face, shapes: key_shapes(view, key) });
    if start_strip::marked_key(view.snapshot) == Some(key) {
        keycap::mark_next(view, rect, key);
    }
    let asked = out[before..].iter().any(|command| matches!(command, Command::Press(_)));
    state.blocked.filter(|_| asked)
}

fn key_shapes(view: &View<'_>, key: Key) -> &'static [PictogramShape] {
    use PictogramShape::{ArrowHead, Line};
    const UP: &[PictogramShape] = &[Line(&[(12.0, 20.0), (12.0, 8.0)]), ArrowHead(12.0, 2.0, -90.0)];
    const DOWN: &[PictogramShape] = &[Line(&[(12.0, 4.0), (12.0, 16.0)]), ArrowHead(12.0, 22.0, 90.0)];
    const LEFT: &[PictogramShape] = &[Line(&[(20.0, 12.0), (8.0, 12.0)]), ArrowHead(2.0, 12.0, 180.0)];
    const RIGHT: &[PictogramShape] = &[Line(&[(4.0, 12.0), (16.0, 12.0)]), ArrowHead(22.0, 12.0, 0.0)];
    const AWAY: &[PictogramShape] = &[Line(&[(5.0, 19.0), (15.0, 9.0)]), ArrowHead(20.0, 4.0, -45.0)];
    const NEAR: &[PictogramShape] = &[Line(&[(19.0, 5.0), (9.0, 15.0)]), ArrowHead(4.0, 20.0, 135.0)];
    if key.jog_direction().is_none() {
        return match key {
            Key::RapidF0 | Key::Rapid25 | Key::Rapid50 | Key::Rapid100 => &[],
            _ => pictogram::for_key(key),
        };
    }
    let place = layout::jog_positions(view.snapshot.kind).into_iter().find(|(other, ..)| *other == key);
    match place {
        Some((_, 0, 1)) => LEFT,
        Some((_, 2, 1)) => RIGHT,
        Some((_, 2, 0)) => AWAY,
        Some((_, 0, 2)) => NEAR,
        Some((_, _, 0)) => UP,
        _ => DOWN,
    }
}
