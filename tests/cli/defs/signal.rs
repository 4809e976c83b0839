//! Tests of `kt830::defs::signal`.

use kt830::defs::signal::*;

#[test]
fn k6_1_every_signal_has_its_own_id() {
    for (i, a) in Input::ALL.iter().enumerate() {
        assert_eq!(Input::from_id(a.id()), Some(*a));
        assert!(Input::ALL[i + 1..].iter().all(|b| a.id() != b.id()), "{} twice", a.id());
    }
    for a in Output::ALL {
        assert_eq!(Output::from_id(a.id()), Some(*a));
    }
    assert_eq!(Input::from_id("wheel"), None);
}

#[test]
fn k6_1_port_zero_is_not_connected() {
    let mut block = Terminals::default();
    block.set(0, true);
    block.set(65, true);
    assert_eq!(block, Terminals(0));
    block.set(64, true);
    assert!(block.is_closed(64) && !block.is_closed(0) && !block.is_closed(63));
}
