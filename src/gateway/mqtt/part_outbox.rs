//! The results of finished parts on their way to the broker: each is sent until the broker has acknowledged it, over losses
//! of the connection and of the control's power. Whoever counts parts tells repetitions by the serial number.
//! Source: OASIS MQTT 3.1.1, 4.3.2 (at least once); retained part history, B6.

use std::collections::VecDeque;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use super::told_to_broker::{SentPart, ToldToBroker};
use crate::defs::part_record::{PartHistory, PartRecord};
use crate::link::data_item::rounded;

/// The newest result is sent when it has not changed for so long: size and verdict follow the part.
const SETTLING: Duration = Duration::from_secs(2);
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
    /// Diameter of the wheel, mm.
    wheel_mm: Option<f64>,
    /// Numbers of the alarms since the part before, the newest first, with spaces between them.
    alarms: String,
}

/// A result on its way.
struct InFlight {
    sent: SentPart,
    packet: u16,
    is_acknowledged: bool,
}

/// The results on their way.
pub struct PartOutbox {
    /// Those that the broker has.
    pub told: ToldToBroker,
    in_flight: VecDeque<InFlight>,
    /// The newest result, and since when it is so.
    settling: Option<(SentPart, Duration)>,
    /// Version of the history in which nothing more was to be sent.
    done_version: Option<u64>,
}

impl PartOutbox {
    /// The outbox of a data directory. If nobody knows what was sent, all parts that the control remembers are sent.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Self { told: ToldToBroker::read(folder), in_flight: VecDeque::new(), settling: None, done_version: None }
    }

    /// The next result to send; `None` while too many are on their way or none is new.
    #[must_use]
    pub fn next(&mut self, now: Duration, machine: &str, parts: &PartHistory) -> Option<SentPart> {
        if self.in_flight.len() >= WINDOW || self.done_version == Some(parts.version()) {
            return None;
        }
        let record_of = |sent: &SentPart| parts.iter().rev().find(|record| sent.is_of(record));
        self.told.keep_only(|sent| record_of(sent).is_some());
        let sent = || self.told.parts().chain(self.in_flight.iter().map(|flying| &flying.sent));
        let result = |record: &PartRecord| SentPart {
            part: record.count,
            program: record.program,
            ended: record.ended.0,
            text: message_of(machine, record),
        };
        // The last one that was sent of each part counts.
        let is_last = |told: &SentPart| sent().rfind(|other| other.part == told.part).is_some_and(|last| last == told);
        let changed = sent().filter(|told| is_last(told)).find_map(|told| {
            // The end of a cycle that goes on after its part was counted changes the record, too.
            let again = result(parts.iter().rev().find(|record| record.count == told.part)?);
            is_other_result(&again.text, &told.text).then_some(again)
        });
        let until = sent().map(|sent| sent.part).max().unwrap_or(0);
        let next = changed.or_else(|| parts.iter().find(|record| record.count > until).map(result));
        let Some(next) = next else {
            self.done_version = Some(parts.version());
            return None;
        };
        if parts.last().is_some_and(|newest| newest.count > next.part) {
            return Some(next);
        }
        let (_, since) = match self.settling.take().filter(|(same, _)| *same == next) {
            Some(known) => self.settling.insert(known),
            None => self.settling.insert((next.clone(), now)),
        };
        (now.saturating_sub(*since) >= SETTLING).then_some(next)
    }

    /// It was sent with this packet identifier.
    pub fn sent(&mut self, sent: SentPart, packet: u16) {
        self.in_flight.push_back(InFlight { sent, packet, is_acknowledged: false });
    }

    /// The broker has the message with this packet identifier.
    pub fn acknowledged(&mut self, packet: u16) {
        if let Some(flying) = self.in_flight.iter_mut().find(|flying| flying.packet == packet) {
            flying.is_acknowledged = true;
        }
        while let Some(first) = self.in_flight.pop_front_if(|first| first.is_acknowledged) {
            self.told.acknowledge(first.sent);
            self.done_version = None;
        }
    }

    /// The connection is lost: what was not acknowledged is sent again.
    pub fn connection_lost(&mut self) {
        self.in_flight.clear();
        self.done_version = None;
    }

    /// Results that the broker has not acknowledged.
    #[must_use]
    pub fn waiting(&self, parts: &PartHistory) -> u64 {
        let known = self.told.parts().map(|sent| sent.part).max().unwrap_or(0);
        let new = parts.iter().rev().take_while(|record| record.count > known).count();
        let again = self.in_flight.iter().filter(|flying| flying.sent.part <= known).count();
        (new + again) as u64
    }
}

/// Whether a result is another one than was sent; the machine may have got another name since.
fn is_other_result(now: &str, sent: &str) -> bool {
    let without_machine = |text: &str| {
        let mut message: serde_json::Value = serde_json::from_str(text).ok()?;
        message.as_object_mut()?.remove("machine");
        Some(message)
    };
    now != sent && without_machine(now) != without_machine(sent)
}

fn message_of(machine: &str, record: &PartRecord) -> String {
    let limits = record.limits;
    let numbers = record.alarms.iter().filter(|number| **number > 0).map(u16::to_string);
    let message = PartResultMessage {
        machine: machine.to_owned(),
        part: record.count,
        number: record.number,
        program: record.program,
        order: (record.order > 0).then_some(record.order),
        ended: record.ended.to_string(),
        cycle_s: rounded(record.cycle_seconds),
        size_mm: record.size.map(rounded),
        nominal_mm: limits.map(|[nominal, ..]| rounded(nominal)),
        min_mm: limits.map(|[_, least, _]| rounded(least)),
        max_mm: limits.map(|[.., greatest]| rounded(greatest)),
        verdict: record.verdict.id(),
        is_bad: record.verdict.is_bad(),
        since_dressing: record.since_dressing,
        wheel_mm: record.wheel_mm.map(rounded),
        alarms: numbers.collect::<Vec<_>>().join(" "),
    };
    // Numbers that are not finite become null: nothing in it can fail.
    serde_json::to_string(&message).unwrap_or_default()
}
