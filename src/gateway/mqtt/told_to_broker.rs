//! What the broker has acknowledged, kept over power-offs: the last results of parts, and the number of the connection.
//! Source: OASIS MQTT 3.1.1, 4.3.2; Eclipse Sparkplug 3.0.0, 5.4 (bdSeq).

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::defs::part_record::PartRecord;
use crate::store::ron_file::{self, ChecksumPolicy};

/// The file, in the data directory.
const FILE: &str = "mqtt_sent.ron";
/// Most results that are remembered: later changes of older ones are not told.
const REMEMBERED: usize = 64;

/// A result that was sent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SentPart {
    /// Serial number of the part.
    pub part: u64,
    /// Its program, and when its cycle ended: with other ones it is a part of other data.
    pub program: u32,
    /// See `program`.
    pub ended: i64,
    /// The result, as it was sent: a size that is typed later makes it another one.
    pub text: String,
}

impl SentPart {
    /// Whether it is the result of this part.
    #[must_use]
    pub const fn is_of(&self, record: &PartRecord) -> bool {
        self.part == record.count && self.program == record.program && self.ended == record.ended.0
    }
}

/// The file.
#[derive(Default, Serialize, Deserialize)]
struct Told {
    next_session: u8,
    parts: VecDeque<SentPart>,
    /// Serial number of the newest part that the broker has.
    #[serde(default)]
    last: u64,
    /// Parts between two that it has: the control had forgotten them by then.
    #[serde(default)]
    skipped: u64,
    /// Topics under which the broker has ever got a list of orders to keep.
    #[serde(default)]
    lists: Vec<String>,
}

/// The file and what it is to say.
pub struct ToldToBroker {
    path: PathBuf,
    told: Told,
    is_changed: bool,
}

impl ToldToBroker {
    /// Reads the file of a data directory. Without it, or with one that cannot be read, nothing was told.
    #[must_use]
    pub fn read(folder: &Path) -> Self {
        let path = folder.join(FILE);
        let told = ron_file::read(&path, ChecksumPolicy::Strict).map(|file| file.value).unwrap_or_default();
        Self { path, told, is_changed: false }
    }

    /// Number of the next connection; it counts on over power-offs.
    pub fn take_session(&mut self) -> u8 {
        let session = self.told.next_session;
        self.told.next_session = session.wrapping_add(1);
        self.is_changed = true;
        self.write();
        session
    }

    /// The results that the broker has, newest last.
    pub fn parts(&self) -> impl DoubleEndedIterator<Item = &SentPart> {
        self.told.parts.iter()
    }

    /// What the broker is to keep under each topic, now that the list of orders under the own one is this; empty for none.
    /// A message that clears a list may be lost with its connection: who has ever got one is told with each connection.
    /// Lists under other names of the machine are cleared once: the name may be that of another machine by then.
    pub fn lists_to_tell(&mut self, own: String, list: String) -> Vec<(String, String)> {
        let mut lists: Vec<_> =
            self.told.lists.extract_if(.., |topic| *topic != own).map(|topic| (topic, String::new())).collect();
        let is_known = !self.told.lists.is_empty();
        self.is_changed |= !lists.is_empty() || !is_known && !list.is_empty();
        if !is_known && !list.is_empty() {
            self.told.lists.push(own.clone());
        }
        if !self.told.lists.is_empty() {
            lists.push((own, list));
        }
        lists
    }

    /// Results that it never gets: more parts than the control remembers were made while it was away.
    #[must_use]
    pub const fn skipped(&self) -> u64 {
        self.told.skipped
    }

    /// The broker has this result.
    pub fn acknowledge(&mut self, sent: SentPart) {
        self.is_changed = true;
        match self.told.parts.iter_mut().find(|told| told.part == sent.part) {
            Some(told) => *told = sent,
            None => {
                if self.told.last > 0 {
                    self.told.skipped += sent.part.saturating_sub(self.told.last + 1);
                }
                self.told.last = sent.part;
                self.told.parts.push_back(sent);
            }
        }
        if self.told.parts.len() > REMEMBERED {
            self.told.parts.pop_front();
        }
    }

    /// Forgets results whose parts the control does not have: data that were set up anew, or a part that a power cut took
    /// back.
    pub fn keep_only(&mut self, is_known: impl Fn(&SentPart) -> bool) {
        let before = self.told.parts.len();
        while self.told.parts.back().is_some_and(|last| !is_known(last)) {
            self.told.parts.pop_back();
        }
        self.is_changed |= self.told.parts.len() != before;
    }

    /// Writes the file if it says less. One that cannot be written costs repetitions after the next power-on, no result.
    pub fn write(&mut self) {
        if std::mem::take(&mut self.is_changed) {
            drop(ron_file::write(&self.path, ChecksumPolicy::Strict, &self.told));
        }
    }
}
