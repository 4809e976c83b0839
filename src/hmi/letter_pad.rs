//! The letter pads: touch input of search words and program blocks.
//! Source: spec B6 (search by number or text, MDI), H6.

use egui::{Id, Rect, Sense, vec2};

use super::{PageKey, View, theme, widget};
use crate::defs::kind::Kind;
use crate::defs::text::Text;

/// The uses of the keyboard: its words and the label of the key that finishes the input. All letters and signs have the
/// same places everywhere.
#[derive(Clone, Copy, Debug)]
pub struct LetterLayout {
    /// Words entered by one touch each.
    words: &'static [Text],
    /// Label of the key that finishes the input.
    enter_label: Text,
}

/// The characters, twelve per row; the last row leaves space for the two wide keys.
const ROWS: [&str; 5] = ["1234567890-\u{8}", "QWERTYUIOP[]", "ASDFGHJKL.#=", "ZXCVBNM()+*/", ";%_:,<>$"];
const COLUMNS: usize = 12;
/// The place of the key that deletes a character.
const BACKSPACE: char = '\u{8}';
/// Columns of space and of the key that finishes the input.
const WIDE: usize = 2;

macro_rules! words {
    ($($zh:literal $en:literal,)*) => { &[$(Text::new($zh, $en)),*] };
}

/// For a search, with the most frequent search words.
pub const SEARCH_LAYOUT: LetterLayout = LetterLayout {
    words: words! {
        "速度" "speed", "延时" "delay", "限位" "limit", "零点" "home", "液压" "hydraulic", "振荡" "oscillation",
        "砂轮" "wheel", "尾座" "tailstock", "量仪" "gauge",
    },
    enter_label: Text::new("完成", "OK"),
};
/// For the search of a program, with frequent words of comments.
pub const PROGRAM_SEARCH_LAYOUT: LetterLayout = LetterLayout {
    words: words! {
        "外圆" "cylindrical", "平面" "plane", "圆台" "rotary", "端面" "face", "锥面" "cone", "切入" "plunge",
        "修整" "dressing", "量仪" "gauge", "回退" "retract",
    },
    ..SEARCH_LAYOUT
};
/// For a page text, with words of its labels.
pub const PAGE_TEXT_LAYOUT: LetterLayout = LetterLayout {
    words: words! {
        "粗磨" "rough", "精磨" "finish", "余量" "amount", "速度" "speed", "位置" "place", "次数" "count",
        "X轴" "X axis", "Z轴" "Z axis", "砂轮" "wheel",
    },
    enter_label: Text::new("换行", "ENTER"),
};
/// For a program block, with the most frequent codes of the kind.
pub const fn block_layout(kind: Kind) -> LetterLayout {
    LetterLayout { words: kind.ui().mdi_codes, enter_label: Text::new("输入", "INPUT") }
}

const ROW: f32 = 46.0;

/// Height of the keyboard: one row of words and the rows of characters.
pub const HEIGHT: f32 = (ROWS.len() + 1) as f32 * ROW + 2.0 * theme::GAP;

/// What was touched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LetterKey {
    /// Appends a character.
    Char(char),
    /// Replaces the text by this word.
    Word(&'static str),
    /// Deletes the last character.
    Backspace,
    /// Finishes the input.
    Done,
}

/// Draws the pad; returns the touched key.
pub fn ui(view: &View<'_>, rect: Rect, board: &LetterLayout) -> Option<LetterKey> {
    view.ui.interact(rect, Id::unique("letters"), Sense::CLICK | Sense::DRAG);
    view.filled_card(rect, view.theme.surface, view.theme.focus);
    let inside = rect.shrink(theme::GAP);
    let mut touched = None;
    let mut key = |cell: (usize, usize, usize), key: PageKey<'_>, meaning: LetterKey| {
        let (column, row, columns) = cell;
        let width = (inside.width() + 3.0) / columns as f32;
        let wide = if matches!(meaning, LetterKey::Char(' ') | LetterKey::Done) { WIDE as f32 } else { 1.0 };
        let corner = inside.min + vec2(column as f32 * width, row as f32 * ROW);
        if widget::button(view, Rect::from_min_size(corner, vec2(wide * width - 3.0, ROW - 2.0)), key) {
            touched = Some(meaning);
        }
    };
    for (index, word) in board.words.iter().enumerate() {
        let (name, label) = (format!("word-{}", word.en), word.get(view.lang));
        key((index, 0, board.words.len()), PageKey::new(&name, label), LetterKey::Word(label));
    }
    for (line, signs) in ROWS.iter().enumerate() {
        for (index, sign) in signs.chars().enumerate() {
            let cell = (index, 1 + line, COLUMNS);
            if sign == BACKSPACE {
                key(cell, PageKey::new("letter-back", view.text("退格", "DEL")), LetterKey::Backspace);
                continue;
            }
            let (mut label, name) = ([0; 4], format!("letter-{sign}"));
            key(cell, PageKey::new(&name, sign.encode_utf8(&mut label)), LetterKey::Char(sign));
        }
    }
    let last = |column| (column, ROWS.len(), COLUMNS);
    key(last(COLUMNS - 2 * WIDE), PageKey::new("letter- ", view.text("空格", "SPACE")), LetterKey::Char(' '));
    key(last(COLUMNS - WIDE), PageKey::new("letter-done", board.enter_label.get(view.lang)), LetterKey::Done);
    touched
}
