//! Reads one line: block number, label, then a statement or words. Changes no state. Source: spec S1.

use std::ops::Range;

use super::expression::{blanks, evaluate, evaluate_after, function_names, parameter};
use super::{RADIUS, RETURN};
use crate::defs::program_error::ProgramError as E;
use crate::nc::expression::{Frame, Scope, equal};
use crate::nc::fault::{Outcome, wrong, wrong1, wrong2};
use crate::nc::lexer::Cursor;
use crate::nc::source::name;
use crate::nc::statement::{Content, Head};
use crate::nc::words::{Kind, Set, Word, Words};
use crate::units::Axis;

const CONDITION: &str = "IF a<b GOTOF …";

/// Opening and closing quotes: ASCII, then “ ” in UTF-8 and in GBK.
const QUOTES: [(&[u8], &[u8]); 3] =
    [(b"\"", b"\""), (&[0xe2, 0x80, 0x9c], &[0xe2, 0x80, 0x9d]), (&[0xa1, 0xb0], &[0xa1, 0xb1])];

/// Reads one line. Afterwards the cursor is at its end.
pub(in crate::nc::dialect) fn read<S: Scope>(
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    words: &mut Words,
    head: Head,
) -> Outcome<Content> {
    words.clear();
    blanks(cursor);
    // `%_N_NAME_MPF` is the header of a file from serial transfer.
    if cursor.peek() == b'%' || cursor.take(b'/') && head.block_skip {
        cursor.rest_of_line();
        return Ok(Content::Nothing);
    }
    blanks(cursor);
    if let Some(n) = block_number(cursor)? {
        words.n = Some(n);
        blanks(cursor);
    }
    label(cursor)?;
    let content = body(cursor, scope, words)?;
    blanks(cursor);
    match cursor.peek() {
        b'\r' | b'\n' => {}
        b';' => cursor.rest_of_line(),
        // A comment in other dialects.
        b'(' => return wrong2(cursor.at, E::ForeignCharacter, "(", ";"),
        sign @ (b'[' | b']') => return wrong1(cursor.at, E::UnexpectedCharacter, char::from(sign)),
        _ => return unexpected(cursor),
    }
    Ok(content)
}

/// The error for an unexpected byte. Round brackets are not comments here.
#[cold]
pub(super) fn unexpected<T>(cursor: &Cursor<'_>) -> Outcome<T> {
    match cursor.peek() {
        b'(' | b')' => wrong(cursor.at, E::UnbalancedRound),
        _ => cursor.unexpected(),
    }
}

/// `N40`, with or without blanks; none if the block has no number.
fn block_number(cursor: &mut Cursor<'_>) -> Outcome<Option<u32>> {
    let at = cursor.at;
    let mut ahead = Cursor { at: at + 1, ..*cursor };
    blanks(&mut ahead);
    if !matches!(cursor.peek(), b'N' | b'n') || !ahead.peek().is_ascii_digit() {
        return Ok(None);
    }
    let number = ahead.number()?;
    *cursor = ahead;
    if number.point || number.value > f64::from(u32::MAX) {
        return wrong1(at, E::NotWhole, "N");
    }
    Ok(Some(number.value as u32))
}

/// The letters, digits and `_` at the cursor.
fn written<'a>(cursor: &Cursor<'a>) -> &'a [u8] {
    let rest = cursor.text.get(cursor.at..).unwrap_or_default();
    let ends = |byte: &u8| !byte.is_ascii_alphanumeric() && *byte != b'_';
    &rest[..rest.iter().position(ends).unwrap_or(rest.len())]
}

fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).to_ascii_uppercase()
}

/// Whether a word is reserved: it cannot be a label.
fn is_reserved(word: &[u8]) -> bool {
    const WORDS: [&str; 11] = ["IF", "GOTOF", "GOTOB", "GOTO", "GOTOC", "MSG", "STOPRE", "RET", "CR", "DIV", "MOD"];
    WORDS.into_iter().chain(function_names()).any(|reserved| word.eq_ignore_ascii_case(reserved.as_bytes()))
}

