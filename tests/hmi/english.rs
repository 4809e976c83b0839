//! English is English: pages, titles and messages of the shipped programs. An alarm of a program leads to the value that
//! is wrong. Source: spec B8, H9.

use std::fs;
use std::ops::RangeInclusive;

use crate::live_screen::Bench;
use crate::stories::{folders, folders_of, ready, ready_of, rig_in, tell};
use egui_kittest::kittest::Queryable;
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::page::Page;
use kt830::defs::page_text::{self, PageText};
use kt830::defs::text::Lang;
use kt830::hmi::offscreen::OffscreenHmi;
use kt830::hmi::{Hmi, page_text as painted_text};
use kt830::host::folders::{Folders, parse_page_text};
use kt830::host::headless::HeadlessHost;
use kt830::link::Command;

fn is_chinese(text: &str) -> bool {
    text.chars().any(|sign| ('\u{4e00}'..='\u{9fff}').contains(&sign))
}

/// What the screen paints in English that is not English.
fn chinese_on(rig: &mut HeadlessHost, page: Page) -> Vec<String> {
    rig.send(Command::OpenPage(page));
    rig.step();
    rig.step();
    painted_text(rig.snapshot(), Lang::En).into_iter().filter(|text| is_chinese(text)).collect()
}

/// The shipped programs with a page that each kind can load.
const PAGES: [(Kind, RangeInclusive<u32>); 4] =
    [(Kind::Gc, 1_001..=1_012), (Kind::Gc, 1_015..=1_020), (Kind::Gs, 1_007..=1_013), (Kind::Ga, 1_010..=1_014)];

#[test]
fn h9_the_pages_of_the_shipped_programs_are_english_in_english() {
    for (kind, programs) in PAGES {
        let mut rig = ready_of(kind);
        for number in programs {
            tell(&mut rig, &format!("load O{number}"));
            assert_eq!(chinese_on(&mut rig, Page::Grinding), [""; 0], "O{number}");
        }
        for page in [Page::Dressing, Page::Macro, Page::Directory] {
            assert_eq!(chinese_on(&mut rig, page), [""; 0], "{page:?}");
        }
    }
    for kind in [Kind::Lathe, Kind::Vertical] {
        let mut rig = ready_of(kind);
        assert_eq!(chinese_on(&mut rig, Page::Directory), [""; 0], "{kind:?} {:?}", folders_of(kind).programs);
    }
}

#[test]
fn h9_the_alarms_of_the_shipped_programs_are_english_in_english() {
    let mut rig = ready();
    tell(
        &mut rig,
        "load O1002\nset #520 = 40\nset #521 = 99\nmode auto\nkey cycle-start\nwait 0.3 s\nexpect alarm 3001",
    );
    assert_eq!(chinese_on(&mut rig, Page::Alarm), [""; 0]);
    assert_eq!(chinese_on(&mut rig, Page::Grinding), [""; 0]);
}

/// The shipped English texts fit their page texts, and their labels follow the rule of the screen: small letters, names of
/// axes, signals and parameters as they are written.
#[test]
fn h9_the_shipped_english_texts_fit_their_pages_and_follow_one_rule() {
    let screens = folders().screens;
    let parse = |name: &str| -> PageText { parse_page_text(name, &fs::read(screens.join(name)).unwrap()).unwrap() };
    let mut pages = 0;
    for number in (1..=20).chain(801..=803) {
        let page = parse(&format!("C{number:04}.TXT"));
        let name = format!("C{number:04}.EN.TXT");
        let text = fs::read_to_string(screens.join(&name)).unwrap();
        assert_eq!(page_text::english_faults(&page, &page_text::parse_all(&text)), [], "{name}");
        let english = parse(&name);
        let labels = english.rows().map(|row| row.label.as_str()).chain([english.title.as_str()]);
        for label in labels {
            assert!(!is_chinese(label) && follows_the_rule(label), "{name}: {label}");
        }
        pages += 1;
    }
    assert_eq!(pages, 23);
}

/// Whether all words of a label are in small letters, but for names: axes, G27, P1, R18.
fn follows_the_rule(label: &str) -> bool {
    label.split([' ', ',', '(', ')']).all(|word| {
        let name = word.len() <= 4 && word.chars().skip(1).all(|sign| sign.is_ascii_digit());
        name || word.chars().all(|sign| !sign.is_ascii_uppercase())
    })
}

