//! When the next tick is due, and the real-time privileges of the control thread. Times are counted from the absolute
//! tick number, not from the last wake-up.
//! Source: notes "reliability".

use std::time::{Duration, Instant};

use crate::link::bus::ThreadRights;
use crate::units::Histogram;
use thread_priority::{ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id};

/// A simulated machine that is more ticks behind than this drops them.
const MAX_CATCH_UP_TICKS: u32 = 50;
/// Ticks per wake-up with a simulated machine.
const TICKS_PER_WAKE_UP: u32 = 16;
/// Number of consecutive late ticks that raises an alarm on a real machine.
const MAX_LATE_IN_A_ROW: u32 = 10;
/// Part of the distance from the clock of the bus that is made up for in a tick: 1/16. At 100 ppm the ticks stay 1.6 µs
/// behind, far below what a wake-up varies.
const FOLLOWED_PART: i64 = 16;
/// Largest step of a tick: a fiftieth of it.
const MAX_STEP_PART: i64 = 50;
/// Spans over which a drift is measured: wake-ups that vary by 40 µs are 40 ppm of a second and 0.7 ppm of a minute.
const SHORTEST_SPAN: Duration = Duration::from_secs(1);
const LONGEST_SPAN: Duration = Duration::from_secs(60);
/// A clock that seems to be further off was set meanwhile: crystals are within 100 ppm.
const MAX_DRIFT_PPM: f64 = 1_000.0;
/// Real-time priority, SCHED_FIFO.
const PRIORITY: u8 = 80;

/// How strictly the thread keeps the tick time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Simulated machine: one wake-up for 16 ticks, which saves a laptop's battery. Late ticks are counted and made up
    /// for; more than 50 ticks are dropped.
    Simulated,
    /// Simulated machine without a wait: simulated time goes as fast as the ticks are computed.
    Unpaced,
    /// Real machine: one wake-up for each tick. A late tick is computed once and the time base starts again from it: the
    /// drives never get the set-points of several ticks in a row. 10 late ticks in a row raise an alarm.
    Real,
}

impl Pace {
    const fn ticks_per_wake_up(self) -> u32 {
        match self {
            Self::Simulated => TICKS_PER_WAKE_UP,
            Self::Unpaced | Self::Real => 1,
        }
    }

    /// Ticks that are made up for; a thread that is further behind drops its time base.
    const fn max_catch_up(self) -> u32 {
        match self {
            Self::Simulated | Self::Unpaced => MAX_CATCH_UP_TICKS,
            Self::Real => 1,
        }
    }
}

/// The schedule of the ticks. Times are durations since the start of the thread.
#[derive(Clone, Copy, Debug)]
pub struct TickSchedule {
    pace: Pace,
    /// When the next wake-up is due.
    due: Duration,
    /// Ticks left until then.
    ticks_left: u32,
    late_in_a_row: u32,
}

/// Times of the thread of a control.
#[derive(Clone, Debug, Default)]
pub struct ThreadTimes {
    /// How late it wakes up.
    pub wake_ups: Histogram,
    /// How long a tick takes from the wake-up to its snapshot.
    pub executions: Histogram,
    /// What the computer has given to it.
    pub rights: ThreadRights,
    /// The clock of the bus beside that of this computer.
    pub bus_clock: DriftMeter,
}

impl ThreadTimes {
    /// Counts the times anew.
    pub fn clear(&mut self) {
        self.wake_ups.clear();
        self.executions.clear();
    }
}

/// How fast a clock goes, by its times and those of this computer.
#[derive(Clone, Copy, Debug, Default)]
pub struct DriftMeter {
    /// Where the span that is measured begins: this computer's time, the other clock's time in ns.
    begun: Option<(Duration, u64)>,
    drift_ppm: f64,
}

impl DriftMeter {
    /// Takes the times of both clocks at one moment.
    pub fn read(&mut self, own: Duration, other_ns: u64) {
        let (own_begun, other_begun) = *self.begun.get_or_insert((own, other_ns));
        let span = own.saturating_sub(own_begun);
        let Some(other_span) = other_ns.checked_sub(other_begun).filter(|_| span < LONGEST_SPAN) else {
            self.begun = Some((own, other_ns));
            return;
        };
        if span >= SHORTEST_SPAN {
            let drift_ppm = 1e6 * (other_span as f64 / span.as_nanos() as f64 - 1.0);
            if drift_ppm.abs() > MAX_DRIFT_PPM {
                self.begun = Some((own, other_ns));
            } else {
                self.drift_ppm = drift_ppm;
            }
        }
    }

    /// How much faster than that of this computer the other clock goes, millionths; 0 before a second has been seen.
    #[must_use]
    pub const fn drift_ppm(&self) -> f64 {
        self.drift_ppm
    }
}

