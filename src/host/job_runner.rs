//! Runs the jobs that the pages request outside the tick: saving and copying programs, checking the syntax of lines.
//! Jobs run on their own thread, so that a long one never delays retained data; a headless host runs them in the step.
//! Source: spec B6, K6.2, H8.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use super::clock;
use super::folders::Folders;
use super::job_answer::{ChangedFolders, JobResult, Tell, cancelled, line_fault, no_usb_drive, refusal};
use super::leadscrew_files;
use super::page_file::PageFileFolder;
use super::program_file::ProgramFiles;
use super::serial::SerialError;
use super::serial::format::SerialProgram;
use super::serial::port::{SerialLine, SerialWait, port_names};
use super::serial::transfer::SerialTransfer;
use super::toolpath::{self, CycleTimer};
use super::transfer::{self, SaveTarget, UsbTransfer};
use crate::controller::files::BackgroundJob;
use crate::defs::date::DateTime;
use crate::defs::text::{LocalizedText, phrase};
use crate::link::files::{FileAnswer, FileRequest, LineCheck, Refusal};
use crate::link::line_fault::LineFault;
use crate::link::media::{Direction, MediaView, TransferRequest, TransferSet};
use crate::link::teach::program_text;
use crate::link::toolpath::CycleTime;
use crate::nc::{NcSettings, Source, check_syntax};
use crate::store::{Folder, StoredSettings, UsbDrive};

/// Runs jobs on the disk.
#[derive(Clone, Debug)]
pub struct JobRunner {
    folders: Folders,
    /// Folder of screenshots and printed lines; `None` saves them on a USB drive only.
    prints: Option<PathBuf>,
    /// The given USB drive; `None` uses the one that is plugged in.
    usb_drive: Option<UsbDrive>,
    /// The given RS232 port.
    port: Option<String>,
    /// Data directory whose settings name the port if none is given.
    data_dir: Option<PathBuf>,
    /// Runs a program for its time; `None` keeps the time at the programmed feeds.
    cycle_timer: Option<CycleTimer>,
    /// Received programs that wait for the answer whether to overwrite.
    received: Arc<Mutex<Vec<SerialProgram>>>,
    /// The operator has cancelled the long job in progress.
    cancelled: Arc<AtomicBool>,
    /// The control is closing down; set once and for all runners.
    ending: Arc<AtomicBool>,
}

impl JobRunner {
    /// A runner for the two folders.
    #[must_use]
    pub fn new(folders: Folders) -> Self {
        Self {
            folders,
            prints: None,
            usb_drive: None,
            port: None,
            data_dir: None,
            cycle_timer: None,
            received: Arc::default(),
            cancelled: Arc::default(),
            ending: Arc::default(),
        }
    }

    /// Sets the folder for screenshots and the folder used as the USB drive.
    #[must_use]
    pub fn with_drives(self, prints: Option<PathBuf>, usb_drive: Option<PathBuf>) -> Self {
        Self { prints, usb_drive: usb_drive.map(UsbDrive::at), ..self }
    }

    /// Sets the RS232 port, or the data directory whose settings name it.
    #[must_use]
    pub fn with_serial(self, port: Option<String>, data: Option<PathBuf>) -> Self {
        Self { port, data_dir: data, ..self }
    }

    /// Sets what runs a program for its time.
    #[must_use]
    pub fn with_cycle_timer(self, timer: CycleTimer) -> Self {
        Self { cycle_timer: Some(timer), ..self }
    }

    /// The same runner with a cancel flag of its own, for a second thread.
    #[must_use]
    pub fn with_own_cancel(self) -> Self {
        Self { cancelled: Arc::default(), ..self }
    }

    /// The folders of programs and page files.
    #[must_use]
    pub const fn folders(&self) -> &Folders {
        &self.folders
    }

    /// The folder of printed lines.
    pub(in crate::host) fn prints(&self) -> Option<&Path> {
        self.prints.as_deref()
    }

    fn port(&self) -> Option<String> {
        let stored = || StoredSettings::read(self.data_dir.as_deref()?).ok()?.serial;
        self.port.clone().or_else(stored)
    }

    fn usb_drive(&self) -> Option<UsbDrive> {
        self.usb_drive.clone().or_else(UsbDrive::find).filter(UsbDrive::is_present)
    }

