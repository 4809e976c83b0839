//! Maps the core's storage requests to database rows: keys, values, and how they are restored at power-on.
//! Source: spec B3 (retained ranges), notes "acknowledge after commit".

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use chrono::{DateTime, Local};

use super::data_loss::{DataLoss, LossChoice, LossSource};
use super::folders::time_text;
use super::password_store::{LostData, PasswordStore};
use crate::controller::{PowerOnState, StorageRequest};
use crate::defs::alarm;
use crate::defs::history::HistoryEntry;
use crate::defs::kind::Kind;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::param::ParamAddress;
use crate::defs::production_order::ProductionOrder;
use crate::defs::system_variable;
use crate::defs::text::{LocalizedText, Text};
use crate::defs::wheel_record::WheelRecord;
use crate::link::command::Command;
use crate::link::page_command::{DataChoice, KeptState, PageCommand, SettingsRequest, StorageAnswer};
use crate::nc::OriginPlace;
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::store::disk;
use crate::store::ron_file::{self, ChecksumPolicy};
use crate::store::{
    DamageReport, KIND_FILE, RetainedChange, RetainedData, RetainedDatabase, RetainedError, ToolOffset, generations,
    remove_temporary,
};
use crate::units::{Axis, PerAxis};

const CURRENT_PROGRAM: &str = "current-program";
const PARTS: &str = "parts";
const CLOCK_OFFSET: &str = "clock-offset";
/// Before the number of a production order.
const ORDER: &str = "order-";
/// Before the number of a wheel.
const WHEEL: &str = "wheel-";
const WRONG_PASSWORDS: &str = "wrong-passwords";
const SCREWS: [&str; 3] = ["screw-x", "screw-y", "screw-z"];
/// The number of the tool offset follows.
const CUTTER_RADIUS: &str = "cutter-radius-";
const CUTTER_TIP: &str = "cutter-tip-";
const RUNNING_AT: &str = "running-at";
/// The kind of machine of the data, and what happened to lost data.
const KIND: &str = "machine-kind";
const LOSS: &str = "data-loss";
/// What takes the place of lost data at the next start: the number of a kept state, or [`FACTORY`].
const CHOICE: &str = "data-choice";
const FACTORY: &str = "factory";
const NOTHING_LOST: Text = Text::new("数据已接受，不能再更换", "the data are accepted: they are not replaced any more");
const DRESS_POINTS: [&str; 3] = ["dress-point-x", "dress-point-y", "dress-point-z"];

/// Result of opening the data.
#[derive(Debug)]
pub struct StoreReport {
    /// The data that the control starts with.
    pub retained: PowerOnState,
    /// The data were damaged or gone, and no person has accepted what took their place: what happened.
    pub loss: Option<DataLoss>,
    /// Earlier states cannot be kept; why.
    pub unkept: Option<String>,
    /// Stored values that are no longer allowed; factory values are used instead.
    pub dropped: Vec<String>,
    /// The kind of machine beside the data, if it is another one: one of them was put there.
    pub other_kind: Option<(Kind, Kind)>,
}

impl StoreReport {
    /// The alarms of the data that stand until a person has decided, with their detail.
    #[must_use]
    pub fn standing(&self) -> Vec<(u16, LocalizedText)> {
        let loss = self.loss.as_ref().map(|loss| (alarm::RETAINED_DATA_DAMAGED, loss.message()));
        let unkept = self.unkept.as_ref().map(|why| (alarm::STORE_FAILED, LocalizedText::same(why)));
        let dropped = Some(self.dropped.join(", ")).filter(|values| !values.is_empty());
        let dropped = dropped.map(|values| (alarm::VALUES_DROPPED, LocalizedText::same(&values)));
        let mismatch = self.other_kind.map(|(of_data, beside)| {
            let (of_data, beside) = (of_data.short_name(), beside.short_name());
            let zh = format!("数据为 {of_data}，{KIND_FILE} 为 {beside}");
            (alarm::SETTINGS_INVALID, LocalizedText::new(zh, format!("data {of_data}, {KIND_FILE} {beside}")))
        });
        loss.into_iter().chain(unkept).chain(dropped).chain(mismatch).collect()
    }
}

