//! The active alarms, their history, and which of them RESET may clear.
//! Source: spec B8, K3.7, H7.

use std::sync::Arc;

use crate::defs::alarm::{self, Reaction, ResetRule};
use crate::defs::alarm_history::{AlarmEnd, MAX_ALARM_HISTORY, PastAlarm};
use crate::defs::date::DateTime;
use crate::defs::text::{LocalizedText, phrase};
use crate::link::snapshot::AlarmView;
use crate::units::Micros;

/// Maximum number of active alarms. Further ones are dropped: the first alarms show the cause.
pub const MAX_ALARMS: usize = 32;

/// Maximum characters of an alarm text in the history.
const MAX_TEXT_CHARS: u16 = 200;

/// The active alarms, oldest first, and the alarm history.
#[derive(Clone, Debug, Default)]
pub struct AlarmList {
    present: Vec<AlarmView>,
    history: Arc<Vec<Arc<PastAlarm>>>,
    /// Counts of the history entries changed since they were last stored on disk.
    changed: Vec<u64>,
    /// When an alarm of the history was last cleared.
    last_cleared: Option<Micros>,
    /// Count of the last alarm before power-on.
    last_count_at_power_on: u64,
    now: Micros,
    date: DateTime,
}

impl AlarmList {
    /// Starts from the stored history. Alarms that were active at power-off ended with it.
    #[must_use]
    pub fn new(mut remembered: Vec<PastAlarm>) -> Self {
        remembered.sort_by_key(|past| past.count);
        let ended = |past: PastAlarm| PastAlarm { ended: past.ended.or(Some((AlarmEnd::PowerOff, None))), ..past };
        let last = remembered.last().map_or(0, |past| past.count);
        let history = remembered.into_iter().map(|past| Arc::new(ended(past))).collect();
        Self { history: Arc::new(history), last_count_at_power_on: last, ..Self::default() }
    }

    /// Sets time and date of this tick: the time stamp of alarms that are raised or cleared in it.
    pub const fn set_time(&mut self, now: Micros, date: DateTime) {
        (self.now, self.date) = (now, date);
    }

    /// The date of power-on is now known. Alarms since then were stamped relative to power-on and get their date.
    pub fn set_power_on_date(&mut self, power_on: DateTime) {
        let dated = |date: DateTime| DateTime(date.0 + power_on.0);
        let since = self.last_count_at_power_on;
        for past in Arc::make_mut(&mut self.history).iter_mut().filter(|past| past.count > since) {
            let past = Arc::make_mut(past);
            past.came = dated(past.came);
            past.ended = past.ended.map(|(how, when)| (how, when.map(dated)));
            self.changed.push(past.count);
        }
        self.date = dated(self.date);
    }

    /// Takes the history entries changed since the last call, to be stored on disk.
    pub fn take_changed(&mut self) -> Vec<PastAlarm> {
        let counts = std::mem::take(&mut self.changed);
        self.history.iter().filter(|past| counts.contains(&past.count)).map(|past| (**past).clone()).collect()
    }

    /// Whether history entries wait to be stored.
    #[must_use]
    pub fn has_changed(&self) -> bool {
        !self.changed.is_empty()
    }

    /// Adds an alarm of the table; `detail` follows its text. An alarm that is already active is not added twice.
    pub fn raise(&mut self, number: u16, detail: Option<LocalizedText>, now: Micros, place: Option<(u32, u32)>) {
        if self.has(number) || self.present.len() >= MAX_ALARMS {
            return;
        }
        let (text, remedy) = match alarm::find(number) {
            Some(row) => (row.text.into(), row.remedy.into()),
            None => (phrase!("程序报警", "program alarm"), LocalizedText::default()),
        };
        let text = match detail {
            Some(detail) if alarm::find(number).is_some() => detail.after_alarm(number),
            Some(detail) if !detail.is_blank() => detail,
            Some(_) | None => text,
        };
        let alarm = AlarmView { number, text, remedy, since: now, place };
        self.record(&alarm);
        self.present.push(alarm);
    }

