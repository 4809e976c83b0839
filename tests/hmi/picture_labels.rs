//! The picture of a grinding page answers a touch by its sidecar D00nn.RON, and shows which value is chosen.
//! Source: spec K7.3, K7.4, H6, B8.

use std::fs;

use egui::{Pos2, vec2};
use egui_kittest::kittest::Queryable;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::variable_name;
use kt830::host::folders::{Folders, parse_page_text};
use kt830::host::headless::HeadlessHost;
use kt830::host::picture_labels::parse_picture_labels;
use kt830::link::Command;
use kt830::link::snapshot::RunState;

use crate::live_screen::Bench;
use crate::stories::{folders, ready, ready_of, rig_in, tell};

fn bench(mut rig: HeadlessHost, story: &str) -> Bench {
    tell(&mut rig, story);
    Bench::new(rig, Page::Grinding)
}

/// The middle of the number of a variable in the picture, on the screen.
fn number_in_picture(bench: &Bench, variable: u16) -> Pos2 {
    let image = bench.screen.get_by_label("picture-labels").rect();
    let files = bench.screen.state().snapshot.page_files().expect("the files of the page");
    let label = files.labels.iter().find(|label| label.variable == variable).expect("a label");
    let (left, top, right, bottom) = label.area;
    let middle = vec2(f32::from(left + right) / 2.0, f32::from(top + bottom) / 2.0);
    image.min + middle * (image.width() / 200.0)
}

fn chosen(bench: &Bench) -> usize {
    bench.screen.state().hmi.variable_entry().unwrap().cursor
}

#[test]
fn h6_a_touch_of_a_number_in_the_picture_chooses_its_value() {
    let mut bench = bench(ready(), "load O1002\npart assets/parts/O1002.ron");
    // The rows of C0002.TXT: #520 is the first, #521 the second, #523 the fourth.
    for (variable, row, name) in [(521, 1, "成品直径"), (523, 3, "Z 轴磨削位置"), (520, 0, "毛坯直径")] {
        let at = number_in_picture(&bench, variable);
        bench.tap(at);
        assert_eq!(chosen(&bench), row, "#{variable}");
        assert!(bench.shows(&format!("数据输入: #{variable}=")) && bench.shows(name));
        assert!(bench.screen.query_by_label("pad-0").is_some(), "the pad opens for it");
        bench.press(egui::Key::Escape);
    }
    // A finger is wider than the number: 20 points beside it still mean it, far away nothing is meant.
    let beside = number_in_picture(&bench, 521) + vec2(0.0, 28.0);
    bench.tap(beside);
    assert_eq!(chosen(&bench), 1);
    bench.press(egui::Key::Escape);
    let image = bench.screen.get_by_label("picture-labels").rect();
    bench.tap(image.center() + vec2(0.0, 120.0));
    assert_eq!(chosen(&bench), 1);
    assert!(bench.screen.query_by_label("pad-0").is_none());
    // The value that is typed then is that of the picture's number.
    let at = number_in_picture(&bench, 521);
    bench.tap(at);
    bench.write("39.9");
    bench.press(egui::Key::Enter);
    assert_eq!(bench.rig.snapshot().variables[521], Some(39.9));
}

#[test]
fn h6_in_a_run_that_locks_values_the_picture_opens_no_pad() {
    let mut bench = bench(ready(), "load O1002\npart assets/parts/O1002.ron\nmode auto\nkey cycle-start\nwait 1 s");
    assert_eq!(bench.rig.snapshot().state, RunState::Running);
    bench.turn();
    let at = number_in_picture(&bench, 521);
    bench.tap(at);
    assert_eq!(chosen(&bench), 1, "looking at another value is free");
    assert!(bench.screen.query_by_label("pad-0").is_none());
}

#[test]
fn h6_the_pictures_of_the_other_kinds_answer_too() {
    for (kind, program, variable) in [(Kind::Gs, "O1007", 681), (Kind::Ga, "O1010", 741)] {
        let mut bench = bench(ready_of(kind), &format!("load {program}"));
        let at = number_in_picture(&bench, variable);
        bench.tap(at);
        assert!(bench.shows(&format!("数据输入: #{variable}=")), "{kind:?}");
    }
    // R parameters by their number.
    let mut bench = bench(ready_of(Kind::Vertical), "");
    let at = number_in_picture(&bench, variable_name::parse("R11").unwrap());
    bench.tap(at);
    assert!(bench.shows("数据输入: R11="), "{:?}", bench.painted());
}

/// O1002's page with a sidecar of its own.
fn with_labels(text: Option<&str>) -> (tempfile::TempDir, Bench) {
    let folder = tempfile::tempdir().unwrap();
    let screens = folder.path().join("screens");
    fs::create_dir(&screens).unwrap();
    for name in ["B0002.BMP", "C0002.TXT"] {
        fs::copy(folders().screens.join(name), screens.join(name)).unwrap();
    }
    if let Some(text) = text {
        fs::write(screens.join("D0002.RON"), text).unwrap();
    }
    let mut rig = rig_in(Folders { screens, ..folders() });
    rig.make_ready();
    let bench = bench(rig, "load O1002");
    (folder, bench)
}

