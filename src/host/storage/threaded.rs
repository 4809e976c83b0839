//! Storage on threads: one for retained data and passwords, one for jobs, one for the serial line, so that neither a
//! long job nor a transfer of minutes delays retained data. Detects files copied into the folders and sends the time.
//! Source: notes "reliability", K7.3 ("copied in by the operator at any time"), L9.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded, never};

use super::{Arrival, RetainedWorker, Storage, StorageWorker};
use crate::controller::StorageRequest;
use crate::controller::files::BackgroundJob;
use crate::defs::text::{LocalizedText, phrase};
use crate::host::clock;
use crate::host::job_answer::ChangedFolders;
use crate::host::job_runner::JobRunner;
use crate::host::part::PartQuery;
use crate::link::command::Command;
use crate::link::files::{FileAnswer, FileRequest, Refusal, Ticket};
use crate::link::media::TransferSet;
use crate::link::page_command::{PageCommand, StorageAnswer};
use crate::store::{FolderChange, FolderWatch};

/// Capacity of the queue of request batches.
const REQUEST_QUEUE: usize = 4_096;
/// Capacity of the queue of arrivals, and most arrivals of one tick.
const ARRIVAL_QUEUE: usize = 256;
/// Capacity of each job queue.
const JOB_QUEUE: usize = 8;
/// How long the storage thread waits for requests before it looks at the folders again.
const POLL_INTERVAL: Duration = Duration::from_millis(200);
/// How often the storage thread sends the computer's clock.
const CALENDAR_INTERVAL: Duration = Duration::from_secs(10);
/// How often it looks whether the data are still there.
const PRESENCE_INTERVAL: Duration = Duration::from_secs(1);
/// Maximum number of further request batches in one commit.
const MAX_BATCHES: usize = 64;

/// A question to the storage thread.
enum StorageQuestion {
    Requests(Vec<StorageRequest>),
    Part(Box<PartQuery>),
}

/// Storage on threads of its own. Dropping it ends the threads.
pub struct ThreadedStorage {
    questions: Option<Sender<StorageQuestion>>,
    arrivals: Receiver<Arrival>,
    thread: Option<JoinHandle<()>>,
    jobs: JobQueues,
}

impl ThreadedStorage {
    /// Reads the folders and starts the threads. A folder that cannot be read raises an alarm.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub fn start(retained: RetainedWorker, worker: StorageWorker) -> std::io::Result<Self> {
        let (questions, asked) = bounded(REQUEST_QUEUE);
        let (tell, arrivals) = bounded(ARRIVAL_QUEUE);
        let folders = worker.jobs.folders();
        let watch = FolderWatch::start(&folders.programs, &folders.screens);
        // They arrive before the first tick.
        worker.read(ChangedFolders { programs: true, screens: true }, &mut |arrival| drop(tell.send(arrival)));
        let (jobs, threads) = JobQueues::start(&worker, &tell)?;
        let own = jobs.clone();
        let (waiting, clock_sent, presence_checked, is_absent) = (None, None, Instant::now(), false);
        let mut thread = StorageThread {
            retained,
            worker,
            asked,
            tell,
            watch,
            jobs: own,
            waiting,
            clock_sent,
            presence_checked,
            is_absent,
        };
        let thread = Builder::new().name("kt830-disk".into()).spawn(move || {
            while thread.turn() {}
            drop(thread);
            threads.into_iter().for_each(|thread| drop(thread.join()));
        })?;
        Ok(Self { questions: Some(questions), arrivals, thread: Some(thread), jobs })
    }
}

impl Storage for ThreadedStorage {
    fn submit(&mut self, requests: &mut Vec<StorageRequest>) {
        let Some(questions) = self.questions.as_ref().filter(|_| !requests.is_empty()) else { return };
        let sent = questions.try_send(StorageQuestion::Requests(std::mem::take(requests)));
        if let Err(StorageQuestion::Requests(kept)) = sent.map_err(TrySendError::into_inner) {
            *requests = kept;
        }
    }

    fn find_part(&mut self, query: PartQuery) -> bool {
        let question = StorageQuestion::Part(Box::new(query));
        self.questions.as_ref().is_some_and(|questions| questions.try_send(question).is_ok())
    }

    fn poll(&mut self, arrivals: &mut Vec<Arrival>) {
        arrivals.extend(self.arrivals.try_iter().take(ARRIVAL_QUEUE));
    }

    fn close(&mut self) {
        self.questions = None;
        // Nobody reads answers any more: a thread that waits for room goes on.
        self.arrivals = never();
        self.jobs.end();
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}

impl Drop for ThreadedStorage {
    fn drop(&mut self) {
        self.close();
    }
}

/// The queues of the two job threads.
#[derive(Clone)]
struct JobQueues {
    general: Option<Sender<BackgroundJob>>,
    line: Option<Sender<BackgroundJob>>,
    runners: [JobRunner; 2],
}

impl JobQueues {
    /// Starts the job threads; they end when their queues are closed.
    fn start(worker: &StorageWorker, tell: &Sender<Arrival>) -> std::io::Result<(Self, Vec<JoinHandle<()>>)> {
        let line_worker = StorageWorker { jobs: worker.jobs.clone().with_own_cancel(), ..worker.clone() };
        let (general, general_jobs) = bounded(JOB_QUEUE);
        let (line, line_jobs) = bounded(JOB_QUEUE);
        let runners = [worker.jobs.clone(), line_worker.jobs.clone()];
        let threads = vec![
            Self::spawn("kt830-jobs", worker.clone(), general_jobs, tell.clone())?,
            Self::spawn("kt830-line", line_worker, line_jobs, tell.clone())?,
        ];
        Ok((Self { general: Some(general), line: Some(line), runners }, threads))
    }

