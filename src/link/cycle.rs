//! The running or last cycle: its time, its phase, and the cycle before.
//! Source: spec K7.2, H8.

use super::cycle_times::CycleTimes;
use super::part_result::PartResult;
use crate::defs::grinding_phase::GrindingPhase;

/// The running or last cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CycleView {
    /// Its durations.
    pub times: CycleTimes,
    /// The phase that the running program has named; none between cycles.
    pub phase: Option<GrindingPhase>,
    /// The part that it, or the pass before it (P390), has finished; none from the next cycle start by the operator on.
    pub part: Option<PartResult>,
    /// The last finished cycle of the same program since power-on.
    pub before: Option<CycleTimes>,
}

impl CycleView {
    /// Time that is left by the cycle before, s: of each phase what the cycle before took longer. Dressing and measuring of the
    /// cycle before count only while this one dresses or measures, for not every part is preceded by them. None without a cycle before.
    #[must_use]
    pub fn seconds_left(&self) -> Option<f64> {
        let before = self.before.filter(|before| before.seconds > 0.0)?;
        let is_ahead = |phase: &GrindingPhase| {
            let recurs = !matches!(phase, GrindingPhase::Dressing | GrindingPhase::Measuring);
            recurs || self.phase == Some(*phase)
        };
        let of_phase = |phase: GrindingPhase| (before.phase(phase) - self.times.phase(phase)).max(0.0);
        let outside = (before.outside_phases() - self.times.outside_phases()).max(0.0);
        Some(outside + GrindingPhase::ALL.into_iter().filter(is_ahead).map(of_phase).sum::<f64>())
    }

    /// Whether the phase has a place in the bar: this cycle or the one before has passed through it.
    #[must_use]
    pub fn has_phase(&self, phase: GrindingPhase) -> bool {
        let of_times = |times: &CycleTimes| times.phase(phase) > 0.0;
        self.phase == Some(phase) || of_times(&self.times) || self.before.as_ref().is_some_and(of_times)
    }
}
