//! How long a cycle spends in each phase that its program names by `#5828`.
//! Source: spec K7.2.

use crate::defs::grinding_phase::GrindingPhase;
use crate::link::cycle_times::CycleTimes;
use crate::units::Micros;

/// The present phase of a cycle, and the time spent in the ones before.
#[derive(Clone, Copy, Debug, Default)]
pub struct PhaseClock {
    current: Option<(GrindingPhase, Micros)>,
    spent: [f64; GrindingPhase::ALL.len()],
}

impl PhaseClock {
    /// A cycle begins.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Enters a phase, or leaves the present one.
    pub fn enter(&mut self, phase: Option<GrindingPhase>, now: Micros) {
        self.spent = self.spent(now);
        self.current = phase.map(|phase| (phase, now));
    }

    /// The present phase.
    pub fn phase(&self) -> Option<GrindingPhase> {
        self.current.map(|(phase, _)| phase)
    }

    /// The durations of a cycle that has lasted `cycle` until now.
    pub fn times(&self, cycle: Micros, now: Micros) -> CycleTimes {
        CycleTimes { seconds: cycle.as_secs_f64(), phases: self.spent(now) }
    }

    fn spent(&self, now: Micros) -> [f64; GrindingPhase::ALL.len()] {
        let mut spent = self.spent;
        if let Some((phase, since)) = self.current {
            spent[phase.index()] += now.since(since).as_secs_f64();
        }
        spent
    }
}
