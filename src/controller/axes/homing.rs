//! Homing of one axis: fast to the switch, back off, slowly onto it, set zero, move to the zero point.
//! The position is latched in the tick of the unfiltered edge. Source: spec B5, K5.16.

use crate::motion::AxisMover;
use crate::units::Axis;

/// Speeds and positions of a homing cycle, mm and mm/s.
#[derive(Clone, Copy, Debug)]
pub struct HomingPlan {
    /// +1 or −1: direction to the switch.
    pub direction: f64,
    /// Speed towards the switch.
    pub fast_mm_s: f64,
    /// Speed onto the switch.
    pub slow_mm_s: f64,
    /// Maximum travel before homing fails.
    pub travel_mm: f64,
    /// Machine coordinate of the switch.
    pub coordinate: f64,
    /// The switch is a cam: homing passes it and returns onto its far edge at the slow speed (L6).
    pub over_switch: bool,
    /// In-position width at the zero point.
    pub width_mm: f64,
    /// The encoder is absolute: homing is the move to the zero point.
    pub is_absolute: bool,
}

/// Back-off speed as a multiple of the slow speed: its end position does not matter.
const BACK_OFF_FACTOR: f64 = 10.0;

/// Maximum travel of the slow stages to leave or reach the switch, mm; a cam is far shorter.
const MAX_SLOW_TRAVEL_MM: f64 = 50.0;

/// Maximum ticks at rest at the zero point without being in position.
const SETTLE_TICKS: u32 = 5_000;

/// Longest gap of a bouncing contact, ticks: more than the 5 ms of a switch plus the input filter.
const BOUNCE_TICKS: u32 = 20;

/// Step of the homing sequence of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum HomingStep {
    /// Nothing done yet.
    Begin,
    /// Fast to the switch.
    SeekFast { from: f64 },
    /// Stopping on the switch.
    StopFast,
    /// L6: slowly across the cam.
    OverSwitch { from: f64 },
    /// L6: stopping beyond the far side of the cam.
    StopOverSwitch,
    /// Off the switch.
    BackOff { from: f64 },
    /// Stopping off the switch.
    StopBackOff,
    /// Slowly onto the switch.
    SeekSlow { from: f64 },
    /// Stopping; the switch was at `edge`.
    StopSlow { edge: f64 },
    /// To the zero point, at rest there for so many ticks.
    ToZero { stood: u32 },
}

impl HomingStep {
    /// Whether the axis at `at` has gone further than this step may go to reach or leave the switch.
    fn is_too_far(self, at: f64, travel_mm: f64) -> bool {
        let (from, most_mm) = match self {
            Self::SeekFast { from } | Self::BackOff { from } => (from, travel_mm),
            Self::SeekSlow { from } | Self::OverSwitch { from } => (from, travel_mm.min(MAX_SLOW_TRAVEL_MM)),
            Self::Begin | Self::StopFast | Self::StopOverSwitch | Self::StopBackOff => return false,
            Self::StopSlow { .. } | Self::ToZero { .. } => return false,
        };
        (at - from).abs() > most_mm
    }
}

/// Why homing failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomingFailure {
    /// The switch was not reached or not left within the maximum travel.
    NoSwitch,
    /// The axis is at rest but not at its zero point.
    NotAtZero,
    /// By its absolute encoder the axis is further from its zero point than the maximum travel.
    TooFar,
}

/// Result of one tick of homing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HomingProgress {
    /// In progress.
    Running,
    /// The axis is at rest and its zero must be set.
    SetZero {
        /// Machine coordinate of the edge before the zero is set.
        edge: f64,
    },
    /// The axis is at its zero point.
    Done,
    /// Homing failed.
    Failed(HomingFailure),
}

/// The homing of one axis.
#[derive(Clone, Debug)]
pub struct AxisHoming {
    /// The axis.
    pub axis: Axis,
    plan: HomingPlan,
    step: HomingStep,
    /// Position at the first unfiltered edge of the switch; edges shortly after it are bounce.
    latched_edge: Option<f64>,
    /// Ticks for which the switch has been off without interruption.
    ticks_off: u32,
}

impl AxisHoming {
    /// Begins with the next tick.
    #[must_use]
    pub const fn new(axis: Axis, plan: HomingPlan) -> Self {
        let step = if plan.is_absolute { HomingStep::ToZero { stood: 0 } } else { HomingStep::Begin };
        Self { axis, plan, step, latched_edge: None, ticks_off: 0 }
    }

    /// Latches the first closing of the contact; bounce after it is ignored. If the switch is off for longer than a
    /// contact can bounce, the edge was a disturbance and is discarded.
    fn latch_edge(&mut self, raw: bool, at: f64) {
        if raw {
            self.ticks_off = 0;
            self.latched_edge.get_or_insert(at);
        } else {
            self.ticks_off += 1;
            if self.ticks_off > BOUNCE_TICKS {
                self.latched_edge = None;
            }
        }
    }

