//! Speed: the quickest way along a curve within velocity, acceleration and jerk of every axis.
//!
//! Owns the square of the rate, b = σ̇², along a cubic B-spline over σ, itself a quadratic B-spline on the same knots. An
//! axis then moves at x'√b, x''b + x'b'/2 and √b (x'''b + 3x''b'/2 + x'b''/2). Where the curve itself comes to rest at
//! its ends, b stays finite, and rest is no special case. Knows nothing of contours.
//! Source: time-optimal path parametrisation in b; an interior-point method. From rest it begins with an even rate that
//! keeps all limits; in motion with the rate taken over, leading to such a one, and around each knot with limits widened
//! by a slack, which is taken away. Every pass may be left and taken up at any knot.

mod newton;
mod terms;

use super::budget::Budget;
use super::smooth::POINTS;
use terms::Terms;

/// The rate is never raised above this, so that a curve of no limits has an answer.
const RATE_SQUARE_MOST: f64 = 400.0;
/// Barrier: while slack is taken away; then from, factor, to.
const BARRIER_SLACK: f64 = 0.1;
const BARRIER: (f64, f64, f64) = (0.05, 0.3, 0.000_2);
/// A rough plan, for the timing only, stops at this barrier.
const BARRIER_ROUGH: f64 = 0.012;
/// Part of the way to the nearest limit that a step may take.
const STEP_SHARE: f64 = 0.95;
/// The barrier is lowered after a step of at least this part.
const LOWER_FROM: f64 = 0.3;
/// Steps of one plan at most.
const STEPS_MOST: u32 = 64;
const STEPS_ROUGH: u32 = 6;
/// Slack left at the end that is still taken: the share of the limits planned for leaves more.
const SLACK_TAKEN: f64 = 1.011;
/// The slack is more than is needed by this part of what is needed, at least and at most, so that the next step has room.
const SLACK_SPARE: (f64, f64, f64) = (0.2, 0.01, 0.2);
/// When more than this is needed at the beginning, it begins with an even rate.
const SLACK_EVEN: f64 = 1.2;
/// Knots over which a rate taken over leads to the nominal one.
pub const OVER_KNOTS: usize = 20;
/// It is gone when less than this is needed.
const SLACK_GONE: f64 = 0.998;
/// Knots of a start in motion around which the limits are wider.
pub const LEAD_KNOTS: usize = 20;
/// Coefficients of one interval.
const INTERVAL: usize = 3;
/// Part of the greatest even rate that a plan from rest begins with.
const EVEN_SHARE: f64 = 0.9;
/// Units of work of one knot in each pass, and for each axis that moves.
const COST_TERMS: (usize, usize) = (20, 40);
const COST_ASSEMBLE: (usize, usize) = (25, 35);
const COST_SOLVE: usize = 12;
const COST_REACH: (usize, usize) = (12, 15);
const COST_MEASURE: (usize, usize) = (8, 10);

