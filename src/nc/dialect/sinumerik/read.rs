//! One line: block number, label, then a statement or words. Reading evaluates and changes nothing. Source: spec S1.

use std::ops::Range;

use super::expression::{blanks, evaluate, evaluate_after, parameter};
use super::{RADIUS, RETURN};
use crate::defs::program_error::ProgramError as E;
use crate::nc::expression::{Frame, Scope, equal};
use crate::nc::fault::{Outcome, wrong, wrong1};
use crate::nc::lexer::Cursor;
use crate::nc::source::name;
use crate::nc::statement::{Content, Head};
use crate::nc::words::{Kind, Set, Word, Words};
use crate::units::Axis;

const CONDITION: &str = "IF a<b GOTOF …";

/// Opening and closing quotes: ASCII, then “ ” in UTF-8 and in GBK.
const QUOTES: [(&[u8], &[u8]); 3] =
    [(b"\"", b"\""), (&[0xe2, 0x80, 0x9c], &[0xe2, 0x80, 0x9d]), (&[0xa1, 0xb0], &[0xa1, 0xb1])];

/// Reads one line. Afterwards the cursor stands at its end.
pub(in crate::nc::dialect) fn read<S: Scope>(
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    words: &mut Words,
    head: Head,
) -> Outcome<Content> {
    words.clear();
    blanks(cursor);
    // `%_N_NAME_MPF` is the head of a file that came over the wire.
    if cursor.peek() == b'%' || cursor.take(b'/') && head.block_skip {
        cursor.rest_of_line();
        return Ok(Content::Nothing);
    }
    blanks(cursor);
    if matches!(cursor.peek(), b'N' | b'n') && cursor.peek_at(1).is_ascii_digit() {
        words.n = Some(block_number(cursor)?);
        blanks(cursor);
    }
    label(cursor);
    let content = body(cursor, scope, words)?;
    blanks(cursor);
    match cursor.peek() {
        b'\r' | b'\n' => {}
        b';' => cursor.rest_of_line(),
        _ => return unexpected(cursor),
    }
    Ok(content)
}

/// The fault for a byte that fits nowhere; round brackets are no comments here.
#[cold]
pub(super) fn unexpected<T>(cursor: &Cursor<'_>) -> Outcome<T> {
    match cursor.peek() {
        b'(' | b')' => wrong(cursor.at, E::UnbalancedRound),
        _ => cursor.unexpected(),
    }
}

fn block_number(cursor: &mut Cursor<'_>) -> Outcome<u32> {
    let at = cursor.at;
    cursor.at += 1;
    let number = cursor.number()?;
    if number.point || number.value > f64::from(u32::MAX) {
        return wrong1(at, E::NotWhole, "N");
    }
    Ok(number.value as u32)
}

/// Skips the label of the line.
fn label(cursor: &mut Cursor<'_>) {
    let Some(name) = name(&cursor.text[cursor.at.min(cursor.text.len())..]) else { return };
    let mut ahead = Cursor { at: cursor.at + name.len(), ..*cursor };
    blanks(&mut ahead);
    if ahead.take(b':') {
        blanks(&mut ahead);
        *cursor = ahead;
    }
}

/// Takes a keyword that no further letter or digit follows.
fn keyword(cursor: &mut Cursor<'_>, word: &str) -> bool {
    let found = name(&cursor.text[cursor.at.min(cursor.text.len())..]);
    let found = found.is_some_and(|name| name.eq_ignore_ascii_case(word.as_bytes()));
    cursor.at += if found { word.len() } else { 0 };
    found
}

fn body<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &mut Words) -> Outcome<Content> {
    let at = cursor.at;
    if keyword(cursor, "IF") {
        let holds = condition(cursor, scope)?;
        blanks(cursor);
        return match direction(cursor) {
            Some(forward) => jump(cursor, forward, holds),
            None => wrong1(cursor.at, E::BadCondition, CONDITION),
        };
    }
    if let Some(forward) = direction(cursor) {
        return jump(cursor, forward, true);
    }
    if keyword(cursor, "MSG") {
        return message(cursor);
    }
    if keyword(cursor, "STOPRE") {
        // What follows is read when the machine has got here.
        scope.axis_position(Axis::X, Frame::Machine, at)?;
        return Ok(Content::Nothing);
    }
    while block_word(cursor, scope, words)? {}
    Ok(if words.is_empty() { Content::Nothing } else { Content::Words })
}

/// `GOTOF` (true) or `GOTOB`.
fn direction(cursor: &mut Cursor<'_>) -> Option<bool> {
    if keyword(cursor, "GOTOF") {
        return Some(true);
    }
    keyword(cursor, "GOTOB").then_some(false)
}

fn jump(cursor: &mut Cursor<'_>, forward: bool, holds: bool) -> Outcome<Content> {
    blanks(cursor);
    let at = cursor.at;
    let Some(name) = name(&cursor.text[at.min(cursor.text.len())..]) else {
        return wrong1(at, E::MissingNumber, if forward { "GOTOF" } else { "GOTOB" });
    };
    cursor.at += name.len();
    Ok(Content::Jump { label: at..cursor.at, forward, holds })
}

