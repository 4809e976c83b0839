//! The Newton step of the speed plan, computed knot by knot.
//!
//! Barrier functions of all limits with gradient and Hessian, the banded factors, and the fraction of a step
//! that keeps all limits. Knows nothing of the order of the passes.

use super::terms::WEIGHTS;
use super::{MAX_RATE_SQUARE, SpeedOptimizer};
use crate::motion::dot;

/// A step that exceeds a jerk limit is shortened by this factor until it does not, at most this many times.
const STEP_REDUCTION: f64 = 0.8;
const MAX_REDUCTIONS: u32 = 40;
/// Share of the feed that a plan uses: with the slack that may be left, [`MAX_FINAL_SLACK`](super::MAX_FINAL_SLACK) in its
/// square, and what b bulges between the places that are limited, the path speed stays within 0.5 % of the feed (B2):
/// 0.9992 · √1.011 = 1.0047.
const FEED_SHARE: f64 = 0.999_2;
/// Weights of b in the middle of an interval.
const MIDDLE: [f64; 3] = WEIGHTS[1].0;
/// Least pivot as a share of the diagonal entry: cancellation may leave none of it.
const LEAST_PIVOT_SHARE: f64 = 1e-12;
/// Minimum distance to a limit in the barrier, so that a value beyond it by rounding is pushed back.
const MIN_MARGIN: f64 = 1e-9;

/// Inverse distances of a value to a limit and to its negative, with one division.
fn inverse_margins(most: f64, value: f64) -> (f64, f64) {
    let (above, below) = ((most - value).max(MIN_MARGIN), (most + value).max(MIN_MARGIN));
    let inverse = 1.0 / (above * below);
    (below * inverse, above * inverse)
}

impl SpeedOptimizer {
    /// Computes the limit terms of one knot. The wider limits at a start in motion are those of the axes: the feed, whose
    /// square has the slack, is none of them.
    pub(super) fn begin_knot(&mut self, p: &[[f64; 3]], k: usize) {
        self.terms.push(p, k, &self.limits, FEED_SHARE * self.feed[k] / self.lead_slack(k).sqrt());
    }

    /// Whether there is an interval after a knot and not all its coefficients are fixed.
    fn is_free(&self, k: usize) -> bool {
        k + 2 < self.rate_square.len() && k + 3 > self.fixed_count
    }

    /// Measures the factor on the limits that the present coefficients need.
    pub(super) fn measure_need(&mut self, k: usize) {
        let c = &self.rate_square;
        let b = f64::midpoint(c[k], c[k + 1]);
        let mut need = b / MAX_RATE_SQUARE;
        if k + 2 > self.fixed_count {
            need = need.max(self.terms.speed[k][0] * b);
            for term in self.terms.at(k) {
                let a = term.acceleration[0] * c[k] + term.acceleration[1] * c[k + 1];
                need = need.max(term.velocity * b).max(a.abs());
            }
        }
        if self.is_free(k) {
            let c = [c[k], c[k + 1], c[k + 2]];
            need = need.max(self.terms.speed[k][1] * dot(MIDDLE, c));
            for (place, (wb, _)) in WEIGHTS.iter().enumerate() {
                let root = dot(*wb, c).max(0.0).sqrt();
                for term in self.terms.at(k) {
                    need = need.max(dot(term.jerk[place], c).abs() * root);
                }
            }
        }
        self.max_need = self.max_need.max(need);
        self.slack[k] = self.slack_for(k, need).min(self.slack[k]);
        self.max_slack = self.max_slack.max(self.slack[k] / self.lead_slack(k));
    }

