//! The words of one block in order, each with its byte position. Source: spec B1, B3 (null words are skipped).

use std::cell::Cell;
use std::ops::Deref;

use super::expression::{Scope, Value, primary};
use super::fault::{E, ReadResult, fail, fail1, fail2};
use super::functions::whole_u32;
use super::lexer::Cursor;
use crate::defs::text::arg::Arg;

/// Most words of a block, without G and M.
pub(crate) const MAX_WORDS: usize = 48;
/// Most G codes of a block.
const MAX_G_CODES: usize = 10;
/// The code of the additional work offsets.
const EXTRA_OFFSET_G: f64 = 54.1;
/// FANUC's look-ahead control. G05.2 and G05.3 of LinuxCNC are curves.
const LOOK_AHEAD_G: f64 = 5.1;
/// The rounding of a code that a program computes.
const CODE_ROUNDING: f64 = 1e-6;
/// Most M codes of a block (DECISION: three, in the order written).
const MAX_M_CODES: usize = 3;
/// Most words of several letters of a block.
const MAX_KEYWORDS: usize = 4;
/// Most variables that a block of words sets.
const MAX_ASSIGNMENTS: usize = 16;

/// The internal letters of the words of a corner: `,C` and CHR=; `,R` and RND=; `,A` and ANG=; CHF=. They are behind Z,
/// where no text has a letter.
pub(crate) const CHAMFER: u8 = b'A' + 27;
pub(crate) const ROUNDING: u8 = b'A' + 28;
pub(crate) const LINE_ANGLE: u8 = b'A' + 29;
pub(crate) const CHAMFER_LENGTH: u8 = b'A' + 30;
/// That of RNDM=: N itself is never a word.
pub(crate) const MODAL_ROUNDING: u8 = b'N';

/// A word: an address letter and its value.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Word {
    pub value: f64,
    pub at: u32,
    pub letter: u8,
    pub kind: ValueKind,
}

/// The notation of a word's value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum ValueKind {
    /// With a decimal point, or computed.
    #[default]
    Decimal,
    /// Digits without a decimal point.
    Integer,
    /// From a null variable: the word is skipped.
    Null,
    /// The letter without a value.
    AddressOnly,
}

/// A G or M code and its byte position.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Code {
    pub number: u32,
    pub at: u32,
}

impl Word {
    /// The address as a program writes it; for those of SINUMERIK see its own table.
    pub fn name(self) -> Arg {
        match self.letter {
            CHAMFER => ",C".into(),
            ROUNDING => ",R".into(),
            LINE_ANGLE => ",A".into(),
            letter => char::from(letter).into(),
        }
    }
}

impl Code {
    /// The code as a program writes it, with at least `width` digits.
    pub fn name(self, letter: char, width: usize) -> Arg {
        format_args!("{letter}{:0width$}", self.number).into()
    }
}

/// A variable that the block sets, and its byte position.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Assignment {
    pub variable: u32,
    pub value: f64,
    pub at: u32,
}

/// A list with room for `N` items.
#[derive(Clone, Debug)]
pub(crate) struct ShortList<T, const N: usize> {
    items: [T; N],
    count: usize,
}

impl<T: Copy + Default, const N: usize> Default for ShortList<T, N> {
    fn default() -> Self {
        Self { items: [T::default(); N], count: 0 }
    }
}

impl<T, const N: usize> Deref for ShortList<T, N> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        &self.items[..self.count]
    }
}

impl<T, const N: usize> ShortList<T, N> {
    /// Adds an item; `false` if there is no room.
    #[inline]
    fn push(&mut self, item: T) -> bool {
        let Some(place) = self.items.get_mut(self.count) else { return false };
        *place = item;
        self.count += 1;
        true
    }
}

