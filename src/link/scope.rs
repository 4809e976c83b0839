//! The scope: up to four signals, tick by tick. What is asked of it, and what it has recorded.
//! Source: issue "a real machine", part 6.

use std::sync::Arc;

use crate::defs::scope_signal::ScopeSignal;
use crate::units::Micros;

/// Number of signals that are recorded together.
pub const SCOPE_CHANNELS: usize = 4;
/// Greatest number of samples of a recording.
pub const MAX_SCOPE_SAMPLES: usize = 4_000;
/// Level of a trigger on an input or output.
pub const DIGITAL_LEVEL: f64 = 0.5;
/// The times that a recording can last; up to the first two every tick of 1 ms is a sample.
pub const SCOPE_SPANS: [Micros; 5] = [
    Micros::from_millis(500),
    Micros::from_millis(4_000),
    Micros::from_millis(20_000),
    Micros::from_millis(60_000),
    Micros::from_millis(300_000),
];

/// When a recording begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ScopeTrigger {
    /// At once.
    #[default]
    Now,
    /// When the first signal rises above this level; a fifth of the time is kept before it. An input or output rises
    /// through [`DIGITAL_LEVEL`] whatever the level.
    Rising(f64),
    /// When the first signal falls below this level.
    Falling(f64),
}

impl ScopeTrigger {
    /// Its edge as an arrow.
    #[must_use]
    pub const fn arrow(self) -> &'static str {
        match self {
            Self::Now => "–",
            Self::Rising(_) => "↑",
            Self::Falling(_) => "↓",
        }
    }
}

/// What is recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScopeSetup {
    /// The signals; the first one is that of the trigger.
    pub channels: [Option<ScopeSignal>; SCOPE_CHANNELS],
    /// How long a recording lasts.
    pub span: Micros,
    /// When it begins.
    pub trigger: ScopeTrigger,
}

/// What the page asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScopeCommand {
    /// A new recording takes the place of the last one.
    Start(ScopeSetup),
    /// The recording ends here.
    Stop,
}

/// How far it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScopeState {
    /// Nothing is recorded.
    #[default]
    Idle,
    /// It waits for its trigger.
    Armed,
    /// It records.
    Recording,
}

/// One recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScopeRecording {
    /// Number of the recording since power-on, from 1; 0: none.
    pub number: u32,
    /// What was asked for.
    pub setup: ScopeSetup,
    /// X is in diameters.
    pub x_as_diameter: bool,
    /// Time between two samples.
    pub period: Micros,
    /// Cycle of the control.
    pub cycle: Micros,
    /// Index of the sample of the trigger; 0 without one.
    pub trigger_index: usize,
    /// The samples, the oldest first; 0 in a channel without a signal.
    pub samples: Vec<[f64; SCOPE_CHANNELS]>,
}

/// The scope, as the page shows it. Two are equal if they hold the same recording, not one with the same samples.
#[derive(Clone, Debug, Default)]
pub struct ScopeView {
    /// How far it is.
    pub state: ScopeState,
    /// What is recorded, or was recorded last.
    pub recording: Arc<ScopeRecording>,
}

impl PartialEq for ScopeView {
    fn eq(&self, other: &Self) -> bool {
        self.state == other.state && Arc::ptr_eq(&self.recording, &other.recording)
    }
}

impl ScopeRecording {
    /// A recording with room for the greatest number of samples.
    #[must_use]
    pub fn with_capacity() -> Self {
        Self { samples: Vec::with_capacity(MAX_SCOPE_SAMPLES), ..Self::default() }
    }

    /// Time of a sample after the trigger, s.
    #[must_use]
    pub fn seconds(&self, sample: usize) -> f64 {
        (sample as f64 - self.trigger_index as f64) * self.period.as_secs_f64()
    }

    /// Least and greatest value of a channel from one sample to before another; none without a sample.
    #[must_use]
    pub fn extremes(&self, channel: usize, samples: std::ops::Range<usize>) -> Option<(f64, f64)> {
        let values = self.samples.get(samples)?.iter().map(|row| row[channel]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        (low <= high).then_some((low, high))
    }
}
