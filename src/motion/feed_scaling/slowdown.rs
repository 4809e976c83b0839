//! A slowdown along set-points that leave little room: the bend of the rate is chosen tick by tick.
//!
//! On a path at its limits no change of rate of a fixed shape is valid: in one tick the jerk of the path leaves nothing, a
//! few ticks later much. The chain rule tells what is left: with the derivatives q', q'', q''' of the set-points by their
//! index, the rate r and its derivatives r' (slope) and r'' (bend), velocity is q' r, acceleration q'' r² + q' r', and jerk
//! q''' r³ + 3 q'' r r' + q' r''. So each axis bounds the bend by its jerk and its acceleration. The search takes the
//! lowest bend within the bounds, until the rest of the way is needed to arrive at the target without slope. Where
//! the bounds leave nothing, for example in a corner, the slope before was too steep: the search goes back and comes there
//! with less. Every step is also checked as the set-points are: by their differences.

use super::{RateSegment, SetpointsAhead, TAIL_TICKS, is_before};
use crate::motion::setpoint_buffer::{BufferPosition, LocalCurve};
use crate::units::WorkBudget;

/// Maximum length of a slowdown, ticks.
pub const MAX_SLOWDOWN_TICKS: usize = 1_024;
/// Work units of a tick of the search.
const STEP_WORK: usize = 150;
/// Share of the bend ahead that the arrival at the target is planned with: the speed ahead varies.
const ARRIVAL_SHARE: f64 = 0.92;
/// Share of the limits that the bounds are taken from: they hold at the ends of a tick, not between them.
const BOUND_SHARE: f64 = 0.995;
/// Maximum number of limits of the slope, and of times that the search goes back.
const MAX_SLOPE_LIMITS: usize = 6;
const MAX_RETURNS: usize = 16;
/// First length of a limit of the slope, and its part behind the place where the bounds leave nothing, set-points.
const FIRST_LENGTH: u64 = 8;
const LENGTH_BEHIND: u64 = 4;

/// Bounds of the bend.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: f64,
    high: f64,
}

impl Bounds {
    /// A change within about one tick is the fastest that has an effect.
    const NONE: Self = Self { low: -1.0, high: 1.0 };

    /// Where `offset + factor · bend` stays within ± `limit`.
    fn keep(&mut self, offset: f64, factor: f64, limit: f64) {
        let inverse = factor.recip();
        if inverse.is_finite() {
            let (middle, half) = (-offset * inverse, limit * inverse.abs());
            self.low = self.low.max(middle - half);
            self.high = self.high.min(middle + half);
        }
    }
}

/// The rate and its slope, per tick.
#[derive(Clone, Copy, Debug)]
pub struct RateState {
    /// The rate.
    pub rate: f64,
    /// Its slope.
    pub slope: f64,
}

impl RateState {
    /// Goes on for `ticks` with a constant bend; returns the distance along the buffer in ticks.
    pub fn advance(&mut self, ticks: f64, bend: f64) -> f64 {
        let way = ticks * (self.rate + ticks * (self.slope / 2.0 + ticks * bend / 6.0));
        self.rate += ticks * (self.slope + ticks * bend / 2.0);
        self.slope += ticks * bend;
        way
    }
}

/// What is searched for.
#[derive(Clone, Copy, Debug)]
pub struct SlowdownRequest {
    /// The rate at the end, below the present one.
    pub target: f64,
    /// Share of the bounds used for braking.
    pub share: f64,
    /// Factor on the slope before a place each time that the bounds leave nothing there.
    pub slope_factor: f64,
    /// The bend that the speed ahead allows on a straight line, per tick².
    pub bend: f64,
    /// Where it must have ended on the buffer.
    pub before: Option<BufferPosition>,
}

/// A tick of a slowdown: its bend, and the state and the place on the buffer after it.
#[derive(Clone, Copy, Debug)]
pub struct SlowdownStep {
    /// The bend, and for how much of the tick it lasts: the last step may be shorter.
    pub segment: RateSegment,
    state: RateState,
    spot: BufferPosition,
    curve: LocalCurve,
}

