//! The house rules that a machine can check: who may import whom, how long a file and a function may be, and what the
//! core never touches.

use std::fs;
use std::path::{Path, PathBuf};

use kt830::defs::kind::Kind;

/// Rooms and the rooms they may import (beside themselves).
const ROOMS: &[(&str, &[&str])] = &[
    ("units", &[]),
    ("defs", &["units"]),
    ("link", &["units", "defs"]),
    ("nc", &["units", "defs", "geometry"]),
    ("geometry", &[]),
    ("motion", &["units", "defs"]),
    ("machine", &["units", "defs", "link"]),
    ("io", &["units", "defs", "technology"]),
    ("store", &["units", "defs"]),
    ("controller", &["units", "defs", "link", "nc", "motion", "machine", "io"]),
    ("host", &["units", "defs", "link", "nc", "machine", "io", "store", "controller"]),
    ("story", &["units", "defs", "link", "io", "host"]),
    ("torture", &["units", "defs", "link", "nc", "io", "store", "controller", "host", "story"]),
    ("technology", &["defs"]),
    ("gateway", &["units", "defs", "link", "store"]),
    ("hmi", &["units", "defs", "link", "technology", "geometry"]),
    (
        "cli",
        &["units", "defs", "link", "nc", "io", "store", "controller", "host", "story", "torture", "gateway", "hmi"],
    ),
];

/// Rooms without clock, file, thread or chance: time and hardware are arguments.
const CORE: &[&str] =
    &["units", "defs", "link", "geometry", "nc", "motion", "machine", "io", "controller", "technology"];

/// What the core never names.
const NOT_IN_CORE: &[&str] = &[
    "std::time",
    "Instant::now",
    "SystemTime",
    "std::fs",
    "std::thread",
    "std::net",
    "std::env",
    "thread_rng",
    "chrono",
];

/// Most lines of a file without its tests, and of a function.
const FILE_LINES: usize = 600;
const FUNCTION_LINES: usize = 60;

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Path below `src`, and the text before the tests.
fn rooms() -> Vec<(String, String)> {
    let all = sources(&root()).into_iter().map(|path| {
        let name = path.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/");
        let text = fs::read_to_string(&path).unwrap();
        (name, text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default().to_owned())
    });
    all.collect()
}

fn room_of(name: &str) -> &str {
    name.split(['/', '.']).next().unwrap()
}

