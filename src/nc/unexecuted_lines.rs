//! Lines that a run does not execute: checks their syntax, and what else can be checked without a run.
//! Source: spec B1, T4, L1, L4, L7.

use std::sync::Arc;

use super::dialect::{self, UnexecutedBlock};
use super::fault::{E, ErrorAt, ProgramFault, ReadResult, ReadStop, fail, fail1};
use super::interpreter::BLOCK_WORK;
use super::lexer::Cursor;
use super::settings::NcSettings;
use super::source::{Library, Source};
use super::statement::{self, BlockContent, BlockReader, SyntaxOnlyScope};
use super::words::BlockWords;
use crate::defs::program_number;
use crate::defs::text::arg::Arg;
use crate::units::WorkBudget;

/// Calls of a text for which [`UnexecutedLines::with_capacity`] takes memory.
const USUAL_CALLS: usize = 16_384;

/// What a run has executed of a text, line by line.
#[derive(Debug, Default)]
pub(crate) struct ExecutedLines(Vec<u8>);

impl ExecutedLines {
    const EXECUTED: u8 = 1;
    const CONDITION_HELD: u8 = 2;
    const CONDITION_FAILED: u8 = 4;

    /// For a text of so many lines.
    pub fn new(lines: usize) -> Self {
        Self(vec![0; lines + 1])
    }

    /// Begins with another text, in the same memory.
    fn begin(&mut self, lines: usize) {
        self.0.clear();
        self.0.resize(lines + 1, 0);
    }

    /// Marks a line as executed; returns whether it was not.
    #[inline]
    pub fn mark(&mut self, line: u32) -> bool {
        let Some(mark) = self.0.get_mut(line as usize) else { return false };
        let new = *mark & Self::EXECUTED == 0;
        *mark |= Self::EXECUTED;
        new
    }

    /// Notes the result of the line's IF.
    pub fn mark_condition(&mut self, line: u32, holds: bool) {
        let result = if holds { Self::CONDITION_HELD } else { Self::CONDITION_FAILED };
        self.0.get_mut(line as usize).into_iter().for_each(|mark| *mark |= result);
    }

    /// Whether a line was executed, and what stands behind its IF, too.
    pub fn is_executed(&self, line: u32) -> bool {
        let mark = self.0.get(line as usize).copied().unwrap_or_default();
        mark & Self::EXECUTED != 0 && mark & (Self::CONDITION_HELD | Self::CONDITION_FAILED) != Self::CONDITION_FAILED
    }
}

/// Reads the unmarked lines of a program and marks them.
pub(crate) struct UnexecutedLines {
    pub marks: ExecutedLines,
    /// The line (from 0) whose `%` ends the text.
    pub text_end: Option<u32>,
    /// The programs that the lines call, and the bytes of the calls.
    pub calls: Vec<(u32, usize)>,
    line: u32,
    words: BlockWords,
}

impl UnexecutedLines {
    pub fn new(lines: usize) -> Self {
        let (marks, words) = (ExecutedLines::new(lines), BlockWords::default());
        Self { marks, text_end: None, calls: Vec::new(), line: 0, words }
    }

    /// For texts of up to `lines` lines without further memory.
    pub fn with_capacity(lines: usize) -> Self {
        let marks = ExecutedLines(Vec::with_capacity(lines + 1));
        Self { marks, calls: Vec::with_capacity(USUAL_CALLS), ..Self::new(0) }
    }

    /// Begins with another text, in the same memory.
    pub fn begin(&mut self, lines: usize) {
        self.marks.begin(lines);
        self.calls.clear();
        (self.text_end, self.line) = (None, 0);
    }

    /// Goes on with another text of which some lines were executed.
    pub fn continue_with(&mut self, marks: ExecutedLines) {
        (self.marks, self.text_end, self.line) = (marks, None, 0);
    }

    /// Reads lines until the budget is spent and passes their mistakes to `tell`; `false` when all are read. With a `library`,
    /// called programs must exist in it.
    pub fn advance(
        &mut self,
        source: &Source,
        settings: &NcSettings,
        library: Option<&dyn Library>,
        budget: &mut WorkBudget,
        tell: &mut dyn FnMut(ProgramFault),
    ) -> bool {
        while !budget.is_spent() {
            budget.spend(BLOCK_WORK);
            let line = self.line;
            if line as usize >= source.line_count() || self.text_end.is_some_and(|end| line > end) {
                return false;
            }
            self.line += 1;
            if !self.marks.mark(line) {
                continue;
            }
            let calls = self.calls.len();
            let read = self.read_line(source, settings, line).and_then(|text_end| {
                let missing = |(number, _): &&(u32, usize)| library.is_some_and(|found| found.find(*number).is_none());
                match self.calls[calls..].iter().find(missing) {
                    Some((number, at)) => fail1(*at, E::MissingProgram, program_number::name_of(*number)),
                    None => Ok(text_end),
                }
            });
            match read {
                Ok(false) => {}
                Ok(true) => self.text_end = Some(line),
                Err(ReadStop::Drain) => {}
                Err(ReadStop::Error(wrong)) => tell(source.fault(self.words.block_number, wrong)),
            }
        }
        true
    }

