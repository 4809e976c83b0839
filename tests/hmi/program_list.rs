//! The lists of the program pages under a finger and at the keyboard: what is touched is selected, and the keys act on what
//! is selected. Source: spec B5, B6.

use std::fs;

use egui::{Pos2, vec2};
use egui_kittest::kittest::Queryable;
use kt830::defs::key::Key;
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
use kt830::host::folders::Folders;
use kt830::link::snapshot::{RunState, Tone};
use tempfile::TempDir;

use crate::live_screen::Bench;
use crate::operators::{Hand, Operator};
use crate::screen::Screen;

/// Height of a line of the listing, and the place of its first character.
const LINE: f32 = 28.0;
const TEXT: f32 = 77.0;

/// The middle of a line (from 1) of a listing that is not scrolled.
fn line_at(screen: &Screen, listing: &str, line: usize) -> Pos2 {
    screen.get_by_label(listing).rect().min + vec2(TEXT, (line as f32 - 0.5) * LINE)
}

/// A control with a folder of programs.
fn shop(programs: &[(&str, &str)]) -> (TempDir, kt830::host::headless::HeadlessHost) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in programs {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let (programs, screens) = (folder.path().to_owned(), crate::stories::folders().screens);
    let rig = crate::stories::rig_in(Folders { programs, screens, by_name: false, dialect: Dialect::LatheA });
    (folder, rig)
}

#[test]
fn b5_a_finger_aims_the_start_from_a_block() {
    let rig = crate::stories::ready_with("G98 G00 X-70 Z-140\nG01 X-72 F100\nW-5\nM30\n");
    let mut operator = Operator::new(Hand::Fingers, rig);
    operator.key(Key::ModeAuto);
    operator.page(Page::Program);
    let third = line_at(&operator.screen, "listing", 3);
    operator.tap_at(third);
    assert!(operator.paints_part("循环启动从程序开头运行"), "until 从此段 is pressed");
    operator.tap("从此段 run-here");
    operator.look();
    assert!(operator.says("第3行"), "{}", operator.snapshot().message.text.zh());
    assert!(!operator.paints_part("循环启动从程序开头运行"));
    operator.key(Key::CycleStart);
    operator.until("the end", 60.0, |snapshot| snapshot.state == RunState::Idle && snapshot.program.line > 2);
    let z = operator.snapshot().axes[kt830::units::Axis::Z].work;
    assert!((z + 145.0).abs() < 0.001, "{z}");
}

#[test]
fn b5_the_arrow_keys_aim_as_well() {
    let mut bench = Bench::new(crate::stories::ready_with("G00 X-70\nG00 X-71\nG00 X-72\nM30\n"), Page::Program);
    crate::stories::tell(&mut bench.rig, "mode auto");
    bench.turn();
    for (key, line) in [
        (egui::Key::ArrowDown, 2),
        (egui::Key::ArrowDown, 3),
        (egui::Key::ArrowDown, 4),
        (egui::Key::ArrowDown, 4),
        (egui::Key::ArrowUp, 3),
    ] {
        bench.press(key);
        assert!(bench.shows(&format!("行 {line} / 4")), "{key:?} to line {line}");
    }
    bench.touch("从此段 run-here");
    crate::stories::tell(&mut bench.rig, "wait 0.1 s\nexpect message \"第3行\"");
    // Left and right still lead to the keys: the first one edits.
    bench.press(egui::Key::ArrowRight);
    bench.press(egui::Key::Enter);
    let refusal = bench.screen.state().hmi.refusal(Lang::Zh).map(|(_, why)| why).unwrap_or_default();
    assert!(refusal.contains("编辑"), "{refusal}");
}

/// Nobody starts where he does not look: the cursor is shown first.
#[test]
fn b5_a_cursor_out_of_sight_is_shown_before_it_is_started_from() {
    let lines: String = (1..=99).map(|line| format!("N{line} G00 X-70\n")).collect();
    let mut operator = Operator::new(Hand::Fingers, crate::stories::ready_with(&format!("{lines}M30\n")));
    operator.key(Key::ModeAuto);
    operator.page(Page::Program);
    let second = line_at(&operator.screen, "listing", 2);
    operator.tap_at(second);
    operator.swipe(true);
    assert!(!operator.paints("N2 G00 X-70"), "scrolled away");
    operator.tap("从此段 run-here");
    assert!(operator.paints("N2 G00 X-70") && operator.snapshot().restart.is_none(), "shown, not started");
    assert!(operator.paints_part("光标在第 2 行"));
    operator.tap("从此段 run-here");
    operator.look();
    assert_eq!(operator.snapshot().restart.as_ref().map(|restart| restart.line), Some(2));
}

#[test]
fn b6_a_finger_moves_the_cursor_of_the_editor() {
    let (_folder, mut rig) = shop(&[("O1003.NC", "O1003\nN10 G00 X10\nN20 M30\n")]);
    crate::stories::tell(&mut rig, "param P22.5 0\nload O1003\nmode edit");
    let mut bench = Bench::new(rig, Page::Program);
    bench.touch("编辑 edit-begin");
    bench.tap(line_at(&bench.screen, "listing", 3));
    bench.write("/");
    assert_eq!(bench.screen.state().hmi.program_text().unwrap().to_string(), "O1003\nN10 G00 X10\n/N20 M30\n");
}

