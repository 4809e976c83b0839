//! Timing: places the control points of a window along the contour.
//!
//! Places them at even times of the estimated speed, and again at even times of the planned speed. Knows nothing of the
//! smoothing.

use super::super::path_segment::distance;
use super::super::per_coordinate;
use super::super::smoother::{FIXED_POINTS, MAX_CONTROL_POINTS};
use super::{CurvePosition, LookaheadWindow, PlanPoint};
use crate::units::WorkBudget;

/// Minimum number of control points after the given ones, and number kept free at the end.
const MIN_FREE_POINTS: usize = 24;
const SPARE_POINTS: usize = 8;
const MAX_PLACED_POINTS: usize = MAX_CONTROL_POINTS - MIN_FREE_POINTS - SPARE_POINTS;
/// Share of the smallest axis acceleration used by the first timing.
const ACCELERATION_SHARE: f64 = 0.5;
/// Number of knots over which the rate at the start blends to a constant one: in braking times, and its range.
const EVEN_BRAKING_TIMES: f64 = 1.2;
const EVEN_KNOTS: (usize, usize) = (20, 80);
/// Work units of one control point on the previous plan, of one placed along the contour, and of one placed again.
const COST_GUIDE: usize = 40;
const COST_PLACE: usize = 80;
const COST_RETIME: usize = 130;

impl LookaheadWindow {
    /// The first three control points: position, velocity and acceleration at the start.
    pub(super) fn begin_points(&mut self) {
        let (start, smooth, d) = (&self.start, &mut self.smoother, self.spacing_s);
        smooth.points.clear();
        smooth.along.clear();
        let speed = distance(start.point.velocity, [0.0; 3]);
        for step in [-1.0, 0.0, 1.0_f64] {
            smooth.points.push(per_coordinate(|x| {
                let (d1, d2) = (start.point.velocity[x] * d, start.point.acceleration[x] * d * d);
                start.point.at[x] - d2 / 6.0 + step * d1 + step.abs() * d2 / 2.0
            }));
            smooth.along.push((start.point.along + step * speed * d).max(0.0).min(self.band.end));
        }
    }

    /// In motion, the next control points follow the previous plan from the start on, in its own time.
    pub(super) fn follow_guide(&mut self, guide: &[PlanPoint], budget: &mut WorkBudget) {
        let (d, tick) = (self.spacing_s, self.limits.tick_s);
        let smooth = &mut self.smoother;
        for time in (FIXED_POINTS - 1..MAX_PLACED_POINTS - 1).map(|knot| knot as f64 * d) {
            let index = (time / tick) as usize;
            let Some(point) = guide.get(index) else { break };
            let since = time - index as f64 * tick;
            let along = point.along - self.start.shift.0 + since * distance(point.velocity, [0.0; 3]);
            let least = smooth.along[smooth.along.len() - 1];
            if along >= self.band.end {
                break;
            }
            smooth.along.push(along.max(least));
            // A spline's control point lies beside its curve by a sixth of the second difference.
            smooth.points.push(per_coordinate(|x| {
                let (v, a) = (point.velocity[x], point.acceleration[x]);
                point.at[x] + since * (v + since / 2.0 * a) - a * d * d / 6.0
            }));
        }
        self.guided = smooth.points.len() - FIXED_POINTS;
        budget.spend(self.guided * COST_GUIDE);
    }

    pub(super) fn begin_placing(&mut self) {
        let last = self.smoother.points.len() - 1;
        let from = self.smoother.along[last];
        let speed = distance(self.smoother.points[last], self.smoother.points[last - 2]) / (2.0 * self.spacing_s);
        let limits = self.limits.least();
        self.estimate.limit_acceleration(from, speed, ACCELERATION_SHARE * limits.acceleration_mm_s2);
        let even = (EVEN_BRAKING_TIMES * limits.ramp_s(speed) / self.next_spacing_s) as usize;
        self.speed.even_knots = even.clamp(EVEN_KNOTS.0, EVEN_KNOTS.1);
        self.sum = from;
    }

    /// Places control points along the contour at even times of the estimated speed, up to the maximum; true when done.
    pub(super) fn place_points(&mut self, budget: &mut WorkBudget) -> bool {
        let end = self.band.end;
        let least = 0.5 * ACCELERATION_SHARE * self.limits.least().acceleration_mm_s2 * self.spacing_s;
        while !budget.is_spent() {
            budget.spend(COST_PLACE);
            let half = self.sum + self.estimate.speed_at(self.sum).max(least) * self.spacing_s / 2.0;
            self.sum += self.estimate.speed_at(half.min(end)).max(least) * self.spacing_s;
            if self.smoother.points.len() >= MAX_PLACED_POINTS && self.sum < end {
                self.cut_band(self.sum);
            }
            if self.sum >= self.band.end {
                self.add_end_points();
                return true;
            }
            self.smoother.points.push(self.estimate.point_at(self.sum));
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
        let least = FIXED_POINTS + MIN_FREE_POINTS;
        for _ in 0..FIXED_POINTS.max(least.saturating_sub(self.smoother.points.len())) {
            self.smoother.points.push(end);
            self.smoother.along.push(self.band.end);
        }
    }

    /// Prepares to place the control points after the given ones again.
    pub(super) fn begin_retime(&mut self) {
        self.sum = self.next_spacing_s / self.spacing_s;
        // The last given point belongs to the knot at the start of this interval.
        self.curve_position = CurvePosition { interval: FIXED_POINTS - 2, fraction: 0.0 };
        self.new_points.clear();
        (self.followed, self.guided) = (self.lead_knots(), 0);
    }

    /// Places the control points again at even times of the planned speed; true when done.
    pub(super) fn retime(&mut self, budget: &mut WorkBudget) -> bool {
        while !budget.is_spent() {
            budget.spend(COST_RETIME);
            self.advance(self.sum);
            let full = FIXED_POINTS + self.new_points.len() >= MAX_PLACED_POINTS;
            if full && !self.is_at_end() {
                self.cut_band(self.along());
            }
            if full || self.is_at_end() {
                self.spacing_s = self.next_spacing_s;
                self.begin_points();
                for (at, along) in &self.new_points {
                    self.smoother.points.push(*at);
                    self.smoother.along.push(*along);
                }
                self.add_end_points();
                return true;
            }
            // Start values only: the smoothing takes them into its own curve.
            self.new_points.push((self.position(), self.along()));
            self.guided += usize::from(self.curve_position.interval < self.followed);
        }
        false
    }
}