    fn spawn(
        name: &str,
        worker: StorageWorker,
        jobs: Receiver<BackgroundJob>,
        tell: Sender<Arrival>,
    ) -> std::io::Result<JoinHandle<()>> {
        Builder::new().name(name.into()).spawn(move || {
            for job in jobs {
                let mut arrived = |arrival| drop(tell.send(arrival));
                run_guarded(&job, &mut arrived, |arrived| worker.run(&job, arrived));
            }
        })
    }

    /// Queues a job without waiting. A full queue is answered with a busy message, except for requests that pages repeat.
    fn queue(&self, job: Box<BackgroundJob>) -> Option<Arrival> {
        if job.request == FileRequest::Cancel {
            self.runners.iter().for_each(JobRunner::cancel);
            return None;
        }
        let asked_again = matches!(job.request, FileRequest::CheckLines { .. } | FileRequest::ListMedia);
        let serial = matches!(&job.request, FileRequest::Transfer(ask) if ask.set == TransferSet::Serial);
        let (ticket, queue) = (job.ticket, if serial { &self.line } else { &self.general });
        let taken = queue.as_ref().is_some_and(|queue| queue.try_send(*job).is_ok());
        (!taken && !asked_again).then(|| {
            let busy = phrase!("上一项工作未完成，请稍候", "the previous job is not finished: wait");
            refused(ticket, busy)
        })
    }

    /// Closes the queues. A job that writes is completed; a calculation or a transfer over the line is cancelled.
    fn end(&mut self) {
        self.runners.iter().for_each(JobRunner::end);
        (self.general, self.line) = (None, None);
    }
}

/// Runs a job. A panic in it ends the job, not its thread: the control is told that it failed.
fn run_guarded(job: &BackgroundJob, arrived: &mut dyn FnMut(Arrival), run: impl FnOnce(&mut dyn FnMut(Arrival))) {
    if catch_unwind(AssertUnwindSafe(|| run(arrived))).is_ok() {
        return;
    }
    let failed = phrase!(
        "内部错误：该工作没有完成，请重试；再次出现时请重新启动并报告",
        "internal error: the job was not completed; try again, and if it returns, restart and report it"
    );
    arrived(refused(job.ticket, failed));
}

/// The answer to a job that was not carried out.
fn refused(ticket: Ticket, why: LocalizedText) -> Arrival {
    let answer = FileAnswer::Refused(Refusal::Other(why));
    Arrival::Command(Command::Page(PageCommand::StorageAnswered(StorageAnswer::File(ticket, answer))))
}

/// The state of the storage thread.
struct StorageThread {
    retained: RetainedWorker,
    worker: StorageWorker,
    asked: Receiver<StorageQuestion>,
    tell: Sender<Arrival>,
    watch: FolderWatch,
    jobs: JobQueues,
    /// A part question that came behind a batch of requests.
    waiting: Option<Box<PartQuery>>,
    clock_sent: Option<Instant>,
    presence_checked: Instant,
    /// The data are gone, and that was told.
    is_absent: bool,
}

impl StorageThread {
    /// Waits for requests, carries them out and looks at the folders; returns false at the end.
    fn turn(&mut self) -> bool {
        if self.clock_sent.is_none_or(|sent| sent.elapsed() >= CALENDAR_INTERVAL) {
            self.clock_sent = Some(Instant::now());
            drop(self.tell.send(Arrival::Command(Command::WallClock(clock::local_time()))));
        }
        self.check_presence();
        match self.asked.recv_timeout(POLL_INTERVAL) {
            Ok(StorageQuestion::Requests(first)) => self.handle(first),
            Ok(StorageQuestion::Part(query)) => self.waiting = Some(query),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        if let Some(query) = self.waiting.take() {
            drop(self.tell.send(Arrival::Part(query.find().map(Box::new))));
        }
        while let Some(changed) = self.watch.try_recv(Instant::now()) {
            let programs = changed == FolderChange::Programs;
            let tell = &self.tell;
            self.worker.read(ChangedFolders { programs, screens: !programs }, &mut |arrival| drop(tell.send(arrival)));
        }
        self.worker.free_unused();
        true
    }

    /// Tells once that the data were removed or replaced.
    fn check_presence(&mut self) {
        if self.presence_checked.elapsed() < PRESENCE_INTERVAL {
            return;
        }
        self.presence_checked = Instant::now();
        let absence = self.retained.absence();
        let was_absent = std::mem::replace(&mut self.is_absent, absence.is_some());
        if let Some(absence) = absence.filter(|_| !was_absent) {
            drop(self.tell.send(Arrival::Command(absence)));
        }
    }

    /// Carries out a batch and what waits behind it in one commit, up to the next part question.
    fn handle(&mut self, mut requests: Vec<StorageRequest>) {
        for _ in 0..MAX_BATCHES {
            match self.asked.try_recv() {
                Ok(StorageQuestion::Requests(more)) => requests.extend(more),
                Ok(StorageQuestion::Part(query)) => {
                    self.waiting = Some(query);
                    break;
                }
                Err(_) => break,
            }
        }
        let tell = &self.tell;
        self.retained.handle(&requests, &mut |arrival| drop(tell.send(arrival)));
        self.worker.print(&requests, &mut |arrival| drop(tell.send(arrival)));
        for request in requests {
            if let StorageRequest::Job(job) = request
                && let Some(busy) = self.jobs.queue(job)
            {
                drop(self.tell.send(busy));
            }
        }
    }
}
