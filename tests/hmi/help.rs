//! Help on every page: every page, soft key, key, alarm and code has its text in both languages, found by touch and by
//! keyboard. Source: spec B6 (everything by touch and by keyboard), K2.4, B8.

use std::sync::Arc;

use crate::sample::{alarm, snapshot};
use crate::screen::{Screen, open, painted};
use egui_kittest::kittest::Queryable;
use kt830::defs::alarm::ALARMS;
use kt830::defs::availability;
use kt830::defs::gcode::{Availability, G_CODES};
use kt830::defs::key::Key;
use kt830::defs::kind::{Dialect, Kind};
use kt830::defs::mcode;
use kt830::defs::page::Page;
use kt830::defs::param_row;
use kt830::defs::program_error::ProgramError;
use kt830::defs::soft_key::{ROWS as SOFT_ROWS, row as soft_row};
use kt830::defs::text::{Lang, Text};
use kt830::hmi::offscreen::OffscreenHmi;
use kt830::hmi::{HelpSection, Hmi, help_entries};
use kt830::link::snapshot::DirectoryRow;

fn touch(screen: &mut Screen, label: &str) {
    screen.get_by_label(label).click();
    screen.step();
    screen.step();
}

fn press(screen: &mut Screen, key: egui::Key) {
    screen.key_press(key);
    screen.step();
}

fn write(screen: &mut Screen, words: &str) {
    screen.event(egui::Event::Text(words.to_owned()));
    screen.step();
    screen.step();
}

fn sent(screen: &mut Screen) -> Vec<String> {
    screen.state_mut().sent.drain(..).map(|command| format!("{command:?}")).collect()
}

/// Whether a text stands on the screen, in part or whole.
fn shows(screen: &Screen, words: &str) -> bool {
    screen.query_all_by_label_contains(words).next().is_some()
}

fn is_chinese(text: &str) -> bool {
    text.chars().any(|sign| ('\u{4e00}'..='\u{9fff}').contains(&sign))
}

#[test]
fn b6_every_page_key_alarm_and_code_has_its_help_in_both_languages() {
    for kind in Kind::ALL {
        let all = help_entries(kind);
        let entry = |section: HelpSection, id: &str| {
            let found: Vec<_> = all.iter().filter(|entry| entry.section == section && entry.id == id).collect();
            assert_eq!(found.len(), 1, "{id} on {kind:?}");
            found[0]
        };
        let says = |section: HelpSection, id: &str, text: Text| {
            let entry = entry(section, id);
            for lang in [Lang::Zh, Lang::En] {
                let words = text.get(lang).split('{').next().unwrap();
                assert!(entry.text(lang).contains(words), "{id} on {kind:?}: {words}");
            }
        };
        for page in Page::ALL.iter().filter(|page| page.exists_on(kind)) {
            says(HelpSection::Pages, &format!("page-{}", page.id()), page.help());
            says(HelpSection::Pages, &format!("page-{}", page.id()), page.usage());
        }
        for row in 0..SOFT_ROWS {
            for (index, soft) in soft_row(kind, row).enumerate() {
                says(HelpSection::SoftKeys, &format!("soft-{}-{}", row + 1, index + 1), soft.action.help());
            }
        }
        for key in Key::ALL.iter().filter(|key| key.exists_on(kind)) {
            says(HelpSection::Keys, &format!("key-{}", key.id()), key.row().help);
        }
        for row in ALARMS {
            let id = format!("alarm-{:03}", row.number);
            for text in [row.cause, row.remedy, row.reaction.name(), row.reset.name()] {
                says(HelpSection::Alarms, &id, text);
            }
        }
        for error in ProgramError::ALL {
            says(HelpSection::Alarms, &format!("alarm-{:03}", error.number()), error.remedy());
        }
        let (mill, family) =
            (kind.dialect() == Dialect::Mill, matches!(kind.dialect(), Dialect::LatheA | Dialect::Mill));
        for row in G_CODES.iter().filter(|row| family && row.availability_on(mill) != Availability::No) {
            says(HelpSection::GCodes, &format!("g-G{:02}", row.code), row.help);
        }
        for row in availability::m_codes(kind) {
            says(HelpSection::MCodes, &format!("m-M{:02}", row.code), row.help);
        }
        for section in HelpSection::ALL {
            assert!(all.iter().any(|entry| entry.section == section), "{section:?} on {kind:?}");
        }
        for entry in &all {
            for (caption, said) in &entry.paragraphs {
                let name = format!("{} of {} on {kind:?}", caption.en, entry.id);
                assert!(!said.zh().is_empty() && !said.en().is_empty(), "{name}");
                assert!(!is_chinese(&said.en()), "{name}: {}", said.en());
            }
            let words = entry.text(Lang::Zh);
            assert!(is_chinese(words.split(": ").nth(1).unwrap_or_default()), "{}: {words}", entry.id);
        }
    }
}

