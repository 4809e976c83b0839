//! Look-ahead window: up to about a second and a half of a run as one smooth curve, from any state of motion to rest.
//!
//! Plans one window in slices of counted work: a first timing along the contour, smoothing inside the tolerance band,
//! the fastest speed along the curve, smoothing and speed again with the better timing, and a check of every set-point
//! against limits and tolerance. In motion, a window takes over control points and rate of the previous window up to
//! where braking affects them: the path stays the same, and the speed can adapt to the path ahead. Knows nothing of
//! the queue and of which part of a plan is used. Each plan ends at rest, so its rest can always be followed if the
//! next window is not ready.

mod check;
mod follow;
mod timing;

use super::Limits;
use super::budget::Budget;
use super::smooth::{POINTS, Smooth};
use super::speed::{KnotLimits, LEAD_KNOTS, Speed};
use super::tube::Tube;
use super::warp::{History, StepLimits};

/// Maximum number of moves in a window.
pub const PIECES: usize = 320;
/// Maximum number of set-points in a plan.
pub const PLAN_TICKS: usize = 8_192;
/// Knot spacing, s. A coarser spacing loses time in corners; a finer one gains none.
pub const SPACING_S: f64 = 0.004;
/// Share of the tolerance used for smoothing; the rest is for deviations between knots and unfinished iterations.
const TUBE_SHARE: f64 = 0.95;
/// Share of the tolerance used for planning; the rest is for positions between set-points, used under an override.
const TOLERANCE_SHARE: f64 = 0.98;
/// Smoothing iterations of each round.
const ROUNDS: [u32; 3] = [20, 0, 20];
const ROUNDS_HURRIED: [u32; 3] = [20, 0, 20];
/// Factor on the knot spacing in the first round.
const FIRST_COARSER: f64 = 1.4;
const LAST: usize = ROUNDS.len() - 1;
/// Maximum number of times the tolerance band is narrowed, and smoothing iterations after each time.
const REPAIRS_MOST: u32 = 8;
const REPAIR_ROUND: u32 = 10;
/// Maximum number of retries with a lower share of the limits after the check.
const SLOWER_MOST: u32 = 3;
/// Share of the limits used for planning: nothing is checked between knots, and a change of rate needs a reserve.
const LIMIT_SHARE: f64 = 0.98;

/// Further reduction of the acceleration limit where acceleration changes within two knots.
const BETWEEN: f64 = 0.03;
/// Factor on the limits at a start in motion. The previous plan left this reserve, so that a solution exists.
const LEAD_SLACK: f64 = 1.016;
/// Further share of the jerk limit: jerk varies most between knots, and a second plan costs more than it gains.
const JERK_SHARE: f64 = 0.98;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Idle,
    Lay,
    Smooth { round: usize, left: u32 },
    Probe,
    Speed { round: usize },
    Retime { round: usize },
    Check,
    Ready,
    Failed,
}

/// Position on the curve of a plan.
#[derive(Clone, Copy, Debug, Default)]
pub struct Follow {
    /// Index of the interval between two knots.
    pub interval: usize,
    /// Fraction of the interval, 0 to 1.
    pub part: f64,
}

/// One set-point of a plan.
#[derive(Clone, Copy, Debug)]
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
    /// Position on the curve.
    pub follow: Follow,
}

impl PlanPoint {
    /// A set-point at rest.
    #[must_use]
    pub const fn at_rest(at: [f64; 3], along: f64, segment: usize) -> Self {
        let follow = Follow { interval: 0, part: 0.0 };
        Self { at, velocity: [0.0; 3], acceleration: [0.0; 3], along, segment, follow }
    }

    /// Whether it is not at rest.
    #[must_use]
    pub fn is_in_motion(&self) -> bool {
        self.velocity.iter().chain(&self.acceleration).any(|x| x.abs() > 0.0)
    }
}

/// Start conditions of a window.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The state at the start.
    pub point: PlanPoint,
    /// The set-points up to the start, the newest last.
    pub past: History,
    /// Last interval of the previous curve that is taken over; `None` at rest and where that curve already brakes.
    pub until: Option<usize>,
    /// Offset of distance (mm) and move index from the previous tolerance band to this one; subtracted.
    pub shift: (f64, usize),
    /// Share of every limit reserved for a change of rate, 0 to below 1.
    pub spare: f64,
    /// Whether early completion is more important than the fastest plan.
    pub hurried: bool,
}

