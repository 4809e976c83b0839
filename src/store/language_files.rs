//! The language files of a folder: `NAME.ron`, each a language that is added to Chinese and English. Source: spec H9.

use std::fs;
use std::path::{Path, PathBuf};

use super::io_fault::IoFault;
use super::ron_file::{self, ChecksumPolicy};
use crate::defs::text::{LanguageFile, LocalizedText, Template, Translation, phrase};

/// Maximum number of languages that files add beside the shipped ones: each has a key on the settings page.
pub const MAX_ADDED_LANGUAGES: usize = 2;

/// The languages that come with the control.
const SHIPPED: [&str; 1] = [include_str!("../../assets/text/de.ron")];

/// The languages that were read, and what is wrong with their files.
#[derive(Debug, Default)]
pub struct AddedLanguages {
    /// The languages in the order of their files' names.
    pub languages: Vec<Translation>,
    /// Files and rows that are not used, each with its place, cause and remedy.
    pub faults: Vec<LocalizedText>,
}

impl AddedLanguages {
    /// Reads a folder, which need not be there, then the languages that come with the control. A file of the folder holds
    /// before a shipped one.
    #[must_use]
    pub fn read(folder: &Path) -> Self {
        let mut all = Self::default();
        match files_of(folder) {
            Ok(files) => files.iter().for_each(|file| all.add(file)),
            Err(fault) => all.faults.push(LocalizedText::same(&fault)),
        }
        let shipped = Self::shipped().languages.into_iter();
        let others: Vec<_> = shipped.filter(|language| !all.languages.contains(language)).collect();
        all.languages.extend(others);
        all
    }

    /// The languages that come with the control alone.
    #[must_use]
    pub fn shipped() -> Self {
        // A test reads them.
        let made = SHIPPED.into_iter().filter_map(|text| Translation::new(ron::from_str(text).ok()?).ok());
        Self { languages: made.map(|(language, _)| language).collect(), faults: Vec::new() }
    }

    fn add(&mut self, path: &Path) {
        let name = path.display().to_string();
        let read = match ron_file::read_newest::<LanguageFile>(path, ChecksumPolicy::Lenient) {
            Ok(file) => Translation::new(file),
            Err(fault) => Err(LocalizedText::same(&fault)),
        };
        let fault = match read {
            Ok((language, _)) if self.languages.contains(&language) => {
                phrase!(
                    "已有语言“{code}”：请改其中一个文件的代码",
                    "the language '{code}' is there already: change the code in one of the files",
                    code = language.code
                )
            }
            Ok(_) if self.languages.len() == MAX_ADDED_LANGUAGES => {
                phrase!(
                    "最多添加 {most} 种语言：请移走一个文件",
                    "at most {most} languages are added: take a file away",
                    most = MAX_ADDED_LANGUAGES
                )
            }
            Ok((language, rows)) => {
                self.faults.extend(rows.into_iter().map(|fault| placed(&name, fault)));
                return self.languages.push(language);
            }
            Err(fault) => fault,
        };
        self.faults.push(placed(&name, fault));
    }
}

/// A fault with the file in which it is.
fn placed(file: &str, fault: LocalizedText) -> LocalizedText {
    const IN_FILE: &Template = &Template::new("{file}：{fault}", "{file}: {fault}", &["file", "fault"]);
    LocalizedText::phrase_of(IN_FILE, [file.into()], [fault])
}

/// The language files of a folder by name.
fn files_of(folder: &Path) -> Result<Vec<PathBuf>, IoFault> {
    let entries = match fs::read_dir(folder).map_err(IoFault::at(folder, "read")) {
        Err(fault) if fault.is_missing() => return Ok(Vec::new()),
        entries => entries?,
    };
    let paths: Result<Vec<_>, _> = entries.map(|entry| entry.map(|entry| entry.path())).collect();
    let mut files = paths.map_err(IoFault::at(folder, "read"))?;
    files.retain(|path| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ron")));
    files.sort();
    Ok(files)
}
