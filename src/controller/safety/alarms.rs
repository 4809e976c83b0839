//! The active alarms, their history, and which of them RESET may clear.
//! Source: spec B8, K3.7, H7.

use crate::defs::alarm::{self, Reaction, ResetRule};
use crate::defs::alarm_history::{AlarmEnd, AlarmHistory, MAX_ALARM_HISTORY, PastAlarm};
use crate::defs::date::DateTime;
use crate::defs::text::{LocalizedText, SharedWords, Text, phrase};
use crate::link::snapshot::AlarmView;
use crate::nc::AlarmHelp;
use crate::units::Micros;

/// Maximum number of active alarms. Further ones are dropped: the first alarms show the cause.
pub const MAX_ALARMS: usize = 32;

/// Maximum characters of an alarm text in the history.
const MAX_TEXT_CHARS: u16 = 200;

/// The text of an alarm.
#[derive(Debug)]
pub enum AlarmWords {
    /// That of the table.
    OfTable,
    /// That of the table and a detail.
    After(LocalizedText),
    /// Another one.
    Instead(Text),
}

impl From<Option<LocalizedText>> for AlarmWords {
    fn from(detail: Option<LocalizedText>) -> Self {
        detail.map_or(Self::OfTable, Self::After)
    }
}

impl From<Option<Text>> for AlarmWords {
    fn from(title: Option<Text>) -> Self {
        title.map_or(Self::OfTable, Self::Instead)
    }
}

/// The active alarms, oldest first, and the alarm history.
#[derive(Debug)]
pub struct AlarmList {
    present: Vec<AlarmView>,
    history: AlarmHistory,
    /// Counts of the history entries changed since they were last stored on disk.
    changed: Vec<u64>,
    /// Counts of the history entries that ended in this tick.
    ended_now: Vec<u64>,
    /// Count of the last alarm before power-on.
    last_count_at_power_on: u64,
    now: Micros,
    date: DateTime,
}

impl AlarmList {
    /// Starts from the stored history at power-on. Alarms that were active at power-off ended with it.
    #[must_use]
    pub fn new(mut remembered: Vec<PastAlarm>, now: Micros) -> Self {
        remembered.sort_by_key(|past| past.count);
        let ended = |past: PastAlarm| PastAlarm { ended: past.ended.or(Some((AlarmEnd::PowerOff, None))), ..past };
        let last = remembered.last().map_or(0, |past| past.count);
        Self {
            present: Vec::with_capacity(MAX_ALARMS),
            history: AlarmHistory::new(remembered.into_iter().map(ended), now.0 + 1),
            changed: Vec::with_capacity(MAX_ALARM_HISTORY),
            ended_now: Vec::with_capacity(MAX_ALARMS),
            last_count_at_power_on: last,
            now,
            date: DateTime::default(),
        }
    }

    /// Sets time and date of this tick: the time stamp of alarms that are raised or cleared in it.
    pub fn set_time(&mut self, now: Micros, date: DateTime) {
        (self.now, self.date) = (now, date);
        self.ended_now.clear();
    }

    /// The date of power-on is now known. Alarms since then were stamped relative to power-on and get their date.
    pub fn set_power_on_date(&mut self, power_on: DateTime) {
        let dated = |date: DateTime| DateTime(date.0 + power_on.0);
        let since = self.last_count_at_power_on;
        for past in self.history.entries_mut().iter_mut().filter(|past| past.count > since) {
            past.came = dated(past.came);
            past.ended = past.ended.map(|(how, when)| (how, when.map(dated)));
            self.changed.push(past.count);
        }
        self.date = dated(self.date);
    }

    /// Takes the history entries changed since the last call, to be stored on disk.
    pub fn take_changed(&mut self, tell: impl FnMut(&PastAlarm)) {
        if !self.changed.is_empty() {
            self.history.iter().filter(|past| self.changed.contains(&past.count)).for_each(tell);
            self.changed.clear();
        }
    }

    /// Adds an alarm of the table. An alarm that is already active is not added twice.
    pub fn raise(&mut self, number: u16, words: impl Into<AlarmWords>, place: Option<(u32, u32)>) {
        if self.has(number) || self.present.len() >= MAX_ALARMS {
            return;
        }
        let (text, cause, remedy) = match alarm::find(number) {
            Some(row) => (row.text.into(), row.cause.into(), row.remedy.into()),
            None if number >= alarm::USER_ALARM_FIRST => {
                (phrase!("程序报警", "program alarm"), LocalizedText::default(), alarm::USER_ALARM_TEXTS.1.into())
            }
            None => (phrase!("程序报警", "program alarm"), LocalizedText::default(), LocalizedText::default()),
        };
        let text = match words.into() {
            AlarmWords::Instead(title) => title.into(),
            AlarmWords::After(detail) if alarm::find(number).is_some() => detail.after_alarm(number),
            AlarmWords::After(detail) if !detail.is_blank() => detail,
            AlarmWords::After(_) | AlarmWords::OfTable => text,
        };
        let alarm = AlarmView { number, text, cause, remedy, variable: None, since: self.now, place };
        self.record(&alarm);
        self.present.push(alarm);
    }

