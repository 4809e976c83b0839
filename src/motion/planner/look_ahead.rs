//! Looking ahead: which window is planned next, from where, and when it takes over.
//!
//! Owns the choice of handover and horizon. Knows nothing of how a window is planned or laid.

use std::collections::VecDeque;

use super::super::budget::Budget;
use super::super::path::Queued;
use super::super::run::{Filled, Filling, Then, after};
use super::super::trail::{Spot, Trail};
use super::super::tube::{SHARP_COSINE, cosine};
use super::super::window::{COST_POINT, PlanPoint, SPACING_S, Start};
use super::super::{LEAST_FEED_MM_S, Rate};
use super::{Ask, NEAREST, Planner, WORK_MOST, WORK_STEADY, stand};

/// Time a window looks ahead, s: the first, so that the axes start soon, the shortest and the longest.
const FIRST_S: f64 = 0.2;
const SHORTEST_S: f64 = 0.25;
const LONGEST_S: f64 = 1.4;
/// Control points that braking at the end of a window takes, about.
const BRAKE_POINTS: f64 = 30.0;
/// Set-points before a handover that the next window still knows of.
const BACK: usize = 4;
/// A plan needs so many ticks more than guessed.
const TICKS_SPARE: usize = 12;
/// The end of a plan at rest has influence so many braking times before it, and so many ticks.
const BRAKES_BEFORE: f64 = 1.3;
const TICKS_BEFORE: f64 = 24.0;
/// So many ticks a handover may be put off, and what part of the acceleration a tick must save.
const CALM_TICKS: usize = 48;
const CALM_TICK: f64 = 0.004;
/// How much later the handover is tried after failures, at most.
const OTHER_TICKS: f64 = 30.0;
/// Part of the limits left for raising the rate.
const SPARE: f64 = 0.04;

/// A window being planned.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// The last set-point of the plan under way that is still followed; nothing at rest.
    pub handover: usize,
    /// Whether it begins in motion.
    in_motion: bool,
    filling: Filling,
    start: Start,
    filled: Filled,
    /// Whether the window is as long as it should be.
    steady: bool,
}

/// What is chosen for the next window.
#[derive(Clone, Copy, Debug)]
struct Choice {
    /// The last set-point of the plan under way that is still followed.
    handover: usize,
    /// The first segment of the tube before that is taken over.
    first: usize,
    /// How far it looks ahead, s.
    seconds: f64,
    /// The number of the move to go on with when nothing is taken over.
    next: u64,
    /// Whether there is time enough.
    steady: bool,
}

impl Job {
    /// Whether there is time enough.
    pub const fn is_steady(&self) -> bool {
        self.steady
    }
}

impl Planner {
    /// Give up the window being planned.
    pub(super) fn cancel(&mut self) {
        self.job = None;
        self.window.clear();
    }

    /// Begin to plan from rest.
    pub(super) fn begin_at_rest(&mut self, moves: &VecDeque<Queued>, ask: Ask) {
        let Some(queued) = moves.get(self.taken) else { return };
        let point = self.partial.unwrap_or_else(|| PlanPoint::at_rest(queued.segment.at(0.0), 0.0, 0));
        if self.partial.is_none() {
            self.tube.clear();
        }
        let start = Start { point, past: [point.at; 4], spare: 0.0, hurried: true };
        let (first, next) = (point.segment, queued.number);
        self.begin_job(start, Choice { handover: 0, first, seconds: FIRST_S, next, steady: false }, ask);
    }

    fn begin_job(&mut self, start: Start, choice: Choice, ask: Ask) {
        let Choice { handover, first, seconds, next, steady } = choice;
        self.window.clear();
        self.window.tube.continue_from(&self.tube, first);
        let mut start = start;
        start.point.along -= self.tube.along.get(first).copied().unwrap_or(0.0);
        start.point.segment -= first;
        start.spare = if ask.catching_up { SPARE } else { 0.0 };
        let in_motion = start.point.is_in_motion();
        // What lies on the trail was planned for an override that the rate is measured by: it may rise, not fall.
        let least = if in_motion { self.planned_override } else { 1.0 };
        let filling = Filling {
            copied: first,
            next,
            seconds: seconds * self.part,
            from: start.point.along,
            speed: start.point.velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
            push: self.limits.axes.iter().map(|(_, l)| l.acceleration_mm_s2).fold(f64::INFINITY, f64::min) / 2.0,
            jerk: self.limits.axes.iter().map(|(_, l)| l.jerk_mm_s3).fold(f64::INFINITY, f64::min),
            feed_override: ask.feed_override.max(least),
        };
        self.job = Some(Job { handover, in_motion, filling, start, filled: Filled::NotYet, steady });
    }

    /// Works on the next window, and begins one when it is time.
    pub(super) fn look_ahead(
        &mut self,
        moves: &VecDeque<Queued>,
        trail: &Trail,
        spot: Spot,
        ask: Ask,
        budget: &mut Budget,
    ) {
        if self.job.is_none() && !ask.braking && self.open && !self.plan.is_empty() {
            self.begin_in_motion(moves, trail, spot, ask);
        }
        let Some(mut job) = self.job else { return };
        if job.in_motion && self.laid > job.handover + 1 {
            // Too late: what follows the handover has been laid.
            self.cancel();
            return;
        }
        if job.filled == Filled::NotYet {
            job.filled = job.filling.fill(&mut self.window.tube, &self.tube, moves, &self.limits, budget);
            if job.filled != Filled::NotYet {
                self.window.tube.close();
                self.window.begin(job.start, budget);
            }
            self.job = Some(job);
        }
        self.window.work(budget);
        if self.window.has_failed() {
            self.part *= 0.5;
            self.cancel();
        }
    }

