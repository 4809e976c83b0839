//! The log of the server: standard error, which the system keeps.

/// Writes a line to the log.
pub fn log_line(text: &str) {
    use std::io::Write;
    // A log that cannot be written is no reason to end.
    drop(writeln!(std::io::stderr(), "kt830 opcua: {}", one_line(text)));
}

/// What strangers have written stays in its line.
fn one_line(text: &str) -> String {
    let is_break = |sign: char| sign.is_control() || matches!(sign, '\u{2028}' | '\u{2029}');
    text.chars().map(|sign| if is_break(sign) { '?' } else { sign }).collect()
}
