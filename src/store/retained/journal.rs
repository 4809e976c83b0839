//! The retained data once more, in `retained.journal`: a state, and every commit after it. When the database is damaged or
//! gone, nothing is lost that was acknowledged; the kept states are older.
//!
//! Each line is a checksum and its text in RON. A commit is appended and flushed before it is acknowledged; a line that a
//! power cut has torn is that of a commit that nobody was told of. Source: spec K4.2, B6; safety stance.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Generation, RetainedChange, RetainedData, RetainedError};
use crate::store::atomic_file;
use crate::store::checksum::checksum;
use crate::store::disk;
use crate::store::io_fault::IoFault;

/// The file's name.
pub(super) const JOURNAL_FILE: &str = "retained.journal";
/// Length above which the journal begins anew with the present state: so many bytes, and so many states.
const USUAL_BYTES: u64 = 1024 * 1024;
const USUAL_STATES: u64 = 4;
/// Longest file that is read, bytes: a state has some hundred kilobytes.
const READ_LIMIT: u64 = 32 * 1024 * 1024;
/// Characters of a checksum before its text, with the blank between.
const SUM_LENGTH: usize = 17;

/// The open journal of a database.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    /// Its file and length, bytes. `None`: it does not go on from the state of the database, and begins anew.
    open: Option<(File, u64)>,
    /// Length of the state that it begins with, bytes.
    state_bytes: u64,
}

impl Journal {
    /// The journal in a folder. It goes on if it has led to these data, otherwise it begins anew with the next commit.
    pub fn open(folder: &Path, data: &RetainedData) -> Self {
        let path = folder.join(JOURNAL_FILE);
        let goes_on = read(folder).is_some_and(|found| found.is_whole && found.data == *data);
        let open = goes_on.then(|| open_file(&path).ok()).flatten();
        Self { path, open, state_bytes: 0 }
    }

    /// Whether it is to begin anew: it does not go on, or it is long.
    pub fn begins_anew(&self) -> bool {
        let most = USUAL_BYTES.max(USUAL_STATES * self.state_bytes);
        self.open.as_ref().is_none_or(|(_, length)| *length >= most)
    }

    /// Whether the file that is open is still there, with what was appended.
    pub fn is_present(&self) -> bool {
        let Some((file, length)) = &self.open else { return true };
        let is_same = super::identity(&self.path).is_some_and(|named| Some(named) == super::identity_of(file));
        is_same && file.metadata().is_ok_and(|metadata| metadata.len() == *length)
    }

    /// Appends a commit to a journal that goes on.
    ///
    /// # Errors
    /// A disk error; the next commit begins a new journal.
    pub fn append(&mut self, generation: Generation, changes: &[RetainedChange]) -> Result<(), RetainedError> {
        let Some((mut file, length)) = self.open.take() else { return Ok(()) };
        let record = line(&(generation, changes))?;
        disk::append(&mut file, &self.path, length, record.as_bytes()).map_err(IoFault::at(&self.path, "write"))?;
        self.open = Some((file, length + record.len() as u64));
        Ok(())
    }

    /// Begins anew with a state.
    ///
    /// # Errors
    /// A disk error.
    pub fn begin(&mut self, data: &RetainedData) -> Result<(), RetainedError> {
        self.open = None;
        let state = line(data)?;
        self.state_bytes = state.len() as u64;
        atomic_file::replace_private(&self.path, state.as_bytes())?;
        self.open = Some(open_file(&self.path)?);
        Ok(())
    }
}

/// What a journal leads to.
pub(super) struct Replayed {
    pub data: RetainedData,
    /// When its last commit was appended.
    pub modified: Option<SystemTime>,
    /// Every line was whole.
    pub is_whole: bool,
}