/// The store of one control.
pub struct RetainedStore {
    database: RetainedDatabase,
    passwords: PasswordStore,
    /// Changes that the disk has refused; they are written before the next changes.
    unsaved: Vec<RetainedChange>,
    /// Removes the rows of values that are no longer allowed, once a person has accepted the data.
    refused: Vec<RetainedChange>,
    folder: PathBuf,
    /// When a generation was kept last, on the clock of the disk.
    kept_at: Duration,
}

/// Time after which the next commit keeps a generation: what a damaged database may cost.
const GENERATION_INTERVAL: Duration = Duration::from_secs(300);
/// Time after which the end of a run keeps one: short cycles do not write one each.
const RUN_END_INTERVAL: Duration = Duration::from_secs(60);

/// Whether a commit of these requests keeps a generation, so long after the last one.
fn keeps_generation(requests: &[StorageRequest], after: Duration) -> bool {
    let ends_run = requests.iter().any(|request| matches!(request, StorageRequest::RunningAt(None)));
    after >= if ends_run { RUN_END_INTERVAL } else { GENERATION_INTERVAL }
}

/// Maximum number of unsaved changes; the oldest are dropped first.
const MAX_UNSAVED: usize = 100_000;

impl RetainedStore {
    /// Opens the data of a directory.
    ///
    /// # Errors
    /// Another control has it open, or the disk reports an error.
    pub fn open(folder: &Path, kind: Kind) -> Result<(Self, StoreReport), RetainedError> {
        let mut opened = RetainedDatabase::open_or_replace(folder, |damaged| replacement(folder, damaged))?;
        // The lock is ours: no other control is writing one.
        remove_temporary(folder);
        let mut loaded = opened.data;
        let stored_kind = loaded.texts.get(KIND).and_then(|id| Kind::from_id(id));
        if let Some(stored) = stored_kind.filter(|stored| *stored != kind) {
            return Err(RetainedError::OtherKind(stored.id().to_owned(), kind.id().to_owned()));
        }
        let choice = loaded.texts.get(CHOICE).filter(|_| loaded.texts.contains_key(LOSS));
        let chosen = choice.and_then(|choice| chosen_state(folder, choice, &loaded));
        let replaced = chosen.map_or(Ok(()), |chosen| {
            let done = opened.database.commit(&loaded.changes_to(&chosen)).map(drop);
            // A commit that reports an error may have succeeded: what is in force is what the disk has.
            loaded = opened.database.load()?;
            done
        });
        let unbound = stored_kind.is_none().then(|| text(KIND, Some(kind.id().to_owned())));
        let unsaved = unbound.into_iter().chain(disarm(&mut loaded)).collect();
        let (mut retained, dropped) = retained_from_data(kind, &loaded);
        let (dropped, refused): (Vec<_>, Vec<_>) = dropped.into_iter().unzip();
        let refused = refused.into_iter().flatten().collect();
        let loss = loaded.texts.get(LOSS).map(|row| DataLoss::from_row(row));
        if loss.is_some() {
            retained.kept_states = kept_states(folder, kind).into();
        }
        let lost = match &loss {
            None => LostData::None,
            Some(DataLoss { source: LossSource::Journal, .. }) => LostData::Restored,
            Some(DataLoss { source: LossSource::EarlierState, .. }) => LostData::Earlier,
            Some(_) => LostData::Whole,
        };
        let passwords = PasswordStore::new(&loaded, lost, folder.to_path_buf());
        let (folder, kept_at) = (folder.to_path_buf(), disk::now());
        let mut store = Self { database: opened.database, passwords, unsaved, refused, folder, kept_at };
        let bound = if store.unsaved.is_empty() { Ok(0) } else { store.commit(&[]) };
        let other_kind = kind_beside(&store.folder).filter(|beside| *beside != kind).map(|beside| (kind, beside));
        // Another one there stands until a person has chosen the kind.
        let bound = if other_kind.is_some() { bound.map(drop) } else { bound.and_then(|_| store.write_kind(kind)) };
        let copied = store.passwords.complete_copy();
        let bound = bound.and(copied.map_err(|error| RetainedError::Copy(error.to_string())));
        // A disk that takes nothing is an alarm, not a dead panel: the values are whole, and each commit tries again.
        let unwritable = opened.unwritable.map_or(Ok(()), Err).and(replaced).and(bound);
        let unkept = unwritable.and_then(|_| store.keep_generation()).err().map(|error| error.to_string());
        let report = StoreReport { retained, loss, unkept, dropped, other_kind };
        Ok((store, report))
    }

