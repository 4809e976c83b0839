//! `kt830 codes`: the table of the language of a kind of machine: codes, words, functions and system variables, and what
//! the control does with each. Source: spec B2, B3, B4, L2, S1, T4.

use serde_json::json;

use super::args::{OutputFormat, SharedArgs};
use super::{CallError, SUCCESS, print_line};
use crate::defs::availability::m_codes;
use crate::defs::gcode::{Availability, G_CODES, GCodeGroup};
use crate::defs::language_row::LanguageState;
use crate::defs::system_variable::{SYSTEM_VARIABLES, VariableAccess};
use crate::defs::text::Text;
use crate::nc;

/// One row: what kind of word, as it is written, its state and its meaning.
type CodeRow = (&'static str, String, LanguageState, Text);

/// Prints the table of the kind that the call names.
///
/// # Errors
/// The call names a machine: the kind of machine decides.
pub fn codes(shared: &SharedArgs) -> Result<u8, CallError> {
    if shared.machine.is_some() {
        return Err(CallError::new("--machine: the table is that of a kind of machine, --kind"));
    }
    for (class, word, state, text) in rows(shared) {
        match shared.format {
            OutputFormat::Text => {
                let line = format!("{class:<9} {word:<14} {:<10} {}", state.name(), text.get(shared.lang));
                print_line(line);
            }
            OutputFormat::Json => {
                print_line(json!({"class": class, "word": word, "state": state.name(), "zh": text.zh, "en": text.en}));
            }
        }
    }
    Ok(SUCCESS)
}

fn rows(shared: &SharedArgs) -> Vec<CodeRow> {
    let dialect = shared.kind.dialect();
    let mut rows = Vec::new();
    if dialect.is_kt830() {
        rows.extend(G_CODES.iter().map(|row| {
            let state = match (row.availability_on(dialect.is_mill()), row.group) {
                (
                    Availability::Yes,
                    GCodeGroup::DrillingCycle | GCodeGroup::LengthCompensation | GCodeGroup::Rotation,
                ) => LanguageState::NoEffect,
                (Availability::Yes, _) => LanguageState::Supported,
                (Availability::NoEncoder | Availability::No, _) => LanguageState::Refused,
            };
            ("G", format!("G{:02}", row.code), state, row.text)
        }));
    }
    rows.extend(dialect.words().iter().map(|word| {
        let class = if is_code(word.word, 'G') {
            "G"
        } else if is_code(word.word, 'M') {
            "M"
        } else {
            "word"
        };
        (class, word.word.to_owned(), LanguageState::Supported, word.text)
    }));
    rows.extend(dialect.language_rows().map(|row| (row.class, row.word.to_owned(), row.state, row.text)));
    let refused = nc::refused_words(dialect);
    rows.extend(refused.iter().map(|word| ("word", (*word).to_owned(), LanguageState::Refused, OF_LARGER_CONTROLS)));
    rows.extend(m_codes(shared.kind).map(|row| ("M", format!("M{:02}", row.code), LanguageState::Supported, row.name)));
    rows.extend(
        dialect
            .m_codes()
            .filter(|row| m_codes(shared.kind).all(|own| own.code != row.code))
            .map(|row| ("M", format!("M{:02}", row.code), LanguageState::Refused, row.name)),
    );
    rows.extend(
        nc::function_names(dialect).map(|name| ("function", name.to_owned(), LanguageState::Supported, FUNCTION)),
    );
    if dialect.is_kt830() {
        rows.extend(SYSTEM_VARIABLES.iter().map(|range| {
            let class = match range.access {
                VariableAccess::Read => "read",
                VariableAccess::ReadWrite => "variable",
                VariableAccess::Write => "write",
            };
            let last = range.first + range.count - 1;
            let word = if range.count == 1 { format!("#{last}") } else { format!("#{}-#{last}", range.first) };
            (class, word, LanguageState::Supported, range.name)
        }));
    }
    rows
}

/// Whether a word is a code: the letter and a number.
fn is_code(word: &str, letter: char) -> bool {
    word.strip_prefix(letter)
        .is_some_and(|number| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
}

const OF_LARGER_CONTROLS: Text = Text::new("较大的西门子系统的词", "a word of larger controls");
const FUNCTION: Text = Text::new("函数", "function");
