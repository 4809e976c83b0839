//! Macro A: calculation by `G65 Hm P#i Q#j R#k`. Source: spec B3.

use super::integer;
use crate::defs::text::arg::Arg;
use crate::nc::dialect::rules::{BlockContext, FlowAction};
use crate::nc::expression;
use crate::nc::fault::{E, ReadResult, fail, fail1, fail2};
use crate::nc::functions::{Comparison, from_bcd, sin_degrees, square_root, to_bcd, whole_number};
use crate::nc::lexer::Cursor;
use crate::nc::op::Op;
use crate::nc::words::Word;

/// Highest block number of a jump.
const MAX_BLOCK_NUMBER: u32 = 99_999_999;

/// Executes a `G65 Hm`. P is the result variable or the block to jump to; Q and R are values.
pub(super) fn execute(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
    let words = running.words;
    if let Some(double) = words.duplicate {
        return fail1(double as usize, E::DoubleWord, char::from(running.text[double as usize]));
    }
    let Some(h) = words.take(b'H') else { return Ok(FlowAction::Next) };
    let code = integer(h, 0, 99)?;
    let extra = words.list.iter().find(|word| !matches!(word.letter, b'H' | b'P' | b'Q' | b'R' | b'O'));
    if let Some(extra) = extra {
        return fail1(extra.at as usize, E::UnknownWord, char::from(extra.letter));
    }
    match code {
        80..=86 => conditional_jump(running, h, code),
        99 => {
            // DECISION: H99 P n raises alarm 3000 + n, as #3000 = n does.
            let p = required_word(running, h, b'P')?;
            running.ops.push(Op::Alarm { number: 3000 + integer(p, 0, 999)?, text: Arg::None });
            Ok(FlowAction::Next)
        }
        _ => {
            let value = calculate(running, h, code)?;
            let (variable, at) = result_variable(running, h)?;
            Ok(FlowAction::Assign { variable, value: Some(value), at })
        }
    }
}

/// The conditions of H81 to H86. H80 jumps always.
const COMPARISONS: [Comparison; 6] =
    [Comparison::Eq, Comparison::Ne, Comparison::Gt, Comparison::Lt, Comparison::Ge, Comparison::Le];

fn conditional_jump(running: &BlockContext<'_, '_>, h: Word, code: u32) -> ReadResult<FlowAction> {
    let p = required_word(running, h, b'P')?;
    let n = integer(p, 0, MAX_BLOCK_NUMBER)?;
    let jumps = match COMPARISONS.get((code as usize).wrapping_sub(81)) {
        Some(compare) => compare.holds(operand_value(running, h, b'Q')?, operand_value(running, h, b'R')?),
        None => true,
    };
    let at = p.at as usize;
    Ok(if jumps { FlowAction::Goto { n, at } } else { FlowAction::GotoNotTaken { n, at } })
}

fn calculate(running: &BlockContext<'_, '_>, h: Word, code: u32) -> ReadResult<f64> {
    let at = h.at as usize;
    let q = || operand_value(running, h, b'Q');
    let r = || operand_value(running, h, b'R');
    let bits = |act: fn(i64, i64) -> i64| -> ReadResult<f64> {
        let (q, r) = (q()?, r()?);
        match (whole_number(q), whole_number(r)) {
            (Some(a), Some(b)) => Ok(act(a, b) as f64),
            _ => fail2(at, E::FunctionDomain, format_args!("H{code}"), format_args!("{q}, {r}")),
        }
    };
    let domain = |value: Option<f64>, of: f64| match value {
        Some(value) => Ok(value),
        None => fail2(at, E::FunctionDomain, format_args!("H{code}"), format_args!("{of}")),
    };
    let by = |value: f64| if value.abs() <= 0.0 { fail(at, E::DivisionByZero) } else { Ok(value) };
    let value = match code {
        1 => q()?,
        2 => q()? + r()?,
        3 => q()? - r()?,
        4 => q()? * r()?,
        5 => q()? / by(r()?)?,
        11 => bits(|a, b| a | b)?,
        12 => bits(|a, b| a & b)?,
        13 => bits(|a, b| a ^ b)?,
        21 => domain(square_root(q()?), q()?)?,
        22 => q()?.abs(),
        23 => q()? % by(r()?)?,
        24 => domain(from_bcd(q()?), q()?)?,
        25 => domain(to_bcd(q()?), q()?)?,
        26 => operand_value(running, h, b'P')? * q()? / by(r()?)?,
        27 => q()?.hypot(r()?),
        31 => q()? * sin_degrees(r()?),
        32 => q()? * sin_degrees(r()? + 90.0),
        33 => q()? * sin_degrees(r()?) / by(sin_degrees(r()? + 90.0))?,
        34 => q()?.atan2(r()?).to_degrees(),
        _ => return fail1(at, E::UnknownH, format_args!("H{code:02}")),
    };
    if value.is_finite() { Ok(value) } else { fail(at, E::Overflow) }
}

fn missing_word<T>(h: Word, letter: u8) -> ReadResult<T> {
    fail2(h.at as usize, E::MissingWord, format_args!("G65 H{:02}", h.value), char::from(letter))
}

fn required_word(running: &BlockContext<'_, '_>, h: Word, letter: u8) -> ReadResult<Word> {
    running.words.peek(letter).map_or_else(|| missing_word(h, letter), Ok)
}

/// The word of a letter, also from a null variable: its value is then 0.
fn null_or_word(running: &BlockContext<'_, '_>, h: Word, letter: u8) -> ReadResult<Word> {
    let found = running.words.list.iter().find(|word| word.letter == letter);
    found.copied().map_or_else(|| missing_word(h, letter), Ok)
}

/// The value of Q, R or (for H26) P; null counts as 0.
fn operand_value(running: &BlockContext<'_, '_>, h: Word, letter: u8) -> ReadResult<f64> {
    null_or_word(running, h, letter).map(|word| word.value)
}

/// The result variable `P#i`: its number is read again from the text, as the word holds its value.
fn result_variable(running: &mut BlockContext<'_, '_>, h: Word) -> ReadResult<(u32, usize)> {
    let at = null_or_word(running, h, b'P')?.at as usize;
    let mut cursor = Cursor::window(running.text, at + 1);
    cursor.skip_blanks()?;
    if cursor.peek() != b'#' {
        return fail1(at, E::BadStatement, "P#i");
    }
    Ok((expression::variable_number(&mut cursor, running.scope)?, at))
}