    /// The kind of machine that the data of a directory belong to; of the newest whole generation if they are damaged
    /// or gone, otherwise of the copy beside them. Nothing is written.
    #[must_use]
    pub fn kind_of(folder: &Path) -> Option<Kind> {
        let of_data = peek(folder).and_then(|data| data.texts.get(KIND).and_then(|id| Kind::from_id(id)));
        of_data.or_else(|| kind_beside(folder))
    }

    /// Writes the kind beside the database, unless it is there.
    fn write_kind(&self, kind: Kind) -> Result<(), RetainedError> {
        if kind_beside(&self.folder) == Some(kind) {
            return Ok(());
        }
        let written = ron_file::write(&self.folder.join(KIND_FILE), ChecksumPolicy::Strict, &kind);
        written.map_err(|error| RetainedError::Copy(error.to_string()))
    }

    /// The data of a directory for a check: nothing is written, and a running control is not disturbed. `None` without
    /// whole data.
    #[must_use]
    pub fn read_only(folder: &Path, kind: Kind) -> Option<PowerOnState> {
        Some(retained_from_data(kind, &peek(folder)?).0)
    }

    /// Keeps the present state as a generation.
    ///
    /// # Errors
    /// The disk reports an error.
    pub fn keep_generation(&mut self) -> Result<(), RetainedError> {
        // A folder that was put in the place of ours has states of its own.
        self.database.check_present()?;
        let data = self.database.load()?;
        self.kept_at = disk::now();
        // What nobody has accepted never takes the place of a good state.
        if !data.texts.contains_key(LOSS) && data.generation.0 > 0 {
            generations::keep(&self.folder, &data).map_err(|error| RetainedError::Copy(error.to_string()))?;
        }
        Ok(())
    }

    /// Whether the data are still where they were opened. Journal, passwords and kept states are made anew if they were
    /// removed.
    ///
    /// # Errors
    /// The data were removed or replaced, or a disk error.
    pub fn check_files(&mut self) -> Result<(), RetainedError> {
        self.database.check_files()?;
        self.passwords.complete_copy().map_err(|error| RetainedError::Copy(error.to_string()))?;
        match generations::has_any(&self.folder) {
            true => Ok(()),
            false => self.keep_generation(),
        }
    }

