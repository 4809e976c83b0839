//! A program's text, with an index of its lines, block numbers, labels and loops built at load. Source: spec B1.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use encoding_rs::GB18030;

use super::fault::{BlockLocation, ReadResult, fail1, fail2};
use super::statement;
use crate::defs::program_error::ProgramError as E;
use crate::defs::program_number;

/// Deepest nesting of WHILE in one program. The numbers after DO are 1 to this.
pub(crate) const LOOP_DEPTH: usize = 3;

/// The UTF-8 byte order mark that some editors write.
const BYTE_ORDER_MARK: &[u8] = &[0xef, 0xbb, 0xbf];

/// Finds the programs that M98, G65, G66 and L call.
pub trait Library {
    /// The program with an O number.
    fn find(&self, number: u32) -> Option<Arc<Source>>;
}

/// A library without programs.
#[derive(Clone, Copy, Debug, Default)]
pub struct EmptyLibrary;

impl Library for EmptyLibrary {
    fn find(&self, _number: u32) -> Option<Arc<Source>> {
        None
    }
}

/// A program's text.
#[derive(Clone, Debug)]
pub struct Source {
    number: u32,
    name: String,
    bytes: Arc<[u8]>,
    utf8: bool,
    line_offsets: Vec<u32>,
    /// Block numbers at the start of a line: (N, byte at which its block begins), sorted.
    block_numbers: Vec<(u32, u32)>,
    /// Block numbers behind a `;`, in the same form.
    inner_block_numbers: Vec<(u32, u32)>,
    /// Jump labels: (label in upper case, line from 0), sorted.
    jump_labels: Vec<(Box<[u8]>, u32)>,
    while_loops: Vec<WhileLoop>,
    /// Counted loops (G22 … G80), sorted by their first line.
    counted_loops: Vec<CountedLoop>,
    /// The line (from 0) of the first M02; found on first use.
    main_end_line: OnceLock<Option<u32>>,
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
}

/// The block of END and the block after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LoopEnd {
    pub at: u32,
    pub after: u32,
}

impl Source {
    /// Indexes a program's text: GBK or UTF-8, line ends CR, LF or CR LF.
    ///
    /// # Panics
    /// If the text has 4 GiB or more; the caller limits file sizes.
    #[must_use]
    pub fn new(number: u32, name: impl Into<String>, bytes: impl Into<Arc<[u8]>>) -> Self {
        let bytes = bytes.into();
        assert!(bytes.len() < u32::MAX as usize, "program of {} bytes", bytes.len());
        let lines = line_starts(&bytes);
        let utf8 = std::str::from_utf8(&bytes).is_ok();
        let mut source = Self {
            number,
            name: name.into(),
            bytes,
            utf8,
            line_offsets: lines,
            block_numbers: Vec::new(),
            inner_block_numbers: Vec::new(),
            jump_labels: Vec::new(),
            while_loops: Vec::new(),
            counted_loops: Vec::new(),
            main_end_line: OnceLock::new(),
        };
        source.build_index();
        source
    }

    /// The O number.
    #[must_use]
    #[inline]
    pub const fn number(&self) -> u32 {
        self.number
    }

    /// The displayed name of the program: its number, or the name of its file.
    #[must_use]
    pub fn title(&self) -> String {
        if program_number::is_named(self.number) {
            program_number::stem(&self.name).to_owned()
        } else {
            program_number::name_of(self.number)
        }
    }

    /// The file name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text.
    #[must_use]
    #[inline]
    pub fn bytes(&self) -> &Arc<[u8]> {
        &self.bytes
    }

    /// The number of lines. A last line without line end counts.
    #[must_use]
    pub fn line_count(&self) -> usize {
        let open_end = self.line_offsets.last().is_some_and(|start| (*start as usize) < self.bytes.len());
        self.line_offsets.len() - usize::from(!open_end)
    }

    /// A line (from 1) as text, without its line end.
    #[must_use]
    pub fn line(&self, line: u32) -> Option<String> {
        let index = (line as usize).checked_sub(1)?;
        let start = *self.line_offsets.get(index)? as usize;
        let end = self.line_offsets.get(index + 1).map_or(self.bytes.len(), |next| *next as usize);
        let bytes = self.bytes.get(start..end)?;
        let kept = bytes.iter().rposition(|byte| !matches!(byte, b'\r' | b'\n')).map_or(0, |last| last + 1);
        Some(self.decode(&bytes[..kept]))
    }

