//! What blocks with a mistake may have set. They are left out of a check, so a mistake that stands behind them for want of
//! that alone is a warning. Source: spec B1 (every mistake is told).

use super::fault::E;

/// What is unknown since a block was left out.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LostState {
    feed: bool,
    plane: bool,
}

impl LostState {
    /// Notes a block that is left out, by the text of its line.
    pub fn note(&mut self, line: &[u8]) {
        let letter_at = |index: usize| line.get(index).is_some_and(u8::is_ascii_alphabetic);
        let mut in_comment = false;
        for (index, byte) in line.iter().enumerate() {
            in_comment = match byte {
                b'(' => true,
                b')' => false,
                _ => in_comment,
            };
            // A letter of a name such as GOTO or FIX is no word.
            if in_comment || letter_at(index + 1) || index > 0 && letter_at(index - 1) {
                continue;
            }
            match byte.to_ascii_uppercase() {
                b'F' => self.feed = true,
                b'G' => self.plane |= matches!(line.get(index + 1..index + 3), Some(b"17" | b"18" | b"19")),
                _ => {}
            }
        }
    }

    /// Whether a mistake may come from what was left out.
    pub const fn explains(self, error: E) -> bool {
        match error {
            E::FeedMissing => self.feed,
            E::PlaneUnnamed => self.plane,
            _ => false,
        }
    }
}
