//! The rows of `docs/requirements/` against what names them: `Source:` lines, comments and tables of `src/`, the names of
//! tests. Writes `docs/requirements/traceability.md` anew and fails when it was not up to date, when something cites a
//! row that is not there, and when nothing shows a row.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The files that define rows, in the order of the table.
const FILES: &[&str] = &["kt830", "base-control", "superman-lathe", "sinumerik-802d", "hmi", "simulator", "tools"];

/// The letters that rows begin with.
const LETTERS: &str = "KBLSHPT";

/// The letters that name nothing else in a comment: P, L, S and T are parameters and words of a program, too.
const PLAIN_LETTERS: &str = "KBH";

/// Rows that neither code nor a test names, and why not.
const WITHOUT: &[(&str, &str)] = &[
    ("K5.1", "the customer says it twice: K3.5, K3.6 and K3.7"),
    ("K5.2", "the customer says it twice: K3.3 and K3.11"),
    ("K5.4", "the customer says it twice: K2.2"),
    ("K5.6", "the customer says it twice: K3.3"),
    ("K5.7", "the customer says it twice: K3.3"),
    ("K8", "a title: its contents are the rows B"),
];

/// A row: a heading of a file.
struct Row {
    id: String,
    /// What stands behind the id.
    title: String,
    /// File and place of the heading, for a link.
    link: String,
}

