//! Reads one line: block number, label, then a statement or words. Changes no state. Source: spec S1.

use std::ops::Range;

use super::expression::{
    accept_keyword, evaluate, evaluate_with, function_names, identifier, parameter_number, skip_blanks, unexpected,
};
use super::keyword::{Keyword, read_distance, read_keyword};
use super::{LONG_ADDRESSES, RETURN_M_CODE};
use crate::nc::expression::{CoordinateFrame, Scope};
use crate::nc::fault::{Capitals, E, ReadResult, fail, fail1, fail2};
use crate::nc::functions::Comparison;
use crate::nc::lexer::Cursor;
use crate::nc::statement::{BlockContent, BlockReader};
use crate::nc::words::{Assignment, BlockWords, Code, ValueKind, Word};
use crate::units::Axis;

/// Statements of larger controls of the same maker.
pub(super) const FOREIGN_WORDS: [&str; 65] = [
    "DEF", "PROC", "ENDPROC", "EXTERN", "ELSE", "ENDIF", "WHILE", "ENDWHILE", "FOR", "ENDFOR", "LOOP", "ENDLOOP",
    "REPEAT", "REPEATB", "UNTIL", "CASE", "ROT", "AROT", "MIRROR", "SCALE", "SETAL", "SUPA", "MCALL", "AR", "AP", "RP",
    "RPL", "CT", "CIP", "TURN", "OFFN", "DISC", "DISR", "DISCL", "FAD", "FP", "SF", "POS", "POSA", "ACC", "MEAS",
    "MEAW", "CFC", "CFTCP", "CFIN", "SPI", "SOFT", "BRISK", "DRIVE", "FFWON", "FFWOF", "COMPON", "COMPOF", "TRAORI",
    "TRANSMIT", "TRACYL", "TRAFOOF", "DRFOF", "WAITP", "WAITM", "FGROUP", "SETMS", "SPCON", "SPCOF", "GEOAX",
];

const IF_SYNTAX: &str = "IF a<b GOTOF …";

/// Opening and closing quotes: ASCII, then “ ” in UTF-8 and in GBK.
const QUOTES: [(&[u8], &[u8]); 3] =
    [(b"\"", b"\""), (&[0xe2, 0x80, 0x9c], &[0xe2, 0x80, 0x9d]), (&[0xa1, 0xb0], &[0xa1, 0xb1])];

/// Reads one line. Afterwards the cursor is at its end.
pub(super) fn read_block<S: Scope>(reader: BlockReader<'_, '_, S>) -> ReadResult<BlockContent> {
    let BlockReader { cursor, scope, words, block_skip, .. } = reader;
    words.clear();
    skip_blanks(cursor);
    // `%_N_NAME_MPF` is the header of a file from serial transfer; 0x1A ends a text of DOS.
    if matches!(cursor.peek(), b'%' | 0x1a) || cursor.accept(b'/') && block_skip {
        cursor.skip_rest_of_line();
        return Ok(BlockContent::Empty);
    }
    skip_blanks(cursor);
    if let Some(n) = block_number(cursor)? {
        words.block_number = Some(n);
        skip_blanks(cursor);
    }
    skip_label(cursor)?;
    let content = read_body(cursor, scope, words)?;
    skip_blanks(cursor);
    match cursor.peek() {
        b'\r' | b'\n' => {}
        b';' => cursor.skip_rest_of_line(),
        // A comment in other dialects.
        b'(' => {
            return match words.peek(b'L') {
                Some(call) => fail1(call.at as usize, E::NoCallByName, format_args!("L{}", call.value)),
                None => fail2(cursor.at, E::NonAsciiCharacter, "(", ";"),
            };
        }
        sign @ (b'[' | b']') => return fail1(cursor.at, E::UnexpectedCharacter, char::from(sign)),
        _ => return unexpected(cursor),
    }
    Ok(content)
}

