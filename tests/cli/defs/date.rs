//! Tests of `kt830::defs::date`.

use kt830::defs::date::DateTime;

/// A day, s.
const DAY: i64 = 86_400;

#[test]
fn b6_dates_are_those_of_the_calendar() {
    // `date -u -d @N` of GNU coreutils.
    for (seconds, shown) in [
        (0, "1970-01-01 00:00:00"),
        (951_827_696, "2000-02-29 12:34:56"),
        (1_795_273_316, "2026-11-21 15:01:56"),
        (4_102_444_799, "2099-12-31 23:59:59"),
    ] {
        assert_eq!(DateTime(seconds).to_string(), shown);
        assert_eq!(DateTime::from_parts(DateTime(seconds).parts()), Some(DateTime(seconds)));
    }
    assert_eq!(DateTime(1_795_273_316).compact(), "20261121-150156");
    assert_eq!(DateTime::parse("2026-11-21 15:01:56"), Some(DateTime(1_795_273_316)));
    for wrong in ["2026-11-21", "2026-11-21 15:01", "2026-02-30 15:01:56", "21.11.2026 15:01:56", "", "a b"] {
        assert_eq!(DateTime::parse(wrong), None, "{wrong}");
    }
    assert!((0..60_000).all(|day| DateTime::from_parts(DateTime(day * DAY).parts()) == Some(DateTime(day * DAY))));
}

#[test]
fn b6_a_day_that_is_none_is_refused() {
    for wrong in [[2_027, 2, 29, 0, 0, 0], [2_026, 13, 1, 0, 0, 0], [2_026, 4, 31, 0, 0, 0], [2_026, 1, 0, 0, 0, 0]] {
        assert_eq!(DateTime::from_parts(wrong), None, "{wrong:?}");
    }
    assert_eq!(DateTime::from_parts([2_026, 1, 1, 24, 0, 0]), None);
    assert_eq!(DateTime::from_parts([2_026, 1, 1, 0, 60, 0]), None);
    assert!(DateTime::from_parts([2_028, 2, 29, 23, 59, 59]).is_some());
}
