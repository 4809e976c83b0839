//! Dialects: they turn the words of a block into operations. Each dialect is one module. Lexer, expressions, flow,
//! operations and check are shared.

mod arc;
mod block;
mod factory;
mod grinder;
mod sinumerik;
mod superman;

pub(crate) use factory::{Spelling, spelling};
pub(crate) use grinder::RepeatWords;

use super::contour::ContourCycle;
use super::expression::{Scope, Value};
use super::fault::Outcome;
use super::flow::{Call, Flow, ModalCall};
use super::lexer::Cursor;
use super::modal::Modals;
use super::op::Op;
use super::scope::LiveScope;
use super::settings::{Settings, System};
use super::source::Source;
use super::statement::{self, Content, Head};
use super::words::Words;

/// What a dialect needs to execute a block of words.
pub(crate) struct Running<'r, 'w> {
    pub words: &'r Words,
    /// The modal state; restored if the block is refused.
    pub modals: &'r mut Modals,
    pub settings: &'r Settings,
    pub ops: &'r mut Vec<Op>,
    pub scope: &'r mut LiveScope<'w>,
    /// The text of the program; some words are read from it again.
    pub text: &'r [u8],
    /// The byte at which the block begins.
    pub at: usize,
    /// The position in the program: in the started program or in a subprogram of the same text (L7).
    pub flow: &'r Flow,
    /// This is the second half of a block that `Step::Again` split.
    pub second_half: bool,
}

/// How the program continues after a block of words.
pub(crate) enum Step {
    /// The next block.
    Next,
    /// The same block again with `second_half`: the operations so far change the start position of the rest.
    Again,
    /// Goes to a block.
    Goto { n: u32, at: usize },
    /// Goes to the only block with the number; an error if there are several, or if it is this block (L1, L7).
    Jump { n: u32, at: usize },
    /// Calls a subprogram of the same text; it begins at the only block with the number (L7).
    Local { n: u32, at: usize },
    /// Begins a counted loop with `times` passes; 0 skips it (L4).
    Loop { times: u32, at: usize },
    /// Ends a counted loop.
    EndLoop { at: usize },
    /// Calls another program.
    Call(Call),
    /// G66, or G67 with `None`.
    Modal(Option<Box<ModalCall>>),
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
pub(crate) fn read<S: Scope>(
    system: System,
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    words: &mut Words,
    head: Head,
) -> Outcome<Content> {
    match system {
        System::LatheA | System::Mill => statement::read(cursor, scope, words, head),
        System::SuperMan => {
            let content = statement::read(cursor, scope, words, head)?;
            // L1: a line is one block. Text after `;` is always a comment.
            cursor.rest_of_line();
            Ok(content)
        }
        System::Sinumerik => sinumerik::read(cursor, scope, words, head),
    }
}

/// Executes a block of words in the machine's dialect.
pub(crate) fn run(running: &mut Running<'_, '_>) -> Outcome<Step> {
    match running.settings.system {
        System::LatheA | System::Mill => grinder::run(running),
        System::Sinumerik => sinumerik::run(running),
        System::SuperMan => superman::run(running),
    }
}

/// A block that is not executed: its text, its first byte, its line from 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unrun<'r> {
    pub source: &'r Source,
    pub at: usize,
    pub line: u32,
}

/// Checks a block of words that is not executed: its syntax, its codes, and that the blocks it names exist.
pub(crate) fn look(words: &Words, settings: &Settings, block: &Unrun<'_>) -> Outcome<()> {
    match settings.system {
        System::LatheA | System::Mill => grinder::look(words, settings),
        System::Sinumerik => sinumerik::look(words, block.source.bytes()),
        System::SuperMan => superman::look(words, settings, block),
    }
}

/// The program that a block certainly calls (literal number, at least one call), and the byte of the call.
pub(crate) fn called(words: &Words, settings: &Settings) -> Option<(u32, usize)> {
    match settings.system {
        System::Sinumerik => sinumerik::called(words),
        System::LatheA | System::Mill | System::SuperMan => None,
    }
}

/// How much of a program can be checked before it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Provable {
    /// All of it: it has neither variables nor conditions.
    Whole,
    /// The syntax of its text and of the texts that it calls; values are known only in the run.
    Text,
    /// Nothing: it depends on macro calculations and on the machine's state.
    No,
}

/// How much of a program in a dialect can be checked before it starts.
pub(crate) const fn provable(settings: &Settings) -> Provable {
    match settings.system {
        System::SuperMan => Provable::Whole,
        System::Sinumerik => Provable::Text,
        System::LatheA | System::Mill => Provable::No,
    }
}

/// Whether a dialect has labels (`AA1:`), each unique in a program.
pub(crate) const fn has_labels(settings: &Settings) -> bool {
    matches!(settings.system, System::Sinumerik)
}

/// The code that ends a program, if a program without blocks is a mistake (L1).
pub(crate) const fn asks_for_blocks(settings: &Settings) -> Option<&'static str> {
    match settings.system {
        System::SuperMan if settings.numbered => Some("M02"),
        System::SuperMan | System::LatheA | System::Mill | System::Sinumerik => None,
    }
}

/// Whether a dialect has macro statements (`#1=…`, IF, WHILE, GOTO).
pub(crate) const fn has_macros(settings: &Settings) -> bool {
    !matches!(settings.system, System::SuperMan)
}
