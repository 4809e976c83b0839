//! The computer's clock, in the time of the place where the machine stands.
//! Source: spec B6 (clock).

use chrono::Local;

use crate::defs::date::Date;

/// What it reads now.
#[must_use]
pub fn local() -> Date {
    let now = Local::now();
    Date(now.timestamp() + i64::from(now.offset().local_minus_utc()))
}
