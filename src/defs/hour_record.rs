//! How the machine was used, hour by hour. Retained data. Source: spec B6; issue "the face", part 8.

use serde::{Deserialize, Serialize};

use super::date::DateTime;
use super::downtime_reason::DowntimeReason;
use super::history::{History, HistoryEntry};
use super::text::Text;

/// Most hours in the history: 31 days.
pub const MAX_HOUR_RECORDS: usize = 24 * 31;
/// Seconds of an hour.
const HOUR: i64 = 3_600;

/// What the machine does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MachineUse {
    /// A program runs, or axes are homing.
    Running,
    /// A program is held, stopped, or waits for an input.
    Waiting,
    /// An alarm has stopped the machine.
    Alarm,
    /// It is on and nothing runs.
    Idle,
}

impl MachineUse {
    /// All of them, in the order of [`HourRecord::seconds`].
    pub const ALL: [Self; 4] = [Self::Running, Self::Waiting, Self::Alarm, Self::Idle];

    /// The name shown.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Running => Text::new("运行", "running"),
            Self::Waiting => Text::new("等待", "waiting"),
            Self::Alarm => Text::new("报警", "alarm"),
            Self::Idle => Text::new("空闲", "idle"),
        }
    }
}

/// An hour of the day of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct HourRecord {
    /// Hours since 1970-01-01 00:00 local time.
    pub hour: u64,
    /// Seconds of each use, by [`MachineUse::ALL`]; what is missing to an hour the machine was off.
    pub seconds: [u32; MachineUse::ALL.len()],
    /// Seconds without a run that the operator has given a reason for, by [`DowntimeReason::ALL`].
    #[serde(default, skip_serializing_if = "is_unexplained")]
    pub explained: [u32; DowntimeReason::ALL.len()],
    /// Finished parts that are not bad.
    pub good: u32,
    /// Bad parts.
    pub bad: u32,
}

impl HourRecord {
    /// The hour of a date; `None` before 1970.
    #[must_use]
    pub fn hour_of(date: DateTime) -> Option<u64> {
        u64::try_from(date.0.div_euclid(HOUR)).ok()
    }

    /// When it began.
    #[must_use]
    pub const fn began(&self) -> DateTime {
        DateTime(self.hour as i64 * HOUR)
    }

    /// Seconds in which the machine was on.
    #[must_use]
    pub fn seconds_on(&self) -> u32 {
        self.seconds.iter().sum()
    }

    /// Seconds in which the machine stood and nobody has said why.
    #[must_use]
    pub fn seconds_unexplained(&self) -> u32 {
        let stood = self.seconds_on() - self.seconds[MachineUse::Running as usize];
        stood.saturating_sub(self.explained.iter().sum())
    }

    /// Adds another one to it.
    pub fn add(&mut self, other: &Self) {
        self.seconds.iter_mut().zip(other.seconds).for_each(|(sum, more)| *sum += more);
        self.explained.iter_mut().zip(other.explained).for_each(|(sum, more)| *sum += more);
        self.good += other.good;
        self.bad += other.bad;
    }
}

/// Whether no stop has a reason: such an hour is written as a control without reasons writes it.
fn is_unexplained(explained: &[u32; DowntimeReason::ALL.len()]) -> bool {
    explained.iter().all(|seconds| *seconds == 0)
}

impl HistoryEntry for HourRecord {
    const CAPACITY: usize = MAX_HOUR_RECORDS;

    fn count(&self) -> u64 {
        self.hour
    }
}

/// The hours of the last month.
pub type HourHistory = History<HourRecord>;
