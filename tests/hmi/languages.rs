//! A language that a file adds reaches every text of the screen. Source: spec H9.

use crate::sample::snapshot;
use crate::screen::{open, painted};
use crate::stories::ready_of;
use kt830::defs::kind::Kind;
use kt830::defs::page::Page;
use kt830::defs::text::{Lang, LanguageFile, Translation, TranslationRow};
use kt830::hmi::{HelpEntry, help_entries, page_text as painted_text};
use kt830::link::Command;
use kt830::store::AddedLanguages;

/// A language in which every letter is `ж`: what is not in it was not taken from the table.
fn strange() -> Lang {
    let all: Vec<(String, String)> = ron::from_str(include_str!("../../assets/text/texts.ron")).unwrap();
    let texts = all.into_iter().map(|(zh, en)| {
        let words = disguised(&en);
        TranslationRow(zh, en, words)
    });
    let file = LanguageFile { code: "xx".to_owned(), name: "жжж".to_owned(), texts: texts.collect() };
    let (language, faults) = Translation::new(file).unwrap();
    assert!(faults.is_empty(), "{faults:?}");
    Lang::Added(language.keep())
}

/// A text with other letters; placeholders stay.
fn disguised(text: &str) -> String {
    let mut inside = false;
    let letter = |sign: char| {
        inside = sign == '{' || inside && sign != '}';
        if sign.is_ascii_alphabetic() && !inside { 'ж' } else { sign }
    };
    text.chars().map(letter).collect()
}

/// What is the same in every language: own names of languages and kinds, ids of signals, names of programs. The title of the
/// settings that hold the language can be read by those who know no other one.
fn is_name(page: Page, text: &str) -> bool {
    let all = |is: fn(char) -> bool| text.chars().all(is);
    match page {
        Page::Diagnosis => all(|sign| sign.is_ascii_lowercase() || sign.is_ascii_digit() || sign == '-'),
        Page::Directory => all(|sign| sign.is_ascii_uppercase()),
        Page::Settings => ["中文", "English", "LATHE", "Language 语言, colours, brightness"].contains(&text),
        _ => false,
    }
}

#[test]
fn h9_an_added_language_reaches_every_text_of_every_page() {
    let lang = strange();
    let mut wrong = Vec::new();
    for kind in Kind::ALL {
        let mut rig = ready_of(kind);
        for page in Page::ALL {
            rig.send(Command::OpenPage(*page));
            rig.step();
            rig.step();
            for text in painted_text(rig.snapshot(), lang).into_iter().filter(|text| !is_name(*page, text)) {
                let words = text.split(|sign: char| !sign.is_ascii_alphabetic());
                let own: Vec<_> = words.filter(|word| word.len() > 3).collect();
                let chinese = text.chars().any(|sign| ('\u{4e00}'..='\u{9fff}').contains(&sign));
                if chinese || !own.is_empty() {
                    wrong.push(format!("{} {}: {text}", kind.id(), page.id()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} texts:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn h9_the_settings_page_says_that_a_language_file_is_wrong() {
    let says = |faults: bool| {
        let mut screen = open(snapshot(Page::Settings));
        screen.state_mut().hmi.add_languages(&[], faults);
        screen.step();
        painted(&screen).iter().any(|text| text.contains("语言文件有错"))
    };
    assert!(says(true) && !says(false));
}

#[test]
fn h9_the_search_finds_the_words_of_an_added_language() {
    let german = AddedLanguages::shipped().languages.into_iter().find(|language| language.code == "de").unwrap();
    let lang = Lang::Added(german.keep());
    let mut entries = help_entries(Kind::Gc);
    let found = |entries: &[HelpEntry], words: &str| entries.iter().filter(|entry| entry.matches(words)).count();
    assert_eq!(found(&entries, "abrichtpunkt"), 0);
    entries.iter_mut().for_each(|entry| entry.add_language(lang));
    assert!(found(&entries, "abrichtpunkt") > 3 && found(&entries, "dressing point") > 3);
    // A word in the name comes before one in the text.
    let best =
        entries.iter().filter(|entry| entry.matches("reitstock vor")).min_by_key(|entry| entry.rank("reitstock vor"));
    assert!(best.unwrap().name.get(lang).to_lowercase().contains("reitst"), "{}", best.unwrap().name.get(lang));
}
