//! S, T, M and the counted loop. Source: spec L4, L7, L8.

use super::{MAX_BLOCK_NUMBER, integer, out_of_range};
use crate::defs::kind::Dialect;
use crate::defs::mcode::MCode;
use crate::nc::dialect::codes;
use crate::nc::dialect::common::in_range;
use crate::nc::dialect::rules::{BlockContext, FlowAction, UnexecutedBlock};
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::op::{Op, SpeedMode};
use crate::nc::words::{BlockWords, Code};
use crate::units::{Axis, PerAxis};

/// Lowest and highest programmable speed, rpm. M05 stops the spindle, S0 does not.
const SPEED_RANGE_RPM: (f64, f64) = (1.0, 9_999.0);
/// M05.
const SPINDLE_STOP: u32 = 5;
/// Most passes of a counted loop.
const MAX_REPEATS: u32 = 9_999;

/// The row of an M code.
fn m_code_row(code: Code) -> Option<&'static MCode> {
    Dialect::SuperMan.m_code(u16::try_from(code.number).ok()?)
}

/// Refuses an M code that the dialect does not have; the error lists the valid codes.
pub(super) fn check_exists(code: Code) -> ReadResult<()> {
    if m_code_row(code).is_some() {
        return Ok(());
    }
    codes::refuse_unknown(code, 'M', 2, Dialect::SuperMan.m_codes().map(|row| u32::from(row.code)))
}

/// Checks an M code of a block that is not executed, and its jump target.
pub(super) fn check_m_code(code: Code, words: &BlockWords, block: &UnexecutedBlock<'_>) -> ReadResult<()> {
    check_exists(code)?;
    if !matches!(code.number, 97 | 98) {
        return Ok(());
    }
    let Some(word) = words.peek(b'L') else {
        return fail2(code.at as usize, E::MissingWord, code.name('M', 2), "L");
    };
    let n = integer(word, 0, MAX_BLOCK_NUMBER)?;
    let named = |error| fail1(word.at as usize, error, format_args!("N{n:04}"));
    match block.source.find_unique_block(n) {
        Ok(Some(line)) if line == block.line && code.number == 97 => named(E::JumpToItself),
        Ok(Some(line)) if code.number == 98 && block.source.main_end_line().is_some_and(|end| line < end) => {
            named(E::SubBeforeMain)
        }
        Ok(Some(_)) => Ok(()),
        Ok(None) => named(E::MissingTarget),
        Err(()) => named(E::SeveralTargets),
    }
}

/// Checks a G22 that is not executed.
pub(super) fn check_loop(code: Code, words: &BlockWords, block: &UnexecutedBlock<'_>) -> ReadResult<()> {
    let at = code.at as usize;
    let Some(word) = words.peek(b'L') else { return fail2(at, E::MissingWord, "G22", "L") };
    integer(word, 0, MAX_REPEATS)?;
    match block.source.counted_loop_at(block.line) {
        Some(found) if found.end_line.is_some() => Ok(()),
        Some(_) | None => fail2(at, E::LoopUnpaired, "G22", "G80"),
    }
}

/// S: spindle speed, rpm (D: the manual leaves the unit to the customer), at most the highest spindle speed (P64).
pub(super) fn spindle_speed(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let Some(word) = running.words.take(b'S') else { return Ok(()) };
    let most = running.settings.superman.max_rpm.min(SPEED_RANGE_RPM.1);
    let value = in_range(word, (SPEED_RANGE_RPM.0, most), " r/min (P64)")?;
    running.modals.speed = Some(value);
    running.ops.push(Op::S { value, mode: SpeedMode::Rpm });
    Ok(())
}

