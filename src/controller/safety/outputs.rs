//! The state of the outputs and of the drives.

use crate::defs::signal::OutputSet;
use crate::io::OutputImage;
use crate::io::drive::DriveState;
use crate::units::{Micros, PerAxis};

/// The outputs.
#[derive(Clone, Debug)]
pub struct Outputs {
    /// The output image of the last tick.
    pub image: OutputImage,
    /// Outputs by function, as of the last tick.
    pub on: OutputSet,
    /// Outputs without a port of their own: they cannot be switched.
    pub unusable: OutputSet,
    /// The drives are to be on.
    pub drives_on: bool,
    /// RESET was pressed in this tick.
    pub fault_reset: bool,
    /// Supervision of the drives.
    pub drives: DriveSupervision,
}

/// What the supervision remembers of the drives.
#[derive(Clone, Copy, Debug, Default)]
pub struct DriveSupervision {
    /// States in the tick before.
    pub before: PerAxis<DriveState>,
    /// Since when the drives are to be on and not all of them are.
    pub switching_since: Option<Micros>,
    /// Until when RESET goes on.
    pub reset_until: Option<Micros>,
    /// Axes that have tripped with a code that is not read yet.
    pub code_awaited: PerAxis<bool>,
}

impl Default for Outputs {
    fn default() -> Self {
        Self {
            image: OutputImage::default(),
            on: OutputSet::NONE,
            unusable: OutputSet::NONE,
            drives_on: true,
            fault_reset: false,
            drives: DriveSupervision::default(),
        }
    }
}
