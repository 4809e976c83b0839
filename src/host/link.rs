//! The screen's end of a control on a thread: commands go in, the newest snapshot comes out.
//! Source: style "a key press", safety stance.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam_channel::Sender;
use triple_buffer::TripleBuffer;

use super::control_end::ControlEnd;
use crate::defs::key::Key;
use crate::link::command::Command;
use crate::link::network::NetworkView;
use crate::link::observed::ObservedSnapshot;
use crate::link::production::OrderProposal;
use crate::link::snapshot::Snapshot;

/// Longest time that a field bus may take at the start, stations and clocks included.
const LONGEST_BEGIN: Duration = Duration::from_secs(30);

/// Statistics and state of the control thread.
#[derive(Debug, Default)]
pub struct ThreadHealth {
    /// Number of ticks.
    pub ticks: AtomicU64,
    /// Number of wake-ups that came more than the duration of their ticks late.
    pub late: AtomicU64,
    /// The thread has panicked; the outputs are in the safe state.
    pub failed: AtomicBool,
}

/// What the page of the network shows, from the network to the screen.
pub(super) struct NetworkLink {
    tell: Option<triple_buffer::Input<Option<NetworkView>>>,
    views: triple_buffer::Output<Option<NetworkView>>,
    newest: Option<Arc<NetworkView>>,
}

impl Default for NetworkLink {
    fn default() -> Self {
        let (tell, views) = TripleBuffer::default().split();
        Self { tell: Some(tell), views, newest: None }
    }
}

/// What a gateway works with.
pub struct ObserverEnds {
    /// The newest snapshots.
    pub snapshots: triple_buffer::Output<ObservedSnapshot>,
    /// Where it tells what its page shows.
    pub tell: triple_buffer::Input<Option<NetworkView>>,
    /// Where orders of the shop go, for the operator to accept.
    pub proposals: Sender<OrderProposal>,
}

/// The screen's connection to the control. Dropping it stops the control: safe outputs, storage completed.
pub struct HostLink {
    pub(super) commands: Sender<Command>,
    pub(super) urgent: Sender<Command>,
    pub(super) snapshots: triple_buffer::Output<Snapshot>,
    pub(super) observer: Option<(triple_buffer::Output<ObservedSnapshot>, Sender<OrderProposal>)>,
    pub(super) network: NetworkLink,
    pub(super) updated: Instant,
    pub(super) health: Arc<ThreadHealth>,
    pub(super) end: ControlEnd,
    pub(super) thread: Option<JoinHandle<()>>,
}

impl HostLink {
    /// Sends a command without waiting. Reset, feed hold and emergency stop have their own queue, which other commands
    /// cannot fill. Returns false if the queue is full or the thread has ended; the command is lost then.
    pub fn send(&self, command: Command) -> bool {
        let urgent = matches!(
            command,
            Command::Press(Key::Reset | Key::FeedHold | Key::EmergencyStop) | Command::EmergencyStop(_)
        );
        let path = if urgent { &self.urgent } else { &self.commands };
        path.try_send(command).is_ok()
    }

    /// The newest snapshot. Never waits and never makes the control wait.
    pub fn newest(&mut self) -> &Snapshot {
        if self.snapshots.update() {
            self.updated = Instant::now();
        }
        if self.network.views.update() {
            self.network.newest = self.network.views.output_buffer_mut().take().map(Arc::new);
        }
        let newest = self.snapshots.output_buffer_mut();
        newest.host.network.clone_from(&self.network.newest);
        newest
    }

    /// The ends for a gateway, once.
    pub fn take_observer(&mut self) -> Option<ObserverEnds> {
        let (snapshots, proposals) = self.observer.take()?;
        Some(ObserverEnds { snapshots, tell: self.network.tell.take()?, proposals })
    }

    /// Time since the newest snapshot was first read; call [`Self::newest`] before. 0 while a field bus is being set up,
    /// before the first tick.
    #[must_use]
    pub fn snapshot_age(&self) -> Duration {
        let age = self.updated.elapsed();
        let begins = self.health.ticks.load(Ordering::Relaxed) == 0 && age < LONGEST_BEGIN;
        if begins { Duration::ZERO } else { age }
    }

    /// Ends the control from another thread.
    #[must_use]
    pub fn control_end(&self) -> ControlEnd {
        self.end.clone()
    }

    /// Statistics and state of the control thread.
    #[must_use]
    pub fn health(&self) -> &ThreadHealth {
        &self.health
    }
}

impl Drop for HostLink {
    fn drop(&mut self) {
        self.end.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}
