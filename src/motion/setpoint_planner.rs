//! The planner: turns queued moves into nominal set-points on the buffer.
//!
//! Decides which moves are planned and how far ahead. Knows nothing of holds and overrides below 100 %. Every plan ends
//! at rest. If the run continues beyond it, only the part not affected by braking is appended first; meanwhile the
//! next window is planned from there. If it is not ready in time, the rest is appended and the axes brake.

mod first_move;
mod handover;

use super::blending::{Continuation, continuation};
use super::lookahead_window::{LookaheadWindow, MAX_PLAN_TICKS, MAX_WINDOW_MOVES, PlanPoint};
use super::path_segment::distance;
use super::point_to_point::PointToPointMove;
use super::queued_move::{MAX_QUEUED_MOVES, MoveQueue, QueuedMove};
use super::setpoint_buffer::{BUFFER_CAPACITY, BufferPosition, NominalSetpoint, SetpointBuffer};
use super::slow_run::SlowRun;
use super::tolerance_band::ToleranceBand;
use super::{AxisLimits, MIN_FEED_MM_S, MotionLimits, MotionSpeed};
use crate::units::WorkBudget;
use handover::{COST_PER_KNOT, PlanningPace, WindowJob};

/// Share of every limit used for planning, so that the differences of set-points stay below it despite rounding.
const LIMIT_SHARE: f64 = 0.999_99;
/// Maximum units of planning work per tick, a unit being about a nanosecond: while a window from rest is planned. At rest
/// nobody else needs the tick, and the axes wait for it.
pub const MAX_WORK_PER_TICK: usize = 60_000;
/// Maximum number of set-points appended per tick.
const SETPOINTS_PER_TICK: usize = 24;
/// Maximum number of zero-length moves skipped per tick.
const EMPTY_MOVES_PER_TICK: usize = 32;
/// The buffer is filled ahead of the axes by this many of the longest braking times, plus `MIN_AHEAD_TICKS` ticks.
const AHEAD_BRAKING_TIMES: f64 = 2.0;
const MIN_AHEAD_TICKS: f64 = 96.0;
/// The braking part of a plan is appended only when the axes are this near to the end of the buffer, in set-points.
const APPEND_MARGIN_TICKS: u64 = 8;
/// A run that may still grow is started when no move has been queued for this many ticks, or after this many ticks.
const GATHER_TICKS: u32 = 1;
const MAX_GATHER_TICKS: u32 = 8;

/// What the path requests from the planner in a tick.
#[derive(Clone, Copy, Debug)]
pub struct PlanRequest {
    /// Where the axes are on the buffer.
    pub spot: BufferPosition,
    /// Feed override, at least 1.
    pub feed_override: f64,
    /// A stop is requested: append the plan up to its end at rest.
    pub braking: bool,
    /// The rate is below the requested one: leave a reserve in the limits for raising it.
    pub catching_up: bool,
}

/// Plans the moves of the queue.
#[derive(Clone, Debug)]
pub struct SetpointPlanner {
    limits: MotionLimits,
    ahead_ticks: u64,
    /// Number of moves at the front of the queue whose end is on the buffer, including the active single move.
    planned_moves: usize,
    single_move: Option<PointToPointMove>,
    /// Number of queued moves that it ends.
    single_moves: usize,
    slow_run: SlowRun,
    /// The plan being appended: its set-points, how many are appended, and its tolerance band.
    plan: Vec<PlanPoint>,
    appended: usize,
    band: ToleranceBand,
    /// Whether the run continues beyond the plan, and the index up to which braking does not affect the plan.
    is_extendable: bool,
    best_handover_index: usize,
    /// Length of the finished moves of a joined one, mm.
    joined_mm: f64,
    /// At rest in the middle of a move: the last set-point of the plan.
    resting_point: Option<PlanPoint>,
    planned_override: f64,
    window: LookaheadWindow,
    job: Option<WindowJob>,
    /// Share of the horizon that is tried; halved when no valid plan from rest was found.
    horizon_fraction: f64,
    /// Measured work units per knot of a window, and the spacing of the knots, s.
    cost_per_knot: f64,
    /// Measured time of a window over the time that the filling of its band has counted.
    time_ratio: f64,
    knot_spacing_s: f64,
    /// The last handover for which no plan was found.
    failed_handover: Option<usize>,
    /// Queue length in the last tick, ticks without a change of it, and ticks that a run has waited to start.
    last_queue_length: usize,
    quiet_ticks: u32,
    waited_ticks: u32,
    work: usize,
}

