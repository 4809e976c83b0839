//! Earlier states of the retained data, in `generations/`, one file each, with the number of their commit. When the
//! database is damaged or gone, the newest whole one takes its place. Source: spec K4.2, B6; safety stance.

use std::fs;
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use super::{RetainedData, is_own, own_identity};
use crate::store::disk;
use crate::store::io_fault::IoFault;
use crate::store::ron_file::{self, ChecksumPolicy, RonError};

const FOLDER: &str = "generations";
const PREFIX: &str = "retained-";
const EXTENSION: &str = ".ron";
/// The newest states that are kept.
const NEWEST: usize = 4;
/// Before them the last one of each hour and of each day: length, s, and how many.
const SPANS: [(u64, usize); 2] = [(3_600, 4), (86_400, 7)];

/// A kept state.
struct GenerationFile {
    number: u64,
    path: PathBuf,
    /// Seconds since 1970 of its last change.
    seconds: u64,
}

/// Keeps a state, unless it is kept already, and deletes the oldest ones.
///
/// # Errors
/// A disk error; the other states stay.
pub fn keep(folder: &Path, data: &RetainedData) -> Result<(), RonError> {
    let number = data.generation.0;
    // What has a higher number is none of these data.
    let own = |folder: &Path| -> Vec<GenerationFile> {
        list(folder).into_iter().filter(|file| file.number <= number).collect()
    };
    let kept = own(folder);
    if kept.iter().any(|file| file.number == number) {
        return Ok(());
    }
    let generations = folder.join(FOLDER);
    disk::create_folders(&generations).map_err(IoFault::at(&generations, "create"))?;
    let path = generations.join(format!("{PREFIX}{number:010}{EXTENSION}"));
    ron_file::write(&path, ChecksumPolicy::Strict, data)?;
    for path in superfluous(&own(folder)) {
        disk::remove(path).map_err(IoFault::at(path, "delete"))?;
    }
    Ok(())
}

/// Whether there is a kept state, whole or not.
#[must_use]
pub fn has_any(folder: &Path) -> bool {
    !list(folder).is_empty()
}

/// The newest state that is whole, with the time of its file.
#[must_use]
pub(super) fn newest_whole(folder: &Path) -> Option<(Option<SystemTime>, RetainedData)> {
    let own = own_identity(folder);
    list(folder).into_iter().find_map(|file| read(&file, own).map(|data| (modified(&file.path), data)))
}

/// The machine whose data the newest state is that says so.
pub(super) fn identity(folder: &Path) -> Option<NonZeroU64> {
    list(folder).iter().find_map(|file| read(file, None)?.identity)
}

/// The kept states that are whole, the newest first, with the time of their file.
#[must_use]
pub fn whole(folder: &Path) -> Vec<(Option<SystemTime>, RetainedData)> {
    let own = own_identity(folder);
    list(folder).iter().filter_map(|file| Some((modified(&file.path), read(file, own)?))).collect()
}

/// The kept state with a number, if it is whole, with the time of its file.
#[must_use]
pub fn find(folder: &Path, number: u64) -> Option<(Option<SystemTime>, RetainedData)> {
    let files = list(folder);
    let file = files.iter().find(|file| file.number == number)?;
    Some((modified(&file.path), read(file, own_identity(folder))?))
}

fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().ok().as_ref().and_then(disk::modified)
}

/// A kept state, if it is whole and not that of another machine.
fn read(file: &GenerationFile, own: Option<NonZeroU64>) -> Option<RetainedData> {
    let found = ron_file::read::<RetainedData>(&file.path, ChecksumPolicy::Strict).ok()?.value;
    is_own(own, &found).then_some(found)
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
            let modified = disk::modified(&entry.metadata().ok()?).unwrap_or(UNIX_EPOCH);
            let seconds = modified.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
            Some(GenerationFile { number, path: entry.path(), seconds })
        })
        .collect();
    found.sort_by_key(|file| std::cmp::Reverse(file.number));
    found
}

/// The files to delete: neither among the newest nor the last of one of the last hours or days.
fn superfluous(files: &[GenerationFile]) -> Vec<&Path> {
    let mut seen: [Vec<u64>; SPANS.len()] = Default::default();
    let mut old = Vec::new();
    for (index, file) in files.iter().enumerate() {
        let mut is_kept = index < NEWEST;
        for (seen, (span, most)) in seen.iter_mut().zip(SPANS) {
            let of_file = file.seconds / span;
            if seen.len() < most && !seen.contains(&of_file) {
                seen.push(of_file);
                is_kept = true;
            }
        }
        if !is_kept {
            old.push(file.path.as_path());
        }
    }
    old
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_and_the_last_of_each_hour_and_day_stay() {
        let file = |number: u64, seconds: u64| GenerationFile { number, path: number.to_string().into(), seconds };
        let (day, hour, minute) = (86_400, 3_600, 60);
        // The newest first, at 20:50 of day 10: one a minute for two hours, then two a day.
        let mut files: Vec<_> =
            (0..120).map(|k| file(1_000 - k, 10 * day + 20 * hour + 50 * minute - k * minute)).collect();
        files.extend((0..20).map(|k| file(800 - k, 9 * day + 12 * hour - k * day / 2)));
        let gone = superfluous(&files);
        let kept: Vec<u64> =
            files.iter().filter(|file| !gone.contains(&file.path.as_path())).map(|file| file.number).collect();
        // Four newest; of the hours 20 the newest one, 19 the last (19:59, 51 minutes before), 18 (18:59, 111), then hour 12
        // of day 9, which is the last of that day, too; days 8 to 4 each with its 12:00, of two a day.
        assert_eq!(kept, [1_000, 999, 998, 997, 1_000 - 51, 1_000 - 111, 800, 798, 796, 794, 792, 790]);
    }
}