    /// Answers a request of a page.
    pub fn answer(&mut self, request: &SettingsRequest) -> Command {
        let changes = match request {
            SettingsRequest::AcceptData(DataChoice::Kept(_) | DataChoice::Factory)
                if let Some(why) = self.choice_refusal() =>
            {
                return answered(StorageAnswer::Failed(why));
            }
            SettingsRequest::AcceptData(DataChoice::Present) => {
                self.refused.iter().cloned().chain([text(LOSS, None), text(CHOICE, None)]).collect()
            }
            SettingsRequest::AcceptData(DataChoice::Kept(state)) => match generations::find(&self.folder, state.number)
            {
                Some(_) => vec![text(CHOICE, Some(state.number.to_string()))],
                None => return answered(StorageAnswer::Failed(unreadable(state))),
            },
            SettingsRequest::AcceptData(DataChoice::Factory) => vec![text(CHOICE, Some(FACTORY.to_owned()))],
            // The data go with the kind.
            SettingsRequest::SaveKind(kind) => vec![text(KIND, Some(kind.id().to_owned()))],
            _ => Vec::new(),
        };
        let mut stored = if changes.is_empty() { Ok(()) } else { self.database.commit(&changes).map(drop) };
        if let SettingsRequest::SaveKind(kind) = request {
            stored = stored.and_then(|()| self.write_kind(*kind));
        }
        match stored {
            Ok(()) => {
                if *request == SettingsRequest::AcceptData(DataChoice::Present) {
                    self.refused.clear();
                    // What a person has checked survives a loss from now on; a full disk has its alarm with the next commit.
                    drop(self.keep_generation());
                }
                self.passwords.answer(request, Some(&mut self.database))
            }
            Err(error) => answered(StorageAnswer::Failed(LocalizedText::same(&error))),
        }
    }

    /// Why no other data can be chosen; none while nobody has accepted what took the place of lost data.
    fn choice_refusal(&mut self) -> Option<LocalizedText> {
        match self.database.load() {
            Ok(data) if data.texts.contains_key(LOSS) => None,
            Ok(_) => Some(NOTHING_LOST.into()),
            Err(error) => Some(LocalizedText::same(&error)),
        }
    }

    /// Stores the core's requests. When it returns, they survive a power cut. Changes that the disk refuses are written
    /// again with the next request.
    ///
    /// # Errors
    /// The disk reports an error.
    pub fn commit(&mut self, requests: &[StorageRequest]) -> Result<u64, RetainedError> {
        let Self { unsaved, refused, .. } = self;
        unsaved.extend(requests.iter().filter_map(to_change));
        // A value that was set since takes the place of the one that is no longer allowed.
        refused.retain(|removed| !unsaved.iter().any(|change| is_same_row(change, removed)));
        let mut done = self.database.commit(&self.unsaved);
        if let Err(RetainedError::BadChange(..)) = done {
            // An invalid change is dropped and reported; the others are still written.
            self.unsaved.retain(RetainedDatabase::accepts);
            self.database.commit(&self.unsaved)?;
            self.unsaved.clear();
        }
        match &mut done {
            Ok(_) => {
                self.unsaved.clear();
                if keeps_generation(requests, disk::now().saturating_sub(self.kept_at)) {
                    self.keep_generation()?;
                }
            }
            Err(_) => drop(self.unsaved.drain(..self.unsaved.len().saturating_sub(MAX_UNSAVED))),
        }
        done.map(|generation| generation.0)
    }
}

/// The kind of machine beside the data, if its file is whole.
fn kind_beside(folder: &Path) -> Option<Kind> {
    ron_file::read::<Kind>(&folder.join(KIND_FILE), ChecksumPolicy::Strict).ok().map(|found| found.value)
}

/// The data of a directory, or their newest whole copy: what a control starts with.
fn peek(folder: &Path) -> Option<RetainedData> {
    let database = RetainedDatabase::peek(folder);
    let copy = RetainedDatabase::newest_copy(folder).map(|copy| copy.data);
    match (database, copy) {
        (Some(data), Some(copy)) if copy.generation > data.generation => Some(copy),
        (data, copy) => data.or(copy),
    }
}

impl Drop for RetainedStore {
    /// The last state of a session is a generation.
    fn drop(&mut self) {
        drop(self.keep_generation());
    }
}