/// The share of the axis limits that is planned with.
fn planning_limits(limits: &MotionLimits) -> MotionLimits {
    let share = limits.axes.map(|l| AxisLimits {
        velocity_mm_s: l.velocity_mm_s * LIMIT_SHARE,
        acceleration_mm_s2: l.acceleration_mm_s2 * LIMIT_SHARE,
        jerk_mm_s3: l.jerk_mm_s3 * LIMIT_SHARE,
    });
    MotionLimits { axes: share, ..*limits }
}

/// Ticks that the buffer is filled ahead: some braking times of the slowest axis.
fn ahead_ticks(limits: &MotionLimits) -> u64 {
    let brake = |l: &AxisLimits| l.velocity_mm_s / l.acceleration_mm_s2 + l.acceleration_mm_s2 / l.jerk_mm_s3;
    let longest = limits.axes.iter().map(|(_, l)| brake(l)).fold(0.0, f64::max) / limits.tick_s;
    (longest * AHEAD_BRAKING_TIMES + MIN_AHEAD_TICKS).min(BUFFER_CAPACITY as f64 / 2.0) as u64
}

impl SetpointPlanner {
    /// A planner without a plan.
    #[must_use]
    pub fn new(limits: &MotionLimits) -> Self {
        let (limits, ahead_ticks) = (planning_limits(limits), ahead_ticks(limits));
        Self {
            limits,
            ahead_ticks,
            planned_moves: 0,
            single_move: None,
            single_moves: 0,
            slow_run: SlowRun::new(),
            plan: Vec::with_capacity(MAX_PLAN_TICKS),
            appended: 0,
            band: ToleranceBand::with_capacity(MAX_WINDOW_MOVES),
            is_extendable: false,
            best_handover_index: 0,
            joined_mm: 0.0,
            resting_point: None,
            planned_override: 1.0,
            window: LookaheadWindow::new(&limits),
            job: None,
            horizon_fraction: 1.0,
            cost_per_knot: COST_PER_KNOT,
            time_ratio: 1.0,
            knot_spacing_s: 1.0,
            failed_handover: None,
            last_queue_length: 0,
            quiet_ticks: 0,
            waited_ticks: 0,
            work: 0,
        }
    }

    /// Discards all plans and plans for other limits, in the same memory.
    pub fn set_limits(&mut self, limits: &MotionLimits) {
        self.clear();
        self.ahead_ticks = ahead_ticks(limits);
        self.limits = planning_limits(limits);
        self.window.set_limits(&self.limits);
        self.band.clear();
        (self.is_extendable, self.best_handover_index, self.planned_override) = (false, 0, 1.0);
        (self.last_queue_length, self.quiet_ticks, self.waited_ticks) = (0, 0, 0);
    }

    /// Discards all plans.
    pub fn clear(&mut self) {
        self.planned_moves = 0;
        self.single_move = None;
        self.slow_run.clear();
        self.plan.clear();
        self.appended = 0;
        self.joined_mm = 0.0;
        self.resting_point = None;
        self.cancel_window();
        self.horizon_fraction = 1.0;
        self.cost_per_knot = COST_PER_KNOT;
        self.time_ratio = 1.0;
    }

    /// The first move was removed from the queue.
    pub const fn first_move_finished(&mut self) {
        self.planned_moves = self.planned_moves.saturating_sub(1);
    }

    /// Units of planning work in the last tick, without what the last step took beyond its grant.
    pub const fn work(&self) -> usize {
        self.work
    }

    /// Plans for one tick within the budget and appends set-points to the buffer.
    pub fn tick(
        &mut self,
        moves: &mut MoveQueue,
        buffer: &mut SetpointBuffer,
        request: PlanRequest,
        tick_budget: &mut WorkBudget,
    ) {
        let spot = request.spot;
        let units = match self.job {
            None if self.is_idle() => MAX_WORK_PER_TICK,
            None => PlanningPace::Steady.work_per_tick(),
            Some(job) if job.is_from_rest() => MAX_WORK_PER_TICK,
            Some(job) if self.is_urgent(job, buffer, spot) => job.pace().max(PlanningPace::Full).work_per_tick(),
            Some(job) => job.pace().work_per_tick(),
        };
        let mut budget = tick_budget.share(units);
        self.quiet_ticks = if moves.len() == self.last_queue_length { self.quiet_ticks.saturating_add(1) } else { 0 };
        self.last_queue_length = moves.len();
        for _ in 0..EMPTY_MOVES_PER_TICK {
            if !self.start_next(moves, buffer, request, &mut budget) {
                break;
            }
        }
        self.raise_single_move_speed(moves, request.feed_override);
        self.look_ahead(moves, buffer, request, &mut budget);
        for _ in 0..SETPOINTS_PER_TICK {
            let is_slow = self.slow_run.is_active();
            let ahead_ticks = if is_slow { self.slow_run.ahead_ticks() } else { self.ahead_ticks };
            if buffer.end() >= spot.tick + ahead_ticks {
                break;
            }
            let laid = if self.single_move.is_some() {
                self.append_single_move(moves, buffer, spot)
            } else if is_slow {
                budget.spend(self.slow_run.work());
                self.append_slow_run(moves, buffer, request)
            } else {
                self.append_plan(moves, buffer, request)
            };
            if !laid && !self.start_next(moves, buffer, request, &mut budget) {
                break;
            }
        }
        self.work = budget.spent().min(units);
        tick_budget.spend(budget.spent());
    }