    /// Adds time and barrier of one knot and the interval after it to gradient and Hessian.
    pub(super) fn assemble(&mut self, k: usize) {
        let (mu, slack) = (self.barrier, self.slack[k]);
        let last = self.rate_square.len() - 1;
        for row in if k + 1 == last { k..last + 1 } else { k..k + 1 } {
            let inverse = 1.0 / self.rate_square[row];
            self.gradient[row] -= mu * inverse;
            self.hessian[row][0] += mu * inverse * inverse;
        }
        let (c0, c1) = (self.rate_square[k], self.rate_square[k + 1]);
        let b = f64::midpoint(c0, c1);
        let inverse = 1.0 / b;
        let root = inverse.sqrt();
        // Time 1/√b and the upper limits of b. Derivatives by b; each of the two coefficients contributes one half.
        let mut first = -0.5 * root * inverse;
        let mut second = 0.75 * root * inverse * inverse;
        let mut upper = |by: f64, most: f64| {
            let room = by / (most - by * b).max(MIN_MARGIN);
            first += mu * room;
            second += mu * room * room;
        };
        upper(1.0 / MAX_RATE_SQUARE, slack);
        if k + 2 > self.fixed_count {
            upper(self.terms.speed[k][0], slack);
        }
        let (mut g, mut h) = ([0.0; 3], [0.0; 6]);
        if k + 2 > self.fixed_count {
            for term in self.terms.at(k) {
                upper(term.velocity, slack);
                let [l0, l1] = term.acceleration;
                let value = l0 * c0 + l1 * c1;
                let (u, w) = inverse_margins(slack, value);
                let (slope, bend) = (mu * (u - w), mu * (u * u + w * w));
                g[0] += slope * l0;
                g[1] += slope * l1;
                h[0] += bend * l0 * l0;
                h[1] += bend * l1 * l0;
                h[2] += bend * l1 * l1;
            }
        }
        g[0] += 0.5 * first;
        g[1] += 0.5 * first;
        h[0] += 0.25 * second;
        h[1] += 0.25 * second;
        h[2] += 0.25 * second;
        if self.is_free(k) {
            self.assemble_middle_speed(k, &mut g, &mut h);
            self.assemble_jerk(k, &mut g, &mut h);
        }
        let rows = 3.min(self.rate_square.len() - k);
        for row in 0..rows {
            self.gradient[k + row] += g[row];
            for lag in 0..=row {
                self.hessian[k + row][lag] += h[row * (row + 1) / 2 + row - lag];
            }
        }
    }

    /// The barrier of the path speed in the middle of an interval: with the speed limited at the knots alone, b bulges
    /// between them.
    fn assemble_middle_speed(&self, k: usize, g: &mut [f64; 3], h: &mut [f64; 6]) {
        let (mu, by) = (self.barrier, self.terms.speed[k][1]);
        let b = dot(MIDDLE, [self.rate_square[k], self.rate_square[k + 1], self.rate_square[k + 2]]);
        let room = by / (self.slack[k] - by * b).max(MIN_MARGIN);
        for row in 0..3 {
            g[row] += mu * room * MIDDLE[row];
            for column in 0..=row {
                h[row * (row + 1) / 2 + column] += mu * room * room * MIDDLE[row] * MIDDLE[column];
            }
        }
    }

    /// The barrier of |value| ≤ slack/√b at three points of an interval.
    ///
    /// With u and w, the inverse margins above and below, the gradients of the two logarithms are (m' − l)·u and
    /// (m' + l)·w: l are the factors of the jerk, m' = falls · wb is the slope of the limit itself. What stands with wb is
    /// summed over the axes first.
    fn assemble_jerk(&self, k: usize, g: &mut [f64; 3], h: &mut [f64; 6]) {
        let (mu, slack) = (self.barrier, self.slack[k]);
        let c = [self.rate_square[k], self.rate_square[k + 1], self.rate_square[k + 2]];
        for (place, (wb, _)) in WEIGHTS.iter().enumerate() {
            let inverse_root = 1.0 / dot(*wb, c).sqrt();
            let most = slack * inverse_root;
            let falls = -0.5 * most * inverse_root * inverse_root;
            let (mut slopes, mut bends, mut crossed) = (0.0, 0.0, [0.0; 3]);
            for term in self.terms.at(k) {
                let lever = &term.jerk[place];
                let (u, w) = inverse_margins(most, dot(*lever, c));
                let (uu, ww) = (u * u, w * w);
                let (slope, bend, skew) = (mu * (w - u), mu * (uu + ww), mu * (ww - uu));
                slopes += u + w;
                bends += bend;
                for row in 0..3 {
                    g[row] -= slope * lever[row];
                    crossed[row] += skew * lever[row];
                    for column in 0..=row {
                        h[row * (row + 1) / 2 + column] += bend * lever[row] * lever[column];
                    }
                }
            }
            let along = mu * slopes * falls;
            let square = bends * falls * falls;
            for row in 0..3 {
                g[row] -= along * wb[row];
                for column in 0..=row {
                    h[row * (row + 1) / 2 + column] +=
                        wb[row] * (square * wb[column] + falls * crossed[column]) + falls * crossed[row] * wb[column];
                }
            }
        }
    }

