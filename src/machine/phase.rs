//! The control phase: a state machine driven by start, hold, stop and standstill. It changes in one place only.
//! Source: spec B5, K2.2, K3.14.

/// The control phase. `H` is the state of homing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Phase<H = ()> {
    /// Nothing runs.
    #[default]
    Idle,
    /// A program or an MDI line runs.
    Running,
    /// Feed hold, still braking.
    Holding,
    /// Feed hold, at rest.
    Held,
    /// Stopped by M00, M01, a message or single block; waits for cycle start.
    Stopped,
    /// Reset or an alarm: braking, then the run ends.
    Aborting,
    /// Axes are homing.
    Homing(H),
}

/// An event that may change the phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event<H = ()> {
    /// Cycle start, granted by the interlocks.
    Start,
    /// Feed hold, by key or by an alarm.
    Hold,
    /// The axes have come to rest.
    AtRest,
    /// The program waits for cycle start.
    Stop,
    /// The program is over.
    Finish,
    /// Reset or an alarm that ends the run.
    Abort,
    /// Homing, granted by the interlocks, or its next axis.
    Home(H),
    /// The last axis is homed.
    Homed,
}

impl<H> Phase<H> {
    /// The phase after an event. Events without meaning in a phase are ignored.
    #[must_use]
    pub fn after(self, event: Event<H>) -> Self {
        match (self, event) {
            (Self::Idle | Self::Held | Self::Stopped, Event::Start) => Self::Running,
            (Self::Running, Event::Hold) => Self::Holding,
            (Self::Running, Event::Stop) => Self::Stopped,
            (Self::Holding, Event::AtRest) => Self::Held,
            (Self::Running, Event::Finish) | (Self::Aborting, Event::AtRest) | (Self::Homing(_), Event::Homed) => {
                Self::Idle
            }
            (Self::Idle | Self::Homing(_), Event::Home(what)) => Self::Homing(what),
            (Self::Homing(_), Event::Hold) | (_, Event::Abort) => Self::Aborting,
            (
                phase,
                Event::Start
                | Event::Hold
                | Event::AtRest
                | Event::Stop
                | Event::Finish
                | Event::Home(_)
                | Event::Homed,
            ) => phase,
        }
    }

    /// The program moves the machine, or an aborted run brakes: only the keys of K2.2 act. A feed hold counts as a
    /// pause from its first tick.
    #[must_use]
    pub const fn is_automatic(&self) -> bool {
        matches!(self, Self::Running | Self::Aborting)
    }

    /// A run is open and waits for cycle start.
    #[must_use]
    pub const fn is_pause(&self) -> bool {
        matches!(self, Self::Held | Self::Stopped)
    }

    /// Axes are homing.
    #[must_use]
    pub const fn is_homing(&self) -> bool {
        matches!(self, Self::Homing(_))
    }

    /// A program or an MDI line has begun and is not over.
    #[must_use]
    pub const fn is_run_open(&self) -> bool {
        matches!(self, Self::Running | Self::Holding | Self::Held | Self::Stopped | Self::Aborting)
    }

    /// The phase without the homing state.
    #[must_use]
    pub const fn bare(&self) -> Phase {
        match self {
            Self::Idle => Phase::Idle,
            Self::Running => Phase::Running,
            Self::Holding => Phase::Holding,
            Self::Held => Phase::Held,
            Self::Stopped => Phase::Stopped,
            Self::Aborting => Phase::Aborting,
            Self::Homing(_) => Phase::Homing(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(phase: Phase, event: Event, expected: Phase) {
        assert_eq!(phase.after(event), expected, "{phase:?} after {event:?}");
    }

    #[test]
    fn b5_a_run_is_held_resumed_stopped_and_left() {
        check(Phase::Idle, Event::Start, Phase::Running);
        check(Phase::Running, Event::Hold, Phase::Holding);
        check(Phase::Holding, Event::AtRest, Phase::Held);
        check(Phase::Held, Event::Start, Phase::Running);
        check(Phase::Running, Event::Stop, Phase::Stopped);
        check(Phase::Stopped, Event::Start, Phase::Running);
        check(Phase::Held, Event::Abort, Phase::Aborting);
        check(Phase::Aborting, Event::AtRest, Phase::Idle);
        check(Phase::Running, Event::Finish, Phase::Idle);
    }

    #[test]
    fn b5_what_means_nothing_changes_nothing() {
        check(Phase::Holding, Event::Start, Phase::Holding);
        check(Phase::Aborting, Event::Start, Phase::Aborting);
        check(Phase::Homing(()), Event::Start, Phase::Homing(()));
        check(Phase::Running, Event::Home(()), Phase::Running);
        check(Phase::Held, Event::Home(()), Phase::Held);
        check(Phase::Idle, Event::Hold, Phase::Idle);
        check(Phase::Homing(()), Event::Hold, Phase::Aborting);
    }
}
