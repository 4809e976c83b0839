//! Reads one block: words, or a macro statement. Reading evaluates, but changes no state. Source: spec B1, B3.

use std::ops::Range;

use super::expression::{CoordinateFrame, Scope, Value, evaluate, primary, variable_number};
use super::fault::{Capitals, E, ReadResult, fail, fail1};
use super::functions::{whole_number, whole_u32};
use super::lexer::Cursor;
use super::print_statement::read_line;
use super::source_index::foreign_statement;
use super::words::{BlockWords, ValueKind, Word, is_comma_word};
use crate::defs::text::arg::Arg;
use crate::units::Axis;

/// Deepest nesting of `IF … THEN IF …` in one block.
const IF_DEPTH: usize = 8;
/// Letters of a foreign word that a message names.
const MAX_WORD: usize = 24;

/// The content of a block.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BlockContent {
    /// Empty, a comment, skipped, or an IF whose condition is false.
    Empty,
    /// Words; they are in `BlockWords`.
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
    /// A jump to a label, forward or backward; `is_true`: the condition is true or missing.
    Jump { label: Range<usize>, forward: bool, holds: bool },
    /// DPRNT: a line of text for the printer.
    Print { text: Arg, at: usize },
    /// A message that stays until the next one; an empty one clears it.
    DisplayMessage { text: Range<usize> },
}

/// What the reading of a block needs: its begin, the variables, the words to fill.
pub(crate) struct BlockReader<'r, 'a, S> {
    pub cursor: &'r mut Cursor<'a>,
    pub scope: &'r mut S,
    pub words: &'r mut BlockWords,
    /// A block of the same line was already read, up to a `;`.
    pub mid_line: bool,
    /// The 跳段 (block skip) switch.
    pub block_skip: bool,
}

/// Reads one block. Afterwards the cursor is at the line end, or after a `;` that another block follows.
#[inline]
pub(crate) fn read_block<S: Scope>(reader: BlockReader<'_, '_, S>) -> ReadResult<BlockContent> {
    let BlockReader { cursor, scope, words, mid_line, block_skip } = reader;
    words.clear();
    let mut is_line_start = !mid_line;
    let content = loop {
        cursor.skip_blanks()?;
        match cursor.peek() {
            b'\r' | b'\n' => break BlockContent::Empty,
            b'/' if cursor.peek_at(1) == b'/' => break BlockContent::Empty,
            b'/' => {
                accept_block_skip(cursor);
                if block_skip {
                    skip_rest_of_block(cursor);
                    break BlockContent::Empty;
                }
                is_line_start = false;
            }
            b':' if cursor.peek_at(1).is_ascii_digit() => {
                read_program_number(cursor, words)?;
                break if cursor.peek().is_ascii_alphabetic() {
                    read_body(cursor, scope, words, 0)?
                } else {
                    BlockContent::Words
                };
            }
            b';' if is_line_start => {
                cursor.skip_rest_of_line();
                return Ok(BlockContent::Empty);
            }
            b'N' | b'n' if words.block_number.is_none() => {
                words.block_number = Some(block_number(cursor)?);
                is_line_start = false;
            }
            _ => break read_body(cursor, scope, words, 0)?,
        }
    };
    read_block_end(cursor)?;
    Ok(content)
}

/// Skips to the end of the line, or to the `;` that ends the block: the block behind it has a `/` of its own, or none.
#[cold]
fn skip_rest_of_block(cursor: &mut Cursor<'_>) {
    let mut in_comment = false;
    while !cursor.at_line_end() && (in_comment || cursor.peek() != b';') {
        if !in_comment && cursor.peek() == b'/' && cursor.peek_at(1) == b'/' {
            return cursor.skip_rest_of_line();
        }
        in_comment = match cursor.peek() {
            b'(' => true,
            b')' => false,
            _ => in_comment,
        };
        cursor.at += 1;
    }
}

/// Takes `/` and the number of its switch, `/1` to `/9`. DECISION: the control has one switch; it is for all of them.
#[inline]
fn accept_block_skip(cursor: &mut Cursor<'_>) {
    cursor.at += 1;
    if matches!(cursor.peek(), b'1'..=b'9') {
        cursor.at += 1;
    }
}

/// The program number after `:`, as ISO codes write it in place of O.
#[cold]
fn read_program_number(cursor: &mut Cursor<'_>, words: &mut BlockWords) -> ReadResult<()> {
    let at = cursor.at as u32;
    cursor.at += 1;
    let number = cursor.read_number()?;
    words.add(Word { value: number.value, at, letter: b'O', kind: ValueKind::Integer })?;
    cursor.skip_blanks()
}

/// Whether another block follows on the line, behind a `;`.
#[inline]
pub(crate) fn line_continues(cursor: &Cursor<'_>) -> bool {
    !cursor.at_line_end() && !cursor.is_at_end()
}

