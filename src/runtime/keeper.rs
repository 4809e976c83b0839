//! Maps the core's storage requests to database rows: keys, values, and how they are restored at power-on.
//! Source: spec B3 (retained ranges), notes "acknowledge after commit".

use std::path::Path;

use super::vault::Vault;
use crate::controller::{Effect, Retained};
use crate::defs::kind::Kind;
use crate::defs::param::ParamAddress;
use crate::defs::screw::ScrewTable;
use crate::link::command::Command;
use crate::link::page_command::PageWish;
use crate::store;
use crate::units::{Axis, PerAxis};

const CURRENT_PROGRAM: &str = "current-program";
const PARTS: &str = "parts";
const CLOCK_OFFSET: &str = "clock-offset";
const SCREWS: [&str; 3] = ["screw-x", "screw-y", "screw-z"];
const RUNNING_AT: &str = "running-at";
/// Factor that combines program and line into one number; larger than any line number.
const LINES: f64 = 1e8;
const DRESS_POINTS: [&str; 3] = ["dress-point-x", "dress-point-y", "dress-point-z"];

/// Result of opening the data.
#[derive(Debug)]
pub struct Found {
    /// The data that the control starts with.
    pub retained: Retained,
    /// The data were damaged: path of the copy and cause.
    pub damaged: Option<String>,
    /// Stored values that are no longer allowed; factory values are used instead.
    pub dropped: Vec<String>,
}

/// The store of one control.
pub struct Keeper {
    store: store::Retained,
    vault: Vault,
    /// Changes that the disk has refused; they are written before the next changes.
    owed: Vec<store::Change>,
}

/// Maximum number of unsaved changes; the oldest are dropped first.
const MOST_OWED: usize = 100_000;

impl Keeper {
    /// Opens the data of a directory.
    ///
    /// # Errors
    /// Another control has it open, or the disk reports an error.
    pub fn open(folder: &Path, kind: Kind) -> Result<(Self, Found), store::RetainedError> {
        let mut opened = store::Retained::open(folder)?;
        let loaded = opened.retained.load()?;
        let damaged = opened.damaged.map(|report| format!("{} ({})", report.kept_as.display(), report.cause));
        let (retained, dropped) = restore(kind, &loaded);
        let vault = Vault::new(&loaded, folder.to_path_buf());
        Ok((Self { store: opened.retained, vault, owed: Vec::new() }, Found { retained, damaged, dropped }))
    }

    /// Answers a request of a page.
    pub fn answer(&mut self, wish: &PageWish) -> Command {
        self.vault.answer(wish, Some(&mut self.store))
    }

    /// Stores the core's requests. When it returns, they survive a power cut. Changes that the disk refuses are written
    /// again with the next request.
    ///
    /// # Errors
    /// The disk reports an error.
    pub fn commit(&mut self, effects: &[Effect]) -> Result<u64, store::RetainedError> {
        self.owed.extend(effects.iter().filter_map(change));
        let mut done = self.store.commit(&self.owed);
        if let Err(store::RetainedError::BadChange { .. }) = done {
            // An invalid change is dropped and reported; the others are still written.
            self.owed.retain(store::Retained::takes);
            self.store.commit(&self.owed)?;
            self.owed.clear();
        }
        match &mut done {
            Ok(_) => self.owed.clear(),
            Err(_) => drop(self.owed.drain(..self.owed.len().saturating_sub(MOST_OWED))),
        }
        done.map(|generation| generation.0)
    }
}

