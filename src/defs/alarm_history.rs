//! The alarm history: when and where each alarm was raised and how it was cleared. Retained data. Source: spec B6.

use std::ops::Deref;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::date::DateTime;
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

impl PastAlarm {
    /// Slot in the retained store: a new entry reuses the slot of the entry it replaces.
    #[must_use]
    pub const fn slot(&self) -> u16 {
        (self.count % MAX_ALARM_HISTORY as u64) as u16
    }
}

/// The entries of the history, latest last.
#[derive(Clone, Debug)]
pub struct AlarmHistory {
    /// Shared by the copies that the screen keeps.
    entries: Arc<Vec<PastAlarm>>,
    version: u64,
}

impl AlarmHistory {
    /// The history with these entries, oldest first, in the memory of a full one. Its versions begin at this one: no
    /// earlier history of the machine may have had it.
    #[must_use]
    pub fn new(remembered: impl IntoIterator<Item = PastAlarm>, version: u64) -> Self {
        let mut entries = Vec::with_capacity(MAX_ALARM_HISTORY);
        entries.extend(remembered);
        Self { entries: Arc::new(entries), version }
    }

    /// Counts the changes.
    #[must_use]
    pub const fn version(&self) -> u64 {
        self.version
    }

    /// Appends an entry; the oldest goes if the history is full.
    pub fn push(&mut self, past: PastAlarm) {
        if self.entries.len() >= MAX_ALARM_HISTORY {
            self.entries_mut().remove(0);
        }
        self.entries_mut().push(past);
    }

    /// The entries, to change them.
    pub fn entries_mut(&mut self) -> &mut Vec<PastAlarm> {
        self.version += 1;
        Arc::make_mut(&mut self.entries)
    }

    /// Takes over the entries of another history if they have changed: in place, unless they are shared.
    pub fn copy_from(&mut self, newest: &Self) {
        if self.version != newest.version {
            match Arc::get_mut(&mut self.entries) {
                Some(entries) => entries.clone_from(&newest.entries),
                None => self.entries = Arc::new(newest.to_vec()),
            }
            self.version = newest.version;
        }
    }
}

impl Default for AlarmHistory {
    /// Empty and older than any other.
    fn default() -> Self {
        Self::new([], 0)
    }
}

impl Deref for AlarmHistory {
    type Target = [PastAlarm];

    fn deref(&self) -> &[PastAlarm] {
        &self.entries
    }
}
