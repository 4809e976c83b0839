//! Smoothing: the curve with minimum jerk within the tolerance band around a contour.
//!
//! Moves the control points of a uniform cubic B-spline over nominal time until the sum of the squares of their third
//! differences is minimal while every knot lies in the band. A knot may move along the contour, so the smoothing also
//! determines the timing. Knows nothing of velocity limits.
//! Source: alternating directions (ADMM, Boyd et al. 2011): a banded least-squares step, whose matrix is constant and
//! factored once, then a projection of each knot into the band. Every pass can be interrupted and resumed at any knot.

use super::per_coordinate;
use super::tolerance_band::{AxisBounds, NearestPoint, ToleranceBand};
use crate::units::WorkBudget;

/// Maximum number of control points.
pub const MAX_CONTROL_POINTS: usize = 640;
/// Weight of the band constraint relative to jerk; found by trial on the benchmark paths.
const BAND_WEIGHT: f64 = 0.03;
/// Over-relaxation, 1 to 2.
const RELAXATION: f64 = 1.7;
/// Minimum number of fixed control points at either end: they define position, velocity and acceleration there.
pub const FIXED_POINTS: usize = 3;
/// The bounds of a knot are narrowed by this share of the radius, so that an unfinished iteration stays inside.
const BOUNDS_MARGIN: f64 = 0.01;
/// Work units of one knot in each pass.
const COST_BEGIN: usize = 60;
const COST_FACTOR: usize = 30;
const COST_SOLVE: usize = 16;
const COST_PROJECT: usize = 50;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SmoothingPass {
    Begin,
    Factor,
    Forward,
    Back,
    Project,
}

/// State of one knot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Knot {
    target: [f64; 3],
    dual: [f64; 3],
    /// Range of distances along the contour that it may be projected to, mm.
    reach: (f64, f64),
    /// Its present distance along the contour, mm, and move index.
    pub near: (f64, usize),
    /// Allowed deviation from the contour, mm.
    pub radius: f64,
    /// Axis bounds, mm.
    pub bounds: AxisBounds,
}

/// Control points and the state of the iteration.
#[derive(Clone, Debug)]
pub struct CurveSmoother {
    /// Control points; the last three are fixed at the end point.
    pub points: Vec<[f64; 3]>,
    /// Number of given control points at the start: three at rest, in motion those taken over from the previous curve.
    pub lead: usize,
    /// Distance of each knot along the contour by the timing, mm; smoothing may move a knot as far as its neighbours.
    pub along: Vec<f64>,
    /// The knots, one per control point; the first and the last are unused.
    pub knots: Vec<Knot>,
    factor: Vec<[f64; 4]>,
    /// Right-hand side per knot in the least-squares step: its target minus its dual.
    attractors: Vec<[f64; 3]>,
    rhs: Vec<[f64; 3]>,
    pass: SmoothingPass,
    cursor: usize,
    share: f64,
    factored_rows: usize,
}

/// Position of a knot from three control points.
fn knot(p: &[[f64; 3]], k: usize) -> [f64; 3] {
    per_coordinate(|x| (p[k - 1][x] + 4.0 * p[k][x] + p[k + 1][x]) / 6.0)
}

impl CurveSmoother {
    /// An empty smoother with capacity for the maximum number of control points.
    pub fn new() -> Self {
        Self {
            points: Vec::with_capacity(MAX_CONTROL_POINTS),
            lead: FIXED_POINTS,
            along: Vec::with_capacity(MAX_CONTROL_POINTS),
            knots: Vec::with_capacity(MAX_CONTROL_POINTS),
            factor: Vec::with_capacity(MAX_CONTROL_POINTS),
            attractors: Vec::with_capacity(MAX_CONTROL_POINTS),
            rhs: Vec::with_capacity(MAX_CONTROL_POINTS),
            pass: SmoothingPass::Begin,
            cursor: 0,
            share: 1.0,
            factored_rows: 0,
        }
    }

    /// Starts from the present control points; `along` must be set for each. `share`: share of every tolerance used.
    pub fn begin(&mut self, share: f64) {
        self.share = share;
        self.pass = SmoothingPass::Begin;
        self.cursor = 0;
        self.knots.clear();
    }

