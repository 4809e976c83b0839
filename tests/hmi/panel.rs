//! The operator panel: every key can be reached, is labelled, and sends its command.

use crate::sample::snapshot;
use crate::screen::{Screen, open, open_sized, painted};
use egui::{Event, Modifiers, PointerButton, Pos2, Rect, pos2, vec2};
use egui_kittest::kittest::Queryable;
use kt830::defs::fitted::Fitted;
use kt830::defs::key::{Key, KeyGroup};
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::hmi::layout::Regions;
use kt830::hmi::offscreen::OffscreenHmi;
use kt830::hmi::panel::layout::{PanelLayout, panel_layout as panel};
use kt830::hmi::{Hmi, SHORTCUTS, theme};
use kt830::link::Command;

/// Press and release of a key, in the order they were sent, without the holds between them.
fn sent(screen: &mut Screen) -> Vec<String> {
    let all = std::mem::take(&mut screen.state_mut().sent);
    all.iter()
        .filter(|command| !matches!(command, Command::StillHeld(_)))
        .map(|command| match command {
            // The mushroom is not latched in these snapshots: its key presses it.
            Command::EmergencyStop(true) => "Press(EmergencyStop)".to_owned(),
            command => format!("{command:?}"),
        })
        .collect()
}

fn pointer(screen: &mut Screen, pos: Pos2, pressed: Option<bool>) {
    screen.event(Event::PointerMoved(pos));
    if let Some(pressed) = pressed {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        screen.event(Event::PointerButton { pos, button, pressed, modifiers });
    }
    for _ in 0..4 {
        screen.step();
    }
}

fn place(screen: &Screen, key: Key) -> Rect {
    screen.get_by_label(&format!("{} {}", key.label().zh, key.id())).rect()
}

fn layout(machine: impl Into<Fitted>, size: egui::Vec2) -> PanelLayout {
    let regions = Regions::new(Rect::from_min_size(Pos2::ZERO, size));
    panel(machine, regions.panel, regions.portrait)
}

fn panel_keys(machine: impl Into<Fitted>) -> impl Iterator<Item = Key> {
    let machine = machine.into();
    Key::ALL.iter().copied().filter(move |key| key.exists_on(machine) && key.row().group != KeyGroup::Screen)
}

/// Every kind as delivered, and with all that parameters can add.
fn machines() -> impl Iterator<Item = Fitted> {
    Kind::ALL.into_iter().flat_map(|kind| [kind.into(), Fitted::fully(kind)])
}

#[test]
fn k2_1_every_key_has_a_place_of_44_points_and_none_overlaps() {
    for size in [vec2(1_024.0, 768.0), vec2(1_280.0, 800.0), vec2(1_371.4, 771.4), vec2(768.0, 1_024.0)] {
        for machine in machines() {
            let layout = layout(machine, size);
            let screen = Rect::from_min_size(Pos2::ZERO, size);
            for key in panel_keys(machine) {
                let count = layout.keys.iter().filter(|(other, _)| *other == key).count();
                assert_eq!(count, 1, "{} of {machine:?} at {size}", key.id());
            }
            for (index, (key, rect)) in layout.keys.iter().enumerate() {
                assert!(rect.width() >= 43.99 && rect.height() >= 43.99, "{} {rect} at {size}", key.id());
                assert!(screen.contains_rect(*rect), "{} {rect} at {size}", key.id());
                let others = layout.keys[..index].iter().map(|(_, other)| *other).chain([layout.handwheel]);
                assert!(others.into_iter().all(|other| !other.shrink(0.1).intersects(*rect)), "{}", key.id());
            }
        }
    }
}

