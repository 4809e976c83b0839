//! Reads the contour blocks that a cycle names, without motion. Source: spec B2 (G70–G73).

use std::sync::Arc;

use super::block::Block;
use super::contour::{ContourCycle, ContourMemory, CycleKind, MAX_CONTOUR_BLOCKS, PendingCycle, contour_move};
use super::external_state::{ExternalState, LiveValue};
use super::fault::{E, ReadResult, fail, fail1};
use super::flow::Flow;
use super::interpreter::{Interpreter, StepStatus};
use crate::units::WorkPos;

/// The state while a contour is read: the position is the end of its last block.
struct ContourReadState<'w> {
    inner: &'w mut dyn ExternalState,
    position: WorkPos,
}

impl ExternalState for ContourReadState<'_> {
    fn position(&self) -> WorkPos {
        self.position
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        self.inner.system_variable(number)
    }

    fn block_skip(&self) -> bool {
        self.inner.block_skip()
    }
}

impl Interpreter {
    /// Expands a cycle into operations. The program continues after the contour, or after the cycle if that is later.
    pub(super) fn expand_contour(
        &mut self,
        PendingCycle { cycle, block_start: begin }: &PendingCycle,
        world: &mut dyn ExternalState,
        block: &mut Block,
    ) -> ReadResult<StepStatus> {
        let start = world.position();
        let mut memory = self.contour_memory.take().unwrap_or_else(|| {
            Box::new(ContourMemory::new(Flow::new(Arc::clone(&self.flow.source)), Block::new(&self.settings)))
        });
        memory.flow.copy_from(&self.flow);
        let (modals, last_n, n) = (self.modals, self.last_block_number, self.block_words.block_number);
        let read = self.read_contour(cycle, world, &mut memory);
        let end_line = self.flow.place.line;
        std::mem::swap(&mut self.flow, &mut memory.flow);
        (self.modals, self.last_block_number, self.block_words.block_number, self.second_half) =
            (modals, last_n, n, false);
        let expanded =
            read.and_then(|()| memory.expand(cycle, start, &mut block.ops).or_else(|error| fail(cycle.at, error)));
        self.contour_memory = Some(memory);
        if let Err(stop) = expanded {
            // The flow goes back to the block: it is read again, or its mistake is reported.
            self.flow.place = *begin;
            return Err(stop);
        }
        block.modals = self.modals;
        if !matches!(cycle.kind, CycleKind::Finish) && end_line > self.flow.place.line {
            self.flow.go_to_line(end_line);
        }
        Ok(StepStatus::Block)
    }

    /// Reads the operations of the contour's blocks. Afterwards the flow is past the last one.
    fn read_contour(
        &mut self,
        cycle: &ContourCycle,
        world: &mut dyn ExternalState,
        memory: &mut ContourMemory,
    ) -> ReadResult<()> {
        if self.flow.source.find_block(cycle.last_block, self.flow.place.at).is_none() {
            return fail1(cycle.at, E::MissingTarget, format_args!("N{}", cycle.last_block));
        }
        self.flow.go_to_block(cycle.first_block, cycle.at)?;
        let mut ahead = ContourReadState { position: world.position(), inner: world };
        let ContourMemory { block: inner, ops, .. } = memory;
        ops.clear();
        for _ in 0..MAX_CONTOUR_BLOCKS {
            inner.clear();
            self.contour_blocks += 1;
            let at = self.flow.place.at;
            match self.read_block(&mut ahead, inner)? {
                StepStatus::End => break,
                StepStatus::Empty | StepStatus::Block => {}
            }
            if self.pending_cycle.take().is_some() {
                return fail(at, E::ContourCode);
            }
            for op in inner.ops.drain(..) {
                match contour_move(&op) {
                    Ok(Some(by)) => ahead.position = by.to,
                    Ok(None) => {}
                    Err(error) => return fail(at, error),
                }
                ops.push(op);
            }
            if self.block_words.block_number == Some(cycle.last_block) && !self.second_half {
                return Ok(());
            }
        }
        fail1(cycle.at, E::MissingTarget, format_args!("N{}", cycle.last_block))
    }
}
