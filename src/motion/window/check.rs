//! The check of the whole plan, set-point by set-point, before any of it is used.
//!
//! Compares velocity, acceleration and jerk (as differences), the distance to the contour and the bounds of each axis.
//! If the curve leaves the tolerance band, the band is narrowed there. If a limit is exceeded, the share of the limits
//! is lowered.

use super::super::budget::Budget;
use super::super::smooth::FIXED;
use super::super::trail::spline;
use super::super::warp::History;
use super::{
    Excess, Follow, LAST, PLAN_TICKS, Phase, REPAIR_ROUND, REPAIRS_MOST, SLOWER_MOST, TOLERANCE_SHARE, Window,
};

/// Subdivisions between two checked points where the nearest move changes: at a smooth transition, at a sharp corner.
const LOOKS: u32 = 3;
const LOOKS_SHARP: u32 = 10;
/// From this share of the tolerance on, one more point is checked in between.
const EDGE: f64 = 0.95;
/// Minimum width of a narrowed band, as a share of the tolerance.
const NARROWEST: f64 = 0.02;
/// A repair narrows the band by this share of the tolerance times the repair count, plus the excess times this factor.
const REPAIR_SPARE: f64 = 0.03;
const REPAIR_MORE: f64 = 1.6;
/// Maximum overshoot of an axis beyond its reversal point, mm: rounding, below a thousandth of the finest increment.
const BEYOND_MM: f64 = 5e-7;
/// Tolerance share and overshoot (mm) allowed on the part taken over from the previous plan: slightly more than that
/// plan was allowed, so that this part never fails.
const JOINED_SHARE: f64 = 0.987;
const JOINED_BEYOND_MM: f64 = 9e-7;
/// Work units of one checked point, and of one set-point without its checked points.
const COST_LOOK: usize = 100;
const COST_CHECK: usize = 300;

impl Window {
    pub(super) fn begin_probe(&mut self) {
        self.begin_excess();
        // The part taken over has already been checked.
        self.cursor = self.smooth.lead - FIXED;
        self.phase = Phase::Probe;
    }

    fn begin_excess(&mut self) {
        self.excess.clear();
        self.excess.resize(self.smooth.points.len(), Excess::default());
        self.is_off = false;
    }

    /// Checks that the smoothed curve stays in the tolerance band between its knots, too; true when done.
    pub(super) fn probe(&mut self, budget: &mut Budget) -> bool {
        let end = self.intervals();
        while self.cursor < end && !budget.is_spent() {
            let k = self.cursor;
            self.cursor += 1;
            let p = [0, 1, 2, 3].map(|i| self.smooth.points[k + i]);
            let (mut segment, _) = self.look(k, spline(&p, 0.0), budget);
            for quarter in 0..4 {
                let from = f64::from(quarter) / 4.0;
                let along = self.smooth.knots[k + 1].near.0;
                self.look_at_room(k, spline(&p, from), if k == 0 { self.start.point.along } else { along });
                segment = self.look_between(k, &p, (from, from + 0.25), segment, budget);
            }
        }
        self.cursor == end
    }

    /// Checks the end of a part of interval `k`, and points in between where the nearest move changes: the distance has
    /// a peak there, which grows with the corner angle.
    fn look_between(
        &mut self,
        k: usize,
        p: &History,
        (from, to): (f64, f64),
        before: usize,
        budget: &mut Budget,
    ) -> usize {
        let (found, near) = self.look(k, spline(p, to), budget);
        if found == before {
            if near {
                self.look(k, spline(p, f64::midpoint(from, to)), budget);
            }
        } else {
            let sharp = self.tube.smooth_run(before) != self.tube.smooth_run(found);
            let looks = if sharp { LOOKS_SHARP } else { LOOKS };
            for fine in 1..looks {
                self.look(k, spline(p, from + (to - from) * f64::from(fine) / f64::from(looks)), budget);
            }
        }
        found
    }

    /// Checks one point of interval `k`; returns the nearest move and whether the point is near the edge of the band.
    fn look(&mut self, k: usize, at: [f64; 3], budget: &mut Budget) -> (usize, bool) {
        budget.take(COST_LOOK);
        let knots = &self.smooth.knots;
        let last = knots.len() - 1;
        let along = &self.smooth.along;
        let low = if k == 0 { 0.0 } else { knots[k].near.0.min(along[k - 1]) };
        let high = if k + 4 > last { self.tube.end } else { knots[k + 3].near.0.max(along[k + 4]) };
        let near = self.tube.nearest(at, low, high, knots[k + 1].near.1);
        let joined = k < self.smooth.lead && self.start.point.is_in_motion();
        let share = if joined { JOINED_SHARE } else { TOLERANCE_SHARE };
        let tolerance = self.tube.pieces[near.segment].tolerance;
        let over = near.off - share * tolerance;
        if over > 0.0 {
            self.is_off = true;
            self.excess[k].off = self.excess[k].off.max(over);
        }
        (near.segment, near.off > EDGE * tolerance)
    }

