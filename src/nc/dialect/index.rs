//! Indexes a program's text in its dialect when it is loaded. Source: spec B1, B3, L1, S1.

use super::{grinder, sinumerik, superman};
use crate::nc::settings::Dialect;
use crate::nc::source_index::{SourceIndex, TextLines};

/// Indexes what a program can jump to, loop over and call: only what its dialect has.
pub(crate) fn index(dialect: Dialect, lines: &TextLines<'_>) -> SourceIndex {
    match dialect {
        Dialect::LatheA | Dialect::Mill => grinder::index::index(lines),
        Dialect::Sinumerik => sinumerik::index::index(lines),
        Dialect::SuperMan => superman::index::index(lines),
    }
}
