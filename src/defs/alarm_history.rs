//! The alarm history: when and where each alarm was raised and how it was cleared. Retained data. Source: spec B6.

use serde::{Deserialize, Serialize};

use super::date::DateTime;
use super::history::{History, HistoryEntry};
use super::text::{LocalizedText, SharedWords, Text};

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
    /// The cause that a program gave; empty for alarms of the table.
    #[serde(default, skip_serializing_if = "SharedWords::is_empty")]
    pub cause: SharedWords,
    /// The remedy that a program gave; empty for alarms of the table.
    #[serde(default, skip_serializing_if = "SharedWords::is_empty")]
    pub remedy: SharedWords,
    /// Active program and line when it was raised; `None` if no program was running.
    pub place: Option<(u32, u32)>,
    /// When it was raised; without a clock the time since power-on.
    pub came: DateTime,
    /// How and when it was cleared; no time for a power cut. `None` while it is active.
    pub ended: Option<(AlarmEnd, Option<DateTime>)>,
}

impl HistoryEntry for PastAlarm {
    const CAPACITY: usize = MAX_ALARM_HISTORY;

    fn count(&self) -> u64 {
        self.count
    }
}

/// The alarms of the machine, also those before the last power-off.
pub type AlarmHistory = History<PastAlarm>;
