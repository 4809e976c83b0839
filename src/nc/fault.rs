//! Program mistakes and their exact location. Source: spec B1, B8.

use std::fmt;

use super::source::Source;
use crate::defs::gcode::GCode;
use crate::defs::program_error::ProgramError;
use crate::defs::text::Lang;

/// The location of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Place {
    /// The O number.
    pub program: u32,
    /// The line, from 1.
    pub line: u32,
    /// The N number, if the block has one.
    pub n: Option<u32>,
}

/// A program mistake: its location, its row in the error table, and details.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Fault {
    /// The block.
    pub place: Place,
    /// The column, from 1, counted in characters.
    pub column: u32,
    /// The row of the error table.
    pub error: ProgramError,
    details: [String; 2],
    /// The displayed name of the program.
    program: Box<str>,
}

impl Fault {
    pub(crate) fn new(program: impl Into<Box<str>>, place: Place, column: u32, wrong: Wrong) -> Self {
        Self { place, column, error: wrong.error, details: wrong.details, program: program.into() }
    }

    /// The displayed name of the program.
    #[must_use]
    pub fn program(&self) -> &str {
        &self.program
    }

    pub(crate) fn detail(&self) -> &str {
        &self.details[0]
    }

    /// The alarm number, 1–65 or 67–99.
    #[must_use]
    pub const fn alarm(&self) -> u16 {
        self.error.number()
    }

    /// The cause, without location and remedy.
    #[must_use]
    pub fn cause(&self, lang: Lang) -> String {
        let text = self.error.text().get(lang);
        match (self.error, self.details[0].get(1..).and_then(|code| GCode::find(code.parse().ok()?))) {
            // The function's name comes from the G-code table, in the chosen language.
            (ProgramError::LaterG | ProgramError::WrongKindG, Some(row)) => {
                fill(text, &[self.details[0].clone(), row.text.get(lang).to_owned()])
            }
            _ => fill(text, &self.details),
        }
    }

    /// The remedy.
    #[must_use]
    pub fn remedy(&self, lang: Lang) -> String {
        fill(self.error.remedy().get(lang), &self.details)
    }

    /// Program, line, column, cause and remedy in one line.
    #[must_use]
    pub fn text(&self, lang: Lang) -> String {
        let (program, line, column) = (&self.program, self.place.line, self.column);
        let (cause, remedy) = (self.cause(lang), self.remedy(lang));
        match lang {
            Lang::Zh => format!("{program} 第{line}行 第{column}列：{cause} – {remedy}"),
            Lang::En => format!("{program} line {line}, column {column}: {cause} – {remedy}"),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(Lang::En))
    }
}

fn fill(template: &str, details: &[String; 2]) -> String {
    template.replace("{}", &details[0]).replace("{2}", &details[1])
}

/// A mistake at a byte of the text; line and column are not determined yet.
#[derive(Clone, Debug)]
pub(crate) struct Wrong {
    pub at: usize,
    pub error: ProgramError,
    pub details: [String; 2],
}

/// Why reading a block stopped.
#[derive(Clone, Debug)]
pub(crate) enum Stop {
    /// A live value is needed: all motion must be done first.
    Drain,
    /// The text has a mistake.
    Wrong(Wrong),
}

/// The error is boxed to keep the success path small.
pub(crate) type Outcome<T> = Result<T, Box<Stop>>;

#[cold]
pub(crate) fn wrong<T>(at: usize, error: ProgramError) -> Outcome<T> {
    wrong2(at, error, "", "")
}

#[cold]
pub(crate) fn wrong1<T>(at: usize, error: ProgramError, detail: impl Into<String>) -> Outcome<T> {
    wrong2(at, error, detail, "")
}

#[cold]
pub(crate) fn wrong2<T>(
    at: usize,
    error: ProgramError,
    detail: impl Into<String>,
    second: impl Into<String>,
) -> Outcome<T> {
    Err(Box::new(Stop::Wrong(Wrong { at, error, details: [detail.into(), second.into()] })))
}

/// Determines line and column of a mistake.
pub(crate) fn fault_in(source: &Source, n: Option<u32>, mut wrong: Wrong) -> Fault {
    if wrong.error == ProgramError::ForeignCharacter
        && wrong.details[1].is_empty()
        && let Some((character, instead)) = source.foreign(wrong.at)
    {
        if character == char::REPLACEMENT_CHARACTER {
            wrong.error = ProgramError::BadEncoding;
            wrong.details =
                [source.bytes().get(wrong.at).map(|byte| format!("0x{byte:02X}")).unwrap_or_default(), instead];
        } else {
            wrong.details = [character.to_string(), instead];
        }
    }
    let (place, column) = source.place(wrong.at, n);
    Fault::new(source.title(), place, column, wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b1_a_fault_names_program_line_column_cause_and_remedy_in_both_languages() {
        let wrong = Wrong { at: 0, error: ProgramError::UnknownWord, details: ["Q9".into(), String::new()] };
        let fault = Fault::new("O1001", Place { program: 1001, line: 7, n: None }, 12, wrong);
        assert!(fault.text(Lang::En).starts_with("O1001 line 7, column 12: unknown word 'Q9' – "));
        assert!(fault.text(Lang::Zh).starts_with("O1001 第7行 第12列：无法识别的字 'Q9' – "));
        assert_eq!(fault.alarm(), 1);
    }
}
