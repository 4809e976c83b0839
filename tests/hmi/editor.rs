//! The program editor with the real core and its folders behind it.

use std::fs;
use std::path::PathBuf;

use crate::live_screen::Bench;
use egui_kittest::kittest::Queryable;
use kt830::defs::kind::Dialect;
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::host::folders::Folders;
use kt830::link::Command;
use kt830::link::files::{FileRequest, Refusal, Requester, Ticket};
use kt830::link::page_command::PageCommand;
use tempfile::TempDir;

const TEXT: &str = "O1234 (A)\r\nN10 G00 X10\r\nN20 M30\r\n";

/// A folder of programs with O1234, and a control with it.
pub struct Shop {
    folder: TempDir,
    pub bench: Bench,
}

impl Shop {
    pub fn new(text: &[u8]) -> Self {
        Self::with("O1234.NC", text)
    }

    fn with(name: &str, text: &[u8]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), text).unwrap();
        let screens = crate::stories::folders().screens;
        let mut rig = crate::stories::rig_in(Folders {
            programs: folder.path().to_owned(),
            screens,
            by_name: false,
            dialect: Dialect::LatheA,
        });
        crate::stories::tell(&mut rig, &format!("load {}", name.trim_end_matches(".NC")));
        Self { folder, bench: Bench::new(rig, Page::Program) }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("O1234.NC")
    }

    fn file(&self) -> String {
        fs::read_to_string(self.path()).unwrap()
    }

    pub fn text(&self) -> String {
        self.bench.screen.state().hmi.program_text().unwrap().to_string()
    }

    pub fn tell(&mut self, story: &str) {
        crate::stories::tell(&mut self.bench.rig, story);
        self.bench.turn();
    }

    /// In edit mode, with the password given.
    fn edit(&mut self) {
        self.tell("mode edit");
        self.bench.touch("编辑 edit-begin");
        if self.bench.asks_password() {
            self.bench.write("187350");
            self.bench.press(egui::Key::Enter);
        }
        assert!(self.bench.screen.query_by_label("保存 edit-save").is_some(), "not editing");
    }

    pub fn refusal(&self) -> String {
        self.bench.screen.state().hmi.refusal(Lang::Zh).map(|(_, why)| why).unwrap_or_default()
    }

    pub fn key(&mut self, key: egui::Key, modifiers: egui::Modifiers) {
        self.bench.screen.key_press_modifiers(modifiers, key);
        self.bench.turn();
    }
}

#[test]
fn k6_2_the_password_is_asked_once_a_power_on() {
    let mut shop = Shop::new(TEXT.as_bytes());
    shop.tell("mode edit");
    shop.bench.touch("编辑 edit-begin");
    assert!(shop.bench.asks_password());
    shop.bench.write("000000");
    shop.bench.press(egui::Key::Enter);
    assert!(shop.bench.asks_password(), "a wrong one opens nothing");
    shop.bench.write("187350");
    shop.bench.press(egui::Key::Enter);
    shop.bench.write("(B)");
    assert!(shop.text().starts_with("(B)O1234"));
    shop.key(egui::Key::S, egui::Modifiers::CTRL);
    assert!(shop.file().starts_with("(B)O1234"), "{}", shop.refusal());
    shop.bench.touch("结束 edit-end");
    shop.bench.touch("编辑 edit-begin");
    assert!(!shop.bench.asks_password(), "once a power-on");
    shop.bench.rig.power_cut();
    shop.bench.rig.power_on();
    shop.bench.turn();
    shop.tell("mode edit");
    shop.bench.rig.send(Command::OpenPage(Page::Program));
    shop.bench.turn();
    shop.bench.touch("编辑 edit-begin");
    assert!(shop.bench.asks_password(), "and again after it");
}

#[test]
fn k6_2_the_parameters_take_the_password_away() {
    let mut shop = Shop::new(TEXT.as_bytes());
    shop.tell("param P22.5 0\nmode edit");
    shop.bench.touch("编辑 edit-begin");
    assert!(!shop.bench.asks_password());
    assert!(shop.bench.screen.query_by_label("保存 edit-save").is_some());
    // P23.5 has O9000 to O9999.
    let mut shop = Shop::with("O9001.NC", b"O9001\nM99\n");
    shop.tell("param P22.5 0\nmode edit");
    shop.bench.touch("编辑 edit-begin");
    assert!(shop.bench.asks_password());
}

