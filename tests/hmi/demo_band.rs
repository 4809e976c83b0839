//! What spectators of a demonstration see below the page (row T2).

use egui_kittest::kittest::Queryable;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::text::LocalizedText;
use kt830::link::Command;
use kt830::link::demo_view::DemoView;

use crate::live_screen::Bench;
use crate::stories::{ready, ready_of, tell};

fn shown(demo: DemoView) -> Bench {
    let mut rig = ready();
    rig.show_demo(demo);
    Bench::new(rig, Page::Home)
}

/// The caption stands below the page: nothing of the page is hidden by it.
#[test]
fn t2_a_caption_stands_below_the_page_and_invites_to_a_touch() {
    let silent = shown(DemoView::Silent);
    assert!(!silent.shows("触摸试一试"));
    let mut told = shown(DemoView::Caption(LocalizedText::new("砂轮启动", "the wheel starts")));
    assert!(told.shows("砂轮启动") && told.shows("触摸试一试"), "{:?}", told.painted());
    let bottom = |bench: &Bench| bench.screen.get_by_label_contains("home-alarm").rect().bottom();
    assert!(bottom(&told) < bottom(&silent) - 50.0);
    told.rig.show_demo(DemoView::Silent);
    told.turn();
    assert!(!told.shows("砂轮启动"));
    assert!((bottom(&told) - bottom(&silent)).abs() < 0.5);
}

#[test]
fn t2_who_has_touched_is_told_how_long_it_is_until_the_demonstration_goes_on() {
    let mut taken = shown(DemoView::TakenOver { seconds_left: 42, of: 60 });
    assert!(taken.shows("42 s") && !taken.shows("触摸试一试"), "{:?}", taken.painted());
    taken.rig.show_demo(DemoView::TakenOver { seconds_left: 41, of: 60 });
    taken.turn();
    assert!(taken.shows("41 s"));
}

/// Wherever the finger lands, and whatever key is pressed, somebody takes over; on a machine without a demonstration a touch
/// of nothing sends nothing.
#[test]
fn t2_any_touch_and_any_key_takes_over() {
    let mut bench = shown(DemoView::Caption(LocalizedText::new("砂轮启动", "the wheel starts")));
    let sent = |bench: &mut Bench| {
        bench.screen.step();
        let sent = std::mem::take(&mut bench.screen.state_mut().sent);
        sent.iter().any(|command| matches!(command, Command::TakeOver))
    };
    assert!(!sent(&mut bench));
    let press = |bench: &mut Bench, pressed: bool| {
        let (pos, button, modifiers) = (egui::pos2(400.0, 520.0), egui::PointerButton::Primary, egui::Modifiers::NONE);
        bench.screen.input_mut().events.push(egui::Event::PointerButton { pos, button, pressed, modifiers });
    };
    press(&mut bench, true);
    assert!(sent(&mut bench), "a place without a key");
    press(&mut bench, false);
    assert!(!sent(&mut bench));
    bench.screen.key_press(egui::Key::ArrowDown);
    assert!(sent(&mut bench));
    let mut silent = shown(DemoView::Silent);
    press(&mut silent, true);
    assert!(!sent(&mut silent));
}

/// A title lies over the page, with the name of the machine; there is no band, and a touch takes over as well.
#[test]
fn t2_a_title_says_what_comes_next_and_a_touch_takes_over() {
    let mut bench = shown(DemoView::Title(LocalizedText::new("一批零件", "a batch")));
    let painted = bench.painted();
    assert!(painted.iter().any(|text| text == "一批零件") && painted.iter().any(|text| text == "KT-830GC"));
    assert!(!bench.shows("触摸试一试"), "{painted:?}");
    bench.screen.step();
    bench.screen.state_mut().sent.clear();
    bench.screen.key_press(egui::Key::ArrowDown);
    bench.screen.step();
    assert!(bench.screen.state().sent.iter().any(|command| matches!(command, Command::TakeOver)));
    let mut rig = ready();
    tell(&mut rig, "title \"一批零件\" \"a batch\"\nprepared");
    assert_eq!(rig.snapshot().host.demo, DemoView::Title(LocalizedText::new("一批零件", "a batch")));
}

/// Another machine comes under the screen: no page shows what was typed for the one before.
#[test]
fn t2_the_pages_begin_anew_on_another_machine() {
    let mut rig = ready();
    tell(&mut rig, "load O1002");
    let mut bench = Bench::new(rig, Page::Grinding);
    bench.write("12");
    let typed = |bench: &Bench| bench.screen.state().hmi.variable_entry().map(|entry| entry.editor.text.clone());
    assert_eq!(typed(&bench).as_deref(), Some("12"));
    bench.rig = ready_of(Kind::Gs);
    bench.rig.send(Command::OpenPage(Page::Grinding));
    bench.turn();
    assert_eq!(typed(&bench).as_deref(), Some(""));
    assert!(bench.shows("KT-830GS"), "{:?}", bench.painted());
    // Another one of the same kind, whose time goes on.
    tell(&mut bench.rig, "load O1007");
    bench.turn();
    bench.write("34");
    assert_eq!(typed(&bench).as_deref(), Some("34"));
    bench.rig.number_control(1);
    bench.turn();
    assert_eq!(typed(&bench).as_deref(), Some(""));
}

#[test]
fn t2_a_line_of_the_story_tells_spectators_something() {
    let mut rig = ready();
    tell(&mut rig, "caption \"砂轮启动\" \"the wheel starts\"");
    let caption = LocalizedText::new("砂轮启动", "the wheel starts");
    assert_eq!(rig.snapshot().host.demo, DemoView::Caption(caption));
    tell(&mut rig, "caption off");
    assert_eq!(rig.snapshot().host.demo, DemoView::Silent);
}