    /// Checks the blocks of a line; returns whether the text ends in it.
    fn read_line(&mut self, source: &Source, settings: &NcSettings, line: u32) -> ReadResult<bool> {
        let text = source.bytes();
        let mut cursor = Cursor::window(text, source.line_start(line));
        let (mut mid_line, mut text_end) = (false, false);
        loop {
            let at = cursor.at;
            let (scope, block_skip) = (&mut SyntaxOnlyScope, false);
            let reader = BlockReader { cursor: &mut cursor, scope, words: &mut self.words, mid_line, block_skip };
            let content = dialect::read_block(settings.dialect, reader);
            if cursor.is_truncated(text) {
                return fail(at, E::BlockTooLong);
            }
            match content? {
                BlockContent::Words => {
                    let rules = dialect::rules(settings.dialect);
                    (rules.check_unexecuted)(&self.words, &UnexecutedBlock { source, settings, at, line })?;
                    self.calls.extend((rules.called_program)(&self.words));
                }
                BlockContent::TextEnd { at } if !source.is_at_head(at) => text_end = true,
                BlockContent::Goto { n, at } if n > 0 && source.find_block(n, at).is_none() => {
                    return fail1(at, E::MissingTarget, format_args!("N{n}"));
                }
                BlockContent::Jump { label, forward, .. } => source.find_label(label, line, forward).map(drop)?,
                _ => {}
            }
            if !statement::line_continues(&cursor) || cursor.at <= at {
                return Ok(text_end);
            }
            mid_line = true;
        }
    }
}

/// Mistakes of the text as a whole: repeated labels, no blocks.
pub fn check_whole_text<'a>(source: &'a Source, settings: &NcSettings) -> impl Iterator<Item = ProgramFault> + use<'a> {
    let told =
        |at: usize, error: E, detail: Arg| source.fault(None, ErrorAt { at, error, details: [detail, Arg::None] });
    let rules = dialect::rules(settings.dialect);
    let empty = rules
        .required_end_code
        .filter(|_| {
            settings.needs_block_numbers && source.bytes().split(|byte| matches!(byte, b'\r' | b'\n')).all(has_no_block)
        })
        .map(|end| told(0, E::EmptyProgram, end.into()));
    let labels = rules.has_labels.then(|| source.repeated_labels()).into_iter().flatten();
    let labels = labels.map(move |(line, label)| {
        let text = source.bytes().get(source.line_start(line)..).unwrap_or_default();
        let upper = text.get(..text.len().min(LABEL_SEARCH_BYTES)).unwrap_or_default().to_ascii_uppercase();
        let at = upper.windows(label.len()).position(|part| part == label).unwrap_or(0);
        told(source.line_start(line) + at, E::SeveralLabels, String::from_utf8_lossy(label).as_ref().into())
    });
    empty.into_iter().chain(labels)
}

/// Bytes of a line that are searched for its label.
const LABEL_SEARCH_BYTES: usize = 256;

/// Whether a line has no block.
fn has_no_block(line: &[u8]) -> bool {
    line.trim_ascii_start().first().is_none_or(|first| matches!(first, b';' | b'%' | b'('))
}

/// Checks only the syntax of some lines, without the rest of the program: jump targets are not checked.
#[must_use]
pub fn check_syntax(source: &Arc<Source>, settings: &NcSettings) -> Vec<ProgramFault> {
    const ELSEWHERE: [E; 6] = [
        E::MissingTarget,
        E::SeveralTargets,
        E::MissingLabel,
        E::SeveralLabels,
        E::LabelInOtherDirection,
        E::LoopUnpaired,
    ];
    let (mut unread, mut faults) = (UnexecutedLines::new(source.line_count()), Vec::new());
    while unread.advance(source, settings, None, &mut WorkBudget::unlimited(), &mut |fault| faults.push(fault)) {}
    faults.retain(|fault: &ProgramFault| !ELSEWHERE.contains(&fault.error));
    faults
}
