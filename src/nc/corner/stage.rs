//! The blocks that wait for the move behind their corner. Source: spec B2, S1, K6.3.

use std::collections::VecDeque;

use super::CornerWords;
use crate::nc::block::{Block, BlockPlace};
use crate::nc::contour_segment::end_point;
use crate::nc::fault::{E, ProgramFault};
use crate::nc::modal::ModalState;
use crate::nc::op::Op;
use crate::units::{PerAxis, WorkPos};

/// Most blocks without a move between a corner and the move behind it.
pub(super) const MAX_BETWEEN: usize = 3;
/// Most blocks that wait: the open one, those between, the one behind it.
const MAX_WAITING: usize = MAX_BETWEEN + 2;
/// Operations of a block for which memory is taken at once.
const USUAL_BLOCK_OPS: usize = 8;

/// A block that waits.
#[derive(Debug)]
pub(super) struct HeldBlock {
    pub(super) place: BlockPlace,
    pub(super) modals: ModalState,
    pub(super) complete: bool,
    pub(super) is_cycle: bool,
    pub(super) ops: Vec<Op>,
    pub(super) used_variables: Vec<u32>,
}

/// A block whose end the next move decides.
#[derive(Debug)]
pub(super) struct OpenCorner {
    pub(super) block: HeldBlock,
    pub(super) words: CornerWords,
    /// The place of its move among its operations.
    pub(super) index: usize,
    /// The programmed end.
    pub(super) end: WorkPos,
}

/// The blocks that wait for a move.
#[derive(Debug)]
pub(in crate::nc) struct CornerStage {
    pub(super) open: Option<OpenCorner>,
    /// Blocks without a move behind the open one.
    pub(super) between: VecDeque<HeldBlock>,
    /// Blocks that are complete; they are returned before another one is read.
    pub(super) ready: VecDeque<HeldBlock>,
    spare: Vec<HeldBlock>,
    /// The block returned last.
    pub place: BlockPlace,
    /// The mistake of the open corner; every further call returns it.
    pub(super) refusal: Option<ProgramFault>,
}

impl HeldBlock {
    fn empty(modals: &ModalState) -> Self {
        Self {
            place: BlockPlace::default(),
            modals: *modals,
            complete: true,
            is_cycle: false,
            ops: Vec::with_capacity(USUAL_BLOCK_OPS),
            used_variables: Vec::new(),
        }
    }
}

impl OpenCorner {
    /// A block whose first move waits.
    pub(super) fn new(block: HeldBlock, words: CornerWords) -> Self {
        let index = move_index(&block.ops).unwrap_or_default();
        let end = block.ops.get(index).and_then(end_point).unwrap_or(words.from);
        Self { block, words, index, end }
    }

    /// Ends the move where its corner to the first move of `behind` begins; returns where that one begins.
    fn join(&mut self, behind: &HeldBlock, words: Option<&CornerWords>) -> Result<WorkPos, E> {
        // What changes positions, or stops reading ahead, must not stand before the next move.
        let ahead = behind.ops.iter().take_while(|op| !op.effect().is_motion());
        if behind.is_cycle || !ahead.into_iter().all(Op::may_stand_in_contour) {
            return Err(self.words.without_move());
        }
        let next = move_index(&behind.ops).and_then(|index| behind.ops.get(index));
        let (Some(op), Some(next)) = (self.block.ops.get_mut(self.index), next) else {
            return Err(self.words.without_move());
        };
        let (corner, begin) = self.words.join(op, next, words)?;
        corner.into_iter().for_each(|op| self.block.ops.insert(self.index + 1, op));
        Ok(begin)
    }
}

/// The place of the first move among operations.
pub(super) fn move_index(ops: &[Op]) -> Option<usize> {
    ops.iter().position(|op| op.effect().is_motion())
}

