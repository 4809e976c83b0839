//! Feed scaling: the rate at which the buffer is followed, from 0 (held) to 1 (as planned).
//!
//! Holds the rate and its slope and searches for a change of rate that keeps every limit. Knows nothing of moves. A
//! change of rate adds to the acceleration and jerk of the buffer. Whether the sum is within the limits depends on the
//! buffer ahead, so a candidate is simulated tick by tick to its end and the differences of its set-points are checked.
//! Only a valid candidate is started, so the change in progress is always verified. A candidate has a fixed shape, or it is a
//! [`slowdown`] fitted to the path ahead; while a slowdown is in progress, shorter ones are looked for.

mod slowdown;

use super::MotionLimits;
use super::setpoint_buffer::{BufferPosition, SetpointBuffer};
use crate::units::{Axis, WorkBudget};
use slowdown::{MAX_SLOWDOWN_TICKS, RateState, SlowdownRequest, SlowdownStep};

/// Rate changes tried, as fractions of the fastest possible on a straight line; the first valid one is used.
const RATE_CHANGE_FRACTIONS: [f64; 11] = [0.98, 0.8, 0.65, 0.5, 0.38, 0.28, 0.2, 0.12, 0.07, 0.035, 0.015];
/// Slowdowns tried; the shortest valid one is used. First what is the shortest most often; more braking is shorter where it
/// is possible at all, and some paths need a much smaller slope in their corners, some a little smaller one. The last three are for slowdowns too long to be
/// fitted within the work of a tick; the last is valid nearly everywhere.
const SLOWDOWN_CANDIDATES: [SlowdownCandidate; 11] = [
    SlowdownCandidate::Shaped { fraction: 0.98 },
    SlowdownCandidate::Fitted { share: 1.0, slope_factor: 0.75 },
    SlowdownCandidate::Fitted { share: 0.7, slope_factor: 0.75 },
    SlowdownCandidate::Fitted { share: 0.85, slope_factor: 0.85 },
    SlowdownCandidate::Fitted { share: 1.0, slope_factor: 0.5 },
    SlowdownCandidate::Fitted { share: 0.5, slope_factor: 0.75 },
    SlowdownCandidate::Fitted { share: 1.0, slope_factor: 0.9 },
    SlowdownCandidate::Fitted { share: 0.3, slope_factor: 0.6 },
    SlowdownCandidate::Shaped { fraction: 0.6 },
    SlowdownCandidate::Shaped { fraction: 0.3 },
    SlowdownCandidate::Shaped { fraction: 0.05 },
];
/// The target itself, then the fractions of it that are tried if it cannot be reached.
const TARGET_FRACTIONS: [f64; 3] = [1.0, 0.97, 0.85];
/// Work units of a simulated tick.
const STEP_WORK: usize = 40;
/// Work units per tick after which no further candidate is tried.
const TRY_WORK: usize = 48_000;
/// Work units per tick to shorten a slowdown in progress: about one search of 200 ticks.
const SHORTEN_WORK: usize = 30_000;
/// Maximum work units per tick: those, and the last candidate to its end.
pub const MAX_FEED_SCALING_WORK: usize = TRY_WORK + MAX_CANDIDATE_TICKS * STEP_WORK;
/// Maximum simulated length of a candidate, ticks.
const MAX_CANDIDATE_TICKS: usize = 4_096;
/// Number of set-points ahead whose speed sets the scale of the candidates.
const SCALE_SETPOINTS: u64 = 96;
/// Work units of their scale.
const SCALE_WORK: usize = 400;
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

impl SetpointsAhead<'_> {
    /// Whether the set-points that shape the curve at a place have been appended.
    fn is_known(&self, spot: BufferPosition) -> bool {
        !self.buffer.is_open() || spot.tick + 3 <= self.buffer.end()
    }
}

/// A change of rate of a fixed shape: from a state to a target in three segments.
#[derive(Clone, Copy, Debug)]
struct ShapedChange {
    state: RateState,
    segments: [RateSegment; 3],
    target: f64,
}

/// Advances by one tick along the segments of a change to `target`; returns the distance along the buffer in ticks.
fn advance(state: &mut RateState, segments: &mut [RateSegment], target: f64) -> f64 {
    let (mut left, mut way) = (1.0, 0.0);
    for leg in segments.iter_mut() {
        let t = leg.ticks.min(left);
        if t > 0.0 {
            way += state.advance(t, leg.bend);
            leg.ticks -= t;
            left -= t;
        }
        if left <= 0.0 {
            break;
        }
    }
    if is_over(segments) {
        *state = RateState { rate: target, slope: 0.0 };
        way += left * target;
    }
    way.max(0.0)
}

/// Whether nothing is left of a change of rate.
fn is_over(segments: &[RateSegment]) -> bool {
    segments.iter().all(|leg| leg.ticks <= 0.0)
}

