//! A history of limited length: the newest entries of a machine, shared by core and screen. Retained data.

use std::ops::Deref;
use std::sync::Arc;

/// An entry of a history.
pub trait HistoryEntry: Clone {
    /// Most entries; a new one replaces the oldest.
    const CAPACITY: usize;

    /// Serial number on this machine, from 1.
    fn count(&self) -> u64;

    /// Slot in the retained store: a new entry reuses the slot of the entry it replaces.
    fn slot(&self) -> u16 {
        (self.count() % Self::CAPACITY as u64) as u16
    }
}

/// The entries, latest last.
#[derive(Clone, Debug)]
pub struct History<T> {
    /// Shared by the copies that the screen keeps.
    entries: Arc<Vec<T>>,
    version: u64,
}

impl<T: HistoryEntry> History<T> {
    /// The history with these entries, oldest first, in the memory of a full one. Its versions begin at this one: no
    /// earlier history of the machine may have had it.
    #[must_use]
    pub fn new(remembered: impl IntoIterator<Item = T>, version: u64) -> Self {
        let mut entries = Vec::with_capacity(T::CAPACITY);
        entries.extend(remembered);
        Self { entries: Arc::new(entries), version }
    }

    /// Counts the changes.
    #[must_use]
    pub const fn version(&self) -> u64 {
        self.version
    }

    /// Appends an entry; the oldest goes if the history is full.
    pub fn push(&mut self, entry: T) {
        if self.entries.len() >= T::CAPACITY {
            self.entries_mut().remove(0);
        }
        self.entries_mut().push(entry);
    }

    /// The entries, to change them.
    pub fn entries_mut(&mut self) -> &mut Vec<T> {
        self.version += 1;
        Arc::make_mut(&mut self.entries)
    }

    /// Takes over the entries of another history if they have changed: in place, unless they are shared.
    pub fn copy_from(&mut self, newest: &Self) {
        if self.version != newest.version {
            match Arc::get_mut(&mut self.entries) {
                Some(entries) => entries.clone_from(&newest.entries),
                None => self.entries = Arc::new(newest.to_vec()),
            }
            self.version = newest.version;
        }
    }
}

impl<T: HistoryEntry> Default for History<T> {
    /// Empty and older than any other.
    fn default() -> Self {
        Self::new([], 0)
    }
}

impl<T> Deref for History<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.entries
    }
}
