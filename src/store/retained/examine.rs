//! Checks a copy of the database in memory before the file is opened, because opening can repair and write the file.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use redb::StorageBackend;
use redb::backends::InMemoryBackend;

use super::tables::{self, FORMAT, OLDEST};
use super::{RetainedError, builder};
use crate::store::whole_file::{self, ReadError};

/// Maximum size of the database, bytes; a thousand times the expected size.
const FILE_LIMIT: u64 = 256 * 1024 * 1024;

/// What is wrong with the file; `None` if it is intact. The file itself is only read.
///
/// An interrupted commit is not damage: the database returns to the commit before, the last acknowledged one.
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
    // The bytes are untrusted: a failed assertion of the database is a finding, not a crash.
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

/// Opens the bytes as a database, checks the checksum of every page, then the checksum over the rows.
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
