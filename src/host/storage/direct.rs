//! Storage in the step: a request is carried out before the step ends, its answer comes with the next tick. Folders are
//! read at the start and after jobs that change them; files copied in meanwhile are not seen.
//! Source: spec tools.md T3, T5.

use super::{Arrival, RetainedWorker, Storage, StorageWorker};
use crate::controller::{StorageRequest, StoredProgram};
use crate::host::job_runner::JobRunner;
use crate::host::part::PartQuery;
use crate::host::print_file::printed_lines;
use crate::store::FolderError;

/// Most printed lines that wait to be taken; the oldest are dropped first.
const MAX_PRINTED: usize = 100_000;

/// Storage without threads.
pub struct DirectStorage {
    retained: RetainedWorker,
    worker: StorageWorker,
    arrivals: Vec<Arrival>,
    /// Lines that programs have printed since they were taken.
    printed: Vec<String>,
}

impl DirectStorage {
    /// Reads the folders.
    ///
    /// # Errors
    /// A folder cannot be read.
    pub fn new(retained: RetainedWorker, jobs: JobRunner) -> Result<Self, FolderError> {
        let worker = StorageWorker::new(jobs);
        let arrivals = vec![worker.programs()?, worker.screens()?];
        Ok(Self { retained, worker, arrivals, printed: Vec::new() })
    }

    /// Keeps programs that are not in the folder; they come again whenever the folder is read.
    pub(in crate::host) fn keep_programs(&mut self, programs: &[StoredProgram]) {
        self.worker.added.extend_from_slice(programs);
    }

    /// Takes the lines that programs have printed.
    pub(in crate::host) fn take_printed(&mut self) -> Vec<String> {
        std::mem::take(&mut self.printed)
    }

    /// Changes how jobs are run: drives, serial port.
    pub(in crate::host) fn change_jobs(&mut self, change: impl FnOnce(JobRunner) -> JobRunner) {
        self.worker.jobs = change(self.worker.jobs.clone());
    }
}

impl Storage for DirectStorage {
    fn submit(&mut self, requests: &mut Vec<StorageRequest>) {
        let tell = &mut |arrival| self.arrivals.push(arrival);
        self.retained.handle(requests, tell);
        self.worker.print(requests, tell);
        self.printed.extend(printed_lines(requests).map(|(_, line)| line.as_name().to_owned()));
        self.printed.drain(..self.printed.len().saturating_sub(MAX_PRINTED));
        for request in requests.drain(..) {
            // A job that is cancelled has ended already: `run` does nothing with `Cancel`.
            if let StorageRequest::Job(job) = request {
                self.worker.run(&job, tell);
            }
        }
    }

    fn find_part(&mut self, query: PartQuery) -> bool {
        self.arrivals.push(Arrival::Part(query.find().map(Box::new)));
        true
    }

    fn poll(&mut self, arrivals: &mut Vec<Arrival>) {
        arrivals.append(&mut self.arrivals);
    }

    /// Everything is stored in the step already.
    fn close(&mut self) {}
}