/// The rate at which the buffer is followed.
#[derive(Clone, Debug)]
pub struct FeedScaling {
    state: RateState,
    target: f64,
    /// The change in progress: its segments, and the first that is left.
    segments: Vec<RateSegment>,
    first: usize,
    /// The slowdown that was tried last.
    trial: Vec<SlowdownStep>,
    /// The candidate to try first in the next tick.
    next_try: usize,
    /// The rate that was requested last.
    requested: f64,
    /// Where the slowdown in progress ends on the buffer.
    slowdown_end: Option<BufferPosition>,
}

/// A slowdown that is tried.
#[derive(Clone, Copy, Debug)]
enum SlowdownCandidate {
    /// Of a fixed shape, this fraction of the fastest possible on a straight line.
    Shaped { fraction: f64 },
    /// Fitted to the path, with this share of the braking that it leaves, and this factor on the slope ([`SlowdownRequest`]).
    Fitted { share: f64, slope_factor: f64 },
}

impl FeedScaling {
    /// A constant rate.
    #[must_use]
    pub fn steady(rate: f64) -> Self {
        Self {
            state: RateState { rate, slope: 0.0 },
            target: rate,
            segments: Vec::with_capacity(MAX_SLOWDOWN_TICKS),
            first: 0,
            trial: Vec::with_capacity(MAX_SLOWDOWN_TICKS + TAIL_TICKS),
            next_try: 0,
            requested: rate,
            slowdown_end: None,
        }
    }

    /// Sets a constant rate at once; only at rest.
    pub fn set_steady(&mut self, rate: f64) {
        (self.state, self.target) = (RateState { rate, slope: 0.0 }, rate);
        self.segments.clear();
        (self.first, self.next_try, self.slowdown_end) = (0, 0, None);
        self.requested = rate;
    }

    /// The present rate.
    #[must_use]
    pub const fn rate(&self) -> f64 {
        self.state.rate
    }

    /// The rate at the end of the change in progress.
    #[must_use]
    pub const fn target(&self) -> f64 {
        self.target
    }

    /// Whether no change is in progress.
    #[must_use]
    pub fn is_steady(&self) -> bool {
        self.first >= self.segments.len()
    }

    /// Whether the rate is constantly zero.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.is_steady() && self.state.rate <= 0.0
    }

    /// Advances by one tick; returns the distance along the buffer in ticks.
    pub fn advance(&mut self) -> f64 {
        let way = advance(&mut self.state, &mut self.segments[self.first..], self.target);
        while self.segments.get(self.first).is_some_and(|leg| leg.ticks <= 0.0) {
            self.first += 1;
        }
        way
    }

    /// Starts the fastest change to `target` (0 to 1) that keeps every limit on the set-points ahead. If no candidate is
    /// valid in this tick, the rate continues as before; call again in the next tick.
    pub fn change_to(&mut self, target: f64, ahead: &SetpointsAhead<'_>, budget: &mut WorkBudget) {
        if (target - self.requested).abs() > 0.0 {
            (self.requested, self.next_try) = (target, 0);
        }
        let mut share = budget.share(TRY_WORK);
        if target < self.state.rate {
            self.slow_down(target, None, ahead, &mut share);
        } else {
            self.speed_up(target, ahead, &mut share);
        }
        budget.spend(share.spent());
    }

    /// Looks for a shorter slowdown than the one in progress.
    pub fn shorten(&mut self, ahead: &SetpointsAhead<'_>, budget: &mut WorkBudget) {
        if self.slowdown_end.is_some() && !self.is_steady() {
            let mut share = budget.share(SHORTEN_WORK);
            self.slow_down(self.target, self.slowdown_end, ahead, &mut share);
            budget.spend(share.spent());
        }
    }

    /// Starts the shortest slowdown found within the budget that ends before a place on the buffer.
    fn slow_down(
        &mut self,
        target: f64,
        mut before: Option<BufferPosition>,
        ahead: &SetpointsAhead<'_>,
        budget: &mut WorkBudget,
    ) {
        for _ in 0..SLOWDOWN_CANDIDATES.len() {
            if budget.is_spent() {
                return;
            }
            let (slope, bend) = scales(ahead, before);
            budget.spend(SCALE_WORK);
            let candidate = SLOWDOWN_CANDIDATES[self.next_try % SLOWDOWN_CANDIDATES.len()];
            self.next_try += 1;
            let found = match candidate {
                SlowdownCandidate::Shaped { fraction } => {
                    let change = ShapedChange::new(self.state, target, fraction * slope, fraction * bend);
                    let end = change.end(before, ahead, budget);
                    end.inspect(|_| self.begin(target, change.segments.into_iter()))
                }
                // A change of fixed shape may swing below the target; from there nothing is slowed down.
                SlowdownCandidate::Fitted { .. } if target >= self.state.rate => None,
                SlowdownCandidate::Fitted { share, slope_factor } => {
                    let request = SlowdownRequest { target, share, slope_factor, bend, before };
                    let mut steps = std::mem::take(&mut self.trial);
                    let end = slowdown::find(&mut steps, self.state, request, ahead, budget);
                    let end = end.inspect(|_| self.begin(target, steps.iter().map(|step| step.segment)));
                    self.trial = steps;
                    end
                }
            };
            if found.is_some() {
                before = found;
                self.slowdown_end = found;
            }
        }
    }

    /// Tries changes upward until one is valid or the budget is spent.
    ///
    /// Where the buffer is at a limit throughout, the full rate cannot be reached without exceeding it slightly. Then a
    /// slightly lower rate ([`TARGET_FRACTIONS`]) is used.
    fn speed_up(&mut self, target: f64, ahead: &SetpointsAhead<'_>, budget: &mut WorkBudget) {
        let (slope, bend) = scales(ahead, None);
        const COUNT: usize = RATE_CHANGE_FRACTIONS.len() * TARGET_FRACTIONS.len();
        for _ in 0..COUNT {
            let number = self.next_try % COUNT;
            let near = target * TARGET_FRACTIONS[number / RATE_CHANGE_FRACTIONS.len()];
            let fraction = RATE_CHANGE_FRACTIONS[number % RATE_CHANGE_FRACTIONS.len()];
            self.next_try = number + 1;
            let closer = (near - target).abs() <= 0.0 || (near > self.state.rate && near > self.target);
            if closer {
                let change = ShapedChange::new(self.state, near, fraction * slope, fraction * bend);
                if change.end(None, ahead, budget).is_some() {
                    self.begin(near, change.segments.into_iter());
                    (self.slowdown_end, self.next_try) = (None, 0);
                    return;
                }
                if budget.is_spent() {
                    return;
                }
            }
        }
    }

    /// Starts a change that has been checked.
    fn begin(&mut self, target: f64, segments: impl Iterator<Item = RateSegment>) {
        self.segments.clear();
        self.segments.extend(segments.filter(|leg| leg.ticks > 0.0));
        (self.first, self.target) = (0, target);
    }
}