#[test]
fn b6_programs_are_edited_in_edit_mode_only_and_not_in_a_run() {
    let mut shop = Shop::new(b"G04 P9000\nM30\n");
    shop.tell("param P22.5 0\nmode auto");
    shop.bench.touch("编辑 edit-begin");
    assert!(shop.refusal().contains("编辑"), "{}", shop.refusal());
    assert!(shop.bench.screen.query_by_label("保存 edit-save").is_none());
    // The core says no by itself, whatever a page asks.
    let save = |force| {
        let text = "M30\n".into();
        Command::Page(PageCommand::File(
            Ticket::without_reply(Requester::Editor),
            FileRequest::Save { number: 1_234, text, base_stamp: 0, overwrite: force },
        ))
    };
    let mut rig = crate::stories::ready_with("G04 P9000\nM30\n");
    crate::stories::tell(&mut rig, "param P22.5 0\nmode auto\nkey cycle-start\nwait 0.1 s\nexpect state running");
    rig.send(save(true));
    (0..3).for_each(|_| rig.step());
    assert!(rig.snapshot().message.text.zh().contains("运行中"), "{}", rig.snapshot().message.text.zh());
    shop.bench.rig.send(save(true));
    shop.bench.turn();
    assert_eq!(shop.file(), "G04 P9000\nM30\n");
}

#[test]
fn b6_what_was_changed_elsewhere_is_not_overwritten_unasked() {
    let mut shop = Shop::new(TEXT.as_bytes());
    shop.edit();
    shop.bench.write("/");
    fs::write(shop.path(), "O1234 (ANOTHER)\n").unwrap();
    shop.bench.touch("保存 edit-save");
    assert!(shop.bench.shows("文件已被别处改动"));
    shop.bench.touch("取消 question-no");
    assert_eq!(shop.file(), "O1234 (ANOTHER)\n");
    assert!(shop.text().starts_with('/'), "what was typed is not lost");
    let last = shop.bench.rig.snapshot().files.answers.last().map(|answer| answer.result.clone());
    assert_eq!(last, Some(Err(Refusal::Conflict)));
    shop.bench.touch("保存 edit-save");
    shop.bench.touch("覆盖 question-overwrite");
    assert!(shop.file().starts_with("/O1234 (A)"));
    // Saved once more: nothing stands in the way now.
    shop.bench.write("/");
    shop.bench.touch("保存 edit-save");
    assert!(shop.file().starts_with("//O1234 (A)"));
    // The disk's takes the place of what was typed, and editing goes on.
    shop.bench.write("/");
    fs::write(shop.path(), "O1234 (ANOTHER)\n").unwrap();
    shop.bench.touch("保存 edit-save");
    shop.bench.touch("读磁盘 question-read");
    assert_eq!((shop.text().as_str(), shop.file().as_str()), ("O1234 (ANOTHER)\n", "O1234 (ANOTHER)\n"));
    shop.bench.write("/");
    shop.bench.touch("保存 edit-save");
    assert_eq!(shop.file(), "/O1234 (ANOTHER)\n");
}

#[test]
fn b1_a_program_keeps_its_encoding_and_its_line_ends() {
    let gbk = |text: &str| encoding_rs::GBK.encode(text).0.into_owned();
    let mut shop = Shop::new(&gbk("O1234 (砂轮修整)\r\nM30\r\n"));
    shop.edit();
    shop.bench.press(egui::Key::ArrowDown);
    shop.bench.write("N5");
    shop.bench.press(egui::Key::Enter);
    shop.bench.touch("保存 edit-save");
    assert_eq!(fs::read(shop.path()).unwrap(), gbk("O1234 (砂轮修整)\r\nN5\r\nM30\r\n"));
    // Bytes that are no characters would be lost by saving: such a file is only shown.
    let mut shop = Shop::new(b"O1234 (\xFF\xFF\x80)\nM30\n");
    shop.tell("param P22.5 0\nmode edit");
    shop.bench.touch("编辑 edit-begin");
    assert!(shop.refusal().contains("编码"), "{}", shop.refusal());
}

