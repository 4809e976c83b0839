//! Timing: where on the contour the control points of a span begin, and begin again.
//!
//! Owns the guess of a first timing from corners and accelerations, and the even spacing in time of a better one. Knows
//! nothing of what the smoothing makes of it.

use super::super::AxisLimits;
use super::super::contour::distance;
use super::super::smooth::POINTS;
use super::{Follow, POINTS_AIM, POINTS_LEAST, SPACING_LEAST_S, Span, TUBE_SHARE};

/// How often the spacing grows at most, and by what, until the points are few enough.
const COARSER_MOST: u32 = 24;
const COARSER: f64 = 1.5;

impl Span {
    /// The greatest speed at a distance along the contour of the first timing, mm/s.
    fn first_speed(&self, along: f64, push: f64) -> f64 {
        let k = self.tube.segment_at(along);
        let (from, to) = (along - self.tube.along[k], self.tube.along[k + 1] - along);
        let rise = (self.corner[k].powi(2) + 2.0 * push * from.max(0.0)).sqrt();
        let fall = (self.corner[k + 1].powi(2) + 2.0 * push * to.max(0.0)).sqrt();
        let own = self.tube.segments[k].limits(&self.limits).velocity_mm_s.min(self.feeds[k]);
        rise.min(fall).min(own)
    }

    /// A first timing: corners at a speed guessed from tolerance and jerk, even acceleration between them.
    pub(super) fn first_timing(&mut self) {
        let least =
            |of: fn(&AxisLimits) -> f64| self.limits.axes.iter().map(|(_, l)| of(l)).fold(f64::INFINITY, f64::min);
        let (push, jerk) = (0.5 * least(|l| l.acceleration_mm_s2), least(|l| l.jerk_mm_s3));
        let count = self.tube.segments.len();
        self.corner.clear();
        self.corner.resize(count + 1, 0.0);
        for k in 1..count {
            let [_, a] = self.tube.segments[k - 1].directions();
            let [b, _] = self.tube.segments[k].directions();
            let turn = distance(a, b).max(1e-9);
            // A bend of half-width h deviates turn · h / 6 and needs the third derivative turn / h²; the tube gives
            // about two and a half times that width by swinging out before and after.
            let width = 2.5 * 6.0 * self.tolerance / turn;
            let bend = (jerk * width * width / turn).cbrt();
            self.corner[k] = bend.min(self.feeds[k - 1]).min(self.feeds[k]);
        }
        for k in 1..=count {
            let reach = self.corner[k - 1].powi(2) + 2.0 * push * self.tube.segments[k - 1].length();
            self.corner[k] = self.corner[k].min(reach.sqrt());
        }
        for k in (0..count).rev() {
            let reach = self.corner[k + 1].powi(2) + 2.0 * push * self.tube.segments[k].length();
            self.corner[k] = self.corner[k].min(reach.sqrt());
        }
        let mut spacing = SPACING_LEAST_S;
        for _ in 0..COARSER_MOST {
            let points = self.lay_first(spacing, push);
            if (points as f64) < POINTS_AIM {
                break;
            }
            spacing *= COARSER;
        }
        self.spacing_s = spacing;
    }

    /// Control points along the contour at even times; returns how many. Stops early when there are too many.
    fn lay_first(&mut self, spacing: f64, push: f64) -> usize {
        let (length, least) = (self.tube.length(), 0.5 * push * spacing);
        self.smooth.points.clear();
        self.smooth.along.clear();
        let start = self.tube.segments[0].at(0.0);
        for _ in 0..3 {
            self.smooth.points.push(start);
            self.smooth.along.push(0.0);
        }
        let mut along = 0.0;
        while self.smooth.points.len() < POINTS - 4 {
            let half = along + self.first_speed(along, push).max(least) * spacing / 2.0;
            along += self.first_speed(half.min(length), push).max(least) * spacing;
            if along >= length {
                break;
            }
            self.smooth.points.push(self.tube.at(along));
            self.smooth.along.push(along);
        }
        let last = self.tube.segments.len() - 1;
        let end = self.tube.segments[last].at(f64::INFINITY);
        for _ in 0..3.max(POINTS_LEAST.saturating_sub(self.smooth.points.len())) {
            self.smooth.points.push(end);
            self.smooth.along.push(length);
        }
        self.smooth.points.len()
    }

    /// Control points again at even times of the better timing.
    pub(super) fn time_again(&mut self) {
        self.rewind();
        self.fresh.clear();
        let mut spacing = 1.0;
        // The time of the plan, in spacings.
        let mut total = 0.0;
        for k in 0..self.intervals() {
            total += self.time_between(k, 0.0, 1.0);
        }
        if total > POINTS_AIM {
            spacing = total / POINTS_AIM;
        }
        self.spacing_s *= spacing;
        while self.fresh.len() < POINTS - 8 {
            self.advance(spacing);
            if self.is_at_end() {
                break;
            }
            // The knots around are 1 and 2; the first and the last fixed ones have been placed by nobody.
            let Follow { interval, part } = self.follow;
            let length = self.tube.length();
            let place = |k: usize| match k {
                0 => 0.0,
                k if k + 1 >= self.smooth.points.len() => length,
                k => self.smooth.near[k].0,
            };
            let along = place(interval + 1) + part * (place(interval + 2) - place(interval + 1));
            self.fresh.push((self.position(), along));
        }
        let end = self.smooth.points[self.smooth.points.len() - 1];
        self.smooth.points.truncate(3);
        self.smooth.along.truncate(3);
        for (at, along) in &self.fresh {
            self.smooth.points.push(*at);
            self.smooth.along.push(*along);
        }
        for _ in 0..3.max(POINTS_LEAST.saturating_sub(self.smooth.points.len())) {
            self.smooth.points.push(end);
            self.smooth.along.push(self.tube.length());
        }
        self.smooth.begin(self.allowed() * TUBE_SHARE);
    }
}
