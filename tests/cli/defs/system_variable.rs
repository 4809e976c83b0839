//! Tests of `kt830::defs::system_variable`.

use kt830::defs::system_variable::*;

#[test]
fn b3_ranges_do_not_overlap_and_stand_in_order() {
    for pair in SYSTEM_VARIABLES.windows(2) {
        assert!(pair[0].first + pair[0].count <= pair[1].first, "{:?}", pair);
    }
    assert_eq!(find(2_016).map(|range| range.first), Some(2_001));
    assert!(find(2_017).is_none() && find(3_005).is_none());
}