    /// Applies a feed override above 100 % to an active single move at once.
    fn raise_single_move_speed(&mut self, moves: &MoveQueue, feed_override: f64) {
        if let (Some(active), Some(queued)) = (&mut self.single_move, moves.get(self.planned_moves.saturating_sub(1)))
            && (feed_override - self.planned_override).abs() > 0.0
        {
            self.planned_override = feed_override;
            active.set_speed(top_speed(queued, &self.limits, feed_override));
        }
    }

    fn append_single_move(&mut self, moves: &mut MoveQueue, buffer: &mut SetpointBuffer, spot: BufferPosition) -> bool {
        let Some(active) = &mut self.single_move else { return false };
        let Some(queued) = moves.get(self.planned_moves.saturating_sub(1)) else { return false };
        let place = NominalSetpoint {
            position: active.next_setpoint(),
            planned_override: self.planned_override,
            is_rapid: queued.programmed.speed == MotionSpeed::Rapid,
        };
        let over = active.is_finished();
        append_setpoint(buffer, spot, place, !over);
        if over {
            for queued in moves.range_mut(self.planned_moves - self.single_moves..self.planned_moves) {
                queued.end_index = Some(buffer.end());
            }
            self.single_move = None;
        }
        true
    }

    /// Appends the next set-point of the slow run; false if it rests.
    fn append_slow_run(&mut self, moves: &mut MoveQueue, buffer: &mut SetpointBuffer, request: PlanRequest) -> bool {
        if request.braking && !buffer.is_open() {
            return false;
        }
        // The rate is relative to the override of the set-points on the buffer: the planned override may rise, not fall.
        self.planned_override = self.planned_override.max(request.feed_override);
        let feed_override = if request.braking { 0.0 } else { self.planned_override };
        let run = &mut self.slow_run;
        let Some(next) = run.next_setpoint(moves, self.planned_moves, &self.limits, feed_override) else {
            return false;
        };
        let (position, planned_override) = (next.position, self.planned_override);
        let place = NominalSetpoint { position, planned_override, is_rapid: false };
        append_setpoint(buffer, request.spot, place, !next.is_at_rest);
        let delay = if next.is_at_rest { 0 } else { self.slow_run.delay_ticks() };
        for _ in 0..next.finished_moves {
            if let Some(queued) = moves.get_mut(self.planned_moves) {
                queued.end_index = Some(buffer.end() + delay);
            }
            self.planned_moves += 1;
        }
        if next.is_at_rest {
            append_rest(buffer);
        }
        true
    }

    fn append_plan(&mut self, moves: &mut MoveQueue, buffer: &mut SetpointBuffer, request: PlanRequest) -> bool {
        self.adopt_window(buffer);
        let Some(point) = self.plan.get(self.appended).copied() else { return false };
        let kept = self.is_extendable && self.appended > self.job.map_or(self.best_handover_index, |job| job.handover);
        if kept && !request.braking && buffer.is_open() && buffer.end() >= request.spot.tick + APPEND_MARGIN_TICKS {
            return false;
        }
        self.appended += 1;
        let over = self.appended == self.plan.len();
        let rapid = moves.get(self.planned_moves).is_some_and(|queued| queued.programmed.speed == MotionSpeed::Rapid);
        let place = NominalSetpoint { position: point.at, planned_override: self.planned_override, is_rapid: rapid };
        append_setpoint(buffer, request.spot, place, !over);
        let whole = over && self.band.ends_at_move_end();
        let piece = &self.band.moves[point.segment];
        let (first, last) = piece.numbers;
        let number = if whole { last + 1 } else { first };
        let passed_mm = point.along - self.band.starts[point.segment];
        while let Some(queued) = moves.get_mut(self.planned_moves) {
            let end_mm = self.joined_mm + queued.segment.length();
            if queued.number >= number && (queued.number >= last || end_mm > passed_mm) {
                break;
            }
            queued.end_index = Some(buffer.end());
            self.planned_moves += 1;
            self.joined_mm = if queued.number < first { 0.0 } else { end_mm };
        }
        if over {
            self.resting_point = (!whole).then_some(point);
            if whole {
                self.joined_mm = 0.0;
            }
            self.plan.clear();
            self.appended = 0;
            self.cancel_window();
            append_rest(buffer);
        }
        true
    }

