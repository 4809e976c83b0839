//! The check of the whole plan, set-point by set-point, before any of it is used.
//!
//! Compares velocity, acceleration and jerk (as differences), the distance to the contour and the bounds of each axis.
//! If the curve leaves the tolerance band, the band is narrowed there. If a limit is exceeded, the share of the limits
//! is lowered, or the slack where it was exceeded by the slack at a start in motion.

use super::super::feed_scaling::SetpointHistory;
use super::super::path_segment::distance;
use super::super::per_coordinate;
use super::super::setpoint_buffer::spline;
use super::super::smoother::FIXED_POINTS;
use super::{
    CurvePosition, IntervalExcess, LAST_ROUND, LookaheadWindow, MAX_PLAN_TICKS, MAX_REPAIRS, MAX_SLOWDOWNS,
    REPAIR_ITERATIONS, TOLERANCE_SHARE, WindowPhase,
};
use crate::units::WorkBudget;

/// Share of the tolerance up to which the deviation may rise between two checked points.
const BETWEEN_SHARE: f64 = 0.986;
/// Maximum number of times that the part between two checked points is halved: at 100 mm/s a 64th of a tick is 1.6 µm.
const MAX_HALVINGS: u32 = 6;
/// Minimum width of a narrowed band, as a share of the tolerance.
const MIN_BAND_SHARE: f64 = 0.02;
/// A repair narrows the band by this share of the tolerance times the repair count, plus the excess times this factor.
const REPAIR_SPARE: f64 = 0.03;
const REPAIR_FACTOR: f64 = 1.6;
/// Maximum overshoot of an axis beyond its reversal point, mm: rounding, below a thousandth of the finest increment.
const MAX_OVERSHOOT_MM: f64 = 5e-7;
/// Shares of the tolerance and overshoot (mm) at a start on the previous plan: more than that plan was allowed, because the
/// new set-points fall on other places beside it.
const LEAD_SHARES: (f64, f64) = (0.99, 0.995);
const LEAD_MAX_OVERSHOOT_MM: f64 = 9e-7;
/// Factor on the slack at a start in motion after each check that found a limit exceeded there: from 1.6 % it leaves
/// 0.6, 0.3 and 0.1 %, the last of which the share of the limits covers.
const LEAD_SLACK_STEP: f64 = 0.4;
/// Work units of one checked point, and of one set-point without its checked points.
const COST_CHECK_POINT: usize = 90;
/// Work units of the distances from two moves: a checked point looks at seven or more.
const COST_TWO_MOVES: usize = 30;
const COST_CHECK_SETPOINT: usize = 200;

/// A checked point of an interval between two knots or set-points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CheckedPoint {
    /// Fraction of the interval.
    fraction: f64,
    /// Share of the tolerance that it was checked against.
    share: f64,
    at: [f64; 3],
    /// Distance to the contour, mm, and the nearest move.
    deviation: f64,
    segment: usize,
}

/// Upper bound of the second derivative in an interval of a spline, mm.
fn bend(p: &SetpointHistory) -> f64 {
    let at = |k: usize| distance(per_coordinate(|x| p[k - 1][x] + p[k + 1][x] - 2.0 * p[k][x]), [0.0; 3]);
    at(1).max(at(2))
}

/// Upper bound of the first derivative in an interval of a spline, mm.
fn longest_step(p: &SetpointHistory) -> f64 {
    distance(p[0], p[1]).max(distance(p[1], p[2])).max(distance(p[2], p[3]))
}

impl LookaheadWindow {
    pub(super) fn begin_curve_check(&mut self) {
        self.begin_excess();
        self.misses_stroke_end = false;
        self.cursor = self.smoother.free_intervals().0;
        self.phase = WindowPhase::CheckCurve;
    }

    fn begin_excess(&mut self) {
        self.excess.clear();
        self.excess.resize(self.smoother.points.len(), IntervalExcess::default());
        self.is_outside = false;
    }

    /// Checks that the smoothed curve stays in the tolerance band between its knots, too; true when done.
    pub(super) fn check_curve(&mut self, budget: &mut WorkBudget) -> bool {
        let end = self.smoother.free_intervals().1.min(self.intervals());
        while self.cursor < end && !budget.is_spent() {
            let k = self.cursor;
            self.cursor += 1;
            let p = self.smoother.control_points(k);
            self.last_check = self.check_point(k, &p, 0.0, self.shares_at(k).0, budget);
            self.check_stroke_end(k, spline(&p, 0.0));
            for quarter in 0..4 {
                let from = f64::from(quarter) / 4.0;
                let along = self.smoother.knots[k + 1].near.0;
                self.check_bounds(k, spline(&p, from), if k == 0 { self.start.point.along } else { along });
                self.check_up_to(k, &p, from + 0.25, budget);
            }
        }
        self.cursor == end
    }

