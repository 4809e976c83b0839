//! Speed: the quickest way along a curve within velocity, acceleration and jerk of every axis.
//!
//! Owns the square of the rate, b = σ̇², along a cubic B-spline over σ, itself a quadratic B-spline on the same knots. An
//! axis then moves at x'√b, x''b + x'b'/2 and √b (x'''b + 3x''b'/2 + x'b''/2). Where the curve itself comes to rest at
//! its ends, b stays finite, and the start from rest is no special case. Knows nothing of contours.
//! Source: time-optimal path parametrisation in b; an interior-point method whose every iterate keeps all limits, so it
//! may be stopped at any time.

use super::smooth::POINTS;

/// The rate is never raised above this, so that a curve of no limits has an answer.
const RATE_SQUARE_MOST: f64 = 400.0;
/// How fast the barrier is lowered, from and to what.
const BARRIER: (f64, f64, f64) = (0.05, 0.5, 0.001);
/// Part of the way to the nearest limit that a step may take.
const STEP_SHARE: f64 = 0.95;
/// The barrier is lowered after a step of at least this part.
const LOWER_FROM: f64 = 0.3;
/// Steps of one plan at most.
const STEPS_MOST: u32 = 90;
/// Halvings of a step at most.
const HALVINGS: usize = 30;

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

/// The plan along one curve.
#[derive(Clone, Debug)]
pub struct Speed {
    /// Coefficients of b, one more than knots.
    pub rate_square: Vec<f64>,
    /// Greatest speed at each knot, mm per spacing.
    pub feed: Vec<f64>,
    limits: KnotLimits,
    pub barrier: f64,
    steps: u32,
    gradient: Vec<f64>,
    hessian: Vec<[f64; 3]>,
    step: Vec<f64>,
}

/// Weights of three coefficients in b and b' at the left end, the middle and the right end of an interval, and in b''.
const WEIGHTS: [([f64; 3], [f64; 3]); 3] = [
    ([0.5, 0.5, 0.0], [-1.0, 1.0, 0.0]),
    ([0.125, 0.75, 0.125], [-0.5, 0.0, 0.5]),
    ([0.0, 0.5, 0.5], [0.0, -1.0, 1.0]),
];
const BEND: [f64; 3] = [1.0, -2.0, 1.0];

/// First and second derivative of one axis at a knot.
fn at_knot(p: &[[f64; 3]], k: usize, x: usize) -> (f64, f64) {
    ((p[k + 2][x] - p[k][x]) / 2.0, p[k][x] - 2.0 * p[k + 1][x] + p[k + 2][x])
}

/// First and second derivative of one axis at the left end, the middle and the right end of an interval.
fn in_interval(p: &[[f64; 3]], k: usize, x: usize) -> [(f64, f64); 3] {
    let (left, right) = (at_knot(p, k, x), at_knot(p, k + 1, x));
    let d3 = right.1 - left.1;
    [left, (left.0 + left.1 / 2.0 + d3 / 8.0, f64::midpoint(left.1, right.1)), right]
}

fn third(p: &[[f64; 3]], k: usize, x: usize) -> f64 {
    p[k + 3][x] - 3.0 * (p[k + 2][x] - p[k + 1][x]) - p[k][x]
}

impl Speed {
    /// Room for the most control points.
    pub fn new() -> Self {
        Self {
            rate_square: Vec::with_capacity(POINTS),
            feed: Vec::with_capacity(POINTS),
            limits: KnotLimits::default(),
            barrier: 0.0,
            steps: 0,
            gradient: Vec::with_capacity(POINTS),
            hessian: Vec::with_capacity(POINTS),
            step: Vec::with_capacity(POINTS),
        }
    }

    /// Begin with an even rate that keeps all limits along control points `p`; `feed` has been set for each knot.
    pub fn begin(&mut self, p: &[[f64; 3]], limits: KnotLimits) {
        self.limits = limits;
        self.barrier = BARRIER.0;
        self.steps = 0;
        let knots = p.len() - 2;
        let mut rate = RATE_SQUARE_MOST * 0.5;
        for k in 0..knots {
            let mut square = 0.0;
            for x in 0..3 {
                let (d1, d2) = at_knot(p, k, x);
                square += d1 * d1;
                rate = rate.min((limits.velocity[x] / d1.abs().max(1e-30)).powi(2));
                rate = rate.min(limits.acceleration[x] / d2.abs().max(1e-30));
                if k + 1 < knots {
                    rate = rate.min((limits.jerk[x] / third(p, k, x).abs().max(1e-30)).powf(2.0 / 3.0));
                }
            }
            rate = rate.min(self.feed[k].powi(2) / square.max(1e-60));
        }
        let count = knots + 1;
        self.rate_square.clear();
        self.rate_square.resize(count, rate * 0.9);
        self.gradient.clear();
        self.gradient.resize(count, 0.0);
        self.hessian.clear();
        self.hessian.resize(count, [0.0; 3]);
        self.step.clear();
        self.step.resize(count, 0.0);
    }

