//! The check of the whole plan, set-point by set-point, before any of it is used.
//!
//! Compares velocity, acceleration and jerk (as differences), the distance to the contour and the bounds of each axis.
//! If the curve leaves the tolerance band, the band is narrowed there. If a limit is exceeded, the share of the limits
//! is lowered.

use super::super::feed_scaling::SetpointHistory;
use super::super::setpoint_buffer::spline;
use super::super::smoother::FIXED_POINTS;
use super::{
    CurvePosition, IntervalExcess, LAST_ROUND, LookaheadWindow, MAX_PLAN_TICKS, MAX_REPAIRS, MAX_SLOWDOWNS,
    REPAIR_ITERATIONS, TOLERANCE_SHARE, WindowPhase,
};
use crate::units::WorkBudget;

/// Subdivisions between two checked points where the nearest move changes: at a smooth transition, at a sharp corner.
const CHECKS_AT_CORNER: u32 = 3;
const CHECKS_AT_SHARP_CORNER: u32 = 10;
/// From this share of the tolerance on, one more point is checked in between.
const EDGE_SHARE: f64 = 0.95;
/// Minimum width of a narrowed band, as a share of the tolerance.
const MIN_BAND_SHARE: f64 = 0.02;
/// A repair narrows the band by this share of the tolerance times the repair count, plus the excess times this factor.
const REPAIR_SPARE: f64 = 0.03;
const REPAIR_FACTOR: f64 = 1.6;
/// Maximum overshoot of an axis beyond its reversal point, mm: rounding, below a thousandth of the finest increment.
const MAX_OVERSHOOT_MM: f64 = 5e-7;
/// Tolerance share and overshoot (mm) allowed on the part taken over from the previous plan: slightly more than that
/// plan was allowed, so that this part never fails.
const LEAD_TOLERANCE_SHARE: f64 = 0.987;
const LEAD_MAX_OVERSHOOT_MM: f64 = 9e-7;
/// Work units of one checked point, and of one set-point without its checked points.
const COST_CHECK_POINT: usize = 100;
const COST_CHECK_SETPOINT: usize = 300;

impl LookaheadWindow {
    pub(super) fn begin_curve_check(&mut self) {
        self.begin_excess();
        // The part taken over has already been checked.
        self.cursor = self.smoother.lead - FIXED_POINTS;
        self.phase = WindowPhase::CheckCurve;
    }

    fn begin_excess(&mut self) {
        self.excess.clear();
        self.excess.resize(self.smoother.points.len(), IntervalExcess::default());
        self.is_outside = false;
    }

    /// Checks that the smoothed curve stays in the tolerance band between its knots, too; true when done.
    pub(super) fn check_curve(&mut self, budget: &mut WorkBudget) -> bool {
        let end = self.intervals();
        while self.cursor < end && !budget.is_spent() {
            let k = self.cursor;
            self.cursor += 1;
            let p = [0, 1, 2, 3].map(|i| self.smoother.points[k + i]);
            (self.nearest_before, _) = self.check_point(k, spline(&p, 0.0), budget);
            for quarter in 0..4 {
                let from = f64::from(quarter) / 4.0;
                let along = self.smoother.knots[k + 1].near.0;
                self.check_bounds(k, spline(&p, from), if k == 0 { self.start.point.along } else { along });
                self.check_between(k, &p, from, from + 0.25, budget);
            }
        }
        self.cursor == end
    }

    /// Checks the end of a part of interval `k`, and points in between where the nearest move changes: the distance has
    /// a peak there, which grows with the corner angle.
    fn check_between(&mut self, k: usize, p: &SetpointHistory, from: f64, to: f64, budget: &mut WorkBudget) {
        let (found, near) = self.check_point(k, spline(p, to), budget);
        let before = std::mem::replace(&mut self.nearest_before, found);
        if found == before {
            if near {
                self.check_point(k, spline(p, f64::midpoint(from, to)), budget);
            }
        } else {
            let sharp = self.band.smooth_run(before) != self.band.smooth_run(found);
            let looks = if sharp { CHECKS_AT_SHARP_CORNER } else { CHECKS_AT_CORNER };
            for fine in 1..looks {
                self.check_point(k, spline(p, from + (to - from) * f64::from(fine) / f64::from(looks)), budget);
            }
        }
    }

    /// Checks one point of interval `k`; returns the nearest move and whether the point is near the edge of the band.
    fn check_point(&mut self, k: usize, at: [f64; 3], budget: &mut WorkBudget) -> (usize, bool) {
        budget.spend(COST_CHECK_POINT);
        let knots = &self.smoother.knots;
        let last = knots.len() - 1;
        let along = &self.smoother.along;
        let low = if k == 0 { 0.0 } else { knots[k].near.0.min(along[k - 1]) };
        let high = if k + 4 > last { self.band.end } else { knots[k + 3].near.0.max(along[k + 4]) };
        let near = self.band.nearest(at, low, high, knots[k + 1].near.1);
        let joined = k < self.smoother.lead && self.start.point.is_in_motion();
        let share = if joined { LEAD_TOLERANCE_SHARE } else { TOLERANCE_SHARE };
        let tolerance = self.band.moves[near.segment].tolerance;
        let over = near.deviation - share * tolerance;
        if over > 0.0 {
            self.is_outside = true;
            self.excess[k].deviation = self.excess[k].deviation.max(over);
        }
        (near.segment, near.deviation > EDGE_SHARE * tolerance)
    }

