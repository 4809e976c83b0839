//! The state of the outputs and of the drives.

use crate::defs::signal::OutputSet;
use crate::io::OutputImage;

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
}

impl Default for Outputs {
    fn default() -> Self {
        Self { image: OutputImage::default(), on: OutputSet::NONE, unusable: OutputSet::NONE, drives_on: true }
    }
}