    /// The text of the first comment; the directory shows it beside the number.
    #[must_use]
    pub fn comment_title(&self) -> Option<String> {
        let open = self.bytes.iter().position(|byte| matches!(byte, b'(' | b';'))?;
        let closing: &[u8] = if self.bytes[open] == b'(' { b")\r\n" } else { b"\r\n" };
        let rest = &self.bytes[open + 1..];
        let end = rest.iter().position(|byte| closing.contains(byte)).unwrap_or(rest.len());
        let title = self.decode(&rest[..end]);
        let title = title.trim();
        (!title.is_empty()).then(|| title.to_owned())
    }

    /// The byte at which the last non-blank line begins.
    pub(crate) fn last_line_start(&self) -> usize {
        let blank = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\r' | b'\n');
        let last = self.bytes.iter().rposition(|byte| !blank(byte)).unwrap_or(0);
        self.line_offsets.iter().rev().map(|start| *start as usize).find(|start| *start <= last).unwrap_or(0)
    }

    /// The byte at which a line (from 0) begins.
    pub(crate) fn line_start(&self, line: u32) -> usize {
        self.line_offsets.get(line as usize).map_or(self.bytes.len(), |start| *start as usize)
    }

    /// The line (from 0) that contains a byte.
    pub(crate) fn line_of(&self, at: usize) -> u32 {
        self.line_offsets.partition_point(|start| *start as usize <= at).saturating_sub(1) as u32
    }

    /// The byte at which the block with number `n` begins: the next one after byte `at`, else the first in the text.
    pub(crate) fn find_block(&self, n: u32, at: usize) -> Option<usize> {
        let from = |from: u32| {
            let next = |labels: &[(u32, u32)]| {
                let index = labels.partition_point(|label| *label < (n, from));
                labels.get(index).filter(|label| label.0 == n).map(|label| label.1)
            };
            next(&self.block_numbers).into_iter().chain(next(&self.inner_block_numbers)).min()
        };
        from(at as u32 + 1).or_else(|| from(0)).map(|found| found as usize)
    }

    /// The line of the nearest label after `line` (forward), or at or before it. `identifier` is its byte range in the text.
    pub(crate) fn find_label(&self, name: Range<usize>, line: u32, forward: bool) -> ReadResult<u32> {
        let at = name.start;
        let wanted = self.bytes.get(name).unwrap_or_default().to_ascii_uppercase();
        let from = self.jump_labels.partition_point(|(label, at)| (&**label, *at) < (&*wanted, 0));
        let own = self.jump_labels[from..].iter().take_while(|(label, _)| **label == *wanted).map(|(_, at)| *at);
        let found = match forward {
            true => own.clone().find(|at| *at > line),
            false => own.clone().filter(|at| *at <= line).last(),
        };
        match found {
            Some(line) => Ok(line),
            None if own.count() > 0 => {
                let right = if forward { "GOTOB" } else { "GOTOF" };
                fail2(at, E::LabelInOtherDirection, String::from_utf8_lossy(&wanted), right)
            }
            None => fail1(at, E::MissingLabel, String::from_utf8_lossy(&wanted)),
        }
    }

    /// The line (from 0) of the only block with number `n`: none if it is missing, an error if there are several.
    pub(crate) fn find_unique_block(&self, n: u32) -> Result<Option<u32>, ()> {
        let first = self.block_numbers.partition_point(|label| *label < (n, 0));
        let is = |index: usize| self.block_numbers.get(index).filter(|label| label.0 == n).map(|label| label.1);
        let is = |index: usize| is(index).map(|at| self.line_of(at as usize));
        if is(first + 1).is_some() { Err(()) } else { Ok(is(first)) }
    }

    /// The line (from 0) that ends the main program: the first with an M02 (L7).
    pub(crate) fn main_end_line(&self) -> Option<u32> {
        let ends = |line: u32| has_code(&self.bytes[self.line_start(line)..self.line_start(line + 1)], b'M', 2);
        *self.main_end_line.get_or_init(|| (0..self.line_offsets.len() as u32).find(|line| ends(*line)))
    }

