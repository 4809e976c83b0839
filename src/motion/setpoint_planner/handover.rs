//! Look-ahead: which window is planned next, from where, and when it takes over.
//!
//! Selects handover and horizon. Knows nothing of how a window is planned or appended.

use super::super::blending::{BandFiller, Continuation, FillResult, continuation};
use super::super::lookahead_window::{PlanPoint, WindowStart, knot_spacing_s};
use super::super::queued_move::{MoveQueue, QueuedMove};
use super::super::setpoint_buffer::{BufferPosition, SetpointBuffer};
use super::{APPEND_MARGIN_TICKS, PlanRequest, SetpointPlanner, append_rest, top_speed};
use crate::units::WorkBudget;

/// Time that the first window leaves for planning the next one, s; minimum and maximum horizon of a window.
const FIRST_HORIZON_S: f64 = 0.05;
const MIN_HORIZON_S: f64 = 0.35;
const MAX_HORIZON_S: f64 = 1.4;
/// Horizon where there is no time for the minimum, s.
const SHORT_HORIZON_S: f64 = 0.1;
/// Work units per knot of a window, from the first timing to the last check; and the rate at which a lower cost is learned.
pub const COST_PER_KNOT: f64 = 15_000.0;
const COST_DECAY: f64 = 0.2;
/// Range of the learned cost: few steps and no repair, and many of both.
const MIN_COST_PER_KNOT: f64 = 0.5 * COST_PER_KNOT;
const MAX_COST_PER_KNOT: f64 = 3.0 * COST_PER_KNOT;
/// Rate at which the time that windows take is learned, over the time that the filling of their band has counted; and its range.
const TIME_RATIO_DECAY: f64 = 0.5;
const TIME_RATIOS: (f64, f64) = (0.2, 1.5);
/// Approximate time of braking at the end of a window, s.
const BRAKE_S: f64 = 0.12;
/// Set-points before a handover that the next window takes into account.
const HISTORY_POINTS: usize = 4;
/// Reserve in the estimated planning time, ticks.
const SPARE_TICKS: usize = 18;
/// Braking at the end of a plan affects it over this many braking times plus this many ticks.
const INFLUENCE_BRAKING_TIMES: f64 = 1.3;
const INFLUENCE_TICKS: f64 = 24.0;
/// Ticks of the old curve that the next window takes over if there is time, so that the speed can adapt to the path
/// ahead.
const LEAD_TICKS: i64 = 64;
const SHORT_LEAD_TICKS: i64 = 24;
/// Maximum part of the old curve that the next window takes over, s.
const MAX_LEAD_S: f64 = 0.16;
/// This near to the handover, in ticks, the full work budget is used.
const URGENT_TICKS: u64 = 48;
/// After a window in motion has failed, the next one starts at least this many ticks later: nearly the same state fails again.
const RETRY_TICKS: usize = 24;
/// A window that is tried again follows the previous plan over this share of what is left of it: where that plan brakes, too,
/// it keeps all limits.
const RETRY_GUIDE_SHARE: f64 = 0.4;
/// A handover later than this share of the braking part of the plan needs a hurried window.
const LATE_SHARE: f64 = 0.3;
/// Minimum planning time, ticks.
const MIN_PLANNING_TICKS: i64 = 80;
/// Minimum time for which a window starts along the previous plan, also where that plan brakes, s: the acceleration at the
/// start must fade.
const MIN_GUIDE_S: f64 = 0.028;
/// Share of the limits reserved for raising the rate.
const RATE_RESERVE: f64 = 0.04;

/// The reserve in the limits that a plan leaves, as a share of them.
pub fn rate_reserve(request: PlanRequest) -> f64 {
    if request.catching_up { RATE_RESERVE } else { 0.0 }
}

/// How fast a window in motion is planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PlanningPace {
    /// Windows have their full length, and there is time.
    Steady,
    /// Windows have not reached their full length.
    Full,
    /// The axes will brake unless the window is ready soon: the plan would end first, or be far in its braking part, or a window
    /// has found no plan and there is no time for a steady one.
    Hurried,
}

