//! Protection of values: whether a page may change them now.
//! Source: spec K7.7.

use super::PartsView;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text};

const LOCKED: Text = Text::new("P22.0=0：不允许修改", "P22.0=0: locked");
const NOT_IN_RUN: Text = Text::new("程序运行中不能修改 (P6.3)", "not allowed while a program runs (P6.3)");

/// K7.7: protection (P22.0) of wear and variables on the offset and the macro page.
pub fn check_unlocked(parts: PartsView<'_>) -> Result<(), LocalizedText> {
    if parts.plant.params.bit(param::EDIT_OFFSETS) { Ok(()) } else { Err(LOCKED.into()) }
}

/// K7.7: no edit while a run is open, unless P6.3 allows it.
pub fn check_not_running(parts: PartsView<'_>) -> Result<(), LocalizedText> {
    let allowed = parts.plant.params.bit(param::EDIT_VALUES_IN_RUN);
    if !parts.program.is_open() || allowed { Ok(()) } else { Err(NOT_IN_RUN.into()) }
}
