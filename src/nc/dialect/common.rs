//! Shared by the dialects: targets, unique addresses, feed and modes, blocks that change the work position, whole
//! numbers and ranges. Source: spec B1, B2, S1.

use std::fmt::Display;

use super::{BlockContext, FlowAction};
use crate::defs::program_error::ProgramError as E;
use crate::nc::expression::whole_number;
use crate::nc::fault::{ReadResult, ReadStop, fail1, fail2};
use crate::nc::op::{AxisSet, Op};
use crate::nc::words::{BlockWords, Word};
use crate::units::{Axis, WorkPos};

/// Greatest coordinate, feed or speed that can be programmed.
pub(super) const MAX_VALUE: f64 = 99_999.999;
/// Least feed: three decimals.
const MIN_FEED: f64 = 0.001;

/// The end of a move.
#[derive(Clone, Copy, Debug)]
pub(super) struct MoveTarget {
    pub to: WorkPos,
    pub words: AxisSet,
    pub incremental: AxisSet,
}

impl MoveTarget {
    /// No axis moves yet.
    pub const fn from(position: WorkPos) -> Self {
        Self { to: position, words: AxisSet::NONE, incremental: AxisSet::NONE }
    }

    /// Adds an axis: its coordinate, or the distance from its position.
    #[inline]
    pub fn add(&mut self, axis: Axis, value: f64, incremental: bool) {
        self.words.insert(axis);
        if incremental {
            self.incremental.insert(axis);
        }
        self.to[axis] = if incremental { self.to[axis] + value } else { value };
    }
}

/// Refuses M codes that exclude each other in one block. `width` is the number of digits of a code's name.
pub(super) fn check_exclusive_m_codes(words: &BlockWords, groups: &[&[u32]], width: usize) -> ReadResult<()> {
    for group in groups {
        let mut found = words.m().iter().filter(|code| group.contains(&code.number));
        if let (Some(first), Some(second)) = (found.next(), found.next())
            && first.number != second.number
        {
            let [a, b] = [first, second].map(|code| format!("M{:0width$}", code.number));
            return fail2(second.at as usize, E::DoubleGroup, a, b);
        }
    }
    Ok(())
}

/// The byte of the first axis word, else of the first code.
pub(super) fn first_offset(running: &BlockContext<'_, '_>, is_axis_word: impl Fn(u8) -> bool) -> usize {
    let words = running.words;
    let axis = words.list().iter().find(|word| is_axis_word(word.letter));
    axis.map_or_else(|| words.g().first().map_or(running.at, |code| code.at as usize), |word| word.at as usize)
}

/// Reports an unknown word, as written up to the next letter or blank.
#[cold]
pub(super) fn unknown_word<T>(text: &[u8], word: Word) -> ReadResult<T> {
    let at = word.at as usize;
    let rest = text.get(at..).unwrap_or_default();
    let ends = |byte: &u8| !matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+' | b'#' | b'[' | b']');
    let length = rest.iter().skip(1).position(ends).map_or(rest.len(), |length| length + 1);
    fail1(at, E::UnknownWord, String::from_utf8_lossy(&rest[..length]).to_ascii_uppercase())
}

/// The modes that a block sets.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModeChanges {
    /// Exact stop or continuous.
    pub path: bool,
    /// The work offset.
    pub frame: bool,
}

/// Refuses an address that occurs twice in the block.
pub(super) fn refuse_duplicate_address(running: &BlockContext<'_, '_>) -> ReadResult<()> {
    match running.words.duplicate {
        Some(at) => fail1(at as usize, E::DoubleWord, letter_at(running, at)),
        None => Ok(()),
    }
}

/// The letter at a byte of the text, in upper case.
pub(super) fn letter_at(running: &BlockContext<'_, '_>, at: u32) -> char {
    char::from(running.text.get(at as usize).copied().unwrap_or(b'?')).to_ascii_uppercase()
}

/// Makes F the modal feed; `mm` is millimetres per programmed unit.
#[inline]
pub(super) fn set_feed(running: &mut BlockContext<'_, '_>, mm: f64) -> ReadResult<()> {
    let Some(word) = running.words.take(b'F') else { return Ok(()) };
    if !(MIN_FEED..=MAX_VALUE).contains(&word.value) {
        return out_of_range("F", word, "0.001–99999.999");
    }
    running.modals.feed = Some(word.value * mm);
    Ok(())
}

/// Adds the operations for path mode and work offset; not again in the second half of a block.
#[inline]
pub(super) fn push_modes(running: &mut BlockContext<'_, '_>, modes: ModeChanges) {
    if running.second_half {
        return;
    }
    if modes.path {
        running.ops.push(Op::SetPathMode(running.modals.path_mode));
    }
    if modes.frame {
        running.ops.push(Op::SelectWorkOffset { g: running.modals.work_offset });
    }
}

/// Splits a block that changes the work position before it moves. The rest is tried first: a mistake refuses the whole
/// block. It is read again after the change. Arc errors do not count in the trial, as the start differs then.
pub(super) fn split_block(
    running: &mut BlockContext<'_, '_>,
    rest: impl FnOnce(&mut BlockContext<'_, '_>) -> ReadResult<FlowAction>,
) -> ReadResult<FlowAction> {
    let (kept, modals) = (running.ops.len(), *running.modals);
    match rest(running) {
        Err(stop) if !depends_on_start(&stop) => return Err(stop),
        Ok(_) | Err(_) => {}
    }
    running.ops.truncate(kept);
    *running.modals = modals;
    Ok(FlowAction::SecondHalf)
}

fn depends_on_start(stop: &ReadStop) -> bool {
    matches!(stop, ReadStop::Error(wrong) if matches!(wrong.error, E::ArcEndOffCircle | E::ArcRadius))
}

/// The value of a word that must be a whole number from `low` to `high`.
pub(super) fn integer(name: impl Display, word: Word, low: u32, high: u32) -> ReadResult<u32> {
    match whole_number(word.value) {
        None => fail1(word.at as usize, E::NotWhole, format_args!("{name}")),
        Some(value) if (i64::from(low)..=i64::from(high)).contains(&value) => Ok(value as u32),
        Some(_) => out_of_range(name, word, &format!("{low}–{high}")),
    }
}

#[cold]
pub(super) fn out_of_range<T>(name: impl Display, word: Word, range: &str) -> ReadResult<T> {
    fail2(word.at as usize, E::OutOfRange, format_args!("{name}{}", word.value), range)
}
