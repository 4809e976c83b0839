//! The storage of a tortured control: the real one on a simulated disk, answering as late as it likes.

use std::collections::VecDeque;
use std::path::PathBuf;

use super::ledger::Ledger;
use super::planted::PlantedBug;
use crate::controller::StorageRequest;
use crate::defs::date::DateTime;
use crate::defs::text::LocalizedText;
use crate::host::part::PartQuery;
use crate::host::storage::{Arrival, DirectStorage, Storage};
use crate::io::random::SplitMix64;
use crate::link::command::Command;

/// Date of the first tick: 2026-01-01, in seconds since 1970.
const START_DATE: DateTime = DateTime(1_767_225_600);
const TICKS_OF_A_SECOND: u64 = 1_000;
/// The control is told the date so often, ticks.
const CALENDAR_TICKS: u64 = 10 * TICKS_OF_A_SECOND;

/// Storage that takes its time.
pub struct DelayedStorage {
    /// `None` while the power is off.
    inner: Option<DirectStorage>,
    /// Batches that the disk has not begun with, and the tick in which it does.
    queue: VecDeque<(u64, Vec<StorageRequest>)>,
    /// What is to survive a power cut.
    pub ledger: Ledger,
    tick: u64,
    /// Until this tick the disk does nothing.
    hangs_until: u64,
    /// Longest time from a request to its commit, ticks.
    slowness: u64,
    chance: SplitMix64,
    bug: Option<PlantedBug>,
    place: DataPlace,
    /// When the control is told the date.
    date_due: u64,
}

/// Where the data of this course are. The folder has another name in every course; an alarm that names it is stored, and
/// would make the bytes on the disk other ones.
#[derive(Clone, Debug)]
pub struct DataPlace(pub PathBuf);

impl DataPlace {
    /// A text that names the folder `DATA`.
    #[must_use]
    pub fn hide_in(&self, text: &LocalizedText) -> LocalizedText {
        let place = self.0.to_string_lossy();
        let hidden = |words: &str| words.replace(&*place, "DATA");
        LocalizedText::new(hidden(&text.zh()), hidden(&text.en()))
    }
}

impl DelayedStorage {
    /// The storage of a control that starts with the account's state.
    #[must_use]
    pub fn new(inner: DirectStorage, ledger: Ledger, (seed, bug): (u64, Option<PlantedBug>), place: DataPlace) -> Self {
        let (queue, chance) = (VecDeque::new(), SplitMix64::new(seed));
        Self {
            inner: Some(inner),
            queue,
            ledger,
            tick: 0,
            hangs_until: 0,
            slowness: 0,
            chance,
            bug,
            place,
            date_due: 0,
        }
    }

    /// The disk does nothing for some ticks.
    pub const fn hang(&mut self, ticks: u64) {
        self.hangs_until = self.tick + ticks;
    }

    /// Longest time from a request to its commit, ticks.
    pub const fn set_slowness(&mut self, ticks: u64) {
        self.slowness = ticks;
    }

    /// The power is off: what waits for the disk is lost.
    pub fn power_cut(&mut self) {
        self.inner = None;
        self.queue.clear();
    }

    /// The power is back.
    pub fn power_on(&mut self, inner: DirectStorage, ledger: Ledger) {
        (self.inner, self.ledger, self.hangs_until, self.date_due) = (Some(inner), ledger, 0, 0);
    }

    /// Whether everything that was handed over is stored and acknowledged.
    #[must_use]
    pub fn is_quiet(&self) -> bool {
        self.queue.is_empty() && self.ledger.open_batches() == 0
    }

    fn take_batch(&mut self, mut requests: Vec<StorageRequest>) {
        match self.bug {
            Some(PlantedBug::StorageDropsARequest) if self.chance.next_unit() < 0.1 => {
                requests.retain(|request| !request.is_retained());
            }
            Some(PlantedBug::StorageRoundsValues) => requests.iter_mut().for_each(|request| {
                if let StorageRequest::Variable(_, Some(value)) = request {
                    *value = f64::from(*value as f32);
                }
            }),
            _ => {}
        }
        if let Some(inner) = &mut self.inner {
            inner.submit(&mut requests);
        }
    }
}

impl Storage for DelayedStorage {
    fn submit(&mut self, requests: &mut Vec<StorageRequest>) {
        let batch = std::mem::take(requests);
        self.ledger.hand_over(&batch);
        let delay = (self.chance.next_unit() * self.slowness as f64) as u64;
        let begins = self.queue.back().map_or(0, |(tick, _)| *tick).max(self.tick + delay);
        if self.bug == Some(PlantedBug::StorageSwapsBatches) {
            return self.queue.push_front((begins, batch));
        }
        self.queue.push_back((begins, batch));
    }

    fn find_part(&mut self, query: PartQuery) -> bool {
        self.inner.as_mut().is_some_and(|inner| inner.find_part(query))
    }

    fn poll(&mut self, arrivals: &mut Vec<Arrival>) {
        if self.date_due <= self.tick {
            self.date_due = self.tick + CALENDAR_TICKS;
            let seconds = START_DATE.0 + (self.tick / TICKS_OF_A_SECOND) as i64;
            arrivals.push(Arrival::Command(Command::WallClock(DateTime(seconds))));
        }
        self.tick += 1;
        let early = self.bug == Some(PlantedBug::StorageAcknowledgesEarly);
        let marks = self.queue.iter().flat_map(|(_, batch)| batch).filter_map(|request| match request {
            StorageRequest::Mark(mark) => Some(*mark),
            _ => None,
        });
        if early && let Some(mark) = marks.max() {
            arrivals.push(Arrival::Command(Command::Stored(mark)));
        }
        while self.tick >= self.hangs_until && self.queue.front().is_some_and(|(begins, _)| *begins <= self.tick) {
            if let Some((_, batch)) = self.queue.pop_front() {
                self.take_batch(batch);
            }
        }
        if let Some(inner) = &mut self.inner {
            inner.poll(arrivals);
        }
        for arrival in arrivals {
            match arrival {
                Arrival::Command(Command::Stored(mark)) => self.ledger.acknowledge(*mark),
                Arrival::Command(Command::DiskFailed(text)) => *text = self.place.hide_in(text),
                _ => {}
            }
        }
    }

    fn close(&mut self) {
        if let Some(inner) = &mut self.inner {
            inner.close();
        }
    }
}
