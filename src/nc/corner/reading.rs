//! How the interpreter reads blocks with corners: each waits for the move behind it. Source: spec B2, S1.

use super::CornerWords;
use super::stage::{CornerStage, HeldBlock, MAX_BETWEEN, OpenCorner};
use crate::defs::text::arg::Arg;
use crate::nc::block::{Block, BlockPlace};
use crate::nc::external_state::{AheadState, ExternalState};
use crate::nc::fault::{E, ErrorAt, ReadStop, StepStop};
use crate::nc::interpreter::{Interpreter, StepStatus};
use crate::nc::op::Op;

/// The place of the first move among operations.
fn move_index(ops: &[Op]) -> Option<usize> {
    ops.iter().position(|op| op.effect().is_motion())
}

impl Interpreter {
    /// As [`Self::step`]; a block with a corner is returned when the move behind it is known.
    #[inline]
    pub(in crate::nc) fn step_cornered(
        &mut self,
        world: &mut dyn ExternalState,
        block: &mut Block,
    ) -> Result<StepStatus, StepStop> {
        if !self.corners.is_idle() {
            return self.step_behind_corner(world, block);
        }
        self.corners.place = self.next_place();
        let stepped = match self.step(world, block) {
            Err(stop) => return Err(self.stopped(stop)),
            Ok(stepped) => stepped,
        };
        let Some(words) = self.corner_words.take() else { return Ok(stepped) };
        let held = self.corners.hold(block, self.corners.place);
        self.open_corner(held, words);
        if words.end_angle.is_some() {
            return self.refuse_corner(E::AngleWithEnd);
        }
        Ok(StepStatus::Empty)
    }

    /// A block waits for the move behind it.
    fn open_corner(&mut self, block: HeldBlock, words: CornerWords) {
        let index = move_index(&block.ops).unwrap_or_default();
        let end = block.ops.get(index).and_then(|op| words.path_of(op).ok()).map_or(words.from, |by| by.to);
        self.corners.open = Some(OpenCorner { block, words, index, end });
    }

    #[cold]
    fn step_behind_corner(&mut self, world: &mut dyn ExternalState, block: &mut Block) -> Result<StepStatus, StepStop> {
        if let Some(fault) = &self.corners.refusal {
            return Err(StepStop::Fault(fault.clone()));
        }
        if self.corners.give(block) {
            return Ok(StepStatus::Block);
        }
        let Some(position) = self.corners.open.as_ref().map(|open| open.end) else { return Ok(StepStatus::Empty) };
        if self.ended {
            return self.leave_corner(block);
        }
        let place = self.next_place();
        let mut ahead = AheadState { inner: world, position, reads_machine: false };
        match self.step(&mut ahead, block) {
            Ok(StepStatus::Empty) => {
                self.corners.place = place;
                Ok(StepStatus::Empty)
            }
            Ok(StepStatus::Block) => self.follow_corner(block, place),
            // What needs the machine to stand has no move that a corner could lead to.
            Ok(StepStatus::End) | Err(ReadStop::Drain) => self.leave_corner(block),
            Err(stop) => Err(self.stopped(stop)),
        }
    }

    /// A block behind an open corner was read.
    fn follow_corner(&mut self, block: &mut Block, place: BlockPlace) -> Result<StepStatus, StepStop> {
        let words = self.corner_words.take();
        let behind = self.corners.hold(block, place);
        let Some(index) = move_index(&behind.ops) else {
            self.corners.between.push_back(behind);
            return if self.corners.between.len() > MAX_BETWEEN {
                self.leave_corner(block)
            } else {
                Ok(StepStatus::Empty)
            };
        };
        let Some(OpenCorner { block: mut before, words: open, index: at, end }) = self.corners.open.take() else {
            return Ok(StepStatus::Empty);
        };
        let joined = match (before.ops.get_mut(at), behind.ops.get(index).filter(|_| !behind.is_cycle)) {
            (Some(op), Some(next)) => open.join(op, next, words.as_ref()),
            _ => Err(E::CornerWithoutMove),
        };
        let begin = match joined {
            Ok(corner) => {
                let begin = corner.as_ref().map(|(_, begin)| *begin);
                corner.into_iter().for_each(|(op, _)| before.ops.insert(at + 1, op));
                begin.or_else(|| before.ops.get(at).and_then(|op| open.path_of(op).ok()).map(|by| by.to))
            }
            Err(_) if open.is_modal => Some(end),
            Err(mistake) => {
                self.corners.open = Some(OpenCorner { block: before, words: open, index: at, end });
                self.corners.between.push_back(behind);
                return self.refuse_corner(mistake);
            }
        };
        self.corners.ready.push_back(before);
        let Self { corners: CornerStage { ready, between, .. }, .. } = self;
        ready.extend(between.drain(..));
        match words {
            // `X_ Z_ ,A_` behind an open line only ends it.
            Some(words) if words.corner.is_some() || words.open_angle.is_some() => {
                self.open_corner(behind, CornerWords { from: begin.unwrap_or(words.from), end_angle: None, ..words });
            }
            Some(_) | None => self.corners.ready.push_back(behind),
        }
        self.corners.give(block);
        Ok(StepStatus::Block)
    }

    /// No move follows the open corner.
    fn leave_corner(&mut self, block: &mut Block) -> Result<StepStatus, StepStop> {
        let Some(open) = &self.corners.open else { return Ok(StepStatus::Empty) };
        match (open.words.is_modal, open.words.open_angle) {
            (true, _) => {
                self.corners.release();
                self.corners.give(block);
                Ok(StepStatus::Block)
            }
            (false, Some(_)) => self.refuse_corner(E::AngleWithoutEnd),
            (false, None) => self.refuse_corner(E::CornerWithoutMove),
        }
    }

    /// Refuses the open corner, at its word.
    fn refuse_corner(&mut self, error: E) -> Result<StepStatus, StepStop> {
        let Some(OpenCorner { block, words, .. }) = &self.corners.open else { return Ok(StepStatus::Empty) };
        let wrong = ErrorAt { at: words.at, error, details: [words.name.into(), Arg::None] };
        let fault = self.fault_in(block.place.location, wrong);
        self.corners.refusal = Some(fault.clone());
        Err(StepStop::Fault(fault))
    }
}
