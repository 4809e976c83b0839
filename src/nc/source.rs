//! A program's text, with an index of its lines, and of what its dialect can jump to, built at load. Source: spec B1.

use std::fmt::{self, Write};
use std::ops::Range;
use std::sync::Arc;

use encoding_rs::{CoderResult, GB18030};

use super::fault::{BlockLocation, Capitals, E, ErrorAt, ProgramFault, ReadResult, fail1, fail2};
use super::lexer;
use super::message_texts::{self, AlarmHelp, MessageTexts};
use super::misread_text;
use super::source_index::{CountedLoop, SourceIndex, TextLines, WhileLoop, after_blanks};
use crate::defs::kind::Dialect;
use crate::defs::program_number;
use crate::defs::text::arg::Arg;
use crate::defs::value_bound::ValueBound;

/// The UTF-8 byte order mark that some editors write.
const BYTE_ORDER_MARK: &[u8] = &[0xef, 0xbb, 0xbf];

/// Lines and blocks for which the index of a short text takes memory.
const SHORT_TEXT_LINES: usize = 64;

/// Finds the programs that M98, G65, G66 and L call.
pub trait Library {
    /// The program with an O number.
    fn find(&self, number: u32) -> Option<Arc<Source>>;
    /// The places of a number that several programs have: none of them is called.
    fn places_of_duplicate(&self, _number: u32) -> Option<&str> {
        None
    }
}

/// A library that a program and its subprograms share.
pub type SharedLibrary = Arc<dyn Library + Send + Sync>;

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
    title: Arg,
    bytes: Vec<u8>,
    utf8: bool,
    line_offsets: Vec<u32>,
    dialect: Dialect,
    index: SourceIndex,
    /// The texts of the index, decoded; with their English where the program gives it.
    messages: Vec<Arg>,
    /// What the program says of its messages and alarms.
    texts: MessageTexts,
}

