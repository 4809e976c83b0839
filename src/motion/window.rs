//! The window: some seconds of a run taken as one smooth curve, from any state of motion to rest.
//!
//! Owns the planning of one window, in slices of counted work: a first timing along the contour, smoothing inside the
//! tube, the quickest speed along the curve, both again with the better timing, and a run over the whole plan that
//! compares every set-point with limits and tolerance. In motion a window takes over the control points and the rate of
//! the one before up to where that one's end has no influence: the course goes on as it was, and the speed has that much
//! room to meet what comes. Knows nothing of the queue, nor which part of a plan is used:
//! each ends at rest, so what is left of it may be followed when the next does not come.

mod check;
mod follow;
mod timing;

use super::Limits;
use super::budget::Budget;
use super::smooth::{POINTS, Smooth};
use super::speed::{KnotLimits, LEAD_KNOTS, Speed};
use super::tube::Tube;
use super::warp::{History, StepLimits};

/// Moves in a window at most.
pub const PIECES: usize = 320;
/// Set-points of a plan at most.
pub const PLAN_TICKS: usize = 8_192;
/// Knot spacing, s. A coarser one loses time in corners, a finer one gains none.
pub const SPACING_S: f64 = 0.004;
/// Part of the tolerance used while smoothing; the rest is for what lies between knots and for unfinished iterations.
const TUBE_SHARE: f64 = 0.95;
/// Part of the tolerance planned for: the rest is for what lies between set-points and is passed under an override.
const TOLERANCE_SHARE: f64 = 0.98;
/// Iterations of smoothing in each round.
const ROUNDS: [u32; 3] = [20, 0, 20];
const ROUNDS_HURRIED: [u32; 3] = [20, 0, 20];
/// The first round makes do with knots so many times farther apart.
const FIRST_COARSER: f64 = 1.4;
const LAST: usize = ROUNDS.len() - 1;
/// How often the tube is made narrower, and the iterations of smoothing after each time.
const REPAIRS_MOST: u32 = 8;
const REPAIR_ROUND: u32 = 10;
/// How often a plan is tried with a lower share of the limits after the check.
const SLOWER_MOST: u32 = 3;
/// The share of the limits planned for: what lies between knots is not looked at, and a change of rate needs room.
const LIMIT_SHARE: f64 = 0.98;

/// And of the acceleration where it changes within two knots.
const BETWEEN: f64 = 0.03;
/// So much wider the limits are at a start in motion: a plan before has left that much, so that a way on can be found.
const LEAD_SLACK: f64 = 1.016;
/// Of the jerk a little less still: it bends most between knots, and to plan again costs more than it gains.
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

/// Where on the plan: interval, part of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Follow {
    /// Interval between two knots.
    pub interval: usize,
    /// Part of it, 0 to 1.
    pub part: f64,
}

/// One set-point of a plan.
#[derive(Clone, Copy, Debug)]
pub struct PlanPoint {
    /// Position, mm; velocity, mm/s; acceleration, mm/s².
    pub at: [f64; 3],
    /// Velocity, mm/s.
    pub velocity: [f64; 3],
    /// Acceleration, mm/s².
    pub acceleration: [f64; 3],
    /// Distance along the tube, mm.
    pub along: f64,
    /// The segment that it has come to: all before have ended.
    pub segment: usize,
    /// Where on the curve: interval, part of it.
    pub follow: Follow,
}

impl PlanPoint {
    /// At rest.
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

/// Where and how a window begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The state there.
    pub point: PlanPoint,
    /// The set-points up to there, the newest last.
    pub past: History,
    /// The interval of the curve before up to whose end its course is taken over; none at rest, nor where that curve
    /// already brakes.
    pub until: Option<usize>,
    /// What is to be taken off the distances along and the segments of the tube before.
    pub shift: (f64, usize),
    /// Part of every limit that is left for a change of rate, 0 to below 1.
    pub spare: f64,
    /// Whether it is to be ready soon rather than the quickest.
    pub hurried: bool,
}

/// How far beyond what is allowed the curve comes in an interval, mm.
#[derive(Clone, Copy, Debug, Default)]
struct Excess {
    off: f64,
    room: [(f64, f64); 3],
}

/// The curve of the plan that is followed.
#[derive(Clone, Debug)]
struct Curve {
    points: Vec<[f64; 3]>,
    rate_square: Vec<f64>,
    /// Where along its tube each knot lies, and on which segment.
    near: Vec<(f64, usize)>,
    share: f64,
}

/// Planning of one window.
#[derive(Clone, Debug)]
pub struct Window {
    limits: Limits,
    steps: StepLimits,
    /// The contour; filled by the caller before `begin`.
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
    /// Where the first timing begins, mm along.
    first_from: f64,
    /// Progress of the first timing: distance along. Then the time between new control points, in spacings.
    sum: f64,
    cursor: usize,
    past: History,
    worst: f64,
    excess: Vec<Excess>,
    is_off: bool,
    repairs: u32,
    slower: u32,
    /// Whether the horizon was too far: the curve ends before.
    is_cut: bool,
    /// The intervals of the last set-points but one and but two.
    seen: [usize; 2],
    /// The segment nearest to the last place looked at.
    nearest_before: usize,
    /// The set-points, checked once the plan is ready.
    pub plan: Vec<PlanPoint>,
}

impl Window {
    /// Room for the longest.
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

    /// Forget the plan.
    pub fn clear(&mut self) {
        self.phase = Phase::Idle;
        self.tube.clear();
    }

    /// Begin to plan along the tube, which has been filled and closed.
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

    /// Whether the plan can be followed.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Ready
    }

    /// Whether no plan was found that keeps limits and tolerance.
    pub fn has_failed(&self) -> bool {
        self.phase == Phase::Failed
    }

    /// Whether the curve ends before the end of the tube that was asked for.
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// The plan is taken over: what follows from now on begins on its curve.
    pub fn keep(&mut self) {
        std::mem::swap(&mut self.before.points, &mut self.smooth.points);
        std::mem::swap(&mut self.before.rate_square, &mut self.speed.rate_square);
        self.before.near.clear();
        self.before.near.extend(self.smooth.knots.iter().map(|knot| knot.near));
        self.before.share = self.share;
    }

    /// Some work on the plan.
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

    /// Whether the end point has been passed.
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
        // Soon after a handover the plan before has used that much more itself.
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