impl PlanningPace {
    /// Maximum units of planning work per tick.
    pub const fn work_per_tick(self) -> usize {
        match self {
            Self::Steady => 5_000,
            Self::Full => 18_000,
            Self::Hurried => 45_000,
        }
    }
}

/// A window being planned.
#[derive(Clone, Copy, Debug)]
pub struct WindowJob {
    /// Index of the last set-point of the current plan that is still used; 0 from rest.
    pub handover: usize,
    /// Index of the last set-point of the current plan that the window follows in its own time.
    guide_end: usize,
    /// Whether it starts in motion.
    in_motion: bool,
    filler: BandFiller,
    start: WindowStart,
    fill_result: FillResult,
    pace: PlanningPace,
    /// Set-points from the handover to where the horizon counts from.
    lead_ticks: usize,
    /// Requested horizon, s, and work units spent.
    horizon_s: f64,
    work_spent: usize,
}

/// Handover and horizon of the next window.
#[derive(Clone, Copy, Debug)]
struct HandoverChoice {
    /// Index of the last set-point of the current plan that is still used.
    handover: usize,
    /// Index of the first move of the old tolerance band that is taken over.
    first: usize,
    /// Where the horizon counts from, and index of the last set-point that the new curve follows in its own time.
    end: PlanPoint,
    /// Set-points from the handover to there.
    lead_ticks: usize,
    guide_end: usize,
    /// Horizon from there, s.
    horizon_s: f64,
    /// Serial number of the next move if no move is taken over.
    next: u64,
    pace: PlanningPace,
}

impl WindowJob {
    /// How fast it is planned.
    pub const fn pace(&self) -> PlanningPace {
        self.pace
    }

    /// Whether the axes wait for it at rest.
    pub const fn is_from_rest(&self) -> bool {
        !self.in_motion
    }

    /// The part of the present plan that a window in motion follows at first.
    fn guide<'a>(&self, plan: &'a [PlanPoint]) -> &'a [PlanPoint] {
        if !self.in_motion {
            return &[];
        }
        plan.get(self.handover..plan.len().min(self.guide_end + 1)).unwrap_or_default()
    }
}

impl SetpointPlanner {
    /// Discards the window being planned.
    pub(super) fn cancel_window(&mut self) {
        self.job = None;
        self.window.clear();
    }

    /// Starts a window from rest.
    pub(super) fn begin_at_rest(&mut self, moves: &MoveQueue, request: PlanRequest) {
        let Some(queued) = moves.get(self.planned_moves) else { return };
        let point = self.resting_point.unwrap_or_else(|| PlanPoint::at_rest(queued.segment.at(0.0), 0.0, 0));
        if self.resting_point.is_none() {
            self.band.clear();
        }
        let history = [point.at; 4];
        let start = WindowStart { point, history, shift: (0.0, 0), reserve: 0.0 };
        let (first, next) = (point.segment, queued.number);
        self.knot_spacing_s = knot_spacing_s(&self.limits, queued.tolerance_mm);
        let horizon_s = self.first_horizon_s(top_speed(queued, &self.limits, request.feed_override));
        let choice = HandoverChoice {
            handover: 0,
            first,
            end: point,
            lead_ticks: 0,
            guide_end: 0,
            horizon_s,
            next,
            pace: PlanningPace::Full,
        };
        self.begin_job(start, choice, request);
    }

    fn begin_job(&mut self, start: WindowStart, choice: HandoverChoice, request: PlanRequest) {
        let HandoverChoice { handover, first, lead_ticks, guide_end, horizon_s: seconds, next, pace, .. } = choice;
        let limits = self.limits.least();
        self.window.clear();
        self.window.band.continue_from(&self.band, first);
        let mut start = start;
        start.shift = (self.band.starts.get(first).copied().unwrap_or(0.0), first);
        start.point.along -= start.shift.0;
        start.point.segment -= first;
        start.reserve = rate_reserve(request);
        let in_motion = start.point.is_in_motion();
        // The rate is relative to the override of the set-points on the buffer: the planned override may rise, not fall.
        let least = if in_motion { self.planned_override } else { 1.0 };
        let filling = BandFiller {
            copied: first,
            next,
            time_left_s: seconds * self.horizon_fraction / self.time_ratio,
            from: choice.end.along - start.shift.0,
            speed: choice.end.velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
            acceleration: limits.acceleration_mm_s2 / 2.0,
            jerk: limits.jerk_mm_s3,
            feed_override: request.feed_override.max(least),
        };
        self.job = Some(WindowJob {
            handover,
            guide_end,
            in_motion,
            filler: filling,
            start,
            fill_result: FillResult::Incomplete,
            pace,
            lead_ticks,
            horizon_s: seconds * self.horizon_fraction,
            work_spent: 0,
        });
    }

