//! Lines that a run does not come to: read for their writing, and for what can be said of them without a run.
//! Source: spec B1, T4, L1, L4, L7.

use std::sync::Arc;

use super::dialect::{self, Unread};
use super::fault::{Fault, Outcome, Stop, fault_in, wrong, wrong1};
use super::lexer::Cursor;
use super::settings::Settings;
use super::source::{Source, at_head};
use super::statement::{self, Blank, Content, Head};
use super::words::Words;
use crate::defs::program_error::ProgramError as E;

/// One bit a line.
pub(crate) struct Visited(Vec<u64>);

impl Visited {
    pub fn new(lines: usize) -> Self {
        Self(vec![0; lines / 64 + 1])
    }

    /// Marks a line; whether it is new.
    #[inline]
    pub fn mark(&mut self, line: u32) -> bool {
        let Some(word) = self.0.get_mut(line as usize / 64) else { return false };
        let bit = 1 << (line % 64);
        let new = *word & bit == 0;
        *word |= bit;
        new
    }
}

/// The mistakes of all lines up to `text_end` (from 0) that are not marked yet; they are afterwards.
pub(crate) fn faults(
    source: &Arc<Source>,
    settings: &Settings,
    visited: &mut Visited,
    mut text_end: Option<u32>,
) -> Vec<Fault> {
    let (mut words, mut found) = (Words::default(), Vec::new());
    for line in 0..source.line_count() as u32 {
        if text_end.is_some_and(|end| line > end) {
            break;
        }
        if !visited.mark(line) {
            continue;
        }
        match read_line(source, settings, line, &mut words) {
            Ok(false) => {}
            Ok(true) => text_end = Some(line),
            Err(stop) => {
                if let Stop::Wrong(wrong) = *stop {
                    found.push(fault_in(source, words.n, wrong));
                }
            }
        }
    }
    found
}

/// Reads the blocks of a line; true where the text ends in it.
fn read_line(source: &Source, settings: &Settings, line: u32, words: &mut Words) -> Outcome<bool> {
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
            Content::Words => dialect::look(words, settings, &Unread { source, at, line })?,
            Content::TextEnd { at } if !at_head(text, at) => text_end = true,
            Content::Goto { n, at } if n > 0 && source.find_block(n, line).is_none() => {
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
