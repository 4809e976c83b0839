//! Languages that files add to Chinese and English. Source: spec H9.
//!
//! The table of all texts, from which a language file is begun, comes from the sources: this test writes it anew and fails
//! when it was not up to date.

use std::collections::HashSet;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use kt830::defs::page_text;
use kt830::defs::text::{LanguageFile, Translation, TranslationRow};
use kt830::store::AddedLanguages;

use crate::command::kt830;
use crate::structure::tokens::{with_strings, without_tests};

/// Chinese and English of a text.
type Pair = (String, String);

/// The files below a folder of the repository with one of these endings, by name.
fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let (mut found, mut open) = (Vec::new(), vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)]);
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let ending = path.extension().map(|ending| ending.to_string_lossy().into_owned()).unwrap_or_default();
            match path.is_dir() {
                true => open.push(path),
                false => found.extend(endings.contains(&ending.as_str()).then_some(path)),
            }
        }
    }
    found.sort();
    found
}

/// Whether a text is Chinese: ideographs, or the signs of Chinese text.
fn is_chinese(text: &str) -> bool {
    text.chars().any(|sign| matches!(sign, '\u{3000}'..='\u{9FFF}' | '\u{FF00}'..='\u{FFEF}'))
}

/// The text that a string of the sources stands for.
fn value(literal: &str) -> String {
    // A line that goes on in the next one.
    let mut parts = literal.split("\\\n");
    let mut joined = parts.next().unwrap_or_default().to_owned();
    parts.for_each(|part| joined.push_str(part.trim_start()));
    ron::from_str(&joined).unwrap_or_else(|fault| panic!("{literal}: {fault}"))
}

/// Pairs of a Chinese string and the English one behind it.
fn of_source(text: &str, out: &mut Vec<Pair>) {
    let tokens = without_tests(&with_strings(text));
    let mut at = 0;
    while at < tokens.len() {
        let zh = tokens[at];
        at += 1;
        if !zh.starts_with('"') || !is_chinese(zh) {
            continue;
        }
        let behind = at + usize::from(tokens.get(at) == Some(&","));
        if let Some(en) = tokens.get(behind).filter(|token| token.starts_with('"') && !is_chinese(token)) {
            out.push((value(zh), value(en)));
            at = behind + 1;
        }
    }
}

/// Labels and titles of the page texts.
fn of_pages(out: &mut Vec<Pair>) {
    for english in files("screens", &["TXT"]).iter().filter(|path| path.to_string_lossy().ends_with(".EN.TXT")) {
        let text = |path: &Path| encoding_of(&fs::read(path).unwrap());
        let own = english.to_string_lossy().replace(".EN.TXT", ".TXT");
        let (mut page, english) = (page_text::parse(&text(Path::new(&own))).unwrap(), text(english));
        page.add_english(&page_text::parse(&english).unwrap());
        out.extend(page.english_title.clone().map(|title| (page.title.clone(), title)));
        out.extend(page.rows().filter_map(|row| Some((row.label.clone(), row.english.clone()?))));
    }
}

fn encoding_of(bytes: &[u8]) -> String {
    kt830::store::decode(bytes).unwrap().text.to_string()
}

/// Titles and messages of the programs: the rows `EN:`, `CAUSE:` and `REMEDY:` with what they stand for.
fn of_programs(out: &mut Vec<Pair>) {
    for path in files("programs", &["NC", "MPF", "SPF"]) {
        let text = encoding_of(&fs::read(path).unwrap());
        let comments = text.split(['(', '\n']).map(|part| part.split(')').next().unwrap());
        let comments: Vec<_> = comments.map(|part| part.trim_start_matches([';', ' ']).trim()).collect();
        let title = |mark: &str| comments.iter().find_map(|part| part.strip_prefix(mark)).map(str::trim);
        let own = comments.iter().find(|part| is_chinese(part));
        out.extend(own.zip(title("EN:")).map(|(zh, en)| ((*zh).to_owned(), en.to_owned())));
        for number in comments.iter().filter_map(|part| part.strip_prefix("#3000=")?.split(' ').next()) {
            let row = |mark: &str| {
                let row = comments.iter().filter(|part| part.starts_with(&format!("#3000={number} ")));
                row.filter_map(|part| part.split_once(mark)).map(|(_, text)| text.trim().to_owned()).next()
            };
            let shown = text.split(&format!("#3000={number}(")).nth(1).and_then(|rest| rest.split(')').next());
            out.extend(shown.map(str::to_owned).zip(row("EN:")));
            out.extend(row("原因:").zip(row("CAUSE:")));
            out.extend(row("处理:").zip(row("REMEDY:")));
        }
        for message in text.split(";MSG(\"").skip(1) {
            let row = message.lines().next().and_then(|row| row.split_once("\")"));
            out.extend(
                row.and_then(|(zh, rest)| Some((zh.to_owned(), rest.trim().strip_prefix("EN:")?.trim().to_owned()))),
            );
        }
    }
}