#[test]
fn b6_a_mistake_is_told_while_it_is_typed() {
    let mut shop = Shop::new(TEXT.as_bytes());
    shop.edit();
    shop.bench.press(egui::Key::ArrowDown);
    shop.bench.write("G999 ");
    for _ in 0..30 {
        shop.bench.turn();
    }
    let looked = shop.bench.rig.snapshot().files.line_check.clone();
    assert!(looked.faults.iter().any(|fault| fault.line == 2), "{looked:?}");
    assert!(looked.faults.iter().all(|fault| fault.line == 2), "{looked:?}");
    let said = looked.faults[0].message.zh().into_owned();
    assert!(shop.bench.shows(&said));
    (0..5).for_each(|_| shop.bench.press(egui::Key::Backspace));
    for _ in 0..30 {
        shop.bench.turn();
    }
    assert_eq!(shop.bench.rig.snapshot().files.line_check.faults, []);
}

#[test]
fn b6_by_touch_words_are_found_replaced_and_taken_back() {
    let mut shop = Shop::new(TEXT.as_bytes());
    shop.edit();
    shop.bench.touch("替换 edit-replace");
    for letter in ["X", "1", "0"] {
        shop.bench.touch(&format!("{letter} letter-{letter}"));
    }
    shop.bench.touch("输入 letter-done");
    for letter in ["Z", "5"] {
        shop.bench.touch(&format!("{letter} letter-{letter}"));
    }
    shop.bench.touch("输入 letter-done");
    shop.bench.touch("全部 replace-all");
    assert!(shop.text().contains("N10 G00 Z5\r\n"), "{}", shop.text());
    shop.bench.touch("键盘 edit-board");
    shop.bench.touch("撤销 edit-undo");
    assert_eq!(shop.text(), TEXT);
    shop.bench.press(egui::Key::ArrowUp);
    shop.bench.press(egui::Key::ArrowUp);
    shop.bench.touch("块首 edit-mark");
    shop.bench.press(egui::Key::ArrowDown);
    shop.bench.touch("剪切 edit-cut");
    assert_eq!(shop.text(), "N20 M30\r\n");
    shop.bench.press(egui::Key::ArrowDown);
    shop.bench.touch("粘贴 edit-paste");
    assert!(shop.text().contains("O1234 (A)\r\nN10 G00 X10\r\n"), "{}", shop.text());
    shop.bench.touch("放弃 edit-discard");
    shop.bench.touch("放弃 question-discard");
    assert_eq!(shop.text(), TEXT);
}

#[test]
fn h6_an_unsaved_text_outlives_page_and_program() {
    let mut shop = Shop::new(TEXT.as_bytes());
    fs::write(shop.folder.path().join("O0002.NC"), "M30\n").unwrap();
    shop.edit();
    shop.bench.write("N1 ");
    for page in [Page::Position, Page::Program] {
        shop.bench.rig.send(Command::OpenPage(page));
        shop.bench.turn();
    }
    shop.tell("mode auto\nwait 0.1 s\nmode edit");
    assert!(shop.text().starts_with("N1 O1234"));
    assert!(shop.bench.shows("未保存"));
}

#[test]
fn b6_the_directory_makes_copies_renames_and_deletes() {
    let mut shop = Shop::new(TEXT.as_bytes());
    shop.tell("param P22.5 0\nmode edit");
    shop.bench.rig.send(Command::OpenPage(Page::Directory));
    shop.bench.turn();
    let number = |shop: &mut Shop, key: &str, number: &str| {
        shop.bench.touch(key);
        for digit in number.chars() {
            shop.bench.touch(&format!("pad-{digit}"));
        }
        shop.bench.touch("输入 input");
    };
    let there = |shop: &Shop, name: &str| shop.folder.path().join(name).exists();
    number(&mut shop, "复制 program-copy", "77");
    assert!(there(&shop, "O0077.NC") && shop.bench.rig.has_program(77), "{}", shop.bench.message());
    // A number that is taken: the typed one stays with the reason, nothing is overwritten.
    shop.bench.touch("新建 program-new");
    shop.bench.write("1234");
    shop.bench.press(egui::Key::Enter);
    let (text, why) = shop.bench.screen.state().hmi.refusal(Lang::Zh).expect("refused");
    assert!(text == "1234" && why.contains("已存在"), "{text}: {why}");
    assert_eq!(shop.file(), TEXT);
    shop.bench.press(egui::Key::Escape);
    number(&mut shop, "新建 program-new", "5");
    assert!(there(&shop, "O0005.NC"));
    // The program page has opened the new program.
    shop.bench.turn();
    assert!(shop.bench.screen.query_by_label("保存 edit-save").is_some());
    shop.bench.rig.send(Command::OpenPage(Page::Directory));
    shop.bench.turn();
    shop.bench.touch("O0077");
    number(&mut shop, "改号 program-rename", "78");
    assert!(there(&shop, "O0078.NC") && !there(&shop, "O0077.NC"));
    shop.bench.touch("O0078");
    shop.bench.touch("删除 program-delete");
    assert!(shop.bench.shows("删除程序？"));
    shop.bench.press(egui::Key::Enter);
    assert!(there(&shop, "O0078.NC"), "Enter alone is 取消");
    shop.bench.touch("删除 program-delete");
    shop.bench.touch("删除 question-delete");
    assert!(!there(&shop, "O0078.NC"));
    // In another mode the key says why it does nothing, and so does the core.
    shop.tell("mode auto");
    shop.bench.touch("O0005");
    shop.bench.touch("删除 program-delete");
    assert!(shop.refusal().contains("编辑") && !shop.bench.shows("删除程序？"));
    let ticket = Ticket::without_reply(Requester::Directory);
    shop.bench.rig.send(Command::Page(PageCommand::File(ticket, FileRequest::Delete(5))));
    shop.bench.turn();
    assert!(there(&shop, "O0005.NC") && shop.bench.message().contains("编辑"), "{}", shop.bench.message());
}

