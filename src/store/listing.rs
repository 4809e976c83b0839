//! Lists a folder: the files of a class by number, and why other files are ignored.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;
use std::time::SystemTime;

use encoding_rs::GBK;

use super::atomic_file::is_temporary;
use super::file_class::{CommentSource, FileClass, PAGE_FILES};
use super::io_fault::IoFault;

/// Maximum number of files read in a folder; the next one is reported as ignored.
pub const LISTING_LIMIT: usize = 20_000;
/// Bytes of a file that are searched for its comment line.
const HEAD_LIMIT: u64 = 2048;
/// Maximum length of a comment line, characters.
const COMMENT_LIMIT: usize = 80;

/// A file of a class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FolderEntry {
    /// The number in its name.
    pub number: u32,
    /// Its name on the disk.
    pub name: String,
    /// Its size, in bytes.
    pub size: u64,
    /// Time of the last change by the computer's clock; `None` if unknown.
    pub modified: Option<SystemTime>,
    /// The comment line; empty when there is none.
    pub comment: String,
}

/// A file that is not used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgnoredFile {
    /// Its name.
    pub name: String,
    /// The reason, for the operator.
    pub reason: String,
}

/// The files of one class in a folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FolderListing {
    /// Sorted by number.
    pub entries: Vec<FolderEntry>,
    /// Sorted by name; without files of other letters.
    pub ignored: Vec<IgnoredFile>,
}

/// A file with a valid name, before its content is read.
pub(super) struct Candidate {
    pub(super) name: String,
    rank: usize,
    pub(super) metadata: fs::Metadata,
}

/// The files of a class by number, without comments, and the ignored files.
pub(super) fn scan(folder: &Path, class: &FileClass) -> Result<(BTreeMap<u32, Candidate>, Vec<IgnoredFile>), IoFault> {
    let mut found: BTreeMap<u32, Candidate> = BTreeMap::new();
    let mut ignored = Vec::new();
    for (looked_at, entry) in fs::read_dir(folder).map_err(IoFault::at(folder, "list"))?.enumerate() {
        let entry = entry.map_err(IoFault::at(folder, "list"))?;
        let Ok(name) = entry.file_name().into_string() else { continue };
        if looked_at >= LISTING_LIMIT {
            ignored.push(IgnoredFile { name, reason: format!("more than {LISTING_LIMIT} files in the folder") });
            break;
        }
        let Some((number, rank)) = class.parse(&name) else {
            ignored.extend(misnamed_file(class, name));
            continue;
        };
        // It may have been deleted since the folder was opened.
        let Ok(metadata) = entry.metadata() else { continue };
        if !metadata.is_file() {
            let reason = "a link, folder or device: only regular files are listed".to_owned();
            ignored.push(IgnoredFile { name, reason });
            continue;
        }
        let candidate = Candidate { name, rank, metadata };
        let Some(rival) = found.remove(&number) else {
            found.insert(number, candidate);
            continue;
        };
        let (winner, loser) = rank_candidates(rival, candidate);
        ignored.push(IgnoredFile { name: loser.name, reason: format!("{} is used instead", winner.name) });
        found.insert(number, winner);
    }
    ignored.sort_by(|a, b| a.name.cmp(&b.name));
    Ok((found, ignored))
}

/// Orders two files of the same number: by rank of the extension, then upper case before lower case.
fn rank_candidates(one: Candidate, other: Candidate) -> (Candidate, Candidate) {
    if (one.rank, &one.name) <= (other.rank, &other.name) { (one, other) } else { (other, one) }
}

/// A file with letter and extension of the class but without a number of four digits.
fn misnamed_file(class: &FileClass, name: String) -> Option<IgnoredFile> {
    let extension = name.rsplit_once('.').map(|(_, extension)| extension)?;
    let known = class.extensions.iter().any(|known| known.eq_ignore_ascii_case(extension));
    let lettered = name.chars().next().is_some_and(|first| first.eq_ignore_ascii_case(&class.letter));
    let other = PAGE_FILES.iter().any(|class| class.parse(&name).is_some());
    (known && lettered && !other && !is_temporary(&name))
        .then(|| IgnoredFile { reason: format!("rename it like {}", class.file_name(1001)), name })
}

/// The files of a class with size, time and comment line.
pub(super) fn list(folder: &Path, class: &FileClass) -> Result<FolderListing, IoFault> {
    let (found, ignored) = scan(folder, class)?;
    let entries = found.into_iter().map(|(number, found)| folder_entry(folder, class, number, found)).collect();
    Ok(FolderListing { entries, ignored })
}

/// The entry of a file; reads its comment line.
pub(super) fn folder_entry(folder: &Path, class: &FileClass, number: u32, found: Candidate) -> FolderEntry {
    let head = match class.comment_source {
        CommentSource::None => String::new(),
        // An unreadable file has no comment; reading it later reports the error.
        CommentSource::FirstComment | CommentSource::Title => read_head(&folder.join(&found.name)).unwrap_or_default(),
    };
    let (size, modified) = (found.metadata.len(), found.metadata.modified().ok());
    FolderEntry { number, name: found.name, size, modified, comment: shown_comment(&class.comment_in(&head)) }
}

/// A comment as the directory shows it.
pub(super) fn shown_comment(comment: &str) -> String {
    comment.chars().filter(|c| !c.is_control()).take(COMMENT_LIMIT).collect()
}

/// The start of a file as text; invalid bytes show as `�`.
pub(super) fn read_head(path: &Path) -> Option<String> {
    let mut bytes = Vec::new();
    File::open(path).ok()?.take(HEAD_LIMIT).read_to_end(&mut bytes).ok()?;
    // An incomplete character at the end does not make the file GBK.
    if std::str::from_utf8(&bytes).err().is_none_or(|wrong| wrong.error_len().is_none()) {
        return Some(String::from_utf8_lossy(&bytes).trim_start_matches('\u{FEFF}').to_owned());
    }
    let (text, _) = GBK.decode_without_bom_handling(&bytes);
    Some(text.into_owned())
}
