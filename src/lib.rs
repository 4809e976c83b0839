//! KT-830: a CNC control for grinding machines.

pub mod defs;
#[cfg(feature = "hmi")]
pub mod hmi;
pub mod io;
pub mod link;
pub mod units;