#[test]
fn b6_the_help_knows_the_g_codes_that_the_language_knows() {
    use kt830::nc::{NcSettings, Source, check_syntax};
    // G17 of other machines is refused by its name.
    let unknown =
        [ProgramError::UnknownG, ProgramError::UnknownCode, ProgramError::WrongKindG].map(ProgramError::number);
    for (kind, dialect) in [(Kind::Lathe, Dialect::SuperMan), (Kind::Vertical, Dialect::Sinumerik)] {
        let listed: Vec<u32> =
            dialect.words().iter().filter_map(|word| word.word.strip_prefix('G')?.parse().ok()).collect();
        for code in 0..=120 {
            let source = std::sync::Arc::new(Source::new(1, "", format!("N0010 G{code}\n").into_bytes(), dialect));
            let faults = check_syntax(&source, &NcSettings::for_dialect(dialect));
            let knows = faults.iter().all(|fault| !unknown.contains(&fault.error.number()));
            assert_eq!(listed.contains(&code), knows, "G{code} on {kind:?}");
        }
    }
}

#[test]
fn b6_help_opens_on_every_page_with_that_page() {
    for page in Page::ALL.iter().filter(|page| **page != Page::Help) {
        let mut machine = snapshot(*page);
        if !page.exists_on(machine.kind) {
            machine.kind = Kind::Lathe;
        }
        let mut screen = open(machine);
        press(&mut screen, egui::Key::F12);
        assert!(shows(&screen, page.help().zh), "{}", page.id());
        assert!(sent(&mut screen).iter().all(|command| !command.contains("Press")), "{}", page.id());
        press(&mut screen, egui::Key::Escape);
        assert!(screen.query_by_label("关闭帮助 close-help").is_none(), "{}", page.id());
    }
    let mut screen = open(snapshot(Page::Help));
    assert!(shows(&screen, Page::Help.help().zh));
    touch(&mut screen, "? help");
    assert!(screen.query_by_label("关闭帮助 close-help").is_none(), "the help needs no help over it");
}

#[test]
fn b8_on_the_alarm_page_help_opens_at_the_first_alarm() {
    let machine = alarm(Page::Alarm);
    let number = machine.alarms[0].number;
    let row = ALARMS.iter().find(|row| row.number == number).unwrap();
    let mut screen = open(machine);
    touch(&mut screen, "? help");
    for text in [row.cause, row.remedy, row.reaction.name(), row.reset.name()] {
        assert!(shows(&screen, text.zh), "{}", text.zh);
    }
}

#[test]
fn b6_help_is_found_by_touch() {
    let mut screen = open(snapshot(Page::Grinding));
    touch(&mut screen, "? help");
    touch(&mut screen, "M 代码 help-m");
    touch(&mut screen, "砂轮启动 m-M03");
    assert!(shows(&screen, mcode::find(3).unwrap().help.zh));
    touch(&mut screen, "查找 search");
    for sign in ["1 letter-1", "8 letter-8", "1 letter-1"] {
        touch(&mut screen, sign);
    }
    touch(&mut screen, "完成 letter-done");
    let row = ALARMS.iter().find(|row| row.number == 181).unwrap();
    assert!(shows(&screen, row.remedy.zh), "the number itself comes first");
    touch(&mut screen, "× search-clear");
    touch(&mut screen, "键盘 help-map");
    touch(&mut screen, "关闭帮助 close-help");
    assert!(sent(&mut screen).is_empty(), "help asks nothing of the machine");
}