/// The words of one block.
#[derive(Clone, Debug, Default)]
pub(crate) struct BlockWords {
    /// All words except G, M and N, in order.
    pub list: ShortList<Word, MAX_WORDS>,
    /// The letters, and some that no text can have.
    first: [u8; 31],
    mask: u32,
    nulls: u32,
    used: Cell<u32>,
    /// The G codes in order.
    pub g: ShortList<Code, MAX_G_CODES>,
    /// The M codes in order.
    pub m: ShortList<Code, MAX_M_CODES>,
    /// Words of several letters without a value, by their number in the dialect.
    pub keywords: ShortList<Code, MAX_KEYWORDS>,
    /// Letters whose words are incremental, or absolute, whatever acts otherwise: `IC()` and `AC()` of SINUMERIK.
    incremental: u32,
    absolute: u32,
    /// The variables that the block sets, in order.
    pub assignments: ShortList<Assignment, MAX_ASSIGNMENTS>,
    /// The block number.
    pub block_number: Option<u32>,
    /// Position of the first word whose address is repeated.
    pub duplicate: Option<u32>,
    /// Position of the first letter without a value.
    pub address_only: Option<u32>,
    /// The block has G54.1; its code is in the list as 54.
    pub has_extra_offset: bool,
    /// Whether the condition of the block's IF holds; none without an IF.
    pub condition: Option<bool>,
}

const fn letter_bit(letter: u8) -> u32 {
    1 << (letter.wrapping_sub(b'A') & 31)
}

/// The mask of some letters.
pub(crate) const fn letter_mask(letters: &[u8]) -> u32 {
    let (mut mask, mut index) = (0, 0);
    while index < letters.len() {
        mask |= letter_bit(letters[index]);
        index += 1;
    }
    mask
}

impl BlockWords {
    /// Removes all words.
    #[inline]
    pub fn clear(&mut self) {
        (self.list.count, self.g.count, self.m.count, self.assignments.count) = (0, 0, 0, 0);
        (self.mask, self.nulls, self.incremental, self.absolute) = (0, 0, 0, 0);
        self.keywords.count = 0;
        self.used.set(0);
        (self.block_number, self.duplicate, self.address_only) = (None, None, None);
        (self.condition, self.has_extra_offset) = (None, false);
    }

    /// Whether a word was skipped because its variable is null.
    #[inline]
    pub fn has_null(&self) -> bool {
        // In `G65 H… P#i`, P names the result variable; it may be null.
        let result = if self.has(b'H') { letter_bit(b'P') } else { 0 };
        self.nulls & !result != 0
    }

    /// Whether the word of a letter was skipped because its variable is null.
    pub fn is_left_out(&self, letter: u8) -> bool {
        self.nulls & letter_bit(letter) != 0
    }

    /// Whether the block has neither words nor codes.
    pub fn is_empty(&self) -> bool {
        let has_codes = !self.g.is_empty() || !self.m.is_empty() || !self.keywords.is_empty();
        !has_codes && self.list.is_empty() && self.assignments.is_empty()
    }

    /// Adds a variable that the block sets.
    pub fn push_assignment(&mut self, set: Assignment) -> ReadResult<()> {
        match self.assignments.push(set) {
            true => Ok(()),
            false => fail2(set.at as usize, E::TooManyCodes, "R", MAX_ASSIGNMENTS),
        }
    }

    /// Adds a word of several letters.
    pub fn push_keyword(&mut self, keyword: Code) -> ReadResult<()> {
        match self.keywords.push(keyword) {
            true => Ok(()),
            false => fail(keyword.at as usize, E::BlockTooLong),
        }
    }

    /// Notes that the word of a letter is incremental, or absolute.
    pub fn set_distance(&mut self, letter: u8, is_incremental: bool) {
        let mask = if is_incremental { &mut self.incremental } else { &mut self.absolute };
        *mask |= letter_bit(letter);
    }

    /// Whether the word of a letter is incremental by itself; `None`: by what acts.
    #[inline]
    pub fn is_incremental(&self, letter: u8) -> Option<bool> {
        match (self.incremental & letter_bit(letter) != 0, self.absolute & letter_bit(letter) != 0) {
            (true, _) => Some(true),
            (false, true) => Some(false),
            (false, false) => None,
        }
    }

