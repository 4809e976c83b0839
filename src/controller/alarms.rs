//! The alarms that are present, and which of them RESET may clear.
//! Source: spec B8, K3.7, H7.

use std::sync::Arc;

use crate::defs::alarm::{self, Reaction, ResetRule};
use crate::defs::text::Said;
use crate::link::snapshot::{AlarmView, PastAlarm};
use crate::units::Micros;

/// Most alarms held at once; further ones of other numbers are dropped, the first ones tell the cause.
pub const MOST_ALARMS: usize = 32;
/// Most alarms remembered since power-on; the oldest makes room.
pub const MOST_HISTORY: usize = 200;

/// The list, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Alarms {
    present: Vec<AlarmView>,
    history: Arc<Vec<PastAlarm>>,
    now: Micros,
}

impl Alarms {
    /// The time of this tick: when an alarm goes.
    pub const fn at(&mut self, now: Micros) {
        self.now = now;
    }

    /// Adds an alarm of the table, with a place or detail in front of its remedy where there is one. An alarm that is
    /// already present is not added twice.
    pub fn raise(&mut self, number: u16, detail: Option<Said>, now: Micros, place: Option<(u32, u32)>) {
        if self.has(number) || self.present.len() >= MOST_ALARMS {
            return;
        }
        let (text, remedy) = match alarm::find(number) {
            Some(row) => (row.text.into(), row.remedy.into()),
            None => (Said::new("程序报警", "program alarm"), Said::default()),
        };
        let text = match detail {
            Some(detail) if alarm::find(number).is_some() => {
                Said::new(format!("{}：{}", text.zh, detail.zh), format!("{}: {}", text.en, detail.en))
            }
            Some(detail) => detail,
            None => text,
        };
        let alarm = AlarmView { number, text, remedy, since: now, place };
        self.remember(&alarm);
        self.present.push(alarm);
    }

    /// Writes an alarm into the history; only now, and when one goes, is the list replaced.
    fn remember(&mut self, alarm: &AlarmView) {
        let history = Arc::make_mut(&mut self.history);
        // Looked at again and still there: it never went.
        let same = |past: &&mut PastAlarm| past.gone == Some(alarm.since) && past.alarm.text == alarm.text;
        if let Some(past) = history.last_mut().filter(same) {
            past.gone = None;
            return;
        }
        if history.len() >= MOST_HISTORY {
            history.remove(0);
        }
        history.push(PastAlarm { alarm: Arc::new(alarm.clone()), gone: None });
    }

    /// Notes in the history which alarms are no longer present.
    fn note_gone(&mut self) {
        let present = &self.present;
        let is_gone =
            |past: &PastAlarm| past.gone.is_none() && present.iter().all(|alarm| alarm.number != past.alarm.number);
        if self.history.iter().any(is_gone) {
            let now = self.now;
            let open = Arc::make_mut(&mut self.history).iter_mut().filter(|past| is_gone(past));
            open.for_each(|past| past.gone = Some(now));
        }
    }

    /// Takes away an alarm whose condition is gone.
    pub fn clear(&mut self, number: u16) {
        let before = self.present.len();
        self.present.retain(|alarm| alarm.number != number);
        if self.present.len() != before {
            self.note_gone();
        }
    }

    /// RESET: clears what it may; `still_there` tells which causes are not gone.
    pub fn reset(&mut self, still_there: impl Fn(u16) -> bool) {
        self.present.retain(|alarm| match alarm::reset_rule(alarm.number) {
            ResetRule::Reset => still_there(alarm.number),
            ResetRule::SelfClearing | ResetRule::SelfClearingUnlessStopped => true,
        });
        self.note_gone();
    }

    /// Whether an alarm is present.
    #[must_use]
    pub fn has(&self, number: u16) -> bool {
        self.present.iter().any(|alarm| alarm.number == number)
    }

    /// Whether one of them forbids cycle start.
    #[must_use]
    pub fn block_start(&self) -> bool {
        self.present.iter().any(|alarm| alarm::reaction(alarm.number) >= Reaction::BlockStart)
    }

    /// Those that came since power-on, the latest last.
    #[must_use]
    pub const fn history(&self) -> &Arc<Vec<PastAlarm>> {
        &self.history
    }

    /// All of them, oldest first.
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
        let mut alarms = Alarms::default();
        alarms.raise(alarm::EMERGENCY_STOP, None, Micros::ZERO, None);
        alarms.raise(alarm::TAILSTOCK, None, Micros::ZERO, None);
        alarms.raise(alarm::TAILSTOCK, None, Micros(1), None);
        assert_eq!(alarms.present().len(), 2);
        alarms.reset(|number| number == alarm::EMERGENCY_STOP);
        assert!(alarms.has(alarm::EMERGENCY_STOP) && !alarms.has(alarm::TAILSTOCK) && alarms.block_start());
    }

    #[test]
    fn b6_the_history_keeps_when_each_alarm_came_and_went() {
        let mut alarms = Alarms::default();
        alarms.raise(alarm::TAILSTOCK, None, Micros(5), Some((1_001, 7)));
        let shown = Arc::clone(alarms.history());
        alarms.at(Micros(9));
        alarms.clear(alarm::HYDRAULIC);
        assert!(Arc::ptr_eq(&shown, alarms.history()), "nothing went: the list is not replaced");
        alarms.reset(|_| false);
        alarms.at(Micros(12));
        alarms.raise(alarm::TAILSTOCK, None, Micros(12), None);
        alarms.clear(alarm::TAILSTOCK);
        alarms.raise(alarm::TAILSTOCK, None, Micros(12), None);
        let times: Vec<_> = alarms.history().iter().map(|past| (past.alarm.since, past.gone)).collect();
        assert_eq!(times, [(Micros(5), Some(Micros(9))), (Micros(12), None)]);
        assert_eq!(alarms.history()[0].alarm.place, Some((1_001, 7)));
        for round in 0..300 {
            alarms.clear(alarm::HYDRAULIC);
            alarms.at(Micros(20 + round));
            alarms.raise(alarm::HYDRAULIC, None, Micros(20 + round), None);
        }
        assert_eq!(alarms.history().len(), MOST_HISTORY);
        assert_eq!(alarms.history().last().map(|past| past.alarm.since), Some(Micros(319)));
    }

    #[test]
    fn k3_7_alarm_180_is_not_reset_by_the_list() {
        let mut alarms = Alarms::default();
        alarms.raise(alarm::HYDRAULIC, None, Micros::ZERO, None);
        alarms.reset(|_| false);
        assert!(alarms.has(alarm::HYDRAULIC));
        alarms.clear(alarm::HYDRAULIC);
        assert!(!alarms.block_start());
    }

    #[test]
    fn k7_3_page_files_never_block_a_run() {
        let mut alarms = Alarms::default();
        alarms.raise(alarm::PAGE_FILES, Some(Said::new("B0002.BMP", "B0002.BMP")), Micros::ZERO, None);
        assert!(!alarms.block_start());
        assert!(alarms.present()[0].text.zh.ends_with("B0002.BMP"));
    }
}
