//! Following: from time to a point of the planned curve.
//!
//! Owns the way from one set-point of a span to the next. Within an interval b is a parabola, so time is the integral of
//! 1/√b, taken by Gauss quadrature and inverted by Newton's method.

use super::super::smooth::POINTS;
use super::super::trail::spline;
use super::{Follow, Span};

/// Steps of Newton's method; three already reach rounding.
const NEWTON_STEPS: u32 = 4;

impl Span {
    /// Coefficients of b over one interval.
    fn rate_square(&self, interval: usize, part: f64) -> f64 {
        let c = &self.speed.rate_square[interval..interval + 3];
        let start = f64::midpoint(c[0], c[1]);
        start + part * ((c[1] - c[0]) + part * (c[2] - 2.0 * c[1] + c[0]) / 2.0)
    }

    /// Time from one part of an interval to another, in spacings, by four-point Gauss quadrature.
    pub(super) fn time_between(&self, interval: usize, from: f64, to: f64) -> f64 {
        const NODES: [(f64, f64); 4] = [
            (0.069_431_844_202_973_71, 0.173_927_422_568_726_9),
            (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
            (0.669_990_521_792_428_1, 0.326_072_577_431_273_1),
            (0.930_568_155_797_026_2, 0.173_927_422_568_726_9),
        ];
        let span = to - from;
        NODES.iter().map(|(x, w)| span * w / self.rate_square(interval, from + span * x).sqrt()).sum()
    }

    /// Goes on by a time in spacings.
    pub(super) fn advance(&mut self, mut time: f64) {
        for _ in 0..POINTS {
            if self.is_at_end() {
                return;
            }
            let Follow { interval, part } = self.follow;
            let rest = self.time_between(interval, part, 1.0);
            if rest <= time {
                time -= rest;
                self.follow = Follow { interval: interval + 1, part: 0.0 };
                continue;
            }
            let mut to = part + (1.0 - part) * time / rest;
            for _ in 0..NEWTON_STEPS {
                let off = time - self.time_between(interval, part, to);
                to = (to + off * self.rate_square(interval, to).sqrt()).clamp(part, 1.0);
            }
            self.follow.part = to;
            return;
        }
    }

    pub(super) fn position(&self) -> [f64; 3] {
        let Follow { interval, part } = self.follow;
        if self.is_at_end() {
            return self.smooth.points[self.smooth.points.len() - 1];
        }
        spline(&self.smooth.points[interval..interval + 4], part)
    }
}
