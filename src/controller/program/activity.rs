//! What a run is in the middle of, with the data of it.
//! Source: spec B3, B5, K4.5, K6.3.

use super::signal_place::SignalPlace;
use crate::defs::signal::Input;
use crate::nc::GaugeMove;
use crate::units::{Axis, MachinePos, Micros};

/// Status of a queued action after one tick.
pub enum ActionStatus {
    /// Finished.
    Done,
    /// Not finished; called again in the next tick.
    Wait,
    /// Done; the run stops until cycle start.
    Stop,
    /// The run is over.
    EndRun,
}

impl ActionStatus {
    /// Finished, or called again in the next tick.
    #[must_use]
    pub const fn done_if(done: bool) -> Self {
        if done { Self::Done } else { Self::Wait }
    }
}

/// What the executor does with the item at the front of the queue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Activity {
    /// No action in progress.
    Idle,
    /// The axes have been at rest since then, but are not in position yet.
    Settling { since: Micros },
    /// An M code was accepted and its unit has not settled yet.
    AwaitUnit,
    /// G04, with its end.
    Dwell { until: Micros },
    /// M80–M89.
    AwaitInput(Input),
    /// G31: tag of the move, its signal, and where that has come; since when the move is over without it.
    Skip { tag: u32, signal: u8, latched: Option<SignalPlace>, arrived_at: Option<Micros> },
    /// G78.
    Gauge(GaugeCycle),
    /// A thread is being cut.
    Thread,
    /// An axis is homing.
    Homing,
}

/// Whether the moves of the run are handed to the planner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Handover {
    /// Moves go to the planner as they come up.
    Feeding,
    /// Single block was switched on after moves were handed over: the axes stop and the moves are taken back.
    TakingBack,
    /// The axes belong to manual motion.
    Detached(ManualIntervention),
}

/// Stage of a G78 cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GaugeStage {
    /// Fast towards the part.
    Approach,
    /// Back-off from the first contact (single-contact cycle).
    BackOff,
    /// Slowly towards the part again, or on to the second signal (two-contact cycle).
    Fine,
    /// Retract at the end.
    Retract,
    /// M79: the arm goes in.
    ArmIn,
}

/// State of a G78 cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaugeCycle {
    /// The request; its end is a machine coordinate.
    pub request: GaugeMove,
    /// The present stage.
    pub stage: GaugeStage,
    /// Tag of this stage's move, once handed to the planner.
    pub tag: Option<u32>,
    /// Where this stage's contact was.
    pub latched: Option<SignalPlace>,
    /// Since when this stage's move is over without a contact.
    pub arrived_at: Option<Micros>,
    /// Since when the signal is off behind the back-off.
    pub released_at: Option<Micros>,
    /// Work coordinate of the first contact, mm displayed.
    pub first_contact: f64,
    /// The axis has reached the speed J; a second signal counts from then on.
    pub at_fine_speed: bool,
    /// The second signal came before that.
    pub second_too_early: bool,
}

/// State of a manual intervention.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ManualIntervention {
    /// Set-points when it began, machine mm.
    pub start: MachinePos,
    /// The axis that the hold has withdrawn, and the distance, mm.
    pub withdrawn: Option<(Axis, f64)>,
}