    /// The counted loop that begins in a line (from 0).
    pub(crate) fn counted_loop_at(&self, line: u32) -> Option<CountedLoop> {
        let index = self.counted_loops.binary_search_by_key(&line, |found| found.line).ok()?;
        self.counted_loops.get(index).copied()
    }

    /// The first line (from 0) of the counted loop that ends in a line.
    pub(crate) fn counted_loop_start(&self, end_line: u32) -> Option<u32> {
        self.counted_loops.iter().find(|found| found.end_line == Some(end_line)).map(|found| found.line)
    }

    /// Labels that occur more than once: line (from 0) of each occurrence but the first, and the label.
    pub(crate) fn repeated_labels(&self) -> impl Iterator<Item = (u32, &[u8])> {
        self.jump_labels.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| (pair[1].1, &*pair[1].0))
    }

    /// The WHILE loop whose block begins at a byte.
    pub(crate) fn while_loop_at(&self, at: usize) -> Option<WhileLoop> {
        let index = self.while_loops.binary_search_by_key(&(at as u32), |found| found.while_at).ok()?;
        self.while_loops.get(index).copied()
    }

    /// The line and column of a byte, both from 1.
    pub(crate) fn locate(&self, at: usize, n: Option<u32>) -> (BlockLocation, u32) {
        let at = at.min(self.bytes.len());
        let line = self.line_offsets.partition_point(|start| *start as usize <= at).max(1);
        let start = self.line_start(line as u32 - 1);
        let column = self.decode(&self.bytes[start.min(at)..at]).chars().count() + 1;
        (BlockLocation { program: self.number, line: line as u32, n }, column as u32)
    }

    /// Decodes bytes of the text: as UTF-8 if the whole program is valid UTF-8, else as GBK.
    pub(crate) fn decode(&self, bytes: &[u8]) -> String {
        let text =
            if self.utf8 { String::from_utf8_lossy(bytes) } else { GB18030.decode_without_bom_handling(bytes).0 };
        text.into_owned()
    }

    /// The non-ASCII character that begins at a byte, and what to type instead.
    pub(crate) fn foreign_character(&self, at: usize) -> Option<(char, String)> {
        let rest = self.bytes.get(at..(at + 4).min(self.bytes.len()))?;
        let character = self.decode(rest).chars().next()?;
        // Without an ASCII equivalent it belongs in a comment. SINUMERIK comments begin with `;`.
        let end = self.name.rsplit_once('.').map(|(_, end)| end.to_ascii_uppercase());
        let comment = if matches!(end.as_deref(), Some("MPF" | "SPF")) { ";" } else { "( )" };
        Some((character, ascii_equivalent(character).map_or_else(|| comment.to_owned(), |ascii| format!("'{ascii}'"))))
    }

    fn build_index(&mut self) {
        let mut open = OpenLoops::default();
        let divided = self.bytes.contains(&b';');
        for line in 0..self.line_offsets.len() as u32 {
            let start = self.line_start(line);
            let end = self.line_start(line + 1);
            let (n, rest) = block_head(&self.bytes[start..]);
            open.closed = None;
            if let Some(n) = n {
                self.block_numbers.push((n, start as u32));
            }
            if let Some(name) = leading_label(rest) {
                self.jump_labels.push((name.to_ascii_uppercase().into_boxed_slice(), line));
            }
            match rest.first() {
                Some(b'G' | b'g') if is_code(rest, b"G22") => {
                    open.counted.push(self.counted_loops.len());
                    self.counted_loops.push(CountedLoop { line, end_line: None });
                }
                Some(b'G' | b'g') if is_code(rest, b"G80") => {
                    if let Some(place) = open.counted.pop().and_then(|index| self.counted_loops.get_mut(index)) {
                        place.end_line = Some(line);
                    }
                }
                Some(b'W' | b'w' | b'E' | b'e') => open.visit_block(&mut self.while_loops, rest, start, end),
                _ => {}
            }
            if divided && self.bytes[start..end].contains(&b';') {
                self.index_rest_of_line(start, end, &mut open);
            }
        }
        self.block_numbers.sort();
        self.inner_block_numbers.sort();
        self.jump_labels.sort();
    }

    /// Block numbers and loops behind the `;` of a line.
    #[cold]
    fn index_rest_of_line(&mut self, start: usize, end: usize, open: &mut OpenLoops) {
        let bytes = Arc::clone(&self.bytes);
        let mut at = start;
        while let Some(next) = statement::next_block_on_line(&bytes[..end], at, at > start) {
            // The previous block ends here. If it is an END, this is the block after the loop.
            let closed = open.closed.and_then(|index| self.while_loops.get_mut(index));
            if let Some(end) = closed.and_then(|found| found.end.as_mut()) {
                end.after = next as u32;
            }
            let (n, rest) = block_head(&bytes[next..end]);
            if let Some(n) = n {
                self.inner_block_numbers.push((n, next as u32));
            }
            open.visit_block(&mut self.while_loops, rest, next, end);
            at = next;
        }
    }
}

