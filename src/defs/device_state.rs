//! States of a device on a field bus.
//! Source: ETG.1000.6 (AL status).

use super::text::Text;

/// State of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviceState {
    /// It does not answer.
    #[default]
    Missing,
    /// Just on.
    Init,
    /// It can be set up.
    PreOperational,
    /// It sends inputs; its outputs are safe.
    SafeOperational,
    /// In operation.
    Operational,
}

impl DeviceState {
    /// Name of the state, as the standard has it.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Missing => Text::new("没有应答", "missing"),
            Self::Init => Text::new("INIT", "INIT"),
            Self::PreOperational => Text::new("PRE-OP", "PRE-OP"),
            Self::SafeOperational => Text::new("SAFE-OP", "SAFE-OP"),
            Self::Operational => Text::new("OP", "OP"),
        }
    }
}
