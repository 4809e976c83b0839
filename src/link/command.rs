//! What a person, a story or the disk can ask of the core.

use std::sync::Arc;

use super::drawing::StockBox;
use super::edit::OffsetCommand;
use super::page_command::PageCommand;
use super::simulated::SimCommand;
use super::teach::TeachCommand;
use crate::defs::date::Date;
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::param::ParamAddress;
use crate::defs::screen::PageText;
use crate::defs::screw::ScrewTable;
use crate::defs::soft_key::Coordinates;
use crate::defs::text::Said;
use crate::units::{Axis, PerAxis};

/// One request to the core. Everything is answered in the tick that takes it, by doing it or by a message that says
/// why not.
#[derive(Clone, Debug)]
pub enum Command {
    /// A key goes down. A jog key acts only while [`Command::Hold`] is repeated.
    Press(Key),
    /// A key goes up.
    Release(Key),
    /// A jog key is still down; sent at least every 50 ms. After `JOG_KEEP_ALIVE` of silence the core lets go.
    Hold(Key),
    /// The screen's handwheel was turned by so many detents.
    Handwheel(i32),
    /// Another page was opened.
    OpenPage(Page),
    /// The position page is opened, or turned, to these coordinates (K7.1).
    ShowCoordinates(Coordinates),
    /// The soft keys are turned to this row, from 0.
    TurnSoftRow(usize),
    /// The grinding page turns to one of its sheets, from 0, where it has several.
    TurnSheet(usize),
    /// Make a program of the folder the current one.
    LoadProgram(u32),
    /// Read the current program up to a line (from 1), to run it from there at cycle start (B5).
    RestartAt(u32),
    /// Offer the run that a power cut has ended once more, from the block it stood at (B5).
    ResumeInterrupted,
    /// Execute a line of MDI text.
    Mdi(String),
    /// A value typed on the open page for one of its macro variables; `None` empties it.
    TypeVariable(u16, Option<f64>),
    /// What the offset and the dressing page ask.
    Offset(OffsetCommand),
    /// An increment to the wear of an offset, typed as U, V or W; G10 goes the same way (K4.1).
    AddWear {
        /// 1 to 16.
        number: usize,
        /// Axis.
        axis: Axis,
        /// mm as displayed.
        by: f64,
    },
    /// The wheel has been changed (K5.17): its size and rating, and no cycle start before it is dressed.
    ChangeWheel {
        /// Diameter, mm.
        diameter_mm: f64,
        /// Width, mm.
        width_mm: f64,
        /// Rated peripheral speed, m/s.
        rated_m_s: f64,
    },
    /// Puts a line of MDI text ready for cycle start; an empty one takes it back.
    ReadyMdi(String),
    /// A value set past the pages (`--set`, `set` in a story, a restored backup).
    SetVariable(u16, Option<f64>),
    /// A parameter set past the pages (`--param`, `param` in a story): no password is asked.
    SetParam(ParamAddress, f64),
    /// The work zero of G54 (0) to G59 (5), machine coordinates, radius mm.
    SetFrame(usize, PerAxis<f64>),
    /// Geometry of a tool offset, 1 to 16, radius mm.
    SetGeometry(usize, PerAxis<f64>),
    /// What is to be ground and what holds it, for the drawing.
    SetStock(Arc<[StockBox]>),
    /// Another table for the screw of an axis (B7).
    SetScrew(Axis, ScrewTable),
    /// Makes the relative position of an axis zero.
    ClearRelative(Axis),
    /// The disk has read the folder of page texts and pictures.
    Screens(Arc<Screens>),
    /// The disk has stored what it was given, up to and including this generation.
    Stored(u64),
    /// The disk could not do what it was asked.
    DiskFailed(Said),
    /// What the pages of parameters and settings ask.
    Page(PageCommand),
    /// What the simulator page asks of the simulated machine; a control never takes it.
    Simulate(SimCommand),
    /// What the teach-in page asks (L9).
    Teach(TeachCommand),
    /// The computer's clock reads this; told now and then. Only dates that people read depend on it.
    Calendar(Date),
    /// The screen is alive; without it the core stops after its keep-alive time.
    Alive,
}

/// The grinding pages as the disk found them.
#[derive(Clone, Debug, Default)]
pub struct Screens {
    /// One for each program O1001–O1020 of which a file was found, by program number; a kind's own pages by 1000 and
    /// the number of their files.
    pub pages: Vec<(u32, ScreenFiles)>,
    /// The picture of the dressing page, or what is wrong with it; none before the folder was read.
    pub dressing: Option<Result<Arc<Picture>, FileFault>>,
}

impl Screens {
    /// The files of a program.
    #[must_use]
    pub fn find(&self, program: u32) -> Option<&ScreenFiles> {
        self.pages.iter().find(|(number, _)| *number == program).map(|(_, files)| files)
    }
}

/// Page text and picture of one program.
#[derive(Clone, Debug)]
pub struct ScreenFiles {
    /// The page text, or what is wrong with it.
    pub text: Result<Arc<PageText>, FileFault>,
    /// The picture, or what is wrong with it.
    pub picture: Result<Arc<Picture>, FileFault>,
}

/// A page picture: 200 × 400, 24 bit, as the bytes of a PNG: those of all programs stay in memory, one is painted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture(pub Vec<u8>);

/// What is wrong with a file of the screens folder: file, line where there is one, cause and remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileFault {
    /// File name.
    pub file: String,
    /// Line and column, from 1, of a text.
    pub place: Option<(u32, u32)>,
    /// Cause and remedy.
    pub said: Said,
}

impl FileFault {
    /// The fault with its place, as it is shown.
    #[must_use]
    pub fn said(&self) -> Said {
        match self.place {
            Some((line, column)) => Said::new(
                format!("{} 第{line}行 第{column}列：{}", self.file, self.said.zh),
                format!("{} line {line}, column {column}: {}", self.file, self.said.en),
            ),
            None => Said::new(format!("{}：{}", self.file, self.said.zh), format!("{}: {}", self.file, self.said.en)),
        }
    }
}
