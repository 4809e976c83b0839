//! The page designer with the real core, folders and medium behind it.
//! Source: spec K5.12, K6.2, K7.3, K7.4; part "page designer for the programmer" of the pages.

use std::fs;
use std::path::PathBuf;

use crate::live_screen::Bench;
use egui_kittest::kittest::Queryable;
use encoding_rs::GBK;
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::host::folders::Folders;
use tempfile::TempDir;

const PROGRAM: &str =
    "O1003 (TEST)\r\n#101=#500-#502 (磨量)\r\nG00 X#500\r\nG01 X#501 F#512 (粗磨速度)\r\n#511=#511+1\r\nM30\r\n";
pub const PAGE: &str =
    "测试;\r\n\r\n始磨位置 #500;\r\n终点位置 #501;\r\n不用的 #520;\r\n;\r\n;\r\n;\r\n;\r\n;\r\n;\r\n;\r\n\r\n%\r\n";

/// A shop with the page designer open.
pub struct Shop {
    folder: TempDir,
    pub bench: Bench,
}

impl Shop {
    pub fn new() -> Self {
        Self::with(Some(PAGE))
    }

    pub fn with(page: Option<&str>) -> Self {
        Self::of(page, PROGRAM)
    }

    fn of(page: Option<&str>, program: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["programs", "screens", "usb"] {
            fs::create_dir(path(name)).unwrap();
        }
        fs::write(path("programs").join("O1003.NC"), program).unwrap();
        fs::write(path("programs").join("O2000.NC"), "O2000\r\nM30\r\n").unwrap();
        if let Some(page) = page {
            fs::write(path("screens").join("C0003.TXT"), GBK.encode(page).0).unwrap();
        }
        let mut rig = crate::stories::rig_in(Folders {
            programs: path("programs"),
            screens: path("screens"),
            by_name: false,
            dialect: Dialect::LatheA,
        });
        rig.set_drives(Some(path("prints")), Some(path("usb")));
        crate::stories::tell(&mut rig, "load O1003");
        let bench = Bench::new(rig, Page::Designer);
        Self { folder, bench }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn tell(&mut self, story: &str) {
        crate::stories::tell(&mut self.bench.rig, story);
        self.bench.turn();
    }

    pub fn edit(&mut self) {
        self.tell("mode edit");
        self.bench.touch("编辑 page-edit");
        if self.bench.asks_password() {
            self.bench.write("187350");
            self.bench.press(egui::Key::Enter);
        }
        assert!(self.bench.screen.query_by_label("保存 page-save").is_some(), "not editing: {}", self.refusal());
    }

    pub fn save(&mut self) -> String {
        self.bench.touch("保存 page-save");
        self.page()
    }

    pub fn page(&self) -> String {
        GBK.decode(&fs::read(self.path("screens/C0003.TXT")).unwrap()).0.into_owned()
    }

    pub fn refusal(&self) -> String {
        self.bench.screen.state().hmi.refusal(Lang::Zh).map(|(_, why)| why).unwrap_or_default()
    }
}

#[test]
fn k7_4_the_page_is_seen_as_it_is_typed_and_saved_as_it_was_read() {
    let mut shop = Shop::new();
    assert!(shop.bench.shows("测试参数设置") && shop.bench.shows("始磨位置"), "the preview");
    shop.edit();
    // To the end of the title, and on.
    for _ in 0..2 {
        shop.bench.press(egui::Key::ArrowRight);
    }
    shop.bench.write("二");
    assert!(shop.bench.shows("测试二参数设置") && shop.bench.shows("未保存"));
    assert_eq!(shop.save(), PAGE.replace("测试;", "测试二;"), "GBK as before, line ends too");
    assert!(shop.bench.shows("C0003.TXT 已保存"));
    // The grinding page shows it.
    assert!(shop.bench.rig.snapshot().screens.find(1_003).is_some());
    shop.bench.touch("结束 page-end");
    shop.bench.touch("磨削页面 page-show");
    assert!(shop.bench.shows("测试二参数设置"));
}

#[test]
fn h8_what_was_saved_is_said_once() {
    let mut shop = Shop::new();
    shop.edit();
    shop.bench.write("二");
    shop.save();
    let said = |shop: &Shop| shop.bench.painted().iter().filter(|text| text.contains("C0003.TXT 已保存")).count();
    assert_eq!(said(&shop), 1, "{:?}", shop.bench.painted());
    // On another page the message line says it.
    shop.tell("page position");
    assert_eq!(said(&shop), 1);
}

#[test]
fn k7_3_the_preview_of_a_new_page_names_its_own_picture() {
    let mut shop = Shop::with(None);
    fs::write(shop.path("programs").join("O1004.NC"), "O1004\r\nM30\r\n").unwrap();
    shop.tell("load O1003");
    // O1003 is current; the page of another program is chosen in the directory.
    let mut rig = crate::stories::rig_in(Folders {
        programs: shop.path("programs"),
        screens: shop.path("screens"),
        by_name: false,
        dialect: Dialect::LatheA,
    });
    crate::stories::tell(&mut rig, "load O1003");
    let mut bench = Bench::new(rig, Page::Directory);
    bench.press(egui::Key::ArrowDown);
    bench.touch("页面设计 design-page");
    assert!(bench.shows("C0004.TXT"), "{:?}", bench.painted());
    assert!(bench.shows("B0004.BMP") && !bench.shows("B0003.BMP"), "{:?}", bench.painted());
}

#[test]
fn k7_4_every_mistake_is_told_with_its_line() {
    let mut shop = Shop::new();
    shop.edit();
    shop.bench.write("；");
    shop.bench.touch("错误 1 page-faults");
    assert!(shop.bench.shows("第1行") && shop.bench.shows("全角"));
    shop.bench.touch("撤销 page-undo");
    assert!(shop.bench.shows("没有错误"));
    // A line with a variable that may not stand on a page.
    shop.bench.press(egui::Key::ArrowDown);
    shop.bench.press(egui::Key::ArrowDown);
    shop.bench.write("甲 #1;");
    assert!(shop.bench.shows("第3行") && shop.bench.shows("#1 不能在页面上修改"));
}

#[test]
fn k7_4_what_the_program_reads_and_the_page_lacks_is_marked_and_added() {
    let mut shop = Shop::new();
    // #502 and #512 are read and not on the page; #511 and #101 are program internal; #520 is not used.
    shop.bench.touch("变量 缺 2 page-variables");
    for words in ["页面上没有", "#502", "#512", "程序没有用", "#520", "程序内部使用", "#511", "粗磨速度"]
    {
        assert!(shop.bench.shows(words), "{words}");
    }
    shop.bench.touch("加入 add-1-#512");
    assert_eq!(shop.refusal(), "先按“编辑”");
    shop.edit();
    shop.bench.touch("变量 缺 2 page-variables");
    shop.bench.touch("加入 add-1-#512");
    assert!(shop.bench.shows("已加入 #512"));
    shop.bench.touch("加入 add-0-#502");
    let saved = shop.save();
    assert!(saved.contains("不用的 #520;\r\n粗磨速度 #512;\r\n磨量 #502;\r\n;\r\n"), "{saved}");
    assert!(shop.bench.screen.query_by_label("变量 page-variables").is_some(), "none is missing");
}

#[test]
fn k6_2_a_page_is_guarded_as_its_program_is() {
    let mut shop = Shop::new();
    shop.tell("mode auto");
    shop.bench.touch("编辑 page-edit");
    assert!(shop.refusal().contains("先按面板上的 编辑 键"), "{}", shop.refusal());
    shop.tell("mode edit");
    shop.bench.touch("编辑 page-edit");
    assert!(shop.bench.asks_password());
    shop.bench.write("000000");
    shop.bench.press(egui::Key::Enter);
    assert!(shop.bench.screen.query_by_label("保存 page-save").is_none());
}

#[test]
fn k7_4_a_page_whose_program_runs_is_not_edited() {
    let mut shop = Shop::of(Some(PAGE), "O1003\r\nG04 X100\r\nM30\r\n");
    shop.bench.rig.make_ready();
    shop.bench.rig.send(kt830::link::Command::OpenPage(Page::Designer));
    shop.bench.turn();
    shop.edit();
    shop.bench.write("甲");
    shop.tell("mode auto");
    shop.tell("key cycle-start");
    assert_eq!(shop.bench.rig.snapshot().state, kt830::link::snapshot::RunState::Running);
    assert!(shop.bench.screen.query_by_label("保存 page-save").is_none(), "the run has ended the editing");
    shop.bench.touch("编辑 page-edit");
    assert!(shop.refusal().contains("程序运行中"), "{}", shop.refusal());
    assert_eq!(shop.page(), PAGE, "nothing was written");
    // What was typed is still there after the run.
    shop.tell("key reset");
    shop.edit();
    assert!(shop.bench.shows("甲测试参数设置"));
}

#[test]
fn k5_12_any_picture_is_converted_and_shown() {
    let mut shop = Shop::new();
    let red = image::RgbaImage::from_pixel(100, 100, image::Rgba([255, 0, 0, 255]));
    red.save(shop.path("usb/drawing of the part.png")).unwrap();
    fs::write(shop.path("usb/broken.jpg"), b"no picture").unwrap();
    shop.edit();
    shop.bench.touch("图片 page-pictures");
    assert!(shop.bench.shows("drawing of the part.png") && shop.bench.shows("broken.jpg"));
    shop.bench.touch("换用 take-1");
    shop.bench.touch("换用 question-picture");
    let bytes = fs::read(shop.path("screens/B0003.BMP")).unwrap();
    // K5.12: 54 + 200 · 400 · 3 bytes. The square fills the width, white above and below.
    assert_eq!(bytes.len(), 240_054);
    let made = image::load_from_memory(&bytes).unwrap().to_rgb8();
    assert_eq!((made.get_pixel(100, 200).0, made.get_pixel(100, 20).0), ([255, 0, 0], [255, 255, 255]));
    assert!(shop.bench.shows("B0003.BMP 已换成"), "{}", shop.refusal());
    let screens = shop.bench.rig.snapshot().screens.clone();
    assert!(screens.find(1_003).unwrap().picture.is_ok());
    // What is no picture changes nothing.
    shop.bench.touch("换用 take-0");
    shop.bench.touch("换用 question-picture");
    assert!(!shop.refusal().is_empty());
    assert_eq!(fs::read(shop.path("screens/B0003.BMP")).unwrap(), bytes);
}

#[test]
fn k7_3_a_page_that_is_not_there_is_begun_from_a_form() {
    let mut shop = Shop::with(None);
    assert!(shop.bench.shows("还没有这个文件") && shop.bench.shows("文字符合格式"));
    shop.edit();
    shop.bench.write("新");
    let saved = shop.save();
    assert!(saved.starts_with("新标题;") && kt830::defs::page_text::parse(&saved).is_ok(), "{saved}");
}

#[test]
fn k7_3_a_file_changed_elsewhere_is_not_lost() {
    let mut shop = Shop::new();
    shop.edit();
    shop.bench.write("甲");
    fs::write(shop.path("screens/C0003.TXT"), PAGE.replace("测试", "other")).unwrap();
    shop.bench.touch("保存 page-save");
    assert!(shop.bench.shows("文件已被别处改动"));
    shop.bench.touch("取消 question-no");
    assert!(fs::read_to_string(shop.path("screens/C0003.TXT")).unwrap().starts_with("other"));
    shop.bench.touch("保存 page-save");
    shop.bench.touch("覆盖 question-overwrite");
    assert!(fs::read(shop.path("screens/C0003.TXT")).unwrap().len() > 10);
}

#[test]
fn k7_2_the_designer_is_reached_from_grinding_program_and_directory() {
    let mut shop = Shop::new();
    for (page, key) in [
        (Page::Grinding, "页面设计 design-page"),
        (Page::Program, "页面 design-page"),
        (Page::Directory, "页面设计 design-page"),
    ] {
        shop.bench.rig.send(kt830::link::Command::OpenPage(page));
        shop.bench.turn();
        shop.bench.touch(key);
        assert!(shop.bench.shows("C0003.TXT · O1003"), "{page:?}");
    }
    // A program without a page says so.
    shop.tell("load O2000");
    shop.bench.rig.send(kt830::link::Command::OpenPage(Page::Program));
    shop.bench.turn();
    shop.bench.touch("页面 design-page");
    assert!(shop.bench.shows("O2000 没有磨削页面"));
}

#[test]
fn b6_a_finger_moves_the_cursor_of_the_page_text() {
    let mut shop = Shop::new();
    shop.edit();
    let text = shop.bench.screen.get_by_label("page-text").rect();
    // The fourth line, in front of its first character.
    shop.bench.tap(text.min + egui::vec2(41.0, 3.5 * 28.0));
    shop.bench.write("A");
    assert_eq!(shop.save(), PAGE.replace("终点位置", "A终点位置"));
}

/// Turns the wheel of the mouse over the list on the right.
fn scroll(bench: &mut Bench, by: f32) {
    let at = egui::pos2(600.0, 400.0);
    for _ in 0..2 {
        bench.screen.event(egui::Event::PointerMoved(at));
        bench.screen.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, by),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: egui::Modifiers::NONE,
        });
        (0..8).for_each(|_| bench.turn());
    }
}

