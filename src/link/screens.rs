//! The page files of the grinding and the dressing page, as read from the disk.
//! Source: spec K7.3, K7.4.

use std::borrow::Cow;
use std::sync::Arc;

use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::page_text::{PageText, PageTextRow};
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, Template};

/// Programs with a grinding page of their own (K7.2).
pub const PROGRAMS_WITH_PAGE: std::ops::RangeInclusive<u32> = 1_001..=1_020;
/// Base of the page numbers: file C0001 belongs to page 1001.
pub const PAGE_FILES: u32 = 1_000;

/// The page files as read from the disk.
#[derive(Clone, Debug, Default)]
pub struct Screens {
    /// One entry per program O1001–O1020 that has a file, by program number; the own pages of a kind have 1000 plus
    /// their file number.
    pub pages: Vec<(u32, ScreenFiles)>,
    /// The picture of the dressing page, or its fault; none until the folder has been read.
    pub dressing: Option<Result<Arc<Picture>, FileFault>>,
}

impl Screens {
    /// The files of a program.
    #[must_use]
    pub fn find(&self, program: u32) -> Option<&ScreenFiles> {
        self.pages.iter().find(|(number, _)| *number == program).map(|(_, files)| files)
    }

    /// The row of a variable on the grinding pages of a program: those of the kind, else its own.
    #[must_use]
    pub fn row(&self, kind: Kind, program: u32, variable: u16) -> Option<&PageTextRow> {
        self.rows(kind.row().page_files, program).find(|row| row.variable == variable)
    }

    /// The rows that tell what part a program makes; none where there is no page or its text is faulty.
    pub fn part_rows(&self, kind: Kind, program: u32) -> impl Iterator<Item = &PageTextRow> {
        let rows = Page::Grinding.exists_on(kind).then(|| self.rows(kind.row().part_files, program));
        rows.into_iter().flatten()
    }

    /// The rows of the pages of a kind, or of a program where the kind has none.
    fn rows(&self, own: &'static [u32], program: u32) -> impl Iterator<Item = &PageTextRow> {
        let of_program = (own.is_empty() && PROGRAMS_WITH_PAGE.contains(&program)).then_some(program);
        let numbers = own.iter().map(|number| PAGE_FILES + number).chain(of_program);
        numbers.filter_map(|number| self.find(number)?.text.as_ref().ok()).flat_map(|text| text.rows())
    }
}

/// Page text and picture of one program.
#[derive(Clone, Debug)]
pub struct ScreenFiles {
    /// The page text with its English, or its fault.
    pub text: Result<Arc<PageText>, FileFault>,
    /// The fault of the English text, if it has one; the page is then shown as written.
    pub english_fault: Option<FileFault>,
    /// The picture, or its fault.
    pub picture: Result<Arc<Picture>, FileFault>,
    /// Where the picture shows variables; empty without D00nn.RON.
    pub labels: Vec<PictureLabel>,
    /// The fault of D00nn.RON, if it has one; the picture then answers no touch.
    pub labels_fault: Option<FileFault>,
}

/// Where a picture shows the number of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureLabel {
    /// The variable.
    pub variable: u16,
    /// Left, top, right, bottom, pixels of the picture.
    pub area: (u16, u16, u16, u16),
}

/// A page picture, 200 × 400 px, 24 bit: the bytes of its BMP file. The pictures of all programs stay in memory, shipped ones
/// as they are in the program; one is painted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture(pub Cow<'static, [u8]>);

/// A fault in a file of the screens folder: file, line if known, cause and remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileFault {
    /// File name.
    pub file: String,
    /// Line and column, from 1, of a text.
    pub position: Option<(u32, u32)>,
    /// Cause and remedy.
    pub message: LocalizedText,
}

const FAULT_AT_PLACE: &Template =
    &Template::new("{file} {place}：{message}", "{file} {place}: {message}", &["file", "place", "message"]);
const FAULT_OF_FILE: &Template = &Template::new("{file}：{message}", "{file}: {message}", &["file", "message"]);

impl FileFault {
    /// The fault with its place, as shown.
    #[must_use]
    pub fn full_message(&self) -> LocalizedText {
        let (file, message) = (self.file.as_str(), self.message.clone());
        match self.position {
            Some((line, column)) => {
                LocalizedText::phrase_of(FAULT_AT_PLACE, [file.into(), Arg::Place(line, column)], [message])
            }
            None => LocalizedText::phrase_of(FAULT_OF_FILE, [file.into()], [message]),
        }
    }
}
