//! Date and time of day in local time. This module never reads a clock. Source: spec B6 (clock, alarms).

use serde::{Deserialize, Serialize};

const MINUTE: i64 = 60;
const HOUR: i64 = 3_600;
const DAY: i64 = 86_400;
/// The years that can be set.
pub const YEARS: std::ops::RangeInclusive<i64> = 2_020..=2_099;

/// Seconds since 1970-01-01 00:00:00 local time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct DateTime(pub i64);

impl DateTime {
    /// A date from year, month, day, hour, minute, second; `None` if the date or time is invalid.
    #[must_use]
    pub fn from_parts(parts: [i64; 6]) -> Option<Self> {
        let [year, month, day, hour, minute, second] = parts;
        let good = (0..24).contains(&hour) && (0..60).contains(&minute) && (0..60).contains(&second);
        let good = good && (1..=12).contains(&month) && day >= 1 && day <= days_in_month(year, month);
        let seconds = days_to_month(year, month) + day - 1;
        good.then_some(Self(seconds * DAY + hour * HOUR + minute * MINUTE + second))
    }

    /// Year, month, day, hour, minute, second.
    #[must_use]
    pub fn parts(self) -> [i64; 6] {
        let (days, rest) = (self.0.div_euclid(DAY), self.0.rem_euclid(DAY));
        // A year has 365.2425 days on average: the first guess is off by one at most.
        let mut year = 1_970 + (days * 400).div_euclid(146_097);
        while days_to_month(year, 1) > days {
            year -= 1;
        }
        while days_to_month(year + 1, 1) <= days {
            year += 1;
        }
        let month = (1..=12).rev().find(|month| days_to_month(year, *month) <= days).unwrap_or(1);
        let day = days - days_to_month(year, month) + 1;
        [year, month, day, rest / HOUR, rest / MINUTE % 60, rest % MINUTE]
    }

    /// Parses `2026-11-21 15:01:56`; `None` if the format differs or the date or time is invalid.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let (day, time) = text.split_once(' ')?;
        let numbers = day.split('-').chain(time.split(':')).map(|part| part.parse::<i64>());
        Self::from_parts(numbers.collect::<Result<Vec<_>, _>>().ok()?.try_into().ok()?)
    }

    /// `15:01:56`
    #[must_use]
    pub fn time(self) -> String {
        let [.., hour, minute, second] = self.parts();
        format!("{hour:02}:{minute:02}:{second:02}")
    }

    /// `2026-11-21`
    #[must_use]
    pub fn day(self) -> String {
        let [year, month, day, ..] = self.parts();
        format!("{year:04}-{month:02}-{day:02}")
    }

    /// `20261121-150156`, for file names.
    #[must_use]
    pub fn compact(self) -> String {
        let [year, month, day, hour, minute, second] = self.parts();
        format!("{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}")
    }
}

/// `2026-11-21 15:01:56`
impl std::fmt::Display for DateTime {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [year, month, day, ..] = self.parts();
        write!(f, "{year:04}-{month:02}-{day:02} {}", self.time())
    }
}

/// Number of days in a month.
#[must_use]
pub const fn days_in_month(year: i64, month: i64) -> i64 {
    match month {
        2 => 28 + (year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)) as i64,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// Days from 1970-01-01 to the first day of a month.
fn days_to_month(year: i64, month: i64) -> i64 {
    let past = year - 1;
    let leaps = past.div_euclid(4) - past.div_euclid(100) + past.div_euclid(400) - 477;
    let months: i64 = (1..month).map(|month| days_in_month(year, month)).sum();
    (year - 1_970) * 365 + leaps + months
}
