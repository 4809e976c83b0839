//! The G codes of a block. Each is looked up in the table; none is ignored. Source: spec B2, K1.

use super::continuous;
use crate::defs::gcode::{Exists, GCode, Group};
use crate::defs::program_error::ProgramError as E;
use crate::nc::dialect::Running;
use crate::nc::fault::{Outcome, wrong, wrong1, wrong2};
use crate::nc::modal::{CycleWords, Motion};
use crate::nc::op::{PathMode, Plane, SpeedMode};
use crate::nc::words::{Code, Words};

/// The G codes of a block; modal ones are already applied to the modal state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plan {
    /// The one-shot function (group 00).
    pub once: Option<Code>,
    /// G66 or G67.
    pub call: Option<Code>,
    /// The function of group 01 in the block.
    pub motion: Option<Code>,
    /// The block contains G61 or G64.
    pub path: bool,
    /// The block contains G54–G59.
    pub frame: bool,
}

impl Plan {
    /// Whether the one-shot function has this number.
    #[inline]
    pub fn once_is(&self, number: u32) -> bool {
        self.once.is_some_and(|once| once.number == number)
    }

    /// Whether the block is a G65 or G66 call: its words are arguments.
    #[inline]
    pub fn is_macro_call(&self) -> bool {
        self.once_is(65) || self.call.is_some_and(|call| call.number == 66)
    }
}

/// Reads the G codes.
pub(super) fn read(running: &mut Running<'_, '_>) -> Outcome<Plan> {
    let mill = running.settings.is_mill();
    let mut plan = Plan::default();
    let mut taken = 0_u16;
    let mut absolute = None;
    let words = running.words;
    for code in words.g() {
        let row = look_up(*code, mill)?;
        // K1: on GC `G90` with another motion code means absolute, which is always active there.
        if code.number == 90 && !mill {
            if let Some(before) = absolute.replace(*code) {
                return double(*code, before);
            }
            continue;
        }
        let group = row.group_on(mill);
        if taken & 1 << group as u16 != 0 {
            return double_group(words, *code, group, mill);
        }
        taken |= 1 << group as u16;
        apply(running, &mut plan, group, *code);
    }
    if let Some(code) = absolute
        && plan.once.is_none()
    {
        match plan.motion {
            None => set_motion(running, &mut plan, code),
            Some(motion) if motion.number > 3 => return double(motion, code),
            Some(_) => {}
        }
    }
    Ok(plan)
}

/// The table row of a code, if this machine and version have it.
#[inline]
pub(super) fn look_up(code: Code, mill: bool) -> Outcome<&'static GCode> {
    let (at, name) = (code.at as usize, || format!("G{:02}", code.number));
    let Some(row) = GCode::find(code.number) else { return wrong1(at, E::UnknownG, name()) };
    match row.exists_on(mill) {
        Exists::Yes => Ok(row),
        Exists::Later => wrong1(at, E::LaterG, name()),
        Exists::No if code.number == 91 => wrong(at, E::IncrementalG91),
        Exists::No => wrong1(at, E::WrongKindG, name()),
    }
}

/// The error for a second code of the same group in the block.
#[cold]
fn double_group<T>(words: &Words, code: Code, group: Group, mill: bool) -> Outcome<T> {
    let same = |before: &&Code| GCode::find(before.number).is_some_and(|row| row.group_on(mill) == group);
    let before = words.g().iter().filter(|before| mill || before.number != 90).find(same);
    double(code, before.copied().unwrap_or(code))
}

#[cold]
fn double<T>(code: Code, before: Code) -> Outcome<T> {
    let (first, second) = (format!("G{:02}", before.number), format!("G{:02}", code.number));
    if code.number == before.number {
        return wrong1(code.at as usize, E::DoubleWord, second);
    }
    wrong2(code.at as usize, E::DoubleGroup, first, second)
}

#[inline]
fn set_motion(running: &mut Running<'_, '_>, plan: &mut Plan, code: Code) {
    plan.motion = Some(code);
    if let Some(motion) = Motion::from_g(code.number) {
        if motion != running.modals.motion {
            running.modals.cycle = CycleWords::default();
        }
        running.modals.motion = motion;
    }
}

#[inline]
fn apply(running: &mut Running<'_, '_>, plan: &mut Plan, group: Group, code: Code) {
    let modals = &mut *running.modals;
    match group {
        Group::Once => plan.once = Some(code),
        Group::Motion => set_motion(running, plan, code),
        Group::Speed => modals.speed_mode = if code.number == 96 { SpeedMode::SurfaceSpeed } else { modals.rotation },
        Group::Distance => modals.incremental = code.number == 91,
        Group::FeedMode => {
            let per_rev = matches!(code.number, 95 | 99);
            if per_rev != modals.per_rev {
                // DECISION: 100 mm/min must not become 100 mm/rev; a new F is required.
                modals.feed = None;
            }
            modals.per_rev = per_rev;
        }
        Group::Units => modals.inch = code.number == 20,
        Group::Compensation => {}
        Group::Call => plan.call = Some(code),
        Group::Frame => {
            plan.frame = true;
            modals.frame = code.number as u8;
        }
        Group::Path => {
            plan.path = true;
            let tolerance = running.settings.tolerance_mm;
            modals.path = if code.number == 61 { PathMode::ExactStop } else { continuous(tolerance) };
        }
        Group::Plane => {
            modals.plane = match code.number {
                17 => Plane::Xy,
                19 => Plane::Yz,
                _ => Plane::Zx,
            };
        }
    }
}
