//! The table of the dialects: they turn the words of a block into operations. A dialect is a folder with a
//! `DialectRules`, and its row here. Lexer, expressions, flow, operations and check are shared.

mod codes;
mod common;
mod corner;
mod grinder;
mod motion;
mod move_target;
mod rules;
mod sinumerik;
mod superman;

pub(crate) use rules::{BlockContext, DialectRow, FlowAction, PreflightScope, UnexecutedBlock};

use self::rules::DialectRules;
use super::expression::Scope;
use super::fault::ReadResult;
use super::modal::ModalState;
use super::op::{PathMode, SpeedMode};
use super::settings::{Dialect, NcSettings};
use super::source::Source;
use super::statement::{BlockContent, BlockReader};

macro_rules! dialects {
    ($($dialect:ident => $rules:ty;)*) => {
        /// The answers of a dialect.
        pub(crate) const fn rules(dialect: Dialect) -> &'static DialectRow {
            match dialect { $(Dialect::$dialect => &<$rules as DialectRules>::ROW,)* }
        }

        /// Reads one block in a dialect. Afterwards the cursor is at the line end, or after a `;` that another block
        /// follows.
        #[inline]
        pub(crate) fn read_block<S: Scope>(
            dialect: Dialect,
            reader: BlockReader<'_, '_, S>,
        ) -> ReadResult<BlockContent> {
            match dialect { $(Dialect::$dialect => <$rules>::read_block(reader),)* }
        }

        /// Executes a block of words in the machine's dialect.
        pub(crate) fn execute(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
            match running.settings.dialect { $(Dialect::$dialect => <$rules>::execute(running),)* }
        }
    };
}

dialects! {
    LatheA => grinder::Grinder<false>;
    Mill => grinder::Grinder<true>;
    Sinumerik => sinumerik::Sinumerik;
    SuperMan => superman::SuperMan;
}

impl Source {
    /// Indexes a program's text in its dialect: GBK or UTF-8, line ends CR, LF or CR LF.
    ///
    /// # Panics
    /// If the text has 4 GiB or more; the caller limits file sizes.
    #[must_use]
    pub fn new(number: u32, name: impl Into<String>, bytes: impl Into<Vec<u8>>, dialect: Dialect) -> Self {
        Self::indexed(number, name.into(), bytes.into(), dialect, rules(dialect).index)
    }

    /// An empty text, with memory for a text of `bytes` bytes in a few lines.
    #[must_use]
    pub fn with_capacity(name: &str, bytes: usize, dialect: Dialect) -> Self {
        let mut source = Self::new(0, name, Vec::with_capacity(bytes), dialect);
        source.reserve_index();
        source
    }

    /// Replaces the text of a program that nothing else holds, in its memory: a line of MDI text.
    pub fn set_text(&mut self, text: &[u8]) {
        self.replace_text(text, rules(self.dialect()).index);
    }
}

impl ModalState {
    /// The active G codes in display order.
    #[must_use]
    pub fn g_codes(&self, dialect: Dialect) -> [u8; 9] {
        let codes = &rules(dialect).modal_codes;
        [
            self.motion.g(),
            self.plane.g(),
            if codes.distance_is_modal && self.incremental { 91 } else { 90 },
            if self.per_rev { codes.per_rev } else { codes.per_minute },
            if self.inch { codes.inch } else { codes.metric },
            self.work_offset,
            if self.path_mode == PathMode::ExactStop { codes.exact_stop } else { 64 },
            if self.speed_mode == SpeedMode::SurfaceSpeed { 96 } else { 97 },
            self.compensation.map_or(40, |active| active.g()),
        ]
    }
}

impl NcSettings {
    /// Factory settings of a machine with programs of this dialect.
    #[must_use]
    pub fn for_dialect(dialect: Dialect) -> Self {
        (rules(dialect).settings)()
    }

    /// Factory settings of GC: X (diameter) and Z.
    #[must_use]
    pub fn lathe_a() -> Self {
        Self::for_dialect(Dialect::LatheA)
    }
}

/// The initial text of a new program with this number.
#[must_use]
pub fn new_program_text(dialect: Dialect, number: u32) -> String {
    (rules(dialect).new_program_text)(number)
}

/// The words of larger controls that a dialect refuses by name.
#[must_use]
pub const fn refused_words(dialect: Dialect) -> &'static [&'static str] {
    rules(dialect).refused_words
}

/// The names of the functions of a dialect.
pub fn function_names(dialect: Dialect) -> impl Iterator<Item = &'static str> {
    let sinumerik = dialect == Dialect::Sinumerik;
    let macros = rules(dialect).has_macros && !sinumerik;
    let common = super::functions::FUNCTIONS.iter().map(|(name, _)| *name).filter(move |_| macros);
    common.chain(sinumerik::function_names().filter(move |_| sinumerik))
}

/// The text of a block that calls a program in a dialect; `None` if a block cannot call by a number.
#[must_use]
pub fn call_text(dialect: Dialect, program: u32) -> Option<String> {
    (rules(dialect).call_text)(program)
}
