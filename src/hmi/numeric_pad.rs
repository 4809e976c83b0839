//! The numeric pad over the lower part of the panel while a value is typed.
//! Source: spec H6. It never covers cycle start, feed hold, reset or the emergency stop.

use egui::{Id, Rect, Sense, vec2};

use super::{EditKey, View, keycap, theme};
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

/// How long the place of a pad that has closed takes no touch, s: a double tap must not reach the machine keys there.
pub const COVERED_S: f64 = 0.6;

/// The whole area takes touches: nothing beneath can be pressed through a gap, nor by the second tap on a key that
/// closed the pad.
pub fn cover(view: &View<'_>, rect: Rect) {
    view.ui.interact(rect, Id::unique("pad"), Sense::CLICK | Sense::DRAG);
}

/// Draws the pad; appends the touched keys to `edits`.
pub fn ui(view: &View<'_>, rect: Rect, edits: &mut Vec<EditKey>) {
    cover(view, rect);
    view.filled_card(rect.expand(2.0), view.theme.surface, view.theme.focus);
    let inside = rect.shrink(4.0);
    let unit = vec2((inside.width() - 9.0) / 4.0, (inside.height() - 9.0) / 4.0);
    for PadKey(label, name, column, row, rows, edit) in &KEYS {
        let corner = inside.min + vec2(f32::from(*column) * (unit.x + 3.0), f32::from(*row) * (unit.y + 3.0));
        let height = unit.y * f32::from(*rows) + 3.0 * f32::from(*rows - 1);
        let place = Rect::from_min_size(corner, vec2(unit.x, height));
        let response = keycap::plain(view, place, ("pad", *name), name);
        let digit = matches!(edit, EditKey::Char(_) | EditKey::Sign);
        let size = if digit { theme::SECONDARY + 4.0 } else { theme::TITLE };
        let ink = if *edit == EditKey::Enter { view.theme.info } else { view.theme.text };
        view.fit_centre(place.shrink(3.0), label.get(view.lang), size, ink);
        if response.clicked() {
            edits.push(*edit);
        }
    }
}
