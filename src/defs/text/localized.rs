//! A text for the operator: constant, a phrase with arguments, or words composed outside the tick.

use std::borrow::Cow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::arg::Arg;
use super::{Lang, MAX_ARGS, SharedWords, Template, Text, Words};
use crate::defs::alarm;

/// A phrase: the Chinese and the English template, then the arguments, `name` or `name = value`.
macro_rules! phrase {
    (@value $name:ident) => { $name };
    (@value $name:ident $value:expr) => { $value };
    ($zh:expr, $en:expr $(, $name:ident $(= $value:expr)?)* $(,)?) => {
        $crate::defs::text::LocalizedText::phrase(
            const { &$crate::defs::text::Template::new($zh, $en, &[$(stringify!($name)),*]) },
            [$($crate::defs::text::arg::Arg::from($crate::defs::text::phrase!(@value $name $($value)?))),*],
        )
    };
}
pub(crate) use phrase;

/// A text of a program.
const OF_PROGRAM: &Template = &Template::new("{text}", "{text}", &["text"]);

/// A text for the operator in both languages: the core does not know the language of the display.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Words", into = "Words")]
pub struct LocalizedText {
    content: TextContent,
    /// The alarm whose text of the table comes before it.
    alarm: Option<u16>,
    /// Maximum number of characters; the rest is cut off.
    max_chars: u16,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum TextContent {
    /// A constant text.
    Text(Text),
    /// A template with its arguments.
    Phrase(&'static Template, [Arg; MAX_ARGS]),
    /// Words that were composed outside the tick.
    Words(Arc<Words>),
}

impl LocalizedText {
    /// A text from its Chinese and English words. It allocates: the core makes phrases instead, by [`phrase!`].
    pub fn new(zh: impl Into<String>, en: impl Into<String>) -> Self {
        Self::of(TextContent::Words(Arc::new(Words { zh: zh.into(), en: en.into() })))
    }

    /// A text of a program; without its English the same in both languages.
    #[must_use]
    pub fn of_program(text: &Arg) -> Self {
        Self::phrase(OF_PROGRAM, [text.clone()])
    }

    /// A phrase from a template and its arguments; see [`phrase!`].
    #[must_use]
    pub fn phrase<const N: usize>(template: &'static Template, args: [Arg; N]) -> Self {
        Self::phrase_of(template, args, [])
    }

    /// A phrase whose last arguments are other texts. Each needs one argument more than it has itself; what does not
    /// fit is put into words.
    #[must_use]
    pub fn phrase_of<const N: usize, const M: usize>(
        template: &'static Template,
        args: [Arg; N],
        texts: [Self; M],
    ) -> Self {
        const { assert!(N + M <= MAX_ARGS, "too many arguments") };
        let mut all = [const { Arg::None }; MAX_ARGS];
        all.iter_mut().zip(args).for_each(|(place, arg)| *place = arg);
        let mut free = N + M;
        for (index, text) in texts.into_iter().enumerate() {
            let whole = text.alarm.is_none() && text.max_chars == u16::MAX;
            all[N + index] = match text.content {
                TextContent::Words(words) if whole => Arg::Words(words),
                TextContent::Phrase(within, own) if whole && free + used(&own) <= MAX_ARGS => {
                    let (first, length) = (free, used(&own));
                    all[first..].iter_mut().zip(own).take(length).for_each(|(place, arg)| *place = arg);
                    free += length;
                    Arg::Phrase(within, first as u8)
                }
                content => Arg::Words(Arc::new(Self { content, ..text }.into())),
            };
        }
        Self::of(TextContent::Phrase(template, all))
    }

    const fn of(content: TextContent) -> Self {
        Self { content, alarm: None, max_chars: u16::MAX }
    }

    /// This text as the detail of an alarm: the alarm's text of the table comes before it.
    #[must_use]
    pub fn after_alarm(self, number: u16) -> Self {
        Self { alarm: Some(number), ..self }
    }

    /// This text cut to a number of characters.
    #[must_use]
    pub fn cut(self, max_chars: u16) -> Self {
        Self { max_chars, ..self }
    }

    /// The same text in both languages: a name, or the words of the operating system.
    #[must_use]
    pub fn same(text: &(impl ToString + ?Sized)) -> Self {
        Self::new(text.to_string(), text.to_string())
    }

    /// The text in a language.
    #[must_use]
    pub fn get(&self, lang: Lang) -> Cow<'_, str> {
        let mut shown = self.unworded(lang).map_or_else(|| Cow::Owned(String::new()), Cow::Borrowed);
        if let (TextContent::Phrase(template, args), Cow::Owned(out)) = (&self.content, &mut shown) {
            // Writing to a `String` does not fail.
            let _ = template.write(out, lang, args);
        }
        let shown = match self.alarm.and_then(alarm::find) {
            Some(row) => Cow::Owned(format!("{}{}{shown}", row.text.get(lang), Text::new("：", ": ").get(lang))),
            None => shown,
        };
        match shown.char_indices().nth(usize::from(self.max_chars)) {
            Some((end, _)) => Cow::Owned(shown[..end].to_owned()),
            None => shown,
        }
    }

    /// The text in Chinese.
    #[must_use]
    pub fn zh(&self) -> Cow<'_, str> {
        self.get(Lang::Zh)
    }

    /// The text in English.
    #[must_use]
    pub fn en(&self) -> Cow<'_, str> {
        self.get(Lang::En)
    }

    /// Whether it says nothing but blanks.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.unworded(Lang::Zh).is_some_and(|text| text.trim().is_empty())
    }

    /// Whether it says nothing at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.unworded(Lang::Zh).is_some_and(str::is_empty)
    }

    /// The text without alarm and limit, if it needs no wording.
    fn unworded(&self, lang: Lang) -> Option<&str> {
        match &self.content {
            TextContent::Text(text) => Some(text.get(lang)),
            TextContent::Words(words) => Some(words.get(lang)),
            TextContent::Phrase(template, _) if template.names.is_empty() => Some(template.text.get(lang)),
            TextContent::Phrase(template, args) if *template == OF_PROGRAM => Some(args[0].as_name_in(lang)),
            TextContent::Phrase(..) => None,
        }
    }
}

/// The number of arguments that a phrase has.
fn used(args: &[Arg]) -> usize {
    args.iter().rposition(|arg| *arg != Arg::None).map_or(0, |last| last + 1)
}

impl Default for LocalizedText {
    fn default() -> Self {
        Text::new("", "").into()
    }
}

impl From<Text> for LocalizedText {
    fn from(text: Text) -> Self {
        Self::of(TextContent::Text(text))
    }
}

impl From<Words> for LocalizedText {
    fn from(words: Words) -> Self {
        Self::of(TextContent::Words(Arc::new(words)))
    }
}

impl From<&SharedWords> for LocalizedText {
    fn from(words: &SharedWords) -> Self {
        words.0.as_ref().map_or_else(Self::default, |words| Self::of(TextContent::Words(Arc::clone(words))))
    }
}

impl From<LocalizedText> for Words {
    fn from(text: LocalizedText) -> Self {
        Self { zh: text.zh().into_owned(), en: text.en().into_owned() }
    }
}

// A text is kept in queues and returned as an error.
const _: () = assert!(size_of::<LocalizedText>() <= 216);
