//! Overall equipment effectiveness by ISO 22400-2: availability, effectiveness, quality ratio, and their product.
//! Source: issue "the face", part 8.

use std::ops::Range;

use crate::defs::hour_record::{HourRecord, MachineUse};
use crate::defs::part_record::{PartHistory, PartRecord};

/// Of so many good parts of a program one may be quicker than planned; a single lucky cycle is no plan.
const QUICKER: usize = 10;

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
    /// The ratios of hours (since 1970) whose sum is `sum`, with all parts that are known.
    pub fn of(sum: &HourRecord, hours: Range<u64>, parts: &PartHistory) -> Self {
        let running = f64::from(sum.seconds[MachineUse::Running as usize]);
        let made = sum.good + sum.bad;
        let within = |part: &&PartRecord| HourRecord::hour_of(part.ended).is_some_and(|hour| hours.contains(&hour));
        let of_shift: Vec<&PartRecord> = parts.iter().filter(within).collect();
        // Parts of long ago are counted, but no longer known one by one.
        let known = made > 0 && of_shift.len() >= made as usize;
        let planned = of_shift.iter().map(|part| planned_seconds(part.program, parts)).sum::<Option<f64>>();
        let ratio = |part: f64, whole: f64| (whole > 0.0).then(|| (part / whole).min(1.0));
        Self {
            availability: ratio(running, f64::from(sum.seconds_on())),
            effectiveness: planned.filter(|_| known).and_then(|planned| ratio(planned, running)),
            quality_ratio: ratio(f64::from(sum.good), f64::from(made)),
        }
    }

    /// The product of the three; `None` while one is unknown.
    pub fn index(&self) -> Option<f64> {
        Some(self.availability? * self.effectiveness? * self.quality_ratio?)
    }
}

/// Planned cycle time of a program, s: what its quick good parts took. `None` without a good part.
fn planned_seconds(program: u32, parts: &PartHistory) -> Option<f64> {
    let good = parts.iter().filter(|part| part.program == program && !part.verdict.is_bad());
    let mut cycles: Vec<f64> = good.map(|part| part.cycle_seconds).collect();
    cycles.sort_by(f64::total_cmp);
    cycles.get(cycles.len() / QUICKER).copied()
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
        };
        PartHistory::new(cycles.iter().enumerate().map(part), cycles.len() as u64)
    }

    /// Eight hours on, six of them running.
    const SUM: HourRecord = HourRecord { hour: 100, seconds: [21_600, 3_600, 0, 3_600], good: 10, bad: 1 };

    fn close(found: Option<f64>, wanted: f64) -> bool {
        found.is_some_and(|found| (found - wanted).abs() < 1e-9)
    }

    #[test]
    fn b6_the_index_is_the_product_of_three_ratios() {
        // Of ten good parts the quickest is no plan: 1800 s each, as the others. 11 · 1800 s of 21600 s.
        let mut cycles = [1_800.0; 11];
        cycles[4] = 900.0;
        let found = Oee::of(&SUM, 100..108, &parts(&cycles));
        assert!(close(found.availability, 0.75) && close(found.quality_ratio, 10.0 / 11.0), "{found:?}");
        assert!(close(found.effectiveness, 11.0 * 1_800.0 / 21_600.0), "{found:?}");
        assert!(close(found.index(), 0.75 * (11.0 * 1_800.0 / 21_600.0) * 10.0 / 11.0), "{found:?}");
    }

    #[test]
    fn b6_what_is_unknown_is_no_ratio() {
        // Ten of the eleven parts are known.
        let found = Oee::of(&SUM, 100..108, &parts(&[1_800.0; 10]));
        assert_eq!((found.effectiveness, found.index()), (None, None));
        let found = Oee::of(&HourRecord::default(), 100..108, &parts(&[]));
        assert_eq!(found, Oee { availability: None, effectiveness: None, quality_ratio: None });
        // Without a good part of the program nothing was planned.
        let found = Oee::of(&HourRecord { good: 0, bad: 1, ..SUM }, 100..108, &parts(&[]));
        assert_eq!((found.quality_ratio, found.effectiveness), (Some(0.0), None));
    }
}
