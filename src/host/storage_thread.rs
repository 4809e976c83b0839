//! The disk thread: stores retained data and acknowledges after the commit; detects files copied into the folders.
//! Source: notes "reliability", K7.3 ("copied in by the operator at any time").

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam_channel::{RecvTimeoutError, Sender, bounded};

use super::clock;
use super::folders::Folders;
use super::job_runner::JobRunner;
use super::realtime::{ProgramDelivery, StorageChannels};
use super::retained_store::RetainedStore;
use crate::controller::StorageRequest;
use crate::controller::files::BackgroundJob;
use crate::defs::text::LocalizedText;
use crate::link::command::Command;
use crate::link::files::{FileAnswer, FileRequest, Refusal};
use crate::link::media::TransferSet;
use crate::link::page_command::{PageCommand, StorageAnswer};
use crate::store::{FolderChange, FolderError, FolderWatch};

/// How long the thread waits for requests before it checks the folders again.
const POLL_INTERVAL: Duration = Duration::from_millis(200);
/// How often the thread sends the computer's clock to the core.
const CALENDAR_INTERVAL: Duration = Duration::from_secs(10);
/// Capacity of each job queue.
const JOB_QUEUE: usize = 8;
/// Maximum number of further request batches in one commit.
const MAX_BATCHES: usize = 64;

/// Starts the thread; it ends with the control thread.
///
/// # Errors
/// The system cannot create a thread.
pub fn start(
    end: StorageChannels,
    mut keeper: Option<RetainedStore>,
    folders: Folders,
    office: JobRunner,
) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("kt830-disk".into()).spawn(move || {
        let desk = |name: &str| start_job_thread(&end, &folders, office.clone(), name);
        // A serial transfer can take minutes, so it has its own thread.
        let (jobs, line) = (desk("kt830-office"), desk("kt830-line"));
        let mut watch = FolderWatch::start(&folders.programs, &folders.screens);
        deliver(&end.commands, &end.deliveries, &folders, FolderChange::Programs);
        deliver(&end.commands, &end.deliveries, &folders, FolderChange::Screens);
        let mut told = None::<Instant>;
        loop {
            if told.is_none_or(|told| told.elapsed() >= CALENDAR_INTERVAL) {
                told = Some(Instant::now());
                drop(end.commands.send(Command::WallClock(clock::local_time())));
            }
            match end.requests.recv_timeout(POLL_INTERVAL) {
                Ok(first) => handle_requests(&end, keeper.as_mut(), (&office, &jobs, &line), first),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            while let Some(changed) = watch.try_recv(Instant::now()) {
                deliver(&end.commands, &end.deliveries, &folders, changed);
            }
        }
    })
}

/// Starts a job thread; it ends when its queue is closed.
fn start_job_thread(end: &StorageChannels, folders: &Folders, office: JobRunner, name: &str) -> Sender<BackgroundJob> {
    let (jobs, waiting) = bounded::<BackgroundJob>(JOB_QUEUE);
    let (commands, deliveries, folders) = (end.commands.clone(), end.deliveries.clone(), folders.clone());
    let spawned = std::thread::Builder::new().name(name.into()).spawn(move || {
        for job in waiting {
            let changed = office.run(&job, &mut |answer| {
                drop(
                    commands.send(Command::Page(PageCommand::StorageAnswered(StorageAnswer::File(job.ticket, answer)))),
                );
            });
            if changed.programs {
                deliver(&commands, &deliveries, &folders, FolderChange::Programs);
            }
            if changed.screens {
                deliver(&commands, &deliveries, &folders, FolderChange::Screens);
            }
        }
    });
    if let Err(error) = spawned {
        let said = LocalizedText::new(error.to_string(), error.to_string());
        drop(end.commands.send(Command::DiskFailed(said)));
    }
    jobs
}

fn handle_requests(
    end: &StorageChannels,
    keeper: Option<&mut RetainedStore>,
    office: (&JobRunner, &Sender<BackgroundJob>, &Sender<BackgroundJob>),
    first: Vec<StorageRequest>,
) {
    let Some(keeper) = keeper else { return };
    let mut effects = first;
    effects.extend(end.requests.try_iter().take(MAX_BATCHES).flatten());
    for effect in &effects {
        match effect {
            StorageRequest::Page(wish) => drop(end.commands.send(keeper.answer(wish))),
            StorageRequest::Job(job) if job.request == FileRequest::Cancel => office.0.cancel(),
            StorageRequest::Job(job) => queue_job(end, if is_serial(job) { office.2 } else { office.1 }, job),
            _ => {}
        }
    }
    effects.retain(|effect| !matches!(effect, StorageRequest::Page(_) | StorageRequest::Job(_)));
    if effects.is_empty() {
        return;
    }
    let answer = match keeper.commit(&effects) {
        Ok(generation) => Command::Stored(generation),
        Err(error) => Command::DiskFailed(LocalizedText::new(error.to_string(), error.to_string())),
    };
    drop(end.commands.send(answer));
}

fn is_serial(job: &BackgroundJob) -> bool {
    matches!(&job.request, FileRequest::Transfer(ask) if ask.set == TransferSet::Serial)
}

/// Queues a job without waiting. A full queue is answered with a busy message, except for requests that pages repeat.
fn queue_job(end: &StorageChannels, jobs: &Sender<BackgroundJob>, job: &BackgroundJob) {
    let asked_again = matches!(job.request, FileRequest::CheckLines { .. } | FileRequest::ListMedia);
    if jobs.try_send(job.clone()).is_err() && !asked_again {
        let busy = LocalizedText::new("上一项工作未完成，请稍候", "the work before is not done: wait");
        let answer = FileAnswer::Refused(Refusal::Other(busy));
        drop(end.commands.send(Command::Page(PageCommand::StorageAnswered(StorageAnswer::File(job.ticket, answer)))));
    }
}

fn deliver(commands: &Sender<Command>, deliveries: &Sender<ProgramDelivery>, folders: &Folders, changed: FolderChange) {
    let failed = |error: &FolderError| drop(commands.send(Command::DiskFailed(error.message())));
    match changed {
        FolderChange::Programs => match folders.read_programs() {
            Ok((programs, directory)) => {
                let delivery = ProgramDelivery { programs: Arc::new(programs), directory: Arc::new(directory) };
                drop(deliveries.send(delivery));
            }
            Err(error) => failed(&error),
        },
        FolderChange::Screens => match folders.read_screens() {
            Ok(screens) => drop(commands.send(Command::ScreensLoaded(Arc::new(screens)))),
            Err(error) => failed(&error),
        },
    }
}
