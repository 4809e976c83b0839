//! The pages. Each one draws from the view, and keeps nothing but its cursor and its edit text.

pub mod directory;
pub mod empty;
pub mod grinding;
pub mod position;
pub mod program;
pub mod scroll;
