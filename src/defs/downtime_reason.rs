//! Why the machine stands, as the operator says it. Source: spec B6; issue "the face", part 8.

use super::text::Text;

/// A reason for a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DowntimeReason {
    /// No parts to grind.
    NoParts,
    /// Set-up for another part.
    SetUp,
    /// Wheel change, dressing, balancing.
    Wheel,
    /// Measuring, inspection.
    Measuring,
    /// Repair, maintenance.
    Repair,
    /// Break, meeting.
    Break,
}

impl DowntimeReason {
    /// All of them, in the order of the times of an hour.
    pub const ALL: [Self; 6] = [Self::NoParts, Self::SetUp, Self::Wheel, Self::Measuring, Self::Repair, Self::Break];

    /// The name shown.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::NoParts => Text::new("缺料", "no parts"),
            Self::SetUp => Text::new("换型", "set-up"),
            Self::Wheel => Text::new("砂轮", "wheel"),
            Self::Measuring => Text::new("测量", "measuring"),
            Self::Repair => Text::new("维修", "repair"),
            Self::Break => Text::new("休息", "break"),
        }
    }

    /// Its word in stories, tables and accessible names.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::NoParts => "no-parts",
            Self::SetUp => "set-up",
            Self::Wheel => "wheel",
            Self::Measuring => "measuring",
            Self::Repair => "repair",
            Self::Break => "break",
        }
    }
}
