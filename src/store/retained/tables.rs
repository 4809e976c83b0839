//! The database tables and the checksum over their rows.
//!
//! Every row has a checksum over table, key and value. The `meta` table holds their sum and is updated with each
//! change: the cost of a commit depends on its changes only, and opening detects lost or altered rows.

use std::collections::BTreeMap;
use std::num::NonZeroU64;

use redb::{Database, ReadTransaction, ReadableDatabase, ReadableTable, TableDefinition, TableError, WriteTransaction};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Generation, RetainedChange, RetainedData, RetainedError, ToolOffset};
use crate::defs::history::HistoryEntry;
use crate::store::checksum::Checksum;
use crate::units::PerAxis;

/// The current format of the tables.
pub(super) const FORMAT: u64 = 2;
/// The oldest supported format: without alarms.
pub(super) const OLDEST_FORMAT: u64 = 1;
/// Maximum length of a key, bytes.
const KEY_LIMIT: usize = 64;
/// Maximum length of a text, bytes.
const TEXT_LIMIT: usize = 4096;
/// Tool offsets 1 to 16.
const LAST_OFFSET: u8 = 16;
/// Number of work offsets: G54 to G59, G54.1 P1 to P48, the external one.
const WORK_OFFSET_COUNT: u8 = 55;

const META: TableDefinition<&str, u64> = TableDefinition::new("meta");
const VARIABLES: TableDefinition<u16, f64> = TableDefinition::new("variables");
const PARAMS: TableDefinition<&str, f64> = TableDefinition::new("params");
const OFFSETS: TableDefinition<u8, [f64; 6]> = TableDefinition::new("tool_offsets");
const WORK_OFFSETS: TableDefinition<u8, [f64; 3]> = TableDefinition::new("work_frames");
const NUMBERS: TableDefinition<&str, f64> = TableDefinition::new("numbers");
const TEXTS: TableDefinition<&str, &str> = TableDefinition::new("texts");

const ALARMS: TableDefinition<u16, &str> = TableDefinition::new("alarms");
const PARTS: TableDefinition<u16, &str> = TableDefinition::new("parts");
const HOURS: TableDefinition<u16, &str> = TableDefinition::new("hours");

const META_FORMAT: &str = "kt830 retained format";
const META_GENERATION: &str = "generation";
const META_ROWS: &str = "rows";
/// Checksum over parts and hours. It stands apart, so that a control that knows none of them can still read the rest.
const META_PRODUCTION: &str = "production rows";
const META_IDENTITY: &str = "identity";

/// An error of the database.
#[derive(Debug, thiserror::Error)]
#[error("retained data: {0}")]
pub struct StorageFault(Box<redb::Error>);

impl<E: Into<redb::Error>> From<E> for StorageFault {
    fn from(fault: E) -> Self {
        Self(Box::new(fault.into()))
    }
}

/// All data of the database, with format and checksums.
pub(super) struct DatabaseContent {
    pub(super) data: RetainedData,
    pub(super) format: u64,
    /// The checksum over the rows, as stored by the last commit.
    pub(super) stored_sum: u64,
    /// The checksum computed from the rows.
    pub(super) computed_sum: u64,
}

/// Refuses invalid values, so that they cannot be restored after a power cut.
pub(super) fn check_change(change: &RetainedChange) -> Result<(), RetainedError> {
    let finite = |value: &Option<f64>| value.is_none_or(f64::is_finite);
    let keyed = |key: &String| !key.is_empty() && key.len() <= KEY_LIMIT;
    let all_finite = |values: &PerAxis<f64>| values.0.iter().all(|value| value.is_finite());
    let (good_key, good_value) = match change {
        RetainedChange::Variable { value, .. } => (true, finite(value)),
        RetainedChange::Param { key, value } | RetainedChange::Number { key, value } => (keyed(key), finite(value)),
        RetainedChange::Offset { number, offset } => {
            ((1..=LAST_OFFSET).contains(number), all_finite(&offset.geometry) && all_finite(&offset.wear))
        }
        RetainedChange::WorkOffset { index, origin } => (*index < WORK_OFFSET_COUNT, all_finite(origin)),
        RetainedChange::Alarm(past) => (true, entry_text(past).is_some_and(|text| text.len() <= TEXT_LIMIT)),
        RetainedChange::Part(part) => {
            let values = part.size.into_iter().chain(part.limits.into_iter().flatten()).chain([part.cycle_seconds]);
            (true, values.into_iter().all(f64::is_finite))
        }
        RetainedChange::Hour(_) => (true, true),
        RetainedChange::Text { key, value } => (keyed(key), value.as_ref().is_none_or(|text| text.len() <= TEXT_LIMIT)),
    };
    let refused = |cause| Err(RetainedError::BadChange(change_name(change), cause));
    match (good_key, good_value) {
        (true, true) => Ok(()),
        (false, _) => refused("its number or name is out of range"),
        (true, false) => refused("its value is not finite, or too long"),
    }
}

