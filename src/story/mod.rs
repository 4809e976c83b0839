//! Stories: scripts of operator actions and expected results.
//! Source: spec tools.md T2, T5.

pub mod parse;
pub mod play;

pub use parse::{Statement, StoryError, StoryLine, parse};
pub use play::{PageReader, Player};
