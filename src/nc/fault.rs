//! Program mistakes and their exact location. Source: spec B1, B8.

use std::fmt::{self, Write};

use crate::defs::gcode::GCode;
pub(crate) use crate::defs::program_error::ProgramError as E;
use crate::defs::text::arg::Arg;
use crate::defs::text::{Lang, LocalizedText, Template};

/// The location of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct BlockLocation {
    /// The O number.
    pub program: u32,
    /// The line, from 1.
    pub line: u32,
    /// The N number, if the block has one.
    pub n: Option<u32>,
}

/// Most calls that a mistake names.
const MAX_CALLS: usize = 8;

/// Most calls that an alarm shows.
const SHOWN_CALLS: usize = 3;
/// The calls of an alarm, by their number.
const CALLS: [&Template; SHOWN_CALLS] = {
    const NAMES: &[&str] = &["a", "b", "c", "d", "e", "f"];
    const ONE: Template = Template::new("由 {a} 第{b}行调用", "called by {a} line {b}", NAMES.split_at(2).0);
    const TWO: Template =
        Template::new("由 {a} 第{b}行调用 ← {c} 第{d}行", "called by {a} line {b} ← {c} line {d}", NAMES.split_at(4).0);
    const THREE: Template = Template::new(
        "由 {a} 第{b}行调用 ← {c} 第{d}行 ← {e} 第{f}行",
        "called by {a} line {b} ← {c} line {d} ← {e} line {f}",
        NAMES,
    );
    [&ONE, &TWO, &THREE]
};

/// The calls that led to a block: program and line (from 1) of each, the last one first. Longer chains are cut off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CallChain {
    calls: [(u32, u32); MAX_CALLS],
    count: u8,
}

impl CallChain {
    /// Program and line of each call.
    pub fn iter(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.calls.iter().take(usize::from(self.count)).copied()
    }
}

impl CallChain {
    /// The chain of what is called in a line of a program that this chain leads to.
    pub(super) fn within(self, place: (u32, u32)) -> Self {
        std::iter::once(place).chain(self.iter()).collect()
    }
}

impl FromIterator<(u32, u32)> for CallChain {
    fn from_iter<I: IntoIterator<Item = (u32, u32)>>(calls: I) -> Self {
        let mut chain = Self::default();
        for (place, call) in chain.calls.iter_mut().zip(calls) {
            *place = call;
            chain.count += 1;
        }
        chain
    }
}

/// A program mistake: its location, its row in the error table, and details.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct ProgramFault {
    /// The block.
    pub location: BlockLocation,
    /// The column, from 1, counted in characters.
    pub column: u32,
    /// The row of the error table.
    pub error: E,
    details: [Arg; 2],
    /// The displayed name of the program.
    program_title: Arg,
    /// How the run came to the block, if it is not in the started program.
    pub calls: CallChain,
}

impl ProgramFault {
    pub(crate) fn new(program: impl Into<Arg>, place: BlockLocation, column: u32, wrong: ErrorAt) -> Self {
        Self {
            location: place,
            column,
            error: wrong.error,
            details: wrong.details,
            program_title: program.into(),
            calls: CallChain::default(),
        }
    }

    /// The same mistake, with the calls that led to its block.
    pub(crate) fn with_calls(self, calls: CallChain) -> Self {
        Self { calls, ..self }
    }

    /// At the same place: what could not be looked at there.
    pub(crate) fn into_unchecked(self, error: E) -> Self {
        Self { error, details: Default::default(), ..self }
    }

    /// The displayed name of the program.
    #[must_use]
    pub fn program_title(&self) -> String {
        self.program_title.to_text()
    }

    pub(crate) fn has_detail(&self) -> bool {
        !self.details[0].is_empty()
    }

    /// The alarm number: 1–65, 67–99 or 500–599.
    #[must_use]
    pub const fn alarm(&self) -> u16 {
        self.error.number()
    }

    /// The cause, without location and remedy.
    #[must_use]
    pub fn cause(&self, lang: Lang) -> String {
        self.cause_phrase().get(lang).into_owned()
    }

    /// The remedy.
    #[must_use]
    pub fn remedy(&self, lang: Lang) -> String {
        self.remedy_phrase().get(lang).into_owned()
    }

    /// Program, line, column, cause and remedy in one line.
    #[must_use]
    pub fn text(&self, lang: Lang) -> String {
        self.phrase().get(lang).into_owned()
    }

    /// [`Self::cause`] as a phrase.
    #[must_use]
    pub fn cause_phrase(&self) -> LocalizedText {
        LocalizedText::phrase(self.error.template(), self.cause_details())
    }

