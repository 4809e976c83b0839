//! Smoothing: the curve with minimum jerk within the tolerance band around a contour.
//!
//! Moves the control points of a uniform cubic B-spline over nominal time until the weighted sum of the squares of their
//! third differences is minimal while every knot lies in the band. The weights grow with the jerk, so that its peaks fall. A
//! knot may move along the contour, so the smoothing also determines the timing. The first intervals after a start in motion
//! keep the jerk limit in nominal time, because the rate there is given. Knows nothing of velocity limits.
//! Source: alternating directions (ADMM, Boyd et al. 2011): a banded least-squares step, then a projection of each knot into
//! the band and of each limited third difference into its limits; reweighted least squares towards the fourth power. Every pass can be interrupted and resumed at any knot.

use super::per_coordinate;
use super::tolerance_band::{AxisBounds, NearestPoint, ToleranceBand};
use crate::units::WorkBudget;

/// Maximum number of control points.
pub const MAX_CONTROL_POINTS: usize = 640;
/// Weight of the band constraint relative to jerk; found by trial on the benchmark paths.
const BAND_WEIGHT: f64 = 0.03;
/// Weight of the jerk limit at a start in motion: twice that of the jerk itself.
const JERK_LIMIT_WEIGHT: f64 = 2.0;
/// Share of the jerk limit that the first intervals may use: the iteration is unfinished.
const JERK_LIMIT_SHARE: f64 = 0.95;
/// Over-relaxation, 1 to 2.
const RELAXATION: f64 = 1.7;
/// Minimum number of fixed control points at either end: they define position, velocity and acceleration there.
pub const FIXED_POINTS: usize = 3;
/// Control points on either side of a repair that move with it: the curve bends over about that many.
const FOCUS_REACH: usize = 12;
/// The bounds of a knot are narrowed by this share of the radius, so that an unfinished iteration stays inside.
const BOUNDS_MARGIN: f64 = 0.01;
/// Iterations between two computations of the weights, and their range.
const ITERATIONS_PER_WEIGHING: u32 = 5;
const WEIGHTS: (f64, f64) = (0.1, 100.0);
/// Third difference of four control points.
const THIRD_DIFFERENCE: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
/// Entries of MᵀM by distance from the diagonal, where M gives the knots.
const MEAN: [f64; 4] = [18.0 / 36.0, 8.0 / 36.0, 1.0 / 36.0, 0.0];
/// Work units of one knot in each pass.
const COST_BEGIN: usize = 50;
const COST_WEIGH: usize = 5;
const COST_FACTOR: usize = 70;
const COST_SOLVE: usize = 11;
const COST_PROJECT: usize = 44;
const COST_PROJECT_JERK: usize = 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SmoothingPass {
    Begin,
    Weigh,
    Factor,
    Forward,
    Back,
    Project,
    ProjectJerk,
}

/// State of one knot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Knot {
    target: [f64; 3],
    dual: [f64; 3],
    /// Range of distances along the contour that it may be projected to, mm; a single one at the end of a stroke.
    reach: (f64, f64),
    /// Its present distance along the contour, mm, and move index.
    pub near: (f64, usize),
    /// Allowed deviation from the contour, mm.
    pub radius: f64,
    /// Axis bounds, mm.
    pub bounds: AxisBounds,
}

/// The limited third difference of an interval, mm.
#[derive(Clone, Copy, Debug)]
struct LimitedJerk {
    target: [f64; 3],
    dual: [f64; 3],
    /// Target minus dual: what the least-squares step aims at.
    attractor: [f64; 3],
}

impl Knot {
    /// Whether it must meet the end of a stroke.
    pub fn is_stroke_end(&self) -> bool {
        self.reach.0 >= self.reach.1
    }
}

