//! The blocks that wait for the move behind their corner. Source: spec B2, S1, K6.3.

use std::collections::VecDeque;

use super::CornerWords;
use crate::nc::block::{Block, BlockPlace};
use crate::nc::fault::ProgramFault;
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

impl CornerStage {
    pub fn new(modals: &ModalState) -> Self {
        let spare = |_| HeldBlock {
            place: BlockPlace::default(),
            modals: *modals,
            complete: true,
            is_cycle: false,
            ops: Vec::with_capacity(USUAL_BLOCK_OPS),
            used_variables: Vec::new(),
        };
        Self {
            open: None,
            between: VecDeque::with_capacity(MAX_WAITING),
            ready: VecDeque::with_capacity(MAX_WAITING),
            spare: (0..MAX_WAITING).map(spare).collect(),
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
        // As many are spare as can wait.
        let mut held = self.spare.pop().unwrap_or_else(|| HeldBlock {
            place,
            modals: block.modals,
            complete: true,
            is_cycle: false,
            ops: Vec::new(),
            used_variables: Vec::new(),
        });
        held.ops.clear();
        held.ops.append(&mut block.ops);
        (held.place, held.modals) = (BlockPlace { location: block.location, ..place }, block.modals);
        (held.complete, held.is_cycle) = (block.complete, block.is_cycle);
        std::mem::swap(&mut held.used_variables, &mut block.used_variables);
        held
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
