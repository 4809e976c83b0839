//! What spectators of a demonstration see below the page (row T2).

use egui_kittest::kittest::Queryable;
use kt830::defs::page::Page;
use kt830::defs::text::LocalizedText;
use kt830::link::demo_view::DemoView;

use crate::live_screen::Bench;
use crate::stories::ready;

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