/// Whether a place on the buffer is before another.
fn is_before(spot: BufferPosition, other: Option<BufferPosition>) -> bool {
    other.is_none_or(|other| (spot.tick, spot.fraction) < (other.tick, other.fraction))
}

impl ShapedChange {
    /// The fastest change with bounded slope and bend.
    fn new(state: RateState, target: f64, slope_most: f64, bend: f64) -> Self {
        let RateState { rate, slope } = state;
        let settled = rate + slope * slope.abs() / (2.0 * bend);
        let way = if target >= settled { 1.0 } else { -1.0 };
        let (rise, first) = (way * (target - rate), way * slope);
        let peak = (bend * rise + first * first / 2.0).max(0.0).sqrt();
        let top = slope_most.max(first);
        let legs = if peak <= top {
            [(peak - first).max(0.0) / bend, 0.0, peak / bend]
        } else {
            let gained = (2.0 * top * top - first * first) / (2.0 * bend);
            [(top - first) / bend, (rise - gained).max(0.0) / top, top / bend]
        };
        let bends = [way * bend, 0.0, -way * bend];
        let segments = [0, 1, 2].map(|k| RateSegment { ticks: legs[k], bend: bends[k] });
        Self { state, segments, target }
    }

    /// Where it reaches its target on the buffer; none if that is not before a place, or if it leaves the limits or the known
    /// set-points.
    fn end(
        mut self,
        before: Option<BufferPosition>,
        ahead: &SetpointsAhead<'_>,
        budget: &mut WorkBudget,
    ) -> Option<BufferPosition> {
        let &SetpointsAhead { buffer, mut spot, past, limits } = ahead;
        let mut seen = *past;
        let (mut tail, mut end) = (0, None);
        for _ in 0..MAX_CANDIDATE_TICKS {
            budget.spend(STEP_WORK);
            spot = spot.later(advance(&mut self.state, &mut self.segments, self.target));
            // A rate below zero or above one is invalid, and set-points not appended yet cannot be checked.
            if self.state.rate < -1e-12 || self.state.rate > 1.0 + 1e-12 || !ahead.is_known(spot) {
                return None;
            }
            seen = [seen[1], seen[2], seen[3], buffer.sample(spot).position];
            if !limits.allows(&seen) {
                return None;
            }
            if is_over(&self.segments) {
                end = end.or(Some(spot));
                tail += 1;
            }
            if !is_before(end.unwrap_or(spot), before) {
                return None;
            }
            if tail > TAIL_TICKS {
                return end;
            }
        }
        None
    }
}

/// Maximum slope and bend of the rate by acceleration and jerk limits at the highest speed ahead.
fn scales(
    &SetpointsAhead { buffer, spot, limits, .. }: &SetpointsAhead<'_>,
    end: Option<BufferPosition>,
) -> (f64, f64) {
    let count = end.map_or(SCALE_SETPOINTS, |end| (end.tick + 3).saturating_sub(spot.tick).min(SCALE_SETPOINTS));
    let mut speed = [1e-9; 3];
    let mut last = buffer.setpoint(spot.tick.saturating_sub(1)).position;
    for number in 0..count {
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
