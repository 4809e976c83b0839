//! The limits along one curve as factors on the coefficients of b.
//!
//! For every knot and interval: velocity, acceleration and jerk of each moving axis at a rate of 1, relative to their
//! limits (value ≤ 1). Knows nothing of the optimisation.

use super::KnotLimits;
use crate::motion::per_coordinate;
use crate::motion::smoother::MAX_CONTROL_POINTS;

/// Weights of three coefficients in b and b' at the left end, the middle and the right end of an interval; b'': `SECOND_DIFFERENCE`.
pub const WEIGHTS: [([f64; 3], [f64; 3]); 3] = [
    ([0.5, 0.5, 0.0], [-1.0, 1.0, 0.0]),
    ([0.125, 0.75, 0.125], [-0.5, 0.0, 0.5]),
    ([0.0, 0.5, 0.5], [0.0, -1.0, 1.0]),
];
const SECOND_DIFFERENCE: [f64; 3] = [1.0, -2.0, 1.0];
/// An axis that changes by less than this over an interval does not move, mm.
const MIN_MOTION_MM: f64 = 1e-13;

/// One axis at one knot and in the interval after it.
#[derive(Clone, Copy, Debug, Default)]
pub struct LimitTerm {
    /// Factor of the squared velocity on b.
    pub velocity: f64,
    /// Factors of the acceleration on the two coefficients at the knot.
    pub acceleration: [f64; 2],
    /// Factors of jerk/√b on three coefficients, at the left end, the middle and the right end of the interval.
    pub jerk: [[f64; 3]; 3],
}

/// The limit terms of all knots of a curve.
#[derive(Clone, Debug, Default)]
pub struct LimitTerms {
    /// Of each axis, knot by knot.
    knots: Vec<[LimitTerm; 3]>,
    /// Factors of the squared path speed on b, at each knot and in the middle of the interval after it.
    pub speed: Vec<[f64; 2]>,
    /// The moving axes are the first `moving_count` of these.
    axes: [usize; 3],
    moving_count: usize,
}

/// First and second derivative of one axis at a knot.
fn at_knot(p: &[[f64; 3]], k: usize, x: usize) -> (f64, f64) {
    ((p[k + 2][x] - p[k][x]) / 2.0, p[k][x] - 2.0 * p[k + 1][x] + p[k + 2][x])
}

impl LimitTerms {
    pub fn new() -> Self {
        let (knots, speed) = (Vec::with_capacity(MAX_CONTROL_POINTS), Vec::with_capacity(MAX_CONTROL_POINTS));
        Self { knots, speed, axes: [0, 1, 2], moving_count: 0 }
    }

    pub fn clear(&mut self) {
        self.knots.clear();
        self.speed.clear();
        (self.axes, self.moving_count) = ([0, 1, 2], 0);
    }

    /// Number of moving axes.
    pub const fn moving_axes(&self) -> usize {
        self.moving_count
    }

    /// The terms of knot `k` for the moving axes.
    #[inline]
    pub fn at(&self, k: usize) -> impl Iterator<Item = &LimitTerm> {
        let row = &self.knots[k];
        self.axes.iter().take(self.moving_count).map(|axis| &row[*axis])
    }

    fn mark_moving(&mut self, axis: usize) {
        if let Some(at) = self.axes.iter().skip(self.moving_count).position(|other| *other == axis) {
            self.axes.swap(self.moving_count, self.moving_count + at);
            self.moving_count += 1;
        }
    }

    /// Appends the terms of knot `k`; `feed` is the maximum path speed there, mm per spacing.
    pub fn push(&mut self, p: &[[f64; 3]], k: usize, limits: &KnotLimits, feed: f64) {
        let interval = k + 3 < p.len();
        // At the knot and in the middle of the interval after it.
        let (mut square, mut middle) = (0.0, 0.0);
        let mut row = [LimitTerm::default(); 3];
        for x in 0..3 {
            let (d1, d2) = at_knot(p, k, x);
            square += d1 * d1;
            let a = limits.acceleration[x];
            let mut term = LimitTerm {
                velocity: (d1 / limits.velocity[x]).powi(2),
                acceleration: [(d2 - d1) / (2.0 * a), (d2 + d1) / (2.0 * a)],
                jerk: [[0.0; 3]; 3],
            };
            if interval {
                if (p[k + 3][x] - p[k][x]).abs() > MIN_MOTION_MM {
                    self.mark_moving(x);
                }
                let (r1, r2) = at_knot(p, k + 1, x);
                let d3 = r2 - d2;
                let places = [(d1, d2), (d1 + d2 / 2.0 + d3 / 8.0, f64::midpoint(d2, r2)), (r1, r2)];
                middle += places[1].0 * places[1].0;
                let inverse = 1.0 / limits.jerk[x];
                for (jerk, ((d1, d2), (wb, ws))) in term.jerk.iter_mut().zip(places.iter().zip(&WEIGHTS)) {
                    *jerk =
                        per_coordinate(|i| (d3 * wb[i] + 1.5 * d2 * ws[i] + 0.5 * d1 * SECOND_DIFFERENCE[i]) * inverse);
                }
            }
            row[x] = term;
        }
        self.knots.push(row);
        self.speed.push([square, middle].map(|square| square / (feed * feed)));
    }
}
