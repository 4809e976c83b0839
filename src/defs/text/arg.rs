//! Arguments of phrases: small values that are put into words together with the phrase.

use std::borrow::Cow;
use std::fmt::{self, Write};
use std::sync::Arc;

use super::{Lang, Template, Text, Words};
use crate::defs::date::DateTime;
use crate::defs::key::Key;
use crate::defs::kind::{Dialect, Kind};
use crate::defs::page::Page;
use crate::defs::param::ParamAddress;
use crate::defs::program_number;
use crate::defs::signal::{Input, Output};
use crate::defs::soft_key::SoftKeyAction;
use crate::defs::variable_name::variable_name;
use crate::units::Axis;

/// Bytes of a name that is kept in place; a longer one is shared.
const SHORT_NAME: usize = 30;

/// A place in a text.
const PLACE: Template = Template::new("第{line}行 第{column}列", "line {line}, column {column}", &["line", "column"]);

/// An argument of a phrase.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Arg {
    /// Nothing.
    #[default]
    None,
    /// A whole number.
    Integer(i64),
    /// A number, as its bits.
    Number(u64),
    /// A character.
    Character(char),
    /// An axis, by its letter.
    Axis(Axis),
    /// A constant text.
    Text(&'static Text),
    /// Another template. Its arguments are those of the phrase from this index on.
    Phrase(&'static Template, u8),
    /// A text that was put into words outside the tick.
    Words(Arc<Words>),
    /// A parameter: `P4`, `P4.4`.
    Param(ParamAddress),
    /// Date and time.
    Date(DateTime),
    /// A variable by its name in a dialect: `#500`, `R18`.
    Variable(u32, Dialect),
    /// A program by the name of its number: `O1001`, `L10`.
    Program(u32),
    /// A line and a column, from 1.
    Place(u32, u32),
    /// The name of an input.
    Input(Input),
    /// The name of an output.
    Output(Output),
    /// The label of a panel key on a kind of machine.
    Key(Key, Kind),
    /// The label of a soft key on a kind of machine.
    SoftKey(SoftKeyAction, Kind),
    /// The title of a page.
    Page(Page),
    /// A short name: its length and its bytes.
    ShortName(u8, [u8; SHORT_NAME]),
    /// A longer name. The box inside keeps the argument small.
    LongName(Arc<Box<str>>),
}

impl Arg {
    /// Whether it is nothing, or an empty name.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        matches!(self, Self::None | Self::ShortName(0, _))
    }

    /// The characters of a name, or Chinese words; empty for any other argument.
    #[must_use]
    pub fn as_name(&self) -> &str {
        match self {
            Self::ShortName(length, bytes) => {
                let bytes = bytes.get(..usize::from(*length)).unwrap_or_default();
                std::str::from_utf8(bytes).unwrap_or_default()
            }
            Self::LongName(name) => name,
            Self::Words(words) => words.get(Lang::Zh),
            _ => "",
        }
    }

    /// The characters of a name, or words in a language; empty for any other argument.
    pub(super) fn as_name_in(&self, lang: Lang) -> &str {
        if let Self::Words(words) = self { words.get(lang) } else { lang.pick_of(self.as_name(), None) }
    }

    /// The argument alone, in English where languages differ.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        // Writing to a `String` does not fail.
        let _ = self.write(&mut out, Lang::En, NumberForm::default());
        out
    }

    /// Puts the argument into words. Only numbers have a form.
    pub(super) fn write(&self, out: &mut String, lang: Lang, form: NumberForm) -> fmt::Result {
        match self {
            Self::None | Self::Phrase(..) => Ok(()),
            Self::Integer(value) => write!(out, "{value:0width$}", width = form.width),
            Self::Number(bits) => form.write(out, f64::from_bits(*bits)),
            Self::Character(character) => out.write_char(*character),
            Self::Axis(axis) => write!(out, "{axis}"),
            Self::Text(text) => out.write_str(text.get(lang)),
            Self::Words(words) => out.write_str(words.get(lang)),
            Self::Param(at) => write!(out, "{at}"),
            Self::Date(date) => write!(out, "{date}"),
            Self::Variable(number, dialect) => out.write_str(&variable_name(*number, *dialect)),
            Self::Program(number) => out.write_str(&program_number::name_of(*number)),
            Self::Place(line, column) => PLACE.write(out, lang, &[Self::from(*line), Self::from(*column)]),
            Self::Input(input) => out.write_str(input.name().get(lang)),
            Self::Output(output) => out.write_str(output.name().get(lang)),
            Self::Key(key, kind) => out.write_str(key.label_on(*kind).get(lang)),
            Self::SoftKey(key, kind) => out.write_str(key.label_on(*kind).get(lang)),
            Self::Page(page) => out.write_str(page.title().get(lang)),
            Self::ShortName(..) | Self::LongName(_) => out.write_str(self.as_name()),
        }
    }
}