/// The name of the changed item, without its value.
fn change_name(change: &RetainedChange) -> String {
    match change {
        RetainedChange::Variable { number, .. } => format!("#{number}"),
        RetainedChange::Param { key, .. } | RetainedChange::Number { key, .. } => key.clone(),
        RetainedChange::Text { key, .. } => key.clone(),
        RetainedChange::Offset { number, .. } => format!("offset {number}"),
        RetainedChange::WorkOffset { index, .. } => format!("frame {index}"),
        RetainedChange::Alarm(past) => format!("alarm record {}", past.slot()),
        RetainedChange::Part(part) => format!("part record {}", part.slot()),
        RetainedChange::Hour(hour) => format!("hour {}", hour.slot()),
    }
}

/// Begins a commit. In two phases the newest commit is marked valid only when it is whole on the disk: one that cannot be
/// read later is damage. In one phase it is taken for an interrupted one, and the commit before returns without a word.
fn begin_commit(database: &Database) -> Result<WriteTransaction, StorageFault> {
    let mut transaction = database.begin_write()?;
    transaction.set_two_phase_commit(true);
    Ok(transaction)
}

/// Creates the empty tables and writes the format.
pub(super) fn create_tables(database: &Database) -> Result<(), StorageFault> {
    let transaction = begin_commit(database)?;
    {
        let mut meta = transaction.open_table(META)?;
        for (key, value) in [(META_FORMAT, FORMAT), (META_GENERATION, 0), (META_ROWS, 0)] {
            meta.insert(key, value)?;
        }
        transaction.open_table(VARIABLES)?;
        transaction.open_table(PARAMS)?;
        transaction.open_table(OFFSETS)?;
        transaction.open_table(WORK_OFFSETS)?;
        transaction.open_table(NUMBERS)?;
        transaction.open_table(TEXTS)?;
        transaction.open_table(ALARMS)?;
        transaction.open_table(PARTS)?;
        transaction.open_table(HOURS)?;
    }
    Ok(transaction.commit()?)
}

/// Upgrades the tables of an older control to this format, and notes whose data they are.
pub(super) fn upgrade(database: &Database, identity: Option<NonZeroU64>) -> Result<(), StorageFault> {
    let identity = identity.map_or(0, NonZeroU64::get);
    let transaction = database.begin_read()?;
    let meta = transaction.open_table(META)?;
    if meta_value(&meta, META_FORMAT)? == FORMAT && meta_value(&meta, META_IDENTITY)? == identity {
        return Ok(());
    }
    drop((meta, transaction));
    let transaction = begin_commit(database)?;
    transaction.open_table(ALARMS)?;
    for (key, value) in [(META_FORMAT, FORMAT), (META_IDENTITY, identity)] {
        transaction.open_table(META)?.insert(key, value)?;
    }
    Ok(transaction.commit()?)
}

/// Writes all changes in one durable transaction.
pub(super) fn commit_changes(database: &Database, changes: &[RetainedChange]) -> Result<Generation, StorageFault> {
    let transaction = begin_commit(database)?;
    apply_rows(&transaction, changes)?;
    let generation = {
        let mut meta = transaction.open_table(META)?;
        let generation = meta_value(&meta, META_GENERATION)? + 1;
        meta.insert(META_GENERATION, generation)?;
        Generation(generation)
    };
    // Default durability: the data are on the disk when this returns.
    transaction.commit()?;
    Ok(generation)
}

/// Writes all rows of an earlier state with its identity and the number of its commit, in one durable transaction.
pub(super) fn restore(
    database: &Database,
    changes: &[RetainedChange],
    state: &RetainedData,
) -> Result<(), StorageFault> {
    let transaction = begin_commit(database)?;
    apply_rows(&transaction, changes)?;
    {
        let mut meta = transaction.open_table(META)?;
        meta.insert(META_GENERATION, state.generation.0)?;
        meta.insert(META_IDENTITY, state.identity.map_or(0, NonZeroU64::get))?;
    }
    Ok(transaction.commit()?)
}

/// Sets a row, or removes it for `None`; gives the change of the checksum sum. `$sum` is the checksum of a row's value.
macro_rules! set_row {
    ($table:ident, $key:expr, $value:expr, $sum:expr) => {{
        let (value, sum) = ($value, $sum);
        let old = match value {
            Some(value) => $table.insert($key, value)?,
            None => $table.remove($key)?,
        };
        let old = old.map_or(0, |old| sum(old.value()));
        value.map_or(0, sum).wrapping_sub(old)
    }};
}