    /// Works on the next window; starts one when it is time.
    pub(super) fn look_ahead(
        &mut self,
        moves: &MoveQueue,
        buffer: &SetpointBuffer,
        request: PlanRequest,
        budget: &mut WorkBudget,
    ) {
        let is_slower = |job: WindowJob| job.in_motion && request.feed_override > job.filler.feed_override;
        let has_time = |job: WindowJob| job.pace == PlanningPace::Steady;
        if self.job.is_some_and(|job| has_time(job) && is_slower(job) && !self.is_urgent(job, buffer, request.spot)) {
            // There was enough time, so there is enough for a faster window.
            self.cancel_window();
        }
        if self.job.is_none() && !request.braking && self.is_extendable && !self.plan.is_empty() {
            self.begin_in_motion(moves, buffer, request);
        }
        let Some(mut job) = self.job else { return };
        if job.in_motion && self.appended > job.handover + 1 {
            // Too late: the set-points after the handover have been appended.
            // It would have taken at least a quarter more.
            self.cost_per_knot = self.cost_per_knot.max(1.25 * self.knot_cost(&job)).min(MAX_COST_PER_KNOT);
            self.cancel_window();
            return;
        }
        let before = budget.left();
        if job.fill_result == FillResult::Incomplete {
            job.fill_result = job.filler.fill(&mut self.window.band, &self.band, moves, &self.limits, budget);
            if job.fill_result != FillResult::Incomplete {
                self.window.band.finish();
                self.window.begin(job.start, job.guide(&self.plan), budget);
            }
            self.job = Some(job);
        }
        self.window.work(budget);
        job.work_spent += before - budget.left();
        self.job = Some(job);
        if self.window.has_failed() {
            if job.in_motion {
                self.failed_handover = Some(job.handover);
            } else {
                // From rest, a shorter window is easier. In motion, it would only have less room for braking.
                self.horizon_fraction *= 0.5;
            }
            self.cancel_window();
        }
    }

    /// Selects handover and horizon of the next window; starts it when it is time.
    fn begin_in_motion(&mut self, moves: &MoveQueue, buffer: &SetpointBuffer, request: PlanRequest) {
        let Some(last) = self.band.moves.last() else { return };
        let front = moves.front().map_or(0, |queued| queued.number);
        let cut = !self.band.ends_at_move_end();
        let last_index = (last.numbers.1 - front) as usize;
        if !cut && !matches!(continuation(moves, last_index), Continuation::ContinuesAt(_)) {
            return;
        }
        // Index of the axes on the plan; negative while they are still before it.
        let here = self.appended as i64 + request.spot.tick as i64 - buffer.end() as i64;
        let near = here + APPEND_MARGIN_TICKS as i64 + SPARE_TICKS as i64;
        let best = self.best_handover_index as i64;
        self.knot_spacing_s = knot_spacing_s(&self.limits, last.tolerance);
        // The horizon is limited by the known moves and by the time for planning.
        let known = self.known_time_s(moves, last_index);
        let aim = (best - LEAD_TICKS).max(near + MIN_PLANNING_TICKS.min(best - near - SHORT_LEAD_TICKS));
        let wanted = self.seconds_of(aim - near, PlanningPace::Full).clamp(MIN_HORIZON_S, MAX_HORIZON_S).min(known);
        let raised = request.feed_override > self.planned_override;
        let (wanted, pace) = self.horizon_and_pace(wanted, [near, aim], raised);
        let ticks = self.ticks_of(wanted, pace);
        let is_early = pace == PlanningPace::Steady && near + ticks + self.ahead_ticks as i64 <= aim;
        if is_early && wanted >= MAX_HORIZON_S {
            return;
        }
        let earliest = self.appended.max(usize::try_from(near + ticks).unwrap_or(0));
        let handover = if raised { earliest } else { earliest.max(usize::try_from(aim).unwrap_or(0)) };
        let handover = self.failed_handover.map_or(handover, |failed| handover.max(failed + RETRY_TICKS));
        if handover < HISTORY_POINTS || handover + HISTORY_POINTS >= self.plan.len() {
            return;
        }
        let point = self.plan[handover];
        let history = [3, 2, 1, 0].map(|back| self.plan[handover - back].at);
        let end = self.best_handover_index.clamp(handover, handover + (MAX_LEAD_S / self.limits.tick_s) as usize);
        let retry_share = if self.failed_handover.is_some() { RETRY_GUIDE_SHARE } else { 0.0 };
        let least_guide = (MIN_GUIDE_S / self.limits.tick_s).max(retry_share * (self.plan.len() - handover) as f64);
        let guide_end = end.max(handover + least_guide as usize);
        let (end, lead_ticks) = (self.plan[end], end - handover);
        let start = WindowStart { point, history, shift: (0.0, 0), reserve: 0.0 };
        let first = self.plan[handover - HISTORY_POINTS].segment.saturating_sub(1);
        let choice = HandoverChoice {
            handover,
            first,
            end,
            lead_ticks,
            guide_end,
            horizon_s: wanted,
            next: last.numbers.1,
            pace,
        };
        self.begin_job(start, choice, request);
    }

