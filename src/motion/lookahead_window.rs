//! Look-ahead window: up to about 1.4 s of a run as one smooth curve, from any state of motion to rest.
//!
//! Plans one window in slices of counted work: a first timing along the contour, smoothing inside the tolerance band,
//! the fastest speed along the curve, smoothing and speed again with the better timing, and a check of every set-point
//! against limits and tolerance. In motion, the first control points follow the previous plan in its own time, up to
//! where braking affects it: that part keeps all limits already, and smoothing changes it little. Knows nothing of
//! the queue and of which part of a plan is used. Each plan ends at rest, so its rest can always be followed if the
//! next window is not ready.

mod check;
mod sampling;
mod speed_estimate;
mod timing;

use super::MotionLimits;
use super::feed_scaling::{DifferenceLimits, SetpointHistory};
use super::smoother::{CurveSmoother, FIXED_POINTS, MAX_CONTROL_POINTS};
use super::speed_optimizer::{KnotLimits, SpeedOptimizer};
use super::tolerance_band::ToleranceBand;
use crate::units::WorkBudget;
use check::CheckedPoint;
use speed_estimate::SpeedEstimate;

/// Maximum number of moves in a window.
pub const MAX_WINDOW_MOVES: usize = 640;
/// Maximum number of set-points in a plan.
pub const MAX_PLAN_TICKS: usize = 8_192;
/// Knot spacing as a share of the time of a rounding within the tolerance ([`rounding_time_s`]), and its range, s. With a
/// coarser spacing corners lose time; a finer one needs more work.
const KNOTS_SHARE: f64 = 0.33;
const KNOT_SPACING_RANGE_S: (f64, f64) = (0.001_2, 0.016);
/// Share of the tolerance used for smoothing; the rest is for deviations between knots and unfinished iterations.
const TUBE_SHARE: f64 = 0.95;
/// Share of the tolerance used for planning; the rest is for positions between set-points, used under an override.
const TOLERANCE_SHARE: f64 = 0.98;
/// Smoothing iterations of each round.
const ROUND_ITERATIONS: [u32; 2] = [14, 14];
/// Factor on the knot spacing in the first round.
const FIRST_SPACING_FACTOR: f64 = 1.4;
const LAST_ROUND: usize = ROUND_ITERATIONS.len() - 1;
/// Maximum number of times the tolerance band is narrowed, and smoothing iterations after each time.
const MAX_REPAIRS: u32 = 8;
const REPAIR_ITERATIONS: u32 = 10;
/// Maximum number of retries with a lower share of the limits after the check.
const MAX_SLOWDOWNS: u32 = 3;
/// Share of the limits used for planning: nothing is checked between knots, and a change of rate needs a reserve.
pub const PLAN_LIMIT_SHARE: f64 = 0.98;

/// Further reduction of the acceleration limit where acceleration changes within two knots.
const BETWEEN_KNOTS_MARGIN: f64 = 0.03;
/// Factor on the limits at a start in motion. The previous plan left this reserve, so that a solution exists.
const LEAD_SLACK: f64 = 1.016;
/// Further share of the jerk limit: jerk varies most between knots, and a second plan costs more than it gains.
pub const PLAN_JERK_SHARE: f64 = 0.98;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum WindowPhase {
    Idle,
    EstimateSpeed,
    PlacePoints,
    Smooth { round: usize, left: u32 },
    CheckCurve,
    Speed { round: usize },
    Retime { round: usize },
    CheckPlan,
    Ready,
    Failed,
}

/// Position on the curve of a plan.
#[derive(Clone, Copy, Debug, Default)]
pub struct CurvePosition {
    /// Index of the interval between two knots.
    pub interval: usize,
    /// Fraction of the interval, 0 to 1.
    pub fraction: f64,
}

