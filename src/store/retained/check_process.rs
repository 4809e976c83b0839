//! Inspects a database first in a process of its own, on Unix with little memory and processor time.
//!
//! A damaged page number can make the database ask for gigabytes, or end its process, before it looks at its checksums.
//! That must not end the control: neither at its start, nor in operation. Without a program that is named by
//! [`set_check_program`] there is no such process: in tests, and in programs that only use this library.

use std::ffi::OsString;
use std::io::{self, Read, Write};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// How a process is started that calls [`super::run_database_check`]: the program and its arguments.
static PROGRAM: OnceLock<(PathBuf, Vec<OsString>)> = OnceLock::new();

/// Memory of the process beside the file, bytes. A whole database needs some megabytes.
#[cfg(unix)]
const MEMORY: u64 = 512 * 1024 * 1024;
/// Memory of the process per byte of the file: as it is read, as it is inspected, and spare.
#[cfg(unix)]
const MEMORY_FACTOR: u64 = 4;
/// Processor time of the process, seconds. A whole database needs some milliseconds.
#[cfg(unix)]
const CPU_SECONDS: u64 = 20;

/// Names the program and the arguments with which databases are inspected in a process of their own; the first call holds.
pub fn set_check_program(program: PathBuf, arguments: impl IntoIterator<Item = &'static str>) {
    drop(PROGRAM.set((program, arguments.into_iter().map(OsString::from).collect())));
}

/// Whether the inspection of the bytes comes to its end, whatever it finds. Only a process that is killed does not: by its
/// own abort, or by a limit. Where none can be started, watched or limited, the inspection in this process decides.
pub(super) fn comes_to_its_end(bytes: &[u8]) -> bool {
    let Some((program, arguments)) = PROGRAM.get() else { return true };
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    let Ok(mut process) = command.spawn() else { return true };
    if let Some(mut input) = process.stdin.take() {
        // A process that ends early closes its input; its status tells.
        drop(input.write_all(bytes));
    }
    // A process that is killed has no exit status on Unix, and one beyond a byte on Windows.
    process.wait().map_or(true, |status| matches!(status.code(), Some(0..=255)))
}

/// In the process: the bytes of the standard input, and from then on the limits.
///
/// # Errors
/// The input cannot be read.
pub(super) fn receive(size_limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::stdin().lock().take(size_limit).read_to_end(&mut bytes)?;
    limit_this_process(bytes.len() as u64)?;
    Ok(bytes)
}

#[cfg(unix)]
fn limit_this_process(file_bytes: u64) -> io::Result<()> {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let memory = MEMORY.saturating_add(MEMORY_FACTOR.saturating_mul(file_bytes));
    for (resource, limit) in [(Resource::As, memory), (Resource::Cpu, CPU_SECONDS), (Resource::Core, 0)] {
        // A limit that the process was started with cannot be raised.
        let limit = getrlimit(resource).maximum.map_or(limit, |most| most.min(limit));
        setrlimit(resource, Rlimit { current: Some(limit), maximum: Some(limit) })?;
    }
    Ok(())
}

#[cfg(not(unix))]
#[allow(clippy::unnecessary_wraps, reason = "as on Unix")]
fn limit_this_process(_file_bytes: u64) -> io::Result<()> {
    Ok(())
}