    /// Writes an alarm into the history. The history `Arc` is replaced only here and when an alarm is cleared.
    fn record(&mut self, alarm: &AlarmView) {
        let history = Arc::make_mut(&mut self.history);
        let text = alarm.text.clone().cut(MAX_TEXT_CHARS);
        // Cleared and raised again in the same tick: the alarm was never gone.
        let again = self.last_cleared == Some(alarm.since);
        let same = |past: &&mut Arc<PastAlarm>| {
            let same_text = || text == past.text || alarm.text.zh().starts_with(&*past.text.zh());
            again && past.ended.is_some() && past.number == alarm.number && same_text()
        };
        if let Some(past) = history.last_mut().filter(same) {
            Arc::make_mut(past).ended = None;
            self.changed.push(past.count);
            return;
        }
        if history.len() >= MAX_ALARM_HISTORY {
            history.remove(0);
        }
        let count = history.last().map_or(1, |last| last.count + 1);
        let (number, place) = (alarm.number, alarm.place);
        history.push(Arc::new(PastAlarm { count, number, text, place, came: self.date, ended: None }));
        self.changed.push(count);
    }

    /// Marks the history entries of alarms that are no longer active as ended.
    fn record_cleared(&mut self, how: AlarmEnd) {
        let present = &self.present;
        let is_present = |number| present.iter().any(|alarm| alarm.number == number);
        let is_gone = |past: &PastAlarm| past.ended.is_none() && !is_present(past.number);
        if self.history.iter().any(|past| is_gone(past)) {
            let date = self.date;
            for past in Arc::make_mut(&mut self.history).iter_mut().filter(|past| is_gone(past)) {
                Arc::make_mut(past).ended = Some((how, Some(date)));
                self.changed.push(past.count);
            }
            self.last_cleared = Some(self.now);
        }
    }

    /// Removes an alarm whose condition is gone.
    pub fn clear(&mut self, number: u16) {
        let before = self.present.len();
        self.present.retain(|alarm| alarm.number != number);
        if self.present.len() != before {
            self.record_cleared(AlarmEnd::Itself);
        }
    }

    /// RESET: clears the alarms that it may clear. `still_there` returns whether a cause is still present.
    pub fn reset(&mut self, still_there: impl Fn(u16) -> bool) {
        self.present.retain(|alarm| match alarm::reset_rule(alarm.number) {
            ResetRule::Reset => still_there(alarm.number),
            ResetRule::SelfClearing | ResetRule::SelfClearingUnlessStopped => true,
        });
        self.record_cleared(AlarmEnd::Reset);
    }

    /// Whether an alarm is active.
    #[must_use]
    pub fn has(&self, number: u16) -> bool {
        self.present.iter().any(|alarm| alarm.number == number)
    }

    /// Whether an active alarm blocks cycle start.
    #[must_use]
    pub fn blocks_start(&self) -> bool {
        self.present.iter().any(|alarm| alarm::reaction(alarm.number) >= Reaction::BlockStart)
    }

    /// The alarm history, including alarms before the last power-off, latest last.
    #[must_use]
    pub const fn history(&self) -> &Arc<Vec<Arc<PastAlarm>>> {
        &self.history
    }