    /// Horizon, s, of the window that begins soonest at the first of two indices of the plan and aims at the second, and its
    /// pace. `raised`: the feed override is above the planned one.
    fn horizon_and_pace(&self, wanted: f64, [near, aim]: [i64; 2], raised: bool) -> (f64, PlanningPace) {
        let (end, best) = (self.plan.len() as i64, self.best_handover_index as i64);
        let full = self.ticks_of(wanted, PlanningPace::Full);
        let left = end - SHORT_LEAD_TICKS - near;
        if full >= left {
            // The plan would end first.
            let pace = PlanningPace::Hurried;
            (wanted.min(self.seconds_of(left, pace).max(SHORT_HORIZON_S)), pace)
        } else if !raised && near + self.ticks_of(wanted, PlanningPace::Steady) <= aim {
            (wanted, PlanningPace::Steady)
        } else if self.failed_handover.is_some() || (near + full - best) as f64 > LATE_SHARE * (end - best) as f64 {
            // Nearly the same has failed, or the handover would be where the axes have braked.
            (wanted, PlanningPace::Hurried)
        } else {
            (wanted, PlanningPace::Full)
        }
    }

    /// Approximate time of the known run beyond the best handover, s; `last` is the index of the last move of the plan.
    fn known_time_s(&self, moves: &MoveQueue, last: usize) -> f64 {
        let planned_s = (self.plan.len() - self.best_handover_index) as f64 * self.limits.tick_s;
        let cut_s = self.band.moves.last().map_or(0.0, |piece| (self.band.length() - self.band.end) / piece.top_speed);
        let ends_s = |queued: Option<&QueuedMove>| queued.map_or(0.0, |queued| queued.ends_s);
        planned_s + cut_s + ends_s(moves.back()) - ends_s(moves.get(last))
    }

    /// Switches to the window when it is ready and the current plan has been appended up to the handover.
    pub(super) fn adopt_window(&mut self, buffer: &mut SetpointBuffer) {
        let Some(job) = self.job else { return };
        if !self.window.is_ready() || (job.in_motion && self.appended != job.handover + 1) {
            return;
        }
        self.update_cost(&job);
        self.update_time_ratio(&job);
        self.failed_handover = None;
        if !job.in_motion {
            append_rest(buffer);
        }
        std::mem::swap(&mut self.plan, &mut self.window.plan);
        std::mem::swap(&mut self.band, &mut self.window.band);
        self.appended = 0;
        self.is_extendable = job.fill_result == FillResult::RunContinues || self.window.is_cut();
        self.window.adopt();
        self.planned_override = job.filler.feed_override;
        self.resting_point = None;
        self.horizon_fraction = (2.0 * self.horizon_fraction).min(1.0);
        self.best_handover_index = self.best_handover();
        self.cancel_window();
    }

