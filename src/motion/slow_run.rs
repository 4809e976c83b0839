//! Slow runs: feed moves at exactly their programmed feed, with bell-shaped acceleration after interpolation.
//!
//! At grinding feeds a corner needs no planning: an interpolated point advances along the contour by feed times tick, and
//! the set-point is the mean of the last 2N − 1 interpolated points with the triangular weights 1, 2 … N … 2, 1 over N².
//! Start, stop, corners and changes of feed are smoothed alike. Knows nothing of windows.
//!
//! Bounds for every contour at a speed of at most v, with T = N ticks. The sums of the absolute first and second
//! differences of the weights give acceleration ≤ 2v/T and jerk ≤ 4v/T² on each axis; the mean distance of the points
//! from the middle one gives a deviation ≤ v·T/3 from the contour. A mean is never beyond a reversal point of an axis.
//! Source: FANUC, bell-shaped acceleration and deceleration after interpolation; the bounds are calculated here.

use super::blending::{Continuation, continuation};
use super::queued_move::{MoveQueue, QueuedMove};
use super::{MIN_FEED_MM_S, MotionLimits, MotionSpeed, per_coordinate};

/// Least and greatest N, ticks.
const MIN_HALF_WIDTH: usize = 2;
const MAX_HALF_WIDTH: usize = 64;
/// Ticks that the buffer is ahead beyond a stop.
const SPARE_TICKS: u64 = 24;
/// Work units of two points of the filter.
const COST_POINT: usize = 4;
/// Maximum number of move ends that the interpolated point passes in a tick.
const MAX_ENDS_PER_TICK: usize = 64;

/// Half width N of the filter for a tolerance, ticks: jerk limit and tolerance then allow the same speed.
fn half_width(limits: &MotionLimits, tolerance_mm: f64) -> usize {
    let jerk = limits.least().jerk_mm_s3;
    // j·T²/4 = 3·tolerance/T.
    let ticks = (12.0 * tolerance_mm / jerk).cbrt() / limits.tick_s;
    (ticks.round() as usize).clamp(MIN_HALF_WIDTH, MAX_HALF_WIDTH)
}

/// Maximum speed of a filter, mm/s, so that every contour keeps limits and tolerance.
fn max_speed(limits: &MotionLimits, half_width: usize, tolerance_mm: f64) -> f64 {
    let seconds = half_width as f64 * limits.tick_s;
    let of_axis = |l: &super::AxisLimits| {
        l.velocity_mm_s.min(l.acceleration_mm_s2 * seconds / 2.0).min(l.jerk_mm_s3 * seconds * seconds / 4.0)
    };
    let of_axes = limits.axes.iter().map(|(_, l)| of_axis(l)).fold(f64::INFINITY, f64::min);
    of_axes.min(3.0 * tolerance_mm / seconds)
}

/// Whether a feed is slow: a filter passes every corner at this feed within the tolerance.
#[must_use]
pub fn is_slow(limits: &MotionLimits, speed: MotionSpeed, tolerance_mm: f64) -> bool {
    match speed {
        MotionSpeed::Rapid => false,
        MotionSpeed::Feed { mm_s } => {
            mm_s.max(MIN_FEED_MM_S) <= max_speed(limits, half_width(limits, tolerance_mm), tolerance_mm)
        }
    }
}

/// The next set-point of a run.
#[derive(Clone, Copy, Debug)]
pub struct SlowSetpoint {
    /// Position, mm.
    pub position: [f64; 3],
    /// Number of moves that the interpolated point has finished in this tick.
    pub finished_moves: usize,
    /// The set-points have come to rest.
    pub is_at_rest: bool,
}

/// A run of slow moves.
#[derive(Clone, Debug)]
pub struct SlowRun {
    /// Whether a run is active, also while it rests in the middle of a move.
    active: bool,
    /// Half width of the filter, ticks.
    half_width: usize,
    /// The last interpolated points; `newest` is the index of the newest one.
    points: Vec<[f64; 3]>,
    newest: usize,
    /// Distance of the interpolated point along its move, mm.
    along: f64,
    /// Ticks for which the interpolated point has stood still.
    still_ticks: usize,
}

impl SlowRun {
    /// No run, with capacity for the widest filter.
    pub fn new() -> Self {
        let points = Vec::with_capacity(2 * MAX_HALF_WIDTH - 1);
        Self { active: false, half_width: MIN_HALF_WIDTH, points, newest: 0, along: 0.0, still_ticks: 0 }
    }

