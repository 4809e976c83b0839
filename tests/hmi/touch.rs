//! The finger on the screen: a swipe turns the page, a long touch explains a key, an opened page fades in. Source: spec H9.

use egui::{Event, Modifiers, PointerButton, Pos2, TouchPhase, pos2, vec2};
use egui_kittest::kittest::Queryable;
use kt830::defs::key::{Key, KeyGroup};
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::soft_key::CoordinateView;
use kt830::hmi::theme;
use kt830::link::Command;
use kt830::link::internal_signal::InternalSignal;
use kt830::link::page_command::PageCommand;

use crate::sample::snapshot;
use crate::screen::{Screen, finger_event, open, painted};

/// Frames of a quarter of a second in which nothing comes from the finger.
fn wait(screen: &mut Screen, frames: usize) {
    (0..frames).for_each(|_| screen.step());
}

fn finger(screen: &mut Screen, pos: Pos2, pressed: Option<bool>) {
    screen.event(Event::PointerMoved(pos));
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    if let Some(pressed) = pressed {
        screen.event(Event::PointerButton { pos, button, pressed, modifiers });
    }
    screen.step();
}

/// A swipe from a place by a way, with a rest of some frames under way; what it sends.
fn swipe(screen: &mut Screen, from: Pos2, way: egui::Vec2, rest: usize) -> Vec<Command> {
    screen.state_mut().sent.clear();
    finger(screen, from, Some(true));
    wait(screen, rest);
    // The harness gives each event a frame of its own: the finger has moved before it is lifted.
    finger(screen, from + way, Some(false));
    std::mem::take(&mut screen.state_mut().sent)
}

fn sent(screen: &mut Screen) -> Vec<String> {
    std::mem::take(&mut screen.state_mut().sent).iter().map(|command| format!("{command:?}")).collect()
}

fn opened(commands: &[Command]) -> Vec<Page> {
    let page = |command: &Command| match command {
        Command::OpenPage(page) => Some(*page),
        _ => None,
    };
    commands.iter().filter_map(page).collect()
}

const MIDDLE: Pos2 = pos2(380.0, 300.0);
const LEFT: egui::Vec2 = vec2(-250.0, 20.0);
const RIGHT: egui::Vec2 = vec2(250.0, -20.0);

#[test]
fn h9_a_swipe_opens_the_next_page_of_its_row_or_the_one_before() {
    // Row 4: process, alarms, wheel, settings, help.
    let mut screen = open(snapshot(Page::Alarm));
    assert_eq!(opened(&swipe(&mut screen, MIDDLE, LEFT, 0)), [Page::Wheel]);
    assert_eq!(opened(&swipe(&mut screen, MIDDLE, RIGHT, 0)), [Page::Process]);
    // The row ends: no page of another row.
    let mut screen = open(snapshot(Page::Help));
    assert_eq!(opened(&swipe(&mut screen, pos2(380.0, 80.0), LEFT, 0)), []);
    // The views of the position are pages of their row.
    let mut machine = snapshot(Page::Position);
    machine.coordinates = CoordinateView::Relative;
    let mut screen = open(machine);
    let commands = swipe(&mut screen, MIDDLE, LEFT, 0);
    assert!(
        commands.iter().any(|command| matches!(command, Command::ShowCoordinates(CoordinateView::All))),
        "{commands:?}"
    );
    // A key that opens no page is passed: row 2 ends with PRINT.
    let mut screen = open(snapshot(Page::Transfer));
    assert_eq!(opened(&swipe(&mut screen, pos2(380.0, 64.0), LEFT, 0)), []);
}

#[test]
fn h9_what_is_no_swipe_opens_nothing() {
    let mut screen = open(snapshot(Page::Alarm));
    for (from, way, rest, what) in [
        (MIDDLE, vec2(-100.0, 0.0), 0, "short"),
        (MIDDLE, vec2(-250.0, 150.0), 0, "steep"),
        (MIDDLE, LEFT, 4, "slow"),
        (pos2(900.0, 300.0), LEFT, 0, "from the panel"),
        (pos2(380.0, 740.0), LEFT, 0, "from the soft keys"),
    ] {
        let commands = swipe(&mut screen, from, way, rest);
        assert!(commands.iter().all(|command| matches!(command, Command::Release(_))), "{what}: {commands:?}");
    }
    // Where a drag moves something sideways.
    for page in [Page::Graphic, Page::Process, Page::Scope] {
        let mut screen = open(snapshot(page));
        assert_eq!(opened(&swipe(&mut screen, pos2(420.0, 250.0), LEFT, 0)), [], "{page:?}");
    }
}

