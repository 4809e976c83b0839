//! The programs of the programs folder, read and split into lines before the core gets them.

use std::sync::Arc;

use ropey::Rope;

use crate::nc::{Library, Source};

/// All programs; replaced as a whole when the folder changes.
#[derive(Clone, Debug, Default)]
pub struct Programs {
    rows: Vec<StoredProgram>,
}

/// One program.
#[derive(Clone, Debug)]
pub struct StoredProgram {
    /// O number.
    pub number: u32,
    /// Source for the interpreter.
    pub source: Arc<Source>,
    /// Text for display.
    pub text: Rope,
    /// Checksum of the file.
    pub stamp: u64,
    /// Some bytes are not valid characters: the program can be shown but not edited.
    pub has_invalid_bytes: bool,
}

impl Programs {
    /// Builds the list; of two programs with the same number the first counts.
    #[must_use]
    pub fn new(mut rows: Vec<StoredProgram>) -> Self {
        rows.sort_by_key(|row| row.number);
        rows.dedup_by_key(|row| row.number);
        Self { rows }
    }

    /// Adds programs; a program with an existing number replaces the old one.
    pub fn replace(&mut self, programs: Vec<StoredProgram>) {
        self.rows.retain(|row| programs.iter().all(|program| program.number != row.number));
        self.rows.extend(programs);
        self.rows.sort_by_key(|row| row.number);
    }

    /// All of them, by number.
    pub fn iter(&self) -> impl Iterator<Item = &StoredProgram> {
        self.rows.iter()
    }

    /// The program with a number.
    #[must_use]
    pub fn get(&self, number: u32) -> Option<&StoredProgram> {
        self.rows.binary_search_by_key(&number, |row| row.number).ok().and_then(|index| self.rows.get(index))
    }
}

impl Library for Programs {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        self.get(number).map(|row| Arc::clone(&row.source))
    }
}
