//! Retained data: what the machine must know after a power cut, in `retained.redb`.
//!
//! One [`Retained::commit`] is one durable transaction: when it returns, the changes are on the disk; when the power
//! fails before, none of them is. A damaged or foreign file is found before it is touched, kept under another name, and
//! told; the caller raises its alarm and starts safe. Source: spec K4.2 (points kept over power-off), B3, B6.

mod examine;
mod tables;

use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use redb::{Database, DatabaseError};

use super::fault::IoFault;
use super::whole_file;
use crate::defs::history::PastAlarm;
use crate::units::PerAxis;
pub use tables::StorageFault;

/// The database's file name.
const FILE: &str = "retained.redb";
/// Under this name a fresh database is built, to be renamed when it is whole.
const FRESH: &str = "retained.fresh.redb";
/// Locked as long as a control works on the data.
const LOCK: &str = "retained.lock";
/// How many damaged files are kept before a person must clear them away.
const DAMAGED_LIMIT: u32 = 99;
/// Memory for pages: the whole database is some hundred kilobytes.
const CACHE_BYTES: usize = 8 * 1024 * 1024;

/// Counts commits; each commit has one more than the one before, across power cuts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Generation(pub u64);

/// Geometry and wear of a tool offset, in millimetres as entered (diameters where the machine uses them).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolOffset {
    /// Geometry of X, Y, Z.
    pub geometry: PerAxis<f64>,
    /// Wear of X, Y, Z.
    pub wear: PerAxis<f64>,
}

/// One change to the retained data. `None` forgets the value: a null variable, a parameter back at its default.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A macro variable `#number` (B3).
    Variable {
        /// Its number.
        number: u16,
        /// Its value; `None` is null.
        value: Option<f64>,
    },
    /// A parameter by its key, "P270" or "P16.0".
    Param {
        /// The key.
        key: String,
        /// The value; `None` is the default.
        value: Option<f64>,
    },
    /// A tool offset, 1 to 16.
    Offset {
        /// Its number.
        number: u8,
        /// All its values.
        offset: ToolOffset,
    },
    /// A work frame: 0 is G54, 5 is G59.
    Frame {
        /// Its index.
        index: u8,
        /// Its zero point in machine coordinates, mm.
        origin: PerAxis<f64>,
    },
    /// A retained number by name: a dressing point, the part count, the wheel's diameter.
    Number {
        /// The name.
        key: String,
        /// The value.
        value: Option<f64>,
    },
    /// A retained text by name.
    Text {
        /// The name.
        key: String,
        /// The text.
        value: Option<String>,
    },
    /// An alarm of the history, in its slot.
    Alarm(Box<PastAlarm>),
}

/// All retained data at once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// The last commit.
    pub generation: Generation,
    /// Macro variables by number; absent is null.
    pub variables: BTreeMap<u16, f64>,
    /// Parameters by key; absent is the default.
    pub params: BTreeMap<String, f64>,
    /// Tool offsets by number, 1 to 16; absent is all zero.
    pub offsets: BTreeMap<u8, ToolOffset>,
    /// Work frames by index, 0 to 5; absent is all zero.
    pub frames: BTreeMap<u8, PerAxis<f64>>,
    /// Retained numbers by name.
    pub numbers: BTreeMap<String, f64>,
    /// Retained texts by name.
    pub texts: BTreeMap<String, String>,
    /// Alarms of the history by slot.
    pub alarms: BTreeMap<u16, PastAlarm>,
}

/// A file that was found damaged or foreign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DamageReport {
    /// Where it is kept, byte for byte as it was found.
    pub kept_as: PathBuf,
    /// What is wrong with it.
    pub cause: String,
}

/// What opening found.
#[derive(Debug)]
pub struct Opened {
    /// The store, ready.
    pub retained: Retained,
    /// Present when the old data could not be used: the store is empty, raise an alarm and start safe.
    pub damaged: Option<DamageReport>,
    /// Whether the store is new and empty: the first start, the file was taken away, or it was damaged.
    pub fresh: bool,
}

/// Why the retained data cannot be opened, read or written.
#[derive(Debug, thiserror::Error)]
pub enum RetainedError {
    /// Another process works on this data.
    #[error("{}: another kt830 is running on this data; close it, or start with another --data FOLDER", .path.display())]
    AlreadyRunning {
        /// The data directory.
        path: PathBuf,
    },
    /// Written by a newer control. Not damage: it is left alone.
    #[error("{}: format {found}, this control knows {known}; start the newer control, or move the file away", .path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its format.
        found: u64,
        /// The newest format known here.
        known: u64,
    },
    /// Too many damaged files are kept already.
    #[error("{}: {DAMAGED_LIMIT} damaged files are kept here; the disk is failing, replace it and clear them away", .path.display())]
    TooManyDamaged {
        /// The data directory.
        path: PathBuf,
    },
    /// A change that cannot be kept; a bug of the caller. None of the commit's changes was kept.
    #[error("{what} cannot be kept: {cause}")]
    BadChange {
        /// The change.
        what: String,
        /// What is wrong with it.
        cause: &'static str,
    },
    /// The database refused. The commit may be kept or not; giving the same changes again is right either way.
    #[error("{}: {fault}; make room on the disk or replace it, then try again", .path.display())]
    Storage {
        /// The file.
        path: PathBuf,
        /// What the database said.
        fault: StorageFault,
    },
    /// The operating system refused.
    #[error(transparent)]
    Io(#[from] IoFault),
}

