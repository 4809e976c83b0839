//! The disk thread: keeps what the core wishes and acknowledges after the commit; sees files copied into the folders.
//! Source: notes "reliability", K7.3 ("copied in by the operator at any time").

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam_channel::RecvTimeoutError;

use super::disk::Folders;
use super::keeper::Keeper;
use super::realtime::{Delivery, DiskEnd};
use crate::controller::Effect;
use crate::defs::text::Said;
use crate::link::command::Command;
use crate::store::{Changed, Watch};

/// How long the thread waits for wishes before it looks at the folders again.
const LOOK_EVERY: Duration = Duration::from_millis(200);
/// Most batches of wishes in one commit.
const BATCHES: usize = 64;

/// Starts the thread; it ends when the control does.
///
/// # Errors
/// The system has no thread to give.
pub fn start(end: DiskEnd, mut keeper: Option<Keeper>, folders: Folders) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("kt830-disk".into()).spawn(move || {
        let mut watch = Watch::start(&folders.programs, &folders.screens);
        deliver(&end, &folders, Changed::Programs);
        deliver(&end, &folders, Changed::Screens);
        loop {
            match end.wishes.recv_timeout(LOOK_EVERY) {
                Ok(first) => keep(&end, keeper.as_mut(), first),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            while let Some(changed) = watch.try_recv(Instant::now()) {
                deliver(&end, &folders, changed);
            }
        }
    })
}

fn keep(end: &DiskEnd, keeper: Option<&mut Keeper>, first: Vec<Effect>) {
    let Some(keeper) = keeper else { return };
    let mut effects = first;
    effects.extend(end.wishes.try_iter().take(BATCHES).flatten());
    for effect in &effects {
        if let Effect::Ask(wish) = effect {
            drop(end.commands.send(keeper.answer(wish)));
        }
    }
    let answer = match keeper.commit(&effects) {
        Ok(generation) => Command::Stored(generation),
        Err(error) => Command::DiskFailed(Said::new(error.to_string(), error.to_string())),
    };
    drop(end.commands.send(answer));
}

fn deliver(end: &DiskEnd, folders: &Folders, changed: Changed) {
    let failed = |error: &dyn std::fmt::Display| {
        drop(end.commands.send(Command::DiskFailed(Said::new(error.to_string(), error.to_string()))));
    };
    match changed {
        Changed::Programs => match folders.read_programs() {
            Ok((programs, directory)) => {
                let delivery = Delivery { programs: Arc::new(programs), directory: Arc::new(directory) };
                drop(end.deliveries.send(delivery));
            }
            Err(error) => failed(&error),
        },
        Changed::Screens => match folders.read_screens() {
            Ok(screens) => drop(end.commands.send(Command::Screens(Arc::new(screens)))),
            Err(error) => failed(&error),
        },
    }
}
