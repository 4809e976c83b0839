//! Tests of `kt830::defs::soft_key`.

use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::soft_key::{ROWS, SoftKeyAction, row};

#[test]
fn k7_1_the_first_row_is_that_of_the_position_page_and_none_has_more_than_five() {
    let first = |kind| row(kind, 0).map(|soft| soft.label.zh).collect::<Vec<_>>();
    assert_eq!(first(Kind::Gc), ["相对", "综合", "机床", "磨削", "砂轮修整"]);
    assert_eq!(first(Kind::Lathe), ["相对", "综合", "机床", "录返", "刀具棒料"]);
    assert_eq!(first(Kind::Vertical), ["相对", "综合", "机床", "R 参数"]);
    let fourth = |kind| row(kind, 3).map(|soft| soft.label.en).collect::<Vec<_>>();
    assert_eq!(fourth(Kind::Gc), ["PROCESS", "ALARMS", "WHEEL", "SETTINGS", "HELP"]);
    assert_eq!(fourth(Kind::Lathe), ["ALARMS", "SETTINGS", "HELP"], "a row closes up over keys that a kind lacks");
    for kind in Kind::ALL.iter().copied() {
        assert!((0..ROWS).all(|index| (1..=5).contains(&row(kind, index).count())), "{kind:?}");
    }
}

#[test]
fn k7_1_every_page_with_a_soft_key_has_it_once_on_each_of_its_kinds() {
    // The views of the position page have keys; the designer opens from the program, the panel stands beside the page.
    let without = [Page::Position, Page::Designer, Page::Panel];
    for kind in Kind::ALL {
        let keys: Vec<_> = (0..ROWS).flat_map(|index| row(kind, index)).map(|soft| soft.action).collect();
        for page in Page::ALL.iter().copied().filter(|page| page.exists_on(kind)) {
            let found = keys.iter().filter(|action| **action == SoftKeyAction::Open(page)).count();
            assert_eq!(found, usize::from(!without.contains(&page)), "{page:?} on {kind:?}");
        }
    }
}
