//! The programs of the programs folder, read and split into lines before the core gets them.

use std::sync::Arc;

use ropey::Rope;

use crate::defs::kind::Kind;
use crate::defs::program_kind;
use crate::nc::program_uses::UnitUse;
use crate::nc::{Library, Source, lines_before_number};

/// Most programs that are followed from a program to those that it calls.
const MAX_CALLED: usize = 32;

/// All programs; replaced as a whole when the folder changes.
#[derive(Clone, Debug, Default)]
pub struct Programs {
    rows: Vec<StoredProgram>,
    /// What each of them starts, with those that it calls: asked for in each tick.
    started: Vec<StartedUnits>,
    duplicates: Vec<DuplicateNumber>,
}

/// A number that several programs have: in doubt none of them is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DuplicateNumber {
    /// The number.
    pub number: u32,
    /// File, and line of its first line from 1, of each program.
    pub places: Vec<(String, u32)>,
    /// The places as a message names them.
    pub text: String,
}

impl DuplicateNumber {
    fn of(programs: &[StoredProgram]) -> Self {
        let places: Vec<_> = programs.iter().map(StoredProgram::place).collect();
        // A file may begin with `%` and comments.
        let number_line = |(place, program): (&(String, u32), &StoredProgram)| {
            let before = lines_before_number(program.source.bytes(), program.source.dialect());
            (place.0.clone(), place.1 + before)
        };
        let numbers = places.iter().zip(programs).map(number_line);
        let text: Vec<_> = numbers.map(|(file, line)| format!("{file}:{line}")).collect();
        Self { number: programs.first().map_or(0, |program| program.number), places, text: text.join(", ") }
    }
}

/// The place of a program in a file that holds several.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilePart {
    /// The name of the file.
    pub file: String,
    /// The lines of the file before the program.
    pub lines_before: u32,
}

/// One program.
#[derive(Clone, Debug)]
pub struct StoredProgram {
    /// O number.
    pub number: u32,
    /// Source for the interpreter.
    pub source: Arc<Source>,
    /// Text for display; empty where a program is only executed.
    pub text: Rope,
    /// Checksum of the file.
    pub stamp: u64,
    /// The units that it starts, and what it calls.
    pub unit_use: UnitUse,
    /// The kinds of machine that it names; none: it is for every kind.
    pub kinds: Vec<Kind>,
    /// Some bytes are not valid characters: the program can be shown but not edited.
    pub has_invalid_bytes: bool,
    /// Its place, if its number is not that of its file.
    pub part: Option<FilePart>,
}

impl StoredProgram {
    /// Whether it is for a kind of machine.
    #[must_use]
    pub fn is_for(&self, kind: Kind) -> bool {
        program_kind::includes(&self.kinds, kind)
    }

    /// Its file, and the line of its first line from 1.
    #[must_use]
    pub fn place(&self) -> (String, u32) {
        match &self.part {
            Some(FilePart { file, lines_before }) => (file.clone(), lines_before + 1),
            None => (self.source.name().to_owned(), 1),
        }
    }
}

impl Programs {
    /// Builds the list. Of two programs with the same number the one with a file of its own is shown, else the first;
    /// neither is called.
    #[must_use]
    pub fn new(mut rows: Vec<StoredProgram>) -> Self {
        rows.sort_by_key(|row| (row.number, row.part.is_some()));
        let same = rows.chunk_by(|one, next| one.number == next.number).filter(|group| group.len() > 1);
        let duplicates = same.map(DuplicateNumber::of).collect();
        rows.dedup_by_key(|row| row.number);
        Self { rows, started: Vec::new(), duplicates }.with_started_units()
    }

    fn with_started_units(mut self) -> Self {
        self.started = self.rows.iter().map(|row| self.follow_calls(row.number)).collect();
        self
    }

    /// Adds programs; a program with an existing number replaces the old one. Of two of them with the same number
    /// neither is called.
    pub fn replace(&mut self, programs: Vec<StoredProgram>) {
        let Self { rows: programs, duplicates, .. } = Self::new(programs);
        let is_replaced = |number: u32| programs.iter().any(|program| program.number == number);
        self.rows.retain(|row| !is_replaced(row.number));
        self.duplicates.retain(|twice| !is_replaced(twice.number));
        self.duplicates.extend(duplicates);
        self.rows.extend(programs);
        self.rows.sort_by_key(|row| row.number);
        *self = std::mem::take(self).with_started_units();
    }

    /// Whether a program is among these.
    #[must_use]
    pub fn holds(&self, program: &StoredProgram) -> bool {
        let (number, place) = (program.number, program.place());
        // A file of the same name elsewhere has another text.
        let is_same = |own: &StoredProgram| own.place() == place && own.stamp == program.stamp;
        let alone = self.get(number).is_some_and(is_same);
        alone || self.duplicates.iter().any(|twice| twice.number == number && twice.places.contains(&place))
    }

    /// The numbers that several programs have.
    #[must_use]
    pub fn duplicates(&self) -> &[DuplicateNumber] {
        &self.duplicates
    }

    /// All of them, by number.
    pub fn iter(&self) -> impl Iterator<Item = &StoredProgram> {
        self.rows.iter()
    }

    /// The program with a number.
    #[must_use]
    pub fn get(&self, number: u32) -> Option<&StoredProgram> {
        self.rows.get(self.index(number)?)
    }

    fn index(&self, number: u32) -> Option<usize> {
        self.rows.binary_search_by_key(&number, |row| row.number).ok()
    }

    /// The units that a program or one that it calls starts (K3.4, K3.7). With more than [`MAX_CALLED`] programs they
    /// count as started. What a program computes (M#1, P#2) is not found: the interlock stops it at its M code.
    #[must_use]
    pub fn started_units(&self, number: u32) -> StartedUnits {
        self.index(number).and_then(|index| self.started.get(index)).copied().unwrap_or_default()
    }

    fn follow_calls(&self, number: u32) -> StartedUnits {
        let (mut seen, mut count, mut next) = ([number; MAX_CALLED], 1, 0);
        let mut found = StartedUnits::default();
        while next < count {
            if let Some(program) = self.get(seen[next]) {
                found.wheel |= program.unit_use.starts_wheel;
                found.work_drive |= program.unit_use.starts_work_drive;
                for called in &program.unit_use.calls {
                    if !seen[..count].contains(called) {
                        let Some(free) = seen.get_mut(count) else {
                            return StartedUnits { wheel: true, work_drive: true };
                        };
                        (*free, count) = (*called, count + 1);
                    }
                }
            }
            next += 1;
        }
        found
    }
}

/// The units that a program starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StartedUnits {
    /// The wheel.
    pub wheel: bool,
    /// Headstock, roll or table.
    pub work_drive: bool,
}

impl Library for Programs {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        self.get(number).map(|row| Arc::clone(&row.source))
    }

    fn places_of_duplicate(&self, number: u32) -> Option<&str> {
        self.duplicates.iter().find(|twice| twice.number == number).map(|twice| twice.text.as_str())
    }
}