impl Source {
    /// A text with the index that `index` makes of its lines. `Source::new` takes the index of the dialect.
    pub(crate) fn indexed(
        number: u32,
        name: String,
        bytes: Vec<u8>,
        dialect: Dialect,
        index_text: fn(&TextLines<'_>, &mut SourceIndex),
    ) -> Self {
        let named = program_number::is_named(number);
        let title = if named { program_number::stem(&name).into() } else { Arg::Program(number) };
        let (line_offsets, index) = (Vec::with_capacity(bytes.len() / 24 + 1), SourceIndex::default());
        let (messages, texts) = (Vec::new(), MessageTexts::default());
        let mut source =
            Self { number, name, title, bytes, utf8: false, line_offsets, dialect, index, messages, texts };
        let mut comments = Vec::new();
        source.index_with(index_text, &mut |line| comments.push(line));
        source.read_message_texts(&comments);
        source
    }

    /// Reads the rows of texts among the lines (from 0) that may be comments, and puts the English of the messages beside
    /// them.
    fn read_message_texts(&mut self, comments: &[u32]) {
        let brackets = self.dialect.has_bracket_comments();
        let rows = comments.iter().filter_map(|line| {
            let comment =
                self.lone_comment(*line as usize, brackets).filter(|bytes| message_texts::is_row_start(bytes))?;
            Some((line + 1, self.decode(comment)))
        });
        let mut texts = MessageTexts::read(rows);
        for ((start, _), message) in self.index.message_texts.iter().zip(&mut self.messages) {
            let start = *start as usize;
            let line = self.line_offsets.partition_point(|offset| *offset as usize <= start);
            let from = line.checked_sub(1).map_or(0, |line| self.line_offsets[line] as usize);
            // Before the bracket or the quotation mark.
            let before = self.bytes.get(from..start.saturating_sub(1)).unwrap_or_default();
            texts.name_variable(before, message);
            *message = texts.translate(before, std::mem::take(message));
        }
        self.texts = texts;
    }

    /// The comment of a line (from 0) that has nothing else.
    fn lone_comment(&self, line: usize, brackets: bool) -> Option<&[u8]> {
        let start = *self.line_offsets.get(line)? as usize;
        let end = self.line_offsets.get(line + 1).map_or(self.bytes.len(), |next| *next as usize);
        let text = self.bytes.get(start..end)?.trim_ascii();
        match brackets {
            true => text.strip_prefix(b"(")?.strip_suffix(b")").map(<[u8]>::trim_ascii_start),
            false => text.strip_prefix(b";").map(<[u8]>::trim_ascii_start),
        }
    }

    /// The English title of the program, if it gives one.
    #[must_use]
    pub fn english_title(&self) -> Option<&str> {
        self.texts.english_title()
    }

    /// The bounds of values that its alarms name.
    #[must_use]
    pub const fn value_bounds(&self) -> &Arc<[ValueBound]> {
        self.texts.bounds()
    }

    /// What the program says of an alarm that it raises, 3000 to 3999.
    #[must_use]
    pub fn alarm_help(&self, number: u32) -> Option<&AlarmHelp> {
        self.texts.alarm_help(number)
    }

    /// The rows of texts, and the texts that the program shows.
    pub(crate) fn message_texts(&self) -> (&MessageTexts, &[Arg]) {
        (&self.texts, &self.messages)
    }

    /// Takes memory for the index of a short text.
    pub(crate) fn reserve_index(&mut self) {
        self.line_offsets.reserve(SHORT_TEXT_LINES);
        self.index.reserve(SHORT_TEXT_LINES);
        self.messages.reserve(SHORT_TEXT_LINES);
    }

    /// Replaces the text, in the memory of this one.
    pub(crate) fn replace_text(&mut self, text: &[u8], index_text: fn(&TextLines<'_>, &mut SourceIndex)) {
        self.bytes.clear();
        self.bytes.extend_from_slice(text);
        self.index_with(index_text, &mut |_| ());
    }

    /// Indexes the text. `comment` is called for each line, from 0, that may be a comment.
    fn index_with(&mut self, index_text: fn(&TextLines<'_>, &mut SourceIndex), comment: &mut impl FnMut(u32)) {
        assert!(self.bytes.len() < u32::MAX as usize, "program of {} bytes", self.bytes.len());
        self.utf8 = std::str::from_utf8(&self.bytes).is_ok();
        push_line_starts(&self.bytes, &mut self.line_offsets, comment);
        self.index.clear();
        index_text(&TextLines { text: &self.bytes, starts: &self.line_offsets }, &mut self.index);
        self.messages.clear();
        for index in 0..self.index.message_texts.len() {
            let (start, end) = self.index.message_texts[index];
            let text = DecodedText(self, &self.bytes[start as usize..end as usize]);
            self.messages.push(format_args!("{text}").into());
        }
    }

    /// The O number.
    #[must_use]
    #[inline]
    pub const fn number(&self) -> u32 {
        self.number
    }

    /// The dialect of the program.
    #[must_use]
    #[inline]
    pub const fn dialect(&self) -> Dialect {
        self.dialect
    }

    /// The displayed name of the program: its number, or the name of its file.
    #[must_use]
    pub fn title(&self) -> String {
        self.title.to_text()
    }

    /// [`Self::title`] as an argument of a phrase.
    #[must_use]
    pub fn title_arg(&self) -> Arg {
        self.title.clone()
    }

    /// The file name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text.
    #[must_use]
    #[inline]
    pub fn bytes(&self) -> &[u8] {
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
        let brackets = self.dialect.has_bracket_comments();
        let open = self.bytes.iter().position(|byte| *byte == b';' || brackets && *byte == b'(')?;
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

    /// Whether a `%` in a line (from 0) ends the text.
    pub(crate) fn ends_in_line(&self, line: u32) -> bool {
        let start = self.line_start(line);
        let text = self.bytes.get(start..self.line_start(line + 1)).unwrap_or_default();
        matches!(text.trim_ascii_start().first(), Some(b'%' | 0x1a)) && !self.is_at_head(start)
    }

    /// The byte at which a line (from 0) begins.
    pub(crate) fn line_start(&self, line: u32) -> usize {
        self.line_offsets.get(line as usize).map_or(self.bytes.len(), |start| *start as usize)
    }

    /// The bytes of a line (from 0), its end included.
    pub(crate) fn line_bytes(&self, line: u32) -> &[u8] {
        self.bytes.get(self.line_start(line)..self.line_start(line + 1)).unwrap_or_default()
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
            next(&self.index.block_numbers).into_iter().chain(next(&self.index.inner_block_numbers)).min()
        };
        from(at as u32 + 1).or_else(|| from(0)).map(|found| found as usize)
    }

    /// The last block with this number that begins before byte `at`.
    pub(crate) fn find_block_before(&self, n: u32, at: usize) -> Option<usize> {
        let last = |labels: &[(u32, u32)]| {
            let end = labels.partition_point(|label| *label < (n, at as u32));
            labels[..end].last().filter(|label| label.0 == n).map(|label| label.1)
        };
        last(&self.index.block_numbers).max(last(&self.index.inner_block_numbers)).map(|found| found as usize)
    }

    /// The line of the nearest label, or block with this number, after `line` (forward), or at or before it. `name` is the
    /// byte range of `AA1` or `N100` in the text.
    pub(crate) fn find_label(&self, name: Range<usize>, line: u32, forward: bool) -> ReadResult<u32> {
        let at = name.start;
        let written = self.bytes.get(name).unwrap_or_default();
        let number = match written {
            [b'N' | b'n', digits @ ..] => {
                std::str::from_utf8(digits).ok().and_then(|digits| digits.parse::<u32>().ok())
            }
            _ => None,
        };
        let (found, missing) = match number {
            Some(n) => {
                let first = self.index.block_numbers.partition_point(|block| *block < (n, 0));
                let own = self.index.block_numbers[first..].iter().take_while(|block| block.0 == n);
                (nearest_line(own.map(|(_, start)| self.line_of(*start as usize)), line, forward), E::MissingTarget)
            }
            None => {
                // The labels of the index are in capitals.
                let wanted = || written.iter().map(u8::to_ascii_uppercase);
                let from = self.index.jump_labels.partition_point(|(label, _)| label.iter().copied().lt(wanted()));
                let same = |label: &[u8]| label.eq_ignore_ascii_case(written);
                let own = self.index.jump_labels[from..].iter().take_while(|(label, _)| same(label));
                (nearest_line(own.map(|(_, at)| *at), line, forward), E::MissingLabel)
            }
        };
        match found {
            Some(Some(line)) => Ok(line),
            Some(None) => {
                let right = if forward { "GOTOB" } else { "GOTOF" };
                fail2(at, E::LabelInOtherDirection, Capitals(written), right)
            }
            None => fail1(at, missing, Capitals(written)),
        }
    }

    /// The line (from 0) of the only block with number `n`: none if it is missing, an error if there are several.
    pub(crate) fn find_unique_block(&self, n: u32) -> Result<Option<u32>, ()> {
        let first = self.index.block_numbers.partition_point(|label| *label < (n, 0));
        match &self.index.block_numbers[first..] {
            [(a, _), (b, _), ..] if *a == n && *b == n => Err(()),
            [(a, at), ..] if *a == n => Ok(Some(self.line_of(*at as usize))),
            _ => Ok(None),
        }
    }

    /// The line (from 0) that ends the main program: the first with an M02 (L7).
    pub(crate) const fn main_end_line(&self) -> Option<u32> {
        self.index.main_end_line
    }

    /// The counted loop that begins in a line (from 0).
    pub(crate) fn counted_loop_at(&self, line: u32) -> Option<CountedLoop> {
        let index = self.index.counted_loops.binary_search_by_key(&line, |found| found.line).ok()?;
        self.index.counted_loops.get(index).copied()
    }

    /// The first line (from 0) of the counted loop that ends in a line.
    pub(crate) fn counted_loop_start(&self, end_line: u32) -> Option<u32> {
        self.index.counted_loops.iter().find(|found| found.end_line == Some(end_line)).map(|found| found.line)
    }

    /// Labels that occur more than once: line (from 0) of each occurrence but the first, and the label.
    pub(crate) fn repeated_labels(&self) -> impl Iterator<Item = (u32, &[u8])> {
        self.index.jump_labels.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| (pair[1].1, &*pair[1].0))
    }

    /// The WHILE loop whose block begins at a byte.
    pub(crate) fn while_loop_at(&self, at: usize) -> Option<WhileLoop> {
        let index = self.index.while_loops.binary_search_by_key(&(at as u32), |found| found.while_at).ok()?;
        self.index.while_loops.get(index).copied()
    }

    /// The WHILE loop whose END block begins at a byte.
    pub(crate) fn while_loop_of_end(&self, at: usize) -> Option<WhileLoop> {
        let ends_here = |found: &&WhileLoop| found.end.is_some_and(|end| end.at as usize == at);
        self.index.while_loops.iter().find(ends_here).copied()
    }

    /// The WHILE loops around the block that begins at a byte, from the inside.
    pub(crate) fn while_loops_around(&self, at: usize) -> impl Iterator<Item = WhileLoop> {
        let loops = &self.index.while_loops;
        let last = loops.partition_point(|found| (found.while_at as usize) < at).checked_sub(1);
        let chain = std::iter::successors(last, |index| loops.get(*index)?.outer.map(|outer| outer as usize));
        let encloses = move |found: &WhileLoop| found.end.is_some_and(|end| end.at as usize >= at);
        chain.filter_map(|index| loops.get(index).copied()).filter(encloses)
    }

    /// The line and column of a byte, both from 1.
    pub(crate) fn locate(&self, at: usize, n: Option<u32>) -> (BlockLocation, u32) {
        let at = at.min(self.bytes.len());
        let line = self.line_offsets.partition_point(|start| *start as usize <= at).max(1);
        let start = self.line_start(line as u32 - 1);
        let mut column = 1;
        self.decode_chars(&self.bytes[start.min(at)..at], |_| column += 1);
        (BlockLocation { program: self.number, line: line as u32, n }, column)
    }

    /// Whether the word or variable of a mistake has a number that is written there.
    pub(crate) fn is_literal_at(&self, fault: &ProgramFault) -> bool {
        let start = self.line_start(fault.location.line.saturating_sub(1));
        let line = self.bytes.get(start..).unwrap_or_default();
        // Columns count characters: behind others than ASCII the word is not found.
        lexer::is_literal(line, line.len().min(fault.column.saturating_sub(1) as usize))
    }

    /// The mistake with its line and column; `n` is the number of its block.
    pub(crate) fn fault(&self, n: Option<u32>, mut wrong: ErrorAt) -> ProgramFault {
        if wrong.error == E::NonAsciiCharacter
            && wrong.details[1].is_empty()
            && let Some((character, instead)) = self.foreign_character(wrong.at)
        {
            wrong.details = if character == char::REPLACEMENT_CHARACTER {
                wrong.error = E::BadEncoding;
                let byte = self.bytes.get(wrong.at);
                [byte.map_or(Arg::None, |byte| format_args!("0x{byte:02X}").into()), instead]
            } else {
                [character.into(), instead]
            };
        }
        misread_text::name_misread_text(&self.bytes, self.dialect, &mut wrong);
        let (place, column) = self.locate(wrong.at, n);
        ProgramFault::new(self.title_arg(), place, column, wrong)
    }

    /// Whether only `%`, blanks and comments precede a byte.
    pub(crate) fn is_at_head(&self, at: usize) -> bool {
        let head = self.bytes.get(..at).unwrap_or_default();
        let head = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head);
        let brackets = self.dialect.has_bracket_comments();
        head.split(|byte| matches!(byte, b'\r' | b'\n')).all(|line| {
            let line = after_blanks(line, brackets);
            let line = after_blanks(line.strip_prefix(b"%").unwrap_or(line), brackets);
            line.is_empty() || line[0] == b';' || line.starts_with(b"//")
        })
    }

    /// Decodes bytes of the text: as UTF-8 if the whole program is valid UTF-8, else as GBK.
    pub(crate) fn decode(&self, bytes: &[u8]) -> String {
        DecodedText(self, bytes).to_string()
    }

    /// Passes the characters of [`Self::decode`] to `tell`, without memory for them.
    fn decode_chars(&self, bytes: &[u8], mut tell: impl FnMut(char)) {
        if self.utf8 {
            for chunk in bytes.utf8_chunks() {
                chunk.valid().chars().for_each(&mut tell);
                if !chunk.invalid().is_empty() {
                    tell(char::REPLACEMENT_CHARACTER);
                }
            }
            return;
        }
        let (mut decoder, mut rest, mut decoded) = (GB18030.new_decoder_without_bom_handling(), bytes, [0_u8; 64]);
        loop {
            let (result, read, written, _) = decoder.decode_to_utf8(rest, &mut decoded, true);
            str::from_utf8(&decoded[..written]).unwrap_or_default().chars().for_each(&mut tell);
            rest = &rest[read..];
            if result == CoderResult::InputEmpty {
                return;
            }
        }
    }

    /// A text that the program shows, by its bytes. Those that the index has found are decoded already.
    pub(crate) fn message_text(&self, range: Range<usize>) -> Arg {
        let key = (range.start as u32, range.end as u32);
        match self.index.message_texts.binary_search(&key) {
            Ok(index) => self.messages[index].clone(),
            Err(_) => format_args!("{}", DecodedText(self, self.bytes.get(range).unwrap_or_default())).into(),
        }
    }

    /// The non-ASCII character that begins at a byte, and what to type instead.
    pub(crate) fn foreign_character(&self, at: usize) -> Option<(char, Arg)> {
        let rest = self.bytes.get(at..(at + 4).min(self.bytes.len()))?;
        let mut first = None;
        self.decode_chars(rest, |character| first = first.or(Some(character)));
        let character = first?;
        // Without an ASCII equivalent it belongs in a comment.
        let comment = if self.dialect.has_bracket_comments() { "( )" } else { ";" };
        Some((
            character,
            ascii_equivalent(character).map_or_else(|| comment.into(), |ascii| format_args!("'{ascii}'").into()),
        ))
    }
}

/// Bytes of a text, decoded as they are written.
struct DecodedText<'s>(&'s Source, &'s [u8]);

impl fmt::Display for DecodedText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut written = Ok(());
        self.0.decode_chars(self.1, |character| written = written.and_then(|()| f.write_char(character)));
        written
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

/// Finds the lines. `comment` is called for each one, from 0, that begins as a comment or with a blank.
fn push_line_starts(bytes: &[u8], starts: &mut Vec<u32>, comment: &mut impl FnMut(u32)) {
    starts.clear();
    let mut at = if bytes.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
    let mut begin_line = |at: usize, starts: &mut Vec<u32>| {
        if matches!(bytes.get(at), Some(b'(' | b';' | b' ' | b'\t')) {
            comment(starts.len() as u32);
        }
        starts.push(at as u32);
    };
    begin_line(at, starts);
    while let Some(end) = line_end(&bytes[at..]) {
        let pair = bytes[at + end] == b'\r' && bytes.get(at + end + 1) == Some(&b'\n');
        at += end + 1 + usize::from(pair);
        begin_line(at, starts);
    }
}

/// The nearest of some lines in ascending order: after `line` (forward), or at or before it. `None`: there are no lines at
/// all; `Some(None)`: none in this direction.
fn nearest_line(lines: impl Iterator<Item = u32> + Clone, line: u32, forward: bool) -> Option<Option<u32>> {
    lines.clone().next()?;
    Some(match forward {
        true => lines.clone().find(|at| *at > line),
        false => lines.take_while(|at| *at <= line).last(),
    })
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
