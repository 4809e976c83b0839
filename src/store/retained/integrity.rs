//! Checks a copy of the database in memory before the file is opened, because opening can repair and write the file.

use std::path::Path;

use redb::StorageBackend;
use redb::backends::InMemoryBackend;

use super::check_process;
use super::tables::{self, FORMAT, OLDEST_FORMAT};
use super::{RetainedData, RetainedError, builder};
use crate::store::atomic_file::{self, ReadError};

/// Maximum size of the database, bytes; a thousand times the expected size.
const FILE_LIMIT: u64 = 256 * 1024 * 1024;

/// The data of the file, or what is wrong with it. The file itself is only read.
///
/// An interrupted commit is not damage: the database returns to the commit before, the last acknowledged one.
pub(super) fn read_intact(path: &Path) -> Result<Result<Box<RetainedData>, String>, RetainedError> {
    let bytes = match atomic_file::read(path, FILE_LIMIT) {
        Ok(bytes) => bytes,
        // A bad sector, or a file that belongs to somebody else: the copies are whole.
        Err(ReadError::Io(fault)) => return Ok(Err(fault.to_string())),
        Err(odd @ (ReadError::NotRegular | ReadError::TooLarge { .. } | ReadError::BeingWritten)) => {
            return Ok(Err(odd.to_string()));
        }
    };
    if bytes.is_empty() {
        return Ok(Err("empty: the file was cut off".to_owned()));
    }
    match inspect_apart(&bytes) {
        Ok(DatabaseState::Intact(data)) => Ok(Ok(data)),
        Ok(DatabaseState::Damaged(cause)) => Ok(Err(cause)),
        Ok(DatabaseState::Newer(found)) => Err(RetainedError::Newer { path: path.to_path_buf(), found, known: FORMAT }),
        Err(_) => Ok(Err(UNREADABLE.to_owned())),
    }
}

/// The data of a file that is intact. The file is only read.
pub(super) fn read_whole(path: &Path) -> Option<RetainedData> {
    let bytes = atomic_file::read(path, FILE_LIMIT).ok()?;
    match inspect_apart(&bytes) {
        Ok(DatabaseState::Intact(data)) => Some(*data),
        Ok(DatabaseState::Damaged(_) | DatabaseState::Newer(_)) | Err(_) => None,
    }
}

/// What is wrong with a file at which the inspection itself fails.
const UNREADABLE: &str = "the database cannot read its own file";

enum DatabaseState {
    Intact(Box<RetainedData>),
    Damaged(String),
    Newer(u64),
}

/// Name of the thread that inspects a database.
pub const DATABASE_CHECK_THREAD: &str = "kt830-database-check";

/// Inspects the bytes, which are untrusted: first in a process of its own, which memory without end cannot hurt; then on a
/// thread of its own, as a failed assertion of the database is a finding, not a crash. [`silence_database_check`] keeps
/// it off the console.
fn inspect_apart(bytes: &[u8]) -> std::thread::Result<DatabaseState> {
    if !check_process::comes_to_its_end(bytes) {
        return Ok(DatabaseState::Damaged(UNREADABLE.to_owned()));
    }
    inspect_on_thread(bytes)
}

/// The work of the process that inspects a database: the bytes come on its standard input. It returns if the inspection
/// comes to its end, whatever that finds.
///
/// # Errors
/// The input cannot be read.
pub fn run_database_check() -> std::io::Result<()> {
    let bytes = check_process::receive(FILE_LIMIT)?;
    drop(inspect_on_thread(&bytes));
    Ok(())
}

fn inspect_on_thread(bytes: &[u8]) -> std::thread::Result<DatabaseState> {
    std::thread::scope(|scope| {
        let builder = std::thread::Builder::new().name(DATABASE_CHECK_THREAD.to_owned());
        match builder.spawn_scoped(scope, || inspect(bytes)) {
            Ok(thread) => thread.join(),
            Err(cause) => Ok(DatabaseState::Damaged(cause.to_string())),
        }
    })
}

/// A panic of the database check prints nothing; call it once at the start of the process.
pub fn silence_database_check() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if std::thread::current().name() != Some(DATABASE_CHECK_THREAD) {
            report(panic);
        }
    }));
}

/// Opens the bytes as a database, checks the checksum of every page, then the checksum over the rows.
fn inspect(bytes: &[u8]) -> DatabaseState {
    let backend = InMemoryBackend::default();
    let copied = backend.set_len(bytes.len() as u64).and_then(|()| backend.write(0, bytes));
    if let Err(cause) = copied {
        return DatabaseState::Damaged(cause.to_string());
    }
    let mut database = match builder().create_with_backend(backend) {
        Ok(database) => database,
        Err(cause) => return DatabaseState::Damaged(cause.to_string()),
    };
    match database.check_integrity() {
        Ok(true) => {}
        Ok(false) => return DatabaseState::Damaged("pages do not match their checksums".to_owned()),
        Err(cause) => return DatabaseState::Damaged(cause.to_string()),
    }
    match tables::load(&database) {
        Ok(found) if found.format > FORMAT => DatabaseState::Newer(found.format),
        Ok(found) if found.format < OLDEST_FORMAT => DatabaseState::Damaged(format!("unknown format {}", found.format)),
        Ok(found) if found.stored_sum != found.computed_sum => {
            DatabaseState::Damaged("rows do not match their checksum".to_owned())
        }
        Ok(found) => DatabaseState::Intact(Box::new(found.data)),
        Err(cause) => DatabaseState::Damaged(cause.to_string()),
    }
}