/// The data that the journal of a folder leads to, up to its first line that is not whole.
pub(super) fn read(folder: &Path) -> Option<Replayed> {
    let path = folder.join(JOURNAL_FILE);
    let bytes = atomic_file::read(&path, READ_LIMIT).ok()?;
    let mut lines = bytes.split_inclusive(|byte| *byte == b'\n');
    let mut data: RetainedData = parse(lines.next()?)?;
    let mut is_whole = true;
    for line in lines {
        let Some((generation, changes)) = parse::<(Generation, Vec<RetainedChange>)>(line) else {
            is_whole = false;
            break;
        };
        changes.into_iter().for_each(|change| data.apply(change));
        data.generation = generation;
    }
    let modified = path.metadata().ok().as_ref().and_then(disk::modified);
    Some(Replayed { data, modified, is_whole })
}

fn open_file(path: &Path) -> Result<(File, u64), IoFault> {
    let file = OpenOptions::new().write(true).open(path).map_err(IoFault::at(path, "open"))?;
    let length = file.metadata().map_err(IoFault::at(path, "open"))?.len();
    Ok((file, length))
}

/// A line with its checksum.
fn line(value: &impl Serialize) -> Result<String, RetainedError> {
    let text = ron::to_string(value).map_err(|wrong| RetainedError::Copy(wrong.to_string()))?;
    Ok(format!("{:016x} {text}\n", checksum(text.as_bytes())))
}

/// What a line holds, if it is whole.
fn parse<T: DeserializeOwned>(line: &[u8]) -> Option<T> {
    let line = std::str::from_utf8(line.strip_suffix(b"\n")?).ok()?;
    let (sum, text) = (line.get(..SUM_LENGTH)?, line.get(SUM_LENGTH..)?);
    let stated = u64::from_str_radix(sum.strip_suffix(' ')?, 16).ok()?;
    (stated == checksum(text.as_bytes())).then(|| ron::from_str(text).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variable(value: f64) -> [RetainedChange; 1] {
        [RetainedChange::Variable { number: 500, value: Some(value) }]
    }

    #[test]
    fn b6_a_journal_goes_on_only_from_the_state_that_it_leads_to() {
        let folder = tempfile::tempdir().expect("a folder");
        let data = RetainedData::default();
        let mut journal = Journal::open(folder.path(), &data);
        assert!(journal.begins_anew());
        journal.begin(&data).expect("written");
        journal.append(Generation(1), &variable(1.5)).expect("written");
        journal.append(Generation(2), &variable(-0.1)).expect("written");
        let led = read(folder.path()).expect("a state").data;
        assert_eq!((led.generation, led.variables[&500]), (Generation(2), -0.1));
        assert!(!Journal::open(folder.path(), &led).begins_anew());
        assert!(Journal::open(folder.path(), &data).begins_anew(), "the database is another one");
    }

    #[test]
    fn b6_a_torn_or_flipped_line_ends_the_journal() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut journal = Journal::open(folder.path(), &RetainedData::default());
        journal.begin(&RetainedData::default()).expect("written");
        for number in 1..=3 {
            journal.append(Generation(number), &variable(number as f64)).expect("written");
        }
        let path = folder.path().join(JOURNAL_FILE);
        let whole = std::fs::read(&path).expect("read");
        let ends: Vec<usize> = (0..whole.len()).filter(|at| whole[*at] == b'\n').collect();
        for cut in 0..=whole.len() {
            std::fs::write(&path, &whole[..cut]).expect("written");
            let led = read(folder.path()).map(|found| found.data.generation.0);
            // The line ends before the cut, without that of the state.
            let lines = ends.iter().filter(|end| **end < cut).count();
            assert_eq!(led, (lines as u64).checked_sub(1), "cut at {cut}");
        }
        for bit in 0..whole.len() * 8 {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            std::fs::write(&path, &bytes).expect("written");
            let lines = ends.iter().filter(|end| **end < bit / 8).count() as u64;
            let led = read(folder.path()).map(|found| found.data.generation.0);
            // An upper-case digit of a checksum is the same checksum.
            assert!(led == lines.checked_sub(1) || led == Some(3), "bit {bit}: {led:?}, {lines} lines before");
        }
    }
}
