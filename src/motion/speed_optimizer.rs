//! Speed planning: the fastest motion along a curve within velocity, acceleration and jerk of every axis.
//!
//! Optimises the square of the rate, b = σ̇², along a cubic B-spline over σ; b is a quadratic B-spline on the same
//! knots. Velocity, acceleration and jerk of an axis are x'√b, x''b + x'b'/2 and √b (x'''b + 3x''b'/2 + x'b''/2). Where
//! the curve itself comes to rest at its ends, b stays finite, so rest is no special case. Knows nothing of contours.
//! Source: time-optimal path parametrisation in b; an interior-point method. From rest it starts with a constant rate
//! that keeps all limits. In motion it starts with the nominal rate, or blends it to such a constant rate, and limits
//! widened by a slack around each knot, which is then removed. Every pass can be interrupted and resumed at any knot.

mod newton;
mod terms;

use super::smoother::MAX_CONTROL_POINTS;
use crate::units::WorkBudget;
use terms::LimitTerms;

/// Upper limit of b, so that a curve without active limits has a solution.
const MAX_RATE_SQUARE: f64 = 400.0;
/// Barrier weight while slack is removed; then start value, factor, end value.
const BARRIER_SLACK: f64 = 0.1;
const BARRIER: (f64, f64, f64) = (0.05, 0.3, 0.000_2);
/// A rough plan (for timing only) stops at this barrier weight.
const BARRIER_ROUGH: f64 = 0.012;
/// Share of the distance to the nearest limit that a step may take.
const STEP_SHARE: f64 = 0.95;
/// The barrier is lowered after a step of at least this fraction.
const BARRIER_STEP_FRACTION: f64 = 0.3;
/// Maximum number of Newton steps of a plan, of one with slack left, and of a rough plan.
const MAX_STEPS: u32 = 64;
const MAX_STEPS_SLACK: u32 = 16;
const MAX_STEPS_ROUGH: u32 = 4;
/// Maximum slack accepted at the end; the share of the limits used for planning leaves more than that.
const MAX_FINAL_SLACK: f64 = 1.011;
/// Extra slack for the next step: factor on the excess over the widened limit, minimum and maximum.
const SLACK_SPARE: (f64, f64, f64) = (0.2, 0.01, 0.2);
/// If more slack than this is needed at the start, the plan starts with a constant rate.
const EVEN_START_ABOVE: f64 = 1.2;
/// The slack of a knot is removed when less than this is needed.
const SLACK_REMOVED_BELOW: f64 = 0.998;
/// Number of coefficients that are given at a start in motion: rate and acceleration there.
const GIVEN_COEFFICIENTS: usize = 2;
/// Share of the maximum constant rate that a plan from rest starts with.
const EVEN_SHARE: f64 = 0.9;
/// Work units of one knot in each pass: base, and per moving axis.
const COST_CLEAR: usize = 4;
const COST_APPLY: usize = 4;
const COST_TERMS: (usize, usize) = (30, 40);
const COST_ASSEMBLE: (usize, usize) = (45, 55);
const COST_SOLVE: usize = 9;
const COST_LIMIT_STEP: (usize, usize) = (14, 14);
const COST_MEASURE: (usize, usize) = (11, 13);

