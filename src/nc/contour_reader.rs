//! Reads the contour blocks that a cycle names, without motion. Source: spec B2 (G70–G73).

use std::sync::Arc;

use super::block::Block;
use super::compensation::ActiveCutter;
use super::contour::{ContourCycle, ContourMemory, CycleKind, MAX_CONTOUR_BLOCKS, PendingCycle, contour_move};
use super::contour_compensation::ContourCutter;
use super::corner::{CornerWord, CornerWords, LineAngle};
use super::external_state::{AheadState, ExternalState};
use super::fault::{E, ErrorAt, ReadResult, ReadStop, fail, fail1, fail2};
use super::flow::Flow;
use super::interpreter::{Interpreter, StepStatus};
use super::modal::ModalState;
use super::op::Op;
use crate::defs::text::arg::Arg;
use crate::units::WorkPos;

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
        self.flow.place = *begin;
        let read = self.read_contour(cycle, world, &mut memory);
        let end_line = self.flow.place.line;
        std::mem::swap(&mut self.flow, &mut memory.flow);
        (self.modals, self.last_block_number, self.block_words.block_number, self.second_half) =
            (modals, last_n, n, false);
        let expanded = read.and_then(|()| {
            memory
                .expand(cycle, start, &mut block.ops)
                .map_err(|(error, details)| ReadStop::Error(ErrorAt { at: cycle.at, error, details }))
        });
        self.contour_memory = Some(memory);
        if let Err(stop) = expanded {
            // The flow goes back to the block: it is read again, or its mistake is reported.
            self.flow.place = *begin;
            return Err(stop);
        }
        (block.modals, block.is_cycle) = (self.modals, true);
        if !matches!(cycle.kind, CycleKind::Finish) && end_line > self.flow.place.line {
            self.flow.go_to_line(end_line);
        }
        Ok(StepStatus::Block)
    }

    /// Reads the operations of the contour's blocks, from the block of the cycle. Afterwards the flow is past the last one.
    fn read_contour(
        &mut self,
        cycle: &ContourCycle,
        world: &mut dyn ExternalState,
        memory: &mut ContourMemory,
    ) -> ReadResult<()> {
        let (source, at) = (&self.flow.source, self.flow.place.at);
        if source.find_block(cycle.last_block, at).is_none() {
            return fail1(cycle.at, E::MissingTarget, format_args!("N{}", cycle.last_block));
        }
        // DECISION: of several blocks with the number, G70 takes the last one before it, the others the next one behind.
        let before = matches!(cycle.kind, CycleKind::Finish).then(|| source.find_block_before(cycle.first_block, at));
        match before.flatten() {
            Some(first) => self.flow.go_to(first),
            None => self.flow.go_to_block(cycle.first_block, cycle.at)?,
        }
        let first = self.flow.place.at;
        let ends_before = |found: usize| cycle.last_block != cycle.first_block && found < first;
        if self.flow.source.find_block(cycle.last_block, first).is_some_and(ends_before) {
            let [last, first] = [cycle.last_block, cycle.first_block].map(|n| Arg::from(format_args!("N{n}")));
            return fail2(cycle.at, E::ContourReversed, last, first);
        }
        let mut ahead = AheadState { position: world.position(), inner: world, reads_machine: true };
        let ContourMemory { block: inner, ops, cutter, .. } = memory;
        ops.clear();
        *cutter = None;
        let mut open: Option<(usize, CornerWords)> = None;
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
            let (line, mut asked) = (inner.location.line, self.corner_words.take());
            for op in inner.ops.drain(..) {
                match contour_move(&op) {
                    Ok(Some(by)) => {
                        let begin = Self::join_contour(ops, open.take(), &op, asked.as_ref())?;
                        ahead.position = by.to;
                        let words = asked.take().filter(CornerWords::is_open);
                        open = words.map(|words| (ops.len(), words.beginning_at(begin.unwrap_or(words.from))));
                        Self::note_cutter(&self.modals, cutter, ops.len(), at)?;
                    }
                    Ok(None) => {}
                    Err(error) => return fail(at, error),
                }
                ops.push((op, line));
            }
            if self.block_words.block_number == Some(cycle.last_block) && !self.second_half {
                let left = open.filter(|(_, words)| !words.is_optional());
                return left.map_or(Ok(()), |(_, words)| refuse_corner(&words, words.without_move()));
            }
        }
        fail1(cycle.at, E::MissingTarget, format_args!("N{}", cycle.last_block))
    }

    /// Puts the corner between the open move of the contour and the next one, which has words of its own. Returns where the
    /// next one begins, if that is changed.
    fn join_contour(
        ops: &mut Vec<(Op, u32)>,
        open: Option<(usize, CornerWords)>,
        next: &Op,
        asked: Option<&CornerWords>,
    ) -> ReadResult<Option<WorkPos>> {
        let Some((index, words)) = open else {
            let ends_a_line = asked.filter(|asked| matches!(asked.angle, LineAngle::End(_)));
            return ends_a_line.map_or(Ok(None), |asked| refuse_corner(asked, E::AngleWithEnd));
        };
        let Some((op, line)) = ops.get_mut(index) else { return Ok(None) };
        let line = *line;
        match words.join(op, next, asked) {
            Ok((corner, begin)) => {
                corner.into_iter().for_each(|op| ops.insert(index + 1, (op, line)));
                Ok(Some(begin))
            }
            Err(_) if words.is_optional() => Ok(None),
            Err(mistake) => refuse_corner(&words, mistake),
        }
    }

    /// Notes the cutter of a move of a contour. It is the same from its first move to the last one of the contour; only
    /// that may be without it.
    fn note_cutter(modals: &ModalState, cutter: &mut Option<ContourCutter>, index: usize, at: usize) -> ReadResult<()> {
        let active = modals.compensation.filter(|active| active.cutter.radius_mm > 0.0);
        let active = active.map(|compensation| ActiveCutter { compensation, plane: modals.plane });
        match (&mut *cutter, active) {
            (None, Some(active)) => *cutter = Some(ContourCutter { active, lead_in: index, leads_out: false }),
            (None, None) => {}
            (Some(ContourCutter { leads_out: false, active: before, .. }), Some(active)) if *before == active => {}
            (Some(ContourCutter { leads_out: leads_out @ false, .. }), None) => *leads_out = true,
            (Some(ContourCutter { active: before, .. }), _) => {
                return fail1(at, E::CompensationChange, format_args!("G{}", before.compensation.g()));
            }
        }
        Ok(())
    }
}

/// Refuses a corner of the contour, at its word.
fn refuse_corner<T>(words: &CornerWords, mistake: E) -> ReadResult<T> {
    let CornerWord { at, name } = words.word_of(mistake);
    fail1(at, mistake, name)
}