    /// One row of the factors L · D · Lᵀ of the Hessian, banded, and of the forward substitution. L has ones in its
    /// diagonal; the inverse of D stands in their place.
    pub(super) fn forward(&mut self, row: usize) {
        if row < self.fixed_count {
            self.hessian[row] = [1.0, 0.0, 0.0];
            self.step[row] = 0.0;
            return;
        }
        let (last, before) = (self.factor_row(row, 1), self.factor_row(row, 2));
        let [mut diagonal, mut first, second] = self.hessian[row];
        first -= second * last.0[1];
        let (l1, l2) = (first * last.0[0], second * before.0[0]);
        let least = LEAST_PIVOT_SHARE * diagonal;
        diagonal -= first * l1 + second * l2;
        self.hessian[row] = [1.0 / diagonal.max(least), l1, l2];
        self.step[row] = -self.gradient[row] - l1 * last.1 - l2 * before.1;
    }

    /// The factor and the substituted value `back` rows before a row; zero where the coefficient is given.
    fn factor_row(&self, row: usize, back: usize) -> ([f64; 3], f64) {
        match row.checked_sub(back).filter(|row| *row >= self.fixed_count) {
            Some(row) => (self.hessian[row], self.step[row]),
            None => ([0.0; 3], 0.0),
        }
    }

    /// One row of the backward substitution.
    pub(super) fn back(&mut self, row: usize) {
        if row < self.fixed_count {
            self.step[row] = 0.0;
            return;
        }
        let mut sum = self.step[row] * self.hessian[row][0];
        for lag in 1..3.min(self.rate_square.len() - row) {
            sum -= self.hessian[row + lag][lag] * self.step[row + lag];
        }
        self.step[row] = sum;
    }

    /// Shortens the step as required by the limits of one knot and the interval after it.
    pub(super) fn limit_step(&mut self, k: usize) {
        let (c, d, slack) = (&self.rate_square, &self.step, self.slack[k]);
        let mut part = self.step_fraction;
        let mut within = |value: f64, change: f64, most: f64| {
            if value + part * change >= most && change > 0.0 {
                part = ((most - value) / change).max(0.0);
            }
        };
        within(-c[k], -d[k], 0.0);
        within(-c[k + 1], -d[k + 1], 0.0);
        let (b, change) = (f64::midpoint(c[k], c[k + 1]), f64::midpoint(d[k], d[k + 1]));
        within(b, change, MAX_RATE_SQUARE * slack);
        if k + 2 > self.fixed_count {
            let speed = self.terms.speed[k][0];
            within(speed * b, speed * change, slack);
            for term in self.terms.at(k) {
                within(term.velocity * b, term.velocity * change, slack);
                let [l0, l1] = term.acceleration;
                let (value, change) = (l0 * c[k] + l1 * c[k + 1], l0 * d[k] + l1 * d[k + 1]);
                within(value, change, slack);
                within(-value, -change, slack);
            }
        }
        if self.is_free(k) {
            within(-c[k + 2], -d[k + 2], 0.0);
            let (c, d) = ([c[k], c[k + 1], c[k + 2]], [d[k], d[k + 1], d[k + 2]]);
            let most = slack * slack;
            let speed = self.terms.speed[k][1];
            within(speed * dot(MIDDLE, c), speed * dot(MIDDLE, d), slack);
            for (place, (wb, _)) in WEIGHTS.iter().enumerate() {
                let (b, change) = (dot(*wb, c), dot(*wb, d));
                for term in self.terms.at(k) {
                    let lever = term.jerk[place];
                    let (value, by) = (dot(lever, c), dot(lever, d));
                    for _ in 0..MAX_REDUCTIONS {
                        let value = value + part * by;
                        if value * value * (b + part * change) < most {
                            break;
                        }
                        part *= STEP_REDUCTION;
                    }
                }
            }
        }
        self.step_fraction = part;
    }
}
