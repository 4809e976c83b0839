//! The structure of the sources: no circle of imports, no wide parameter list, no retired name, no two types of one
//! name, no document that names what is gone. A file and the files below it may import each other.

mod imports;
pub mod tokens;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use imports::{Crate, circles};
use tokens::{declared, functions, is_word, tokens, types};

/// Most parameters of a function beside `self`; a tuple counts as its elements.
const PARAMETERS: usize = 5;

/// Names of an earlier version and what stands in their place; docs/architecture.md has the table. No type, function,
/// module or file has such a name.
#[rustfmt::skip]
const RETIRED: &[(&str, &str)] = &[
    ("System", "Dialect"), ("Frames", "WorkOffsets"), ("Preset", "SetCoordinateSystem"), ("Post", "ToolTurret"),
    ("Proof", "ProgramPreflight"), ("Foresight", "InterlockCheck"), ("foresight", "interlock_check"),
    ("Planned", "LookaheadState"), ("Act", "QueuedAction"), ("Doing", "Activity"), ("Did", "ActionStatus"),
    ("Around", "ControlState"), ("Facts", "InterlockInputs"), ("Path", "TrajectoryPlanner"),
    ("Trail", "SetpointBuffer"), ("Warp", "FeedScaling"), ("Tube", "ToleranceBand"), ("Window", "LookaheadWindow"),
    ("Stroke", "TwoPositionActuator"), ("Hand", "JogDemand"), ("by_hand", "step_jog"), ("mst_lock", "aux_function_lock"),
    ("ScrewTable", "LeadscrewCompensation"), ("Effect", "StorageRequest"), ("PageWish", "SettingsRequest"),
    ("Office", "JobRunner"), ("Keeper", "RetainedStore"), ("Vault", "PasswordStore"), ("Stick", "UsbDrive"),
    ("Courier", "SerialTransfer"), ("Said", "LocalizedText"), ("Face", "KindUi"), ("Rig", "HeadlessHost"),
    ("happen", "transition"),
];

/// Words of an earlier version and what stands in their place. No variable, field or function of `src` has such a name.
#[rustfmt::skip]
const RETIRED_WORDS: &[(&str, &str)] = &[
    ("frames", "offsets or work_offsets"), ("facts", "inputs"), ("foresight", "interlock_check"), ("tube", "band"),
    ("post", "turret"), ("did", "status"), ("wish", "request"), ("wishes", "commands"), ("deed", "action or completion"),
    ("office", "jobs"), ("keeper", "store"), ("vault", "passwords"), ("stick", "drive or usb_drive"),
    ("courier", "transfer"), ("said", "message or text"), ("system", "dialect"), ("mst_lock", "aux_function_lock"),
];

/// Where a retired name means something else. A file `window` is that of the screen.
const HOMONYMS: &[(&str, &str, &str)] = &[
    ("src/hmi/window.rs", "Window", "the window of the operating system"),
    ("tests/hmi/operators.rs", "Hand", "the operator's hand on the screen"),
    ("tests/sim/bench.rs", "Rig", "a machine alone, without a control"),
];

