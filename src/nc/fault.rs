//! Program mistakes and their exact location. Source: spec B1, B8.

use std::fmt;

use crate::defs::gcode::GCode;
pub(crate) use crate::defs::program_error::ProgramError as E;
use crate::defs::text::Lang;

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

/// A program mistake: its location, its row in the error table, and details.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct ProgramFault {
    /// The block.
    pub location: BlockLocation,
    /// The column, from 1, counted in characters.
    pub column: u32,
    /// The row of the error table.
    pub error: E,
    details: [String; 2],
    /// The displayed name of the program.
    program_title: Box<str>,
}

impl ProgramFault {
    pub(crate) fn new(program: impl Into<Box<str>>, place: BlockLocation, column: u32, wrong: ErrorAt) -> Self {
        Self { location: place, column, error: wrong.error, details: wrong.details, program_title: program.into() }
    }

    /// The displayed name of the program.
    #[must_use]
    pub fn program_title(&self) -> &str {
        &self.program_title
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
            (E::UnavailableG | E::WrongKindG, Some(row)) => {
                fill_template(text, &[self.details[0].clone(), row.text.get(lang).to_owned()])
            }
            _ => fill_template(text, &self.details),
        }
    }

    /// The remedy.
    #[must_use]
    pub fn remedy(&self, lang: Lang) -> String {
        fill_template(self.error.remedy().get(lang), &self.details)
    }

    /// Program, line, column, cause and remedy in one line.
    #[must_use]
    pub fn text(&self, lang: Lang) -> String {
        let (program, line, column) = (&self.program_title, self.location.line, self.column);
        let (cause, remedy) = (self.cause(lang), self.remedy(lang));
        match lang {
            Lang::Zh => format!("{program} 第{line}行 第{column}列：{cause} – {remedy}"),
            Lang::En => format!("{program} line {line}, column {column}: {cause} – {remedy}"),
        }
    }
}

impl fmt::Display for ProgramFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(Lang::En))
    }
}

fn fill_template(template: &str, details: &[String; 2]) -> String {
    template.replace("{}", &details[0]).replace("{2}", &details[1])
}

/// A mistake at a byte of the text; line and column are not determined yet.
#[derive(Clone, Debug)]
pub(crate) struct ErrorAt {
    pub at: usize,
    pub error: E,
    pub details: [String; 2],
}

/// Why reading a block stopped.
#[derive(Clone, Debug)]
pub(crate) enum ReadStop {
    /// A live value is needed: all motion must be done first.
    Drain,
    /// The text has a mistake.
    Error(ErrorAt),
}

/// The error is boxed to keep the success path small.
pub(crate) type ReadResult<T> = Result<T, Box<ReadStop>>;

#[cold]
pub(crate) fn fail<T>(at: usize, error: E) -> ReadResult<T> {
    fail2(at, error, "", "")
}

#[cold]
pub(crate) fn fail1<T>(at: usize, error: E, detail: impl Into<String>) -> ReadResult<T> {
    fail2(at, error, detail, "")
}

#[cold]
pub(crate) fn fail2<T>(at: usize, error: E, detail: impl Into<String>, second: impl Into<String>) -> ReadResult<T> {
    Err(Box::new(ReadStop::Error(ErrorAt { at, error, details: [detail.into(), second.into()] })))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b1_a_fault_names_program_line_column_cause_and_remedy_in_both_languages() {
        let wrong = ErrorAt { at: 0, error: E::UnknownWord, details: ["Q9".into(), String::new()] };
        let fault = ProgramFault::new("O1001", BlockLocation { program: 1001, line: 7, n: None }, 12, wrong);
        assert!(fault.text(Lang::En).starts_with("O1001 line 7, column 12: unknown word 'Q9' – "));
        assert!(fault.text(Lang::Zh).starts_with("O1001 第7行 第12列：无法识别的字 'Q9' – "));
        assert_eq!(fault.alarm(), 1);
    }
}
