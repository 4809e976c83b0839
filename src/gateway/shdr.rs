//! The lines of the adapter protocol of MTConnect (SHDR): what has changed, and everything for a new agent.
//! Source: MTConnect Agent (cppagent), "Adapter Agent Protocol"; ANSI/MTC1.4 part 3.

use super::device_model::device_uuid;
use crate::defs::alarm_history::PastAlarm;
use crate::defs::param;
use crate::link::condition::{Condition, level};
use crate::link::data_item::{DataItem, data_items};
use crate::link::snapshot::{AlarmView, Snapshot};

/// Longest text of a value, characters; the rest is cut.
const LONGEST_TEXT: usize = 400;

/// An alarm as a condition that is not normal.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Raised {
    condition: &'static str,
    level: &'static str,
    number: u16,
    text: String,
}

/// What the agents have been told.
#[derive(Clone, Debug, Default)]
pub struct ShdrLines {
    /// Each item with its value.
    values: Vec<(DataItem, String)>,
    raised: Vec<Raised>,
    /// The conditions of the machine.
    conditions: Vec<Condition>,
    /// Who the machine is, in lines.
    identity: String,
    /// Serial number of the newest alarm that has been looked at; none before the first look.
    newest_alarm: Option<u64>,
}

impl ShdrLines {
    /// The lines that tell what has changed since the last call; `time` is in UTC by ISO 8601. Measured values are looked at
    /// with `with_samples`.
    pub fn changes(&mut self, time: &str, snapshot: &Snapshot, with_samples: bool) -> String {
        let known = std::mem::take(&mut self.values);
        let value = |(at, item): (usize, DataItem)| {
            let old = known.get(at).filter(|(other, _)| other.id() == item.id());
            match old {
                Some((_, told)) if !with_samples && item.is_sampled() => (item, told.clone()),
                _ => (item, text(&item.value(snapshot).to_string())),
            }
        };
        self.values = data_items(snapshot).enumerate().map(value).collect();
        // The items are in the same order, unless the axes of the machine have changed.
        let is_told = |at: usize, (item, value): &(DataItem, String)| {
            known.get(at).is_some_and(|(other, told)| told == value && other.id() == item.id())
        };
        let is_same_list = known.len() == self.values.len()
            && known.iter().zip(&self.values).all(|((old, _), (new, _))| old.id() == new.id());
        let numbered = self.values.iter().enumerate();
        let new = numbered.filter(|(at, entry)| !is_told(*at, entry)).map(|(_, entry)| entry);
        let mut lines = values_line(time, new);
        if !is_same_list {
            // What the machine has no longer is not known any more.
            let is_gone = |old: &DataItem| self.values.iter().all(|(item, _)| item.id() != old.id());
            for (old, _) in known.iter().filter(|(old, _)| is_gone(old)) {
                lines += &format!("{time}|{}|UNAVAILABLE\n", old.id());
            }
        }
        self.conditions = Condition::of_machine(snapshot).collect();
        let identity = identity_lines(snapshot);
        if !self.identity.is_empty() && self.identity != identity {
            lines += &identity;
        }
        self.identity = identity;
        let newest = snapshot.alarm_history.last().map_or(0, |alarm| alarm.count);
        let first_look = self.newest_alarm.is_none();
        let seen = self.newest_alarm.replace(newest).unwrap_or(newest);
        let raised: Vec<Raised> = snapshot.alarms.iter().map(raised_of).collect();
        let was_raised = std::mem::replace(&mut self.raised, raised);
        for over in was_raised.iter().filter(|over| !self.raised.iter().any(|now| is_same(now, over))) {
            lines += &format!("{time}|{}|NORMAL|{}|||\n", over.condition, over.number);
        }
        if first_look {
            lines += &self.normal_conditions(time);
        }
        // Alarms that have come and gone since the last look.
        for past in snapshot.alarm_history.iter().rev().take_while(|past| past.count > seen) {
            let short = passed(past);
            if past.ended.is_some() && !self.raised.iter().chain(&was_raised).any(|other| is_same(other, &short)) {
                lines += &condition_line(time, &short);
                lines += &format!("{time}|{}|NORMAL|{}|||\n", short.condition, short.number);
            }
        }
        for new in self.raised.iter().filter(|new| !was_raised.contains(new)) {
            lines += &condition_line(time, new);
        }
        lines
    }

    /// Everything that was told, for an agent that connects.
    #[must_use]
    pub fn everything(&self, time: &str) -> String {
        let mut lines = self.identity.clone();
        lines += &values_line(time, self.values.iter());
        lines += &self.normal_conditions(time);
        for raised in &self.raised {
            lines += &condition_line(time, raised);
        }
        lines
    }

    /// The conditions that have no alarm.
    fn normal_conditions(&self, time: &str) -> String {
        let ids = self.conditions.iter().map(|condition| condition.row().0);
        let normal = ids.filter(|id| !self.raised.iter().any(|raised| raised.condition == *id));
        normal.map(|id| format!("{time}|{id}|NORMAL||||\n")).collect()
    }
}

/// Who the machine is: an agent takes it in place of what its model says, unless it is to preserve that.
fn identity_lines(snapshot: &Snapshot) -> String {
    let (uuid, kind) = (device_uuid(snapshot), snapshot.kind.name().en);
    let number = snapshot.params.get(param::MACHINE_NUMBER);
    format!("* uuid: {uuid}\n* manufacturer: KT-830\n* serialNumber: {number:06}\n* description: KT-830 {kind}\n")
}

/// One line for all values; a message has a line of its own, with the field of its code empty.
fn values_line<'a>(time: &str, values: impl Iterator<Item = &'a (DataItem, String)>) -> String {
    let (mut line, mut messages) = (String::new(), String::new());
    for (item, value) in values {
        let (id, target) = (item.id(), if item.kind == "MESSAGE" { &mut messages } else { &mut line });
        *target += &if item.kind == "MESSAGE" { format!("{time}|{id}||{value}\n") } else { format!("|{id}|{value}") };
    }
    if line.is_empty() { messages } else { format!("{time}{line}\n{messages}") }
}

fn raised_of(alarm: &AlarmView) -> Raised {
    let (condition, ..) = Condition::of_alarm(alarm.number).row();
    let (words, cause) = (alarm.text.en(), alarm.cause.en());
    let words = if cause.is_empty() { words.into_owned() } else { format!("{words}: {cause}") };
    Raised { condition, level: level(alarm.number), number: alarm.number, text: text(&words) }
}

fn passed(past: &PastAlarm) -> Raised {
    let (condition, ..) = Condition::of_alarm(past.number).row();
    Raised { condition, level: level(past.number), number: past.number, text: text(&past.text.en()) }
}

fn is_same(left: &Raised, right: &Raised) -> bool {
    (left.condition, left.number) == (right.condition, right.number)
}

fn condition_line(time: &str, raised: &Raised) -> String {
    let Raised { condition, level, number, text } = raised;
    format!("{time}|{condition}|{level}|{number}|||{text}\n")
}

/// A text that an agent takes as it is: no bar, no quotation mark, no control character, no sign that XML does not have, no
/// word of the protocol (`--multiline--`), not too long.
fn text(words: &str) -> String {
    let sign = |sign: char| match sign {
        '|' => '/',
        '"' => '\'',
        '\u{fffe}' | '\u{ffff}' => ' ',
        sign if sign.is_control() => ' ',
        sign => sign,
    };
    let mut words: String = words.chars().take(LONGEST_TEXT).map(sign).collect();
    while words.contains("--") {
        words = words.replace("--", "- -");
    }
    words.trim().to_owned()
}