/// `N40`, with or without blanks; none if the block has no number.
fn block_number(cursor: &mut Cursor<'_>) -> ReadResult<Option<u32>> {
    let at = cursor.at;
    let mut ahead = Cursor { at: at + 1, ..*cursor };
    skip_blanks(&mut ahead);
    if !matches!(cursor.peek(), b'N' | b'n') || !ahead.peek().is_ascii_digit() {
        return Ok(None);
    }
    let number = ahead.read_number()?;
    *cursor = ahead;
    if number.has_point || number.value > f64::from(u32::MAX) {
        return fail1(at, E::NotWhole, "N");
    }
    Ok(Some(number.value as u32))
}

/// The letters, digits and `_` at the cursor.
fn word_at<'a>(cursor: &Cursor<'a>) -> &'a [u8] {
    let rest = cursor.text.get(cursor.at..).unwrap_or_default();
    let ends = |byte: &u8| !byte.is_ascii_alphanumeric() && *byte != b'_';
    &rest[..rest.iter().position(ends).unwrap_or(rest.len())]
}

fn upper_text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).to_ascii_uppercase()
}

/// Whether a word is reserved: it cannot be a label.
fn is_reserved(word: &[u8]) -> bool {
    const WORDS: [&str; 11] = ["IF", "GOTOF", "GOTOB", "GOTO", "GOTOC", "MSG", "STOPRE", "RET", "CR", "DIV", "MOD"];
    WORDS.into_iter().chain(function_names()).any(|reserved| word.eq_ignore_ascii_case(reserved.as_bytes()))
}

/// Skips the label of the line.
fn skip_label(cursor: &mut Cursor<'_>) -> ReadResult<()> {
    let word = word_at(cursor);
    let mut ahead = Cursor { at: cursor.at + word.len(), ..*cursor };
    skip_blanks(&mut ahead);
    if word.is_empty() || !ahead.accept(b':') {
        return Ok(());
    }
    if identifier(word).is_none() || is_reserved(word) {
        return fail1(cursor.at, E::BadLabel, upper_text(word));
    }
    skip_blanks(&mut ahead);
    *cursor = ahead;
    Ok(())
}

fn read_body<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &mut BlockWords) -> ReadResult<BlockContent> {
    let at = cursor.at;
    if accept_keyword(cursor, "IF") {
        refuse_logic(cursor)?;
        let holds = match bracketed_condition(cursor) {
            Some(end) => read_bracketed_condition(cursor, scope, end)?,
            None => read_condition(cursor, scope)?,
        };
        skip_blanks(cursor);
        let Some(forward) = jump_direction(cursor)? else {
            return match cursor.peek() {
                b'\r' | b'\n' | b';' => fail(at, E::NoBlockIf),
                _ => fail1(cursor.at, E::BadCondition, IF_SYNTAX),
            };
        };
        return read_jump(cursor, forward, holds);
    }
    if let Some(forward) = jump_direction(cursor)? {
        return read_jump(cursor, forward, true);
    }
    if accept_keyword(cursor, "MSG") {
        return read_message(cursor);
    }
    if accept_keyword(cursor, "STOPRE") {
        // Blocks after STOPRE are read when execution reaches this point.
        scope.axis_position(Axis::X, CoordinateFrame::Machine, at)?;
        return Ok(BlockContent::Empty);
    }
    while read_word(cursor, scope, words)? {}
    Ok(if words.is_empty() { BlockContent::Empty } else { BlockContent::Words })
}

/// Refuses AND, OR, XOR and NOT in the condition that follows.
fn refuse_logic(cursor: &Cursor<'_>) -> ReadResult<()> {
    let line = &cursor.text[cursor.at..];
    let end = line.iter().position(|byte| matches!(byte, b'\r' | b'\n' | b';')).unwrap_or(line.len());
    let mut at = 0;
    while at < end {
        let word = line[at..end].iter().take_while(|byte| byte.is_ascii_alphanumeric() || **byte == b'_').count();
        let name = &line[at..at + word];
        if [&b"AND"[..], b"OR", b"XOR", b"NOT"].iter().any(|logic| name.eq_ignore_ascii_case(logic)) {
            return fail1(cursor.at + at, E::NoLogicOperator, upper_text(name));
        }
        at += word.max(1);
    }
    Ok(())
}

