//! The letter pads: touch input of search words and program blocks.
//! Source: spec B6 (search by number or text, MDI), H6.

use egui::{Id, Rect, Sense, vec2};

use super::{PageKey, View, theme, widget};
use crate::defs::kind::Kind;
use crate::defs::text::Text;

/// The keys of a letter pad.
#[derive(Clone, Copy, Debug)]
pub struct LetterLayout {
    /// Words entered by one touch each.
    words: &'static [Text],
    /// Characters, ten per row; the last row leaves space for two keys.
    rows: &'static [&'static str],
    /// Label of the key that finishes the input.
    enter_label: Text,
}

macro_rules! words {
    ($($zh:literal $en:literal,)*) => { &[$(Text::new($zh, $en)),*] };
}

/// For a search, with the most frequent search words.
pub const SEARCH_LAYOUT: LetterLayout = LetterLayout {
    words: words! {
        "速度" "speed", "延时" "delay", "限位" "limit", "零点" "home", "液压" "hydraulic", "振荡" "oscillation",
        "砂轮" "wheel", "尾座" "tailstock", "量仪" "gauge",
    },
    rows: &["1234567890", "QWERTYUIOP", "ASDFGHJKL.", "ZXCVBNM-"],
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
    rows: &["1234567890", "QWERTYUIOP", "ASDFGHJKL.", "#;%()+/=_ ", "ZXCVBNM-"],
    enter_label: Text::new("换行", "ENTER"),
};
/// For a program block, with the most frequent codes of the kind.
pub const fn block_layout(kind: Kind) -> LetterLayout {
    let face = kind.ui();
    let rows: &[&str] = if face.has_macros { MACRO_ROWS } else { PLAIN_ROWS };
    LetterLayout { words: face.mdi_codes, rows, enter_label: Text::new("输入", "INPUT") }
}

const MACRO_ROWS: &[&str] = &["1234567890", "QWERTYUIOP", "ASDFGHJKL.", "#[]()=+*/ ", "ZXCVBNM-"];
/// Without the characters of the macro language.
const PLAIN_ROWS: &[&str] = &["1234567890", "QWERTYUIOP", "ASDFGHJKL.", "ZXCVBNM-"];
const ROW: f32 = 46.0;

impl LetterLayout {
    /// Height of the pad: one row of words and the rows of characters.
    pub const fn height(&self) -> f32 {
        (self.rows.len() + 1) as f32 * ROW + 2.0 * theme::GAP
    }
}

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
    let mut key = |column: usize, row: usize, columns: usize, key: PageKey<'_>, meaning: LetterKey| {
        let width = (inside.width() + 3.0) / columns as f32;
        let corner = inside.min + vec2(column as f32 * width, row as f32 * ROW);
        if widget::button(view, Rect::from_min_size(corner, vec2(width - 3.0, ROW - 2.0)), key) {
            touched = Some(meaning);
        }
    };
    for (index, word) in board.words.iter().enumerate() {
        let (name, label) = (format!("word-{}", word.en), word.get(view.lang));
        key(index, 0, board.words.len(), PageKey::new(&name, label), LetterKey::Word(label));
    }
    for (line, signs) in board.rows.iter().enumerate() {
        for (index, sign) in signs.chars().enumerate() {
            let (mut label, name) = ([0; 4], format!("letter-{sign}"));
            let label = if sign == ' ' { view.text("空格", "SPACE") } else { sign.encode_utf8(&mut label) };
            key(index, 1 + line, 10, PageKey::new(&name, label), LetterKey::Char(sign));
        }
    }
    let last = board.rows.len();
    key(8, last, 10, PageKey::new("letter-back", view.text("退格", "DEL")), LetterKey::Backspace);
    key(9, last, 10, PageKey::new("letter-done", board.enter_label.get(view.lang)), LetterKey::Done);
    touched
}
