//! Look-ahead: which window is planned next, from where, and when it takes over.
//!
//! Selects handover and horizon. Knows nothing of how a window is planned or appended.

use std::collections::VecDeque;

use super::super::budget::Budget;
use super::super::path::Queued;
use super::super::run::{Filled, Filling, Then, after};
use super::super::trail::{Spot, Trail};
use super::super::tube::{SHARP_COSINE, cosine};
use super::super::window::{PlanPoint, SPACING_S, Start};
use super::super::{LEAST_FEED_MM_S, Rate};
use super::{Ask, NEAREST, Planner, WORK_MOST, WORK_STEADY, stand, top_speed};

/// Minimum and maximum horizon of a window, s.
const SHORTEST_S: f64 = 0.25;
const LONGEST_S: f64 = 1.4;
/// Work units per control point from the first timing to the last check, found by trial, and the rate at which a lower
/// cost is learned.
pub const COST_POINT: f64 = 20_000.0;
const COST_LEARNT: f64 = 0.2;
/// Approximate number of control points for braking at the end of a window.
const BRAKE_POINTS: f64 = 30.0;
/// Set-points before a handover that the next window takes into account.
const BACK: usize = 4;
/// Reserve in the estimated planning time, ticks.
const TICKS_SPARE: usize = 18;
/// Braking at the end of a plan affects it over this many braking times plus this many ticks.
const BRAKES_BEFORE: f64 = 1.3;
const TICKS_BEFORE: f64 = 24.0;
/// Ticks of the old curve that the next window takes over if there is time, so that the speed can adapt to the path
/// ahead; and their maximum.
const LEAD_TICKS: i64 = 64;
const LEAD_MOST: usize = 160;
/// With fewer ticks only the state of motion is taken over, not the curve.
const LEAD_LEAST: usize = 0;
const LEAD_SHORT: i64 = 24;
/// This near to the handover, in ticks, the full work budget is used.
const PRESSING: u64 = 48;
/// Minimum planning time, ticks.
const SHORTEST_TICKS: i64 = 80;
/// Maximum shift of the handover after failures, ticks.
const OTHER_TICKS: f64 = 30.0;
/// Share of the limits reserved for raising the rate.
const SPARE: f64 = 0.04;

/// A window being planned.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// Index of the last set-point of the current plan that is still used; 0 from rest.
    pub handover: usize,
    /// Whether it starts in motion.
    in_motion: bool,
    filling: Filling,
    start: Start,
    filled: Filled,
    /// Whether the window has its full length within the steady work budget.
    steady: bool,
    /// Horizon, s, and work units spent.
    seconds: f64,
    spent: usize,
}

/// Handover and horizon of the next window.
#[derive(Clone, Copy, Debug)]
struct Choice {
    /// Index of the last set-point of the current plan that is still used.
    handover: usize,
    /// Index of the first move of the old tolerance band that is taken over.
    first: usize,
    /// The end of the part of the old curve that is taken over.
    end: PlanPoint,
    /// Horizon from there, s.
    seconds: f64,
    /// Serial number of the next move if no move is taken over.
    next: u64,
    /// Whether the steady work budget is enough.
    steady: bool,
}

impl Job {
    /// Whether the steady work budget is enough.
    pub const fn is_steady(&self) -> bool {
        self.steady
    }
}

impl Planner {
    /// Discards the window being planned.
    pub(super) fn cancel(&mut self) {
        self.job = None;
        self.window.clear();
    }

    /// Starts a window from rest.
    pub(super) fn begin_at_rest(&mut self, moves: &VecDeque<Queued>, ask: Ask) {
        let Some(queued) = moves.get(self.taken) else { return };
        let point = self.partial.unwrap_or_else(|| PlanPoint::at_rest(queued.segment.at(0.0), 0.0, 0));
        if self.partial.is_none() {
            self.tube.clear();
        }
        let start = Start { point, past: [point.at; 4], until: None, shift: (0.0, 0), spare: 0.0, hurried: true };
        let (first, next) = (point.segment, queued.number);
        let brake = self.brake_s(top_speed(queued, &self.limits, ask.feed_override));
        self.begin_job(
            start,
            Choice { handover: 0, first, end: point, seconds: self.first_s(brake), next, steady: false },
            ask,
        );
    }

