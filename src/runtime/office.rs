//! Runs the jobs that the pages request outside the tick: saving and copying programs, checking the syntax of lines.
//! Jobs run on their own thread, so that a long one never delays retained data; a rig runs them at once.
//! Source: spec B6, K6.2, H8.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use encoding_rs::GBK;
use ropey::Rope;

use super::clock;
use super::disk::Folders;
use super::draw;
use super::page_file::PageDesk;
use super::screws;
use super::serial::Trouble;
use super::serial::courier::Courier;
use super::serial::line::{Line, ports};
use super::serial::sheet::Sheet;
use super::transfer::{self, Carrier};
use crate::controller::Programs;
use crate::controller::files::Job;
use crate::defs::date::Date;
use crate::defs::program;
use crate::defs::text::{Lang, Said};
use crate::link::files::{FileAnswer, FileRequest, LineFault, Looked, Refusal};
use crate::link::media::{Direction, MediaView, Set, Transfer};
use crate::nc::{Fault, Settings, Source, look};
use crate::store::{Encoding, Folder, FolderError, PROGRAM, Settings as Stored, Stick, decode, stamp};

/// Maximum number of recordings in a folder.
const RECORDS: u32 = 99;

/// A flag that cancels a long job.
pub type Cancelled = Arc<AtomicBool>;

/// Runs jobs on the disk.
#[derive(Clone, Debug)]
pub struct Office {
    folders: Folders,
    /// Folder of screenshots; `None` saves them on a USB drive only.
    prints: Option<PathBuf>,
    /// The given USB drive; `None` uses the one that is plugged in.
    stick: Option<Stick>,
    /// The given RS232 port.
    port: Option<String>,
    /// Data directory whose settings name the port if none is given.
    data: Option<PathBuf>,
    /// Received programs that wait for the answer whether to overwrite.
    held: Arc<Mutex<Vec<Sheet>>>,
    cancelled: Cancelled,
}

/// The folders that a job has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changed {
    /// The program folder.
    pub programs: bool,
    /// The folder of page files.
    pub screens: bool,
}

impl Office {
    /// Creates an office for the two folders.
    #[must_use]
    pub fn new(folders: Folders) -> Self {
        let (held, cancelled) = (Arc::default(), Cancelled::default());
        Self { folders, prints: None, stick: None, port: None, data: None, held, cancelled }
    }

    /// Sets the folder for screenshots and the folder used as the USB drive.
    #[must_use]
    pub fn with(self, prints: Option<PathBuf>, stick: Option<PathBuf>) -> Self {
        Self { prints, stick: stick.map(Stick::at), ..self }
    }

    /// Sets the RS232 port, or the data directory whose settings name it.
    #[must_use]
    pub fn on_line(self, port: Option<String>, data: Option<PathBuf>) -> Self {
        Self { port, data, ..self }
    }

    fn port(&self) -> Option<String> {
        let stored = || self.data.as_deref().and_then(|data| Stored::read(data).ok()).and_then(|found| found.serial);
        self.port.clone().or_else(stored)
    }

    fn stick(&self) -> Option<Stick> {
        self.stick.clone().or_else(Stick::find).filter(Stick::is_present)
    }

