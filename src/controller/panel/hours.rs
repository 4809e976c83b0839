//! What the machine did in each hour: running, waiting, alarm, idle; parts. Source: spec B6.

use super::{Panel, Parts, run_state};
use crate::controller::plant::Plant;
use crate::controller::storage_request::StorageRequest;
use crate::defs::date::DateTime;
use crate::defs::downtime_reason::DowntimeReason;
use crate::defs::history::HistoryEntry;
use crate::defs::hour_record::{HourHistory, HourRecord, MachineUse};
use crate::defs::key::Mode;
use crate::defs::text::Text;
use crate::link::snapshot::RunState;
use crate::units::Micros;

/// Times are added to their hour so often: each change of the history is copied to the screen.
const FOLD_INTERVAL: Micros = Micros::from_millis(10_000);
/// The hour that goes on is stored so often. A power cut loses as much.
const STORE_INTERVAL: Micros = Micros::from_millis(300_000);
/// A reason is given for the stop so far, up to so many hours back.
const LONGEST_EXPLAINED_HOURS: u64 = 24;

const NO_DATE: Text = Text::new("没有日期：不记录停机原因", "no date is known: no reason is recorded");
const RUNS: Text = Text::new("机床在运行：停机原因在停机时给出", "the machine runs: a reason is given while it stands");

/// A stop that goes on.
#[derive(Clone, Copy, Default)]
struct Stop {
    /// The hour in which it began.
    since: u64,
    reason: Option<DowntimeReason>,
    /// How much of it has no reason.
    unexplained: Micros,
}

/// The hours of the machine.
#[derive(Default)]
pub struct HourLog {
    hours: HourHistory,
    /// Times that no hour has yet, by [`MachineUse::ALL`].
    pending: [Micros; MachineUse::ALL.len()],
    /// Times with a reason that no hour has yet, by [`DowntimeReason::ALL`].
    pending_explained: [Micros; DowntimeReason::ALL.len()],
    /// The stop that goes on; none while the machine runs.
    stop: Option<Stop>,
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

    /// One tick of a use. Without a date nothing is counted. `ends_stop`: a program runs by itself.
    fn step(&mut self, plant: &mut Plant, date: Option<DateTime>, (now_is, ends_stop): (MachineUse, bool)) {
        let hour = date.and_then(HourRecord::hour_of);
        if hour.is_none() || hour != self.hour {
            self.fold(plant, true);
            self.hour = hour;
        }
        let Some(hour) = hour else {
            self.stop = None;
            return;
        };
        let tick = plant.axes.tick_time();
        self.pending[now_is as usize] = self.pending[now_is as usize] + tick;
        match (ends_stop, now_is) {
            (true, _) => self.stop = None,
            // A move of the set-up belongs to the stop, and its time to the run.
            (false, MachineUse::Running) => {}
            (false, MachineUse::Waiting | MachineUse::Alarm | MachineUse::Idle) => self.follow_stop(hour, tick),
        }
        if plant.now.since(self.folded_at) >= FOLD_INTERVAL {
            let store = plant.now.since(self.stored_at) >= STORE_INTERVAL;
            self.fold(plant, store);
        }
    }

    fn follow_stop(&mut self, hour: u64, tick: Micros) {
        let stop = self.stop.get_or_insert(Stop { since: hour, ..Stop::default() });
        match stop.reason {
            Some(reason) => {
                let time = &mut self.pending_explained[reason as usize];
                *time = *time + tick;
            }
            None => stop.unexplained = stop.unexplained + tick,
        }
    }

    /// The reason that the operator has given for the stop that goes on.
    pub fn downtime_reason(&self) -> Option<DowntimeReason> {
        self.stop.and_then(|stop| stop.reason)
    }

    /// Gives the stop that goes on a reason, for what of it has none and from now on; or takes the reason away from now on.
    fn explain(&mut self, plant: &mut Plant, reason: Option<DowntimeReason>) -> Result<(), Text> {
        let now = self.hour.ok_or(NO_DATE)?;
        let stop = self.stop.as_mut().ok_or(RUNS)?;
        stop.reason = reason;
        let (since, unexplained) = (stop.since, stop.unexplained);
        let Some(reason) = reason else { return Ok(()) };
        stop.unexplained = Micros::ZERO;
        self.fold(plant, true);
        let mut seconds = whole_seconds(unexplained);
        for hour in (since.max(now.saturating_sub(LONGEST_EXPLAINED_HOURS))..=now).rev() {
            let known = self.hours.iter().find(|record| record.hour == hour);
            let here = known.map_or(0, HourRecord::seconds_unexplained).min(seconds);
            if here > 0 {
                let record = self.change(hour, |record| record.explained[reason as usize] += here);
                plant.store(StorageRequest::Hour(record));
            }
            seconds -= here;
        }
        Ok(())
    }

    /// Adds whole seconds to the hour; what is less waits.
    fn fold(&mut self, plant: &mut Plant, store: bool) {
        self.folded_at = plant.now;
        let Some(hour) = self.hour else { return };
        let (seconds, explained) = (self.pending.map(whole_seconds), self.pending_explained.map(whole_seconds));
        let times = self.pending.iter_mut().zip(seconds).chain(self.pending_explained.iter_mut().zip(explained));
        times.for_each(|(time, seconds)| time.0 -= u64::from(seconds) * 1_000_000);
        let record = self.change(hour, |record| {
            record.add(&HourRecord { seconds, ..HourRecord::default() });
            // Fractions of seconds wait by use and by reason: an hour never has more reasons than it stood.
            for (index, more) in explained.into_iter().enumerate() {
                record.explained[index] += more.min(record.seconds_unexplained());
            }
        });
        if store {
            self.stored_at = plant.now;
            plant.store(StorageRequest::Hour(record));
        }
    }
}

/// The whole seconds of a time.
const fn whole_seconds(time: Micros) -> u32 {
    (time.0 / 1_000_000) as u32
}

impl Panel {
    /// The operator says why the machine stands.
    pub fn set_downtime_reason(&mut self, parts: &mut Parts<'_>, reason: Option<DowntimeReason>) {
        if let Err(why) = self.production.hours.explain(parts.plant, reason) {
            parts.plant.refuse(why);
        }
    }

    /// The control ends: the hour is stored as it is.
    pub fn store_hours(&mut self, plant: &mut Plant) {
        self.production.hours.fold(plant, true);
    }

    /// Counts what the machine does in this tick.
    pub fn follow_hours(&mut self, parts: &mut Parts<'_>) {
        let state = run_state(parts.view());
        let ends_stop = state == RunState::Running && parts.plant.operator.mode == Mode::Auto;
        let now_is = match state {
            RunState::Running | RunState::Homing => MachineUse::Running,
            RunState::Held | RunState::Stopped | RunState::Waiting => MachineUse::Waiting,
            RunState::Alarm => MachineUse::Alarm,
            RunState::Idle => MachineUse::Idle,
        };
        let date = self.calendar.date(parts.plant.now);
        self.production.hours.step(parts.plant, date, (now_is, ends_stop));
    }
}
