//! Input of a value for a macro variable: cursor, text, check, refusal.
//! Source: spec H6, K7.5.

use std::borrow::Cow;

use super::{CoreAnswer, EditKey, FieldEditor};
use crate::defs::text::{Lang, LocalizedText, Text};
use crate::link::Command;
use crate::link::edit::EditAnswer;

/// Largest value that can be typed.
pub const MAX_VALUE: f64 = 99_999.999;

/// Parses a value of a variable and checks its range.
///
/// # Errors
/// The reason of the refusal, in both languages.
pub fn parse_value(variable: u16, text: &str) -> Result<f64, LocalizedText> {
    let Ok(value) = text.parse::<f64>() else {
        return Err(LocalizedText::new("不是数字", "not a number"));
    };
    if !value.is_finite() || value.abs() > MAX_VALUE {
        return Err(LocalizedText::new("超出范围 ±99999.999", "out of range ±99999.999"));
    }
    let zero_or_one = [0.0_f64, 1.0].iter().any(|allowed| allowed.to_bits() == value.to_bits());
    if is_switch(variable) && !zero_or_one {
        return Err(LocalizedText::new("只能输入 0 或 1", "only 0 or 1"));
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
pub struct VariableEntry {
    /// Index of the selected row, in reading order.
    pub cursor: usize,
    /// The editor of its value.
    pub editor: FieldEditor,
}

impl VariableEntry {
    /// Resets to the first field, for another page.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Selects a field by touch.
    pub fn select(&mut self, row: usize) {
        if row != self.cursor {
            self.editor.clear();
        }
        self.cursor = row;
        self.editor.pad_open = true;
    }

    /// Polls the core's answer; selects a refused field again.
    pub fn poll_answer(&mut self, answer: &EditAnswer) {
        if let CoreAnswer::Refused(row) = self.editor.poll_answer(answer) {
            self.cursor = row;
        }
    }

    /// Handles a key; `columns` are the variables of the left and of the right column.
    pub fn handle_key(&mut self, edit: EditKey, columns: (&[u16], &[u16])) -> Option<Command> {
        let count = columns.0.len() + columns.1.len();
        if count == 0 {
            return None;
        }
        self.cursor = self.cursor.min(count - 1);
        self.editor.clear_refused(edit);
        if self.editor.handle_key(edit) {
            return None;
        }
        match (edit, edit.step(self.cursor, count, 1)) {
            (EditKey::Enter, _) => return self.enter(columns),
            (EditKey::Left | EditKey::Right, _) => self.go(other_column(self.cursor, columns.0.len(), count)),
            (_, Some(row)) => self.go(row),
            (_, None) => {}
        }
        None
    }

    fn go(&mut self, row: usize) {
        self.cursor = row;
        self.editor.text.clear();
    }

    fn enter(&mut self, columns: (&[u16], &[u16])) -> Option<Command> {
        let count = columns.0.len() + columns.1.len();
        let next = (self.cursor + 1) % count;
        if self.editor.text.is_empty() {
            self.go(next);
            return None;
        }
        let variable = *columns.0.iter().chain(columns.1).nth(self.cursor)?;
        match parse_value(variable, &self.editor.text) {
            Ok(value) => {
                self.editor.send(self.cursor);
                self.go(next);
                Some(Command::EnterVariable(variable, Some(value)))
            }
            Err(reason) => {
                self.editor.refused = Some(reason);
                None
            }
        }
    }

    /// The reason of a refusal in a language.
    #[must_use]
    pub fn refusal(&self, lang: Lang) -> Option<Cow<'_, str>> {
        self.editor.refusal(lang)
    }
}

/// The row next to this one in the other column, or the last row of a shorter column.
fn other_column(row: usize, left: usize, count: usize) -> usize {
    match row.checked_sub(left) {
        None if left >= count => row,
        None => (row + left).min(count - 1),
        Some(_) if left == 0 => row,
        Some(line) => line.min(left - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: (&[u16], &[u16]) = (&[500, 570, 502], &[510]);

    fn typed(entry: &mut VariableEntry, text: &str) -> Option<Command> {
        for sign in text.chars() {
            entry.handle_key(if sign == '-' { EditKey::Sign } else { EditKey::Char(sign) }, COLUMNS);
        }
        entry.handle_key(EditKey::Enter, COLUMNS)
    }

    #[test]
    fn h6_enter_stores_and_moves_on() {
        let mut entry = VariableEntry::default();
        let command = typed(&mut entry, "-40.25");
        assert!(matches!(command, Some(Command::EnterVariable(500, Some(value))) if (value + 40.25).abs() < 1e-12));
        assert_eq!((entry.cursor, entry.editor.text.as_str()), (1, ""));
    }

    #[test]
    fn k7_5_switches_take_zero_or_one_and_the_refused_text_stays() {
        let mut entry = VariableEntry { cursor: 1, ..VariableEntry::default() };
        assert!(typed(&mut entry, "2").is_none());
        assert_eq!((entry.editor.text.as_str(), entry.refusal(Lang::En).as_deref()), ("2", Some("only 0 or 1")));
        entry.handle_key(EditKey::Char('1'), COLUMNS);
        assert_eq!((entry.editor.text.as_str(), entry.editor.refused.is_none()), ("1", true));
        assert!(matches!(entry.handle_key(EditKey::Enter, COLUMNS), Some(Command::EnterVariable(570, Some(_)))));
    }

    #[test]
    fn h6_arrows_reach_every_field() {
        let mut entry = VariableEntry::default();
        entry.handle_key(EditKey::Right, COLUMNS);
        assert_eq!(entry.cursor, 3);
        entry.handle_key(EditKey::Left, COLUMNS);
        assert_eq!(entry.cursor, 0);
        entry.handle_key(EditKey::Up, COLUMNS);
        assert_eq!(entry.cursor, 3);
        entry.handle_key(EditKey::Down, COLUMNS);
        assert_eq!(entry.cursor, 0);
    }
}
