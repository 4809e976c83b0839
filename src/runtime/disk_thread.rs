//! The disk thread: stores retained data and acknowledges after the commit; detects files copied into the folders.
//! Source: notes "reliability", K7.3 ("copied in by the operator at any time").

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam_channel::{RecvTimeoutError, Sender, bounded};

use super::clock;
use super::disk::Folders;
use super::keeper::Keeper;
use super::office::Office;
use super::realtime::{Delivery, DiskEnd};
use crate::controller::Effect;
use crate::controller::files::Job;
use crate::defs::text::Said;
use crate::link::command::Command;
use crate::link::files::{FileAnswer, FileRequest, Refusal};
use crate::link::media::Set;
use crate::link::page_command::{PageAnswer, PageCommand};
use crate::store::{Changed, FolderError, Watch};

/// How long the thread waits for requests before it checks the folders again.
const LOOK_EVERY: Duration = Duration::from_millis(200);
/// How often the thread sends the computer's clock to the core.
const CLOCK_EVERY: Duration = Duration::from_secs(10);
/// Capacity of each job queue.
const JOBS: usize = 8;
/// Maximum number of further request batches in one commit.
const BATCHES: usize = 64;

/// Starts the thread; it ends with the control thread.
///
/// # Errors
/// The system cannot create a thread.
pub fn start(
    end: DiskEnd,
    mut keeper: Option<Keeper>,
    folders: Folders,
    office: Office,
) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("kt830-disk".into()).spawn(move || {
        let desk = |name: &str| open_office(&end, &folders, office.clone(), name);
        // A serial transfer can take minutes, so it has its own thread.
        let (jobs, line) = (desk("kt830-office"), desk("kt830-line"));
        let mut watch = Watch::start(&folders.programs, &folders.screens);
        deliver(&end.commands, &end.deliveries, &folders, Changed::Programs);
        deliver(&end.commands, &end.deliveries, &folders, Changed::Screens);
        let mut told = None::<Instant>;
        loop {
            if told.is_none_or(|told| told.elapsed() >= CLOCK_EVERY) {
                told = Some(Instant::now());
                drop(end.commands.send(Command::Calendar(clock::local())));
            }
            match end.wishes.recv_timeout(LOOK_EVERY) {
                Ok(first) => keep(&end, keeper.as_mut(), (&office, &jobs, &line), first),
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
fn open_office(end: &DiskEnd, folders: &Folders, office: Office, name: &str) -> Sender<Job> {
    let (jobs, waiting) = bounded::<Job>(JOBS);
    let (commands, deliveries, folders) = (end.commands.clone(), end.deliveries.clone(), folders.clone());
    let spawned = std::thread::Builder::new().name(name.into()).spawn(move || {
        for job in waiting {
            let changed = office.work(&job, &mut |answer| {
                drop(commands.send(Command::Page(PageCommand::Answered(PageAnswer::File(job.ticket, answer)))));
            });
            if changed.programs {
                deliver(&commands, &deliveries, &folders, Changed::Programs);
            }
            if changed.screens {
                deliver(&commands, &deliveries, &folders, Changed::Screens);
            }
        }
    });
    if let Err(error) = spawned {
        let said = Said::new(error.to_string(), error.to_string());
        drop(end.commands.send(Command::DiskFailed(said)));
    }
    jobs
}

fn keep(end: &DiskEnd, keeper: Option<&mut Keeper>, office: (&Office, &Sender<Job>, &Sender<Job>), first: Vec<Effect>) {
    let Some(keeper) = keeper else { return };
    let mut effects = first;
    effects.extend(end.wishes.try_iter().take(BATCHES).flatten());
    for effect in &effects {
        match effect {
            Effect::Ask(wish) => drop(end.commands.send(keeper.answer(wish))),
            Effect::Job(job) if job.request == FileRequest::Cancel => office.0.cancel(),
            Effect::Job(job) => hand_on(end, if is_serial(job) { office.2 } else { office.1 }, job),
            _ => {}
        }
    }
    effects.retain(|effect| !matches!(effect, Effect::Ask(_) | Effect::Job(_)));
    if effects.is_empty() {
        return;
    }
    let answer = match keeper.commit(&effects) {
        Ok(generation) => Command::Stored(generation),
        Err(error) => Command::DiskFailed(Said::new(error.to_string(), error.to_string())),
    };
    drop(end.commands.send(answer));
}

fn is_serial(job: &Job) -> bool {
    matches!(&job.request, FileRequest::Transfer(ask) if ask.set == Set::Serial)
}

/// Queues a job without waiting. A full queue is answered with a busy message, except for requests that pages repeat.
fn hand_on(end: &DiskEnd, jobs: &Sender<Job>, job: &Job) {
    let asked_again = matches!(job.request, FileRequest::Look { .. } | FileRequest::Media);
    if jobs.try_send(job.clone()).is_err() && !asked_again {
        let busy = Said::new("上一项工作未完成，请稍候", "the work before is not done: wait");
        let answer = FileAnswer::Refused(Refusal::Because(busy));
        drop(end.commands.send(Command::Page(PageCommand::Answered(PageAnswer::File(job.ticket, answer)))));
    }
}

fn deliver(commands: &Sender<Command>, deliveries: &Sender<Delivery>, folders: &Folders, changed: Changed) {
    let failed = |error: &FolderError| drop(commands.send(Command::DiskFailed(error.said())));
    match changed {
        Changed::Programs => match folders.read_programs() {
            Ok((programs, directory)) => {
                let delivery = Delivery { programs: Arc::new(programs), directory: Arc::new(directory) };
                drop(deliveries.send(delivery));
            }
            Err(error) => failed(&error),
        },
        Changed::Screens => match folders.read_screens() {
            Ok(screens) => drop(commands.send(Command::Screens(Arc::new(screens)))),
            Err(error) => failed(&error),
        },
    }
}
