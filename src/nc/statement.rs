//! Reads one block: words, or a macro statement. Reading evaluates, but changes no state. Source: spec B1, B3.

use std::ops::Range;

use super::expression::{Frame, Scope, Value, evaluate, primary, variable, whole};
use super::fault::{Outcome, wrong, wrong1};
use super::lexer::Cursor;
use super::words::Words;
use crate::defs::program_error::ProgramError as E;
use crate::units::Axis;

/// Deepest nesting of `IF … THEN IF …` in one block.
const IF_DEPTH: usize = 8;

/// The content of a block.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Content {
    /// Empty, a comment, skipped, or an IF whose condition is false.
    Nothing,
    /// Words; they are in `Words`.
    Words,
    /// `#i = …`; `text` is the comment of #3000 and #3006.
    Assign { variable: u32, value: Value, at: usize, text: Option<Range<usize>> },
    /// GOTO n.
    Goto { n: u32, at: usize },
    /// WHILE […] DO m.
    While { holds: bool, number: u8, at: usize },
    /// END m.
    EndLoop { number: u8, at: usize },
    /// `%`.
    TextEnd { at: usize },
    /// A jump to a label, forward or backward; `holds`: the condition is true or missing.
    Jump { label: Range<usize>, forward: bool, holds: bool },
    /// A message that stays until the next one; an empty one clears it.
    Note { text: Range<usize> },
}

/// Context for reading a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Head {
    /// A block of the same line was already read, up to a `;`.
    pub mid_line: bool,
    /// The 跳段 (block skip) switch.
    pub block_skip: bool,
}

/// Reads one block. Afterwards the cursor is at the line end, or after a `;` that another block follows.
#[inline]
pub(crate) fn read<S: Scope>(
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    words: &mut Words,
    head: Head,
) -> Outcome<Content> {
    words.clear();
    let content = loop {
        cursor.blank()?;
        match cursor.peek() {
            b'\r' | b'\n' => break Content::Nothing,
            b'/' if cursor.peek_at(1) == b'/' => break Content::Nothing,
            b'/' => {
                cursor.at += 1;
                if head.block_skip {
                    cursor.rest_of_line();
                    return Ok(Content::Nothing);
                }
            }
            b';' if !head.mid_line => {
                cursor.rest_of_line();
                return Ok(Content::Nothing);
            }
            b'N' | b'n' if words.n.is_none() => words.n = Some(block_number(cursor)?),
            _ => break body(cursor, scope, words, 0)?,
        }
    };
    tail(cursor)?;
    Ok(content)
}

/// Whether another block follows on the line, behind a `;`.
#[inline]
pub(crate) fn goes_on(cursor: &Cursor<'_>) -> bool {
    !cursor.at_line_end() && !cursor.is_over()
}

#[inline]
fn block_number(cursor: &mut Cursor<'_>) -> Outcome<u32> {
    let at = cursor.at;
    cursor.at += 1;
    cursor.blank()?;
    if !cursor.at_number() {
        return wrong1(at, E::MissingNumber, "N");
    }
    let number = cursor.number()?;
    if number.point || number.value > f64::from(u32::MAX) {
        return wrong1(at, E::NotWhole, "N");
    }
    Ok(number.value as u32)
}

fn body<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &mut Words, depth: usize) -> Outcome<Content> {
    let at = cursor.at;
    match cursor.peek() {
        b'#' => assign(cursor, scope),
        // DECISION: the end mark of old DOS texts (0x1A) ends a text as `%` does.
        b'%' | 0x1a => {
            cursor.at += 1;
            Ok(Content::TextEnd { at })
        }
        b'I' | b'i' if cursor.keyword("IF") => condition(cursor, scope, words, depth),
        b'W' | b'w' if cursor.keyword("WHILE") => {
            let holds = holds(evaluate(cursor, scope)?);
            cursor.blank()?;
            if !cursor.keyword("DO") {
                return wrong1(cursor.at, E::BadStatement, "WHILE […] DO m");
            }
            Ok(Content::While { holds, number: loop_number(cursor)?, at })
        }
        b'E' | b'e' if cursor.keyword("END") => Ok(Content::EndLoop { number: loop_number(cursor)?, at }),
        b'G' | b'g' if cursor.keyword("GOTO") => {
            cursor.blank()?;
            if matches!(cursor.peek(), b'N' | b'n') {
                cursor.at += 1;
                cursor.blank()?;
            }
            if !(cursor.at_number() || matches!(cursor.peek(), b'#' | b'[')) {
                return wrong1(at, E::MissingNumber, "GOTO");
            }
            let target = primary(cursor, scope)?;
            if target.is_none() && !S::STRICT {
                return Ok(Content::Goto { n: 0, at });
            }
            match whole(target.unwrap_or(0.0)).map(u32::try_from) {
                Some(Ok(n)) => Ok(Content::Goto { n, at }),
                Some(Err(_)) | None => wrong1(at, E::NotWhole, "GOTO"),
            }
        }
        byte if byte.is_ascii_alphabetic() => {
            words.read(cursor, scope)?;
            Ok(Content::Words)
        }
        b';' | b'\r' | b'\n' => Ok(Content::Nothing),
        _ => cursor.unexpected(),
    }
}

fn holds(value: Value) -> bool {
    value.is_some_and(|value| value.abs() > 1e-12)
}

fn loop_number(cursor: &mut Cursor<'_>) -> Outcome<u8> {
    cursor.blank()?;
    let at = cursor.at;
    if !cursor.at_number() {
        return wrong1(at, E::DoNumber, "");
    }
    let number = cursor.number()?;
    match whole(number.value) {
        Some(number @ 1..=3) => Ok(number as u8),
        Some(_) | None => wrong1(at, E::DoNumber, number.value.to_string()),
    }
}

