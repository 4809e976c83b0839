//! The planner: turns queued moves into nominal set-points on the trail.
//!
//! Decides which moves are planned and how far ahead. Knows nothing of holds and overrides below 100 %. Every plan ends
//! at rest. If the run continues beyond it, only the part not affected by braking is appended first; meanwhile the
//! next window is planned from there. If it is not ready in time, the rest is appended and the axes brake.

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

/// Share of every limit used for planning, so that the differences of set-points stay below it despite rounding.
const LIMIT_SHARE: f64 = 0.999_99;
/// Maximum units of planning work per tick: until the windows have reached their full length, and afterwards.
pub const WORK_MOST: usize = 26_000;
const WORK_STEADY: usize = 5_000;
/// Maximum number of set-points appended per tick.
const PLACES_PER_TICK: usize = 24;
/// Maximum number of zero-length moves skipped per tick.
const EMPTY_PER_TICK: usize = 32;
/// The trail is filled ahead of the axes by this many of the longest braking times, plus `LEAST_AHEAD` ticks.
const BRAKES_AHEAD: f64 = 2.0;
const LEAST_AHEAD: f64 = 96.0;
/// The braking part of a plan is appended only when the axes are this near to the end of the trail, in set-points.
const NEAREST: u64 = 8;
/// A run that may still grow is started when no move has been queued for this many ticks, or after this many ticks.
const GATHER_TICKS: u32 = 3;
const GATHER_MOST: u32 = 8;

/// What the path requests from the planner in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Ask {
    /// Feed override, at least 1.
    pub feed_override: f64,
    /// A stop is requested: append the plan up to its end at rest.
    pub braking: bool,
    /// The rate is below the requested one: leave a reserve in the limits for raising it.
    pub catching_up: bool,
}

/// Plans the moves of the queue.
#[derive(Clone, Debug)]
pub struct Planner {
    limits: Limits,
    ahead: u64,
    /// Number of moves at the front of the queue whose end is on the trail, including the active stroke.
    taken: usize,
    stroke: Option<Stroke>,
    /// The plan being appended: its set-points, how many are appended, and its tolerance band.
    plan: Vec<PlanPoint>,
    laid: usize,
    tube: Tube,
    /// Whether the run continues beyond the plan, and the index up to which braking does not affect the plan.
    open: bool,
    best: usize,
    /// At rest in the middle of a move: the last set-point of the plan.
    partial: Option<PlanPoint>,
    planned_override: f64,
    window: Window,
    job: Option<Job>,
    /// Share of the horizon that is tried; halved when no valid plan was found.
    part: f64,
    /// Measured work units per control point.
    cost_point: f64,
    /// Queue length in the last tick, ticks without a change of it, and ticks that a run has waited to start.
    seen: usize,
    quiet: u32,
    waited: u32,
    work: usize,
}

impl Planner {
    /// A planner without a plan.
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

    /// Discards all plans.
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

    /// The first move was removed from the queue.
    pub const fn forget_first(&mut self) {
        self.taken = self.taken.saturating_sub(1);
    }

    /// Units of planning work in the last tick.
    pub const fn work(&self) -> usize {
        self.work
    }

    /// Plans for one tick and appends set-points to the trail.
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

    /// Applies a feed override above 100 % to an active stroke at once.
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

    /// Starts the next move or run of the queue; false if there is none or the last one is still active.
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
            // A single move runs exactly at its feed to its end and needs no window.
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

/// Below this share of the horizon a move is planned by itself.
const LEAST_PART: f64 = 0.2;

/// Appends two set-points at rest, so that no third difference spans both the old and the new motion: the check of
/// a plan from rest covers only the plan itself.
fn stand(trail: &mut Trail) {
    for _ in 0..2 {
        let last = trail.last();
        trail.push(last);
    }
}

/// Appends a set-point, with padding before it at a start from rest.
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
