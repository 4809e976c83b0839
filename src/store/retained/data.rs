//! All retained data, and one change to them.

use std::collections::BTreeMap;
use std::num::NonZeroU64;

use serde::{Deserialize, Serialize};

use super::{Generation, ToolOffset};
use crate::defs::alarm_history::PastAlarm;
use crate::defs::history::HistoryEntry;
use crate::defs::hour_record::HourRecord;
use crate::defs::part_record::PartRecord;
use crate::units::PerAxis;

/// One change to the retained data. `None` deletes the value: a null variable, a parameter at its default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum RetainedChange {
    /// A macro variable `#number` (B3).
    Variable {
        /// Its number.
        number: u16,
        /// Its value; `None` is null.
        value: Option<f64>,
    },
    /// A parameter by its key, "P270" or "P16.0".
    Param {
        /// The key.
        key: String,
        /// The value; `None` is the default.
        value: Option<f64>,
    },
    /// A tool offset, 1 to 16.
    Offset {
        /// Its number.
        number: u8,
        /// All its values.
        offset: ToolOffset,
    },
    /// A work offset: 0 is G54, 5 is G59.
    WorkOffset {
        /// Its index.
        index: u8,
        /// Its zero point in machine coordinates, mm.
        origin: PerAxis<f64>,
    },
    /// A retained number by name: a dressing point, the part count, the current program.
    Number {
        /// The name.
        key: String,
        /// The value.
        value: Option<f64>,
    },
    /// A retained text by name.
    Text {
        /// The name.
        key: String,
        /// The text.
        value: Option<String>,
    },
    /// An alarm of the history, in its slot.
    Alarm(PastAlarm),
    /// A finished part, in its slot.
    Part(PartRecord),
    /// An hour of the machine, in its slot.
    Hour(HourRecord),
}

/// All retained data at once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RetainedData {
    /// Which machine's they are: a random number of its first start; `None` in data of an older control.
    #[serde(default)]
    pub identity: Option<NonZeroU64>,
    /// Number of the last commit.
    pub generation: Generation,
    /// Macro variables by number; absent is null.
    pub variables: BTreeMap<u16, f64>,
    /// Parameters by key; absent is the default.
    pub params: BTreeMap<String, f64>,
    /// Tool offsets by number, 1 to 16; absent is all zero.
    pub offsets: BTreeMap<u8, ToolOffset>,
    /// Work offsets by index, 0 to 5; absent is all zero.
    pub work_offsets: BTreeMap<u8, PerAxis<f64>>,
    /// Retained numbers by name.
    pub numbers: BTreeMap<String, f64>,
    /// Retained texts by name.
    pub texts: BTreeMap<String, String>,
    /// Alarms of the history by slot.
    pub alarms: BTreeMap<u16, PastAlarm>,
    /// Finished parts by slot.
    #[serde(default)]
    pub parts: BTreeMap<u16, PartRecord>,
    /// Hours of the machine by slot.
    #[serde(default)]
    pub hours: BTreeMap<u16, HourRecord>,
}

impl RetainedData {
    /// Makes a change.
    pub(super) fn apply(&mut self, change: RetainedChange) {
        match change {
            RetainedChange::Variable { number, value } => set(&mut self.variables, number, value),
            RetainedChange::Param { key, value } => set(&mut self.params, key, value),
            RetainedChange::Offset { number, offset } => set(&mut self.offsets, number, Some(offset)),
            RetainedChange::WorkOffset { index, origin } => set(&mut self.work_offsets, index, Some(origin)),
            RetainedChange::Number { key, value } => set(&mut self.numbers, key, value),
            RetainedChange::Text { key, value } => set(&mut self.texts, key, value),
            RetainedChange::Alarm(past) => set(&mut self.alarms, past.slot(), Some(past)),
            RetainedChange::Part(part) => set(&mut self.parts, part.slot(), Some(part)),
            RetainedChange::Hour(hour) => set(&mut self.hours, hour.slot(), Some(hour)),
        }
    }

    /// The changes that make these data another state. The histories of alarms, parts and hours go on.
    #[must_use]
    pub fn changes_to(&self, other: &Self) -> Vec<RetainedChange> {
        let mut all = Vec::new();
        let gone = |key: &&u16| !other.variables.contains_key(key);
        all.extend(self.variables.keys().filter(gone).map(|&number| RetainedChange::Variable { number, value: None }));
        let gone = |key: &&String| !other.params.contains_key(*key);
        all.extend(self.params.keys().filter(gone).map(|key| RetainedChange::Param { key: key.clone(), value: None }));
        let gone = |key: &&u8| !other.offsets.contains_key(key);
        let zero = ToolOffset::default();
        all.extend(self.offsets.keys().filter(gone).map(|&number| RetainedChange::Offset { number, offset: zero }));
        let gone = |key: &&u8| !other.work_offsets.contains_key(key);
        let origin = PerAxis::default();
        all.extend(self.work_offsets.keys().filter(gone).map(|&index| RetainedChange::WorkOffset { index, origin }));
        let gone = |key: &&String| !other.numbers.contains_key(*key);
        all.extend(
            self.numbers.keys().filter(gone).map(|key| RetainedChange::Number { key: key.clone(), value: None }),
        );
        let gone = |key: &&String| !other.texts.contains_key(*key);
        all.extend(self.texts.keys().filter(gone).map(|key| RetainedChange::Text { key: key.clone(), value: None }));
        let is_entry = |change: &RetainedChange| {
            matches!(change, RetainedChange::Alarm(_) | RetainedChange::Part(_) | RetainedChange::Hour(_))
        };
        all.extend(other.changes().into_iter().filter(|change| !is_entry(change)));
        all
    }

    /// The changes that make an empty database this one.
    pub(super) fn changes(&self) -> Vec<RetainedChange> {
        let mut all = Vec::new();
        all.extend(
            self.variables.iter().map(|(&number, &value)| RetainedChange::Variable { number, value: Some(value) }),
        );
        all.extend(
            self.params.iter().map(|(key, &value)| RetainedChange::Param { key: key.clone(), value: Some(value) }),
        );
        all.extend(self.offsets.iter().map(|(&number, &offset)| RetainedChange::Offset { number, offset }));
        all.extend(self.work_offsets.iter().map(|(&index, &origin)| RetainedChange::WorkOffset { index, origin }));
        all.extend(
            self.numbers.iter().map(|(key, &value)| RetainedChange::Number { key: key.clone(), value: Some(value) }),
        );
        let text =
            |(key, text): (&String, &String)| RetainedChange::Text { key: key.clone(), value: Some(text.clone()) };
        all.extend(self.texts.iter().map(text));
        all.extend(self.alarms.values().cloned().map(RetainedChange::Alarm));
        all.extend(self.parts.values().copied().map(RetainedChange::Part));
        all.extend(self.hours.values().copied().map(RetainedChange::Hour));
        all
    }
}

/// Sets a value, or removes it for `None`.
fn set<K: Ord, V>(rows: &mut BTreeMap<K, V>, key: K, value: Option<V>) {
    match value {
        Some(value) => drop(rows.insert(key, value)),
        None => drop(rows.remove(&key)),
    }
}
