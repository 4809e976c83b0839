//! Whether the reference clock of the bus has jumped. A clock that was set, or whose device began anew, asks for other
//! ticks, and the drives would take the set-points at other times than they were made for.

use super::ClockReading;

/// Most that two clocks may drift apart: 1000 ppm. Crystals are within 100, and a clock that the network sets within 500.
const DRIFT_PART: u64 = 1_000;
/// Where a clock of 32 bits begins anew, ns.
const CLOCK_32_BITS: u64 = 1 << 32;
/// Resolution of the times, ns.
const RESOLUTION_NS: u64 = 1_000;

/// Watches the reference clock against that of this computer.
#[derive(Clone, Copy, Debug, Default)]
pub struct ClockWatch {
    before: Option<ClockReading>,
}

impl ClockWatch {
    /// What comes belongs to clocks that were set anew.
    pub const fn forget(&mut self) {
        self.before = None;
    }

    /// Whether the clock has jumped since the last reading. A frame passes the clock after it was sent and before it came
    /// back; between two readings both clocks have gone on alike, within these times. So a frame that was late is no jump.
    pub fn has_jumped(&mut self, reading: ClockReading) -> bool {
        let Some(before) = self.before.replace(reading) else { return false };
        // A clock of 32 bits begins anew every 4.3 s.
        let wraps = reading.time_ns < before.time_ns && before.time_ns < CLOCK_32_BITS;
        let time_ns = reading.time_ns + if wraps { CLOCK_32_BITS } else { 0 };
        let Some(passed) = time_ns.checked_sub(before.time_ns) else { return true };
        let least = reading.sent_ns.saturating_sub(before.received_ns);
        let most = reading.received_ns.saturating_sub(before.sent_ns);
        let drift = most / DRIFT_PART + RESOLUTION_NS;
        passed + drift < least || passed > most + drift
    }
}