    /// Adds a word: G and M codes to their lists, others to the words.
    pub fn add(&mut self, word: Word) -> ReadResult<()> {
        self.add_value(word.letter, Some(word.value), word.kind, word.at)
    }

    #[inline]
    fn add_value(&mut self, letter: u8, value: Value, kind: ValueKind, at: u32) -> ReadResult<()> {
        match (letter, value) {
            (b'G', Some(value)) if (value - EXTRA_OFFSET_G).abs() < CODE_ROUNDING => {
                self.has_extra_offset = true;
                push_code(&mut self.g, letter, Some(EXTRA_OFFSET_G.trunc()), kind, at)
            }
            (b'G', _) => push_code(&mut self.g, letter, value, kind, at),
            // An argument of G65.
            (b'M', Some(value)) if kind == ValueKind::Decimal && whole_u32(value).is_none() => {
                self.push(Word { value, at, letter, kind })
            }
            (b'M', _) => push_code(&mut self.m, letter, value, kind, at),
            (_, Some(value)) => self.push(Word { value, at, letter, kind }),
            (_, None) if kind == ValueKind::AddressOnly => self.push(Word { value: 0.0, at, letter, kind }),
            (_, None) => self.push(Word { value: 0.0, at, letter, kind: ValueKind::Null }),
        }
    }

    /// Whether a letter has a value.
    #[inline]
    pub fn has(&self, letter: u8) -> bool {
        self.mask & letter_bit(letter) != 0
    }

    /// Whether all letters without a value are among `letters`.
    pub fn address_only_among(&self, letters: &[u8]) -> bool {
        self.list.iter().all(|word| word.kind != ValueKind::AddressOnly || letters.contains(&word.letter))
    }

    /// Whether any letter of a mask has a value.
    #[inline]
    pub fn has_any(&self, mask: u32) -> bool {
        self.mask & mask != 0
    }

    /// The word of a letter, not marked as used.
    #[inline]
    pub fn peek(&self, letter: u8) -> Option<Word> {
        self.find(letter).copied()
    }

    #[inline]
    fn find(&self, letter: u8) -> Option<&Word> {
        self.has(letter).then(|| &self.list.items[usize::from(self.first[usize::from(letter - b'A')])])
    }

    /// The word of a letter, marked as used.
    #[inline]
    pub fn take(&self, letter: u8) -> Option<Word> {
        self.take_in_place(letter).copied()
    }

    /// As [`Self::take`], without a copy: a copy of a word that was just written waits for its bytes to be stored.
    #[inline]
    pub fn take_in_place(&self, letter: u8) -> Option<&Word> {
        let word = self.find(letter)?;
        self.used.set(self.used.get() | letter_bit(letter));
        Some(word)
    }

    /// Marks every word as used.
    pub fn mark_all_used(&self) {
        self.used.set(u32::MAX);
    }

    /// The first word that is not marked as used.
    #[inline]
    pub fn unused(&self) -> Option<Word> {
        let left = self.mask & !self.used.get();
        if left == 0 {
            return None;
        }
        self.list.iter().copied().find(|word| word.kind != ValueKind::Null && left & letter_bit(word.letter) != 0)
    }

    #[inline]
    fn push(&mut self, word: Word) -> ReadResult<()> {
        let index = self.list.count as u8;
        if !self.list.push(word) {
            return fail(word.at as usize, E::BlockTooLong);
        }
        if word.kind == ValueKind::Null {
            self.nulls |= letter_bit(word.letter);
        } else {
            if self.mask & letter_bit(word.letter) != 0 {
                self.duplicate = self.duplicate.or(Some(word.at));
            } else {
                self.first[usize::from(word.letter - b'A')] = index;
                self.mask |= letter_bit(word.letter);
            }
            if word.kind == ValueKind::AddressOnly {
                self.address_only = self.address_only.or(Some(word.at));
            }
        }
        Ok(())
    }

