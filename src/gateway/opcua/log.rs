//! The log of the server: standard error, which the system keeps.

/// Writes a line to the log.
pub fn log_line(text: &str) {
    use std::io::Write;
    // A log that cannot be written is no reason to end.
    drop(writeln!(std::io::stderr(), "kt830 opcua: {text}"));
}