/// Axis limits in units of the knot spacing d: mm/d, mm/d², mm/d³.
#[derive(Clone, Copy, Debug, Default)]
pub struct KnotLimits {
    /// Velocity, mm per spacing.
    pub velocity: [f64; 3],
    /// Acceleration, mm per spacing².
    pub acceleration: [f64; 3],
    /// Jerk, mm per spacing³.
    pub jerk: [f64; 3],
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum OptimizerPass {
    Terms,
    Measure,
    Clear,
    Assemble,
    Forward,
    Back,
    LimitStep,
    ApplyStep,
    #[default]
    Done,
}

/// The speed plan along one curve.
#[derive(Clone, Debug, Default)]
pub struct SpeedOptimizer {
    /// Coefficients of b; one more than knots.
    pub rate_square: Vec<f64>,
    /// Maximum path speed at each knot, mm per spacing.
    pub feed: Vec<f64>,
    /// Number of knots over which the nominal rate blends to a constant one.
    pub even_knots: usize,
    /// Number of knots at a start in motion whose limits may be wider.
    pub lead_knots: usize,
    limits: KnotLimits,
    terms: LimitTerms,
    /// Number of fixed coefficients at the start.
    fixed_count: usize,
    /// Whether the start values after them are a constant rate.
    starts_even: bool,
    is_rough: bool,
    barrier: f64,
    /// Factor on the limits around each knot; and the minimum factor at a start in motion.
    slack: Vec<f64>,
    lead_slack: f64,
    /// The maximum slack relative to its minimum, and the maximum need of the start values.
    max_slack: f64,
    max_need: f64,
    steps: u32,
    /// Fraction of the step that keeps all limits.
    step_fraction: f64,
    pass: OptimizerPass,
    cursor: usize,
    gradient: Vec<f64>,
    hessian: Vec<[f64; 3]>,
    step: Vec<f64>,
}

/// Blends b smoothly from 1 to another value; `part` is 0 to 1.
fn blend_rate(to: f64, part: f64) -> f64 {
    let part = part.min(1.0);
    1.0 + (to - 1.0) * part * part * (3.0 - 2.0 * part)
}

impl SpeedOptimizer {
    /// An empty plan with capacity for the maximum number of control points.
    pub fn new() -> Self {
        Self {
            rate_square: Vec::with_capacity(MAX_CONTROL_POINTS),
            feed: Vec::with_capacity(MAX_CONTROL_POINTS),
            even_knots: 1,
            terms: LimitTerms::new(),
            slack: Vec::with_capacity(MAX_CONTROL_POINTS),
            lead_slack: 1.0,
            step_fraction: 1.0,
            gradient: Vec::with_capacity(MAX_CONTROL_POINTS),
            hessian: Vec::with_capacity(MAX_CONTROL_POINTS),
            step: Vec::with_capacity(MAX_CONTROL_POINTS),
            ..Self::default()
        }
    }

    /// Starts a plan along a curve with the nominal rate; `feed` must be set for each knot. In motion, the rate at the start
    /// is given, and the limits there may be wider by `lead_slack`. A rough plan is used for timing only.
    pub fn begin(&mut self, limits: KnotLimits, in_motion: bool, lead_slack: f64, rough: bool) {
        self.limits = limits;
        self.fixed_count = if in_motion { GIVEN_COEFFICIENTS } else { 0 };
        self.starts_even = false;
        self.lead_slack = lead_slack;
        self.is_rough = rough;
        self.barrier = BARRIER_SLACK;
        self.steps = 0;
        (self.max_slack, self.max_need) = (0.0, 0.0);
        self.slack.clear();
        self.rate_square.clear();
        self.terms.clear();
        (self.pass, self.cursor) = (OptimizerPass::Terms, 0);
    }

    /// Whether the plan keeps all limits.
    pub fn is_feasible(&self) -> bool {
        self.is_rough || self.max_slack <= MAX_FINAL_SLACK
    }

