//! Earlier states of the retained data, in `generations/`, one file each, with the number of their commit. When the
//! database is damaged or gone, the newest whole one takes its place. Source: spec K4.2, B6; safety stance.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use super::{Generation, RetainedData};
use crate::store::disk;
use crate::store::io_fault::IoFault;
use crate::store::ron_file::{self, ChecksumPolicy, RonError};

const FOLDER: &str = "generations";
const PREFIX: &str = "retained-";
const EXTENSION: &str = ".ron";
/// The newest states that are kept, and before them the last one of each day, of so many days.
const NEWEST: usize = 4;
const DAYS: usize = 7;
const SECONDS_PER_DAY: u64 = 86_400;

/// A kept state.
struct GenerationFile {
    number: u64,
    path: PathBuf,
    /// Days since 1970 of its last change.
    day: u64,
}

/// Keeps a state, unless it is kept already, and deletes the oldest ones.
///
/// # Errors
/// A disk error; the other states stay.
pub fn keep(folder: &Path, data: &RetainedData) -> Result<(), RonError> {
    let number = data.generation.0;
    let kept = list(folder);
    if kept.iter().any(|file| file.number == number) {
        return Ok(());
    }
    let generations = folder.join(FOLDER);
    disk::create_folders(&generations).map_err(IoFault::at(&generations, "create"))?;
    let path = generations.join(format!("{PREFIX}{number:010}{EXTENSION}"));
    ron_file::write(&path, ChecksumPolicy::Strict, data)?;
    for path in superfluous(&list(folder)) {
        disk::remove(path).map_err(IoFault::at(path, "delete"))?;
    }
    Ok(())
}

/// The highest number of a kept state, whole or not.
#[must_use]
pub fn highest(folder: &Path) -> Option<Generation> {
    list(folder).first().map(|file| Generation(file.number))
}

/// The newest state that is whole, and its file.
#[must_use]
pub fn newest_whole(folder: &Path) -> Option<(PathBuf, RetainedData)> {
    let whole = |file: GenerationFile| {
        let read = ron_file::read::<RetainedData>(&file.path, ChecksumPolicy::Strict).ok()?;
        Some((file.path, read.value))
    };
    list(folder).into_iter().find_map(whole)
}

/// Numbers of commits are below: a thousand a second for thirty years. A file with another one is none of ours.
const MAX_NUMBER: u64 = 1_000_000_000_000;

/// The kept states, the newest first.
fn list(folder: &Path) -> Vec<GenerationFile> {
    let entries = fs::read_dir(folder.join(FOLDER)).into_iter().flatten().flatten();
    let mut found: Vec<GenerationFile> = entries
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            let number = name.strip_prefix(PREFIX)?.strip_suffix(EXTENSION)?.parse().ok()?;
            if number > MAX_NUMBER {
                return None;
            }
            let modified = entry.metadata().ok()?.modified().unwrap_or(SystemTime::UNIX_EPOCH);
            let day = modified.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs() / SECONDS_PER_DAY;
            Some(GenerationFile { number, path: entry.path(), day })
        })
        .collect();
    found.sort_by_key(|file| std::cmp::Reverse(file.number));
    found
}

/// The files to delete: neither among the newest nor the last of one of the last days.
fn superfluous(files: &[GenerationFile]) -> Vec<&Path> {
    let (mut days, mut old) = (Vec::new(), Vec::new());
    for (index, file) in files.iter().enumerate() {
        let is_last_of_day = !days.contains(&file.day);
        if is_last_of_day {
            days.push(file.day);
        }
        if index >= NEWEST && (!is_last_of_day || days.len() > DAYS) {
            old.push(file.path.as_path());
        }
    }
    old
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_and_the_last_of_each_day_stay() {
        let file = |number: u64, day: u64| GenerationFile { number, path: number.to_string().into(), day };
        // Newest first: six of day 10, two of day 9, one of each day before.
        let mut files: Vec<_> = (20..26).rev().map(|number| file(number, 10)).collect();
        files.extend([file(19, 9), file(18, 9)]);
        files.extend((10..18).rev().map(|number| file(number, number - 9)));
        let gone: Vec<u64> = superfluous(&files).iter().map(|path| path.to_string_lossy().parse().unwrap()).collect();
        // Days 10, 9, 8, 7, 6, 5, 4: their last ones are 25, 19, 17, 16, 15, 14, 13.
        assert_eq!(gone, [21, 20, 18, 12, 11, 10]);
    }
}
