//! Stories: scripts of operator actions and expected results.
//! Source: spec tools.md T2, T5.

pub mod parse;
pub mod play;
mod stage;
pub mod statement;

pub use parse::parse;
pub use play::{PageReader, Player};
pub use stage::{NOT_TORTURED, Stage};
pub use statement::{Statement, StoryError, StoryLine};
