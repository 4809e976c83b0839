//! Timing: places the control points of a window along the contour.
//!
//! Estimates a first timing from corner speeds and accelerations, and places the control points again at even times of
//! the planned speed. Knows nothing of the smoothing.

use super::super::AxisLimits;
use super::super::budget::Budget;
use super::super::contour::distance;
use super::super::smooth::{FIXED, POINTS};
use super::super::speed::{OVER_KNOTS, over};
use super::super::tube::corner_speed;
use super::{Follow, SPACING_S, Window};

/// Minimum number of control points after the given ones, and number kept free at the end.
const POINTS_LEAST: usize = 24;
const POINTS_SPARE: usize = 8;
const POINTS_MOST: usize = POINTS - POINTS_LEAST - POINTS_SPARE;
/// Share of the smallest axis acceleration used by the first timing.
const PUSH_SHARE: f64 = 0.5;
/// Number of knots over which the rate taken over blends to a constant one: in braking times, and its maximum.
const EVEN_BRAKES: f64 = 1.2;
const EVEN_KNOTS: usize = 80;
/// Work units of one corner, of one control point placed, and of one placed again.
const COST_CORNER: usize = 80;
const COST_LAY: usize = 130;
const COST_RETIME: usize = 250;

impl Window {
    fn push(&self) -> f64 {
        PUSH_SHARE * least(self, |l| l.acceleration_mm_s2)
    }

    /// Estimates corner speeds from tolerance and jerk, with constant acceleration between corners.
    pub(super) fn guess_corners(&mut self, budget: &mut Budget) {
        let (push, jerk) = (self.push(), least(self, |l| l.jerk_mm_s3));
        let pieces = &self.tube.pieces;
        let count = pieces.len();
        budget.take(count * COST_CORNER);
        self.corner.clear();
        self.corner.resize(count + 1, 0.0);
        for k in 1..count {
            let bend = corner_speed(&pieces[k - 1], &pieces[k], jerk);
            self.corner[k] = bend.min(pieces[k - 1].top).min(pieces[k].top);
        }
        let (from, speed) = self.lead_end();
        let start = self.tube.segment_at(from);
        self.corner[start] = speed;
        for k in start + 1..=count {
            let reach = self.corner[k - 1].powi(2) + 2.0 * push * pieces[k - 1].segment.length();
            self.corner[k] = self.corner[k].min(reach.sqrt());
        }
        for k in (start + 1..count).rev() {
            // The curve may end inside the last move.
            let length = (self.tube.along[k + 1].min(self.tube.end) - self.tube.along[k]).max(0.0);
            let reach = self.corner[k + 1].powi(2) + 2.0 * push * length;
            self.corner[k] = self.corner[k].min(reach.sqrt());
        }
    }

    /// Maximum speed of the first timing at a distance along the contour, mm/s.
    fn first_speed(&self, along: f64, push: f64) -> f64 {
        let k = self.tube.segment_at(along);
        let from = along - self.tube.along[k].max(self.first_from.min(along));
        let to = self.tube.along[k + 1].min(self.tube.end) - along;
        let rise = (self.corner[k].powi(2) + 2.0 * push * from.max(0.0)).sqrt();
        let fall = (self.corner[k + 1].powi(2) + 2.0 * push * to.max(0.0)).sqrt();
        rise.min(fall).min(self.tube.pieces[k].top)
    }

    /// The first control points. At rest: three at the same position. In motion: those of the previous curve up to
    /// `until`, with their timing.
    pub(super) fn begin_points(&mut self) {
        let (start, smooth) = (&self.start, &mut self.smooth);
        smooth.points.clear();
        smooth.along.clear();
        smooth.lead = FIXED;
        let Some(until) = start.until else {
            let (d, speed) = (self.spacing_s, distance(start.point.velocity, [0.0; 3]));
            for step in [-1.0, 0.0, 1.0_f64] {
                smooth.points.push([0, 1, 2].map(|x| {
                    let (d1, d2) = (start.point.velocity[x] * d, start.point.acceleration[x] * d * d);
                    start.point.at[x] - d2 / 6.0 + step * d1 + step.abs() * d2 / 2.0
                }));
                smooth.along.push((start.point.along + step * speed * d).max(0.0).min(self.tube.end));
            }
            return;
        };
        let from = start.point.follow.interval;
        let last = self.before.points.len() - FIXED;
        let until = until.max(from).min(last.max(from + 1) - 1);
        smooth.lead = until - from + FIXED + 1;
        for k in from..from + smooth.lead {
            smooth.points.push(self.before.points[k]);
            // The first control point has no knot.
            let along = self.before.near[k.max(1)].0.max(0.0) - start.shift.0;
            let least = smooth.along.last().copied().unwrap_or(0.0);
            smooth.along.push(along.max(least).min(self.tube.end));
        }
    }

