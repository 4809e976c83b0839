//! Lines, arcs, dwell, skip, G50 and moves to reference points. Source: spec B2, K1, K5.10, K5.11.

use super::coordinates::{SYNTAX, modal_feed, target};
use super::{MAX_VALUE, OneShot, cycles, integer, out_of_range};
use crate::nc::dialect::codes::BlockCodes;
use crate::nc::dialect::common::in_range;
use crate::nc::dialect::motion;
use crate::nc::dialect::move_target::MoveTarget;
use crate::nc::dialect::rules::BlockContext;
use crate::nc::expression::{CoordinateFrame, Scope};
use crate::nc::fault::{E, ReadResult, fail, fail1, fail2};
use crate::nc::modal::MotionMode;
use crate::nc::op::{CONTACT_SKIP_SIGNAL, Op, REFERENCE_POINTS};
use crate::nc::words::{Code, ValueKind, Word};
use crate::units::{Axis, PerAxis};

/// Number of skip signals of G31.
const SKIP_SIGNALS: u32 = 6;

/// How the one-shot functions of this file are read.
pub(super) fn reading_of(code: u32) -> Option<OneShot> {
    Some(match code {
        4 => dwell,
        28 | 30 => return_to_reference,
        31 => skip,
        50 | 92 => set_coordinate_system,
        53 => machine_move,
        _ => return None,
    })
}