    /// Checks that the curve meets the end of a stroke within the tolerance: beside the way back every point is near the
    /// contour, however far from the end it turns.
    fn check_stroke_end(&mut self, k: usize, at: [f64; 3]) {
        let knot = &self.smoother.knots[k + 1];
        if knot.is_stroke_end() {
            let missed = distance(at, self.band.at(knot.near.0));
            let over = missed - self.shares_at(k).0 * self.band.moves[knot.near.1].tolerance;
            self.misses_stroke_end |= over > 0.0;
            self.record_deviation(k, over);
        }
    }

    /// Checks interval `k` from the last checked point up to fraction `to`.
    fn check_up_to(&mut self, k: usize, p: &SetpointHistory, to: f64, budget: &mut WorkBudget) {
        let end = self.check_point(k, p, to, self.shares_at(k).0, budget);
        let start = std::mem::replace(&mut self.last_check, end);
        self.check_between(k, p, [start, end], MAX_HALVINGS, budget);
    }

    /// Checks interval `k` between two checked points: halves the part until it is known whether the deviation is allowed.
    ///
    /// The distance to a straight move is convex: between two points it exceeds that of the points by no more than the
    /// height of the curve over its chord. To an arc it exceeds them by the height of the arc over that chord, too. Where
    /// the nearest move changes, this holds for either move, each with its own tolerance.
    fn check_between(
        &mut self,
        k: usize,
        p: &SetpointHistory,
        ends: [CheckedPoint; 2],
        halvings: u32,
        budget: &mut WorkBudget,
    ) {
        let [start, end] = ends;
        if ends.iter().any(|point| point.deviation > point.share * self.band.moves[point.segment].tolerance) {
            // The point has been found outside already.
            return;
        }
        // Beside a point that was allowed more, at the end of a start in motion, as much is allowed.
        let share = self.shares_at(k).1.max(start.share).max(end.share);
        if start.segment != end.segment {
            budget.spend(COST_TWO_MOVES);
        }
        let span = end.fraction - start.fraction;
        let over_share = |segment: usize, share: f64| {
            let nearest = &self.band.moves[segment];
            let farthest = ends.map(|point| {
                if point.segment == segment { point.deviation } else { self.band.deviation_from(segment, point.at) }
            });
            let height = (bend(p) + longest_step(p).powi(2) * nearest.segment.curvature()) * span * span / 8.0;
            farthest[0].max(farthest[1]) + height - share * nearest.tolerance
        };
        // Near either move is near enough.
        let over = |share: f64| {
            let of_first = over_share(start.segment, share);
            if start.segment == end.segment { of_first } else { of_first.min(over_share(end.segment, share)) }
        };
        if over(share) <= 0.0 {
            return;
        }
        if halvings == 0 {
            let over = over(1.0);
            self.record_deviation(k, over);
            return;
        }
        let fraction = f64::midpoint(start.fraction, end.fraction);
        let middle = self.check_point(k, p, fraction, share, budget);
        self.check_between(k, p, [start, middle], halvings - 1, budget);
        self.check_between(k, p, [middle, end], halvings - 1, budget);
    }

    /// Shares of the tolerance that the curve may use in interval `k`: at regularly checked points, and between them.
    fn shares_at(&self, k: usize) -> (f64, f64) {
        let joined = k < FIXED_POINTS && self.start.point.is_in_motion();
        if joined { LEAD_SHARES } else { (TOLERANCE_SHARE, BETWEEN_SHARE) }
    }

    fn record_deviation(&mut self, k: usize, over: f64) {
        if over > 0.0 {
            self.is_outside = true;
            self.excess[k].deviation = self.excess[k].deviation.max(over);
        }
    }

    /// Checks one point of interval `k` against a share of the tolerance.
    fn check_point(
        &mut self,
        k: usize,
        p: &SetpointHistory,
        fraction: f64,
        share: f64,
        budget: &mut WorkBudget,
    ) -> CheckedPoint {
        budget.spend(COST_CHECK_POINT);
        let at = spline(p, fraction);
        let knots = &self.smoother.knots;
        let last = knots.len() - 1;
        let along = &self.smoother.along;
        let low = if k == 0 { 0.0 } else { knots[k].near.0.min(along[k - 1]) };
        let high = if k + 4 > last { self.band.end } else { knots[k + 3].near.0.max(along[k + 4]) };
        let near = self.band.nearest(at, low, high, knots[k + 1].near.1);
        self.record_deviation(k, near.deviation - share * self.band.moves[near.segment].tolerance);
        CheckedPoint { fraction, share, at, deviation: near.deviation, segment: near.segment }
    }

