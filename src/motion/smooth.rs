//! Smoothing: the least jerky curve that stays within the tolerance of a contour.
//!
//! Owns the control points of a uniform cubic B-spline over nominal time and moves them until the sum of the squares of
//! their third differences is least while every knot lies in the tube around the contour. Where along the contour a knot
//! lies is free, so the curve also chooses its own timing. Knows nothing of velocity limits.
//! Source: alternating directions (Boyd et al. 2011): a banded least-squares step, whose matrix never changes and is
//! factored once, then each knot by itself back into the tube.

use super::contour::Segment;
use super::contour::{NO_LENGTH_MM, distance};

/// Control points at most.
pub const POINTS: usize = 1_280;
/// Weight of staying in the tube against the jerk; found by trial on the benchmark paths.
const TUBE_WEIGHT: f64 = 0.03;
/// Corners of more than 8° (its cosine) are sharp.
const SHARP_COSINE: f64 = 0.99;
/// Over-relaxation, 1 to 2.
const RELAXATION: f64 = 1.7;
/// Fixed control points at either end: the curve starts and ends at rest there.
const FIXED: usize = 3;

/// The contour of a run of moves and its tolerance.
#[derive(Clone, Debug, Default)]
pub struct Tube {
    /// The moves in order.
    pub segments: Vec<Segment>,
    /// Distance from the start to the beginning of each, mm; one more than segments.
    pub along: Vec<f64>,
    /// For each move, where the run of moves without a sharp corner that it belongs to begins and ends, mm.
    pub smooth_run: Vec<(f64, f64)>,
}

impl Tube {
    /// Finds the sharp corners.
    pub fn mark_corners(&mut self) {
        let count = self.segments.len();
        self.smooth_run.clear();
        self.smooth_run.resize(count, (0.0, self.length()));
        for k in 1..count {
            let ([_, a], [b, _]) = (self.segments[k - 1].directions(), self.segments[k].directions());
            let cosine: f64 = (0..3).map(|x| a[x] * b[x]).sum();
            self.smooth_run[k].0 = if cosine < SHARP_COSINE { self.along[k] } else { self.smooth_run[k - 1].0 };
        }
        for k in (1..count).rev() {
            let (start, end) = self.smooth_run[k];
            self.smooth_run[k - 1].1 = if start < self.along[k] { end } else { self.along[k] };
        }
    }

    /// Length, mm.
    pub fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// The segment that a distance from the start falls in.
    pub fn segment_at(&self, along: f64) -> usize {
        self.along.partition_point(|start| *start <= along).clamp(1, self.segments.len().max(1)) - 1
    }

    /// The point at a distance from the start.
    pub fn at(&self, along: f64) -> [f64; 3] {
        let k = self.segment_at(along);
        self.segments[k].at(along - self.along[k])
    }

    /// The place between two distances from the start that is nearest to `point`: its distance along, itself, how far
    /// off the point is, and the segment it lies on.
    pub fn nearest(&self, point: [f64; 3], low: f64, high: f64) -> Nearest {
        let (first, last) = (self.segment_at(low), self.segment_at(high - NO_LENGTH_MM));
        let last = last.max(first);
        let mut best = Nearest { along: low, on: point, off: f64::INFINITY, segment: first };
        for segment in first..=last {
            let start = self.along[segment];
            let along = self.segments[segment].nearest(point).max(low - start).min(high - start);
            let on = self.segments[segment].at(along);
            let off = distance(on, point);
            if off < best.off {
                best = Nearest { along: start + along, on, off, segment };
            }
        }
        best
    }
}

/// A place on the contour near a point.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Distance from the start, mm.
    pub along: f64,
    /// The place.
    pub on: [f64; 3],
    /// Distance of the point from it, mm.
    pub off: f64,
    /// The segment it lies on.
    pub segment: usize,
}

/// Control points and the state of their iteration.
#[derive(Clone, Debug)]
pub struct Smooth {
    /// Control points; the first three and the last three are the ends.
    pub points: Vec<[f64; 3]>,
    target: Vec<[f64; 3]>,
    dual: Vec<[f64; 3]>,
    /// Where along the contour the timing has each knot; smoothing may move it to where its neighbours were.
    pub along: Vec<f64>,
    /// Where along the contour each knot has come to lie, and on which segment.
    pub near: Vec<(f64, usize)>,
    /// How far each knot may lie off the contour, mm.
    pub radius: Vec<f64>,
    factor: Vec<[f64; 4]>,
    rhs: Vec<[f64; 3]>,
    /// The greatest distance of a knot from its place in the tube at the last iteration, mm.
    pub residual: f64,
}

/// Knot from three control points.
fn knot(p: &[[f64; 3]], k: usize) -> [f64; 3] {
    [0, 1, 2].map(|x| (p[k - 1][x] + 4.0 * p[k][x] + p[k + 1][x]) / 6.0)
}

impl Smooth {
    /// Room for the most control points.
    pub fn new() -> Self {
        Self {
            points: Vec::with_capacity(POINTS),
            target: Vec::with_capacity(POINTS),
            dual: Vec::with_capacity(POINTS),
            along: Vec::with_capacity(POINTS),
            near: Vec::with_capacity(POINTS),
            radius: Vec::with_capacity(POINTS),
            factor: Vec::with_capacity(POINTS),
            rhs: Vec::with_capacity(POINTS),
            residual: f64::INFINITY,
        }
    }