    /// Planning time, ticks, of a horizon in seconds. `seconds_of` is the inverse.
    fn ticks_of(&self, seconds: f64, pace: PlanningPace) -> i64 {
        ((seconds + BRAKE_S) / self.knot_spacing_s * self.cost_per_knot / pace.work_per_tick() as f64).ceil() as i64
    }

    fn seconds_of(&self, ticks: i64, pace: PlanningPace) -> f64 {
        ticks as f64 * pace.work_per_tick() as f64 / self.cost_per_knot * self.knot_spacing_s - BRAKE_S
    }

    /// Work units per knot of the requested horizon, up to now. A window may have more knots than that: it counts for the
    /// estimate what the request has cost.
    fn knot_cost(&self, job: &WindowJob) -> f64 {
        let requested = (job.horizon_s + BRAKE_S) / self.knot_spacing_s;
        let knots = if self.window.is_cut() { self.window.knot_count() as f64 } else { requested };
        job.work_spent as f64 / knots
    }

    /// Updates the cost per knot after each window: upward at once, downward slowly.
    fn update_cost(&mut self, job: &WindowJob) {
        let cost = self.knot_cost(job);
        // A window from rest says little of the next: less of it is fast.
        let decay = if job.in_motion { COST_DECAY } else { 0.0 };
        let learnt = cost.max(self.cost_per_knot + decay * (cost - self.cost_per_knot));
        self.cost_per_knot = learnt.clamp(MIN_COST_PER_KNOT, MAX_COST_PER_KNOT);
    }

    /// Updates the ratio of the time that a window takes to the time that its band has counted: else windows along contours that
    /// seem slower than they are stay so short that all of a plan brakes.
    fn update_time_ratio(&mut self, job: &WindowJob) {
        if job.fill_result != FillResult::RunContinues || self.window.is_cut() {
            return;
        }
        // A window may overtake the plan before it.
        let planned_s = self.window.plan.len().saturating_sub(job.lead_ticks) as f64 * self.limits.tick_s;
        let ratio = (self.time_ratio * planned_s / job.horizon_s).clamp(TIME_RATIOS.0, TIME_RATIOS.1);
        self.time_ratio += TIME_RATIO_DECAY * (ratio - self.time_ratio);
    }

    /// Whether the axes are near the handover of a window.
    pub(super) fn is_urgent(&self, job: WindowJob, buffer: &SetpointBuffer, spot: BufferPosition) -> bool {
        job.in_motion && spot.tick + self.appended as u64 + URGENT_TICKS > buffer.end() + job.handover as u64
    }

    /// Horizon of the first window, s: long enough to plan the next one in time.
    fn first_horizon_s(&self, speed: f64) -> f64 {
        self.planning_ticks() as f64 * self.limits.tick_s + self.influence_s(speed)
    }

    /// Ticks on a plan from rest in which the next window can be planned.
    fn planning_ticks(&self) -> i64 {
        self.ticks_of(FIRST_HORIZON_S, PlanningPace::Full)
            + APPEND_MARGIN_TICKS as i64
            + SPARE_TICKS as i64
            + SHORT_LEAD_TICKS
    }

    /// The same for a run with a tolerance that begins: the index of the first handover.
    pub(super) fn first_handover_ticks(&mut self, tolerance_mm: f64) -> usize {
        self.knot_spacing_s = knot_spacing_s(&self.limits, tolerance_mm);
        usize::try_from(self.planning_ticks()).unwrap_or(usize::MAX)
    }

    /// For how long braking from a speed in mm/s to the end of a plan affects it, s.
    pub(super) fn influence_s(&self, speed: f64) -> f64 {
        INFLUENCE_BRAKING_TIMES * self.limits.least().ramp_s(speed) + INFLUENCE_TICKS * self.limits.tick_s
    }

    /// Index up to which braking at the end of the plan does not affect it.
    pub(super) fn best_handover(&self) -> usize {
        let count = self.plan.len();
        for (left, point) in self.plan.iter().rev().enumerate() {
            let speed = point.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
            if left as f64 * self.limits.tick_s >= self.influence_s(speed) && left > 2 * HISTORY_POINTS {
                return count - 1 - left;
            }
        }
        0
    }
}
