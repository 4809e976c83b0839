//! Stories: scripts of operator actions and expected results.
//! Source: spec tools.md T2, T5.

pub mod parse;
pub mod play;

pub use parse::{Line, Statement, StoryError, parse};
pub use play::{Eyes, Player};
