//! `kt830 texts`: all texts of the control as a language file, empty or brought up to date. Source: spec H9.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

use super::args::{SharedArgs, TextsArgs};
use super::{CallError, FAILED, SUCCESS, print_line};
use crate::defs::text::{Lang, LanguageFile, Translation, TranslationRow};
use crate::store::ron_file::{self, ChecksumPolicy};

/// Chinese and English of every text, in the order of the sources; a test writes it.
const ALL: &str = include_str!("../../assets/text/texts.ron");

/// Prints the file of the call brought up to date, otherwise the language of the call (`--lang de`), otherwise one without
/// words. What is wrong with the file of the call goes to standard error.
///
/// # Errors
/// The file cannot be read.
pub fn texts(shared: &SharedArgs, call: &TextsArgs) -> Result<u8, CallError> {
    let all: Vec<(String, String)> = ron::from_str(ALL).map_err(CallError::at("texts.ron"))?;
    let Some(path) = &call.file else {
        print_line(written(&file_of(shared.lang, all)).trim_end());
        return Ok(SUCCESS);
    };
    let read = ron_file::read_newest::<LanguageFile>(path, ChecksumPolicy::Lenient).map_err(CallError::new)?;
    let is_right = tell_faults(path, &read)?;
    let updated = brought_up_to_date(path, read, all);
    print_line(written(&updated).trim_end());
    Ok(if is_right { SUCCESS } else { FAILED })
}

/// Every text with the words of an added language; the two languages of the control give no words.
fn file_of(lang: Lang, all: Vec<(String, String)>) -> LanguageFile {
    let (code, name, added) = match lang {
        Lang::Zh | Lang::En => ("xx".to_owned(), "Name".to_owned(), None),
        Lang::Added(added) => (added.code.clone(), added.name.clone(), Some(added)),
    };
    let words = |zh: &str, en: &str| added.and_then(|added| added.find(zh, en)).unwrap_or_default().to_owned();
    let row = |(zh, en): (String, String)| {
        let words = words(&zh, &en);
        TranslationRow(zh, en, words)
    };
    LanguageFile { code, name, texts: all.into_iter().map(row).collect() }
}

/// Tells what is wrong with the rows of a file; whether nothing is.
fn tell_faults(path: &Path, file: &LanguageFile) -> Result<bool, CallError> {
    let place = path.display();
    let (language, faults) =
        Translation::new(file.clone()).map_err(|why| CallError::new(format!("{place}: {}", why.en())))?;
    faults.iter().for_each(|fault| warn_line!("{place}: {}", fault.en()));
    let lacking = lacking_glyphs(&language);
    if !lacking.is_empty() {
        warn_line!("{place}: the font of the screen has no {lacking}: write it otherwise");
    }
    Ok(faults.is_empty() && lacking.is_empty())
}

/// Every text with the words that the file has for it, then the rows of the file for other texts.
fn brought_up_to_date(path: &Path, file: LanguageFile, all: Vec<(String, String)>) -> LanguageFile {
    let LanguageFile { code, name, texts } = file;
    let mut known: HashMap<_, _> = HashMap::new();
    for TranslationRow(zh, en, words) in &texts {
        known.entry((zh.clone(), en.clone())).or_insert_with(|| words.clone());
    }
    let rows = all.into_iter().map(|(zh, en)| {
        let words = known.remove(&(zh.clone(), en.clone())).unwrap_or_default();
        TranslationRow(zh, en, words)
    });
    let mut rows: Vec<_> = rows.collect();
    let (count, empty) = (rows.len(), rows.iter().filter(|TranslationRow(.., words)| words.trim().is_empty()).count());
    let own: Vec<_> =
        texts.into_iter().filter_map(|row| known.remove(&(row.0.clone(), row.1.clone())).map(|_| row)).collect();
    let (done, others, place) = (count - empty, own.len(), path.display());
    warn_line!(
        "{place}: {done} of {count} texts have words; {others} rows are for texts that the control does not have"
    );
    rows.extend(own);
    LanguageFile { code, name, texts: rows }
}

/// A file as it is edited: one row a line.
fn written(file: &LanguageFile) -> String {
    let LanguageFile { code, name, texts } = file;
    let mut out = String::from(
        "// A language of the control: Chinese, English, and the words of this language; a row without words is shown in\n\
         // English. {placeholders} stay as they are. Put the file into the folder `languages` of the data directory.\n",
    );
    // Writing to a `String` does not fail.
    let _ = write!(out, "(\n    code: {code:?},\n    name: {name:?},\n    texts: [\n");
    for TranslationRow(zh, en, words) in texts {
        let _ = writeln!(out, "        ({zh:?}, {en:?}, {words:?}),");
    }
    out.push_str("    ],\n)\n");
    out
}

/// The characters of a language that the font of the screen lacks.
#[cfg(feature = "hmi")]
fn lacking_glyphs(language: &Translation) -> String {
    let characters = language.words().flat_map(str::chars).chain(language.name.chars());
    let shown = characters.filter(|sign| !sign.is_control());
    crate::hmi::theme::lacking_glyphs(shown.collect()).into_iter().map(|sign| format!("{sign} ")).collect::<String>()
}

/// A build without a screen has no font.
#[cfg(not(feature = "hmi"))]
const fn lacking_glyphs(_: &Translation) -> String {
    String::new()
}
