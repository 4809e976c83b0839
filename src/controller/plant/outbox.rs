//! What a tick tells the outside: the message, the refusal of a command, and requests to the disk thread.

use std::collections::VecDeque;

use super::Plant;
use super::gathered::GatheredWrites;
use crate::controller::storage_request::StorageRequest;
use crate::defs::alarm;
use crate::defs::param::ParamAddress;
use crate::defs::text::{LocalizedText, phrase};
use crate::link::snapshot::{Message, Tone};
use crate::units::Micros;

/// Capacity for disk requests between two calls of `drain_storage_requests`: every variable, and some others.
const STORAGE_REQUESTS: usize = 1_024;

/// Longest time from a value to its place on the disk, without an alarm.
const MAX_STORING: Micros = Micros::from_millis(1_000);

/// A commit usually takes less; a longer one is shown.
const USUAL_STORING: Micros = Micros::from_millis(100);

/// Messages and disk requests.
#[derive(Debug, Default)]
pub struct Outbox {
    /// The message shown.
    pub message: Message,
    /// Why a command of the last tick was refused, if one was.
    pub refusal: Option<LocalizedText>,
    /// Program message (MSG), shown until it is replaced.
    pub program_message: Option<LocalizedText>,
    /// Requests to the disk thread.
    pub requests: Vec<StorageRequest>,
    /// What programs have written and what is stored soon.
    pub gathered: GatheredWrites,
    /// What the disk thread has not acknowledged.
    pub unstored: UnstoredBatches,
}

/// Most batches of which the time is known; later ones count with the last of them.
const MAX_BATCHES: usize = 64;

/// The batches of values that the disk thread has not acknowledged, and when each was sent.
#[derive(Debug, Default)]
pub struct UnstoredBatches {
    waiting: VecDeque<(u64, Micros)>,
}

impl UnstoredBatches {
    /// A batch is sent now; gives its mark. It grows over power cuts: a late acknowledgement is never one of a later batch.
    pub fn send(&mut self, now: Micros) -> u64 {
        let is_full = self.waiting.len() >= MAX_BATCHES;
        match self.waiting.back_mut() {
            Some((mark, _)) if is_full => *mark = now.0,
            _ => self.waiting.push_back((now.0, now)),
        }
        now.0
    }

    /// Everything up to a mark is stored.
    pub fn stored(&mut self, mark: u64) {
        while self.waiting.front().is_some_and(|(first, _)| *first <= mark) {
            self.waiting.pop_front();
        }
    }

    /// When the oldest batch was sent.
    #[must_use]
    pub fn oldest(&self) -> Option<Micros> {
        self.waiting.front().map(|(_, sent)| *sent)
    }
}

impl Outbox {
    /// Empty, with capacity for the requests of a tick.
    #[must_use]
    pub fn new() -> Self {
        let unstored = UnstoredBatches { waiting: VecDeque::with_capacity(MAX_BATCHES) };
        Self { requests: Vec::with_capacity(STORAGE_REQUESTS), unstored, ..Self::default() }
    }
}

impl Plant {
    pub fn show_note(&mut self, text: impl Into<LocalizedText>) {
        self.show(text, Tone::Info);
    }

    /// Refuses a command and shows the reason.
    pub fn refuse(&mut self, text: impl Into<LocalizedText>) {
        self.show(text, Tone::Refused);
        self.outbox.refusal = Some(self.outbox.message.text.clone());
    }

    /// Replaces the message.
    pub fn show(&mut self, text: impl Into<LocalizedText>, tone: Tone) {
        self.outbox.message = Message { text: text.into(), tone, since: self.now };
    }

    /// MSG: shown until replaced; an empty text ends it.
    pub fn show_program_message(&mut self, text: &LocalizedText) {
        self.outbox.program_message = (!text.is_empty()).then(|| text.clone());
        if self.outbox.program_message.is_some() {
            self.show_note(text.clone());
        }
    }

    /// A program start clears the program message; an MDI line keeps it.
    pub fn clear_program_message(&mut self, mdi: bool) {
        self.outbox.program_message = self.outbox.program_message.take().filter(|_| mdi);
    }

    /// Changes a parameter on behalf of the control and stores it.
    pub fn store_param(&mut self, at: ParamAddress, value: f64) {
        if self.params.write(at, value).is_ok() {
            self.store(StorageRequest::Param(at, value));
        }
    }

    /// Sends a request to the disk thread, behind what programs have written before it.
    pub fn store(&mut self, request: StorageRequest) {
        self.store_gathered();
        self.outbox.requests.push(request);
    }

    /// Whether values have been on their way to the disk for longer than it usually takes.
    #[must_use]
    pub fn is_storing(&self) -> bool {
        self.outbox.unstored.oldest().is_some_and(|sent| self.now.since(sent) > USUAL_STORING)
    }

    /// Values that the disk has not taken for more than a second are an alarm until it has.
    pub fn supervise_storage(&mut self) {
        let waits = self.outbox.unstored.oldest().map(|sent| self.now.since(sent));
        if waits.is_some_and(|waits| waits > MAX_STORING) {
            self.raise(alarm::STORE_SLOW, None);
        } else if self.alarms.has(alarm::STORE_SLOW) {
            self.alarms.clear(alarm::STORE_SLOW);
            self.show_note(phrase!("数据已保存", "the values are stored"));
        }
    }

    /// Stores changed entries of the alarm history on disk.
    pub fn store_alarm_changes(&mut self) {
        self.alarms.take_changed(|past| self.outbox.requests.push(StorageRequest::Alarm(past.clone())));
    }
}
