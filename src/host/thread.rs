//! The control on a thread of its own, paced to real time. Commands arrive through a bounded channel, with a separate one
//! for reset, feed hold and emergency stop; the newest snapshot is published without a lock. A stop, a panic, a lost
//! screen, a silent bus and ticks that are late again and again lead to the safe output image.
//! Source: notes "reliability", style "a key press", safety stance.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, bounded};
use triple_buffer::TripleBuffer;

use super::Host;
use super::clock::time_of_day;
use super::control_end::ControlEnd;
use super::hosted_machine::HostedMachine;
use super::link::{HostLink, NetworkLink, ThreadHealth};
use super::pace::{TickSchedule, WakeUp, request_real_time, sleep_until};
use super::simulated::HostedSimulation;
use super::storage::Storage;
use crate::defs::{alarm, param};
use crate::io::fieldbus::ClockReading;
use crate::link::command::Command;
use crate::link::observed::ObservedSnapshot;
use crate::link::page_command::PageCommand;
use crate::link::production::OrderProposal;
use crate::link::snapshot::Snapshot;
use crate::units::Micros;

/// Capacity of the queue of commands for the next tick.
const COMMAND_QUEUE: usize = 256;
/// Capacity of the separate queue for reset, feed hold and emergency stop.
const URGENT_QUEUE: usize = 16;
/// Capacity of the queue of orders that the shop proposes; one is taken in a tick.
const PROPOSAL_QUEUE: usize = 8;
/// Longest wait for the axes at the end of the control.
const MAX_BRAKING: Micros = Micros::from_millis(3_000);
/// Snapshots a second.
const SNAPSHOTS_PER_SECOND: u64 = 60;

/// A host on its thread.
pub struct HostThread<P, S> {
    host: Host<P, S>,
    from_screen: Receiver<Command>,
    from_urgent: Receiver<Command>,
    from_network: Receiver<OrderProposal>,
    snapshots: triple_buffer::Input<Snapshot>,
    /// The snapshots of the network.
    observed: triple_buffer::Input<ObservedSnapshot>,
    schedule: TickSchedule,
    started: Instant,
    ticks: u64,
    health: Arc<ThreadHealth>,
    end: ControlEnd,
    touched: bool,
}

/// Starts a host on a thread, at the pace of its machine. `script` drives it with [`HostThread::turn`] until [`HostThread::is_stopped`]; then the
/// outputs are made safe and storage is completed.
///
/// # Errors
/// The system cannot create a thread.
pub fn start<P, S>(
    mut host: Host<P, S>,
    script: impl FnOnce(&mut HostThread<P, S>) + Send + 'static,
) -> std::io::Result<HostLink>
where
    P: HostedMachine + Send + 'static,
    S: Storage + Send + 'static,
{
    let schedule = TickSchedule::new(host.plant.pace());
    let (commands, from_screen) = bounded(COMMAND_QUEUE);
    let (urgent, from_urgent) = bounded(URGENT_QUEUE);
    let (proposals, from_network) = bounded(PROPOSAL_QUEUE);
    let (snapshots, newest) = TripleBuffer::new(host.snapshot()).split();
    let first = ObservedSnapshot { snapshot: host.snapshot().clone(), taken: time_of_day() };
    let (observed, observer) = TripleBuffer::new(&first).split();
    let (health, end) = (Arc::new(ThreadHealth::default()), ControlEnd::default());
    let (own_health, own_end) = (Arc::clone(&health), end.clone());
    let thread = std::thread::Builder::new().name("kt830-control".into()).spawn(move || {
        let mut host = host;
        host.times.rights = request_real_time(host.plant.core());
        let mut thread = HostThread {
            host,
            from_screen,
            from_urgent,
            from_network,
            snapshots,
            observed,
            schedule,
            started: Instant::now(),
            ticks: 0,
            health: own_health,
            end: own_end,
            touched: false,
        };
        // Here: locking the memory takes longer than the watchdogs of the devices.
        thread.guard(|thread| thread.host.begin());
        thread.started = Instant::now();
        thread.guard(script);
        thread.guard(HostThread::bring_to_rest);
        thread.host.leave_safe();
        thread.hold_safe_image();
        thread.guard(|thread| thread.host.close());
        thread.end.set_ended();
    })?;
    let updated = Instant::now();
    let observer = Some((observer, proposals));
    let network = NetworkLink::default();
    Ok(HostLink { commands, urgent, snapshots: newest, observer, network, updated, health, end, thread: Some(thread) })
}

impl<S: Storage> HostThread<HostedSimulation, S> {
    /// Puts another control with its simulated machine in the place of this one, between two ticks. What was sent to the old
    /// one does not reach the new one.
    pub fn exchange(&mut self, host: Host<HostedSimulation, S>) {
        let (rights, control) = (self.host.times.rights, self.host.control + 1);
        let mut left = std::mem::replace(&mut self.host, host);
        (self.host.times.rights, self.host.control) = (rights, control);
        left.leave_safe();
        left.close();
        let lost = self.from_urgent.try_iter().chain(self.from_screen.try_iter());
        self.touched |= lost.filter(is_touch).count() > 0;
        self.from_network.try_iter().for_each(drop);
    }
}

/// Whether the operator has sent a command: a page reads its files by itself.
const fn is_touch(command: &Command) -> bool {
    !matches!(command, Command::KeepAlive | Command::Page(PageCommand::File(..)))
}

