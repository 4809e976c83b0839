//! KT-830: a CNC control for grinding machines.

pub mod defs;
pub mod io;
pub mod link;
pub mod machine;
pub mod store;
pub mod units;
