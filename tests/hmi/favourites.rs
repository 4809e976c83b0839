//! Favourites: what the operator keeps on the home page (rows H6, H7).

use std::path::Path;

use egui_kittest::kittest::Queryable;
use kt830::defs::favourite::{Favourite, MAX_FAVOURITES};
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::param::ParamAddress;
use kt830::host::headless::{HeadlessHost, HostSetup};
use kt830::host::retained_store::RetainedStore;
use kt830::link::Command;
use kt830::store::StoredSettings;

use crate::live_screen::Bench;

/// A machine whose data stay in a folder, with O1002 loaded.
fn machine(folder: &Path) -> HeadlessHost {
    let (store, found) = RetainedStore::open(folder, Kind::Gc).unwrap();
    let folders = crate::stories::folders();
    let setup = HostSetup { kind: Kind::Gc, retained: found.retained, store: Some(store), folders, seed: 1 };
    let mut rig = HeadlessHost::new(setup).unwrap();
    rig.send(Command::LoadProgram(1_002));
    rig.send(Command::SetVariable(521, Some(40.0)));
    (0..50).for_each(|_| rig.step());
    rig
}

/// Searches for words and presses the key beside the first thing found.
fn keep(bench: &mut Bench, words: &str, key: &str) {
    bench.touch("全部查找 header-search");
    bench.write(words);
    bench.touch(&format!("{key} help-keep"));
    bench.touch("关闭帮助 close-help");
}

fn stored(folder: &Path) -> Vec<String> {
    StoredSettings::read(folder).unwrap().favourites.iter().map(ToString::to_string).collect()
}

#[test]
fn h7_what_the_search_finds_stays_on_the_home_page_and_leads_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::new(machine(folder.path()), Page::Home);
    assert!(bench.shows("收藏：查找"), "an empty row says how it is filled");
    for words in ["P270", "#521", "O1005", "page-dressing"] {
        keep(&mut bench, words, "☆ 收藏");
    }
    assert_eq!(stored(folder.path()), ["param P270", "variable #521", "program O1005", "page dressing"]);
    let begin = bench.param("P270");
    for (label, page) in [
        (format!("param P270 {begin}"), Page::Params),
        ("variable #521 40.0".to_owned(), Page::Grinding),
        ("page dressing".to_owned(), Page::Dressing),
    ] {
        bench.screen.get_by_label_contains(&label).click();
        bench.turn();
        assert_eq!(bench.rig.snapshot().page, page, "{label}");
        bench.touch("总览 header-home");
    }
    // Its value is the one that holds now.
    bench.rig.send(Command::SetVariable(521, Some(12.5)));
    bench.turn();
    assert!(bench.shows("12.50"), "{:?}", bench.painted());
}

#[test]
fn h7_favourites_are_there_after_the_next_start_and_can_be_let_go() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::new(machine(folder.path()), Page::Home);
    keep(&mut bench, "P270", "☆ 收藏");
    drop(bench);
    let mut bench = Bench::new(machine(folder.path()), Page::Home);
    bench.screen.state_mut().hmi.set_favourites(StoredSettings::read(folder.path()).unwrap().favourites);
    bench.turn();
    assert!(bench.shows("P270"));
    keep(&mut bench, "P270", "★ 已收藏");
    assert_eq!(stored(folder.path()), [""; 0]);
    assert!(bench.shows("收藏：查找") && !bench.shows("P270"));
}

#[test]
fn h7_a_full_home_page_takes_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::new(machine(folder.path()), Page::Home);
    for number in 501..501 + MAX_FAVOURITES {
        keep(&mut bench, &format!("#{number}"), "☆ 收藏");
    }
    let full = stored(folder.path());
    assert_eq!(full.len(), MAX_FAVOURITES);
    keep(&mut bench, "P270", "收藏已满");
    assert_eq!(stored(folder.path()), full);
    // One that is kept can still be let go.
    keep(&mut bench, "#501", "★ 已收藏");
    assert_eq!(stored(folder.path()), full[1..]);
}

/// A program that was deleted, and a device that this machine lacks: shown, but they lead nowhere.
#[test]
fn h7_a_favourite_that_is_gone_opens_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::new(machine(folder.path()), Page::Home);
    let gone = vec![Favourite::Program("O4711".to_owned()), Favourite::Page(Page::Tools)];
    bench.screen.state_mut().hmi.set_favourites(gone);
    bench.turn();
    assert!(!Page::Tools.exists_on(Kind::Gc));
    let tools = format!("page tools {}", Page::Tools.title_on(Kind::Gc).zh);
    for label in ["program O4711 没有此程序", &tools] {
        bench.touch(label);
        assert_eq!(bench.rig.snapshot().page, Page::Home);
    }
}

#[test]
fn h7_favourites_are_written_as_words_and_wrong_ones_are_named() {
    let all = [
        Favourite::Page(Page::Jobs),
        Favourite::Param(ParamAddress { number: 16, bit: Some(0) }),
        Favourite::Variable(521),
        Favourite::Program("SHAFT".to_owned()),
    ];
    assert_eq!(all.clone().map(String::from), ["page jobs", "param P16.0", "variable #521", "program SHAFT"]);
    assert_eq!(all.clone().map(String::from).map(|text| Favourite::try_from(text).unwrap()), all);
    for wrong in ["", "page", "page nowhere", "param X", "variable 521", "variable #70000", "program ", "key jog"] {
        let fault = Favourite::try_from(wrong.to_owned()).unwrap_err();
        assert!(fault.contains(&format!("`{wrong}`")) && fault.contains("write page"), "{fault}");
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("settings.ron"), "(lang: Some(En),\n favourites: [\"page nowhere\"])").unwrap();
    let fault = StoredSettings::read(folder.path()).unwrap_err().to_string();
    assert!(fault.contains("no favourite `page nowhere`") && fault.contains('2'), "{fault}");
}