#[test]
fn k7_3_a_picture_without_the_sidecar_works_as_before() {
    let (_folder, bench) = with_labels(None);
    assert!(bench.screen.query_by_label("picture-labels").is_none());
    assert!(bench.screen.state().snapshot.alarms.is_empty());
    assert!(bench.shows("毛坯直径"));
    // A variable that the page does not have is no target.
    let (_folder, bench) = with_labels(Some("[(variable: \"#700\", area: (0, 0, 20, 20))]"));
    assert!(bench.screen.query_by_label("picture-labels").is_none());
}

#[test]
fn b8_a_wrong_sidecar_is_alarm_66_with_its_place_and_the_page_works() {
    for (text, says) in [
        ("[\n  (variable: \"#520\", area: (0, 0, 20)),\n]", "D0002.RON"),
        ("[(variable: \"#520\", area: (20, 0, 20, 9))]", "#520"),
        ("[(variable: \"#520\", area: (0, 0, 201, 9))]", "200×400"),
        ("[(variable: \"#520\", place: (0, 0, 20, 9))]", "place"),
        ("[(variable: \"520\", area: (0, 0, 20, 9))]", "520 不是变量"),
        ("no list", "D0002.RON"),
    ] {
        let (_folder, mut bench) = with_labels(Some(text));
        bench.turn();
        let alarms = bench.rig.snapshot().alarms.clone();
        let told = alarms.first().map(|alarm| alarm.text.zh().into_owned()).unwrap_or_default();
        assert!(told.contains(says) && told.contains("D0002.RON"), "{text}: {told}");
        assert_eq!(alarms[0].number, 66);
        assert!(bench.shows("毛坯直径") && bench.screen.query_by_label("picture-labels").is_none());
    }
}

#[test]
fn b8_a_wrong_sidecar_names_its_line() {
    let wrong = parse_picture_labels("D0002.RON", b"[\n  (variable: \"#520\", area: (0, 0, 20)),\n]").unwrap_err();
    assert_eq!(wrong.position.map(|(line, _)| line), Some(2));
    assert!(parse_picture_labels("D0002.RON", b"[\xFF]").is_err());
    assert_eq!(parse_picture_labels("D0002.RON", b"[]"), Ok(Vec::new()));
}

/// Every number that a shipped picture shows is a value of its page.
#[test]
fn k7_4_the_numbers_of_the_shipped_pictures_are_on_their_pages() {
    let screens = folders().screens;
    let mut seen = 0;
    for entry in fs::read_dir(&screens).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let Some(number) = name.strip_prefix('D').and_then(|name| name.strip_suffix(".RON")) else { continue };
        let labels = parse_picture_labels(&name, &fs::read(screens.join(&name)).unwrap()).unwrap();
        let text = format!("C{number}.TXT");
        let page = parse_page_text(&text, &fs::read(screens.join(&text)).unwrap()).unwrap();
        for label in labels {
            let on_page = page.rows().any(|row| row.variable == label.variable);
            // The pictures of the R pages show some working values, too.
            assert!(on_page || number.starts_with("08"), "{name}: {}", label.variable);
            seen += 1;
        }
    }
    // Twenty programs and three R pages, some six numbers each.
    assert!(seen > 110, "{seen}");
}

#[test]
fn k7_2_the_part_of_the_last_cycle_covers_the_picture_and_its_numbers() {
    let mut bench = bench(ready(), "load O1002\npart assets/parts/O1002.ron\nmode auto\nkey cycle-start");
    tell(&mut bench.rig, "wait until idle max 200 s");
    bench.turn();
    assert!(bench.screen.query_by_label("picture-labels").is_none());
    bench.touch("合格 part-result");
    assert!(bench.screen.query_by_label("picture-labels").is_some());
    bench.rig.send(Command::OpenPage(Page::Position));
    bench.turn();
    assert!(bench.screen.query_by_label("picture-labels").is_none());
}

#[test]
fn h6_the_range_of_a_value_is_that_of_its_program() {
    let mut bench = bench(ready(), "load O1002\npart assets/parts/O1002.ron");
    for (variable, range) in [(521, "范围 > 0，< 40.3 ·"), (520, "范围 > 40，< 60 ·"), (523, "范围 ±99999.999 ·")]
    {
        let at = number_in_picture(&bench, variable);
        bench.tap(at);
        assert!(bench.shows(range), "#{variable}: {:?}", bench.painted());
        bench.press(egui::Key::Escape);
    }
    // The range follows the other value.
    tell(&mut bench.rig, "set #521 = 40.1");
    let at = number_in_picture(&bench, 520);
    bench.tap(at);
    assert!(bench.shows("范围 > 40.1，< 60 ·"), "{:?}", bench.painted());
    // Another program has other bounds; without any the value is free.
    tell(&mut bench.rig, "load O1001");
    bench.turn();
    assert!(!bench.shows("> 40.1"));
    bench.press(egui::Key::Escape);
    bench.touch("光磨次数 #511");
    assert!(bench.shows("范围 0 … 1000 ·"), "{:?}", bench.painted());
}