    /// Begin from the control points given; `along` is set for each of them.
    pub fn begin(&mut self, radius: f64) {
        let n = self.points.len();
        self.radius.clear();
        self.radius.resize(n, radius);
        self.near.clear();
        self.near.resize(n, (0.0, 0));
        self.target.clear();
        self.target.extend_from_slice(&self.points);
        self.dual.clear();
        self.dual.resize(n, [0.0; 3]);
        self.rhs.clear();
        self.rhs.resize(n, [0.0; 3]);
        self.factorise();
    }

    /// Banded Cholesky factor of D3ᵀD3 + weight MᵀM over the free control points.
    fn factorise(&mut self) {
        let n = self.points.len();
        let third = [-1.0, 3.0, -3.0, 1.0];
        let mean = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
        let auto = |of: &[f64], lag: usize| (lag..of.len()).map(|k| of[k] * of[k - lag]).sum::<f64>();
        let mut band = [0.0; 4];
        for (lag, entry) in band.iter_mut().enumerate() {
            *entry = auto(&third, lag) + TUBE_WEIGHT * auto(&mean, lag);
        }
        self.factor.clear();
        self.factor.resize(n, [0.0; 4]);
        for row in FIXED..n - FIXED {
            let mut line = [0.0; 4];
            for lag in (0..4).rev() {
                if row < FIXED + lag {
                    continue;
                }
                let column = row - lag;
                let mut sum = band[lag];
                for (back, entry) in line.iter().enumerate().skip(lag + 1).filter(|(back, _)| row >= FIXED + back) {
                    let other = if lag == 0 { *entry } else { self.factor[column][back - lag] };
                    sum -= entry * other;
                }
                line[lag] = if lag == 0 { sum.max(1e-12).sqrt() } else { sum / self.factor[column][0] };
            }
            self.factor[row] = line;
        }
    }

    /// One iteration.
    pub fn iterate(&mut self, tube: &Tube) {
        self.solve();
        let n = self.points.len();
        self.residual = 0.0;
        for k in 1..n - 1 {
            let here = knot(&self.points, k);
            let before = self.target[k];
            let relaxed = [0, 1, 2].map(|x| RELAXATION * here[x] + (1.0 - RELAXATION) * before[x]);
            let wish = [0, 1, 2].map(|x| relaxed[x] + self.dual[k][x]);
            let Nearest { along, on, off, segment } = self.reach(tube, k, wish);
            self.near[k] = (along, segment);
            let radius = self.radius[k];
            let part = if off > radius { radius / off } else { 1.0 };
            let inside = [0, 1, 2].map(|x| on[x] + part * (wish[x] - on[x]));
            self.target[k] = inside;
            self.dual[k] = [0, 1, 2].map(|x| wish[x] - inside[x]);
            self.residual = self.residual.max(distance(here, inside));
        }
    }

    /// The place of the contour that knot `k` is drawn to: between its neighbours, and on its own side of a sharp corner,
    /// so that the places allowed are convex and the iteration does not waver between the legs.
    fn reach(&self, tube: &Tube, k: usize, wish: [f64; 3]) -> Nearest {
        let (start, end) = tube.smooth_run[tube.segment_at(self.along[k])];
        tube.nearest(wish, self.along[k - 1].max(start), self.along[k + 1].min(end))
    }

    /// The least-squares step: free control points from targets and duals.
    fn solve(&mut self) {
        let n = self.points.len();
        let aim = |s: &Self, k: usize, x: usize| s.target[k][x] - s.dual[k][x];
        let third = [-1.0, 3.0, -3.0, 1.0];
        for row in FIXED..n - FIXED {
            let mut sum = [0.0; 3];
            for (x, value) in sum.iter_mut().enumerate() {
                *value = TUBE_WEIGHT * (aim(self, row - 1, x) + 4.0 * aim(self, row, x) + aim(self, row + 1, x)) / 6.0;
            }
            self.rhs[row] = sum;
        }
        // What the fixed control points add: D3 and M of them, taken to the right-hand side.
        for row in (FIXED..2 * FIXED).chain(n - 2 * FIXED..n - FIXED) {
            for column in (row - 3..=row + 3).filter(|c| *c < FIXED || *c >= n - FIXED) {
                let lag = row.abs_diff(column);
                let entry = (lag..4).map(|k| third[k] * third[k - lag]).sum::<f64>()
                    + TUBE_WEIGHT * [18.0, 8.0, 1.0, 0.0][lag] / 36.0;
                for x in 0..3 {
                    self.rhs[row][x] -= entry * self.points[column][x];
                }
            }
        }
        for row in FIXED..n - FIXED {
            let line = self.factor[row];
            for x in 0..3 {
                let mut sum = self.rhs[row][x];
                for (lag, entry) in line.iter().enumerate().take(row - FIXED + 1).skip(1) {
                    sum -= entry * self.rhs[row - lag][x];
                }
                self.rhs[row][x] = sum / line[0];
            }
        }
        for row in (FIXED..n - FIXED).rev() {
            for x in 0..3 {
                let mut sum = self.rhs[row][x];
                for lag in 1..4.min(n - FIXED - row) {
                    sum -= self.factor[row + lag][lag] * self.points[row + lag][x];
                }
                self.points[row][x] = sum / self.factor[row][0];
            }
        }
    }
}
