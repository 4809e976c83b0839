//! An error in a line of a program, as the pages show it.

use crate::defs::text::LocalizedText;

/// An error in a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineFault {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Cause and remedy.
    pub message: LocalizedText,
}
