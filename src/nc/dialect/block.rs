//! What the blocks of the grinders' languages have in common: an address once, feed and modes first, a rehearsal where
//! the position changes, whole numbers and ranges. Source: spec B1, B2, S1.

use std::fmt::Display;

use super::{Running, Step};
use crate::defs::program_error::ProgramError as E;
use crate::nc::expression::whole;
use crate::nc::fault::{Outcome, Stop, wrong1, wrong2};
use crate::nc::op::Op;
use crate::nc::words::Word;

/// The greatest coordinate, feed or speed that can be written.
pub(super) const LIMIT: f64 = 99_999.999;
/// The least feed: what three decimals can say.
const LEAST_FEED: f64 = 0.001;

/// Which modes a block sets anew.
#[derive(Clone, Copy, Debug)]
pub(super) struct Modes {
    /// Exact stop or continuous.
    pub path: bool,
    /// The work frame.
    pub frame: bool,
}

/// Refuses an address that stands twice in the block.
pub(super) fn refuse_double(running: &Running<'_, '_>) -> Outcome<()> {
    match running.words.double {
        Some(at) => wrong1(at as usize, E::DoubleWord, letter_at(running, at)),
        None => Ok(()),
    }
}

/// The letter at a place of the text.
pub(super) fn letter_at(running: &Running<'_, '_>, at: u32) -> char {
    char::from(running.text.get(at as usize).copied().unwrap_or(b'?')).to_ascii_uppercase()
}

/// Takes F, in units of `mm`, as the modal feed.
#[inline]
pub(super) fn feed(running: &mut Running<'_, '_>, mm: f64) -> Outcome<()> {
    let Some(word) = running.words.take(b'F') else { return Ok(()) };
    if !(LEAST_FEED..=LIMIT).contains(&word.value) {
        return out_of_range("F", word, "0.001–99999.999");
    }
    running.modals.feed = Some(word.value * mm);
    Ok(())
}

/// Hands out path mode and frame. The second half of a block has them behind it.
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

/// A block that changes where coordinates are counted from before it uses them. The rest is rehearsed, so that a mistake
/// in it refuses the whole block, and done when the change is; its arcs begin elsewhere then.
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

/// A word that must be a whole number in a range.
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