    fn begin_job(&mut self, start: Start, choice: Choice, ask: Ask) {
        let Choice { handover, first, seconds, next, steady, .. } = choice;
        self.window.clear();
        self.window.tube.continue_from(&self.tube, first);
        let mut start = start;
        start.shift = (self.tube.along.get(first).copied().unwrap_or(0.0), first);
        start.point.along -= start.shift.0;
        start.point.segment -= first;
        start.spare = if ask.catching_up { SPARE } else { 0.0 };
        let in_motion = start.point.is_in_motion();
        // The rate is relative to the override of the set-points on the trail: the planned override may rise, not fall.
        let least = if in_motion { self.planned_override } else { 1.0 };
        let filling = Filling {
            copied: first,
            next,
            seconds: seconds * self.part,
            from: choice.end.along - start.shift.0,
            speed: choice.end.velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
            push: self.limits.axes.iter().map(|(_, l)| l.acceleration_mm_s2).fold(f64::INFINITY, f64::min) / 2.0,
            jerk: self.limits.axes.iter().map(|(_, l)| l.jerk_mm_s3).fold(f64::INFINITY, f64::min),
            feed_override: ask.feed_override.max(least),
        };
        self.job = Some(Job {
            handover,
            in_motion,
            filling,
            start,
            filled: Filled::NotYet,
            steady,
            seconds: seconds * self.part,
            spent: 0,
        });
    }

    /// Works on the next window; starts one when it is time.
    pub(super) fn look_ahead(
        &mut self,
        moves: &VecDeque<Queued>,
        trail: &Trail,
        spot: Spot,
        ask: Ask,
        budget: &mut Budget,
    ) {
        if self.job.is_some_and(|job| job.steady && job.in_motion && ask.feed_override > job.filling.feed_override) {
            // There was enough time, so there is enough for a faster window.
            self.cancel();
        }
        if self.job.is_none() && !ask.braking && self.open && !self.plan.is_empty() {
            self.begin_in_motion(moves, trail, spot, ask);
        }
        let Some(mut job) = self.job else { return };
        if job.in_motion && self.laid > job.handover + 1 {
            // Too late: the set-points after the handover have been appended.
            job.spent += job.spent / 4;
            self.learn_cost(&job);
            self.cancel();
            return;
        }
        let before = budget.left();
        if job.filled == Filled::NotYet {
            job.filled = job.filling.fill(&mut self.window.tube, &self.tube, moves, &self.limits, budget);
            if job.filled != Filled::NotYet {
                self.window.tube.close();
                self.window.begin(job.start, budget);
            }
            self.job = Some(job);
        }
        self.window.work(budget);
        job.spent += before - budget.left();
        self.job = Some(job);
        if self.window.has_failed() {
            self.part *= 0.5;
            self.cancel();
        }
    }

    /// Selects handover and horizon of the next window; starts it when it is time.
    fn begin_in_motion(&mut self, moves: &VecDeque<Queued>, trail: &Trail, spot: Spot, ask: Ask) {
        let Some(last) = self.tube.pieces.last() else { return };
        let front = moves.front().map_or(0, |queued| queued.number);
        let cut = !self.tube.ends_with_a_move();
        if !cut && !matches!(after(moves, (last.number - front) as usize), Then::Goes(_)) {
            return;
        }
        // Index of the axes on the plan; negative while they are still before it.
        let here = self.laid as i64 + spot.tick as i64 - trail.end() as i64;
        let near = here + NEAREST as i64 + TICKS_SPARE as i64;
        let best = self.best as i64;
        // The horizon is limited by the known moves and by the time for planning.
        let known = self.known_beyond(moves, (last.number - front) as usize, LONGEST_S);
        let aim = (best - LEAD_TICKS).max(near + SHORTEST_TICKS.min(best - near - LEAD_SHORT));
        let wanted = self.seconds_of((aim - near) as f64, WORK_MOST).clamp(SHORTEST_S, LONGEST_S).min(known);
        let raised = ask.feed_override > self.planned_override;
        let steady = !raised && near + self.ticks_of(wanted, WORK_STEADY) <= aim;
        let ticks = self.ticks_of(wanted, if steady { WORK_STEADY } else { WORK_MOST });
        if !raised && wanted >= LONGEST_S && steady && near + ticks + self.ahead as i64 <= aim {
            return;
        }
        let earliest = self.laid.max(usize::try_from(near + ticks).unwrap_or(0));
        // After a failure, start from a later state.
        let other = ((1.0 - self.part) * OTHER_TICKS) as usize;
        let handover = other + if raised { earliest } else { earliest.max(usize::try_from(aim).unwrap_or(0)) };
        if handover < BACK || handover + BACK >= self.plan.len() {
            return;
        }
        let point = self.plan[handover];
        let past = [3, 2, 1, 0].map(|back| self.plan[handover - back].at);
        let end = self.plan[self.best.clamp(handover, handover + LEAD_MOST)];
        let until = (handover + LEAD_LEAST <= self.best).then_some(end.follow.interval);
        let start = Start { point, past, until, shift: (0.0, 0), spare: 0.0, hurried: false };
        let first = self.plan[handover - BACK].segment.saturating_sub(1);
        self.begin_job(start, Choice { handover, first, end, seconds: wanted, next: last.number, steady }, ask);
    }