    /// Reads words until the next character is not a letter.
    #[inline]
    pub fn read<S: Scope>(&mut self, cursor: &mut Cursor<'_>, scope: &mut S) -> ReadResult<()> {
        loop {
            cursor.skip_blanks()?;
            let at = cursor.at as u32;
            let letter = cursor.peek() & !0x20;
            let letter = match (cursor.peek().is_ascii_alphabetic(), take_comma(cursor)) {
                (true, _) => letter,
                (false, Some(letter)) => letter,
                (false, None) => return Ok(()),
            };
            cursor.at += 1;
            let (value, kind) = word_value(cursor, scope)?;
            match letter {
                b'N' => self.read_block_number(value, kind, at)?,
                _ => self.add_value(letter, value, kind, at)?,
            }
        }
    }

    fn read_block_number(&mut self, value: Value, kind: ValueKind, at: u32) -> ReadResult<()> {
        let Some(value) = value.filter(|_| kind == ValueKind::Integer) else {
            return fail1(at as usize, E::MissingNumber, "N");
        };
        if self.block_number.is_some() {
            return fail1(at as usize, E::DoubleWord, "N");
        }
        self.block_number = Some(value.min(f64::from(u32::MAX)) as u32);
        Ok(())
    }
}

/// Whether `,C` `,R` or `,A` is next.
pub(crate) fn is_comma_word(cursor: &Cursor<'_>) -> bool {
    comma_letter(cursor).is_some()
}

fn comma_letter(cursor: &Cursor<'_>) -> Option<u8> {
    match (cursor.peek(), cursor.peek_at(1) & !0x20) {
        (b',', b'C') => Some(CHAMFER),
        (b',', b'R') => Some(ROUNDING),
        (b',', b'A') => Some(LINE_ANGLE),
        _ => None,
    }
}

/// The letter of `,C` `,R` `,A`, with the cursor on its letter; none if no such word is next.
#[inline]
fn take_comma(cursor: &mut Cursor<'_>) -> Option<u8> {
    let letter = comma_letter(cursor)?;
    cursor.at += 1;
    Some(letter)
}

#[inline]
fn push_code<const N: usize>(
    codes: &mut ShortList<Code, N>,
    letter: u8,
    value: Value,
    kind: ValueKind,
    at: u32,
) -> ReadResult<()> {
    let name = char::from(letter);
    let number = match value {
        None if kind == ValueKind::AddressOnly => return fail1(at as usize, E::MissingNumber, name),
        // A G or M word from a null variable is skipped like any other word.
        None => return Ok(()),
        Some(value) => whole_u32(value).map_or_else(
            || {
                let unknown = match letter {
                    b'G' if (value - LOOK_AHEAD_G).abs() < CODE_ROUNDING => E::LookAheadCode,
                    b'G' => E::UnknownG,
                    _ => E::UnknownM,
                };
                fail1(at as usize, unknown, format_args!("{name}{value}"))
            },
            Ok,
        )?,
    };
    if codes.push(Code { number, at }) { Ok(()) } else { fail2(at as usize, E::TooManyCodes, name, N) }
}

/// The value after a letter: a number, `#…` or `[…]`, each with or without a sign.
#[inline]
fn word_value<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> ReadResult<(Value, ValueKind)> {
    if !cursor.at_number() {
        cursor.skip_blanks()?;
    }
    let negative = cursor.peek() == b'-';
    if negative || cursor.peek() == b'+' {
        cursor.at += 1;
        cursor.skip_blanks()?;
    }
    match cursor.peek() {
        b'0'..=b'9' | b'.' => {
            let number = cursor.read_number()?;
            let kind = if number.has_point { ValueKind::Decimal } else { ValueKind::Integer };
            Ok((Some(if negative { -number.value } else { number.value }), kind))
        }
        b'#' | b'[' => {
            let value = primary(cursor, scope)?;
            Ok((if negative { value.map(|value| -value) } else { value }, ValueKind::Decimal))
        }
        0x80.. => cursor.unexpected(),
        _ => Ok((None, ValueKind::AddressOnly)),
    }
}
