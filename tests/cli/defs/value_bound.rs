//! The ranges that a program names for its values. Source: spec K7.4, B8, H6.

use kt830::defs::text::Lang;
use kt830::defs::value_bound::{BoundLimit, BoundSide, ValueBound, ValueRange};

fn bound(variable: u16, side: BoundSide, is_strict: bool, limit: f64) -> ValueBound {
    ValueBound { variable, side, is_strict, limit: BoundLimit::Number(limit) }
}

#[test]
fn k7_4_the_narrowest_bounds_make_the_range() {
    use BoundSide::{Least, Most};
    let bounds = [
        bound(511, Least, false, 0.0),
        bound(511, Most, false, 1_000.0),
        bound(511, Most, false, 50.0),
        bound(512, Least, true, 0.0),
        bound(512, Least, false, 0.0),
        ValueBound { variable: 521, side: Most, is_strict: true, limit: BoundLimit::Variable(520) },
        bound(521, Least, true, 0.0),
    ];
    let value_of = |variable| (variable == 520).then_some(40.3);
    let range = |variable| ValueRange::of(variable, &bounds, value_of);
    assert_eq!(range(511).words(Lang::Zh), "0 … 50");
    assert_eq!(range(512).words(Lang::Zh), "> 0");
    assert_eq!(range(521).words(Lang::Zh), "> 0，< 40.3");
    assert_eq!(range(521).words(Lang::En), "> 0, < 40.3");
    assert_eq!(range(600).words(Lang::Zh), "");
    assert!(range(600).is_free() && range(600).holds(-1e9));
    for (variable, value, holds) in [
        (511, 0.0, true),
        (511, 50.0, true),
        (511, 50.1, false),
        (511, -0.1, false),
        (512, 0.0, false),
        (512, 0.1, true),
        (521, 40.3, false),
        (521, 40.299, true),
    ] {
        assert_eq!(range(variable).holds(value), holds, "#{variable} = {value}");
    }
    // What a program has computed is shown short.
    let computed = ValueRange { least: None, most: Some((0.1 + 0.2, true)) };
    assert_eq!(computed.words(Lang::En), "< 0.3");
    // A variable that is empty counts as 0.
    assert!(!ValueRange::of(521, &bounds, |_| None).holds(1.0));
}
