//! Dialects: how the words of a block become operations. Each is one module; lexer, expressions, flow, operations and
//! the check are shared.

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

/// What a dialect is given to execute a block of words.
pub(crate) struct Running<'r, 'w> {
    pub words: &'r Words,
    /// A working copy: it counts only if the block is accepted.
    pub modals: &'r mut Modals,
    pub settings: &'r Settings,
    pub ops: &'r mut Vec<Op>,
    pub scope: &'r mut LiveScope<'w>,
    /// The text of the program, for words that are read again.
    pub text: &'r [u8],
    /// Where the block begins in it.
    pub at: usize,
    /// Where the program is: whether in the one that was started, or in a subprogram of the same text (L7).
    pub flow: &'r Flow,
    /// The second half of a block that was divided by `Step::Again`.
    pub second_half: bool,
}

/// What follows a block of words.
pub(crate) enum Step {
    /// The next block.
    Next,
    /// The same block once more with `second_half`: what was handed out changes the position that the rest starts from.
    Again,
    /// Another block.
    Goto { n: u32, at: usize },
    /// The one block of that number; it is an error if there are several, or if it is this block (L1, L7).
    Jump { n: u32, at: usize },
    /// A subprogram of the same text that begins at the one block of that number (L7).
    Local { n: u32, at: usize },
    /// A counted loop begins here: so often; 0 leaves it out (L4).
    Loop { times: u32, at: usize },
    /// A counted loop ends here.
    EndLoop { at: usize },
    /// Another program.
    Call(Call),
    /// G66, or G67 with `None`.
    Modal(Option<Box<ModalCall>>),
    /// M99.
    Return { target: Option<u32>, at: usize },
    /// A cycle over a contour of the program (G70–G73).
    Contour(Box<ContourCycle>),
    /// A variable gets a value.
    Assign { variable: u32, value: Value, at: usize },
    /// M02, M30.
    End,
}

/// Reads one block in the language of the machine. Afterwards the cursor stands at the line end, or behind a mark that
/// another block follows.
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
            // L1: a line is one block; what stands behind `;` is a comment, whatever it says.
            cursor.rest_of_line();
            Ok(content)
        }
        System::Sinumerik => sinumerik::read(cursor, scope, words, head),
    }
}

/// Executes a block of words in the dialect of the machine kind.
pub(crate) fn run(running: &mut Running<'_, '_>) -> Outcome<Step> {
    match running.settings.system {
        System::LatheA | System::Mill => grinder::run(running),
        System::Sinumerik => sinumerik::run(running),
        System::SuperMan => superman::run(running),
    }
}

/// A block that is not executed: its program, its first byte there, its line from 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unrun<'r> {
    pub source: &'r Source,
    pub at: usize,
    pub line: u32,
}

/// Looks at a block of words that is not executed, whether it is written as it must be, its codes exist, and what it
/// names is there.
pub(crate) fn look(words: &Words, settings: &Settings, block: &Unrun<'_>) -> Outcome<()> {
    match settings.system {
        System::LatheA | System::Mill => grinder::look(words, settings),
        System::Sinumerik => sinumerik::look(words, block.source.bytes()),
        System::SuperMan => superman::look(words, settings, block),
    }
}

/// The program that a block calls, where its number is written and it is called at least once, and the byte of the call.
pub(crate) fn called(words: &Words, settings: &Settings) -> Option<(u32, usize)> {
    match settings.system {
        System::Sinumerik => sinumerik::called(words),
        System::LatheA | System::Mill | System::SuperMan => None,
    }
}

/// How far a program can be proved before it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Provable {
    /// It has neither variables nor conditions: what it will do is known.
    Whole,
    /// Its text, and the texts that it calls; values come in the run.
    Text,
    /// Not at all: what a macro calculates and the machine answers decides.
    No,
}

/// How far programs of a language can be proved.
pub(crate) const fn provable(settings: &Settings) -> Provable {
    match settings.system {
        System::SuperMan => Provable::Whole,
        System::Sinumerik => Provable::Text,
        System::LatheA | System::Mill => Provable::No,
    }
}

/// Whether a language has labels (`AA1:`), each once in a program.
pub(crate) const fn has_labels(settings: &Settings) -> bool {
    matches!(settings.system, System::Sinumerik)
}

/// What ends a program of a language in which one without blocks is a mistake (L1).
pub(crate) const fn asks_for_blocks(settings: &Settings) -> Option<&'static str> {
    match settings.system {
        System::SuperMan if settings.numbered => Some("M02"),
        System::SuperMan | System::LatheA | System::Mill | System::Sinumerik => None,
    }
}

/// Whether a language has the macro statements (`#1=…`, IF, WHILE, GOTO).
pub(crate) const fn has_macros(settings: &Settings) -> bool {
    !matches!(settings.system, System::SuperMan)
}
