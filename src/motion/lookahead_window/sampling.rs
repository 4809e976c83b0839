//! Sampling: from time to a point of the planned curve.
//!
//! Advances from one set-point of a plan to the next. Within an interval, b (the square of the rate) is a parabola.
//! Time is the integral of 1/√b, computed by Gauss quadrature and inverted by Newton's method.

use super::super::per_coordinate;
use super::super::setpoint_buffer::spline;
use super::super::smoother::MAX_CONTROL_POINTS;
use super::{CurvePosition, LookaheadWindow, PlanPoint};

/// Newton iterations; three reach rounding accuracy.
const NEWTON_STEPS: u32 = 3;

impl LookaheadWindow {
    /// b and its derivative at a fraction of an interval.
    fn rate_square(&self, interval: usize, part: f64) -> (f64, f64) {
        let c = &self.speed.rate_square[interval..interval + 3];
        let (slope, bend) = (c[1] - c[0], c[2] - 2.0 * c[1] + c[0]);
        (f64::midpoint(c[0], c[1]) + part * (slope + part * bend / 2.0), slope + part * bend)
    }

    /// Time between two fractions of an interval, in knot spacings, by four-point Gauss quadrature.
    pub(super) fn time_between(&self, interval: usize, from: f64, to: f64) -> f64 {
        const NODES: [(f64, f64); 4] = [
            (0.069_431_844_202_973_71, 0.173_927_422_568_726_9),
            (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
            (0.669_990_521_792_428_1, 0.326_072_577_431_273_1),
            (0.930_568_155_797_026_2, 0.173_927_422_568_726_9),
        ];
        let span = to - from;
        NODES.iter().map(|(x, w)| w / self.rate_square(interval, from + span * x).0.sqrt()).sum::<f64>() * span
    }

    /// Advances by a time in knot spacings.
    pub(super) fn advance(&mut self, mut time: f64) {
        for _ in 0..MAX_CONTROL_POINTS {
            if self.is_at_end() {
                return;
            }
            let CurvePosition { interval, fraction: part } = self.curve_position;
            let (b, slope) = self.rate_square(interval, part);
            // σ̈ = b'/2
            let mut to = part + time * (b.sqrt() + time * slope / 4.0);
            if to > 0.9 {
                let rest = self.time_between(interval, part, 1.0);
                if rest <= time {
                    time -= rest;
                    self.curve_position = CurvePosition { interval: interval + 1, fraction: 0.0 };
                    continue;
                }
            }
            for _ in 0..NEWTON_STEPS {
                to = to.max(part).min(1.0);
                let off = time - self.time_between(interval, part, to);
                to += off * self.rate_square(interval, to).0.sqrt();
                if off.abs() < 1e-13 {
                    break;
                }
            }
            self.curve_position.fraction = to.max(part).min(1.0);
            return;
        }
    }

    pub(super) fn position(&self) -> [f64; 3] {
        let CurvePosition { interval, fraction: part } = self.curve_position;
        if self.is_at_end() {
            return self.band.end_point();
        }
        spline(&self.smoother.points[interval..interval + 4], part)
    }

    /// Distance along the contour at the present position, interpolated between knots, mm.
    pub(super) fn along(&self) -> f64 {
        let CurvePosition { interval, fraction: part } = self.curve_position;
        if self.is_at_end() {
            return self.band.end;
        }
        let last = self.smoother.points.len() - 1;
        let place = |k: usize| match k {
            1 => self.start.point.along,
            k if k >= last => self.band.end,
            k => self.smoother.knots[k].near.0,
        };
        place(interval + 1) + part * (place(interval + 2) - place(interval + 1))
    }

    /// The set-point at the present position.
    pub(super) fn plan_point(&self) -> PlanPoint {
        let last = self.band.moves.len() - 1;
        if self.is_at_end() {
            return PlanPoint::at_rest(self.position(), self.band.end, last);
        }
        let CurvePosition { interval, fraction: part } = self.curve_position;
        let p = &self.smoother.points[interval..interval + 4];
        let (b, slope) = self.rate_square(interval, part);
        let (rate, d) = (b.sqrt() / self.spacing_s, self.spacing_s);
        let mut point = PlanPoint::at_rest(spline(p, part), self.along(), self.band.segment_at(self.along()).min(last));
        let second = per_coordinate(|x| (p[0][x] - 2.0 * p[1][x] + p[2][x], p[1][x] - 2.0 * p[2][x] + p[3][x]));
        let first = per_coordinate(|x| {
            let (left, right) = second[x];
            (p[2][x] - p[0][x]) / 2.0 + part * (left + part * (right - left) / 2.0)
        });
        point.velocity = per_coordinate(|x| first[x] * rate);
        point.acceleration = per_coordinate(|x| {
            let (left, right) = second[x];
            ((left + part * (right - left)) * b + first[x] * slope / 2.0) / (d * d)
        });
        point
    }
}
