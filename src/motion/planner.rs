//! The planner: queued moves to nominal set-points on the trail.
//!
//! Owns which moves are planned and how far ahead the trail is laid. Knows nothing of holds and overrides below 100 %.

use std::collections::VecDeque;

use super::path::Queued;
use super::span::{SHARPEST_COSINE, Span};
use super::stroke::Stroke;
use super::trail::{PLACES, Place, Spot, Trail};
use super::{End, LEAST_FEED_MM_S, Limits, MOVES, Rate};

/// The planner keeps this part of every limit, so that the differences of set-points stay below it despite rounding.
const LIMIT_SHARE: f64 = 0.999_99;
/// Places laid in a tick at most.
const PLACES_PER_TICK: usize = 24;
/// Moves of no length passed in a tick at most.
const EMPTY_PER_TICK: usize = 32;
/// The trail is laid ahead of the axes by this many of the longest braking times.
const BRAKES_AHEAD: f64 = 2.0;
const LEAST_AHEAD: f64 = 96.0;
/// Length, mm, and time, s, of one span at most: its points then lie near enough to each other for a tolerance of 10 µm.
const SPAN_LENGTH_MOST_MM: f64 = 450.0;
const SPAN_SECONDS_MOST: f64 = 10.0;
/// A run that could still go on is begun when no move has come for so many ticks.
const GATHER_TICKS: u32 = 3;
/// Below this tolerance, mm, corners are exact stops: the curve through the set-points needs half a micrometre itself.
const LEAST_TOLERANCE_MM: f64 = 0.001;

/// Plans the moves of a queue.
#[derive(Clone, Debug)]
pub struct Planner {
    limits: Limits,
    ahead: u64,
    /// Moves at the front of the queue that are laid or under way.
    taken: usize,
    stroke: Option<Stroke>,
    span: Span,
    /// Moves of the span that have been laid.
    span_ended: usize,
    /// Moves in a span at most: halved when none was found that keeps everything, doubled when one was.
    run_most: usize,
    planned_override: f64,
    /// Moves in the queue at the last tick, and for how many ticks that has been so.
    seen: usize,
    quiet: u32,
}

impl Planner {
    /// A planner with nothing under way.
    #[must_use]
    pub fn new(limits: &Limits) -> Self {
        let brake =
            |l: &super::AxisLimits| l.velocity_mm_s / l.acceleration_mm_s2 + l.acceleration_mm_s2 / l.jerk_mm_s3;
        let longest = limits.axes.iter().map(|(_, l)| brake(l)).fold(0.0, f64::max) / limits.tick_s;
        let ahead = (longest * BRAKES_AHEAD + LEAST_AHEAD).min(PLACES as f64 / 2.0) as u64;
        let share = limits.axes.map(|l| super::AxisLimits {
            velocity_mm_s: l.velocity_mm_s * LIMIT_SHARE,
            acceleration_mm_s2: l.acceleration_mm_s2 * LIMIT_SHARE,
            jerk_mm_s3: l.jerk_mm_s3 * LIMIT_SHARE,
        });
        let limits = Limits { axes: share, ..*limits };
        Self {
            limits,
            ahead,
            taken: 0,
            stroke: None,
            span: Span::new(&limits, MOVES),
            span_ended: 0,
            run_most: MOVES,
            planned_override: 1.0,
            seen: 0,
            quiet: 0,
        }
    }

    /// Forget what is under way.
    pub fn clear(&mut self) {
        self.taken = 0;
        self.stroke = None;
        self.span.clear();
        self.run_most = MOVES;
    }

    /// The first move of the queue has gone.
    pub const fn forget_first(&mut self) {
        self.taken = self.taken.saturating_sub(1);
    }

    /// Lay some more of the trail. `feed_override` is at least 1.
    pub fn tick(&mut self, moves: &mut VecDeque<Queued>, trail: &mut Trail, spot: Spot, feed_override: f64) {
        self.quiet = if moves.len() == self.seen { self.quiet.saturating_add(1) } else { 0 };
        self.seen = moves.len();
        for _ in 0..EMPTY_PER_TICK {
            if !self.take_next(moves, trail, feed_override) {
                break;
            }
        }
        if (feed_override - self.planned_override).abs() > 0.0 && self.stroke.is_some() {
            self.planned_override = feed_override;
            if let (Some(stroke), Some(queued)) = (&mut self.stroke, moves.get(self.taken.saturating_sub(1))) {
                stroke.set_speed(top_speed(queued, &self.limits, feed_override));
            }
        }
        self.span.plan(spot.tick >= trail.end());
        for _ in 0..PLACES_PER_TICK {
            if trail.end() >= spot.tick + self.ahead {
                return;
            }
            let laid = if self.span.is_idle() {
                self.lay_stroke(moves, trail, spot)
            } else {
                self.lay_span(moves, trail, spot)
            };
            if !laid && !self.take_next(moves, trail, feed_override) {
                return;
            }
        }
    }

    fn lay_stroke(&mut self, moves: &mut VecDeque<Queued>, trail: &mut Trail, spot: Spot) -> bool {
        let Some(stroke) = &mut self.stroke else { return false };
        let Some(queued) = moves.get_mut(self.taken.saturating_sub(1)) else { return false };
        let place = Place {
            at: stroke.next(),
            planned_override: self.planned_override,
            rapid: queued.program.rate == Rate::Rapid,
        };
        let over = stroke.is_over();
        lay(trail, spot, place, !over);
        if over {
            queued.ends_at = Some(trail.end());
            self.stroke = None;
        }
        true
    }