    /// Approximate time of the known run beyond `best`, s, up to `most`.
    fn known_beyond(&self, moves: &VecDeque<Queued>, last: usize, most: f64) -> f64 {
        let mut seconds = (self.plan.len() - self.best) as f64 * self.limits.tick_s;
        if let Some(piece) = self.tube.pieces.last() {
            seconds += (self.tube.length() - self.tube.end) / piece.top;
        }
        let jerk = self.limits.axes.iter().map(|(_, l)| l.jerk_mm_s3).fold(f64::INFINITY, f64::min);
        let mut before = moves.get(last).map(|queued| &queued.segment);
        for queued in moves.range((last + 1).min(moves.len())..) {
            if seconds >= most {
                break;
            }
            let length = queued.segment.length();
            seconds += match queued.program.rate {
                Rate::Rapid => 0.0,
                Rate::Feed { mm_s } => length / mm_s.max(LEAST_FEED_MM_S),
            };
            if before.is_some_and(|before| cosine(before, &queued.segment) < SHARP_COSINE) {
                // Between sharp corners the motion is nearly from rest to rest.
                seconds += 4.0 * (length / (2.0 * jerk)).cbrt();
            }
            before = Some(&queued.segment);
        }
        seconds
    }

    /// Switches to the window when it is ready and the current plan has been appended up to the handover.
    pub(super) fn adopt(&mut self, trail: &mut Trail) {
        let Some(job) = self.job else { return };
        if !self.window.is_ready() || (job.in_motion && self.laid != job.handover + 1) {
            return;
        }
        self.learn_cost(&job);
        if !job.in_motion {
            stand(trail);
        }
        std::mem::swap(&mut self.plan, &mut self.window.plan);
        std::mem::swap(&mut self.tube, &mut self.window.tube);
        self.laid = 0;
        self.open = job.filled == Filled::Open || self.window.is_cut();
        self.window.keep();
        self.planned_override = job.filling.feed_override;
        self.partial = None;
        self.part = (2.0 * self.part).min(1.0);
        self.best = self.best_handover();
        self.cancel();
    }

    /// Planning time, ticks, of a horizon in seconds at a number of work units per tick. `seconds_of` is the inverse.
    fn ticks_of(&self, seconds: f64, work: usize) -> i64 {
        ((seconds / SPACING_S + BRAKE_POINTS) * self.cost_point / work as f64).ceil() as i64
    }

    fn seconds_of(&self, ticks: f64, work: usize) -> f64 {
        (ticks * work as f64 / self.cost_point - BRAKE_POINTS) * SPACING_S
    }

    /// Updates the cost per control point after each window: upward at once, downward slowly.
    fn learn_cost(&mut self, job: &Job) {
        let cost = job.spent as f64 / (job.seconds / SPACING_S + BRAKE_POINTS);
        let learnt = cost.max(self.cost_point + COST_LEARNT * (cost - self.cost_point));
        self.cost_point = learnt.clamp(0.5 * COST_POINT, 3.0 * COST_POINT);
    }

    /// Whether the axes are near the handover of a window.
    pub(super) fn is_pressing(&self, job: Job, trail: &Trail, spot: Spot) -> bool {
        job.in_motion && spot.tick + self.laid as u64 + PRESSING > trail.end() + job.handover as u64
    }

    /// Horizon of the first window, s: long enough to plan the next one in time.
    fn first_s(&self, brake: f64) -> f64 {
        let ticks = self.ticks_of(SHORTEST_S, WORK_MOST) + NEAREST as i64 + TICKS_SPARE as i64 + LEAD_SHORT;
        BRAKES_BEFORE * brake + (ticks as f64 + TICKS_BEFORE) * self.limits.tick_s
    }

    /// Braking time from a speed in mm/s, s.
    fn brake_s(&self, speed: f64) -> f64 {
        let (mut push, mut jerk) = (f64::INFINITY, f64::INFINITY);
        for (_, l) in self.limits.axes.iter() {
            (push, jerk) = (push.min(l.acceleration_mm_s2), jerk.min(l.jerk_mm_s3));
        }
        // From a low speed: 2·√(v/j). From a high speed: v/a + a/j.
        (speed / push + push / jerk).min(2.0 * (speed / jerk).sqrt())
    }

    /// Index up to which braking at the end of the plan does not affect it.
    fn best_handover(&self) -> usize {
        let count = self.plan.len();
        for (left, point) in self.plan.iter().rev().enumerate() {
            let speed = point.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
            let brake = self.brake_s(speed) / self.limits.tick_s;
            if left as f64 >= BRAKES_BEFORE * brake + TICKS_BEFORE && left > 2 * BACK {
                return count - 1 - left;
            }
        }
        0
    }
}
