//! The control thread: one tick per tick time (P58), timed from the absolute tick number, not from the last wake-up.
//! Commands arrive through a bounded channel, with a separate one for reset, feed hold and emergency stop; the newest
//! snapshot is published. A panic, a lost screen or a silent bus leads to the safe output image.
//! Source: notes "reliability", style "a key press", safety stance.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};
use thread_priority::{ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id};

use crate::controller::{Controller, Programs, StorageRequest};
use crate::defs::alarm;
use crate::defs::key::Key;
use crate::defs::signal::Terminals;
use crate::io::{Backend, OutputImage};
use crate::link::command::Command;
use crate::link::snapshot::{DirectoryRow, Snapshot};
use crate::units::Micros;

/// Capacity of the queue of commands for the next tick.
const COMMAND_QUEUE: usize = 256;
/// Capacity of the separate queue for reset, feed hold and emergency stop.
const URGENT_QUEUE: usize = 16;
/// Capacity of the queue of request batches to the disk thread.
const REQUEST_QUEUE: usize = 4_096;
/// Snapshots a second.
const SNAPSHOTS_PER_SECOND: u64 = 60;
/// A thread that is more ticks behind than this drops them and restarts its time base.
const MAX_CATCH_UP_TICKS: u64 = 50;
/// Ticks per wake-up with a simulated machine.
const TICKS_PER_WAKE_UP: u64 = 16;
/// Number of consecutive late ticks that raises an alarm on a real machine.
const MAX_LATE_IN_A_ROW: u32 = 10;
/// Real-time priority, SCHED_FIFO.
const PRIORITY: u8 = 80;

/// What the disk thread delivers to the core besides commands.
pub struct ProgramDelivery {
    /// The programs of the folder.
    pub programs: Arc<Programs>,
    /// The program directory as shown.
    pub directory: Arc<Vec<DirectoryRow>>,
}

/// How strictly the thread keeps the tick time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Simulated machine: the thread does [`TICKS_PER_WAKE_UP`] ticks per wake-up, which saves a laptop's battery. Late ticks are
    /// only counted.
    Simulated,
    /// Real machine: the thread wakes up for each tick. Several consecutive late ticks raise an alarm.
    Real,
}

impl Pace {
    /// Ticks per wake-up.
    const fn ticks_per_wake_up(self) -> u64 {
        match self {
            Self::Simulated => TICKS_PER_WAKE_UP,
            Self::Real => 1,
        }
    }
}

/// Statistics and state of the thread.
#[derive(Debug, Default)]
pub struct ThreadHealth {
    /// Number of ticks.
    pub ticks: AtomicU64,
    /// Number of wake-ups that came more than the duration of their ticks late.
    pub late: AtomicU64,
    /// The thread runs with real-time priority.
    pub real_time: AtomicBool,
    /// The thread has panicked; the outputs are in the safe state.
    pub failed: AtomicBool,
}

/// The screen's connection to the control.
pub struct HostLink {
    commands: Sender<Command>,
    urgent: Sender<Command>,
    snapshot: Arc<Mutex<Snapshot>>,
    /// Statistics and state of the thread.
    pub health: Arc<ThreadHealth>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// The disk thread's connection to the control.
pub struct StorageChannels {
    /// Storage requests.
    pub requests: Receiver<Vec<StorageRequest>>,
    /// Answers to them.
    pub commands: Sender<Command>,
    /// Programs read from the folder.
    pub deliveries: Sender<ProgramDelivery>,
}

/// Starts the control thread.
///
/// # Errors
/// The system cannot create a thread.
pub fn start<B: Backend + Send + 'static>(
    controller: Controller,
    backend: B,
    pace: Pace,
) -> std::io::Result<(HostLink, StorageChannels)> {
    let (commands, from_screen) = bounded(COMMAND_QUEUE);
    let (urgent, from_urgent) = bounded(URGENT_QUEUE);
    let (wish, wishes) = bounded(REQUEST_QUEUE);
    let (deliver, deliveries) = bounded(4);
    let mut first = Snapshot::new(controller.kind());
    controller.snapshot(&mut first);
    let newest = Arc::new(Mutex::new(first.clone()));
    let (health, stop) = (Arc::new(ThreadHealth::default()), Arc::new(AtomicBool::new(false)));
    let core = ControlThread {
        controller,
        backend,
        pace,
        from_screen,
        from_urgent,
        requests: wish,
        deliveries,
        snapshot: Arc::clone(&newest),
        scratch: first,
        health: Arc::clone(&health),
        stop: Arc::clone(&stop),
        inbox: Vec::with_capacity(COMMAND_QUEUE + URGENT_QUEUE),
        effects: Vec::new(),
        last_outputs: OutputImage::default(),
        late_in_a_row: 0,
    };
    let thread = std::thread::Builder::new().name("kt830-control".into()).spawn(move || core.run())?;
    let disk = StorageChannels { requests: wishes, commands: commands.clone(), deliveries: deliver };
    Ok((HostLink { commands, urgent, snapshot: newest, health, stop, thread: Some(thread) }, disk))
}