/// From any page: the magnifier, a number or word, OPEN. The page shows what was found.
#[test]
fn b6_the_search_goes_to_what_it_finds() {
    let machine = || {
        let mut machine = snapshot(Page::Position);
        let row =
            DirectoryRow {
                number: 1_005, name: "O1005".into(), comment: "锥面磨削".into(), ..DirectoryRow::default()
            };
        machine.directory = Arc::new(vec![row]);
        machine
    };
    // By touch: five touches for a parameter.
    let mut screen = open(machine());
    for label in ["全部查找 header-search", "P letter-P", "2 letter-2", "7 letter-7", "0 letter-0"] {
        touch(&mut screen, label);
    }
    touch(&mut screen, "打开 参数 help-open");
    assert_eq!(sent(&mut screen), ["OpenPage(Params)"]);
    assert!(screen.query_by_label("关闭帮助 close-help").is_none());
    screen.state_mut().snapshot.page = Page::Params;
    screen.step();
    screen.step();
    assert!(painted(&screen).iter().any(|text| text.starts_with("数据输入: P270=")), "{:?}", painted(&screen));
    // By keyboard: a program, a variable, a page, an alarm that is present, a code without a page.
    for (words, wanted) in [
        ("1005", Some("OpenPage(Directory)")),
        ("#777", Some("OpenPage(Macro)")),
        ("page-graphic", Some("OpenPage(Graphic)")),
        ("g33", None),
        ("#99", None),
    ] {
        let mut screen = open(machine());
        press(&mut screen, egui::Key::F12);
        write(&mut screen, words);
        press(&mut screen, egui::Key::Enter);
        press(&mut screen, egui::Key::Enter);
        assert_eq!(sent(&mut screen).first().map(String::as_str), wanted, "{words}");
        let is_open = screen.query_by_label("关闭帮助 close-help").is_some();
        assert_eq!(is_open, wanted.is_none(), "{words}");
    }
    // The page that is open shows it at once.
    let mut machine = machine();
    machine.page = Page::Params;
    let mut screen = open(machine);
    press(&mut screen, egui::Key::F12);
    write(&mut screen, "p64");
    press(&mut screen, egui::Key::Enter);
    press(&mut screen, egui::Key::Enter);
    screen.step();
    assert!(sent(&mut screen).is_empty());
    assert!(painted(&screen).iter().any(|text| text.starts_with("数据输入: P64=")), "{:?}", painted(&screen));
}

#[test]
fn b6_help_is_found_by_keyboard() {
    let mut screen = open(snapshot(Page::Position));
    press(&mut screen, egui::Key::F12);
    // X is an address key of the position page: in the help it is a letter of the search.
    screen.key_press(egui::Key::X);
    write(&mut screen, "x");
    assert!(sent(&mut screen).is_empty());
    for _ in 0..2 {
        press(&mut screen, egui::Key::Escape);
    }
    assert!(screen.query_by_label("关闭帮助 close-help").is_none(), "first the search, then the sheet");
    press(&mut screen, egui::Key::F12);
    write(&mut screen, "/g78");
    press(&mut screen, egui::Key::Enter);
    let g78 = G_CODES.iter().find(|row| row.code == 78).unwrap();
    assert!(shows(&screen, g78.help.zh));
    press(&mut screen, egui::Key::ArrowDown);
    assert!(!shows(&screen, g78.help.zh), "the next one found");
    write(&mut screen, "尾座退");
    assert!(shows(&screen, Key::TailstockRetract.row().help.zh));
    write(&mut screen, "zzzz");
    assert!(screen.query_by_label_contains("help-entry").is_none() && sent(&mut screen).is_empty());
}

#[test]
fn k2_4_help_on_a_key_says_why_it_is_refused_now() {
    let mut machine = snapshot(Page::Position);
    machine.keys[Key::WheelStart as usize].blocked = Some(Text::new("液压未打开", "hydraulics are off"));
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::Zh), (1_024, 768));
    stage.frame(&machine);
    let key = |key| egui::Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: egui::Modifiers::NONE,
    };
    stage.events.push(key(egui::Key::F12));
    stage.frame(&machine);
    stage.events.push(egui::Event::Text("砂轮启动".into()));
    let mut found = false;
    for _ in 0..4 {
        stage.frame(&machine);
        found |= stage.texts().iter().any(|(text, ..)| text == "液压未打开");
        stage.events.push(key(egui::Key::ArrowDown));
    }
    assert!(found);
}

#[test]
fn h9_no_help_text_is_cut() {
    let mut wrong = Vec::new();
    for lang in [Lang::Zh, Lang::En] {
        for kind in [Kind::Gc, Kind::Ga, Kind::Vertical, Kind::Lathe] {
            let mut machine = snapshot(Page::Help);
            machine.kind = kind;
            let mut stage = OffscreenHmi::new(Hmi::new(lang), (1_024, 768));
            stage.ctx().set_missing_glyph_policy(egui::MissingGlyphPolicy::Panic);
            stage.frame(&machine);
            let mut step = |stage: &mut OffscreenHmi, key| {
                let modifiers = egui::Modifiers::NONE;
                stage.events.push(egui::Event::Key {
                    key,
                    physical_key: None,
                    pressed: true,
                    repeat: false,
                    modifiers,
                });
                stage.frame(&machine);
                stage.frame(&machine);
                for (text, ink, clip, cut) in stage.texts() {
                    // A long name in the list ends with …: the whole of it stands beside the list.
                    let list = ink.min.x < 320.0;
                    if !list && (cut || !clip.expand(0.5).contains_rect(ink)) {
                        wrong.push(format!("{text} {lang:?} {kind:?}"));
                    }
                }
            };
            let all = help_entries(kind);
            for section in HelpSection::ALL {
                for _ in 1..all.iter().filter(|entry| entry.section == section).count() {
                    step(&mut stage, egui::Key::ArrowDown);
                }
                step(&mut stage, egui::Key::ArrowRight);
            }
        }
    }
    assert!(wrong.is_empty(), "{} texts:\n{}", wrong.len(), wrong.join("\n"));
}

