//! The computer's clock in local time.
//! Source: spec B6 (clock).

use chrono::Local;

use crate::defs::date::DateTime;

/// The local date and time.
#[must_use]
pub fn local_time() -> DateTime {
    let now = Local::now();
    DateTime(now.timestamp() + i64::from(now.offset().local_minus_utc()))
}
