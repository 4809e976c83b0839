//! The programs of one text: exports of other controls hold several between two `%`, each with its number.
//! Source: spec B1, K7.8.

use std::ops::Range;

use super::dialect;
use crate::defs::kind::Dialect;

/// A program in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramPart {
    /// The number that its text gives; none only for the first program of a text.
    pub number: Option<u32>,
    /// Its name if its text gives one: `L10.SPF`.
    pub name: Option<String>,
    /// Its bytes in the text.
    pub bytes: Range<usize>,
    /// The lines of the text before it.
    pub lines_before: u32,
}

/// The programs of a text, in its order; a text without a number is one program.
///
/// GC, GS, GA: a program begins at a line with `O1001` or `:1001`. 802D: at a line with `%_N_NAME_MPF`.
#[must_use]
pub fn program_parts(text: &[u8], dialect: Dialect) -> Vec<ProgramPart> {
    let part = |(number, name): (Option<u32>, Option<String>), start: usize, lines_before: u32| ProgramPart {
        number,
        name,
        bytes: start..text.len(),
        lines_before,
    };
    let heading = dialect::rules(dialect).program_heading;
    let mut parts: Vec<ProgramPart> = Vec::new();
    let (mut start, mut lines) = (0, 0);
    while start < text.len() {
        let rest = &text[start..];
        let length = rest.iter().position(|byte| matches!(byte, b'\r' | b'\n')).unwrap_or(rest.len());
        let line = &rest[..length];
        if let Some((number, name)) = heading(line) {
            let (from, lines_before) = if parts.is_empty() { (0, 0) } else { (start, lines) };
            parts.last_mut().into_iter().for_each(|before| before.bytes.end = from);
            parts.push(part((Some(number), name), from, lines_before));
        } else if parts.is_empty() && !is_before_block(line, dialect) {
            parts.push(part((None, None), 0, 0));
        }
        start += length + 1 + usize::from(rest[length..].starts_with(b"\r\n"));
        lines += 1;
    }
    if parts.is_empty() {
        parts.push(part((None, None), 0, 0));
    }
    parts
}

/// The lines before the number of a program: `%`, blank lines and comments.
#[must_use]
pub fn lines_before_number(text: &[u8], dialect: Dialect) -> u32 {
    let lines = text.split(|byte| *byte == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
    lines.take_while(|line| is_before_block(line, dialect)).count() as u32
}

/// Whether a line may stand before the number of a program: `%`, blank, or a comment alone.
fn is_before_block(line: &[u8], dialect: Dialect) -> bool {
    let line = line.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(line).trim_ascii();
    let line = line.strip_prefix(b"%").unwrap_or(line).trim_ascii_start();
    match line.first() {
        None | Some(b';') => true,
        Some(b'(') => {
            dialect.has_bracket_comments() && line.iter().position(|byte| *byte == b')') == Some(line.len() - 1)
        }
        Some(_) => line.starts_with(b"//"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::program_number;

    fn parts(text: &str) -> Vec<(Option<u32>, &str, u32)> {
        let found = program_parts(text.as_bytes(), Dialect::LatheA);
        found.into_iter().map(|part| (part.number, &text[part.bytes], part.lines_before)).collect()
    }

    #[test]
    fn b1_an_export_is_divided_at_its_numbers() {
        let text = "%\nO0031 (MAIN)\nM98 P0032\nM30\nO0032\nG00 X5\nM99\n:33\nM99\n%\n";
        assert_eq!(
            parts(text),
            [
                (Some(31), "%\nO0031 (MAIN)\nM98 P0032\nM30\n", 0),
                (Some(32), "O0032\nG00 X5\nM99\n", 4),
                (Some(33), ":33\nM99\n%\n", 7)
            ]
        );
        // Each between two % of its own, with CR LF, blanks and a title before the number.
        let text = "\r\n%\r\n(TITLE)\r\n  O7\r\nM99\r\n%\r\n%\r\nO00000008(B)\r\nM99\r\n%";
        assert_eq!(
            parts(text),
            [(Some(7), &text[..text.find("O0000").unwrap()], 0), (Some(8), "O00000008(B)\r\nM99\r\n%", 7)]
        );
        // CR alone.
        assert_eq!(parts("O1\rM99\rO2\rM99\r"), [(Some(1), "O1\rM99\r", 0), (Some(2), "O2\rM99\r", 2)]);
    }

    #[test]
    fn b1_a_text_without_number_is_one_program() {
        assert_eq!(parts("G00 X5\nM30\n"), [(None, "G00 X5\nM30\n", 0)]);
        assert_eq!(parts(""), [(None, "", 0)]);
        assert_eq!(parts("%\n(ONLY A TITLE)\n"), [(None, "%\n(ONLY A TITLE)\n", 0)]);
        // Blocks before the first number are a program of their own.
        assert_eq!(parts("G00 X5\nM30\nO2\nM99\n"), [(None, "G00 X5\nM30\n", 0), (Some(2), "O2\nM99\n", 2)]);
        // Not numbers of programs: too large, zero, an O word statement.
        assert_eq!(parts("O1\nO123456789\nO0\nO2X5\nM30\n").len(), 1);
    }

    #[test]
    fn s1_an_archive_is_divided_at_its_names() {
        let text = b"%_N_AA_MPF\n;$PATH=/_N_MPF_DIR\nL10\nM2\n%_N_L10_SPF\nM17\n";
        let found = program_parts(text, Dialect::Sinumerik);
        let told: Vec<_> = found.iter().map(|part| (part.name.as_deref(), part.lines_before)).collect();
        assert_eq!(told, [(Some("AA.MPF"), 0), (Some("L10.SPF"), 4)]);
        assert_eq!(found[1].number, Some(program_number::from_l(10)));
    }
}