#[test]
fn h9_a_swipe_over_keys_and_rows_presses_none() {
    for page in Page::ALL {
        let mut screen = open(snapshot(*page));
        for from in [pos2(500.0, 120.0), MIDDLE, pos2(500.0, 560.0)] {
            for command in swipe(&mut screen, from, LEFT, 0) {
                // A page may ask for its files.
                let turns = matches!(
                    command,
                    Command::OpenPage(_) | Command::ShowCoordinates(_) | Command::Page(PageCommand::File(..))
                );
                assert!(turns, "{page:?} {from:?}: {command:?}");
            }
        }
    }
}

#[test]
fn h9_a_long_touch_explains_a_key_and_does_not_press_it() {
    let mut screen = open(snapshot(Page::Position));
    let place =
        |screen: &Screen, key: Key| screen.get_by_label(&format!("{} {}", key.label().zh, key.id())).rect().center();
    let explained = |screen: &Screen| painted(screen).iter().any(|text| text.contains("短按才执行"));
    let key = place(&screen, Key::Lubrication);
    // The slow touch of a glove presses.
    finger(&mut screen, key, Some(true));
    wait(&mut screen, 3);
    finger(&mut screen, key, Some(false));
    assert_eq!(sent(&mut screen), ["Press(Lubrication)", "Release(Lubrication)"]);
    assert!(!explained(&screen));
    // A long one explains, and nothing is sent when it ends.
    finger(&mut screen, key, Some(true));
    wait(&mut screen, 8);
    assert!(explained(&screen), "{:?}", painted(&screen));
    finger(&mut screen, key, Some(false));
    wait(&mut screen, 2);
    assert_eq!(sent(&mut screen), [""; 0]);
    // The next touch is a press again.
    finger(&mut screen, key, Some(true));
    finger(&mut screen, key, Some(false));
    assert_eq!(sent(&mut screen), ["Press(Lubrication)", "Release(Lubrication)"]);
    // Keys that act at once are not explained: feed hold must not wait.
    let mut screen = open(snapshot(Page::Position));
    let hold = place(&screen, Key::FeedHold);
    finger(&mut screen, hold, Some(true));
    assert_eq!(sent(&mut screen), ["Press(FeedHold)"]);
    wait(&mut screen, 8);
    assert!(!explained(&screen));
}

/// Keys that stop, retract or slow act however long the finger rests; so does a key that switches off. A jog key moves at
/// once and is never explained.
#[test]
fn h9_a_long_touch_of_a_key_that_stops_is_a_press() {
    for key in Key::ALL.iter().copied().filter(|key| key.exists_on(Kind::Gc)) {
        let mut screen = open(snapshot(Page::Alarm));
        let label = format!("{} {}", key.label().zh, key.id());
        let Some(place) = screen.query_by_label(&label).map(|node| node.rect().center()) else { continue };
        finger(&mut screen, place, Some(true));
        wait(&mut screen, 8);
        finger(&mut screen, place, Some(false));
        let said = sent(&mut screen);
        let pressed = said.iter().any(|what| *what == format!("Press({key:?})") || what.starts_with("EmergencyStop"));
        let stops = matches!(
            key,
            Key::WheelStop | Key::HeadstockStop | Key::WheelRetract | Key::FeedHold | Key::Reset | Key::EmergencyStop
        );
        let slows = key.row().group == KeyGroup::Override;
        let moves = key.jog_direction().is_some();
        let is_on = screen.state().snapshot.key(key).lamp;
        assert_eq!(pressed, stops || slows || moves || is_on, "{key:?}: {said:?}");
    }
}

/// Whether the veil of a page that fades in lies over it.
fn is_veiled(screen: &Screen) -> bool {
    let ground = theme::DARK.background;
    let veil = |shape: &egui::Shape| match shape {
        egui::Shape::Rect(rect) => {
            let colour = rect.fill;
            rect.rect.width() > 500.0
                && rect.rect.height() > 300.0
                && colour != ground
                && (1..255).contains(&colour.a())
        }
        _ => false,
    };
    screen.output().shapes.iter().any(|clipped| veil(&clipped.shape))
}

