//! The G codes of a block. Each is looked up in the table; none is ignored. Source: spec B2, K1.

use super::AXIS_WORDS;
use crate::defs::gcode::{Availability, GCode, GCodeGroup};
use crate::nc::dialect::codes::BlockCodes;
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::{E, ReadResult, fail, fail1, fail2};
use crate::nc::modal::CycleWords;
use crate::nc::words::{BlockWords, Code};
use crate::nc::work_offsets::{EXTRA_G, EXTRA_WORK_OFFSETS};

/// Reads the G codes.
#[inline]
pub(super) fn read_g_codes(running: &mut BlockContext<'_, '_>) -> ReadResult<BlockCodes> {
    let mill = running.settings.is_mill();
    let mut plan = BlockCodes::default();
    let mut taken = 0_u16;
    let mut absolute = None;
    let words = running.words;
    for code in words.g.iter() {
        // A preset of other G code systems: it has coordinates and no lead.
        let presets = words.has(b'S') || words.has_any(AXIS_WORDS) && !words.has(b'F');
        if code.number == 92 && !mill && presets {
            return fail(code.at as usize, E::PresetByG50);
        }
        // G05 with an end point is a curve of LinuxCNC.
        if code.number == 5 && words.has_any(AXIS_WORDS) {
            return fail1(code.at as usize, E::UnknownG, code.name('G', 2));
        }
        let row = look_up(*code, mill)?;
        // K1: on GC `G90` with another motion code means absolute, which is always active there.
        if code.number == 90 && !mill {
            absolute = Some(*code);
            continue;
        }
        let group = row.group_on(mill);
        // FANUC: the last code of a group counts. DECISION: only the same one may be repeated, as in `G01 G42 G01`.
        if taken & 1 << group as u16 != 0 && words.g.iter().any(|g| g.at < code.at && g.number == code.number) {
            continue;
        }
        if taken & 1 << group as u16 != 0 {
            return refuse_group(words, *code, group, mill);
        }
        taken |= 1 << group as u16;
        plan.apply(running, group, *code);
    }
    if let Some(code) = absolute
        && plan.one_shot.is_none()
    {
        match plan.motion {
            None => plan.set_motion(running, code),
            Some(motion) if motion.number > 3 => return refuse_duplicate(motion, code),
            Some(_) => {}
        }
    }
    // FANUC: codes of group 00 other than G04 end the words of the single cycles G90, G92 and G94.
    if !mill && plan.one_shot.is_some_and(|code| code.number != 4) {
        running.modals.cycle = CycleWords::default();
    }
    Ok(plan)
}

/// `G54.1 P_` or `G54 P_`: an additional work offset. P of another function in the block is not its own.
pub(super) fn extra_work_offset(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<()> {
    let words = running.words;
    let Some(code) = words.g.iter().find(|code| code.number == 54) else { return Ok(()) };
    let name = if words.has_extra_offset { "G54.1" } else { "G54" };
    let other_m = words.m.iter().find(|code| matches!(code.number, 20..=22 | 91 | 92 | 98 | 99));
    let other_g = plan.one_shot.filter(|code| !matches!(code.number, 9 | 50 | 53)).or(plan.modal_call);
    let other = other_g.map(|code| code.name('G', 2)).or(other_m.map(|code| code.name('M', 2)));
    match (words.has_extra_offset, other) {
        (true, Some(other)) => fail2(code.at as usize, E::NotTogether, name, other),
        (false, Some(_)) => Ok(()),
        (is_extra, None) => match words.take(b'P') {
            None if is_extra => fail2(code.at as usize, E::MissingWord, name, "P"),
            None => Ok(()),
            Some(word) => {
                let number = super::integer(word, 1, EXTRA_WORK_OFFSETS as u32)?;
                running.modals.work_offset = EXTRA_G + number as u8;
                Ok(())
            }
        },
    }
}

/// The table row of a code, if this machine and version have it.
#[inline]
pub(super) fn look_up(code: Code, mill: bool) -> ReadResult<&'static GCode> {
    let (at, name) = (code.at as usize, || code.name('G', 2));
    let Some(row) = GCode::find(code.number) else {
        let error = match code.number {
            5 => E::LookAheadCode,
            7 | 8 => E::RadiusMode,
            43 | 44 => E::LengthByT,
            // Grinding cycles of FANUC and Allen-Bradley, drilling cycles.
            77 | 79 | 81..=89 => E::CycleByTable,
            _ => E::UnknownG,
        };
        return fail1(at, error, name());
    };
    match row.availability_on(mill) {
        Availability::Yes => Ok(row),
        Availability::NoEncoder => fail1(at, E::NoEncoderG, name()),
        Availability::No if code.number == 91 => fail(at, E::IncrementalG91),
        Availability::No if code.number == 95 => fail(at, E::FeedPerRevByG99),
        Availability::No if mill && matches!(code.number, 71..=75) => fail1(at, E::CycleByTable, name()),
        Availability::No => fail1(at, E::WrongKindG, name()),
    }
}

/// The error for a second code of the same group in the block.
#[cold]
fn refuse_group<T>(words: &BlockWords, code: Code, group: GCodeGroup, mill: bool) -> ReadResult<T> {
    let same = |before: &&Code| GCode::find(before.number).is_some_and(|row| row.group_on(mill) == group);
    let before = words.g.iter().filter(|before| mill || before.number != 90).find(same);
    refuse_duplicate(code, before.copied().unwrap_or(code))
}

#[cold]
fn refuse_duplicate<T>(code: Code, before: Code) -> ReadResult<T> {
    // As a feed per minute it stands beside G90 or a motion code; on GS it has only G95 beside it.
    match [before, code].iter().find(|code| code.number == 94) {
        Some(cycle) if ![before.number, code.number].contains(&95) => fail(cycle.at as usize, E::FaceCycleG94),
        _ => fail2(code.at as usize, E::DoubleGroup, before.name('G', 2), code.name('G', 2)),
    }
}