/// One set-point of a plan.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlanPoint {
    /// Position, mm.
    pub at: [f64; 3],
    /// Velocity, mm/s.
    pub velocity: [f64; 3],
    /// Acceleration, mm/s².
    pub acceleration: [f64; 3],
    /// Distance along the contour, mm.
    pub along: f64,
    /// Index of the move it lies on; all earlier moves have ended.
    pub segment: usize,
}

impl PlanPoint {
    /// A set-point at rest.
    #[must_use]
    pub fn at_rest(at: [f64; 3], along: f64, segment: usize) -> Self {
        Self { at, along, segment, ..Self::default() }
    }

    /// Whether it is not at rest.
    #[must_use]
    pub fn is_in_motion(&self) -> bool {
        self.velocity.iter().chain(&self.acceleration).any(|x| x.abs() > 0.0)
    }
}

/// Start conditions of a window.
#[derive(Clone, Copy, Debug, Default)]
pub struct WindowStart {
    /// The state at the start.
    pub point: PlanPoint,
    /// The set-points up to the start, the newest last.
    pub history: SetpointHistory,
    /// Offset of distance (mm) and move index from the previous tolerance band to this one; subtracted.
    pub shift: (f64, usize),
    /// Share of every limit reserved for a change of rate, 0 to below 1.
    pub reserve: f64,
}

/// Time that a corner's rounding within a tolerance takes with the jerk of the fastest axis, s: a bend over ±T deviates by
/// jerk · T³ / 6.
fn rounding_time_s(limits: &MotionLimits, tolerance_mm: f64) -> f64 {
    let jerk = limits.axes.iter().map(|(_, l)| l.jerk_mm_s3).fold(0.0, f64::max);
    (6.0 * tolerance_mm / jerk).cbrt()
}

/// Knot spacing of a window with a tolerance, s.
pub fn knot_spacing_s(limits: &MotionLimits, tolerance_mm: f64) -> f64 {
    let (least, most) = KNOT_SPACING_RANGE_S;
    (KNOTS_SHARE * rounding_time_s(limits, tolerance_mm)).max(least).min(most)
}

/// How far the curve exceeds tolerance and axis bounds in an interval, mm.
#[derive(Clone, Copy, Debug, Default)]
struct IntervalExcess {
    deviation: f64,
    bounds: [(f64, f64); 3],
}

/// Planning of one window.
#[derive(Clone, Debug)]
pub struct LookaheadWindow {
    limits: MotionLimits,
    steps: DifferenceLimits,
    /// The tolerance band; filled by the caller before `begin`.
    pub band: ToleranceBand,
    start: WindowStart,
    smoother: CurveSmoother,
    speed: SpeedOptimizer,
    new_points: Vec<([f64; 3], f64)>,
    estimate: SpeedEstimate,
    /// Knot spacing of the present points and of the next, s.
    spacing_s: f64,
    next_spacing_s: f64,
    /// Share of the limits that this window is planned with, and the plan in use.
    share: f64,
    adopted_share: f64,
    phase: WindowPhase,
    curve_position: CurvePosition,
    /// First timing: distance along the contour, mm. Retiming: time between new control points, in knot spacings.
    sum: f64,
    cursor: usize,
    history: SetpointHistory,
    worst_ratio: f64,
    /// The interval of the newest of the set-points with that ratio.
    worst_interval: usize,
    /// Number of control points after the given ones that follow the previous plan at a start in motion, and the share of
    /// the slack that is used there.
    guided: usize,
    /// Retiming: number of knots at which the curve before followed the previous plan.
    followed: usize,
    lead_slack_share: f64,
    excess: Vec<IntervalExcess>,
    is_outside: bool,
    /// Whether the curve turns before the end of a stroke.
    misses_stroke_end: bool,
    repairs: u32,
    slowdowns: u32,
    /// Whether the horizon was too long, so that the curve ends earlier.
    is_cut: bool,
    /// The intervals of the two set-points before the last.
    past_intervals: [usize; 2],
    last_check: CheckedPoint,
    /// The set-points; all checked once the plan is ready.
    pub plan: Vec<PlanPoint>,
}