/// The database change of an effect; `None` for jobs and page requests.
fn change(effect: &Effect) -> Option<store::Change> {
    Some(match effect {
        Effect::Variable(number, value) => store::Change::Variable { number: *number as u16, value: *value },
        Effect::Param(at, value) => store::Change::Param { key: at.to_string(), value: Some(*value) },
        Effect::Offset { number, geometry, wear } => store::Change::Offset {
            number: *number as u8,
            offset: store::ToolOffset { geometry: *geometry, wear: *wear },
        },
        Effect::Frame(index, origin) => store::Change::Frame { index: *index as u8, origin: *origin },
        Effect::DressPoint(axis, at) => {
            store::Change::Number { key: DRESS_POINTS[*axis as usize].into(), value: Some(*at) }
        }
        Effect::Screw(axis, table) => {
            store::Change::Text { key: SCREWS[*axis as usize].into(), value: Some(table.text()) }
        }
        Effect::CurrentProgram(number) => {
            store::Change::Number { key: CURRENT_PROGRAM.into(), value: Some(f64::from(*number)) }
        }
        Effect::Alarm(past) => store::Change::Alarm(past.clone()),
        Effect::ClockOffset(seconds) => {
            store::Change::Number { key: CLOCK_OFFSET.into(), value: Some(*seconds as f64) }
        }
        Effect::Parts(parts) => store::Change::Number { key: PARTS.into(), value: Some(f64::from(*parts)) },
        Effect::RunningAt(place) => store::Change::Number {
            key: RUNNING_AT.into(),
            // One number, so that program and line always belong together.
            value: place.map(|(program, line)| f64::from(program) * LINES + f64::from(line)),
        },
        Effect::Ask(_) | Effect::Job(_) => return None,
    })
}

/// Applies one request to data in memory: a control without a data directory starts with them after a power cut.
pub fn remember(retained: &mut Retained, effect: &Effect) {
    match effect {
        Effect::Variable(number, value) => drop(retained.variables.set(*number, *value)),
        Effect::Param(at, value) => drop(retained.params.write(*at, *value)),
        Effect::Offset { number, geometry, wear } => {
            if let Some(index) = number.checked_sub(1).filter(|index| *index < retained.frames.wear.len()) {
                retained.frames.geometry[index] = *geometry;
                retained.frames.wear[index] = *wear;
            }
        }
        Effect::Frame(index, origin) => {
            if let Some(frame) = retained.frames.work.get_mut(*index) {
                *frame = *origin;
            }
        }
        Effect::DressPoint(axis, at) => retained.dress_points[*axis] = Some(*at),
        Effect::Screw(axis, table) => retained.screws[*axis] = table.clone(),
        Effect::CurrentProgram(number) => retained.current_program = *number,
        Effect::Alarm(past) => {
            retained.alarms.retain(|other| other.slot() != past.slot());
            retained.alarms.push((**past).clone());
        }
        Effect::ClockOffset(seconds) => retained.clock_offset_s = *seconds,
        Effect::Parts(parts) => retained.parts = *parts,
        Effect::RunningAt(place) => retained.interrupted = *place,
        Effect::Ask(_) | Effect::Job(_) => {}
    }
}

fn restore(kind: Kind, loaded: &store::Loaded) -> (Retained, Vec<String>) {
    let mut retained = Retained::factory(kind);
    let mut dropped = Vec::new();
    for (number, value) in &loaded.variables {
        if retained.variables.set(u32::from(*number), Some(*value)).is_err() {
            dropped.push(format!("#{number} = {value}"));
        }
    }
    for (key, value) in &loaded.params {
        let written = ParamAddress::parse(key).map(|at| retained.params.write(at, *value));
        if !matches!(written, Some(Ok(()))) {
            dropped.push(format!("{key} = {value}"));
        }
    }
    for (number, offset) in &loaded.offsets {
        let number = usize::from(*number);
        remember(&mut retained, &Effect::Offset { number, geometry: offset.geometry, wear: offset.wear });
    }
    for (index, origin) in &loaded.frames {
        remember(&mut retained, &Effect::Frame(usize::from(*index), PerAxis(origin.0)));
    }
    for axis in Axis::ALL {
        let Some(text) = loaded.texts.get(SCREWS[axis as usize]) else { continue };
        match ScrewTable::parse(text) {
            Ok(table) => retained.screws[axis] = table,
            Err(fault) => dropped.push(format!("{}: {fault}", SCREWS[axis as usize])),
        }
    }
    let number = |key: &str| loaded.numbers.get(key).map_or(0, |value| value.max(0.0) as u32);
    retained.current_program = number(CURRENT_PROGRAM);
    retained.parts = number(PARTS);
    retained.alarms = loaded.alarms.values().cloned().collect();
    retained.clock_offset_s = loaded.numbers.get(CLOCK_OFFSET).map_or(0, |seconds| *seconds as i64);
    retained.interrupted = loaded.numbers.get(RUNNING_AT).map(|at| ((at / LINES) as u32, (at % LINES) as u32));
    retained.dress_points = PerAxis::from_fn(|axis| loaded.numbers.get(DRESS_POINTS[axis as usize]).copied());
    (retained, dropped)
}
