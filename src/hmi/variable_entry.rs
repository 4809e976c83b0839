//! Input of a value for a macro variable: cursor, text, check, refusal.
//! Source: spec H6, K7.5.

use super::EditKey;
use super::field_editor::{CoreAnswer, FieldEditor, parse_within};
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::defs::value_bound::TYPED_VALUE_LIMIT;
use crate::link::Command;
use crate::link::edit::EditAnswer;

/// Parses a value of a variable and checks its range.
///
/// # Errors
/// The reason of the refusal, in both languages.
pub fn parse_value(variable: u16, text: &str) -> Result<f64, LocalizedText> {
    let value = parse_within(text, TYPED_VALUE_LIMIT)?;
    let zero_or_one = [0.0_f64, 1.0].iter().any(|allowed| allowed.to_bits() == value.to_bits());
    if is_switch(variable) && !zero_or_one {
        return Err(phrase!("只能输入 0 或 1", "only 0 or 1"));
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
    /// Selects a field by touch.
    pub fn select(&mut self, row: usize) {
        if row != self.cursor {
            self.editor.clear();
        }
        self.cursor = row;
        self.editor.open_pad();
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
