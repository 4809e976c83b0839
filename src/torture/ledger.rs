//! What the control has asked to be stored and what was acknowledged, to compare with what a power cut leaves.
//! Source: notes "acknowledge after commit"; spec B3, K4.2.

use std::collections::{BTreeMap, VecDeque};

use crate::controller::{PowerOnState, StorageRequest};
use crate::defs::alarm_history::PastAlarm;
use crate::defs::history::HistoryEntry;
use crate::host::retained_store::apply_request;
use crate::nc::{CommonVariables, WorkOffsets};
use crate::units::Axis;

/// Retained values by name, each in a form that can be compared.
pub type Rows = BTreeMap<String, String>;

/// All retained values of a control.
#[must_use]
pub fn rows(state: &PowerOnState) -> Rows {
    let mut rows = Rows::new();
    rows.insert("parameters".to_owned(), format!("{:?}", state.params));
    let retained = (0..1_000).filter(|number| CommonVariables::is_retained(*number));
    for number in retained {
        if let Ok(Some(value)) = state.variables.get(number) {
            rows.insert(format!("#{number}"), value.to_string());
        }
    }
    offset_rows(&state.work_offsets, &mut rows);
    for axis in Axis::ALL {
        rows.insert(format!("dressing point {axis}"), format!("{:?}", state.dress_points[axis]));
        rows.insert(format!("leadscrew {axis}"), state.leadscrew_tables[axis].to_text());
    }
    rows.insert("current program".to_owned(), state.current_program.to_string());
    rows.insert("part count".to_owned(), state.part_count.to_string());
    rows.insert("interrupted".to_owned(), format!("{:?}", state.interrupted));
    rows.insert("clock".to_owned(), state.clock_offset_s.to_string());
    rows.insert("wrong passwords".to_owned(), state.wrong_passwords.to_string());
    let mut alarms: Vec<&PastAlarm> = state.alarm_history.iter().collect();
    alarms.sort_by_key(|alarm| alarm.slot());
    rows.extend(alarms.iter().map(|alarm| (format!("alarm record {}", alarm.slot()), alarm_row(alarm))));
    rows.extend(state.parts.iter().map(|part| (format!("part record {}", part.slot()), format!("{part:?}"))));
    rows.extend(state.hours.iter().map(|hour| (format!("hour {}", hour.slot()), format!("{hour:?}"))));
    rows.extend(state.orders.iter().map(|order| (format!("order {}", order.number), format!("{order:?}"))));
    rows.extend(state.wheels.iter().map(|wheel| (format!("wheel {}", wheel.number), format!("{wheel:?}"))));
    rows
}

/// The offsets that are retained; a local offset (G52) is not.
fn offset_rows(offsets: &WorkOffsets, rows: &mut Rows) {
    rows.insert("G54 to G59".to_owned(), format!("{:?} {:?}", offsets.external, offsets.work));
    for (index, ((geometry, wear), cutter)) in
        offsets.geometry.iter().zip(&offsets.wear).zip(&offsets.cutter).enumerate()
    {
        rows.insert(format!("offset {}", index + 1), format!("{geometry:?} {wear:?} {cutter:?}"));
    }
}

/// An alarm as pages show it; a template is stored as the words that it gives.
fn alarm_row(alarm: &PastAlarm) -> String {
    let PastAlarm { count, number, text, place, came, ended, .. } = alarm;
    format!("{count} {number} {} {} {place:?} {came:?} {ended:?}", text.zh(), text.en())
}

/// The first value that differs: name, what was expected, what was found.
#[must_use]
pub fn first_difference(expected: &Rows, found: &Rows) -> Option<String> {
    let names = expected.keys().chain(found.keys());
    let differs = |name: &&String| expected.get(*name) != found.get(*name);
    let name = names.clone().find(differs)?;
    let value =
        |rows: &Rows| rows.get(name).map_or_else(|| "nothing".to_owned(), |text| text.chars().take(200).collect());
    Some(format!("{name} is {}, expected {}", value(found), value(expected)))
}

/// One batch of requests, as the control handed it over.
#[derive(Debug)]
struct Batch {
    requests: Vec<StorageRequest>,
    mark: Option<u64>,
}

/// The account of one power-on.
#[derive(Debug)]
pub struct Ledger {
    /// What was acknowledged.
    acknowledged: PowerOnState,
    /// What was handed over since.
    open: VecDeque<Batch>,
    /// The newest mark that the control is told of in this tick.
    told: Option<u64>,
}

impl Ledger {
    /// An account that begins with what the control has started with.
    #[must_use]
    pub const fn new(start: PowerOnState) -> Self {
        Self { acknowledged: start, open: VecDeque::new(), told: None }
    }

    /// The control hands requests over.
    pub fn hand_over(&mut self, requests: &[StorageRequest]) {
        let mark = requests.iter().rev().find_map(|request| match request {
            StorageRequest::Mark(mark) => Some(*mark),
            _ => None,
        });
        let requests: Vec<_> = requests.iter().filter(|request| request.is_retained()).cloned().collect();
        if !requests.is_empty() || mark.is_some() {
            self.open.push_back(Batch { requests, mark });
        }
    }

    /// The control is told that everything up to a mark is stored. It counts from the end of the tick.
    pub fn acknowledge(&mut self, mark: u64) {
        self.told = self.told.max(Some(mark));
    }

    /// The power went within the tick: the control was told of nothing.
    pub const fn forget_told(&mut self) {
        self.told = None;
    }

    /// The tick is over.
    pub fn end_tick(&mut self) {
        let Some(mark) = self.told.take() else { return };
        let upto = self.open.iter().rposition(|batch| batch.mark.is_some_and(|other| other <= mark));
        for batch in self.open.drain(..upto.map_or(0, |last| last + 1)) {
            batch.requests.iter().for_each(|request| apply_request(&mut self.acknowledged, request));
        }
    }

    /// Number of batches that are not acknowledged.
    #[must_use]
    pub fn open_batches(&self) -> usize {
        self.open.len()
    }

    /// Whether a power cut may leave this: everything that was acknowledged, and of what came later a beginning of
    /// whole batches.
    ///
    /// # Errors
    /// A value that is lost, altered or ahead of its batch.
    pub fn check(&self, found: &PowerOnState) -> Result<(), String> {
        self.check_rows(found, rows)
    }

    /// As [`Self::check`], of data that took the place of lost ones: nothing is missing but the place of a run.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn check_after_loss(&self, found: &PowerOnState) -> Result<(), String> {
        self.check_rows(found, |state| rows(&PowerOnState { interrupted: None, ..state.clone() }))
    }

    fn check_rows(&self, found: &PowerOnState, rows: fn(&PowerOnState) -> Rows) -> Result<(), String> {
        let found = rows(found);
        let mut state = self.acknowledged.clone();
        let difference = first_difference(&rows(&state), &found);
        let Some(first) = difference else { return Ok(()) };
        for batch in &self.open {
            batch.requests.iter().for_each(|request| apply_request(&mut state, request));
            if rows(&state) == found {
                return Ok(());
            }
        }
        Err(format!("after the power cut {first}, nor any of the {} batches on their way", self.open.len()))
    }
}
