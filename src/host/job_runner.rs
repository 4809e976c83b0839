//! Runs the jobs that the pages request outside the tick: saving and copying programs, checking the syntax of lines.
//! Jobs run on their own thread, so that a long one never delays retained data; a headless host runs them in the step.
//! Source: spec B6, K6.2, H8.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use encoding_rs::GBK;
use ropey::Rope;

use super::clock;
use super::folders::Folders;
use super::leadscrew_files;
use super::page_file::PageFileFolder;
use super::serial::SerialError;
use super::serial::format::SerialProgram;
use super::serial::port::{SerialLine, port_names};
use super::serial::transfer::SerialTransfer;
use super::toolpath;
use super::transfer::{self, UsbTransfer};
use crate::controller::Programs;
use crate::controller::files::BackgroundJob;
use crate::defs::date::DateTime;
use crate::defs::program_number;
use crate::defs::text::{Lang, LocalizedText};
use crate::link::files::{FileAnswer, FileRequest, LineCheck, Refusal};
use crate::link::line_fault::LineFault;
use crate::link::media::{Direction, MediaView, TransferRequest, TransferSet};
use crate::nc::{self, NcSettings, ProgramFault, Source, check_syntax};
use crate::store::{Encoding, Folder, FolderError, PROGRAM, StoredSettings as Stored, UsbDrive, decode, stamp};

/// Maximum number of recordings in a folder.
const MAX_RECORDINGS: u32 = 99;

/// A flag that cancels a long job.
pub type CancelFlag = Arc<AtomicBool>;

/// Runs jobs on the disk.
#[derive(Clone, Debug)]
pub struct JobRunner {
    folders: Folders,
    /// Folder of screenshots; `None` saves them on a USB drive only.
    prints: Option<PathBuf>,
    /// The given USB drive; `None` uses the one that is plugged in.
    usb_drive: Option<UsbDrive>,
    /// The given RS232 port.
    port: Option<String>,
    /// Data directory whose settings name the port if none is given.
    data_dir: Option<PathBuf>,
    /// Received programs that wait for the answer whether to overwrite.
    received: Arc<Mutex<Vec<SerialProgram>>>,
    cancelled: CancelFlag,
}

/// The folders that a job has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChangedFolders {
    /// The program folder.
    pub programs: bool,
    /// The folder of page files.
    pub screens: bool,
}

impl JobRunner {
    /// A runner for the two folders.
    #[must_use]
    pub fn new(folders: Folders) -> Self {
        let (held, cancelled) = (Arc::default(), CancelFlag::default());
        Self { folders, prints: None, usb_drive: None, port: None, data_dir: None, received: held, cancelled }
    }

    /// Sets the folder for screenshots and the folder used as the USB drive.
    #[must_use]
    pub fn with_drives(self, prints: Option<PathBuf>, stick: Option<PathBuf>) -> Self {
        Self { prints, usb_drive: stick.map(UsbDrive::at), ..self }
    }

    /// Sets the RS232 port, or the data directory whose settings name it.
    #[must_use]
    pub fn with_serial(self, port: Option<String>, data: Option<PathBuf>) -> Self {
        Self { port, data_dir: data, ..self }
    }

    /// The same runner with a cancel flag of its own, for a second thread.
    #[must_use]
    pub fn with_own_cancel(self) -> Self {
        Self { cancelled: CancelFlag::default(), ..self }
    }

    /// The folders of programs and page files.
    #[must_use]
    pub const fn folders(&self) -> &Folders {
        &self.folders
    }

    fn port(&self) -> Option<String> {
        let stored =
            || self.data_dir.as_deref().and_then(|data| Stored::read(data).ok()).and_then(|found| found.serial);
        self.port.clone().or_else(stored)
    }

    fn usb_drive(&self) -> Option<UsbDrive> {
        self.usb_drive.clone().or_else(UsbDrive::find).filter(UsbDrive::is_present)
    }