/// `GOTOF` (true) or `GOTOB` (false); refuses other GOTO keywords.
fn jump_direction(cursor: &mut Cursor<'_>) -> ReadResult<Option<bool>> {
    if accept_keyword(cursor, "GOTOF") {
        return Ok(Some(true));
    }
    if accept_keyword(cursor, "GOTOB") {
        return Ok(Some(false));
    }
    match word_at(cursor) {
        word if word.len() >= 4 && word[..4].eq_ignore_ascii_case(b"GOTO") => {
            fail1(cursor.at, E::UnknownJump, upper_text(word))
        }
        _ => Ok(None),
    }
}

fn read_jump(cursor: &mut Cursor<'_>, forward: bool, holds: bool) -> ReadResult<BlockContent> {
    skip_blanks(cursor);
    let at = cursor.at;
    match (identifier(word_at(cursor)), word_at(cursor)) {
        (Some(label), _) if is_reserved(label) => fail1(at, E::BadLabel, upper_text(label)),
        (Some(name), _) | (None, name @ [b'N' | b'n', b'0'..=b'9', ..]) => {
            cursor.at += name.len();
            Ok(BlockContent::Jump { label: at..cursor.at, forward, holds })
        }
        (None, word) if !word.is_empty() => fail1(at, E::BadLabel, upper_text(word)),
        (None, _) if matches!(cursor.peek(), b'\r' | b'\n' | b';') => {
            fail1(at, E::MissingJumpLabel, if forward { "GOTOF" } else { "GOTOB" })
        }
        (None, _) => unexpected(cursor),
    }
}

/// The byte of the bracket that closes `(R3<3)`, if the whole condition stands in brackets: a jump follows, or nothing.
fn bracketed_condition(cursor: &Cursor<'_>) -> Option<usize> {
    let mut ahead = *cursor;
    skip_blanks(&mut ahead);
    if !ahead.accept(b'(') {
        return None;
    }
    let mut depth = 1;
    while depth > 0 {
        match ahead.peek() {
            b'(' => depth += 1,
            b')' => depth -= 1,
            b'\r' | b'\n' | b';' => return None,
            _ => {}
        }
        ahead.at += 1;
    }
    let end = ahead.at - 1;
    skip_blanks(&mut ahead);
    let jumps = word_at(&ahead).get(..4).is_some_and(|word| word.eq_ignore_ascii_case(b"GOTO"));
    (jumps || matches!(ahead.peek(), b'\r' | b'\n' | b';')).then_some(end)
}

/// A condition in brackets; `end` is the byte of the closing one.
fn read_bracketed_condition<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, end: usize) -> ReadResult<bool> {
    skip_blanks(cursor);
    cursor.at += 1;
    let holds = read_condition(cursor, scope)?;
    skip_blanks(cursor);
    if cursor.at != end {
        return unexpected(cursor);
    }
    cursor.at += 1;
    Ok(holds)
}

fn read_condition<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> ReadResult<bool> {
    const SIGNS: [(&str, Comparison); 6] = [
        ("==", Comparison::Eq),
        ("<>", Comparison::Ne),
        (">=", Comparison::Ge),
        ("<=", Comparison::Le),
        (">", Comparison::Gt),
        ("<", Comparison::Lt),
    ];
    let left = evaluate(cursor, scope)?;
    skip_blanks(cursor);
    let at = cursor.at;
    let Some((sign, compare)) = SIGNS.into_iter().find(|(sign, _)| cursor.accept_keyword(sign)) else {
        if matches!(cursor.peek(), b'\r' | b'\n' | b';') {
            return fail(at, E::NoBlockIf);
        }
        let what = if cursor.peek() == b'=' { "=" } else { IF_SYNTAX };
        return fail1(at, E::BadCondition, what);
    };
    if matches!(cursor.peek(), b'=' | b'<' | b'>') {
        return fail1(at, E::BadCondition, format_args!("{sign}{}", char::from(cursor.peek())));
    }
    Ok(compare.holds(left, evaluate(cursor, scope)?))
}

