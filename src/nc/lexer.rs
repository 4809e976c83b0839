//! The lexer that all dialects share: reads numbers, signs and keywords from bytes.
//! Numbers are read as an integer mantissa and a scale, so that `0.1` is the nearest `f64` to 0.1. Source: spec B1.

use super::fault::{Capitals, ReadResult, fail, fail1};
use crate::defs::program_error::ProgramError;

/// Most digits of one number.
const MAX_NUMBER_LENGTH: usize = 40;
/// Mantissas with up to this many digits are exact in an `f64`.
const EXACT_DIGITS: usize = 15;

const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// Most bytes of a block. A longer one could delay a tick.
pub(crate) const MAX_BLOCK_LENGTH: usize = 4_096;

/// The byte that `peek` returns after the end of a text.
pub(crate) const END_OF_TEXT: u8 = b'\n';

/// A number in the text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NumberLiteral {
    pub value: f64,
    /// It has a decimal point.
    pub has_point: bool,
}

/// A read position in a text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cursor<'a> {
    pub text: &'a [u8],
    pub at: usize,
}

impl<'a> Cursor<'a> {
    /// Limits the text to one block's length from `at`.
    #[inline]
    pub fn window(text: &'a [u8], at: usize) -> Self {
        let end = text.len().min(at + MAX_BLOCK_LENGTH);
        Self { text: &text[..end], at }
    }

    /// Whether the window cuts off a block of `text`.
    #[inline]
    pub const fn is_truncated(&self, text: &[u8]) -> bool {
        // The LF of a CR at the end may lie outside the window.
        self.text.len() < text.len() && self.at + 2 > self.text.len()
    }

    /// The next byte; a line end after the last byte.
    #[inline]
    pub fn peek(&self) -> u8 {
        self.text.get(self.at).copied().unwrap_or(END_OF_TEXT)
    }

    /// The byte `ahead` bytes after the next one.
    #[inline]
    pub fn peek_at(&self, ahead: usize) -> u8 {
        self.text.get(self.at + ahead).copied().unwrap_or(END_OF_TEXT)
    }

    /// Whether all bytes are read.
    pub fn is_at_end(&self) -> bool {
        self.at >= self.text.len()
    }

    fn rest(&self) -> &'a [u8] {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// Skips `byte` if it is next; returns whether it was.
    #[inline]
    pub fn accept(&mut self, byte: u8) -> bool {
        let found = self.peek() == byte && !self.is_at_end();
        self.at += usize::from(found);
        found
    }

    /// Skips a keyword if it is next, in upper or lower case; returns whether it was.
    pub fn accept_keyword(&mut self, word: &str) -> bool {
        // Expressions ask for many keywords at each place: `tag_no_case` of nom would be 5 % of a run.
        let found = self.rest().get(..word.len()).is_some_and(|next| next.eq_ignore_ascii_case(word.as_bytes()));
        self.at += if found { word.len() } else { 0 };
        found
    }

    /// Skips spaces and `( )` comments.
    #[inline]
    pub fn skip_blanks(&mut self) -> ReadResult<()> {
        loop {
            match self.peek() {
                b' ' | b'\t' => self.at += 1,
                b'(' => self.skip_comment()?,
                _ => return Ok(()),
            }
        }
    }

    #[cold]
    fn skip_comment(&mut self) -> ReadResult<()> {
        let open = self.at;
        while !(self.peek() == b')' || self.at_line_end()) {
            self.at += 1;
        }
        if self.accept(b')') { Ok(()) } else { fail(open, ProgramError::UnbalancedComment) }
    }

    /// Skips to the line end, which stays unread.
    pub fn skip_rest_of_line(&mut self) {
        while !self.at_line_end() {
            self.at += 1;
        }
    }

    /// Whether the line end is next.
    #[inline]
    pub fn at_line_end(&self) -> bool {
        matches!(self.peek(), b'\n' | b'\r')
    }