impl LookaheadWindow {
    /// An empty window with capacity for the longest plan.
    pub fn new(limits: &MotionLimits) -> Self {
        Self {
            limits: *limits,
            steps: DifferenceLimits::from_limits(limits),
            band: ToleranceBand::with_capacity(MAX_WINDOW_MOVES),
            start: WindowStart::default(),
            smoother: CurveSmoother::new(),
            speed: SpeedOptimizer::new(),
            new_points: Vec::with_capacity(MAX_CONTROL_POINTS),
            estimate: SpeedEstimate::new(),
            spacing_s: KNOT_SPACING_RANGE_S.1,
            next_spacing_s: KNOT_SPACING_RANGE_S.1,
            share: PLAN_LIMIT_SHARE,
            adopted_share: PLAN_LIMIT_SHARE,
            phase: WindowPhase::Idle,
            curve_position: CurvePosition::default(),
            sum: 0.0,
            cursor: 0,
            history: [[0.0; 3]; 4],
            worst_ratio: 0.0,
            worst_interval: 0,
            guided: 0,
            followed: 0,
            lead_slack_share: 1.0,
            excess: Vec::with_capacity(MAX_CONTROL_POINTS),
            is_outside: false,
            misses_stroke_end: false,
            repairs: 0,
            slowdowns: 0,
            is_cut: false,
            past_intervals: [0; 2],
            last_check: CheckedPoint::default(),
            plan: Vec::with_capacity(MAX_PLAN_TICKS),
        }
    }

    /// Discards the plan.
    pub fn clear(&mut self) {
        self.phase = WindowPhase::Idle;
        self.band.clear();
    }

    /// Plans for other limits. Nothing may be planned.
    pub fn set_limits(&mut self, limits: &MotionLimits) {
        self.clear();
        self.limits = *limits;
        self.steps = DifferenceLimits::from_limits(limits);
    }

    /// Starts to plan inside the tolerance band, which must be filled and closed. In motion, `guide` is the previous plan
    /// from the start on.
    pub fn begin(&mut self, start: WindowStart, guide: &[PlanPoint], budget: &mut WorkBudget) {
        self.start = start;
        self.repairs = 0;
        self.slowdowns = 0;
        self.lead_slack_share = 1.0;
        self.share = PLAN_LIMIT_SHARE * (1.0 - start.reserve);
        self.is_cut = false;
        let tolerance = self.band.moves.iter().map(|piece| piece.tolerance).fold(f64::INFINITY, f64::min);
        self.next_spacing_s = knot_spacing_s(&self.limits, tolerance);
        self.spacing_s =
            if start.point.is_in_motion() { self.next_spacing_s } else { self.next_spacing_s * FIRST_SPACING_FACTOR };
        self.begin_points();
        self.follow_guide(guide, budget);
        self.estimate.begin(&self.band, rounding_time_s(&self.limits, tolerance));
        self.phase = WindowPhase::EstimateSpeed;
    }

    /// Whether the plan is complete and valid.
    pub fn is_ready(&self) -> bool {
        self.phase == WindowPhase::Ready
    }

    /// Whether no plan within limits and tolerance was found.
    pub fn has_failed(&self) -> bool {
        self.phase == WindowPhase::Failed
    }

    /// Number of knots of the curve.
    pub fn knot_count(&self) -> usize {
        self.smoother.points.len()
    }

    /// Whether the curve ends before the requested horizon.
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// A run starts on a plan that is no window, with this share of the limits.
    pub const fn begin_run(&mut self, share: f64) {
        self.adopted_share = share;
    }

    /// The plan is used: the next window starts on it.
    pub const fn adopt(&mut self) {
        self.adopted_share = self.share;
    }

    /// Number of knots after a start in motion at which the curve follows the previous plan; 0 from rest.
    fn lead_knots(&self) -> usize {
        if self.start.point.is_in_motion() { FIXED_POINTS + self.guided } else { 0 }
    }