/// `MSG("…")`, `MSG(“…”)` or `MSG()`.
fn read_message(cursor: &mut Cursor<'_>) -> ReadResult<BlockContent> {
    message_range(cursor).map(|text| BlockContent::DisplayMessage { text })
}

/// The bytes of the text in the brackets behind `MSG`.
pub(super) fn message_range(cursor: &mut Cursor<'_>) -> ReadResult<Range<usize>> {
    skip_blanks(cursor);
    let open = cursor.at;
    if !cursor.accept(b'(') {
        return fail(open, E::BadMessage);
    }
    skip_blanks(cursor);
    let at = cursor.at;
    let text = if cursor.peek() == b')' { at..at } else { read_quoted(cursor)? };
    skip_blanks(cursor);
    match cursor.peek() {
        b')' => {
            cursor.at += 1;
            Ok(text)
        }
        b'\r' | b'\n' | b';' => fail(open, E::UnbalancedRound),
        b'<' => fail(cursor.at, E::MessageIsText),
        _ if quotes_at(cursor).is_some() => fail(cursor.at, E::UnbalancedQuote),
        _ => fail(cursor.at, E::BadMessage),
    }
}

/// The pair of quotes whose opening quote is at the cursor.
fn quotes_at(cursor: &Cursor<'_>) -> Option<(&'static [u8], &'static [u8])> {
    let rest = cursor.text.get(cursor.at..).unwrap_or_default();
    QUOTES.into_iter().find(|(begin, _)| rest.starts_with(begin))
}

/// Reads a text in quotes; the cursor is then after it.
fn read_quoted(cursor: &mut Cursor<'_>) -> ReadResult<Range<usize>> {
    let open = cursor.at;
    let Some((begin, end)) = quotes_at(cursor) else { return fail(open, E::UnbalancedQuote) };
    let start = open + begin.len();
    // A GBK character has two bytes, the first from 0x81; the second may look like a first byte.
    let wide = begin == QUOTES[2].0;
    let mut at = start;
    loop {
        match cursor.text.get(at) {
            None | Some(b'\r' | b'\n') => return fail(open, E::UnbalancedQuote),
            Some(_) if cursor.text[at..].starts_with(end) => break,
            Some(0x81..) if wide => at += 2,
            Some(_) => at += 1,
        }
    }
    cursor.at = at + end.len();
    Ok(start..at)
}

/// Reads one word of a block; `false` if there is none.
fn read_word<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &mut BlockWords) -> ReadResult<bool> {
    skip_blanks(cursor);
    let at = cursor.at;
    let start = at as u32;
    if let Some(found) = identifier(&cursor.text[at.min(cursor.text.len())..]) {
        return read_long_word(cursor, scope, words, found).map(|()| true);
    }
    let letter = cursor.peek().to_ascii_uppercase();
    if letter == b'$' {
        let name = identifier(&cursor.text[at + 1..]).unwrap_or_default();
        return fail1(at, E::UnknownSystemVariable, format_args!("${}", Capitals(name)));
    }
    if !letter.is_ascii_alphabetic() {
        return Ok(false);
    }
    if letter == b'R' {
        if words.g.iter().any(|code| matches!(code.number, 2 | 3)) {
            refuse_r_as_radius(cursor)?;
        }
        let variable = parameter_number(cursor, scope, &words.assignments)?;
        let value = assigned_value(cursor, scope, words, at)?;
        words.push_assignment(Assignment { variable, value, at: start })?;
        return Ok(true);
    }
    cursor.at += 1;
    if matches!(letter, b'X' | b'Y' | b'Z') && cursor.peek() == b'1' && cursor.peek_at(1) == b'=' {
        // `X1=0`: an axis of the machine, for G74 and G75.
        words.push_keyword(Code { number: Keyword::MachineAxis as u32, at: start })?;
        cursor.at += 1;
    }
    let (value, kind) = read_value(cursor, scope, words, (letter, at))?;
    if letter == b'N' {
        return fail1(at, E::DoubleWord, "N");
    }
    words.add(Word { value, at: start, letter, kind })?;
    Ok(true)
}

