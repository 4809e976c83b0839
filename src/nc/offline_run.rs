//! Follows a program without a machine: for a check, and for a restart from a chosen block. Source: spec B1, B5, T4.

use std::sync::Arc;

use super::block::Block;
use super::called_texts::FoundCall;
use super::expression::Locals;
use super::external_state::{ExternalState, OfflineMachine};
use super::fault::{E, ErrorAt, ProgramFault, ReadResult, StepStop};
use super::flow::{CallDepth, Callee};
use super::interpreter::{Interpreter, NextStatus, StepStatus};
use super::modal::{CycleWords, MotionMode};
use super::source::Source;
use crate::defs::text::arg::Arg;
use crate::units::WorkBudget;

impl Interpreter {
    /// Reads one block without a machine, unless a line (from 1) of the started program is next. `NextStatus::Busy`: it
    /// was read and done in `world`, call again. `NextStatus::Block`: the line is next; the modal state there is in
    /// [`Self::modals`], the position in `world`. `NextStatus::End`: the program ends before the line.
    ///
    /// # Errors
    /// A mistake in the blocks up to the line.
    pub fn read_towards(
        &mut self,
        line: u32,
        world: &mut OfflineMachine,
        block: &mut Block,
        budget: &mut WorkBudget,
    ) -> Result<NextStatus, ProgramFault> {
        block.clear();
        let there = self.flow.place.line + 1 == line && !self.flow.place.mid_line && !self.second_half;
        // Behind G40 the blocks that wait come first.
        let waits = self.compensation.has_blocks() && !self.compensation.is_open();
        let there = there && !self.corners.is_ready();
        if there && self.flow.is_main() && !self.ended && !waits {
            return Ok(NextStatus::Block);
        }
        if self.is_over() || !self.read_one(world, block)? {
            return Ok(NextStatus::End);
        }
        self.charge_blocks(budget);
        block.ops.iter().for_each(|op| world.apply(op));
        Ok(NextStatus::Busy)
    }

    /// Goes to the block at a byte of a text, as if the program came there from the line above it.
    pub(super) fn begin_alone(&mut self, source: &Arc<Source>, at: usize, (locals, depth): (&Locals, CallDepth)) {
        self.flow.begin_at(Arc::clone(source), at, locals, depth);
        (self.ended, self.second_half, self.pending_cycle, self.corner_words) = (false, false, None, None);
        (self.modals.modal_call, self.modals.compensation) = (false, None);
        self.null_uses.iter_mut().for_each(Vec::clear);
        self.warnings.iter_mut().for_each(Vec::clear);
    }

    /// Executes one block, both halves if it is divided.
    pub(super) fn step_whole_block(&mut self, world: &mut OfflineMachine, block: &mut Block) -> ReadResult<StepStatus> {
        block.clear();
        loop {
            let stepped = self.step(world, block)?;
            if !self.second_half {
                return Ok(stepped);
            }
        }
    }

    /// The programs that the last block calls.
    pub(super) fn take_called_programs(&mut self, calls: &mut Vec<FoundCall>) {
        if !self.flow.is_main() {
            calls.push((Arc::clone(&self.flow.source), *self.flow.locals(), self.flow.call_depth()));
        }
        calls.extend(self.modal_macro());
    }

    /// The call of the macro of the G66 that acts.
    pub(super) fn modal_macro(&self) -> Option<FoundCall> {
        let (modal, arguments) = self.flow.modal_calls.active()?;
        let source = self.library.find(modal.program)?;
        Some((source, *arguments, self.flow.call_depth().within(Callee::Macro)))
    }

    /// Skips a faulty block, so that a check can read on without consequential errors.
    pub(crate) fn skip_faulty_block(&mut self, error: E) {
        if !self.compensation.is_idle() {
            self.modals.compensation = None;
        }
        // A mistake of a corner is found behind its block.
        if self.corners.abandon() | self.compensation.abandon() {
            return;
        }
        self.second_half = false;
        // Later blocks count on its motion code. A missing feed is said once.
        let mut written = self.block_words.g.iter().filter(|code| code.number <= 3);
        if let Some(motion) = written.next_back().and_then(|code| MotionMode::from_g(code.number))
            && error != E::FeedMissing
        {
            self.modals.motion = motion;
            self.modals.cycle = CycleWords::default();
        }
        // The F word of the faulty block is kept, so that later blocks do not report a missing feed.
        if self.modals.feed.is_none() {
            let word = self.block_words.list.iter().find(|word| word.letter == b'F');
            self.modals.feed = word.map(|word| word.value).filter(|feed| *feed > 0.0);
        }
        if matches!(error, E::SubWithoutReturn | E::EndInSub) {
            let _ = self.flow.return_to(None, 0); // without a target it always succeeds
            return;
        }
        // Nothing is known of a loop with a faulty condition: its blocks are read by themselves.
        if let Some(end) = self.flow.source.while_loop_at(self.flow.place.at).and_then(|found| found.end) {
            self.flow.go_to(end.after as usize);
            return;
        }
        self.flow.enter_faulty_loop();
        self.flow.go_to_line(self.flow.place.line + 1);
    }

    /// Whether the last block has warnings.
    #[inline]
    pub(crate) fn has_warnings(&self) -> bool {
        self.flow.place.mid_line
            || self.warnings.as_ref().is_some_and(|notes| !notes.is_empty())
            || self.null_uses.as_ref().is_some_and(|nulls| !nulls.is_empty())
    }

    /// Whether an unknown value may have left out an F: its own word, or what a condition or a jump decides.
    pub(crate) fn may_have_left_out_feed(&self) -> bool {
        let words = &self.block_words;
        let is_plain = words.condition.is_none() && !words.is_empty();
        words.is_left_out(b'F') || self.has_null_use() && !is_plain
    }

    /// Whether the last block used a null variable.
    #[inline]
    pub(crate) fn has_null_use(&self) -> bool {
        self.block_words.has_null() || self.null_uses.as_ref().is_some_and(|nulls| !nulls.is_empty())
    }

    /// Takes the warnings of the last block: allowed but rarely intended.
    pub(crate) fn take_warnings(&mut self, tell: &mut dyn FnMut(ProgramFault)) {
        let source = Arc::clone(&self.flow.source);
        for (source, at, variable) in self.null_uses.iter_mut().flat_map(|nulls| nulls.drain(..)) {
            let details = [Arg::from(format_args!("#{variable}")), Arg::None];
            tell(source.fault(None, ErrorAt { at, error: E::NullUsed, details }));
        }
        for wrong in self.warnings.iter_mut().flat_map(|notes| notes.drain(..)) {
            tell(source.fault(None, wrong));
        }
        if self.flow.place.mid_line {
            let wrong = ErrorAt { at: self.flow.place.at, error: E::BlockAfterSemicolon, details: Default::default() };
            tell(source.fault(None, wrong));
        }
    }

    /// Reads one block, with or without operations; `true` while there is more.
    #[inline]
    pub(crate) fn read_one(&mut self, world: &mut dyn ExternalState, block: &mut Block) -> Result<bool, ProgramFault> {
        block.clear();
        match self.step_compensated(world, block) {
            Ok(StepStatus::Empty | StepStatus::Block) => Ok(true),
            Ok(StepStatus::End) => Ok(false),
            Err(StepStop::Drain) => Ok(true),
            Err(StepStop::Fault(fault)) => Err(fault),
        }
    }
}
