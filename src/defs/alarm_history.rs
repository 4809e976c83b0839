//! The alarm history: when and where each alarm was raised and how it was cleared. Retained data. Source: spec B6.

use serde::{Deserialize, Serialize};

use super::date::DateTime;
use super::text::{LocalizedText, Text};

/// Maximum number of alarms in the history; a new alarm replaces the oldest.
pub const MAX_ALARM_HISTORY: usize = 1_000;

/// How an alarm was cleared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum AlarmEnd {
    /// By RESET after its cause was gone.
    Reset,
    /// By itself when its cause was gone.
    Itself,
    /// Power off while it was active.
    PowerOff,
}

impl AlarmEnd {
    /// The name shown.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Reset => Text::new("复位", "RESET"),
            Self::Itself => Text::new("自动消除", "automatic"),
            Self::PowerOff => Text::new("断电", "power off"),
        }
    }
}

/// One entry of the alarm history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PastAlarm {
    /// Serial number of the alarm on this machine, from 1.
    pub count: u64,
    /// Alarm number.
    pub number: u16,
    /// Alarm text.
    pub text: LocalizedText,
    /// Active program and line when it was raised; `None` if no program was running.
    pub place: Option<(u32, u32)>,
    /// When it was raised; without a clock the time since power-on.
    pub came: DateTime,
    /// How and when it was cleared; no time for a power cut. `None` while it is active.
    pub ended: Option<(AlarmEnd, Option<DateTime>)>,
}

impl PastAlarm {
    /// Slot in the retained store: a new entry reuses the slot of the entry it replaces.
    #[must_use]
    pub const fn slot(&self) -> u16 {
        (self.count % MAX_ALARM_HISTORY as u64) as u16
    }
}