    /// The steps for a cam switch (L6): fast approach, slowly off its far side, slowly back onto it.
    fn step_over_switch(&self, mover: &mut AxisMover, switch: bool, at: f64) -> Option<HomingStep> {
        let HomingPlan { direction, slow_mm_s, over_switch: past, .. } = self.plan;
        match self.step {
            HomingStep::Begin | HomingStep::SeekFast { .. } if switch && past => {
                mover.set_velocity_target(direction * slow_mm_s);
                Some(HomingStep::OverSwitch { from: at })
            }
            HomingStep::OverSwitch { .. } if !switch => {
                mover.stop();
                Some(HomingStep::StopOverSwitch)
            }
            HomingStep::StopOverSwitch if mover.is_at_rest() => {
                mover.set_velocity_target(-direction * slow_mm_s);
                Some(HomingStep::SeekSlow { from: at })
            }
            _ => None,
        }
    }

    /// Moves to the zero point until the axis is in position there.
    fn settle_at_zero(&mut self, mover: &mut AxisMover, at: f64, stood: u32) -> HomingProgress {
        let HomingPlan { coordinate, fast_mm_s, slow_mm_s, width_mm, travel_mm, is_absolute, .. } = self.plan;
        if is_absolute && (at - coordinate).abs() > travel_mm {
            return HomingProgress::Failed(HomingFailure::TooFar);
        }
        let speed_mm_s = if is_absolute { fast_mm_s } else { slow_mm_s * BACK_OFF_FACTOR };
        mover.set_position_target(coordinate, speed_mm_s);
        let rest = mover.is_at_rest();
        let stood = if rest { stood + 1 } else { 0 };
        self.step = HomingStep::ToZero { stood };
        if rest && (at - coordinate).abs() <= width_mm {
            HomingProgress::Done
        } else if stood > SETTLE_TICKS {
            HomingProgress::Failed(HomingFailure::NotAtZero)
        } else {
            HomingProgress::Running
        }
    }

    /// One tick. `raw` is the switch before the filter, `at` the axis position from the encoder.
    pub fn tick(&mut self, mover: &mut AxisMover, switch: bool, raw: bool, at: f64) -> HomingProgress {
        let HomingPlan { direction, fast_mm_s, slow_mm_s, travel_mm, over_switch: past, .. } = self.plan;
        let rest = mover.is_at_rest();
        self.latch_edge(raw, at);
        if let Some(step) = self.step_over_switch(mover, switch, at).filter(|_| past) {
            self.step = step;
            return HomingProgress::Running;
        }
        self.step = match self.step {
            HomingStep::Begin if switch => {
                mover.set_velocity_target(-direction * slow_mm_s * BACK_OFF_FACTOR);
                HomingStep::BackOff { from: at }
            }
            HomingStep::Begin => {
                mover.set_velocity_target(direction * fast_mm_s);
                HomingStep::SeekFast { from: at }
            }
            HomingStep::SeekFast { .. } if switch => {
                mover.stop();
                HomingStep::StopFast
            }
            HomingStep::StopFast if rest => {
                mover.set_velocity_target(-direction * slow_mm_s * BACK_OFF_FACTOR);
                HomingStep::BackOff { from: at }
            }
            HomingStep::BackOff { .. } if !switch => {
                mover.stop();
                HomingStep::StopBackOff
            }
            HomingStep::StopBackOff if rest => {
                mover.set_velocity_target(direction * slow_mm_s);
                HomingStep::SeekSlow { from: at }
            }
            HomingStep::SeekSlow { .. } if switch => {
                mover.stop();
                HomingStep::StopSlow { edge: self.latched_edge.unwrap_or(at) }
            }
            HomingStep::StopSlow { edge } if rest => {
                self.step = HomingStep::ToZero { stood: 0 };
                return HomingProgress::SetZero { edge };
            }
            HomingStep::ToZero { stood } => return self.settle_at_zero(mover, at, stood),
            step @ (HomingStep::SeekFast { .. }
            | HomingStep::StopFast
            | HomingStep::OverSwitch { .. }
            | HomingStep::StopOverSwitch
            | HomingStep::BackOff { .. }
            | HomingStep::StopBackOff
            | HomingStep::SeekSlow { .. }
            | HomingStep::StopSlow { .. }) => {
                if step.is_too_far(at, travel_mm) {
                    mover.stop();
                    return HomingProgress::Failed(HomingFailure::NoSwitch);
                }
                step
            }
        };
        HomingProgress::Running
    }
}
