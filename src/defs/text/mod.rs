//! Texts in the two languages of the control, and in those that files add.
//!
//! The core says what it means by a phrase: a constant template and its arguments. Making, cloning and dropping one
//! allocates nothing. The screen, the disk thread and the tests put it into words.

pub mod arg;
mod localized;
mod translation;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

pub use localized::LocalizedText;
pub(crate) use localized::phrase;
pub use translation::{LanguageFile, Translation, TranslationRow};

/// A language of the control. Chinese is the default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Lang {
    /// 中文
    #[default]
    Zh,
    /// English
    En,
    /// One that a file adds.
    Added(&'static Translation),
}

impl Lang {
    /// Its code by ISO 639: `zh`, `en`, `de`.
    #[must_use]
    pub fn code(self) -> &'static str {
        match self {
            Self::Zh => "zh",
            Self::En => "en",
            Self::Added(translation) => &translation.code,
        }
    }

    /// Its own name: `中文`, `English`, `Deutsch`.
    #[must_use]
    pub fn own_name(self) -> &'static str {
        match self {
            Self::Zh => "中文",
            Self::En => "English",
            Self::Added(translation) => &translation.name,
        }
    }

    /// A text by its Chinese and its English. What an added language lacks is shown in English.
    #[must_use]
    pub fn pick<'t>(self, zh: &'t str, en: &'t str) -> &'t str {
        match self {
            Self::Zh => zh,
            Self::En => en,
            Self::Added(translation) => translation.find(zh, en).unwrap_or(en),
        }
    }

    /// A text of the customer by his own words and their English, if he gives it.
    #[must_use]
    pub fn pick_of<'t>(self, own: &'t str, english: Option<&'t str>) -> &'t str {
        let shown = self.pick(own, english.unwrap_or_default());
        if shown.is_empty() { own } else { shown }
    }
}

/// A constant text in both languages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text {
    /// Chinese.
    pub zh: &'static str,
    /// English.
    pub en: &'static str,
}

impl Text {
    /// A text from its Chinese and English forms.
    #[must_use]
    pub const fn new(zh: &'static str, en: &'static str) -> Self {
        Self { zh, en }
    }

    /// The text in a language.
    #[must_use]
    pub fn get(self, lang: Lang) -> &'static str {
        lang.pick(self.zh, self.en)
    }
}

/// Maximum number of arguments of a phrase.
pub const MAX_ARGS: usize = 6;

/// A constant text with named placeholders: `{axis}`, `{value:.3}`, `{off:+.3}`, `{number:04}`, as in `format!`.
#[derive(Debug, PartialEq, Eq)]
pub struct Template {
    /// The text with its placeholders.
    pub text: Text,
    /// The names of the arguments, in their order.
    pub names: &'static [&'static str],
}

impl Template {
    /// A template from its Chinese and English forms and the names of its arguments.
    ///
    /// # Panics
    /// A language has a placeholder that is not named, or lacks one that is. The macro [`phrase!`] checks at compile
    /// time.
    #[must_use]
    pub const fn new(zh: &'static str, en: &'static str, names: &'static [&'static str]) -> Self {
        assert!(names.len() <= MAX_ARGS, "too many arguments");
        assert!(uses_exactly(zh, names) && uses_exactly(en, names), "placeholders and arguments differ");
        Self { text: Text::new(zh, en), names }
    }
}

/// Whether a text has a placeholder for each name, and no other.
const fn uses_exactly(text: &str, names: &[&str]) -> bool {
    let (bytes, mut at, mut used) = (text.as_bytes(), 0, 0_u32);
    while at < bytes.len() {
        if bytes[at] == b'{' {
            let (start, mut index) = (at + 1, 0);
            while index < names.len() && !is_placeholder(bytes, start, names[index].as_bytes()) {
                index += 1;
            }
            if index == names.len() {
                return false;
            }
            used |= 1 << index;
        }
        at += 1;
    }
    used == (1 << names.len()) - 1
}

/// Whether the placeholder that begins at `start` has this name.
const fn is_placeholder(text: &[u8], start: usize, name: &[u8]) -> bool {
    if start + name.len() >= text.len() {
        return false;
    }
    let mut index = 0;
    while index < name.len() {
        if text[start + index] != name[index] {
            return false;
        }
        index += 1;
    }
    matches!(text[start + name.len()], b':' | b'}')
}

/// A text in both languages that was put into words.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "LocalizedText")]
pub struct Words {
    zh: String,
    en: String,
}

impl Words {
    /// A text from its Chinese and English words.
    pub fn new(zh: impl Into<String>, en: impl Into<String>) -> Self {
        Self { zh: zh.into(), en: en.into() }
    }

    /// The text in a language.
    #[must_use]
    pub fn get(&self, lang: Lang) -> &str {
        lang.pick(&self.zh, &self.en)
    }
}

/// Words that are shared: a copy allocates nothing and is small.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Words", into = "Words")]
pub struct SharedWords(Option<Arc<Words>>);

impl SharedWords {
    /// Words in both languages; where one is empty, the other stands for it.
    #[must_use]
    pub fn either(zh: &str, en: &str) -> Self {
        Words::new(if zh.is_empty() { en } else { zh }, if en.is_empty() { zh } else { en }).into()
    }

    /// The words in a language.
    #[must_use]
    pub fn get(&self, lang: Lang) -> &str {
        self.0.as_ref().map_or("", |words| words.get(lang))
    }

    /// Whether there are no words.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.0.is_none()
    }
}

impl From<Words> for SharedWords {
    fn from(words: Words) -> Self {
        Self(Some(words).filter(|words| *words != Words::default()).map(Arc::new))
    }
}

impl From<SharedWords> for Words {
    fn from(shared: SharedWords) -> Self {
        shared.0.map_or_else(Self::default, Arc::unwrap_or_clone)
    }
}
