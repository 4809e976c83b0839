//! The kinds of machine that a program is for. It names them in a comment before its first block, `(机型 GS)` or
//! `(KIND GC GS)`; a program that names none is for every kind. The kinds of the KT-830 share one folder of programs.
//! Source: spec K1, B6 (directory).

use super::kind::Kind;

/// The words before the names.
const WORDS: [&str; 2] = ["机型", "KIND"];

/// The kinds that a program names in its first lines; none: it is for every kind.
pub fn kinds_of<'a>(lines: impl IntoIterator<Item = &'a str>) -> Vec<Kind> {
    let head = lines.into_iter().map(str::trim).take_while(|line| is_before_first_block(line));
    head.flat_map(|line| line.split(['(', ')', ';'])).find_map(kinds_in_comment).unwrap_or_default()
}

/// Whether a program that names these kinds is for a kind of machine.
#[must_use]
pub fn includes(kinds: &[Kind], kind: Kind) -> bool {
    kinds.is_empty() || kinds.contains(&kind)
}

/// Blank lines, `%`, the program number and comments come before the first block.
fn is_before_first_block(line: &str) -> bool {
    line.chars().next().is_none_or(|first| matches!(first, '%' | 'O' | 'o' | ':' | '(' | ';'))
}

/// The kinds that a comment names; `None` if it begins with another word or names something that is no kind.
fn kinds_in_comment(comment: &str) -> Option<Vec<Kind>> {
    let mut words = comment.split([' ', ',', '，', '、', '：', '=']).filter(|word| !word.is_empty());
    let first = words.next()?;
    WORDS.iter().find(|word| word.eq_ignore_ascii_case(first))?;
    let kinds = words.map(Kind::from_id).collect::<Option<Vec<_>>>()?;
    (!kinds.is_empty()).then_some(kinds)
}
