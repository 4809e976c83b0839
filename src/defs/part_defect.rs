//! What makes a part scrap whatever its size. Source: P5, P8.

use serde::{Deserialize, Serialize};

use super::text::Text;

/// What has spoilt a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PartDefect {
    /// The wheel has burnt it.
    Burn,
    /// Something has run into it.
    Crash,
    /// The wheel has ground a flat into it while it stood.
    Flat,
}

impl PartDefect {
    /// Its name on the screen.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Burn => Text::new("烧伤", "BURNT"),
            Self::Crash => Text::new("碰撞", "CRASHED"),
            Self::Flat => Text::new("磨平", "FLAT"),
        }
    }

    /// Its id in reports.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Burn => "burn",
            Self::Crash => "crash",
            Self::Flat => "flat",
        }
    }
}