    /// Works until one iteration is done; false if the work budget was spent before.
    pub fn iterate(&mut self, band: &ToleranceBand, budget: &mut WorkBudget) -> bool {
        loop {
            let n = self.points.len();
            let (end, cost) = match self.pass {
                SmoothingPass::Begin => (n, COST_BEGIN),
                SmoothingPass::Factor => (n, COST_FACTOR),
                SmoothingPass::Forward | SmoothingPass::Back => (n - self.lead - FIXED_POINTS, COST_SOLVE),
                SmoothingPass::Project => (n - 1, COST_PROJECT),
            };
            let from = self.cursor;
            let until = budget.spend_on_slice(from, end, cost);
            match self.pass {
                SmoothingPass::Begin => (from..until).for_each(|k| self.begin_knot(band, k)),
                SmoothingPass::Factor => (from..until).for_each(|k| self.factor_row(k)),
                SmoothingPass::Forward => (from..until).for_each(|k| self.forward(k + self.lead)),
                SmoothingPass::Back => (from..until).for_each(|k| self.back(n - FIXED_POINTS - 1 - k)),
                SmoothingPass::Project => (from..until).for_each(|k| self.project(band, k)),
            }
            self.cursor = until;
            if until < end {
                return false;
            }
            (self.pass, self.cursor) = match self.pass {
                SmoothingPass::Begin => (SmoothingPass::Factor, 0),
                SmoothingPass::Factor => (SmoothingPass::Forward, 0),
                SmoothingPass::Forward => (SmoothingPass::Back, 0),
                // The knots before `lead - 1` are given, like their control points.
                SmoothingPass::Back => (SmoothingPass::Project, self.lead - 1),
                SmoothingPass::Project => {
                    (self.pass, self.cursor) = (SmoothingPass::Forward, 0);
                    return true;
                }
            };
        }
    }

    fn begin_knot(&mut self, band: &ToleranceBand, k: usize) {
        let n = self.points.len();
        let along = self.along[k].max(0.0).min(band.end);
        let segment = band.segment_at(along);
        let (start, end) = band.smooth_run(segment);
        let low = self.along[k.max(1) - 1].max(start).max(0.0);
        let high = self.along[(k + 1).min(n - 1)].min(end).min(band.end);
        let radius = band.moves[segment].tolerance * self.share;
        let spare = BOUNDS_MARGIN * radius;
        let room = band.bounds(along).map(|(low, high)| {
            let middle = f64::midpoint(low, high);
            ((low + spare).min(middle), (high - spare).max(middle))
        });
        let (target, dual) = (self.points[k], [0.0; 3]);
        self.knots.push(Knot { target, dual, reach: (low, high), near: (along, segment), radius, bounds: room });
        if self.factor.len() <= k {
            self.factor.push([0.0; 4]);
        }
        match self.rhs.get_mut(k) {
            Some(rhs) => *rhs = [0.0; 3],
            None => self.rhs.push([0.0; 3]),
        }
        match self.attractors.get_mut(k) {
            Some(aim) => *aim = target,
            None => self.attractors.push(target),
        }
    }

    /// One row of the banded Cholesky factor of D3ᵀD3 + weight MᵀM over the free control points; the diagonal is stored
    /// inverted. The rows do not depend on the number of control points.
    fn factor_row(&mut self, row: usize) {
        if row < FIXED_POINTS || row < self.factored_rows {
            return;
        }
        let mut line = [0.0; 4];
        for lag in (0..4_usize).rev() {
            if row < FIXED_POINTS + lag {
                continue;
            }
            let column = row - lag;
            let mut sum = band(lag);
            for (back, entry) in line.iter().enumerate().skip(lag + 1).filter(|(back, _)| row >= FIXED_POINTS + back) {
                sum -= entry * if lag == 0 { *entry } else { self.factor[column][back - lag] };
            }
            line[lag] = if lag == 0 { 1.0 / sum.max(1e-12).sqrt() } else { sum * self.factor[column][0] };
        }
        self.factor[row] = line;
        self.factored_rows = row + 1;
    }