fn condition<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &mut Words, depth: usize) -> Outcome<Content> {
    if depth >= IF_DEPTH {
        return wrong(cursor.at, E::TooComplex);
    }
    let holds = holds(evaluate(cursor, scope)?);
    cursor.blank()?;
    let then = cursor.at;
    let thens = cursor.keyword("THEN");
    cursor.blank()?;
    let at = cursor.at;
    let jumps = matches!(cursor.peek(), b'G' | b'g') && matches!(cursor.peek_at(1), b'O' | b'o');
    if !(thens || jumps) {
        return wrong1(then, E::BadStatement, "IF […] GOTO n / THEN");
    }
    let content = if holds {
        body(cursor, scope, words, depth + 1)?
    } else {
        // The rest is still read, to report mistakes and to find a block after `;`.
        let n = words.n;
        let content = body(cursor, &mut Blank, words, depth + 1)?;
        words.clear();
        words.n = n;
        content
    };
    match content {
        Content::Nothing
        | Content::While { .. }
        | Content::EndLoop { .. }
        | Content::TextEnd { .. }
        | Content::Jump { .. }
        | Content::Note { .. }
            if depth == 0 || holds =>
        {
            if matches!(content, Content::Nothing) && at < cursor.at {
                return Ok(Content::Nothing);
            }
            wrong1(at, E::BadStatement, "IF […] THEN")
        }
        content if holds => Ok(content),
        _ => Ok(Content::Nothing),
    }
}

fn assign<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> Outcome<Content> {
    let at = cursor.at;
    let variable = variable(cursor, scope)?;
    cursor.blank()?;
    if cursor.peek() != b'=' || cursor.peek_at(1) == b'=' {
        return wrong1(cursor.at, E::BadStatement, "#i = …");
    }
    cursor.at += 1;
    cursor.blank()?;
    let start = cursor.at;
    if matches!(cursor.peek(), b'\r' | b'\n' | b';') {
        return wrong1(at, E::MissingNumber, format!("#{variable}="));
    }
    let value = evaluate(cursor, scope)?;
    cursor.blank()?;
    let text = matches!(variable, 3000 | 3006).then(|| comment(cursor, start)).flatten();
    Ok(Content::Assign { variable, value, at, text })
}

fn comment(cursor: &Cursor<'_>, start: usize) -> Option<Range<usize>> {
    let read = cursor.text.get(start..cursor.at)?;
    let open = read.iter().position(|byte| *byte == b'(')? + 1;
    let length = read[open..].iter().position(|byte| *byte == b')')?;
    Some(start + open..start + open + length)
}

/// Reads the end of a block: line end, comment, or `;` with another block.
#[inline]
fn tail(cursor: &mut Cursor<'_>) -> Outcome<()> {
    match cursor.peek() {
        b'\r' | b'\n' => Ok(()),
        b';' => {
            cursor.at += 1;
            if !is_block(*cursor) {
                cursor.rest_of_line();
            }
            Ok(())
        }
        b'/' if cursor.peek_at(1) == b'/' => {
            cursor.rest_of_line();
            Ok(())
        }
        // After GOTO 40, DO1 and END1.
        b' ' | b'\t' | b'(' => {
            cursor.blank()?;
            tail(cursor)
        }
        _ => cursor.unexpected(),
    }
}

/// DECISION: the text after `;` is a block if all of it, up to the next `;`, is words or a statement.
/// Everything else is a comment. A check warns of such a block.
#[cold]
fn is_block(mut cursor: Cursor<'_>) -> bool {
    let mut words = Words::default();
    while cursor.take(b';') || cursor.take(b' ') {}
    let said = block(&mut cursor, &mut words);
    let closed = cursor.blank().is_ok() && matches!(cursor.peek(), b'\r' | b'\n' | b';');
    closed && words.bare.is_none() && matches!(said, Ok(true))
}

/// Checks the syntax of a block with its `/` and its number; returns whether it contains anything else. An IF counts
/// even if its condition is false.
fn block(cursor: &mut Cursor<'_>, words: &mut Words) -> Outcome<bool> {
    cursor.blank()?;
    if cursor.peek() == b'/' && cursor.peek_at(1) != b'/' {
        cursor.at += 1;
        cursor.blank()?;
    }
    if matches!(cursor.peek(), b'N' | b'n') {
        words.n = Some(block_number(cursor)?);
        cursor.blank()?;
    }
    let at = cursor.at;
    body(cursor, &mut Blank, words, 0)?;
    Ok(cursor.at > at)
}

/// The start of the block after the next `;`, for the block that begins at `at`; `text` ends with its line.
pub(crate) fn behind(text: &[u8], at: usize, mid_line: bool) -> Option<usize> {
    let mut cursor = Cursor::window(text, at);
    cursor.blank().ok()?;
    if cursor.peek() == b';' && !mid_line {
        return None;
    }
    while !matches!(cursor.peek(), b';' | b'\r' | b'\n') {
        if cursor.peek() == b'/' && cursor.peek_at(1) == b'/' {
            return None;
        }
        cursor.at += 1;
        cursor.blank().ok()?;
    }
    (cursor.take(b';') && is_block(cursor)).then_some(cursor.at)
}

/// A scope without values, for syntax checks.
pub(crate) struct Blank;

impl Scope for Blank {
    const STRICT: bool = false;

    fn read(&mut self, _number: u32, _at: usize) -> Outcome<Value> {
        Ok(None)
    }

    fn axis_position(&mut self, _axis: Axis, _frame: Frame, _at: usize) -> Outcome<Value> {
        Ok(None)
    }

    fn null_used(&mut self, _at: usize) {}
}