/// From the empty directory page to a program that has run, by finger alone.
#[test]
fn b6_a_new_program_is_current_visible_and_open_at_once() {
    let (folder, mut rig) = shop(&[("O0001.NC", "O0001\nM30\n")]);
    crate::stories::tell(&mut rig, "param P22.5 0\nload O0001\nmode edit");
    let mut operator = Operator::new(Hand::Fingers, rig);
    operator.page(Page::Directory);
    operator.tap("新建 program-new");
    operator.number("77");
    (0..4).for_each(|_| operator.look());
    assert_eq!((operator.snapshot().program.number, operator.snapshot().page), (77, Page::Program));
    assert!(operator.sees("保存 edit-save") && operator.sees("X letter-X"), "open for editing");
    operator.words("G04 X1");
    operator.key(Key::ModeAuto);
    assert!(operator.paints_part("循环启动运行原来的程序"), "what is shown is not what runs");
    operator.key(Key::ModeEdit);
    operator.tap("编辑 edit-begin");
    operator.tap("保存 edit-save");
    let text = fs::read_to_string(folder.path().join("O0077.NC")).unwrap();
    assert_eq!(text, "O0077\r\nG04 X1\r\n\r\nM30\r\n");
    operator.page(Page::Directory);
    assert!(operator.paints("当前") && operator.sees("O0077"), "visible in the directory");
    // A number that is taken opens nothing.
    operator.tap("新建 program-new");
    operator.number("1");
    assert_eq!((operator.snapshot().program.number, operator.snapshot().page), (77, Page::Directory));
    operator.tap("取消 cancel");
}

#[test]
fn b6_a_program_is_found_by_number_name_and_comment() {
    let programs = [
        ("O0012.NC", "O0012 (外圆)\nM30\n"),
        ("O0120.NC", "O0120 (Face A)\nM30\n"),
        ("O3000.NC", "O3000 (外圆 B)\nM30\n"),
    ];
    let (_folder, mut rig) = shop(&programs);
    crate::stories::tell(&mut rig, "param P22.5 0\nmode edit");
    let mut bench = Bench::new(rig, Page::Directory);
    let shown = |bench: &Bench| ["O0012", "O0120", "O3000"].map(|name| bench.screen.query_by_label(name).is_some());
    assert_eq!(shown(&bench), [true; 3]);
    bench.touch("查找 search");
    for (text, found) in [
        ("12", [true, true, false]),
        ("0120", [false, true, false]),
        ("face", [false, true, false]),
        ("外圆", [true, false, true]),
        ("外圆 30", [false, false, true]),
        ("x", [false; 3]),
    ] {
        (0..9).for_each(|_| bench.press(egui::Key::Backspace));
        bench.write(text);
        assert_eq!(shown(&bench), found, "{text}");
    }
    assert!(bench.shows("没有找到"));
    // Nothing is selected: nothing is deleted.
    bench.press(egui::Key::Enter);
    bench.touch("删除 program-delete");
    assert!(!bench.shows("删除程序？"));
    bench.touch("× search-clear");
    assert_eq!(shown(&bench), [true; 3]);
    // A letter or a digit at the keyboard begins a search; the keys act on what it shows.
    bench.write("3000");
    bench.press(egui::Key::Enter);
    bench.touch("删除 program-delete");
    assert!(bench.shows("删除程序？") && bench.painted().iter().any(|text| text.starts_with("O3000")));
}

/// A touch screen that acts as a mouse: the pointer comes from where it was last, in the frame of the press.
#[test]
fn b6_a_tap_does_not_scroll_the_list_under_it() {
    let programs: Vec<_> =
        (1..=40).map(|number| (format!("O{number:04}.NC"), format!("O{number:04}\nM30\n"))).collect();
    let programs: Vec<_> = programs.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    let (_folder, rig) = shop(&programs);
    let mut bench = Bench::new(rig, Page::Directory);
    bench.press(egui::Key::PageDown);
    bench.press(egui::Key::PageDown);
    let places = ["O0018", "O0015", "O0019"].map(|name| (name, bench.screen.get_by_label(name).rect().center()));
    for (name, place) in places {
        bench.tap(place);
        assert_eq!(bench.screen.get_by_label(name).rect().center(), place, "{name} has not moved");
        bench.touch("装入 load-program");
        assert!(bench.message().contains(name), "{name}: {}", bench.message());
    }
}