#[test]
fn b6_the_cursor_begins_where_the_text_is_looked_at() {
    let lines: String = (1..=60).map(|line| format!("N{line} G04 X1\r\n")).collect();
    let mut shop = Shop::new(format!("O1234\r\n{lines}M30\r\n").as_bytes());
    shop.tell("param P22.5 0\nmode edit");
    // Three pages down, without editing.
    (0..3).for_each(|_| shop.bench.press(egui::Key::PageDown));
    shop.bench.write("A");
    assert!(shop.refusal().contains("先按“编辑”"), "{}", shop.refusal());
    shop.bench.touch("编辑 edit-begin");
    shop.bench.write("A");
    let line = shop.text().lines().position(|line| line.starts_with('A')).unwrap();
    assert!((20..60).contains(&line), "typed into line {line}, which is not in sight");
}

#[test]
fn b6_home_end_and_delete_do_what_they_do_in_every_editor() {
    let mut shop = Shop::new(TEXT.as_bytes());
    shop.tell("param P22.5 0\nmode edit");
    shop.bench.touch("编辑 edit-begin");
    shop.bench.press(egui::Key::ArrowDown);
    shop.bench.press(egui::Key::End);
    shop.bench.write("F9");
    shop.bench.press(egui::Key::Home);
    shop.bench.press(egui::Key::Delete);
    assert!(shop.text().contains("\r\n10 G00 X10F9\r\n"), "{}", shop.text());
    // At the end of a line Delete takes the whole line end.
    shop.bench.press(egui::Key::End);
    shop.bench.press(egui::Key::Delete);
    assert!(shop.text().contains("X10F9N20 M30\r\n"), "{}", shop.text());
    // At the end of the text there is nothing to take.
    (0..4).for_each(|_| shop.bench.press(egui::Key::ArrowDown));
    shop.bench.press(egui::Key::End);
    let before = shop.text();
    shop.bench.press(egui::Key::Delete);
    shop.bench.press(egui::Key::Delete);
    assert_eq!(shop.text().trim_end(), before.trim_end());
}

#[test]
fn b5_a_program_is_run_from_the_line_under_the_cursor() {
    let rig = crate::stories::ready_with("G98 G00 X-70 Z-140\nG01 X-72 F100\nW-5\nM30\n");
    let mut bench = Bench::new(rig, Page::Program);
    crate::stories::tell(&mut bench.rig, "mode jog");
    bench.turn();
    bench.touch("从此段 run-here");
    assert!(bench.message().contains("自动方式"), "{}", bench.message());
    crate::stories::tell(&mut bench.rig, "mode auto");
    bench.turn();
    bench.touch("定位 edit-go");
    bench.write("3");
    bench.press(egui::Key::Enter);
    bench.touch("从此段 run-here");
    crate::stories::tell(&mut bench.rig, "wait 0.1 s\nexpect message \"第3行\"\nexpect message \"X-72.000\"");
    crate::stories::tell(
        &mut bench.rig,
        "key cycle-start\nwait until idle max 60 s\nexpect Z -145 ±0.001\nexpect X -72 ±0.001",
    );
    bench.turn();
    bench.touch("断电续 run-resume");
    assert!(bench.message().contains("没有断电中断"), "{}", bench.message());
}