impl Template {
    /// Puts the template into words, with its arguments.
    pub(super) fn write(&self, out: &mut String, lang: Lang, args: &[Arg]) -> fmt::Result {
        let mut rest = self.text.get(lang);
        while let Some((before, after)) = rest.split_once('{') {
            out.push_str(before);
            let (inside, tail) = after.split_once('}').unwrap_or((after, ""));
            let (name, form) = inside.split_once(':').unwrap_or((inside, ""));
            match self.names.iter().position(|known| *known == name).and_then(|index| args.get(index)) {
                Some(Arg::Phrase(template, first)) => {
                    template.write(out, lang, args.get(usize::from(*first)..).unwrap_or_default())?;
                }
                Some(arg) => arg.write(out, lang, NumberForm::parse(form))?,
                None => write!(out, "{{{inside}}}")?,
            }
            rest = tail;
        }
        out.write_str(rest)
    }
}

/// Most digits of a number; a larger form is a mistake of a template.
const MAX_DIGITS: usize = 16;

/// How a number is written: the part of a placeholder after the colon, as in `format!`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NumberForm {
    plus: bool,
    /// Minimum number of characters, filled with zeros.
    width: usize,
    decimals: Option<usize>,
}

impl NumberForm {
    /// Reads `.3`, `+.3`, `04`; an empty form is the shortest way to write the number.
    pub(super) fn parse(form: &str) -> Self {
        let (plus, rest) = form.strip_prefix('+').map_or((false, form), |rest| (true, rest));
        let (width, decimals) = rest.split_once('.').map_or((rest, None), |(width, decimals)| (width, Some(decimals)));
        let decimals = decimals.and_then(|digits| digits.parse().ok()).map(|digits: usize| digits.min(MAX_DIGITS));
        Self { plus, width: width.parse().unwrap_or(0).min(MAX_DIGITS), decimals }
    }

    fn write(self, out: &mut String, value: f64) -> fmt::Result {
        match (self.decimals, self.plus) {
            (Some(decimals), true) => write!(out, "{value:+.decimals$}"),
            (Some(decimals), false) => write!(out, "{value:.decimals$}"),
            (None, _) => write!(out, "{value}"),
        }
    }
}

impl From<f64> for Arg {
    fn from(value: f64) -> Self {
        Self::Number(value.to_bits())
    }
}

impl From<fmt::Arguments<'_>> for Arg {
    fn from(name: fmt::Arguments<'_>) -> Self {
        let mut short = ShortName::default();
        match short.write_fmt(name) {
            Ok(()) => Self::ShortName(short.length, short.bytes),
            Err(_) => Self::LongName(Arc::new(name.to_string().into())),
        }
    }
}

/// Takes a name as long as it is short.
#[derive(Default)]
struct ShortName {
    length: u8,
    bytes: [u8; SHORT_NAME],
}

impl Write for ShortName {
    fn write_str(&mut self, part: &str) -> fmt::Result {
        let start = usize::from(self.length);
        let place = self.bytes.get_mut(start..start + part.len()).ok_or(fmt::Error)?;
        place.copy_from_slice(part.as_bytes());
        self.length += part.len() as u8;
        Ok(())
    }
}

impl From<usize> for Arg {
    fn from(value: usize) -> Self {
        Self::Integer(value as i64)
    }
}

/// Types that are names.
macro_rules! names {
    ($($from:ty),+) => {
        $(impl From<$from> for Arg {
            fn from(name: $from) -> Self {
                format_args!("{name}").into()
            }
        })+
    };
}

names!(&str, String, &String, Cow<'_, str>);

/// Types that an argument holds as they are.
macro_rules! arguments {
    ($($kind:ident: $($from:ty),+;)*) => {
        $($(impl From<$from> for Arg {
            fn from(value: $from) -> Self {
                Self::$kind(value.into())
            }
        })+)*
    };
}

arguments! {
    Integer: u8, u16, u32, i32, i64;
    Character: char;
    Axis: Axis;
    Text: &'static Text;
    Param: ParamAddress;
    Date: DateTime;
    Input: Input;
    Output: Output;
    Page: Page;
}

// A phrase keeps several of them in place.
const _: () = assert!(size_of::<Arg>() <= 32);