    /// Chooses handover and horizon of the next window; begins when it is time.
    fn begin_in_motion(&mut self, moves: &VecDeque<Queued>, trail: &Trail, spot: Spot, ask: Ask) {
        let Some(last) = self.tube.pieces.last() else { return };
        let front = moves.front().map_or(0, |queued| queued.number);
        let cut = !self.tube.ends_with_a_move();
        if !cut && !matches!(after(moves, (last.number - front) as usize), Then::Goes(_)) {
            return;
        }
        // Where on the plan the axes are, as far as they are on it.
        let here = self.laid as i64 + spot.tick as i64 - trail.end() as i64;
        let near = here + NEAREST as i64 + TICKS_SPARE as i64;
        let best = self.best as i64;
        // As much as is known, as can be planned in time.
        let known = self.known_beyond(moves, (last.number - front) as usize, LONGEST_S);
        let wanted = seconds_of((best - near) as f64, WORK_MOST).clamp(SHORTEST_S, LONGEST_S).min(known);
        let steady = near + ticks_of(wanted, WORK_STEADY) <= best;
        let ticks = ticks_of(wanted, if steady { WORK_STEADY } else { WORK_MOST });
        let raised = ask.feed_override > self.planned_override;
        if !raised && wanted >= LONGEST_S && steady && near + ticks + self.ahead as i64 <= best {
            return;
        }
        let earliest = self.laid.max(usize::try_from(near + ticks).unwrap_or(0));
        // After a failure another state may be better.
        let other = ((1.0 - self.part) * OTHER_TICKS) as usize;
        let handover = other + if raised { earliest } else { earliest.max(self.best) };
        if handover < BACK || handover + BACK >= self.plan.len() {
            return;
        }
        let handover = self.calmest(handover);
        let point = self.plan[handover];
        let past = [3, 2, 1, 0].map(|back| self.plan[handover - back].at);
        let first = self.plan[handover - BACK].segment.saturating_sub(1);
        let start = Start { point, past, spare: 0.0, hurried: false };
        self.begin_job(start, Choice { handover, first, seconds: wanted, next: last.number, steady }, ask);
    }

    /// About how long the run is known beyond the place where the end of the plan takes influence, s, up to `most`.
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
                // From corner to corner nearly as from rest to rest.
                seconds += 4.0 * (length / (2.0 * jerk)).cbrt();
            }
            before = Some(&queued.segment);
        }
        seconds
    }

    /// The set-point with the least acceleration soon after one: from there every way on is open, while a state at a limit
    /// leaves hardly one.
    fn calmest(&self, from: usize) -> usize {
        let strain = |point: &PlanPoint| {
            let part = |(axis, l): (crate::units::Axis, &super::super::AxisLimits)| {
                point.acceleration[axis as usize].abs() / l.acceleration_mm_s2
            };
            self.limits.axes.iter().map(part).fold(0.0, f64::max)
        };
        let last = (from + CALM_TICKS).min(self.plan.len() - BACK - 1);
        let mut best = (f64::INFINITY, from);
        for (later, point) in self.plan[from..=last].iter().enumerate() {
            let strain = strain(point) + later as f64 * CALM_TICK;
            if strain < best.0 {
                best = (strain, from + later);
            }
        }
        best.1
    }

    /// Changes over to the window when it is ready and the plan under way has been laid up to the handover.
    pub(super) fn adopt(&mut self, trail: &mut Trail) {
        let Some(job) = self.job else { return };
        if !self.window.is_ready() || (job.in_motion && self.laid != job.handover + 1) {
            return;
        }
        if !job.in_motion {
            stand(trail);
        }
        std::mem::swap(&mut self.plan, &mut self.window.plan);
        std::mem::swap(&mut self.tube, &mut self.window.tube);
        self.laid = 0;
        self.open = job.filled == Filled::Open;
        self.planned_override = job.filling.feed_override;
        self.partial = None;
        self.part = (2.0 * self.part).min(1.0);
        self.best = self.best_handover();
        self.cancel();
    }

    /// Up to where the end of the plan at rest has no influence.
    fn best_handover(&self) -> usize {
        let (mut push, mut jerk) = (f64::INFINITY, f64::INFINITY);
        for (_, l) in self.limits.axes.iter() {
            (push, jerk) = (push.min(l.acceleration_mm_s2), jerk.min(l.jerk_mm_s3));
        }
        let count = self.plan.len();
        for (left, point) in self.plan.iter().rev().enumerate() {
            let speed = point.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
            // A low speed is left by √(v/j), a high one by v/a and a/j.
            let brake = (speed / push + push / jerk).min(2.0 * (speed / jerk).sqrt()) / self.limits.tick_s;
            if left as f64 >= BRAKES_BEFORE * brake + TICKS_BEFORE && left > 2 * BACK {
                return count - 1 - left;
            }
        }
        0
    }
}

/// Ticks that planning so much takes at so many units of work a tick, and back.
fn ticks_of(seconds: f64, work: usize) -> i64 {
    ((seconds / SPACING_S + BRAKE_POINTS) * COST_POINT as f64 / work as f64).ceil() as i64
}

fn seconds_of(ticks: f64, work: usize) -> f64 {
    (ticks * work as f64 / COST_POINT as f64 - BRAKE_POINTS) * SPACING_S
}
