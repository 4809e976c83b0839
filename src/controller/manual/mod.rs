//! Manual operation: jog keys, handwheel, homing, dressing points, oscillation key, teach-in.

mod dressing;
mod homing;
mod jog;
mod oscillation_key;
mod teach;

pub use dressing::DressingInput;
pub use jog::{step_jog, turn_handwheel};
pub use oscillation_key::toggle_oscillation;
pub use teach::TeachRecorder;

use crate::defs::text::Text;

const ON_LIMIT_SWITCH: Text =
    Text::new("限位方向，请向反方向移开", "this direction is towards the limit switch: move the other way");

/// The state of manual operation that no other part shares.
#[derive(Clone, Debug, Default)]
pub struct Manual {
    /// The question and the lamp of the dressing points.
    pub dressing: DressingInput,
    /// The teach-in.
    pub teach: TeachRecorder,
}