/// How far the curve exceeds tolerance (`off`) and axis bounds (`room`) in an interval, mm.
#[derive(Clone, Copy, Debug, Default)]
struct Excess {
    off: f64,
    room: [(f64, f64); 3],
}

/// The curve of the plan in use.
#[derive(Clone, Debug)]
struct Curve {
    points: Vec<[f64; 3]>,
    rate_square: Vec<f64>,
    /// Distance along the contour and move index of each knot.
    near: Vec<(f64, usize)>,
    share: f64,
}

/// Planning of one window.
#[derive(Clone, Debug)]
pub struct Window {
    limits: Limits,
    steps: StepLimits,
    /// The tolerance band; filled by the caller before `begin`.
    pub tube: Tube,
    start: Start,
    before: Curve,
    smooth: Smooth,
    speed: Speed,
    fresh: Vec<([f64; 3], f64)>,
    corner: Vec<f64>,
    spacing_s: f64,
    share: f64,
    phase: Phase,
    follow: Follow,
    /// Start of the first timing, mm along the contour.
    first_from: f64,
    /// First timing: distance along the contour, mm. Retiming: time between new control points, in knot spacings.
    sum: f64,
    cursor: usize,
    past: History,
    worst: f64,
    excess: Vec<Excess>,
    is_off: bool,
    repairs: u32,
    slower: u32,
    /// Whether the horizon was too long, so that the curve ends earlier.
    is_cut: bool,
    /// The intervals of the two set-points before the last.
    seen: [usize; 2],
    /// The move nearest to the last checked point.
    nearest_before: usize,
    /// The set-points; all checked once the plan is ready.
    pub plan: Vec<PlanPoint>,
}

impl Window {
    /// An empty window with capacity for the longest plan.
    pub fn new(limits: &Limits) -> Self {
        let at_rest = PlanPoint::at_rest([0.0; 3], 0.0, 0);
        Self {
            limits: *limits,
            steps: StepLimits::of(limits),
            tube: Tube::with_capacity(PIECES),
            start: Start {
                point: at_rest,
                past: [[0.0; 3]; 4],
                until: None,
                shift: (0.0, 0),
                spare: 0.0,
                hurried: false,
            },
            before: Curve {
                points: Vec::with_capacity(POINTS),
                rate_square: Vec::with_capacity(POINTS),
                near: Vec::with_capacity(POINTS),
                share: LIMIT_SHARE,
            },
            smooth: Smooth::new(),
            speed: Speed::new(),
            fresh: Vec::with_capacity(POINTS),
            corner: Vec::with_capacity(PIECES + 1),
            spacing_s: SPACING_S,
            share: LIMIT_SHARE,
            phase: Phase::Idle,
            follow: Follow::default(),
            first_from: 0.0,
            sum: 0.0,
            cursor: 0,
            past: [[0.0; 3]; 4],
            worst: 0.0,
            excess: Vec::with_capacity(POINTS),
            is_off: false,
            repairs: 0,
            slower: 0,
            is_cut: false,
            seen: [0; 2],
            nearest_before: 0,
            plan: Vec::with_capacity(PLAN_TICKS),
        }
    }

    /// Discards the plan.
    pub fn clear(&mut self) {
        self.phase = Phase::Idle;
        self.tube.clear();
    }

    /// Starts to plan inside the tolerance band, which must be filled and closed.
    pub fn begin(&mut self, start: Start, budget: &mut Budget) {
        self.start = start;
        self.repairs = 0;
        self.slower = 0;
        self.share = LIMIT_SHARE * (1.0 - start.spare);
        self.is_cut = false;
        self.spacing_s = if start.point.is_in_motion() { SPACING_S } else { SPACING_S * FIRST_COARSER };
        self.begin_points();
        self.guess_corners(budget);
        self.begin_lay();
        self.phase = Phase::Lay;
    }

