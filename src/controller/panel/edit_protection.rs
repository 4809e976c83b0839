//! Protection of values: whether a page may change them now.
//! Source: spec K7.7.

use super::PartsView;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text};
use crate::link::edit::LOCKED_IN_RUN;

const LOCKED: Text = Text::new("P22.0=0：不允许修改", "P22.0=0: locked");

/// K7.7: protection (P22.0) of wear and variables on the offset and the macro page.
pub fn check_unlocked(parts: PartsView<'_>) -> Result<(), LocalizedText> {
    if parts.plant.params.bit(param::EDIT_OFFSETS) { Ok(()) } else { Err(LOCKED.into()) }
}

/// K7.7: no edit while a run is open, unless P6.3 allows it.
pub fn check_not_running(parts: PartsView<'_>) -> Result<(), LocalizedText> {
    let allowed = parts.plant.params.bit(param::EDIT_VALUES_IN_RUN);
    if !parts.program.is_open() || allowed { Ok(()) } else { Err(LOCKED_IN_RUN.into()) }
}