/// `T b`, `T 0 b`: station b. `T a 0`: station a with compensation: the slides move by the difference of the tips.
pub(super) fn tool_call(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let Some(word) = running.words.take(b'T') else { return Ok(()) };
    let (station, with) = match integer(word, 0, 99)? {
        station @ 1..=4 => (station, false),
        both if both % 10 == 0 && (1..=4).contains(&(both / 10)) => (both / 10, true),
        _ => return out_of_range(word, "T1–T4 T01–T04 T10 T20 T30 T40"),
    };
    let world = &running.scope.world;
    let before = if running.modals.tool == 0 { world.active_tool() } else { u32::from(running.modals.tool) };
    let by = with.then(|| {
        let (old, new) = (world.tool_compensation(before), world.tool_compensation(station));
        PerAxis::from_fn(|axis: Axis| old[axis] - new[axis])
    });
    running.modals.tool = station as u16;
    running.modals.offset = if with { station as u16 } else { 0 };
    running.ops.push(Op::IndexTurret { station: station as u8, by });
    Ok(())
}

/// Codes that must be the only M code of a block: stops, jumps, calls and returns.
const fn stands_alone(code: u32) -> bool {
    matches!(code, 0 | 2 | 97..=99)
}

/// Mutually exclusive M codes of a block: spindle, coolant.
const EXCLUSIVE_M_CODES: [&[u32]; 2] = [&[3, 4, 5], &[7, 8]];

/// Checks M codes that must be alone or exclude each other; M02, jumps, calls and returns must not have F.
pub(super) fn check_exclusive_m_codes(words: &BlockWords) -> ReadResult<()> {
    for code in words.m.iter().filter(|code| stands_alone(code.number)) {
        codes::check_stands_alone(words, *code, 2)?;
        if let Some(feed) = words.peek(b'F').filter(|_| code.number != 0 && words.g.is_empty()) {
            return fail2(feed.at as usize, E::NotTogether, code.name('M', 2), "F");
        }
    }
    codes::check_exclusive_m_codes(words, &EXCLUSIVE_M_CODES, 2)
}

/// Checks the M codes, adds those that act before the motion, and returns how the program continues.
pub(super) fn before_motion(running: &mut BlockContext<'_, '_>) -> ReadResult<Option<(Code, FlowAction)>> {
    let words = running.words;
    let mut flow = None;
    check_exclusive_m_codes(words)?;
    for code in words.m.iter() {
        check_exists(*code)?;
        running.modals.m_code = Some(code.number as u8);
        let target = || match words.take(b'L') {
            Some(word) => Ok((integer(word, 0, MAX_BLOCK_NUMBER)?, word.at as usize)),
            None => fail2(code.at as usize, E::MissingWord, code.name('M', 2), "L"),
        };
        let step = match code.number {
            0 => continue,
            2 => match running.flow.local_sub() {
                Some(n) => return fail1(code.at as usize, E::EndInSub, format_args!("N{n:04}")),
                None => FlowAction::End,
            },
            97 => target().map(|(n, at)| FlowAction::GotoUnique { n, at })?,
            98 => target().map(|(n, at)| FlowAction::CallLocal { n, at })?,
            99 => FlowAction::Return { target: None, at: code.at as usize },
            number => {
                // L5: a check warns of a thread if the program has not started the spindle.
                running.modals.spindle_on =
                    number != SPINDLE_STOP && (running.modals.spindle_on || matches!(number, 3 | 4));
                running.ops.push(Op::M { code: number as u8, s: None, p: None, l: None });
                continue;
            }
        };
        flow = Some((*code, step));
    }
    Ok(flow)
}

/// Adds the M codes that act after the motion.
pub(super) fn after_motion(running: &mut BlockContext<'_, '_>) {
    for code in running.words.m.iter().filter(|code| matches!(code.number, 0 | 2)) {
        running.ops.push(Op::M { code: code.number as u8, s: None, p: None, l: None });
    }
}

/// `G22 L n`: executes the blocks up to G80 n times; L0000 skips them.
pub(super) fn begin_loop(running: &BlockContext<'_, '_>, at: usize) -> ReadResult<FlowAction> {
    match running.words.take(b'L') {
        Some(word) => Ok(FlowAction::BeginCountedLoop { times: integer(word, 0, MAX_REPEATS)?, at }),
        None => fail2(at, E::MissingWord, "G22", "L"),
    }
}