/// Runs the control until it is stopped: the script of the window.
pub fn run_until_stopped<P: HostedMachine, S: Storage>(thread: &mut HostThread<P, S>) {
    while !thread.is_stopped() {
        thread.turn();
    }
}

impl<P: HostedMachine, S: Storage> HostThread<P, S> {
    /// Waits for the next tick, computes it and publishes the snapshot. Does nothing once the thread is stopped.
    pub fn turn(&mut self) {
        if self.is_stopped() {
            return;
        }
        self.pace();
        let begun = Instant::now();
        self.guard(|thread| {
            thread.receive();
            thread.host.step();
            thread.publish();
        });
        self.host.times.executions.add(Micros(begun.elapsed().as_micros() as u64));
        self.follow_bus();
        self.health.ticks.fetch_add(1, Ordering::Relaxed);
    }

    /// The clock of a bus paces the ticks.
    fn follow_bus(&mut self) {
        let tick = Duration::from_micros(self.host.tick_time().0);
        if let Some(ClockReading { error_ns, time_ns, .. }) = self.host.plant.bus_clock() {
            self.schedule.follow(error_ns, tick);
            self.host.times.bus_clock.read(self.started.elapsed(), time_ns);
        }
    }

    /// The control ends: a machine that moves brakes to rest first. Nothing more is received.
    fn bring_to_rest(&mut self) {
        if self.health.failed.load(Ordering::Acquire) {
            return;
        }
        self.host.begin_end();
        for _ in 0..MAX_BRAKING.0 / self.host.tick_time().0.max(1) {
            if self.host.controller.is_at_rest() {
                break;
            }
            self.pace();
            self.host.step();
        }
    }

    /// A real machine gets the safe image until its drives are off and its brakes hold; after a failure of the control
    /// until the control is ended.
    fn hold_safe_image(&mut self) {
        let settling = self.host.plant.settling_time();
        if settling == Micros::ZERO {
            return;
        }
        let mut left = settling.0 / self.host.tick_time().0.max(1);
        while left > 0 || !self.end.is_requested() {
            left = left.saturating_sub(1);
            // After a panic the control may fail in its own report of late ticks.
            self.guard(Self::pace);
            self.host.hold_safe_image();
        }
    }

    /// Runs a step; a panic in it stops the thread and is shown on the screen.
    fn guard(&mut self, step: impl FnOnce(&mut Self)) {
        if catch_unwind(AssertUnwindSafe(|| step(self))).is_err() {
            self.health.failed.store(true, Ordering::Release);
        }
    }

    fn pace(&mut self) {
        let tick = Duration::from_micros(self.host.tick_time().0);
        let Some(due) = self.schedule.next_due(tick) else { return };
        sleep_until(self.started + due);
        let woke = self.started.elapsed();
        self.host.times.wake_ups.add(Micros(woke.saturating_sub(due).as_micros() as u64));
        let max_stall = Duration::from_micros(self.host.controller.params().millis(param::MAX_STALL).0);
        match self.schedule.woke_up(woke, tick, max_stall) {
            WakeUp::OnTime => return,
            WakeUp::Late => {}
            WakeUp::TooOftenLate => self.host.controller.report_alarm(alarm::LATE_TICKS, None),
            WakeUp::Stalled => self.host.report_stall(),
        }
        self.health.late.fetch_add(1, Ordering::Relaxed);
    }

    fn receive(&mut self) {
        for command in self.from_urgent.try_iter().chain(self.from_screen.try_iter().take(COMMAND_QUEUE)) {
            self.touched |= is_touch(&command);
            self.host.send(command);
        }
        if let Ok(proposal) = self.from_network.try_recv() {
            self.host.send(Command::ProposeOrder(proposal));
        }
    }

    /// Publishes the newest snapshot 60 times a second; screen and network never make the control wait. The network gets
    /// its own in another tick, and seldom while it is off.
    fn publish(&mut self) {
        self.ticks += 1;
        let every = (1_000_000 / SNAPSHOTS_PER_SECOND / self.host.tick_time().0.max(1)).max(1);
        if self.ticks.is_multiple_of(every) {
            self.host.snapshot_into(self.snapshots.input_buffer_mut());
            self.snapshots.publish();
        }
        let params = self.host.controller.params();
        let is_on =
            [param::MTCONNECT_PORT, param::WEB_PORT, param::MQTT_ENABLED].iter().any(|of| params.get(*of) > 0.0);
        let period = if is_on { every } else { every * SNAPSHOTS_PER_SECOND / 2 };
        if self.ticks % period == every / 2 {
            let observed = self.observed.input_buffer_mut();
            self.host.snapshot_into(&mut observed.snapshot);
            observed.taken = time_of_day();
            self.observed.publish();
        }
    }

    /// The host.
    pub const fn host(&mut self) -> &mut Host<P, S> {
        &mut self.host
    }

    /// Whether the thread is to end: the screen is closed, or a step has failed.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.end.is_requested() || self.health.failed.load(Ordering::Acquire)
    }

    /// Whether the operator has sent a command since [`Self::take_touched`].
    #[must_use]
    pub const fn is_touched(&self) -> bool {
        self.touched
    }

    /// Whether the operator has sent a command; clears the flag.
    pub const fn take_touched(&mut self) -> bool {
        std::mem::replace(&mut self.touched, false)
    }
}