    /// Whether nothing is planned and nothing left to append.
    fn is_idle(&self) -> bool {
        let is_busy = self.single_move.is_some() || self.slow_run.is_active();
        !is_busy && self.plan.is_empty() && self.job.is_none()
    }

    /// Starts the next move or run of the queue; false if there is none or the last one is still active.
    fn start_next(
        &mut self,
        moves: &mut MoveQueue,
        buffer: &mut SetpointBuffer,
        request: PlanRequest,
        budget: &mut WorkBudget,
    ) -> bool {
        if !self.is_idle() {
            return false;
        }
        let Some(queued) = moves.get_mut(self.planned_moves) else { return false };
        if queued.segment.has_no_length() {
            queued.end_index = Some(buffer.end());
            self.planned_moves += 1;
            return true;
        }
        let is_slow = queued.is_slow;
        let then = continuation(moves, self.planned_moves);
        if self.horizon_fraction > MIN_HORIZON_FRACTION && (then != Continuation::Stops || self.resting_point.is_some())
        {
            let is_fresh = self.resting_point.is_none() && self.horizon_fraction >= 1.0 && !is_slow;
            if is_fresh
                && matches!(then, Continuation::ContinuesAt(_))
                && self.begin_on_first_move(moves, buffer, request, budget)
            {
                self.waited_ticks = 0;
                return true;
            }
            self.waited_ticks += 1;
            if self.quiet_ticks < GATHER_TICKS && self.waited_ticks < MAX_GATHER_TICKS && moves.len() < MAX_QUEUED_MOVES
            {
                return false;
            }
            self.waited_ticks = 0;
            if then != Continuation::Unknown
                && let Some(queued) = moves.get(self.planned_moves).filter(|queued| queued.is_slow)
                && self.resting_point.is_none()
            {
                self.planned_override = request.feed_override;
                self.slow_run.begin(queued, &self.limits);
                // The third differences must not reach back to the end of the move before.
                append_rest(buffer);
                return true;
            }
            // A single move runs exactly at its feed to its end and needs no window.
            if then != Continuation::Unknown || self.resting_point.is_some() {
                self.begin_at_rest(moves, request);
                return false;
            }
        }
        self.horizon_fraction = (2.0 * self.horizon_fraction).min(1.0);
        self.begin_single_move(moves, request)
    }

    /// Starts the next move by itself, from rest to rest.
    fn begin_single_move(&mut self, moves: &MoveQueue, request: PlanRequest) -> bool {
        let Some(queued) = moves.get(self.planned_moves) else { return false };
        self.planned_override = request.feed_override;
        let (mut segment, mut from) = (queued.segment, 0.0);
        self.single_moves = 1;
        if let Some(point) = self.resting_point.take() {
            // In the middle of a move, which may be a joined one.
            let piece = &self.band.moves[point.segment];
            (segment, from) = (piece.segment, point.along - self.band.starts[point.segment]);
            self.single_moves = (piece.numbers.1 + 1 - queued.number) as usize;
        }
        let along = QueuedMove { segment, ..*queued };
        let mut limits = segment.limits(&self.limits);
        limits.velocity_mm_s = top_speed(&along, &self.limits, request.feed_override);
        self.single_move = Some(PointToPointMove::new(segment, from, limits, self.limits.tick_s));
        self.planned_moves += self.single_moves;
        self.joined_mm = 0.0;
        true
    }
}

/// Below this share of the horizon a move is planned by itself.
const MIN_HORIZON_FRACTION: f64 = 0.2;

/// Appends two set-points at rest, so that no third difference spans both the old and the new motion: the check of
/// a plan from rest covers only the plan itself.
fn append_rest(buffer: &mut SetpointBuffer) {
    let last = buffer.last();
    let is_same = |back: &u64| distance(buffer.setpoint(buffer.end() - 1 - back).position, last.position) <= 0.0;
    let repeats = (1..=2).take_while(is_same).count();
    for _ in repeats..2 {
        buffer.push(last);
    }
}

/// Appends a set-point, with padding before it at a start from rest.
fn append_setpoint(buffer: &mut SetpointBuffer, spot: BufferPosition, place: NominalSetpoint, more: bool) {
    if !buffer.is_open() {
        buffer.pad_for_start(spot);
    }
    buffer.push(place);
    buffer.set_open(more);
}

fn top_speed(queued: &QueuedMove, limits: &MotionLimits, feed_override: f64) -> f64 {
    let axes = queued.segment.limits(limits).velocity_mm_s;
    match queued.programmed.speed {
        MotionSpeed::Rapid => axes,
        MotionSpeed::Feed { mm_s } => axes.min(mm_s.max(MIN_FEED_MM_S) * feed_override),
    }
}
