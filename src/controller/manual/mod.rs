//! Manual operation: jog keys, handwheel, homing, dressing points, oscillation key, teach-in.

mod dressing;
mod homing;
mod jog;
mod oscillation_key;
mod teach;

pub use dressing::DressingPanel;
pub use jog::{step_jog, turn_handwheel};
pub use oscillation_key::toggle_oscillation;
pub use teach::TeachRecorder;

/// The state of manual operation that no other part shares.
#[derive(Clone, Debug, Default)]
pub struct Manual {
    /// The question and the lamp of the dressing points.
    pub dressing: DressingPanel,
    /// The teach-in.
    pub teach: TeachRecorder,
}
