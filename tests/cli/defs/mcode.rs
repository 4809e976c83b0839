//! Tests of `kt830::defs::mcode`.

use kt830::defs::mcode::*;

#[test]
fn k3_the_codes_stand_once_and_in_order() {
    assert!(MCODES.windows(2).all(|pair| pair[0].code < pair[1].code));
    assert!(find(4).is_none() && !is_known(4) && !is_known(100));
    assert!(NOT_IMPLEMENTED.iter().all(|code| find(*code).is_none() && is_known(u32::from(*code))));
}