/// The value behind a letter at `at`: a number, or `=` and an expression.
fn read_value<S: Scope>(
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    words: &mut BlockWords,
    (letter, at): (u8, usize),
) -> ReadResult<(f64, ValueKind)> {
    skip_blanks(cursor);
    let fixed = matches!(letter, b'G' | b'L' | b'N');
    match cursor.peek() {
        b'=' if fixed => fail1(at, E::DigitsOnly, char::from(letter)),
        b'=' => {
            cursor.at += 1;
            skip_blanks(cursor);
            if quotes_at(cursor).is_some() {
                return fail1(at, E::NumberNotName, char::from(letter));
            }
            match read_distance(cursor, scope, words, (letter, at))? {
                Some(value) => Ok((value, ValueKind::Decimal)),
                None => Ok((evaluate_with(cursor, scope, &words.assignments)?, ValueKind::Decimal)),
            }
        }
        b'0'..=b'9' | b'.' | b'+' | b'-' => {
            let number = read_number(cursor, at, letter)?;
            let name = &cursor.text[at..cursor.at];
            skip_blanks(cursor);
            if cursor.peek() == b'=' {
                return match letter {
                    b'M' | b'S' => fail1(at, E::NoAddressExtension, Capitals(name)),
                    _ if fixed => fail1(at, E::DigitsOnly, char::from(letter)),
                    _ => fail1(at, E::UnknownWord, Capitals(name)),
                };
            }
            Ok(number)
        }
        0x80.. => cursor.unexpected(),
        _ => missing_number(cursor, at, letter),
    }
}

/// Reads a word of several letters, which is next.
fn read_long_word<S: Scope>(
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    words: &mut BlockWords,
    found: &[u8],
) -> ReadResult<()> {
    let at = cursor.at;
    if accept_keyword(cursor, "RET") {
        return words.add(Word {
            value: f64::from(RETURN_M_CODE),
            at: at as u32,
            letter: b'M',
            kind: ValueKind::Integer,
        });
    }
    for (name, letter) in LONG_ADDRESSES {
        if accept_keyword(cursor, name) {
            let value = assigned_value(cursor, scope, words, at)?;
            return words.add(Word { value, at: at as u32, letter, kind: ValueKind::Decimal });
        }
    }
    if read_keyword(cursor, words)? {
        return Ok(());
    }
    if ["SPOS", "SPOSA"].iter().any(|word| found.eq_ignore_ascii_case(word.as_bytes())) {
        return fail1(at, E::NoSpindlePosition, upper_text(found));
    }
    refuse_long_word(cursor, at, found)
}

