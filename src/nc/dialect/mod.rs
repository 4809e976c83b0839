//! Dialects: they turn the words of a block into operations. Each dialect is one module. Lexer, expressions, flow,
//! operations and check are shared.

mod arc;
mod common;
mod defaults;
mod grinder;
mod sinumerik;
mod superman;

pub(crate) use defaults::{ModalCodes, modal_codes};
pub(crate) use grinder::RepetitiveCycleState;

use super::contour::ContourCycle;
use super::expression::{Scope, Value};
use super::fault::ReadResult;
use super::flow::{Call, Flow, ModalCall};
use super::lexer::Cursor;
use super::modal::ModalState;
use super::op::Op;
use super::scope::LiveScope;
use super::settings::{Dialect, NcSettings};
use super::source::Source;
use super::statement::{self, BlockContent, ReadOptions};
use super::words::BlockWords;

/// What a dialect needs to execute a block of words.
pub(crate) struct BlockContext<'r, 'w> {
    pub words: &'r BlockWords,
    /// The modal state; restored if the block is refused.
    pub modals: &'r mut ModalState,
    pub settings: &'r NcSettings,
    pub ops: &'r mut Vec<Op>,
    pub scope: &'r mut LiveScope<'w>,
    /// The text of the program; some words are read from it again.
    pub text: &'r [u8],
    /// The byte at which the block begins.
    pub at: usize,
    /// The position in the program: in the started program or in a subprogram of the same text (L7).
    pub flow: &'r Flow,
    /// This is the second half of a block that `FlowAction::Again` split.
    pub second_half: bool,
}

/// How the program continues after a block of words.
pub(crate) enum FlowAction {
    /// The next block.
    Next,
    /// The same block again with `second_half`: the operations so far change the start position of the rest.
    SecondHalf,
    /// Goes to a block.
    Goto { n: u32, at: usize },
    /// Goes to the only block with the number; an error if there are several, or if it is this block (L1, L7).
    GotoUnique { n: u32, at: usize },
    /// Calls a subprogram of the same text; it begins at the only block with the number (L7).
    CallLocal { n: u32, at: usize },
    /// Begins a counted loop with `times` passes; 0 skips it (L4).
    BeginCountedLoop { times: u32, at: usize },
    /// Ends a counted loop.
    EndCountedLoop { at: usize },
    /// Calls another program.
    Call(Call),
    /// G66, or G67 with `None`.
    SetModalCall(Option<Box<ModalCall>>),
    /// M99.
    Return { target: Option<u32>, at: usize },
    /// Expands a cycle over a contour of the program (G70–G73).
    Contour(Box<ContourCycle>),
    /// Sets a variable.
    Assign { variable: u32, value: Value, at: usize },
    /// M02, M30.
    End,
}

/// Reads one block in the machine's dialect. Afterwards the cursor is at the line end, or after a `;` that another
/// block follows.
#[inline]
pub(crate) fn read_block<S: Scope>(
    system: Dialect,
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    words: &mut BlockWords,
    head: ReadOptions,
) -> ReadResult<BlockContent> {
    match system {
        Dialect::LatheA | Dialect::Mill => statement::read_block(cursor, scope, words, head),
        Dialect::SuperMan => {
            let content = statement::read_block(cursor, scope, words, head)?;
            // L1: a line is one block. Text after `;` is always a comment.
            cursor.skip_rest_of_line();
            Ok(content)
        }
        Dialect::Sinumerik => sinumerik::read_block(cursor, scope, words, head),
    }
}

/// Executes a block of words in the machine's dialect.
pub(crate) fn execute(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
    match running.settings.dialect {
        Dialect::LatheA | Dialect::Mill => grinder::execute(running),
        Dialect::Sinumerik => sinumerik::execute(running),
        Dialect::SuperMan => superman::execute(running),
    }
}

/// A block that is not executed: its text, its first byte, its line from 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnexecutedBlock<'r> {
    pub source: &'r Source,
    pub at: usize,
    pub line: u32,
}

/// Checks a block of words that is not executed: its syntax, its codes, and that the blocks it names exist.
pub(crate) fn check_unexecuted(
    words: &BlockWords,
    settings: &NcSettings,
    block: &UnexecutedBlock<'_>,
) -> ReadResult<()> {
    match settings.dialect {
        Dialect::LatheA | Dialect::Mill => grinder::check_unexecuted(words, settings),
        Dialect::Sinumerik => sinumerik::check_unexecuted(words, block.source.bytes()),
        Dialect::SuperMan => superman::check_unexecuted(words, settings, block),
    }
}

/// The program that a block certainly calls (literal number, at least one call), and the byte of the call.
pub(crate) fn called_program(words: &BlockWords, settings: &NcSettings) -> Option<(u32, usize)> {
    match settings.dialect {
        Dialect::Sinumerik => sinumerik::called_program(words),
        Dialect::LatheA | Dialect::Mill | Dialect::SuperMan => None,
    }
}

/// How much of a program can be checked before it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PreflightScope {
    /// All of it: it has neither variables nor conditions.
    FullRun,
    /// The syntax of its text and of the texts that it calls; values are known only in the run.
    TextOnly,
    /// Nothing: it depends on macro calculations and on the machine's state.
    Unsupported,
}

/// How much of a program in a dialect can be checked before it starts.
pub(crate) const fn preflight_scope(settings: &NcSettings) -> PreflightScope {
    match settings.dialect {
        Dialect::SuperMan => PreflightScope::FullRun,
        Dialect::Sinumerik => PreflightScope::TextOnly,
        Dialect::LatheA | Dialect::Mill => PreflightScope::Unsupported,
    }
}

/// Whether a dialect has labels (`AA1:`), each unique in a program.
pub(crate) const fn has_labels(settings: &NcSettings) -> bool {
    matches!(settings.dialect, Dialect::Sinumerik)
}

/// The code that ends a program, if a program without blocks is a mistake (L1).
pub(crate) const fn required_end_code(settings: &NcSettings) -> Option<&'static str> {
    match settings.dialect {
        Dialect::SuperMan if settings.needs_block_numbers => Some("M02"),
        Dialect::SuperMan | Dialect::LatheA | Dialect::Mill | Dialect::Sinumerik => None,
    }
}

/// Whether a dialect has macro statements (`#1=…`, IF, WHILE, GOTO).
pub(crate) const fn has_macros(settings: &NcSettings) -> bool {
    !matches!(settings.dialect, Dialect::SuperMan)
}
