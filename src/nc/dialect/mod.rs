//! Dialects: they turn the words of a block into operations. A dialect is a folder with a `DialectRules`, a row in
//! `with_rules` and a row in `index`. Lexer, expressions, flow, operations and check are shared.

mod arc;
mod common;
mod grinder;
pub(crate) mod index;
mod sinumerik;
mod superman;

pub(crate) use grinder::RepetitiveCycleState;

use super::contour::ContourCycle;
use super::expression::{Scope, Value};
use super::fault::ReadResult;
use super::flow::{Call, CallLimit, Callee, Flow, ModalCall};
use super::lexer::Cursor;
use super::modal::ModalState;
use super::op::Op;
use super::scope::LiveScope;
use super::settings::{Dialect, NcSettings, SpeedUnit, SuperManSettings};
use super::source::Source;
use super::statement::{BlockContent, ReadOptions};
use super::words::BlockWords;
use crate::units::PerAxis;

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

/// The G codes of modal states in a dialect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModalCodes {
    /// G90 and G91 are modal.
    pub distance_is_modal: bool,
    /// Feed per minute and per revolution.
    pub per_minute: u8,
    pub per_rev: u8,
    /// Inches and millimetres.
    pub inch: u8,
    pub metric: u8,
    /// Exact stop.
    pub exact_stop: u8,
}

/// All that a dialect decides. There is no default: a new dialect answers every question.
pub(crate) trait DialectRules: Sync {
    /// Factory settings of a machine with programs of this dialect.
    fn settings(&self) -> NcSettings;

    /// The G codes that show the modal states.
    fn modal_codes(&self) -> ModalCodes;

    /// Executes a block of words.
    fn execute(&self, running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction>;

    /// Checks a block of words that is not executed: its syntax, its codes, and that the blocks it names exist.
    fn check_unexecuted(&self, words: &BlockWords, block: &UnexecutedBlock<'_>) -> ReadResult<()>;

    /// The program that a block certainly calls (literal number, at least one call), and the byte of the call.
    fn called_program(&self, words: &BlockWords) -> Option<(u32, usize)>;

    /// The program that a line calls, by its text in upper case without comments; for the page designer.
    fn call_in_text(&self, code: &str) -> Option<u32>;

    /// The text of a block that calls a program; `None` if a block cannot call by a number.
    fn call_text(&self, program: u32) -> Option<String>;

    /// The initial text of a new program with this number.
    fn new_program_text(&self, number: u32) -> String;

    /// Deepest nesting of a call, and the name of the call.
    fn call_limit(&self, callee: &Callee) -> CallLimit;

    /// How much of a program can be checked before it starts.
    fn preflight_scope(&self) -> PreflightScope;

    /// The code that ends a program, if a program without blocks is a mistake (L1).
    fn required_end_code(&self, settings: &NcSettings) -> Option<&'static str>;

    /// Whether there are labels (`AA1:`), each unique in a program.
    fn has_labels(&self) -> bool;

    /// Whether there are macro statements (`#1=…`, IF, WHILE, GOTO).
    fn has_macros(&self) -> bool;
}

/// Evaluates an expression with the rules of a dialect: the one row of each.
macro_rules! with_rules {
    ($dialect:expr, $rules:ident => $value:expr) => {
        match $dialect {
            Dialect::LatheA => {
                let $rules = &grinder::GrinderRules::LATHE_A;
                $value
            }
            Dialect::Mill => {
                let $rules = &grinder::GrinderRules::MILL;
                $value
            }
            Dialect::Sinumerik => {
                let $rules = &sinumerik::SinumerikRules;
                $value
            }
            Dialect::SuperMan => {
                let $rules = &superman::SuperManRules;
                $value
            }
        }
    };
}

/// The rules of a dialect.
pub(crate) const fn rules(dialect: Dialect) -> &'static dyn DialectRules {
    with_rules!(dialect, rules => rules)
}

/// Reads one block in a dialect. Afterwards the cursor is at the line end, or after a `;` that another block follows.
/// The rules of each dialect have the function `read_block`; the call is static, as every block is read here.
#[inline]
pub(crate) fn read_block<S: Scope>(
    dialect: Dialect,
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    words: &mut BlockWords,
    head: ReadOptions,
) -> ReadResult<BlockContent> {
    with_rules!(dialect, rules => rules.read_block(cursor, scope, words, head))
}

/// Executes a block of words in the machine's dialect; static, as every block is executed here.
pub(crate) fn execute(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
    with_rules!(running.settings.dialect, rules => rules.execute(running))
}

impl NcSettings {
    /// Factory settings of a machine with programs of this dialect.
    #[must_use]
    pub fn for_dialect(dialect: Dialect) -> Self {
        rules(dialect).settings()
    }

    /// Factory settings of GC: X (diameter) and Z.
    #[must_use]
    pub fn lathe_a() -> Self {
        Self::for_dialect(Dialect::LatheA)
    }

    /// Factory settings of GS and GA: X, Y, Z in radius.
    #[must_use]
    pub fn mill() -> Self {
        Self::for_dialect(Dialect::Mill)
    }

    /// Factory settings of the vertical lathe-grinder: X (diameter) and Z.
    #[must_use]
    pub fn sinumerik() -> Self {
        Self::for_dialect(Dialect::Sinumerik)
    }

    /// Factory settings of the 超人 lathe: X (diameter) and Z.
    #[must_use]
    pub fn superman() -> Self {
        Self::for_dialect(Dialect::SuperMan)
    }

    /// Settings that a dialect changes: those of a lathe with two axes, X a diameter.
    fn two_axes(dialect: Dialect) -> Self {
        Self {
            dialect,
            diameter: true,
            axes: PerAxis([true, false, true]),
            least_increment_mm: None,
            inch: false,
            tolerance_mm: 0.01,
            arc_tolerance_mm: 0.01,
            speed_unit: SpeedUnit::Rpm,
            jump_input: 0,
            tool_count: 16,
            exact_stop: false,
            start_is_work_zero: false,
            needs_block_numbers: false,
            superman: SuperManSettings::default(),
            oscillation_by_cylinder: false,
            rapid_mm_min: PerAxis([6_000.0; 3]),
        }
    }
}

/// The initial text of a new program with this number.
#[must_use]
pub fn new_program_text(dialect: Dialect, number: u32) -> String {
    rules(dialect).new_program_text(number)
}

/// The text of a block that calls a program in a dialect; `None` if a block cannot call by a number.
#[must_use]
pub fn call_text(dialect: Dialect, program: u32) -> Option<String> {
    rules(dialect).call_text(program)
}
