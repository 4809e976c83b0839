//! The row of soft keys: the open page is lit in every row, ◀ ▶ turn both ways, and a page that opens shows the row of its
//! key. Source: spec K7.1, K7.2, B6.

use egui::accesskit::Toggled;
use egui_kittest::kittest::{NodeT, Queryable};
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::soft_key::{self, ROWS as SOFT_ROWS, SoftKeyAction};
use kt830::link::Command;
use kt830::link::snapshot::RunState;

use crate::operators::{Hand, Operator};
use crate::screen::{Screen, open, painted};

/// A screen of a simulated machine on a page, with a row of soft keys.
fn screen_of(page: Page, row: usize) -> Screen {
    let mut machine = crate::sample::snapshot(page);
    machine.simulated = crate::sample::busy(page).simulated;
    machine.soft_key_row = row;
    open(machine)
}

fn is_lit(screen: &Screen, label: &str) -> bool {
    screen.query_by_label(label).is_some_and(|node| node.accesskit_node().toggled() == Some(Toggled::True))
}

fn sent(screen: &mut Screen) -> Vec<String> {
    (0..3).for_each(|_| screen.step());
    std::mem::take(&mut screen.state_mut().sent).iter().map(|command| format!("{command:?}")).collect()
}

#[test]
fn k7_1_the_open_page_is_lit_in_every_row_and_names_its_place() {
    for page in Page::ALL.iter().copied() {
        for row in 0..SOFT_ROWS {
            let screen = screen_of(page, row);
            let kind = screen.state().snapshot.kind;
            let lit = soft_key::key_of_page(page, screen.state().snapshot.coordinates);
            let Some((own, index)) = soft_key::place(kind, lit) else { continue };
            let label = lit.label_on(kind).zh;
            assert!(is_lit(&screen, &format!("{label} open-page")), "{page:?} in row {row}");
            let place = format!("第 {} 行 F{}", own + 1, index + 1);
            assert!(painted(&screen).contains(&place), "{page:?} in row {row}: {place}");
            // Of the keys F1 to F5 only its own one is lit, in its row.
            for (at, soft) in soft_key::row(kind, row).enumerate() {
                let key = format!("{} f{}", soft.label.zh, at + 1);
                assert_eq!(is_lit(&screen, &key), (row, at) == (own, index), "{key} on {page:?}");
            }
        }
    }
}

#[test]
fn k7_1_the_rows_turn_both_ways_and_the_open_page_leads_to_its_row() {
    for row in 0..SOFT_ROWS {
        let (next, previous) = ((row + 1) % SOFT_ROWS, (row + SOFT_ROWS - 1) % SOFT_ROWS);
        for (label, wanted) in [("▶ next-row", next), ("◀ previous-row", previous), ("报警 open-page", 3)] {
            let mut screen = screen_of(Page::Alarm, row);
            screen.get_by_label(label).click();
            assert_eq!(sent(&mut screen), [format!("ShowSoftKeyRow({wanted})")], "{label} in row {row}");
        }
        for (modifiers, wanted) in [(egui::Modifiers::NONE, next), (egui::Modifiers::SHIFT, previous)] {
            let mut screen = screen_of(Page::Alarm, row);
            screen.key_press_modifiers(modifiers, egui::Key::F6);
            assert_eq!(sent(&mut screen), [format!("ShowSoftKeyRow({wanted})")], "{modifiers:?} F6 in row {row}");
        }
    }
}

/// A finger opens pages from the alarm chip, from a page and by a message; each time the key of the page is in sight.
#[test]
fn k7_1_a_jump_to_a_page_shows_its_row() {
    let mut operator = Operator::new(Hand::Fingers, crate::stories::rig());
    let lit = |operator: &Operator, label: &str| is_lit(&operator.screen, label);
    operator.until("alarm 180", 10.0, |snapshot| !snapshot.alarms.is_empty());
    operator.tap("报警 alarm-chip");
    assert!(lit(&operator, "报警 f2"), "from the alarm chip");
    // The page is open already: it is shown again all the same.
    (0..3).for_each(|_| operator.tap("▶ next-row"));
    assert!(operator.sees("相对 f1") && lit(&operator, "报警 open-page"));
    operator.tap("报警 alarm-list");
    assert!(lit(&operator, "报警 f2"), "from the message line");
    operator.tap("◀ previous-row");
    assert!(operator.sees("程序 f1"), "there is a way back");
    operator.tap("报警 open-page");
    assert!(lit(&operator, "报警 f2"), "from its own key");
    // From another page, from the command line, and by a key.
    operator.page(Page::Directory);
    operator.tap("页面设计 design-page");
    assert!(operator.snapshot().page == Page::Designer && lit(&operator, "程序 f1"));
    operator.rig.send(Command::ShowSoftKeyRow(3));
    operator.rig.send(Command::OpenPage(Page::Designer));
    operator.look();
    operator.look();
    assert!(lit(&operator, "程序 f1"), "opened again");
    operator.page(Page::Grinding);
    assert!(operator.sees("参数 f1") && lit(&operator, "磨削 open-page"), "K7.2: the row of the customer's picture");
    operator.tap("磨削 open-page");
    assert!(lit(&operator, "磨削 f4"));
}

#[test]
fn k7_1_a_story_turns_the_rows_back() {
    let mut rig = crate::stories::rig();
    crate::stories::tell(&mut rig, "page alarm\nkey previous-row\nkey f3");
    assert_eq!(rig.snapshot().page, Page::Directory);
    crate::stories::tell(&mut rig, "page position\nkey previous-row\nkey f1");
    assert_eq!(rig.snapshot().page, Page::Jobs, "before the first row comes the last");
    assert!(Key::ALL.contains(&Key::PreviousRow));
}