    /// Whether the plan is complete and valid.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Ready
    }

    /// Whether no plan within limits and tolerance was found.
    pub fn has_failed(&self) -> bool {
        self.phase == Phase::Failed
    }

    /// Whether the curve ends before the requested horizon.
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Keeps the curve of this plan: the next window starts on it.
    pub fn keep(&mut self) {
        std::mem::swap(&mut self.before.points, &mut self.smooth.points);
        std::mem::swap(&mut self.before.rate_square, &mut self.speed.rate_square);
        self.before.near.clear();
        self.before.near.extend(self.smooth.knots.iter().map(|knot| knot.near));
        self.before.share = self.share;
    }

    /// Works on the plan until it is done or the budget is spent.
    pub fn work(&mut self, budget: &mut Budget) {
        while !budget.is_spent() {
            match self.phase {
                Phase::Idle | Phase::Ready | Phase::Failed => return,
                Phase::Lay => {
                    if self.lay_first(budget) {
                        self.smooth.begin(TOLERANCE_SHARE * TUBE_SHARE);
                        self.phase = self.round(0);
                    }
                }
                Phase::Smooth { round: LAST, left: 0 } => self.begin_probe(),
                Phase::Smooth { round, left: 0 } => self.begin_speed(round),
                Phase::Smooth { round, left } => {
                    if self.smooth.iterate(&self.tube, budget) {
                        self.phase = Phase::Smooth { round, left: left - 1 };
                    }
                }
                Phase::Probe => {
                    if self.probe(budget) {
                        self.after_probe();
                    }
                }
                Phase::Speed { round } => {
                    if self.speed.work(&self.smooth.points, budget) {
                        self.after_speed(round);
                    }
                }
                Phase::Retime { round } => {
                    if self.retime(budget) {
                        self.smooth.begin(TOLERANCE_SHARE * TUBE_SHARE);
                        self.phase = self.round(round + 1);
                    }
                }
                Phase::Check => {
                    if self.check(budget) {
                        self.judge();
                    }
                }
            }
        }
    }

    fn round(&self, round: usize) -> Phase {
        if self.start.hurried || ROUNDS[1] == 0 {
            let round = if round == 0 { 0 } else { LAST };
            return Phase::Smooth {
                round,
                left: if self.start.hurried { ROUNDS_HURRIED[round] } else { ROUNDS[round] },
            };
        }
        Phase::Smooth { round, left: ROUNDS[round] }
    }

    fn intervals(&self) -> usize {
        self.smooth.points.len() - 3
    }

    /// Whether the end of the curve has been reached.
    fn is_at_end(&self) -> bool {
        self.follow.interval >= self.intervals()
    }

    fn begin_speed(&mut self, round: usize) {
        let (d, share) = (self.spacing_s, self.share);
        let axes = self.limits.axes.map(|l| {
            let ramp_s = l.acceleration_mm_s2 / l.jerk_mm_s3;
            [
                l.velocity_mm_s * d * share,
                l.acceleration_mm_s2 * d * d * share * (1.0 - BETWEEN * (2.0 * d / ramp_s).min(1.0).powi(2)),
                l.jerk_mm_s3 * d * d * d * share * JERK_SHARE,
            ]
        });
        let limits = KnotLimits {
            velocity: axes.0.map(|l| l[0]),
            acceleration: axes.0.map(|l| l[1]),
            jerk: axes.0.map(|l| l[2]),
        };
        self.speed.feed.clear();
        for knot in &self.smooth.knots[1..self.smooth.points.len() - 1] {
            self.speed.feed.push(self.tube.pieces[knot.near.1].feed * d);
        }
        let from = self.start.point.follow.interval;
        let given = match self.start.until {
            Some(_) => &self.before.rate_square[from..from + self.smooth.lead - 1],
            None if self.start.point.is_in_motion() => &[1.0; 2],
            None => &[],
        };
        // A handover this far on the previous curve is past its own slack: the limits need not be wider.
        let fresh = self.start.until.is_some() && from >= LEAD_KNOTS;
        let slack = if fresh { 1.0 } else { LEAD_SLACK };
        self.speed.begin(limits, given, slack * (self.before.share / share).max(1.0), round < LAST);
        self.phase = Phase::Speed { round };
    }

    fn after_speed(&mut self, round: usize) {
        if round < LAST {
            self.begin_retime();
            self.phase = Phase::Retime { round };
        } else if self.speed.is_good() {
            self.begin_check();
            self.phase = Phase::Check;
        } else {
            self.phase = Phase::Failed;
        }
    }
}