#[test]
fn k7_4_what_a_called_program_reads_may_stand_on_another_page() {
    // O1002 calls O9011, whose values stand on the page of O1011: C0011.TXT.
    let mut rig = crate::stories::rig();
    crate::stories::tell(&mut rig, "load O1002");
    let mut bench = Bench::new(rig, Page::Designer);
    // The key tells how many are missing: none.
    bench.touch("变量 page-variables");
    assert!(!bench.shows("页面上没有"));
    scroll(&mut bench, -1_200.0);
    assert!(bench.shows("在页面 C0011.TXT"));
}

#[test]
fn k7_4_a_long_line_is_followed_sideways() {
    let mut shop = Shop::new();
    shop.edit();
    let long = "很长的名称".repeat(12);
    shop.bench.write(&long);
    let cursor_in_sight = |bench: &Bench| {
        let text = format!("{long}{}", PAGE.lines().next().unwrap());
        let painted = (0..text.chars().count()).map(|left| text.chars().skip(left).collect::<String>());
        painted.enumerate().find(|(_, tail)| bench.shows(tail)).map(|(left, _)| left)
    };
    assert!(cursor_in_sight(&shop.bench).is_some_and(|left| left > 20), "the line was brought along");
    shop.bench.press(egui::Key::Home);
    assert_eq!(cursor_in_sight(&shop.bench), Some(0));
}