    /// All active alarms, oldest first.
    #[must_use]
    pub fn present(&self) -> &[AlarmView] {
        &self.present
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b8_reset_leaves_alarms_whose_cause_is_still_there() {
        let mut alarms = AlarmList::default();
        alarms.raise(alarm::EMERGENCY_STOP, None, Micros::ZERO, None);
        alarms.raise(alarm::TAILSTOCK_INTERLOCK, None, Micros::ZERO, None);
        alarms.raise(alarm::TAILSTOCK_INTERLOCK, None, Micros(1), None);
        assert_eq!(alarms.present().len(), 2);
        alarms.reset(|number| number == alarm::EMERGENCY_STOP);
        assert!(alarms.has(alarm::EMERGENCY_STOP) && !alarms.has(alarm::TAILSTOCK_INTERLOCK) && alarms.blocks_start());
    }

    #[test]
    fn b6_the_history_keeps_when_each_alarm_came_and_went_and_how() {
        let mut alarms = AlarmList::default();
        alarms.set_time(Micros(5), DateTime(105));
        alarms.raise(alarm::TAILSTOCK_INTERLOCK, None, Micros(5), Some((1_001, 7)));
        let shown = Arc::clone(alarms.history());
        alarms.set_time(Micros(9), DateTime(109));
        alarms.clear(alarm::HYDRAULIC_PRESSURE);
        assert!(Arc::ptr_eq(&shown, alarms.history()), "nothing went: the list is not replaced");
        alarms.reset(|_| false);
        alarms.set_time(Micros(12), DateTime(112));
        alarms.raise(alarm::TAILSTOCK_INTERLOCK, None, Micros(12), None);
        alarms.clear(alarm::TAILSTOCK_INTERLOCK);
        alarms.raise(alarm::TAILSTOCK_INTERLOCK, None, Micros(12), None);
        let times: Vec<_> = alarms.history().iter().map(|past| (past.came, past.ended)).collect();
        assert_eq!(times, [(DateTime(105), Some((AlarmEnd::Reset, Some(DateTime(109))))), (DateTime(112), None)]);
        assert_eq!(alarms.history()[0].place, Some((1_001, 7)));
        alarms.set_time(Micros(13), DateTime(113));
        alarms.clear(alarm::TAILSTOCK_INTERLOCK);
        assert_eq!(alarms.history()[1].ended, Some((AlarmEnd::Itself, Some(DateTime(113)))));
        let changed: Vec<_> = alarms.take_changed().iter().map(|past| past.count).collect();
        assert_eq!(changed, [1, 2]);
        assert!(alarms.take_changed().is_empty(), "the disk is told once");
    }

    #[test]
    fn b6_what_came_before_the_clock_was_known_has_its_date() {
        let mut alarms = AlarmList::default();
        alarms.set_time(Micros(2_000_000), DateTime(2));
        alarms.raise(alarm::TAILSTOCK_INTERLOCK, None, Micros(2_000_000), None);
        alarms.clear(alarm::TAILSTOCK_INTERLOCK);
        let mut alarms = AlarmList::new(alarms.take_changed());
        alarms.set_time(Micros(3_000_000), DateTime(3));
        alarms.raise(alarm::HYDRAULIC_PRESSURE, None, Micros(3_000_000), None);
        alarms.set_power_on_date(DateTime(1_000));
        alarms.clear(alarm::HYDRAULIC_PRESSURE);
        let times: Vec<_> = alarms.history().iter().map(|past| (past.came.0, past.ended)).collect();
        // The alarm of the previous power cycle keeps its stamp: its date is unknown.
        assert_eq!(times[0], (2, Some((AlarmEnd::Itself, Some(DateTime(2))))));
        assert_eq!(times[1], (1_003, Some((AlarmEnd::Itself, Some(DateTime(1_003))))));
    }

    #[test]
    fn b6_the_history_outlives_the_power_and_keeps_a_thousand() {
        let mut alarms = AlarmList::default();
        for round in 0..1_200 {
            alarms.set_time(Micros(20 + round), DateTime(round as i64));
            alarms.clear(alarm::HYDRAULIC_PRESSURE);
            alarms.raise(alarm::HYDRAULIC_PRESSURE, None, Micros(20 + round), None);
            alarms.clear(alarm::HYDRAULIC_PRESSURE);
            alarms.set_time(Micros(20 + round) + Micros(1), DateTime(round as i64));
        }
        alarms.raise(alarm::TAILSTOCK_INTERLOCK, None, Micros(5_000), None);
        assert_eq!(alarms.history().len(), MAX_ALARM_HISTORY);
        let slots: std::collections::BTreeSet<_> = alarms.history().iter().map(|past| past.slot()).collect();
        assert_eq!(slots.len(), MAX_ALARM_HISTORY, "each has a place of its own in the store");
        let kept: Vec<_> = alarms.history().iter().map(|past| (**past).clone()).collect();
        let mut alarms = AlarmList::new(kept);
        let last = Arc::clone(&alarms.history()[MAX_ALARM_HISTORY - 1]);
        assert_eq!((last.number, last.ended), (alarm::TAILSTOCK_INTERLOCK, Some((AlarmEnd::PowerOff, None))));
        alarms.raise(alarm::TAILSTOCK_INTERLOCK, None, Micros::ZERO, None);
        assert_eq!(alarms.history().last().map(|past| past.count), Some(last.count + 1));
    }

    #[test]
    fn k3_7_alarm_180_is_not_reset_by_the_list() {
        let mut alarms = AlarmList::default();
        alarms.raise(alarm::HYDRAULIC_PRESSURE, None, Micros::ZERO, None);
        alarms.reset(|_| false);
        assert!(alarms.has(alarm::HYDRAULIC_PRESSURE));
        alarms.clear(alarm::HYDRAULIC_PRESSURE);
        assert!(!alarms.blocks_start());
    }

    #[test]
    fn k7_3_page_files_never_block_a_run() {
        let mut alarms = AlarmList::default();
        alarms.raise(alarm::PAGE_FILES_INVALID, Some(LocalizedText::new("B0002.BMP", "B0002.BMP")), Micros::ZERO, None);
        assert!(!alarms.blocks_start());
        assert!(alarms.present()[0].text.zh().ends_with("B0002.BMP"));
    }
}