    /// Cancels the long job in progress.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Release);
    }

    /// Ends the jobs that nobody waits for when the control closes down: calculations and transfers over the line, the
    /// one in progress and all that follow. Jobs that write files are completed.
    pub fn end(&self) {
        self.ending.store(true, Ordering::Release);
    }

    /// Whether a calculation or a transfer over the line is to stop.
    fn is_stopped(&self) -> bool {
        self.cancelled.load(Ordering::Acquire) || self.ending.load(Ordering::Acquire)
    }

    /// Runs a job. `tell` receives its answers; the last one completes it.
    pub fn run(&self, job: &BackgroundJob, tell: &mut dyn FnMut(FileAnswer)) -> ChangedFolders {
        if self.ending.load(Ordering::Acquire) && ends_with_control(&job.request) {
            return report_answer(Err(cancelled()), tell);
        }
        // A long job, which 取消 cancels.
        if matches!(job.request, FileRequest::Transfer(_) | FileRequest::ComputeToolpath(_)) {
            self.cancelled.store(false, Ordering::Release);
        }
        let pages = PageFileFolder { screens: Folder::new(&self.folders.screens), usb_drive: self.usb_drive() };
        let files = ProgramFiles {
            folder: Folder::new(&self.folders.programs),
            programs: &job.programs,
            dialect: job.settings.dialect,
            subprograms_locked: job.subprograms_locked,
        };
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
            FileRequest::SaveScreenshot(_)
            | FileRequest::SaveTable(_)
            | FileRequest::SaveReport(_)
            | FileRequest::ExportLeadscrew(..) => report_answer(self.export(job).map(FileAnswer::Done), tell),
            FileRequest::ReadPage { id, program } => {
                report_answer(pages.read(*id, *program, job).map(|read| FileAnswer::Page(Arc::new(read))), tell)
            }
            FileRequest::SavePage { id, text, base_stamp: base, overwrite: force } => {
                report_page_change(pages.save(*id, text, *base, *force), tell)
            }
            FileRequest::ImportPicture { page, from, name } => {
                report_page_change(pages.take_picture(*page, *from, name), tell)
            }
            FileRequest::SavePictureLabels { page, labels, base } => {
                report_page_change(pages.save_labels(*page, labels, base, job.settings.dialect), tell)
            }
            FileRequest::Transfer(ask) if ask.set == TransferSet::Serial => self.transfer_serial(ask, job, tell),
            FileRequest::Transfer(ask) => self.transfer_usb(ask, job, tell),
            FileRequest::ImportLeadscrew(axis) => {
                report_answer(leadscrew_files::read(*axis, self.usb_drive().as_ref()), tell)
            }
            FileRequest::Save { number, text, base_stamp: base, overwrite: force } => {
                report_program_change(files.save(*number, text, (*base, *force)), tell)
            }
            FileRequest::SaveRecording(blocks) => {
                report_program_change(files.save_recording(&program_text(blocks)), tell)
            }
            FileRequest::New(number) => report_program_change(files.create(*number), tell),
            FileRequest::Copy { from, to } => report_program_change(files.copy(*from, *to), tell),
            FileRequest::Rename { from, to } => report_program_change(files.rename(*from, *to), tell),
            FileRequest::Delete(number) => report_program_change(files.delete(*number), tell),
        }
    }

    /// Writes a picture or a table to the folder of screenshots or the USB drive.
    fn export(&self, job: &BackgroundJob) -> Result<LocalizedText, Refusal> {
        let (date, usb) = (file_date(job), self.usb_drive());
        let target = SaveTarget { folder: self.prints.as_deref(), usb_drive: usb.as_ref() };
        match &job.request {
            FileRequest::SaveScreenshot(picture) => target.save_screenshot(picture, date),
            FileRequest::SaveTable(text) => target.save_dated(text.as_bytes(), date, "CSV"),
            FileRequest::SaveReport(text) => target.save_dated(text.as_bytes(), date, "HTML"),
            FileRequest::ExportLeadscrew(axis, table) => leadscrew_files::write(*axis, table, date, target),
            other => Err(refusal("不能导出", format!("{other:?} cannot be exported"))),
        }
    }
}

/// Answers a job that changes no folder.
fn report_answer(done: JobResult, tell: Tell<'_>) -> ChangedFolders {
    tell(done.unwrap_or_else(FileAnswer::Refused));
    ChangedFolders::default()
}