#[test]
fn h6_what_is_typed_after_tab_goes_into_the_text() {
    let mut shop = Shop::new();
    shop.edit();
    shop.bench.touch("键盘 page-board");
    shop.bench.press(egui::Key::Tab);
    shop.bench.write("甲");
    shop.bench.press(egui::Key::Tab);
    shop.bench.touch("7 letter-7");
    shop.bench.press(egui::Key::ArrowRight);
    shop.bench.write("乙");
    let title = PAGE.lines().next().unwrap();
    let mut signs = title.chars();
    let first = signs.next().unwrap();
    assert!(shop.save().starts_with(&format!("甲7{first}乙{}", signs.as_str())), "{}", shop.page());
}

#[test]
fn h6_a_page_changed_elsewhere_can_be_read_from_the_disk() {
    let mut shop = Shop::new();
    shop.edit();
    shop.bench.write("一");
    let other = PAGE.replace("测试", "别处");
    fs::write(shop.path("screens/C0003.TXT"), GBK.encode(&other).0).unwrap();
    shop.bench.touch("保存 page-save");
    assert!(shop.bench.shows("文件已被别处改动"));
    shop.bench.touch("读磁盘 question-read");
    assert!(shop.bench.shows("别处参数设置"), "{}", shop.refusal());
    assert_eq!(shop.page(), other);
    shop.bench.write("二");
    assert_eq!(shop.save(), format!("二{other}"));
}