#[test]
fn rooms_import_only_whom_they_may() {
    let mut wrong = Vec::new();
    for (name, text) in rooms() {
        let Some((room, allowed)) = ROOMS.iter().find(|(room, _)| *room == room_of(&name)) else { continue };
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            for piece in code.split("crate::").skip(1) {
                let target: String = piece.chars().take_while(|sign| sign.is_alphanumeric() || *sign == '_').collect();
                let known = ROOMS.iter().any(|(room, _)| *room == target);
                if known && target != *room && !allowed.contains(&target.as_str()) {
                    wrong.push(format!("{name}:{}: {room} may not import {target}", number + 1));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The table of rooms in `docs/architecture.md` names the same imports.
#[test]
fn the_map_of_rooms_says_who_imports_whom() {
    let map = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/architecture.md")).unwrap();
    for (room, imports) in ROOMS {
        let start = format!("| `{room}` | ");
        let row = map.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("no row of {room}"));
        let told = row.trim_end_matches(" |").rsplit(" | ").next().unwrap_or_default();
        let wanted = if imports.is_empty() { "–".to_owned() } else { imports.join(", ") };
        assert_eq!(told, wanted, "{room}");
    }
}

#[test]
fn every_file_belongs_to_a_room() {
    for (name, _) in rooms() {
        let known = ROOMS.iter().any(|(room, _)| *room == room_of(&name));
        assert!(known || ["lib.rs", "main.rs"].contains(&name.as_str()), "{name} is in no room");
    }
}

#[test]
fn the_core_has_no_clock_file_thread_or_chance() {
    let mut wrong = Vec::new();
    for (name, text) in rooms() {
        if !CORE.contains(&room_of(&name)) {
            continue;
        }
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            for word in NOT_IN_CORE {
                if code.contains(word) {
                    wrong.push(format!("{name}:{}: {word}", number + 1));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_and_functions_are_short() {
    let mut wrong = Vec::new();
    for (name, text) in rooms() {
        let lines = text.lines().count();
        if lines > FILE_LINES {
            wrong.push(format!("{name}: {lines} lines"));
        }
        let mut open: Option<(usize, usize, String)> = None;
        for (number, line) in text.lines().enumerate() {
            let indent = line.len() - line.trim_start().len();
            let begins =
                line.trim_start().split(' ').take(5).any(|word| word == "fn") && !line.trim_start().starts_with("//");
            if open.is_none() && begins && !line.trim_end().ends_with(';') {
                open = Some((number, indent, line.trim().to_owned()));
            }
            if let Some((start, depth, head)) = &open
                && indent == *depth
                && line.trim() == "}"
            {
                let length = number - start + 1;
                if length > FUNCTION_LINES {
                    wrong.push(format!("{name}:{}: {length} lines: {head}", start + 1));
                }
                open = None;
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Where a kind may be named: its row says what differs from the others.
const NAMES_KINDS: &[&str] = &["defs/kind/"];
/// Where a dialect may be named: its folder, and the tables keyed by dialect.
const NAMES_DIALECTS: &[&str] =
    &["defs/kind/", "nc/dialect/", "defs/dialect_word.rs", "defs/mcode.rs", "defs/variable_name.rs"];

#[test]
fn kinds_and_languages_are_told_apart_in_their_rooms_alone() {
    let kinds = Kind::ALL.map(|kind| (format!("Kind::{kind:?}"), NAMES_KINDS));
    let dialects = Kind::ALL.map(|kind| (format!("Dialect::{:?}", kind.dialect()), NAMES_DIALECTS));
    let mut wrong = Vec::new();
    for (name, text) in rooms() {
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            for (variant, rooms) in kinds.iter().chain(&dialects) {
                let found = code.split(variant.as_str()).skip(1).any(|rest| {
                    // Neither a longer name nor another enumeration's variant.
                    !rest.starts_with(|sign: char| sign.is_alphanumeric() || sign == '_')
                });
                if found && !rooms.iter().any(|room| name.starts_with(room)) {
                    wrong.push(format!("{name}:{}: {variant}", number + 1));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn colours_stand_in_the_theme_alone() {
    let mut wrong = Vec::new();
    for (name, text) in rooms() {
        let exempt = name == "hmi/theme.rs";
        if room_of(&name) != "hmi" || exempt {
            continue;
        }
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            if ["Color32::from_", "Color32::RED", "Color32::GREEN", "Color32::BLACK"]
                .iter()
                .any(|word| code.contains(word))
            {
                wrong.push(format!("{name}:{}: {}", number + 1, line.trim()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_test_is_switched_off() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let mark = ["#[ign", "ore"].concat();
    for path in sources(&tests).into_iter().chain(sources(&root())) {
        assert!(!fs::read_to_string(&path).unwrap().contains(&mark), "{}", path.display());
    }
}

/// Rooms that run in the tick: they say what they mean by phrases, and the screen puts them into words.
const MAKES_PHRASES: &[&str] = &["controller", "machine"];
/// What puts a text into words, and allocates.
const WORDING: &[&str] = &["format!(", ".to_string()", "to_string)", "LocalizedText::new("];
/// Where a text is composed nevertheless: seldom, and when the operator asks for it.
const COMPOSES_TEXTS: &[(&str, &str)] = &[
    // Values read from a file: names the parameters in use, as many as they are.
    ("controller/panel/files.rs", "kept.push(at.to_string())"),
    // The programs are listed by the disk thread, when the folder is read.
    ("controller/program/library.rs", "format!(\"{file}:{line}\")"),
];

#[test]
fn the_tick_makes_phrases_and_leaves_the_words_to_the_screen() {
    let (mut wrong, mut used) = (Vec::new(), vec![false; COMPOSES_TEXTS.len()]);
    for (name, text) in rooms().into_iter().filter(|(name, _)| MAKES_PHRASES.contains(&room_of(name))) {
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            if !WORDING.iter().any(|word| code.contains(word)) {
                continue;
            }
            match COMPOSES_TEXTS.iter().position(|(file, words)| *file == name && code.contains(words)) {
                Some(exempt) => used[exempt] = true,
                None => wrong.push(format!("{name}:{}: {}", number + 1, line.trim())),
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(!used.contains(&false), "an exemption that is no longer needed: {used:?}");
}
