//! What the machine did in each hour: running, waiting, alarm, idle; parts. Source: spec B6.

use super::{Panel, Parts, run_state};
use crate::controller::plant::Plant;
use crate::controller::storage_request::StorageRequest;
use crate::defs::date::DateTime;
use crate::defs::history::HistoryEntry;
use crate::defs::hour_record::{HourHistory, HourRecord, MachineUse};
use crate::link::snapshot::RunState;
use crate::units::Micros;

/// Times are added to their hour so often: each change of the history is copied to the screen.
const FOLD_INTERVAL: Micros = Micros::from_millis(10_000);
/// The hour that goes on is stored so often. A power cut loses as much.
const STORE_INTERVAL: Micros = Micros::from_millis(300_000);

/// The hours of the machine.
#[derive(Default)]
pub struct HourLog {
    hours: HourHistory,
    /// Times that no hour has yet, by [`MachineUse::ALL`].
    pending: [Micros; MachineUse::ALL.len()],
    folded_at: Micros,
    stored_at: Micros,
    /// The hour that goes on.
    hour: Option<u64>,
}

impl HourLog {
    /// As kept since the last power-off.
    pub fn at_power_on(kept: &[HourRecord], now: Micros) -> Self {
        let mut kept = kept.to_vec();
        kept.sort_by_key(|record| record.hour);
        Self { hours: HourHistory::new(kept, now.0 + 1), folded_at: now, stored_at: now, ..Self::default() }
    }

    /// The hours.
    pub const fn history(&self) -> &HourHistory {
        &self.hours
    }

    /// Changes an hour; a new one takes the slot of the one a month before.
    fn change(&mut self, hour: u64, change: impl FnOnce(&mut HourRecord)) -> HourRecord {
        let fresh = HourRecord { hour, ..HourRecord::default() };
        let entries = self.hours.entries_mut();
        if !entries.iter().any(|record| record.hour == hour) {
            entries.retain(|record| record.slot() != fresh.slot());
            let place = entries.partition_point(|record| record.hour < hour);
            entries.insert(place, fresh);
        }
        let record = entries.iter_mut().rev().find(|record| record.hour == hour);
        record.map_or(fresh, |record| {
            change(record);
            *record
        })
    }

    /// The hour that goes on; `None` without a date.
    pub const fn hour(&self) -> Option<u64> {
        self.hour
    }

    /// The hour of a date, if it is known.
    pub fn known_hour(&self, date: DateTime) -> Option<u64> {
        HourRecord::hour_of(date).filter(|hour| self.hours.iter().any(|record| record.hour == *hour))
    }

    /// Changes the count of parts of an hour.
    pub fn count_part(&mut self, plant: &mut Plant, hour: Option<u64>, change: impl FnOnce(&mut HourRecord)) {
        if let Some(hour) = hour {
            let record = self.change(hour, change);
            plant.store(StorageRequest::Hour(record));
        }
    }

    /// One tick of a use. Without a date nothing is counted.
    fn step(&mut self, plant: &mut Plant, date: Option<DateTime>, now_is: MachineUse) {
        let hour = date.and_then(HourRecord::hour_of);
        if hour.is_none() || hour != self.hour {
            self.fold(plant, true);
            self.hour = hour;
        }
        if hour.is_none() {
            return;
        }
        let tick = plant.axes.tick_time();
        self.pending[now_is as usize] = self.pending[now_is as usize] + tick;
        if plant.now.since(self.folded_at) >= FOLD_INTERVAL {
            let store = plant.now.since(self.stored_at) >= STORE_INTERVAL;
            self.fold(plant, store);
        }
    }

    /// Adds whole seconds to the hour; what is less waits.
    fn fold(&mut self, plant: &mut Plant, store: bool) {
        self.folded_at = plant.now;
        let Some(hour) = self.hour else { return };
        let seconds = self.pending.map(|time| (time.0 / 1_000_000) as u32);
        for (time, seconds) in self.pending.iter_mut().zip(seconds) {
            time.0 -= u64::from(seconds) * 1_000_000;
        }
        let record = self.change(hour, |record| {
            record.seconds.iter_mut().zip(seconds).for_each(|(sum, more)| *sum += more);
        });
        if store {
            self.stored_at = plant.now;
            plant.store(StorageRequest::Hour(record));
        }
    }
}

impl Panel {
    /// The control ends: the hour is stored as it is.
    pub fn store_hours(&mut self, plant: &mut Plant) {
        self.production.hours.fold(plant, true);
    }

    /// Counts what the machine does in this tick.
    pub fn follow_hours(&mut self, parts: &mut Parts<'_>) {
        let now_is = match run_state(parts.view()) {
            RunState::Running | RunState::Homing => MachineUse::Running,
            RunState::Held | RunState::Stopped | RunState::Waiting => MachineUse::Waiting,
            RunState::Alarm => MachineUse::Alarm,
            RunState::Idle => MachineUse::Idle,
        };
        let date = self.calendar.date(parts.plant.now);
        self.production.hours.step(parts.plant, date, now_is);
    }
}
