//! File requests of the pages and requests for long calculations, with their answers. The core decides if a request
//! is allowed; the work runs outside the tick, and the answer comes back as a command. Every request carries a ticket,
//! and its answer carries the same ticket: a page receives only the answers to its own requests.
//! Source: spec B6 (程序), K6.2, K7.8, H8 (progress, cancel).

use std::sync::Arc;

use ropey::Rope;

use super::line_fault::LineFault;
use super::media::{MediaView, Screenshot, TransferRequest};
use super::page_file::{PageFile, PageTextId, PictureLocation};
use super::screens::PictureLabel;
use super::teach::TaughtBlock;
use super::toolpath::Toolpath;
use crate::defs::alarm;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::param::ParamAddress;
use crate::defs::text::{LocalizedText, Template, Text, phrase};
use crate::units::{Axis, PerAxis};

/// Maximum number of lines checked in one request.
pub const MAX_CHECKED_LINES: usize = 120;
/// Maximum number of characters checked in a line; no screen is wide enough for more.
pub const MAX_CHECKED_CHARS: usize = 1_000;

/// Number of answers kept for the pages: more than arrive between two frames.
const MAX_ANSWERS: usize = 16;

/// The sender of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Requester {
    /// The program page.
    Editor,
    /// The page designer.
    Designer,
    /// The directory.
    Directory,
    /// The USB and RS232 page.
    Transfer,
    /// The leadscrew table page.
    Leadscrew,
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
    pub requester: Requester,
    /// Counts the requests of one sender.
    pub number: u32,
}

impl Ticket {
    /// The ticket of a request whose answer is ignored.
    #[must_use]
    pub const fn without_reply(asker: Requester) -> Self {
        Self { requester: asker, number: 0 }
    }
}

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum FileRequest {
    /// Opens the editor: asks only whether the program may be edited now.
    CheckEditable(u32),
    /// Replaces the text of a program.
    Save {
        /// O number.
        number: u32,
        /// The new text.
        text: Rope,
        /// Checksum of the text that was edited; the file on the disk must still have it.
        base_stamp: u64,
        /// Replaces the file even if it was changed.
        overwrite: bool,
    },
    /// Saves a recorded program under the next free name (L9).
    SaveRecording(Vec<TaughtBlock>),
    /// Checks the syntax of lines while they are typed.
    CheckLines {
        /// O number, for the places of errors.
        number: u32,
        /// Number of the first line, from 1.
        first_line: u32,
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
    ComputeToolpath(u32),
    /// Lists the files on both sides of a transfer.
    ListMedia,
    /// Copies files to or from a medium.
    Transfer(TransferRequest),
    /// Saves a screenshot.
    SaveScreenshot(Screenshot),
    /// Saves a table of samples as CSV.
    SaveTable(String),
    /// Saves a report as HTML.
    SaveReport(String),
    /// Reads a page text for editing, with the variables that the program uses.
    ReadPage {
        /// Which text.
        id: PageTextId,
        /// O number of the program.
        program: u32,
    },
    /// Replaces a page text.
    SavePage {
        /// Which text.
        id: PageTextId,
        /// The new text.
        text: Rope,
        /// Checksum of the file that was edited; 0 if there was none.
        base_stamp: u64,
        /// Replaces the file even if it was changed.
        overwrite: bool,
    },
    /// Takes a picture for a page; another format is converted (K5.12).
    ImportPicture {
        /// 1000 plus the file number.
        page: u32,
        /// Where the picture is.
        from: PictureLocation,
        /// Its file name.
        name: String,
    },
    /// Replaces the places of the variables in the picture of a page.
    SavePictureLabels {
        /// 1000 plus the file number.
        page: u32,
        /// The new places.
        labels: Vec<PictureLabel>,
        /// The places that were changed: others in the file are a conflict.
        base: Vec<PictureLabel>,
    },
    /// Reads the leadscrew table of an axis from a file of the medium (B7).
    ImportLeadscrew(Axis),
    /// Writes the leadscrew table of an axis to a file.
    ExportLeadscrew(Axis, LeadscrewCompensation),
    /// Cancels the long operation in progress.
    Cancel,
}

/// The result of checking lines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LineCheck {
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
    /// These files hold several programs, or have a name that is none of a program; their names and programs.
    Split(Vec<String>),
    /// These pictures are not 200×400 px in 24 bits; one fault each.
    Convert(Vec<LocalizedText>),
    /// An alarm of the table, with its place.
    Alarm(u16, LocalizedText),
    /// Any other reason.
    Other(LocalizedText),
}

