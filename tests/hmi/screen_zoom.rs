//! The screen at 150 % and 200 % of its size: the display shows a part of it; what stops and starts is always in view.
//! Source: spec H1, H9; issue "the face", part 12.

use egui::{Event, Modifiers, PointerButton, Pos2, Rect, TouchPhase, Vec2, pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use kt830::defs::key::Key;
use kt830::defs::page::Page;
use kt830::hmi::theme::DARK;
use kt830::link::Command;
use kt830::link::page_command::{PageCommand, ZOOMS};

use crate::live_screen::Bench;
use crate::sample::snapshot;
use crate::screen::{Screen, finger_event, open_sized};
use crate::service::kept as kept_rig;

/// Displays of 1024×768 and 768×1024 at 200 %, in points.
const LANDSCAPE: Vec2 = vec2(512.0, 384.0);
const PORTRAIT: Vec2 = vec2(384.0, 512.0);
/// The keys beside the part.
const PINNED: [Key; 4] = [Key::Reset, Key::CycleStart, Key::FeedHold, Key::EmergencyStop];
const OVERVIEW: &str = "全屏缩略图 overview";

fn zoomed(machine: kt830::link::Snapshot, size: Vec2) -> Screen {
    let mut screen = open_sized(snapshot(Page::Help), size);
    screen.state_mut().hmi.set_zoom(200);
    screen.state_mut().snapshot = machine;
    (0..4).for_each(|_| screen.step());
    screen.state_mut().sent.clear();
    screen
}

fn label(key: Key) -> String {
    format!("{} {}", key.label().zh, key.id())
}

/// The part of the display that shows a part of the screen: without strip, message line and the margin of the harness.
fn part(size: Vec2) -> Rect {
    let whole = Rect::from_min_size(Pos2::ZERO, size).shrink(8.0);
    let (least, most) = (whole.min, whole.max);
    match size.x > size.y {
        true => Rect::from_min_max(least, pos2(most.x - 92.0, most.y - 48.0)),
        false => Rect::from_min_max(least, pos2(most.x, most.y - 92.0 - 48.0)),
    }
}

fn finger(screen: &mut Screen, pos: Pos2, pressed: Option<bool>) {
    let events = &mut screen.input_mut().events;
    events.push(Event::PointerMoved(pos));
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    events.extend(pressed.map(|pressed| Event::PointerButton { pos, button, pressed, modifiers }));
    screen.step();
}

/// A tap on the overview at shares of the whole screen.
fn look_at(screen: &mut Screen, across: f32, down: f32) {
    let room = screen.get_by_label(OVERVIEW).rect();
    // The overview has the form of the whole screen: 1024×768 or 768×1024.
    let ratio = if screen.ctx.content_rect().aspect_ratio() < 1.0 { 0.75 } else { 4.0 / 3.0 };
    let size = if room.width() / room.height() > ratio {
        vec2(room.height() * ratio, room.height())
    } else {
        vec2(room.width(), room.width() / ratio)
    };
    let small = Rect::from_center_size(room.center(), size).shrink(0.5);
    let at = small.min + vec2(across, down) * small.size();
    finger(screen, at, Some(true));
    finger(screen, at, Some(false));
    // The page takes no touch for a moment.
    (0..4).for_each(|_| screen.step());
}

/// The accessible names with the sizes of their places, as far as they are in the part.
fn sizes(screen: &Screen, part: Rect) -> Vec<(String, Vec2)> {
    let seen = |node: &egui_kittest::Node<'_>| node.rect().intersect(part).size();
    let named = |node: egui_kittest::Node<'_>| node.accesskit_node().label().map(|name| (name, seen(&node)));
    screen.root().children_recursive().filter_map(named).filter(|(_, size)| size.x > 1.0 && size.y > 1.0).collect()
}

#[test]
fn h9_at_200_percent_the_keys_that_stop_and_start_are_in_view_on_every_page() {
    for size in [LANDSCAPE, PORTRAIT] {
        let display = Rect::from_min_size(Pos2::ZERO, size);
        let mut screen = zoomed(snapshot(Page::Position), size);
        for page in Page::ALL {
            screen.state_mut().snapshot = snapshot(*page);
            (0..4).for_each(|_| screen.step());
            for (across, down) in [(0.0, 0.0), (1.0, 1.0)] {
                look_at(&mut screen, across, down);
                let places = PINNED.map(|key| screen.get_by_label(&label(key)).rect());
                for (index, place) in places.iter().enumerate() {
                    let name = label(PINNED[index]);
                    assert!(display.contains_rect(*place), "{name} on {page:?}: {place}");
                    assert!(place.width().min(place.height()) >= 44.0, "{name} on {page:?}: {place}");
                    assert!(!place.intersects(part(size)), "{name} on {page:?}: {place}");
                    assert!(places[..index].iter().all(|other| !other.intersects(*place)), "{name} on {page:?}");
                }
            }
        }
    }
}

/// Whatever a page has at 100 % is shown whole in one of the parts that a hand finds on the overview.
#[test]
fn h9_at_200_percent_everything_can_be_reached() {
    for (size, usual) in [(LANDSCAPE, vec2(1_024.0, 768.0)), (PORTRAIT, vec2(768.0, 1_024.0))] {
        for page in
            [Page::Position, Page::Grinding, Page::Params, Page::Settings, Page::Alarm, Page::Dressing, Page::Jobs]
        {
            let mut screen = open_sized(snapshot(page), usual);
            (0..3).for_each(|_| screen.step());
            let mut all = sizes(&screen, Rect::from_min_size(Pos2::ZERO, usual));
            all.retain(|(name, _)| name != OVERVIEW && PINNED.iter().all(|key| *name != label(*key)));
            assert!(all.len() > 30, "{page:?}");
            let mut screen = zoomed(snapshot(page), size);
            let mut seen: Vec<(String, Vec2)> = Vec::new();
            for step in 0..81 {
                look_at(&mut screen, (step % 9) as f32 / 8.0, (step / 9) as f32 / 8.0);
                seen.extend(sizes(&screen, part(size)));
            }
            // What is wider than the part is seen piece by piece.
            let room = part(size).size();
            let is_seen = |(name, whole): &(String, Vec2)| {
                let wanted = (*whole * 0.9).min(room - vec2(1.0, 1.0));
                seen.iter().any(|(other, shown)| other == name && shown.x >= wanted.x && shown.y >= wanted.y)
            };
            let lacking: Vec<_> = all.iter().filter(|place| !is_seen(place)).collect();
            assert!(lacking.is_empty(), "{page:?} {size}: {lacking:?}");
        }
    }
}

/// The frame of the chosen field, in view or not.
fn framed(screen: &Screen) -> Option<Rect> {
    let frame = |shape: &egui::Shape| match shape {
        egui::Shape::Rect(rect) if rect.stroke.color == DARK.focus => Some(rect.rect),
        _ => None,
    };
    let of_page = screen.output().shapes.iter().filter(|clipped| clipped.clip_rect.max.x < 450.0);
    of_page.filter_map(|clipped| frame(&clipped.shape)).find(|rect| rect.width() > 100.0)
}

#[test]
fn h9_the_chosen_field_is_brought_into_view_and_the_pad_leaves_it_free() {
    let mut screen = zoomed(snapshot(Page::Grinding), LANDSCAPE);
    for _ in 0..12 {
        screen.key_press(egui::Key::ArrowDown);
        (0..4).for_each(|_| screen.step());
        let chosen = framed(&screen).expect("a field is chosen");
        assert!(part(LANDSCAPE).contains_rect(chosen), "{chosen}");
    }
    let before = framed(&screen).unwrap();
    finger(&mut screen, before.center(), Some(true));
    finger(&mut screen, before.center(), Some(false));
    (0..6).for_each(|_| screen.step());
    let chosen = framed(&screen).unwrap();
    let pad = ["pad-7", "pad-point"].map(|key| screen.get_by_label(key).rect());
    assert!(part(LANDSCAPE).contains_rect(chosen), "{chosen}");
    for key in pad {
        assert!(part(LANDSCAPE).expand(1.0).contains_rect(key) && !key.intersects(chosen), "{key} {chosen}");
    }
}

/// What the finger does on the overview is no swipe and presses nothing beneath.
#[test]
fn h9_a_finger_on_the_overview_moves_the_part_and_nothing_else() {
    let mut screen = zoomed(snapshot(Page::Alarm), LANDSCAPE);
    let room = screen.get_by_label(OVERVIEW).rect();
    let before = next_row(&screen);
    finger(&mut screen, room.left_center() + vec2(2.0, 0.0), Some(true));
    finger(&mut screen, room.right_center() - vec2(2.0, 0.0), None);
    finger(&mut screen, room.right_center() - vec2(2.0, 0.0), Some(false));
    (0..2).for_each(|_| screen.step());
    let sent = std::mem::take(&mut screen.state_mut().sent);
    assert!(sent.iter().all(|command| matches!(command, Command::Release(_))), "{sent:?}");
    assert!(next_row(&screen).x < before.x - 200.0, "the part shows what is on the right");
    // A page that is opened begins at its upper left corner.
    screen.state_mut().snapshot = snapshot(Page::Home);
    (0..3).for_each(|_| screen.step());
    assert!((next_row(&screen).x - before.x).abs() < 1.0);
    // So does one whose chosen field is elsewhere.
    screen.state_mut().snapshot = snapshot(Page::Jobs);
    (0..4).for_each(|_| screen.step());
    assert!((next_row(&screen).x - before.x).abs() < 1.0);
    // The keyboard moves it as well.
    let before = next_row(&screen);
    screen.key_press_modifiers(Modifiers::ALT, egui::Key::ArrowDown);
    (0..2).for_each(|_| screen.step());
    assert!(next_row(&screen).y < before.y - 50.0, "{before} {}", next_row(&screen));
}

fn next_row(screen: &Screen) -> Pos2 {
    screen.get_by_label("▶ next-row").rect().center()
}

/// The panel goes on beneath the strip: a second finger there presses only what is seen.
#[test]
fn h9_a_second_finger_presses_only_what_is_in_view() {
    let mut screen = zoomed(snapshot(Page::Position), LANDSCAPE);
    let places = PINNED.map(|key| screen.get_by_label(&label(key)).rect().center());
    for (key, place) in PINNED.into_iter().zip(places) {
        screen.state_mut().sent.clear();
        let first = pos2(60.0, 60.0);
        let events = &mut screen.input_mut().events;
        events.push(finger_event(1, TouchPhase::Start, first));
        screen.step();
        screen.input_mut().events.push(finger_event(2, TouchPhase::Start, place));
        screen.step();
        for (id, at) in [(2, place), (1, first)] {
            screen.input_mut().events.push(finger_event(id, TouchPhase::End, at));
        }
        (0..6).for_each(|_| screen.step());
        let sent: Vec<_> = screen.state().sent.iter().map(|command| format!("{command:?}")).collect();
        let wanted: &[&str] = match key {
            Key::Reset => &["Press(Reset)", "Release(Reset)"],
            Key::FeedHold => &["Press(FeedHold)", "Release(FeedHold)"],
            Key::EmergencyStop => &["EmergencyStop(true)", "Release(EmergencyStop)"],
            _ => &[],
        };
        assert_eq!(sent, wanted, "{key:?}");
    }
}

/// A place of the screen that moves with the part: its key of the search.
fn corner(screen: &Screen) -> Pos2 {
    screen.get_by_label("全部查找 header-search").rect().min
}

/// What the machine and the keys of the panel do moves nothing.
#[test]
fn h9_the_part_stays_while_the_panel_is_used() {
    for key in [(Modifiers::NONE, egui::Key::F11), (Modifiers::ALT, egui::Key::U), (Modifiers::NONE, egui::Key::F10)] {
        let mut screen = zoomed(snapshot(Page::Position), LANDSCAPE);
        look_at(&mut screen, 0.5, 0.3);
        let before = corner(&screen);
        let (modifiers, physical) = key;
        for pressed in [true, false] {
            let (physical_key, repeat) = (None, false);
            screen.event(Event::Key { key: physical, physical_key, pressed, repeat, modifiers });
            (0..6).for_each(|_| screen.step());
            assert_eq!(corner(&screen), before, "{physical:?} {pressed}");
        }
    }
    // A block ends: the cursor's line is framed again.
    let mut machine = snapshot(Page::Program);
    machine.state = kt830::link::snapshot::RunState::Running;
    let mut screen = zoomed(machine, LANDSCAPE);
    look_at(&mut screen, 1.0, 0.5);
    let before = screen.get_by_label("冷却 coolant").rect();
    screen.state_mut().snapshot.state = kt830::link::snapshot::RunState::Held;
    (0..6).for_each(|_| screen.step());
    assert_eq!(screen.get_by_label("冷却 coolant").rect(), before);
}

/// The part has moved under the finger: the second tap of a double tap does nothing.
#[test]
fn h9_what_has_just_come_under_the_finger_takes_no_touch() {
    // The size: at 200 % another key is where that of 200 % was.
    let mut screen = open_sized(snapshot(Page::Settings), LANDSCAPE * 2.0);
    screen.step();
    let place = screen.get_by_label("200 % size-200").rect().center();
    let tap = |screen: &mut Screen, at: Pos2| {
        // A quarter of a second each: two taps are half a second.
        screen.input_mut().events.push(Event::PointerMoved(at));
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            screen.input_mut().events.push(Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        screen.step();
    };
    for waits in [0, 4] {
        screen.state_mut().hmi.set_zoom(100);
        (0..4).for_each(|_| screen.step());
        tap(&mut screen, place);
        assert_eq!((screen.state().hmi.zoom() * 100.0).round() as u16, 200);
        (0..waits).for_each(|_| screen.step());
        screen.state_mut().sent.clear();
        let other = screen.get_by_label("English lang-en").rect();
        tap(&mut screen, other.center());
        screen.step();
        let said = screen.state().sent.iter().any(|command| matches!(command, Command::Page(PageCommand::SetLang(_))));
        assert_eq!(said, waits > 0, "{:?}", screen.state().sent);
    }
}

/// A row that was chosen is not brought back while the list is moved.
#[test]
fn h9_a_list_that_is_moved_moves_no_part() {
    let mut screen = zoomed(snapshot(Page::Params), LANDSCAPE);
    screen.key_press(egui::Key::ArrowDown);
    (0..4).for_each(|_| screen.step());
    look_at(&mut screen, 0.5, 0.4);
    let before = corner(&screen);
    let from = part(LANDSCAPE).center();
    finger(&mut screen, from, Some(true));
    finger(&mut screen, from - vec2(0.0, 60.0), None);
    finger(&mut screen, from - vec2(0.0, 90.0), Some(false));
    (0..4).for_each(|_| screen.step());
    assert_eq!(corner(&screen), before);
}

/// The input line is far from the field: the message line beside the part says what is typed, and why it is refused.
#[test]
fn h6_a_refusal_is_in_view_while_a_value_is_typed() {
    let mut screen = zoomed(snapshot(Page::Grinding), LANDSCAPE);
    screen.key_press(egui::Key::ArrowDown);
    screen.event(Event::Text("99999999".to_owned()));
    screen.key_press(egui::Key::Enter);
    (0..4).for_each(|_| screen.step());
    let (_, refused) = screen.state().hmi.refusal(kt830::defs::text::Lang::Zh).expect("the value is refused");
    let texts = screen.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        egui::Shape::Text(text) => Some((text, text.visual_bounding_rect().intersect(clipped.clip_rect))),
        _ => None,
    });
    let seen = texts.filter(|(_, place)| place.is_positive() && place.min.y >= part(LANDSCAPE).max.y);
    let told: Vec<_> = seen.map(|(text, _)| text.galley.job.text.clone()).collect();
    assert!(told.iter().any(|text| text.contains("99999999") && text.contains(&refused)), "{refused}: {told:?}");
}

