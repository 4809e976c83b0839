//! Whether a part is good. Source: spec K4.5, P5.

use serde::{Deserialize, Serialize};

use super::part_defect::PartDefect;
use super::text::Text;

/// Whether a part is good.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PartVerdict {
    /// Scrap, whatever its size.
    Spoilt(PartDefect),
    /// Within its limits.
    Good,
    /// Beyond a limit.
    Out {
        /// Other places of the same surface are within the limits.
        partly: bool,
    },
    /// It has a size and no limits.
    NoTolerance,
    /// Nobody knows its size.
    NotMeasured,
}

impl PartVerdict {
    /// Whether the part must not be delivered.
    #[must_use]
    pub const fn is_bad(self) -> bool {
        matches!(self, Self::Spoilt(_) | Self::Out { .. })
    }

    /// The verdict on the screen.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Spoilt(defect) => defect.name(),
            Self::Good => Text::new("合格", "OK"),
            Self::Out { partly: true } => Text::new("局部超差", "PARTLY OUT"),
            Self::Out { partly: false } => Text::new("超差", "NOT OK"),
            Self::NoTolerance => Text::new("无公差", "no tolerance"),
            Self::NotMeasured => Text::new("未测量", "not measured"),
        }
    }

    /// The verdict in reports.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Spoilt(defect) => defect.id(),
            Self::Good => "ok",
            Self::Out { .. } => "out-of-tolerance",
            Self::NoTolerance => "no-tolerance",
            Self::NotMeasured => "not-measured",
        }
    }
}
