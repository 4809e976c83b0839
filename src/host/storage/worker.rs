//! Carries out storage requests. Called in the step of a headless host, or by the storage threads.
//! Source: spec B3, B6, K7.3.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

use super::Arrival;
use crate::controller::StorageRequest;
use crate::controller::StoredProgram;
use crate::controller::files::BackgroundJob;
use crate::defs::text::LocalizedText;
use crate::host::job_answer::ChangedFolders;
use crate::host::job_runner::JobRunner;
use crate::host::password_store::PasswordStore;
use crate::host::print_file::{self, printed_lines};
use crate::host::retained_store::RetainedStore;
use crate::link::command::Command;
use crate::link::files::FileAnswer;
use crate::link::page_command::{PageCommand, SettingsRequest, StorageAnswer};
use crate::store::FolderError;

/// Where retained data and passwords are kept.
pub enum RetainedWorker {
    /// In the data directory.
    Disk(RetainedStore),
    /// In memory, until the program ends: the host itself keeps the retained data.
    Memory(PasswordStore),
}

impl RetainedWorker {
    /// The store of a data directory, or memory without one.
    #[must_use]
    pub fn new(store: Option<RetainedStore>) -> Self {
        store.map_or_else(|| Self::Memory(PasswordStore::default()), Self::Disk)
    }

    /// Answers the requests of the pages, then stores the values and acknowledges the commit.
    pub(super) fn handle(&mut self, requests: &[StorageRequest], tell: &mut dyn FnMut(Arrival)) {
        for request in requests {
            if let StorageRequest::Page(request) = request {
                tell(Arrival::Command(self.answer(request)));
            }
        }
        if let Self::Disk(store) = self
            && requests.iter().any(StorageRequest::is_retained)
            && let Err(error) = store.commit(requests)
        {
            return tell(Arrival::Command(Command::DiskFailed(LocalizedText::same(&error))));
        }
        let mark = requests.iter().rev().find_map(|request| match request {
            StorageRequest::Mark(mark) => Some(*mark),
            _ => None,
        });
        if let Some(mark) = mark {
            tell(Arrival::Command(Command::Stored(mark)));
        }
    }

    /// What to tell of data that were removed or replaced; nothing is stored that would notice it.
    pub(super) fn absence(&mut self) -> Option<Command> {
        let Self::Disk(store) = self else { return None };
        store.check_files().err().map(|error| Command::DiskFailed(LocalizedText::same(&error)))
    }

    fn answer(&mut self, request: &SettingsRequest) -> Command {
        match self {
            Self::Disk(store) => store.answer(request),
            Self::Memory(passwords) => passwords.answer(request, None),
        }
    }
}

/// Runs jobs and reads the folders.
#[derive(Clone)]
pub struct StorageWorker {
    /// Runs the jobs of the pages.
    pub jobs: JobRunner,
    /// Programs that are not in the folder: files named on the command line.
    pub added: Vec<StoredProgram>,
    pub(super) delivered: KeptArrivals,
    /// Held while a folder is read and delivered: what was read first is delivered first, whichever thread reads.
    pub(super) reading: Arc<Mutex<()>>,
}

/// What the control was given. Storage keeps it until nobody else has it, so that its memory is never freed in a tick.
#[derive(Clone, Default)]
pub(super) struct KeptArrivals(Arc<Mutex<Vec<Arc<dyn Any + Send + Sync>>>>);

impl KeptArrivals {
    fn keep(&self, items: impl IntoIterator<Item = Arc<dyn Any + Send + Sync>>) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend(items);
    }

    fn free_unused(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).retain(|item| Arc::strong_count(item) > 1);
    }
}

impl StorageWorker {
    /// A worker without added programs.
    #[must_use]
    pub fn new(jobs: JobRunner) -> Self {
        Self { jobs, added: Vec::new(), delivered: KeptArrivals::default(), reading: Arc::default() }
    }