/// A long touch is answered where the eye is.
#[test]
fn h9_a_key_is_explained_in_the_part_that_is_shown() {
    for size in [LANDSCAPE, PORTRAIT] {
        let mut screen = zoomed(snapshot(Page::Position), size);
        look_at(&mut screen, 1.0, 1.0);
        let key = screen.get_by_label(&label(Key::CycleStart)).rect().center();
        finger(&mut screen, key, Some(true));
        (0..8).for_each(|_| screen.step());
        finger(&mut screen, key, Some(false));
        screen.step();
        let card = screen.output().shapes.iter().find_map(|clipped| match &clipped.shape {
            egui::Shape::Text(text) if text.galley.job.text.contains("短按才执行") => {
                Some(text.visual_bounding_rect().intersect(clipped.clip_rect))
            }
            _ => None,
        });
        let card = card.expect("the answer");
        assert!(card.is_positive() && part(size).expand(1.0).contains_rect(card), "{card} {size}");
        let pressed = screen.state().sent.iter().any(|command| matches!(command, Command::Press(Key::CycleStart)));
        assert!(!pressed);
    }
}

/// A window may be as small as its frame allows: the screen goes on painting.
#[test]
fn h1_no_display_is_too_small() {
    for size in [vec2(512.0, 384.0), vec2(300.0, 200.0), vec2(120.0, 90.0), vec2(40.0, 300.0), vec2(17.0, 17.0)] {
        for percent in ZOOMS {
            let mut screen = open_sized(snapshot(Page::Position), size);
            screen.state_mut().hmi.set_zoom(percent);
            for page in Page::ALL {
                screen.state_mut().snapshot = snapshot(*page);
                (0..2).for_each(|_| screen.step());
                assert!(screen.query_by_label(&label(Key::EmergencyStop)).is_some(), "{page:?} {size} {percent} %");
            }
        }
    }
}

#[test]
fn h9_the_size_is_chosen_on_the_settings_page_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::new(kept_rig(folder.path(), kt830::defs::kind::Kind::Gc), Page::Settings);
    assert!(bench.screen.query_by_label(OVERVIEW).is_none(), "100 % has no part to move");
    let kept = || kt830::store::StoredSettings::read(folder.path()).unwrap().zoom;
    for percent in [150, 200] {
        bench.touch(&format!("{percent} % size-{percent}"));
        assert_eq!(kept(), Some(percent));
        let shown = (bench.screen.state().hmi.zoom() * 100.0).round() as u16;
        assert_eq!(shown, percent);
        bench.screen.get_by_label(OVERVIEW);
    }
    // What another version may have stored shows the whole screen.
    bench.screen.state_mut().hmi.set_zoom(100);
    for other in [0, 99, 175, 400] {
        bench.screen.state_mut().hmi.set_zoom(other);
        bench.turn();
        assert!(bench.screen.query_by_label(OVERVIEW).is_none());
    }
    bench.rig.send(Command::Page(PageCommand::SetZoom(175)));
    bench.turn();
    assert_eq!(kept(), Some(200), "a size that is not offered changes nothing");
}