/// Outside edit mode the listing follows the running block; a search leads to its match all the same.
#[test]
fn b6_a_search_scrolls_to_its_match_outside_edit_mode() {
    let lines: String = (2..200).map(|line| format!("N{line} G00 X{line}.\n")).collect();
    for begun in [false, true] {
        let mut rig = crate::stories::ready_with(&format!("G04 P9000\n{lines}M30\n"));
        if begun {
            let story = "mode auto\nkey cycle-start\nwait 0.1 s\nkey feed-hold\nwait 0.1 s\nexpect state held";
            crate::stories::tell(&mut rig, story);
        }
        assert_eq!(rig.snapshot().program.line > 0, begun);
        let mut bench = Bench::new(rig, Page::Program);
        for (key, typed, found) in
            [("查找 edit-find", "X150.", "N150 G00 X150."), ("定位 edit-go", "90", "N90 G00 X90.")]
        {
            bench.touch(key);
            bench.write(typed);
            bench.press(egui::Key::Enter);
            bench.turn();
            assert!(bench.shows(found), "{found}, a block has run: {begun}");
        }
    }
}

/// After a power cut alarm 180 has the message line; the offer to resume has a place of its own on every page until the
/// operator has begun a run.
#[test]
fn b5_the_offer_to_resume_stands_beside_an_alarm_until_it_is_answered() {
    let mut bench = Bench::new(crate::stories::ready_with("G04 X5\nG04 X60\nM30\n"), Page::Position);
    assert!(!bench.shows("断电续 O7000"));
    let cut = "mode auto\nkey cycle-start\nwait 10 s\npower cut\nwait 1 s\npower on\nwait 10 s\nexpect alarm 180";
    crate::stories::tell(&mut bench.rig, cut);
    bench.turn();
    assert!(bench.shows("180") && bench.shows("断电续 O7000 第 2 行"), "{:?}", bench.painted());
    bench.touch("断电续 interrupted-run");
    assert_eq!(bench.rig.snapshot().page, Page::Program);
    // There it stands above the keys, with the key that resumes.
    assert!(bench.shows("O7000 在第 2 行断电中断") && !bench.shows("断电续 O7000"), "{:?}", bench.painted());
    let begun = "key hydraulic\nwait 4 s\nhome all\nmode auto\nkey cycle-start\nwait 1 s\nexpect state running\nkey reset\nwait 1 s";
    crate::stories::tell(&mut bench.rig, begun);
    crate::stories::tell(&mut bench.rig, "page position");
    bench.turn();
    assert!(!bench.shows("断电续 O7000"), "{:?}", bench.painted());
}

/// The modal state at the chosen block stays in sight until it runs, also when the message has gone.
#[test]
fn b5_the_page_shows_where_cycle_start_would_begin() {
    use kt830::link::restart_view::RestartView;
    use kt830::units::PerAxis;
    let mut machine = crate::sample::snapshot(Page::Program);
    let told = |machine: &kt830::link::Snapshot, lang: Lang| kt830::hmi::page_text(machine, lang).join("\n");
    machine.interrupted = Some((1_001, 13));
    let (zh, en) = (told(&machine, Lang::Zh), told(&machine, Lang::En));
    assert!(zh.contains("O1001 在第 13 行断电中断") && zh.contains("断电续"), "{zh}");
    assert!(en.contains("O1001") && en.contains("line 13") && en.contains("RESUME"), "{en}");
    // A chosen block comes first.
    machine.restart = Some(Box::new(RestartView {
        program: 1_001,
        line: 21,
        modals: machine.modals,
        start: PerAxis([Some(40.2), None, Some(-12.5)]),
        wheel_turns: true,
        workpiece_turns: false,
        coolant_on: true,
    }));
    let (zh, en) = (told(&machine, Lang::Zh), told(&machine, Lang::En));
    for words in ["O1001 第21行", "G18", "X40.200 Z-12.500", "先启动 砂轮 冷却"] {
        assert!(zh.contains(words), "{words}: {zh}");
    }
    assert!(
        en.contains("O1001 line 21") && en.contains("start wheel coolant first") && !zh.contains("断电中断"),
        "{en}"
    );
}
