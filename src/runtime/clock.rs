//! The computer's clock in local time.
//! Source: spec B6 (clock).

use chrono::Local;

use crate::defs::date::Date;

/// The local date and time.
#[must_use]
pub fn local() -> Date {
    let now = Local::now();
    Date(now.timestamp() + i64::from(now.offset().local_minus_utc()))
}
