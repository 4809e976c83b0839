//! Files and lines of the programs of a check: a program may be one of several in a file.
//! Source: spec B1, T4.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::controller::{Programs, StoredProgram};
use crate::nc::ProgramFault;
use crate::store::{PROGRAM_LIMIT, read_regular_file, stamp};

/// A line of a file, from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileLine {
    /// The file as the call names it, or in its folder.
    pub file: String,
    pub line: u32,
}

/// Finds the files of the programs of a check.
pub struct ProgramPlaces {
    /// The checked program.
    number: u32,
    path: PathBuf,
    /// The folder of programs.
    folder: PathBuf,
    programs: Arc<Programs>,
}

impl ProgramPlaces {
    /// For the check of a program of this number and file.
    pub fn new((number, path): (u32, &Path), folder: &Path, programs: Arc<Programs>) -> Self {
        Self { number, path: path.to_owned(), folder: folder.to_owned(), programs }
    }

    /// The line of a file that a line of a program is.
    pub fn find(&self, program: u32, line: u32) -> FileLine {
        let own = || FileLine { file: self.path.display().to_string(), line };
        if program == self.number {
            return own();
        }
        let Some(program) = self.programs.get(program) else { return own() };
        let lines_before = program.part.as_ref().map_or(0, |part| part.lines_before);
        FileLine { file: self.file_of(program).display().to_string(), line: line + lines_before }
    }

    /// The name of a program that is not the checked one.
    pub fn title(&self, program: u32) -> Option<String> {
        let other = self.programs.get(program).filter(|_| program != self.number)?;
        Some(other.source.title())
    }

    /// The calls that led to a mistake, the last one first.
    pub fn calls(&self, fault: &ProgramFault) -> Vec<FileLine> {
        fault.calls.iter().map(|(program, line)| self.find(program, line)).collect()
    }

    fn file_of(&self, program: &StoredProgram) -> PathBuf {
        let name = program.part.as_ref().map_or_else(|| program.source.name(), |part| part.file.as_str());
        let (beside, in_folder) = (self.path.with_file_name(name), self.folder.join(name));
        // A named program beside the checked file comes before one of the same name in the folder.
        let is_beside = || {
            let is_it = |bytes: Vec<u8>| program.part.is_none() && stamp(&bytes) == program.stamp;
            read_regular_file(&beside, PROGRAM_LIMIT).is_ok_and(is_it)
        };
        if beside == self.path || !in_folder.is_file() || is_beside() { beside } else { in_folder }
    }
}
