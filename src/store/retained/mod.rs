//! Retained (non-volatile) data, in `retained.redb`.
//!
//! One [`RetainedDatabase::commit`] is one durable transaction: when it returns, all changes are on the disk; after an earlier
//! power cut none of them is. A damaged or foreign file is detected before it is opened, renamed and reported; the
//! caller raises an alarm and starts with an earlier state. Source: spec K4.2 (points kept over power-off), B3, B6.

mod check_process;
mod data;
pub mod generations;
mod integrity;
mod journal;
mod lock;
mod tables;

use std::fs::{self, File};
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use redb::{Database, DatabaseError};

use super::atomic_file;
use super::disk::{self, DatabaseFile};
use super::io_fault::IoFault;
use super::settings::SETTINGS_FILE;
use serde::{Deserialize, Serialize};

use crate::units::PerAxis;
pub use check_process::set_check_program;
pub use data::{RetainedChange, RetainedData};
pub use integrity::{run_database_check, silence_database_check};
use journal::{JOURNAL_FILE, Journal};
pub use tables::StorageFault;

/// The database's file name.
pub const DATABASE_FILE: &str = "retained.redb";
/// Temporary name of a new database, until it is complete.
const NEW_DATABASE_FILE: &str = "retained.fresh.redb";
/// The passwords once more, beside the database: they outlive it.
pub const PASSWORD_FILE: &str = "passwords.ron";
/// The kind of machine of the data, once more beside the database: it outlives it.
pub const KIND_FILE: &str = "machine-kind.ron";
/// Maximum number of damaged files kept; then the newest replaces the one before.
const MAX_DAMAGED_FILES: u32 = 99;
/// Page cache, bytes; the whole database has some hundred kilobytes.
const CACHE_BYTES: usize = 8 * 1024 * 1024;

/// Number of a commit; it increases by one with every commit, also across power cuts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Generation(pub u64);

/// Geometry and wear of a tool offset, radius mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolOffset {
    /// Geometry of X, Y, Z.
    pub geometry: PerAxis<f64>,
    /// Wear of X, Y, Z.
    pub wear: PerAxis<f64>,
}

/// A damaged or foreign file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DamageReport {
    /// Path of the unchanged copy.
    pub kept_as: PathBuf,
    /// What is wrong with it.
    pub cause: String,
}

/// A copy of the data beside their database.
#[derive(Debug)]
pub struct DataCopy {
    /// When it was written last.
    pub modified: Option<SystemTime>,
    /// The data.
    pub data: RetainedData,
    /// It has every commit; otherwise later ones may be missing.
    pub is_last: bool,
}

/// Result of opening.
#[derive(Debug)]
pub struct OpenedDatabase {
    /// The store, ready for use.
    pub database: RetainedDatabase,
    /// Set when the old data were unusable: what the caller gave in their place is stored; an alarm.
    pub damaged: Option<DamageReport>,
    /// Whether the file is new: first start, file deleted, or damaged.
    pub fresh: bool,
    /// Whether the file is gone that was here at an earlier start.
    pub gone: bool,
    /// The data.
    pub data: RetainedData,
    /// Why the disk takes nothing now. The data are whole, and the next commit tries again.
    pub unwritable: Option<RetainedError>,
}

/// Why the retained data cannot be opened, read or written.
#[derive(Debug, thiserror::Error)]
pub enum RetainedError {
    /// Another process uses the data directory.
    #[error("{}: another kt830 is running on this data; close it, or start with another --data FOLDER", .0.display())]
    AlreadyRunning(PathBuf),
    /// Written by a newer control. This is not damage; the file stays unchanged.
    #[error("{}: format {found}, this control knows {known}; start the newer control, or move the file away", .path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its format.
        found: u64,
        /// The newest supported format.
        known: u64,
    },
    /// An invalid change and what is wrong with it: a bug of the caller. No change of the commit was stored.
    #[error("{0} cannot be kept: {1}")]
    BadChange(String, &'static str),
    /// Database error in the file. The commit may have succeeded or not; it is safe to commit the same changes again.
    #[error("{}: {}; free disk space or replace it, then try again", .0.display(), .1)]
    Storage(PathBuf, StorageFault),
    /// The file was removed or replaced while it is open: what is stored now is lost at the end of the process.
    #[error("{}: removed or replaced while the control runs; nothing is kept any more: save a backup, then restart the control", .0.display())]
    Gone(PathBuf),
    /// The data belong to another kind of machine: what is stored, and what was asked for.
    #[error(
        "the data are those of kind {0}, not {1}; start with that kind, choose the kind on the settings page, or take another --data FOLDER"
    )]
    OtherKind(String, String),
    /// A copy or an earlier state could not be written; the data themselves are stored.
    #[error("{0}; a copy of the data is not kept")]
    Copy(String),
    /// The operating system reported an error.
    #[error(transparent)]
    Io(#[from] IoFault),
}

