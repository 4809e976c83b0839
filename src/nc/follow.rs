//! Follows a program without a machine: for a check, and for a restart from a chosen block. Source: spec B1, B5, T4.

use std::sync::Arc;

use super::fault::{Fault, Stop, Wrong, fault_in};
use super::interpreter::{Block, Interpreter, Next, Stepped};
use super::memory::Memory;
use super::op::Op;
use super::source::Source;
use super::world::{CheckWorld, World};
use crate::defs::program_error::ProgramError as E;

/// Most blocks that one call of `advance_to` reads.
pub const ADVANCE_PER_CALL: usize = 2_000;

impl Interpreter {
    /// Reads without a machine until a line (from 1) of the started program is next. The modal state is then in
    /// [`Self::modals`], the position in `world`. `sink` gets all operations. At most [`ADVANCE_PER_CALL`] blocks.
    /// `Next::Block`: line reached. `Next::Busy`: call again. `Next::End`: the program ends before the line.
    ///
    /// # Errors
    /// A mistake in the blocks up to the line.
    pub fn advance_to(&mut self, line: u32, world: &mut CheckWorld, sink: &mut dyn FnMut(&Op)) -> Result<Next, Fault> {
        let mut block = Block::new(&self.settings);
        for _ in 0..ADVANCE_PER_CALL {
            let there = self.flow.line + 1 == line && !self.flow.mid_line && !self.second_half;
            if there && self.flow.is_main() && !self.ended {
                return Ok(Next::Block);
            }
            if self.ended || !self.single(world, &mut block)? {
                return Ok(Next::End);
            }
            for op in &block.ops {
                world.apply(op);
                sink(op);
            }
        }
        Ok(Next::Busy)
    }

    /// Skips a faulty block, so that a check can read on without consequential errors.
    pub(crate) fn skip(&mut self, error: E) {
        self.second_half = false;
        // The F word of the faulty block is kept, so that later blocks do not report a missing feed.
        if self.modals.feed.is_none() {
            let word = self.words.list().iter().find(|word| word.letter == b'F');
            self.modals.feed = word.map(|word| word.value).filter(|feed| *feed > 0.0);
        }
        if matches!(error, E::SubWithoutReturn | E::EndInSub) {
            let _ = self.flow.return_to(None, 0); // without a target it always succeeds
            return;
        }
        self.flow.enter_wrong_loop();
        self.flow.go_to_line(self.flow.line + 1);
    }

    /// Leaves the outermost open loop; for a check of an endless loop.
    pub(crate) fn leave_loop(&mut self) -> bool {
        self.flow.leave_loops()
    }

    /// Restores the common variables; for a check that continues from an earlier state.
    pub(crate) fn put_memory(&mut self, memory: Memory) {
        self.memory = memory;
    }

    /// Whether M99 restarted the main program.
    pub(crate) const fn has_restarted(&self) -> bool {
        self.flow.restarted
    }

    /// Whether M02 or M30 was read.
    pub(crate) const fn has_ended(&self) -> bool {
        self.ended
    }

    /// Whether the last block has warnings.
    #[inline]
    pub(crate) fn has_remarks(&self) -> bool {
        self.flow.mid_line
            || self.notes.as_ref().is_some_and(|notes| !notes.is_empty())
            || self.nulls.as_ref().is_some_and(|nulls| !nulls.is_empty())
    }

    /// Whether the last block used a null variable.
    #[inline]
    pub(crate) fn has_met_null(&self) -> bool {
        self.words.has_null() || self.nulls.as_ref().is_some_and(|nulls| !nulls.is_empty())
    }

    /// Takes the warnings of the last block: allowed but rarely intended.
    pub(crate) fn remarks(&mut self) -> Vec<Fault> {
        let source = Arc::clone(&self.flow.source);
        let mut remarks = Vec::new();
        for (source, at, variable) in self.nulls.iter_mut().flat_map(|nulls| nulls.drain(..)) {
            let details = [format!("#{variable}"), String::new()];
            remarks.push(fault_in(&source, None, Wrong { at, error: E::NullUsed, details }));
        }
        for wrong in self.notes.iter_mut().flat_map(|notes| notes.drain(..)) {
            remarks.push(fault_in(&source, None, wrong));
        }
        if self.flow.mid_line {
            let wrong = Wrong { at: self.flow.at, error: E::BlockAfterSemicolon, details: Default::default() };
            remarks.push(fault_in(&source, None, wrong));
        }
        remarks
    }

    /// The running program and the line (from 0) that is read next.
    #[inline]
    pub(crate) fn at_line(&self) -> (&Arc<Source>, u32) {
        (&self.flow.source, self.flow.line)
    }

    /// Reads one block, with or without operations; `true` while there is more.
    #[inline]
    pub(crate) fn single(&mut self, world: &mut dyn World, block: &mut Block) -> Result<bool, Fault> {
        block.clear();
        match self.step(world, block) {
            Ok(Stepped::Nothing | Stepped::Block) => Ok(true),
            Ok(Stepped::End) => Ok(false),
            Err(stop) => match *stop {
                Stop::Drain => Ok(true),
                Stop::Wrong(wrong) => Err(self.fault(wrong)),
            },
        }
    }
}
