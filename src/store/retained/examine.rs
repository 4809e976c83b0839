//! Looks at a database in memory before the file is opened: opening repairs, and repair writes.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use redb::StorageBackend;
use redb::backends::InMemoryBackend;

use super::tables::{self, FORMAT, OLDEST};
use super::{RetainedError, builder};
use crate::store::whole_file::{self, ReadError};

/// The largest database, in bytes; a thousand times what is kept.
const FILE_LIMIT: u64 = 256 * 1024 * 1024;

/// What is wrong with the file; `None` when it is whole. The file itself is only read.
///
/// An interrupted commit is no damage: the database falls back to the commit before, which was the last acknowledged.
pub(super) fn damage(path: &Path) -> Result<Option<String>, RetainedError> {
    let bytes = match whole_file::read(path, FILE_LIMIT) {
        Ok(bytes) => bytes,
        Err(ReadError::Io(fault)) => return Err(fault.into()),
        Err(odd @ (ReadError::NotPlain | ReadError::TooLarge { .. } | ReadError::Changing)) => {
            return Ok(Some(odd.to_string()));
        }
    };
    if bytes.is_empty() {
        return Ok(Some("empty: the file was cut off".to_owned()));
    }
    // Bytes from anywhere reach the database here; its assertions count as findings, not as crashes.
    let found = catch_unwind(AssertUnwindSafe(|| look(&bytes)));
    match found {
        Ok(Finding::Whole) => Ok(None),
        Ok(Finding::Damaged(cause)) => Ok(Some(cause)),
        Ok(Finding::Newer(found)) => Err(RetainedError::Newer { path: path.to_path_buf(), found, known: FORMAT }),
        Err(_) => Ok(Some("the database does not understand its own file".to_owned())),
    }
}

enum Finding {
    Whole,
    Damaged(String),
    Newer(u64),
}

/// Opens the bytes as a database, checks every page's checksum, then the rows against their own.
fn look(bytes: &[u8]) -> Finding {
    let backend = InMemoryBackend::default();
    let copied = backend.set_len(bytes.len() as u64).and_then(|()| backend.write(0, bytes));
    if let Err(cause) = copied {
        return Finding::Damaged(cause.to_string());
    }
    let mut database = match builder().create_with_backend(backend) {
        Ok(database) => database,
        Err(cause) => return Finding::Damaged(cause.to_string()),
    };
    match database.check_integrity() {
        Ok(true) => {}
        Ok(false) => return Finding::Damaged("pages do not fit their checksums".to_owned()),
        Err(cause) => return Finding::Damaged(cause.to_string()),
    }
    match tables::load(&database) {
        Ok(found) if found.format > FORMAT => Finding::Newer(found.format),
        Ok(found) if found.format < OLDEST => Finding::Damaged(format!("unknown format {}", found.format)),
        Ok(found) if found.stated != found.counted => Finding::Damaged("rows do not fit their checksum".to_owned()),
        Ok(_) => Finding::Whole,
        Err(cause) => Finding::Damaged(cause.to_string()),
    }
}