/// H6: the pad lies over the page, beside the field and above the input line. No key of the panel is under it.
#[test]
fn h6_the_pad_never_covers_what_runs_or_stops() {
    for size in [vec2(1_024.0, 768.0), vec2(1_280.0, 800.0), vec2(1_371.4, 771.4), vec2(768.0, 1_024.0)] {
        let (keys, content) =
            (layout(Kind::Gc, size).keys, Regions::new(Rect::from_min_size(Pos2::ZERO, size)).content);
        for variable in [500, 505, 508, 514, 516, 511] {
            let mut screen = open_sized(snapshot(Page::Grinding), size);
            let cell = |screen: &Screen| screen.get_by_label_contains(&format!(" #{variable}")).rect();
            screen.get_by_label_contains(&format!(" #{variable}")).click();
            (0..4).for_each(|_| screen.step());
            let pad = PAD_KEYS.map(|name| screen.get_by_label(name).rect());
            for key in pad {
                assert!(key.width() >= 52.0 && key.height() >= 52.0, "{key} at {size}: for gloves");
                assert!(!key.intersects(cell(&screen)), "#{variable} at {size} is covered");
                assert!(keys.iter().all(|(_, rect)| !rect.intersects(key)), "a machine key at {size} is covered");
                assert!(content.contains_rect(key) && key.max.y < content.max.y - theme::INPUT, "{key} at {size}");
            }
        }
    }
}

const PAD_KEYS: [&str; 5] = ["pad-7", "pad-sign", "pad-point", "取消 cancel", "输入 input"];

#[test]
fn h2_emergency_stop_stands_in_the_lower_right_corner_on_every_kind() {
    let places: Vec<Rect> = Kind::ALL
        .iter()
        .map(|kind| layout(*kind, vec2(1_024.0, 768.0)).keys)
        .filter_map(|keys| keys.iter().find(|(key, _)| *key == Key::EmergencyStop).map(|(_, rect)| *rect))
        .collect();
    assert!(places.windows(2).all(|pair| pair[0] == pair[1]) && places.len() == Kind::ALL.len());
    assert!(places[0].max.x > 1_010.0 && places[0].max.y > 755.0, "{}", places[0]);
}

#[test]
fn k2_1_every_key_of_every_kind_is_labelled_and_sends_its_press() {
    for kind in Kind::ALL {
        let mut machine = snapshot(Page::Position);
        machine.kind = kind;
        // The keys of an axis are there where it is fitted.
        machine.axes[kt830::units::Axis::Y].present = true;
        let mut screen = open(machine);
        for key in panel_keys(kind) {
            screen.get_by_label(&format!("{} {}", key.label().zh, key.id())).click();
            for _ in 0..4 {
                screen.step();
            }
            let wanted = [format!("Press({key:?})"), format!("Release({key:?})")];
            assert_eq!(sent(&mut screen), wanted, "{} of {kind:?}", key.id());
        }
    }
}

#[test]
fn k2_1_every_key_of_every_kind_is_on_the_keyboard() {
    for kind in Kind::ALL {
        let mut machine = snapshot(Page::Position);
        machine.kind = kind;
        let mut screen = open(machine);
        for key in panel_keys(kind) {
            let shortcut =
                SHORTCUTS.iter().find(|shortcut| shortcut.key == key).unwrap_or_else(|| panic!("{}", key.id()));
            screen.key_press_modifiers(shortcut.modifiers, shortcut.physical);
            for _ in 0..4 {
                screen.step();
            }
            let wanted = [format!("Press({key:?})"), format!("Release({key:?})")];
            assert_eq!(sent(&mut screen), wanted, "{} of {kind:?}", key.id());
        }
        let on = |index: usize| SHORTCUTS[index].key.exists_on(kind);
        for (index, one) in SHORTCUTS.iter().enumerate().filter(|(index, _)| on(*index)) {
            let twice = |other: usize| {
                on(other) && SHORTCUTS[other].physical == one.physical && SHORTCUTS[other].modifiers == one.modifiers
            };
            assert!(!(0..index).any(twice), "{:?} twice on {kind:?}", one.physical);
        }
    }
}

