//! The phases of a grinding cycle. A program names its phase by `#5828`; the phase is shown and timed, it changes nothing.
//! Source: spec K7.2, K4.5.

use super::text::Text;

/// A phase of a grinding cycle, in the order in which most cycles pass through them. The value is that of `#5828`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum GrindingPhase {
    /// The wheel is dressed.
    Dressing = 1,
    /// The part, or the wheel, is measured before grinding.
    Measuring = 2,
    /// The wheel approaches in rapid traverse.
    Approach = 3,
    /// The wheel infeeds and does not touch the part yet.
    AirGrinding = 4,
    /// Most of the stock is removed.
    Roughing = 5,
    /// The last of the stock is removed.
    Finishing = 6,
    /// The wheel grinds without infeed until the part has sprung back.
    SparkOut = 7,
    /// The wheel leaves the part.
    Retract = 8,
}

impl GrindingPhase {
    /// All phases, in order.
    pub const ALL: [Self; 8] = [
        Self::Dressing,
        Self::Measuring,
        Self::Approach,
        Self::AirGrinding,
        Self::Roughing,
        Self::Finishing,
        Self::SparkOut,
        Self::Retract,
    ];

    /// The phase of a value of `#5828`; none for 0 and for numbers without a phase.
    #[must_use]
    pub fn of_number(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|phase| *phase as u32 == number)
    }

    /// Its place in [`Self::ALL`].
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize - 1
    }

    /// The name on the screen.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Dressing => Text::new("修整", "dress"),
            Self::Measuring => Text::new("测量", "measure"),
            Self::Approach => Text::new("快进", "approach"),
            Self::AirGrinding => Text::new("空磨", "air"),
            Self::Roughing => Text::new("粗磨", "rough"),
            Self::Finishing => Text::new("精磨", "finish"),
            Self::SparkOut => Text::new("光磨", "spark"),
            Self::Retract => Text::new("退刀", "retract"),
        }
    }
}