    /// Skips one line end: CR, LF or CR LF.
    #[inline]
    pub fn skip_line_end(&mut self) {
        if self.peek() == b'\r' {
            self.at += 1;
            if self.peek() == b'\n' && !self.is_at_end() {
                self.at += 1;
            }
        } else {
            self.at = (self.at + 1).min(self.text.len());
        }
    }

    /// Whether an unsigned number is next.
    #[inline]
    pub fn at_number(&self) -> bool {
        matches!(self.peek(), b'0'..=b'9' | b'.')
    }

    /// Reads an unsigned number.
    #[inline]
    pub fn read_number(&mut self) -> ReadResult<NumberLiteral> {
        let start = self.at;
        let mut mantissa = 0_u64;
        let mut digits = 0;
        let mut scale = 0;
        let mut point = false;
        loop {
            match self.peek() {
                digit @ b'0'..=b'9' => {
                    mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
                    digits += 1;
                    scale += usize::from(point);
                }
                b'.' if !point => point = true,
                b'.' => return self.bad_number(start),
                _ => break,
            }
            self.at += 1;
        }
        if digits > EXACT_DIGITS || digits == 0 {
            return self.long_number(start, digits, point);
        }
        let value = if scale == 0 { mantissa as f64 } else { mantissa as f64 / POWERS_OF_TEN[scale] };
        Ok(NumberLiteral { value, has_point: point })
    }

    #[cold]
    fn long_number(&mut self, start: usize, digits: usize, point: bool) -> ReadResult<NumberLiteral> {
        let text = std::str::from_utf8(&self.text[start..self.at]).unwrap_or_default();
        match text.parse::<f64>() {
            Ok(value) if digits > 0 && digits <= MAX_NUMBER_LENGTH => Ok(NumberLiteral { value, has_point: point }),
            _ => self.bad_number(start),
        }
    }

    #[cold]
    fn bad_number<T>(&mut self, start: usize) -> ReadResult<T> {
        while self.at_number() {
            self.at += 1;
        }
        fail1(start, ProgramError::BadNumber, Capitals(&self.text[start..self.at]))
    }

    /// The error for an unexpected byte.
    #[cold]
    pub fn unexpected<T>(&self) -> ReadResult<T> {
        match self.peek() {
            b'[' | b']' => fail(self.at, ProgramError::UnbalancedBracket),
            b'(' | b')' => fail(self.at, ProgramError::UnbalancedComment),
            // The character is decoded when the error gets its line and column.
            0x80.. => fail(self.at, ProgramError::NonAsciiCharacter),
            b'\r' | b'\n' => fail1(self.at, ProgramError::UnexpectedCharacter, "⏎"),
            byte if byte.is_ascii_control() => {
                fail1(self.at, ProgramError::UnexpectedCharacter, format_args!("0x{byte:02X}"))
            }
            byte => fail1(self.at, ProgramError::UnexpectedCharacter, char::from(byte)),
        }
    }
}

/// Whether the word or variable at a byte has a number that is written there.
pub(super) fn is_literal(text: &[u8], at: usize) -> bool {
    let mut cursor = Cursor::window(text, at);
    if !cursor.accept(b'#') {
        while cursor.peek().is_ascii_alphabetic() {
            cursor.at += 1;
        }
    }
    cursor.skip_blanks().is_ok() && (cursor.at_number() || matches!(cursor.peek(), b'-' | b'+'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Option<f64> {
        Cursor::window(text.as_bytes(), 0).read_number().ok().map(|number| number.value)
    }

    #[test]
    fn b1_numbers_are_the_nearest_to_what_is_written() {
        for text in ["0.1", "100", "100.", ".5", "0.3", "1234567.8901", "123456789012345678901234567890", "0.000001"] {
            assert_eq!(number(text), text.parse().ok(), "{text}");
        }
    }

    #[test]
    fn b1_bad_numbers_are_refused() {
        for text in [".", "1.2.3", "..", "1..", "12345678901234567890123456789012345678901"] {
            assert_eq!(number(text), None, "{text}");
        }
    }
}
