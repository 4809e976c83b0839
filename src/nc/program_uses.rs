//! Finds the variables that a program reads and writes, and the programs it calls, for the page designer; checks its
//! rows of texts.
//! Variables with computed numbers (`#[#1+2]`) are not found.
//! Source: spec B3, B8, K7.4, S1.

use std::collections::BTreeMap;

use super::dialect;
use super::message_texts::TextRowFault;
use super::settings::Dialect;
use super::source::Source;
use crate::defs::mcode::SwitchedUnit;
use crate::defs::page_text::{VariableUse, is_allowed_on_page};
use crate::defs::variable_name;

/// Most lines that are scanned.
const MAX_LINES: usize = 1_000_000;

/// The variables and programs that a program uses.
#[derive(Clone, Debug, Default)]
pub struct ProgramUses {
    /// The variables that a page can show, by number.
    pub variables: BTreeMap<u16, VariableUse>,
    /// The numbers of the called programs.
    pub calls: Vec<u32>,
}

/// The units that a program starts (K3.4, K3.7). Computed codes are not found.
#[derive(Clone, Debug, Default)]
pub struct UnitUse {
    /// It has an M code that starts the wheel.
    pub starts_wheel: bool,
    /// It has an M code that starts headstock, roll or table.
    pub starts_work_drive: bool,
    /// The numbers of the called programs.
    pub calls: Vec<u32>,
}

impl UnitUse {
    /// Scans a program.
    #[must_use]
    pub fn of(source: &Source) -> Self {
        let (mut found, dialect) = (Self::default(), source.dialect());
        for line in 1..=source.line_count() as u32 {
            let bytes = &source.bytes()[source.line_start(line - 1)..source.line_start(line)];
            // M03, M98, G65, G66: most lines of a long program have none of them.
            let has = |letter: u8| bytes.iter().any(|byte| byte.eq_ignore_ascii_case(&letter));
            if has(b'M') || has(b'G') && bytes.windows(2).any(is_macro_code) {
                let (code, _) = split_comment(&source.line(line).unwrap_or_default(), dialect);
                for unit in code.split('M').skip(1).filter_map(|behind| switched_unit(behind, dialect)) {
                    match unit {
                        (SwitchedUnit::Wheel, on) => found.starts_wheel |= on,
                        (SwitchedUnit::WorkDrive, on) => found.starts_work_drive |= on,
                        (SwitchedUnit::Coolant, _) => {}
                    }
                }
                found.calls.extend((dialect::rules(dialect).call_in_text)(&code));
            }
        }
        found.calls.sort_unstable();
        found.calls.dedup();
        found
    }
}

/// Whether two bytes may be the digits of G65 or G66.
fn is_macro_code(digits: &[u8]) -> bool {
    matches!(digits, b"65" | b"66")
}

/// What the M word switches whose text behind the letter this is.
fn switched_unit(behind: &str, dialect: Dialect) -> Option<(SwitchedUnit, bool)> {
    let digits = behind.trim_start();
    let digits = &digits[..digits.bytes().take_while(u8::is_ascii_digit).count()];
    dialect.m_code(digits.parse().ok()?)?.action.switched_unit()
}

/// Scans a program.
#[must_use]
pub fn find_uses(source: &Source, dialect: Dialect) -> ProgramUses {
    let mut found = ProgramUses::default();
    for line in 1..=source.line_count().min(MAX_LINES) as u32 {
        scan_line(&mut found, source, line, dialect);
    }
    found
}

/// Rows of texts of a program that do not fit: for the check (B8).
#[must_use]
pub fn text_row_faults(source: &Source) -> Vec<TextRowFault> {
    let (texts, shown) = source.message_texts();
    if texts.has_no_rows() {
        return Vec::new();
    }
    let lines = 1..=source.line_count().min(MAX_LINES) as u32;
    let code = lines.map(|line| split_comment(&source.line(line).unwrap_or_default(), source.dialect()).0);
    texts.faults(code, shown.iter())
}

/// Splits a line into its code without comments and quoted texts, and its first comment.
fn split_comment(text: &str, dialect: Dialect) -> (String, String) {
    let (mut code, mut comment) = (String::with_capacity(text.len()), String::new());
    let (mut depth, mut quoted) = (0_u32, false);
    let mut signs = text.chars().peekable();
    let brackets = dialect.has_bracket_comments();
    while let Some(sign) = signs.next() {
        match sign {
            '"' | '“' | '”' => quoted = !quoted,
            _ if quoted => {}
            '(' if brackets => depth += 1,
            ')' if brackets => depth = depth.saturating_sub(1),
            _ if depth > 0 => comment.push(sign),
            '/' if signs.peek() == Some(&'/') => break,
            ';' => {
                if comment.is_empty() {
                    comment = signs.collect();
                }
                break;
            }
            _ => code.push(sign.to_ascii_uppercase()),
        }
    }
    (code, comment.trim().to_owned())
}

fn scan_line(found: &mut ProgramUses, source: &Source, line: u32, dialect: Dialect) {
    let Some(text) = source.line(line) else { return };
    let (code, comment) = split_comment(&text, dialect);
    let bytes = code.as_bytes();
    let macro_a = code.contains("G65") && code.contains('H');
    let mut at = 0;
    while at < bytes.len() {
        let letter = bytes[at];
        let before = at.checked_sub(1).map_or(b' ', |before| bytes[before]);
        let starts = letter == b'#' || (letter == b'R' && dialect.has_r_parameters() && !before.is_ascii_alphabetic());
        let digits = bytes[at + 1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        if starts && digits > 0 {
            let end = at + 1 + digits;
            if let Some(variable) = variable_name::parse(&code[at..end]).filter(|number| is_allowed_on_page(*number)) {
                let rest = code[end..].trim_start();
                let result = rest.starts_with('=') && !rest.starts_with("==") || macro_a && before == b'P';
                let entry = found.variables.entry(variable).or_insert_with(|| {
                    let (place, comment) = ((source.number(), line), comment.clone());
                    VariableUse { variable, place, comment, ..VariableUse::default() }
                });
                if result { entry.writes = true } else { entry.reads = true }
            }
            at = end;
            continue;
        }
        at += 1;
    }
    found.calls.extend((dialect::rules(dialect).call_in_text)(&code));
}
