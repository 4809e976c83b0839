//! Shared by the dialects: unique addresses, the feed, blocks that change the work position, whole numbers and ranges.
//! Source: spec B1, B2, S1.

use std::fmt::Display;

use super::codes::BlockCodes;
use super::rules;
use super::rules::{BlockContext, FlowAction};
use crate::defs::system_variable;
use crate::defs::text::arg::Arg;
use crate::geometry::CompensationSide;
use crate::nc::cutter::{Compensation, CutterShape};
use crate::nc::expression::Scope;
use crate::nc::fault::{Capitals, E, ReadResult, ReadStop, fail1, fail2};
use crate::nc::functions::whole_number;
use crate::nc::modal::ModalCodes;
use crate::nc::op::{Op, SpeedMode};
use crate::nc::settings::CutterSource;
use crate::nc::words::{BlockWords, ValueKind, Word};

/// Greatest coordinate, feed or speed that can be programmed.
pub(super) const MAX_VALUE: f64 = 99_999.999;
/// Least feed, mm/min: three decimals.
const MIN_FEED: f64 = 0.001;
/// Least feed in inches, and per revolution: four decimals.
const MIN_FINE_FEED: f64 = 0.0001;
/// Below this feed, mm/min, a program that does not name the unit of F may mean mm/r.
const SLOW_FEED: f64 = 2.0;
const METRES_PER_FOOT: f64 = 0.3048;

/// Reports an unknown word, as written up to the next letter or blank.
#[cold]
pub(super) fn unknown_word<T>(text: &[u8], word: Word) -> ReadResult<T> {
    let at = word.at as usize;
    let rest = text.get(at..).unwrap_or_default();
    let ends = |byte: &u8| !matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+' | b'#' | b'[' | b']');
    let address = address_at(text, word.at).len();
    let length = rest.iter().skip(address).position(ends).map_or(rest.len(), |length| length + address);
    let error = if word.letter == b'M' { E::UnknownM } else { E::UnknownWord };
    fail1(at, error, Capitals(&rest[..length]))
}

/// Refuses an address that occurs twice in the block.
pub(super) fn refuse_duplicate_address(running: &BlockContext<'_, '_>) -> ReadResult<()> {
    running
        .words
        .duplicate
        .map_or(Ok(()), |at| fail1(at as usize, E::DoubleWord, Capitals(address_at(running.text, at))))
}

/// The address at a byte of a text: a letter, or `,R`.
pub(super) fn address_at(text: &[u8], at: u32) -> &[u8] {
    let rest = text.get(at as usize..).unwrap_or_default();
    let length = if rest.first() == Some(&b',') { 2 } else { 1 };
    rest.get(..length).unwrap_or(rest)
}

/// The letter at a byte of a text, in upper case.
pub(super) fn letter_at(text: &[u8], at: u32) -> char {
    text.get(at as usize).map_or('?', |byte| char::from(byte.to_ascii_uppercase()))
}

/// The error for a word that is missing, or that an empty variable takes away.
#[cold]
pub(super) fn missing_word<T>(words: &BlockWords, at: u32, name: &'static str, letter: u8) -> ReadResult<T> {
    match words.list.iter().find(|word| word.letter == letter && word.kind == ValueKind::Null) {
        Some(empty) => fail2(empty.at as usize, E::EmptyWord, name, char::from(letter)),
        None => fail2(at as usize, E::MissingWord, name, char::from(letter)),
    }
}

/// Makes F the modal feed; `mm` is millimetres per programmed unit.
#[inline]
pub(super) fn set_feed(running: &mut BlockContext<'_, '_>, mm: f64) -> ReadResult<()> {
    let Some(word) = running.words.take_in_place(b'F') else { return Ok(()) };
    let least = if mm > 1.0 || running.modals.per_rev { MIN_FINE_FEED } else { MIN_FEED };
    let feed = in_range(*word, (least, MAX_VALUE), "")? * mm;
    running.modals.feed = Some(feed);
    if feed < SLOW_FEED && !running.modals.feed_unit_named && !running.modals.per_rev {
        warn_of_slow_feed(running, *word);
    }
    Ok(())
}

