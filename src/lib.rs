//! KT-830: a CNC control for grinding machines.

pub mod defs;
pub mod nc;
pub mod units;