impl HostLink {
    /// Sends a command. Reset, feed hold and emergency stop have their own queue, which other commands cannot fill.
    /// Returns false when the queue is full or the thread has ended; the command is lost.
    pub fn send(&self, command: Command) -> bool {
        let urgent = matches!(
            command,
            Command::Press(Key::Reset | Key::FeedHold | Key::EmergencyStop) | Command::EmergencyStop(_)
        );
        let path = if urgent { &self.urgent } else { &self.commands };
        path.try_send(command).is_ok()
    }

    /// Copies the newest snapshot.
    pub fn copy_snapshot(&self, into: &mut Snapshot) {
        into.clone_from(&self.snapshot.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Drop for HostLink {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}

/// The state of the thread.
struct ControlThread<B> {
    controller: Controller,
    backend: B,
    pace: Pace,
    from_screen: Receiver<Command>,
    from_urgent: Receiver<Command>,
    requests: Sender<Vec<StorageRequest>>,
    deliveries: Receiver<ProgramDelivery>,
    snapshot: Arc<Mutex<Snapshot>>,
    scratch: Snapshot,
    health: Arc<ThreadHealth>,
    stop: Arc<AtomicBool>,
    inbox: Vec<Command>,
    effects: Vec<StorageRequest>,
    last_outputs: OutputImage,
    late_in_a_row: u32,
}

impl<B: Backend> ControlThread<B> {
    fn run(mut self) {
        self.health.real_time.store(request_real_time(), Ordering::Release);
        let tick = self.controller.tick_time();
        let every = (1_000_000 / SNAPSHOTS_PER_SECOND / tick.0.max(1)).max(1);
        let (mut start, mut skipped, mut index) = (Instant::now(), 0_u64, 0_u64);
        let bundle = self.pace.ticks_per_wake_up();
        while !self.stop.load(Ordering::Acquire) {
            if index.is_multiple_of(bundle) {
                let due = start + Duration::from_micros((index + bundle - skipped) * tick.0);
                let behind = sleep_until(due);
                if behind > Duration::from_micros(tick.0 * bundle) {
                    self.note_late();
                    if behind > Duration::from_micros(tick.0 * MAX_CATCH_UP_TICKS) {
                        (start, skipped) = (Instant::now(), index + bundle);
                    }
                } else {
                    self.late_in_a_row = 0;
                }
            }
            index += 1;
            let now = Micros(index * tick.0);
            let done = catch_unwind(AssertUnwindSafe(|| self.tick(now, index % every == 0)));
            if done.is_err() {
                self.health.failed.store(true, Ordering::Release);
                break;
            }
        }
        self.write_safe_outputs();
    }

    fn tick(&mut self, now: Micros, show: bool) {
        self.inbox.extend(self.from_urgent.try_iter());
        self.inbox.extend(self.from_screen.try_iter().take(COMMAND_QUEUE));
        while let Ok(delivery) = self.deliveries.try_recv() {
            self.controller.set_programs(delivery.programs, delivery.directory);
        }
        let image = self.backend.read(now);
        self.last_outputs = *self.controller.tick(now, &image, &self.inbox);
        self.backend.write(now, &self.last_outputs);
        self.inbox.clear();
        self.submit_requests();
        if show {
            self.publish_snapshot();
        }
        self.health.ticks.fetch_add(1, Ordering::Relaxed);
    }

    /// Submits storage requests without waiting. What does not fit into the queue is submitted again in the next tick.
    fn submit_requests(&mut self) {
        self.controller.drain_storage_requests(&mut self.effects);
        if self.effects.is_empty() {
            return;
        }
        if self.effects.iter().any(StorageRequest::changes_machine_setup) {
            self.backend.rewire(self.controller.params());
        }
        match self.requests.try_send(std::mem::take(&mut self.effects)) {
            Ok(()) => {}
            Err(TrySendError::Full(wishes) | TrySendError::Disconnected(wishes)) => self.effects = wishes,
        }
    }

    /// Publishes the newest snapshot only. While the screen copies one, this snapshot is skipped.
    fn publish_snapshot(&mut self) {
        self.controller.snapshot(&mut self.scratch);
        if let Ok(mut newest) = self.snapshot.try_lock() {
            std::mem::swap(&mut *newest, &mut self.scratch);
        }
    }

    fn note_late(&mut self) {
        self.health.late.fetch_add(1, Ordering::Relaxed);
        self.late_in_a_row += 1;
        if self.pace == Pace::Real && self.late_in_a_row >= MAX_LATE_IN_A_ROW {
            self.controller.report_alarm(alarm::LATE_TICKS, None);
        }
    }

    /// Writes the safe image without a tick: spindles, fluids, drives and analog outputs off, clamps hold.
    fn write_safe_outputs(&mut self) {
        let kept = self.controller.kept_in_safe_state();
        let terminals = Terminals(self.last_outputs.terminals.0 & kept.0);
        let safe =
            OutputImage { terminals, drives_on: false, wheel_volts: 0.0, analog_2_volts: 0.0, ..self.last_outputs };
        let backend = &mut self.backend;
        drop(catch_unwind(AssertUnwindSafe(|| backend.write(Micros::ZERO, &safe))));
    }
}

/// Sleeps until `due`; returns how late the thread woke up.
fn sleep_until(due: Instant) -> Duration {
    let now = Instant::now();
    if let Some(ahead) = due.checked_duration_since(now) {
        #[cfg(target_os = "linux")]
        sleep_until_absolute(ahead);
        #[cfg(not(target_os = "linux"))]
        std::thread::sleep(ahead);
    }
    Instant::now().saturating_duration_since(due)
}

/// `clock_nanosleep` until an absolute time: signals and preemption do not accumulate delay.
#[cfg(target_os = "linux")]
fn sleep_until_absolute(ahead: Duration) {
    use rustix::thread::{ClockId, clock_nanosleep_absolute};
    let clock = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
    let mut due = clock;
    due.tv_sec += ahead.as_secs() as i64;
    due.tv_nsec += i64::from(ahead.subsec_nanos());
    if due.tv_nsec >= 1_000_000_000 {
        due.tv_sec += 1;
        due.tv_nsec -= 1_000_000_000;
    }
    while clock_nanosleep_absolute(ClockId::Monotonic, &due) == Err(rustix::io::Errno::INTR) {}
}

/// Locks all memory in use. On Linux a page is locked at its first use, so that stacks are not allocated in advance.
#[cfg(unix)]
fn memory_lock_flags() -> rustix::mm::MlockAllFlags {
    use rustix::mm::MlockAllFlags;
    let all = MlockAllFlags::CURRENT | MlockAllFlags::FUTURE;
    #[cfg(target_os = "linux")]
    let all = all | MlockAllFlags::ONFAULT;
    all
}

/// Requests real-time priority and locked memory; returns false where the system does not permit it.
fn request_real_time() -> bool {
    #[cfg(unix)]
    {
        use rustix::mm::mlockall;
        use thread_priority::{RealtimeThreadSchedulePolicy, ThreadPriorityValue};
        let Ok(value) = ThreadPriorityValue::try_from(PRIORITY) else { return false };
        let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
        let given =
            set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Crossplatform(value), policy).is_ok();
        let locked = given && mlockall(memory_lock_flags()).is_ok();
        given && locked
    }
    #[cfg(not(unix))]
    {
        false
    }
}
