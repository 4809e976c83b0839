//! The G codes of a block. Each is looked up; none is ignored. Source: spec S1.

use crate::defs::program_error::ProgramError as E;
use crate::nc::dialect::Running;
use crate::nc::fault::{Outcome, wrong2};
use crate::nc::modal::Motion;
use crate::nc::op::{PathMode, Plane, SpeedMode};
use crate::nc::words::{Code, Words};

/// Groups of G codes; a block may contain one code of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    /// G0 to G3.
    Motion,
    /// G4.
    Once,
    /// G18.
    Plane,
    /// G54 to G59.
    Frame,
    /// G60 exact stop, G64 continuous.
    Path,
    /// G90, G91.
    Distance,
    /// G94 to G97: one group on this control; here G96 and G97 do not change the unit of F.
    Feed,
}

/// The G codes of a block; modal ones are already applied to the modal state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plan {
    /// G4.
    pub dwell: Option<Code>,
    /// The block contains G60 or G64.
    pub path: bool,
    /// The block contains G54–G59.
    pub frame: bool,
    /// The motion function in the block.
    pub motion: Option<Code>,
}

const fn group(code: u32) -> Option<Group> {
    Some(match code {
        0..=3 => Group::Motion,
        4 => Group::Once,
        18 => Group::Plane,
        54..=59 => Group::Frame,
        60 | 64 => Group::Path,
        90 | 91 => Group::Distance,
        94..=97 => Group::Feed,
        _ => return None,
    })
}

fn look_up(code: Code) -> Outcome<Group> {
    match group(code.number) {
        Some(group) => Ok(group),
        // Other dialects select the unit of F by these codes.
        None if code.number == 98 => wrong2(code.at as usize, E::NoSuchCode, "G98", "G94 (mm/min) G95 (mm/r)"),
        None if code.number == 99 => wrong2(code.at as usize, E::NoSuchCode, "G99", "G95 (mm/r) G94 (mm/min)"),
        None => {
            let known: Vec<_> = (0..100).filter(|code| group(*code).is_some()).map(|code| format!("G{code}")).collect();
            wrong2(code.at as usize, E::NoSuchCode, format!("G{}", code.number), known.join(" "))
        }
    }
}

/// The group of a code; refuses it if the block already contains a code of the group.
fn by_itself(words: &Words, index: usize) -> Outcome<Group> {
    let code = words.g()[index];
    let group = look_up(code)?;
    match words.g()[..index].iter().find(|before| self::group(before.number) == Some(group)) {
        Some(before) => {
            let [first, second] = [*before, code].map(|code| format!("G{}", code.number));
            wrong2(code.at as usize, E::DoubleGroup, first, second)
        }
        None => Ok(group),
    }
}

/// Checks the codes of a block that is not executed.
pub(super) fn look(words: &Words) -> Outcome<()> {
    (0..words.g().len()).try_for_each(|index| by_itself(words, index).map(drop))?;
    words.m().iter().try_for_each(|code| super::known(*code))?;
    one_direction(words)
}

/// Mutually exclusive M codes of a block: spindle, coolant.
const EXCLUSIVE: [&[u32]; 2] = [&[3, 4, 5], &[7, 8, 9]];

/// Refuses mutually exclusive M codes in one block, such as M3 and M4.
pub(in crate::nc::dialect) fn one_direction(words: &Words) -> Outcome<()> {
    for codes in EXCLUSIVE {
        let mut found = words.m().iter().filter(|code| codes.contains(&code.number));
        if let (Some(first), Some(second)) = (found.next(), found.next())
            && first.number != second.number
        {
            let [a, b] = [first, second].map(|code| format!("M{}", code.number));
            return wrong2(second.at as usize, E::DoubleGroup, a, b);
        }
    }
    Ok(())
}

/// Reads the G codes.
pub(super) fn read(running: &mut Running<'_, '_>) -> Outcome<Plan> {
    let mut plan = Plan::default();
    let words = running.words;
    for (index, code) in words.g().iter().enumerate() {
        let group = by_itself(words, index)?;
        apply(running, &mut plan, group, *code);
    }
    Ok(plan)
}

fn apply(running: &mut Running<'_, '_>, plan: &mut Plan, group: Group, code: Code) {
    let modals = &mut *running.modals;
    match group {
        Group::Motion => {
            plan.motion = Some(code);
            modals.motion = Motion::from_g(code.number).unwrap_or_default();
        }
        Group::Once => plan.dwell = Some(code),
        Group::Plane => modals.plane = Plane::Zx,
        Group::Frame => {
            plan.frame = true;
            modals.frame = code.number as u8;
        }
        Group::Path => {
            plan.path = true;
            let tolerance_mm = running.settings.tolerance_mm;
            modals.path = if code.number == 60 { PathMode::ExactStop } else { PathMode::Continuous { tolerance_mm } };
        }
        Group::Distance => modals.incremental = code.number == 91,
        Group::Feed => match code.number {
            96 => modals.speed_mode = SpeedMode::SurfaceSpeed,
            97 => modals.speed_mode = modals.rotation,
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