    /// Checks the axis bounds at a set-point of interval `k`. The curve through the set-points lies between them at any
    /// rate.
    fn check_bounds(&mut self, k: usize, at: [f64; 3], along: f64) {
        let most =
            if k < FIXED_POINTS && self.start.point.is_in_motion() { LEAD_MAX_OVERSHOOT_MM } else { MAX_OVERSHOOT_MM };
        for (x, (low, high)) in self.band.bounds(along).into_iter().enumerate() {
            let beyond = (low - at[x], at[x] - high);
            if beyond.0 > most || beyond.1 > most {
                self.is_outside = true;
                let known = &mut self.excess[k].bounds[x];
                *known = (known.0.max(beyond.0), known.1.max(beyond.1));
            }
        }
    }

    /// After the curve check: narrows the band where the curve was outside, otherwise continues with the speed. The check
    /// of the set-points finds what is outside still, but not an end of a stroke that is missed.
    pub(super) fn after_curve_check(&mut self) {
        if self.is_outside && self.repairs < MAX_REPAIRS {
            self.repair();
        } else if self.misses_stroke_end {
            self.phase = WindowPhase::Failed;
        } else {
            self.begin_speed(LAST_ROUND);
        }
    }

    fn repair(&mut self) {
        self.repairs += 1;
        let outside = |excess: &IntervalExcess| {
            excess.deviation > 0.0 || excess.bounds.iter().any(|(low, high)| *low > 0.0 || *high > 0.0)
        };
        let first = self.excess.iter().position(outside).unwrap_or(0);
        let last = self.excess.iter().rposition(outside).unwrap_or(0);
        for (k, excess) in self.excess.iter().enumerate().take(self.smoother.points.len() - 3) {
            let allowed = self.band.moves[self.smoother.knots[k + 1].near.1].tolerance * TOLERANCE_SHARE;
            let spare = REPAIR_SPARE * f64::from(self.repairs) * allowed;
            let by = |x: f64| if x > 0.0 { REPAIR_FACTOR * x + spare } else { 0.0 };
            let room = excess.bounds.map(|(low, high)| (by(low), by(high)));
            self.smoother.narrow(k, by(excess.deviation), allowed * MIN_BAND_SHARE, room);
        }
        self.smoother.focus(first, last);
        self.phase = WindowPhase::Smooth { round: LAST_ROUND, left: REPAIR_ITERATIONS };
    }

    pub(super) fn begin_check(&mut self) {
        self.curve_position = CurvePosition::default();
        self.history = self.start.history;
        self.worst_ratio = 0.0;
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
            self.last_check.fraction = 0.0;
            if self.plan.len() == 1 {
                self.last_check = self.check_point(k, &past, 0.0, self.shares_at(k).0, budget);
            }
            self.check_up_to(k, &past, 1.0, budget);
            if over {
                // The stop at the end still shows in the differences of the next three ticks.
                for _ in 0..3 {
                    self.record_setpoint(point.at);
                }
                self.drop_standing_end();
                return true;
            }
            if self.plan.len() >= MAX_PLAN_TICKS {
                self.worst_ratio = f64::INFINITY;
                return true;
            }
        }
        false
    }

    /// Removes set-points before the last that already stand at its position: the motion is over.
    fn drop_standing_end(&mut self) {
        while let [.., before, last] = &self.plan[..]
            && distance(before.at, last.at) <= 0.0
        {
            let last = *last;
            self.plan.truncate(self.plan.len() - 2);
            self.plan.push(last);
        }
    }

    fn record_setpoint(&mut self, at: [f64; 3]) {
        self.history = [self.history[1], self.history[2], self.history[3], at];
        let ratio = self.steps.worst_ratio(&self.history);
        if ratio > self.worst_ratio {
            (self.worst_ratio, self.worst_interval) = (ratio, self.curve_position.interval);
        }
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
            if self.worst_interval < self.lead_knots() {
                self.lead_slack_share *= LEAD_SLACK_STEP;
            } else {
                self.share *= (1.0 / self.worst_ratio).max(0.9) * 0.998;
            }
            self.begin_speed(LAST_ROUND);
        } else {
            self.phase = WindowPhase::Ready;
        }
    }
}
