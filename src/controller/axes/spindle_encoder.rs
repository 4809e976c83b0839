//! The main spindle encoder.
//! Source: spec L5.

use super::SECONDS_PER_MINUTE;
use crate::units::Micros;

/// Window for measuring the spindle speed, µs.
const SPEED_WINDOW_US: u64 = 100_000;

/// The main spindle encoder.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpindleEncoder {
    /// Revolutions since power-on, forward positive.
    pub turns: f64,
    window_start: Micros,
    window_start_turns: f64,
    /// Speed, rpm, forward positive.
    pub rpm: f64,
}

impl SpindleEncoder {
    /// Reads the encoder (revolutions) in this tick.
    pub fn read(&mut self, turns: f64, now: Micros) {
        self.turns = turns;
        let span = now.since(self.window_start);
        if span.0 >= SPEED_WINDOW_US {
            self.rpm = (turns - self.window_start_turns) / span.as_secs_f64() * SECONDS_PER_MINUTE;
            (self.window_start_turns, self.window_start) = (turns, now);
        }
    }
}
