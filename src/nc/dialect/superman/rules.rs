//! The rules of the 超人 (SuperMan) lathe dialect. Source: spec L1, L7.

use crate::nc::dialect::{BlockContext, DialectRules, FlowAction, ModalCodes, PreflightScope, UnexecutedBlock};
use crate::nc::expression::Scope;
use crate::nc::fault::ReadResult;
use crate::nc::flow::{COUNTED_DEPTH, CallLimit, Callee};
use crate::nc::lexer::Cursor;
use crate::nc::settings::{Dialect, NcSettings};
use crate::nc::statement::{self, BlockContent, ReadOptions};
use crate::nc::words::BlockWords;

/// Number of stations of the tool turret.
const STATIONS: u32 = 4;

/// The rules of the lathe.
pub(in crate::nc::dialect) struct SuperManRules;

impl SuperManRules {
    /// Reads one block.
    #[inline]
    pub fn read_block<S: Scope>(
        &self,
        cursor: &mut Cursor<'_>,
        scope: &mut S,
        words: &mut BlockWords,
        head: ReadOptions,
    ) -> ReadResult<BlockContent> {
        let content = statement::read_block(cursor, scope, words, head)?;
        // L1: a line is one block. Text after `;` is always a comment.
        cursor.skip_rest_of_line();
        Ok(content)
    }
}

impl DialectRules for SuperManRules {
    fn settings(&self) -> NcSettings {
        NcSettings {
            exact_stop: true,
            start_is_work_zero: true,
            needs_block_numbers: true,
            tool_count: STATIONS,
            ..NcSettings::two_axes(Dialect::SuperMan)
        }
    }

    fn modal_codes(&self) -> ModalCodes {
        ModalCodes { distance_is_modal: false, per_minute: 98, per_rev: 99, inch: 20, metric: 21, exact_stop: 61 }
    }

    #[inline]
    fn execute(&self, running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
        super::execute(running)
    }

    fn check_unexecuted(&self, words: &BlockWords, block: &UnexecutedBlock<'_>) -> ReadResult<()> {
        super::check_unexecuted(words, block)
    }

    fn called_program(&self, _words: &BlockWords) -> Option<(u32, usize)> {
        None
    }

    fn call_in_text(&self, _code: &str) -> Option<u32> {
        None
    }

    /// L7: M98 calls a block of the same text.
    fn call_text(&self, _program: u32) -> Option<String> {
        None
    }

    fn new_program_text(&self, _number: u32) -> String {
        "N0010M02\r\n".to_owned()
    }

    /// No program calls another; calls in the same text have their own limit.
    fn call_limit(&self, _callee: &Callee) -> CallLimit {
        CallLimit { depth: COUNTED_DEPTH, name: "M98" }
    }

    fn preflight_scope(&self) -> PreflightScope {
        PreflightScope::FullRun
    }

    fn required_end_code(&self, settings: &NcSettings) -> Option<&'static str> {
        settings.needs_block_numbers.then_some("M02")
    }

    fn has_labels(&self) -> bool {
        false
    }

    fn has_macros(&self) -> bool {
        false
    }
}
