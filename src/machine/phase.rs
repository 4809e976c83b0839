//! The control phase: a state machine driven by start, hold, stop and standstill. It changes in one place only.
//! Source: spec B5, K2.2, K3.14.

/// The control phase. `H` is the state of homing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RunPhase<H = ()> {
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
pub enum PhaseEvent<H = ()> {
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

impl<H> RunPhase<H> {
    /// The phase after an event. Events without meaning in a phase are ignored.
    #[must_use]
    pub fn after(self, event: PhaseEvent<H>) -> Self {
        match (self, event) {
            (Self::Idle | Self::Held | Self::Stopped, PhaseEvent::Start) => Self::Running,
            (Self::Running, PhaseEvent::Hold) => Self::Holding,
            (Self::Running, PhaseEvent::Stop) => Self::Stopped,
            (Self::Holding, PhaseEvent::AtRest) => Self::Held,
            (Self::Running, PhaseEvent::Finish)
            | (Self::Aborting, PhaseEvent::AtRest)
            | (Self::Homing(_), PhaseEvent::Homed) => Self::Idle,
            (Self::Idle | Self::Homing(_), PhaseEvent::Home(what)) => Self::Homing(what),
            (Self::Homing(_), PhaseEvent::Hold) | (_, PhaseEvent::Abort) => Self::Aborting,
            (phase, PhaseEvent::Start | PhaseEvent::Hold | PhaseEvent::AtRest | PhaseEvent::Stop) => phase,
            (phase, PhaseEvent::Finish | PhaseEvent::Home(_) | PhaseEvent::Homed) => phase,
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
    pub const fn without_homing(&self) -> RunPhase {
        match self {
            Self::Idle => RunPhase::Idle,
            Self::Running => RunPhase::Running,
            Self::Holding => RunPhase::Holding,
            Self::Held => RunPhase::Held,
            Self::Stopped => RunPhase::Stopped,
            Self::Aborting => RunPhase::Aborting,
            Self::Homing(_) => RunPhase::Homing(()),
        }
    }
}