/// Limits in units of the knot spacing: mm, mm per spacing, and so on.
#[derive(Clone, Copy, Debug, Default)]
pub struct KnotLimits {
    /// Velocity.
    pub velocity: [f64; 3],
    /// Acceleration.
    pub acceleration: [f64; 3],
    /// Jerk.
    pub jerk: [f64; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    Terms,
    Measure,
    Clear,
    Assemble,
    Forward,
    Back,
    Reach,
    Go,
    Over,
}

/// The plan along one curve.
#[derive(Clone, Debug)]
pub struct Speed {
    /// Coefficients of b, one more than knots.
    pub rate_square: Vec<f64>,
    /// Greatest speed at each knot, mm per spacing.
    pub feed: Vec<f64>,
    /// Knots over which a rate taken over leads to an even one.
    pub even_knots: usize,
    limits: KnotLimits,
    terms: Terms,
    /// Coefficients at the start that are given.
    fixed: usize,
    /// And those that are known, where the search begins.
    given: usize,
    /// Whether it begins with an even rate after them.
    is_even: bool,
    rough: bool,
    barrier: f64,
    /// By what the limits around each knot are widened, and in any case at the start in motion.
    slack: Vec<f64>,
    lead_slack: f64,
    /// The greatest of them, and what the first coefficients need.
    need: f64,
    worst: f64,
    steps: u32,
    /// Part of the step that may be taken.
    part: f64,
    pass: Pass,
    cursor: usize,
    gradient: Vec<f64>,
    hessian: Vec<[f64; 3]>,
    step: Vec<f64>,
}

/// The square of the rate at a part of the way from the last that is given to another.
pub fn over(last: f64, to: f64, part: f64) -> f64 {
    let part = part.min(1.0);
    last + (to - last) * part * part * (3.0 - 2.0 * part)
}

impl Speed {
    /// Room for the most control points.
    pub fn new() -> Self {
        Self {
            rate_square: Vec::with_capacity(POINTS),
            feed: Vec::with_capacity(POINTS),
            even_knots: 1,
            limits: KnotLimits::default(),
            terms: Terms::new(),
            fixed: 0,
            given: 0,
            is_even: false,
            rough: false,
            barrier: 0.0,
            slack: Vec::with_capacity(POINTS),
            lead_slack: 1.0,
            need: 0.0,
            worst: 0.0,
            steps: 0,
            part: 1.0,
            pass: Pass::Over,
            cursor: 0,
            gradient: Vec::with_capacity(POINTS),
            hessian: Vec::with_capacity(POINTS),
            step: Vec::with_capacity(POINTS),
        }
    }

    /// Begin along a curve with the nominal rate; `feed` has been set for each knot. In motion, the first coefficients
    /// are `given`: the first three stay, the others are where the search begins. There limits may be wider by
    /// `lead_slack`.
    /// A rough plan serves for the timing only.
    pub fn begin(&mut self, limits: KnotLimits, given: &[f64], lead_slack: f64, rough: bool) {
        self.limits = limits;
        self.fixed = given.len().min(INTERVAL);
        self.given = given.len();
        self.is_even = false;
        self.lead_slack = lead_slack;
        self.rough = rough;
        self.barrier = BARRIER_SLACK;
        self.steps = 0;
        (self.need, self.worst) = (0.0, 0.0);
        self.slack.clear();
        self.rate_square.clear();
        self.rate_square.extend_from_slice(given);
        if let Some(last) = given.last() {
            let part = |k: usize| k as f64 / OVER_KNOTS as f64;
            (1..OVER_KNOTS).for_each(|k| self.rate_square.push(over(*last, 1.0, part(k))));
        }
        self.terms.clear();
        (self.pass, self.cursor) = (Pass::Terms, 0);
    }

    /// Whether the plan keeps all limits.
    pub fn is_good(&self) -> bool {
        self.rough || self.need <= SLACK_TAKEN
    }

    /// Works on the plan along control points `p`; true when it is over.
    pub fn work(&mut self, p: &[[f64; 3]], budget: &mut Budget) -> bool {
        while self.pass != Pass::Over {
            let knots = p.len() - 2;
            let axes = self.terms.axes();
            let per = |cost: (usize, usize)| cost.0 + cost.1 * axes;
            let (end, cost) = match self.pass {
                Pass::Terms => (knots, COST_TERMS.0 + COST_TERMS.1 * 3),
                Pass::Measure => (knots, per(COST_MEASURE)),
                Pass::Clear => (knots + 1, 3),
                Pass::Assemble => (knots, per(COST_ASSEMBLE)),
                Pass::Forward | Pass::Back => (knots + 1, COST_SOLVE),
                Pass::Reach => (knots, per(COST_REACH)),
                Pass::Go => (knots + 1, 2),
                Pass::Over => (0, 0),
            };
            let from = self.cursor;
            let until = budget.slice(from, end, cost);
            for k in from..until {
                match self.pass {
                    Pass::Terms => self.begin_knot(p, k),
                    Pass::Measure => self.measure(k),
                    Pass::Clear => (self.gradient[k], self.hessian[k]) = (0.0, [0.0; 3]),
                    Pass::Assemble => self.assemble(k),
                    Pass::Forward => self.forward(k),
                    Pass::Back => self.back(knots - k),
                    Pass::Reach => self.reach(k),
                    Pass::Go => self.rate_square[k] += self.part * self.step[k],
                    Pass::Over => {}
                }
            }
            self.cursor = until;
            if until < end {
                return false;
            }
            self.pass = self.next_pass();
            self.cursor = 0;
        }
        true
    }