/// What names the rows. Paths are below the repository.
struct Survey {
    rows: Vec<Row>,
    /// Row → source files.
    code: BTreeMap<String, BTreeSet<String>>,
    /// Row → file → tests, in the order of the file.
    tests: BTreeMap<String, BTreeMap<String, Vec<String>>>,
    /// File → tests without a row.
    free: BTreeMap<String, Vec<String>>,
    /// Citations of rows that are not there.
    wrong: Vec<String>,
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn requirements() -> PathBuf {
    root().join("docs/requirements")
}

/// `K3.7`, `B5`: a letter, a number of one or two digits, and for K a second one.
fn is_id(word: &str) -> bool {
    let Some(letter) = word.chars().next().filter(|letter| LETTERS.contains(*letter)) else { return false };
    let number = |text: &str| {
        (1..=2).contains(&text.len()) && !text.starts_with('0') && text.bytes().all(|sign| sign.is_ascii_digit())
    };
    let (part, row) = word[1..].split_once('.').map_or((&word[1..], None), |(part, row)| (part, Some(row)));
    number(part) && row.is_none_or(|row| letter == 'K' && number(row))
}

/// Where ids stand in a text. `P6.4` and `P270` are parameters, `B0001` is a picture.
fn ids_in(text: &str) -> Vec<Range<usize>> {
    let bytes = text.as_bytes();
    let word = |at: usize| bytes.get(at).is_some_and(|sign| sign.is_ascii_alphanumeric() || *sign == b'_');
    let digits = |at: usize| bytes[at..].iter().take_while(|sign| sign.is_ascii_digit()).count();
    let mut found = Vec::new();
    for (start, sign) in bytes.iter().enumerate() {
        let begins = start == 0 || !(word(start - 1) || b"#.".contains(&bytes[start - 1]));
        if !begins || !sign.is_ascii_uppercase() {
            continue;
        }
        let mut end = start + 1 + digits(start + 1);
        if bytes.get(end) == Some(&b'.') && digits(end + 1) > 0 {
            end += 1 + digits(end + 1);
        }
        if !word(end) && is_id(&text[start..end]) {
            found.push(start..end);
        }
    }
    found
}

/// The rows from one to another of the same kind: `K7.2–K7.4` is three rows.
fn between(first: &str, last: &str, rows: &[Row]) -> Vec<String> {
    let place = |id: &str| rows.iter().position(|row| row.id == id);
    let (Some(from), Some(to)) = (place(first), place(last)) else { return Vec::new() };
    let all = rows.iter().skip(from).take((to + 1).saturating_sub(from));
    all.filter(|row| row.id.contains('.') == first.contains('.')).map(|row| row.id.clone()).collect()
}

/// The ids of a text that `counts` lets through, ranges written out.
fn cited_in(text: &str, rows: &[Row], counts: impl Fn(&str, &Range<usize>) -> bool) -> Vec<String> {
    let ids = ids_in(text);
    let mut found = Vec::new();
    for (at, id) in ids.iter().enumerate().filter(|(_, id)| counts(text, id)) {
        let name = &text[id.clone()];
        let begin = at.checked_sub(1).map(|before| ids[before].clone());
        if let Some(begin) = begin.filter(|begin| text.get(begin.end..id.start) == Some("–")) {
            found.extend(between(&text[begin], name, rows));
        }
        found.push(name.to_owned());
    }
    found
}

/// Whether an id in a comment means a row: by its letter, or because it stands in brackets that begin with an id.
fn means_a_row(text: &str, id: &Range<usize>) -> bool {
    if text[id.clone()].starts_with(|letter: char| PLAIN_LETTERS.contains(letter)) {
        return true;
    }
    let Some((_, inside)) = text[..id.start].rsplit_once('(') else { return false };
    let words = ["rows ", "spec ", "tools.md "];
    let inside = words.iter().find_map(|word| inside.strip_prefix(word)).unwrap_or(inside);
    !inside.contains(')') && (inside.is_empty() || ids_in(inside).first().is_some_and(|first| first.start == 0))
}

/// The text of a comment on a line.
fn comment(line: &str) -> Option<&str> {
    let text = line.trim_start();
    if text.starts_with("//") {
        return Some(text.trim_start_matches(['/', '!']).trim());
    }
    line.split_once(" // ").map(|(_, text)| text.trim())
}

/// The sentence behind `Source:` that begins on a line; it may go on over the next ones.
fn source(lines: &[&str], at: usize) -> Option<String> {
    let (_, first) = comment(lines[at])?.split_once("Source: ")?;
    let mut text = first.to_owned();
    let mut next = lines[at + 1..].iter();
    while !text.contains(". ") && !text.ends_with('.') {
        let more = next.next().filter(|line| line.trim_start().starts_with("//")).and_then(|line| comment(line));
        let Some(more) = more.filter(|more| !more.is_empty()) else { break };
        text = format!("{text} {more}");
    }
    Some(text.split(". ").next().unwrap_or_default().to_owned())
}

/// The rows that the fields of a table name: `row: "B5"`, `3, "K3.1", true`.
fn fields(line: &str) -> Vec<String> {
    let pieces: Vec<&str> = line.split('"').collect();
    let of_a_table = |piece: &&[&str]| {
        is_id(piece[1]) && (piece[0].ends_with("row: ") || piece[0].ends_with(", ")) && piece[2].starts_with(',')
    };
    pieces.windows(3).filter(of_a_table).map(|piece| piece[1].to_owned()).collect()
}

/// Names of the tests of a file, in its order.
fn tests_of(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut waiting = false;
    for line in text.lines().map(str::trim) {
        waiting |= line == "#[test]";
        if let Some(rest) = line.strip_prefix("fn ").filter(|_| waiting) {
            found.push(rest.chars().take_while(|sign| sign.is_alphanumeric() || *sign == '_').collect());
            waiting = false;
        }
    }
    found
}

/// An id as a name of a test writes it, from a place of the name's words on, and how many words it takes.
fn id_of_words(words: &[&str]) -> Option<(String, usize)> {
    let first = words.first()?.to_ascii_uppercase();
    let is_number = |word: &&&str| !word.is_empty() && word.bytes().all(|sign| sign.is_ascii_digit());
    let second = words.get(1).filter(is_number);
    let digits = first.strip_prefix(|letter: char| LETTERS.contains(letter))?;
    if digits.is_empty() || !digits.bytes().all(|sign| sign.is_ascii_digit()) {
        return None;
    }
    match second {
        Some(second) if first.starts_with('K') => Some((format!("{first}.{second}"), 2)),
        _ => Some((first, 1)),
    }
}

/// The rows that the name of a test begins with. The first may be no row at all: the caller looks.
fn rows_of_name(name: &str, rows: &[Row]) -> Vec<String> {
    let words: Vec<&str> = name.split('_').collect();
    let Some((first, mut at)) = id_of_words(&words) else { return Vec::new() };
    let mut found = vec![first];
    loop {
        let range = words.get(at) == Some(&"to");
        let Some((id, length)) = id_of_words(&words[(at + usize::from(range)).min(words.len())..]) else { break };
        at += usize::from(range) + length;
        // A number behind another letter than K is a bit of a parameter: p6_4.
        let bit = length == 1 && words.get(at).is_some_and(|word| word.bytes().all(|sign| sign.is_ascii_digit()));
        if bit || !rows.iter().any(|row| row.id == id) {
            break;
        }
        if range {
            let last = found.last().cloned().unwrap_or_default();
            found.extend(between(&last, &id, rows).into_iter().skip(1));
        } else {
            found.push(id);
        }
    }
    found
}

fn files_in(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files_in(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// Path below the repository → text, of all Rust files of a folder.
fn rust_files(folder: &str) -> BTreeMap<String, String> {
    let named = |path: PathBuf| {
        let name = path.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/");
        (name, fs::read_to_string(path).unwrap())
    };
    files_in(&root().join(folder)).into_iter().map(named).collect()
}

/// The name that a heading has in a link: letters and digits in lower case, blanks as hyphens.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|sign| sign.is_alphanumeric() || " -_".contains(*sign));
    kept.flat_map(char::to_lowercase).map(|sign| if sign == ' ' { '-' } else { sign }).collect()
}

fn rows() -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for file in FILES {
        let text = fs::read_to_string(requirements().join(format!("{file}.md"))).unwrap();
        for line in text.lines().filter(|line| line.starts_with('#')) {
            let heading = line.trim_start_matches('#').trim();
            let (id, title) = heading.split_once(' ').unwrap_or((heading, ""));
            if is_id(id) {
                assert!(!rows.iter().any(|row| row.id == id), "{file}.md: {id} stands twice");
                let link = format!("{file}.md#{}", anchor(heading));
                rows.push(Row { id: id.to_owned(), title: title.to_owned(), link });
            }
        }
    }
    rows
}

impl Survey {
    fn new() -> Self {
        let mut survey = Self {
            rows: rows(),
            code: BTreeMap::new(),
            tests: BTreeMap::new(),
            free: BTreeMap::new(),
            wrong: Vec::new(),
        };
        for folder in ["src", "tests", "benches", "examples"] {
            for (file, text) in rust_files(folder) {
                survey.read_code(&file, &text, folder == "src");
                survey.read_tests(&file, &text);
            }
        }
        survey
    }