#[test]
fn k2_1_the_help_page_tells_the_physical_key_of_every_key_of_the_kind() {
    for kind in Kind::ALL {
        let mut machine = snapshot(Page::Help);
        machine.kind = kind;
        for lang in [Lang::Zh, Lang::En] {
            let mut stage = OffscreenHmi::new(Hmi::new(lang), (1_024, 768));
            stage.frame(&machine);
            // The map is the tab left of the first one.
            let (key, modifiers) = (egui::Key::ArrowLeft, egui::Modifiers::NONE);
            stage.events.push(egui::Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers });
            stage.frame(&machine);
            let page: Vec<String> = stage.texts().into_iter().map(|(text, ..)| text).collect();
            for key in panel_keys(kind) {
                assert!(page.iter().any(|text| text == key.label_on(kind).get(lang)), "{} on {kind:?}", key.id());
            }
            assert!(page.iter().any(|text| text == "F10 Space") && page.iter().any(|text| text == "Alt+C"));
        }
    }
}

#[test]
fn k2_1_direction_keys_lie_in_the_kinds_own_arrangement() {
    use kt830::hmi::panel::layout::jog_positions;
    let at = |kind, column, row| {
        let places = jog_positions(kind);
        places.into_iter().find(|(_, x, y)| (*x, *y) == (column, row)).map(|(key, ..)| key)
    };
    // Left, right, up, down.
    let cross = |kind| [at(kind, 0, 1), at(kind, 2, 1), at(kind, 1, 0), at(kind, 1, 2)].map(Option::unwrap);
    assert_eq!(cross(Kind::Gc), [Key::ZMinus, Key::ZPlus, Key::XPlus, Key::XMinus]);
    assert_eq!(cross(Kind::Gs), [Key::XMinus, Key::XPlus, Key::YPlus, Key::YMinus]);
    assert_eq!(cross(Kind::Ga), [Key::XMinus, Key::XPlus, Key::ZPlus, Key::ZMinus]);
    for kind in Kind::ALL {
        assert_eq!(at(kind, 1, 1), Some(Key::Rapid));
    }
}

#[test]
fn k2_jog_holds_while_the_finger_stays_and_lets_go_when_it_leaves() {
    let mut screen = open(snapshot(Page::Position));
    let key = place(&screen, Key::XMinus);
    pointer(&mut screen, key.center(), Some(true));
    for _ in 0..20 {
        screen.step();
    }
    let all = std::mem::take(&mut screen.state_mut().sent);
    assert!(matches!(all.first(), Some(Command::Press(Key::XMinus))), "{all:?}");
    let holds = all.iter().filter(|command| matches!(command, Command::StillHeld(Key::XMinus))).count();
    // kittest steps a quarter of a second: one hold a frame.
    assert!(holds >= 20 && holds + 1 == all.len(), "{all:?}");
    pointer(&mut screen, key.center() + vec2(0.0, 80.0), None);
    assert_eq!(sent(&mut screen), ["Release(XMinus)"]);
    // Back on the key with the same touch: still dead.
    pointer(&mut screen, key.center(), None);
    pointer(&mut screen, key.center(), Some(false));
    assert!(sent(&mut screen).is_empty());
}

#[test]
fn k2_jog_lets_go_when_the_window_loses_the_focus() {
    let mut screen = open(snapshot(Page::Position));
    let key = place(&screen, Key::ZPlus);
    pointer(&mut screen, key.center(), Some(true));
    screen.event(Event::WindowFocused(false));
    for _ in 0..4 {
        screen.step();
    }
    assert_eq!(sent(&mut screen), ["Press(ZPlus)", "Release(ZPlus)"], "and stays let go under the same touch");
    pointer(&mut screen, key.center(), Some(false));
    assert!(sent(&mut screen).is_empty());
}

