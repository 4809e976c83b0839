//! KT-830: a CNC control for grinding machines.

pub mod cli;
pub mod controller;
pub mod defs;
#[cfg(feature = "hmi")]
pub mod hmi;
pub mod io;
pub mod link;
pub mod machine;
pub mod motion;
pub mod nc;
pub mod runtime;
pub mod store;
pub mod story;
pub mod units;
