//! Smoothing: the least jerky curve that stays within the tube around a contour.
//!
//! Owns the control points of a uniform cubic B-spline over nominal time and moves them until the sum of the squares of
//! their third differences is least while every knot lies in the tube. Where along the contour a knot lies is free, so
//! the curve also chooses its own timing. Knows nothing of velocity limits.
//! Source: alternating directions (Boyd et al. 2011): a banded least-squares step, whose matrix never changes and is
//! factored once, then each knot by itself back into the tube. Every pass may be left and taken up at any knot.

use super::budget::Budget;
use super::tube::{Nearest, Room, Tube};

/// Control points at most.
pub const POINTS: usize = 640;
/// Weight of staying in the tube against the jerk; found by trial on the benchmark paths.
const TUBE_WEIGHT: f64 = 0.03;
/// Over-relaxation, 1 to 2.
const RELAXATION: f64 = 1.7;
/// Fixed control points at either end at least: position, velocity and acceleration there.
pub const FIXED: usize = 3;
/// The box of a knot is made narrower by this part of the radius, so that an unfinished iteration does not leave it.
const ROOM_SPARE: f64 = 0.01;
/// Units of work of one knot in each pass.
const COST_BEGIN: usize = 60;
const COST_FACTOR: usize = 30;
const COST_SOLVE: usize = 16;
const COST_PROJECT: usize = 50;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    Begin,
    Factor,
    Forward,
    Back,
    Project,
}

/// What is known of one knot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Knot {
    target: [f64; 3],
    dual: [f64; 3],
    /// Between which distances along the contour it may be drawn.
    reach: (f64, f64),
    /// Where along the contour it has come to lie, and on which segment.
    pub near: (f64, usize),
    /// How far it may lie off the contour, mm.
    pub radius: f64,
    /// How far it may go.
    pub room: Room,
}

