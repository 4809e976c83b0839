//! Feed scaling: the rate at which the buffer is followed, from 0 (held) to 1 (as planned).
//!
//! Holds the rate and its slope and searches for a change of rate that keeps every limit. Knows nothing of moves. A
//! change of rate adds to the acceleration and jerk of the buffer. Whether the sum is within the limits depends on the
//! buffer ahead, so a candidate is simulated tick by tick to its end and the differences of its set-points are checked.
//! Only a valid candidate is started, so the change in progress is always verified.

use super::MotionLimits;
use super::setpoint_buffer::{BufferPosition, SetpointBuffer};
use crate::units::{Axis, WorkBudget};

/// Rate changes tried, as fractions of the fastest possible on a straight line; the first valid one is used.
const RATE_CHANGE_FRACTIONS: [f64; 11] = [0.98, 0.8, 0.65, 0.5, 0.38, 0.28, 0.2, 0.12, 0.07, 0.035, 0.015];
/// The target itself, then the fractions of it that are tried if it cannot be reached.
const TARGET_FRACTIONS: [f64; 3] = [1.0, 0.97, 0.85];
/// Work units of a simulated tick.
const STEP_WORK: usize = 40;
/// Work units per tick after which no further candidate is tried.
const TRY_WORK: usize = 1_200 * STEP_WORK;
/// Maximum work units per tick: those, and the last candidate to its end.
pub const MAX_FEED_SCALING_WORK: usize = TRY_WORK + MAX_CANDIDATE_TICKS * STEP_WORK;
/// Maximum simulated length of a candidate, ticks.
const MAX_CANDIDATE_TICKS: usize = 4_096;
/// Number of set-points ahead whose speed sets the scale of the candidates.
const SCALE_SETPOINTS: u64 = 96;
/// Ticks after the end of a change in which its last difference still shows.
const TAIL_TICKS: usize = 4;
/// Rounding of positions near 1 m, differenced three times at 1 ms, is 1e-3 mm/s³: 1e-6 of the smallest useful jerk
/// limit. The planner keeps a larger margin than this to every limit.
pub const ROUNDING_MARGIN: f64 = 1e-6;

/// Maximum first, second and third difference of set-points per axis, mm.
#[derive(Clone, Copy, Debug)]
pub struct DifferenceLimits {
    /// Velocity times a tick.
    pub first: [f64; 3],
    /// Acceleration times a tick squared.
    pub second: [f64; 3],
    /// Jerk times a tick cubed.
    pub third: [f64; 3],
}

/// The last four set-points, the newest last.
pub type SetpointHistory = [[f64; 3]; 4];

impl DifferenceLimits {
    /// The limits for one tick.
    #[must_use]
    pub fn from_limits(limits: &MotionLimits) -> Self {
        let dt = limits.tick_s;
        Self {
            first: Axis::ALL.map(|axis| limits.axes[axis].velocity_mm_s * dt),
            second: Axis::ALL.map(|axis| limits.axes[axis].acceleration_mm_s2 * dt * dt),
            third: Axis::ALL.map(|axis| limits.axes[axis].jerk_mm_s3 * dt * dt * dt),
        }
    }

    /// Highest ratio of a difference of the newest set-point to its limit; up to 1 all limits are kept.
    #[must_use]
    pub fn worst_ratio(&self, p: &SetpointHistory) -> f64 {
        (0..3).fold(0.0, |worst, x| {
            let (d1, d2, d3) = (p[3][x] - p[2][x], p[2][x] - p[1][x], p[1][x] - p[0][x]);
            let third = (d1 - 2.0 * d2 + d3).abs() / self.third[x];
            f64::max(worst, d1.abs() / self.first[x]).max((d1 - d2).abs() / self.second[x]).max(third)
        })
    }

    /// Whether the newest set-point of a history keeps all limits.
    #[must_use]
    pub fn allows(&self, p: &SetpointHistory) -> bool {
        (0..3).all(|x| {
            let (d1, d2, d3) = (p[3][x] - p[2][x], p[2][x] - p[1][x], p[1][x] - p[0][x]);
            let (second, before) = (d1 - d2, d2 - d3);
            let most = 1.0 + ROUNDING_MARGIN;
            d1.abs() <= self.first[x] * most
                && second.abs() <= self.second[x] * most
                && (second - before).abs() <= self.third[x] * most
        })
    }
}

/// A segment of a change of rate: duration in ticks; `bend` is the second derivative of the rate, per tick².
#[derive(Clone, Copy, Debug, Default)]
struct RateSegment {
    ticks: f64,
    bend: f64,
}

/// What a change of rate is checked against.
pub struct SetpointsAhead<'a> {
    /// The set-points.
    pub buffer: &'a SetpointBuffer,
    /// Where the buffer is followed now.
    pub spot: BufferPosition,
    /// The last set-points.
    pub past: &'a SetpointHistory,
    /// The limits of every set-point.
    pub limits: &'a DifferenceLimits,
}

/// The rate at which the buffer is followed.
#[derive(Clone, Copy, Debug)]
pub struct FeedScaling {
    rate: f64,
    slope: f64,
    segments: [RateSegment; 3],
    target: f64,
    /// The candidate to try first in the next tick.
    next_try: usize,
}

impl FeedScaling {
    /// A constant rate.
    #[must_use]
    pub const fn steady(rate: f64) -> Self {
        Self { rate, slope: 0.0, segments: [RateSegment { ticks: 0.0, bend: 0.0 }; 3], target: rate, next_try: 0 }
    }

    /// The present rate.
    #[must_use]
    pub const fn rate(&self) -> f64 {
        self.rate
    }