/// A folder of page files of its own.
fn with_pages(files: &[(&str, &str)]) -> (tempfile::TempDir, HeadlessHost) {
    let folder = tempfile::tempdir().unwrap();
    let screens = folder.path().join("screens");
    fs::create_dir(&screens).unwrap();
    fs::copy(folders().screens.join("B0002.BMP"), screens.join("B0002.BMP")).unwrap();
    for (name, text) in files {
        fs::write(screens.join(name), text).unwrap();
    }
    let mut rig = rig_in(Folders { screens, dialect: Dialect::LatheA, ..folders() });
    rig.make_ready();
    tell(&mut rig, "load O1002\npage grinding");
    (folder, rig)
}

const OWN: &str = "磨削;\n毛坯 #520;\n成品 #521;\n;;;;;;;;%";

#[test]
fn h9_a_page_text_without_english_is_shown_as_written() {
    let shows = |rig: &mut HeadlessHost, words: &str| {
        painted_text(rig.snapshot(), Lang::En).iter().any(|text| text.contains(words))
    };
    let (_folder, mut rig) = with_pages(&[("C0002.TXT", OWN)]);
    assert!(shows(&mut rig, "毛坯") && shows(&mut rig, "磨削") && rig.snapshot().alarms.is_empty());
    // A row that is missing in the English text falls back; the rows may stand in another order.
    let (_folder, mut rig) =
        with_pages(&[("C0002.TXT", OWN), ("c0002.en.txt", "grinding;\n;finished #521;\n;;;;;;;;%")]);
    assert!(shows(&mut rig, "毛坯") && shows(&mut rig, "finished") && shows(&mut rig, "grinding"));
    assert!(rig.snapshot().alarms.is_empty());
    // A wrong English text is alarm 66 with its place; the page is shown as written.
    let (_folder, mut rig) = with_pages(&[("C0002.TXT", OWN), ("C0002.EN.TXT", "grinding;\nfinished 521;\n%")]);
    assert!(shows(&mut rig, "毛坯"));
    let alarm = &rig.snapshot().alarms[0];
    assert!(alarm.number == 66 && alarm.text.en().contains("C0002.EN.TXT line 2"), "{}", alarm.text.en());
}

/// A ready machine whose finishing feed #527 is missing; O1002 is loaded.
fn without_feed() -> HeadlessHost {
    let mut rig = ready();
    let values = [(520, 41.0), (521, 40.0), (522, 60.0), (524, 0.4), (525, 0.05), (526, 1.2), (527, 0.0)];
    values.iter().for_each(|(number, value)| tell(&mut rig, &format!("set #{number} = {value}")));
    tell(&mut rig, "load O1002\nmode auto");
    rig
}

const START: &str = "key cycle-start\nwait 0.3 s\nexpect alarm 3005";

/// The variable of the input line.
fn cursor(bench: &Bench) -> String {
    let line = bench.painted().into_iter().find_map(|text| Some(text.strip_prefix("数据输入: ")?.to_owned()));
    line.unwrap_or_default().split('=').next().unwrap_or_default().to_owned()
}

#[test]
fn b8_the_cursor_goes_to_the_value_that_is_wrong() {
    let mut bench = Bench::new(without_feed(), Page::Grinding);
    tell(&mut bench.rig, START);
    bench.turn();
    assert_eq!(cursor(&bench), "#527");
    // The value is corrected at once; the cursor goes on, and stays where the operator puts it.
    bench.write("0.3");
    bench.press(egui::Key::Enter);
    assert_eq!((bench.rig.snapshot().variables[527], cursor(&bench)), (Some(0.3), "#528".to_owned()));
    bench.turn();
    assert_eq!(cursor(&bench), "#528");
}

#[test]
fn b8_a_value_that_is_being_typed_keeps_the_cursor() {
    let mut bench = Bench::new(without_feed(), Page::Grinding);
    bench.write("39");
    tell(&mut bench.rig, START);
    bench.turn();
    assert_eq!(cursor(&bench), "#520");
}