/// Warns of a feed that would be usual per revolution, once in a program.
#[cold]
fn warn_of_slow_feed(running: &mut BlockContext<'_, '_>, word: Word) {
    running.modals.feed_unit_named = true;
    let ModalCodes { per_minute, per_rev, .. } = rules(running.settings.dialect).modal_codes;
    let codes = format_args!("G{per_minute} (mm/min) / G{per_rev} (mm/r)").into();
    running.scope.warn(word.at as usize, E::FeedUnitUnnamed, [format_args!("F{}", word.value).into(), codes]);
}

/// Makes S the modal speed. With inches a surface speed is in feet per minute.
pub(super) fn set_speed(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let Some(word) = running.words.take(b'S') else { return Ok(()) };
    let value = in_range(word, (0.0, MAX_VALUE), "")?;
    running.modals.speed = Some(value);
    let mode = running.modals.speed_mode;
    let is_in_feet = mode == SpeedMode::SurfaceSpeed && running.modals.inch_feed;
    running.ops.push(Op::S { value: if is_in_feet { value * METRES_PER_FOOT } else { value }, mode });
    Ok(())
}

/// G40, or G41 and G42 with the cutter of an offset; `offset` is the number that the block names.
///
/// A block that `changes_tool` while they act selects the cutter again.
pub(super) fn set_compensation(
    running: &mut BlockContext<'_, '_>,
    plan: &BlockCodes,
    (offset, changes_tool): (Option<u32>, bool),
) -> ReadResult<()> {
    let side = match (plan.compensation.map(|code| code.number), running.modals.compensation) {
        (Some(41), _) => CompensationSide::Left,
        (Some(42), _) => CompensationSide::Right,
        (Some(_), _) => {
            running.modals.compensation = None;
            return Ok(());
        }
        (None, Some(active)) if changes_tool => active.side,
        (None, _) => return Ok(()),
    };
    // The cutter of an open contour stays.
    if let (false, None, Some(active)) = (changes_tool, offset, running.modals.compensation)
        && active.side == side
    {
        return Ok(());
    }
    let at = plan.compensation.map_or(running.at, |code| code.at as usize);
    let by_offset = |number: u32| (running.scope.world.cutter(number as usize), number);
    let (cutter, number) = match (offset, running.settings.cutter_source) {
        (Some(number), _) => by_offset(number),
        (None, CutterSource::ToolOffset) => by_offset(u32::from(running.modals.offset)),
        (None, CutterSource::Offset(number)) => by_offset(number),
        (None, CutterSource::WholeWheel) => {
            let diameter_mm = running.scope.read(system_variable::WHEEL_DIAMETER.first, at)?.unwrap_or(0.0);
            (CutterShape { radius_mm: diameter_mm / 2.0, tip: 0 }, 0)
        }
    };
    if cutter.radius_mm <= 0.0 {
        running.scope.warn(at, E::CutterWithoutRadius, [format_args!("{number:02}").into(), Arg::None]);
    }
    running.modals.compensation = Some(Compensation { side, cutter });
    Ok(())
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
        Some(_) => out_of_range_as(name, word, format_args!("{low}–{high}")),
    }
}

/// The value of a word that must be in a range; `unit` follows the range in the error.
#[inline]
pub(super) fn in_range(word: Word, (low, high): (f64, f64), unit: &str) -> ReadResult<f64> {
    if (low..=high).contains(&word.value) {
        Ok(word.value)
    } else {
        out_of_range(word, format_args!("{low}–{high}{unit}"))
    }
}

#[cold]
pub(super) fn out_of_range_as<T>(name: impl Display, word: Word, range: impl Into<Arg>) -> ReadResult<T> {
    fail2(word.at as usize, E::OutOfRange, format_args!("{name}{}", word.value), range)
}

/// Refuses a word, named by its letter.
#[cold]
pub(super) fn out_of_range<T>(word: Word, range: impl Into<Arg>) -> ReadResult<T> {
    out_of_range_as(char::from(word.letter), word, range)
}