    /// Program, line, column and cause: the text of an alarm, whose remedy is beside it.
    #[must_use]
    pub fn place_and_cause(&self) -> LocalizedText {
        let template = const {
            &Template::new("{program} {place}：{cause}", "{program} {place}: {cause}", &["program", "place", "cause"])
        };
        let [first, second] = self.cause_details();
        let (place, cause) = (Arg::Place(self.location.line, self.column), Arg::Phrase(self.error.template(), 3));
        LocalizedText::phrase(template, [self.program_title.clone(), place, cause, first, second])
    }

    /// [`Self::remedy`] as a phrase.
    #[must_use]
    pub fn remedy_phrase(&self) -> LocalizedText {
        LocalizedText::phrase(self.error.remedy_template(), self.details.clone())
    }

    /// The calls that led to the block, the last one first; blank if it is in the started program.
    #[must_use]
    pub fn calls_phrase(&self) -> LocalizedText {
        let mut args = [const { Arg::None }; 2 * SHOWN_CALLS];
        let mut shown = 0_usize;
        for ((program, line), place) in self.calls.iter().zip(args.chunks_exact_mut(2)) {
            place.clone_from_slice(&[Arg::Program(program), Arg::Integer(i64::from(line))]);
            shown += 1;
        }
        let template = shown.checked_sub(1).and_then(|index| CALLS.get(index));
        template.map_or_else(LocalizedText::default, |template| LocalizedText::phrase(template, args))
    }

    /// [`Self::text`] as a phrase.
    #[must_use]
    pub fn phrase(&self) -> LocalizedText {
        let template = const {
            &Template::new(
                "{program} {place}：{cause} – {remedy}",
                "{program} {place}: {cause} – {remedy}",
                &["program", "place", "cause", "remedy"],
            )
        };
        let [first, second] = self.cause_details();
        let place = Arg::Place(self.location.line, self.column);
        let (cause, remedy) = (Arg::Phrase(self.error.template(), 4), Arg::Phrase(self.error.remedy_template(), 4));
        LocalizedText::phrase(template, [self.program_title.clone(), place, cause, remedy, first, second])
    }

    /// The details. The name of a function comes from the table of G codes.
    fn cause_details(&self) -> [Arg; 2] {
        let [first, second] = self.details.clone();
        match (self.error, first.as_name().get(1..).and_then(|code| GCode::find(code.parse().ok()?))) {
            (E::NoEncoderG | E::WrongKindG, Some(row)) => [first, Arg::Text(&row.text)],
            _ => [first, second],
        }
    }
}

impl fmt::Display for ProgramFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(Lang::En))
    }
}

/// A part of a program text as a message shows it: in capitals.
pub(crate) struct Capitals<'t>(pub &'t [u8]);

impl fmt::Display for Capitals<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for chunk in self.0.utf8_chunks() {
            chunk.valid().chars().try_for_each(|character| f.write_char(character.to_ascii_uppercase()))?;
            if !chunk.invalid().is_empty() {
                f.write_char(char::REPLACEMENT_CHARACTER)?;
            }
        }
        Ok(())
    }
}

impl From<Capitals<'_>> for Arg {
    fn from(text: Capitals<'_>) -> Self {
        format_args!("{text}").into()
    }
}

/// A mistake at a byte of the text; line and column are not determined yet.
#[derive(Clone, Debug)]
pub(crate) struct ErrorAt {
    pub at: usize,
    pub error: E,
    pub details: [Arg; 2],
}

/// Why reading a block stopped.
#[derive(Clone, Debug)]
pub(crate) enum ReadStop {
    /// A live value is needed: all motion must be done first.
    Drain,
    /// The text has a mistake.
    Error(ErrorAt),
}

/// Why reading a block stopped, with the place of a mistake.
#[derive(Clone, Debug)]
pub(crate) enum StepStop {
    /// As [`ReadStop::Drain`].
    Drain,
    /// The text has a mistake.
    Fault(ProgramFault),
}

/// The result of reading a part of a block.
pub(crate) type ReadResult<T> = Result<T, ReadStop>;

#[cold]
pub(crate) fn fail<T>(at: usize, error: E) -> ReadResult<T> {
    fail2(at, error, Arg::None, Arg::None)
}

#[cold]
pub(crate) fn fail1<T>(at: usize, error: E, detail: impl Into<Arg>) -> ReadResult<T> {
    fail2(at, error, detail, Arg::None)
}

#[cold]
pub(crate) fn fail2<T>(at: usize, error: E, detail: impl Into<Arg>, second: impl Into<Arg>) -> ReadResult<T> {
    Err(ReadStop::Error(ErrorAt { at, error, details: [detail.into(), second.into()] }))
}
