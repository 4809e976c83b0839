//! The index of a program's text: what a jump, a loop or a call can go to. Each dialect fills in what it has.
//! Source: spec B1, B3, L1, L4, L7, S1.

use crate::defs::program_number;

/// Deepest nesting of WHILE in one program. The numbers after DO are 1 to this.
pub(crate) const LOOP_DEPTH: usize = 3;

/// The index. A dialect leaves empty what it does not have.
#[derive(Clone, Debug, Default)]
pub(crate) struct SourceIndex {
    /// Block numbers at the start of a line: (N, byte at which its block begins), sorted.
    pub block_numbers: Vec<(u32, u32)>,
    /// Block numbers behind a `;`, in the same form.
    pub inner_block_numbers: Vec<(u32, u32)>,
    /// Jump labels: (label in upper case, line from 0), sorted.
    pub jump_labels: Vec<(Box<[u8]>, u32)>,
    /// WHILE loops, sorted by their first byte.
    pub while_loops: Vec<WhileLoop>,
    /// Counted loops (G22 … G80), sorted by their first line.
    pub counted_loops: Vec<CountedLoop>,
    /// First and last byte of the texts that the program shows, in the order of the text.
    pub message_texts: Vec<(u32, u32)>,
    /// The line (from 0) of the first M02.
    pub main_end_line: Option<u32>,
}

impl SourceIndex {
    /// Takes memory for some entries of every table but that of the labels.
    pub fn reserve(&mut self, entries: usize) {
        self.block_numbers.reserve(entries);
        self.inner_block_numbers.reserve(entries);
        self.while_loops.reserve(entries);
        self.counted_loops.reserve(entries);
        self.message_texts.reserve(entries);
    }

    /// Sorts the block numbers, each with the byte of its block. In place: a stable sort would take the memory of a
    /// million numbers again, 8 MB.
    pub fn sort_block_numbers(&mut self) {
        let key = |(n, at): &(u32, u32)| (u64::from(*n) << u32::BITS) | u64::from(*at);
        self.block_numbers.sort_unstable_by_key(key);
        self.inner_block_numbers.sort_unstable_by_key(key);
    }

    /// Empties the index and keeps its memory.
    pub fn clear(&mut self) {
        let Self { block_numbers, inner_block_numbers, jump_labels, while_loops, counted_loops, .. } = self;
        block_numbers.clear();
        inner_block_numbers.clear();
        jump_labels.clear();
        while_loops.clear();
        counted_loops.clear();
        self.message_texts.clear();
        self.main_end_line = None;
    }
}

/// G22 and its G80, lines from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CountedLoop {
    pub line: u32,
    pub end_line: Option<u32>,
}

/// WHILE and its END, given by the bytes at which their blocks begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WhileLoop {
    pub number: u8,
    pub while_at: u32,
    pub end: Option<LoopEnd>,
    /// The index of the loop around it.
    pub outer: Option<u32>,
}

/// The block of END and the block after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LoopEnd {
    pub at: u32,
    pub after: u32,
}

/// A text and the bytes at which its lines begin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextLines<'a> {
    pub text: &'a [u8],
    pub starts: &'a [u32],
}

impl<'a> TextLines<'a> {
    /// Number (from 0), first byte and text of every line, with its line end.
    pub fn iter(self) -> impl Iterator<Item = (u32, usize, &'a [u8])> {
        let ends = self.starts.iter().skip(1).map(|start| *start as usize).chain([self.text.len()]);
        self.starts.iter().zip(ends).enumerate().map(move |(line, (start, end))| {
            let start = *start as usize;
            (line as u32, start, &self.text[start..end])
        })
    }
}

