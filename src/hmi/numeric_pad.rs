//! The numeric pad while a value is typed: a sheet over the page, beside the field. It covers no key of the panel.
//! Source: spec H6.

use std::fmt::Debug;
use std::hash::Hash;

use egui::{Id, Rect, Sense, Vec2, pos2, vec2};

use super::{EditKey, View, keycap, theme};
use crate::defs::text::Text;

/// One key of the pad.
struct PadKey {
    label: Text,
    /// Accessible name.
    name: &'static str,
    /// Its cells in the wide pad and in the tall one.
    cells: [PadCells; 2],
    edit: EditKey,
}

/// Column, row, columns and rows that a key takes.
struct PadCells(u8, u8, u8, u8);

const fn digit(sign: &'static str, name: &'static str, column: u8, row: u8, value: char) -> PadKey {
    let cells = [PadCells(column, row, 1, 1), PadCells(column, row, 1, 1)];
    PadKey { label: Text::new(sign, sign), name, cells, edit: EditKey::Char(value) }
}

const fn edit(label: Text, name: &'static str, cells: [PadCells; 2], edit: EditKey) -> PadKey {
    PadKey { label, name, cells, edit }
}

/// The digits lie the same way in both forms; the other keys are beside them in the wide one, below them in the tall one.
const KEYS: [PadKey; 15] = [
    digit("7", "pad-7", 0, 0, '7'),
    digit("8", "pad-8", 1, 0, '8'),
    digit("9", "pad-9", 2, 0, '9'),
    edit(Text::new("退格", "DEL"), "pad-back", [PadCells(3, 0, 1, 1), PadCells(0, 4, 1, 1)], EditKey::Backspace),
    digit("4", "pad-4", 0, 1, '4'),
    digit("5", "pad-5", 1, 1, '5'),
    digit("6", "pad-6", 2, 1, '6'),
    edit(Text::new("取消", "CANCEL"), "取消 cancel", [PadCells(3, 1, 1, 1), PadCells(0, 5, 1, 1)], EditKey::Cancel),
    digit("1", "pad-1", 0, 2, '1'),
    digit("2", "pad-2", 1, 2, '2'),
    digit("3", "pad-3", 2, 2, '3'),
    edit(Text::new("输入", "INPUT"), "输入 input", [PadCells(3, 2, 1, 2), PadCells(1, 4, 2, 2)], EditKey::Enter),
    edit(Text::new("-/+", "-/+"), "pad-sign", [PadCells(0, 3, 1, 1), PadCells(0, 3, 1, 1)], EditKey::Sign),
    digit("0", "pad-0", 1, 3, '0'),
    digit(".", "pad-point", 2, 3, '.'),
];

/// Size of a key with its gap, points.
const KEY: Vec2 = vec2(61.0, 55.0);
const KEY_GAP: f32 = 3.0;
const MARGIN: f32 = 5.0;
/// Height of the wide form, points.
pub const HEIGHT: f32 = 4.0 * KEY.y + 2.0 * MARGIN - KEY_GAP;

/// The two forms of the pad: an index into [`PadKey::cells`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PadForm {
    /// Four columns, four rows.
    Wide,
    /// Three columns, six rows: for a narrow column of the page.
    Tall,
}

impl PadForm {
    /// The form that fits into a column of the page.
    fn that_fits(room: Rect) -> Self {
        if room.width() < Self::Wide.size(room).x { Self::Tall } else { Self::Wide }
    }

    /// Columns and rows.
    const fn cells(self) -> Vec2 {
        match self {
            Self::Wide => vec2(4.0, 4.0),
            Self::Tall => vec2(3.0, 6.0),
        }
    }

    /// Size of a key with its gap: the tall form takes the whole width of its column, so that nothing beside it is left.
    fn key(self, room: Rect) -> Vec2 {
        match self {
            Self::Wide => KEY,
            Self::Tall => vec2((room.width() - 2.0 * MARGIN + KEY_GAP) / self.cells().x, KEY.y),
        }
    }

    fn size(self, room: Rect) -> Vec2 {
        self.cells() * self.key(room) + Vec2::splat(2.0 * MARGIN - KEY_GAP)
    }
}

/// How long a place that the pad has left takes no touch, s: a double tap on 取消 must not reach the page there.
pub const COVERED_S: f64 = 0.6;

/// The pad between frames.
#[derive(Debug, Default)]
pub struct NumericPad {
    /// Where it is open.
    place: Option<Rect>,
    /// The places that it left, and when, s.
    left: Vec<(Rect, f64)>,
    touched: Vec<EditKey>,
}

impl NumericPad {
    /// The keys touched in the frame before: the pad is drawn last, above the page that takes them.
    pub fn take_touched(&mut self) -> Vec<EditKey> {
        std::mem::take(&mut self.touched)
    }

    /// Draws the pad in the `room` that the page has for it, while it `is_open`. A place that it has left takes no touch
    /// for a moment.
    pub fn ui(&mut self, view: &View<'_>, room: Rect, is_open: bool) {
        let now = view.ui.input(|input| input.time);
        let place = is_open.then(|| free_place(self.place, room, view.entry.get()));
        self.left.extend(self.place.filter(|_| self.place != place).map(|before| (before, now)));
        self.left.retain(|(_, since)| now - since < COVERED_S);
        for (index, (rect, _)) in self.left.iter().enumerate() {
            cover(view, *rect, ("left-by-pad", index));
        }
        self.place = place;
        let Some(rect) = place else { return };
        draw(view, rect, room, &mut self.touched);
        if !self.touched.is_empty() {
            view.ui.ctx().request_repaint();
        }
    }
}

/// Where the pad leaves the field free: where it was, or a corner of the room. The lower ones come first, the right one
/// before the left one.
fn free_place(last: Option<Rect>, room: Rect, entry: Option<Rect>) -> Rect {
    let size = PadForm::that_fits(room).size(room);
    let (right, bottom) = ((room.max.x - size.x).max(room.min.x), (room.max.y - size.y).max(room.min.y));
    let corners = [(right, bottom), (room.min.x, bottom), (right, room.min.y), (room.min.x, room.min.y)]
        .map(|(x, y)| Rect::from_min_size(pos2(x, y), size));
    let is_free = |rect: &Rect| entry.is_none_or(|entry| !entry.shrink(1.0).intersects(*rect));
    let last = last.filter(|rect| rect.size() == size && room.expand(0.1).contains_rect(*rect));
    last.into_iter().chain(corners).find(is_free).unwrap_or(corners[0])
}

/// The whole area takes touches: nothing beneath can be pressed through a gap.
pub fn cover(view: &View<'_>, rect: Rect, id: impl Hash + Debug) {
    view.ui.interact(rect, Id::unique(id), Sense::CLICK | Sense::DRAG);
}

fn draw(view: &View<'_>, rect: Rect, room: Rect, touched: &mut Vec<EditKey>) {
    let form = PadForm::that_fits(room);
    let key = form.key(room);
    cover(view, rect, "pad");
    view.filled_card(rect, view.theme.surface, view.theme.focus);
    let inside = rect.shrink(MARGIN);
    for PadKey { label, name, cells, edit } in &KEYS {
        let PadCells(column, row, columns, rows) = cells[form as usize];
        let corner = inside.min + vec2(f32::from(column), f32::from(row)) * key;
        let size = vec2(f32::from(columns), f32::from(rows)) * key - Vec2::splat(KEY_GAP);
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
