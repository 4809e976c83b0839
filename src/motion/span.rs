//! The span: a run of moves taken as one smooth curve from rest to rest.
//!
//! Owns the planning of one run, spread over ticks: a first timing along the contour, smoothing inside the tolerance, the
//! quickest speed along the curve, both once more with the better timing, and a run over the whole plan that compares
//! every set-point with limits and tolerance before the first is laid. Knows nothing of the queue.

mod follow;
mod timing;

use super::Limits;
use super::contour::Segment;
use super::smooth::{POINTS, Smooth, Tube};
use super::speed::{KnotLimits, Speed};
use super::trail::spline;
use super::warp::{History, StepLimits};

/// Knot spacing at least, s, and control points aimed at, at most: the spacing grows for long runs.
const SPACING_LEAST_S: f64 = 0.004;
const POINTS_AIM: f64 = 900.0;
/// Control points at least.
const POINTS_LEAST: usize = 24;
/// Part of the tolerance used while smoothing; the rest is for what lies between knots and for unfinished iterations.
const TUBE_SHARE: f64 = 0.95;
/// Part of the tolerance planned for: the rest is for what lies between set-points and is passed under an override.
const TOLERANCE_SHARE: f64 = 0.99;
/// Places looked at in a tick, and between two of them near a corner.
const LOOKS: u32 = 4;
const CLOSER_LOOKS: u32 = 10;
/// Iterations of smoothing in each round.
const ROUNDS: [u32; 3] = [60, 50, 60];
/// The share of the limits planned for: what lies between knots is not looked at.
const LIMIT_SHARE: f64 = 0.995;
/// Narrower than this part of the tolerance the tube is not made.
const NARROWEST: f64 = 0.02;
/// A repair aims this part of the tolerance inside.
const REPAIR_SPARE: f64 = 0.01;
/// How often the tube is made narrower, and the iterations of smoothing after each time.
const REPAIRS_MOST: u32 = 8;
const REPAIR_ROUND: u32 = 60;
/// How often a plan is slowed after the check until it is given up.
const SLOWER_MOST: u32 = 4;
/// Work of a tick, in control points iterated: while the axes rest, and while they move.
const WORK_AT_REST: usize = 3_000;
const WORK_MOVING: usize = 600;
/// A step of the speed plan is as much work as this many iterations of smoothing; so is a check.
const SPEED_WORK: usize = 5;
/// Turns sharper than this (cosine of the angle) are exact stops: stopping costs nothing there.
pub const SHARPEST_COSINE: f64 = -0.8;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Idle,
    Smooth { round: usize, left: u32 },
    Speed { round: usize },
    Check { slower: u32 },
    Ready,
    Failed,
}

/// Where on the plan: interval, part of it.
#[derive(Clone, Copy, Debug)]
struct Follow {
    interval: usize,
    part: f64,
}

/// Planning and following of one run.
#[derive(Clone, Debug)]
pub struct Span {
    limits: Limits,
    /// The contour; filled by the caller before `begin`.
    pub tube: Tube,
    /// Greatest speed of each move, mm/s; filled by the caller.
    pub feeds: Vec<f64>,
    tolerance: f64,
    smooth: Smooth,
    speed: Speed,
    fresh: Vec<([f64; 3], f64)>,
    corner: Vec<f64>,
    spacing_s: f64,
    phase: Phase,
    follow: Follow,
    past: History,
    worst: f64,
    slowed: f64,
    /// How much farther off than allowed each interval comes, mm.
    excess: Vec<f64>,
    repairs: u32,
    /// The intervals of the last set-points but one and but two.
    seen: [usize; 2],
}

impl Span {
    /// Room for the longest run.
    pub fn new(limits: &Limits, moves: usize) -> Self {
        let mut along = Vec::with_capacity(moves + 1);
        along.push(0.0);
        let tube = Tube { segments: Vec::with_capacity(moves), along, smooth_run: Vec::with_capacity(moves) };
        Self {
            limits: *limits,
            tube,
            feeds: Vec::with_capacity(moves),
            tolerance: 0.0,
            smooth: Smooth::new(),
            speed: Speed::new(),
            fresh: Vec::with_capacity(POINTS),
            corner: Vec::with_capacity(moves + 1),
            spacing_s: 0.0,
            phase: Phase::Idle,
            follow: Follow { interval: 0, part: 0.0 },
            past: [[0.0; 3]; 4],
            worst: 0.0,
            slowed: 1.0,
            excess: Vec::with_capacity(POINTS),
            repairs: 0,
            seen: [0; 2],
        }
    }

