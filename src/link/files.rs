//! What the pages ask of the folders and of the long calculations, and how that is answered. The core says whether it may
//! be; the work is done beside the tick, and the answer comes back as a command. Every request carries a ticket and every
//! answer that of its request: a page hears what it asked for and nothing else.
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

/// Most lines that are looked at in one request, and most characters of a line that are.
pub const LOOKED_LINES: usize = 120;
/// What no screen is wide enough for is not looked at either.
pub const LOOKED_CHARS: usize = 1_000;

/// Answers that the pages can still read: more than come between two frames.
const ANSWERS: usize = 16;

/// Who asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Asker {
    /// The program page.
    Editor,
    /// The page designer.
    Designer,
    /// The directory.
    Directory,
    /// The page of USB and RS232.
    Transfer,
    /// The tables of the screws.
    Screw,
    /// The drawing.
    Graphic,
    /// The teach-in.
    Teach,
    /// The screen itself: its pictures, and tables that are kept.
    Screen,
}

/// The number of a request, given by the one that asks; its answer brings it back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ticket {
    /// Who asks.
    pub asker: Asker,
    /// Counts the requests of one asker.
    pub number: u32,
}

impl Ticket {
    /// The ticket of a request whose answer nobody waits for.
    #[must_use]
    pub const fn unheard(asker: Asker) -> Self {
        Self { asker, number: 0 }
    }
}

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum FileRequest {
    /// Opens the editor: asks only whether it may be edited now.
    MayEdit(u32),
    /// Replaces the text of a program.
    Save {
        /// O number.
        number: u32,
        /// The new text.
        text: Rope,
        /// The stamp of the text that it was made from; the file on the disk must still have it.
        base: u64,
        /// Replaces the file even so.
        force: bool,
    },
    /// Keeps a recorded program under the next free name (L9).
    Record(String),
    /// Reads lines of a text for their writing while they are typed.
    Look {
        /// O number, for the places of mistakes.
        number: u32,
        /// Line of the first of them, from 1.
        first: u32,
        /// The lines.
        text: String,
        /// Comes back with the answer.
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
    /// The path of a program by a check run from where the machine stands.
    Draw(u32),
    /// What stands on both sides of a transfer.
    Media,
    /// Copies to or from a medium.
    Transfer(Transfer),
    /// Keeps a picture of the screen.
    Print(Print),
    /// Keeps a table of samples, CSV.
    Table(String),
    /// A page text for editing, with what a program uses of it.
    ReadPage {
        /// 1000 and the number of the files.
        page: u32,
        /// O number of the program.
        program: u32,
    },
    /// Replaces a page text.
    SavePage {
        /// 1000 and the number of the files.
        page: u32,
        /// The new text.
        text: Rope,
        /// The stamp of the file that it was made from; 0: there was none.
        base: u64,
        /// Replaces the file even so.
        force: bool,
    },
    /// Makes a picture that of a page; one of another form is converted (K5.12).
    TakePicture {
        /// 1000 and the number of the files.
        page: u32,
        /// Where it lies.
        from: PictureFrom,
        /// Its name there.
        name: String,
    },
    /// The table of an axis' screw out of a file of the medium (B7).
    ScrewIn(Axis),
    /// The table of an axis' screw into a file.
    ScrewOut(Axis, ScrewTable),
    /// Ends the long work that is under way.
    Cancel,
}

/// A mistake in a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineFault {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Cause and remedy.
    pub said: Said,
}

/// What was found in lines that were looked at.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Looked {
    /// The token of the request.
    pub token: u64,
    /// The mistakes, by line.
    pub faults: Vec<LineFault>,
}

/// Why something was not done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Somebody else has changed the file since it was opened.
    Conflict,
    /// The password for programs is wanted (K6.2).
    Password,
    /// The machine builder's password is wanted.
    Builder,
    /// These files are there already and differ.
    Overwrite(Vec<String>),
    /// These pictures are not 200×400 in 24 bits; each with what is wrong.
    Convert(Vec<Said>),
    /// An alarm of the table, with its place.
    Alarm(u16, Said),
    /// Anything else.
    Because(Said),
}

impl Refusal {
    /// What is shown.
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

/// Values out of a file: every one of them is allowed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Restored {
    /// Parameters.
    pub params: Vec<(ParamAddress, f64)>,
    /// Macro variables.
    pub variables: Vec<(u16, f64)>,
    /// Offsets 1 to 16: geometry and wear, radius mm.
    pub offsets: Vec<(usize, PerAxis<f64>, PerAxis<f64>)>,
    /// Work frames, 0 is G54; machine coordinates, radius mm.
    pub frames: Vec<(usize, PerAxis<f64>)>,
}

/// What the work beside the tick answers.
#[derive(Clone, Debug, PartialEq)]
pub enum FileAnswer {
    /// It was done.
    Done(Said),
    /// A program was saved.
    Saved {
        /// What is said.
        said: Said,
        /// O number.
        number: u32,
        /// Stamp of the new file.
        stamp: u64,
    },
    /// It was not, and nothing was changed.
    Refused(Refusal),
    /// What was found in lines.
    Looked(Looked),
    /// What stands on both sides of a transfer.
    Media(MediaView),
    /// A page text that was asked for.
    Page(Arc<PageFile>),
    /// Values of a file: the core takes them.
    Restored(Box<Restored>),
    /// A table of an axis' screw, and what it was read from; the core takes it.
    Screw(Axis, ScrewTable, String),
    /// A path.
    Drawn(Arc<Drawing>),
    /// So many thousandths are done; the words say of what.
    Progress(Text, u16),
    /// So many bytes have come; nobody knows of how many.
    Bytes(Text, u64),
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Deed {
    /// What is said of it.
    pub said: Said,
    /// The number of the text that was saved, and its stamp.
    pub saved: Option<(u32, u64)>,
}

/// How a request ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answered {
    /// Whose request it was.
    pub ticket: Ticket,
    /// What was done, or why not.
    pub result: Result<Deed, Refusal>,
}

/// What the pages see of that work.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilesView {
    /// How the last requests ended, the latest last.
    pub answers: Vec<Answered>,
    /// What stands on both sides of a transfer, as it was looked at last.
    pub media: Option<Arc<MediaView>>,
    /// The page text that was read last.
    pub page: Option<Arc<PageFile>>,
    /// The path that was computed last.
    pub drawing: Option<Arc<Drawing>>,
    /// Long work under way: its name, thousandths done.
    pub busy: Option<(Text, u16)>,
    /// Bytes that have come so far, where nobody knows of how many.
    pub bytes: Option<u64>,
    /// What was found in the lines that were looked at last.
    pub looked: Arc<Looked>,
}

impl FilesView {
    /// Keeps an answer for the one that waits for it; the oldest makes room.
    pub fn answer(&mut self, ticket: Ticket, result: Result<Deed, Refusal>) {
        if self.answers.len() >= ANSWERS {
            self.answers.remove(0);
        }
        self.answers.push(Answered { ticket, result });
    }
}
