//! Timing: places the control points of a window along the contour.
//!
//! Estimates a first timing from corner speeds and accelerations, and places the control points again at even times of
//! the planned speed. Knows nothing of the smoothing.

use super::super::AxisLimits;
use super::super::path_segment::distance;
use super::super::per_coordinate;
use super::super::smoother::{FIXED_POINTS, MAX_CONTROL_POINTS};
use super::super::speed_optimizer::{BLEND_KNOTS, blend_rate};
use super::super::tolerance_band::corner_speed;
use super::{CurvePosition, KNOT_SPACING_S, LookaheadWindow};
use crate::units::WorkBudget;

/// Minimum number of control points after the given ones, and number kept free at the end.
const MIN_FREE_POINTS: usize = 24;
const SPARE_POINTS: usize = 8;
const MAX_PLACED_POINTS: usize = MAX_CONTROL_POINTS - MIN_FREE_POINTS - SPARE_POINTS;
/// Share of the smallest axis acceleration used by the first timing.
const ACCELERATION_SHARE: f64 = 0.5;
/// Number of knots over which the rate taken over blends to a constant one: in braking times, and its maximum.
const EVEN_BRAKING_TIMES: f64 = 1.2;
const MAX_EVEN_KNOTS: usize = 80;
/// Work units of one corner, of one control point placed, and of one placed again.
const COST_CORNER: usize = 80;
const COST_PLACE: usize = 130;
const COST_RETIME: usize = 250;

impl LookaheadWindow {
    fn assumed_acceleration(&self) -> f64 {
        ACCELERATION_SHARE * least(self, |l| l.acceleration_mm_s2)
    }

    /// Estimates corner speeds from tolerance and jerk, with constant acceleration between corners.
    pub(super) fn guess_corners(&mut self, budget: &mut WorkBudget) {
        let (push, jerk) = (self.assumed_acceleration(), least(self, |l| l.jerk_mm_s3));
        let pieces = &self.band.moves;
        let count = pieces.len();
        budget.spend(count * COST_CORNER);
        self.corner_speeds.clear();
        self.corner_speeds.resize(count + 1, 0.0);
        for k in 1..count {
            let bend = corner_speed(&pieces[k - 1], &pieces[k], jerk);
            self.corner_speeds[k] = bend.min(pieces[k - 1].top_speed).min(pieces[k].top_speed);
        }
        let (from, speed) = self.first_timing_start();
        let start = self.band.segment_at(from);
        self.corner_speeds[start] = speed;
        for k in start + 1..=count {
            let reach = self.corner_speeds[k - 1].powi(2) + 2.0 * push * pieces[k - 1].segment.length();
            self.corner_speeds[k] = self.corner_speeds[k].min(reach.sqrt());
        }
        for k in (start + 1..count).rev() {
            // The curve may end inside the last move.
            let length = (self.band.starts[k + 1].min(self.band.end) - self.band.starts[k]).max(0.0);
            let reach = self.corner_speeds[k + 1].powi(2) + 2.0 * push * length;
            self.corner_speeds[k] = self.corner_speeds[k].min(reach.sqrt());
        }
    }

    /// Maximum speed of the first timing at a distance along the contour, mm/s.
    fn first_speed(&self, along: f64, push: f64) -> f64 {
        let k = self.band.segment_at(along);
        let from = along - self.band.starts[k].max(self.first_from.min(along));
        let to = self.band.starts[k + 1].min(self.band.end) - along;
        let rise = (self.corner_speeds[k].powi(2) + 2.0 * push * from.max(0.0)).sqrt();
        let fall = (self.corner_speeds[k + 1].powi(2) + 2.0 * push * to.max(0.0)).sqrt();
        rise.min(fall).min(self.band.moves[k].top_speed)
    }

    /// The first control points. At rest: three at the same position. In motion: those of the previous curve up to
    /// `until`, with their timing.
    pub(super) fn begin_points(&mut self) {
        let (start, smooth) = (&self.start, &mut self.smoother);
        smooth.points.clear();
        smooth.along.clear();
        smooth.lead = FIXED_POINTS;
        let Some(until) = start.lead_end else {
            let (d, speed) = (self.spacing_s, distance(start.point.velocity, [0.0; 3]));
            for step in [-1.0, 0.0, 1.0_f64] {
                smooth.points.push(per_coordinate(|x| {
                    let (d1, d2) = (start.point.velocity[x] * d, start.point.acceleration[x] * d * d);
                    start.point.at[x] - d2 / 6.0 + step * d1 + step.abs() * d2 / 2.0
                }));
                smooth.along.push((start.point.along + step * speed * d).max(0.0).min(self.band.end));
            }
            return;
        };
        let from = start.point.curve_position.interval;
        let last = self.previous.points.len() - FIXED_POINTS;
        let until = until.max(from).min(last.max(from + 1) - 1);
        smooth.lead = until - from + FIXED_POINTS + 1;
        for k in from..from + smooth.lead {
            smooth.points.push(self.previous.points[k]);
            // The first control point has no knot.
            let along = self.previous.near[k.max(1)].0.max(0.0) - start.shift.0;
            let least = smooth.along.last().copied().unwrap_or(0.0);
            smooth.along.push(along.max(least).min(self.band.end));
        }
    }

