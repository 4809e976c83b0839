//! The results of finished parts on their way to the broker: each is sent until the broker has acknowledged it, over losses
//! of the connection and of the control's power. Whoever counts parts tells repetitions by the serial number.
//! Source: OASIS MQTT 3.1.1, 4.3.2 (at least once); issue of the retained part history (B6).

use std::collections::VecDeque;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::defs::part_record::PartRecord;
use crate::link::snapshot::Snapshot;
use crate::store::ron_file::{self, ChecksumPolicy};

/// The file with the last part that was acknowledged, in the data directory.
const SENT_FILE: &str = "mqtt_sent.ron";
/// Most results that wait for their acknowledgement.
const WINDOW: usize = 16;

/// A result, as it is sent (JSON).
#[derive(Clone, Debug, PartialEq, Serialize)]
struct PartResultMessage {
    /// The machine.
    machine: String,
    /// Serial number of the part on this machine.
    part: u64,
    /// Its number in the part count.
    number: u32,
    /// The program.
    program: u32,
    /// The order; none without one.
    order: Option<u32>,
    /// End of its cycle, local time of the machine.
    ended: String,
    /// Cycle time, s.
    cycle_s: f64,
    /// Measured size, mm; none if nobody has measured it.
    size_mm: Option<f64>,
    /// Nominal size and its limits, mm.
    nominal_mm: Option<f64>,
    min_mm: Option<f64>,
    max_mm: Option<f64>,
    /// `ok`, `out-of-tolerance`, …
    verdict: &'static str,
    /// Whether it must not be delivered.
    is_bad: bool,
    /// Parts since the last dressing.
    since_dressing: u32,
}

/// A part of which the broker knows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct SentPart {
    part: u64,
    /// The result, as it was sent: a size that was typed later makes it another one.
    text: String,
}

/// A result on its way.
struct InFlight {
    sent: SentPart,
    packet: u16,
    is_acknowledged: bool,
}

/// The results on their way.
pub struct PartOutbox {
    path: PathBuf,
    /// The last one that was acknowledged.
    acknowledged: Option<SentPart>,
    in_flight: VecDeque<InFlight>,
    /// Whether the file says less.
    is_changed: bool,
}

impl PartOutbox {
    /// The outbox of a data directory. Without its file, or with one that cannot be read, all parts that the control
    /// remembers are sent.
    #[must_use]
    pub fn new(folder: &std::path::Path) -> Self {
        let path = folder.join(SENT_FILE);
        let acknowledged = ron_file::read(&path, ChecksumPolicy::Strict).ok().map(|file| file.value);
        Self { path, acknowledged, in_flight: VecDeque::new(), is_changed: false }
    }

    /// The next result to send, as JSON; `None` while too many are on their way or none is new.
    #[must_use]
    pub fn next(&self, machine: &str, snapshot: &Snapshot) -> Option<(u64, String)> {
        if self.in_flight.len() >= WINDOW {
            return None;
        }
        let newest = snapshot.production.parts.last()?.count;
        // Data that were set up anew count from 1 again.
        let last = self.last_sent().filter(|sent| sent.part <= newest);
        let told_until = last.map_or(0, |sent| sent.part);
        let message = |record: &PartRecord| (record.count, message_of(machine, record));
        let changed = last.and_then(|sent| {
            let again = snapshot.production.parts.iter().rev().find(|record| record.count == sent.part).map(message)?;
            (again.1 != sent.text && told_until == newest).then_some(again)
        });
        changed.or_else(|| snapshot.production.parts.iter().find(|record| record.count > told_until).map(message))
    }

    /// It was sent with this packet identifier.
    pub fn sent(&mut self, (part, text): (u64, String), packet: u16) {
        self.in_flight.push_back(InFlight { sent: SentPart { part, text }, packet, is_acknowledged: false });
    }

    /// The broker has the message with this packet identifier.
    pub fn acknowledged(&mut self, packet: u16) {
        for flying in self.in_flight.iter_mut().filter(|flying| flying.packet == packet) {
            flying.is_acknowledged = true;
        }
        while self.in_flight.front().is_some_and(|first| first.is_acknowledged) {
            self.acknowledged = self.in_flight.pop_front().map(|first| first.sent);
            self.is_changed = true;
        }
    }

    /// The connection is lost: what was not acknowledged is sent again.
    pub fn connection_lost(&mut self) {
        self.in_flight.clear();
    }

    /// Parts that the broker has not acknowledged.
    #[must_use]
    pub fn waiting(&self, snapshot: &Snapshot) -> u64 {
        let newest = snapshot.production.parts.last().map_or(0, |record| record.count);
        let known = self.acknowledged.as_ref().map_or(0, |sent| sent.part);
        if known > newest { newest } else { newest - known }
    }

    /// Writes how far the broker knows the parts, if that has changed. A file that cannot be written costs repetitions
    /// after the next power-on, no result.
    pub fn write(&mut self) {
        if std::mem::take(&mut self.is_changed)
            && let Some(sent) = &self.acknowledged
        {
            drop(ron_file::write(&self.path, ChecksumPolicy::Strict, sent));
        }
    }

    fn last_sent(&self) -> Option<&SentPart> {
        self.in_flight.back().map(|flying| &flying.sent).or(self.acknowledged.as_ref())
    }
}

fn message_of(machine: &str, record: &PartRecord) -> String {
    let limits = record.limits;
    let message = PartResultMessage {
        machine: machine.to_owned(),
        part: record.count,
        number: record.number,
        program: record.program,
        order: (record.order > 0).then_some(record.order),
        ended: record.ended.to_string(),
        cycle_s: record.cycle_seconds,
        size_mm: record.size,
        nominal_mm: limits.map(|[nominal, ..]| nominal),
        min_mm: limits.map(|[_, least, _]| least),
        max_mm: limits.map(|[.., greatest]| greatest),
        verdict: record.verdict.id(),
        is_bad: record.verdict.is_bad(),
        since_dressing: record.since_dressing,
    };
    // Numbers that are not finite become null: nothing in it can fail.
    serde_json::to_string(&message).unwrap_or_default()
}
