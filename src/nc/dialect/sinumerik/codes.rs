//! The G codes of a block. Each is looked up; none is ignored. Source: spec S1.

use crate::defs::program_error::ProgramError as E;
use crate::nc::dialect::{BlockContext, common};
use crate::nc::fault::{ReadResult, fail2};
use crate::nc::modal::MotionMode;
use crate::nc::op::{PathMode, SpeedMode};
use crate::nc::words::{BlockWords, Code};
use crate::units::Plane;

/// Groups of G codes; a block may contain one code of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SinumerikGroup {
    /// G0 to G3.
    Motion,
    /// G4.
    Dwell,
    /// G18.
    Plane,
    /// G54 to G59.
    WorkOffset,
    /// G60 exact stop, G64 continuous.
    Path,
    /// G90, G91.
    Distance,
    /// G94 to G97: one group on this control; here G96 and G97 do not change the unit of F.
    Feed,
}

/// The G codes of a block; modal ones are already applied to the modal state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SinumerikCodes {
    /// G4.
    pub dwell: Option<Code>,
    /// The block contains G60 or G64.
    pub path_mode: bool,
    /// The block contains G54–G59.
    pub work_offset: bool,
    /// The motion function in the block.
    pub motion: Option<Code>,
}

const fn group_of(code: u32) -> Option<SinumerikGroup> {
    Some(match code {
        0..=3 => SinumerikGroup::Motion,
        4 => SinumerikGroup::Dwell,
        18 => SinumerikGroup::Plane,
        54..=59 => SinumerikGroup::WorkOffset,
        60 | 64 => SinumerikGroup::Path,
        90 | 91 => SinumerikGroup::Distance,
        94..=97 => SinumerikGroup::Feed,
        _ => return None,
    })
}

fn look_up(code: Code) -> ReadResult<SinumerikGroup> {
    match group_of(code.number) {
        Some(group) => Ok(group),
        // Other dialects select the unit of F by these codes.
        None if code.number == 98 => fail2(code.at as usize, E::UnknownCode, "G98", "G94 (mm/min) G95 (mm/r)"),
        None if code.number == 99 => fail2(code.at as usize, E::UnknownCode, "G99", "G95 (mm/r) G94 (mm/min)"),
        None => {
            let known: Vec<_> =
                (0..100).filter(|code| group_of(*code).is_some()).map(|code| format!("G{code}")).collect();
            fail2(code.at as usize, E::UnknownCode, format_args!("G{}", code.number), known.join(" "))
        }
    }
}

/// The group of a code; refuses it if the block already contains a code of the group.
fn exclusive_group(words: &BlockWords, index: usize) -> ReadResult<SinumerikGroup> {
    let code = words.g()[index];
    let group = look_up(code)?;
    match words.g()[..index].iter().find(|before| self::group_of(before.number) == Some(group)) {
        Some(before) => {
            let [first, second] = [*before, code].map(|code| format!("G{}", code.number));
            fail2(code.at as usize, E::DoubleGroup, first, second)
        }
        None => Ok(group),
    }
}

/// Checks the codes of a block that is not executed.
pub(super) fn check_codes(words: &BlockWords) -> ReadResult<()> {
    (0..words.g().len()).try_for_each(|index| exclusive_group(words, index).map(drop))?;
    words.m().iter().try_for_each(|code| super::check_m_code(*code))?;
    check_exclusive_m_codes(words)
}

/// Mutually exclusive M codes of a block: spindle, coolant.
const EXCLUSIVE_M_CODES: [&[u32]; 2] = [&[3, 4, 5], &[7, 8, 9]];

/// Refuses mutually exclusive M codes in one block, such as M3 and M4.
pub(super) fn check_exclusive_m_codes(words: &BlockWords) -> ReadResult<()> {
    common::check_exclusive_m_codes(words, &EXCLUSIVE_M_CODES, 1)
}

/// Reads the G codes.
pub(super) fn read_g_codes(running: &mut BlockContext<'_, '_>) -> ReadResult<SinumerikCodes> {
    let mut plan = SinumerikCodes::default();
    let words = running.words;
    for (index, code) in words.g().iter().enumerate() {
        let group = exclusive_group(words, index)?;
        apply_code(running, &mut plan, group, *code);
    }
    Ok(plan)
}

fn apply_code(running: &mut BlockContext<'_, '_>, plan: &mut SinumerikCodes, group: SinumerikGroup, code: Code) {
    let modals = &mut *running.modals;
    match group {
        SinumerikGroup::Motion => {
            plan.motion = Some(code);
            modals.motion = MotionMode::from_g(code.number).unwrap_or_default();
        }
        SinumerikGroup::Dwell => plan.dwell = Some(code),
        SinumerikGroup::Plane => modals.plane = Plane::Zx,
        SinumerikGroup::WorkOffset => {
            plan.work_offset = true;
            modals.work_offset = code.number as u8;
        }
        SinumerikGroup::Path => {
            plan.path_mode = true;
            let tolerance_mm = running.settings.tolerance_mm;
            modals.path_mode =
                if code.number == 60 { PathMode::ExactStop } else { PathMode::Continuous { tolerance_mm } };
        }
        SinumerikGroup::Distance => modals.incremental = code.number == 91,
        SinumerikGroup::Feed => match code.number {
            96 => modals.speed_mode = SpeedMode::SurfaceSpeed,
            97 => modals.speed_mode = modals.g97_mode,
            number => {
                let per_rev = number == 95;
                if per_rev != modals.per_rev {
                    // 100 mm/min must not become 100 mm/rev; a new F is required.
                    modals.feed = None;
                }
                modals.per_rev = per_rev;
            }
        },
    }
}