/// Changes the rows, and the sums of their checksums with them.
fn apply_rows(transaction: &WriteTransaction, changes: &[RetainedChange]) -> Result<(), StorageFault> {
    let moved = set_rows(transaction, changes)?;
    let moved_production = set_production(transaction, changes)?;
    let mut meta = transaction.open_table(META)?;
    for (key, by) in [(META_ROWS, moved), (META_PRODUCTION, moved_production)] {
        let sum = meta_value(&meta, key)?.wrapping_add(by);
        meta.insert(key, sum)?;
    }
    Ok(())
}

/// Changes the rows of production; returns the change of their checksum sum.
fn set_production(transaction: &WriteTransaction, changes: &[RetainedChange]) -> Result<u64, StorageFault> {
    let mut parts = transaction.open_table(PARTS)?;
    let mut hours = transaction.open_table(HOURS)?;
    let mut moved = 0_u64;
    for change in changes {
        let by = match change {
            RetainedChange::Part(part) => {
                let (slot, text) = (part.slot(), entry_text(part).unwrap_or_default());
                set_row!(parts, slot, Some(text.as_str()), |text: &str| entry_checksum(RowTable::Part, slot, text))
            }
            RetainedChange::Hour(hour) => {
                let (slot, text) = (hour.slot(), entry_text(hour).unwrap_or_default());
                set_row!(hours, slot, Some(text.as_str()), |text: &str| entry_checksum(RowTable::Hour, slot, text))
            }
            _ => 0,
        };
        moved = moved.wrapping_add(by);
    }
    Ok(moved)
}

/// Changes the other rows; returns the change of their checksum sum.
fn set_rows(transaction: &WriteTransaction, changes: &[RetainedChange]) -> Result<u64, StorageFault> {
    let mut variables = transaction.open_table(VARIABLES)?;
    let mut params = transaction.open_table(PARAMS)?;
    let mut offsets = transaction.open_table(OFFSETS)?;
    let mut work_offsets = transaction.open_table(WORK_OFFSETS)?;
    let mut numbers = transaction.open_table(NUMBERS)?;
    let mut texts = transaction.open_table(TEXTS)?;
    let mut alarms = transaction.open_table(ALARMS)?;
    let mut moved = 0_u64;
    for change in changes {
        let by = match change {
            RetainedChange::Variable { number, value } => {
                set_row!(variables, *number, *value, |value: f64| variable_checksum(*number, value))
            }
            RetainedChange::Param { key, value } => {
                set_row!(params, key.as_str(), *value, |value: f64| number_checksum(RowTable::Param, key, value))
            }
            RetainedChange::Number { key, value } => {
                set_row!(numbers, key.as_str(), *value, |value: f64| number_checksum(RowTable::Number, key, value))
            }
            RetainedChange::Offset { number, offset } => {
                let row = |values: [f64; 6]| axes_checksum(RowTable::Offset, *number, &values);
                let ([gx, gy, gz], [wx, wy, wz]) = (offset.geometry.0, offset.wear.0);
                set_row!(offsets, *number, Some([gx, gy, gz, wx, wy, wz]), row)
            }
            RetainedChange::WorkOffset { index, origin } => {
                let row = |origin: [f64; 3]| axes_checksum(RowTable::WorkOffset, *index, &origin);
                set_row!(work_offsets, *index, Some(origin.0), row)
            }
            RetainedChange::Text { key, value } => {
                let row = |text: &str| row_checksum(RowTable::Text, key.as_bytes(), text.as_bytes());
                set_row!(texts, key.as_str(), value.as_deref(), row)
            }
            RetainedChange::Alarm(past) => {
                let (slot, text) = (past.slot(), entry_text(past).unwrap_or_default());
                set_row!(alarms, slot, Some(text.as_str()), |text: &str| entry_checksum(RowTable::Alarm, slot, text))
            }
            RetainedChange::Part(_) | RetainedChange::Hour(_) => 0,
        };
        moved = moved.wrapping_add(by);
    }
    Ok(moved)
}