/// What takes the place of data that are damaged or gone: their newest whole copy, the newest passwords, and the record
/// of what happened, until a person has accepted it.
fn replacement(folder: &Path, damaged: Option<&DamageReport>) -> RetainedData {
    let (mut data, mut state_of, mut source) = (RetainedData::default(), None, LossSource::None);
    if let Some(copy) = RetainedDatabase::newest_copy(folder) {
        source = if copy.is_last { LossSource::Journal } else { LossSource::EarlierState };
        (data, state_of) = (copy.data, Some(time_text(copy.modified)));
    }
    PasswordStore::add_copy(folder, &mut data);
    let copy = damaged.and_then(|report| Some(report.kept_as.file_name()?.to_string_lossy().into_owned()));
    // The place of a run is that of the state, not of the loss.
    [CHOICE, RUNNING_AT].into_iter().for_each(|key| drop(data.texts.remove(key)));
    data.texts.insert(LOSS.to_owned(), DataLoss { copy, state_of, choice: LossChoice::None, source }.row());
    data
}

/// The state that a person has chosen in place of lost data; none if it is no longer whole. It is a loss, too, until it is
/// accepted in its turn. The passwords and the kind of machine stay, the place of an interrupted run goes.
fn chosen_state(folder: &Path, choice: &str, present: &RetainedData) -> Option<RetainedData> {
    let (time, mut chosen) = match choice {
        FACTORY => (None, RetainedData::default()),
        number => {
            let (time, kept) = generations::find(folder, number.parse().ok()?)?;
            (time.map(state_time), kept)
        }
    };
    [CHOICE, RUNNING_AT].into_iter().for_each(|key| drop(chosen.texts.remove(key)));
    let loss = DataLoss { state_of: time, choice: LossChoice::Made, ..DataLoss::from_row(present.texts.get(LOSS)?) };
    chosen.texts.insert(LOSS.to_owned(), loss.row());
    // The copy lacks a change that was made since the loss.
    PasswordStore::add_copy(folder, &mut chosen);
    chosen.texts.extend(PasswordStore::rows_of(present));
    chosen.texts.extend(present.texts.get(KIND).map(|kind| (KIND.to_owned(), kind.clone())));
    Some(chosen)
}

/// A choice that could not be carried out must not come later, over values that were set since; the alarm says so.
fn disarm(loaded: &mut RetainedData) -> Vec<RetainedChange> {
    if loaded.texts.remove(CHOICE).is_none() {
        return Vec::new();
    }
    let missed = |row: &mut String| {
        *row = DataLoss { choice: LossChoice::Missed, ..DataLoss::from_row(row) }.row();
        text(LOSS, Some(row.clone()))
    };
    loaded.texts.get_mut(LOSS).map(missed).into_iter().chain([text(CHOICE, None)]).collect()
}

/// The states of a kind of machine that may take the place of lost data, the newest first.
fn kept_states(folder: &Path, kind: Kind) -> Vec<KeptState> {
    let is_of_kind = |data: &RetainedData| data.texts.get(KIND).is_none_or(|id| id == kind.id());
    let whole = generations::whole(folder).into_iter().filter(|(_, data)| is_of_kind(data));
    let state = |(time, data): (Option<SystemTime>, RetainedData)| KeptState {
        number: data.generation.0,
        time: time.map(state_time).unwrap_or_default(),
    };
    whole.map(state).collect()
}

/// The time of a kept state. With seconds: a session may keep several within a minute.
fn state_time(time: SystemTime) -> String {
    DateTime::<Local>::from(time).format("%Y-%m-%d %H:%M:%S").to_string()
}

/// Whether two changes are of the same row.
fn is_same_row(one: &RetainedChange, other: &RetainedChange) -> bool {
    use RetainedChange::{Number, Param, Text, Variable};
    match (one, other) {
        (Variable { number: one, .. }, Variable { number: other, .. }) => one == other,
        (Param { key: one, .. }, Param { key: other, .. })
        | (Number { key: one, .. }, Number { key: other, .. })
        | (Text { key: one, .. }, Text { key: other, .. }) => one == other,
        _ => false,
    }
}