/// Refuses a word of several letters that is none of this control.
#[cold]
fn refuse_long_word(cursor: &Cursor<'_>, at: usize, found: &[u8]) -> ReadResult<()> {
    let name = upper_text(found);
    let is_cycle = name.strip_prefix("CYCLE").is_some_and(|number| is_number(number.as_bytes()));
    match name.as_str() {
        "ELSE" | "ENDIF" => return fail(at, E::NoBlockIf),
        "WHILE" | "ENDWHILE" | "FOR" | "ENDFOR" | "LOOP" | "ENDLOOP" | "REPEAT" | "REPEATB" | "UNTIL" => {
            return fail1(at, E::NoLoopStatement, name);
        }
        _ => {}
    }
    if is_cycle || FOREIGN_WORDS.contains(&name.as_str()) {
        return fail1(at, E::ForeignWord, name);
    }
    let mut behind = Cursor { at: at + found.len(), ..*cursor };
    skip_blanks(&mut behind);
    match behind.peek() {
        b'=' | b'[' => return fail1(at, E::NoUserVariable, name),
        b'(' => return fail1(at, E::NoCallByName, name),
        _ => {}
    }
    // `XR20`: `=` is missing.
    if matches!(found, [_, b'R' | b'r', digits @ ..] if is_number(digits)) {
        let address = if upper_text(&found[..2]) == "CR" { &found[..2] } else { &found[..1] };
        return fail1(at, E::EqualsMissing, upper_text(address));
    }
    // A word of this language in the wrong place.
    let own = is_reserved(found) || found.get(..4).is_some_and(|word| word.eq_ignore_ascii_case(b"GOTO"));
    // A name alone in its block calls a program of that name.
    let is_alone = matches!(behind.peek(), b'\r' | b'\n' | b';') && is_first_word(cursor.text, at);
    let error = match (own, is_alone) {
        (true, _) => E::UnknownWord,
        (false, true) => E::NoCallByName,
        (false, false) => E::ForeignWord,
    };
    fail1(at, error, name)
}

/// Whether a byte is the first one of its block, behind its number.
fn is_first_word(text: &[u8], at: usize) -> bool {
    let line = text[..at].rsplit(|byte| matches!(byte, b'\r' | b'\n')).next().unwrap_or_default().trim_ascii();
    matches!(line, [] | [b'N' | b'n', ..]) && line.iter().skip(1).all(u8::is_ascii_digit)
}

/// Refuses `R5` without `=` in an arc block: in other dialects it is the radius.
fn refuse_r_as_radius(cursor: &Cursor<'_>) -> ReadResult<()> {
    let rest = &cursor.text[cursor.at + 1..];
    let length = rest.iter().take_while(|byte| matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+')).count();
    let after = rest[length..].iter().find(|byte| !matches!(byte, b' ' | b'\t'));
    if length == 0 || after == Some(&b'=') {
        return Ok(());
    }
    let number = Capitals(&rest[..length]);
    fail2(cursor.at, E::RadiusByCr, format_args!("R{number}"), format_args!("CR={number}"))
}

fn is_number(digits: &[u8]) -> bool {
    !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
}

/// The error for a missing number: an expression without `=`, or nothing.
#[cold]
fn missing_number<T>(cursor: &Cursor<'_>, at: usize, letter: u8) -> ReadResult<T> {
    let calculated = matches!(cursor.peek(), b'(' | b'$')
        || matches!(word_at(cursor), [b'R' | b'r', digits @ ..] if is_number(digits));
    let error = if calculated && letter != b'G' && letter != b'L' { E::EqualsMissing } else { E::MissingNumber };
    fail1(at, error, char::from(letter))
}

fn read_number(cursor: &mut Cursor<'_>, at: usize, letter: u8) -> ReadResult<(f64, ValueKind)> {
    let negative = cursor.peek() == b'-';
    cursor.at += usize::from(matches!(cursor.peek(), b'+' | b'-'));
    if !cursor.at_number() {
        return missing_number(cursor, at, letter);
    }
    let number = cursor.read_number()?;
    let kind = if number.has_point { ValueKind::Decimal } else { ValueKind::Integer };
    Ok((if negative { -number.value } else { number.value }, kind))
}

/// The value after `=`; `at` is the start of the word.
fn assigned_value<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &BlockWords, at: usize) -> ReadResult<f64> {
    let end = cursor.at;
    skip_blanks(cursor);
    if !cursor.accept(b'=') {
        return fail1(cursor.at, E::EqualsMissing, upper_text(&cursor.text[at..end]));
    }
    evaluate_with(cursor, scope, &words.assignments)
}
