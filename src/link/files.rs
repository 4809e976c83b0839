//! File requests of the pages and requests for long calculations, with their answers. The core decides if a request
//! is allowed; the work runs outside the tick, and the answer comes back as a command. Every request carries a ticket,
//! and its answer carries the same ticket: a page receives only the answers to its own requests.
//! Source: spec B6 (程序), K6.2, K7.8, H8 (progress, cancel).

use std::sync::Arc;

use ropey::Rope;

use super::drawing::Drawing;
use super::media::{MediaView, Print, Transfer};
use super::page_file::{PageFile, PictureFrom};
use crate::defs::alarm;
use crate::defs::param::ParamAddress;
use crate::defs::screw::ScrewTable;
use crate::defs::text::{Said, Text};
use crate::units::{Axis, PerAxis};

/// Maximum number of lines checked in one request.
pub const LOOKED_LINES: usize = 120;
/// Maximum number of characters checked in a line; no screen is wide enough for more.
pub const LOOKED_CHARS: usize = 1_000;

/// Number of answers kept for the pages: more than arrive between two frames.
const ANSWERS: usize = 16;

/// The sender of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Asker {
    /// The program page.
    Editor,
    /// The page designer.
    Designer,
    /// The directory.
    Directory,
    /// The USB and RS232 page.
    Transfer,
    /// The leadscrew table page.
    Screw,
    /// The graphic page.
    Graphic,
    /// The teach-in page.
    Teach,
    /// The screen itself: screenshots and saved tables.
    Screen,
}

/// Identifies a request. The sender assigns it, the answer carries it back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ticket {
    /// The sender of a request.
    pub asker: Asker,
    /// Counts the requests of one sender.
    pub number: u32,
}

impl Ticket {
    /// The ticket of a request whose answer is ignored.
    #[must_use]
    pub const fn unheard(asker: Asker) -> Self {
        Self { asker, number: 0 }
    }
}

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum FileRequest {
    /// Opens the editor: asks only whether the program may be edited now.
    MayEdit(u32),
    /// Replaces the text of a program.
    Save {
        /// O number.
        number: u32,
        /// The new text.
        text: Rope,
        /// Checksum of the text that was edited; the file on the disk must still have it.
        base: u64,
        /// Replaces the file even if it was changed.
        force: bool,
    },
    /// Saves a recorded program under the next free name (L9).
    Record(String),
    /// Checks the syntax of lines while they are typed.
    Look {
        /// O number, for the places of errors.
        number: u32,
        /// Number of the first line, from 1.
        first: u32,
        /// The lines.
        text: String,
        /// Returned with the answer.
        token: u64,
    },
    /// A new, empty program.
    New(u32),
    /// A copy of a program under a free number.
    Copy {
        /// O number.
        from: u32,
        /// A free one.
        to: u32,
    },
    /// Another number for a program.
    Rename {
        /// O number.
        from: u32,
        /// A free one.
        to: u32,
    },
    /// Deletes a program.
    Delete(u32),
    /// Computes the tool path of a program by a check run from the current machine position.
    Draw(u32),
    /// Lists the files on both sides of a transfer.
    Media,
    /// Copies files to or from a medium.
    Transfer(Transfer),
    /// Saves a screenshot.
    Print(Print),
    /// Saves a table of samples as CSV.
    Table(String),
    /// Reads a page text for editing, with the variables that the program uses.
    ReadPage {
        /// 1000 plus the file number.
        page: u32,
        /// O number of the program.
        program: u32,
    },
    /// Replaces a page text.
    SavePage {
        /// 1000 plus the file number.
        page: u32,
        /// The new text.
        text: Rope,
        /// Checksum of the file that was edited; 0 if there was none.
        base: u64,
        /// Replaces the file even if it was changed.
        force: bool,
    },
    /// Takes a picture for a page; another format is converted (K5.12).
    TakePicture {
        /// 1000 plus the file number.
        page: u32,
        /// Where the picture is.
        from: PictureFrom,
        /// Its file name.
        name: String,
    },
    /// Reads the leadscrew table of an axis from a file of the medium (B7).
    ScrewIn(Axis),
    /// Writes the leadscrew table of an axis to a file.
    ScrewOut(Axis, ScrewTable),
    /// Cancels the long operation in progress.
    Cancel,
}

/// An error in a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineFault {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Cause and remedy.
    pub said: Said,
}

/// The result of checking lines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Looked {
    /// The token of the request.
    pub token: u64,
    /// The errors, by line.
    pub faults: Vec<LineFault>,
}