    fn has(&self, id: &str) -> bool {
        self.rows.iter().any(|row| row.id == id)
    }

    /// Citations in comments and tables; those of `src` are kept, those of `Source:` lines are looked at everywhere.
    fn read_code(&mut self, file: &str, text: &str, keep: bool) {
        let lines: Vec<&str> = text.lines().collect();
        for (number, line) in lines.iter().enumerate() {
            let sources = source(&lines, number).map(|text| cited_in(&text, &self.rows, |_, _| true));
            let mut cited = sources.unwrap_or_default();
            for id in &cited {
                if !self.has(id) {
                    self.wrong.push(format!("{file}:{}: {id} is no row", number + 1));
                }
            }
            cited.extend(comment(line).map_or_else(|| fields(line), |text| cited_in(text, &self.rows, means_a_row)));
            cited.retain(|id| keep && self.has(id));
            for id in cited {
                self.code.entry(id).or_default().insert(file.to_owned());
            }
        }
    }

    fn read_tests(&mut self, file: &str, text: &str) {
        for name in tests_of(text) {
            let rows = rows_of_name(&name, &self.rows);
            if rows.is_empty() {
                self.free.entry(file.to_owned()).or_default().push(name.clone());
            }
            for id in rows {
                if !self.has(&id) {
                    self.wrong.push(format!("{file}: {name}: {id} is no row"));
                }
                self.tests.entry(id).or_default().entry(file.to_owned()).or_default().push(name.clone());
            }
        }
    }