    /// Cancels the long job in progress.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Release);
    }

    /// Runs a job. `tell` receives its answers; the last one completes it.
    pub fn work(&self, job: &Job, tell: &mut dyn FnMut(FileAnswer)) -> Changed {
        if is_long(&job.request) {
            self.cancelled.store(false, Ordering::Release);
        }
        let (programs, date) = (Folder::new(&self.folders.programs), of(job));
        let called = |number: u32| Called::new(number, &job.programs);
        let done = match &job.request {
            FileRequest::MayEdit(_) | FileRequest::Cancel => return Changed::default(),
            FileRequest::Look { number, first, text, token } => {
                tell(FileAnswer::Looked(look_at(*number, *first, text, *token, &job.settings)));
                return Changed::default();
            }
            FileRequest::Draw(number) => {
                let answer = self.draw(*number, job, tell).unwrap_or_else(FileAnswer::Refused);
                tell(answer);
                return Changed::default();
            }
            FileRequest::Media => {
                let media = transfer::media(&self.folders, self.stick().as_ref());
                tell(FileAnswer::Media(MediaView { port: self.port(), ports: ports(), ..media }));
                return Changed::default();
            }
            FileRequest::Print(picture) => {
                let done = transfer::print(picture, date, self.prints.as_deref(), self.stick().as_ref());
                tell(done.map_or_else(FileAnswer::Refused, FileAnswer::Done));
                return Changed::default();
            }
            FileRequest::Table(text) => {
                let stick = self.stick();
                let done = transfer::keep(text.as_bytes(), (date, "CSV"), self.prints.as_deref(), stick.as_ref());
                tell(done.map_or_else(FileAnswer::Refused, FileAnswer::Done));
                return Changed::default();
            }
            FileRequest::ReadPage { page, program } => {
                let read = self.page_desk().read(*page, *program, job);
                tell(read.map_or_else(FileAnswer::Refused, |read| FileAnswer::Page(Arc::new(read))));
                return Changed::default();
            }
            FileRequest::SavePage { page, text, base, force } => {
                return self.page_changed(self.page_desk().save(*page, text, *base, *force), tell);
            }
            FileRequest::TakePicture { page, from, name } => {
                return self.page_changed(self.page_desk().take(*page, *from, name), tell);
            }
            FileRequest::Transfer(ask) if ask.set == Set::Serial => return self.over_the_line(ask, job, tell),
            FileRequest::Transfer(ask) => return self.carry(ask, job, tell),
            FileRequest::ScrewIn(axis) => {
                tell(screws::read(*axis, self.stick().as_ref()).unwrap_or_else(FileAnswer::Refused));
                return Changed::default();
            }
            FileRequest::ScrewOut(axis, table) => {
                let stick = self.stick();
                let done = screws::write((*axis, table), date, self.prints.as_deref(), stick.as_ref());
                tell(done.map_or_else(FileAnswer::Refused, FileAnswer::Done));
                return Changed::default();
            }
            FileRequest::Save { number, text, base, force } => save(&programs, &called(*number), text, (*base, *force)),
            FileRequest::Record(text) => record(&programs, text),
            FileRequest::New(number) => new(&programs, *number, &job.settings),
            FileRequest::Copy { from, to } => copy(&programs, &called(*from), *to),
            FileRequest::Rename { from, to } => rename(&programs, *from, *to),
            FileRequest::Delete(number) => delete(&programs, &called(*number)),
        };
        // At a conflict the file was changed from outside: the core must read it again, too.
        let changed = Changed { programs: done.is_ok() || done == Err(Refusal::Conflict), screens: false };
        tell(done.unwrap_or_else(FileAnswer::Refused));
        changed
    }
}

/// The file of a program.
#[derive(Debug)]
struct Called {
    number: u32,
    /// File name of a named program.
    file: Option<String>,
    /// Title used in messages.
    title: String,
}

impl Called {
    fn new(number: u32, programs: &Programs) -> Self {
        let source = programs.get(number).map(|program| &program.source);
        let title = source.map_or_else(|| program::title(number), |source| source.title());
        let file = source.filter(|_| program::is_named(number)).map(|source| source.name().to_owned());
        Self { number, file, title }
    }

    fn read(&self, folder: &Folder) -> Result<Vec<u8>, FolderError> {
        let read = match &self.file {
            Some(file) => folder.read_named(&PROGRAM, file),
            None => folder.read(&PROGRAM, file_number(self.number).unwrap_or_default()),
        };
        read.map(|read| read.bytes)
    }

    fn write(&self, folder: &Folder, bytes: &[u8]) -> Result<(), Refusal> {
        let written = match &self.file {
            Some(file) => folder.write_named(&PROGRAM, file, bytes),
            None => folder.write(&PROGRAM, file_number(self.number)?, bytes),
        };
        written.map(drop).map_err(|error| refused(&error))
    }
}

/// Date and time for file names: the machine's, otherwise the computer's.
fn of(job: &Job) -> Date {
    job.date.unwrap_or_else(clock::local)
}

/// Whether a request is a long job that 取消 cancels.
pub(super) const fn is_long(request: &FileRequest) -> bool {
    matches!(request, FileRequest::Transfer(_) | FileRequest::Draw(_))
}

impl Office {
    fn page_desk(&self) -> PageDesk {
        PageDesk { screens: Folder::new(&self.folders.screens), stick: self.stick() }
    }

    /// Answers a change of a page file; after a success the page files are read again.
    fn page_changed(&self, done: Result<FileAnswer, Refusal>, tell: &mut dyn FnMut(FileAnswer)) -> Changed {
        let changed = Changed { programs: false, screens: done.is_ok() };
        tell(done.unwrap_or_else(FileAnswer::Refused));
        changed
    }

