//! The G and M codes of a block, as far as the dialects share them. Source: spec B2, S1.

use super::rules::BlockContext;
use crate::defs::gcode::GCodeGroup;
use crate::nc::fault::{E, ReadResult, fail2};
use crate::nc::modal::{CycleWords, MotionMode};
use crate::nc::op::{Op, PathMode, SpeedMode};
use crate::nc::words::{BlockWords, Code};
use crate::units::Plane;

/// The G codes of a block; modal ones are already applied to the modal state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BlockCodes {
    /// The one-shot function (group 00).
    pub one_shot: Option<Code>,
    /// G66 or G67.
    pub modal_call: Option<Code>,
    /// The function of group 01 in the block.
    pub motion: Option<Code>,
    /// The block selects exact stop or continuous path.
    pub path_mode: bool,
    /// G40, G41 or G42.
    pub compensation: Option<Code>,
    /// The block contains G54–G59.
    pub work_offset: bool,
}

impl BlockCodes {
    /// Whether the one-shot function has this number.
    #[inline]
    pub fn is_one_shot(&self, number: u32) -> bool {
        self.one_shot.is_some_and(|once| once.number == number)
    }

    /// Notes a code of group 01 and makes it the active function.
    #[inline]
    pub fn set_motion(&mut self, running: &mut BlockContext<'_, '_>, code: Code) {
        self.motion = Some(code);
        if let Some(motion) = MotionMode::from_g(code.number) {
            if motion != running.modals.motion {
                running.modals.cycle = CycleWords::default();
            }
            running.modals.motion = motion;
        }
    }

    /// Notes a code and applies it to the modal state.
    #[inline]
    pub fn apply(&mut self, running: &mut BlockContext<'_, '_>, group: GCodeGroup, code: Code) {
        let modals = &mut *running.modals;
        match group {
            GCodeGroup::NonModal => self.one_shot = Some(code),
            GCodeGroup::Motion => self.set_motion(running, code),
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
                (modals.per_rev, modals.feed_unit_named) = (per_rev, true);
            }
            GCodeGroup::Units => {
                modals.inch = matches!(code.number, 20 | 70 | 700);
                modals.inch_feed = matches!(code.number, 20 | 700);
            }
            GCodeGroup::Compensation => self.compensation = Some(code),
            GCodeGroup::DrillingCycle | GCodeGroup::LengthCompensation => {}
            GCodeGroup::Rotation | GCodeGroup::ExactStopWindow => {}
            GCodeGroup::ModalCall => self.modal_call = Some(code),
            GCodeGroup::WorkOffset => {
                self.work_offset = true;
                modals.work_offset = code.number as u8;
            }
            GCodeGroup::PathMode => {
                self.path_mode = true;
                let continuous = PathMode::Continuous { tolerance_mm: running.settings.tolerance_mm };
                modals.path_mode = if code.number == 64 { continuous } else { PathMode::ExactStop };
            }
            GCodeGroup::Plane => {
                modals.plane_named = true;
                modals.plane = match code.number {
                    17 => Plane::Xy,
                    19 => Plane::Yz,
                    _ => Plane::Zx,
                };
            }
        }
    }

    /// Adds the operations for path mode and work offset; not again in the second half of a block.
    #[inline]
    pub fn push_modes(&self, running: &mut BlockContext<'_, '_>) {
        if running.second_half {
            return;
        }
        if self.path_mode {
            running.ops.push(Op::SetPathMode(running.modals.path_mode));
        }
        if self.work_offset {
            running.ops.push(Op::SelectWorkOffset { g: running.modals.work_offset });
        }
    }
}

/// M codes that act after the motion of their block: stops, ends, and what switches off.
pub(super) const fn acts_after_motion(code: u32) -> bool {
    matches!(code, 0 | 1 | 2 | 5 | 9 | 30 | 31 | 33 | 65)
}

/// Refuses a code that the dialect does not have; the error lists the codes that it has.
#[cold]
pub(super) fn refuse_unknown<T>(
    code: Code,
    letter: char,
    width: usize,
    known: impl Iterator<Item = u32>,
) -> ReadResult<T> {
    let known: Vec<_> = known.map(|number| Code { number, at: 0 }.name(letter, width).to_text()).collect();
    fail2(code.at as usize, E::UnknownCode, code.name(letter, width), known.join(" "))
}

/// Refuses another M code beside `code`. `width` is the number of digits of a code's name.
pub(super) fn check_stands_alone(words: &BlockWords, code: Code, width: usize) -> ReadResult<()> {
    match words.m.iter().find(|other| other.at != code.at) {
        Some(other) => fail2(code.at as usize, E::NotTogether, code.name('M', width), other.name('M', width)),
        None => Ok(()),
    }
}

/// Refuses M codes that exclude each other in one block. `width` is the number of digits of a code's name.
pub(super) fn check_exclusive_m_codes(words: &BlockWords, groups: &[&[u32]], width: usize) -> ReadResult<()> {
    for group in groups {
        let mut found = words.m.iter().filter(|code| group.contains(&code.number));
        if let (Some(first), Some(second)) = (found.next(), found.next())
            && first.number != second.number
        {
            return fail2(second.at as usize, E::DoubleGroup, first.name('M', width), second.name('M', width));
        }
    }
    Ok(())
}
