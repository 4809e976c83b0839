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
    StoredSettings::read(folder).unwrap().favourites
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
    let kept = stored(folder.path()).iter().map(|text| text.parse().unwrap()).collect();
    bench.screen.state_mut().hmi.set_favourites(kept);
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

/// A program that was deleted, and a device that this machine lacks: a touch lets them go.
#[test]
fn h7_a_favourite_that_is_gone_is_let_go_by_a_touch() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::new(machine(folder.path()), Page::Home);
    let gone = vec![Favourite::Program("O4711".to_owned()), Favourite::Page(Page::Tools), Favourite::Variable(521)];
    bench.screen.state_mut().hmi.set_favourites(gone);
    bench.turn();
    assert!(!Page::Tools.exists_on(Kind::Gc));
    for label in ["program O4711 没有了，碰一下取下", "page tools 没有了，碰一下取下"] {
        bench.touch(label);
        assert_eq!(bench.rig.snapshot().page, Page::Home);
    }
    assert_eq!(stored(folder.path()), ["variable #521"]);
    assert!(!bench.shows("没有了"));
}

#[test]
fn h7_favourites_are_written_as_words_and_wrong_ones_are_named() {
    let all = [
        Favourite::Page(Page::Jobs),
        Favourite::Param(ParamAddress { number: 16, bit: Some(0) }),
        Favourite::Variable(521),
        Favourite::Program("SHAFT".to_owned()),
    ];
    let words = ["page jobs", "param P16.0", "variable #521", "program SHAFT"];
    assert_eq!(all.clone().map(|favourite| favourite.to_string()), words);
    assert_eq!(words.map(|text| text.parse::<Favourite>().unwrap()), all);
    for wrong in ["", "page", "page nowhere", "param X", "variable 521", "variable #70000", "program ", "key jog"] {
        let fault = wrong.parse::<Favourite>().unwrap_err();
        assert!(fault.contains(&format!("`{wrong}`")) && fault.contains("write page"), "{fault}");
    }
}

/// One of a later version stops nobody: the others are there, and the control starts without an alarm.
#[test]
fn h7_an_unknown_favourite_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let settings = StoredSettings {
        favourites: vec!["page nowhere".to_owned(), "variable #521".to_owned()],
        ..StoredSettings::default()
    };
    settings.write(folder.path()).unwrap();
    let (data, picture) = (folder.path().to_str().unwrap(), folder.path().join("home.png"));
    let out = crate::command::kt830(&["shot", "home", "--data", data, "--out", picture.to_str().unwrap()]);
    assert_eq!(out.status.code(), Some(0));
    let told = String::from_utf8_lossy(&out.stderr);
    assert!(told.contains("no favourite `page nowhere`") && picture.exists(), "{told}");
}
