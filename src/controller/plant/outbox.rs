//! What a tick tells the outside: the message, the refusal of a command, and requests to the disk thread.

use super::Plant;
use super::gathered::GatheredWrites;
use crate::controller::storage_request::StorageRequest;
use crate::defs::param::ParamAddress;
use crate::defs::text::LocalizedText;
use crate::link::snapshot::{Message, Tone};

/// Capacity for disk requests between two calls of `drain_storage_requests`: every variable, and some others.
const STORAGE_REQUESTS: usize = 1_024;

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
}

impl Outbox {
    /// Empty, with capacity for the requests of a tick.
    #[must_use]
    pub fn new() -> Self {
        Self { requests: Vec::with_capacity(STORAGE_REQUESTS), ..Self::default() }
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

    /// Stores changed entries of the alarm history on disk.
    pub fn store_alarm_changes(&mut self) {
        self.alarms.take_changed(|past| self.outbox.requests.push(StorageRequest::Alarm(past.clone())));
    }
}
