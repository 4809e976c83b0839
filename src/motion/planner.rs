//! The planner: queued moves to nominal set-points on the trail.
//!
//! Owns which moves are planned and how far ahead the trail is laid. Knows nothing of holds and overrides below 100 %.
//! Of a plan that could go on, the trail first gets only the part that its end at rest has no influence on; meanwhile the
//! next window is planned from there. When that is not ready in time, the rest of the plan is laid: the axes brake.

mod look_ahead;

use std::collections::VecDeque;

use super::budget::Budget;
use super::path::Queued;
use super::run::{Then, after};
use super::stroke::Stroke;
use super::trail::{PLACES, Place, Spot, Trail};
use super::tube::Tube;
use super::window::{PIECES, PLAN_TICKS, PlanPoint, Window};
use super::{LEAST_FEED_MM_S, Limits, MOVES, Rate};
use look_ahead::{COST_POINT, Job};

/// The planner keeps this part of every limit, so that the differences of set-points stay below it despite rounding.
const LIMIT_SHARE: f64 = 0.999_99;
/// Units of planning in a tick at most: before the axes start and until the windows are as long as they should be, and
/// after that.
pub const WORK_MOST: usize = 26_000;
const WORK_STEADY: usize = 5_000;
/// Places laid in a tick at most.
const PLACES_PER_TICK: usize = 24;
/// Moves of no length passed in a tick at most.
const EMPTY_PER_TICK: usize = 32;
/// The trail is laid ahead of the axes by this many of the longest braking times.
const BRAKES_AHEAD: f64 = 2.0;
const LEAST_AHEAD: f64 = 96.0;
/// The part of a plan that is better left to the next is laid only when the axes are so near, in places.
const NEAREST: u64 = 8;
/// A run that could still go on is begun when no move has come for so many ticks, or after so many.
const GATHER_TICKS: u32 = 3;
const GATHER_MOST: u32 = 8;

/// What the path asks of the planner in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Ask {
    /// Feed override, at least 1.
    pub feed_override: f64,
    /// A stop is wanted, and the way to it must be known.
    pub braking: bool,
    /// The rate is below what is asked for: leave room for raising it.
    pub catching_up: bool,
}