    /// Cancels the long job in progress.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Release);
    }

    /// Runs a job. `tell` receives its answers; the last one completes it.
    pub fn run(&self, job: &BackgroundJob, tell: &mut dyn FnMut(FileAnswer)) -> ChangedFolders {
        if is_long(&job.request) {
            self.cancelled.store(false, Ordering::Release);
        }
        let (programs, pages) = (Folder::new(&self.folders.programs), self.page_files());
        let called = |number: u32| ProgramFile::new(number, &job.programs);
        match &job.request {
            FileRequest::CheckEditable(_) | FileRequest::Cancel => ChangedFolders::default(),
            FileRequest::CheckLines { number, first_line: first, text, token } => {
                let checked = check_lines(*number, *first, text, *token, &job.settings);
                report_answer(Ok(FileAnswer::LinesChecked(checked)), tell)
            }
            FileRequest::ComputeToolpath(number) => report_answer(self.compute_toolpath(*number, job, tell), tell),
            FileRequest::ListMedia => {
                let media = transfer::media_view(&self.folders, self.usb_drive().as_ref());
                let media = MediaView { port: self.port(), ports: port_names(), ..media };
                report_answer(Ok(FileAnswer::Media(media)), tell)
            }
            FileRequest::SaveScreenshot(_) | FileRequest::SaveTable(_) | FileRequest::ExportLeadscrew(..) => {
                report_answer(self.export(job).map(FileAnswer::Done), tell)
            }
            FileRequest::ReadPage { page, program } => {
                report_answer(pages.read(*page, *program, job).map(|read| FileAnswer::Page(Arc::new(read))), tell)
            }
            FileRequest::SavePage { page, text, base_stamp: base, overwrite: force } => {
                report_page_change(pages.save(*page, text, *base, *force), tell)
            }
            FileRequest::ImportPicture { page, from, name } => {
                report_page_change(pages.take_picture(*page, *from, name), tell)
            }
            FileRequest::Transfer(ask) if ask.set == TransferSet::Serial => self.transfer_serial(ask, job, tell),
            FileRequest::Transfer(ask) => self.transfer_usb(ask, job, tell),
            FileRequest::ImportLeadscrew(axis) => {
                report_answer(leadscrew_files::read(*axis, self.usb_drive().as_ref()), tell)
            }
            FileRequest::Save { number, text, base_stamp: base, overwrite: force } => {
                report_program_change(save_program(&programs, &called(*number), text, (*base, *force)), tell)
            }
            FileRequest::SaveRecording(text) => report_program_change(save_recording(&programs, text), tell),
            FileRequest::New(number) => report_program_change(new_program(&programs, *number, &job.settings), tell),
            FileRequest::Copy { from, to } => report_program_change(copy_program(&programs, &called(*from), *to), tell),
            FileRequest::Rename { from, to } => report_program_change(rename_program(&programs, *from, *to), tell),
            FileRequest::Delete(number) => report_program_change(delete_program(&programs, &called(*number)), tell),
        }
    }

    /// Writes a picture or a table to the folder of screenshots or the USB drive.
    fn export(&self, job: &BackgroundJob) -> Result<LocalizedText, Refusal> {
        let (date, folder, usb) = (file_date(job), self.prints.as_deref(), self.usb_drive());
        match &job.request {
            FileRequest::SaveScreenshot(picture) => transfer::save_screenshot(picture, date, folder, usb.as_ref()),
            FileRequest::SaveTable(text) => transfer::save_file(text.as_bytes(), (date, "CSV"), folder, usb.as_ref()),
            FileRequest::ExportLeadscrew(axis, table) => {
                leadscrew_files::write((*axis, table), date, folder, usb.as_ref())
            }
            other => Err(Refusal::Other(LocalizedText::new("不能导出", format!("{other:?} exports nothing")))),
        }
    }
}

type JobAnswer = Result<FileAnswer, Refusal>;