    /// Whether the barrier has been lowered all the way.
    pub fn is_done(&self) -> bool {
        self.barrier <= BARRIER.2 || self.steps >= STEPS_MOST
    }

    /// One step; all limits are kept before and after. `p` are the control points of `begin`.
    pub fn iterate(&mut self, p: &[[f64; 3]]) {
        self.assemble(p);
        self.solve();
        let mut part = 1.0;
        for (c, d) in self.rate_square.iter().zip(&self.step) {
            if *d < 0.0 {
                part = f64::min(part, -STEP_SHARE * c / d);
            }
        }
        for _ in 0..HALVINGS {
            // A step that stays clear of the limits by itself is shortened a little all the same: the next is better.
            if self.is_within(p, part / STEP_SHARE) {
                for (c, d) in self.rate_square.iter_mut().zip(&self.step) {
                    *c += part * d;
                }
                break;
            }
            part *= 0.6;
        }
        self.steps += 1;
        if part >= LOWER_FROM {
            self.barrier = (self.barrier * BARRIER.1).max(BARRIER.2 * 0.999);
        }
    }

    /// Whether the coefficients moved by `part` of the step keep all limits.
    fn is_within(&self, p: &[[f64; 3]], part: f64) -> bool {
        let c = |k: usize| self.rate_square[k] + part * self.step[k];
        let knots = p.len() - 2;
        (0..knots).all(|k| {
            let c = [c(k), c(k + 1), if k + 1 < knots { c(k + 2) } else { c(k + 1) }];
            c.iter().all(|c| *c > 0.0)
                && self.knot_is_within(p, k, c[0], c[1])
                && (k + 1 == knots || self.jerk_is_within(p, k, c))
        })
    }

    fn knot_is_within(&self, p: &[[f64; 3]], k: usize, c0: f64, c1: f64) -> bool {
        let (b, slope) = (f64::midpoint(c0, c1), c1 - c0);
        let mut square = 0.0;
        let axes = (0..3).all(|x| {
            let (d1, d2) = at_knot(p, k, x);
            square += d1 * d1;
            d1 * d1 * b < self.limits.velocity[x].powi(2)
                && (d2 * b + 0.5 * d1 * slope).abs() < self.limits.acceleration[x]
        });
        axes && b < RATE_SQUARE_MOST && square * b < self.feed[k].powi(2)
    }

    fn jerk_is_within(&self, p: &[[f64; 3]], k: usize, c: [f64; 3]) -> bool {
        let dot = |w: &[f64; 3]| w[0] * c[0] + w[1] * c[1] + w[2] * c[2];
        let bend = dot(&BEND);
        let rates = [0, 1, 2].map(|end: usize| {
            let (wb, ws) = &WEIGHTS[end];
            let b = dot(wb);
            (b, dot(ws), 1.0 / b.sqrt())
        });
        (0..3).all(|x| {
            let d3 = third(p, k, x);
            let places = in_interval(p, k, x);
            (0..3).all(|end| {
                let ((b, slope, root), (d1, d2)) = (rates[end], places[end]);
                (d3 * b + 1.5 * d2 * slope + 0.5 * d1 * bend).abs() < self.limits.jerk[x] * root
            })
        })
    }

