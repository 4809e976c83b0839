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
    pub past: bool,
    /// In-position width at the zero point.
    pub width_mm: f64,
}

/// Back-off speed as a multiple of the slow speed: its end position does not matter.
const BACK_OFF_FACTOR: f64 = 10.0;

/// Maximum travel of the slow stages to leave or reach the switch, mm; a cam is far shorter.
const SLOW_WAY_MM: f64 = 50.0;

/// Maximum ticks at rest at the zero point without being in position.
const SETTLE_TICKS: u32 = 5_000;

/// Longest gap of a bouncing contact, ticks: more than the 5 ms of a switch plus the input filter.
const BOUNCE_TICKS: u32 = 20;

/// Step of the homing sequence of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Begin,
    SeekFast {
        from: f64,
    },
    StopFast,
    /// L6: slowly across the cam.
    Past {
        from: f64,
    },
    /// L6: stopping beyond the far side of the cam.
    StopPast,
    BackOff {
        from: f64,
    },
    StopBackOff,
    SeekSlow {
        from: f64,
    },
    StopSlow {
        edge: f64,
    },
    ToZero {
        stood: u32,
    },
}

/// Why homing failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The switch was not reached or not left within the maximum travel.
    NoSwitch,
    /// The axis is at rest but not at its zero point.
    NoZero,
}

/// Result of one tick of homing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// In progress.
    Going,
    /// The axis is at rest and its zero must be set.
    SetZero {
        /// Machine coordinate of the edge before the zero is set.
        edge: f64,
    },
    /// The axis is at its zero point.
    Done,
    /// Homing failed.
    Failed(Failure),
}

/// The homing of one axis.
#[derive(Clone, Debug)]
pub struct AxisHoming {
    /// The axis.
    pub axis: Axis,
    plan: HomingPlan,
    step: Step,
    /// Position at the first unfiltered edge of the switch; edges shortly after it are bounce.
    edge: Option<f64>,
    /// Ticks for which the switch has been off without interruption.
    quiet: u32,
}

impl AxisHoming {
    /// Begins with the next tick.
    #[must_use]
    pub const fn new(axis: Axis, plan: HomingPlan) -> Self {
        Self { axis, plan, step: Step::Begin, edge: None, quiet: 0 }
    }

    /// Latches the first closing of the contact; bounce after it is ignored. If the switch is off for longer than a
    /// contact can bounce, the edge was a disturbance and is discarded.
    fn note_edge(&mut self, raw: bool, at: f64) {
        if raw {
            self.quiet = 0;
            self.edge.get_or_insert(at);
        } else {
            self.quiet += 1;
            if self.quiet > BOUNCE_TICKS {
                self.edge = None;
            }
        }
    }

    /// The steps for a cam switch (L6): fast approach, slowly off its far side, slowly back onto it.
    fn step_past(&self, mover: &mut AxisMover, switch: bool, at: f64) -> Option<Step> {
        let HomingPlan { direction, slow_mm_s, past, .. } = self.plan;
        match self.step {
            Step::Begin | Step::SeekFast { .. } if switch && past => {
                mover.velocity_target(direction * slow_mm_s);
                Some(Step::Past { from: at })
            }
            Step::Past { .. } if !switch => {
                mover.stop();
                Some(Step::StopPast)
            }
            Step::StopPast if mover.is_at_rest() => {
                mover.velocity_target(-direction * slow_mm_s);
                Some(Step::SeekSlow { from: at })
            }
            _ => None,
        }
    }

    /// Moves to the zero point until the axis is in position there.
    fn settle_at_zero(&mut self, mover: &mut AxisMover, at: f64, stood: u32) -> Progress {
        let HomingPlan { coordinate, slow_mm_s, width_mm, .. } = self.plan;
        mover.position_target(coordinate, slow_mm_s * BACK_OFF_FACTOR);
        let rest = mover.is_at_rest();
        let stood = if rest { stood + 1 } else { 0 };
        self.step = Step::ToZero { stood };
        if rest && (at - coordinate).abs() <= width_mm {
            Progress::Done
        } else if stood > SETTLE_TICKS {
            Progress::Failed(Failure::NoZero)
        } else {
            Progress::Going
        }
    }

    /// One tick. `raw` is the switch before the filter, `at` the axis position from the encoder.
    pub fn tick(&mut self, mover: &mut AxisMover, switch: bool, raw: bool, at: f64) -> Progress {
        let HomingPlan { direction, fast_mm_s, slow_mm_s, travel_mm, past, .. } = self.plan;
        let rest = mover.is_at_rest();
        self.note_edge(raw, at);
        if let Some(step) = self.step_past(mover, switch, at).filter(|_| past) {
            self.step = step;
            return Progress::Going;
        }
        let too_far = |from: f64, most_mm: f64| (at - from).abs() > most_mm;
        self.step = match self.step {
            Step::Begin if switch => {
                mover.velocity_target(-direction * slow_mm_s * BACK_OFF_FACTOR);
                Step::BackOff { from: at }
            }
            Step::Begin => {
                mover.velocity_target(direction * fast_mm_s);
                Step::SeekFast { from: at }
            }
            Step::SeekFast { .. } if switch => {
                mover.stop();
                Step::StopFast
            }
            Step::StopFast if rest => {
                mover.velocity_target(-direction * slow_mm_s * BACK_OFF_FACTOR);
                Step::BackOff { from: at }
            }
            Step::BackOff { .. } if !switch => {
                mover.stop();
                Step::StopBackOff
            }
            Step::StopBackOff if rest => {
                mover.velocity_target(direction * slow_mm_s);
                Step::SeekSlow { from: at }
            }
            Step::SeekSlow { .. } if switch => {
                mover.stop();
                Step::StopSlow { edge: self.edge.unwrap_or(at) }
            }
            Step::StopSlow { edge } if rest => {
                self.step = Step::ToZero { stood: 0 };
                return Progress::SetZero { edge };
            }
            Step::ToZero { stood } => return self.settle_at_zero(mover, at, stood),
            Step::SeekFast { from } | Step::BackOff { from } if too_far(from, travel_mm) => {
                mover.stop();
                return Progress::Failed(Failure::NoSwitch);
            }
            Step::SeekSlow { from } | Step::Past { from } if too_far(from, travel_mm.min(SLOW_WAY_MM)) => {
                mover.stop();
                return Progress::Failed(Failure::NoSwitch);
            }
            step @ (Step::SeekFast { .. }
            | Step::StopFast
            | Step::Past { .. }
            | Step::StopPast
            | Step::BackOff { .. }
            | Step::StopBackOff
            | Step::SeekSlow { .. }
            | Step::StopSlow { .. }) => step,
        };
        Progress::Going
    }
}