    /// Replaces the detail of an active alarm by one that is known now.
    pub fn complete(&mut self, number: u16, detail: LocalizedText) {
        let text = detail.after_alarm(number);
        let Some(alarm) = self.present.iter_mut().find(|alarm| alarm.number == number) else { return };
        alarm.text = text.clone();
        let entries = self.history.entries_mut();
        if let Some(past) = entries.iter_mut().rev().find(|past| past.number == number && past.ended.is_none()) {
            past.text = text.cut(MAX_TEXT_CHARS);
            self.changed.push(past.count);
        }
    }

    /// Adds to an alarm raised in this tick what its program says of it (B8): the words that it gives, and the variable
    /// whose value is wrong.
    pub fn explain(&mut self, number: u16, help: &AlarmHelp, variable: Option<u16>) {
        let now = self.now;
        let Some(alarm) = self.present.last_mut().filter(|alarm| alarm.number == number && alarm.since == now) else {
            return;
        };
        for (place, words) in [(&mut alarm.cause, &help.cause), (&mut alarm.remedy, &help.remedy)] {
            if !words.is_empty() {
                *place = words.into();
            }
        }
        alarm.variable = variable;
        let entries = self.history.entries_mut();
        if let Some(past) = entries.iter_mut().rev().find(|past| past.number == number && past.ended.is_none()) {
            past.cause.clone_from(&help.cause);
            past.remedy.clone_from(&help.remedy);
        }
    }

    /// Adds cause and remedy to an alarm raised in this tick.
    pub fn complete_words(&mut self, number: u16, cause: LocalizedText, remedy: LocalizedText) {
        let now = self.now;
        if let Some(alarm) = self.present.last_mut().filter(|alarm| alarm.number == number && alarm.since == now) {
            (alarm.cause, alarm.remedy) = (cause, remedy);
        }
    }

    /// Writes an alarm into the history.
    fn record(&mut self, alarm: &AlarmView) {
        let text = alarm.text.clone().cut(MAX_TEXT_CHARS);
        // Cleared and raised again in the same tick: the alarm was never gone.
        let again =
            |past: &PastAlarm| self.ended_now.contains(&past.count) && past.number == alarm.number && past.text == text;
        if let Some(index) = self.history.iter().rposition(again) {
            let past = &mut self.history.entries_mut()[index];
            past.ended = None;
            return self.changed.push(past.count);
        }
        let count = self.history.last().map_or(1, |last| last.count + 1);
        let (number, place) = (alarm.number, alarm.place);
        let (cause, remedy) = (SharedWords::default(), SharedWords::default());
        self.history.push(PastAlarm { count, number, text, cause, remedy, place, came: self.date, ended: None });
        self.changed.push(count);
    }

    /// Marks the history entries of alarms that are no longer active as ended.
    fn record_cleared(&mut self, how: AlarmEnd) {
        let present = &self.present;
        let is_present = |number| present.iter().any(|alarm| alarm.number == number);
        let is_gone = |past: &PastAlarm| past.ended.is_none() && !is_present(past.number);
        if self.history.iter().any(is_gone) {
            let date = self.date;
            for past in self.history.entries_mut().iter_mut().filter(|past| is_gone(past)) {
                past.ended = Some((how, Some(date)));
                self.changed.push(past.count);
                self.ended_now.push(past.count);
            }
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

    /// Whether an active alarm blocks every cycle start.
    #[must_use]
    pub fn blocks_start(&self) -> bool {
        self.has_reaction(Reaction::BlockStart)
    }

    /// Whether an active alarm has this reaction or a graver one.
    #[must_use]
    pub fn has_reaction(&self, least: Reaction) -> bool {
        self.present.iter().any(|alarm| alarm::reaction(alarm.number) >= least)
    }

    /// The alarm history, including alarms before the last power-off, latest last.
    #[must_use]
    pub const fn history(&self) -> &AlarmHistory {
        &self.history
    }

    /// All active alarms, oldest first.
    #[must_use]
    pub fn present(&self) -> &[AlarmView] {
        &self.present
    }
}