/// Reads all data.
pub(super) fn load(database: &Database) -> Result<DatabaseContent, StorageFault> {
    let transaction = database.begin_read()?;
    let meta = transaction.open_table(META)?;
    let generation = Generation(meta_value(&meta, META_GENERATION)?);
    let identity = NonZeroU64::new(meta_value(&meta, META_IDENTITY)?);
    let mut loaded = RetainedData { identity, generation, ..RetainedData::default() };
    let mut counted = 0_u64;
    for row in transaction.open_table(VARIABLES)?.iter()? {
        let (number, value) = row?;
        counted = counted.wrapping_add(variable_checksum(number.value(), value.value()));
        loaded.variables.insert(number.value(), value.value());
    }
    for (table, of, into) in
        [(PARAMS, RowTable::Param, &mut loaded.params), (NUMBERS, RowTable::Number, &mut loaded.numbers)]
    {
        for row in transaction.open_table(table)?.iter()? {
            let (key, value) = row?;
            counted = counted.wrapping_add(number_checksum(of, key.value(), value.value()));
            into.insert(key.value().to_owned(), value.value());
        }
    }
    for row in transaction.open_table(OFFSETS)?.iter()? {
        let (number, values) = row?;
        let [gx, gy, gz, wx, wy, wz] = values.value();
        counted = counted.wrapping_add(axes_checksum(RowTable::Offset, number.value(), &values.value()));
        let offset = ToolOffset { geometry: PerAxis([gx, gy, gz]), wear: PerAxis([wx, wy, wz]) };
        loaded.offsets.insert(number.value(), offset);
    }
    for row in transaction.open_table(WORK_OFFSETS)?.iter()? {
        let (index, origin) = row?;
        counted = counted.wrapping_add(axes_checksum(RowTable::WorkOffset, index.value(), &origin.value()));
        loaded.work_offsets.insert(index.value(), PerAxis(origin.value()));
    }
    for entry in transaction.open_table(TEXTS)?.iter()? {
        let (key, text) = entry?;
        counted = counted.wrapping_add(row_checksum(RowTable::Text, key.value().as_bytes(), text.value().as_bytes()));
        loaded.texts.insert(key.value().to_owned(), text.value().to_owned());
    }
    let alarms = load_history(&transaction, (ALARMS, RowTable::Alarm), &mut loaded.alarms)?;
    let parts = load_history(&transaction, (PARTS, RowTable::Part), &mut loaded.parts)?;
    let hours = load_history(&transaction, (HOURS, RowTable::Hour), &mut loaded.hours)?;
    counted = counted.wrapping_add(alarms).wrapping_add(parts).wrapping_add(hours);
    let stated = meta_value(&meta, META_ROWS)?.wrapping_add(meta_value(&meta, META_PRODUCTION)?);
    let format = meta_value(&meta, META_FORMAT)?;
    Ok(DatabaseContent { data: loaded, format, stored_sum: stated, computed_sum: counted })
}

/// Reads the entries of a history by their slots; gives the sum of their checksums.
fn load_history<T: DeserializeOwned>(
    transaction: &ReadTransaction,
    (table, of): (TableDefinition<u16, &str>, RowTable),
    into: &mut BTreeMap<u16, T>,
) -> Result<u64, StorageFault> {
    let table = match transaction.open_table(table) {
        Ok(table) => table,
        // An older format has no such table.
        Err(TableError::TableDoesNotExist(_)) => return Ok(0),
        Err(other) => return Err(other.into()),
    };
    let mut counted = 0_u64;
    for entry in table.iter()? {
        let (slot, text) = entry?;
        counted = counted.wrapping_add(entry_checksum(of, slot.value(), text.value()));
        // An entry in a newer text format cannot be shown; this is not damage.
        if let Ok(entry) = serde_json::from_str(text.value()) {
            into.insert(slot.value(), entry);
        }
    }
    Ok(counted)
}

/// A number of the meta table; 0 if it is missing. 0 is not a valid format.
fn meta_value(meta: &impl ReadableTable<&'static str, u64>, key: &str) -> Result<u64, StorageFault> {
    Ok(meta.get(key)?.map_or(0, |value| value.value()))
}

/// The table of a row, as used in the row's checksum; the numbers are part of the file format.
#[derive(Clone, Copy)]
enum RowTable {
    Variable = 1,
    Param = 2,
    Offset = 3,
    WorkOffset = 4,
    Number = 5,
    Text = 6,
    Alarm = 7,
    Part = 8,
    Hour = 9,
}

fn row_checksum(of: RowTable, key: &[u8], value: &[u8]) -> u64 {
    let length = u8::try_from(key.len()).unwrap_or(u8::MAX);
    Checksum::new().add(&[of as u8, length]).add(key).add(value).finish()
}

/// An entry of a history as it is stored.
fn entry_text(entry: &impl Serialize) -> Option<String> {
    serde_json::to_string(entry).ok()
}

fn entry_checksum(of: RowTable, slot: u16, text: &str) -> u64 {
    row_checksum(of, &slot.to_le_bytes(), text.as_bytes())
}

fn variable_checksum(number: u16, value: f64) -> u64 {
    row_checksum(RowTable::Variable, &number.to_le_bytes(), &value.to_le_bytes())
}

fn number_checksum(of: RowTable, key: &str, value: f64) -> u64 {
    row_checksum(of, key.as_bytes(), &value.to_le_bytes())
}

fn axes_checksum(of: RowTable, number: u8, values: &[f64]) -> u64 {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    row_checksum(of, &[number], &bytes)
}