/// The retained data of one machine. One process at a time.
#[derive(Debug)]
pub struct Retained {
    path: PathBuf,
    /// Absent after a failed commit, until the next use opens the file again.
    database: Option<Database>,
    _lock: File,
}

impl Retained {
    /// Opens `retained.redb` in a data directory, or begins a fresh one.
    ///
    /// # Errors
    /// When another process has it, a newer control wrote it, or the disk refuses. Damage is no error: see [`Opened`].
    pub fn open(folder: &Path) -> Result<Opened, RetainedError> {
        let lock = lock(folder)?;
        let path = folder.join(FILE);
        let mut damaged = None;
        let present = fs::symlink_metadata(&path).is_ok();
        if present && let Some(cause) = examine::damage(&path)? {
            damaged = Some(DamageReport { kept_as: put_aside(folder, &path)?, cause });
        }
        let fresh = !present || damaged.is_some();
        if fresh {
            begin(folder, &path)?;
        }
        let database = open_database(&path)?;
        if !fresh {
            tables::upgrade(&database).map_err(|fault| RetainedError::Storage { path: path.clone(), fault })?;
        }
        Ok(Opened { retained: Self { path, database: Some(database), _lock: lock }, damaged, fresh })
    }

    /// Keeps all the changes or none, later ones over earlier ones; when it returns, they outlive a power cut.
    ///
    /// # Errors
    /// [`RetainedError::BadChange`] for values that are not finite and keys out of range; [`RetainedError::Storage`]
    /// when the disk refuses: the file is opened again at the next use.
    pub fn commit(&mut self, changes: &[Change]) -> Result<Generation, RetainedError> {
        for change in changes {
            tables::check(change)?;
        }
        self.with(|database| tables::apply(database, changes))
    }

    /// Whether a change is of the form that can be kept.
    #[must_use]
    pub fn takes(change: &Change) -> bool {
        tables::check(change).is_ok()
    }

    /// All retained data.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn load(&mut self) -> Result<Loaded, RetainedError> {
        self.with(|database| Ok(tables::load(database)?.loaded))
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn with<T>(&mut self, act: impl FnOnce(&Database) -> Result<T, StorageFault>) -> Result<T, RetainedError> {
        let database = match self.database.take() {
            Some(database) => database,
            None => open_database(&self.path)?,
        };
        let done = act(&database).map_err(|fault| RetainedError::Storage { path: self.path.clone(), fault })?;
        // Only after success: redb wants to be opened again after a failed write.
        self.database = Some(database);
        Ok(done)
    }
}

/// Takes the data directory for this process.
fn lock(folder: &Path) -> Result<File, RetainedError> {
    let path = folder.join(LOCK);
    let file = File::options().create(true).truncate(false).write(true).open(&path);
    let file = file.map_err(IoFault::at(&path, "open"))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(RetainedError::AlreadyRunning { path: folder.to_path_buf() }),
        Err(TryLockError::Error(cause)) => Err(IoFault::at(&path, "lock")(cause).into()),
    }
}

/// Renames a damaged file to the first free `retained.damaged-N.redb`.
fn put_aside(folder: &Path, path: &Path) -> Result<PathBuf, RetainedError> {
    for number in 1..=DAMAGED_LIMIT {
        let kept = folder.join(format!("retained.damaged-{number}.redb"));
        if fs::symlink_metadata(&kept).is_ok() {
            continue;
        }
        fs::rename(path, &kept).map_err(IoFault::at(path, "put aside"))?;
        whole_file::flush_folder(folder).map_err(IoFault::at(folder, "flush"))?;
        return Ok(kept);
    }
    Err(RetainedError::TooManyDamaged { path: folder.to_path_buf() })
}

/// Builds a fresh database beside and renames it: a power cut never leaves half of one.
fn begin(folder: &Path, path: &Path) -> Result<(), RetainedError> {
    let fresh = folder.join(FRESH);
    match fs::remove_file(&fresh) {
        Ok(()) => {}
        Err(missing) if missing.kind() == std::io::ErrorKind::NotFound => {}
        Err(cause) => return Err(IoFault::at(&fresh, "delete")(cause).into()),
    }
    let refused = |fault| RetainedError::Storage { path: fresh.clone(), fault };
    let database = builder().create(&fresh).map_err(|wrong| refused(wrong.into()))?;
    tables::begin(&database).map_err(refused)?;
    drop(database);
    // Closing wrote the header once more.
    let file = File::open(&fresh).map_err(IoFault::at(&fresh, "open"))?;
    file.sync_all().map_err(IoFault::at(&fresh, "flush"))?;
    fs::rename(&fresh, path).map_err(IoFault::at(&fresh, "rename"))?;
    Ok(whole_file::flush_folder(folder).map_err(IoFault::at(folder, "flush"))?)
}

fn open_database(path: &Path) -> Result<Database, RetainedError> {
    builder().open(path).map_err(|wrong| match wrong {
        DatabaseError::DatabaseAlreadyOpen => RetainedError::AlreadyRunning { path: path.to_path_buf() },
        other => RetainedError::Storage { path: path.to_path_buf(), fault: other.into() },
    })
}

fn builder() -> redb::Builder {
    let mut builder = Database::builder();
    builder.set_cache_size(CACHE_BYTES);
    builder
}