/// Answers a job that changes no folder.
fn report_answer(done: JobAnswer, tell: &mut dyn FnMut(FileAnswer)) -> ChangedFolders {
    tell(done.unwrap_or_else(FileAnswer::Refused));
    ChangedFolders::default()
}

/// Answers a change of a program.
fn report_program_change(done: JobAnswer, tell: &mut dyn FnMut(FileAnswer)) -> ChangedFolders {
    // At a conflict the file was changed from outside: the core must read it again, too.
    let changed = ChangedFolders { programs: done.is_ok() || done == Err(Refusal::Conflict), screens: false };
    tell(done.unwrap_or_else(FileAnswer::Refused));
    changed
}

/// Answers a change of a page file; after a success the page files are read again.
fn report_page_change(done: JobAnswer, tell: &mut dyn FnMut(FileAnswer)) -> ChangedFolders {
    let changed = ChangedFolders { programs: false, screens: done.is_ok() };
    tell(done.unwrap_or_else(FileAnswer::Refused));
    changed
}

/// The file of a program.
#[derive(Debug)]
struct ProgramFile {
    number: u32,
    /// File name of a named program.
    file: Option<String>,
    /// Title used in messages.
    title: String,
}

impl ProgramFile {
    fn new(number: u32, programs: &Programs) -> Self {
        let source = programs.get(number).map(|program| &program.source);
        let title = source.map_or_else(|| program_number::name_of(number), |source| source.title());
        let file = source.filter(|_| program_number::is_named(number)).map(|source| source.name().to_owned());
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
        written.map(drop).map_err(|error| folder_refusal(&error))
    }
}

/// Date and time for file names: the machine's, otherwise the computer's.
fn file_date(job: &BackgroundJob) -> DateTime {
    job.date.unwrap_or_else(clock::local_time)
}

/// Whether a request is a long job that 取消 cancels.
pub(super) const fn is_long(request: &FileRequest) -> bool {
    matches!(request, FileRequest::Transfer(_) | FileRequest::ComputeToolpath(_))
}

impl JobRunner {
    fn page_files(&self) -> PageFileFolder {
        PageFileFolder { screens: Folder::new(&self.folders.screens), usb_drive: self.usb_drive() }
    }

    /// Sends or receives programs over RS232.
    fn transfer_serial(
        &self,
        ask: &TransferRequest,
        job: &BackgroundJob,
        tell: &mut dyn FnMut(FileAnswer),
    ) -> ChangedFolders {
        let unchosen = || SerialError::Port(LocalizedText::new("没有选择端口", "no port is chosen"));
        let line = self.port().ok_or_else(unchosen).map_err(Refusal::from).and_then(|port| {
            let holdings = job.transfer_values.as_deref().ok_or_else(transfer::no_usb_drive)?;
            Ok(SerialLine::from_params(&holdings.params, port))
        });
        let shelf = self.folders.program_folder();
        let (named, cancelled, held) = (self.folders.by_name, &*self.cancelled, &*self.received);
        let done = line.and_then(|line| {
            SerialTransfer { folder: &shelf, by_name: named, port: &line, cancelled, received: held }.run(ask, tell)
        });
        tell(done.unwrap_or_else(FileAnswer::Refused));
        ChangedFolders { programs: ask.direction == Direction::Import, screens: false }
    }

    fn transfer_usb(
        &self,
        ask: &TransferRequest,
        job: &BackgroundJob,
        tell: &mut dyn FnMut(FileAnswer),
    ) -> ChangedFolders {
        let Some(stick) = self.usb_drive() else {
            tell(FileAnswer::Refused(transfer::no_usb_drive()));
            return ChangedFolders::default();
        };
        let holdings = job.transfer_values.as_deref();
        let carrier = UsbTransfer {
            folders: &self.folders,
            usb_drive: &stick,
            holdings,
            cancelled: &self.cancelled,
            date: file_date(job),
        };
        let done = carrier.run(ask, tell).unwrap_or_else(FileAnswer::Refused);
        tell(done);
        // Incoming files change the folders.
        let inward = ask.direction == Direction::Import;
        ChangedFolders {
            programs: inward && matches!(ask.set, TransferSet::Programs | TransferSet::Backup),
            screens: inward && matches!(ask.set, TransferSet::Screens | TransferSet::Backup),
        }
    }