/// The retained data of one machine, used by one process at a time.
#[derive(Debug)]
pub struct RetainedDatabase {
    path: PathBuf,
    /// Identity of the file that is open.
    opened: Option<FileIdentity>,
    /// `None` after a failed commit; the next use opens the file again.
    database: Option<Database>,
    /// A damaged file could not be put aside, and is where the new one will be.
    is_in_the_way: bool,
    /// What a new file is to hold, until it is made.
    to_create: Option<Box<RetainedData>>,
    /// Which machine's data they are.
    identity: Option<NonZeroU64>,
    /// The same data once more.
    journal: Journal,
    lock: File,
}

impl RetainedDatabase {
    /// Opens `retained.redb` in a data directory, or creates it.
    ///
    /// # Errors
    /// Another process has it open, a newer control wrote it, or the file cannot be read. Damage is no error, nor is a
    /// disk that takes nothing: see [`OpenedDatabase`].
    pub fn open(folder: &Path) -> Result<OpenedDatabase, RetainedError> {
        Self::open_or_replace(folder, |_| RetainedData::default())
    }

    /// As [`Self::open`]. Data that are damaged or gone are replaced by what `replacement` gives, together with the new
    /// file: a power cut leaves the old state, or the new one whole.
    ///
    /// # Errors
    /// As [`Self::open`]; the replacement has values that cannot be kept.
    pub fn open_or_replace(
        folder: &Path,
        replacement: impl FnOnce(Option<&DamageReport>) -> RetainedData,
    ) -> Result<OpenedDatabase, RetainedError> {
        let lock = lock::take(folder)?;
        let own = own_identity(folder);
        let path = folder.join(DATABASE_FILE);
        let mut damaged = None;
        let mut intact = None;
        let present = fs::symlink_metadata(&path).is_ok();
        if lock::is_in_use(&path) {
            return Err(RetainedError::AlreadyRunning(folder.to_path_buf()));
        }
        if present {
            match integrity::read_intact(&path)? {
                Ok(data) => match contradiction(folder, own, &data) {
                    Some(cause) => damaged = Some(put_aside(folder, &path, cause.to_owned())),
                    None => intact = Some(*data),
                },
                Err(cause) => damaged = Some(put_aside(folder, &path, cause)),
            }
        }
        let (fresh, gone) = (intact.is_none(), !present && has_traces(folder));
        let replaced = || match damaged.is_some() || gone {
            true => replacement(damaged.as_ref()),
            false => RetainedData::default(),
        };
        let mut data = intact.unwrap_or_else(replaced);
        data.identity = own.or(data.identity).or_else(disk::new_identity);
        let to_create = fresh.then(|| Box::new(data.clone()));
        let journal = Journal::open(folder, &data);
        let identity = data.identity;
        let is_in_the_way = damaged.as_ref().is_some_and(|report| report.kept_as == path);
        let mut database =
            Self { path, opened: None, database: None, is_in_the_way, to_create, identity, journal, lock };
        let unwritable = match database.open_file() {
            Ok(opened) => {
                database.database = Some(opened);
                match database.journal.begins_anew() {
                    true => database.journal.begin(&data).err(),
                    false => None,
                }
            }
            Err(failed @ (RetainedError::Storage(..) | RetainedError::Io(_))) => Some(failed),
            Err(refused) => return Err(refused),
        };
        Ok(OpenedDatabase { database, damaged, fresh, gone, data, unwritable })
    }

    /// Opens the file; makes it before, if it is new.
    fn open_file(&mut self) -> Result<Database, RetainedError> {
        if let Some(content) = &self.to_create {
            if self.is_in_the_way {
                rename_damaged(atomic_file::folder_of(&self.path), &self.path)?;
                self.is_in_the_way = false;
            }
            create_database(atomic_file::folder_of(&self.path), &self.path, content)?;
        }
        self.to_create = None;
        // From now on this is no first start, whatever is removed.
        lock::mark_as_used(&self.lock, atomic_file::folder_of(&self.path), self.identity);
        let database = open_database(&self.path)?;
        tables::upgrade(&database, self.identity).map_err(|fault| RetainedError::Storage(self.path.clone(), fault))?;
        self.opened = self.opened.or_else(|| identity(&self.path));
        Ok(database)
    }

