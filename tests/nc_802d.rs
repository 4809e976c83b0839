//! The language of the SINUMERIK 802D: programs and their operations side by side, and wrong programs with their errors
//! (row S1).

#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kt830::defs::program;
use kt830::defs::text::Lang;
use kt830::nc::{CheckWorld, Checked, Library, Memory, Settings, Source, check_with};

/// Subprograms of one folder, by number.
struct Folder(HashMap<u32, Arc<Source>>);

impl Library for Folder {
    fn find(&self, number: u32) -> Option<Arc<Source>> {
        self.0.get(&number).cloned()
    }
}

fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|found| found == extension));
    files.sort();
    files
}

fn source(path: &Path) -> Arc<Source> {
    let name = path.file_name().unwrap().to_str().unwrap();
    let number = program::number(program::stem(name));
    Arc::new(Source::new(number, name.to_uppercase(), std::fs::read(path).unwrap()))
}

fn run(source: &Arc<Source>) -> (String, Checked) {
    let settings = Settings::sinumerik();
    let subs = files("tests/nc/802d/sub", "SPF").iter().map(|path| source_of(path)).collect();
    let library: Arc<dyn Library + Send + Sync> = Arc::new(Folder(subs));
    let mut world = CheckWorld::new(&settings);
    let mut ops = String::new();
    let checked = check_with(source, &library, &settings, Memory::default(), &mut world, &mut |block| {
        let name = if block.at.program == source.number() { source.title() } else { program::title(block.at.program) };
        for op in &block.ops {
            ops.push_str(&format!("{name}:{} {op}\n", block.at.line));
        }
    });
    (ops, checked)
}

fn source_of(path: &Path) -> (u32, Arc<Source>) {
    let source = source(path);
    (source.number(), source)
}

/// What a text comes to, as one line a mistake.
fn mistakes(checked: &Checked) -> Vec<String> {
    checked
        .faults
        .iter()
        .map(|fault| format!("{}:{} {}", fault.place.line, fault.column, fault.cause(Lang::En)))
        .collect()
}

#[test]
fn s1_golden_programs_give_their_operations() {
    for path in files("tests/nc/802d", "MPF") {
        let (ops, checked) = run(&source(&path));
        assert_eq!(mistakes(&checked), [""; 0], "{}", path.display());
        let expected = std::fs::read_to_string(path.with_extension("ops")).unwrap_or_default();
        assert_eq!(ops, expected, "{}\n{ops}", path.display());
    }
}

/// The first line says what is wrong: `; line:column cause`, several parted by ` | `.
#[test]
fn s1_wrong_programs_name_every_error_with_line_and_column() {
    let mut wrong = Vec::new();
    for path in files("tests/nc/802d/bad", "MPF") {
        let (_, checked) = run(&source(&path));
        let text = std::fs::read_to_string(&path).unwrap();
        let expected = text.lines().next().unwrap().trim_start_matches([';', ' ']);
        let found = mistakes(&checked).join(" | ");
        if found != expected {
            wrong.push(format!("{}\nfound    {found}\nexpected {expected}", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
