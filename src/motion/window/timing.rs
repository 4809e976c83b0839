//! Timing: where on the contour the control points of a window begin, and begin again.
//!
//! Owns the guess of a first timing from corners and accelerations, and the even spacing in time of a better one. Knows
//! nothing of what the smoothing makes of it.

use super::super::AxisLimits;
use super::super::budget::Budget;
use super::super::contour::distance;
use super::super::smooth::POINTS;
use super::super::tube::corner_speed;
use super::{Follow, SPACING_S, Window};

/// By what the spacing grows when the points are too many.
const COARSER: f64 = 1.3;
/// Control points at least, and kept free at the end.
const POINTS_LEAST: usize = 24;
const POINTS_SPARE: usize = 8;
/// Part of the least acceleration of the axes that the first timing uses.
const PUSH_SHARE: f64 = 0.5;
/// Units of work of a corner, of a control point laid, of an interval timed.
const COST_CORNER: usize = 80;
const COST_LAY: usize = 130;
const COST_TIME: usize = 60;
const COST_RETIME: usize = 250;

impl Window {
    fn push(&self) -> f64 {
        PUSH_SHARE * least(self, |l| l.acceleration_mm_s2)
    }

    /// Corners at a speed guessed from tolerance and jerk, even acceleration between them.
    pub(super) fn guess_corners(&mut self, budget: &mut Budget) {
        let (push, jerk) = (self.push(), least(self, |l| l.jerk_mm_s3));
        let pieces = &self.tube.pieces;
        let count = pieces.len();
        budget.take(count * COST_CORNER);
        self.corner.clear();
        self.corner.resize(count + 1, 0.0);
        let start = self.tube.segment_at(self.start.point.along);
        for k in 1..count {
            let bend = corner_speed(&pieces[k - 1], &pieces[k], jerk);
            self.corner[k] = bend.min(pieces[k - 1].top).min(pieces[k].top);
        }
        self.corner[start] = distance(self.start.point.velocity, [0.0; 3]);
        for k in start + 1..=count {
            let reach = self.corner[k - 1].powi(2) + 2.0 * push * pieces[k - 1].segment.length();
            self.corner[k] = self.corner[k].min(reach.sqrt());
        }
        for k in (start + 1..count).rev() {
            // The last piece may end before its end.
            let length = (self.tube.along[k + 1].min(self.tube.end) - self.tube.along[k]).max(0.0);
            let reach = self.corner[k + 1].powi(2) + 2.0 * push * length;
            self.corner[k] = self.corner[k].min(reach.sqrt());
        }
    }

    /// The greatest speed at a distance along the contour of the first timing, mm/s.
    fn first_speed(&self, along: f64, push: f64) -> f64 {
        let k = self.tube.segment_at(along);
        let from = along - self.tube.along[k].max(self.start.point.along.min(along));
        let to = self.tube.along[k + 1].min(self.tube.end) - along;
        let rise = (self.corner[k].powi(2) + 2.0 * push * from.max(0.0)).sqrt();
        let fall = (self.corner[k + 1].powi(2) + 2.0 * push * to.max(0.0)).sqrt();
        rise.min(fall).min(self.tube.pieces[k].top)
    }

    /// The first three control points: position, velocity and acceleration of the start at the nominal rate.
    pub(super) fn begin_points(&mut self) {
        let (d, start) = (self.spacing_s, self.start.point);
        let speed = distance(start.velocity, [0.0; 3]);
        self.smooth.points.clear();
        self.smooth.along.clear();
        for step in [-1.0, 0.0, 1.0_f64] {
            self.smooth.points.push([0, 1, 2].map(|x| {
                let (d1, d2) = (start.velocity[x] * d, start.acceleration[x] * d * d);
                start.at[x] - d2 / 6.0 + step * d1 + step.abs() * d2 / 2.0
            }));
            self.smooth.along.push((start.along + step * speed * d).clamp(0.0, self.tube.end));
        }
    }

    pub(super) fn begin_lay(&mut self) {
        self.begin_points();
        self.sum = self.start.point.along;
        self.cursor = 1;
    }

    /// Control points along the contour at even times of the guess; begins again with a coarser spacing when they are
    /// too many. True when done.
    pub(super) fn lay_first(&mut self, budget: &mut Budget) -> bool {
        let push = self.push();
        let (spacing, end) = (self.spacing_s, self.tube.end);
        let least = 0.5 * push * spacing;
        while !budget.is_spent() {
            budget.take(COST_LAY);
            let half = self.sum + self.first_speed(self.sum, push).max(least) * spacing / 2.0;
            self.sum += self.first_speed(half.min(end), push).max(least) * spacing;
            self.cursor += 1;
            if self.sum >= end {
                self.end_points();
                return true;
            }
            if self.cursor > 2 {
                self.smooth.points.push(self.tube.at(self.sum));
                self.smooth.along.push(self.sum);
            }
            if self.smooth.points.len() >= POINTS - POINTS_LEAST - POINTS_SPARE {
                self.spacing_s *= COARSER;
                self.begin_lay();
                return false;
            }
        }
        false
    }

    /// The last control points, at rest.
    fn end_points(&mut self) {
        let end = self.tube.end_point();
        for _ in 0..3.max(POINTS_LEAST.saturating_sub(self.smooth.points.len())) {
            self.smooth.points.push(end);
            self.smooth.along.push(self.tube.end);
        }
    }

    /// Time of the whole plan; true when done.
    pub(super) fn total(&mut self, budget: &mut Budget) -> bool {
        let end = self.intervals();
        let until = budget.slice(self.cursor, end, COST_TIME);
        for k in self.cursor..until {
            self.sum += self.time_between(k, 0.0, 1.0);
        }
        self.cursor = until;
        until == end
    }

    /// Prepares to place the control points again; the spacing grows if they would be too many.
    pub(super) fn begin_retime(&mut self) {
        let most = (POINTS - POINTS_LEAST - 2 * POINTS_SPARE) as f64;
        self.sum = (self.sum / most).max(SPACING_S / self.spacing_s);
        self.follow = Follow::default();
        self.fresh.clear();
        self.cursor = 0;
    }

    /// Control points again at even times of the better timing; true when done.
    pub(super) fn retime(&mut self, budget: &mut Budget) -> bool {
        while !budget.is_spent() {
            budget.take(COST_RETIME);
            // The first three stand for the times from -1 to 1.
            self.advance(if self.cursor == 0 { 2.0 * self.sum } else { self.sum });
            self.cursor += 1;
            if self.is_at_end() || self.fresh.len() >= POINTS - POINTS_LEAST - POINTS_SPARE {
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
