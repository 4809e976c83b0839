//! Every change that the store makes to a disk. A test may put an observer between store and disk: one that refuses
//! changes, or one that knows what a power cut leaves of them.
//!
//! While an observer is installed nothing is flushed: the observer decides what a flush means.
//! Source: notes "reliability".

use std::cell::RefCell;
use std::fs::{self, File, Metadata, OpenOptions};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, Seek, SeekFrom, Write};
use std::num::NonZeroU64;
use std::ops::Bound;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::OnceLock;
use std::time::{Duration, Instant, SystemTime};

use redb::backends::FileBackend;
use redb::{BackendError, DatabaseError, StorageBackend};

/// Permissions of a file that nobody but the user of the control reads or writes.
pub(super) const PRIVATE: u32 = 0o600;

/// A change, before it is made.
#[derive(Clone, Copy, Debug)]
pub enum DiskChange<'a> {
    /// A folder, with those above it that are missing.
    CreateFolder(&'a Path),
    /// An empty file.
    CreateFile(&'a Path),
    /// Bytes of a file.
    Write {
        /// The file.
        file: &'a Path,
        /// Where they begin.
        offset: u64,
        /// The bytes.
        bytes: &'a [u8],
    },
    /// A file is cut, or filled up with zeros.
    SetLength {
        /// The file.
        file: &'a Path,
        /// Its new length, bytes.
        length: u64,
    },
    /// What was written to a file is to survive a power cut.
    FlushFile(&'a Path),
    /// A file gets another name in the same folder; a file of that name is replaced.
    Rename {
        /// Old path.
        from: &'a Path,
        /// New path.
        to: &'a Path,
    },
    /// A file is deleted.
    Remove(&'a Path),
    /// The names in a folder are to survive a power cut.
    FlushFolder(&'a Path),
}

impl DiskChange<'_> {
    /// The file or folder that changes.
    #[must_use]
    pub const fn path(&self) -> &Path {
        match self {
            Self::Write { file: path, .. }
            | Self::SetLength { file: path, .. }
            | Self::Rename { from: path, .. }
            | Self::CreateFolder(path)
            | Self::CreateFile(path)
            | Self::FlushFile(path)
            | Self::Remove(path)
            | Self::FlushFolder(path) => path,
        }
    }
}

/// Sees the changes of a thread before they are made.
pub trait DiskObserver {
    /// A change that is about to be made.
    ///
    /// # Errors
    /// The disk refuses it: it is not made, and the store gets this error.
    fn before(&mut self, change: DiskChange<'_>) -> io::Result<()>;

    /// The time of the story since its beginning.
    fn now(&self) -> Duration {
        Duration::ZERO
    }
}

thread_local! {
    static OBSERVER: RefCell<Option<Rc<RefCell<dyn DiskObserver>>>> = const { RefCell::new(None) };
}

/// Shows the changes of this thread to an observer, until the guard is dropped.
#[must_use]
pub fn observe(observer: Rc<RefCell<dyn DiskObserver>>) -> ObservationGuard {
    OBSERVER.with_borrow_mut(|place| ObservationGuard { before: place.replace(observer) })
}

/// Ends an observation when dropped.
pub struct ObservationGuard {
    before: Option<Rc<RefCell<dyn DiskObserver>>>,
}

impl Drop for ObservationGuard {
    fn drop(&mut self) {
        OBSERVER.set(self.before.take());
    }
}

/// Tells the observer of a change; true if there is one.
fn tell(change: DiskChange<'_>) -> io::Result<bool> {
    OBSERVER.with_borrow(|observer| match observer {
        Some(observer) => observer.borrow_mut().before(change).map(|()| true),
        None => Ok(false),
    })
}

fn is_observed() -> bool {
    OBSERVER.with_borrow(Option::is_some)
}

/// A number that no other machine has. Under an observer it is always the same one: a story gives the same files.
pub(super) fn new_identity() -> Option<NonZeroU64> {
    NonZeroU64::new(if is_observed() { 1 } else { RandomState::new().hash_one(std::process::id()) })
}

/// The salt of passwords under an observer: a story gives the same files. Otherwise it is random.
pub(super) fn fixed_salt() -> Option<[u8; 16]> {
    is_observed().then_some([1; 16])
}

/// A time that only goes on. Under an observer it is that of the story.
#[must_use]
pub fn now() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    let told = OBSERVER.with_borrow(|observer| observer.as_ref().map(|observer| observer.borrow().now()));
    told.unwrap_or_else(|| START.get_or_init(Instant::now).elapsed())
}

/// When a file was written last, if the disk knows. Under an observer it is always the same: a story gives the same data.
pub(super) fn modified(metadata: &Metadata) -> Option<SystemTime> {
    if is_observed() { Some(SystemTime::UNIX_EPOCH) } else { metadata.modified().ok() }
}

/// Creates a folder, and those above it that are missing.
pub(super) fn create_folders(folder: &Path) -> io::Result<()> {
    if !folder.is_dir() {
        tell(DiskChange::CreateFolder(folder))?;
    }
    fs::create_dir_all(folder)
}

/// Tells of a file that was created empty under a random name.
pub(super) fn created(file: &Path) -> io::Result<()> {
    tell(DiskChange::CreateFile(file)).map(drop)
}

/// Writes a new file.
pub(super) fn write_new(file: &mut File, path: &Path, bytes: &[u8]) -> io::Result<()> {
    tell(DiskChange::Write { file: path, offset: 0, bytes })?;
    file.write_all(bytes)
}

/// Appends to a file of this length, and makes it durable.
pub(super) fn append(file: &mut File, path: &Path, length: u64, bytes: &[u8]) -> io::Result<()> {
    tell(DiskChange::Write { file: path, offset: length, bytes })?;
    file.seek(SeekFrom::Start(length))?;
    file.write_all(bytes)?;
    flush_file(file, path)
}

/// Makes what was written to a file durable.
pub(super) fn flush_file(file: &File, path: &Path) -> io::Result<()> {
    match tell(DiskChange::FlushFile(path))? {
        true => Ok(()),
        false => file.sync_all(),
    }
}

/// Renames a file within its folder.
pub(super) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    tell(DiskChange::Rename { from, to })?;
    fs::rename(from, to)
}

/// Deletes a file; false if there was none.
pub(super) fn remove(path: &Path) -> io::Result<bool> {
    if fs::symlink_metadata(path).is_err_and(|error| error.kind() == io::ErrorKind::NotFound) {
        return Ok(false);
    }
    tell(DiskChange::Remove(path))?;
    fs::remove_file(path).map(|()| true)
}

/// Makes the names in a folder durable.
pub(super) fn flush_folder(folder: &Path) -> io::Result<()> {
    // On other systems a folder cannot be opened as a file, and the rename itself is journalled.
    match tell(DiskChange::FlushFolder(folder))? || !cfg!(unix) {
        true => Ok(()),
        false => File::open(folder)?.sync_all(),
    }
}

/// The file of a database.
#[derive(Debug)]
pub(super) struct DatabaseFile {
    path: PathBuf,
    file: FileBackend,
}

/// A file that is created so is for the user of the control alone.
pub(super) fn private(options: &mut OpenOptions) -> &mut OpenOptions {
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.mode(PRIVATE);
    }
    options
}

impl DatabaseFile {
    /// Opens a file; `is_new`: creates it.
    pub(super) fn open(path: &Path, is_new: bool) -> Result<Self, DatabaseError> {
        if is_new {
            created(path)?;
        }
        let file = private(OpenOptions::new().read(true).write(true).create_new(is_new)).open(path)?;
        Ok(Self { path: path.to_path_buf(), file: FileBackend::new(file)? })
    }
}

impl StorageBackend for DatabaseFile {
    fn len(&self) -> io::Result<u64> {
        self.file.len()
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        self.file.read(offset, out)
    }

    fn set_len(&self, length: u64) -> io::Result<()> {
        tell(DiskChange::SetLength { file: &self.path, length })?;
        self.file.set_len(length)
    }

    fn sync_data(&self) -> io::Result<()> {
        match tell(DiskChange::FlushFile(&self.path))? {
            true => Ok(()),
            false => self.file.sync_data(),
        }
    }

    fn write(&self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        tell(DiskChange::Write { file: &self.path, offset, bytes })?;
        self.file.write(offset, bytes)
    }

    fn close(&self) -> io::Result<()> {
        self.file.close()
    }

    fn try_lock_range(&self, start: Bound<u64>, end: Bound<u64>) -> Result<bool, BackendError> {
        self.file.try_lock_range(start, end)
    }

    fn try_lock_shared_range(&self, start: Bound<u64>, end: Bound<u64>) -> Result<bool, BackendError> {
        self.file.try_lock_shared_range(start, end)
    }

    fn lock_range(&self, start: Bound<u64>, end: Bound<u64>) -> Result<(), BackendError> {
        self.file.lock_range(start, end)
    }

    fn lock_shared_range(&self, start: Bound<u64>, end: Bound<u64>) -> Result<(), BackendError> {
        self.file.lock_shared_range(start, end)
    }

    fn unlock_range(&self, start: Bound<u64>, end: Bound<u64>) -> Result<(), BackendError> {
        self.file.unlock_range(start, end)
    }

    fn query_lock_range(&self, start: Bound<u64>, end: Bound<u64>) -> Result<bool, BackendError> {
        self.file.query_lock_range(start, end)
    }
}
