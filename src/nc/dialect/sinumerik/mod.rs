//! The SINUMERIK 802D dialect, as far as the vertical lathe-grinder's programs use it: R parameters, `X=R20`, labels,
//! `IF … GOTOF`, `MSG("…")`, `L10 P3`.
//!
//! `read` turns a line into words or a statement, `expression` evaluates, `codes` checks the codes, `motion` returns
//! operations. Order within a block: R assignments, modes and work offset, S, M codes that act before the motion, the
//! move or dwell, M codes that act after the motion, then the call or return. Source: spec S1.

mod codes;
mod expression;
mod motion;
mod read;

pub(super) use self::read::read;

use self::codes::Plan;
use super::block::{self, LIMIT};
use super::{Running, Step};
use crate::defs::kind::System;
use crate::defs::mcode;
use crate::defs::program::{self, L_LAST};
use crate::defs::program_error::ProgramError as E;
use crate::nc::fault::{Outcome, wrong1, wrong2};
use crate::nc::flow::{Call, Callee};
use crate::nc::op::Op;
use crate::nc::words::{Code, Kind, Word, Words};

/// Checks a block that is not executed: known codes, unique and known addresses, a call in a block of its own.
pub(super) fn look(words: &Words, text: &[u8]) -> Outcome<()> {
    codes::look(words)?;
    if let Some(at) = words.double {
        let letter = text.get(at as usize).map_or('?', |byte| char::from(byte.to_ascii_uppercase()));
        return wrong1(at as usize, E::DoubleWord, letter);
    }
    if let Some(call) = words.look(b'L') {
        return alone(words, call);
    }
    match words.list().iter().find(|word| !LETTERS.contains(&word.letter)) {
        Some(word) => unknown_word(text, *word),
        None => Ok(()),
    }
}

/// The address letters of words, without N, G, M and L.
const LETTERS: &[u8] = &[b'X', b'Y', b'Z', b'I', b'J', b'K', b'F', b'S', RADIUS];

/// Refuses a call that is not in a block of its own.
fn alone(words: &Words, call: Word) -> Outcome<()> {
    let name = || format!("L{}", call.value);
    if let Some(code) = words.g().first() {
        return wrong2(code.at as usize, E::NotTogether, name(), format!("G{}", code.number));
    }
    if let Some(code) = words.m().first() {
        return wrong2(code.at as usize, E::NotTogether, name(), format!("M{}", code.number));
    }
    match words.list().iter().find(|word| !matches!(word.letter, b'L' | b'P')) {
        Some(word) => wrong2(word.at as usize, E::NotTogether, name(), letter(*word)),
        None => Ok(()),
    }
}

/// The subprogram that a block calls, and the byte of the call. `P0` does not call; `P=R32` is known only in the run.
pub(super) fn called(words: &Words) -> Option<(u32, usize)> {
    let call = words.look(b'L')?;
    let never = words.look(b'P').is_some_and(|word| word.kind != Kind::Digits || word.value <= 0.0);
    let number = crate::nc::expression::whole(call.value).and_then(|number| u32::try_from(number).ok())?;
    (!never && number <= L_LAST).then(|| (program::of_l(number), call.at as usize))
}

/// Most repetitions of a subprogram.
const REPEATS: u32 = 9_999;
/// The internal letter of `CR=`; R itself is never a word.
const RADIUS: u8 = b'R';
/// The internal M code of `RET`.
const RETURN: u32 = 17;

/// Executes a block of words.
pub(super) fn run(running: &mut Running<'_, '_>) -> Outcome<Step> {
    let plan = codes::read(running)?;
    block::refuse_double(running)?;
    if let Some(call) = running.words.take(b'L') {
        return subprogram(running, &plan, call);
    }
    modes(running, &plan)?;
    if running.second_half || !(plan.frame && motion::names_axes(running)) {
        return rest(running, &plan);
    }
    block::divided(running, |running| rest(running, &plan))
}

/// Executes what follows the modes and the work offset.
fn rest(running: &mut Running<'_, '_>, plan: &Plan) -> Outcome<Step> {
    if plan.dwell.is_none()
        && let Some(word) = running.words.take(b'S')
    {
        let value = within(word, 0.0)?;
        running.modals.speed = Some(value);
        running.ops.push(Op::S { value, mode: running.modals.speed_mode });
    }
    let flow = m_codes(running, false)?;
    match plan.dwell {
        Some(code) => motion::dwell(running, code)?,
        None => motion::modal(running, plan)?,
    }
    m_codes(running, true)?;
    match running.words.unused() {
        Some(word) => unknown_word(running.text, word),
        None => Ok(flow),
    }
}