fn answered(answer: StorageAnswer) -> Command {
    Command::Page(PageCommand::StorageAnswered(answer))
}

fn unreadable(state: &KeptState) -> LocalizedText {
    LocalizedText::new(
        format!("{} 的数据读不出：请选其他的", state.time),
        format!("the values of {} cannot be read: choose others", state.time),
    )
}

fn text(key: &str, value: Option<String>) -> RetainedChange {
    RetainedChange::Text { key: key.to_owned(), value }
}

/// The database change of a request; `None` for jobs and page requests.
fn to_change(request: &StorageRequest) -> Option<RetainedChange> {
    let number = |key: &str, value: f64| RetainedChange::Number { key: key.into(), value: Some(value) };
    Some(match request {
        StorageRequest::Variable(number, value) => RetainedChange::Variable { number: *number as u16, value: *value },
        StorageRequest::Param(at, value) => RetainedChange::Param { key: at.to_string(), value: Some(*value) },
        StorageRequest::Offset { number, geometry, wear } => {
            let offset = ToolOffset { geometry: *geometry, wear: *wear };
            RetainedChange::Offset { number: *number as u8, offset }
        }
        StorageRequest::CutterRadius(offset, radius_mm) => number(&format!("{CUTTER_RADIUS}{offset}"), *radius_mm),
        StorageRequest::CutterTip(offset, tip) => number(&format!("{CUTTER_TIP}{offset}"), f64::from(*tip)),
        StorageRequest::WorkOffset(place, origin) => {
            RetainedChange::WorkOffset { index: place.stored_index() as u8, origin: *origin }
        }
        StorageRequest::DressPoint(axis, at) => {
            RetainedChange::Number { key: DRESS_POINTS[*axis as usize].into(), value: *at }
        }
        StorageRequest::LeadscrewTable(axis, table) => {
            RetainedChange::Text { key: SCREWS[*axis as usize].into(), value: Some(table.to_text()) }
        }
        StorageRequest::CurrentProgram(program) => number(CURRENT_PROGRAM, f64::from(*program)),
        StorageRequest::Alarm(past) => RetainedChange::Alarm(past.clone()),
        StorageRequest::Part(part) => RetainedChange::Part(*part),
        StorageRequest::Hour(hour) => RetainedChange::Hour(*hour),
        StorageRequest::Order(number, order) => {
            let value = order.and_then(|order| serde_json::to_string(&order).ok());
            RetainedChange::Text { key: format!("{ORDER}{number}"), value }
        }
        StorageRequest::Wheel(number, wheel) => {
            let value = wheel.and_then(|wheel| serde_json::to_string(&wheel).ok());
            RetainedChange::Text { key: format!("{WHEEL}{number}"), value }
        }
        StorageRequest::ClockOffset(seconds) => number(CLOCK_OFFSET, *seconds as f64),
        StorageRequest::WrongPasswords(count) => number(WRONG_PASSWORDS, f64::from(*count)),
        StorageRequest::PartCount(parts) => number(PARTS, f64::from(*parts)),
        StorageRequest::RunningAt(place) => RetainedChange::Text {
            key: RUNNING_AT.into(),
            // One row, so that program and line always belong together.
            value: place.map(|(program, line)| format!("{program} {line}")),
        },
        StorageRequest::PrintLine(..) | StorageRequest::Page(_) | StorageRequest::Job(_) | StorageRequest::Mark(_) => {
            return None;
        }
    })
}

