//! Finds the variables that a program reads and writes, and the programs it calls, for the page designer.
//! Variables with computed numbers (`#[#1+2]`) are not found.
//! Source: spec B3, K7.4, S1.

use std::collections::BTreeMap;

use super::dialect;
use super::settings::Dialect;
use super::source::Source;
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

/// Scans a program.
#[must_use]
pub fn find_uses(source: &Source, system: Dialect) -> ProgramUses {
    let mut found = ProgramUses::default();
    for line in 1..=source.line_count().min(MAX_LINES) as u32 {
        let Some(text) = source.line(line) else { continue };
        let (code, comment) = split_comment(&text, system);
        scan_line(&mut found, &code, &comment, (source.number(), line), system);
    }
    found
}

/// Splits a line into its code without comments and quoted texts, and its first comment.
fn split_comment(text: &str, system: Dialect) -> (String, String) {
    let (mut code, mut comment) = (String::with_capacity(text.len()), String::new());
    let (mut depth, mut quoted) = (0_u32, false);
    let mut signs = text.chars().peekable();
    let brackets = system.has_bracket_comments();
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

fn scan_line(found: &mut ProgramUses, code: &str, comment: &str, place: (u32, u32), system: Dialect) {
    let bytes = code.as_bytes();
    let macro_a = code.contains("G65") && code.contains('H');
    let mut at = 0;
    while at < bytes.len() {
        let letter = bytes[at];
        let before = at.checked_sub(1).map_or(b' ', |before| bytes[before]);
        let starts = letter == b'#' || (letter == b'R' && system.has_r_parameters() && !before.is_ascii_alphabetic());
        let digits = bytes[at + 1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        if starts && digits > 0 {
            let end = at + 1 + digits;
            if let Some(variable) = variable_name::parse(&code[at..end]).filter(|number| is_allowed_on_page(*number)) {
                let rest = code[end..].trim_start();
                let result = rest.starts_with('=') && !rest.starts_with("==") || macro_a && before == b'P';
                let entry = found.variables.entry(variable).or_insert_with(|| {
                    let comment = comment.to_owned();
                    VariableUse { variable, place, comment, ..VariableUse::default() }
                });
                if result { entry.writes = true } else { entry.reads = true }
            }
            at = end;
            continue;
        }
        at += 1;
    }
    found.calls.extend((dialect::rules(system).call_in_text)(code));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str, system: Dialect) -> Vec<(u16, bool, bool)> {
        let found = find_uses(&Source::new(1001, "", text.as_bytes().to_vec(), system), system);
        found.variables.values().map(|one| (one.variable, one.reads, one.writes)).collect()
    }

    #[test]
    fn k7_4_what_a_program_reads_and_writes() {
        let text =
            "#101=#500-#502 (#503)\nIF[#504 EQ 1]GOTO 5\nG01 X#505 F[#506*2]\n//X#507\n;#508\n#1=#[#2+3]\n#434=1\n";
        let read = |variable| (variable, true, false);
        assert_eq!(
            of(text, Dialect::LatheA),
            [(101, false, true), read(500), read(502), read(504), read(505), read(506)]
        );
        assert_eq!(
            of("G65 H02 P#510 Q#511 R1\n#512=#512+1", Dialect::Mill),
            [(510, false, true), (511, true, false), (512, true, true)]
        );
        assert_eq!(of("IF[#500==1]GOTO 1", Dialect::LatheA), [read(500)]);
    }

    #[test]
    fn s1_r_parameters_are_variables() {
        let text = "R60=R60-R28 ; R1\nX=R20\nMSG(\"R5\")\nG2 X1 CR=5\nIF (R7==R8) GOTOF AA1";
        let found: Vec<_> = of(text, Dialect::Sinumerik).into_iter().map(|(number, ..)| number - 600).collect();
        assert_eq!(found, [7, 8, 20, 28, 60]);
    }

    #[test]
    fn k7_4_called_programs_are_named() {
        let text = "M98 P9010 L2\nG65 P9011 A1\nM98 P00029012\nG65 H80 P100";
        let found = find_uses(&Source::new(1, "", text.as_bytes().to_vec(), Dialect::LatheA), Dialect::LatheA);
        assert_eq!(found.calls, [9010, 9011, 9012]);
    }
}