/// The files of a folder of the repository, and of those below it: path and text.
fn files(folder: &str) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut found, mut open) = (Vec::new(), vec![root.join(folder)]);
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let name = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
                found.push((name, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

fn sources_and_tests() -> impl Iterator<Item = (String, String)> {
    files("src").into_iter().chain(files("tests"))
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let files = files("src");
    let named = files.iter().map(|(name, text)| (name.trim_start_matches("src/"), text.as_str()));
    let circles = circles(&Crate::read(named).edges());
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

#[test]
fn no_function_has_more_than_five_parameters() {
    let mut wide = Vec::new();
    for (name, text) in sources_and_tests() {
        for (function, count) in functions(&tokens(&text)) {
            if count > PARAMETERS {
                wide.push(format!("{name}: fn {function} has {count} parameters"));
            }
        }
    }
    assert!(wide.is_empty(), "{}", wide.join("\n"));
}

/// The name of a module for a type: `ScrewTable` is `screw_table`.
fn file_name(name: &str) -> String {
    let letters = name.char_indices().map(|(at, sign)| match sign.is_uppercase() && at > 0 {
        true => format!("_{}", sign.to_lowercase()),
        false => sign.to_lowercase().to_string(),
    });
    letters.collect()
}

#[test]
fn no_retired_name_is_declared() {
    let files: BTreeMap<String, &str> = RETIRED.iter().map(|(name, today)| (file_name(name), *today)).collect();
    // A window is that of the screen; on a rig of devices the scenarios of `tests/rig` are played.
    let retired_file = |name: &str| files.get(name).filter(|_| !matches!(name, "window" | "rig"));
    let mut wrong = Vec::new();
    for (file, text) in sources_and_tests() {
        for part in file.trim_end_matches(".rs").split('/') {
            wrong.extend(retired_file(part).map(|today| format!("{file}: a file named {part} is retired: {today}")));
        }
        for (keyword, name) in declared(&tokens(&text)) {
            let homonym = HOMONYMS.iter().any(|(at, word, _)| *at == file && *word == name);
            let by_name = RETIRED.iter().find(|(retired, _)| *retired == name && !homonym).map(|(_, today)| today);
            let today = by_name.or_else(|| retired_file(name).filter(|_| keyword == "mod"));
            wrong.extend(today.map(|today| format!("{file}: {keyword} {name} is retired: {today}")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The retired words among the tokens of a text, and what stands in their place.
fn retired_words(text: &str) -> Vec<(&'static str, &'static str)> {
    let tokens: BTreeSet<&str> = tokens(text).into_iter().collect();
    RETIRED_WORDS.iter().copied().filter(|(word, _)| tokens.contains(word)).collect()
}

#[test]
fn no_variable_or_field_has_a_retired_name() {
    let mut wrong = Vec::new();
    for (file, text) in files("src") {
        wrong.extend(
            retired_words(&text).into_iter().map(|(word, today)| format!("{file}: {word} is retired: {today}")),
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn retired_words_are_found_in_code_alone() {
    let text = "// the post\nfn f(frames: &str) { let part = self.did.or(\"a USB stick\"); let frames_shown = 1; }";
    assert_eq!(retired_words(text).into_iter().map(|(word, _)| word).collect::<Vec<_>>(), ["frames", "did"]);
}

#[test]
fn no_two_types_have_the_same_name() {
    let mut defined: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (file, text) in files("src") {
        for name in types(&tokens(&text)) {
            defined.entry(name.to_owned()).or_default().push(file.clone());
        }
    }
    defined.retain(|_, files| files.len() > 1);
    assert!(defined.is_empty(), "types with the same name: {defined:#?}");
}

#[test]
fn every_homonym_is_still_there() {
    for (file, word, meaning) in HOMONYMS {
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
        let found = declared(&tokens(&text)).iter().any(|(_, name)| name == word);
        assert!(found, "{file} declares no {word} ({meaning})");
    }
}

/// The documents that name modules, types, functions and files.
const DOCUMENTS: &[&str] = &["docs/architecture.md", "CONTRIBUTING.md", "src/lib.rs"];

/// The names and paths between single back quotes in a text, without its code blocks.
fn quoted_names(text: &str) -> Vec<&str> {
    let mut fenced = false;
    let lines = text.lines().filter(|line| {
        let fence = line.trim_start_matches("//!").trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    });
    let spans = lines.flat_map(|line| line.split('`').skip(1).step_by(2));
    spans
        .filter(|span| span.starts_with(|sign: char| sign.is_alphabetic() || sign == '.') && !span.contains(' '))
        .collect()
}

#[test]
fn documents_name_what_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut known = BTreeSet::new();
    for (file, text) in sources_and_tests() {
        known.extend(tokens(&text).into_iter().map(str::to_owned));
        known.extend(file.trim_end_matches(".rs").split('/').map(str::to_owned));
    }
    let mut wrong = Vec::new();
    for document in DOCUMENTS {
        let text = fs::read_to_string(root.join(document)).unwrap();
        for name in quoted_names(&text) {
            let path = name.contains('/') || name.starts_with('.');
            let words = name.split(|sign: char| !sign.is_alphanumeric() && sign != '_').filter(|word| is_word(word));
            if path && !root.join(name).exists() {
                wrong.push(format!("{document}: there is no file {name}"));
            } else if !path {
                let unknown = words.filter(|word| !known.contains(*word));
                wrong.extend(unknown.map(|word| format!("{document}: there is no {word} ({name})")));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_file_is_named_like_its_type() {
    assert_eq!(["ScrewTable", "Post", "by_hand"].map(file_name), ["screw_table", "post", "by_hand"]);
}

#[test]
fn names_are_taken_from_between_back_quotes() {
    let text = "see `a::B` and `src/lib.rs`, not `cargo run`\n```\n`code`\n```\n`.ci/run`, `#100`";
    assert_eq!(quoted_names(text), ["a::B", "src/lib.rs", ".ci/run"]);
}
