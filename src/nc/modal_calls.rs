//! The macros of G66: after a move the last one is called; its own moves call the one before it. Source: spec B3.

use super::expression::Locals;

/// A G66 macro: called after every block with motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModalCall {
    pub program: u32,
    pub times: u32,
}

#[derive(Clone, Debug)]
struct ModalEntry {
    call: ModalCall,
    arguments: Locals,
    /// The entry that acts while this macro runs, and again behind its G67.
    before: Option<usize>,
}

/// What acted before a macro was called.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModalMark {
    entries: usize,
    active: Option<usize>,
}

/// The G66 calls that no G67 has ended.
#[derive(Clone, Debug, Default)]
pub(crate) struct ModalCalls {
    entries: Vec<ModalEntry>,
    active: Option<usize>,
}

impl ModalCalls {
    /// With memory for calls of this depth.
    pub fn with_capacity(depth: usize) -> Self {
        Self { entries: Vec::with_capacity(depth), active: None }
    }

    /// Ends all calls; keeps the memory.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.active = None;
    }

    /// Takes over the calls of another list, in the memory of this one.
    pub fn copy_from(&mut self, other: &Self) {
        self.entries.clone_from(&other.entries);
        self.active = other.active;
    }

    /// Whether a macro is called after a move.
    #[inline]
    pub const fn is_active(&self) -> bool {
        self.active.is_some()
    }

    /// The macro that is called after a move, with its arguments.
    #[inline]
    pub fn active(&self) -> Option<(ModalCall, &Locals)> {
        self.active.and_then(|index| self.entries.get(index)).map(|entry| (entry.call, &entry.arguments))
    }

    /// How many calls act, one inside the other.
    pub fn depth(&self) -> usize {
        std::iter::successors(self.active, |index| self.entries.get(*index)?.before).count()
    }

    /// G66.
    pub fn push(&mut self, call: ModalCall, arguments: &Locals) {
        let before = self.active;
        self.active = Some(self.entries.len());
        self.entries.push(ModalEntry { call, arguments: *arguments, before });
    }

    /// G67: ends the last call.
    pub fn pop(&mut self) {
        let Some(index) = self.active else { return };
        self.active = self.entries.get(index).and_then(|entry| entry.before);
        if index + 1 == self.entries.len() {
            self.entries.pop();
        }
    }

    /// The active macro runs: its moves call the one before.
    pub fn enter(&mut self) -> ModalMark {
        let mark = ModalMark { entries: self.entries.len(), active: self.active };
        self.active = self.active.and_then(|index| self.entries.get(index)?.before);
        mark
    }

    /// How many were begun and not ended.
    pub fn count(&self) -> usize {
        self.entries.len()
    }

    /// A macro that G65 has called has returned: what it began ends. What it ended stays so.
    pub fn end_since(&mut self, count: usize) {
        while let Some(index) = self.active.filter(|index| *index >= count) {
            self.active = self.entries.get(index).and_then(|entry| entry.before);
        }
        self.entries.truncate(count);
    }

    /// The macro has returned: what it began ends.
    pub fn leave(&mut self, mark: ModalMark) {
        self.entries.truncate(mark.entries);
        self.active = mark.active;
    }
}
