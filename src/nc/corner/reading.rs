//! How the interpreter reads blocks with corners: each waits for the move behind it. Source: spec B2, S1.

use super::stage::{MAX_BETWEEN, OpenCorner, move_index};
use super::{CornerWord, LineAngle};
use crate::defs::text::arg::Arg;
use crate::nc::block::{Block, BlockPlace};
use crate::nc::external_state::{AheadState, ExternalState};
use crate::nc::fault::{E, ErrorAt, ReadStop, StepStop};
use crate::nc::interpreter::{Interpreter, StepStatus};
use crate::nc::op::Op;

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
        self.corners.open = Some(OpenCorner::new(held, words));
        if matches!(words.angle, LineAngle::End(_)) {
            return self.refuse_corner(E::AngleWithEnd);
        }
        Ok(StepStatus::Empty)
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
        if move_index(&behind.ops).is_none() {
            let may_follow =
                behind.ops.iter().all(Op::may_stand_in_contour) && self.corners.between.len() < MAX_BETWEEN;
            self.corners.between.push_back(behind);
            return if may_follow { Ok(StepStatus::Empty) } else { self.leave_corner(block) };
        }
        if let Err(mistake) = self.corners.join(behind, words) {
            return self.refuse_corner(mistake);
        }
        self.corners.give(block);
        Ok(StepStatus::Block)
    }

    /// No move follows the open corner.
    fn leave_corner(&mut self, block: &mut Block) -> Result<StepStatus, StepStop> {
        let Some(words) = self.corners.open.as_ref().map(|open| open.words) else { return Ok(StepStatus::Empty) };
        if !words.is_optional() {
            return self.refuse_corner(words.without_move());
        }
        self.corners.release();
        self.corners.give(block);
        Ok(StepStatus::Block)
    }

    /// Refuses the open corner, at its word.
    fn refuse_corner(&mut self, error: E) -> Result<StepStatus, StepStop> {
        let Some(OpenCorner { block, words, .. }) = &self.corners.open else { return Ok(StepStatus::Empty) };
        let CornerWord { at, name } = words.word_of(error);
        let wrong = ErrorAt { at, error, details: [name.into(), Arg::None] };
        let fault = self.fault_in(block.place.location, wrong);
        self.corners.refusal = Some(fault.clone());
        Err(StepStop::Fault(fault))
    }
}
