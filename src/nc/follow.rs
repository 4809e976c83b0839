//! Following a program without a machine: for the check, and for a run from a chosen block. Source: spec B1, B5, T4.

use std::sync::Arc;

use super::fault::{Fault, Stop, Wrong, fault_in};
use super::interpreter::{Block, Interpreter, Next, Stepped};
use super::memory::Memory;
use super::op::Op;
use super::source::Source;
use super::world::{CheckWorld, World};
use crate::defs::program_error::ProgramError as E;

/// How many blocks one call of `advance_to` may read.
pub const ADVANCE_PER_CALL: usize = 2_000;

impl Interpreter {
    /// Reads on, as fast as it goes and without a machine, until a line (from 1) of the started program is next: what
    /// is in force there is then in [`Self::modals`], the position in `world`; `sink` sees what was passed. At most [`ADVANCE_PER_CALL`] blocks;
    /// `Next::Block` when the line is reached, `Next::Busy` to be asked again, `Next::End` if the program ends before.
    ///
    /// # Errors
    /// A mistake on the way.
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

    /// Goes past a fault; for a check that wants to see the rest without what follows from it.
    pub(crate) fn skip(&mut self, error: E) {
        self.second_half = false;
        // The feed was meant to stay: later blocks are not blamed for it.
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

    /// Leaves the outermost loop that is open; for a check that sees no end of it.
    pub(crate) fn leave_loop(&mut self) -> bool {
        self.flow.leave_loops()
    }

    /// Gives back the values of the common variables; for a check that goes on from an earlier place.
    pub(crate) fn put_memory(&mut self, memory: Memory) {
        self.memory = memory;
    }

    /// Whether M99 has begun the main program again.
    pub(crate) const fn has_restarted(&self) -> bool {
        self.flow.restarted
    }

    /// Whether M02 or M30 was read.
    pub(crate) const fn has_ended(&self) -> bool {
        self.ended
    }

    /// Whether there is anything to remark on the last block.
    #[inline]
    pub(crate) fn has_remarks(&self) -> bool {
        self.flow.mid_line
            || self.notes.as_ref().is_some_and(|notes| !notes.is_empty())
            || self.nulls.as_ref().is_some_and(|nulls| !nulls.is_empty())
    }

    /// Whether a variable without a value counted in the last block.
    #[inline]
    pub(crate) fn has_met_null(&self) -> bool {
        self.words.has_null() || self.nulls.as_ref().is_some_and(|nulls| !nulls.is_empty())
    }

    /// What is allowed and seldom meant in the last block.
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

    /// Reads one block whatever it is; `true` while there is more.
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