#[test]
fn h9_an_opened_page_is_there_at_once_and_fades_in_only_on_a_display() {
    for fades in [true, false] {
        let mut screen = open(snapshot(Page::Position));
        screen.state_mut().hmi.set_fades(fades);
        screen.step();
        assert!(!is_veiled(&screen));
        screen.state_mut().snapshot = snapshot(Page::Alarm);
        screen.step();
        assert_eq!(is_veiled(&screen), fades);
        assert!(painted(&screen).iter().any(|text| text.contains("报警")));
        // The next frame of the harness is a quarter of a second later.
        screen.step();
        assert!(!is_veiled(&screen));
    }
}

/// Two fingers, as the window translates them: the first one is the pointer, the second one is not.
fn two_fingers(first: Pos2, second: Pos2) -> Vec<String> {
    let mut screen = open(snapshot(Page::Alarm));
    let button = |pressed: bool| {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos: first, button, pressed, modifiers }
    };
    let frames = [
        vec![finger_event(1, TouchPhase::Start, first), Event::PointerMoved(first), button(true)],
        vec![finger_event(2, TouchPhase::Start, second)],
        vec![finger_event(2, TouchPhase::Move, second + vec2(3.0, 0.0))],
        vec![finger_event(2, TouchPhase::End, second)],
        vec![finger_event(1, TouchPhase::End, first), button(false), Event::PointerGone],
    ];
    for events in frames {
        screen.input_mut().events.extend(events);
        screen.step();
    }
    sent(&mut screen)
}

/// A finger that rests somewhere, on the page or on another key, keeps nobody from stopping the machine.
#[test]
fn h9_a_second_finger_presses_the_keys_that_stop() {
    let screen = open(snapshot(Page::Alarm));
    let place = |key: Key| {
        let label = format!("{} {}", key.label().zh, key.id());
        screen.get_by_label(&label).rect().center()
    };
    for rests in [MIDDLE, place(Key::XPlus), place(Key::Coolant)] {
        for key in [Key::EmergencyStop, Key::FeedHold, Key::Reset] {
            let said = two_fingers(rests, place(key));
            let pressed = said.iter().filter(|what| {
                **what == format!("Press({key:?})") || (key == Key::EmergencyStop && what.starts_with("EmergencyStop"))
            });
            assert_eq!(pressed.count(), 1, "{key:?}: {said:?}");
        }
        let said = two_fingers(rests, place(Key::WheelStart));
        assert!(!said.iter().any(|what| what.contains("WheelStart")), "{said:?}");
    }
    // A key under the first finger is not pressed when a second one has come.
    let said = two_fingers(place(Key::Coolant), MIDDLE);
    assert!(!said.iter().any(|what| what.contains("Coolant")), "{said:?}");
    // A stop key under a single finger is pressed once.
    let said = two_fingers(place(Key::FeedHold), MIDDLE);
    assert_eq!(said.iter().filter(|what| *what == "Press(FeedHold)").count(), 1, "{said:?}");
}

/// A hand slaps the emergency stop: several fingers touch it, together or one soon after the other. It stays pressed; a
/// touch of its own, later, turns it out.
#[test]
fn h9_a_slap_with_several_fingers_keeps_the_emergency_stop_pressed() {
    let screen = open(snapshot(Page::Alarm));
    let key = Key::EmergencyStop;
    let place = screen.get_by_label(&format!("{} {}", key.label().zh, key.id())).rect().center();
    let stops = |said: &[String]| -> Vec<String> {
        said.iter().filter(|what| what.starts_with("EmergencyStop")).cloned().collect()
    };
    let said = two_fingers(place, place + vec2(6.0, 4.0));
    assert_eq!(stops(&said), ["EmergencyStop(true)", "EmergencyStop(true)"], "{said:?}");
    // The latch stands in the snapshot: a second finger does not turn it out, nor does a touch at once.
    let latched = |gap: usize| {
        let mut machine = snapshot(Page::Alarm);
        machine.internals = machine.internals.with(InternalSignal::ScreenEmergencyStop, true);
        let mut screen = open(snapshot(Page::Alarm));
        // Each in one frame: the harness gives single events a frame of their own.
        let touch = |screen: &mut Screen, pressed: bool| {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            let moved = Event::PointerMoved(place);
            screen.input_mut().events.extend([moved, Event::PointerButton { pos: place, button, pressed, modifiers }]);
            screen.step();
        };
        touch(&mut screen, true);
        touch(&mut screen, false);
        screen.state_mut().snapshot = machine;
        wait(&mut screen, gap);
        screen.state_mut().sent.clear();
        touch(&mut screen, true);
        stops(&sent(&mut screen))
    };
    assert_eq!(latched(0), ["EmergencyStop(true)"]);
    assert_eq!(latched(8), ["EmergencyStop(false)"]);
}