fn condition<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> Outcome<bool> {
    const SIGNS: [&str; 6] = ["==", "<>", ">=", "<=", ">", "<"];
    let left = evaluate(cursor, scope)?;
    blanks(cursor);
    let at = cursor.at;
    let Some(sign) = SIGNS.into_iter().find(|sign| cursor.keyword(sign)) else {
        let what = if cursor.peek() == b'=' { "=" } else { CONDITION };
        return wrong1(at, E::BadCondition, what);
    };
    if matches!(cursor.peek(), b'=' | b'<' | b'>') {
        return wrong1(at, E::BadCondition, format!("{sign}{}", char::from(cursor.peek())));
    }
    let right = evaluate(cursor, scope)?;
    let equals = equal(left, right);
    Ok(match sign {
        "==" => equals,
        "<>" => !equals,
        ">=" => left > right || equals,
        "<=" => left < right || equals,
        ">" => left > right && !equals,
        _ => left < right && !equals,
    })
}

/// `MSG("…")`, `MSG(“…”)` or `MSG()`.
fn message(cursor: &mut Cursor<'_>) -> Outcome<Content> {
    blanks(cursor);
    let open = cursor.at;
    if !cursor.take(b'(') {
        return wrong1(open, E::BadStatement, "MSG(\"…\")");
    }
    blanks(cursor);
    let at = cursor.at;
    let text = if cursor.peek() == b')' { at..at } else { quoted(cursor)? };
    blanks(cursor);
    if cursor.take(b')') { Ok(Content::Note { text }) } else { wrong(open, E::UnbalancedRound) }
}

/// A text in quotes; the cursor stands behind it.
fn quoted(cursor: &mut Cursor<'_>) -> Outcome<Range<usize>> {
    let open = cursor.at;
    let rest = &cursor.text[open.min(cursor.text.len())..];
    let Some((begin, end)) = QUOTES.into_iter().find(|(begin, _)| rest.starts_with(begin)) else {
        return wrong(open, E::UnbalancedQuote);
    };
    let start = open + begin.len();
    // A character of GBK has two bytes from 0x81 on; its second may look like the beginning of another.
    let wide = begin == QUOTES[2].0;
    let mut at = start;
    loop {
        match cursor.text.get(at) {
            None | Some(b'\r' | b'\n') => return wrong(open, E::UnbalancedQuote),
            Some(_) if cursor.text[at..].starts_with(end) => break,
            Some(0x81..) if wide => at += 2,
            Some(_) => at += 1,
        }
    }
    cursor.at = at + end.len();
    Ok(start..at)
}

/// One word of a block; `false` where none begins.
fn block_word<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &mut Words) -> Outcome<bool> {
    blanks(cursor);
    let at = cursor.at;
    let start = at as u32;
    if let Some(found) = name(&cursor.text[at.min(cursor.text.len())..]) {
        if keyword(cursor, "RET") {
            words.add(Word { value: f64::from(RETURN), at: start, letter: b'M', kind: Kind::Digits })?;
            return Ok(true);
        }
        if keyword(cursor, "CR") {
            let value = assigned(cursor, scope, words, "CR")?;
            words.add(Word { value, at: start, letter: RADIUS, kind: Kind::Exact })?;
            return Ok(true);
        }
        return wrong1(at, E::UnknownWord, String::from_utf8_lossy(found).to_ascii_uppercase());
    }
    let letter = cursor.peek().to_ascii_uppercase();
    if !letter.is_ascii_alphabetic() {
        return Ok(false);
    }
    if letter == b'R' {
        let variable = parameter(cursor, scope, words.sets())?;
        let value = assigned(cursor, scope, words, "R")?;
        words.push_set(Set { variable, value, at: start })?;
        return Ok(true);
    }
    cursor.at += 1;
    blanks(cursor);
    let fixed = matches!(letter, b'G' | b'L' | b'N');
    let (value, kind) = match cursor.peek() {
        b'=' if fixed => return wrong1(at, E::DigitsOnly, char::from(letter)),
        b'=' => {
            cursor.at += 1;
            (evaluate_after(cursor, scope, words.sets())?, Kind::Exact)
        }
        b'0'..=b'9' | b'.' | b'+' | b'-' => number(cursor, letter)?,
        0x80.. => return cursor.unexpected(),
        _ => return wrong1(at, E::MissingNumber, char::from(letter)),
    };
    if letter == b'N' {
        return wrong1(at, E::DoubleWord, "N");
    }
    words.add(Word { value, at: start, letter, kind })?;
    Ok(true)
}

fn number(cursor: &mut Cursor<'_>, letter: u8) -> Outcome<(f64, Kind)> {
    let at = cursor.at;
    let negative = cursor.peek() == b'-';
    cursor.at += usize::from(matches!(cursor.peek(), b'+' | b'-'));
    if !cursor.at_number() {
        return wrong1(at, E::MissingNumber, char::from(letter));
    }
    let number = cursor.number()?;
    let kind = if number.point { Kind::Exact } else { Kind::Digits };
    Ok((if negative { -number.value } else { number.value }, kind))
}

/// The value after `=`.
fn assigned<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &Words, name: &str) -> Outcome<f64> {
    blanks(cursor);
    if !cursor.take(b'=') {
        return wrong1(cursor.at, E::MissingNumber, format!("{name}="));
    }
    evaluate_after(cursor, scope, words.sets())
}