/// Why a request was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The file was changed elsewhere since it was opened.
    Conflict,
    /// The program password is required (K6.2).
    Password,
    /// The machine builder's password is required.
    Builder,
    /// These files already exist with different content.
    Overwrite(Vec<String>),
    /// These pictures are not 200×400 px in 24 bits; one fault each.
    Convert(Vec<Said>),
    /// An alarm of the table, with its place.
    Alarm(u16, Said),
    /// Any other reason.
    Because(Said),
}

impl Refusal {
    /// The text shown.
    #[must_use]
    pub fn said(&self) -> Said {
        match self {
            Self::Conflict => Text::new("文件已被别处改动", "the file was changed elsewhere meanwhile").into(),
            Self::Password => Text::new("需要程序编辑密码", "the password for editing programs is needed").into(),
            Self::Builder => Text::new("需要机床厂密码", "the machine builder's password is needed").into(),
            Self::Overwrite(names) => Said::new(
                format!("{} 个文件已存在且内容不同", names.len()),
                format!("{} files are there already and differ", names.len()),
            ),
            Self::Convert(faults) => faults.first().cloned().unwrap_or_default(),
            Self::Alarm(number, detail) => alarm::find(*number).map_or_else(
                || detail.clone(),
                |row| {
                    Said::new(
                        format!("{}：{}。{}", row.text.zh, detail.zh, row.remedy.zh),
                        format!("{}: {}. {}", row.text.en, detail.en, row.remedy.en),
                    )
                },
            ),
            Self::Because(said) => said.clone(),
        }
    }
}

/// Values read from a file; all of them are within their ranges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Restored {
    /// Parameters.
    pub params: Vec<(ParamAddress, f64)>,
    /// Macro variables.
    pub variables: Vec<(u16, f64)>,
    /// Offsets 1 to 16: geometry and wear, radius mm.
    pub offsets: Vec<(usize, PerAxis<f64>, PerAxis<f64>)>,
    /// Work offsets, 0 is G54; machine coordinates, radius mm.
    pub frames: Vec<(usize, PerAxis<f64>)>,
}

/// An answer of the work outside the tick.
#[derive(Clone, Debug, PartialEq)]
pub enum FileAnswer {
    /// The request was executed.
    Done(Said),
    /// A program was saved.
    Saved {
        /// Message.
        said: Said,
        /// O number.
        number: u32,
        /// Checksum of the new file.
        stamp: u64,
    },
    /// The request was refused; nothing was changed.
    Refused(Refusal),
    /// The result of checking lines.
    Looked(Looked),
    /// Lists the files on both sides of a transfer.
    Media(MediaView),
    /// A page text for editing.
    Page(Arc<PageFile>),
    /// Values of a file; the core applies them.
    Restored(Box<Restored>),
    /// A leadscrew table of an axis and the file it was read from; the core applies it.
    Screw(Axis, ScrewTable, String),
    /// A tool path.
    Drawn(Arc<Drawing>),
    /// Progress of an operation: its name, and the part done in thousandths.
    Progress(Text, u16),
    /// Bytes received so far of an operation of unknown length, with its name.
    Bytes(Text, u64),
}

/// The result of a request that was executed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Deed {
    /// Message.
    pub said: Said,
    /// O number and checksum of the text that was saved.
    pub saved: Option<(u32, u64)>,
}

/// A finished request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answered {
    /// The ticket of the request.
    pub ticket: Ticket,
    /// The result, or the reason of the refusal.
    pub result: Result<Deed, Refusal>,
}

/// The state of file requests as the pages see it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilesView {
    /// The last finished requests, newest last.
    pub answers: Vec<Answered>,
    /// The files on both sides of a transfer, as last listed.
    pub media: Option<Arc<MediaView>>,
    /// The last page text read.
    pub page: Option<Arc<PageFile>>,
    /// The last tool path computed.
    pub drawing: Option<Arc<Drawing>>,
    /// Long operation in progress: its name, thousandths done.
    pub busy: Option<(Text, u16)>,
    /// Bytes received so far, where the length is unknown.
    pub bytes: Option<u64>,
    /// The result of the last line check.
    pub looked: Arc<Looked>,
}

impl FilesView {
    /// Stores an answer for its sender; drops the oldest answer if the list is full.
    pub fn answer(&mut self, ticket: Ticket, result: Result<Deed, Refusal>) {
        if self.answers.len() >= ANSWERS {
            self.answers.remove(0);
        }
        self.answers.push(Answered { ticket, result });
    }
}
