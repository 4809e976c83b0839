//! The times of the values that the server shows: that of the tick, on a clock that never runs back.

use std::cell::Cell;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use chrono::{TimeDelta, Utc};
use opcua::types::DateTime;

/// A clock may be so far from one that runs on before the server begins anew with it.
const CLOCK_TOLERANCE: Duration = Duration::from_secs(2);

/// Gives values their times. The control may be on another computer, with a clock that is behind this one, ahead of it, or
/// set meanwhile; a value with an older time than the one before would be held back by the library.
pub struct SourceClock {
    wall: Duration,
    begun: Instant,
    /// The newest time of a value.
    newest: Cell<chrono::DateTime<Utc>>,
    /// The control is behind this clock by this.
    lag: Cell<TimeDelta>,
    /// The clock of the control was set back.
    is_set_back: Cell<bool>,
}

impl SourceClock {
    /// A clock that runs on from the time of day.
    pub fn new() -> Self {
        Self {
            wall: time_of_day(),
            begun: Instant::now(),
            newest: Cell::default(),
            lag: Cell::default(),
            is_set_back: Cell::default(),
        }
    }

    /// The time of this computer.
    pub fn now(&self) -> DateTime {
        DateTime::from(self.time())
    }

    /// A time of the control, if it is not to come.
    pub fn not_ahead(&self, time: DateTime) -> DateTime {
        DateTime::from(time.as_chrono().min(self.time()))
    }

    /// The time of values of the control's tick at `tick`, of which it has told `age` ago.
    pub fn of_tick(&self, tick: DateTime, age: Duration) -> DateTime {
        self.of_tick_at(tick.as_chrono(), self.time(), TimeDelta::from_std(age).unwrap_or_default())
    }

    fn of_tick_at(&self, tick: chrono::DateTime<Utc>, now: chrono::DateTime<Utc>, age: TimeDelta) -> DateTime {
        let told = tick.min(now);
        self.is_set_back.set(self.newest.get() - told > tolerance());
        self.lag.set((now - age - tick).max(TimeDelta::zero()));
        self.advance(told)
    }

    /// The time of what has changed now without a tick that says it: what time the control has, as far as is known.
    pub fn of_no_tick(&self) -> DateTime {
        self.of_no_tick_at(self.time())
    }

    fn of_no_tick_at(&self, now: chrono::DateTime<Utc>) -> DateTime {
        self.advance(now - self.lag.get())
    }

    /// Whether the clock of the system, or that of the control, was set meanwhile.
    pub fn is_wrong(&self) -> bool {
        self.is_set_back.get() || self.elapsed().abs_diff(time_of_day()) > CLOCK_TOLERANCE
    }

    fn advance(&self, to: chrono::DateTime<Utc>) -> DateTime {
        self.newest.set(to.max(self.newest.get()));
        DateTime::from(self.newest.get())
    }

    fn elapsed(&self) -> Duration {
        self.wall + self.begun.elapsed()
    }

    fn time(&self) -> chrono::DateTime<Utc> {
        chrono::DateTime::from(UNIX_EPOCH + self.elapsed())
    }
}

fn tolerance() -> TimeDelta {
    TimeDelta::from_std(CLOCK_TOLERANCE).unwrap_or_default()
}

fn time_of_day() -> Duration {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(milliseconds: i64) -> chrono::DateTime<Utc> {
        chrono::DateTime::from_timestamp_millis(1_800_000_000_000 + milliseconds).expect("a time")
    }

    #[test]
    fn values_are_as_old_as_their_tick_and_never_from_the_future() {
        let clock = SourceClock::new();
        assert_eq!(clock.of_tick_at(at(960), at(1_000), TimeDelta::zero()).as_chrono(), at(960));
        assert_eq!(
            clock.of_tick_at(at(9_000), at(1_100), TimeDelta::zero()).as_chrono(),
            at(1_100),
            "its clock is ahead"
        );
        assert!(!clock.is_wrong());
    }

    #[test]
    fn what_no_tick_says_is_of_now_on_the_clock_of_the_control() {
        let clock = SourceClock::new();
        // An hour behind. An order comes ten minutes after its newest value.
        clock.of_tick_at(at(0), at(3_600_000), TimeDelta::zero());
        assert_eq!(clock.of_no_tick_at(at(4_200_000)).as_chrono(), at(600_000));
        // It has not changed by that how far the control is behind.
        assert_eq!(clock.of_no_tick_at(at(4_201_000)).as_chrono(), at(601_000));
        assert_eq!(clock.of_tick_at(at(601_500), at(4_201_500), TimeDelta::zero()).as_chrono(), at(601_500));
        assert!(!clock.is_wrong());
    }

    #[test]
    fn how_old_a_welcome_is_does_not_count_as_a_difference_of_the_clocks() {
        let clock = SourceClock::new();
        clock.of_tick_at(at(1_000), at(1_600), TimeDelta::milliseconds(560));
        assert_eq!(clock.of_no_tick_at(at(60_000)).as_chrono(), at(59_960), "40 ms from the tick to the line");
    }

    #[test]
    fn times_never_run_back_and_a_clock_that_does_is_said() {
        let clock = SourceClock::new();
        clock.of_tick_at(at(5_000), at(5_000), TimeDelta::zero());
        assert_eq!(clock.of_tick_at(at(4_000), at(5_010), TimeDelta::zero()).as_chrono(), at(5_000));
        assert!(!clock.is_wrong(), "within the tolerance");
        assert_eq!(clock.of_tick_at(at(2_900), at(5_020), TimeDelta::zero()).as_chrono(), at(5_000));
        assert!(clock.is_wrong());
    }
}
