//! The command as a user calls it.

#![allow(dead_code, clippy::unwrap_used, reason = "a test driver: a failure is the message")]

use std::path::Path;
use std::process::{Command, Output};

/// Calls the command in the repository, with a data directory of its own and without a display.
pub fn kt830(words: &[&str]) -> Output {
    let data = tempfile::tempdir().unwrap();
    kt830_in(Path::new(env!("CARGO_MANIFEST_DIR")), data.path(), words)
}

/// The same in another folder.
pub fn kt830_in(folder: &Path, data: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_kt830"))
        .args(words)
        .current_dir(folder)
        .env("XDG_DATA_HOME", data)
        .env("HOME", data)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .unwrap()
}
