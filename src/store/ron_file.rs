//! RON files that people read, edit and copy: settings, backups of parameters and variables, part files.
//!
//! The last line is a comment with the checksum of the text before it. The previous version is kept as `NAME.bak`.
//! A file edited by hand is accepted with a warning for [`ChecksumPolicy::Lenient`] and refused for [`ChecksumPolicy::Strict`].
//! An unreadable file is never replaced silently by defaults: the previous version is read, with a warning.

use std::path::{Path, PathBuf};

use ron::ser::PrettyConfig;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::atomic_file::{self, ReadError};
use super::checksum;
use super::disk;
use super::io_fault::IoFault;

/// Maximum size of a RON file, bytes.
pub const RON_LIMIT: u64 = 16 * 1024 * 1024;
/// Start of the checksum line; 16 hexadecimal digits and a line end follow.
const CHECKSUM_MARK: &str = "// checksum ";

/// How strictly the checksum is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChecksumPolicy {
    /// Edited by people: a missing or stale checksum is a warning.
    Lenient,
    /// Written by the control alone: a missing or stale checksum refuses the file.
    Strict,
}

/// A warning about a file that was read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RonWarning {
    /// Edited or written by hand.
    #[error("{}: no checksum; the file is damaged, or was edited by hand", .0.display())]
    NoChecksum(PathBuf),
    /// Edited by hand after the control wrote it.
    #[error("{}: the checksum does not fit; the file is damaged, or was edited by hand", .0.display())]
    StaleChecksum(PathBuf),
    /// The previous version was read instead.
    #[error("{cause}; the previous generation {} was used instead", .backup.display())]
    FromBackup {
        /// The file that was read.
        backup: PathBuf,
        /// What is wrong with the newer one.
        cause: String,
    },
}

impl RonWarning {
    /// Whether the file itself could not be read.
    #[must_use]
    pub const fn is_damage(&self) -> bool {
        matches!(self, Self::FromBackup { .. })
    }
}

/// A value and its warnings.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedFile<T> {
    /// The value.
    pub value: T,
    /// Empty if there is nothing to report.
    pub warnings: Vec<RonWarning>,
}

