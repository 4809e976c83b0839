//! The KT-820/KT-830 dialect: lathe system A on GC, modal G90/G91 on GS and GA.
//!
//! Order within a block (DECISION): modes, work offset, T, S, M codes that act before the motion, the move, dwell or
//! G50, M codes that act after the motion, then the jump or call. Source: spec B2, B4, K1, K3.14, K3.15.

mod auxiliary;
mod calls;
mod codes;
mod cycle;
mod grinding;
pub(super) mod index;
mod macro_a;
mod motion;
mod repetitive;
mod rules;

use self::codes::GrinderCodes;
pub(crate) use self::repetitive::RepetitiveCycleState;
pub(super) use self::rules::GrinderRules;
use super::common::{self, MAX_VALUE, out_of_range};
use super::{BlockContext, FlowAction};
use crate::defs::program_error::ProgramError as E;
use crate::nc::fault::{ReadResult, fail1};
use crate::nc::op::{Op, PathMode};
use crate::nc::words::{BlockWords, ValueKind, Word};
use crate::units::{Axis, MM_PER_INCH};

/// The letters X Y Z U V W.
const AXIS_WORDS: u32 = 1 << (b'X' - b'A')
    | 1 << (b'Y' - b'A')
    | 1 << (b'Z' - b'A')
    | 1 << (b'U' - b'A')
    | 1 << (b'V' - b'A')
    | 1 << (b'W' - b'A');

/// Executes a block of words.
fn execute(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
    let plan = codes::read_g_codes(running)?;
    if let Some(at) = running.words.address_only
        && !(plan.is_one_shot(27) && running.words.address_only_among(b"XYZ"))
    {
        return missing_number(running, at);
    }
    if plan.is_macro_call() {
        return calls::macro_call(running, &plan);
    }
    common::refuse_duplicate_address(running)?;
    running.words.take(b'O');
    apply_modes(running, &plan)?;
    running.words.take(b'T');
    if running.second_half {
        return execute_remainder(running, &plan);
    }
    auxiliary::tool_call(running)?;
    if !changes_coordinates(running, &plan) {
        return execute_remainder(running, &plan);
    }
    common::split_block(running, |running| execute_remainder(running, &plan))
}

/// Executes what follows the modes, the work offset and the tool.
fn execute_remainder(running: &mut BlockContext<'_, '_>, plan: &GrinderCodes) -> ReadResult<FlowAction> {
    auxiliary::spindle_speed(running, plan)?;
    let mut flow = auxiliary::before_motion(running)?;
    match plan.one_shot.map(|once| once.number) {
        Some(code) if repetitive::is_contour_cycle(code) => {
            if let Some(cycle) = repetitive::contour_cycle(running, code)? {
                flow = FlowAction::Contour(cycle);
            }
        }
        _ => execute_one_shot_or_move(running, plan)?,
    }
    auxiliary::after_motion(running)?;
    if let Some(unused) = running.words.unused() {
        return unknown_word(running, plan, unused);
    }
    if matches!(flow, FlowAction::Next)
        && let Some(call) = plan.modal_call
        && call.number == 67
    {
        return Ok(FlowAction::SetModalCall(None));
    }
    Ok(flow)
}

/// Checks the codes of a block that is not executed.
fn check_unexecuted(words: &BlockWords, mill: bool) -> ReadResult<()> {
    for code in words.g() {
        codes::look_up(*code, mill)?;
    }
    match words.m().iter().find(|code| !crate::defs::mcode::is_known(code.number)) {
        Some(code) => fail1(code.at as usize, E::UnknownM, format_args!("M{}", code.number)),
        None => Ok(()),
    }
}

/// Sets feed, path mode and work offset.
#[inline]
fn apply_modes(running: &mut BlockContext<'_, '_>, plan: &GrinderCodes) -> ReadResult<()> {
    // The F of G27 and G78 is not modal.
    if !(plan.is_one_shot(27) || plan.is_one_shot(78)) {
        let mm = if running.modals.inch { MM_PER_INCH } else { 1.0 };
        common::set_feed(running, mm)?;
    }
    common::push_modes(running, common::ModeChanges { path: plan.path_mode, frame: plan.work_offset });
    Ok(())
}

/// Whether the block changes its work offset or tool offset and also moves.
#[inline]
fn changes_coordinates(running: &BlockContext<'_, '_>, plan: &GrinderCodes) -> bool {
    let moves = running.words.has_any(AXIS_WORDS) && !plan.is_one_shot(4);
    moves && !plan.is_one_shot(10) && (plan.work_offset || running.words.has(b'T'))
}

fn execute_one_shot_or_move(running: &mut BlockContext<'_, '_>, plan: &GrinderCodes) -> ReadResult<()> {
    match plan.one_shot.map(|once| once.number) {
        // M35 has used the axis words.
        None if running.words.m().iter().any(|code| code.number == 35) => Ok(()),
        None => motion::modal_move(running, plan),
        Some(4) => motion::dwell(running),
        Some(10) => grinding::add_wear(running, motion::code_offset(running, 10)),
        Some(27) => grinding::dress_return(running),
        Some(35) => grinding::oscillation_on(running, motion::code_offset(running, 35)),
        Some(36) => {
            running.ops.push(Op::OscillationOff);
            Ok(())
        }
        Some(code @ (74 | 75)) => repetitive::grooving_cycle(running, code),
        Some(78) => grinding::gauge_move(running, motion::code_offset(running, 78)),
        Some(code @ (28 | 30)) => motion::return_to_reference(running, code),
        Some(31) => motion::skip(running),
        Some(50) => motion::set_coordinate_system(running),
        Some(53) => motion::machine_move(running),
        Some(_) => Ok(()),
    }
}

/// The length of a word in millimetres; applies inches and least increment.
#[inline]
fn length_mm(running: &BlockContext<'_, '_>, word: Word) -> ReadResult<f64> {
    let mut value = word.value;
    if word.kind == ValueKind::Integer
        && let Some(least) = running.settings.least_increment_mm
    {
        value *= least;
    }
    if running.modals.inch {
        value *= MM_PER_INCH;
    }
    if value.abs() > MAX_VALUE {
        return out_of_range(char::from(word.letter), word, "±99999.999");
    }
    Ok(value)
}

/// The value of a word that must be a whole number in a range.
fn integer(word: Word, low: u32, high: u32) -> ReadResult<u32> {
    common::integer(char::from(word.letter), word, low, high)
}

#[cold]
fn missing_number<T>(running: &BlockContext<'_, '_>, at: u32) -> ReadResult<T> {
    fail1(at as usize, E::MissingNumber, common::letter_at(running, at))
}

/// Reports an unknown word, or an axis word that the one-shot function does not use.
#[cold]
fn unknown_word<T>(running: &BlockContext<'_, '_>, plan: &GrinderCodes, word: Word) -> ReadResult<T> {
    if Axis::ALL.into_iter().any(|axis| axis_letters(axis).contains(&word.letter))
        && let Some(once) = plan.one_shot
    {
        return fail1(word.at as usize, E::AxisUnused, format_args!("G{:02}", once.number));
    }
    common::unknown_word(running.text, word)
}

/// The address letters of an axis: absolute and incremental.
#[inline]
const fn axis_letters(axis: Axis) -> [u8; 2] {
    match axis {
        Axis::X => [b'X', b'U'],
        Axis::Y => [b'Y', b'V'],
        Axis::Z => [b'Z', b'W'],
    }
}

const fn continuous_path(tolerance_mm: f64) -> PathMode {
    PathMode::Continuous { tolerance_mm }
}