/// Control points and the state of the iteration.
#[derive(Clone, Debug)]
pub struct CurveSmoother {
    /// Control points; the first three are given, the last three are fixed at the end point.
    pub points: Vec<[f64; 3]>,
    /// Distance of each knot along the contour by the timing, mm; smoothing may move a knot as far as its neighbours.
    pub along: Vec<f64>,
    /// The knots, one per control point; the first and the last are unused.
    pub knots: Vec<Knot>,
    /// Weight of the third difference of each interval.
    weights: Vec<f64>,
    /// The first intervals, whose jerk is limited.
    limited: Vec<LimitedJerk>,
    /// The third difference at the jerk limit of each axis, mm, and one over it.
    jerk: [f64; 3],
    inverse_jerk: [f64; 3],
    iterations: u32,
    factor: Vec<[f64; 4]>,
    /// Right-hand side per knot in the least-squares step: its target minus its dual.
    attractors: Vec<[f64; 3]>,
    rhs: Vec<[f64; 3]>,
    /// The control points from the first to before the second are moved; the others stand.
    free: (usize, usize),
    pass: SmoothingPass,
    cursor: usize,
    share: f64,
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
            along: Vec::with_capacity(MAX_CONTROL_POINTS),
            knots: Vec::with_capacity(MAX_CONTROL_POINTS),
            weights: Vec::with_capacity(MAX_CONTROL_POINTS),
            limited: Vec::with_capacity(MAX_CONTROL_POINTS),
            jerk: [0.0; 3],
            inverse_jerk: [0.0; 3],
            iterations: 0,
            factor: Vec::with_capacity(MAX_CONTROL_POINTS),
            attractors: Vec::with_capacity(MAX_CONTROL_POINTS),
            rhs: Vec::with_capacity(MAX_CONTROL_POINTS),
            free: (FIXED_POINTS, FIXED_POINTS),
            pass: SmoothingPass::Begin,
            cursor: 0,
            share: 1.0,
        }
    }

    /// Starts from the present control points; `along` must be set for each. `share`: share of every tolerance used;
    /// `jerk`: third difference at the jerk limit of each axis, mm, which the first `limited` intervals keep.
    pub fn begin(&mut self, share: f64, jerk: [f64; 3], limited: usize) {
        self.share = share;
        self.jerk = jerk;
        self.inverse_jerk = jerk.map(|j| 1.0 / j);
        self.iterations = 0;
        self.free = (FIXED_POINTS, self.points.len() - FIXED_POINTS);
        self.pass = SmoothingPass::Begin;
        self.cursor = 0;
        self.knots.clear();
        self.weights.clear();
        self.weights.resize(self.points.len() - FIXED_POINTS, 1.0);
        self.limited.clear();
        for k in 0..limited {
            let target = self.clamp_jerk(self.third_difference(k));
            self.limited.push(LimitedJerk { target, dual: [0.0; 3], attractor: target });
        }
    }

    /// Works until one iteration is done; false if the work budget was spent before.
    pub fn iterate(&mut self, band: &ToleranceBand, budget: &mut WorkBudget) -> bool {
        loop {
            let (first, after) = self.free;
            let (end, cost) = match self.pass {
                SmoothingPass::Begin => (self.points.len(), COST_BEGIN),
                SmoothingPass::Weigh => (self.weights.len(), COST_WEIGH),
                SmoothingPass::Factor => (after - first, COST_FACTOR),
                SmoothingPass::Forward | SmoothingPass::Back => (after - first, COST_SOLVE),
                // The knots of the free control points and one beyond at each end.
                SmoothingPass::Project => (after - first + 2, COST_PROJECT),
                // Only what the free control points can change: elsewhere the duals would grow without an effect.
                SmoothingPass::ProjectJerk => {
                    (self.limited.len().min(after).saturating_sub(first - FIXED_POINTS), COST_PROJECT_JERK)
                }
            };
            let from = self.cursor;
            let until = budget.spend_on_slice(from, end, cost);
            match self.pass {
                SmoothingPass::Begin => (from..until).for_each(|k| self.begin_knot(band, k)),
                SmoothingPass::Weigh => (from..until).for_each(|k| self.weigh(k)),
                SmoothingPass::Factor => (from..until).for_each(|k| self.factor_row(first + k)),
                SmoothingPass::Forward => (from..until).for_each(|k| self.forward(first + k)),
                SmoothingPass::Back => (from..until).for_each(|k| self.back(after - 1 - k)),
                SmoothingPass::Project => (from..until).for_each(|k| self.project(band, first - 1 + k)),
                SmoothingPass::ProjectJerk => (from..until).for_each(|k| self.project_jerk(first - FIXED_POINTS + k)),
            }
            self.cursor = until;
            if until < end {
                return false;
            }
            (self.pass, self.cursor) = match self.pass {
                SmoothingPass::Begin | SmoothingPass::Weigh => (SmoothingPass::Factor, 0),
                SmoothingPass::Factor => (SmoothingPass::Forward, 0),
                SmoothingPass::Forward => (SmoothingPass::Back, 0),
                SmoothingPass::Back => (SmoothingPass::Project, 0),
                SmoothingPass::Project => (SmoothingPass::ProjectJerk, 0),
                SmoothingPass::ProjectJerk => {
                    self.iterations += 1;
                    let is_due = self.iterations.is_multiple_of(ITERATIONS_PER_WEIGHING);
                    self.pass = if is_due { SmoothingPass::Weigh } else { SmoothingPass::Forward };
                    self.cursor = 0;
                    return true;
                }
            };
        }
    }

    fn begin_knot(&mut self, band: &ToleranceBand, k: usize) {
        let n = self.points.len();
        let (mut along, before, after) = (self.along[k], self.along[k.max(1) - 1], self.along[(k + 1).min(n - 1)]);
        // The given control points of a start in motion cannot be moved to the end of a stroke.
        let is_given = k < FIXED_POINTS && !self.limited.is_empty();
        let stroke_end =
            if is_given { None } else { band.stroke_end(f64::midpoint(before, along), f64::midpoint(along, after)) };
        along = stroke_end.unwrap_or(along).max(0.0).min(band.end);
        let segment = band.segment_at(along);
        let (start, end) = band.smooth_run(segment);
        let (low, high) = (before.max(start).max(0.0), after.min(end).min(band.end));
        let (low, high) = stroke_end.map_or((low, high), |at| (at, at));
        let radius = band.moves[segment].tolerance * self.share;
        let spare = BOUNDS_MARGIN * radius;
        let bounds = band.bounds(along);
        let room = per_coordinate(|x| {
            let (low, high) = bounds[x];
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

    /// The weight of an interval: the geometric mean of the last one and the square of its share of the jerk limit.
    fn weigh(&mut self, k: usize) {
        let third = self.third_difference(k);
        let share = (0..3).map(|x| (third[x] * self.inverse_jerk[x]).abs()).fold(0.0, f64::max);
        self.weights[k] = (self.weights[k] * (share * share).clamp(WEIGHTS.0, WEIGHTS.1)).sqrt();
    }

    /// The third difference of an interval, mm.
    fn third_difference(&self, k: usize) -> [f64; 3] {
        let p = &self.points[k..k + 4];
        per_coordinate(|x| p[3][x] - 3.0 * p[2][x] + 3.0 * p[1][x] - p[0][x])
    }

    /// The nearest third difference within the limits.
    fn clamp_jerk(&self, third: [f64; 3]) -> [f64; 3] {
        per_coordinate(|x| {
            let most = JERK_LIMIT_SHARE * self.jerk[x];
            third[x].max(-most).min(most)
        })
    }

    /// Entry of the matrix D3ᵀWD3 + weight MᵀM.
    fn entry(&self, row: usize, column: usize) -> f64 {
        let (low, high) = (row.min(column), row.max(column));
        let last = self.weights.len() - 1;
        let jerk = (high.saturating_sub(3)..=low.min(last))
            .map(|k| self.jerk_weight(k) * THIRD_DIFFERENCE[high - k] * THIRD_DIFFERENCE[low - k]);
        jerk.sum::<f64>() + BAND_WEIGHT * MEAN[high - low]
    }

    /// Weight of the jerk of an interval, with that of its limit.
    fn jerk_weight(&self, k: usize) -> f64 {
        self.weights[k] + if k < self.limited.len() { JERK_LIMIT_WEIGHT } else { 0.0 }
    }

    /// One row of the banded Cholesky factor over the free control points; the diagonal is stored inverted.
    fn factor_row(&mut self, row: usize) {
        let mut line = [0.0; 4];
        for lag in (0..4_usize).rev() {
            if row < self.free.0 + lag {
                continue;
            }
            let column = row - lag;
            let mut sum = self.entry(row, column);
            for (back, entry) in line.iter().enumerate().skip(lag + 1).filter(|(back, _)| row >= self.free.0 + back) {
                sum -= entry * if lag == 0 { *entry } else { self.factor[column][back - lag] };
            }
            line[lag] = if lag == 0 { 1.0 / sum.max(1e-12).sqrt() } else { sum * self.factor[column][0] };
        }
        self.factor[row] = line;
    }

    /// Right-hand side and forward substitution of one row. The factors of rows before the first are zero.
    fn forward(&mut self, row: usize) {
        let (first, after) = self.free;
        let aim = [self.attractors[row - 1], self.attractors[row], self.attractors[row + 1]];
        let mut sum = per_coordinate(|x| (BAND_WEIGHT / 6.0) * (aim[0][x] + 4.0 * aim[1][x] + aim[2][x]));
        for k in row - FIXED_POINTS..self.limited.len().min(row + 1) {
            let (aim, weight) = (&self.limited[k].attractor, JERK_LIMIT_WEIGHT * THIRD_DIFFERENCE[row - k]);
            (0..3).for_each(|x| sum[x] += weight * aim[x]);
        }
        // Contribution of the fixed control points (D3 and M), moved to the right-hand side.
        if row < first + FIXED_POINTS || row + FIXED_POINTS >= after {
            for column in (row - 3..=row + 3).filter(|c| *c < first || *c >= after) {
                let entry = self.entry(row, column);
                (0..3).for_each(|x| sum[x] -= entry * self.points[column][x]);
            }
        }
        let line = self.factor[row];
        let before = [self.rhs[row - 1], self.rhs[row - 2], self.rhs[row - 3]];
        // The most recent row last, because its value was just computed.
        self.rhs[row] = per_coordinate(|x| {
            let far = sum[x] - line[3] * before[2][x] - line[2] * before[1][x];
            (far - line[1] * before[0][x]) * line[0]
        });
    }

    fn back(&mut self, row: usize) {
        let sum = self.rhs[row];
        let after = |lag: usize| {
            // The fixed points at the end are already in the right-hand side.
            if row + lag < self.free.1 {
                (self.factor[row + lag][lag], self.points[row + lag])
            } else {
                (0.0, [0.0; 3])
            }
        };
        let inverse = self.factor[row][0];
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

    /// Projects the third difference of one of the first intervals into the jerk limits.
    fn project_jerk(&mut self, k: usize) {
        let here = self.third_difference(k);
        let LimitedJerk { target, dual, .. } = self.limited[k];
        let free = per_coordinate(|x| RELAXATION * here[x] + (1.0 - RELAXATION) * target[x] + dual[x]);
        let target = self.clamp_jerk(free);
        self.limited[k] = LimitedJerk {
            target,
            dual: per_coordinate(|x| free[x] - target[x]),
            attractor: per_coordinate(|x| 2.0 * target[x] - free[x]),
        };
    }

    /// Continues with the control points around intervals `from` to `to` alone; the rest of the curve stands.
    pub fn focus(&mut self, from: usize, to: usize) {
        let first = from.saturating_sub(FOCUS_REACH).max(FIXED_POINTS);
        let after = (to + FIXED_POINTS + 1 + FOCUS_REACH).min(self.points.len() - FIXED_POINTS);
        self.free = (first, after);
        (self.pass, self.cursor) = (SmoothingPass::Weigh, 0);
    }

    /// The intervals that the free control points shape: the first, and after the last.
    pub fn free_intervals(&self) -> (usize, usize) {
        (self.free.0 - FIXED_POINTS, self.free.1)
    }

    /// The four control points of interval `k`.
    pub fn control_points(&self, k: usize) -> [[f64; 3]; 4] {
        [self.points[k], self.points[k + 1], self.points[k + 2], self.points[k + 3]]
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