    /// Stores all changes or none, in their order. When it returns, they survive a power cut.
    ///
    /// # Errors
    /// [`RetainedError::BadChange`] for values that are not finite and keys out of range; [`RetainedError::Storage`]
    /// for a disk error: the next use opens the file again.
    pub fn commit(&mut self, changes: &[RetainedChange]) -> Result<Generation, RetainedError> {
        for change in changes {
            tables::check_change(change)?;
        }
        let generation = self.with_database(|database| tables::commit_changes(database, changes))?;
        // A removed folder takes its name from the file, not the file from us: commits would go on into nothing.
        self.check_present()?;
        self.note(generation, changes)?;
        Ok(generation)
    }

    /// Whether the file that is open is still there under its name.
    ///
    /// # Errors
    /// It is not: [`RetainedError::Gone`].
    pub fn check_present(&self) -> Result<(), RetainedError> {
        match self.opened.is_none() || identity(&self.path) == self.opened {
            true => Ok(()),
            false => Err(RetainedError::Gone(self.path.clone())),
        }
    }

    /// As [`Self::check_present`]; writes the journal anew if it was removed, cut or replaced.
    ///
    /// # Errors
    /// As [`Self::check_present`], or a disk error.
    pub fn check_files(&mut self) -> Result<(), RetainedError> {
        self.check_present()?;
        match self.database.is_some() && !self.journal.is_present() {
            true => self.load().and_then(|data| self.journal.begin(&data)),
            false => Ok(()),
        }
    }

    /// Notes a commit in the journal.
    fn note(&mut self, generation: Generation, changes: &[RetainedChange]) -> Result<(), RetainedError> {
        match self.journal.begins_anew() || !self.journal.is_present() {
            true => self.load().and_then(|data| self.journal.begin(&data)),
            false => self.journal.append(generation, changes),
        }
    }

    /// The newest copy of the data of a directory beside its database.
    #[must_use]
    pub fn newest_copy(folder: &Path) -> Option<DataCopy> {
        let journal = journal::read(folder).map(|found| DataCopy {
            modified: found.modified,
            data: found.data,
            is_last: found.is_whole,
        });
        let kept = generations::newest_whole(folder);
        let kept = kept.map(|(modified, data)| DataCopy { modified, data, is_last: false });
        let own = own_identity(folder);
        let copies = journal.into_iter().chain(kept).filter(|copy| is_own(own, &copy.data));
        copies.reduce(|newest, other| if other.data.generation > newest.data.generation { other } else { newest })
    }

    /// All data of a directory that nobody opens; `None` if there are none, or they are damaged or another machine's.
    /// Nothing is written.
    #[must_use]
    pub fn peek(folder: &Path) -> Option<RetainedData> {
        integrity::read_whole(&folder.join(DATABASE_FILE)).filter(|data| is_own(own_identity(folder), data))
    }

    /// Whether a change is valid.
    #[must_use]
    pub fn accepts(change: &RetainedChange) -> bool {
        tables::check_change(change).is_ok()
    }

    /// All retained data.
    ///
    /// # Errors
    /// A disk error.
    pub fn load(&mut self) -> Result<RetainedData, RetainedError> {
        self.with_database(|database| Ok(tables::load(database)?.data))
    }

    /// The path of the database.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn with_database<T>(&mut self, act: impl FnOnce(&Database) -> Result<T, StorageFault>) -> Result<T, RetainedError> {
        let database = self.database.take().map_or_else(|| self.open_file(), Ok)?;
        let done = act(&database).map_err(|fault| RetainedError::Storage(self.path.clone(), fault))?;
        // Only after success: redb must be opened again after a failed write.
        self.database = Some(database);
        Ok(done)
    }
}

/// Device and number of a file; where a system has neither, its time of creation.
type FileIdentity = (u64, u64);

/// The identity of the file that a path names now.
fn identity(path: &Path) -> Option<FileIdentity> {
    identity_from(&fs::metadata(path).ok()?)
}

/// The identity of an open file.
fn identity_of(file: &File) -> Option<FileIdentity> {
    identity_from(&file.metadata().ok()?)
}

fn identity_from(metadata: &fs::Metadata) -> Option<FileIdentity> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        Some((metadata.dev(), metadata.ino()))
    }
    #[cfg(not(unix))]
    {
        let created = metadata.created().ok()?.duration_since(std::time::UNIX_EPOCH).ok()?;
        Some((created.as_secs(), u64::from(created.subsec_nanos())))
    }
}