    /// Whether a run is active.
    pub const fn is_active(&self) -> bool {
        self.active
    }

    /// Ticks by which the set-points follow the interpolated point.
    pub const fn delay_ticks(&self) -> u64 {
        self.half_width as u64 - 1
    }

    /// Ticks that the buffer is filled ahead of the axes: a stop from a slow feed takes about N ticks. More would keep
    /// moves in the queue that the interpolated point has passed, so that short moves run out.
    pub const fn ahead_ticks(&self) -> u64 {
        2 * self.half_width as u64 + SPARE_TICKS
    }

    /// Work units of a set-point.
    pub const fn work(&self) -> usize {
        self.half_width * COST_POINT
    }

    /// Ends the run.
    pub const fn clear(&mut self) {
        self.active = false;
    }

    /// Starts a run at rest at the start of a move.
    pub fn begin(&mut self, first: &QueuedMove, limits: &MotionLimits) {
        self.half_width = half_width(limits, first.tolerance_mm);
        self.points.clear();
        self.points.resize(2 * self.half_width - 1, first.segment.at(0.0));
        (self.active, self.newest, self.along, self.still_ticks) = (true, 0, 0.0, 0);
    }

    /// The set-point of the next tick. The interpolated point is on the move at queue index `place`; it stands at a feed
    /// override of 0, and at the end of the last known move.
    pub fn next_setpoint(
        &mut self,
        moves: &MoveQueue,
        place: usize,
        limits: &MotionLimits,
        feed_override: f64,
    ) -> Option<SlowSetpoint> {
        let (mut at, mut left_s) = (place, limits.tick_s);
        for _ in 0..if feed_override > 0.0 { MAX_ENDS_PER_TICK } else { 0 } {
            let queued = moves.get(at)?;
            let speed = self.speed(queued, limits, feed_override);
            let needed_s = (queued.segment.length() - self.along) / speed;
            if needed_s > left_s {
                self.along += speed * left_s;
                break;
            }
            self.along = queued.segment.length();
            left_s -= needed_s;
            let Some(next) = self.next_move(moves, at, limits) else { break };
            (at, self.along) = (next, 0.0);
        }
        let queued = moves.get(at)?;
        let point = queued.segment.at(self.along);
        let stands = self.points[self.newest].iter().zip(point).all(|(old, new)| (old - new).abs() <= 0.0);
        self.still_ticks = if stands { self.still_ticks + 1 } else { 0 };
        self.newest = (self.newest + 1) % self.points.len();
        self.points[self.newest] = point;
        let is_at_rest = self.still_ticks + 1 >= self.points.len();
        let is_over = is_at_rest && self.along >= queued.segment.length();
        if is_over {
            self.active = false;
        }
        let finished_moves = at - place + usize::from(is_over);
        Some(SlowSetpoint { position: self.mean(), finished_moves, is_at_rest })
    }

    /// The speed on a move, mm/s.
    fn speed(&self, queued: &QueuedMove, limits: &MotionLimits, feed_override: f64) -> f64 {
        let MotionSpeed::Feed { mm_s } = queued.programmed.speed else { return MIN_FEED_MM_S };
        (mm_s.max(MIN_FEED_MM_S) * feed_override).min(max_speed(limits, self.half_width, queued.tolerance_mm))
    }

    /// The move that the run continues with after the one at `place`, if it is known and slow enough for this filter.
    fn next_move(&self, moves: &MoveQueue, place: usize, limits: &MotionLimits) -> Option<usize> {
        let Continuation::ContinuesAt(next) = continuation(moves, place) else { return None };
        let queued = moves.get(next)?;
        let MotionSpeed::Feed { mm_s } = queued.programmed.speed else { return None };
        let fits = mm_s.max(MIN_FEED_MM_S) <= max_speed(limits, self.half_width, queued.tolerance_mm);
        fits.then_some(next)
    }

    /// The weighted mean of the points; exact where they are equal.
    fn mean(&self) -> [f64; 3] {
        let (count, half) = (self.points.len(), self.half_width);
        let middle = self.points[(self.newest + count + 1 - half) % count];
        let mut sum = [0.0; 3];
        for age in 0..count {
            let weight = (age + 1).min(count - age) as f64;
            let point = &self.points[(self.newest + count - age) % count];
            for ((sum, point), middle) in sum.iter_mut().zip(point).zip(middle) {
                *sum += weight * (point - middle);
            }
        }
        let all = (half * half) as f64;
        per_coordinate(|x| middle[x] + sum[x] / all)
    }
}