const ALARM: &Template =
    &Template::new("{text}：{detail}。{remedy}", "{text}: {detail}. {remedy}", &["text", "remedy", "detail"]);

impl Refusal {
    /// The text shown.
    #[must_use]
    pub fn message(&self) -> LocalizedText {
        match self {
            Self::Conflict => Text::new("文件已被别处改动", "the file was changed elsewhere in the meantime").into(),
            Self::Password => Text::new("需要程序编辑密码", "the password for editing programs is needed").into(),
            Self::Builder => Text::new("需要机床厂密码", "the machine builder's password is needed").into(),
            Self::Overwrite(names) => {
                phrase!("{count} 个文件已存在且内容不同", "{count} files already exist and differ", count = names.len())
            }
            Self::Split(files) => {
                phrase!("{count} 个文件各有几个程序", "{count} files hold several programs", count = files.len())
            }
            Self::Convert(faults) => faults.first().cloned().unwrap_or_default(),
            Self::Alarm(number, detail) => alarm::find(*number).map_or_else(
                || detail.clone(),
                |row| LocalizedText::phrase_of(ALARM, [(&row.text).into(), (&row.remedy).into()], [detail.clone()]),
            ),
            Self::Other(message) => message.clone(),
        }
    }
}

/// Values read from a file; all of them are within their ranges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestoredValues {
    /// Parameters.
    pub params: Vec<(ParamAddress, f64)>,
    /// Macro variables.
    pub variables: Vec<(u16, f64)>,
    /// Offsets 1 to 16: geometry and wear, radius mm.
    pub offsets: Vec<(usize, PerAxis<f64>, PerAxis<f64>)>,
    /// Circles of offsets 1 to 16: radius in mm, and tip.
    pub cutters: Vec<(usize, f64, u8)>,
    /// Work offsets by the index that they are stored by, 0 is G54; machine coordinates, radius mm.
    pub work_offsets: Vec<(usize, PerAxis<f64>)>,
}

/// An answer of the work outside the tick.
#[derive(Clone, Debug, PartialEq)]
pub enum FileAnswer {
    /// The request was executed.
    Done(LocalizedText),
    /// A program was saved.
    Saved {
        /// Message.
        message: LocalizedText,
        /// O number.
        number: u32,
        /// Checksum of the new file.
        stamp: u64,
    },
    /// The request was refused; nothing was changed.
    Refused(Refusal),
    /// The result of checking lines.
    LinesChecked(LineCheck),
    /// Lists the files on both sides of a transfer.
    Media(MediaView),
    /// A page text for editing.
    Page(Arc<PageFile>),
    /// Values of a file; the core applies them.
    Restored(Box<RestoredValues>),
    /// A leadscrew table of an axis and the file it was read from; the core applies it.
    Leadscrew(Axis, LeadscrewCompensation, String),
    /// A tool path.
    ToolpathComputed(Arc<Toolpath>),
    /// Progress of an operation: its name, and the part done in thousandths.
    Progress(Text, u16),
    /// Bytes received so far of an operation of unknown length, with its name.
    BytesReceived(Text, u64),
}

/// The result of a request that was executed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Completion {
    /// Message.
    pub message: LocalizedText,
    /// O number and checksum of the text that was saved.
    pub saved: Option<(u32, u64)>,
}

impl From<LocalizedText> for Completion {
    fn from(message: LocalizedText) -> Self {
        Self { message, saved: None }
    }
}

/// A finished request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FinishedRequest {
    /// The ticket of the request.
    pub ticket: Ticket,
    /// The result, or the reason of the refusal.
    pub result: Result<Completion, Refusal>,
}

/// The state of file requests as the pages see it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilesView {
    /// The last finished requests, newest last.
    pub answers: Vec<FinishedRequest>,
    /// The files on both sides of a transfer, as last listed.
    pub media: Option<Arc<MediaView>>,
    /// The last page text read.
    pub page: Option<Arc<PageFile>>,
    /// The last tool path computed.
    pub toolpath: Option<Arc<Toolpath>>,
    /// Long operation in progress: its name, thousandths done.
    pub busy: Option<(Text, u16)>,
    /// Bytes received so far, where the length is unknown.
    pub bytes_received: Option<u64>,
    /// The result of the last line check.
    pub line_check: Arc<LineCheck>,
}

impl FilesView {
    /// Stores an answer for its sender; drops the oldest answer if the list is full.
    pub fn add_answer(&mut self, ticket: Ticket, result: Result<Completion, Refusal>) {
        if self.answers.len() >= MAX_ANSWERS {
            self.answers.remove(0);
        }
        self.answers.push(FinishedRequest { ticket, result });
    }
}