/// Answers a change of a program.
fn report_program_change(done: JobResult, tell: Tell<'_>) -> ChangedFolders {
    // At a conflict the file was changed from outside: the core must read it again, too.
    let programs = done.is_ok() || done == Err(Refusal::Conflict);
    ChangedFolders { programs, ..report_answer(done, tell) }
}

/// Answers a change of a page file; the page files are read again, also where others have changed them.
fn report_page_change(done: JobResult, tell: Tell<'_>) -> ChangedFolders {
    let screens = done.is_ok() || done == Err(Refusal::Conflict);
    ChangedFolders { screens, ..report_answer(done, tell) }
}

/// Date and time for file names: the machine's, otherwise the computer's.
fn file_date(job: &BackgroundJob) -> DateTime {
    job.date.unwrap_or_else(clock::local_time)
}

/// Whether a request is a calculation or a transfer over the line, which end with the control.
fn ends_with_control(request: &FileRequest) -> bool {
    let serial = matches!(request, FileRequest::Transfer(ask) if ask.set == TransferSet::Serial);
    serial || matches!(request, FileRequest::ComputeToolpath(_))
}

impl JobRunner {
    /// Sends or receives programs over RS232.
    fn transfer_serial(&self, ask: &TransferRequest, job: &BackgroundJob, tell: Tell<'_>) -> ChangedFolders {
        let unchosen = || SerialError::Port(phrase!("没有选择端口", "no port is chosen"));
        let line = self.port().ok_or_else(unchosen).map_err(Refusal::from).and_then(|port| {
            let holdings = job.transfer_values.as_deref().ok_or_else(no_usb_drive)?;
            Ok(SerialLine::from_params(&holdings.params, port))
        });
        let shelf = self.folders.program_folder();
        let wait = SerialWait { stopped: &|| self.is_stopped(), now: &Instant::now };
        let (by_name, received) = (self.folders.by_name, &*self.received);
        let done = line
            .and_then(|line| SerialTransfer { folder: &shelf, by_name, port: &line, wait, received }.run(ask, tell));
        ChangedFolders { programs: ask.direction == Direction::Import, ..report_answer(done, tell) }
    }

    fn transfer_usb(&self, ask: &TransferRequest, job: &BackgroundJob, tell: Tell<'_>) -> ChangedFolders {
        let Some(drive) = self.usb_drive() else { return report_answer(Err(no_usb_drive()), tell) };
        let (holdings, cancelled, date) = (job.transfer_values.as_deref(), &*self.cancelled, file_date(job));
        let subprograms_locked = job.subprograms_locked;
        let folders = &self.folders;
        let transfer = UsbTransfer { folders, usb_drive: &drive, holdings, subprograms_locked, cancelled, date };
        report_answer(transfer.run(ask, tell), tell);
        // Incoming files change the folders.
        let inward = ask.direction == Direction::Import;
        ChangedFolders {
            programs: inward && matches!(ask.set, TransferSet::Programs | TransferSet::Backup),
            screens: inward && matches!(ask.set, TransferSet::Screens | TransferSet::Backup),
        }
    }

    fn compute_toolpath(&self, number: u32, job: &BackgroundJob, tell: Tell<'_>) -> JobResult {
        let missing = || refusal(format!("没有程序 O{number:04}"), format!("there is no O{number:04}"));
        let program = job.programs.get(number).ok_or_else(missing)?;
        let start = job.start.as_ref().ok_or_else(missing)?;
        tell(FileAnswer::Progress(toolpath::PROGRESS_TEXT, 0));
        let mut drawing = toolpath::compute_toolpath(program, job, start, &|| self.is_stopped(), tell);
        if let Some(timer) = self.cycle_timer.filter(|_| drawing.finished && drawing.faults.is_empty()) {
            tell(FileAnswer::Progress(toolpath::TIMING_TEXT, toolpath::TIMING_PROGRESS));
            let seconds = timer(program, job, start, &|| self.is_stopped());
            drawing.cycle_time = seconds.map_or(drawing.cycle_time, CycleTime::Simulated);
        }
        if self.is_stopped() {
            return Err(cancelled());
        }
        Ok(FileAnswer::ToolpathComputed(Arc::new(drawing)))
    }
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
