//! What a dialect decides, and what it gets and returns. Knows no dialect.

use crate::nc::contour::PendingCycle;
use crate::nc::corner::CornerWords;
use crate::nc::expression::{Locals, Scope, Value};
use crate::nc::fault::ReadResult;
use crate::nc::flow::{Call, CallLimit, Callee, Flow};
use crate::nc::modal::{ModalCodes, ModalState};
use crate::nc::modal_calls::ModalCall;
use crate::nc::op::Op;
use crate::nc::scope::LiveScope;
use crate::nc::settings::NcSettings;
use crate::nc::source::Source;
use crate::nc::source_index::{SourceIndex, TextLines};
use crate::nc::statement::{self, BlockContent, BlockReader};
use crate::nc::words::BlockWords;

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
    /// Where a call of a macro puts its arguments.
    pub arguments: &'r mut Locals,
    /// Where a cycle over a contour of the program (G70–G73) puts itself.
    pub pending_cycle: &'r mut Option<PendingCycle>,
    /// Where a line or arc puts what it asks of its end: a corner, an angle.
    pub corner: &'r mut Option<CornerWords>,
    /// This is the second half of a block that `FlowAction::SecondHalf` split.
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
    /// The next block; the block to which it would have gone must be there, too.
    GotoNotTaken { n: u32, at: usize },
    /// Goes to the only block with the number; an error if there are several, or if it is this block (L1, L7).
    GotoUnique { n: u32, at: usize },
    /// Calls a subprogram of the same text; it begins at the only block with the number (L7).
    CallLocal { n: u32, at: usize },
    /// Begins a counted loop with `times` passes; 0 skips it (L4).
    BeginCountedLoop { times: u32, at: usize },
    /// Ends a counted loop.
    EndCountedLoop { at: usize },
    /// Calls another program; a macro with the arguments of the context.
    Call(Call),
    /// G66 with the arguments of the context, or G67 with `None`.
    SetModalCall(Option<ModalCall>),
    /// M99.
    Return { target: Option<u32>, at: usize },
    /// Sets a variable.
    Assign { variable: u32, value: Value, at: usize },
    /// M02, M30.
    End,
}

/// The number of a program, and its file name if it has one.
pub(crate) type ProgramHeading = (u32, Option<String>);

/// A block that is not executed: its text, the settings, its first byte, its line from 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnexecutedBlock<'r> {
    pub source: &'r Source,
    pub settings: &'r NcSettings,
    pub at: usize,
    pub line: u32,
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

/// The answers of a dialect. There is no default: a new dialect answers every question.
pub(crate) struct DialectRow {
    /// Factory settings of a machine with programs of this dialect.
    pub settings: fn() -> NcSettings,
    /// The G codes that show the modal states.
    pub modal_codes: ModalCodes,
    /// Indexes a text: what its jumps, loops and calls can go to.
    pub index: fn(&TextLines<'_>, &mut SourceIndex),
    /// Checks a block of words that is not executed: its syntax, its codes, and that the blocks it names exist.
    pub check_unexecuted: fn(&BlockWords, &UnexecutedBlock<'_>) -> ReadResult<()>,
    /// A check executes the blocks that its run did not reach, each by itself; else [`Self::check_unexecuted`] reads them.
    pub executes_lone_blocks: bool,
    /// The program that a block certainly calls (literal number, at least one call), and the byte of the call.
    pub called_program: fn(&BlockWords) -> Option<(u32, usize)>,
    /// The program that a line calls, by its text in upper case without comments; for the page designer.
    pub call_in_text: fn(&str) -> Vec<u32>,
    /// The text of a block that calls a program; `None` if a block cannot call by a number.
    pub call_text: fn(u32) -> Option<String>,
    /// The number, and the name if it has one, of the program that begins in a line of a text with several.
    pub program_heading: fn(&[u8]) -> Option<ProgramHeading>,
    /// The initial text of a new program with this number.
    pub new_program_text: fn(u32) -> String,
    /// Deepest nesting of a call, and the name of the call.
    pub call_limit: fn(Callee) -> CallLimit,
    /// How much of a program can be checked before it starts.
    pub preflight_scope: PreflightScope,
    /// The code that ends a program, if a program without blocks is a mistake; not for a single MDI line (L1).
    pub required_end_code: Option<&'static str>,
    /// Words of larger controls that are refused by name.
    pub refused_words: &'static [&'static str],
    /// There are labels (`AA1:`), each unique in a program.
    pub has_labels: bool,
    /// There are macro statements (`#1=…`, IF, WHILE, GOTO).
    pub has_macros: bool,
}

/// A dialect: its answers, and the two functions that every block goes through. They are called statically.
pub(crate) trait DialectRules {
    /// The answers.
    const ROW: DialectRow;

    /// Reads one block. Afterwards the cursor is at the line end, or after a `;` that another block follows.
    #[inline]
    fn read_block<S: Scope>(reader: BlockReader<'_, '_, S>) -> ReadResult<BlockContent> {
        statement::read_block(reader)
    }

    /// Executes a block of words.
    fn execute(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction>;
}