    /// Checks the axis bounds at a set-point of interval `k`. The curve through the set-points lies between them at any
    /// rate.
    fn check_bounds(&mut self, k: usize, at: [f64; 3], along: f64) {
        let most = if k < self.smoother.lead && self.start.point.is_in_motion() {
            LEAD_MAX_OVERSHOOT_MM
        } else {
            MAX_OVERSHOOT_MM
        };
        for (x, (low, high)) in self.band.bounds(along).into_iter().enumerate() {
            let beyond = (low - at[x], at[x] - high);
            if beyond.0 > most || beyond.1 > most {
                self.is_outside = true;
                let known = &mut self.excess[k].bounds[x];
                *known = (known.0.max(beyond.0), known.1.max(beyond.1));
            }
        }
    }

    /// After the curve check: narrows the band where the curve was outside, otherwise continues with the speed.
    pub(super) fn after_curve_check(&mut self) {
        if self.is_outside && self.repairs < MAX_REPAIRS {
            self.repair();
        } else {
            self.begin_speed(LAST_ROUND);
        }
    }

    fn repair(&mut self) {
        self.repairs += 1;
        for (k, excess) in self.excess.iter().enumerate().take(self.smoother.points.len() - 3) {
            let allowed = self.band.moves[self.smoother.knots[k + 1].near.1].tolerance * TOLERANCE_SHARE;
            let spare = REPAIR_SPARE * f64::from(self.repairs) * allowed;
            let by = |x: f64| if x > 0.0 { REPAIR_FACTOR * x + spare } else { 0.0 };
            let room = excess.bounds.map(|(low, high)| (by(low), by(high)));
            self.smoother.narrow(k, by(excess.deviation), allowed * MIN_BAND_SHARE, room);
        }
        self.phase = WindowPhase::Smooth { round: LAST_ROUND, left: REPAIR_ITERATIONS };
    }

    pub(super) fn begin_check(&mut self) {
        let part = self.start.lead_end.map_or(0.0, |_| self.start.point.curve_position.fraction);
        self.curve_position = CurvePosition { interval: 0, fraction: part };
        self.history = self.start.history;
        self.worst_ratio = 0.0;
        self.nearest_before = self.band.segment_at(self.start.point.along);
        self.past_intervals = [0; 2];
        self.begin_excess();
        self.plan.clear();
    }

    /// Computes and checks the set-points of the plan; true when done.
    pub(super) fn check(&mut self, budget: &mut WorkBudget) -> bool {
        let step = self.limits.tick_s / self.spacing_s;
        while !budget.is_spent() {
            budget.spend(COST_CHECK_SETPOINT);
            self.advance(step);
            let point = self.plan_point();
            let over = self.is_at_end();
            if point.at.iter().any(|x| !x.is_finite()) {
                self.worst_ratio = f64::INFINITY;
                return true;
            }
            self.plan.push(point);
            self.check_bounds(self.curve_position.interval.min(self.intervals() - 1), point.at, point.along);
            self.record_setpoint(point.at);
            // The checked spline interval lies between the two set-points before the last.
            let interval = self.curve_position.interval.min(self.intervals() - 1);
            let k = self.past_intervals[0];
            self.past_intervals = [self.past_intervals[1], interval];
            let past = self.history;
            self.check_between(k, &past, 0.0, 1.0, budget);
            if over {
                // The stop at the end still shows in the differences of the next three ticks.
                for _ in 0..3 {
                    self.record_setpoint(point.at);
                }
                return true;
            }
            if self.plan.len() >= MAX_PLAN_TICKS {
                self.worst_ratio = f64::INFINITY;
                return true;
            }
        }
        false
    }

    fn record_setpoint(&mut self, at: [f64; 3]) {
        self.history = [self.history[1], self.history[2], self.history[3], at];
        self.worst_ratio = self.worst_ratio.max(self.steps.worst_ratio(&self.history));
    }

    /// Evaluates the check: repair, retry with lower limits, failed or ready.
    pub(super) fn evaluate(&mut self) {
        if self.is_outside && self.repairs < MAX_REPAIRS {
            self.repair();
        } else if self.is_outside
            || (self.worst_ratio > 1.0 && self.slowdowns >= MAX_SLOWDOWNS)
            || self.worst_ratio.is_infinite()
        {
            self.phase = WindowPhase::Failed;
        } else if self.worst_ratio > 1.0 {
            self.slowdowns += 1;
            self.share *= (1.0 / self.worst_ratio).max(0.9) * 0.998;
            self.begin_speed(LAST_ROUND);
        } else {
            self.phase = WindowPhase::Ready;
        }
    }
}