/// Renames a damaged file to the first free `retained.damaged-N.redb`, or to the last.
fn rename_damaged(folder: &Path, path: &Path) -> Result<PathBuf, RetainedError> {
    let name = |number| folder.join(format!("retained.damaged-{number}.redb"));
    let is_free = |kept: &PathBuf| fs::symlink_metadata(kept).is_err();
    // The last one gives way: a disk that damages file after file must not keep the control from starting.
    let kept = (1..=MAX_DAMAGED_FILES).map(name).find(is_free).unwrap_or_else(|| name(MAX_DAMAGED_FILES));
    disk::rename(path, &kept).map_err(IoFault::at(path, "put aside"))?;
    atomic_file::flush_folder(folder)?;
    Ok(kept)
}

/// Puts a damaged database aside. On a disk that takes nothing it stays where it is, until one can be made in its place.
fn put_aside(folder: &Path, path: &Path, cause: String) -> DamageReport {
    let kept_as = rename_damaged(folder, path).unwrap_or_else(|_| path.to_path_buf());
    DamageReport { kept_as, cause }
}

/// The machine to which the data of a folder belong: its lock says so, else its kept states, else its journal.
fn own_identity(folder: &Path) -> Option<NonZeroU64> {
    lock::identity_in(folder).or_else(|| generations::identity(folder)).or_else(|| journal::read(folder)?.data.identity)
}

/// Whether data can be those of a machine. Older ones do not say.
fn is_own(own: Option<NonZeroU64>, data: &RetainedData) -> bool {
    own.zip(data.identity).is_none_or(|(own, stated)| own == stated)
}

/// What says that a whole database is not the last one of its folder; none if nothing does.
fn contradiction(folder: &Path, own: Option<NonZeroU64>, data: &RetainedData) -> Option<&'static str> {
    if !is_own(own, data) {
        return Some("of another machine");
    }
    // The database is written before its copies: it was put back, or has lost its last commits.
    if RetainedDatabase::newest_copy(folder).is_some_and(|copy| copy.data.generation > data.generation) {
        return Some("older than the copies beside it");
    }
    let is_other =
        |found: journal::Replayed| found.is_whole && found.data.generation == data.generation && found.data != *data;
    journal::read(folder).is_some_and(is_other).then_some("not the one that its journal was written with")
}

/// Stands in a data directory that a real machine was started with: no simulation uses its data.
pub const REAL_MACHINE_MARK: &str = "real-machine.txt";

/// Whether a control has stored data in this directory before.
#[must_use]
pub fn has_traces(folder: &Path) -> bool {
    let mut names =
        fs::read_dir(folder).into_iter().flatten().flatten().filter_map(|entry| entry.file_name().into_string().ok());
    lock::was_used(folder)
        || generations::has_any(folder)
        || names.any(|name| {
            let name = name.strip_suffix(".bak").unwrap_or(&name);
            let of_control = [PASSWORD_FILE, KIND_FILE, JOURNAL_FILE, SETTINGS_FILE, REAL_MACHINE_MARK];
            name == DATABASE_FILE || name.starts_with("retained.damaged-") || of_control.contains(&name)
        })
}

/// Creates a database under a temporary name and renames it: a power cut never leaves an incomplete one.
fn create_database(folder: &Path, path: &Path, content: &RetainedData) -> Result<(), RetainedError> {
    let changes = content.changes();
    for change in &changes {
        tables::check_change(change)?;
    }
    let fresh = folder.join(NEW_DATABASE_FILE);
    disk::remove(&fresh).map_err(IoFault::at(&fresh, "delete"))?;
    let refused = |fault| RetainedError::Storage(fresh.clone(), fault);
    let database = DatabaseFile::open(&fresh, true)
        .and_then(|file| builder().create_with_backend(file))
        .map_err(|wrong| refused(wrong.into()))?;
    tables::create_tables(&database).map_err(refused)?;
    tables::restore(&database, &changes, content).map_err(refused)?;
    drop(database);
    // Closing has written the header again.
    let file = File::open(&fresh).map_err(IoFault::at(&fresh, "open"))?;
    disk::flush_file(&file, &fresh).map_err(IoFault::at(&fresh, "flush"))?;
    disk::rename(&fresh, path).map_err(IoFault::at(&fresh, "rename"))?;
    Ok(atomic_file::flush_folder(folder)?)
}

fn open_database(path: &Path) -> Result<Database, RetainedError> {
    DatabaseFile::open(path, false).and_then(|file| builder().create_with_backend(file)).map_err(|wrong| match wrong {
        DatabaseError::DatabaseAlreadyOpen => RetainedError::AlreadyRunning(path.to_path_buf()),
        other => RetainedError::Storage(path.to_path_buf(), other.into()),
    })
}

fn builder() -> redb::Builder {
    let mut builder = Database::builder();
    builder.set_cache_size(CACHE_BYTES);
    builder
}