    /// Forget the run.
    pub fn clear(&mut self) {
        self.phase = Phase::Idle;
        self.tube.segments.clear();
        self.tube.along.clear();
        self.tube.along.push(0.0);
        self.feeds.clear();
    }

    /// Add a move of the run.
    pub fn add(&mut self, segment: Segment, feed_mm_s: f64) {
        let end = self.tube.length() + segment.length();
        self.tube.segments.push(segment);
        self.tube.along.push(end);
        self.feeds.push(feed_mm_s);
    }

    /// Begin to plan the run within a tolerance in mm.
    pub fn begin(&mut self, tolerance: f64) {
        self.tolerance = tolerance;
        self.repairs = 0;
        self.tube.mark_corners();
        self.first_timing();
        self.smooth.begin(self.allowed() * TUBE_SHARE);
        self.phase = Phase::Smooth { round: 0, left: ROUNDS[0] };
    }

    /// Whether a run is being planned or followed.
    pub fn is_idle(&self) -> bool {
        self.phase == Phase::Idle
    }

    /// Whether the plan can be followed.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Ready
    }

    /// Whether no plan was found that keeps limits and tolerance.
    pub fn has_failed(&self) -> bool {
        self.phase == Phase::Failed
    }

    /// Some work on the plan.
    pub fn plan(&mut self, at_rest: bool) {
        let mut work = if at_rest { WORK_AT_REST } else { WORK_MOVING };
        while work > 0 {
            let cost = self.smooth.points.len();
            match self.phase {
                Phase::Idle | Phase::Ready | Phase::Failed => return,
                Phase::Smooth { round, left: 0 } => {
                    self.begin_speed();
                    self.phase = Phase::Speed { round };
                }
                Phase::Smooth { round, left } => {
                    self.smooth.iterate(&self.tube);
                    self.phase = Phase::Smooth { round, left: left - 1 };
                }
                Phase::Speed { round } if self.speed.is_done() => {
                    if round + 1 < ROUNDS.len() {
                        self.time_again();
                        self.phase = Phase::Smooth { round: round + 1, left: ROUNDS[round + 1] };
                    } else {
                        self.rewind();
                        self.phase = Phase::Check { slower: 0 };
                    }
                }
                Phase::Speed { round: _ } => self.speed.iterate(&self.smooth.points),
                Phase::Check { slower } => self.check(slower),
            }
            let times = if matches!(self.phase, Phase::Smooth { .. }) { 1 } else { SPEED_WORK };
            work = work.saturating_sub(cost * times);
        }
    }

    /// The next set-point and the move it belongs to; `None` after the end point has been given out.
    pub fn next(&mut self) -> Option<([f64; 3], usize)> {
        if self.is_at_end() {
            return None;
        }
        let step = self.limits.tick_s / self.spacing_s / self.slowed;
        self.advance(step);
        let at = self.position();
        let last = self.tube.segments.len() - 1;
        let near = if self.is_at_end() { last } else { self.smooth.near[self.follow.interval + 1].1.min(last) };
        Some((at, near))
    }

    fn intervals(&self) -> usize {
        self.smooth.points.len() - 3
    }

    /// Whether no set-point has been given out.
    pub fn is_at_start(&self) -> bool {
        self.follow.interval == 0 && self.follow.part <= 0.0
    }

    /// Whether the end point has been given out.
    pub fn is_at_end(&self) -> bool {
        self.follow.interval >= self.intervals()
    }

    fn rewind(&mut self) {
        self.follow = Follow { interval: 0, part: 0.0 };
        self.past = [self.smooth.points[0]; 4];
        self.worst = 0.0;
        self.seen = [0; 2];
        self.excess.clear();
        self.excess.resize(self.smooth.points.len(), -1.0);
    }

    fn begin_speed(&mut self) {
        let (d, share) = (self.spacing_s, LIMIT_SHARE);
        let axes = self.limits.axes.map(|l| {
            [l.velocity_mm_s * d * share, l.acceleration_mm_s2 * d * d * share, l.jerk_mm_s3 * d * d * d * share]
        });
        let limits = KnotLimits {
            velocity: axes.0.map(|l| l[0]),
            acceleration: axes.0.map(|l| l[1]),
            jerk: axes.0.map(|l| l[2]),
        };
        self.speed.feed.clear();
        let last = self.feeds.len() - 1;
        for knot in 0..self.smooth.points.len() - 2 {
            let near = self.smooth.near[knot + 1].1.min(last);
            self.speed.feed.push(self.feeds[near] * d * share);
        }
        self.slowed = 1.0;
        self.speed.begin(&self.smooth.points, limits);
    }

    /// How far set-points may be off the contour, mm.
    fn allowed(&self) -> f64 {
        self.tolerance * TOLERANCE_SHARE
    }

    /// Runs over set-points and compares them. Where one is too far off, the tube is made narrower there and the curve
    /// smoothed again; where one is beyond a limit, the plan is slowed.
    fn check(&mut self, slower: u32) {
        let steps = StepLimits::of(&self.limits);
        for _ in 0..self.smooth.points.len() {
            let Some((at, _)) = self.next() else {
                // The rest after the end is still seen in the differences of three ticks.
                let end = self.past[3];
                for _ in 0..3 {
                    self.past = [self.past[1], self.past[2], self.past[3], end];
                    self.worst = self.worst.max(steps.slowing(&self.past));
                }
                self.judge(slower);
                return;
            };
            self.past = [self.past[1], self.past[2], self.past[3], at];
            self.worst = self.worst.max(steps.slowing(&self.past));
            let k = self.follow.interval.min(self.intervals() - 1);
            let places = &self.smooth.near;
            let (low, high) = (
                if k == 0 { 0.0 } else { places[k].0.min(self.smooth.along[k - 1]) },
                if k + 4 >= places.len() { self.tube.length() } else { places[k + 3].0.max(self.smooth.along[k + 4]) },
            );
            let off = self.farthest(low, high);
            // The tick looked at lies between the set-points before last.
            let seen = self.seen;
            self.seen = [seen[1], k];
            for k in seen {
                self.excess[k] = self.excess[k].max(off - self.allowed());
            }
        }
    }

    /// How far the curve through the last set-points is off the contour, between two places of it, over one tick: an
    /// override may stop the axes anywhere on it. Where the nearest segment changes the distance has a peak, and is
    /// looked at more closely.
    fn farthest(&self, low: f64, high: f64) -> f64 {
        let look = |part: f64| self.tube.nearest(spline(&self.past, part), low, high);
        let mut before = look(0.0);
        let mut farthest = before.off;
        for part in 1..=LOOKS {
            let end = f64::from(part) / f64::from(LOOKS);
            let now = look(end);
            farthest = farthest.max(now.off);
            if now.segment != before.segment {
                for fine in 1..CLOSER_LOOKS {
                    let back = f64::from(fine) / f64::from(LOOKS * CLOSER_LOOKS);
                    farthest = farthest.max(look(end - back).off);
                }
            }
            before = now;
        }
        farthest
    }

    /// Makes the tube narrower by what the curve between two knots is too far off; whether there was any such place.
    fn narrow(&mut self) -> bool {
        let (allowed, mut off) = (self.allowed(), false);
        for (k, excess) in self.excess.iter().enumerate() {
            if *excess > 0.0 {
                off = true;
                for radius in &mut self.smooth.radius[k + 1..k + 3] {
                    *radius = (*radius - 1.2 * (excess + REPAIR_SPARE * allowed)).max(allowed * NARROWEST);
                }
            }
        }
        off
    }

    /// What follows from a check.
    fn judge(&mut self, slower: u32) {
        let (off, worst) = (self.narrow(), self.worst);
        self.rewind();
        self.phase = if off && self.repairs < REPAIRS_MOST {
            self.repairs += 1;
            Phase::Smooth { round: ROUNDS.len() - 1, left: REPAIR_ROUND }
        } else if off || (worst > 1.0 && slower >= SLOWER_MOST) {
            Phase::Failed
        } else if worst > 1.0 {
            self.slowed *= worst * 1.000_5;
            Phase::Check { slower: slower + 1 }
        } else {
            Phase::Ready
        };
    }
}
