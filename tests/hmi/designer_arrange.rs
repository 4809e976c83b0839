//! The page designer's preview under the finger: entries are chosen, moved and removed, frames are drawn on the picture.
//! Source: spec K7.3, K7.4; issue "the face", part 11.

use std::fs;

use egui::{Event, Pos2, pos2, vec2};
use egui_kittest::kittest::Queryable;
use kt830::defs::page_text;
use kt830::link::screens::PictureLabel;

use crate::designer::{PAGE, Shop};

fn middle(shop: &Shop, label: &str) -> Pos2 {
    shop.bench.screen.get_by_label(label).rect().center()
}

/// A finger drags from one place to another.
fn drag(shop: &mut Shop, from: Pos2, to: Pos2) {
    let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
    let bench = &mut shop.bench;
    bench.screen.event(Event::PointerMoved(from));
    bench.screen.event(Event::PointerButton { pos: from, button, pressed: true, modifiers });
    for share in [0.3, 0.7, 1.0] {
        bench.screen.event(Event::PointerMoved(from + (to - from) * share));
    }
    bench.screen.event(Event::PointerButton { pos: to, button, pressed: false, modifiers });
    bench.turn();
    bench.turn();
}

fn drag_entry(shop: &mut Shop, from: usize, to: usize) {
    let (from, to) = (middle(shop, &format!("entry-{from}")), middle(shop, &format!("entry-{to}")));
    drag(shop, from, to);
}

/// A shop whose page has a picture.
fn shop_with_picture() -> Shop {
    let mut shop = Shop::new();
    let picture = concat!(env!("CARGO_MANIFEST_DIR"), "/screens/B0003.BMP");
    fs::copy(picture, shop.path("screens/B0003.BMP")).unwrap();
    // A direct storage reads its folders again after a job that changes them.
    shop.edit();
    shop.bench.write("甲");
    shop.save();
    shop
}

fn labels(shop: &mut Shop) -> Vec<PictureLabel> {
    shop.bench.rig.snapshot().screens.find(1_003).unwrap().labels.clone()
}

#[test]
fn k7_4_entries_change_their_places_under_the_finger() {
    let mut shop = Shop::new();
    // Nothing moves before the page is edited.
    assert!(shop.bench.screen.query_by_label("entry-1").is_none());
    shop.edit();
    drag_entry(&mut shop, 1, 3);
    let saved = shop.save();
    assert_eq!(
        saved,
        PAGE.replace("始磨位置 #500", "X").replace("不用的 #520", "始磨位置 #500").replace("X", "不用的 #520")
    );
    // Into an empty place, and into the right column, which the text does not reach yet.
    drag_entry(&mut shop, 2, 5);
    drag_entry(&mut shop, 1, 12);
    let saved = page_text::parse(&shop.save()).unwrap();
    let at = |column: &[Option<page_text::PageTextRow>], index: usize| column[index].as_ref().map(|row| row.variable);
    assert_eq!([at(&saved.left, 0), at(&saved.left, 1), at(&saved.left, 4)], [None, None, Some(501)]);
    assert_eq!([at(&saved.right, 0), at(&saved.right, 1)], [None, Some(520)]);
    // One change is one step back.
    shop.bench.touch("撤销 page-undo");
    let before = page_text::parse(&shop.save()).unwrap();
    assert_eq!(at(&before.left, 0), Some(520));
    // A place that the text does not reach is chosen without a change; line ends are those of the file.
    let at = middle(&shop, "entry-20");
    shop.bench.tap(at);
    assert!(!shop.bench.shows("未保存"));
    assert!(!shop.page().replace("\r\n", "").contains('\n'));
    // Dropped beside the page, nothing moves.
    let from = middle(&shop, "entry-1");
    drag(&mut shop, from, pos2(300.0, 20.0));
    assert_eq!(page_text::parse(&shop.page()).unwrap(), before);
    assert!(!shop.bench.shows("未保存"));
}

#[test]
fn k7_4_an_entry_is_chosen_named_and_removed_on_the_page() {
    let mut shop = Shop::new();
    shop.edit();
    let at = middle(&shop, "entry-2");
    shop.bench.tap(at);
    // The cursor stands behind its name.
    shop.bench.write("二");
    assert_eq!(shop.save(), PAGE.replace("终点位置", "终点位置二"));
    shop.bench.touch("删除该项 entry-remove");
    assert_eq!(shop.save(), PAGE.replace("终点位置 #501", ""));
    // A variable goes to the place that is chosen.
    let at = middle(&shop, "entry-7");
    shop.bench.tap(at);
    shop.bench.touch("变量 缺 3 page-variables");
    shop.bench.touch("加入 add-0-#501");
    let saved = page_text::parse(&shop.save()).unwrap();
    assert_eq!(saved.left[6].as_ref().map(|row| row.variable), Some(501));
}