    /// Works on the plan along control points `p`; true when it is done.
    pub fn work(&mut self, p: &[[f64; 3]], budget: &mut WorkBudget) -> bool {
        while self.pass != OptimizerPass::Done {
            let knots = p.len() - 2;
            let axes = self.terms.moving_axes();
            let per = |cost: (usize, usize)| cost.0 + cost.1 * axes;
            let (end, cost) = match self.pass {
                OptimizerPass::Terms => (knots, COST_TERMS.0 + COST_TERMS.1 * 3),
                OptimizerPass::Measure => (knots, per(COST_MEASURE)),
                OptimizerPass::Clear => (knots + 1, COST_CLEAR),
                OptimizerPass::Assemble => (knots, per(COST_ASSEMBLE)),
                OptimizerPass::Forward | OptimizerPass::Back => (knots + 1, COST_SOLVE),
                OptimizerPass::LimitStep => (knots, per(COST_LIMIT_STEP)),
                OptimizerPass::ApplyStep => (knots + 1, COST_APPLY),
                OptimizerPass::Done => (0, 0),
            };
            let from = self.cursor;
            let until = budget.spend_on_slice(from, end, cost);
            for k in from..until {
                match self.pass {
                    OptimizerPass::Terms => self.begin_knot(p, k),
                    OptimizerPass::Measure => self.measure_need(k),
                    OptimizerPass::Clear => (self.gradient[k], self.hessian[k]) = (0.0, [0.0; 3]),
                    OptimizerPass::Assemble => self.assemble(k),
                    OptimizerPass::Forward => self.forward(k),
                    OptimizerPass::Back => self.back(knots - k),
                    OptimizerPass::LimitStep => self.limit_step(k),
                    OptimizerPass::ApplyStep => self.rate_square[k] += self.step_fraction * self.step[k],
                    OptimizerPass::Done => {}
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

    fn next_pass(&mut self) -> OptimizerPass {
        match self.pass {
            OptimizerPass::Terms => {
                self.rate_square.resize(self.terms.speed.len() + 1, 1.0);
                self.slack.resize(self.rate_square.len(), f64::INFINITY);
                while self.gradient.len() < self.rate_square.len() {
                    self.gradient.push(0.0);
                    self.hessian.push([0.0; 3]);
                    self.step.push(0.0);
                }
                self.max_slack = 0.0;
                OptimizerPass::Measure
            }
            OptimizerPass::Measure => self.update_slack(),
            OptimizerPass::Clear => OptimizerPass::Assemble,
            OptimizerPass::Assemble => OptimizerPass::Forward,
            OptimizerPass::Forward => OptimizerPass::Back,
            OptimizerPass::Back => {
                self.step_fraction = 1.0 / STEP_SHARE;
                OptimizerPass::LimitStep
            }
            OptimizerPass::LimitStep => {
                // A step that stays clear of the limits is shortened by the same factor.
                self.step_fraction *= STEP_SHARE;
                OptimizerPass::ApplyStep
            }
            OptimizerPass::ApplyStep => {
                self.steps += 1;
                if self.max_slack > MAX_FINAL_SLACK {
                    self.max_slack = 0.0;
                    return OptimizerPass::Measure;
                }
                if self.step_fraction >= BARRIER_STEP_FRACTION {
                    self.barrier *= BARRIER.1;
                }
                if self.is_finished() { OptimizerPass::Done } else { OptimizerPass::Clear }
            }
            OptimizerPass::Done => OptimizerPass::Done,
        }
    }

    /// Continues with less slack or without slack.
    fn update_slack(&mut self) -> OptimizerPass {
        if self.fixed_count == 0 && self.steps == 0 {
            // From rest, start with a constant rate that keeps all limits. Jerk falls with b to the power of 3/2.
            let rate = EVEN_SHARE / self.max_need.max(self.max_need.powf(2.0 / 3.0));
            self.rate_square.fill(rate.min(MAX_RATE_SQUARE * EVEN_SHARE));
            self.slack.fill(1.0);
            self.max_slack = 1.0;
        }
        if self.fixed_count > 0 && self.steps == 0 && !self.starts_even && self.max_need > EVEN_START_ABOVE {
            // In motion, the given rate blends to such a constant rate; its need of slack is measured again.
            let rate = (EVEN_SHARE / self.max_need.max(self.max_need.powf(2.0 / 3.0))).min(1.0);
            for (count, c) in self.rate_square[GIVEN_COEFFICIENTS..].iter_mut().enumerate() {
                *c = blend_rate(rate, (count + 1) as f64 / self.even_knots as f64);
            }
            self.starts_even = true;
            self.slack.fill(f64::INFINITY);
            (self.max_slack, self.max_need) = (0.0, 0.0);
            return OptimizerPass::Measure;
        }
        if self.max_slack <= MAX_FINAL_SLACK {
            self.barrier = BARRIER.0;
        }
        if self.is_finished() { OptimizerPass::Done } else { OptimizerPass::Clear }
    }

    /// Minimum factor on the limits around a knot.
    fn lead_slack(&self, k: usize) -> f64 {
        if self.fixed_count > 0 && k < self.lead_knots { self.lead_slack } else { 1.0 }
    }

    /// Factor on the limits around a knot whose coefficients need the factor `need`: slightly more than needed, with a
    /// decreasing margin, until it can be removed.
    fn slack_for(&self, k: usize, need: f64) -> f64 {
        let least = self.lead_slack(k);
        if need < SLACK_REMOVED_BELOW * least {
            return least;
        }
        need * (1.0 + (SLACK_SPARE.0 * (need / least - 1.0)).clamp(SLACK_SPARE.1, SLACK_SPARE.2))
    }

    fn is_finished(&self) -> bool {
        let has_slack = self.max_slack > MAX_FINAL_SLACK;
        let (least, most) = match (self.is_rough, has_slack) {
            (true, _) => (BARRIER_ROUGH, MAX_STEPS_ROUGH),
            (false, true) => (BARRIER.2, MAX_STEPS_SLACK),
            (false, false) => (BARRIER.2, MAX_STEPS),
        };
        self.steps >= most || (!has_slack && self.barrier < least)
    }
}
