//! The parts that the machine has finished, with their sizes. Retained data. Source: spec K4.5, K5.17, B6.

use serde::{Deserialize, Serialize};

use super::date::DateTime;
use super::history::{History, HistoryEntry};
use super::part_verdict::PartVerdict;

/// Most parts in the history; a new part replaces the oldest.
pub const MAX_PART_RECORDS: usize = 1_000;

/// Most alarms that are kept with a part.
pub const MAX_PART_ALARMS: usize = 4;

/// A finished part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartRecord {
    /// Serial number of the part on this machine, from 1; never reset.
    pub count: u64,
    /// Its number in the part count.
    pub number: u32,
    /// The program.
    pub program: u32,
    /// The production order that it belongs to; 0 for none.
    pub order: u32,
    /// When the cycle ended; without a clock the time since power-on.
    pub ended: DateTime,
    /// Cycle time, s.
    pub cycle_seconds: f64,
    /// Measured size, mm; `None` if nobody has measured it.
    pub size: Option<f64>,
    /// Nominal, least and greatest size, mm, as in force at its end; `None` without a tolerance.
    pub limits: Option<[f64; 3]>,
    /// Whether it is good.
    pub verdict: PartVerdict,
    /// Parts ground since the last dressing, this one included.
    pub since_dressing: u32,
    /// Diameter of the wheel at its end, mm (P77); `None` on machines without a wheel.
    #[serde(default)]
    pub wheel_mm: Option<f64>,
    /// Numbers of the alarms since the part before it, the newest first; 0 where there was none.
    #[serde(default)]
    pub alarms: [u16; MAX_PART_ALARMS],
}

impl HistoryEntry for PartRecord {
    const CAPACITY: usize = MAX_PART_RECORDS;

    fn count(&self) -> u64 {
        self.count
    }
}

/// The finished parts of the machine, also those before the last power-off.
pub type PartHistory = History<PartRecord>;
