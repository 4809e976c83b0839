//! The G codes of a block. Each is looked up in the table; none is ignored. Source: spec B2, K1.

use super::continuous_path;
use crate::defs::gcode::{Availability, GCode, GCodeGroup};
use crate::defs::program_error::ProgramError as E;
use crate::nc::dialect::BlockContext;
use crate::nc::fault::{ReadResult, fail, fail1, fail2};
use crate::nc::modal::{CycleWords, MotionMode};
use crate::nc::op::{PathMode, SpeedMode};
use crate::nc::words::{BlockWords, Code};
use crate::units::Plane;

/// The G codes of a block; modal ones are already applied to the modal state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GrinderCodes {
    /// The one-shot function (group 00).
    pub one_shot: Option<Code>,
    /// G66 or G67.
    pub modal_call: Option<Code>,
    /// The function of group 01 in the block.
    pub motion: Option<Code>,
    /// The block contains G61 or G64.
    pub path_mode: bool,
    /// The block contains G54–G59.
    pub work_offset: bool,
}

impl GrinderCodes {
    /// Whether the one-shot function has this number.
    #[inline]
    pub fn is_one_shot(&self, number: u32) -> bool {
        self.one_shot.is_some_and(|once| once.number == number)
    }

    /// Whether the block is a G65 or G66 call: its words are arguments.
    #[inline]
    pub fn is_macro_call(&self) -> bool {
        self.is_one_shot(65) || self.modal_call.is_some_and(|call| call.number == 66)
    }
}

/// Reads the G codes.
pub(super) fn read_g_codes(running: &mut BlockContext<'_, '_>) -> ReadResult<GrinderCodes> {
    let mill = running.settings.is_mill();
    let mut plan = GrinderCodes::default();
    let mut taken = 0_u16;
    let mut absolute = None;
    let words = running.words;
    for code in words.g() {
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
        apply_code(running, &mut plan, group, *code);
    }
    if let Some(code) = absolute
        && plan.one_shot.is_none()
    {
        match plan.motion {
            None => set_motion(running, &mut plan, code),
            Some(motion) if motion.number > 3 => return refuse_duplicate(motion, code),
            Some(_) => {}
        }
    }
    Ok(plan)
}

/// The table row of a code, if this machine and version have it.
#[inline]
pub(super) fn look_up(code: Code, mill: bool) -> ReadResult<&'static GCode> {
    let (at, name) = (code.at as usize, || format!("G{:02}", code.number));
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
    let before = words.g().iter().filter(|before| mill || before.number != 90).find(same);
    refuse_duplicate(code, before.copied().unwrap_or(code))
}

#[cold]
fn refuse_duplicate<T>(code: Code, before: Code) -> ReadResult<T> {
    let (first, second) = (format!("G{:02}", before.number), format!("G{:02}", code.number));
    if code.number == before.number {
        return fail1(code.at as usize, E::DoubleWord, second);
    }
    fail2(code.at as usize, E::DoubleGroup, first, second)
}

#[inline]
fn set_motion(running: &mut BlockContext<'_, '_>, plan: &mut GrinderCodes, code: Code) {
    plan.motion = Some(code);
    if let Some(motion) = MotionMode::from_g(code.number) {
        if motion != running.modals.motion {
            running.modals.cycle = CycleWords::default();
        }
        running.modals.motion = motion;
    }
}

#[inline]
fn apply_code(running: &mut BlockContext<'_, '_>, plan: &mut GrinderCodes, group: GCodeGroup, code: Code) {
    let modals = &mut *running.modals;
    match group {
        GCodeGroup::NonModal => plan.one_shot = Some(code),
        GCodeGroup::Motion => set_motion(running, plan, code),
        GCodeGroup::SpindleSpeedMode => {
            modals.speed_mode = if code.number == 96 { SpeedMode::SurfaceSpeed } else { modals.g97_mode }
        }
        GCodeGroup::DistanceMode => modals.incremental = code.number == 91,
        GCodeGroup::FeedMode => {
            let per_rev = matches!(code.number, 95 | 99);
            if per_rev != modals.per_rev {
                // DECISION: 100 mm/min must not become 100 mm/rev; a new F is required.
                modals.feed = None;
            }
            modals.per_rev = per_rev;
        }
        GCodeGroup::Units => modals.inch = code.number == 20,
        GCodeGroup::Compensation => {}
        GCodeGroup::ModalCall => plan.modal_call = Some(code),
        GCodeGroup::WorkOffset => {
            plan.work_offset = true;
            modals.work_offset = code.number as u8;
        }
        GCodeGroup::PathMode => {
            plan.path_mode = true;
            let tolerance = running.settings.tolerance_mm;
            modals.path_mode = if code.number == 61 { PathMode::ExactStop } else { continuous_path(tolerance) };
        }
        GCodeGroup::Plane => {
            modals.plane = match code.number {
                17 => Plane::Xy,
                19 => Plane::Yz,
                _ => Plane::Zx,
            };
        }
    }
}