/// Applies one request to data in memory: a control without a data directory starts with them after a power cut.
pub fn apply_request(retained: &mut PowerOnState, request: &StorageRequest) {
    match request {
        StorageRequest::Variable(number, value) => drop(retained.variables.set(*number, *value)),
        StorageRequest::Param(at, value) => drop(retained.params.write(*at, *value)),
        StorageRequest::Offset { number, geometry, wear } => {
            if let Some(index) = number.checked_sub(1).filter(|index| *index < retained.work_offsets.wear.len()) {
                retained.work_offsets.geometry[index] = *geometry;
                retained.work_offsets.wear[index] = *wear;
            }
        }
        StorageRequest::CutterRadius(offset, radius_mm) => {
            let cutter = offset.checked_sub(1).and_then(|index| retained.work_offsets.cutter.get_mut(index));
            cutter.into_iter().for_each(|cutter| cutter.radius_mm = *radius_mm);
        }
        StorageRequest::CutterTip(offset, tip) => {
            let cutter = offset.checked_sub(1).and_then(|index| retained.work_offsets.cutter.get_mut(index));
            cutter.into_iter().for_each(|cutter| cutter.tip = *tip);
        }
        StorageRequest::WorkOffset(place, origin) => retained.work_offsets.set_origin(*place, *origin),
        StorageRequest::DressPoint(axis, at) => retained.dress_points[*axis] = *at,
        StorageRequest::LeadscrewTable(axis, table) => retained.leadscrew_tables[*axis] = table.clone(),
        StorageRequest::CurrentProgram(number) => retained.current_program = *number,
        StorageRequest::Alarm(past) => {
            retained.alarm_history.retain(|other| other.slot() != past.slot());
            retained.alarm_history.push(past.clone());
        }
        StorageRequest::Part(part) => {
            retained.parts.retain(|other| other.slot() != part.slot());
            retained.parts.push(*part);
        }
        StorageRequest::Hour(hour) => {
            retained.hours.retain(|other| other.slot() != hour.slot());
            retained.hours.push(*hour);
        }
        StorageRequest::Order(number, order) => {
            retained.orders.retain(|other| other.number != *number);
            let place = retained.orders.partition_point(|other| other.number < *number);
            drop(retained.orders.splice(place..place, *order));
        }
        StorageRequest::Wheel(number, wheel) => {
            retained.wheels.retain(|other| other.number != *number);
            let place = retained.wheels.partition_point(|other| other.number < *number);
            drop(retained.wheels.splice(place..place, *wheel));
        }
        StorageRequest::ClockOffset(seconds) => retained.clock_offset_s = *seconds,
        StorageRequest::WrongPasswords(count) => retained.wrong_passwords = *count,
        StorageRequest::PartCount(parts) => retained.part_count = *parts,
        StorageRequest::RunningAt(place) => retained.interrupted = *place,
        StorageRequest::PrintLine(..) | StorageRequest::Page(_) | StorageRequest::Job(_) | StorageRequest::Mark(_) => {}
    }
}

/// A stored value that is no longer allowed: what it is, and the change that removes its row.
type DroppedValue = (String, Option<RetainedChange>);

