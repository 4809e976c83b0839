//! From a cold start every page of the page table is reached by touch and by keyboard, and on every page every key of the
//! kind's panel is there for a finger. Pages, keys and kinds come from their tables. Source: spec B6, H2, K2.1, P1.

use crate::operators::{Hand, Operator};
use egui::{Pos2, Rect, vec2};
use egui_kittest::kittest::Queryable;
use kt830::defs::key::{Key, KeyGroup};
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::link::Command;

/// The panel stands beside every page; its own word in the page table is for pictures of it.
fn pages(kind: Kind) -> impl Iterator<Item = Page> {
    Page::ALL.iter().copied().filter(move |page| *page != Page::Panel && page.exists_on(kind))
}

fn panel_is_there(operator: &Operator, page: Page) {
    let whole = Rect::from_min_size(Pos2::ZERO, vec2(1_024.0, 768.0));
    let kind = operator.snapshot().kind;
    // The keys of an axis are there where it is fitted.
    let fitted = operator.snapshot().axes[kt830::units::Axis::Y].present;
    let lacking = |key: &Key| !fitted && matches!(key, Key::YPlus | Key::YMinus | Key::HandwheelY);
    for key in Key::ALL.iter().filter(|key| key.exists_on(kind) && key.row().group != KeyGroup::Screen && !lacking(key))
    {
        let label = format!("{} {}", key.label().zh, key.id());
        let found = operator.screen.query_by_label(&label).unwrap_or_else(|| panic!("{label} on {page:?} of {kind:?}"));
        // The harness keeps a margin of 8 around the screen: 44 points there are 43. Sizes are looked at in hmi_panel.
        assert!(
            whole.contains_rect(found.rect()) && found.rect().height() > 43.0,
            "{label} on {page:?}: {}",
            found.rect()
        );
    }
}

fn check(kind: Kind, hands: &[Hand]) {
    for hand in hands {
        let mut operator = Operator::new(*hand, crate::stories::rig_of(kind, crate::stories::folders_of(kind)));
        for page in pages(kind) {
            operator.page(page);
            panel_is_there(&operator, page);
        }
        // And back again from the last one.
        operator.page(Page::Position);
    }
}

#[test]
fn b6_every_page_of_the_cylindrical_grinder_is_reached_by_touch_and_by_keyboard() {
    check(Kind::Gc, &[Hand::Fingers, Hand::Keyboard]);
}

#[test]
fn b6_every_page_of_the_surface_grinder_is_reached_by_touch_and_by_keyboard() {
    check(Kind::Gs, &[Hand::Fingers, Hand::Keyboard]);
}

#[test]
fn b6_every_page_of_the_rotary_table_grinder_is_reached_by_touch_and_by_keyboard() {
    check(Kind::Ga, &[Hand::Fingers, Hand::Keyboard]);
}

#[test]
fn b6_every_page_of_the_other_kinds_is_reached() {
    check(Kind::Vertical, &[Hand::Fingers]);
    check(Kind::Lathe, &[Hand::Keyboard]);
}

#[test]
fn p1_a_real_machine_has_no_way_to_a_simulator() {
    let mut screen = crate::screen::open(crate::sample::snapshot(Page::Position));
    assert!(screen.state().snapshot.simulated.is_none());
    let mut rows = Vec::new();
    for _ in 0..6 {
        assert!(screen.query_by_label("模拟 f1").is_none());
        rows.push(["相对 f1", "参数 f1", "程序 f1", "过程 f1"].map(|label| screen.query_by_label(label).is_some()));
        screen.key_press(egui::Key::F6);
        (0..3).for_each(|_| screen.step());
        for command in std::mem::take(&mut screen.state_mut().sent) {
            let Command::ShowSoftKeyRow(row) = command else { panic!("{command:?}: what is not there opens nothing") };
            screen.state_mut().snapshot.soft_key_row = row;
        }
        screen.step();
    }
    assert!(rows.iter().all(|row| row.iter().filter(|shown| **shown).count() == 1), "{rows:?}");
    assert_eq!(rows[0], rows[4], "four rows, then the first again");
}
