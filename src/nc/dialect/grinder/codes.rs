//! The G codes of a block. Each is looked up in the table; none is ignored. Source: spec B2, K1.

use crate::defs::gcode::{Availability, GCode, GCodeGroup};
use crate::nc::dialect::codes::BlockCodes;
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::{E, ReadResult, fail, fail1, fail2};
use crate::nc::words::{BlockWords, Code};

/// Reads the G codes.
pub(super) fn read_g_codes(running: &mut BlockContext<'_, '_>) -> ReadResult<BlockCodes> {
    let mill = running.settings.is_mill();
    let mut plan = BlockCodes::default();
    let mut taken = 0_u16;
    let mut absolute = None;
    let words = running.words;
    for code in words.g.iter() {
        let row = look_up(*code, mill)?;
        // K1: on GC `G90` with another motion code means absolute, which is always active there.
        if code.number == 90 && !mill {
            if let Some(before) = absolute.replace(*code) {
                return refuse_duplicate(*code, before);
            }
            continue;
        }
        let group = row.group_on(mill);
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
    Ok(plan)
}

/// The table row of a code, if this machine and version have it.
#[inline]
pub(super) fn look_up(code: Code, mill: bool) -> ReadResult<&'static GCode> {
    let (at, name) = (code.at as usize, || code.name('G', 2));
    let Some(row) = GCode::find(code.number) else { return fail1(at, E::UnknownG, name()) };
    match row.availability_on(mill) {
        Availability::Yes => Ok(row),
        Availability::NotYet => fail1(at, E::UnavailableG, name()),
        Availability::No if code.number == 91 => fail(at, E::IncrementalG91),
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
    let (first, second) = (before.name('G', 2), code.name('G', 2));
    if code.number == before.number {
        return fail1(code.at as usize, E::DoubleWord, second);
    }
    fail2(code.at as usize, E::DoubleGroup, first, second)
}