    fn compute_toolpath(
        &self,
        number: u32,
        job: &BackgroundJob,
        tell: &mut dyn FnMut(FileAnswer),
    ) -> Result<FileAnswer, Refusal> {
        let missing = || {
            Refusal::Other(LocalizedText::new(format!("没有程序 O{number:04}"), format!("there is no O{number:04}")))
        };
        let program = job.programs.get(number).ok_or_else(missing)?;
        let start = job.start.as_ref().ok_or_else(missing)?;
        tell(FileAnswer::Progress(toolpath::PROGRESS_TEXT, 0));
        let drawing = toolpath::compute_toolpath(program, job, start, &self.cancelled, tell);
        if self.cancelled.load(Ordering::Acquire) {
            return Err(Refusal::Other(LocalizedText::new("已取消", "cancelled")));
        }
        Ok(FileAnswer::ToolpathComputed(Arc::new(drawing)))
    }
}

/// A program fault as the pages show it.
#[must_use]
pub fn line_fault(fault: &ProgramFault) -> LineFault {
    let said = |lang| format!("{} – {}", fault.cause(lang), fault.remedy(lang));
    LineFault {
        line: fault.location.line,
        column: fault.column,
        message: LocalizedText::new(said(Lang::Zh), said(Lang::En)),
    }
}

pub(super) fn refusal_of(error: &dyn std::fmt::Display) -> Refusal {
    Refusal::Other(LocalizedText::new(error.to_string(), error.to_string()))
}

/// The refusal for an error of a folder.
pub(super) fn folder_refusal(error: &FolderError) -> Refusal {
    Refusal::Other(error.message())
}

fn file_number(number: u32) -> Result<u16, Refusal> {
    u16::try_from(number)
        .ok()
        .filter(|number| (1..=9_999).contains(number))
        .ok_or_else(|| Refusal::Other(LocalizedText::new("程序号应为 1-9999", "program numbers are 1 to 9999")))
}

/// Replaces a program unless it was changed since it was read. Keeps its encoding, or UTF-8 if GBK lacks a character.
fn save_program(
    folder: &Folder,
    of: &ProgramFile,
    text: &Rope,
    (base, force): (u64, bool),
) -> Result<FileAnswer, Refusal> {
    let (number, title) = (of.number, &of.title);
    let encoding = match of.read(folder) {
        Ok(bytes) if !force && stamp(&bytes) != base => return Err(Refusal::Conflict),
        Ok(bytes) => decode(&bytes).map_or(Encoding::Utf8, |decoded| decoded.encoding),
        // Deleted meanwhile: writing it again loses nothing.
        Err(FolderError::Missing { .. }) => Encoding::Utf8,
        Err(error) => return Err(folder_refusal(&error)),
    };
    let (bytes, kept) = encode(text, encoding);
    of.write(folder, &bytes)?;
    let said = if kept {
        LocalizedText::new(format!("{title} 已保存"), format!("{title} saved"))
    } else {
        LocalizedText::new(
            format!("{title} 已保存；含 GBK 以外的字，改用 UTF-8 编码"),
            format!("{title} saved as UTF-8: it holds signs that GBK lacks"),
        )
    };
    Ok(FileAnswer::Saved { message: said, number, stamp: stamp(&bytes) })
}