/// A part of the buffer in which the slope is limited, so that the bounds leave a bend at its end.
#[derive(Clone, Copy, Debug, Default)]
struct SlopeLimit {
    /// First and last set-point.
    from: u64,
    to: u64,
    /// The least slope there.
    least: f64,
    /// Its length in set-points.
    length: u64,
}

/// The limits of the slope, in the order in which the search has found them.
#[derive(Debug, Default)]
struct SlopeLimits {
    limits: [SlopeLimit; MAX_SLOPE_LIMITS],
    count: usize,
}

impl SlopeLimits {
    /// The least slope at a place.
    fn least(&self, tick: u64) -> f64 {
        let here = self.limits[..self.count].iter().filter(|limit| (limit.from..=limit.to).contains(&tick));
        here.map(|limit| limit.least).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The bounds leave nothing at a place with the slope there: limits the slope before it, or limits it more and from
    /// farther before. Returns how many steps stand, or none if there are too many limits.
    fn limit_before(&mut self, from: &SlowdownStep, steps: &[SlowdownStep], factor: f64) -> Option<usize> {
        let tick = from.spot.tick;
        let last = self.limits[..self.count].last();
        if last.is_none_or(|limit| !(limit.from..=limit.to).contains(&tick)) {
            let least = from.state.slope.min(0.0);
            *self.limits.get_mut(self.count)? = SlopeLimit { least, length: FIRST_LENGTH / 2, ..SlopeLimit::default() };
            self.count += 1;
        }
        let limit = &mut self.limits[self.count - 1];
        limit.least *= factor;
        limit.length *= 2;
        limit.to = limit.to.max(tick + LENGTH_BEHIND);
        let stand = steps.iter().take_while(|step| step.spot.tick + limit.length < limit.to).count();
        limit.from = steps[..stand].last().map_or(0, |step| step.spot.tick);
        Some(stand)
    }
}

/// Searches for a slowdown, one step for each tick; returns where it ends on the buffer, or none if none was found that
/// keeps the limits on the known set-points within the budget.
pub fn find(
    steps: &mut Vec<SlowdownStep>,
    start: RateState,
    request: SlowdownRequest,
    ahead: &SetpointsAhead<'_>,
    budget: &mut WorkBudget,
) -> Option<BufferPosition> {
    let begun = RateSegment { ticks: 0.0, bend: 0.0 };
    let first =
        SlowdownStep { segment: begun, state: start, spot: ahead.spot, curve: ahead.buffer.local_curve(ahead.spot) };
    let mut slope_limits = SlopeLimits::default();
    let mut returns = 0;
    steps.clear();
    while steps.len() < MAX_SLOWDOWN_TICKS && !budget.is_spent() {
        budget.spend(STEP_WORK);
        let from = steps.last().copied().unwrap_or(first);
        let step = next_step(&from, slope_limits.least(from.spot.tick), request, ahead);
        if !ahead.is_known(step.spot) || !is_before(step.spot, request.before) {
            return None;
        }
        if is_valid(&step, steps, request, ahead) {
            let is_last = step.segment.ticks < 1.0;
            steps.push(step);
            if is_last {
                budget.spend(TAIL_TICKS * STEP_WORK);
                return ends_within_limits(&step, steps, request, ahead).then_some(step.spot);
            }
        } else {
            returns += 1;
            if returns > MAX_RETURNS {
                return None;
            }
            let stand = slope_limits.limit_before(&from, steps, request.slope_factor)?;
            steps.truncate(stand);
        }
    }
    None
}

/// The next step: as much braking as the bounds and the least slope leave, then the arrival at the target.
fn next_step(
    from: &SlowdownStep,
    least_slope: f64,
    request: SlowdownRequest,
    ahead: &SetpointsAhead<'_>,
) -> SlowdownStep {
    let &SlowdownStep { state, spot, ref curve, .. } = from;
    let RateState { rate, slope } = state;
    let gap = rate - request.target;
    let bounds = bend_bounds(state, spot.fraction, curve, ahead);
    // With a constant bend, a slope s ends at the target after 2 · gap / -s ticks.
    let arrival = if slope < 0.0 { slope * slope / (2.0 * gap) } else { 0.0 };
    let (ticks, bend) = if slope < 0.0 && 2.0 * gap <= -slope {
        (-2.0 * gap / slope, arrival)
    } else if arrival >= ARRIVAL_SHARE * request.bend {
        (1.0, arrival.max(bounds.low))
    } else {
        let least = if bounds.low < 0.0 { request.share * bounds.low } else { bounds.low };
        (1.0, least.max(least_slope - slope).min(bounds.high))
    };
    let mut after = state;
    let way = after.advance(ticks, bend) + (1.0 - ticks) * request.target;
    if ticks < 1.0 {
        // Exactly, whatever is lost by rounding.
        after = RateState { rate: request.target, slope: 0.0 };
    }
    let spot = spot.later(way.max(0.0));
    let segment = RateSegment { ticks, bend };
    SlowdownStep { segment, state: after, spot, curve: ahead.buffer.local_curve(spot) }
}

/// The bounds of the bend in the next tick, by the jerk at its start and the acceleration at its end.
fn bend_bounds(state: RateState, fraction: f64, curve: &LocalCurve, ahead: &SetpointsAhead<'_>) -> Bounds {
    let RateState { rate, slope } = state;
    let mut bounds = Bounds::NONE;
    let (way, later, cube) = (rate + slope / 2.0, rate + slope, rate * rate * rate);
    let crosses = fraction + way >= 1.0;
    for x in 0..3 {
        let &LocalCurve { first, second, third, .. } = curve;
        let (jerk, turning) = (ahead.limits.third[x] * BOUND_SHARE, 3.0 * second[x] * rate * slope);
        bounds.keep(third[0][x] * cube + turning, first[x], jerk);
        if crosses {
            bounds.keep(third[1][x] * cube + turning, first[x], jerk);
        }
        let middle = second[x] + way / 2.0 * third[0][x];
        let second = second[x] + way.min(1.0 - fraction) * third[0][x] + (way + fraction - 1.0).max(0.0) * third[1][x];
        let first = first[x] + way * middle;
        bounds.keep(second * later * later + first * slope, first, ahead.limits.second[x] * BOUND_SHARE);
    }
    bounds
}

/// Whether the limits are kept behind the last step, where the rate is constant, as long as its differences show.
fn ends_within_limits(
    last: &SlowdownStep,
    steps: &mut Vec<SlowdownStep>,
    request: SlowdownRequest,
    ahead: &SetpointsAhead<'_>,
) -> bool {
    let count = steps.len();
    let state = RateState { rate: request.target, slope: 0.0 };
    let mut spot = last.spot;
    let is_kept = (0..TAIL_TICKS).all(|_| {
        spot = spot.later(request.target);
        let step = SlowdownStep { state, spot, curve: ahead.buffer.local_curve(spot), ..*last };
        let is_kept = is_valid(&step, steps, request, ahead);
        steps.push(step);
        is_kept
    });
    steps.truncate(count);
    is_kept
}

/// Whether a step behind others keeps the limits on known set-points.
fn is_valid(
    step: &SlowdownStep,
    before: &[SlowdownStep],
    request: SlowdownRequest,
    ahead: &SetpointsAhead<'_>,
) -> bool {
    let position = |back: usize| match before.len().checked_sub(back) {
        Some(at) => before[at].curve.position,
        None => ahead.past[4 + before.len() - back],
    };
    let seen = [position(3), position(2), position(1), step.curve.position];
    ahead.is_known(step.spot) && (request.target..=1.0).contains(&step.state.rate) && ahead.limits.allows(&seen)
}

#[cfg(test)]
mod tests;
