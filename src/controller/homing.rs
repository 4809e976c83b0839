//! Homing of one axis after another: fast to the switch, off it, slowly onto it, zero set, to the zero point.
//! Source: spec B5, K5.16. The position counts in the tick of the edge, before the input filter.

use crate::motion::AxisMover;
use crate::units::Axis;

/// Speeds and places of a homing, mm and mm/s.
#[derive(Clone, Copy, Debug)]
pub struct HomingPlan {
    /// +1 or −1: where the switch is.
    pub direction: f64,
    /// Speed towards the switch.
    pub fast_mm_s: f64,
    /// Speed onto the switch.
    pub slow_mm_s: f64,
    /// Farthest way before it has failed.
    pub travel_mm: f64,
    /// Coordinate of the switch.
    pub coordinate: f64,
    /// In-position width at the zero point.
    pub width_mm: f64,
}

/// Back-off is this many times the slow speed: its place does not matter.
const BACK_OFF_FACTOR: f64 = 10.0;

/// Longest pause of a bouncing contact, ticks: longer than the 5 ms of a switch and the input filter together.
const BOUNCE_TICKS: u32 = 20;

/// Where the sequence of one axis stands.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Begin,
    SeekFast { from: f64 },
    StopFast,
    BackOff { from: f64 },
    StopBackOff,
    SeekSlow { from: f64 },
    StopSlow { edge: f64 },
    ToZero,
}

/// What homing tells the controller in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// Under way.
    Going,
    /// The axis stands; the switch's edge was at this coordinate of today's frame.
    SetZero {
        /// Machine coordinate of the edge before the zero is set.
        edge: f64,
    },
    /// The axis stands at its zero point.
    Done,
    /// No switch within the travel.
    Failed,
}

/// The homing of one axis.
#[derive(Clone, Debug)]
pub struct AxisHoming {
    /// The axis.
    pub axis: Axis,
    plan: HomingPlan,
    step: Step,
    /// Position at the first unfiltered edge of the switch; what follows within a moment is bounce.
    edge: Option<f64>,
    /// Ticks for which the switch has been off without a break.
    quiet: u32,
}

impl AxisHoming {
    /// Begins with the next tick.
    #[must_use]
    pub const fn new(axis: Axis, plan: HomingPlan) -> Self {
        Self { axis, plan, step: Step::Begin, edge: None, quiet: 0 }
    }

    /// The contact closes where it first closes; bouncing after that moves nothing. Off for longer than it can bounce,
    /// an edge was a disturbance and is forgotten.
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

    /// One tick. `raw` is the switch before the filter, `at` the axis position from the encoder.
    pub fn tick(&mut self, mover: &mut AxisMover, switch: bool, raw: bool, at: f64) -> Progress {
        let HomingPlan { direction, fast_mm_s, slow_mm_s, travel_mm, coordinate, width_mm } = self.plan;
        let rest = mover.is_at_rest();
        self.note_edge(raw, at);
        let too_far = |from: f64| (at - from).abs() > travel_mm;
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
                self.step = Step::ToZero;
                return Progress::SetZero { edge };
            }
            Step::ToZero => {
                mover.position_target(coordinate, slow_mm_s * BACK_OFF_FACTOR);
                let there = mover.is_at_rest() && (at - coordinate).abs() <= width_mm;
                return if there { Progress::Done } else { Progress::Going };
            }
            Step::SeekFast { from } | Step::BackOff { from } | Step::SeekSlow { from } if too_far(from) => {
                mover.stop();
                return Progress::Failed;
            }
            step @ (Step::SeekFast { .. }
            | Step::StopFast
            | Step::BackOff { .. }
            | Step::StopBackOff
            | Step::SeekSlow { .. }
            | Step::StopSlow { .. }) => step,
        };
        Progress::Going
    }
}