/// The loops that are open while the text is indexed.
#[derive(Default)]
struct OpenLoops {
    loops: [usize; LOOP_DEPTH],
    depth: usize,
    /// The loop that the last block closed.
    closed: Option<usize>,
    counted: Vec<usize>,
}

impl OpenLoops {
    /// Opens or closes a loop if the block is a WHILE or END. `end` is the end of its line.
    fn visit_block(&mut self, loops: &mut Vec<WhileLoop>, block: &[u8], at: usize, end: usize) {
        self.closed = None;
        if starts_with_word(block, b"WHILE") {
            if let Some(place) = self.loops.get_mut(self.depth) {
                *place = loops.len();
                self.depth += 1;
            }
            loops.push(WhileLoop { number: do_number(block), while_at: at as u32, end: None });
        } else if starts_with_word(block, b"END") {
            let number = leading_number(&block[3..]).unwrap_or(0) as u8;
            let Some(index) = self.depth.checked_sub(1).map(|top| self.loops[top]) else { return };
            if let Some(place) = loops.get_mut(index).filter(|place| place.number == number) {
                place.end = Some(LoopEnd { at: at as u32, after: end as u32 });
                self.closed = Some(index);
                self.depth -= 1;
            }
        }
    }
}

/// The first line end in `bytes`; compares eight bytes at a time.
fn line_end(bytes: &[u8]) -> Option<usize> {
    const ONES: u64 = 0x0101_0101_0101_0101;
    const HIGHS: u64 = 0x8080_8080_8080_8080;
    let (chunks, _) = bytes.as_chunks::<8>();
    let mut at = 0;
    for chunk in chunks {
        let word = u64::from_le_bytes(*chunk);
        let (lf, cr) = (word ^ (ONES * 0x0a), word ^ (ONES * 0x0d));
        let found = (lf.wrapping_sub(ONES) & !lf & HIGHS) | (cr.wrapping_sub(ONES) & !cr & HIGHS);
        if found != 0 {
            return Some(at + found.trailing_zeros() as usize / 8);
        }
        at += 8;
    }
    bytes[at..].iter().position(|byte| matches!(byte, b'\n' | b'\r')).map(|rest| at + rest)
}

fn line_starts(bytes: &[u8]) -> Vec<u32> {
    let mut starts = Vec::with_capacity(bytes.len() / 24 + 1);
    let mut at = if bytes.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
    starts.push(at as u32);
    while let Some(end) = line_end(&bytes[at..]) {
        let pair = bytes[at + end] == b'\r' && bytes.get(at + end + 1) == Some(&b'\n');
        at += end + 1 + usize::from(pair);
        starts.push(at as u32);
    }
    starts
}

/// The text after leading spaces and `( )` comments.
fn after_blanks(mut bytes: &[u8]) -> &[u8] {
    loop {
        let kept = bytes.iter().position(|byte| !matches!(byte, b' ' | b'\t')).unwrap_or(bytes.len());
        bytes = &bytes[kept..];
        if bytes.first() != Some(&b'(') {
            return bytes;
        }
        let closed = bytes.iter().position(|byte| matches!(byte, b')' | b'\r' | b'\n'));
        match closed {
            Some(close) if bytes[close] == b')' => bytes = &bytes[close + 1..],
            Some(_) | None => return &[],
        }
    }
}

fn starts_with_word(bytes: &[u8], word: &[u8]) -> bool {
    bytes.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word))
}