    /// Distance along the contour, mm, and speed, mm/s, at the start of the first timing.
    fn first_timing_start(&self) -> (f64, f64) {
        let (points, last) = (&self.smoother.points, self.smoother.lead - 1);
        let step = distance(points[last], points[last - 2]) / 2.0;
        (self.smoother.along[last], step * self.last_rate_square().sqrt() / self.spacing_s)
    }

    /// The last given coefficient of the square of the rate.
    fn last_rate_square(&self) -> f64 {
        let last = self.start.point.curve_position.interval + self.smoother.lead - 2;
        if self.start.lead_end.is_some() { self.previous.rate_square[last] } else { 1.0 }
    }

    /// Time from the previous control point to number `count` after the given ones, in knot spacings: the rate blends
    /// from the given to the nominal one.
    fn step_after(&self, count: usize) -> f64 {
        1.0 / blend_rate(self.last_rate_square(), 1.0, count as f64 / BLEND_KNOTS as f64).sqrt()
    }

    pub(super) fn begin_placing(&mut self) {
        let (from, speed) = self.first_timing_start();
        self.first_from = from;
        let (push, jerk) = (2.0 * self.assumed_acceleration(), least(self, |l| l.jerk_mm_s3));
        let brake = (speed / push + push / jerk).min(2.0 * (speed / jerk).sqrt());
        self.speed.even_knots =
            ((EVEN_BRAKING_TIMES * brake / KNOT_SPACING_S) as usize).clamp(BLEND_KNOTS, MAX_EVEN_KNOTS);
        self.sum = self.first_from;
        self.cursor = 0;
    }

    /// Places control points along the contour at even times of the first timing, up to the maximum; true when done.
    pub(super) fn place_points(&mut self, budget: &mut WorkBudget) -> bool {
        let push = self.assumed_acceleration();
        let end = self.band.end;
        let least = 0.5 * push * self.spacing_s;
        while !budget.is_spent() {
            budget.spend(COST_PLACE);
            let spacing = self.spacing_s * self.step_after(self.cursor + 1);
            let half = self.sum + self.first_speed(self.sum, push).max(least) * spacing / 2.0;
            self.sum += self.first_speed(half.min(end), push).max(least) * spacing;
            self.cursor += 1;
            if self.smoother.points.len() >= MAX_PLACED_POINTS && self.sum < end {
                self.cut_band(self.sum);
            }
            if self.sum >= self.band.end {
                self.add_end_points();
                return true;
            }
            self.smoother.points.push(self.band.at(self.sum));
            self.smoother.along.push(self.sum);
        }
        false
    }

    /// The horizon was too long: cuts the tolerance band.
    fn cut_band(&mut self, along: f64) {
        self.band.truncate_at(along);
        self.is_cut = true;
    }

    /// The last control points, at rest.
    fn add_end_points(&mut self) {
        let end = self.band.end_point();
        let least = self.smoother.lead + MIN_FREE_POINTS;
        for _ in 0..FIXED_POINTS.max(least.saturating_sub(self.smoother.points.len())) {
            self.smoother.points.push(end);
            self.smoother.along.push(self.band.end);
        }
    }

    /// Prepares to place the control points after the given ones again.
    pub(super) fn begin_retime(&mut self) {
        self.sum = KNOT_SPACING_S / self.spacing_s;
        // The last given point belongs to the knot at the start of this interval.
        self.curve_position = CurvePosition { interval: self.smoother.lead - 2, fraction: 0.0 };
        self.new_points.clear();
        self.cursor = 0;
    }

    /// Places the control points again at even times of the planned speed; true when done.
    pub(super) fn retime(&mut self, budget: &mut WorkBudget) -> bool {
        while !budget.is_spent() {
            budget.spend(COST_RETIME);
            self.advance(self.sum * self.step_after(self.cursor + 1));
            self.cursor += 1;
            let full = self.smoother.lead + self.new_points.len() >= MAX_PLACED_POINTS;
            if full && !self.is_at_end() {
                self.cut_band(self.along());
            }
            if full || self.is_at_end() {
                self.spacing_s *= self.sum;
                self.begin_points();
                for (at, along) in &self.new_points {
                    self.smoother.points.push(*at);
                    self.smoother.along.push(*along);
                }
                self.add_end_points();
                return true;
            }
            self.new_points.push((self.position(), self.along()));
        }
        false
    }
}

fn least(window: &LookaheadWindow, of: fn(&AxisLimits) -> f64) -> f64 {
    window.limits.axes.iter().map(|(_, l)| of(l)).fold(f64::INFINITY, f64::min)
}