    fn lay_span(&mut self, moves: &mut VecDeque<Queued>, trail: &mut Trail, spot: Spot) -> bool {
        if self.span.has_failed() {
            // Half as many at once then; a single move is a stroke.
            self.run_most = (self.span.tube.segments.len() / 2).max(1);
            self.span.clear();
            return false;
        }
        if !self.span.is_ready() {
            return false;
        }
        if self.span.is_at_start() {
            stand(trail);
        }
        let Some((at, near)) = self.span.next() else { return false };
        let over = self.span.is_at_end();
        let rapid = moves.get(self.taken).is_some_and(|queued| queued.program.rate == Rate::Rapid);
        lay(trail, spot, Place { at, planned_override: self.planned_override, rapid }, !over);
        let last = self.span.tube.segments.len() - 1;
        let ended = if over { last + 1 } else { near };
        while self.span_ended < ended {
            if let Some(queued) = moves.get_mut(self.taken) {
                queued.ends_at = Some(trail.end());
            }
            self.taken += 1;
            self.span_ended += 1;
        }
        if over {
            self.run_most = (2 * self.run_most).min(MOVES);
            stand(trail);
            self.span.clear();
        }
        true
    }

    /// Take the next move of the queue, or a run of them; false when there is none or the last is still under way.
    fn take_next(&mut self, moves: &mut VecDeque<Queued>, trail: &Trail, feed_override: f64) -> bool {
        if self.stroke.is_some() || !self.span.is_idle() {
            return false;
        }
        let Some(queued) = moves.get(self.taken) else { return false };
        if queued.segment.is_nothing() {
            moves[self.taken].ends_at = Some(trail.end());
            self.taken += 1;
            return true;
        }
        let (count, tolerance, open) = self.run_ahead(moves);
        if open && self.quiet < GATHER_TICKS && moves.len() < MOVES {
            return false;
        }
        let count = count.min(self.run_most);
        if count > 1 {
            self.planned_override = feed_override;
            for queued in moves.range(self.taken..self.taken + count) {
                self.span.add(queued.segment, top_feed(queued, feed_override));
            }
            self.span_ended = 0;
            self.span.begin(tolerance);
            return false;
        }
        self.run_most = (2 * self.run_most).min(MOVES);
        let Some(queued) = moves.get(self.taken) else { return false };
        let mut limits = queued.segment.limits(&self.limits);
        limits.velocity_mm_s = top_speed(queued, &self.limits, feed_override);
        self.planned_override = feed_override;
        self.stroke = Some(Stroke::new(queued.segment, limits, self.limits.tick_s));
        self.taken += 1;
        true
    }

    /// How many of the next moves can be one span, its tolerance, and whether moves still to come could belong to it.
    fn run_ahead(&self, moves: &VecDeque<Queued>) -> (usize, f64, bool) {
        let (mut tolerance, mut length, mut seconds) = (f64::INFINITY, 0.0, 0.0);
        // Where to stop when the run is too long for one span: at its sharpest corner, but not in its first half.
        let mut corners: [(f64, usize); MOVES] = [(1.0, 0); MOVES];
        for number in self.taken..moves.len() {
            let count = number + 1 - self.taken;
            let this = &moves[number];
            length += this.segment.length();
            seconds += this.segment.length() / top_speed(this, &self.limits, 1.0);
            let too_long = length > SPAN_LENGTH_MOST_MM || seconds > SPAN_SECONDS_MOST;
            if too_long || count == MOVES {
                let half = count / 2;
                let sharpest =
                    corners[half..count].iter().fold((2.0, 1), |a, b| if b.1 > 0 && b.0 < a.0 { *b } else { a });
                return (sharpest.1, if tolerance.is_finite() { tolerance } else { 0.0 }, false);
            }
            let End::Continuous { tolerance_mm } = this.program.end else { return (count, tolerance, false) };
            let Some(next) = moves.get(number + 1) else { return (count, tolerance, true) };
            let same = (this.program.rate == Rate::Rapid) == (next.program.rate == Rate::Rapid);
            let ([_, a], [b, _]) = (this.segment.directions(), next.segment.directions());
            let cosine: f64 = (0..3).map(|x| a[x] * b[x]).sum();
            if !same || tolerance_mm < LEAST_TOLERANCE_MM || next.segment.is_nothing() || cosine < SHARPEST_COSINE {
                return (count, tolerance, false);
            }
            corners[count] = (cosine, count);
            tolerance = tolerance.min(tolerance_mm);
        }
        (moves.len().saturating_sub(self.taken), tolerance, true)
    }
}

/// Stand long enough that no third difference sees both what was before and what comes: the check of a span knows only
/// the span.
fn stand(trail: &mut Trail) {
    for _ in 0..2 {
        let last = trail.last();
        trail.push(last);
    }
}

/// Lay a place, with what a start from rest needs before it.
fn lay(trail: &mut Trail, spot: Spot, place: Place, more: bool) {
    if !trail.is_open() {
        trail.pad_for_start(spot);
    }
    trail.push(place);
    trail.set_open(more);
}

/// Programmed speed, mm/s.
fn top_feed(queued: &Queued, feed_override: f64) -> f64 {
    match queued.program.rate {
        Rate::Rapid => f64::MAX.sqrt(),
        Rate::Feed { mm_s } => mm_s.max(LEAST_FEED_MM_S) * feed_override,
    }
}

fn top_speed(queued: &Queued, limits: &Limits, feed_override: f64) -> f64 {
    let axes = queued.segment.limits(limits).velocity_mm_s;
    match queued.program.rate {
        Rate::Rapid => axes,
        Rate::Feed { mm_s } => axes.min(mm_s.max(LEAST_FEED_MM_S) * feed_override),
    }
}