    /// Right-hand side and forward substitution of one row. The rows before the first are zero.
    fn forward(&mut self, row: usize) {
        let n = self.points.len();
        let aim = [self.attractors[row - 1], self.attractors[row], self.attractors[row + 1]];
        let mut sum = per_coordinate(|x| (BAND_WEIGHT / 6.0) * (aim[0][x] + 4.0 * aim[1][x] + aim[2][x]));
        // Contribution of the fixed control points (D3 and M), moved to the right-hand side.
        let lead = self.lead;
        if row < lead + FIXED_POINTS || row >= n - 2 * FIXED_POINTS {
            for column in (row - 3..=row + 3).filter(|c| *c < lead || *c >= n - FIXED_POINTS) {
                let entry = band(row.abs_diff(column));
                (0..3).for_each(|x| sum[x] -= entry * self.points[column][x]);
            }
        }
        let line = self.factor[row - lead + FIXED_POINTS];
        let before = [self.rhs[row - 1], self.rhs[row - 2], self.rhs[row - 3]];
        // The most recent row last, because its value was just computed.
        self.rhs[row] = per_coordinate(|x| {
            let far = sum[x] - line[3] * before[2][x] - line[2] * before[1][x];
            (far - line[1] * before[0][x]) * line[0]
        });
    }

    fn back(&mut self, row: usize) {
        let n = self.points.len();
        let sum = self.rhs[row];
        let after = |lag: usize| {
            // The fixed points at the end are already in the right-hand side.
            let factor = row + lag - self.lead + FIXED_POINTS;
            if row + lag < n - FIXED_POINTS {
                (self.factor[factor][lag], self.points[row + lag])
            } else {
                (0.0, [0.0; 3])
            }
        };
        let inverse = self.factor[row - self.lead + FIXED_POINTS][0];
        let [(f1, p1), (f2, p2), (f3, p3)] = [after(1), after(2), after(3)];
        self.points[row] = per_coordinate(|x| (sum[x] - f3 * p3[x] - f2 * p2[x] - f1 * p1[x]) * inverse);
    }

    /// Projects one knot into the band, between its neighbours and on its own side of a sharp corner, so that the
    /// allowed set is convex and the iteration does not oscillate between the two sides.
    fn project(&mut self, band: &ToleranceBand, k: usize) {
        let here = knot(&self.points, k);
        let this = &mut self.knots[k];
        let free = per_coordinate(|x| RELAXATION * here[x] + (1.0 - RELAXATION) * this.target[x] + this.dual[x]);
        let NearestPoint { along, point: on, deviation: off, segment } =
            band.nearest(free, this.reach.0, this.reach.1, this.near.1);
        this.near = (along, segment);
        let part = if off > this.radius { this.radius / off } else { 1.0 };
        // The contour lies inside the bounds, so clamping to them never increases the distance to it.
        let inside = per_coordinate(|x| (on[x] + part * (free[x] - on[x])).max(this.bounds[x].0).min(this.bounds[x].1));
        this.target = inside;
        this.dual = per_coordinate(|x| free[x] - inside[x]);
        self.attractors[k] = per_coordinate(|x| 2.0 * inside[x] - free[x]);
    }

    /// Narrows the band at the knots around interval `k`: the radius by `radius` (at least `least` remains) and the
    /// axis bounds by `room`, mm.
    pub fn narrow(&mut self, k: usize, radius: f64, least: f64, room: [(f64, f64); 3]) {
        for knot in &mut self.knots[k + 1..k + 3] {
            knot.radius = (knot.radius - radius).max(least);
            for (bound, by) in knot.bounds.iter_mut().zip(room) {
                let middle = f64::midpoint(bound.0, bound.1);
                *bound = ((bound.0 + by.0).min(middle), (bound.1 - by.1).max(middle));
            }
        }
    }
}

/// Entry of the matrix at a distance from the diagonal.
fn band(lag: usize) -> f64 {
    const THIRD: [f64; 4] = [20.0, -15.0, 6.0, -1.0];
    const MEAN: [f64; 4] = [18.0 / 36.0, 8.0 / 36.0, 1.0 / 36.0, 0.0];
    THIRD[lag] + BAND_WEIGHT * MEAN[lag]
}