#[test]
fn b8_the_alarm_page_leads_to_the_entry() {
    let mut bench = Bench::new(without_feed(), Page::Alarm);
    tell(&mut bench.rig, START);
    bench.turn();
    assert!(bench.shows("粗磨速度、精磨速度 #526 #527 中有一个没有输入") && bench.shows("在磨削页面输入大于 0 的数值"));
    bench.touch("修改 #527 alarm-entry-3005");
    assert_eq!((bench.rig.snapshot().page, cursor(&bench)), (Page::Grinding, "#527".to_owned()));
    // The history keeps what the program said.
    tell(&mut bench.rig, "page alarm");
    bench.turn();
    bench.press(egui::Key::ArrowRight);
    bench.press(egui::Key::Enter);
    assert!(bench.shows("粗磨速度、精磨速度 #526 #527 中有一个没有输入") && bench.shows("排除原因后按复位"));
    tell(&mut bench.rig, "page position");
    bench.turn();
    // By keyboard: the row, then its entry.
    tell(&mut bench.rig, "page alarm");
    bench.turn();
    bench.press(egui::Key::ArrowDown);
    bench.press(egui::Key::Enter);
    assert_eq!((bench.rig.snapshot().page, cursor(&bench)), (Page::Grinding, "#527".to_owned()));
    // A value that the page does not have is entered in the list of variables.
    tell(&mut bench.rig, "key reset\nwait 0.1 s\nset #523 = 40\nset #527 = 0.3\nset #531 = 1\nload O1002");
    tell(&mut bench.rig, "param P96 5\nkey cycle-start\nwait 1 s\nexpect alarm 3032\npage alarm");
    bench.turn();
    bench.touch("修改 #763 alarm-entry-3032");
    assert!(bench.rig.snapshot().page == Page::Macro && bench.shows("#763="));
    // Alarms without a variable have no such key.
    tell(&mut bench.rig, "key emergency-stop\nwait 0.1 s\npage alarm");
    bench.turn();
    let keys = |bench: &Bench| bench.screen.query_all_by_label_contains("alarm-entry").count();
    assert_eq!(keys(&bench), 1, "that of the program alarm, none of the emergency stop");
}

/// What a screen says in English is in small letters, keys and heads are in capitals, help texts are sentences.
#[test]
fn h9_every_page_follows_the_one_rule_of_capitals() {
    use crate::sample::{alarm, busy, refused, running, snapshot, troubled};
    // Names of languages and kinds, the text of the program and of a page, and what the sample itself says.
    let names = ["English", "No.", "KT-830GC", "SuperMan", "MTConnect"];
    let follows = |text: &str| {
        let word = text.trim_start().split([' ', ':', ',', '·', '\n']).next().unwrap_or_default();
        let capitalised = word.starts_with(|sign: char| sign.is_ascii_uppercase())
            && word.contains(|sign: char| sign.is_ascii_lowercase());
        let sentence = text.trim_end().ends_with(['.', '?', '!']) || text.contains(". ") || text.contains("? ");
        !capitalised || sentence || names.contains(&word)
    };
    let mut wrong = std::collections::BTreeSet::new();
    // The program page shows the program; the help wraps its sentences.
    for page in Page::ALL.iter().copied().filter(|page| !matches!(page, Page::Program | Page::Help)) {
        for machine in [snapshot, running, alarm, refused, troubled, busy] {
            let texts = painted_text(&machine(page), Lang::En).into_iter();
            wrong.extend(
                texts.filter(|text| !is_chinese(text) && !follows(text)).map(|text| format!("{page:?}: {text}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// No English label of a shipped page is cut, on a wide and on a tall display.
#[test]
fn h9_the_english_labels_of_the_shipped_pages_have_their_room() {
    let mut cut = std::collections::BTreeSet::new();
    let mut look = |rig: &mut HeadlessHost, what: &str| {
        tell(rig, "page grinding");
        for size in [(1_024, 768), (768, 1_024)] {
            let mut stage = OffscreenHmi::new(Hmi::new(Lang::En), size);
            stage.frame(rig.snapshot());
            let texts = stage.texts().into_iter().filter(|(_, _, _, cut)| *cut);
            cut.extend(texts.map(|(text, ..)| format!("{what} {size:?}: {text}")));
        }
    };
    for (kind, programs) in PAGES {
        let mut rig = ready_of(kind);
        for number in programs {
            tell(&mut rig, &format!("load O{number}"));
            look(&mut rig, &format!("O{number}"));
        }
    }
    let mut rig = ready_of(Kind::Vertical);
    for sheet in 1..=3 {
        tell(&mut rig, &format!("page grinding\nsheet {sheet}"));
        look(&mut rig, &format!("sheet {sheet}"));
    }
    assert!(cut.is_empty(), "{cut:#?}");
}