    /// The rate at the end of the change in progress.
    #[must_use]
    pub const fn target(&self) -> f64 {
        self.target
    }

    /// Whether no change is in progress.
    #[must_use]
    pub fn is_steady(&self) -> bool {
        self.segments.iter().all(|leg| leg.ticks <= 0.0)
    }

    /// Whether the rate is constantly zero.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.is_steady() && self.rate <= 0.0
    }

    /// Advances by one tick; returns the distance along the buffer in ticks.
    pub fn advance(&mut self) -> f64 {
        let (mut left, mut way) = (1.0, 0.0);
        for leg in &mut self.segments {
            let t = leg.ticks.min(left);
            if t > 0.0 {
                way += t * (self.rate + t * (self.slope / 2.0 + t * leg.bend / 6.0));
                self.rate += t * (self.slope + t * leg.bend / 2.0);
                self.slope += t * leg.bend;
                leg.ticks -= t;
                left -= t;
            }
        }
        if self.is_steady() {
            (self.rate, self.slope) = (self.target, 0.0);
            way += left * self.target;
        }
        way.max(0.0)
    }

    /// Starts the fastest change to `target` (0 to 1) that keeps every limit on the set-points ahead. If no candidate is
    /// valid in this tick, the rate continues as before; call again in the next tick.
    ///
    /// Where the buffer is at a limit throughout, the full rate cannot be reached without exceeding it slightly. Then a
    /// slightly lower rate ([`TARGET_FRACTIONS`]) is used on the way up.
    pub fn change_to(&mut self, target: f64, ahead: &SetpointsAhead<'_>, budget: &mut WorkBudget) {
        let mut share = budget.share(TRY_WORK);
        self.try_changes(target, ahead, &mut share);
        budget.spend(share.spent());
    }

    /// Tries candidates until one is valid or the budget is spent.
    fn try_changes(&mut self, target: f64, ahead: &SetpointsAhead<'_>, budget: &mut WorkBudget) {
        let (slope, bend) = scales(ahead);
        for _ in 0..RATE_CHANGE_FRACTIONS.len() * TARGET_FRACTIONS.len() {
            let near = target * TARGET_FRACTIONS[self.next_try / RATE_CHANGE_FRACTIONS.len()];
            let part = RATE_CHANGE_FRACTIONS[self.next_try % RATE_CHANGE_FRACTIONS.len()];
            self.next_try = (self.next_try + 1) % (RATE_CHANGE_FRACTIONS.len() * TARGET_FRACTIONS.len());
            let closer = (near - target).abs() <= 0.0 || (near > self.rate && near > self.target);
            if closer {
                let candidate = self.candidate_to(near, part * slope, part * bend);
                if candidate.keeps_limits(ahead, budget) {
                    *self = Self { next_try: 0, ..candidate };
                    return;
                }
                if budget.is_spent() {
                    return;
                }
            }
        }
    }

    /// The fastest change of rate with bounded slope and bend.
    fn candidate_to(&self, target: f64, slope_most: f64, bend: f64) -> Self {
        let settled = self.rate + self.slope * self.slope.abs() / (2.0 * bend);
        let way = if target >= settled { 1.0 } else { -1.0 };
        let (rise, first) = (way * (target - self.rate), way * self.slope);
        let peak = (bend * rise + first * first / 2.0).max(0.0).sqrt();
        let top = slope_most.max(first);
        let legs = if peak <= top {
            [(peak - first).max(0.0) / bend, 0.0, peak / bend]
        } else {
            let gained = (2.0 * top * top - first * first) / (2.0 * bend);
            [(top - first) / bend, (rise - gained).max(0.0) / top, top / bend]
        };
        let bends = [way * bend, 0.0, -way * bend];
        let legs = [0, 1, 2].map(|k| RateSegment { ticks: legs[k], bend: bends[k] });
        Self { segments: legs, target, ..*self }
    }

    fn keeps_limits(mut self, ahead: &SetpointsAhead<'_>, budget: &mut WorkBudget) -> bool {
        let &SetpointsAhead { buffer, mut spot, past, limits } = ahead;
        let mut seen = *past;
        let mut tail = 0;
        for _ in 0..MAX_CANDIDATE_TICKS {
            budget.spend(STEP_WORK);
            spot = spot.later(self.advance());
            // A rate below zero or above one is invalid, and set-points not appended yet cannot be checked.
            let unknown = buffer.is_open() && spot.tick + 3 > buffer.end();
            if self.rate < -1e-12 || self.rate > 1.0 + 1e-12 || unknown {
                return false;
            }
            seen = [seen[1], seen[2], seen[3], buffer.sample(spot).position];
            if !limits.allows(&seen) {
                return false;
            }
            tail += usize::from(self.is_steady());
            if tail > TAIL_TICKS {
                return true;
            }
        }
        false
    }
}

/// Maximum slope and bend of the rate by acceleration and jerk limits at the highest speed ahead.
fn scales(&SetpointsAhead { buffer, spot, limits, .. }: &SetpointsAhead<'_>) -> (f64, f64) {
    let mut speed = [1e-9; 3];
    let mut last = buffer.setpoint(spot.tick.saturating_sub(1)).position;
    for number in 0..SCALE_SETPOINTS {
        let at = buffer.setpoint(spot.tick + number).position;
        for axis in 0..3 {
            speed[axis] = (at[axis] - last[axis]).abs().max(speed[axis]);
        }
        last = at;
    }
    let least = |of: &[f64; 3]| (0..3).map(|x| of[x] / speed[x]).fold(f64::INFINITY, f64::min);
    // A change within about one tick is the fastest that has an effect.
    (least(&limits.second).min(1.0), least(&limits.third).min(1.0))
}