    /// Works on the plan until it is done or the budget is spent.
    pub fn work(&mut self, budget: &mut WorkBudget) {
        while !budget.is_spent() {
            match self.phase {
                WindowPhase::Idle | WindowPhase::Ready | WindowPhase::Failed => return,
                WindowPhase::EstimateSpeed => {
                    if self.estimate.work(&self.band, &self.limits, budget) {
                        self.begin_placing();
                        self.phase = WindowPhase::PlacePoints;
                    }
                }
                WindowPhase::PlacePoints => {
                    if self.place_points(budget) {
                        self.begin_smoothing(0);
                    }
                }
                WindowPhase::Smooth { round: LAST_ROUND, left: 0 } => self.begin_curve_check(),
                WindowPhase::Smooth { round, left: 0 } => self.begin_speed(round),
                WindowPhase::Smooth { round, left } => {
                    if self.smoother.iterate(&self.band, budget) {
                        self.phase = WindowPhase::Smooth { round, left: left - 1 };
                    }
                }
                WindowPhase::CheckCurve => {
                    if self.check_curve(budget) {
                        self.after_curve_check();
                    }
                }
                WindowPhase::Speed { round } => {
                    if self.speed.work(&self.smoother.points, budget) {
                        self.after_speed(round);
                    }
                }
                WindowPhase::Retime { round } => {
                    if self.retime(budget) {
                        self.begin_smoothing(round + 1);
                    }
                }
                WindowPhase::CheckPlan => {
                    if self.check(budget) {
                        self.evaluate();
                    }
                }
            }
        }
    }

    fn begin_smoothing(&mut self, round: usize) {
        let jerk = self.limits.axes.map(|l| l.jerk_mm_s3 * self.spacing_s.powi(3) * self.share);
        self.smoother.begin(TOLERANCE_SHARE * TUBE_SHARE, jerk.0, self.guided);
        self.phase = WindowPhase::Smooth { round, left: ROUND_ITERATIONS[round] };
    }

    fn intervals(&self) -> usize {
        self.smoother.points.len() - 3
    }

    /// Whether the end of the curve has been reached.
    fn is_at_end(&self) -> bool {
        self.curve_position.interval >= self.intervals()
    }

    fn begin_speed(&mut self, round: usize) {
        let (d, share) = (self.spacing_s, self.share);
        let axes = self.limits.axes.map(|l| {
            let ramp_s = l.acceleration_mm_s2 / l.jerk_mm_s3;
            [
                l.velocity_mm_s * d * share,
                l.acceleration_mm_s2
                    * d
                    * d
                    * share
                    * (1.0 - BETWEEN_KNOTS_MARGIN * (2.0 * d / ramp_s).min(1.0).powi(2)),
                l.jerk_mm_s3 * d * d * d * share * PLAN_JERK_SHARE,
            ]
        });
        let of = |k: usize| axes.0.map(|l| l[k]);
        let limits = KnotLimits { velocity: of(0), acceleration: of(1), jerk: of(2) };
        self.speed.feed.clear();
        for knot in &self.smoother.knots[1..self.smoother.points.len() - 1] {
            self.speed.feed.push(self.band.moves[knot.near.1].feed * d);
        }
        let in_motion = self.start.point.is_in_motion();
        let slack = if in_motion { 1.0 + (LEAD_SLACK - 1.0) * self.lead_slack_share } else { 1.0 };
        let slack = slack * (self.adopted_share / share).max(1.0);
        self.speed.lead_knots = self.lead_knots();
        self.speed.begin(limits, in_motion, slack, round < LAST_ROUND);
        self.phase = WindowPhase::Speed { round };
    }

    fn after_speed(&mut self, round: usize) {
        if round < LAST_ROUND {
            self.begin_retime();
            self.phase = WindowPhase::Retime { round };
        } else if self.speed.is_feasible() {
            self.begin_check();
            self.phase = WindowPhase::CheckPlan;
        } else {
            self.phase = WindowPhase::Failed;
        }
    }
}
