//! Detects changes in `programs/` and `screens/`.
//!
//! Uses the system's change notifications. Without them (a network folder, no watches left) it lists the folders
//! periodically. At most one change per folder is pending, regardless of the number of files.
//! Source: spec K7.3 (copied in by the operator at any time).

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant, UNIX_EPOCH};

use notify::event::{AccessKind, AccessMode, ModifyKind};
use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};

use super::checksum::Checksum;

/// How often the folders are listed when there are no notifications.
pub const POLL_INTERVAL: Duration = Duration::from_secs(1);

/// Which folder changed. The caller lists it to find the changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FolderChange {
    /// `programs/`
    Programs,
    /// `screens/`
    Screens,
}

impl FolderChange {
    const ALL: [Self; 2] = [Self::Programs, Self::Screens];
}

/// Watches the two folders.
pub struct FolderWatch {
    folders: [PathBuf; 2],
    mode: WatchMode,
}

/// How changes are detected.
enum WatchMode {
    Notifications { _watcher: RecommendedWatcher, pending: Arc<PendingChanges>, waiting: Receiver<FolderChange> },
    Polling { cause: String, seen: [u64; 2], told: [bool; 2], next: Option<Instant> },
}

/// Shared with the system's thread: a flag per folder limits the channel to one notification each.
#[derive(Default)]
struct PendingChanges {
    flags: [AtomicBool; 2],
    lost: AtomicBool,
}

impl FolderWatch {
    /// Watches two existing folders. Never fails: without notifications from the system it polls.
    #[must_use]
    pub fn start(programs: &Path, screens: &Path) -> Self {
        // The system reports absolute paths.
        let whole = |folder: &Path| std::path::absolute(folder).unwrap_or_else(|_| folder.to_path_buf());
        let folders = [programs, screens].map(whole);
        let sight = start_notifications(&folders).unwrap_or_else(|wrong| start_polling(&folders, wrong.to_string()));
        Self { folders, mode: sight }
    }

    /// Watches by polling only.
    #[must_use]
    pub fn polling(programs: &Path, screens: &Path) -> Self {
        let folders = [programs.to_path_buf(), screens.to_path_buf()];
        let sight = start_polling(&folders, "polling was asked for".to_owned());
        Self { folders, mode: sight }
    }

    /// Why the folders are polled; `None` while the system sends notifications.
    #[must_use]
    pub fn polling_because(&self) -> Option<&str> {
        if let WatchMode::Polling { cause, .. } = &self.mode { Some(cause) } else { None }
    }

    /// Returns a changed folder without waiting. `now` controls the polling interval.
    pub fn try_recv(&mut self, now: Instant) -> Option<FolderChange> {
        if self.is_lost() {
            let mut sight = start_polling(&self.folders, "a watched folder was removed or its watch failed".to_owned());
            if let WatchMode::Polling { told, .. } = &mut sight {
                // Changes during the failure are unknown: both folders count as changed.
                *told = [false; 2];
            }
            self.mode = sight;
        }
        match &mut self.mode {
            WatchMode::Notifications { pending, waiting, .. } => {
                let changed = waiting.try_recv().ok()?;
                pending.flags[changed as usize].store(false, Ordering::Release);
                Some(changed)
            }
            WatchMode::Polling { seen, told, next, .. } => {
                if next.is_none_or(|next| now >= next) {
                    *next = Some(now + POLL_INTERVAL);
                    for ((folder, seen), told) in self.folders.iter().zip(seen).zip(told.iter_mut()) {
                        let before = std::mem::replace(seen, folder_fingerprint(folder));
                        *told &= before == *seen;
                    }
                }
                let changed = FolderChange::ALL.into_iter().find(|changed| !told[*changed as usize])?;
                told[changed as usize] = true;
                Some(changed)
            }
        }
    }

    /// As [`FolderWatch::try_recv`], but waits up to `longest` for a notification; does not wait when polling.
    pub fn recv_timeout(&mut self, now: Instant, longest: Duration) -> Option<FolderChange> {
        if let WatchMode::Notifications { pending, waiting, .. } = &self.mode
            && !pending.lost.load(Ordering::Acquire)
        {
            let changed = waiting.recv_timeout(longest).ok()?;
            pending.flags[changed as usize].store(false, Ordering::Release);
            return Some(changed);
        }
        self.try_recv(now)
    }

    fn is_lost(&self) -> bool {
        matches!(&self.mode, WatchMode::Notifications { pending, .. } if pending.lost.load(Ordering::Acquire))
    }
}

/// Starts the system's notifications.
fn start_notifications(folders: &[PathBuf; 2]) -> notify::Result<WatchMode> {
    let pending = Arc::new(PendingChanges::default());
    let (sender, waiting) = sync_channel(FolderChange::ALL.len());
    let (shared, roots) = (Arc::clone(&pending), folders.clone());
    let mut watcher =
        notify::recommended_watcher(move |event: notify::Result<Event>| handle_event(event, &roots, &shared, &sender))?;
    for folder in folders {
        watcher.watch(folder, RecursiveMode::NonRecursive)?;
    }
    Ok(WatchMode::Notifications { _watcher: watcher, pending, waiting })
}

/// Runs on the system's thread for each event.
fn handle_event(
    event: notify::Result<Event>,
    roots: &[PathBuf; 2],
    pending: &PendingChanges,
    sender: &SyncSender<FolderChange>,
) {
    let Ok(event) = event else { return pending.lost.store(true, Ordering::Release) };
    if !is_change(&event.kind) {
        return;
    }
    let overflowed = event.need_rescan();
    for (changed, root) in FolderChange::ALL.into_iter().zip(roots) {
        let moved_or_removed = matches!(event.kind, EventKind::Remove(_) | EventKind::Modify(ModifyKind::Name(_)));
        if moved_or_removed && event.paths.iter().any(|path| path == root) {
            pending.lost.store(true, Ordering::Release);
        }
        let concerned = overflowed || event.paths.iter().any(|path| path.starts_with(root));
        if concerned && !pending.flags[changed as usize].swap(true, Ordering::AcqRel) {
            // The channel has room for one notification per folder, and the flag allows one: it is never full.
            let _ = sender.try_send(changed);
        }
    }
}

/// Whether an event is a change. Reading a file is an event, too, and must not cause another read.
fn is_change(kind: &EventKind) -> bool {
    match kind {
        EventKind::Access(AccessKind::Close(AccessMode::Write)) => true,
        EventKind::Access(_) => false,
        EventKind::Any | EventKind::Create(_) | EventKind::Modify(_) | EventKind::Remove(_) | EventKind::Other => true,
    }
}

/// Starts polling; existing files are not a change.
fn start_polling(folders: &[PathBuf; 2], cause: String) -> WatchMode {
    let seen = folders.each_ref().map(|folder| folder_fingerprint(folder));
    WatchMode::Polling { cause, seen, told: [true; 2], next: None }
}

/// A checksum over names, sizes and times; an unreadable folder counts as empty.
fn folder_fingerprint(folder: &Path) -> u64 {
    let mut sum = 0_u64;
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let Ok(metadata) = entry.metadata() else { continue };
        let written = metadata.modified().ok().and_then(|at| at.duration_since(UNIX_EPOCH).ok()).unwrap_or_default();
        let print = Checksum::new()
            .add(entry.file_name().as_encoded_bytes())
            .add(&metadata.len().to_le_bytes())
            .add(&written.as_nanos().to_le_bytes());
        // A sum does not depend on the order of the listing.
        sum = sum.wrapping_add(print.finish());
    }
    sum
}