/// The entries that a search lists, the best first, as the page sorts them.
fn found(kind: Kind, search: &str) -> Vec<String> {
    let mut all: Vec<_> = help_entries(kind).into_iter().filter(|entry| entry.matches(search)).collect();
    all.sort_by_key(|entry| entry.rank(search));
    all.into_iter().map(|entry| entry.id).collect()
}

#[test]
fn b6_a_search_prefers_whole_words() {
    for kind in [Kind::Gc, Kind::Gs] {
        let clock = found(kind, "clock");
        assert_eq!(clock[0], "page-settings", "{clock:?}");
        assert!(clock.iter().any(|id| id == "g-G02"), "a part of a word is found as well: {clock:?}");
    }
    assert_eq!(found(Kind::Gc, "180")[0], "alarm-180");
    assert_eq!(found(Kind::Gc, "M03")[0], "m-M03");
    assert_eq!(found(Kind::Gc, "时钟")[0], "page-settings");
}

#[test]
fn b6_a_parameter_is_found_with_its_meaning_range_and_value() {
    assert_eq!(found(Kind::Gc, "P370")[0], "param-P370");
    assert_eq!(found(Kind::Gc, "P17.0")[0], "param-P17.0");
    let serial: Vec<String> = found(Kind::Lathe, "RS232").into_iter().filter(|id| id.starts_with("param-")).collect();
    assert_eq!(serial, ["param-P370", "param-P371", "param-P372", "param-P373"]);
    let all = help_entries(Kind::Gc);
    let entry = all.iter().find(|entry| entry.id == "param-P370").unwrap();
    let row = param_row::rows(Kind::Gc).into_iter().find(|row| row.address.number == 370).unwrap();
    for lang in [Lang::Zh, Lang::En] {
        let text = entry.text(lang);
        for words in [&*row.name.get(lang), &row.range().get(lang), "9600", row.level.name().get(lang)] {
            assert!(text.contains(words), "{words} in {text}");
        }
    }
    // Every parameter of every kind, and the value that it has now.
    for kind in Kind::ALL {
        let all = help_entries(kind);
        for row in param_row::rows(kind) {
            assert_eq!(
                all.iter().filter(|entry| entry.id == format!("param-{}", row.address)).count(),
                1,
                "{}",
                row.address
            );
        }
    }
    let mut screen = open(snapshot(Page::Help));
    write(&mut screen, "p270");
    assert!(painted(&screen).iter().any(|text| text == "3000"), "{:?}", painted(&screen));
}

#[test]
fn h6_a_long_entry_is_read_to_its_end_beside_the_letters() {
    let longest = |all: Vec<kt830::hmi::HelpEntry>| all.into_iter().max_by_key(|entry| entry.text(Lang::En).len());
    let entry = longest(help_entries(Kind::Gc)).unwrap();
    let (_, last) = entry.paragraphs.last().unwrap();
    let end = last.en().split(' ').next_back().unwrap().to_owned();
    let mut stage = OffscreenHmi::new(Hmi::new(Lang::En), (1_024, 768));
    let machine = snapshot(Page::Help);
    stage.frame(&machine);
    for letter in format!("/{}", entry.id).split_inclusive(|_| true) {
        stage.events.push(egui::Event::Text(letter.to_owned()));
        stage.frame(&machine);
    }
    let right = |stage: &OffscreenHmi| -> Vec<String> {
        let texts = stage.texts().into_iter().filter(|(_, ink, ..)| ink.min.x > 320.0 && ink.max.x < 760.0);
        texts.map(|(text, ..)| text).collect()
    };
    stage.frame(&machine);
    assert!(!right(&stage).iter().any(|text| text.ends_with(&end)), "{} has room: {:?}", entry.id, right(&stage));
    for _ in 0..40 {
        stage.events.push(egui::Event::PointerMoved(egui::pos2(600.0, 200.0)));
        stage.events.push(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, -100.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: egui::Modifiers::NONE,
        });
        stage.frame(&machine);
    }
    assert!(right(&stage).iter().any(|text| text.ends_with(&end)), "{}: {end} not in {:?}", entry.id, right(&stage));
}
