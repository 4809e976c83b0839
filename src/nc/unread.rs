//! Lines that a run does not execute: checks their syntax, and what else can be checked without a run.
//! Source: spec B1, T4, L1, L4, L7.

use super::dialect::{self, Unrun};
use super::fault::{Fault, Outcome, Stop, Wrong, fault_in, wrong, wrong1};
use super::lexer::Cursor;
use super::settings::Settings;
use super::source::{Library, Source, at_head};
use super::statement::{self, Blank, Content, Head};
use super::words::Words;
use crate::defs::program;
use crate::defs::program_error::ProgramError as E;

/// The lines read so far, one bit per line.
pub(crate) struct Visited(Vec<u64>);

impl Visited {
    pub fn new(lines: usize) -> Self {
        Self(vec![0; lines / 64 + 1])
    }

    /// Marks a line; returns whether it was unmarked.
    #[inline]
    pub fn mark(&mut self, line: u32) -> bool {
        let Some(word) = self.0.get_mut(line as usize / 64) else { return false };
        let bit = 1 << (line % 64);
        let new = *word & bit == 0;
        *word |= bit;
        new
    }
}

/// Reads the unmarked lines of a program and marks them.
pub(crate) struct Unread {
    pub visited: Visited,
    /// The line (from 0) whose `%` ends the text.
    pub text_end: Option<u32>,
    /// The programs that the lines call, and the bytes of the calls.
    pub calls: Vec<(u32, usize)>,
    line: u32,
    words: Words,
}

impl Unread {
    pub fn new(lines: usize) -> Self {
        Self { visited: Visited::new(lines), text_end: None, calls: Vec::new(), line: 0, words: Words::default() }
    }

    /// Reads at most `most` lines and passes their mistakes to `tell`; `false` when all are read. With a `library`,
    /// called programs must exist in it.
    pub fn advance(
        &mut self,
        (source, settings): (&Source, &Settings),
        library: Option<&dyn Library>,
        most: u32,
        tell: &mut dyn FnMut(Fault),
    ) -> bool {
        for _ in 0..most {
            let line = self.line;
            if line as usize >= source.line_count() || self.text_end.is_some_and(|end| line > end) {
                return false;
            }
            self.line += 1;
            if !self.visited.mark(line) {
                continue;
            }
            let calls = self.calls.len();
            let read = read_line(source, settings, line, (&mut self.words, &mut self.calls)).and_then(|text_end| {
                let missing = |(number, _): &&(u32, usize)| library.is_some_and(|found| found.find(*number).is_none());
                match self.calls[calls..].iter().find(missing) {
                    Some((number, at)) => wrong1(*at, E::MissingProgram, program::title(*number)),
                    None => Ok(text_end),
                }
            });
            match read {
                Ok(false) => {}
                Ok(true) => self.text_end = Some(line),
                Err(stop) => {
                    if let Stop::Wrong(wrong) = *stop {
                        tell(fault_in(source, self.words.n, wrong));
                    }
                }
            }
        }
        true
    }
}

/// Mistakes of the text as a whole: repeated labels, no blocks.
pub(crate) fn whole<'a>(source: &'a Source, settings: &Settings) -> impl Iterator<Item = Fault> + use<'a> {
    let told = |at: usize, error: E, detail: String| {
        fault_in(source, None, Wrong { at, error, details: [detail, String::new()] })
    };
    let empty = dialect::asks_for_blocks(settings)
        .filter(|_| source.bytes().split(|byte| matches!(byte, b'\r' | b'\n')).all(is_blank))
        .map(|end| told(0, E::EmptyProgram, end.to_owned()));
    let labels = dialect::has_labels(settings).then(|| source.repeated_labels()).into_iter().flatten();
    let labels = labels.map(move |(line, label)| {
        let text = source.bytes().get(source.start(line)..).unwrap_or_default();
        let upper = text.get(..text.len().min(LABEL_WITHIN)).unwrap_or_default().to_ascii_uppercase();
        let at = upper.windows(label.len()).position(|part| part == label).unwrap_or(0);
        told(source.start(line) + at, E::SeveralLabels, String::from_utf8_lossy(label).into_owned())
    });
    empty.into_iter().chain(labels)
}

/// Bytes of a line that are searched for its label.
const LABEL_WITHIN: usize = 256;

/// Whether a line has no block.
fn is_blank(line: &[u8]) -> bool {
    line.trim_ascii_start().first().is_none_or(|first| matches!(first, b';' | b'%' | b'('))
}

/// Checks the blocks of a line; returns whether the text ends in it.
fn read_line(
    source: &Source,
    settings: &Settings,
    line: u32,
    (words, calls): (&mut Words, &mut Vec<(u32, usize)>),
) -> Outcome<bool> {
    let text = source.bytes();
    let mut cursor = Cursor::window(text, source.start(line));
    let mut head = Head { mid_line: false, block_skip: false };
    let mut text_end = false;
    loop {
        let at = cursor.at;
        let content = dialect::read(settings.system, &mut cursor, &mut Blank, words, head);
        if cursor.is_cut(text) {
            return wrong(at, E::BlockTooLong);
        }
        match content? {
            Content::Words => {
                dialect::look(words, settings, &Unrun { source, at, line })?;
                calls.extend(dialect::called(words, settings));
            }
            Content::TextEnd { at } if !at_head(text, at) => text_end = true,
            Content::Goto { n, at } if n > 0 && source.find_block(n, at).is_none() => {
                return wrong1(at, E::MissingTarget, format!("N{n}"));
            }
            Content::Jump { label, forward, .. } => source.find_label(label, line, forward).map(drop)?,
            _ => {}
        }
        if !statement::goes_on(&cursor) || cursor.at <= at {
            return Ok(text_end);
        }
        head.mid_line = true;
    }
}
