//! The file of `--trace`: a header, then one line a tick.

use std::fmt::Display;
use std::fs::File;
use std::io::{BufWriter, Error, Write};
use std::path::Path;

use super::CallError;

/// A trace that is being written.
pub struct TraceFile {
    file: BufWriter<File>,
    path: String,
    /// The first error; nothing is written after it.
    error: Option<Error>,
}

impl TraceFile {
    /// Creates the file and writes its header.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn create(path: &Path, header: impl Display) -> Result<Self, CallError> {
        let name = path.display().to_string();
        let what = || format!("--trace {name}");
        // A pipe would wait for a reader for ever.
        if is_pipe(path) {
            return Err(CallError::new(format!("{}: a pipe; name a file", what())));
        }
        let file = File::create(path).map_err(CallError::at(what()))?;
        let mut trace = Self { file: BufWriter::new(file), path: name, error: None };
        trace.write(header);
        Ok(trace)
    }

    /// Writes a line.
    pub fn write(&mut self, line: impl Display) {
        if self.error.is_none() {
            self.error = writeln!(self.file, "{line}").err();
        }
    }

    /// Completes the file.
    ///
    /// # Errors
    /// A line could not be written.
    pub fn finish(mut self) -> Result<(), CallError> {
        let written = self.error.take().map_or(Ok(()), Err).and_then(|()| self.file.flush());
        written.map_err(CallError::at(format!("--trace {}", self.path)))
    }
}

/// Whether a path is a named pipe; what the shell has opened for this process is none.
#[cfg(unix)]
fn is_pipe(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    path.symlink_metadata().is_ok_and(|found| found.file_type().is_fifo())
}

#[cfg(not(unix))]
const fn is_pipe(_path: &Path) -> bool {
    false
}