/// Whether a line contains a code outside its comments, with or without leading zeros.
fn has_code(line: &[u8], letter: u8, number: u32) -> bool {
    let mut depth = 0_u32;
    for (at, byte) in line.iter().enumerate() {
        match byte {
            b';' if depth == 0 => return false,
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            _ if depth == 0
                && byte.to_ascii_uppercase() == letter
                && leading_number(&line[at + 1..]) == Some(number) =>
            {
                return true;
            }
            _ => {}
        }
    }
    false
}

/// Whether a line begins with a code that no further digit follows.
fn is_code(bytes: &[u8], word: &[u8]) -> bool {
    starts_with_word(bytes, word) && !bytes.get(word.len()).is_some_and(u8::is_ascii_digit)
}

fn leading_number(bytes: &[u8]) -> Option<u32> {
    let bytes = after_blanks(bytes);
    let count = bytes.iter().take(9).position(|byte| !byte.is_ascii_digit()).unwrap_or(bytes.len().min(9));
    let number = bytes[..count].iter().fold(0, |number, digit| number * 10 + u32::from(digit - b'0'));
    (count > 0).then_some(number)
}

/// The block number at the start of a line, and the text after it.
fn block_head(line: &[u8]) -> (Option<u32>, &[u8]) {
    let mut rest = after_blanks(line);
    if rest.first() == Some(&b'/') {
        if rest.get(1) == Some(&b'/') {
            return (None, &[]);
        }
        rest = after_blanks(&rest[1..]);
    }
    if !matches!(rest.first(), Some(b'N' | b'n')) {
        return (None, rest);
    }
    let number = leading_number(&rest[1..]);
    let rest = after_blanks(&rest[1..]);
    let kept = rest.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(rest.len());
    (number, after_blanks(&rest[kept..]))
}

/// The identifier at the start of a text: two letters or `_`, then letters, digits and `_`.
pub(crate) fn identifier(text: &[u8]) -> Option<&[u8]> {
    let letter = |byte: &u8| byte.is_ascii_alphabetic() || *byte == b'_';
    if !text.get(..2)?.iter().all(letter) {
        return None;
    }
    let length = text.iter().take_while(|byte| letter(byte) || byte.is_ascii_digit()).count();
    text.get(..length)
}

/// The label at the start of a block, before its `:`.
fn leading_label(text: &[u8]) -> Option<&[u8]> {
    let name = identifier(text)?;
    let after = text[name.len()..].iter().find(|byte| !matches!(byte, b' ' | b'\t'));
    (after == Some(&b':')).then_some(name)
}

/// The number after the last DO of a block, 0 if there is none.
fn do_number(block: &[u8]) -> u8 {
    let end = block.iter().position(|byte| matches!(byte, b'\r' | b'\n' | b';')).unwrap_or(block.len());
    let block = &block[..end];
    let place = block.windows(2).rposition(|pair| pair.eq_ignore_ascii_case(b"DO"));
    place.and_then(|place| leading_number(&block[place + 2..])).map_or(0, |number| number.min(255) as u8)
}

/// The ASCII equivalent of a full-width or typographic character.
fn ascii_equivalent(character: char) -> Option<char> {
    match character {
        '\u{ff01}'..='\u{ff5e}' => char::from_u32(character as u32 - 0xfee0),
        '\u{3000}' | '\u{a0}' => Some(' '),
        '。' => Some('.'),
        '、' => Some(','),
        '【' | '〔' => Some('['),
        '】' | '〕' => Some(']'),
        '“' | '”' => Some('"'),
        '‘' | '’' => Some('\''),
        '—' | '–' | '−' => Some('-'),
        '×' => Some('*'),
        '÷' => Some('/'),
        _ => None,
    }
}

/// Whether only `%`, blanks and comments precede a byte.
pub(crate) fn is_at_text_head(text: &[u8], at: usize) -> bool {
    let head = text.get(..at).unwrap_or_default();
    let head = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head);
    head.split(|byte| matches!(byte, b'\r' | b'\n')).all(|line| {
        let line = after_blanks(line);
        let line = after_blanks(line.strip_prefix(b"%").unwrap_or(line));
        line.is_empty() || line[0] == b';' || line.starts_with(b"//")
    })
}
