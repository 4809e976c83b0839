//! How long a cycle and its phases took.
//! Source: spec K7.2.

use crate::defs::grinding_phase::GrindingPhase;

/// Durations of a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CycleTimes {
    /// The whole cycle, s.
    pub seconds: f64,
    /// Its phases by [`GrindingPhase::index`], s; 0 for a phase that the program has not named.
    pub phases: [f64; GrindingPhase::ALL.len()],
}

impl CycleTimes {
    /// Duration of a phase, s.
    #[must_use]
    pub const fn phase(&self, phase: GrindingPhase) -> f64 {
        self.phases[phase.index()]
    }

    /// Time outside every named phase, s.
    #[must_use]
    pub fn outside_phases(&self) -> f64 {
        (self.seconds - self.phases.iter().sum::<f64>()).max(0.0)
    }
}
