//! The first timing: how fast a contour can be followed within the tolerance, before any curve is known.
//!
//! Samples the contour and looks at averages of it over several widths. Among the averages that stay within the
//! tolerance, the one that can be followed fastest decides: a bend made of many short moves is passed as one bend, whatever
//! its chords. Where even the narrowest average leaves the tolerance, the corner itself decides. Then the speed changes with
//! a constant acceleration. Knows nothing of control points. Every pass can be interrupted and resumed at any sample.
//! Source: an average over a triangle of half-width h is the second difference of the twofold sum; it cuts a bend of
//! curvature κ by κh²/12, which is put back.

use super::super::path_segment::square_distance;
use super::super::tolerance_band::{ToleranceBand, corner_speed};
use super::super::{MotionLimits, per_coordinate};
use crate::units::WorkBudget;

/// Maximum number of intervals between samples.
const MAX_INTERVALS: usize = 256;
/// Intervals per length that the top speed travels in the time of a rounding ([`super::rounding_time_s`]).
const INTERVALS_PER_ROUNDING: f64 = 24.0;
/// Half-widths of the averages, in intervals; about a factor of √2 from one to the next.
const WIDTHS: [usize; 12] = [1, 2, 3, 4, 6, 8, 11, 16, 22, 32, 44, 64];
/// Samples before the start and after the end of the contour, on straight lines: the third difference of an average reaches
/// three half-widths far.
const PADDING: usize = 3 * WIDTHS[WIDTHS.len() - 1] + 1;
/// Deviation of a usable average, as a share of the tolerance: the smoothed curve uses the rest.
const DEVIATION_SHARE: f64 = 0.8;
/// Work units of a sample, of a sum, of an average of one width, and of a corner.
const COST_SAMPLE: usize = 36;
const COST_SUM: usize = 5;
const COST_WIDTH: usize = 66;
const COST_CORNER: usize = 50;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum EstimatePass {
    Sample,
    Sum,
    Evaluate,
    #[default]
    Done,
}

/// The fastest usable average at a sample.
#[derive(Clone, Copy, Debug)]
struct BestAverage {
    speed: f64,
    point: [f64; 3],
}

/// Estimated speed and smoothed points along a contour.
#[derive(Clone, Debug, Default)]
pub(super) struct SpeedEstimate {
    /// Points of the contour, mm.
    samples: Vec<[f64; 3]>,
    /// Twofold sums of the samples with padding, relative to the origin, mm.
    sums: Vec<[f64; 3]>,
    origin: [f64; 3],
    /// The averages that decided, mm.
    smoothed: Vec<[f64; 3]>,
    /// Square of the maximum speed at each sample, mm²/s².
    speed_squares: Vec<f64>,
    /// Number of intervals and their length along the contour, mm.
    intervals: usize,
    step: f64,
    pass: EstimatePass,
    cursor: usize,
    /// The move of the sample at the cursor.
    segment: usize,
    running: [[f64; 3]; 2],
}

impl SpeedEstimate {
    /// An empty estimate with capacity for the maximum number of samples.
    pub(super) fn new() -> Self {
        let samples = || Vec::with_capacity(MAX_INTERVALS + 1);
        Self {
            samples: samples(),
            sums: Vec::with_capacity(MAX_INTERVALS + 1 + 2 * PADDING),
            smoothed: samples(),
            speed_squares: Vec::with_capacity(MAX_INTERVALS + 1),
            ..Self::default()
        }
    }

    /// Starts the estimate of a band; `rounding_s` is the time of a rounding within its tolerance.
    pub(super) fn begin(&mut self, band: &ToleranceBand, rounding_s: f64) {
        let top_speed = band.moves.iter().map(|piece| piece.top_speed).fold(0.0, f64::max);
        let fine = (top_speed * rounding_s / INTERVALS_PER_ROUNDING).max(f64::MIN_POSITIVE);
        self.intervals = ((band.end / fine).ceil() as usize).clamp(2, MAX_INTERVALS);
        self.step = band.end / self.intervals as f64;
        self.samples.clear();
        self.sums.clear();
        self.smoothed.clear();
        self.speed_squares.clear();
        (self.pass, self.cursor, self.segment) = (EstimatePass::Sample, 0, 0);
        self.running = [[0.0; 3]; 2];
    }

