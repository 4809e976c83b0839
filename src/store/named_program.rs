//! Programs with names: `VGRIND.MPF`, `L10.SPF`, `L10` without extension, or `EXPORT.NC`. Source: spec B1, S1.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

use super::file_class::{PROGRAM, first_comment};
use super::io_fault::IoFault;
use super::listing::{LISTING_LIMIT, read_head, shown_comment};

/// Extensions of main programs and subprograms, and of what other controls export.
const EXTENSIONS: [&str; 3] = ["MPF", "SPF", "NC"];
/// The longest name, in characters.
const NAME_LIMIT: usize = 24;

/// A program with a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedProgram {
    /// The name used in calls, upper case.
    pub stem: String,
    /// Its name on the disk.
    pub name: String,
    /// Its size, in bytes.
    pub size: u64,
    /// Time of the last change; `None` if unknown.
    pub modified: Option<SystemTime>,
    /// The first comment of the file; empty if there is none.
    pub comment: String,
}

/// The name used in calls, upper case; `None` for files that are not named programs, such as `O1001.NC`.
#[must_use]
pub fn program_stem(name: &str) -> Option<String> {
    if PROGRAM.parse(name).is_some() {
        return None;
    }
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let known = |extension: &str| EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(extension));
    let stem = match name.rsplit_once('.') {
        Some((stem, extension)) => known(extension).then_some(stem)?,
        None => name.strip_prefix(['L', 'l']).filter(|rest| digits(rest)).map(|_| name)?,
    };
    let whole = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
    let good = (1..=NAME_LIMIT).contains(&stem.len()) && stem.bytes().all(whole);
    good.then(|| stem.to_ascii_uppercase())
}

/// Lists the named programs of a folder, sorted by name. Of two with the same stem the first file name is used.
///
/// # Errors
/// The folder cannot be listed.
pub fn list_named_programs(folder: &Path) -> Result<Vec<NamedProgram>, IoFault> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(IoFault::at(folder, "list"))?.take(LISTING_LIMIT) {
        let entry = entry.map_err(IoFault::at(folder, "list"))?;
        let Ok(name) = entry.file_name().into_string() else { continue };
        let Some(stem) = program_stem(&name) else { continue };
        // Deleted since the folder was opened, or not a regular file.
        let Some(metadata) = entry.metadata().ok().filter(fs::Metadata::is_file) else { continue };
        let comment = shown_comment(&first_comment(&read_head(&entry.path()).unwrap_or_default()));
        found.push(NamedProgram { stem, name, size: metadata.len(), modified: metadata.modified().ok(), comment });
    }
    found.sort_by(|a, b| (&a.stem, &a.name).cmp(&(&b.stem, &b.name)));
    found.dedup_by(|later, first| later.stem == first.stem);
    Ok(found)
}
