//! The alarms that are present, and which of them RESET may clear.
//! Source: spec B8, K3.7, H7.

use crate::defs::alarm::{self, Reaction, ResetRule};
use crate::defs::text::Said;
use crate::link::snapshot::AlarmView;
use crate::units::Micros;

/// Most alarms held at once; further ones of other numbers are dropped, the first ones tell the cause.
pub const MOST_ALARMS: usize = 32;

/// The list, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Alarms {
    present: Vec<AlarmView>,
}

impl Alarms {
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
        self.present.push(AlarmView { number, text, remedy, since: now, place });
    }

    /// Takes away an alarm whose condition is gone.
    pub fn clear(&mut self, number: u16) {
        self.present.retain(|alarm| alarm.number != number);
    }

    /// RESET: clears what it may; `still_there` tells which causes are not gone.
    pub fn reset(&mut self, still_there: impl Fn(u16) -> bool) {
        self.present.retain(|alarm| match alarm::reset_rule(alarm.number) {
            ResetRule::Reset => still_there(alarm.number),
            ResetRule::SelfClearing | ResetRule::SelfClearingUnlessStopped => true,
        });
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
