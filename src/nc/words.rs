//! The words of one block in order, each with its byte position. Source: spec B1, B3 (null words are skipped).

use std::cell::Cell;

use super::expression::{Scope, Value, primary, whole};
use super::fault::{Outcome, wrong, wrong1, wrong2};
use super::lexer::Cursor;
use crate::defs::program_error::ProgramError as E;

/// Most words of a block, without G and M.
pub(crate) const WORDS: usize = 48;
/// Most G codes of a block.
const G_WORDS: usize = 10;
/// Most M codes of a block (DECISION: three, in the order written).
const M_WORDS: usize = 3;
/// Most variables that a block of words sets.
const SETS: usize = 16;

/// A word: an address letter and its value.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Word {
    pub value: f64,
    pub at: u32,
    pub letter: u8,
    pub kind: Kind,
}

/// The notation of a word's value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Kind {
    /// With a decimal point, or computed.
    #[default]
    Exact,
    /// Digits without a decimal point.
    Digits,
    /// From a null variable: the word is skipped.
    Null,
    /// The letter without a value.
    Bare,
}

/// A G or M code and its byte position.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Code {
    pub number: u32,
    pub at: u32,
}

/// A variable that the block sets, and its byte position.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Set {
    pub variable: u32,
    pub value: f64,
    pub at: u32,
}

/// The words of one block.
#[derive(Clone, Debug)]
pub(crate) struct Words {
    list: [Word; WORDS],
    count: usize,
    first: [u8; 26],
    mask: u32,
    nulls: u32,
    used: Cell<u32>,
    g: [Code; G_WORDS],
    g_count: usize,
    m: [Code; M_WORDS],
    m_count: usize,
    sets: [Set; SETS],
    set_count: usize,
    /// The block number.
    pub n: Option<u32>,
    /// Position of the first word whose address is repeated.
    pub double: Option<u32>,
    /// Position of the first letter without a value.
    pub bare: Option<u32>,
}

impl Default for Words {
    fn default() -> Self {
        Self {
            list: [Word::default(); WORDS],
            count: 0,
            first: [0; 26],
            mask: 0,
            nulls: 0,
            used: Cell::new(0),
            g: [Code::default(); G_WORDS],
            g_count: 0,
            m: [Code::default(); M_WORDS],
            m_count: 0,
            sets: [Set::default(); SETS],
            set_count: 0,
            n: None,
            double: None,
            bare: None,
        }
    }
}

const fn bit(letter: u8) -> u32 {
    1 << (letter.wrapping_sub(b'A') & 31)
}

impl Words {
    /// Removes all words.
    #[inline]
    pub fn clear(&mut self) {
        self.count = 0;
        self.mask = 0;
        self.nulls = 0;
        self.used.set(0);
        self.g_count = 0;
        self.m_count = 0;
        self.set_count = 0;
        self.n = None;
        self.double = None;
        self.bare = None;
    }

    /// All words except G, M and N, in order.
    pub fn list(&self) -> &[Word] {
        &self.list[..self.count]
    }

    /// Whether a word was skipped because its variable is null.
    #[inline]
    pub fn has_null(&self) -> bool {
        // In `G65 H… P#i`, P names the result variable; it may be null.
        let result = if self.has(b'H') { bit(b'P') } else { 0 };
        self.nulls & !result != 0
    }

    /// The G codes in order.
    #[inline]
    pub fn g(&self) -> &[Code] {
        &self.g[..self.g_count]
    }

    /// The M codes in order.
    #[inline]
    pub fn m(&self) -> &[Code] {
        &self.m[..self.m_count]
    }

    /// The variables that the block sets, in order.
    #[inline]
    pub fn sets(&self) -> &[Set] {
        &self.sets[..self.set_count]
    }

    /// Whether the block has neither words nor codes.
    pub fn is_empty(&self) -> bool {
        self.count == 0 && self.g_count == 0 && self.m_count == 0 && self.set_count == 0
    }

    /// Adds a variable that the block sets.
    pub fn push_set(&mut self, set: Set) -> Outcome<()> {
        let Some(place) = self.sets.get_mut(self.set_count) else {
            return wrong2(set.at as usize, E::TooManyCodes, "R", SETS.to_string());
        };
        *place = set;
        self.set_count += 1;
        Ok(())
    }

    /// Adds a word: G and M codes to their lists, others to the words.
    pub fn add(&mut self, word: Word) -> Outcome<()> {
        let value = Some(word.value);
        match word.letter {
            b'G' => push_code(&mut self.g, &mut self.g_count, b'G', value, word.kind, word.at),
            b'M' => push_code(&mut self.m, &mut self.m_count, b'M', value, word.kind, word.at),
            _ => self.push(word),
        }
    }

    /// Whether a letter has a value.
    #[inline]
    pub fn has(&self, letter: u8) -> bool {
        self.mask & bit(letter) != 0
    }

    /// Whether all letters without a value are among `letters`.
    pub fn bare_only(&self, letters: &[u8]) -> bool {
        self.list().iter().all(|word| word.kind != Kind::Bare || letters.contains(&word.letter))
    }

