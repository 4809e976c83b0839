//! The computer's clock.
//! Source: spec B6 (clock).

use std::time::{SystemTime, UNIX_EPOCH};

use chrono::Local;

use crate::defs::date::DateTime;
use crate::units::Micros;

/// The local date and time.
#[must_use]
pub fn local_time() -> DateTime {
    let now = Local::now();
    DateTime(now.timestamp() + i64::from(now.offset().local_minus_utc()))
}

/// The time since 1970, UTC.
#[must_use]
pub fn time_of_day() -> Micros {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Micros(u64::try_from(since.as_micros()).unwrap_or(u64::MAX))
}
