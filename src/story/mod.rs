//! Stories: what an operator does at the control, as text, and what is to be seen then.
//! Source: spec tools.md T2, T5.

pub mod parse;
pub mod play;

pub use parse::{Line, Statement, StoryError, parse};
pub use play::{Eyes, Player};
