//! Date and time of day: the system clock plus the offset set at the machine. Control logic never uses it: its own
//! time is counted in ticks. Source: spec B6 (设置: clock).

use super::{Panel, Parts};
use crate::controller::storage_request::StorageRequest;
use crate::defs::date::{DateTime, YEARS};
use crate::defs::text::phrase;
use crate::units::Micros;

/// The calendar resynchronises when the system clock differs by at least this, s. Truncation to whole seconds at
/// different moments then does not make the date jump.
const RESYNC_S: i64 = 2;

/// Calendar: date of power-on and the offset set at the machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Calendar {
    /// System clock at power-on.
    power_on: Option<DateTime>,
    /// Date set at the machine minus system clock, s.
    offset_s: i64,
}

impl Calendar {
    /// At power-on only the offset is known.
    #[must_use]
    pub const fn new(offset_s: i64) -> Self {
        Self { power_on: None, offset_s }
    }

    /// Takes a reading of the system clock. Returns the date of power-on when it first becomes known.
    pub fn sync(&mut self, now: Micros, told: DateTime) -> Option<DateTime> {
        let power_on = DateTime(told.0 - seconds(now));
        if self.power_on.is_none_or(|known| (known.0 - power_on.0).abs() >= RESYNC_S) {
            let first = self.power_on.replace(power_on).is_none();
            return first.then_some(DateTime(power_on.0 + self.offset_s));
        }
        None
    }

    /// Date and time at a moment; `None` while the system clock is unknown.
    #[must_use]
    pub fn date(&self, now: Micros) -> Option<DateTime> {
        self.power_on.map(|power_on| DateTime(power_on.0 + self.offset_s + seconds(now)))
    }

    /// Date and time, or the time since power-on while the date is unknown.
    #[must_use]
    pub fn timestamp(&self, now: Micros) -> DateTime {
        self.date(now).unwrap_or(DateTime(seconds(now)))
    }

    /// The offset that makes this the present date, s; `None` while the system clock is unknown.
    fn offset_for(&self, now: Micros, wanted: DateTime) -> Option<i64> {
        self.power_on.map(|power_on| wanted.0 - power_on.0 - seconds(now))
    }
}

const fn seconds(now: Micros) -> i64 {
    (now.0 / 1_000_000) as i64
}

impl Panel {
    /// Takes a reading of the system clock.
    pub fn take_clock(&mut self, parts: &mut Parts<'_>, told: DateTime) {
        if let Some(power_on) = self.calendar.sync(parts.plant.now, told) {
            parts.plant.alarms.set_power_on_date(power_on);
        }
    }

    /// Sets the displayed date and time. No motion depends on them.
    pub fn set_date(&mut self, parts: &mut Parts<'_>, wanted: DateTime) {
        let [year, ..] = wanted.parts();
        if !YEARS.contains(&year) {
            let (from, to) = (*YEARS.start(), *YEARS.end());
            return parts.plant.refuse(phrase!("年份应为 {from}-{to}", "the year must be {from} to {to}", from, to));
        }
        let Some(offset_s) = self.calendar.offset_for(parts.plant.now, wanted) else {
            return parts.plant.refuse(phrase!("没有系统时钟", "the computer has no clock"));
        };
        self.calendar.offset_s = offset_s;
        parts.plant.store(StorageRequest::ClockOffset(offset_s));
        parts.plant.show_note(phrase!("日期时间已设为 {wanted}", "date and time set to {wanted}", wanted));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b6_the_date_follows_the_computers_clock_with_what_was_set() {
        let mut calendar = Calendar::new(60);
        assert_eq!((calendar.date(Micros(9_000_000)), calendar.timestamp(Micros(9_000_000))), (None, DateTime(9)));
        assert_eq!(calendar.sync(Micros(9_000_000), DateTime(1_009)), Some(DateTime(1_060)));
        assert_eq!(calendar.date(Micros(10_000_000)), Some(DateTime(1_070)));
        // One second off is rounding at the moment of reading, not a changed clock.
        assert_eq!(calendar.sync(Micros(10_000_000), DateTime(1_011)), None);
        assert_eq!(calendar.date(Micros(10_000_000)), Some(DateTime(1_070)));
        calendar.sync(Micros(10_000_000), DateTime(5_010));
        assert_eq!(calendar.date(Micros(10_000_000)), Some(DateTime(5_070)));
        assert_eq!(calendar.offset_for(Micros(10_000_000), DateTime(5_000)), Some(-10));
    }
}