    /// Works until the estimate is done; false if the work budget was spent before.
    pub(super) fn work(&mut self, band: &ToleranceBand, limits: &MotionLimits, budget: &mut WorkBudget) -> bool {
        while self.pass != EstimatePass::Done && !budget.is_spent() {
            let last = match self.pass {
                EstimatePass::Sample => self.sample(band, budget),
                EstimatePass::Sum => self.sum_up(budget),
                EstimatePass::Evaluate => self.evaluate(band, limits, budget),
                EstimatePass::Done => return true,
            };
            if self.cursor < last {
                self.cursor += 1;
                continue;
            }
            self.cursor = 0;
            self.segment = 0;
            self.pass = match self.pass {
                EstimatePass::Sample => EstimatePass::Sum,
                EstimatePass::Sum => EstimatePass::Evaluate,
                EstimatePass::Evaluate | EstimatePass::Done => EstimatePass::Done,
            };
        }
        self.pass == EstimatePass::Done
    }

    /// Moves on to the move at the cursor and returns the distance along the contour, mm.
    fn advance_segment(&mut self, band: &ToleranceBand) -> f64 {
        let along = (self.cursor as f64 * self.step).min(band.end);
        while self.segment + 1 < band.moves.len() && band.starts[self.segment + 1] <= along {
            self.segment += 1;
        }
        along
    }

    fn sample(&mut self, band: &ToleranceBand, budget: &mut WorkBudget) -> usize {
        budget.spend(COST_SAMPLE);
        let along = self.advance_segment(band);
        self.samples.push(band.moves[self.segment].segment.at(along - band.starts[self.segment]));
        self.intervals
    }

    fn sum_up(&mut self, budget: &mut WorkBudget) -> usize {
        budget.spend(COST_SUM);
        if self.cursor == 0 {
            self.origin = self.samples[self.intervals / 2];
        }
        let last = self.intervals;
        let (from, next, by) = if self.cursor < PADDING {
            (0, 1, self.cursor as f64 - PADDING as f64)
        } else if self.cursor > PADDING + last {
            (last, last - 1, (PADDING + last) as f64 - self.cursor as f64)
        } else {
            (self.cursor - PADDING, self.cursor - PADDING, 0.0)
        };
        let [once, twice] = &mut self.running;
        for x in 0..3 {
            let (a, b) = (self.samples[from][x], self.samples[next][x]);
            once[x] += a + by * (b - a) - self.origin[x];
            twice[x] += once[x];
        }
        self.sums.push(*twice);
        last + 2 * PADDING
    }

    /// The average over a triangle of half-width `width` around a padded index, relative to the origin, mm.
    fn average(&self, index: usize, width: usize) -> [f64; 3] {
        let part = 1.0 / (width * width) as f64;
        let (after, here, before) =
            (&self.sums[index + width - 1], &self.sums[index - 1], &self.sums[index - width - 1]);
        per_coordinate(|x| (after[x] - 2.0 * here[x] + before[x]) * part)
    }

    /// Speed and smoothed point of the sample at the cursor.
    fn evaluate(&mut self, band: &ToleranceBand, limits: &MotionLimits, budget: &mut WorkBudget) -> usize {
        let along = self.advance_segment(band);
        let piece = &band.moves[self.segment];
        let mut best = BestAverage { speed: 0.0, point: self.samples[self.cursor] };
        let mut unusable = 0;
        for width in WIDTHS {
            budget.spend(COST_WIDTH);
            if !self.try_width(width, DEVIATION_SHARE * piece.tolerance, limits, &mut best) {
                unusable += 1;
            }
            if unusable > 1 || best.speed >= piece.top_speed {
                break;
            }
        }
        if best.speed <= 0.0 {
            best.speed = self.slowest_corner(band, along, limits, budget);
        }
        self.smoothed.push(best.point);
        self.speed_squares.push(best.speed.min(piece.top_speed).powi(2));
        self.intervals
    }