#[test]
fn k7_4_errors_of_the_text_are_corrected_first() {
    let mut shop = Shop::new();
    shop.edit();
    // The `;` of the first entry is gone.
    shop.bench.press(egui::Key::ArrowDown);
    shop.bench.press(egui::Key::ArrowDown);
    shop.bench.press(egui::Key::End);
    shop.bench.press(egui::Key::Backspace);
    drag_entry(&mut shop, 2, 1);
    assert_eq!(shop.refusal(), "先改正文字中的错误");
    let at = middle(&shop, "entry-2");
    shop.bench.tap(at);
    drag_entry(&mut shop, 2, 1);
    assert_eq!(shop.refusal(), "先改正文字中的错误");
}

#[test]
fn k7_3_a_frame_drawn_on_the_picture_is_the_place_of_the_chosen_value() {
    let mut shop = shop_with_picture();
    let picture = shop.bench.screen.get_by_label("design-picture").rect();
    let scale = picture.width() / 200.0;
    let at = |x: f32, y: f32| picture.min + vec2(x, y) * scale;
    // Without a chosen entry there is no variable; a touch draws nothing.
    shop.bench.press(egui::Key::Home);
    drag(&mut shop, at(20.0, 40.0), at(60.0, 60.0));
    assert!(shop.refusal().starts_with("先碰一下"), "{}", shop.refusal());
    let entry = middle(&shop, "entry-2");
    shop.bench.tap(entry);
    shop.bench.tap(at(20.0, 40.0));
    assert!(!shop.path("screens/D0003.RON").exists());
    drag(&mut shop, at(20.0, 40.0), at(60.0, 60.0));
    assert!(shop.bench.shows("D0003.RON 已保存"), "{}", shop.refusal());
    assert_eq!(labels(&mut shop), [PictureLabel { variable: 501, area: (20, 40, 60, 60) }]);
    // Drawn backwards and over the edge: another place of the same variable.
    drag(&mut shop, at(190.0, 390.0), picture.max + vec2(50.0, 3.0));
    assert_eq!(labels(&mut shop), [PictureLabel { variable: 501, area: (190, 390, 200, 400) }]);
    let entry = middle(&shop, "entry-1");
    shop.bench.tap(entry);
    drag(&mut shop, at(60.0, 60.0), at(20.0, 40.0));
    assert_eq!(labels(&mut shop).len(), 2);
    // A touch of a frame chooses its entry.
    shop.bench.tap(at(195.0, 395.0));
    shop.bench.write("二");
    let saved = shop.save();
    assert!(saved.contains("终点位置二 #501"), "{saved} {}", shop.refusal());
    shop.bench.touch("删除图标 frame-remove");
    assert_eq!(labels(&mut shop), [PictureLabel { variable: 500, area: (20, 40, 60, 60) }]);
}

/// A finger that is lost while it draws, by another window or a touch screen that fails, has drawn nothing.
#[test]
fn k7_3_a_frame_is_not_saved_by_a_finger_that_is_lost() {
    let mut shop = shop_with_picture();
    let picture = shop.bench.screen.get_by_label("design-picture").rect();
    let entry = middle(&shop, "entry-1");
    shop.bench.tap(entry);
    drag(&mut shop, picture.center(), pos2(-10_000.0, -10_000.0));
    assert!(!shop.path("screens/D0003.RON").exists());
    drag(&mut shop, picture.center(), picture.center() + vec2(40.0, 40.0));
    assert!(shop.path("screens/D0003.RON").exists());
}

#[test]
fn k7_3_frames_that_others_have_changed_or_spoilt_are_not_overwritten() {
    let mut shop = shop_with_picture();
    let picture = shop.bench.screen.get_by_label("design-picture").rect();
    let entry = middle(&shop, "entry-1");
    shop.bench.tap(entry);
    let others = "[(variable: \"#520\", area: (1, 2, 30, 40))]";
    for found in [others, "[(variable"] {
        fs::write(shop.path("screens/D0003.RON"), found).unwrap();
        drag(&mut shop, picture.center(), picture.center() + vec2(40.0, 40.0));
        assert!(!shop.refusal().is_empty(), "{found}");
        assert_eq!(fs::read_to_string(shop.path("screens/D0003.RON")).unwrap(), found);
    }
    // What others have drawn is read at the conflict: the next frame stands beside it.
    fs::write(shop.path("screens/D0003.RON"), others).unwrap();
    drag(&mut shop, picture.center(), picture.center() + vec2(40.0, 40.0));
    drag(&mut shop, picture.center(), picture.center() + vec2(40.0, 40.0));
    assert_eq!(labels(&mut shop).len(), 2, "{}", shop.refusal());
}

#[test]
fn h9_the_english_text_keeps_the_places_of_the_page_text() {
    let mut shop = Shop::new();
    shop.bench.touch("英文 page-language");
    shop.edit();
    drag_entry(&mut shop, 1, 3);
    assert!(shop.refusal().starts_with("位置由页面文字决定"), "{}", shop.refusal());
}