#[test]
fn k7_1_the_map_shows_all_pages_and_a_touch_opens_one() {
    for kind in Kind::ALL {
        let mut machine = crate::sample::snapshot(Page::Alarm);
        (machine.kind, machine.simulated) = (kind, crate::sample::busy(Page::Alarm).simulated);
        let mut screen = open(machine);
        screen.get_by_label("全部页面 page-map").click();
        (0..2).for_each(|_| screen.step());
        let rows = soft_key::row_count(true);
        for row in 0..rows {
            let pages = soft_key::row(kind, row).filter(|soft| soft.action.opens_page());
            for (index, soft) in pages.enumerate() {
                let name = format!("{} map-{}-{}", soft.label.zh, row + 1, index + 1);
                assert!(screen.query_by_label(&name).is_some(), "{name} on {kind:?}");
            }
        }
        let key = |page: Page| {
            let action = SoftKeyAction::Open(page);
            let (row, index) = soft_key::place(kind, action).unwrap();
            format!("{} map-{}-{}", action.label_on(kind).zh, row + 1, index + 1)
        };
        assert!(is_lit(&screen, &key(Page::Alarm)), "the open page is marked");
        assert!(sent(&mut screen).is_empty());
        screen.get_by_label(&key(Page::Graphic)).click();
        (0..2).for_each(|_| screen.step());
        assert_eq!(sent(&mut screen), [format!("{:?}", Command::OpenPage(Page::Graphic))]);
        assert!(screen.query_by_label(&key(Page::Graphic)).is_none(), "the map is gone");
    }
}

#[test]
fn k7_1_the_map_is_used_by_keyboard_and_covers_the_page() {
    let mut screen = open(crate::sample::snapshot(Page::Alarm));
    let key = |screen: &mut Screen, key: egui::Key, modifiers: egui::Modifiers| {
        screen.key_press_modifiers(modifiers, key);
        (0..2).for_each(|_| screen.step());
    };
    let none = egui::Modifiers::NONE;
    key(&mut screen, egui::Key::F6, egui::Modifiers::CTRL);
    assert!(screen.query_by_label("图形 map-2-3").is_some());
    // Two rows up from 报警 (row 4, F2) and one to the right.
    [egui::Key::ArrowUp, egui::Key::ArrowUp, egui::Key::ArrowRight, egui::Key::Enter]
        .into_iter()
        .for_each(|pressed| key(&mut screen, pressed, none));
    assert_eq!(sent(&mut screen), [format!("{:?}", Command::OpenPage(Page::Graphic))]);
    // Escape closes it, and so do its key, the help and an alarm's page; letters do nothing beneath it.
    let mut screen = open(crate::sample::snapshot(Page::Position));
    key(&mut screen, egui::Key::F6, egui::Modifiers::CTRL);
    key(&mut screen, egui::Key::X, none);
    assert!(sent(&mut screen).is_empty());
    key(&mut screen, egui::Key::Escape, none);
    assert!(screen.query_by_label("图形 map-2-3").is_none());
    key(&mut screen, egui::Key::F6, egui::Modifiers::CTRL);
    key(&mut screen, egui::Key::F12, none);
    assert!(screen.query_by_label("图形 map-2-3").is_none());
    key(&mut screen, egui::Key::F6, egui::Modifiers::CTRL);
    assert!(screen.query_by_label("图形 map-2-3").is_some());
    key(&mut screen, egui::Key::F6, egui::Modifiers::CTRL);
    assert!(screen.query_by_label("图形 map-2-3").is_none());
}

/// A stopped program of a lathe continues by F1 in every row: the map has pages alone, so that it starts nothing.
#[test]
fn k7_1_the_map_of_a_stopped_lathe_starts_nothing() {
    for page in Page::ALL.iter().copied().filter(|page| page.exists_on(Kind::Lathe)) {
        let mut machine = crate::sample::snapshot(page);
        (machine.kind, machine.state) = (Kind::Lathe, RunState::Stopped);
        let mut screen = open(machine);
        screen.key_press_modifiers(egui::Modifiers::CTRL, egui::Key::F6);
        screen.step();
        screen.key_press(egui::Key::Enter);
        let all = sent(&mut screen);
        assert!(
            !all.iter().any(|command| command.starts_with("Press") || command.contains("Start")),
            "{page:?}: {all:?}"
        );
        if screen.query_by_label_contains("close-map").is_none() {
            screen.key_press_modifiers(egui::Modifiers::CTRL, egui::Key::F6);
            screen.step();
        }
        assert!(
            screen.query_by_label_contains("继续 map-").is_none()
                && screen.query_by_label_contains("屏幕打印 map-").is_none()
        );
    }
}

/// Whatever opens a page closes the map, also the page that is open already; Space is feed hold over it.
#[test]
fn k7_1_an_opened_page_closes_the_map() {
    let mut screen = open(crate::sample::snapshot(Page::Alarm));
    let key = |screen: &mut Screen, key: egui::Key, modifiers: egui::Modifiers| {
        screen.key_press_modifiers(modifiers, key);
        (0..2).for_each(|_| screen.step());
    };
    key(&mut screen, egui::Key::F6, egui::Modifiers::CTRL);
    key(&mut screen, egui::Key::F7, egui::Modifiers::NONE);
    assert!(screen.query_by_label_contains("map-2-3").is_none());
    let mut screen = open(crate::sample::snapshot(Page::Mdi));
    key(&mut screen, egui::Key::F6, egui::Modifiers::CTRL);
    key(&mut screen, egui::Key::Space, egui::Modifiers::NONE);
    let all = sent(&mut screen);
    assert!(all.iter().any(|command| command == "Press(FeedHold)"), "{all:?}");
}
