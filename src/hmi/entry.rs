//! Input of a value for a macro variable: cursor, text, check, refusal.
//! Source: spec H6, K7.5.

use super::typing::{Heard, Typing};
use crate::defs::text::{Lang, Said, Text};
use crate::link::Command;
use crate::link::edit::EditAnswer;

/// Largest value that can be typed.
pub const LARGEST: f64 = 99_999.999;

/// One key of the numeric pad or of the keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edit {
    /// 0–9 or the decimal point.
    Char(char),
    /// Changes the sign.
    Sign,
    /// Deletes the last character.
    Back,
    /// Deletes the character behind the cursor; without a text cursor, the last one.
    Delete,
    /// Moves to the start of the line.
    LineStart,
    /// Moves to the end of the line.
    LineEnd,
    /// INPUT (输入): accepts the value.
    Enter,
    /// CANCEL (取消): discards the value.
    Cancel,
    /// Moves to the field above.
    Up,
    /// Moves to the field below.
    Down,
    /// Moves to the other column.
    Left,
    /// Moves to the other column.
    Right,
    /// Moves to the next field.
    Next,
    /// Moves to the previous field.
    Previous,
}

/// Parses a value of a variable and checks its range.
///
/// # Errors
/// The reason of the refusal, in both languages.
pub fn check(variable: u16, text: &str) -> Result<f64, Said> {
    let Ok(value) = text.parse::<f64>() else {
        return Err(Said::new("不是数字", "not a number"));
    };
    if !value.is_finite() || value.abs() > LARGEST {
        return Err(Said::new("超出范围 ±99999.999", "out of range ±99999.999"));
    }
    let zero_or_one = [0.0_f64, 1.0].iter().any(|allowed| allowed.to_bits() == value.to_bits());
    if is_switch(variable) && !zero_or_one {
        return Err(Said::new("只能输入 0 或 1", "only 0 or 1"));
    }
    Ok(value)
}

/// Whether a variable is a switch: #570–#579 are 0 or 1 (K7.5).
#[must_use]
pub const fn is_switch(variable: u16) -> bool {
    matches!(variable, 570..=579)
}

/// The range of a variable, as shown.
#[must_use]
pub const fn range(variable: u16) -> Text {
    if is_switch(variable) { Text::new("0 或 1", "0 or 1") } else { Text::new("±99999.999", "±99999.999") }
}

/// The cursor and what is being typed.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    /// Index of the selected row, in reading order.
    pub cursor: usize,
    /// The editor of its value.
    pub typing: Typing,
}

impl Entry {
    /// Resets to the first field, for another page.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Selects a field by touch.
    pub fn choose(&mut self, row: usize) {
        if row != self.cursor {
            self.typing.clear();
        }
        self.cursor = row;
        self.typing.pad = true;
    }

    /// Polls the core's answer; selects a refused field again.
    pub fn hear(&mut self, answer: &EditAnswer) {
        if let Heard::Refused(row) = self.typing.hear(answer) {
            self.cursor = row;
        }
    }

    /// Handles a key; `columns` are the variables of the left and of the right column.
    pub fn edit(&mut self, edit: Edit, columns: (&[u16], &[u16])) -> Option<Command> {
        let count = columns.0.len() + columns.1.len();
        if count == 0 {
            return None;
        }
        self.cursor = self.cursor.min(count - 1);
        self.typing.next_key(edit);
        if self.typing.key(edit) {
            return None;
        }
        match edit {
            Edit::Enter => return self.enter(columns),
            Edit::Up | Edit::Previous => self.go((self.cursor + count - 1) % count),
            Edit::Down | Edit::Next => self.go((self.cursor + 1) % count),
            Edit::Left | Edit::Right => self.go(other_column(self.cursor, columns.0.len(), count)),
            Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Delete | Edit::LineStart | Edit::LineEnd | Edit::Cancel => {
            }
        }
        None
    }

    fn go(&mut self, row: usize) {
        self.cursor = row;
        self.typing.text.clear();
    }

    fn enter(&mut self, columns: (&[u16], &[u16])) -> Option<Command> {
        let count = columns.0.len() + columns.1.len();
        let next = (self.cursor + 1) % count;
        if self.typing.text.is_empty() {
            self.go(next);
            return None;
        }
        let variable = *columns.0.iter().chain(columns.1).nth(self.cursor)?;
        match check(variable, &self.typing.text) {
            Ok(value) => {
                self.typing.send(self.cursor);
                self.go(next);
                Some(Command::TypeVariable(variable, Some(value)))
            }
            Err(reason) => {
                self.typing.refused = Some(reason);
                None
            }
        }
    }

    /// The reason of a refusal in a language.
    #[must_use]
    pub fn reason(&self, lang: Lang) -> Option<&str> {
        self.typing.reason(lang)
    }
}

/// The row next to this one in the other column, or the last row of a shorter column.
const fn other_column(row: usize, left: usize, count: usize) -> usize {
    if row < left {
        let beside = row + left;
        if left >= count {
            row
        } else if beside < count {
            beside
        } else {
            count - 1
        }
    } else if left == 0 {
        row
    } else {
        let beside = row - left;
        if beside < left { beside } else { left - 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: (&[u16], &[u16]) = (&[500, 570, 502], &[510]);

    fn typed(entry: &mut Entry, text: &str) -> Option<Command> {
        for sign in text.chars() {
            entry.edit(if sign == '-' { Edit::Sign } else { Edit::Char(sign) }, COLUMNS);
        }
        entry.edit(Edit::Enter, COLUMNS)
    }

    #[test]
    fn h6_enter_stores_and_moves_on() {
        let mut entry = Entry::default();
        let command = typed(&mut entry, "-40.25");
        assert!(matches!(command, Some(Command::TypeVariable(500, Some(value))) if (value + 40.25).abs() < 1e-12));
        assert_eq!((entry.cursor, entry.typing.text.as_str()), (1, ""));
    }

    #[test]
    fn k7_5_switches_take_zero_or_one_and_the_refused_text_stays() {
        let mut entry = Entry { cursor: 1, ..Entry::default() };
        assert!(typed(&mut entry, "2").is_none());
        assert_eq!((entry.typing.text.as_str(), entry.reason(Lang::En)), ("2", Some("only 0 or 1")));
        entry.edit(Edit::Char('1'), COLUMNS);
        assert_eq!((entry.typing.text.as_str(), entry.typing.refused.is_none()), ("1", true));
        assert!(matches!(entry.edit(Edit::Enter, COLUMNS), Some(Command::TypeVariable(570, Some(_)))));
    }

    #[test]
    fn h6_range_and_form_are_checked() {
        assert!(check(500, "99999.999").is_ok() && check(500, "-99999.999").is_ok());
        for bad in ["100000", "1e9", "nan", "inf", "", "-", ".", "1.2.3"] {
            assert!(check(500, bad).is_err(), "{bad:?}");
        }
        for bad in ["2", "0.5", "-1", "1.0000001"] {
            assert!(check(575, bad).is_err(), "{bad:?}");
        }
        assert!(check(575, "0").is_ok() && check(579, "1").is_ok());
    }

    #[test]
    fn h6_arrows_reach_every_field() {
        let mut entry = Entry::default();
        entry.edit(Edit::Right, COLUMNS);
        assert_eq!(entry.cursor, 3);
        entry.edit(Edit::Left, COLUMNS);
        assert_eq!(entry.cursor, 0);
        entry.edit(Edit::Up, COLUMNS);
        assert_eq!(entry.cursor, 3);
        entry.edit(Edit::Down, COLUMNS);
        assert_eq!(entry.cursor, 0);
    }
}