#[inline]
fn block_number(cursor: &mut Cursor<'_>) -> ReadResult<u32> {
    let at = cursor.at;
    cursor.at += 1;
    cursor.skip_blanks()?;
    if !cursor.at_number() {
        return fail1(at, E::MissingNumber, "N");
    }
    let number = cursor.read_number()?;
    if number.has_point || number.value > f64::from(u32::MAX) {
        return fail1(at, E::NotWhole, "N");
    }
    Ok(number.value as u32)
}

/// What a block holds, or its mistake.
type ContentResult = ReadResult<BlockContent>;

fn read_body<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &mut BlockWords, depth: usize) -> ContentResult {
    let at = cursor.at;
    match cursor.peek() {
        b'#' => read_assignment(cursor, scope),
        // DECISION: the end mark of old DOS texts (0x1A) ends a text as `%` does.
        // The rest of its line is not read: `%00042`, the name under which another control sent the program.
        b'%' | 0x1a => {
            cursor.skip_rest_of_line();
            Ok(BlockContent::TextEnd { at })
        }
        b'I' | b'i' if cursor.accept_keyword("IF") => read_if(cursor, scope, words, depth),
        // FANUC takes the first two letters for the word.
        b'W' | b'w' if cursor.accept_keyword("WHILE") || cursor.accept_keyword("WH") => {
            let holds = is_true(evaluate(cursor, scope)?);
            cursor.skip_blanks()?;
            if !cursor.accept_keyword("DO") {
                return fail1(cursor.at, E::BadStatement, "WHILE […] DO m");
            }
            Ok(BlockContent::While { holds, number: loop_number(cursor)?, at })
        }
        b'D' | b'd' if cursor.accept_keyword("DPRNT") => {
            Ok(BlockContent::Print { text: read_line(cursor, scope)?, at })
        }
        // DECISION: the lines are kept as they come; there is no printer to be opened or closed.
        b'P' | b'p' if cursor.accept_keyword("POPEN") || cursor.accept_keyword("PCLOS") => Ok(BlockContent::Empty),
        b'B' | b'b' if cursor.accept_keyword("BPRNT") => fail(at, E::NoBinaryPrint),
        // DO without WHILE repeats without end; a GOTO leaves it.
        b'D' | b'd' if cursor.accept_keyword("DO") => {
            Ok(BlockContent::While { holds: true, number: loop_number(cursor)?, at })
        }
        b'E' | b'e' if cursor.accept_keyword("END") => read_loop_end(cursor, at),
        b'G' | b'g' if cursor.accept_keyword("GOTO") => read_goto(cursor, scope, at),
        b'O' | b'o' if let Some(statement) = o_word_statement(*cursor) => {
            fail1(at, E::ForeignStatement, Capitals(statement))
        }
        byte if byte.is_ascii_alphabetic() || byte == b',' && is_comma_word(cursor) => {
            words.read(cursor, scope)?;
            Ok(BlockContent::Words)
        }
        b';' | b'\r' | b'\n' => Ok(BlockContent::Empty),
        _ => unexpected_in_block(cursor),
    }
}

/// The number behind END. `ENDIF` is a statement of another language.
fn read_loop_end(cursor: &mut Cursor<'_>, at: usize) -> ContentResult {
    let word = &cursor.text[at..cursor.text.len().min(at + MAX_WORD)];
    let letters = word.iter().take_while(|byte| byte.is_ascii_alphabetic() || **byte == b'_').count();
    if letters > "END".len() {
        return fail1(at, E::ForeignStatement, Capitals(&word[..letters]));
    }
    Ok(BlockContent::EndLoop { number: loop_number(cursor)?, at })
}

/// The target behind GOTO: a number, a variable or an expression.
fn read_goto<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, at: usize) -> ContentResult {
    cursor.skip_blanks()?;
    if matches!(cursor.peek(), b'N' | b'n') {
        cursor.at += 1;
        cursor.skip_blanks()?;
    }
    if !(cursor.at_number() || matches!(cursor.peek(), b'#' | b'[')) {
        return fail1(at, E::MissingNumber, "GOTO");
    }
    let target = primary(cursor, scope)?;
    if target.is_none() && !S::HAS_VALUES {
        return Ok(BlockContent::Goto { n: 0, at });
    }
    if target.is_none() {
        scope.null_used(at);
    }
    let n = whole_u32(target.unwrap_or(0.0)).map_or_else(|| fail1(at, E::NotWhole, "GOTO"), Ok)?;
    Ok(BlockContent::Goto { n, at })
}

