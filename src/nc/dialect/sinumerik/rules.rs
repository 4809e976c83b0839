//! The rules of the SINUMERIK 802D dialect. Source: spec S1.

use crate::defs::program_number;
use crate::nc::dialect::{BlockContext, DialectRules, FlowAction, ModalCodes, PreflightScope, UnexecutedBlock};
use crate::nc::expression::Scope;
use crate::nc::fault::ReadResult;
use crate::nc::flow::{CallLimit, Callee};
use crate::nc::lexer::Cursor;
use crate::nc::settings::{Dialect, NcSettings};
use crate::nc::statement::{BlockContent, ReadOptions};
use crate::nc::words::BlockWords;

/// Deepest nesting of L calls: eight levels with the main program (DECISION).
const L_DEPTH: usize = 7;

/// The rules of the vertical lathe-grinder.
pub(in crate::nc::dialect) struct SinumerikRules;

impl SinumerikRules {
    /// Reads one block.
    #[inline]
    pub fn read_block<S: Scope>(
        &self,
        cursor: &mut Cursor<'_>,
        scope: &mut S,
        words: &mut BlockWords,
        head: ReadOptions,
    ) -> ReadResult<BlockContent> {
        super::read::read_block(cursor, scope, words, head)
    }
}

impl DialectRules for SinumerikRules {
    fn settings(&self) -> NcSettings {
        NcSettings { exact_stop: true, ..NcSettings::two_axes(Dialect::Sinumerik) }
    }

    fn modal_codes(&self) -> ModalCodes {
        ModalCodes { distance_is_modal: true, per_minute: 94, per_rev: 95, inch: 70, metric: 71, exact_stop: 60 }
    }

    #[inline]
    fn execute(&self, running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
        super::execute(running)
    }

    fn check_unexecuted(&self, words: &BlockWords, block: &UnexecutedBlock<'_>) -> ReadResult<()> {
        super::check_unexecuted(words, block.source.bytes())
    }

    fn called_program(&self, words: &BlockWords) -> Option<(u32, usize)> {
        super::called_program(words)
    }

    fn call_in_text(&self, _code: &str) -> Option<u32> {
        None
    }

    fn call_text(&self, program: u32) -> Option<String> {
        program_number::is_l_number(program).then(|| program_number::name_of(program))
    }

    fn new_program_text(&self, number: u32) -> String {
        format!("O{number:04}\r\n\r\nM30\r\n")
    }

    fn call_limit(&self, _callee: &Callee) -> CallLimit {
        CallLimit { depth: L_DEPTH, name: "L" }
    }

    fn preflight_scope(&self) -> PreflightScope {
        PreflightScope::TextOnly
    }

    fn required_end_code(&self, _settings: &NcSettings) -> Option<&'static str> {
        None
    }

    fn has_labels(&self) -> bool {
        true
    }

    fn has_macros(&self) -> bool {
        true
    }
}