/// The selection is a program, not a place in the list.
#[test]
fn b6_the_keys_of_the_directory_act_on_the_selected_program() {
    let (folder, mut rig) = shop(&[("O0020.NC", "O0020\nM30\n"), ("O0030.NC", "O0030\nM30\n")]);
    crate::stories::tell(&mut rig, "param P22.5 0\nmode edit");
    let mut bench = Bench::new(rig, Page::Directory);
    bench.touch("O0030");
    // A copy comes before it in the list, and is selected; then the old one again.
    bench.touch("复制 program-copy");
    bench.write("25");
    bench.press(egui::Key::Enter);
    assert!(folder.path().join("O0025.NC").exists());
    bench.touch("删除 program-delete");
    assert!(bench.painted().iter().any(|text| text.starts_with("O0025 ") && text.contains("不能恢复")), "the copy");
    bench.touch("取消 question-no");
    bench.touch("O0030");
    bench.touch("改号 program-rename");
    bench.write("10");
    bench.press(egui::Key::Enter);
    assert!(folder.path().join("O0010.NC").exists() && !folder.path().join("O0030.NC").exists());
    bench.touch("删除 program-delete");
    bench.touch("删除 question-delete");
    let left: Vec<_> = bench.rig.snapshot().directory.iter().map(|row| row.number).collect();
    assert_eq!(left, [20, 25], "the renamed one");
}

/// While a finger has scrolled the selected program away, the title says on which one the keys act; they show it.
#[test]
fn b6_a_selected_program_out_of_sight_is_named_and_shown() {
    let programs: Vec<_> =
        (1..=40).map(|number| (format!("O{number:04}.NC"), format!("O{number:04} (P{number})\nM30\n"))).collect();
    let programs: Vec<_> = programs.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    let (_folder, mut rig) = shop(&programs);
    crate::stories::tell(&mut rig, "param P22.5 0\nload O0002\nmode edit");
    let mut operator = Operator::new(Hand::Fingers, rig);
    operator.page(Page::Directory);
    operator.tap("O0003");
    operator.swipe(true);
    operator.swipe(true);
    assert!(!operator.sees("O0003") && operator.paints("O0003"));
    operator.tap("复制 program-copy");
    assert!(operator.sees("O0003"));
    operator.tap("取消 cancel");
    // The page keys of the keyboard take the selection along.
    operator.strike(egui::Key::PageDown, egui::Modifiers::NONE);
    assert!(!operator.paints("O0003"));
}

#[test]
fn k1_a_program_of_another_kind_is_marked_and_loading_it_says_so() {
    let programs = [
        ("O0001.NC", "O0001 (A) (机型 GS)\nM30\n"),
        ("O0002.NC", "O0002 (B) (KIND GC GS)\nM30\n"),
        ("O0003.NC", "O0003 (C)\nM30\n"),
    ];
    let (_folder, rig) = shop(&programs);
    let mut bench = Bench::new(rig, Page::Directory);
    let marks =
        |bench: &Bench| bench.painted().iter().filter(|text| text.ends_with("的程序")).cloned().collect::<Vec<_>>();
    assert_eq!(marks(&bench), ["GS 的程序"]);
    for (number, foreign) in [("O0003", false), ("O0002", false), ("O0001", true)] {
        bench.touch(number);
        bench.touch("装入 load-program");
        assert!(bench.message().contains(&format!("当前程序 {number}")), "{}", bench.message());
        assert_eq!(bench.message().contains("不是本机 GC 的程序"), foreign, "{}", bench.message());
        let warned = bench.rig.snapshot().message.tone == Tone::Warning;
        assert_eq!(warned, foreign, "in amber");
    }
}

/// Every shipped program that only some kinds can run says which.
#[test]
fn k1_the_shipped_programs_say_for_which_machine_they_are() {
    let (_, directory) = crate::stories::folders().read_programs().unwrap();
    for row in &directory {
        let expected: &[Kind] = match row.number {
            1_001..=1_006 | 1_011 | 1_012 | 1_015..=1_020 | 9_010..=9_016 | 9_071 | 9_073 | 9_076 => &[Kind::Gc],
            1_007..=1_009 | 1_013 | 9_017 | 9_020 | 9_075 | 9_077..=9_079 => &[Kind::Gs],
            1_010 | 1_014 | 9_018 => &[Kind::Ga],
            _ => &[],
        };
        assert_eq!(row.kinds, expected, "{}", row.name);
    }
}

#[test]
fn b6_a_recalled_mdi_line_is_in_sight_and_is_what_is_sent() {
    let mut rig = crate::stories::ready();
    crate::stories::tell(&mut rig, "mode mdi");
    let mut bench = Bench::new(rig, Page::Mdi);
    for line in 1..=15 {
        bench.write(&format!("G04 X{line}"));
        bench.press(egui::Key::Enter);
    }
    assert!(!bench.shows("G04 X3"), "further down");
    (0..13).for_each(|_| bench.press(egui::Key::ArrowUp));
    assert!(bench.painted().iter().any(|text| text == "G04 X3"), "the framed line is in sight");
    bench.press(egui::Key::Enter);
    assert_eq!(&*bench.rig.snapshot().prepared_mdi, "G04 X3");
    // A finger takes another one.
    let place = bench.screen.get_by_label("mdi-line-1").rect().center();
    bench.tap(place);
    bench.press(egui::Key::Enter);
    assert_eq!(&*bench.rig.snapshot().prepared_mdi, "G04 X15");
}
