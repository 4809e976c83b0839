//! The programs of the programs folder, read and split into lines before the core gets them.

use std::sync::Arc;

use ropey::Rope;

use crate::defs::kind::Kind;
use crate::defs::program_kind;
use crate::nc::program_uses::WheelUse;
use crate::nc::{Library, Source};

/// Most programs that are followed from a program to those that it calls.
const MAX_CALLED: usize = 32;

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
    /// Whether it starts the wheel, and what it calls.
    pub wheel_use: WheelUse,
    /// The kinds of machine that it names; none: it is for every kind.
    pub kinds: Vec<Kind>,
    /// Some bytes are not valid characters: the program can be shown but not edited.
    pub has_invalid_bytes: bool,
}

impl StoredProgram {
    /// Whether it is for a kind of machine.
    #[must_use]
    pub fn is_for(&self, kind: Kind) -> bool {
        program_kind::includes(&self.kinds, kind)
    }
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

    /// Whether a program or one that it calls starts the wheel (K3.7). With more than [`MAX_CALLED`] programs it counts
    /// as such. What a program computes (M#1, P#2) is not found: the interlock stops it at its M03.
    #[must_use]
    pub fn starts_wheel(&self, number: u32) -> bool {
        let (mut seen, mut count, mut next) = ([number; MAX_CALLED], 1, 0);
        while next < count {
            if let Some(program) = self.get(seen[next]) {
                if program.wheel_use.starts_wheel {
                    return true;
                }
                for called in &program.wheel_use.calls {
                    if !seen[..count].contains(called) {
                        let Some(free) = seen.get_mut(count) else { return true };
                        (*free, count) = (*called, count + 1);
                    }
                }
            }
            next += 1;
        }
        false
    }
}

impl Library for Programs {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        self.get(number).map(|row| Arc::clone(&row.source))
    }
}
