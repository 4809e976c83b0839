//! Reads the contour blocks that a cycle names, without motion. Source: spec B2 (G70–G73).
//!
//! They are those between P and Q in the text of the cycle: no call leads into them or out of them, no jump out of them.

use std::ops::Range;
use std::sync::Arc;

use super::block::Block;
use super::compensation::ActiveCutter;
use super::contour::{ContourCycle, ContourMemory, CycleKind, MAX_CONTOUR_BLOCKS, PendingCycle, contour_move};
use super::contour_compensation::ContourCutter;
use super::corner::{CornerWord, CornerWords, LineAngle};
use super::external_state::{AheadState, ExternalState};
use super::fault::{E, ErrorAt, ReadResult, ReadStop, fail, fail1, fail2};
use super::flow::{Flow, Place};
use super::interpreter::{Interpreter, StepStatus};
use super::lexer::Cursor;
use super::modal::ModalState;
use super::op::Op;
use super::statement;
use crate::defs::text::arg::Arg;
use crate::units::WorkPos;

/// The G codes of contour blocks: moves, compensation, path mode, feed and speed.
const CONTOUR_G: [u32; 16] = [0, 1, 2, 3, 9, 18, 40, 41, 42, 61, 64, 80, 96, 97, 98, 99];

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
        let (end, read_modals) = (self.flow.place, self.modals);
        std::mem::swap(&mut self.flow, &mut memory.flow);
        (self.modals, self.last_block_number, self.block_words.block_number, self.second_half) =
            (modals, last_n, n, false);
        let expanded = read.and_then(|()| {
            memory
                .expand(cycle, start, &mut block.ops)
                .map_err(|(error, details)| ReadStop::Error(ErrorAt { at: cycle.at, error, details }))
        });
        if expanded.is_ok() {
            // What the contour assigns holds behind it.
            self.flow.take_locals(&memory.flow);
        }
        self.contour_memory = Some(memory);
        if let Err(stop) = expanded {
            // The flow goes back to the block: it is read again, or its mistake is reported.
            self.flow.place = *begin;
            return Err(stop);
        }
        if matches!(cycle.kind, CycleKind::Finish) {
            // Speed and path mode of the contour act in this pass, and from then on.
            let ModalState { speed_mode, g97_mode, speed, path_mode, .. } = read_modals;
            self.modals = ModalState { speed_mode, g97_mode, speed, path_mode, ..self.modals };
        } else if end.at > self.flow.place.at {
            self.flow.go_behind(end);
        }
        (block.modals, block.is_cycle) = (self.modals, true);
        self.contour_was_read = true;
        Ok(StepStatus::Block)
    }

    /// Reads the operations of the contour's blocks, from the block of the cycle. Afterwards the flow is past the last one.
    fn read_contour(
        &mut self,
        cycle: &ContourCycle,
        world: &mut dyn ExternalState,
        memory: &mut ContourMemory,
    ) -> ReadResult<()> {
        let last = self.go_to_contour(cycle, memory.flow.place)?;
        let (first, level) = (self.flow.place.at, self.flow.call_depth());
        memory.place = (self.flow.source.number(), first);
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
            if self.flow.call_depth() != level || self.flow.modal_calls.is_active() {
                return fail(at, E::ContourLeft);
            }
            let foreign = self.block_words.g.iter().find(|code| !CONTOUR_G.contains(&code.number));
            let is_cycle = !inner.ops.is_empty() && inner.modals.motion.is_cycle();
            if self.pending_cycle.take().is_some() || foreign.is_some() || is_cycle {
                return fail(foreign.map_or(at, |code| code.at as usize), E::ContourCode);
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
            if !(first..=last).contains(&self.flow.place.at) {
                return fail(at, E::ContourLeft);
            }
        }
        fail1(cycle.at, E::ContourTooLong, format_args!("{MAX_CONTOUR_BLOCKS}"))
    }

    /// Goes to the first block of a contour; returns where the last one begins. `cycle_end` is behind the cycle.
    fn go_to_contour(&mut self, cycle: &ContourCycle, cycle_end: Place) -> ReadResult<usize> {
        let name = |n: u32| Arg::from(format_args!("N{n}"));
        let (source, at) = (&self.flow.source, self.flow.place.at);
        if source.find_block(cycle.last_block, at).is_none() {
            return fail1(cycle.at, E::MissingTarget, name(cycle.last_block));
        }
        // DECISION: of several blocks with the number, G70 takes the last one before it, the others the next one behind.
        let is_finish = matches!(cycle.kind, CycleKind::Finish);
        let before = is_finish.then(|| source.find_block_before(cycle.first_block, at)).flatten();
        match before {
            Some(first) => self.flow.go_to(first),
            None => self.flow.go_to_block(cycle.first_block, cycle.at)?,
        }
        let (source, first) = (&self.flow.source, self.flow.place.at);
        let Some(last) = source.find_block(cycle.last_block, first).filter(|last| *last >= first) else {
            return fail2(cycle.at, E::ContourReversed, name(cycle.last_block), name(cycle.first_block));
        };
        // They would be skipped: the program goes on behind the contour.
        if !is_finish && let Some(between) = first_content(source.bytes(), cycle_end.at..first) {
            return fail2(between, E::ContourApart, name(cycle.first_block), name(cycle.last_block));
        }
        Ok(last)
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

/// The first block of a stretch of text that holds anything but its number or a comment.
#[cold]
fn first_content(text: &[u8], stretch: Range<usize>) -> Option<usize> {
    let mut at = stretch.start;
    while at < stretch.end {
        let mut cursor = Cursor::window(text, at);
        // Behind another block of its line.
        let is_inner = cursor.accept(b';');
        if statement::has_content(&mut cursor) {
            return Some(at);
        }
        at = statement::next_block_on_line(text, at, is_inner).unwrap_or_else(|| {
            cursor.skip_rest_of_line();
            Place::behind(cursor, 0).at
        });
    }
    None
}

/// Refuses a corner of the contour, at its word.
fn refuse_corner<T>(words: &CornerWords, mistake: E) -> ReadResult<T> {
    let CornerWord { at, name } = words.word_of(mistake);
    fail1(at, mistake, name)
}
