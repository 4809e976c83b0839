//! The passes of a loop in which nothing changes: only the machine or the operator can end it. Source: spec B3.

use super::modal::ModalState;

/// The jumps back to the same block in which no block has changed anything.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct IdlePasses {
    pub count: u32,
    /// Something has changed since the last jump back.
    pub changed: bool,
    /// The byte of its target.
    target: usize,
    /// The modal state there: a pass may change F alone.
    modals: Option<ModalState>,
}

impl IdlePasses {
    pub fn note_jump_back(&mut self, target: usize, modals: &ModalState) {
        self.changed |= self.modals.replace(*modals) != Some(*modals);
        let same = !std::mem::take(&mut self.changed) && self.target == target;
        self.count = if same { self.count + 1 } else { 0 };
        self.target = target;
    }
}
