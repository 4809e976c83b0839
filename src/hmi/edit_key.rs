//! The keys that edit a value or a text, or move the cursor: from the numeric pad or the keyboard.
//! Source: spec H6.

/// One key of the numeric pad or of the keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditKey {
    /// 0–9 or the decimal point.
    Char(char),
    /// Changes the sign.
    Sign,
    /// Deletes the last character.
    Backspace,
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

impl EditKey {
    /// The field that a cursor key selects from `here`, of `count` fields in rows of `columns`, around the ends; none
    /// for a key that does not move the cursor.
    pub const fn step(self, here: usize, count: usize, columns: usize) -> Option<usize> {
        let forward = match self {
            Self::Up => count.saturating_sub(columns),
            Self::Down => columns,
            Self::Left | Self::Previous => count - 1,
            Self::Right | Self::Next => 1,
            Self::Char(_) | Self::Sign | Self::Backspace | Self::Delete => return None,
            Self::LineStart | Self::LineEnd | Self::Enter | Self::Cancel => return None,
        };
        Some((here + forward) % count)
    }
}
