//! The numeric pad while a value is typed: a sheet over the page, beside the field. It covers no key of the panel.
//! Source: spec H6.

use egui::{Id, Rect, Sense, Vec2, pos2, vec2};

use super::{Area, EditKey, View, keycap, theme};
use crate::defs::text::Text;

/// One key: label, accessible name, column, row, height in rows, edit key.
struct PadKey(Text, &'static str, u8, u8, u8, EditKey);

const fn digit(sign: &'static str, name: &'static str, column: u8, row: u8, value: char) -> PadKey {
    PadKey(Text::new(sign, sign), name, column, row, 1, EditKey::Char(value))
}

const KEYS: [PadKey; 15] = [
    digit("7", "pad-7", 0, 0, '7'),
    digit("8", "pad-8", 1, 0, '8'),
    digit("9", "pad-9", 2, 0, '9'),
    PadKey(Text::new("退格", "DEL"), "pad-back", 3, 0, 1, EditKey::Backspace),
    digit("4", "pad-4", 0, 1, '4'),
    digit("5", "pad-5", 1, 1, '5'),
    digit("6", "pad-6", 2, 1, '6'),
    PadKey(Text::new("取消", "CANCEL"), "取消 cancel", 3, 1, 1, EditKey::Cancel),
    digit("1", "pad-1", 0, 2, '1'),
    digit("2", "pad-2", 1, 2, '2'),
    digit("3", "pad-3", 2, 2, '3'),
    PadKey(Text::new("输入", "INPUT"), "输入 input", 3, 2, 2, EditKey::Enter),
    PadKey(Text::new("-/+", "-/+"), "pad-sign", 0, 3, 1, EditKey::Sign),
    digit("0", "pad-0", 1, 3, '0'),
    digit(".", "pad-point", 2, 3, '.'),
];

/// Size of a key with its gap, points.
const KEY: Vec2 = vec2(61.0, 55.0);
const KEY_GAP: f32 = 3.0;
const MARGIN: f32 = 5.0;
/// Size of the pad: four columns, four rows.
const SIZE: Vec2 = vec2(4.0 * KEY.x - KEY_GAP + 2.0 * MARGIN, 4.0 * KEY.y - KEY_GAP + 2.0 * MARGIN);

/// How long the place of a pad that has closed takes no touch, s: a double tap on 取消 must not reach the page there.
pub const COVERED_S: f64 = 0.6;

/// The pad between frames.
#[derive(Debug, Default)]
pub struct NumericPad {
    place: Option<Rect>,
    /// When it was last drawn open, s.
    drawn_at: Option<f64>,
    touched: Vec<EditKey>,
}

impl NumericPad {
    /// The keys touched in the frame before: the pad is drawn last, above the page that takes them.
    pub fn take_touched(&mut self) -> Vec<EditKey> {
        std::mem::take(&mut self.touched)
    }

    /// Draws the pad over the page if it is `open`; covers its place for a moment after it has closed.
    pub fn ui(&mut self, view: &View<'_>, content: Rect, open: bool) {
        let now = view.ui.input(|input| input.time);
        if open {
            let rect = free_place(self.place, content, view.entry.get());
            (self.place, self.drawn_at) = (Some(rect), Some(now));
            draw(view, rect, &mut self.touched);
            if !self.touched.is_empty() {
                view.ui.ctx().request_repaint();
            }
            return;
        }
        match self.place {
            Some(rect) if self.drawn_at.is_some_and(|at| now - at < COVERED_S) => cover(view, rect),
            _ => self.place = None,
        }
    }
}

/// Where the pad leaves the field free: where it was, or a corner of the page above its input line. The lower ones come
/// first, the right one before the left one.
fn free_place(last: Option<Rect>, content: Rect, entry: Option<Rect>) -> Rect {
    let room = content.trim_bottom(theme::INPUT).shrink(theme::GAP);
    let (right, bottom) = (room.max.x - SIZE.x, room.max.y - SIZE.y);
    let corners = [(right, bottom), (room.min.x, bottom), (right, room.min.y), (room.min.x, room.min.y)]
        .map(|(x, y)| Rect::from_min_size(pos2(x, y), SIZE));
    let is_free = |rect: &Rect| entry.is_none_or(|entry| !entry.shrink(1.0).intersects(*rect));
    last.filter(|rect| room.contains_rect(*rect)).into_iter().chain(corners).find(is_free).unwrap_or(corners[0])
}

/// The whole area takes touches: nothing beneath can be pressed through a gap.
fn cover(view: &View<'_>, rect: Rect) {
    view.ui.interact(rect, Id::unique("pad"), Sense::CLICK | Sense::DRAG);
}

fn draw(view: &View<'_>, rect: Rect, touched: &mut Vec<EditKey>) {
    cover(view, rect);
    view.filled_card(rect, view.theme.surface, view.theme.focus);
    let inside = rect.shrink(MARGIN);
    for PadKey(label, name, column, row, rows, edit) in &KEYS {
        let corner = inside.min + vec2(f32::from(*column) * KEY.x, f32::from(*row) * KEY.y);
        let size = vec2(KEY.x, KEY.y * f32::from(*rows)) - Vec2::splat(KEY_GAP);
        let place = Rect::from_min_size(corner, size);
        let response = keycap::plain(view, place, ("pad", *name), name);
        let digit = matches!(edit, EditKey::Char(_) | EditKey::Sign);
        let size = if digit { theme::SECONDARY + 4.0 } else { theme::TITLE };
        let ink = if *edit == EditKey::Enter { view.theme.info } else { view.theme.text };
        view.fit_centre(place.shrink(3.0), label.get(view.lang), size, ink);
        if response.clicked() {
            touched.push(*edit);
        }
    }
}
