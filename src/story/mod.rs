//! Stories: scripts of operator actions and expected results.
//! Source: spec tools.md T2, T5.

pub mod parse;
pub mod play;
pub mod statement;

pub use parse::parse;
pub use play::{PageReader, Player, Stage};
pub use statement::{Statement, StoryError, StoryLine};