#[test]
fn s3_a_page_of_the_kind_is_called_by_its_title_and_offers_on_all_its_sheets() {
    let mut rig = crate::stories::ready_of(Kind::Vertical);
    crate::stories::tell(&mut rig, "load VGRIND");
    let mut bench = Bench::new(rig, Page::Designer);
    assert!(bench.shows("R 参数") && !bench.shows("O1801"));
    bench.touch("变量 page-variables");
    scroll(&mut bench, -500.0);
    assert!(bench.shows("在页面 C080"));
}

/// H9: the English text of a page is edited beside it.
#[test]
fn h9_the_english_text_begins_as_the_page_text_and_is_saved_beside_it() {
    let mut shop = Shop::new();
    shop.bench.touch("英文 page-language");
    assert!(shop.bench.shows("C0003.EN.TXT") && shop.bench.shows("还没有这个文件"));
    shop.edit();
    shop.bench.write("EN ");
    shop.bench.touch("保存 page-save");
    let file = shop.path("screens/C0003.EN.TXT");
    let saved = GBK.decode(&fs::read(&file).unwrap()).0.into_owned();
    assert!(saved.starts_with("EN 测试;") && saved.contains("终点位置 #501;"), "{saved}");
    assert_eq!(shop.page(), PAGE, "the page text is unchanged");
    shop.bench.touch("结束 page-end");
    // A row that does not fit the page text is an error of its line.
    let wrong = saved.replace("#501", "#502");
    fs::write(&file, GBK.encode(&wrong).0).unwrap();
    shop.bench.touch("英文 page-language");
    assert!(shop.bench.shows("C0003.TXT · ") && !shop.bench.shows("C0003.EN.TXT · "));
    shop.bench.touch("英文 page-language");
    assert!(shop.bench.shows("页面文字中没有 #502"), "{:?}", shop.bench.painted());
    // Unsaved changes keep the text on the screen.
    shop.edit();
    shop.bench.write("x");
    shop.bench.touch("结束 page-end");
    shop.bench.touch("英文 page-language");
    assert!(shop.refusal().contains("保存") && shop.bench.shows("C0003.EN.TXT · "), "{}", shop.refusal());
}