    /// Keeps the average of a width if it is within the tolerance and faster; false if it is not within the tolerance.
    fn try_width(&self, width: usize, tolerance: f64, limits: &MotionLimits, best: &mut BestAverage) -> bool {
        let index = self.cursor + PADDING;
        let at = |index: usize| self.average(index, width);
        let p = [at(index - 2 * width), at(index - width), at(index), at(index + width), at(index + 2 * width)];
        let h = width as f64 * self.step;
        let second = per_coordinate(|x| p[1][x] - 2.0 * p[2][x] + p[3][x]);
        let center = per_coordinate(|x| p[2][x] - second[x] / 12.0 + self.origin[x]);
        let here = &self.samples[self.cursor];
        if square_distance(center, *here) > tolerance * tolerance {
            return false;
        }
        // Acceleration and jerk relative to their limits at 1 mm/s.
        let (mut acceleration, mut jerk) = (f64::MIN_POSITIVE, f64::MIN_POSITIVE);
        for (x, (_, limit)) in limits.axes.iter().enumerate() {
            let before = p[3][x] - 3.0 * p[2][x] + 3.0 * p[1][x] - p[0][x];
            let after = p[4][x] - 3.0 * p[3][x] + 3.0 * p[2][x] - p[1][x];
            acceleration = acceleration.max(second[x].abs() / limit.acceleration_mm_s2);
            jerk = jerk.max(before.abs().max(after.abs()) / limit.jerk_mm_s3);
        }
        let speed = (h / acceleration.sqrt()).min(h / jerk.cbrt());
        if speed > best.speed {
            *best = BestAverage { speed, point: center };
        }
        true
    }

    /// The speed of the slowest corner within an interval of a distance along the contour, mm/s.
    fn slowest_corner(&self, band: &ToleranceBand, along: f64, limits: &MotionLimits, budget: &mut WorkBudget) -> f64 {
        let jerk = limits.least().jerk_mm_s3;
        let first = band.segment_at((along - self.step).max(0.0));
        let mut speed = band.moves[first].top_speed;
        for (k, pair) in band.moves.windows(2).enumerate().skip(first) {
            if band.starts[k + 1] > along + self.step {
                break;
            }
            budget.spend(COST_CORNER);
            speed = speed.min(corner_speed(&pair[0], &pair[1], jerk));
        }
        speed
    }

    /// Limits the change of speed by an acceleration, mm/s², from a speed at a distance along the contour to rest at its
    /// end.
    pub(super) fn limit_acceleration(&mut self, from: f64, speed: f64, acceleration: f64) {
        let by = 2.0 * acceleration * self.step;
        let start = ((from / self.step) as usize).min(self.intervals - 1);
        self.speed_squares[start] = speed * speed;
        for k in start + 1..=self.intervals {
            self.speed_squares[k] = self.speed_squares[k].min(self.speed_squares[k - 1] + by);
        }
        self.speed_squares[self.intervals] = 0.0;
        for k in (start + 1..self.intervals).rev() {
            self.speed_squares[k] = self.speed_squares[k].min(self.speed_squares[k + 1] + by);
        }
    }

    /// The interval of a distance along the contour and the fraction of it.
    fn place(&self, along: f64) -> (usize, f64) {
        let place = (along / self.step).max(0.0).min(self.intervals as f64);
        let k = (place as usize).min(self.intervals - 1);
        (k, place - k as f64)
    }

    /// Estimated speed at a distance along the contour, mm/s.
    pub(super) fn speed_at(&self, along: f64) -> f64 {
        let (k, part) = self.place(along);
        let (a, b) = (self.speed_squares[k], self.speed_squares[k + 1]);
        (a + part * (b - a)).max(0.0).sqrt()
    }

    /// Smoothed point at a distance along the contour, mm.
    pub(super) fn point_at(&self, along: f64) -> [f64; 3] {
        let (k, part) = self.place(along);
        let (a, b) = (&self.smoothed[k], &self.smoothed[k + 1]);
        per_coordinate(|x| a[x] + part * (b[x] - a[x]))
    }
}