    /// Sends or receives programs over RS232.
    fn over_the_line(&self, ask: &Transfer, job: &Job, tell: &mut dyn FnMut(FileAnswer)) -> Changed {
        let unchosen = || Trouble::Port(Said::new("没有选择端口", "no port is chosen"));
        let line = self.port().ok_or_else(unchosen).map_err(Refusal::from).and_then(|port| {
            let holdings = job.holdings.as_deref().ok_or_else(transfer::no_stick)?;
            Ok(Line::of(&holdings.params, port))
        });
        let shelf = self.folders.shelf();
        let (named, cancelled, held) = (self.folders.named, &*self.cancelled, &*self.held);
        let done =
            line.and_then(|line| Courier { shelf: &shelf, named, line: &line, cancelled, held }.carry(ask, tell));
        tell(done.unwrap_or_else(FileAnswer::Refused));
        Changed { programs: ask.direction == Direction::In, screens: false }
    }

    fn carry(&self, ask: &Transfer, job: &Job, tell: &mut dyn FnMut(FileAnswer)) -> Changed {
        let Some(stick) = self.stick() else {
            tell(FileAnswer::Refused(transfer::no_stick()));
            return Changed::default();
        };
        let holdings = job.holdings.as_deref();
        let carrier =
            Carrier { folders: &self.folders, stick: &stick, holdings, cancelled: &self.cancelled, date: of(job) };
        let done = carrier.carry(ask, tell).unwrap_or_else(FileAnswer::Refused);
        tell(done);
        // Incoming files change the folders.
        let inward = ask.direction == Direction::In;
        Changed {
            programs: inward && matches!(ask.set, Set::Programs | Set::Backup),
            screens: inward && matches!(ask.set, Set::Screens | Set::Backup),
        }
    }

    fn draw(&self, number: u32, job: &Job, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let missing =
            || Refusal::Because(Said::new(format!("没有程序 O{number:04}"), format!("there is no O{number:04}")));
        let program = job.programs.get(number).ok_or_else(missing)?;
        let start = job.start.as_ref().ok_or_else(missing)?;
        tell(FileAnswer::Progress(draw::NAME, 0));
        let drawing = draw::draw(program, job, start, &self.cancelled, tell);
        if self.cancelled.load(Ordering::Acquire) {
            return Err(Refusal::Because(Said::new("已取消", "cancelled")));
        }
        Ok(FileAnswer::Drawn(Arc::new(drawing)))
    }
}

/// A program fault as the pages show it.
#[must_use]
pub fn line_fault(fault: &Fault) -> LineFault {
    let said = |lang| format!("{} – {}", fault.cause(lang), fault.remedy(lang));
    LineFault { line: fault.place.line, column: fault.column, said: Said::new(said(Lang::Zh), said(Lang::En)) }
}

pub(super) fn because(error: &dyn std::fmt::Display) -> Refusal {
    Refusal::Because(Said::new(error.to_string(), error.to_string()))
}

/// The refusal for an error of a folder.
pub(super) fn refused(error: &FolderError) -> Refusal {
    Refusal::Because(error.said())
}

fn file_number(number: u32) -> Result<u16, Refusal> {
    u16::try_from(number)
        .ok()
        .filter(|number| (1..=9_999).contains(number))
        .ok_or_else(|| Refusal::Because(Said::new("程序号应为 1-9999", "program numbers are 1 to 9999")))
}

/// Replaces a program unless it was changed since it was read. Keeps its encoding, or UTF-8 if GBK lacks a character.
fn save(folder: &Folder, of: &Called, text: &Rope, (base, force): (u64, bool)) -> Result<FileAnswer, Refusal> {
    let (number, title) = (of.number, &of.title);
    let encoding = match of.read(folder) {
        Ok(bytes) if !force && stamp(&bytes) != base => return Err(Refusal::Conflict),
        Ok(bytes) => decode(&bytes).map_or(Encoding::Utf8, |decoded| decoded.encoding),
        // Deleted meanwhile: writing it again loses nothing.
        Err(FolderError::Missing { .. }) => Encoding::Utf8,
        Err(error) => return Err(refused(&error)),
    };
    let (bytes, kept) = encode(text, encoding);
    of.write(folder, &bytes)?;
    let said = if kept {
        Said::new(format!("{title} 已保存"), format!("{title} saved"))
    } else {
        Said::new(
            format!("{title} 已保存；含 GBK 以外的字，改用 UTF-8 编码"),
            format!("{title} saved as UTF-8: it holds signs that GBK lacks"),
        )
    };
    Ok(FileAnswer::Saved { said, number, stamp: stamp(&bytes) })
}

