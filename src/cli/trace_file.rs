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
        let file = File::create(path).map_err(CallError::at(format!("--trace {name}")))?;
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