    /// Whether any letter of a mask has a value.
    #[inline]
    pub fn has_any(&self, mask: u32) -> bool {
        self.mask & mask != 0
    }

    /// The word of a letter, not marked as used.
    #[inline]
    pub fn look(&self, letter: u8) -> Option<Word> {
        self.has(letter).then(|| self.list[usize::from(self.first[usize::from(letter - b'A')])])
    }

    /// The word of a letter, marked as used.
    #[inline]
    pub fn take(&self, letter: u8) -> Option<Word> {
        self.used.set(self.used.get() | bit(letter));
        self.look(letter)
    }

    /// Marks every word as used.
    pub fn use_all(&self) {
        self.used.set(u32::MAX);
    }

    /// The first word that is not marked as used.
    #[inline]
    pub fn unused(&self) -> Option<Word> {
        let left = self.mask & !self.used.get();
        if left == 0 {
            return None;
        }
        self.list().iter().copied().find(|word| word.kind != Kind::Null && left & bit(word.letter) != 0)
    }

    #[inline]
    fn push(&mut self, word: Word) -> Outcome<()> {
        let Some(place) = self.list.get_mut(self.count) else { return wrong(word.at as usize, E::BlockTooLong) };
        *place = word;
        if word.kind == Kind::Null {
            self.nulls |= bit(word.letter);
        } else {
            if self.mask & bit(word.letter) != 0 {
                self.double = self.double.or(Some(word.at));
            } else {
                self.first[usize::from(word.letter - b'A')] = self.count as u8;
                self.mask |= bit(word.letter);
            }
            if word.kind == Kind::Bare {
                self.bare = self.bare.or(Some(word.at));
            }
        }
        self.count += 1;
        Ok(())
    }

    /// Reads words until the next character is not a letter.
    #[inline]
    pub fn read<S: Scope>(&mut self, cursor: &mut Cursor<'_>, scope: &mut S) -> Outcome<()> {
        loop {
            cursor.blank()?;
            let at = cursor.at as u32;
            let letter = cursor.peek() & !0x20;
            if !cursor.peek().is_ascii_alphabetic() {
                return Ok(());
            }
            cursor.at += 1;
            let (value, kind) = word_value(cursor, scope)?;
            match letter {
                b'G' => push_code(&mut self.g, &mut self.g_count, letter, value, kind, at)?,
                b'M' => push_code(&mut self.m, &mut self.m_count, letter, value, kind, at)?,
                b'N' => self.number(value, kind, at)?,
                _ => {
                    let (value, kind) = match value {
                        Some(value) => (value, kind),
                        None if kind == Kind::Bare => (0.0, kind),
                        None => (0.0, Kind::Null),
                    };
                    self.push(Word { value, at, letter, kind })?;
                }
            }
        }
    }

    fn number(&mut self, value: Value, kind: Kind, at: u32) -> Outcome<()> {
        let Some(value) = value.filter(|_| kind == Kind::Digits) else {
            return wrong1(at as usize, E::MissingNumber, "N");
        };
        if self.n.is_some() {
            return wrong1(at as usize, E::DoubleWord, "N");
        }
        self.n = Some(value.min(f64::from(u32::MAX)) as u32);
        Ok(())
    }
}

#[inline]
fn push_code<const COUNT: usize>(
    codes: &mut [Code; COUNT],
    count: &mut usize,
    letter: u8,
    value: Value,
    kind: Kind,
    at: u32,
) -> Outcome<()> {
    let name = char::from(letter);
    let number = match value {
        None if kind == Kind::Bare => return wrong1(at as usize, E::MissingNumber, name),
        // A G or M word from a null variable is skipped like any other word.
        None => return Ok(()),
        Some(value) => match whole(value).map(u32::try_from) {
            Some(Ok(number)) => number,
            Some(Err(_)) | None => {
                let error = if letter == b'G' { E::UnknownG } else { E::UnknownM };
                return wrong1(at as usize, error, format!("{name}{value}"));
            }
        },
    };
    let Some(place) = codes.get_mut(*count) else {
        return wrong2(at as usize, E::TooManyCodes, name, COUNT.to_string());
    };
    *place = Code { number, at };
    *count += 1;
    Ok(())
}

/// The value after a letter: a number, `#…` or `[…]`, each with or without a sign.
#[inline]
fn word_value<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> Outcome<(Value, Kind)> {
    if !cursor.at_number() {
        cursor.blank()?;
    }
    let mut negative = false;
    match cursor.peek() {
        b'-' => {
            negative = true;
            cursor.at += 1;
            cursor.blank()?;
        }
        b'+' => {
            cursor.at += 1;
            cursor.blank()?;
        }
        _ => {}
    }
    match cursor.peek() {
        b'0'..=b'9' | b'.' => {
            let number = cursor.number()?;
            let kind = if number.point { Kind::Exact } else { Kind::Digits };
            Ok((Some(if negative { -number.value } else { number.value }), kind))
        }
        b'#' | b'[' => {
            let value = primary(cursor, scope)?;
            Ok((if negative { value.map(|value| -value) } else { value }, Kind::Exact))
        }
        0x80.. => cursor.unexpected(),
        _ => Ok((None, Kind::Bare)),
    }
}
