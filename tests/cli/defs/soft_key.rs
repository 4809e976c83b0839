//! Tests of `kt830::defs::soft_key`.

use kt830::defs::kind::Kind;
use kt830::defs::soft_key::{ROWS, row};

#[test]
fn k7_1_the_first_row_is_that_of_the_position_page_and_none_has_more_than_five() {
    let first = |kind| row(kind, 0).map(|soft| soft.label.zh).collect::<Vec<_>>();
    assert_eq!(first(Kind::Gc), ["相对", "综合", "机床", "磨削", "砂轮修整"]);
    assert_eq!(first(Kind::Lathe), ["相对", "综合", "机床", "录返", "刀具棒料"]);
    for kind in Kind::ALL.iter().copied() {
        assert!((0..ROWS.len()).all(|index| (1..=5).contains(&row(kind, index).count())), "{kind:?}");
    }
}