/// Saves a recorded program under the first free name of `TEACH01` to `TEACH99` (L9).
fn save_recording(folder: &Folder, text: &str) -> Result<FileAnswer, Refusal> {
    for number in 1..=MAX_RECORDINGS {
        let stem = format!("TEACH{number:02}");
        match folder.read_named(&PROGRAM, &format!("{stem}.NC")) {
            Err(FolderError::Missing { .. }) => {}
            Ok(_) | Err(_) => continue,
        }
        folder.write_named(&PROGRAM, &format!("{stem}.NC"), text.as_bytes()).map_err(|error| folder_refusal(&error))?;
        return Ok(FileAnswer::Done(LocalizedText::new(
            format!("录返程序 {stem} 已保存"),
            format!("recorded as {stem}"),
        )));
    }
    let said =
        LocalizedText::new("TEACH01–TEACH99 都已存在，请先删除", "TEACH01 to TEACH99 are there already: delete one");
    Err(Refusal::Other(said))
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

fn new_program(folder: &Folder, number: u32, settings: &NcSettings) -> Result<FileAnswer, Refusal> {
    let file = file_number(number)?;
    match folder.find(&PROGRAM, file) {
        Err(FolderError::Missing { .. }) => {}
        Err(error) => return Err(folder_refusal(&error)),
        Ok(found) => {
            return Err(Refusal::Other(LocalizedText::new(
                format!("{} 已存在，请换一个号", found.name),
                format!("{} is there already: choose another number", found.name),
            )));
        }
    }
    let text = nc::new_program_text(settings.dialect, number);
    folder.write(&PROGRAM, file, text.as_bytes()).map_err(|error| folder_refusal(&error))?;
    Ok(FileAnswer::Done(LocalizedText::new(format!("O{number:04} 已新建"), format!("O{number:04} is new"))))
}

fn copy_program(folder: &Folder, from: &ProgramFile, to: u32) -> Result<FileAnswer, Refusal> {
    let title = &from.title;
    match &from.file {
        None => folder.copy(&PROGRAM, file_number(from.number)?, file_number(to)?).map(drop),
        Some(_) => {
            let bytes = from.read(folder).map_err(|error| folder_refusal(&error))?;
            match folder.find(&PROGRAM, file_number(to)?) {
                Err(FolderError::Missing { .. }) => folder.write(&PROGRAM, file_number(to)?, &bytes).map(drop),
                Err(error) => Err(error),
                Ok(found) => Err(FolderError::Exists { path: folder.path().join(found.name) }),
            }
        }
    }
    .map_err(|error| folder_refusal(&error))?;
    Ok(FileAnswer::Done(LocalizedText::new(
        format!("{title} 已复制为 O{to:04}"),
        format!("{title} copied to O{to:04}"),
    )))
}

fn rename_program(folder: &Folder, from: u32, to: u32) -> Result<FileAnswer, Refusal> {
    folder.rename(&PROGRAM, file_number(from)?, file_number(to)?).map_err(|error| folder_refusal(&error))?;
    Ok(FileAnswer::Done(LocalizedText::new(
        format!("O{from:04} 已改为 O{to:04}"),
        format!("O{from:04} is now O{to:04}"),
    )))
}

fn delete_program(folder: &Folder, of: &ProgramFile) -> Result<FileAnswer, Refusal> {
    let title = &of.title;
    match &of.file {
        Some(file) => folder.delete_named(&PROGRAM, file),
        None => folder.delete(&PROGRAM, file_number(of.number)?),
    }
    .map_err(|error| folder_refusal(&error))?;
    Ok(FileAnswer::Done(LocalizedText::new(format!("{title} 已删除"), format!("{title} deleted"))))
}

/// Checks the syntax of some lines. Jumps out of them and loops across them are allowed.
fn check_lines(number: u32, first: u32, text: &str, token: u64, settings: &NcSettings) -> LineCheck {
    let source = Arc::new(Source::new(number, "", text.as_bytes().to_vec(), settings.dialect));
    let found = check_syntax(&source, settings);
    let faults = found.iter().map(line_fault).map(|fault| {
        let line = first + fault.line.saturating_sub(1);
        LineFault { line, ..fault }
    });
    LineCheck { token, faults: faults.collect() }
}