/// Plans the moves of a queue.
#[derive(Clone, Debug)]
pub struct Planner {
    limits: Limits,
    ahead: u64,
    /// Moves at the front of the queue whose end has been laid, or is by the stroke under way.
    taken: usize,
    stroke: Option<Stroke>,
    /// The plan being laid: its set-points, how many have been, and its tube.
    plan: Vec<PlanPoint>,
    laid: usize,
    tube: Tube,
    /// Whether the plan could go on beyond its end, and the place up to which its end has no influence.
    open: bool,
    best: usize,
    /// Standing in the middle of a move: the last place of the plan.
    partial: Option<PlanPoint>,
    planned_override: f64,
    window: Window,
    job: Option<Job>,
    /// Part of the horizon that is tried: halved when no plan was found that keeps everything.
    part: f64,
    /// Moves in the queue at the last tick, for how many ticks that has been so, and for how many a run has waited.
    /// Units of work that a control point has been found to cost.
    cost_point: f64,
    seen: usize,
    quiet: u32,
    waited: u32,
    work: usize,
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
            plan: Vec::with_capacity(PLAN_TICKS),
            laid: 0,
            tube: Tube::with_capacity(PIECES),
            open: false,
            best: 0,
            partial: None,
            planned_override: 1.0,
            window: Window::new(&limits),
            job: None,
            part: 1.0,
            cost_point: COST_POINT,
            seen: 0,
            quiet: 0,
            waited: 0,
            work: 0,
        }
    }

    /// Forget what is under way.
    pub fn clear(&mut self) {
        self.taken = 0;
        self.stroke = None;
        self.plan.clear();
        self.laid = 0;
        self.partial = None;
        self.cancel();
        self.part = 1.0;
        self.cost_point = COST_POINT;
    }

    /// The first move of the queue has gone.
    pub const fn forget_first(&mut self) {
        self.taken = self.taken.saturating_sub(1);
    }

    /// Units of planning in the last tick.
    pub const fn work(&self) -> usize {
        self.work
    }

    /// Lay some more of the trail.
    pub fn tick(&mut self, moves: &mut VecDeque<Queued>, trail: &mut Trail, spot: Spot, ask: Ask) {
        let calm = self.job.is_none_or(|job| job.is_steady() && !self.is_pressing(job, trail, spot));
        let units = if calm { WORK_STEADY } else { WORK_MOST };
        let mut budget = Budget::new(units);
        self.quiet = if moves.len() == self.seen { self.quiet.saturating_add(1) } else { 0 };
        self.seen = moves.len();
        for _ in 0..EMPTY_PER_TICK {
            if !self.take_next(moves, trail, ask) {
                break;
            }
        }
        self.raise_stroke(moves, ask.feed_override);
        self.look_ahead(moves, trail, spot, ask, &mut budget);
        for _ in 0..PLACES_PER_TICK {
            if trail.end() >= spot.tick + self.ahead {
                break;
            }
            let laid = if self.stroke.is_some() {
                self.lay_stroke(moves, trail, spot)
            } else {
                self.lay_plan(moves, trail, spot, ask)
            };
            if !laid && !self.take_next(moves, trail, ask) {
                break;
            }
        }
        self.work = units - budget.left();
    }

    /// A stroke under way takes a feed override above 100 % at once.
    fn raise_stroke(&mut self, moves: &VecDeque<Queued>, feed_override: f64) {
        if let (Some(stroke), Some(queued)) = (&mut self.stroke, moves.get(self.taken.saturating_sub(1)))
            && (feed_override - self.planned_override).abs() > 0.0
        {
            self.planned_override = feed_override;
            stroke.set_speed(top_speed(queued, &self.limits, feed_override));
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

    fn lay_plan(&mut self, moves: &mut VecDeque<Queued>, trail: &mut Trail, spot: Spot, ask: Ask) -> bool {
        self.adopt(trail);
        let Some(point) = self.plan.get(self.laid).copied() else { return false };
        let kept = self.open && self.laid > self.job.map_or(self.best, |job| job.handover);
        if kept && !ask.braking && trail.is_open() && trail.end() >= spot.tick + NEAREST {
            return false;
        }
        self.laid += 1;
        let over = self.laid == self.plan.len();
        let rapid = moves.get(self.taken).is_some_and(|queued| queued.program.rate == Rate::Rapid);
        lay(trail, spot, Place { at: point.at, planned_override: self.planned_override, rapid }, !over);
        let whole = over && self.tube.ends_with_a_move();
        let number = self.tube.pieces[point.segment].number + u64::from(whole);
        while let Some(queued) = moves.get_mut(self.taken)
            && queued.number < number
        {
            queued.ends_at = Some(trail.end());
            self.taken += 1;
        }
        if over {
            self.partial = (!whole).then_some(point);
            self.plan.clear();
            self.laid = 0;
            self.cancel();
            stand(trail);
        }
        true
    }

    /// Take the next move of the queue, or a run of them; false when there is none or the last is still under way.
    fn take_next(&mut self, moves: &mut VecDeque<Queued>, trail: &Trail, ask: Ask) -> bool {
        if self.stroke.is_some() || !self.plan.is_empty() || self.job.is_some() {
            return false;
        }
        let Some(queued) = moves.get_mut(self.taken) else { return false };
        if queued.segment.is_nothing() {
            queued.ends_at = Some(trail.end());
            self.taken += 1;
            return true;
        }
        let then = after(moves, self.taken);
        if self.part > LEAST_PART && (then != Then::Stops || self.partial.is_some()) {
            self.waited += 1;
            if self.quiet < GATHER_TICKS && self.waited < GATHER_MOST && moves.len() < MOVES {
                return false;
            }
            self.waited = 0;
            // A single move runs exactly at its feed and to its end: that is nothing for a window.
            if then != Then::Open || self.partial.is_some() {
                self.begin_at_rest(moves, ask);
                return false;
            }
        }
        self.part = (2.0 * self.part).min(1.0);
        let Some(queued) = moves.get(self.taken) else { return false };
        let mut limits = queued.segment.limits(&self.limits);
        limits.velocity_mm_s = top_speed(queued, &self.limits, ask.feed_override);
        self.planned_override = ask.feed_override;
        let from = self.partial.take().map_or(0.0, |point| point.along - self.tube.along[point.segment]);
        self.stroke = Some(Stroke::new(queued.segment, from, limits, self.limits.tick_s));
        self.taken += 1;
        true
    }
}

/// Below this part of the horizon a move is taken by itself.
const LEAST_PART: f64 = 0.2;

/// Stand long enough that no third difference sees both what was before and what comes: the check of a plan from rest
/// knows only the plan.
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

fn top_speed(queued: &Queued, limits: &Limits, feed_override: f64) -> f64 {
    let axes = queued.segment.limits(limits).velocity_mm_s;
    match queued.program.rate {
        Rate::Rapid => axes,
        Rate::Feed { mm_s } => axes.min(mm_s.max(LEAST_FEED_MM_S) * feed_override),
    }
}