/// The move of the active function of group 01.
pub(super) fn modal_move(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<()> {
    if motion::modal_move(running, plan, &SYNTAX, target)? {
        return Ok(());
    }
    match running.modals.motion {
        MotionMode::LongitudinalCycle => cycles::longitudinal(running),
        MotionMode::FaceCycle => cycles::face(running),
        // Functions of another dialect; no code of this one selects them.
        _ => Ok(()),
    }
}

/// G09: the move of its block with an exact stop at its end.
pub(super) fn exact_stop_move(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<()> {
    motion::exact_stop_block(running, |running| modal_move(running, plan))
}

/// G04: P milliseconds, X or U seconds.
fn dwell(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let words = running.words;
    let found = [b'P', b'X', b'U'].map(|letter| words.take(letter));
    let mut given = found.into_iter().flatten();
    let Some(word) = given.next() else { return fail2(code.at as usize, E::MissingWord, "G04", "P / X / U") };
    if let Some(second) = given.next() {
        return fail2(second.at as usize, E::NotTogether, char::from(word.letter), char::from(second.letter));
    }
    let scale = match (word.letter, word.kind, running.settings.least_increment_mm) {
        (b'P', _, _) => 0.001,
        (_, ValueKind::Integer, Some(least)) => least,
        _ => 1.0,
    };
    if word.letter == b'P' && is_written_with_point(running.text, word) {
        return fail2(word.at as usize, E::DwellPoint, format_args!("P{}", word.value), format_args!("{}", word.value));
    }
    let s = word.value * scale;
    if !(0.0..=MAX_VALUE).contains(&s) {
        return out_of_range(word, "0–99999.999 s");
    }
    running.ops.push(Op::Dwell { s });
    Ok(())
}

/// Whether the value of a word is a number with a decimal point in the text, and not computed.
fn is_written_with_point(text: &[u8], word: Word) -> bool {
    let behind = text.get(word.at as usize + 1..).unwrap_or_default();
    word.kind == ValueKind::Decimal
        && behind.iter().find(|byte| **byte != b' ').is_some_and(|byte| !matches!(byte, b'#' | b'['))
}

/// The error for a function without an axis of this machine: none is named, or another one as in `G28 C0`.
#[cold]
fn missing_axis<T>(running: &BlockContext<'_, '_>, code: Code, wanted: &'static str) -> ReadResult<T> {
    let is_axis = |word: &&Word| matches!(word.letter, b'A' | b'B' | b'C' | b'H' | b'V' | b'Y');
    match running.words.list.iter().find(is_axis) {
        Some(word) => fail1(word.at as usize, E::NoAxis, char::from(word.letter)),
        None => fail2(code.at as usize, E::MissingWord, code.name('G', 2), wanted),
    }
}

/// G28: via the intermediate point to the machine zero; G30 P2 to P4: to another reference point.
fn return_to_reference(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let MoveTarget { to, words, incremental, .. } = target(running)?;
    if words.is_empty() {
        return missing_axis(running, code, "X / Z");
    }
    let number = match running.words.take(b'P').filter(|_| code.number == 30) {
        Some(word) => integer(word, 2, REFERENCE_POINTS as u32)? as u8,
        None if code.number == 30 => 2,
        None => 1,
    };
    running.ops.push(Op::ReturnToReference { number, via: to, words, incremental });
    Ok(())
}

/// The skip signal that a word P names.
fn skip_signal(word: Word) -> ReadResult<u8> {
    let contact = u32::from(CONTACT_SKIP_SIGNAL);
    match integer(word, 1, contact) {
        Ok(signal) if signal <= SKIP_SIGNALS || signal == contact => Ok(signal as u8),
        _ => fail2(
            word.at as usize,
            E::OutOfRange,
            format_args!("P{}", word.value),
            format_args!("1–{SKIP_SIGNALS}, {contact}"),
        ),
    }
}

/// G31: feeds until skip signal P is active: gauge signal 1–6, default 1, or 9, the wheel's contact monitor.
fn skip(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let MoveTarget { to, words, incremental, .. } = target(running)?;
    if words.is_empty() {
        return fail2(code.at as usize, E::MissingWord, "G31", "X / Z");
    }
    let signal = running.words.take(b'P').map_or(Ok(1), skip_signal)?;
    let feed = modal_feed(running)?;
    running.ops.push(Op::Skip { to, feed, signal, words, incremental });
    Ok(())
}

/// G50, on GS and GA also G92: assigns work coordinates X Z to the present position; U and W shift them; S limits the
/// speed under G96.
fn set_coordinate_system(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let MoveTarget { to, words, .. } = target(running)?;
    let limit = running.words.take(b'S');
    if let Some(word) = limit {
        running.ops.push(Op::SpeedLimit { rpm: in_range(word, (0.0, MAX_VALUE), "")? });
    }
    if words.is_empty() {
        return match limit {
            Some(_) => Ok(()),
            // Behind no axis that this machine lacks.
            None if running.words.list.is_empty() => fail1(code.at as usize, E::PresetEmpty, code.name('G', 2)),
            None => missing_axis(running, code, "X / Z / S"),
        };
    }
    if running.modals.several_tools {
        return fail(code.at as usize, E::G50WithTools);
    }
    running.modals.g50_used = true;
    running
        .ops
        .push(Op::SetCoordinateSystem { values: PerAxis::from_fn(|axis| words.contains(axis).then_some(to[axis])) });
    Ok(())
}

/// G53: machine coordinates for this block. Alone in its block it stops reading ahead (FANUC).
fn machine_move(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let MoveTarget { to, words, incremental, .. } = target(running)?;
    if words.is_empty() && running.words.list.is_empty() {
        // Waits until the machine stands.
        return running.scope.axis_position(Axis::X, CoordinateFrame::Machine, code.at as usize).map(drop);
    }
    if words.is_empty() {
        return missing_axis(running, code, "X / Z");
    }
    if !incremental.is_empty() {
        return fail2(motion::first_offset(running, &SYNTAX), E::NotTogether, "G53", "U V W G91");
    }
    let feed = match running.modals.motion {
        MotionMode::Rapid => None,
        MotionMode::Feed => Some(modal_feed(running)?),
        motion => return fail2(code.at as usize, E::CycleInForce, format_args!("G{:02}", motion.g()), "G53"),
    };
    running.ops.push(Op::MachineMove { to: PerAxis::from_fn(|axis| words.contains(axis).then_some(to[axis])), feed });
    Ok(())
}