impl CornerStage {
    pub fn new(modals: &ModalState) -> Self {
        Self {
            open: None,
            between: VecDeque::with_capacity(MAX_WAITING),
            ready: VecDeque::with_capacity(MAX_WAITING),
            spare: (0..MAX_WAITING).map(|_| HeldBlock::empty(modals)).collect(),
            place: BlockPlace::default(),
            refusal: None,
        }
    }

    /// Forgets everything: another program begins.
    pub fn reset(&mut self) {
        self.release();
        self.spare.extend(self.ready.drain(..));
    }

    /// Whether no block waits.
    #[inline]
    pub fn is_idle(&self) -> bool {
        self.open.is_none() && self.ready.is_empty()
    }

    /// Whether a complete block waits to be returned.
    pub fn is_ready(&self) -> bool {
        !self.ready.is_empty()
    }

    /// Goes on behind a mistake: the blocks that wait are returned without a corner. True: the mistake was the corner's.
    pub fn abandon(&mut self) -> bool {
        let is_own = self.refusal.is_some();
        self.release();
        is_own
    }

    /// Lets the blocks that wait be returned as they are.
    pub(super) fn release(&mut self) {
        self.refusal = None;
        self.ready.extend(self.open.take().map(|open| open.block));
        self.ready.extend(self.between.drain(..));
    }

    /// The operator has moved the axes by hand in a hold (K6.3).
    pub fn shift_by_hand(&mut self, mut by: PerAxis<f64>) {
        let Self { ready, open, between, .. } = self;
        ready.iter_mut().flat_map(|block| &mut block.ops).for_each(|op| op.shift_by_hand(&mut by));
        let Some(OpenCorner { block, words, end, .. }) = open else { return };
        words.from = words.from + by;
        block.ops.iter_mut().for_each(|op| op.shift_by_hand(&mut by));
        *end = *end + by;
        between.iter_mut().flat_map(|block| &mut block.ops).for_each(|op| op.shift_by_hand(&mut by));
    }

    /// Takes the content of a block.
    pub(super) fn hold(&mut self, block: &mut Block, place: BlockPlace) -> HeldBlock {
        let mut held = self.spare.pop().unwrap_or_else(|| HeldBlock::empty(&block.modals));
        held.ops.clear();
        held.ops.append(&mut block.ops);
        (held.place, held.modals) = (BlockPlace { location: block.location, ..place }, block.modals);
        (held.complete, held.is_cycle) = (block.complete, block.is_cycle);
        std::mem::swap(&mut held.used_variables, &mut block.used_variables);
        held
    }

    /// A block with a move was read behind the open one, which is complete now; its own corner opens.
    ///
    /// # Errors
    /// The mistake of the corner; all blocks wait on.
    pub(super) fn join(&mut self, behind: HeldBlock, words: Option<CornerWords>) -> Result<(), E> {
        let Some(mut open) = self.open.take() else {
            self.ready.push_back(behind);
            return Ok(());
        };
        let begin = match open.join(&behind, words.as_ref()) {
            Ok(begin) => begin,
            Err(_) if open.words.is_optional() => open.end,
            Err(mistake) => {
                self.open = Some(open);
                self.between.push_back(behind);
                return Err(mistake);
            }
        };
        self.ready.push_back(open.block);
        self.ready.extend(self.between.drain(..));
        match words.filter(CornerWords::is_open) {
            Some(words) => self.open = Some(OpenCorner::new(behind, words.beginning_at(begin))),
            None => self.ready.push_back(behind),
        }
        Ok(())
    }

    /// Fills `block` with the next block that is complete; false if there is none.
    pub(super) fn give(&mut self, block: &mut Block) -> bool {
        let Some(mut held) = self.ready.pop_front() else { return false };
        block.clear();
        block.ops.append(&mut held.ops);
        (block.location, block.modals) = (held.place.location, held.modals);
        (block.complete, block.is_cycle) = (held.complete, held.is_cycle);
        std::mem::swap(&mut held.used_variables, &mut block.used_variables);
        self.place = held.place;
        self.spare.push(held);
        true
    }
}