/// Skips the label of the line.
fn label(cursor: &mut Cursor<'_>) -> Outcome<()> {
    let word = written(cursor);
    let mut ahead = Cursor { at: cursor.at + word.len(), ..*cursor };
    blanks(&mut ahead);
    if word.is_empty() || !ahead.take(b':') {
        return Ok(());
    }
    if name(word).is_none() || is_reserved(word) {
        return wrong1(cursor.at, E::BadLabel, shown(word));
    }
    blanks(&mut ahead);
    *cursor = ahead;
    Ok(())
}

/// Skips a keyword if it is next and no further letter or digit follows; returns whether it was.
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
        return match direction(cursor)? {
            Some(forward) => jump(cursor, forward, holds),
            None => wrong1(cursor.at, E::BadCondition, CONDITION),
        };
    }
    if let Some(forward) = direction(cursor)? {
        return jump(cursor, forward, true);
    }
    if keyword(cursor, "MSG") {
        return message(cursor);
    }
    if keyword(cursor, "STOPRE") {
        // Blocks after STOPRE are read when execution reaches this point.
        scope.axis_position(Axis::X, Frame::Machine, at)?;
        return Ok(Content::Nothing);
    }
    while block_word(cursor, scope, words)? {}
    Ok(if words.is_empty() { Content::Nothing } else { Content::Words })
}

/// `GOTOF` (true) or `GOTOB` (false); refuses other GOTO keywords.
fn direction(cursor: &mut Cursor<'_>) -> Outcome<Option<bool>> {
    if keyword(cursor, "GOTOF") {
        return Ok(Some(true));
    }
    if keyword(cursor, "GOTOB") {
        return Ok(Some(false));
    }
    match written(cursor) {
        word if word.len() >= 4 && word[..4].eq_ignore_ascii_case(b"GOTO") => {
            wrong1(cursor.at, E::NoSuchJump, shown(word))
        }
        _ => Ok(None),
    }
}

fn jump(cursor: &mut Cursor<'_>, forward: bool, holds: bool) -> Outcome<Content> {
    blanks(cursor);
    let at = cursor.at;
    match (name(written(cursor)), written(cursor)) {
        (Some(label), _) if is_reserved(label) => wrong1(at, E::BadLabel, shown(label)),
        (Some(label), _) => {
            cursor.at += label.len();
            Ok(Content::Jump { label: at..cursor.at, forward, holds })
        }
        (None, word) if !word.is_empty() => wrong1(at, E::BadLabel, shown(word)),
        (None, _) if matches!(cursor.peek(), b'\r' | b'\n' | b';') => {
            wrong1(at, E::LabelLeftOut, if forward { "GOTOF" } else { "GOTOB" })
        }
        (None, _) => unexpected(cursor),
    }
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
        return wrong(open, E::BadMessage);
    }
    blanks(cursor);
    let at = cursor.at;
    let text = if cursor.peek() == b')' { at..at } else { quoted(cursor)? };
    blanks(cursor);
    match cursor.peek() {
        b')' => {
            cursor.at += 1;
            Ok(Content::Note { text })
        }
        b'\r' | b'\n' | b';' => wrong(open, E::UnbalancedRound),
        _ if quote(cursor).is_some() => wrong(cursor.at, E::UnbalancedQuote),
        _ => wrong(cursor.at, E::BadMessage),
    }
}

/// The pair of quotes whose opening quote is at the cursor.
fn quote(cursor: &Cursor<'_>) -> Option<(&'static [u8], &'static [u8])> {
    let rest = cursor.text.get(cursor.at..).unwrap_or_default();
    QUOTES.into_iter().find(|(begin, _)| rest.starts_with(begin))
}