/// Control points and the state of their iteration.
#[derive(Clone, Debug)]
pub struct Smooth {
    /// Control points; the last three are the end.
    pub points: Vec<[f64; 3]>,
    /// So many of the first are given: three at rest, in motion what is taken over from the curve before.
    pub lead: usize,
    /// Where along the contour the timing has each knot; smoothing may move it to where its neighbours were.
    pub along: Vec<f64>,
    /// The knots, as many as control points; the first and the last are none.
    pub knots: Vec<Knot>,
    factor: Vec<[f64; 4]>,
    /// What the least-squares step draws each knot to: its target less its dual.
    aim: Vec<[f64; 3]>,
    rhs: Vec<[f64; 3]>,
    pass: Pass,
    cursor: usize,
    share: f64,
    kept_factor: usize,
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
            lead: FIXED,
            along: Vec::with_capacity(POINTS),
            knots: Vec::with_capacity(POINTS),
            factor: Vec::with_capacity(POINTS),
            aim: Vec::with_capacity(POINTS),
            rhs: Vec::with_capacity(POINTS),
            pass: Pass::Begin,
            cursor: 0,
            share: 1.0,
            kept_factor: 0,
        }
    }

    /// Begin from the control points given, with `along` set for each of them and a part of every tolerance.
    pub fn begin(&mut self, share: f64) {
        self.share = share;
        self.pass = Pass::Begin;
        self.cursor = 0;
        self.knots.clear();
    }

    /// Works until one iteration is over; false when the work of the tick was spent before.
    pub fn iterate(&mut self, tube: &Tube, budget: &mut Budget) -> bool {
        loop {
            let n = self.points.len();
            let (end, cost) = match self.pass {
                Pass::Begin => (n, COST_BEGIN),
                Pass::Factor => (n, COST_FACTOR),
                Pass::Forward | Pass::Back => (n - self.lead - FIXED, COST_SOLVE),
                Pass::Project => (n - 1, COST_PROJECT),
            };
            let from = self.cursor;
            let until = budget.slice(from, end, cost);
            match self.pass {
                Pass::Begin => (from..until).for_each(|k| self.begin_knot(tube, k)),
                Pass::Factor => (from..until).for_each(|k| self.factor_row(k)),
                Pass::Forward => (from..until).for_each(|k| self.forward(k + self.lead)),
                Pass::Back => (from..until).for_each(|k| self.back(n - FIXED - 1 - k)),
                Pass::Project => (from..until).for_each(|k| self.project(tube, k)),
            }
            self.cursor = until;
            if until < end {
                return false;
            }
            (self.pass, self.cursor) = match self.pass {
                Pass::Begin => (Pass::Factor, 0),
                Pass::Factor => (Pass::Forward, 0),
                Pass::Forward => (Pass::Back, 0),
                // Before that, knots are given as the points are.
                Pass::Back => (Pass::Project, self.lead - 1),
                Pass::Project => {
                    (self.pass, self.cursor) = (Pass::Forward, 0);
                    return true;
                }
            };
        }
    }

    fn begin_knot(&mut self, tube: &Tube, k: usize) {
        let n = self.points.len();
        let along = self.along[k].max(0.0).min(tube.end);
        let segment = tube.segment_at(along);
        let (start, end) = tube.smooth_run(segment);
        let low = self.along[k.max(1) - 1].max(start).max(0.0);
        let high = self.along[(k + 1).min(n - 1)].min(end).min(tube.end);
        let radius = tube.pieces[segment].tolerance * self.share;
        let spare = ROOM_SPARE * radius;
        let room = tube.room(along).map(|(low, high)| {
            let middle = f64::midpoint(low, high);
            ((low + spare).min(middle), (high - spare).max(middle))
        });
        let (target, dual) = (self.points[k], [0.0; 3]);
        self.knots.push(Knot { target, dual, reach: (low, high), near: (along, segment), radius, room });
        if self.factor.len() <= k {
            self.factor.push([0.0; 4]);
        }
        match self.rhs.get_mut(k) {
            Some(rhs) => *rhs = [0.0; 3],
            None => self.rhs.push([0.0; 3]),
        }
        match self.aim.get_mut(k) {
            Some(aim) => *aim = target,
            None => self.aim.push(target),
        }
    }

    /// One row of the banded Cholesky factor of D3ᵀD3 + weight MᵀM over the free control points; the diagonal is kept
    /// inverted. The rows do not depend on how many there are.
    fn factor_row(&mut self, row: usize) {
        if row < FIXED || row < self.kept_factor {
            return;
        }
        let mut line = [0.0; 4];
        for lag in (0..4_usize).rev() {
            if row < FIXED + lag {
                continue;
            }
            let column = row - lag;
            let mut sum = band(lag);
            for (back, entry) in line.iter().enumerate().skip(lag + 1).filter(|(back, _)| row >= FIXED + back) {
                sum -= entry * if lag == 0 { *entry } else { self.factor[column][back - lag] };
            }
            line[lag] = if lag == 0 { 1.0 / sum.max(1e-12).sqrt() } else { sum * self.factor[column][0] };
        }
        self.factor[row] = line;
        self.kept_factor = row + 1;
    }

    /// Right-hand side and forward substitution of one row. The first rows have nothing before them: zeros.
    fn forward(&mut self, row: usize) {
        let n = self.points.len();
        let aim = [self.aim[row - 1], self.aim[row], self.aim[row + 1]];
        let mut sum = [0, 1, 2].map(|x| (TUBE_WEIGHT / 6.0) * (aim[0][x] + 4.0 * aim[1][x] + aim[2][x]));
        // What the fixed control points add: D3 and M of them, taken to the right-hand side.
        let lead = self.lead;
        if row < lead + FIXED || row >= n - 2 * FIXED {
            for column in (row - 3..=row + 3).filter(|c| *c < lead || *c >= n - FIXED) {
                let entry = band(row.abs_diff(column));
                (0..3).for_each(|x| sum[x] -= entry * self.points[column][x]);
            }
        }
        let line = self.factor[row - lead + FIXED];
        let before = [self.rhs[row - 1], self.rhs[row - 2], self.rhs[row - 3]];
        // The nearest last: it is the one just found.
        self.rhs[row] = [0, 1, 2].map(|x| {
            let far = sum[x] - line[3] * before[2][x] - line[2] * before[1][x];
            (far - line[1] * before[0][x]) * line[0]
        });
    }

    fn back(&mut self, row: usize) {
        let n = self.points.len();
        let sum = self.rhs[row];
        let after = |lag: usize| {
            // The fixed points at the end are on the right-hand side already.
            let factor = row + lag - self.lead + FIXED;
            if row + lag < n - FIXED { (self.factor[factor][lag], self.points[row + lag]) } else { (0.0, [0.0; 3]) }
        };
        let inverse = self.factor[row - self.lead + FIXED][0];
        let [(f1, p1), (f2, p2), (f3, p3)] = [after(1), after(2), after(3)];
        self.points[row] = [0, 1, 2].map(|x| (sum[x] - f3 * p3[x] - f2 * p2[x] - f1 * p1[x]) * inverse);
    }

    /// One knot back into the tube: to the place of the contour between its neighbours' places and on its own side of a
    /// sharp corner, so that the places allowed are convex and the iteration does not waver between the legs.
    fn project(&mut self, tube: &Tube, k: usize) {
        let here = knot(&self.points, k);
        let this = &mut self.knots[k];
        let wish = [0, 1, 2].map(|x| RELAXATION * here[x] + (1.0 - RELAXATION) * this.target[x] + this.dual[x]);
        let Nearest { along, on, off, segment } = tube.nearest(wish, this.reach.0, this.reach.1, this.near.1);
        this.near = (along, segment);
        let part = if off > this.radius { this.radius / off } else { 1.0 };
        // Toward the box is toward the contour, which lies in it: the distance only shrinks.
        let inside = [0, 1, 2].map(|x| (on[x] + part * (wish[x] - on[x])).max(this.room[x].0).min(this.room[x].1));
        this.target = inside;
        this.dual = [0, 1, 2].map(|x| wish[x] - inside[x]);
        self.aim[k] = [0, 1, 2].map(|x| 2.0 * inside[x] - wish[x]);
    }

    /// Makes the tube narrower at the knots around interval `k`: by so much of the radius, and so much at either side of
    /// the box, mm.
    pub fn narrow(&mut self, k: usize, radius: f64, least: f64, room: [(f64, f64); 3]) {
        for knot in &mut self.knots[k + 1..k + 3] {
            knot.radius = (knot.radius - radius).max(least);
            for (bound, by) in knot.room.iter_mut().zip(room) {
                let middle = f64::midpoint(bound.0, bound.1);
                *bound = ((bound.0 + by.0).min(middle), (bound.1 - by.1).max(middle));
            }
        }
    }
}

/// Entry of the matrix at a distance from its diagonal.
fn band(lag: usize) -> f64 {
    const THIRD: [f64; 4] = [20.0, -15.0, 6.0, -1.0];
    const MEAN: [f64; 4] = [18.0 / 36.0, 8.0 / 36.0, 1.0 / 36.0, 0.0];
    THIRD[lag] + TUBE_WEIGHT * MEAN[lag]
}
