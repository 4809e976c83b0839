//! A block that was read: its operations and the modal state after it.

use super::fault::BlockLocation;
use super::modal::ModalState;
use super::op::Op;
use super::settings::NcSettings;

/// Operations of a block for which memory is taken at once: a roughing cycle of 250 strokes. A longer one takes more.
pub const USUAL_OPS: usize = 1_024;

/// Where a block is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BlockPlace {
    pub location: BlockLocation,
    /// Its first byte.
    pub at: usize,
}

/// A block that was read.
#[derive(Clone, Debug)]
pub struct Block {
    /// Where the block is in the program.
    pub location: BlockLocation,
    /// Its operations, in order.
    pub ops: Vec<Op>,
    /// The modal state after the block.
    pub modals: ModalState,
    /// Whether this ends the block: single block stops here. A block that changes the work offset or tool and also
    /// moves is returned in two parts.
    pub complete: bool,
    /// A cycle over a contour: it has compensated its moves by itself.
    pub is_cycle: bool,
    /// The variables that its words were calculated from; only a check fills it.
    pub used_variables: Vec<u32>,
}

impl Block {
    /// An empty block. `Interpreter::next` fills it again for every block.
    #[must_use]
    pub fn new(settings: &NcSettings) -> Self {
        Self {
            location: BlockLocation::default(),
            ops: Vec::with_capacity(USUAL_OPS),
            modals: ModalState::new(settings),
            complete: true,
            is_cycle: false,
            used_variables: Vec::new(),
        }
    }

    /// An empty block of another program, in the same memory.
    pub fn restart(&mut self, modals: ModalState) {
        self.clear();
        (self.location, self.modals) = (BlockLocation::default(), modals);
    }

    pub(super) fn clear(&mut self) {
        self.ops.clear();
        self.used_variables.clear();
        (self.complete, self.is_cycle) = (true, false);
    }
}