    /// Keeps the lines that programs print. A folder that cannot be written raises an alarm.
    pub(super) fn print(&self, requests: &[StorageRequest], tell: &mut dyn FnMut(Arrival)) {
        if let Some(folder) = self.jobs.prints()
            && let Err(error) = print_file::append(folder, printed_lines(requests))
        {
            let (place, cause) = (folder.display(), error);
            tell(Arrival::Command(Command::DiskFailed(LocalizedText::same(&format!("DPRNT, {place}: {cause}")))));
        }
    }

    /// Runs a job. Folders that it changed are read before its final answer is told.
    pub(super) fn run(&self, job: &BackgroundJob, tell: &mut dyn FnMut(Arrival)) {
        let told = |answer| {
            let answer = StorageAnswer::File(job.ticket, answer);
            Arrival::Command(Command::Page(PageCommand::StorageAnswered(answer)))
        };
        let mut last = Vec::new();
        let changed = self.jobs.run(job, &mut |answer| match answer {
            FileAnswer::Progress(..) | FileAnswer::BytesReceived(..) | FileAnswer::ToolpathComputed(_) => {
                tell(told(answer));
            }
            answer => last.push(answer),
        });
        self.read(changed, tell);
        last.into_iter().map(told).for_each(tell);
    }

    /// Reads the changed folders, after a read that another thread has begun. A folder that cannot be read raises an
    /// alarm.
    pub(super) fn read(&self, changed: ChangedFolders, tell: &mut dyn FnMut(Arrival)) {
        self.free_unused();
        if changed == ChangedFolders::default() {
            return;
        }
        let _reading = self.reading.lock().unwrap_or_else(PoisonError::into_inner);
        let failed = |error: FolderError| Arrival::Command(Command::DiskFailed(error.message()));
        if changed.programs {
            tell(self.programs().unwrap_or_else(failed));
        }
        if changed.screens {
            tell(self.screens().unwrap_or_else(failed));
        }
    }

    /// Frees what was delivered and is used by nobody any more.
    pub(super) fn free_unused(&self) {
        self.delivered.free_unused();
    }

    /// The programs of the folder and the added ones.
    pub(super) fn programs(&self) -> Result<Arrival, FolderError> {
        let (mut programs, directory) = self.jobs.folders().read_programs()?;
        programs.replace(self.added.clone());
        let (programs, directory) = (Arc::new(programs), Arc::new(directory));
        self.delivered.keep([Arc::clone(&programs) as _, Arc::clone(&directory) as _]);
        Ok(Arrival::Programs(programs, directory))
    }

    /// The page files.
    pub(super) fn screens(&self) -> Result<Arrival, FolderError> {
        let screens = Arc::new(self.jobs.folders().read_screens()?);
        self.delivered.keep([Arc::clone(&screens) as _]);
        Ok(Arrival::Command(Command::ScreensLoaded(screens)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;
    use crate::host::folders::Folders;

    /// Without it a listing from before a job could replace the one from after it.
    #[test]
    fn no_folder_is_read_while_another_read_is_delivered() {
        let files = tempfile::tempdir().unwrap();
        let (programs, screens) = (files.path().to_path_buf(), files.path().to_path_buf());
        let folders = Folders { programs, screens, by_name: false, dialect: Kind::Gc.dialect() };
        let worker = StorageWorker::new(JobRunner::new(folders));
        let mut told = 0;
        worker.clone().read(ChangedFolders { programs: true, screens: true }, &mut |_| {
            assert!(worker.reading.try_lock().is_err());
            told += 1;
        });
        assert_eq!(told, 2);
        assert!(worker.reading.try_lock().is_ok());
    }

    #[test]
    fn what_was_delivered_is_freed_by_storage_when_nobody_uses_it() {
        let delivered = KeptArrivals::default();
        let used = Arc::new(1_u8);
        let (unused, watched) = (Arc::new(2_u8), Arc::downgrade(&used));
        delivered.keep([Arc::clone(&used) as _, unused as _]);
        delivered.free_unused();
        assert_eq!(delivered.0.lock().unwrap().len(), 1);
        drop(used);
        assert!(watched.upgrade().is_some(), "the last user frees nothing");
        delivered.free_unused();
        assert!(watched.upgrade().is_none());
    }
}
