//! Overall equipment effectiveness by ISO 22400-2: availability, effectiveness, quality ratio, and their product.
//! Source: issue "the face", part 8.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::defs::hour_record::{HourRecord, MachineUse};
use crate::defs::part_record::{MAX_PART_RECORDS, PartHistory, PartRecord};

/// Of so many good parts of a kind one may be quicker than planned; a single lucky cycle is no plan.
const QUICKER: usize = 10;

/// What makes parts of the same kind: program, order, nominal size.
type PartKind = (u32, u32, Option<u64>);

/// The planned cycle times: of each kind of part what its quick good ones took, s.
pub struct PlannedCycles(BTreeMap<PartKind, f64>);

impl PlannedCycles {
    /// Those of all parts that are known.
    pub fn of(parts: &PartHistory) -> Self {
        let mut cycles: BTreeMap<PartKind, Vec<f64>> = BTreeMap::new();
        for part in parts.iter().filter(|part| !part.verdict.is_bad()) {
            cycles.entry(kind_of(part)).or_default().push(part.cycle_seconds);
        }
        let planned = |mut cycles: Vec<f64>| {
            cycles.sort_by(f64::total_cmp);
            cycles.get(cycles.len() / QUICKER).copied()
        };
        Self(cycles.into_iter().filter_map(|(kind, cycles)| Some((kind, planned(cycles)?))).collect())
    }
}

fn kind_of(part: &PartRecord) -> PartKind {
    (part.program, part.order, part.limits.map(|[nominal, ..]| nominal.to_bits()))
}

/// The three ratios of a shift, each 0 to 1; `None` where nothing is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oee {
    /// Time in which a program ran, of the time in which the machine was on.
    pub availability: Option<f64>,
    /// Planned time of the parts made, of the time in which a program ran.
    pub effectiveness: Option<f64>,
    /// Good parts of all.
    pub quality_ratio: Option<f64>,
}

impl Oee {
    /// The ratios of hours (since 1970) whose sum is `sum`, with all parts that are known and their planned cycles.
    pub fn of(sum: &HourRecord, hours: Range<u64>, parts: &PartHistory, plan: &PlannedCycles) -> Self {
        let running = f64::from(sum.seconds[MachineUse::Running as usize]);
        let made = f64::from(sum.good + sum.bad);
        let hour_of = |part: &PartRecord| HourRecord::hour_of(part.ended);
        let of_shift = parts.iter().filter(|part| hour_of(part).is_some_and(|hour| hours.contains(&hour)));
        // Parts of long ago are counted, but no longer known one by one.
        let oldest = parts.iter().next().and_then(hour_of);
        let known = parts.iter().count() < MAX_PART_RECORDS || oldest.is_some_and(|oldest| oldest < hours.start);
        let planned: Vec<f64> = of_shift.filter_map(|part| plan.0.get(&kind_of(part)).copied()).collect();
        // A part that ends with the shift may be counted in one hour and recorded in the next: the mean is not hurt.
        let mean = planned.iter().sum::<f64>() / planned.len().max(1) as f64;
        let ratio = |part: f64, whole: f64| (whole > 0.0).then(|| (part / whole).min(1.0));
        Self {
            availability: ratio(running, f64::from(sum.seconds_on())),
            effectiveness: ratio(mean * made, running).filter(|_| known && !planned.is_empty()),
            quality_ratio: ratio(f64::from(sum.good), made),
        }
    }

    /// The product of the three; `None` while one is unknown, 0 without a good part.
    pub fn index(&self) -> Option<f64> {
        match self.quality_ratio {
            Some(0.0) => Some(0.0),
            quality => Some(self.availability? * self.effectiveness? * quality?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::date::DateTime;
    use crate::defs::part_verdict::PartVerdict;

    /// Parts of O1002 that end every half an hour from hour 100 on; the second one is scrap.
    fn parts(cycles: &[f64]) -> PartHistory {
        let part = |(number, cycle): (usize, &f64)| PartRecord {
            count: number as u64 + 1,
            number: number as u32 + 1,
            program: 1_002,
            order: 0,
            ended: DateTime(100 * 3_600 + 1_800 * number as i64),
            cycle_seconds: *cycle,
            size: None,
            limits: None,
            verdict: if number == 1 { PartVerdict::Out { partly: false } } else { PartVerdict::Good },
            since_dressing: 0,
            wheel_mm: None,
            alarms: [0; 4],
        };
        PartHistory::new(cycles.iter().enumerate().map(part), cycles.len() as u64)
    }

    /// Eight hours on, six of them running.
    const SUM: HourRecord =
        HourRecord { hour: 100, seconds: [21_600, 3_600, 0, 3_600], explained: [0; 6], good: 10, bad: 1 };

    fn close(found: Option<f64>, wanted: f64) -> bool {
        found.is_some_and(|found| (found - wanted).abs() < 1e-9)
    }

    fn oee(sum: &HourRecord, parts: &PartHistory) -> Oee {
        Oee::of(sum, 100..108, parts, &PlannedCycles::of(parts))
    }

    #[test]
    fn b6_the_index_is_the_product_of_three_ratios() {
        // Of ten good parts the quickest is no plan: 1800 s each, as the others. 11 · 1800 s of 21600 s.
        let mut cycles = [1_800.0; 11];
        cycles[4] = 900.0;
        let found = oee(&SUM, &parts(&cycles));
        assert!(close(found.availability, 0.75) && close(found.quality_ratio, 10.0 / 11.0), "{found:?}");
        assert!(close(found.effectiveness, 11.0 * 1_800.0 / 21_600.0), "{found:?}");
        assert!(close(found.index(), 0.75 * (11.0 * 1_800.0 / 21_600.0) * 10.0 / 11.0), "{found:?}");
        // One of them was recorded a second behind the shift.
        let found = oee(&SUM, &parts(&[1_800.0; 10]));
        assert!(close(found.effectiveness, 11.0 * 1_800.0 / 21_600.0), "{found:?}");
    }

    #[test]
    fn b6_other_parts_of_the_program_are_no_plan() {
        let quick = |part: &PartRecord| PartRecord { order: 7, cycle_seconds: 60.0, ended: DateTime(0), ..*part };
        let slow = parts(&[1_800.0; 11]);
        let all: Vec<PartRecord> = slow.iter().map(quick).chain(slow.iter().copied()).collect();
        let found = oee(&SUM, &PartHistory::new(all, 22));
        assert!(close(found.effectiveness, 11.0 * 1_800.0 / 21_600.0), "{found:?}");
    }

    #[test]
    fn b6_what_is_unknown_is_no_ratio() {
        let nothing = parts(&[]);
        assert_eq!((oee(&SUM, &nothing).effectiveness, oee(&SUM, &nothing).index()), (None, None));
        let found = oee(&HourRecord::default(), &nothing);
        assert_eq!(found, Oee { availability: None, effectiveness: None, quality_ratio: None });
        // The history is full and begins in the shift: nobody knows what came before.
        let full = parts(&vec![1.0; MAX_PART_RECORDS]);
        assert_eq!(oee(&SUM, &full).effectiveness, None);
        // Scrap alone is no output, whatever it took.
        let found = oee(&HourRecord { good: 0, bad: 1, ..SUM }, &nothing);
        assert_eq!((found.quality_ratio, found.effectiveness, found.index()), (Some(0.0), None, Some(0.0)));
    }
}