/// The error for a byte with which nothing begins: a bracket there has no partner to be missed.
#[cold]
fn unexpected_in_block<T>(cursor: &Cursor<'_>) -> ReadResult<T> {
    match cursor.peek() {
        b'[' => fail1(cursor.at, E::UnexpectedCharacter, "["),
        b'0'..=b'9' if has_word_before(cursor) => {
            let digits =
                cursor.text[cursor.at..].iter().take_while(|byte| byte.is_ascii_digit() || **byte == b'.').count();
            fail1(cursor.at, E::NumberWithoutLetter, Capitals(&cursor.text[cursor.at..cursor.at + digits]))
        }
        digit @ b'0'..=b'9' => fail1(cursor.at, E::BlockOfDigits, char::from(digit)),
        _ => cursor.unexpected(),
    }
}

/// Whether something stands before the cursor in its line.
fn has_word_before(cursor: &Cursor<'_>) -> bool {
    let before = cursor.text[..cursor.at].iter().rev().find(|byte| !matches!(byte, b' ' | b'\t'));
    before.is_some_and(|byte| !matches!(byte, b'\r' | b'\n' | b';' | b'/'))
}

/// An O word and the statement behind it, as LinuxCNC writes it: `o100 while`, `o<name> call`.
fn o_word_statement<'a>(mut cursor: Cursor<'a>) -> Option<&'a [u8]> {
    let start = cursor.at;
    cursor.at += 1;
    while matches!(cursor.peek(), b' ' | b'\t') {
        cursor.at += 1;
    }
    if cursor.accept(b'<') {
        while !cursor.at_line_end() && !cursor.accept(b'>') {
            cursor.at += 1;
        }
    }
    while cursor.peek().is_ascii_digit() {
        cursor.at += 1;
    }
    let statement = foreign_statement(cursor.text.get(cursor.at..)?)?;
    let blanks = cursor.text[cursor.at..].iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
    let end = cursor.at + blanks + statement.len();
    Some(&cursor.text[start..end.min(start + MAX_WORD)])
}

fn is_true(value: Value) -> bool {
    value.is_some_and(|value| value.abs() > 1e-12)
}

fn loop_number(cursor: &mut Cursor<'_>) -> ReadResult<u8> {
    cursor.skip_blanks()?;
    let at = cursor.at;
    if !cursor.at_number() {
        return fail1(at, E::MissingNumber, "DO / END");
    }
    let number = cursor.read_number()?;
    match whole_number(number.value) {
        Some(number @ 1..=3) => Ok(number as u8),
        Some(_) | None => fail1(at, E::DoNumber, format_args!("{}", number.value)),
    }
}

fn read_if<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, words: &mut BlockWords, depth: usize) -> ContentResult {
    if depth >= IF_DEPTH {
        return fail(cursor.at, E::TooComplex);
    }
    let holds = is_true(evaluate(cursor, scope)?) || scope.assumes_conditions();
    words.condition = Some(holds);
    cursor.skip_blanks()?;
    let then = cursor.at;
    let thens = cursor.accept_keyword("THEN");
    cursor.skip_blanks()?;
    let at = cursor.at;
    let jumps = matches!(cursor.peek(), b'G' | b'g') && matches!(cursor.peek_at(1), b'O' | b'o');
    if !(thens || jumps) {
        return fail(then, E::ThenMissing);
    }
    let content = if holds {
        read_body(cursor, scope, words, depth + 1)?
    } else {
        // The rest is still read, to report mistakes and to find a block after `;`.
        let n = words.block_number;
        let content = read_body(cursor, &mut SyntaxOnlyScope, words, depth + 1)?;
        words.clear();
        (words.block_number, words.condition) = (n, Some(false));
        content
    };
    let acts = matches!(
        content,
        BlockContent::Words | BlockContent::Assign { .. } | BlockContent::Goto { .. } | BlockContent::Print { .. }
    );
    let only_comment = matches!(content, BlockContent::Empty) && at < cursor.at;
    if matches!(content, BlockContent::Empty) && thens && !only_comment {
        return fail(then, E::ThenAlone);
    }
    if !(acts || only_comment) && (depth == 0 || holds) {
        return fail1(at, E::BadStatement, "IF […] THEN");
    }
    Ok(if holds { content } else { BlockContent::Empty })
}

fn read_assignment<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> ReadResult<BlockContent> {
    let at = cursor.at;
    let variable = variable_number(cursor, scope)?;
    cursor.skip_blanks()?;
    if let Some(sign) = foreign_assignment(cursor) {
        return fail1(cursor.at, E::AssignmentSign, sign);
    }
    if cursor.peek() != b'=' {
        return fail1(cursor.at, E::BadStatement, "#i = …");
    }
    cursor.at += 1;
    cursor.skip_blanks()?;
    let start = cursor.at;
    if matches!(cursor.peek(), b'\r' | b'\n' | b';') {
        return fail1(at, E::MissingNumber, format_args!("#{variable}="));
    }
    let value = evaluate(cursor, scope)?;
    cursor.skip_blanks()?;
    let text = matches!(variable, 3000 | 3006).then(|| comment_text(cursor, start)).flatten();
    Ok(BlockContent::Assign { variable, value, at, text })
}

