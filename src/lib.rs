//! KT-830: a CNC control for grinding machines.

pub mod motion;
pub mod units;
