//! Programs in the manner of other controls (`tests/nc/foreign`): each gets the verdict of `check` that its row in
//! `verdicts.txt` names (rows B1, T4, S1).

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::command::kt830_in;

/// A row of `verdicts.txt`.
#[derive(Debug)]
struct Row {
    path: String,
    kind: String,
    verdict: Verdict,
}

/// What `check` must say.
#[derive(Debug)]
enum Verdict {
    Accept,
    /// The first error: its line, and words of its message.
    Refuse(u32, Vec<String>),
    /// No error, but a warning: its line, and words of its message.
    Warn(u32, Vec<String>),
}

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/nc/foreign")
}

/// The rows of `verdicts.txt`: path | kind | verdict | line | words of the message | why.
fn rows() -> Vec<Row> {
    let text = std::fs::read_to_string(corpus().join("verdicts.txt")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.splitn(6, '|').map(str::trim).collect();
        let [path, kind, verdict, at, words, _why] = cells[..] else { panic!("not a row: {line}") };
        let words = || words.split(',').filter(|word| *word != "-").map(str::to_lowercase).collect();
        let verdict = match verdict {
            "accept" => Verdict::Accept,
            "refuse" => Verdict::Refuse(at.parse().unwrap(), words()),
            "warn" => Verdict::Warn(at.parse().unwrap(), words()),
            other => panic!("no verdict: {other}"),
        };
        Row { path: path.to_owned(), kind: kind.to_owned(), verdict }
    };
    text.lines().filter(|line| !line.starts_with('#') && !line.is_empty()).map(row).collect()
}

/// The rows that are not fulfilled yet: path and kind, one in a line.
fn known_shortfalls() -> BTreeSet<String> {
    let text = std::fs::read_to_string(corpus().join("lacking.txt")).unwrap();
    text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect()
}

/// Whether a message stands at a line and has all words. The line follows the name of the checked file, or that of a
/// program that it calls.
fn tells(message: &str, line: u32, words: &[String]) -> bool {
    let lower = message.to_lowercase();
    message.contains(&format!(":{line}:")) && words.iter().all(|word| lower.contains(word.as_str()))
}

/// Checks a program in its folder. `Err` says what `check` said instead.
fn judge(row: &Row, data: &Path) -> Result<(), String> {
    let path = corpus().join(&row.path);
    let folder = path.parent().unwrap();
    let arguments = ["check", "--lang", "en", "--kind", &row.kind, "--programs", folder.to_str().unwrap()];
    let words = [&arguments[..], &[path.to_str().unwrap()]].concat();
    let out = kt830_in(Path::new(env!("CARGO_MANIFEST_DIR")), data, &words);
    let (said, warned) = (String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
    let is_right = match &row.verdict {
        Verdict::Accept => out.status.success(),
        Verdict::Refuse(line, words) => {
            out.status.code() == Some(2) && said.lines().next().is_some_and(|first| tells(first, *line, words))
        }
        Verdict::Warn(line, words) => out.status.success() && warned.lines().any(|told| tells(told, *line, words)),
    };
    is_right.then_some(()).ok_or_else(|| format!("{} on {}: {:?}\n{said}{warned}", row.path, row.kind, row.verdict))
}

#[test]
fn b1_programs_of_other_controls_get_the_verdict_of_their_row() {
    let (rows, shortfalls) = (rows(), known_shortfalls());
    assert!(rows.len() >= 60, "{} rows", rows.len());
    let data = tempfile::tempdir().unwrap();
    let name = |row: &Row| format!("{} {}", row.path, row.kind);
    let names: BTreeSet<_> = rows.iter().map(name).collect();
    assert!(shortfalls.is_subset(&names), "not in verdicts.txt: {:?}", shortfalls.difference(&names));
    let mut wrong = Vec::new();
    for row in &rows {
        match (judge(row, data.path()), shortfalls.contains(&name(row))) {
            (Err(told), false) => wrong.push(told),
            (Ok(()), true) => wrong.push(format!("{} is right now: take it out of lacking.txt", name(row))),
            (Ok(()), false) | (Err(_), true) => {}
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), rows.len(), wrong.join("\n"));
}

/// Every program of the folder has a row.
#[test]
fn t4_every_program_of_other_controls_has_a_verdict() {
    let rows: BTreeSet<_> = rows().into_iter().map(|row| row.path).collect();
    for folder in std::fs::read_dir(corpus()).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()) {
        for file in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            let path = file.strip_prefix(corpus()).unwrap().to_str().unwrap().replace('\\', "/");
            assert!(rows.contains(&path), "{path} has no row in verdicts.txt");
        }
    }
}
