//! Tests of `kt830::defs::alarm`.

use kt830::defs::alarm::*;

#[test]
fn b8_numbers_stand_once_and_in_their_range() {
    assert!(ALARMS.windows(2).all(|pair| pair[0].number < pair[1].number));
    for row in ALARMS {
        let named = !row.cause.zh.is_empty() && !row.remedy.en.is_empty();
        assert!(named, "alarm {} lacks a text", row.number);
    }
}

#[test]
fn b8_the_seeds_numbers_are_kept() {
    for number in [66, 180, 181, 182, 183] {
        assert!(find(number).is_some(), "alarm {number}");
    }
}