/// The sign of an assignment in other languages.
#[inline]
fn foreign_assignment(cursor: &Cursor<'_>) -> Option<&'static str> {
    match (cursor.peek(), cursor.peek_at(1)) {
        (b':', b'=') => Some(":="),
        (b'=', b'=') => Some("=="),
        _ => None,
    }
}

fn comment_text(cursor: &Cursor<'_>, start: usize) -> Option<Range<usize>> {
    let read = cursor.text.get(start..cursor.at)?;
    let open = read.iter().position(|byte| *byte == b'(')? + 1;
    let length = read[open..].iter().position(|byte| *byte == b')')?;
    Some(start + open..start + open + length)
}

/// Reads the end of a block: line end, comment, or `;` with another block.
#[inline]
fn read_block_end(cursor: &mut Cursor<'_>) -> ReadResult<()> {
    match cursor.peek() {
        // The end mark of old DOS texts may stand in the last line.
        b'\r' | b'\n' | 0x1a => Ok(()),
        b';' => {
            cursor.at += 1;
            if !is_block(*cursor) {
                cursor.skip_rest_of_line();
            }
            Ok(())
        }
        b'/' if cursor.peek_at(1) == b'/' => {
            cursor.skip_rest_of_line();
            Ok(())
        }
        // After GOTO 40, DO1 and END1.
        b' ' | b'\t' | b'(' => {
            cursor.skip_blanks()?;
            read_block_end(cursor)
        }
        _ => unexpected_in_block(cursor),
    }
}

/// DECISION: the text after `;` is a block if all of it, up to the next `;`, is words or a statement.
/// Everything else is a comment. A check warns of such a block. A block number or a comment alone hides no block behind it.
#[cold]
fn is_block(mut cursor: Cursor<'_>) -> bool {
    let mut words = BlockWords::default();
    loop {
        while cursor.accept(b';') || cursor.accept(b' ') {}
        words.clear();
        let read = read_syntax_only(&mut cursor, &mut words);
        let closed = cursor.skip_blanks().is_ok() && matches!(cursor.peek(), b'\r' | b'\n' | b';');
        match read {
            Ok(has_words) if closed && words.address_only.is_none() => {
                if has_words || cursor.peek() != b';' {
                    return has_words;
                }
            }
            _ => return false,
        }
    }
}

/// Checks the syntax of a block with its `/` and its number; returns whether it contains anything else. An IF counts
/// even if its condition is false.
fn read_syntax_only(cursor: &mut Cursor<'_>, words: &mut BlockWords) -> ReadResult<bool> {
    cursor.skip_blanks()?;
    if cursor.peek() == b'/' && cursor.peek_at(1) != b'/' {
        accept_block_skip(cursor);
        cursor.skip_blanks()?;
    }
    if matches!(cursor.peek(), b'N' | b'n') {
        words.block_number = Some(block_number(cursor)?);
        cursor.skip_blanks()?;
    }
    let at = cursor.at;
    read_body(cursor, &mut SyntaxOnlyScope, words, 0)?;
    Ok(cursor.at > at)
}

/// Whether the block at a cursor holds anything but its number or a comment; the cursor is then somewhere in its line.
#[cold]
pub(super) fn has_content(cursor: &mut Cursor<'_>) -> bool {
    !matches!(read_syntax_only(cursor, &mut BlockWords::default()), Ok(false))
}

/// The start of the block after the next `;`, for the block that begins at `at`; `text` ends with its line.
pub(crate) fn next_block_on_line(text: &[u8], at: usize, mid_line: bool) -> Option<usize> {
    let mut cursor = Cursor::window(text, at);
    cursor.skip_blanks().ok()?;
    if cursor.peek() == b';' && !mid_line {
        return None;
    }
    while !matches!(cursor.peek(), b';' | b'\r' | b'\n') {
        if cursor.peek() == b'/' && cursor.peek_at(1) == b'/' {
            return None;
        }
        cursor.at += 1;
        cursor.skip_blanks().ok()?;
    }
    (cursor.accept(b';') && is_block(cursor)).then_some(cursor.at)
}

/// A scope without values, for syntax checks.
pub(crate) struct SyntaxOnlyScope;

impl Scope for SyntaxOnlyScope {
    const HAS_VALUES: bool = false;

    fn read(&mut self, _number: u32, _at: usize) -> ReadResult<Value> {
        Ok(None)
    }

    fn axis_position(&mut self, _axis: Axis, _frame: CoordinateFrame, _at: usize) -> ReadResult<Value> {
        Ok(None)
    }

    fn null_used(&mut self, _at: usize) {}
}