fn retained_from_data(kind: Kind, loaded: &RetainedData) -> (PowerOnState, Vec<DroppedValue>) {
    let mut retained = PowerOnState::factory(kind);
    let mut dropped = Vec::new();
    for (number, value) in &loaded.variables {
        if retained.variables.set(u32::from(*number), Some(*value)).is_err() {
            let remove = RetainedChange::Variable { number: *number, value: None };
            dropped.push((format!("#{number} = {value}"), Some(remove)));
        }
    }
    for (key, value) in &loaded.params {
        let written = ParamAddress::parse(key).map(|at| retained.params.write(at, *value));
        if !matches!(written, Some(Ok(()))) {
            let remove = RetainedChange::Param { key: key.clone(), value: None };
            dropped.push((format!("{key} = {value}"), Some(remove)));
        }
    }
    for (number, offset) in &loaded.offsets {
        let number = usize::from(*number);
        apply_request(&mut retained, &StorageRequest::Offset { number, geometry: offset.geometry, wear: offset.wear });
    }
    for number in 1..=TOOL_OFFSET_COUNT as u32 {
        let [radius, tip] =
            [system_variable::CUTTER_RADIUS, system_variable::CUTTER_TIP].map(|range| range.first + number - 1);
        for (prefix, variable) in [(CUTTER_RADIUS, radius), (CUTTER_TIP, tip)] {
            let key = format!("{prefix}{number}");
            let Some(value) = loaded.numbers.get(&key) else { continue };
            if !matches!(retained.work_offsets.set_cutter_variable(variable, *value), Some(Ok(_))) {
                dropped.push((format!("#{variable} = {value}"), Some(RetainedChange::Number { key, value: None })));
            }
        }
    }
    for (index, origin) in &loaded.work_offsets {
        match OriginPlace::of_stored_index(usize::from(*index)) {
            Some(place) => apply_request(&mut retained, &StorageRequest::WorkOffset(place, *origin)),
            None => dropped.push((format!("work offset {index}"), None)),
        }
    }
    for axis in Axis::ALL {
        let Some(stored) = loaded.texts.get(SCREWS[axis as usize]) else { continue };
        match LeadscrewCompensation::parse(stored) {
            Ok(table) => retained.leadscrew_tables[axis] = table,
            Err(fault) => {
                let key = SCREWS[axis as usize];
                dropped.push((format!("{key}: {fault}"), Some(text(key, None))));
            }
        }
    }
    let number = |key: &str| loaded.numbers.get(key).map_or(0, |value| value.max(0.0) as u32);
    retained.current_program = number(CURRENT_PROGRAM);
    retained.part_count = number(PARTS);
    retained.wrong_passwords = number(WRONG_PASSWORDS);
    retained.alarm_history = loaded.alarms.values().cloned().collect();
    take_production(&mut retained, loaded, &mut dropped);
    retained.clock_offset_s = loaded.numbers.get(CLOCK_OFFSET).map_or(0, |seconds| *seconds as i64);
    let place = loaded.texts.get(RUNNING_AT).and_then(|text| text.split_once(' '));
    retained.interrupted = place.and_then(|(program, line)| Some((program.parse().ok()?, line.parse().ok()?)));
    retained.dress_points = PerAxis::from_fn(|axis| loaded.numbers.get(DRESS_POINTS[axis as usize]).copied());
    (retained, dropped)
}

/// Parts, hours, orders and wheels.
fn take_production(retained: &mut PowerOnState, loaded: &RetainedData, dropped: &mut Vec<DroppedValue>) {
    retained.parts = loaded.parts.values().copied().collect();
    retained.hours = loaded.hours.values().copied().collect();
    for (key, stored) in loaded.texts.iter().filter(|(key, _)| key.starts_with(ORDER)) {
        match serde_json::from_str::<ProductionOrder>(stored) {
            Ok(order) => apply_request(retained, &StorageRequest::Order(order.number, Some(order))),
            Err(fault) => dropped.push((format!("{key}: {fault}"), Some(text(key, None)))),
        }
    }
    for (key, stored) in loaded.texts.iter().filter(|(key, _)| key.starts_with(WHEEL)) {
        match serde_json::from_str::<WheelRecord>(stored) {
            Ok(wheel) => apply_request(retained, &StorageRequest::Wheel(wheel.number, Some(wheel))),
            Err(fault) => dropped.push((format!("{key}: {fault}"), Some(text(key, None)))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b6_the_end_of_a_run_is_kept_and_short_cycles_do_not_write_one_each() {
        let (end, value) = (StorageRequest::RunningAt(None), StorageRequest::PartCount(7));
        let keeps = |requests: &[StorageRequest], s: u64| keeps_generation(requests, Duration::from_secs(s));
        assert!(keeps(&[value.clone(), end.clone()], 60) && !keeps(&[end], 59));
        let value = [value];
        assert!(keeps(&value, 300) && !keeps(&value, 299));
        assert!(!keeps(&[StorageRequest::RunningAt(Some((1_002, 7)))], 60), "a run goes on");
    }
}