    /// Distance along the contour, mm, and speed, mm/s, at the start of the first timing.
    fn lead_end(&self) -> (f64, f64) {
        let (points, last) = (&self.smooth.points, self.smooth.lead - 1);
        let step = distance(points[last], points[last - 2]) / 2.0;
        (self.smooth.along[last], step * self.last_rate_square().sqrt() / self.spacing_s)
    }

    /// The last given coefficient of the square of the rate.
    fn last_rate_square(&self) -> f64 {
        let last = self.start.point.follow.interval + self.smooth.lead - 2;
        if self.start.until.is_some() { self.before.rate_square[last] } else { 1.0 }
    }

    /// Time from the previous control point to number `count` after the given ones, in knot spacings: the rate blends
    /// from the given to the nominal one.
    fn step_after(&self, count: usize) -> f64 {
        1.0 / over(self.last_rate_square(), 1.0, count as f64 / OVER_KNOTS as f64).sqrt()
    }

    pub(super) fn begin_lay(&mut self) {
        let (from, speed) = self.lead_end();
        self.first_from = from;
        let (push, jerk) = (2.0 * self.push(), least(self, |l| l.jerk_mm_s3));
        let brake = (speed / push + push / jerk).min(2.0 * (speed / jerk).sqrt());
        self.speed.even_knots = ((EVEN_BRAKES * brake / SPACING_S) as usize).clamp(OVER_KNOTS, EVEN_KNOTS);
        self.sum = self.first_from;
        self.cursor = 0;
    }

    /// Places control points along the contour at even times of the first timing, up to the maximum; true when done.
    pub(super) fn lay_first(&mut self, budget: &mut Budget) -> bool {
        let push = self.push();
        let end = self.tube.end;
        let least = 0.5 * push * self.spacing_s;
        while !budget.is_spent() {
            budget.take(COST_LAY);
            let spacing = self.spacing_s * self.step_after(self.cursor + 1);
            let half = self.sum + self.first_speed(self.sum, push).max(least) * spacing / 2.0;
            self.sum += self.first_speed(half.min(end), push).max(least) * spacing;
            self.cursor += 1;
            if self.smooth.points.len() >= POINTS_MOST && self.sum < end {
                self.cut(self.sum);
            }
            if self.sum >= self.tube.end {
                self.end_points();
                return true;
            }
            self.smooth.points.push(self.tube.at(self.sum));
            self.smooth.along.push(self.sum);
        }
        false
    }

    /// The horizon was too long: cuts the tolerance band.
    fn cut(&mut self, along: f64) {
        self.tube.cut(along);
        self.is_cut = true;
    }

    /// The last control points, at rest.
    fn end_points(&mut self) {
        let end = self.tube.end_point();
        let least = self.smooth.lead + POINTS_LEAST;
        for _ in 0..FIXED.max(least.saturating_sub(self.smooth.points.len())) {
            self.smooth.points.push(end);
            self.smooth.along.push(self.tube.end);
        }
    }

    /// Prepares to place the control points after the given ones again.
    pub(super) fn begin_retime(&mut self) {
        self.sum = SPACING_S / self.spacing_s;
        // The last given point belongs to the knot at the start of this interval.
        self.follow = Follow { interval: self.smooth.lead - 2, part: 0.0 };
        self.fresh.clear();
        self.cursor = 0;
    }

    /// Places the control points again at even times of the planned speed; true when done.
    pub(super) fn retime(&mut self, budget: &mut Budget) -> bool {
        while !budget.is_spent() {
            budget.take(COST_RETIME);
            self.advance(self.sum * self.step_after(self.cursor + 1));
            self.cursor += 1;
            let full = self.smooth.lead + self.fresh.len() >= POINTS_MOST;
            if full && !self.is_at_end() {
                self.cut(self.along());
            }
            if full || self.is_at_end() {
                self.spacing_s *= self.sum;
                self.begin_points();
                for (at, along) in &self.fresh {
                    self.smooth.points.push(*at);
                    self.smooth.along.push(*along);
                }
                self.end_points();
                return true;
            }
            self.fresh.push((self.position(), self.along()));
        }
        false
    }
}

fn least(window: &Window, of: fn(&AxisLimits) -> f64) -> f64 {
    window.limits.axes.iter().map(|(_, l)| of(l)).fold(f64::INFINITY, f64::min)
}