    /// The table and the lists below it.
    fn text(&self) -> String {
        let mut text = String::from(
            "# Traceability\n\nRow → source files that cite it → tests that are named by it. Written by \
             `tests/cli/requirements.rs`; do not edit. [README.md](README.md) says how citations are read. The number behind \
             a file of tests is how many of them there are; their names stand below the table.\n\n\
             | row | requirement | code, below `src/` | tests |\n|---|---|---|---|\n",
        );
        for row in &self.rows {
            let code: Vec<String> = self.code.get(&row.id).into_iter().flatten().map(|file| short(file)).collect();
            let files = self.tests.get(&row.id).into_iter().flatten();
            let tests: Vec<String> = files.map(|(file, names)| format!("`{file}` {}", names.len())).collect();
            let (code, tests) = (or_dash(&code), or_dash(&tests));
            writeln!(text, "| [{}]({}) | {} | {code} | {tests} |", row.id, row.link, row.title).unwrap();
        }
        text.push_str("\n## Rows without code or test\n\n");
        for (id, reason) in WITHOUT {
            writeln!(text, "- {id}: {reason}").unwrap();
        }
        text.push_str("\n## Tests by row\n");
        for row in &self.rows {
            if let Some(files) = self.tests.get(&row.id) {
                writeln!(text, "\n### {} tests\n", row.id).unwrap();
                list(&mut text, files);
            }
        }
        text.push_str(
            "\n## Tests without a row\n\nThey hold what every row relies on: limits of motion, files, house rules.\n\n",
        );
        list(&mut text, &self.free);
        text
    }
}

fn short(file: &str) -> String {
    format!("`{}`", file.strip_prefix("src/").unwrap_or(file))
}

fn or_dash(words: &[String]) -> String {
    if words.is_empty() { "–".to_owned() } else { words.join(", ") }
}

fn list(text: &mut String, files: &BTreeMap<String, Vec<String>>) {
    for (file, names) in files {
        writeln!(text, "- `{file}`").unwrap();
        for name in names {
            writeln!(text, "  - `{name}`").unwrap();
        }
    }
}

#[test]
fn what_is_cited_is_a_row() {
    let wrong = Survey::new().wrong;
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_row_has_code_or_a_test_or_a_reason() {
    let survey = Survey::new();
    let mut wrong = Vec::new();
    for row in &survey.rows {
        let shown = survey.code.contains_key(&row.id) || survey.tests.contains_key(&row.id);
        let excused = WITHOUT.iter().any(|(id, _)| *id == row.id);
        if !shown && !excused {
            wrong.push(format!("{}: neither code nor a test names it", row.id));
        }
        if shown && excused {
            wrong.push(format!("{}: it is named now, so it needs no reason", row.id));
        }
    }
    wrong.extend(WITHOUT.iter().filter(|(id, _)| !survey.has(id)).map(|(id, _)| format!("{id} is no row")));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_decision_names_its_rows() {
    let rows = rows();
    let mut wrong = Vec::new();
    for entry in fs::read_dir(requirements().join("decisions")).unwrap() {
        let path = entry.unwrap().path();
        let file = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate().filter(|(_, line)| line.starts_with("- ")) {
            let named = line.strip_suffix(']').and_then(|line| line.rsplit_once('[')).map_or("", |(_, named)| named);
            let whole =
                !named.is_empty() && named.split([',', '–']).all(|id| rows.iter().any(|row| row.id == id.trim()));
            if !whole {
                wrong.push(format!("decisions/{file}:{}: ends with no row", number + 1));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_table_of_rows_code_and_tests_is_up_to_date() {
    let path = requirements().join("traceability.md");
    let wanted = Survey::new().text();
    let present = fs::read_to_string(&path).unwrap_or_default();
    if present != wanted {
        fs::write(&path, wanted).unwrap();
        panic!("docs/requirements/traceability.md was not up to date; it has been written anew");
    }
}