/// Sets feed, path mode and work offset. The F of a dwell is a time.
fn modes(running: &mut Running<'_, '_>, plan: &Plan) -> Outcome<()> {
    if plan.dwell.is_none() {
        block::feed(running, 1.0)?;
    }
    block::modes(running, block::Modes { path: plan.path, frame: plan.frame });
    Ok(())
}

/// `L10 P3`: calls a subprogram P times, not at all if P is 0. It must be in a block of its own.
fn subprogram(running: &Running<'_, '_>, plan: &Plan, call: Word) -> Outcome<Step> {
    let words = running.words;
    let times = words.take(b'P').map_or(Ok(1), |word| integer(word, 0, REPEATS))?;
    let program = program::of_l(integer(call, 0, L_LAST)?);
    alone(words, call)?;
    debug_assert!(!plan.frame && !plan.path, "without G codes there is nothing to change");
    let at = call.at as usize;
    Ok(match times {
        0 => Step::Next,
        times => Step::Call(Call { program, times, callee: Callee::Sub, at }),
    })
}

/// Codes that act after the motion of the block.
const fn acts_after_motion(code: u32) -> bool {
    matches!(code, 0 | 1 | 2 | 5 | 9 | RETURN | 30 | 31 | 33 | 65)
}

/// Checks the M codes, adds those that act before (or after) the motion, and returns how the program continues.
fn m_codes(running: &mut Running<'_, '_>, after: bool) -> Outcome<Step> {
    let words = running.words;
    let mut flow = Step::Next;
    codes::one_direction(words)?;
    for code in words.m() {
        known(*code)?;
        if let (2 | RETURN | 30, Some(other)) = (code.number, words.m().iter().find(|other| other.at != code.at)) {
            let [first, second] = [code, other].map(|code| format!("M{}", code.number));
            return wrong2(code.at as usize, E::NotTogether, first, second);
        }
        flow = match code.number {
            // Every end of a subprogram except M30 returns to its caller.
            2 | RETURN if !running.flow.is_main() => Step::Return { target: None, at: code.at as usize },
            2 | RETURN | 30 => Step::End,
            _ => flow,
        };
        if after == acts_after_motion(code.number) {
            hand_out(running, *code);
        }
    }
    Ok(flow)
}

fn hand_out(running: &mut Running<'_, '_>, code: Code) {
    let code = match code.number {
        2 | RETURN if !running.flow.is_main() => return,
        RETURN => 2,
        number => number as u8,
    };
    running.modals.m = Some(code);
    running.ops.push(Op::M { code, s: None, p: None, l: None });
}

/// Accepts the M codes of the machine and M17; the error lists the valid codes.
fn known(code: Code) -> Outcome<()> {
    let exists =
        |number: u32| u16::try_from(number).is_ok_and(|code| mcode::find_in(System::Sinumerik, code).is_some());
    if code.number == RETURN || exists(code.number) {
        return Ok(());
    }
    let known: Vec<_> =
        (0..100).filter(|number| *number == RETURN || exists(*number)).map(|n| format!("M{n}")).collect();
    wrong2(code.at as usize, E::NoSuchCode, format!("M{}", code.number), known.join(" "))
}

/// The value of a word that must be a whole number in a range.
fn integer(word: Word, low: u32, high: u32) -> Outcome<u32> {
    block::integer(letter(word), word, low, high)
}

/// The value of a word, checked from `low` to the greatest programmable value.
fn within(word: Word, low: f64) -> Outcome<f64> {
    if (low..=LIMIT).contains(&word.value) { Ok(word.value) } else { out_of_range(word, "0–99999.999") }
}

/// The address of a word as written.
fn letter(word: Word) -> String {
    if word.letter == RADIUS { "CR".to_owned() } else { char::from(word.letter).to_string() }
}

#[cold]
fn out_of_range<T>(word: Word, range: &str) -> Outcome<T> {
    block::out_of_range(letter(word), word, range)
}

/// Reports an unknown word, as written up to the next blank.
#[cold]
fn unknown_word<T>(text: &[u8], word: Word) -> Outcome<T> {
    let at = word.at as usize;
    let rest = text.get(at..).unwrap_or_default();
    let length = rest.iter().position(|byte| matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | b';')).unwrap_or(rest.len());
    wrong1(at, E::UnknownWord, String::from_utf8_lossy(&rest[..length]).to_ascii_uppercase())
}