/// The table as it should be.
fn table() -> String {
    let mut pairs = Vec::new();
    files("src", &["rs"]).iter().for_each(|path| of_source(&fs::read_to_string(path).unwrap(), &mut pairs));
    of_pages(&mut pairs);
    of_programs(&mut pairs);
    let mut seen = HashSet::new();
    pairs.retain(|pair| seen.insert(pair.clone()));
    let mut out = String::from("// Texts of the control, Chinese and English. Written by a test; do not edit.\n[\n");
    for (zh, en) in pairs {
        writeln!(out, "    ({zh:?}, {en:?}),").unwrap();
    }
    out + "]\n"
}

#[test]
fn h9_the_table_of_texts_is_that_of_the_sources() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/text/texts.ron");
    let (wanted, present) = (table(), fs::read_to_string(&path).unwrap_or_default());
    if present != wanted {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, wanted).unwrap();
        panic!("assets/text/texts.ron was not up to date; it has been written anew");
    }
}

fn row(zh: &str, en: &str, words: &str) -> TranslationRow {
    TranslationRow(zh.to_owned(), en.to_owned(), words.to_owned())
}

fn german(texts: Vec<TranslationRow>) -> LanguageFile {
    LanguageFile { code: "de".to_owned(), name: "Deutsch".to_owned(), texts }
}

fn output(words: &[&str]) -> (i32, String, String) {
    let output = kt830(words);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
fn h9_a_language_file_is_begun_and_brought_up_to_date() {
    let (code, empty, _) = output(&["texts"]);
    let all: LanguageFile = ron::from_str(&empty).unwrap();
    assert_eq!(code, 0);
    assert!(all.texts.iter().all(|TranslationRow(.., words)| words.is_empty()));
    assert!(
        all.texts.contains(&row("取消", "CANCEL", "")) && all.texts.contains(&row("成品直径", "finished diameter", ""))
    );

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("de.ron");
    // A text of the control with words, one without, and one of the customer's own page.
    let own = row("我的直径", "", "mein Durchmesser");
    let file = german(vec![row("取消", "CANCEL", "ABBRECHEN"), own.clone()]);
    fs::write(&path, ron::to_string(&file).unwrap()).unwrap();
    let (code, text, told) = output(&["texts", path.to_str().unwrap()]);
    let updated: LanguageFile = ron::from_str(&text).unwrap();
    assert_eq!(code, 0, "{told}");
    assert_eq!((updated.code.as_str(), updated.name.as_str()), ("de", "Deutsch"));
    assert!(updated.texts.contains(&row("取消", "CANCEL", "ABBRECHEN")));
    assert_eq!((updated.texts.len(), updated.texts.last()), (all.texts.len() + 1, Some(&own)));
    assert!(told.contains(&format!("1 of {} texts have words; 1 rows", all.texts.len())), "{told}");
    // Once more it is the same.
    fs::write(&path, &text).unwrap();
    assert_eq!(output(&["texts", path.to_str().unwrap()]).1, text);
}

#[test]
fn h9_what_is_wrong_with_a_language_file_is_told() {
    let made = |code: &str, name: &str, texts| {
        Translation::new(LanguageFile { code: code.to_owned(), name: name.to_owned(), texts })
    };
    for (code, name, told) in [
        ("en", "English", "small letters"),
        ("D", "Deutsch", "small letters"),
        ("de", "", "1 to 10 characters"),
        ("de", "a name that is far too long", "1 to 10 characters"),
    ] {
        assert!(made(code, name, Vec::new()).unwrap_err().en().contains(told), "{code} {name}");
    }
    let texts = vec![
        row("轴 {axis}", "axis {axis}", "Achse {achse}"),
        row("轴 {axis} {value}", "axis {axis} {value:.3}", "{value:.3} auf Achse {axis}"),
        // Another form of a number would round a limit, or stop the screen.
        row("限位 {limit:.3}", "limit {limit:.3}", "Grenze {limit:.0}"),
        row("限 {limit:.3}", "limit {limit:.3}", "Grenze {limit:.99999}"),
        row("关", "off", "aus"),
        row("关", "off", "zu"),
        row("断开", "off", "getrennt"),
    ];
    let (language, faults) = made("de", "Deutsch", texts).unwrap();
    let faults: Vec<_> = faults.iter().map(|fault| fault.en().into_owned()).collect();
    assert_eq!(faults.len(), 4, "{faults:?}");
    assert!(faults[0].contains("'Achse {achse}' has other placeholders than 'axis {axis}'"), "{faults:?}");
    assert!(faults[1].contains("{limit:.0}") && faults[2].contains("{limit:.99999}"), "{faults:?}");
    assert!(faults[3].contains("'关' has two rows"), "{faults:?}");
    // The first of two rows holds; the same English has other words where the Chinese differs.
    assert_eq!(language.find("关", "off"), Some("aus"));
    assert_eq!(language.find("断开", "off"), Some("getrennt"));
    assert_eq!(language.find("轴 {axis}", "axis {axis}"), None);
    assert_eq!(language.find("轴 {axis} {value}", "axis {axis} {value:.3}"), Some("{value:.3} auf Achse {axis}"));
}

#[test]
fn h9_files_of_a_folder_are_languages_or_faults_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let none = AddedLanguages::read(&folder.path().join("none"));
    assert!(none.faults.is_empty() && none.languages.len() == 1 && none.languages[0].words().count() > 1_000);
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    for (name, code) in [("1.ron", "de"), ("2.ron", "de"), ("4.RON", "ru"), ("5.ron", "fr"), ("6.ron", "it")] {
        write(name, &format!("(code: {code:?}, name: {code:?}, texts: [])"));
    }
    write("3.ron", "(code: \"pl\",\n  name: 7, texts: [])");
    write("notes.txt", "not a language");
    // Two files beside the shipped languages: none of those is pushed out.
    let two = tempfile::tempdir().unwrap();
    for code in ["ru", "fr"] {
        let text = format!("(code: {code:?}, name: {code:?}, texts: [])");
        fs::write(two.path().join(format!("{code}.ron")), text).unwrap();
    }
    let all = AddedLanguages::read(two.path());
    let codes: Vec<_> = all.languages.iter().map(|language| language.code.as_str()).collect();
    assert_eq!((codes, all.faults.len()), (vec!["fr", "ru", "de"], 0));
    let AddedLanguages { languages, faults } = AddedLanguages::read(folder.path());
    let codes: Vec<_> = languages.iter().map(|language| language.code.as_str()).collect();
    assert_eq!(codes, ["de", "ru"]);
    // The file of the folder holds before the shipped one.
    assert_eq!(languages[0].words().count(), 0);
    let faults: Vec<_> = faults.iter().map(|fault| fault.en().into_owned()).collect();
    for (index, told) in [(0, "2.ron: the language 'de' is there already"), (1, "3.ron line 2"), (2, "at most 2")] {
        assert!(faults[index].contains(told), "{faults:?}");
    }
}

