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

/// Looks at a block of words that is not executed – the program's text and where the block begins in it – whether it is
/// written as it must be and its codes exist.
pub(crate) fn look(words: &Words, settings: &Settings, written: (&[u8], usize)) -> Outcome<()> {
    match settings.system {
        System::LatheA | System::Mill => grinder::look(words, settings),
        System::Sinumerik => sinumerik::look(words),
        System::SuperMan => superman::look(words, settings, written),
    }
}

/// Whether a language has the macro statements (`#1=…`, IF, WHILE, GOTO).
pub(crate) const fn has_macros(settings: &Settings) -> bool {
    !matches!(settings.system, System::SuperMan)
}
