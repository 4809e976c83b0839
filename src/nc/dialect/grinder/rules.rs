//! The rules of the KT-820/KT-830 dialect. Source: spec B1–B4, K1.

use crate::nc::dialect::{BlockContext, DialectRules, FlowAction, ModalCodes, PreflightScope, UnexecutedBlock};
use crate::nc::expression::Scope;
use crate::nc::fault::ReadResult;
use crate::nc::flow::{CallLimit, Callee};
use crate::nc::lexer::Cursor;
use crate::nc::settings::{Dialect, NcSettings};
use crate::nc::statement::{self, BlockContent, ReadOptions};
use crate::nc::words::BlockWords;
use crate::units::PerAxis;

/// Deepest nesting of M98, and of G65 and G66.
const SUB_DEPTH: usize = 4;
const MACRO_DEPTH: usize = 4;

/// The rules of GC (lathe system A), or of GS and GA (modal G90 and G91).
pub(in crate::nc::dialect) struct GrinderRules {
    mill: bool,
}

impl GrinderRules {
    /// GC.
    pub const LATHE_A: Self = Self { mill: false };
    /// GS and GA.
    pub const MILL: Self = Self { mill: true };

    /// Reads one block.
    #[inline]
    pub fn read_block<S: Scope>(
        &self,
        cursor: &mut Cursor<'_>,
        scope: &mut S,
        words: &mut BlockWords,
        head: ReadOptions,
    ) -> ReadResult<BlockContent> {
        statement::read_block(cursor, scope, words, head)
    }
}

impl DialectRules for GrinderRules {
    fn settings(&self) -> NcSettings {
        match self.mill {
            false => NcSettings::two_axes(Dialect::LatheA),
            true => NcSettings { diameter: false, axes: PerAxis([true; 3]), ..NcSettings::two_axes(Dialect::Mill) },
        }
    }

    fn modal_codes(&self) -> ModalCodes {
        ModalCodes { distance_is_modal: self.mill, per_minute: 98, per_rev: 99, inch: 20, metric: 21, exact_stop: 61 }
    }

    #[inline]
    fn execute(&self, running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
        super::execute(running)
    }

    fn check_unexecuted(&self, words: &BlockWords, _block: &UnexecutedBlock<'_>) -> ReadResult<()> {
        super::check_unexecuted(words, self.mill)
    }

    fn called_program(&self, _words: &BlockWords) -> Option<(u32, usize)> {
        None
    }

    fn call_in_text(&self, code: &str) -> Option<u32> {
        let calls = ["M98", "G65", "G66"].iter().any(|word| code.contains(word));
        let calculates = code.contains("G65") && code.contains('H');
        let behind = code.split('P').nth(1).filter(|_| calls && !calculates)?;
        let digits = behind.bytes().take_while(u8::is_ascii_digit).count();
        let number = behind[..digits].parse::<u32>().unwrap_or(0);
        // B3: P may hold a repeat count before the four digits of the number.
        (1..=8).contains(&digits).then_some(number % 10_000)
    }

    fn call_text(&self, program: u32) -> Option<String> {
        Some(format!("M98 P{program}"))
    }

    fn new_program_text(&self, number: u32) -> String {
        format!("O{number:04}\r\n\r\nM30\r\n")
    }

    fn call_limit(&self, callee: &Callee) -> CallLimit {
        match callee {
            Callee::Macro(_) => CallLimit { depth: MACRO_DEPTH, name: "G65/G66" },
            Callee::Sub => CallLimit { depth: SUB_DEPTH, name: "M98" },
        }
    }

    fn preflight_scope(&self) -> PreflightScope {
        PreflightScope::Unsupported
    }

    fn required_end_code(&self, _settings: &NcSettings) -> Option<&'static str> {
        None
    }

    fn has_labels(&self) -> bool {
        false
    }

    fn has_macros(&self) -> bool {
        true
    }
}