#[test]
fn h9_the_command_line_speaks_a_language_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = german(vec![row("快速定位", "rapid traverse", "Eilgang")]);
    fs::write(folder.path().join("de.ron"), ron::to_string(&file).unwrap()).unwrap();
    let languages = folder.path().to_str().unwrap();
    let (code, text, told) = output(&["codes", "--lang", "de", "--languages", languages]);
    assert_eq!((code, told.as_str()), (0, ""));
    assert!(text.contains("Eilgang"), "{text}");
    // What the file lacks is English.
    assert!(!is_chinese(&text), "{text}");

    // One that comes with the control needs no file.
    let (code, text, _) = output(&["codes", "--lang", "de"]);
    assert!(code == 0 && !is_chinese(&text) && !text.contains("rapid traverse"), "{text}");

    let (code, _, told) = output(&["codes", "--lang", "fr", "--languages", languages]);
    assert_eq!(code, 2);
    assert!(told.contains("--lang fr: the languages are zh, en, de; others are files in"), "{told}");
    let (code, _, told) = output(&["codes", "--languages", "no-such-folder"]);
    assert!(code == 2 && told.contains("--languages no-such-folder: there is no such folder"), "{told}");
}

/// The shipped languages: no row is wrong, every character is in the font, and no row is for a text that is gone.
#[test]
fn h9_the_shipped_languages_are_whole() {
    for path in files("assets/text", &["ron"]).iter().filter(|path| !path.ends_with("texts.ron")) {
        let (code, text, told) = output(&["texts", path.to_str().unwrap()]);
        assert!(code == 0 && told.lines().count() == 1 && told.contains("; 0 rows are for texts"), "{told}");
        let all: LanguageFile = ron::from_str(&text).unwrap();
        let empty = all.texts.iter().filter(|TranslationRow(.., words)| words.is_empty()).count();
        // New texts may wait for their words; a language that lacks a tenth is none any more.
        assert!(empty * 10 < all.texts.len(), "{}: {empty} of {} have no words", path.display(), all.texts.len());
    }
}
