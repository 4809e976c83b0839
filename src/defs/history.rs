//! An alarm as it is remembered: when it came, where, and how it ended. It outlives a power cut. Source: spec B6.

use serde::{Deserialize, Serialize};

use super::date::Date;
use super::text::{Said, Text};

/// Most alarms remembered; the oldest makes room.
pub const MOST_ALARMS_KEPT: usize = 1_000;

/// How an alarm went away.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum End {
    /// RESET, its cause being gone.
    Reset,
    /// By itself, when its cause was gone.
    Itself,
    /// The power went while it was present.
    PowerOff,
}

impl End {
    /// The name shown.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Reset => Text::new("复位", "RESET"),
            Self::Itself => Text::new("自动消除", "by itself"),
            Self::PowerOff => Text::new("断电", "power off"),
        }
    }
}

/// One alarm of the history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PastAlarm {
    /// Counts the alarms of this machine, from 1.
    pub count: u64,
    /// Its number.
    pub number: u16,
    /// What was the matter.
    pub text: Said,
    /// Program and line under way when it came; none outside a run.
    pub place: Option<(u32, u32)>,
    /// When it came; without a clock the time since power-on.
    pub came: Date,
    /// How it went and when, which nobody knows of a power cut; none while it is present.
    pub ended: Option<(End, Option<Date>)>,
}

impl PastAlarm {
    /// The place in the store: the newest takes that of the one it pushes out.
    #[must_use]
    pub const fn slot(&self) -> u16 {
        (self.count % MOST_ALARMS_KEPT as u64) as u16
    }
}