/// The text after leading spaces and, with `brackets`, `( )` comments.
#[inline]
pub(crate) fn after_blanks(mut bytes: &[u8], brackets: bool) -> &[u8] {
    loop {
        let kept = bytes.iter().position(|byte| !matches!(byte, b' ' | b'\t')).unwrap_or(bytes.len());
        bytes = &bytes[kept..];
        if !brackets || bytes.first() != Some(&b'(') {
            return bytes;
        }
        let closed = bytes.iter().position(|byte| matches!(byte, b')' | b'\r' | b'\n'));
        match closed {
            Some(close) if bytes[close] == b')' => bytes = &bytes[close + 1..],
            Some(_) | None => return &[],
        }
    }
}

/// Whether a text begins with a word, in either case.
pub(crate) fn starts_with_word(bytes: &[u8], word: &[u8]) -> bool {
    bytes.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word))
}

/// The number at the start of a text.
pub(crate) fn leading_number(bytes: &[u8], brackets: bool) -> Option<u32> {
    let bytes = after_blanks(bytes, brackets);
    let count = bytes.iter().take(9).position(|byte| !byte.is_ascii_digit()).unwrap_or(bytes.len().min(9));
    let number = bytes[..count].iter().fold(0, |number, digit| number * 10 + u32::from(digit - b'0'));
    (count > 0).then_some(number)
}

/// The block number at the start of a line, and the text after it.
#[inline]
pub(crate) fn block_head(line: &[u8], brackets: bool) -> (Option<u32>, &[u8]) {
    match line.first() {
        Some(b' ' | b'\t' | b'(' | b'/' | b'N' | b'n') => read_block_head(line, brackets),
        _ => (None, line),
    }
}

fn read_block_head(line: &[u8], brackets: bool) -> (Option<u32>, &[u8]) {
    let mut rest = after_blanks(line, brackets);
    if rest.first() == Some(&b'/') {
        if rest.get(1) == Some(&b'/') {
            return (None, &[]);
        }
        let number = usize::from(matches!(rest.get(1), Some(b'1'..=b'9')));
        rest = after_blanks(&rest[1 + number..], brackets);
    }
    if !matches!(rest.first(), Some(b'N' | b'n')) {
        return (None, rest);
    }
    // A label of the 802D may begin with this letter: `NEXT:`.
    let Some(number) = leading_number(&rest[1..], brackets) else { return (None, rest) };
    let rest = after_blanks(&rest[1..], brackets);
    let kept = rest.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(rest.len());
    (Some(number), after_blanks(&rest[kept..], brackets))
}

/// The number of a line that begins with `O1001` or `:1001`, and the rest of the line.
#[must_use]
pub fn o_number(line: &[u8]) -> Option<(u32, &[u8])> {
    let [b'O' | b'o' | b':', rest @ ..] = line.trim_ascii_start() else { return None };
    let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let (number, rest) = rest.split_at(digits);
    let number =
        std::str::from_utf8(number).ok()?.parse().ok().filter(|number| program_number::is_o_number(*number))?;
    let ends = !rest.first().is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte >= 0x80);
    let is_heading =
        (1..=program_number::O_MAX_DIGITS as usize).contains(&digits) && ends && foreign_statement(rest).is_none();
    is_heading.then_some((number, rest))
}

/// Statements that LinuxCNC writes behind an O word.
const FOREIGN_STATEMENTS: [&str; 14] = [
    "SUB",
    "ENDSUB",
    "CALL",
    "RETURN",
    "DO",
    "WHILE",
    "ENDWHILE",
    "IF",
    "ELSEIF",
    "ELSE",
    "ENDIF",
    "REPEAT",
    "ENDREPEAT",
    "BREAK",
];

/// The statement of LinuxCNC with which a text begins.
pub(crate) fn foreign_statement(text: &[u8]) -> Option<&[u8]> {
    let text = after_blanks(text, false);
    let letters = text.iter().position(|byte| !byte.is_ascii_alphabetic()).unwrap_or(text.len());
    let statement = &text[..letters];
    FOREIGN_STATEMENTS.iter().any(|known| known.as_bytes().eq_ignore_ascii_case(statement)).then_some(statement)
}