    fn next_pass(&mut self) -> Pass {
        match self.pass {
            Pass::Terms => {
                self.rate_square.resize(self.terms.speed.len() + 1, 1.0);
                self.slack.resize(self.rate_square.len(), f64::INFINITY);
                while self.gradient.len() < self.rate_square.len() {
                    self.gradient.push(0.0);
                    self.hessian.push([0.0; 3]);
                    self.step.push(0.0);
                }
                self.need = 0.0;
                Pass::Measure
            }
            Pass::Measure => self.loosen(),
            Pass::Clear => Pass::Assemble,
            Pass::Assemble => Pass::Forward,
            Pass::Forward => Pass::Back,
            Pass::Back => {
                self.part = 1.0 / STEP_SHARE;
                Pass::Reach
            }
            Pass::Reach => {
                // A step that stays clear of the limits by itself is shortened a little all the same.
                self.part *= STEP_SHARE;
                Pass::Go
            }
            Pass::Go => {
                self.steps += 1;
                if self.need > SLACK_TAKEN {
                    self.need = 0.0;
                    return Pass::Measure;
                }
                if self.part >= LOWER_FROM {
                    self.barrier *= BARRIER.1;
                }
                if self.is_over() { Pass::Over } else { Pass::Clear }
            }
            Pass::Over => Pass::Over,
        }
    }

    /// Goes on with less slack, or without.
    fn loosen(&mut self) -> Pass {
        if self.fixed == 0 && self.steps == 0 {
            // From rest any even rate is a beginning: one that keeps all limits. Jerk falls with its power of 3/2.
            let rate = EVEN_SHARE / self.worst.max(self.worst.powf(2.0 / 3.0));
            self.rate_square.fill(rate.min(RATE_SQUARE_MOST * EVEN_SHARE));
            self.slack.fill(1.0);
            self.need = 1.0;
        }
        if self.fixed > 0 && self.steps == 0 && !self.is_even && self.worst > SLACK_EVEN {
            // In motion the rate given leads over to such an even one; what that needs is measured again.
            let rate = (EVEN_SHARE / self.worst.max(self.worst.powf(2.0 / 3.0))).min(1.0);
            let last = self.rate_square[self.given - 1];
            for (count, c) in self.rate_square[self.given..].iter_mut().enumerate() {
                *c = over(last, rate, (count + 1) as f64 / self.even_knots as f64);
            }
            self.is_even = true;
            self.slack.fill(f64::INFINITY);
            (self.need, self.worst) = (0.0, 0.0);
            return Pass::Measure;
        }
        if self.need <= SLACK_TAKEN {
            self.barrier = BARRIER.0;
        }
        if self.is_over() { Pass::Over } else { Pass::Clear }
    }

    /// By what the limits around a knot are widened in any case.
    fn lead_slack(&self, k: usize) -> f64 {
        if self.fixed > 0 && k < LEAD_KNOTS { self.lead_slack } else { 1.0 }
    }

    /// By what they are widened when the coefficients need so much: a little more while that is more than nothing, and
    /// ever less so.
    fn slack_for(&self, k: usize, need: f64) -> f64 {
        let least = self.lead_slack(k);
        if need < SLACK_GONE * least {
            return least;
        }
        need * (1.0 + (SLACK_SPARE.0 * (need / least - 1.0)).clamp(SLACK_SPARE.1, SLACK_SPARE.2))
    }

    fn is_over(&self) -> bool {
        let (least, most) = if self.rough { (BARRIER_ROUGH, STEPS_ROUGH) } else { (BARRIER.2, STEPS_MOST) };
        self.steps >= most + if self.fixed > 0 && self.rough { 6 } else { 0 }
            || (self.need <= SLACK_TAKEN && self.barrier < least)
    }
}
