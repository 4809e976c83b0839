//! Names of numbered files: a letter, four digits (a program may have up to eight), an extension; case-insensitive.

use crate::defs::program_number;

/// Maximum size of a part program, bytes: some five million blocks.
pub const PROGRAM_LIMIT: u64 = 128 * 1024 * 1024;
/// Maximum size of all programs of a folder together, bytes: they stay in memory, with text and index.
pub const PROGRAMS_LIMIT: u64 = 2 * PROGRAM_LIMIT;
/// Maximum size of a text named in a call or a story (story, part, leadscrew table), bytes.
pub const TEXT_LIMIT: u64 = 16 * 1024 * 1024;
/// Maximum size of a page text, bytes; a real one has 22 short lines.
pub const PAGE_TEXT_LIMIT: u64 = 64 * 1024;
/// Maximum size of a picture, bytes; 200 × 400 pixels in 24 bits are 240 054 (K5.12).
pub const PICTURE_LIMIT: u64 = 1024 * 1024;

/// Part programs `O1001.NC` (B1), `O12345678.NC`.
pub const PROGRAM: FileClass = FileClass {
    letter: 'O',
    max_digits: program_number::O_MAX_DIGITS as usize,
    extensions: &["NC"],
    limit: PROGRAM_LIMIT,
    comment_source: CommentSource::FirstComment,
};
/// Page texts `C0001.TXT`; `C0001.NC` is used only without it (K7.3).
pub const PAGE_TEXT: FileClass = FileClass {
    letter: 'C',
    max_digits: DIGITS,
    extensions: &["TXT", "NC"],
    limit: PAGE_TEXT_LIMIT,
    comment_source: CommentSource::Title,
};
/// English texts of the pages, `C0001.EN.TXT`, beside the page texts (H9).
pub const PAGE_TEXT_EN: FileClass = FileClass {
    letter: 'C',
    max_digits: DIGITS,
    extensions: &["EN.TXT"],
    limit: PAGE_TEXT_LIMIT,
    comment_source: CommentSource::Title,
};
/// Pictures `B0001.BMP` (K7.3).
pub const PICTURE: FileClass = FileClass {
    letter: 'B',
    max_digits: DIGITS,
    extensions: &["BMP"],
    limit: PICTURE_LIMIT,
    comment_source: CommentSource::None,
};

/// Places of the variables in a picture, `D0001.RON`.
pub const PICTURE_LABELS: FileClass = FileClass {
    letter: 'D',
    max_digits: DIGITS,
    extensions: &["RON"],
    limit: PAGE_TEXT_LIMIT,
    comment_source: CommentSource::None,
};

/// The files of the pages.
pub const PAGE_FILES: [FileClass; 4] = [PAGE_TEXT, PAGE_TEXT_EN, PICTURE, PICTURE_LABELS];

/// A type of file: its names and its maximum size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileClass {
    /// The letter before the number, upper case.
    pub letter: char,
    /// Most digits of the number; it has at least four.
    pub max_digits: usize,
    /// Extensions in upper case; earlier ones have priority.
    pub extensions: &'static [&'static str],
    /// Maximum size, bytes.
    pub limit: u64,
    /// Source of the comment in the directory.
    pub comment_source: CommentSource,
}

/// Source of the comment line of a directory entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommentSource {
    /// The first `( )` or `;` comment at the start of the file, as in programs.
    FirstComment,
    /// The text up to the first `;`, as in page texts (K7.4).
    Title,
    /// No comment: the file is not text.
    None,
}

/// Number of digits in the name of a page file; the least in that of a program.
const DIGITS: usize = program_number::O_DIGITS as usize;

impl FileClass {
    /// The largest number in a name.
    #[must_use]
    pub const fn largest_number(&self) -> u32 {
        10_u32.pow(self.max_digits as u32) - 1
    }

    /// The file name for a number, as written by this control: `O1001.NC`.
    #[must_use]
    pub fn file_name(&self, number: u32) -> String {
        let extension = self.extensions.first().copied().unwrap_or_default();
        format!("{}{number:04}.{extension}", self.letter)
    }

    /// Number and rank of the extension (0 is best) of a name, case-insensitive; `None` for names of other classes.
    #[must_use]
    pub fn parse(&self, name: &str) -> Option<(u32, usize)> {
        let (stem, extension) = name.split_once('.')?;
        let rank = self.extensions.iter().position(|known| known.eq_ignore_ascii_case(extension))?;
        let digits = stem.strip_prefix([self.letter, self.letter.to_ascii_lowercase()])?;
        Some((program_number::of_digits(digits, self.max_digits)?, rank))
    }

    /// The comment line of a file that starts with `head`.
    pub(super) fn comment_in(&self, head: &str) -> String {
        match self.comment_source {
            CommentSource::FirstComment => first_comment(head),
            CommentSource::Title => head.split([';', '；']).next().unwrap_or_default().trim().to_owned(),
            CommentSource::None => String::new(),
        }
    }
}

/// The first comment of a program: `( )`, `//` or after `;`.
pub(super) fn first_comment(head: &str) -> String {
    for line in head.lines() {
        let after = |mark: &str| line.split_once(mark).map(|(_, rest)| rest);
        let bracketed = after("(").map(|rest| rest.split(')').next().unwrap_or_default());
        let found = bracketed.or_else(|| Some(after(";")?.trim_start_matches(';'))).or_else(|| after("//"));
        let found = found.unwrap_or_default().trim();
        if !found.is_empty() {
            return found.to_owned();
        }
    }
    String::new()
}