    /// Checks the axis bounds at a set-point of interval `k`. The curve through the set-points lies between them at any
    /// rate.
    fn look_at_room(&mut self, k: usize, at: [f64; 3], along: f64) {
        let most = if k < self.smooth.lead && self.start.point.is_in_motion() { JOINED_BEYOND_MM } else { BEYOND_MM };
        for (x, (low, high)) in self.tube.room(along).into_iter().enumerate() {
            let beyond = (low - at[x], at[x] - high);
            if beyond.0 > most || beyond.1 > most {
                self.is_off = true;
                let known = &mut self.excess[k].room[x];
                *known = (known.0.max(beyond.0), known.1.max(beyond.1));
            }
        }
    }

    /// After the curve check: narrows the band where the curve was outside, otherwise continues with the speed.
    pub(super) fn after_probe(&mut self) {
        if self.is_off && self.repairs < REPAIRS_MOST {
            self.repair();
        } else {
            self.begin_speed(LAST);
        }
    }

    fn repair(&mut self) {
        self.repairs += 1;
        for (k, excess) in self.excess.iter().enumerate().take(self.smooth.points.len() - 3) {
            let allowed = self.tube.pieces[self.smooth.knots[k + 1].near.1].tolerance * TOLERANCE_SHARE;
            let spare = REPAIR_SPARE * f64::from(self.repairs) * allowed;
            let by = |x: f64| if x > 0.0 { REPAIR_MORE * x + spare } else { 0.0 };
            let room = excess.room.map(|(low, high)| (by(low), by(high)));
            self.smooth.narrow(k, by(excess.off), allowed * NARROWEST, room);
        }
        self.phase = Phase::Smooth { round: LAST, left: REPAIR_ROUND };
    }

    pub(super) fn begin_check(&mut self) {
        let part = self.start.until.map_or(0.0, |_| self.start.point.follow.part);
        self.follow = Follow { interval: 0, part };
        self.past = self.start.past;
        self.worst = 0.0;
        self.nearest_before = self.tube.segment_at(self.start.point.along);
        self.seen = [0; 2];
        self.begin_excess();
        self.plan.clear();
    }

    /// Computes and checks the set-points of the plan; true when done.
    pub(super) fn check(&mut self, budget: &mut Budget) -> bool {
        let step = self.limits.tick_s / self.spacing_s;
        while !budget.is_spent() {
            budget.take(COST_CHECK);
            self.advance(step);
            let point = self.plan_point();
            let over = self.is_at_end();
            if point.at.iter().any(|x| !x.is_finite()) {
                self.worst = f64::INFINITY;
                return true;
            }
            self.plan.push(point);
            self.look_at_room(self.follow.interval.min(self.intervals() - 1), point.at, point.along);
            self.see(point.at);
            // The checked spline interval lies between the two set-points before the last.
            let interval = self.follow.interval.min(self.intervals() - 1);
            let k = self.seen[0];
            self.seen = [self.seen[1], interval];
            let (past, before) = (self.past, self.nearest_before);
            self.nearest_before = self.look_between(k, &past, (0.0, 1.0), before, budget);
            if over {
                // The stop at the end still shows in the differences of the next three ticks.
                for _ in 0..3 {
                    self.see(point.at);
                }
                return true;
            }
            if self.plan.len() >= PLAN_TICKS {
                self.worst = f64::INFINITY;
                return true;
            }
        }
        false
    }

    fn see(&mut self, at: [f64; 3]) {
        self.past = [self.past[1], self.past[2], self.past[3], at];
        self.worst = self.worst.max(self.steps.excess(&self.past));
    }

    /// Evaluates the check: repair, retry with lower limits, failed or ready.
    pub(super) fn judge(&mut self) {
        if self.is_off && self.repairs < REPAIRS_MOST {
            self.repair();
        } else if self.is_off || (self.worst > 1.0 && self.slower >= SLOWER_MOST) || self.worst.is_infinite() {
            self.phase = Phase::Failed;
        } else if self.worst > 1.0 {
            self.slower += 1;
            self.share *= (1.0 / self.worst).max(0.9) * 0.998;
            self.begin_speed(LAST);
        } else {
            self.phase = Phase::Ready;
        }
    }
}