/// How a wake-up came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WakeUp {
    /// Within the time of its ticks.
    OnTime,
    /// Later than the time of its ticks.
    Late,
    /// Late on a real machine so often in a row that the alarm is due.
    TooOftenLate,
    /// Later than the longest stall that is allowed: nobody has watched machine and clock meanwhile.
    Stalled,
}

impl TickSchedule {
    /// A schedule that begins at the start of the thread.
    #[must_use]
    pub const fn new(pace: Pace) -> Self {
        Self { pace, due: Duration::ZERO, ticks_left: 0, late_in_a_row: 0 }
    }

    /// The time at which to wake up before the next tick of this length; `None` if the tick is computed at once.
    pub fn next_due(&mut self, tick: Duration) -> Option<Duration> {
        if self.pace == Pace::Unpaced {
            return None;
        }
        if self.ticks_left > 0 {
            self.ticks_left -= 1;
            return None;
        }
        let ticks = self.pace.ticks_per_wake_up();
        self.ticks_left = ticks - 1;
        self.due += tick * ticks;
        Some(self.due)
    }

    /// The tick was so much later than the clock of the bus asks for: the next ones come earlier by a part of it. A late
    /// wake-up, which is no error of the clocks, moves them little.
    pub fn follow(&mut self, error_ns: i64, tick: Duration) {
        let tick_ns = tick.as_nanos() as i64;
        let step_ns = (error_ns / FOLLOWED_PART).clamp(-tick_ns / MAX_STEP_PART, tick_ns / MAX_STEP_PART);
        let step = Duration::from_nanos(step_ns.unsigned_abs());
        self.due = if step_ns > 0 { self.due.saturating_sub(step) } else { self.due + step };
    }

    /// Notes the time of a wake-up. A thread that is too far behind starts again from now; one that stood still for longer
    /// than `max_stall` (P475), once, has a name of its own.
    pub fn woke_up(&mut self, now: Duration, tick: Duration, max_stall: Duration) -> WakeUp {
        let behind = now.saturating_sub(self.due);
        if behind > tick * self.pace.max_catch_up() {
            self.due = now;
        }
        if behind <= tick * self.pace.ticks_per_wake_up() {
            self.late_in_a_row = 0;
            return WakeUp::OnTime;
        }
        self.late_in_a_row += 1;
        if behind > max_stall {
            return WakeUp::Stalled;
        }
        match self.pace {
            Pace::Real if self.late_in_a_row >= MAX_LATE_IN_A_ROW => WakeUp::TooOftenLate,
            Pace::Real | Pace::Simulated | Pace::Unpaced => WakeUp::Late,
        }
    }
}

/// Sleeps until `due`.
pub(super) fn sleep_until(due: Instant) {
    let Some(ahead) = due.checked_duration_since(Instant::now()) else { return };
    #[cfg(target_os = "linux")]
    sleep_until_absolute(ahead);
    #[cfg(not(target_os = "linux"))]
    std::thread::sleep(ahead);
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

/// Stack that is touched before the first tick, so that none of its pages is missing in one: more than a tick uses.
const STACK_BYTES: usize = 256 * 1024;
/// Size of a page of memory.
const PAGE_BYTES: usize = 4_096;

/// Uses the stack once.
#[inline(never)]
fn touch_stack() {
    let mut stack = [0_u8; STACK_BYTES];
    for page in stack.chunks_mut(PAGE_BYTES) {
        page[0] = 1;
    }
    std::hint::black_box(&mut stack);
}

/// Binds this thread to a core of the computer; returns whether the system has done it.
fn bind_to_core(core: u16) -> bool {
    #[cfg(target_os = "linux")]
    {
        use rustix::thread::{CpuSet, sched_setaffinity};
        let mut cores = CpuSet::new();
        cores.set(usize::from(core));
        sched_setaffinity(None, &cores).is_ok()
    }
    #[cfg(not(target_os = "linux"))]
    {
        let _ = core;
        false
    }
}

/// Requests real-time priority, locked memory with a stack that is there, and a core; returns what the system permits.
pub(super) fn request_real_time(core: Option<u16>) -> ThreadRights {
    let core = core.map(|core| (core, bind_to_core(core)));
    #[cfg(unix)]
    {
        use rustix::mm::mlockall;
        use thread_priority::{RealtimeThreadSchedulePolicy, ThreadPriorityValue};
        let Ok(value) = ThreadPriorityValue::try_from(PRIORITY) else {
            return ThreadRights { core, ..ThreadRights::default() };
        };
        let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
        let has_priority =
            set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Crossplatform(value), policy).is_ok();
        let has_locked_memory = has_priority && mlockall(memory_lock_flags()).is_ok();
        if has_locked_memory {
            touch_stack();
        }
        ThreadRights { has_priority, has_locked_memory, core }
    }
    #[cfg(not(unix))]
    {
        ThreadRights { core, ..ThreadRights::default() }
    }
}
