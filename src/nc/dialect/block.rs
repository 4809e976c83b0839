//! Shared by the grinder dialects: unique addresses, feed and modes, blocks that change the work position, whole
//! numbers and ranges. Source: spec B1, B2, S1.

use std::fmt::Display;

use super::{Running, Step};
use crate::defs::program_error::ProgramError as E;
use crate::nc::expression::whole;
use crate::nc::fault::{Outcome, Stop, wrong1, wrong2};
use crate::nc::op::Op;
use crate::nc::words::Word;

/// Greatest coordinate, feed or speed that can be programmed.
pub(super) const LIMIT: f64 = 99_999.999;
/// Least feed: three decimals.
const LEAST_FEED: f64 = 0.001;

/// The modes that a block sets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Modes {
    /// Exact stop or continuous.
    pub path: bool,
    /// The work offset.
    pub frame: bool,
}

/// Refuses an address that occurs twice in the block.
pub(super) fn refuse_double(running: &Running<'_, '_>) -> Outcome<()> {
    match running.words.double {
        Some(at) => wrong1(at as usize, E::DoubleWord, letter_at(running, at)),
        None => Ok(()),
    }
}

/// The letter at a byte of the text, in upper case.
pub(super) fn letter_at(running: &Running<'_, '_>, at: u32) -> char {
    char::from(running.text.get(at as usize).copied().unwrap_or(b'?')).to_ascii_uppercase()
}

/// Makes F the modal feed; `mm` is millimetres per programmed unit.
#[inline]
pub(super) fn feed(running: &mut Running<'_, '_>, mm: f64) -> Outcome<()> {
    let Some(word) = running.words.take(b'F') else { return Ok(()) };
    if !(LEAST_FEED..=LIMIT).contains(&word.value) {
        return out_of_range("F", word, "0.001–99999.999");
    }
    running.modals.feed = Some(word.value * mm);
    Ok(())
}

/// Adds the operations for path mode and work offset; not again in the second half of a block.
#[inline]
pub(super) fn modes(running: &mut Running<'_, '_>, modes: Modes) {
    if running.second_half {
        return;
    }
    if modes.path {
        running.ops.push(Op::Path(running.modals.path));
    }
    if modes.frame {
        running.ops.push(Op::Frame { g: running.modals.frame });
    }
}

/// Splits a block that changes the work position before it moves. The rest is tried first: a mistake refuses the whole
/// block. It is read again after the change. Arc errors do not count in the trial, as the start differs then.
pub(super) fn divided(
    running: &mut Running<'_, '_>,
    rest: impl FnOnce(&mut Running<'_, '_>) -> Outcome<Step>,
) -> Outcome<Step> {
    let (kept, modals) = (running.ops.len(), *running.modals);
    match rest(running) {
        Err(stop) if !starts_elsewhere(&stop) => return Err(stop),
        Ok(_) | Err(_) => {}
    }
    running.ops.truncate(kept);
    *running.modals = modals;
    Ok(Step::Again)
}

fn starts_elsewhere(stop: &Stop) -> bool {
    matches!(stop, Stop::Wrong(wrong) if matches!(wrong.error, E::ArcEndOff | E::ArcRadius))
}

/// The value of a word that must be a whole number from `low` to `high`.
pub(super) fn integer(name: impl Display, word: Word, low: u32, high: u32) -> Outcome<u32> {
    match whole(word.value) {
        None => wrong1(word.at as usize, E::NotWhole, name.to_string()),
        Some(value) if (i64::from(low)..=i64::from(high)).contains(&value) => Ok(value as u32),
        Some(_) => out_of_range(name, word, &format!("{low}–{high}")),
    }
}

#[cold]
pub(super) fn out_of_range<T>(name: impl Display, word: Word, range: &str) -> Outcome<T> {
    wrong2(word.at as usize, E::OutOfRange, format!("{name}{}", word.value), range)
}
