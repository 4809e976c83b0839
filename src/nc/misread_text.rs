//! Names what really stands where a text cannot be read: a statement of another language, a comment within a comment, the
//! letter O in place of a zero. Source: spec B1, B8.

use super::fault::{Capitals, E, ErrorAt};
use super::source_index::block_head;
use crate::defs::kind::Dialect;
use crate::defs::text::arg::Arg;

/// The statements with which a block may begin.
const STATEMENTS: [&[u8]; 7] = [b"WHILE", b"END", b"GOTO", b"DPRNT", b"POPEN", b"PCLOS", b"BPRNT"];

/// Replaces a mistake by the one that it comes from.
#[cold]
pub(super) fn name_misread_text(text: &[u8], dialect: Dialect, wrong: &mut ErrorAt) {
    if dialect.is_kt830() {
        match wrong.error {
            E::MissingNumber => name_misread_word(text, wrong),
            E::UnexpectedCharacter => name_unexpected_character(text, wrong),
            E::UnknownFunction => name_condition_brackets(text, wrong),
            _ => {}
        }
    }
    if matches!(
        wrong.error,
        E::UnexpectedCharacter | E::ForeignStatement | E::MissingNumber | E::UnknownWord | E::NumberWithoutLetter
    ) && dialect.has_bracket_comments()
        && let Some(inner) = nested_comment(text, wrong.at)
    {
        (wrong.at, wrong.error, wrong.details) = (inner, E::UnbalancedComment, Default::default());
    }
}

/// The start of the line of a byte.
fn line_start(text: &[u8], at: usize) -> usize {
    text[..at].iter().rposition(|byte| matches!(byte, b'\r' | b'\n')).map_or(0, |end| end + 1)
}

/// The bracket within a comment before a byte of its line: the first `)` has ended the comment, and what follows is read as
/// words.
fn nested_comment(text: &[u8], at: usize) -> Option<usize> {
    let before = text.get(..at)?;
    let mut is_comment = false;
    for (index, byte) in before.iter().enumerate().skip(line_start(text, at)) {
        match byte {
            b'(' if is_comment => return Some(index),
            b'(' => is_comment = true,
            b')' => is_comment = false,
            _ => {}
        }
    }
    None
}

/// Where a number is missing behind an address: a statement of another language (`ELSE`), or the letter O in place of a
/// zero (`GO1`).
fn name_misread_word(text: &[u8], wrong: &mut ErrorAt) {
    if wrong.details[0].to_text().len() > 1 {
        return; // the number of a GOTO, or of an address that is named already
    }
    let is_letter = |byte: &u8| byte.is_ascii_alphabetic() || *byte == b'_';
    let (before, behind) = text.split_at(wrong.at.min(text.len()));
    let start = before.len() - before.iter().rev().take_while(|byte| is_letter(byte)).count();
    let end = before.len() + behind.iter().take_while(|byte| is_letter(byte)).count();
    match &text[start..end] {
        [letter, b'O' | b'o'] => {
            (wrong.error, wrong.details) = (E::LetterForZero, [char::from(*letter).into(), Arg::None]);
        }
        word @ [_, _, _, ..] => {
            // `SUB NAME`: the statement comes first.
            let (start, word) = first_word_of_block(text, start).unwrap_or((start, word));
            (wrong.at, wrong.error) = (start, E::ForeignStatement);
            wrong.details = [Capitals(word).into(), Arg::None];
        }
        _ => {}
    }
}

/// Where a character does not fit: the block began with a statement of another language (`SETVN100[A]`), or `/` stands
/// within it.
fn name_unexpected_character(text: &[u8], wrong: &mut ErrorAt) {
    let at = wrong.at.min(text.len());
    let is_known = |word: &[u8]| STATEMENTS.iter().any(|known| word.eq_ignore_ascii_case(known));
    if let Some((start, word)) = first_word_of_block(text, at).filter(|(_, word)| !is_known(word)) {
        (wrong.at, wrong.error) = (start, E::ForeignStatement);
        wrong.details = [Capitals(word).into(), Arg::None];
    } else if text.get(at) == Some(&b'/') && text[line_start(text, at)..at].iter().any(u8::is_ascii_alphanumeric) {
        (wrong.error, wrong.details) = (E::SkipWithinBlock, Default::default());
    }
}

/// Where `IF (…) THEN` or `WHILE (…) DO` of another language was read as a comment and a function.
fn name_condition_brackets(text: &[u8], wrong: &mut ErrorAt) {
    let start = line_start(text, wrong.at);
    let line = &text[start..wrong.at.min(text.len())];
    let Some(open) = line.iter().position(|byte| *byte == b'(') else { return };
    let word = line[..open].trim_ascii_end();
    let keyword = [b"IF".as_slice(), b"WHILE"]
        .into_iter()
        .find(|known| word.len().checked_sub(known.len()).is_some_and(|at| word[at..].eq_ignore_ascii_case(known)));
    if let Some(keyword) = keyword {
        (wrong.at, wrong.error) = (start + open, E::ConditionBrackets);
        wrong.details = [Capitals(keyword).into(), Arg::None];
    }
}

/// The letters with which the block of a byte begins, if they are no single address.
fn first_word_of_block(text: &[u8], at: usize) -> Option<(usize, &[u8])> {
    let (_, block) = block_head(&text[line_start(text, at)..at], true);
    let letters = block.iter().take_while(|byte| byte.is_ascii_alphabetic() || **byte == b'_').count();
    (letters >= 3).then(|| (at - block.len(), &block[..letters]))
}
