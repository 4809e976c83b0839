//! The letter pad: words for a search by touch, with the words of the trade ready to be touched.
//! Source: spec B6 (search by number or text), H6.

use egui::{Id, Rect, Sense, Ui, vec2};

use super::theme;
use super::view::{View, card};
use super::widget::{self, Look};
use crate::defs::text::Text;

const ROWS: [&str; 4] = ["1234567890", "QWERTYUIOP", "ASDFGHJKL.", "ZXCVBNM-"];
/// What is searched most, a touch each.
const WORDS: [Text; 9] = [
    Text::new("速度", "speed"),
    Text::new("延时", "delay"),
    Text::new("限位", "limit"),
    Text::new("零点", "home"),
    Text::new("液压", "hydraulic"),
    Text::new("振荡", "oscillation"),
    Text::new("砂轮", "wheel"),
    Text::new("尾座", "tailstock"),
    Text::new("量仪", "gauge"),
];
/// Height of the pad: a row of words and four of letters.
pub const HEIGHT: f32 = 5.0 * ROW + 2.0 * theme::GAP;
const ROW: f32 = 46.0;

/// What was touched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Letter {
    /// One sign more.
    Sign(char),
    /// This word instead.
    Word(&'static str),
    /// One sign less.
    Back,
    /// Enough.
    Done,
}

/// Draws the pad; gives what was touched.
pub fn ui(ui: &Ui, view: &View<'_>, rect: Rect) -> Option<Letter> {
    ui.interact(rect, Id::unique("letters"), Sense::CLICK | Sense::DRAG);
    card(ui.painter(), rect, view.theme.surface, view.theme.focus);
    let inside = rect.shrink(theme::GAP);
    let mut touched = None;
    let cell = |column: f32, row: f32, columns: f32, wide: f32| {
        let width = (inside.width() + 3.0) / columns;
        let corner = inside.min + vec2(column * width, row * ROW);
        Rect::from_min_size(corner, vec2(wide * width - 3.0, ROW - 2.0))
    };
    for (index, word) in WORDS.into_iter().enumerate() {
        let name = format!("word-{}", word.en);
        let place = cell(index as f32, 0.0, WORDS.len() as f32, 1.0);
        if widget::push(ui, view, place, &name, word.get(view.lang), Look::default()) {
            touched = Some(Letter::Word(word.get(view.lang)));
        }
    }
    for (line, signs) in ROWS.into_iter().enumerate() {
        for (index, sign) in signs.chars().enumerate() {
            let place = cell(index as f32, 1.0 + line as f32, 10.0, 1.0);
            let mut label = [0; 4];
            let label = sign.encode_utf8(&mut label);
            if widget::push(ui, view, place, &format!("letter-{sign}"), label, Look::default()) {
                touched = Some(Letter::Sign(sign));
            }
        }
    }
    if widget::push(ui, view, cell(8.0, 4.0, 10.0, 1.0), "letter-back", view.say("退格", "DEL"), Look::default()) {
        touched = Some(Letter::Back);
    }
    if widget::push(ui, view, cell(9.0, 4.0, 10.0, 1.0), "letter-done", view.say("完成", "OK"), Look::default()) {
        touched = Some(Letter::Done);
    }
    touched
}
