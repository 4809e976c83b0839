//! Macro A: calculation by `G65 Hm P#i Q#j R#k`. Source: spec B3.

use super::integer;
use crate::defs::program_error::ProgramError as E;
use crate::nc::dialect::{Running, Step};
use crate::nc::expression::{self, equal, whole};
use crate::nc::fault::{Outcome, wrong, wrong1, wrong2};
use crate::nc::functions::{from_bcd, sine, square_root, to_bcd};
use crate::nc::lexer::Cursor;
use crate::nc::op::Op;
use crate::nc::words::Word;

/// Highest block number of a jump.
const NUMBERS: u32 = 99_999_999;

/// Executes a `G65 Hm`. P is the result variable or the block to jump to; Q and R are values.
pub(super) fn run(running: &mut Running<'_, '_>) -> Outcome<Step> {
    let words = running.words;
    if let Some(double) = words.double {
        return wrong1(double as usize, E::DoubleWord, char::from(running.text[double as usize]));
    }
    let Some(h) = words.take(b'H') else { return Ok(Step::Next) };
    let code = integer(h, 0, 99)?;
    let extra = words.list().iter().find(|word| !matches!(word.letter, b'H' | b'P' | b'Q' | b'R' | b'O'));
    if let Some(extra) = extra {
        return wrong1(extra.at as usize, E::UnknownWord, char::from(extra.letter));
    }
    match code {
        80..=86 => jump(running, h, code),
        99 => {
            // DECISION: H99 P n raises alarm 3000 + n, as #3000 = n does.
            let p = need(running, h, b'P')?;
            running.ops.push(Op::Alarm { number: 3000 + integer(p, 0, 999)?, text: Box::default() });
            Ok(Step::Next)
        }
        _ => {
            let value = calculate(running, h, code)?;
            let (variable, at) = result_variable(running, h)?;
            Ok(Step::Assign { variable, value: Some(value), at })
        }
    }
}

fn jump(running: &Running<'_, '_>, h: Word, code: u32) -> Outcome<Step> {
    let p = need(running, h, b'P')?;
    let n = integer(p, 0, NUMBERS)?;
    let jumps = if code == 80 {
        true
    } else {
        let (q, r) = (operand(running, h, b'Q')?, operand(running, h, b'R')?);
        match code {
            81 => equal(q, r),
            82 => !equal(q, r),
            83 => q > r && !equal(q, r),
            84 => q < r && !equal(q, r),
            85 => q > r || equal(q, r),
            _ => q < r || equal(q, r),
        }
    };
    Ok(if jumps { Step::Goto { n, at: p.at as usize } } else { Step::Next })
}

fn calculate(running: &Running<'_, '_>, h: Word, code: u32) -> Outcome<f64> {
    let at = h.at as usize;
    let q = || operand(running, h, b'Q');
    let r = || operand(running, h, b'R');
    let bits = |act: fn(i64, i64) -> i64| -> Outcome<f64> {
        let (q, r) = (q()?, r()?);
        match (whole(q), whole(r)) {
            (Some(a), Some(b)) => Ok(act(a, b) as f64),
            _ => wrong2(at, E::Domain, format!("H{code}"), format!("{q}, {r}")),
        }
    };
    let domain = |value: Option<f64>, of: f64| match value {
        Some(value) => Ok(value),
        None => wrong2(at, E::Domain, format!("H{code}"), of.to_string()),
    };
    let by = |value: f64| if value.abs() <= 0.0 { wrong(at, E::DivisionByZero) } else { Ok(value) };
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
        26 => result_value(running, h)? * q()? / by(r()?)?,
        27 => q()?.hypot(r()?),
        31 => q()? * sine(r()?),
        32 => q()? * sine(r()? + 90.0),
        33 => q()? * sine(r()?) / by(sine(r()? + 90.0))?,
        34 => q()?.atan2(r()?).to_degrees(),
        _ => return wrong1(at, E::UnknownH, format!("H{code:02}")),
    };
    if value.is_finite() { Ok(value) } else { wrong(at, E::Overflow) }
}

fn need(running: &Running<'_, '_>, h: Word, letter: u8) -> Outcome<Word> {
    match running.words.look(letter) {
        Some(word) => Ok(word),
        None => wrong2(h.at as usize, E::MissingWord, format!("G65 H{:02}", h.value), char::from(letter)),
    }
}

/// The value of Q or R; null counts as 0.
fn operand(running: &Running<'_, '_>, h: Word, letter: u8) -> Outcome<f64> {
    match running.words.list().iter().find(|word| word.letter == letter) {
        Some(word) => Ok(word.value),
        None => need(running, h, letter).map(|word| word.value),
    }
}

/// The result variable `P#i`: its number is read again from the text, as the word holds its value.
fn result_variable(running: &mut Running<'_, '_>, h: Word) -> Outcome<(u32, usize)> {
    let Some(word) = running.words.list().iter().find(|word| word.letter == b'P') else {
        return wrong2(h.at as usize, E::MissingWord, format!("G65 H{:02}", h.value), "P");
    };
    let at = word.at as usize;
    let mut cursor = Cursor::window(running.text, at + 1);
    cursor.blank()?;
    if cursor.peek() != b'#' {
        return wrong1(at, E::BadStatement, "P#i");
    }
    Ok((expression::variable(&mut cursor, running.scope)?, at))
}

/// The present value of P, for H26.
fn result_value(running: &Running<'_, '_>, h: Word) -> Outcome<f64> {
    match running.words.list().iter().find(|word| word.letter == b'P') {
        Some(word) => Ok(word.value),
        None => need(running, h, b'P').map(|word| word.value),
    }
}
