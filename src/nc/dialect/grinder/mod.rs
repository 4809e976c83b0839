//! The KT-820/KT-830 dialect: lathe system A on GC, modal G90/G91 on GS and GA.
//!
//! Order within a block (DECISION): modes, work offset, T, S, M codes that act before the motion, the move, dwell or
//! G50, M codes that act after the motion, then the jump or call. Source: spec B2, B4, K1, K3.14, K3.15.

mod auxiliary;
mod calls;
mod codes;
mod cycle;
mod grinding;
mod macro_a;
mod motion;
mod repetitive;

use self::codes::Plan;
pub(crate) use self::repetitive::RepeatWords;
use super::block::{self, LIMIT, out_of_range};
use super::{Running, Step};
use crate::defs::program_error::ProgramError as E;
use crate::nc::fault::{Outcome, wrong1};
use crate::nc::op::{Op, PathMode};
use crate::nc::settings::Settings;
use crate::nc::words::{Kind, Word, Words};
use crate::units::{Axis, MM_PER_INCH};

/// The letters X Y Z U V W.
const AXIS_WORDS: u32 = 1 << (b'X' - b'A')
    | 1 << (b'Y' - b'A')
    | 1 << (b'Z' - b'A')
    | 1 << (b'U' - b'A')
    | 1 << (b'V' - b'A')
    | 1 << (b'W' - b'A');

/// Executes a block of words.
pub(super) fn run(running: &mut Running<'_, '_>) -> Outcome<Step> {
    let plan = codes::read(running)?;
    if let Some(at) = running.words.bare
        && !(plan.once_is(27) && running.words.bare_only(b"XYZ"))
    {
        return missing_number(running, at);
    }
    if plan.is_macro_call() {
        return calls::macro_call(running, &plan);
    }
    block::refuse_double(running)?;
    running.words.take(b'O');
    modes(running, &plan)?;
    running.words.take(b'T');
    if running.second_half {
        return rest(running, &plan);
    }
    auxiliary::tool(running)?;
    if !changes_position(running, &plan) {
        return rest(running, &plan);
    }
    block::divided(running, |running| rest(running, &plan))
}

/// Executes what follows the modes, the work offset and the tool.
fn rest(running: &mut Running<'_, '_>, plan: &Plan) -> Outcome<Step> {
    auxiliary::speed(running, plan)?;
    let mut flow = auxiliary::before_motion(running)?;
    match plan.once.map(|once| once.number) {
        Some(code) if repetitive::is_contour_cycle(code) => {
            if let Some(cycle) = repetitive::contour(running, code)? {
                flow = Step::Contour(cycle);
            }
        }
        _ => once_or_move(running, plan)?,
    }
    auxiliary::after_motion(running)?;
    if let Some(unused) = running.words.unused() {
        return unknown_word(running, plan, unused);
    }
    if matches!(flow, Step::Next)
        && let Some(call) = plan.call
        && call.number == 67
    {
        return Ok(Step::Modal(None));
    }
    Ok(flow)
}

/// Checks the codes of a block that is not executed.
pub(super) fn look(words: &Words, settings: &Settings) -> Outcome<()> {
    for code in words.g() {
        codes::look_up(*code, settings.is_mill())?;
    }
    match words.m().iter().find(|code| !crate::defs::mcode::is_known(code.number)) {
        Some(code) => wrong1(code.at as usize, E::UnknownM, format!("M{}", code.number)),
        None => Ok(()),
    }
}

/// Sets feed, path mode and work offset.
#[inline]
fn modes(running: &mut Running<'_, '_>, plan: &Plan) -> Outcome<()> {
    // The F of G27 and G78 is not modal.
    if !(plan.once_is(27) || plan.once_is(78)) {
        let mm = if running.modals.inch { MM_PER_INCH } else { 1.0 };
        block::feed(running, mm)?;
    }
    block::modes(running, block::Modes { path: plan.path, frame: plan.frame });
    Ok(())
}

/// Whether the block changes its work offset or tool offset and also moves.
#[inline]
fn changes_position(running: &Running<'_, '_>, plan: &Plan) -> bool {
    let moves = running.words.has_any(AXIS_WORDS) && !plan.once_is(4);
    moves && !plan.once_is(10) && (plan.frame || running.words.has(b'T'))
}

fn once_or_move(running: &mut Running<'_, '_>, plan: &Plan) -> Outcome<()> {
    match plan.once.map(|once| once.number) {
        // M35 has used the axis words.
        None if running.words.m().iter().any(|code| code.number == 35) => Ok(()),
        None => motion::modal(running, plan),
        Some(4) => motion::dwell(running),
        Some(10) => grinding::add_wear(running, motion::code_place(running, 10)),
        Some(27) => grinding::dress_return(running),
        Some(35) => grinding::oscillation(running, motion::code_place(running, 35)),
        Some(36) => {
            running.ops.push(Op::OscillationOff);
            Ok(())
        }
        Some(code @ (74 | 75)) => repetitive::groove(running, code),
        Some(78) => grinding::gauge(running, motion::code_place(running, 78)),
        Some(code @ (28 | 30)) => motion::reference(running, code),
        Some(31) => motion::skip(running),
        Some(50) => motion::preset(running),
        Some(53) => motion::machine(running),
        Some(_) => Ok(()),
    }
}

/// The length of a word in millimetres; applies inches and least increment.
#[inline]
fn length(running: &Running<'_, '_>, word: Word) -> Outcome<f64> {
    let mut value = word.value;
    if word.kind == Kind::Digits
        && let Some(least) = running.settings.least_increment_mm
    {
        value *= least;
    }
    if running.modals.inch {
        value *= MM_PER_INCH;
    }
    if value.abs() > LIMIT {
        return out_of_range(char::from(word.letter), word, "±99999.999");
    }
    Ok(value)
}

/// The value of a word that must be a whole number in a range.
fn integer(word: Word, low: u32, high: u32) -> Outcome<u32> {
    block::integer(char::from(word.letter), word, low, high)
}

#[cold]
fn missing_number<T>(running: &Running<'_, '_>, at: u32) -> Outcome<T> {
    wrong1(at as usize, E::MissingNumber, block::letter_at(running, at))
}

/// Reports an unknown word, as written up to the next letter or blank.
#[cold]
fn unknown_word<T>(running: &Running<'_, '_>, plan: &Plan, word: Word) -> Outcome<T> {
    let at = word.at as usize;
    let rest = running.text.get(at..).unwrap_or_default();
    let ends = |byte: &u8| !matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+' | b'#' | b'[' | b']');
    let length = rest.iter().skip(1).position(ends).map_or(rest.len(), |length| length + 1);
    let text = String::from_utf8_lossy(&rest[..length]).to_ascii_uppercase();
    if Axis::ALL.into_iter().any(|axis| axis_letters(axis).contains(&word.letter))
        && let Some(once) = plan.once
    {
        return wrong1(at, E::AxisUnused, format!("G{:02}", once.number));
    }
    wrong1(at, E::UnknownWord, text)
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

const fn continuous(tolerance_mm: f64) -> PathMode {
    PathMode::Continuous { tolerance_mm }
}