/// Reads a text in quotes; the cursor is then after it.
fn quoted(cursor: &mut Cursor<'_>) -> Outcome<Range<usize>> {
    let open = cursor.at;
    let Some((begin, end)) = quote(cursor) else { return wrong(open, E::UnbalancedQuote) };
    let start = open + begin.len();
    // A GBK character has two bytes, the first from 0x81; the second may look like a first byte.
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

/// Reads one word of a block; `false` if there is none.
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
            let value = assigned(cursor, scope, words, at)?;
            words.add(Word { value, at: start, letter: RADIUS, kind: Kind::Exact })?;
            return Ok(true);
        }
        // `XR20`: `=` is missing.
        if matches!(found, [_, b'R' | b'r', digits @ ..] if is_number(digits)) {
            let address = if shown(&found[..2]) == "CR" { &found[..2] } else { &found[..1] };
            return wrong1(at, E::EqualsMissing, shown(address));
        }
        return wrong1(at, E::UnknownWord, shown(found));
    }
    let letter = cursor.peek().to_ascii_uppercase();
    if !letter.is_ascii_alphabetic() {
        return Ok(false);
    }
    if letter == b'R' {
        if words.g().iter().any(|code| matches!(code.number, 2 | 3)) {
            refuse_radius(cursor)?;
        }
        let variable = parameter(cursor, scope, words.sets())?;
        let value = assigned(cursor, scope, words, at)?;
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
        b'0'..=b'9' | b'.' | b'+' | b'-' => number(cursor, at, letter)?,
        0x80.. => return cursor.unexpected(),
        _ => return no_number(cursor, at, letter),
    };
    if letter == b'N' {
        return wrong1(at, E::DoubleWord, "N");
    }
    words.add(Word { value, at: start, letter, kind })?;
    Ok(true)
}

/// Refuses `R5` without `=` in an arc block: in other dialects it is the radius.
fn refuse_radius(cursor: &Cursor<'_>) -> Outcome<()> {
    let rest = &cursor.text[cursor.at + 1..];
    let length = rest.iter().take_while(|byte| matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+')).count();
    let after = rest[length..].iter().find(|byte| !matches!(byte, b' ' | b'\t'));
    if length == 0 || after == Some(&b'=') {
        return Ok(());
    }
    let number = String::from_utf8_lossy(&rest[..length]).into_owned();
    wrong2(cursor.at, E::RadiusByCr, format!("R{number}"), format!("CR={number}"))
}

fn is_number(digits: &[u8]) -> bool {
    !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
}

/// The error for a missing number: an expression without `=`, or nothing.
#[cold]
fn no_number<T>(cursor: &Cursor<'_>, at: usize, letter: u8) -> Outcome<T> {
    let calculated = matches!(cursor.peek(), b'(' | b'$')
        || matches!(written(cursor), [b'R' | b'r', digits @ ..] if is_number(digits));
    let error = if calculated && letter != b'G' && letter != b'L' { E::EqualsMissing } else { E::MissingNumber };
    wrong1(at, error, char::from(letter))
}

fn number(cursor: &mut Cursor<'_>, at: usize, letter: u8) -> Outcome<(f64, Kind)> {
    let negative = cursor.peek() == b'-';
    cursor.at += usize::from(matches!(cursor.peek(), b'+' | b'-'));
    if !cursor.at_number() {
        return no_number(cursor, at, letter);
    }
    let number = cursor.number()?;
    let kind = if number.point { Kind::Exact } else { Kind::Digits };
    Ok((if negative { -number.value } else { number.value }, kind))
}

/// The value after `=`; `at` is the start of the word.
fn assigned<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &Words, at: usize) -> Outcome<f64> {
    let end = cursor.at;
    blanks(cursor);
    if !cursor.take(b'=') {
        return wrong1(cursor.at, E::EqualsMissing, shown(&cursor.text[at..end]));
    }
    evaluate_after(cursor, scope, words.sets())
}