#[test]
fn k2_jog_by_keyboard_holds_until_the_key_is_up() {
    let mut screen = open(snapshot(Page::Position));
    let alt_j = |pressed| Event::Key {
        key: egui::Key::J,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::ALT,
    };
    screen.event(Event::ModifiersChanged(Modifiers::ALT));
    screen.event(alt_j(true));
    for _ in 0..6 {
        screen.step();
    }
    let all = std::mem::take(&mut screen.state_mut().sent);
    assert!(matches!(all.first(), Some(Command::Press(Key::XMinus))), "{all:?}");
    assert!(all.iter().any(|command| matches!(command, Command::StillHeld(Key::XMinus))), "{all:?}");
    screen.event(alt_j(false));
    screen.step();
    screen.step();
    assert_eq!(sent(&mut screen), ["Release(XMinus)"]);
}

#[test]
fn h9_stop_keys_act_on_the_press_others_when_lifted_inside() {
    let mut screen = open(snapshot(Page::Position));
    for key in [Key::EmergencyStop, Key::FeedHold, Key::Reset] {
        let rect = place(&screen, key);
        pointer(&mut screen, rect.center(), Some(true));
        assert_eq!(sent(&mut screen), [format!("Press({key:?})")]);
        pointer(&mut screen, rect.center(), Some(false));
        assert_eq!(sent(&mut screen), [format!("Release({key:?})")]);
    }
    let start = place(&screen, Key::CycleStart);
    pointer(&mut screen, start.center(), Some(true));
    assert!(sent(&mut screen).is_empty());
    pointer(&mut screen, start.center() - vec2(200.0, 0.0), Some(false));
    assert!(sent(&mut screen).is_empty(), "a swipe off the key does nothing");
    // A swipe that only ends on a key does nothing either.
    pointer(&mut screen, pos2(300.0, 560.0), Some(true));
    pointer(&mut screen, start.center(), Some(false));
    assert!(sent(&mut screen).is_empty());
}

#[test]
fn k2_4_a_blocked_key_says_why() {
    let mut screen = open(snapshot(Page::Position));
    screen.get_by_label("液压 hydraulic").click();
    for _ in 0..4 {
        screen.step();
    }
    assert_eq!(sent(&mut screen), ["Press(Hydraulic)", "Release(Hydraulic)"]);
    let mut stage = kt830::hmi::offscreen::OffscreenHmi::new(Hmi::new(Lang::Zh), (1_024, 768));
    let machine = snapshot(Page::Position);
    stage.frame(&machine);
    let alt_p = |pressed| Event::Key {
        key: egui::Key::P,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::ALT,
    };
    stage.events.push(alt_p(true));
    stage.frame(&machine);
    assert!(stage.texts().iter().any(|(text, ..)| text == "砂轮旋转时液压键无效"));
}

#[test]
fn k2_3_the_handwheel_sends_detents() {
    let mut screen = open(snapshot(Page::Position));
    let wheel = screen.get_by_label("手轮 handwheel").rect();
    pointer(&mut screen, wheel.center(), Some(true));
    pointer(&mut screen, wheel.center() + vec2(35.0, 0.0), None);
    pointer(&mut screen, wheel.center() + vec2(35.0, 0.0), Some(false));
    let turned: i32 = screen.state().sent.iter().map(detents).sum();
    assert_eq!(turned, 3);
    screen.state_mut().sent.clear();
    screen.key_press_modifiers(Modifiers::ALT, egui::Key::Comma);
    screen.step();
    screen.step();
    assert_eq!(screen.state().sent.iter().map(detents).sum::<i32>(), -1);
}

/// A touch screen that acts as a mouse reports the way to the handwheel and the press at once.
#[test]
fn k2_3_the_way_to_the_handwheel_turns_nothing() {
    let mut screen = open(snapshot(Page::Position));
    let wheel = screen.get_by_label("手轮 handwheel").rect().center();
    pointer(&mut screen, pos2(100.0, 300.0), None);
    pointer(&mut screen, wheel, Some(true));
    pointer(&mut screen, wheel, Some(false));
    assert_eq!(screen.state().sent.iter().map(detents).sum::<i32>(), 0);
}

fn detents(command: &Command) -> i32 {
    match command {
        Command::Handwheel(detents) => *detents,
        _ => 0,
    }
}