    /// Gradient and Hessian of time plus barrier.
    fn assemble(&mut self, p: &[[f64; 3]]) {
        self.gradient.fill(0.0);
        self.hessian.fill([0.0; 3]);
        let knots = p.len() - 2;
        let mu = self.barrier;
        for k in 0..=knots {
            self.gradient[k] -= mu / self.rate_square[k];
            self.hessian[k][0] += mu / self.rate_square[k].powi(2);
        }
        for k in 0..knots {
            let (c0, c1) = (self.rate_square[k], self.rate_square[k + 1]);
            let (b, slope) = (f64::midpoint(c0, c1), c1 - c0);
            let root = 1.0 / b.sqrt();
            // Time 1/√b, and the upper end of b.
            let most = RATE_SQUARE_MOST - b;
            let mut first = -0.5 * root / b + mu / most;
            let mut second = 0.75 * root / (b * b) + mu / (most * most);
            let mut square = 0.0;
            for x in 0..3 {
                let (d1, d2) = at_knot(p, k, x);
                square += d1 * d1;
                let top = self.limits.velocity[x].powi(2) - d1 * d1 * b;
                first += mu * d1 * d1 / top;
                second += mu * (d1 * d1 / top).powi(2);
                let value = d2 * b + 0.5 * d1 * slope;
                let lever = [0.5 * d2 - 0.5 * d1, 0.5 * d2 + 0.5 * d1, 0.0];
                self.add(k, lever, [0.0; 3], self.limits.acceleration[x], value);
            }
            let top = self.feed[k].powi(2) - square * b;
            first += mu * square / top;
            second += mu * (square / top).powi(2);
            for (i, row) in [k, k + 1].into_iter().enumerate() {
                self.gradient[row] += 0.5 * first;
                self.hessian[row][0] += 0.25 * second;
                if i == 1 {
                    self.hessian[row][1] += 0.25 * second;
                }
            }
        }
        for k in 0..knots - 1 {
            let c = [self.rate_square[k], self.rate_square[k + 1], self.rate_square[k + 2]];
            let dot = |w: &[f64; 3]| w[0] * c[0] + w[1] * c[1] + w[2] * c[2];
            let bend = dot(&BEND);
            for (end, (wb, ws)) in WEIGHTS.iter().enumerate() {
                let (b, slope) = (dot(wb), dot(ws));
                let root = 1.0 / b.sqrt();
                for x in 0..3 {
                    let (d1, d2) = in_interval(p, k, x)[end];
                    let d3 = third(p, k, x);
                    let value = d3 * b + 1.5 * d2 * slope + 0.5 * d1 * bend;
                    let lever = [0, 1, 2].map(|i| d3 * wb[i] + 1.5 * d2 * ws[i] + 0.5 * d1 * BEND[i]);
                    // The limit itself falls with b: J/√b.
                    let falls = wb.map(|w| -0.5 * self.limits.jerk[x] * root / b * w);
                    self.add(k, lever, falls, self.limits.jerk[x] * root, value);
                }
            }
        }
    }

    /// Adds the barrier of |value| ≤ limit, both with their gradients by three coefficients from `k` on.
    fn add(&mut self, k: usize, lever: [f64; 3], falls: [f64; 3], limit: f64, value: f64) {
        for way in [1.0, -1.0] {
            let inverse = 1.0 / (limit - way * value);
            let slope = [0, 1, 2].map(|i| (falls[i] - way * lever[i]) * inverse);
            for row in 0..3 {
                if k + row >= self.gradient.len() {
                    continue;
                }
                self.gradient[k + row] -= self.barrier * slope[row];
                for lag in 0..=row {
                    self.hessian[k + row][lag] += self.barrier * slope[row] * slope[row - lag];
                }
            }
        }
    }

    /// The Newton step by a banded Cholesky factor, in place.
    fn solve(&mut self) {
        let n = self.gradient.len();
        for row in 0..n {
            for lag in (0..3.min(row + 1)).rev() {
                let column = row - lag;
                let mut sum = self.hessian[row][lag];
                for back in lag + 1..3.min(row + 1) {
                    sum -= self.hessian[row][back] * self.hessian[column][back - lag];
                }
                self.hessian[row][lag] =
                    if lag == 0 { (sum * (1.0 + 1e-10)).max(1e-300).sqrt() } else { sum / self.hessian[column][0] };
            }
            let mut sum = -self.gradient[row];
            for lag in 1..3.min(row + 1) {
                sum -= self.hessian[row][lag] * self.step[row - lag];
            }
            self.step[row] = sum / self.hessian[row][0];
        }
        for row in (0..n).rev() {
            let mut sum = self.step[row];
            for lag in 1..3.min(n - row) {
                sum -= self.hessian[row + lag][lag] * self.step[row + lag];
            }
            self.step[row] = sum / self.hessian[row][0];
        }
    }
}
