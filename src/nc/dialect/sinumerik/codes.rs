//! The G codes of a block. Each is looked up; none is ignored. Source: spec S1.

use super::RETURN_M_CODE;
use crate::defs::gcode::GCodeGroup;
use crate::nc::dialect::codes::{self, BlockCodes};
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::words::{BlockWords, Code};
use crate::nc::work_offsets::{EXTRA_G, EXTRA_WORK_OFFSETS};

/// G500: no work offset; G505 and more: additional ones, here those of G54.1 P1 to P48 (DECISION).
const NO_OFFSET_G: u32 = 500;
const FIRST_EXTRA_G: u32 = 505;
const LAST_EXTRA_G: u32 = FIRST_EXTRA_G + EXTRA_WORK_OFFSETS as u32 - 1;

/// The number by which the work offset of a code is selected.
const fn work_offset_number(code: u32) -> u32 {
    match code {
        NO_OFFSET_G => EXTRA_G as u32,
        FIRST_EXTRA_G..=LAST_EXTRA_G => EXTRA_G as u32 + code - FIRST_EXTRA_G + 1,
        _ => code,
    }
}

/// The group of a code. G94 to G97 are one group on this control: each selects the unit of F and the unit of S.
const fn group_of(code: u32) -> Option<GCodeGroup> {
    Some(match code {
        0..=3 => GCodeGroup::Motion,
        4 | 9 | 53 | 74 | 75 | 153 => GCodeGroup::NonModal,
        18 => GCodeGroup::Plane,
        40..=42 => GCodeGroup::Compensation,
        54..=59 | NO_OFFSET_G | FIRST_EXTRA_G..=LAST_EXTRA_G => GCodeGroup::WorkOffset,
        601 | 602 => GCodeGroup::ExactStopWindow,
        60 | 64 => GCodeGroup::PathMode,
        70 | 71 | 700 | 710 => GCodeGroup::Units,
        90 | 91 => GCodeGroup::DistanceMode,
        94..=97 => GCodeGroup::FeedMode,
        _ => return None,
    })
}

/// Whether a message names the code: of the additional work offsets only the first.
fn is_named(code: &u32) -> bool {
    group_of(*code).is_some() && !(FIRST_EXTRA_G + 1..=LAST_EXTRA_G).contains(code)
}

fn look_up(code: Code) -> ReadResult<GCodeGroup> {
    match group_of(code.number) {
        Some(group) => Ok(group),
        // Other dialects select the unit of F by these codes.
        None if code.number == 98 => fail2(code.at as usize, E::UnknownCode, "G98", "G94 (mm/min) G95 (mm/r)"),
        None if code.number == 99 => fail2(code.at as usize, E::UnknownCode, "G99", "G95 (mm/r) G94 (mm/min)"),
        None if matches!(code.number, 17 | 19) => fail1(code.at as usize, E::WrongKindG, code.name('G', 2)),
        None => codes::refuse_unknown(code, 'G', 0, (0..1_000).filter(is_named)),
    }
}

/// The group of a code; refuses it if the block already contains a code of the group.
fn exclusive_group(words: &BlockWords, index: usize) -> ReadResult<GCodeGroup> {
    let code = words.g[index];
    let group = look_up(code)?;
    match words.g[..index].iter().find(|before| self::group_of(before.number) == Some(group)) {
        Some(before) => fail2(code.at as usize, E::DoubleGroup, before.name('G', 0), code.name('G', 0)),
        None => Ok(group),
    }
}

/// Checks the codes of a block that is not executed.
pub(super) fn check_codes(words: &BlockWords) -> ReadResult<()> {
    (0..words.g.len()).try_for_each(|index| exclusive_group(words, index).map(drop))?;
    words.m.iter().try_for_each(|code| super::check_m_code(*code))?;
    check_exclusive_m_codes(words)
}

/// Mutually exclusive M codes of a block: spindle, coolant, ends.
const EXCLUSIVE_M_CODES: [&[u32]; 3] = [&[3, 4, 5], &[7, 8, 9], &[2, RETURN_M_CODE, 30]];

/// Refuses mutually exclusive M codes in one block, such as M3 and M4.
pub(super) fn check_exclusive_m_codes(words: &BlockWords) -> ReadResult<()> {
    codes::check_exclusive_m_codes(words, &EXCLUSIVE_M_CODES, 1)
}

/// Reads the G codes.
pub(super) fn read_g_codes(running: &mut BlockContext<'_, '_>) -> ReadResult<BlockCodes> {
    let mut plan = BlockCodes::default();
    let words = running.words;
    for (index, code) in words.g.iter().enumerate() {
        let group = exclusive_group(words, index)?;
        let code = &Code { number: work_offset_number(code.number), ..*code };
        if group == GCodeGroup::FeedMode {
            plan.apply(running, GCodeGroup::SpindleSpeedMode, *code);
        }
        plan.apply(running, group, feed_code(*code));
    }
    Ok(plan)
}

/// The code that selects the unit of F: under G96 and G97 it is per revolution, as under G95.
const fn feed_code(code: Code) -> Code {
    match code.number {
        96 | 97 => Code { number: 95, ..code },
        _ => code,
    }
}