/// H6: values are typed one after the other, so 输入 is pressed again and again at the same place.
#[test]
fn h6_the_pad_stays_where_it_is_from_value_to_value() {
    for size in [vec2(1_024.0, 768.0), vec2(1_280.0, 800.0), vec2(1_371.4, 771.4), vec2(768.0, 1_024.0)] {
        let mut screen = open_sized(snapshot(Page::Grinding), size);
        screen.get_by_label_contains(" #500").click();
        (0..4).for_each(|_| screen.step());
        let input = screen.get_by_label("输入 input").rect();
        // It covers the key of the page designer whole: no strip of it is left beside 取消.
        let pad = PAD_KEYS.iter().fold(Rect::NOTHING, |pad, name| pad.union(screen.get_by_label(name).rect()));
        let design = screen.query_by_label_contains("design-page").map(|key| key.rect());
        assert!(design.is_none_or(|key| pad.expand(6.0).contains_rect(key)), "{design:?} beside {pad} at {size}");
        for count in 1..=20 {
            screen.get_by_label("输入 input").click();
            (0..4).for_each(|_| screen.step());
            assert_eq!(screen.get_by_label("输入 input").rect(), input, "after {count} values at {size}");
        }
        assert_eq!(sent(&mut screen), Vec::<String>::new());
    }
}

/// H6: where the pad cannot stay, a double tap on 输入 reaches nothing at the place that it has left.
#[test]
fn h6_a_place_that_the_pad_has_left_takes_no_touch() {
    let mut screen = open(snapshot(Page::Offset));
    let chosen = |screen: &Screen| painted(screen).into_iter().find(|text| text.starts_with("数据输入:")).unwrap();
    screen.get_by_label("geometry-01-X").click();
    (0..4).for_each(|_| screen.step());
    let input = screen.get_by_label("输入 input").rect();
    let tap = |screen: &mut Screen| {
        screen.event(Event::PointerMoved(input.center()));
        for pressed in [true, false] {
            let (pos, button, modifiers) = (input.center(), PointerButton::Primary, Modifiers::NONE);
            screen.event(Event::PointerButton { pos, button, pressed, modifiers });
            screen.step();
        }
    };
    let mut taps = 0;
    while screen.get_by_label("输入 input").rect() == input {
        tap(&mut screen);
        (0..2).for_each(|_| screen.step());
        taps += 1;
        assert!(taps < 64, "the pad covers a field");
    }
    let before = chosen(&screen);
    tap(&mut screen);
    screen.step();
    assert_eq!(chosen(&screen), before, "the second tap chose a field beneath");
    (0..60).for_each(|_| screen.step());
    tap(&mut screen);
    screen.step();
    assert_ne!(chosen(&screen), before, "later the field acts");
}

/// H6: the second tap of a double tap on 取消 must not reach the field that lies there.
#[test]
fn h6_a_double_tap_on_a_key_that_closes_the_pad_reaches_no_field() {
    let mut screen = open(snapshot(Page::Offset));
    screen.get_by_label("geometry-01-X").click();
    (0..4).for_each(|_| screen.step());
    let cancel = screen.get_by_label("取消 cancel").rect().center();
    sent(&mut screen);
    let tap = |screen: &mut Screen| {
        screen.event(Event::PointerMoved(cancel));
        for pressed in [true, false] {
            let (pos, button, modifiers) = (cancel, PointerButton::Primary, Modifiers::NONE);
            screen.event(Event::PointerButton { pos, button, pressed, modifiers });
            screen.step();
        }
    };
    tap(&mut screen);
    screen.step();
    assert!(screen.query_by_label("取消 cancel").is_none(), "the pad is closed");
    tap(&mut screen);
    (0..8).for_each(|_| screen.step());
    assert!(screen.query_by_label("取消 cancel").is_none(), "nothing was chosen");
    assert_eq!(sent(&mut screen), Vec::<String>::new());
    tap(&mut screen);
    (0..2).for_each(|_| screen.step());
    assert!(screen.query_by_label("取消 cancel").is_some(), "later the field acts");
}
