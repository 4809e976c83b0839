//! The lock of a data directory. It also says that there are data, and whose: it outlives their database.
//! Source: spec K4.2; safety stance.

use std::fs::{self, File, TryLockError};
use std::io::{Seek, Write};
use std::num::NonZeroU64;
use std::path::Path;
use std::time::Duration;

use super::RetainedError;
use crate::store::atomic_file::{self, LOCK_FILE};
use crate::store::checksum::checksum;
use crate::store::disk;
use crate::store::io_fault::IoFault;

/// How often the lock is tried, and the pause between: half a second in all.
const LOCK_TRIES: u32 = 10;
const LOCK_PAUSE: Duration = Duration::from_millis(50);
/// What the lock holds once there are data, before the identity of their machine and its checksum.
const USED_MARK: &str = "used";
/// Longest lock that is read, bytes.
const READ_LIMIT: u64 = 64;

/// Locks the data directory for this process.
pub(super) fn take(folder: &Path) -> Result<File, RetainedError> {
    let path = folder.join(LOCK_FILE);
    // A pipe would make the start wait for ever, a folder or a broken link refuse it.
    let is_odd = fs::symlink_metadata(&path).is_ok_and(|found| !found.is_file());
    let file = match is_odd && disk::rename(&path, &folder.join(format!("{LOCK_FILE}.damaged"))).is_err() {
        true => File::open(folder),
        false => open_lock(folder, &path),
    };
    // Where no lock can be made, the folder itself is locked.
    let file = file.or_else(|failed| File::open(folder).map_err(|_| failed)).map_err(IoFault::at(&path, "open"))?;
    lock_file(file, folder)
}

/// Opens the lock, or makes it.
fn open_lock(folder: &Path, path: &Path) -> std::io::Result<File> {
    let file = disk::private(File::options().create(true).truncate(false).write(true)).open(path);
    // A file system that is mounted read-only after a fault of the disk still locks.
    let file = file.or_else(|failed| File::open(path).map_err(|_| failed));
    // That of another owner gives way in a folder that is ours.
    file.or_else(|failed| {
        let aside = folder.join(format!("{LOCK_FILE}.damaged"));
        let moved = disk::rename(path, &aside).is_ok();
        let made = moved.then(|| disk::private(File::options().create_new(true).write(true)).open(path).ok());
        made.flatten().ok_or(failed)
    })
}

fn lock_file(file: File, folder: &Path) -> Result<File, RetainedError> {
    for tries_left in (0..LOCK_TRIES).rev() {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            // A control that is ending, or a program that it has just started, has the lock for some milliseconds.
            Err(TryLockError::WouldBlock) if tries_left > 0 => std::thread::sleep(LOCK_PAUSE),
            Err(TryLockError::WouldBlock) => break,
            Err(TryLockError::Error(cause)) => return Err(IoFault::at(&folder.join(LOCK_FILE), "lock")(cause).into()),
        }
    }
    Err(RetainedError::AlreadyRunning(folder.to_path_buf()))
}

/// Whether another process has a database open although the lock of its folder is gone: one that it writes looks damaged.
pub(super) fn is_in_use(database: &Path) -> bool {
    let is_file = fs::symlink_metadata(database).is_ok_and(|found| found.is_file());
    let file = is_file.then(|| File::open(database).ok()).flatten();
    file.is_some_and(|file| matches!(file.try_lock(), Err(TryLockError::WouldBlock)))
}

/// Whether a lock says that there are data.
pub(super) fn was_used(folder: &Path) -> bool {
    folder.join(LOCK_FILE).metadata().is_ok_and(|lock| lock.len() > 0)
}

/// The identity of the machine to which the data of a folder belong, if its lock says so and is whole.
pub(super) fn identity_in(folder: &Path) -> Option<NonZeroU64> {
    let bytes = atomic_file::read(&folder.join(LOCK_FILE), READ_LIMIT).ok()?;
    let text = std::str::from_utf8(&bytes).ok()?;
    let digits = text.strip_prefix(USED_MARK)?.split_whitespace().next()?;
    let identity = u64::from_str_radix(digits, 16).ok().and_then(NonZeroU64::new)?;
    (mark_of(identity) == text).then_some(identity)
}

/// What the lock holds. A flipped bit must not make the data those of another machine.
fn mark_of(identity: NonZeroU64) -> String {
    format!("{USED_MARK} {identity:016x} {:016x}\n", checksum(&identity.get().to_le_bytes()))
}

/// Notes that there are data, and whose. A lock that cannot be written says nothing: the database says it, too.
pub(super) fn mark_as_used(mut lock: &File, folder: &Path, identity: Option<NonZeroU64>) {
    let is_marked = identity_in(folder) == identity && was_used(folder);
    if !is_marked {
        let text = identity.map_or_else(|| format!("{USED_MARK}\n"), mark_of);
        let written = lock.rewind().and_then(|()| lock.write_all(text.as_bytes()));
        let _ = written.and_then(|()| lock.set_len(text.len() as u64));
    }
}