/// Saves a recorded program under the first free name of `TEACH01` to `TEACH99` (L9).
fn record(folder: &Folder, text: &str) -> Result<FileAnswer, Refusal> {
    for number in 1..=RECORDS {
        let stem = format!("TEACH{number:02}");
        match folder.read_named(&PROGRAM, &format!("{stem}.NC")) {
            Err(FolderError::Missing { .. }) => {}
            Ok(_) | Err(_) => continue,
        }
        folder.write_named(&PROGRAM, &format!("{stem}.NC"), text.as_bytes()).map_err(|error| refused(&error))?;
        return Ok(FileAnswer::Done(Said::new(format!("录返程序 {stem} 已保存"), format!("recorded as {stem}"))));
    }
    let said = Said::new("TEACH01–TEACH99 都已存在，请先删除", "TEACH01 to TEACH99 are there already: delete one");
    Err(Refusal::Because(said))
}

/// Encodes a text. Returns false when UTF-8 replaced GBK because of a character that GBK lacks.
pub(super) fn encode(text: &Rope, encoding: Encoding) -> (Vec<u8>, bool) {
    if encoding == Encoding::Gbk {
        let whole = String::from(text);
        let (bytes, _, lacking) = GBK.encode(&whole);
        if !lacking {
            return (bytes.into_owned(), true);
        }
    }
    let mut bytes = Vec::with_capacity(text.len_bytes());
    text.chunks().for_each(|chunk| bytes.extend_from_slice(chunk.as_bytes()));
    (bytes, encoding == Encoding::Utf8)
}

fn new(folder: &Folder, number: u32, settings: &Settings) -> Result<FileAnswer, Refusal> {
    let file = file_number(number)?;
    match folder.find(&PROGRAM, file) {
        Err(FolderError::Missing { .. }) => {}
        Err(error) => return Err(refused(&error)),
        Ok(found) => {
            return Err(Refusal::Because(Said::new(
                format!("{} 已存在，请换一个号", found.name),
                format!("{} is there already: choose another number", found.name),
            )));
        }
    }
    let text = settings.system.new_text(number);
    folder.write(&PROGRAM, file, text.as_bytes()).map_err(|error| refused(&error))?;
    Ok(FileAnswer::Done(Said::new(format!("O{number:04} 已新建"), format!("O{number:04} is new"))))
}

fn copy(folder: &Folder, from: &Called, to: u32) -> Result<FileAnswer, Refusal> {
    let title = &from.title;
    match &from.file {
        None => folder.copy(&PROGRAM, file_number(from.number)?, file_number(to)?).map(drop),
        Some(_) => {
            let bytes = from.read(folder).map_err(|error| refused(&error))?;
            match folder.find(&PROGRAM, file_number(to)?) {
                Err(FolderError::Missing { .. }) => folder.write(&PROGRAM, file_number(to)?, &bytes).map(drop),
                Err(error) => Err(error),
                Ok(found) => Err(FolderError::Exists { path: folder.path().join(found.name) }),
            }
        }
    }
    .map_err(|error| refused(&error))?;
    Ok(FileAnswer::Done(Said::new(format!("{title} 已复制为 O{to:04}"), format!("{title} copied to O{to:04}"))))
}

fn rename(folder: &Folder, from: u32, to: u32) -> Result<FileAnswer, Refusal> {
    folder.rename(&PROGRAM, file_number(from)?, file_number(to)?).map_err(|error| refused(&error))?;
    Ok(FileAnswer::Done(Said::new(format!("O{from:04} 已改为 O{to:04}"), format!("O{from:04} is now O{to:04}"))))
}

fn delete(folder: &Folder, of: &Called) -> Result<FileAnswer, Refusal> {
    let title = &of.title;
    match &of.file {
        Some(file) => folder.delete_named(&PROGRAM, file),
        None => folder.delete(&PROGRAM, file_number(of.number)?),
    }
    .map_err(|error| refused(&error))?;
    Ok(FileAnswer::Done(Said::new(format!("{title} 已删除"), format!("{title} deleted"))))
}

/// Checks the syntax of some lines. Jumps out of them and loops across them are allowed.
fn look_at(number: u32, first: u32, text: &str, token: u64, settings: &Settings) -> Looked {
    let source = Arc::new(Source::new(number, "", text.as_bytes().to_vec()));
    let found = look(&source, settings);
    let faults = found.iter().map(line_fault).map(|fault| {
        let line = first + fault.line.saturating_sub(1);
        LineFault { line, ..fault }
    });
    Looked { token, faults: faults.collect() }
}
