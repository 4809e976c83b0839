//! A language that a file adds: its words for the texts of the control.
//!
//! Chinese and English stand beside each other where a text is used, so that the compiler holds them together. A third
//! language is a table by both: what it lacks is shown in English. Source: spec H9.

use std::collections::HashMap;
use std::fmt;
use std::hash::{Hash, Hasher};

use serde::{Deserialize, Serialize};

use super::{LocalizedText, phrase};

/// Maximum length of the code of a language, characters.
pub const MAX_CODE: usize = 8;
/// Maximum length of the name of a language, characters: it stands on a key.
pub const MAX_NAME: usize = 10;

/// A row of a language file: Chinese, English, and the words of the language; empty where it has none yet.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TranslationRow(pub String, pub String, pub String);

/// A language file, as it is written.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LanguageFile {
    /// Its code by ISO 639: `de`, `ru`.
    pub code: String,
    /// Its own name: `Deutsch`.
    pub name: String,
    /// Its rows.
    pub texts: Vec<TranslationRow>,
}

/// The words of an added language.
pub struct Translation {
    /// Its code by ISO 639.
    pub code: String,
    /// Its own name.
    pub name: String,
    /// The rows by their English: Chinese and words.
    rows: HashMap<String, Vec<(String, String)>>,
}

impl Translation {
    /// The words of a language file, and what is wrong with rows of it: those are left out.
    ///
    /// # Errors
    /// The code or the name is none.
    pub fn new(file: LanguageFile) -> Result<(Self, Vec<LocalizedText>), LocalizedText> {
        let LanguageFile { code, name, texts } = file;
        if !is_code(&code) {
            return Err(phrase!(
                "语言代码“{code}”应为 2 到 {most} 个小写字母（ISO 639），且不是 zh、en",
                "the code '{code}' of the language should be 2 to {most} small letters (ISO 639), and not zh or en",
                code,
                most = MAX_CODE
            ));
        }
        if name.trim().is_empty() || name.chars().count() > MAX_NAME {
            return Err(phrase!(
                "语言名称“{name}”应有 1 到 {most} 个字符",
                "the name '{name}' of the language should have 1 to {most} characters",
                name,
                most = MAX_NAME
            ));
        }
        let (mut made, mut faults) = (Self { code, name, rows: HashMap::new() }, Vec::new());
        for row in texts {
            if let Err(fault) = made.take(row) {
                faults.push(fault);
            }
        }
        Ok((made, faults))
    }

    /// Takes a row; one without words is none.
    fn take(&mut self, row: TranslationRow) -> Result<(), LocalizedText> {
        let TranslationRow(zh, en, words) = row;
        if words.trim().is_empty() {
            return Ok(());
        }
        if placeholders(&words) != placeholders(&en) {
            return Err(phrase!(
                "“{words}”的占位符与“{en}”不同：请写同样的 {ph}，该行不用",
                "'{words}' has other placeholders than '{en}': write the same {ph}; the row is left out",
                words,
                en,
                ph = "{…}"
            ));
        }
        let rows = self.rows.entry(en).or_default();
        if rows.iter().any(|(known, _)| *known == zh) {
            return Err(phrase!(
                "“{zh}”有两行：请删除一行，用第一行",
                "'{zh}' has two rows: delete one; the first is used",
                zh
            ));
        }
        rows.push((zh, words));
        Ok(())
    }

    /// The words for a text.
    #[must_use]
    pub fn find(&self, zh: &str, en: &str) -> Option<&str> {
        let rows = self.rows.get(en)?;
        rows.iter().find(|(known, _)| known == zh).map(|(_, words)| words.as_str())
    }

    /// All words of the language.
    pub fn words(&self) -> impl Iterator<Item = &str> {
        self.rows.values().flatten().map(|(_, words)| words.as_str())
    }

    /// Keeps it for the run of the process, as the two languages of the control are.
    #[must_use]
    pub fn keep(self) -> &'static Self {
        Box::leak(Box::new(self))
    }
}

/// Whether this may be the code of an added language.
fn is_code(code: &str) -> bool {
    let letters = code.bytes().all(|byte| byte.is_ascii_lowercase());
    letters && (2..=MAX_CODE).contains(&code.len()) && !["zh", "en"].contains(&code)
}

/// The placeholders of a template, each as it is written, in order: `axis`, `value:.3`.
fn placeholders(text: &str) -> Vec<&str> {
    let mut found: Vec<_> = text.split('{').skip(1).map(|part| part.split('}').next().unwrap_or(part)).collect();
    found.sort_unstable();
    found
}

impl fmt::Debug for Translation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Translation").field("code", &self.code).finish_non_exhaustive()
    }
}

impl PartialEq for Translation {
    fn eq(&self, other: &Self) -> bool {
        self.code == other.code
    }
}

impl Eq for Translation {}

impl Hash for Translation {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.code.hash(state);
    }
}