/// Why a RON file was not read or written.
#[derive(Debug, thiserror::Error)]
pub enum RonError {
    /// Neither the file nor its previous version exists.
    #[error("{}: not found; it is created when first saved", .0.display())]
    Missing(PathBuf),
    /// The text is not RON, or not of this type.
    #[error("{} line {line}, column {column}: {cause}; correct it there or restore a backup", .path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What is wrong.
        cause: String,
    },
    /// A missing or wrong checksum in a file that only the control writes.
    #[error("{}: {}; restore a backup", .0.display(), .1)]
    Checksum(PathBuf, &'static str),
    /// A link, folder or device, too large, or still being written.
    #[error("{}: {}; put a regular RON file there", .0.display(), .1)]
    NotReadable(PathBuf, String),
    /// A value that RON cannot express: a bug of the caller.
    #[error("{}: the value cannot be written as RON: {}", .0.display(), .1)]
    Value(PathBuf, String),
    /// The operating system reported an error.
    #[error(transparent)]
    Io(#[from] IoFault),
}

/// Reads a file, or its previous version if the file is missing or invalid.
///
/// # Errors
/// The error of the file itself, if the previous version is invalid, too.
pub fn read<T: DeserializeOwned>(path: &Path, care: ChecksumPolicy) -> Result<LoadedFile<T>, RonError> {
    read_one(path, care).or_else(|first| {
        let backup = with_suffix(path, "bak");
        let Ok(LoadedFile { value, mut warnings }) = read_one(&backup, care) else { return Err(first) };
        warnings.insert(0, RonWarning::FromBackup { backup, cause: first.to_string() });
        Ok(LoadedFile { value, warnings })
    })
}

/// Reads a file, never its previous version: of who may come in, since that may name somebody who was shut out since.
///
/// # Errors
/// The error of the file.
pub fn read_newest<T: DeserializeOwned>(path: &Path, care: ChecksumPolicy) -> Result<T, RonError> {
    read_one(path, care).map(|read| read.value)
}

/// Whether a previous version of a file is there, readable or not.
#[must_use]
pub fn has_backup(path: &Path) -> bool {
    with_suffix(path, "bak").symlink_metadata().is_ok()
}

/// Writes a file: after a power cut it is the old or the new one. A valid old file becomes `NAME.bak`; an invalid one
/// is renamed to `NAME.damaged`, so that it never replaces a valid previous version.
///
/// # Errors
/// A disk error; the old file stays. [`RonError::Value`] if the value could not be read back.
pub fn write<T: Serialize + DeserializeOwned>(path: &Path, care: ChecksumPolicy, value: &T) -> Result<(), RonError> {
    write_by(path, care, value, atomic_file::replace_private)
}

/// As [`write`], a file that others may read, too: on a USB stick.
///
/// # Errors
/// As [`write`].
pub fn write_shared<T>(path: &Path, care: ChecksumPolicy, value: &T) -> Result<(), RonError>
where
    T: Serialize + DeserializeOwned,
{
    write_by(path, care, value, atomic_file::replace)
}

type Replace = fn(&Path, &[u8]) -> Result<(), IoFault>;

fn write_by<T>(path: &Path, care: ChecksumPolicy, value: &T, replace: Replace) -> Result<(), RonError>
where
    T: Serialize + DeserializeOwned,
{
    let text = to_text(path, value)?;
    match read_one::<T>(path, care) {
        // A copy, because USB drives have no links and the file must stay.
        Ok(_) => {
            let bytes = atomic_file::read(path, RON_LIMIT).map_err(|refused| read_error(path, refused))?;
            replace(&with_suffix(path, "bak"), &bytes)?;
        }
        Err(RonError::Missing(_)) => {}
        Err(RonError::Io(fault)) => return Err(RonError::Io(fault)),
        Err(RonError::Text { .. } | RonError::Checksum(..) | RonError::NotReadable(..) | RonError::Value(..)) => {
            let aside = with_suffix(path, "damaged");
            disk::rename(path, &aside).map_err(IoFault::at(path, "put aside"))?;
        }
    }
    Ok(replace(path, text.as_bytes())?)
}

/// The text of a value with its checksum line.
fn to_text<T: Serialize + DeserializeOwned>(path: &Path, value: &T) -> Result<String, RonError> {
    let refused = |cause: String| RonError::Value(path.to_path_buf(), cause);
    let pretty = PrettyConfig::new().new_line("\n");
    let mut text = ron::ser::to_string_pretty(value, pretty).map_err(|wrong| refused(wrong.to_string()))?;
    text.push('\n');
    ron::from_str::<T>(&text).map_err(|wrong| refused(wrong.to_string()))?;
    let sum = checksum::checksum(text.as_bytes());
    text.push_str(&format!("{CHECKSUM_MARK}{sum:016x}\n"));
    if text.len() as u64 > RON_LIMIT {
        return Err(refused(format!("{} bytes, more than {RON_LIMIT}", text.len())));
    }
    Ok(text)
}

/// Reads one file, without its previous version.
fn read_one<T: DeserializeOwned>(path: &Path, care: ChecksumPolicy) -> Result<LoadedFile<T>, RonError> {
    let bytes = atomic_file::read(path, RON_LIMIT).map_err(|refused| read_error(path, refused))?;
    from_bytes(path, care, &bytes)
}

/// Reads the bytes of a file; `path` is for the errors.
///
/// # Errors
/// Bytes that are no text, a checksum that does not fit, or text that is no such value.
pub fn from_bytes<T: DeserializeOwned>(
    path: &Path,
    care: ChecksumPolicy,
    bytes: &[u8],
) -> Result<LoadedFile<T>, RonError> {
    let text = std::str::from_utf8(bytes).map_err(|wrong| utf8_error(path, bytes, wrong.valid_up_to()))?;
    let warnings = check_checksum(path, care, text)?;
    // The Windows editor writes a byte order mark.
    let text = text.trim_start_matches('\u{FEFF}');
    let value = ron::from_str(text).map_err(|wrong| {
        let (line, column) = next_token(text, wrong.span.start.line, wrong.span.start.col);
        RonError::Text { path: path.to_path_buf(), line, column, cause: wrong.code.to_string() }
    })?;
    Ok(LoadedFile { value, warnings })
}

/// The position of the next token: the parser reports the position before the blanks.
fn next_token(text: &str, line: usize, column: usize) -> (usize, usize) {
    for (number, content) in text.lines().enumerate().skip(line.saturating_sub(1)) {
        let skipped = if number + 1 == line { column.saturating_sub(1) } else { 0 };
        let token = content.chars().enumerate().skip(skipped).find(|(_, character)| !character.is_whitespace());
        if let Some((at, _)) = token {
            return (number + 1, at + 1);
        }
    }
    (line, column)
}

/// Checks the checksum line.
fn check_checksum(path: &Path, care: ChecksumPolicy, text: &str) -> Result<Vec<RonWarning>, RonError> {
    let refused = |cause| RonError::Checksum(path.to_path_buf(), cause);
    let stated = text.rfind(CHECKSUM_MARK).and_then(|at| {
        let digits = text[at + CHECKSUM_MARK.len()..].trim_end();
        u64::from_str_radix(digits, 16).ok().map(|sum| (at, sum))
    });
    match (stated, care) {
        (Some((at, sum)), _) if checksum::checksum(&text.as_bytes()[..at]) == sum => Ok(Vec::new()),
        (Some(_), ChecksumPolicy::Lenient) => Ok(vec![RonWarning::StaleChecksum(path.to_path_buf())]),
        (None, ChecksumPolicy::Lenient) => Ok(vec![RonWarning::NoChecksum(path.to_path_buf())]),
        (Some(_), ChecksumPolicy::Strict) => Err(refused("the checksum does not fit: damaged, or edited by hand")),
        (None, ChecksumPolicy::Strict) => Err(refused("no checksum: cut off, or edited by hand")),
    }
}

fn read_error(path: &Path, refused: ReadError) -> RonError {
    let path = path.to_path_buf();
    match refused {
        ReadError::Io(fault) if fault.is_missing() => RonError::Missing(path),
        ReadError::Io(fault) => RonError::Io(fault),
        other @ (ReadError::NotRegular | ReadError::TooLarge { .. } | ReadError::BeingWritten) => {
            RonError::NotReadable(path, other.to_string())
        }
    }
}

fn utf8_error(path: &Path, bytes: &[u8], valid: usize) -> RonError {
    let before = String::from_utf8_lossy(&bytes[..valid]);
    let (line, last) = (before.matches('\n').count() + 1, before.rsplit('\n').next().unwrap_or_default());
    let cause = "not UTF-8 text".to_owned();
    RonError::Text { path: path.to_path_buf(), line, column: last.chars().count() + 1, cause }
}

/// `NAME.extension`; the own extension of the file stays.
fn with_suffix(path: &Path, extension: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".{extension}"));
    name.into()
}
