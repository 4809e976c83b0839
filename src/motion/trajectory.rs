//! Program motion: the move queue and the set-points along the moves.
//!
//! Owns the queue, the planner, the buffer, the position of the axes on it, and hold, override and abort.
//!
//! An override below 100 % slows feed and corners alike and takes effect within a few ticks. An override above 100 %
//! raises the programmed feed of everything that is not on the buffer yet: of an active single move at once, of a
//! blended run from the next look-ahead window on, which is then planned immediately.

use std::collections::VecDeque;

use super::blending::approximate_s;
use super::feed_scaling::{DifferenceLimits, FeedScaling, MAX_FEED_SCALING_WORK, SetpointHistory, SetpointsAhead};
use super::path_segment::PathSegment;
use super::queued_move::{MAX_QUEUED_MOVES, MAX_QUEUED_S, MIN_QUEUED_MOVES, QueuedMove};
use super::setpoint_buffer::{BufferPosition, SetpointBuffer};
use super::setpoint_planner::{MAX_WORK_PER_TICK, PlanRequest, SetpointPlanner};
use super::slow_run::is_slow;
use super::{CornerMode, MotionLimits, MotionSpeed, Move, MoveQueueFull, Override, Setpoint};
use crate::units::{MachinePos, PerAxis, WorkBudget};

/// Maximum work units of look-ahead and feed scaling per tick.
pub const MAX_TRAJECTORY_WORK: usize = MAX_WORK_PER_TICK + MAX_FEED_SCALING_WORK;
/// Maximum number of finished tags kept for [`TrajectoryPlanner::pop_finished`]; older tags are dropped.
pub const MAX_FINISHED_TAGS: usize = 1_024;
/// After this many ticks without reaching the requested rate, the rest of the plan is appended up to its end at rest.
const MAX_UNMET_TICKS: u32 = 50;
/// A rate this near to the requested rate counts as reached.
const RATE_MET_TOLERANCE: f64 = 0.16;
/// Maximum feed override.
const MAX_FEED_OVERRIDE: f64 = 1.5;

/// Program motion of all axes.
#[derive(Clone, Debug)]
pub struct TrajectoryPlanner {
    limits: MotionLimits,
    steps: DifferenceLimits,
    moves: VecDeque<QueuedMove>,
    /// Moves pushed since power-on, and the approximate time at the end of the last, s.
    pushed_count: u64,
    pushed_s: f64,
    finished: VecDeque<u32>,
    finished_tag: Option<u32>,
    planner: SetpointPlanner,
    buffer: SetpointBuffer,
    buffer_position: BufferPosition,
    history: SetpointHistory,
    feed_scaling: FeedScaling,
    /// Number of ticks in which the requested rate could not be reached.
    unmet_ticks: u32,
    held: bool,
    aborting: bool,
}

impl TrajectoryPlanner {
    /// A path with the axes at rest at `start`, mm.
    ///
    /// # Panics
    /// When a limit or the tick is not positive and finite, or a start is not finite: a bug of the caller.
    #[must_use]
    pub fn new(limits: MotionLimits, start: MachinePos) -> Self {
        check_limits(&limits);
        assert!(start.is_finite(), "start {start:?}");
        let buffer = SetpointBuffer::at_rest(start.coordinates());
        let spot = buffer.rest_position();
        Self {
            limits,
            steps: DifferenceLimits::from_limits(&limits),
            moves: VecDeque::with_capacity(MAX_QUEUED_MOVES),
            pushed_count: 0,
            pushed_s: 0.0,
            finished: VecDeque::with_capacity(MAX_FINISHED_TAGS),
            finished_tag: None,
            planner: SetpointPlanner::new(&limits),
            buffer,
            buffer_position: spot,
            history: [start.coordinates(); 4],
            feed_scaling: FeedScaling::steady(1.0),
            unmet_ticks: 0,
            held: false,
            aborting: false,
        }
    }

    /// Sets the limits for everything planned from now on.
    ///
    /// # Panics
    /// When the axes are not at rest with nothing queued, or a limit is not positive: bugs of the caller.
    pub fn set_limits(&mut self, limits: MotionLimits) {
        assert!(self.is_done(), "limits changed while moves are queued");
        check_limits(&limits);
        self.limits = limits;
        self.steps = DifferenceLimits::from_limits(&limits);
        self.planner.set_limits(&limits);
    }

    /// Appends a move to the queue.
    ///
    /// # Errors
    /// [`MoveQueueFull`] when [`MAX_QUEUED_MOVES`] are queued, or while an abort brakes.
    ///
    /// # Panics
    /// When an end point, centre, feed or tolerance is not finite: a bug of the caller.
    pub fn push(&mut self, program: Move) -> Result<(), MoveQueueFull> {
        if self.aborting || self.moves.len() >= MAX_QUEUED_MOVES {
            return Err(MoveQueueFull);
        }
        assert!(program.to.is_finite(), "end point {:?}", program.to);
        if let MotionSpeed::Feed { mm_s } = program.speed {
            assert!(mm_s.is_finite(), "feed {mm_s}");
        }
        let from = self.moves.back().map_or(self.last_planned_position(), |last| last.programmed.to.coordinates());
        let segment = PathSegment::new(from, program.to, program.shape);
        assert!(segment.length().is_finite(), "move {program:?}");
        let tolerance_mm = match program.corner {
            CornerMode::Continuous { tolerance_mm } => tolerance_mm,
            CornerMode::ExactStop => self.moves.back().map_or(0.0, |last| last.tolerance_mm),
        };
        let is_slow = is_slow(&self.limits, program.speed, tolerance_mm);
        let mut queued = QueuedMove {
            programmed: program,
            segment,
            tolerance_mm,
            is_slow,
            number: self.pushed_count,
            ends_s: 0.0,
            end_index: None,
        };
        queued.ends_s = self.pushed_s + approximate_s(self.moves.back(), &queued, &self.limits);
        (self.pushed_count, self.pushed_s) = (self.pushed_count + 1, queued.ends_s);
        self.moves.push_back(queued);
        Ok(())
    }

    /// Number of moves to push now; 0 while enough are queued, or an abort brakes.
    #[must_use]
    pub fn free_slots(&self) -> usize {
        let last_s = |of: Option<&QueuedMove>| of.map_or(0.0, |queued| queued.ends_s);
        let queued_s = last_s(self.moves.back()) - last_s(self.moves.front());
        match self.moves.len() {
            _ if self.aborting => 0,
            count @ ..MIN_QUEUED_MOVES => MIN_QUEUED_MOVES - count,
            count if queued_s < MAX_QUEUED_S => MAX_QUEUED_MOVES - count,
            _ => 0,
        }
    }

    /// Advances by one tick and returns the set-point at its end. The work is within [`MAX_TRAJECTORY_WORK`].
    pub fn tick(&mut self, requested: Override) -> Setpoint {
        self.tick_within(requested, &mut WorkBudget::new(MAX_TRAJECTORY_WORK))
    }

    /// As [`Self::tick`], within a budget. The caller grants [`MAX_TRAJECTORY_WORK`]: with less, plans and changes of
    /// rate come later.
    pub fn tick_within(&mut self, requested: Override, budget: &mut WorkBudget) -> Setpoint {
        let feed = clamp_factor(requested.feed, MAX_FEED_OVERRIDE);
        let requested = Override { feed, rapid: clamp_factor(requested.rapid, 1.0) };
        // A verified change of rate relies on the end of a closed buffer: nothing may be appended until it has ended.
        // An abort appends only what it needs until a change of rate to rest has been found.
        let wanted = !self.aborting || (self.buffer.is_open() && self.feed_scaling.target() > 0.0);
        if wanted && (self.buffer.is_open() || self.feed_scaling.is_steady()) {
            let request = PlanRequest {
                spot: self.buffer_position,
                feed_override: requested.feed.max(1.0),
                braking: self.unmet_ticks > if self.held { 0 } else { MAX_UNMET_TICKS },
                catching_up: !self.held && self.wanted_rate(requested) > self.feed_scaling.target(),
            };
            self.planner.tick(&mut self.moves, &mut self.buffer, request, budget);
        }
        self.adjust_rate(requested, budget);
        let ahead = self.feed_scaling.advance();
        self.buffer_position = self.buffer_position.later(ahead);
        let resting = self.buffer.rest_position();
        if self.buffer_position.tick >= resting.tick {
            self.buffer_position = resting;
        }
        let on = self.buffer.sample(self.buffer_position);
        self.history = [self.history[1], self.history[2], self.history[3], on.position];
        self.report_finished();
        if self.aborting && self.is_at_rest() {
            self.discard_moves();
            (self.aborting, self.held) = (false, false);
            self.feed_scaling.set_steady(1.0);
        }
        let rate = self.feed_scaling.rate() / self.limits.tick_s;
        Setpoint { position: MachinePos::new(on.position), velocity_mm_s: PerAxis(on.step.map(|step| step * rate)) }
    }

    /// Feed hold: brakes along the path to rest within the limits and stays at rest.
    pub const fn hold(&mut self) {
        self.held = true;
    }

    /// Ends a hold. An abort cannot be cancelled.
    pub const fn resume(&mut self) {
        if !self.aborting {
            self.held = false;
        }
    }

    /// Whether a hold is active, braking or at rest.
    #[must_use]
    pub const fn is_holding(&self) -> bool {
        self.held
    }

    /// Whether all axes are at rest and stay so in the next tick, unless a move is pushed or hold or override change.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.feed_scaling.is_stopped() || (self.buffer_position.tick >= self.buffer.end() && !self.buffer.is_open())
    }

    /// Whether every move is finished and the axes are at rest.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.moves.is_empty() && self.is_at_rest()
    }

    /// Brakes along the path to rest within the limits, then discards all moves and any hold. Until then
    /// [`TrajectoryPlanner::free_slots`] is 0. Discarded moves are not reported as finished.
    pub fn abort(&mut self) {
        (self.aborting, self.held) = (true, true);
        if self.is_at_rest() {
            self.discard_moves();
            (self.aborting, self.held) = (false, false);
            self.feed_scaling.set_steady(1.0);
        }
    }

    /// Discards every move and sets the position, mm (after a jog in a hold, homing and the like); a hold stays active.
    ///
    /// # Panics
    /// When the axes are not at rest: a bug of the caller.
    pub fn reset_to(&mut self, position: MachinePos) {
        assert!(self.is_at_rest(), "cleared in motion");
        self.moves.clear();
        self.planner.clear();
        self.buffer_position = self.buffer.reset_to(position.coordinates());
        self.history = [position.coordinates(); 4];
        self.feed_scaling.set_steady(if self.held { 0.0 } else { 1.0 });
    }

    /// Number of unfinished moves, including the active one.
    #[must_use]
    pub fn remaining_moves(&self) -> usize {
        self.moves.len()
    }

    /// The tag of the active or next move.
    #[must_use]
    pub fn active_tag(&self) -> Option<u32> {
        self.moves.front().map(|queued| queued.programmed.tag)
    }

    /// The tag of the last finished move; all moves before it are finished, too.
    #[must_use]
    pub const fn finished_tag(&self) -> Option<u32> {
        self.finished_tag
    }

    /// Takes the next tag of a finished move; each is returned once, in order. The newest [`MAX_FINISHED_TAGS`] are kept.
    pub fn pop_finished(&mut self) -> Option<u32> {
        self.finished.pop_front()
    }

    /// The position of the last set-point, mm.
    #[must_use]
    pub const fn position(&self) -> MachinePos {
        MachinePos::new(self.history[3])
    }

    /// Signed distance from the last set-point to the end of the active move, mm; zero without an active move.
    #[must_use]
    pub fn distance_to_go(&self) -> PerAxis<f64> {
        let at = self.position();
        self.moves.front().map_or_else(PerAxis::default, |queued| queued.programmed.to - at)
    }

    /// Units of planning work in the last tick; counted, not timed, and never above [`MAX_WORK_PER_TICK`].
    #[must_use]
    pub const fn work_of_last_tick(&self) -> usize {
        self.planner.work()
    }

    /// Average speed along the path in the last tick, mm/s.
    #[must_use]
    pub fn path_speed_mm_s(&self) -> f64 {
        super::path_segment::distance(self.history[3], self.history[2]) / self.limits.tick_s
    }

    /// The rate requested by hold and override at the present position.
    fn wanted_rate(&self, requested: Override) -> f64 {
        let place = self.buffer.setpoint(self.buffer_position.tick + 1);
        match (self.held, place.is_rapid) {
            (true, _) => 0.0,
            (false, true) => requested.rapid,
            (false, false) => (requested.feed / place.planned_override).min(1.0),
        }
    }

    /// Starts a change to the requested rate.
    fn adjust_rate(&mut self, requested: Override, budget: &mut WorkBudget) {
        let target = self.wanted_rate(requested);
        if (target - self.feed_scaling.target()).abs() <= 0.0 {
            self.unmet_ticks = 0;
            let (buffer, spot) = (&self.buffer, self.buffer_position);
            self.feed_scaling
                .shorten(&SetpointsAhead { buffer, spot, past: &self.history, limits: &self.steps }, budget);
            return;
        }
        if self.buffer_position.tick >= self.buffer.end() {
            // At rest with an empty buffer: the rate can change at once.
            self.feed_scaling.set_steady(target);
            self.unmet_ticks = 0;
        } else {
            let (buffer, spot) = (&self.buffer, self.buffer_position);
            let ahead = SetpointsAhead { buffer, spot, past: &self.history, limits: &self.steps };
            self.feed_scaling.change_to(target, &ahead, budget);
            let met = (target - self.feed_scaling.target()).abs() <= RATE_MET_TOLERANCE;
            self.unmet_ticks = if met { 0 } else { self.unmet_ticks.saturating_add(1) };
        }
    }

    fn report_finished(&mut self) {
        while let Some(queued) = self.moves.front() {
            match queued.end_index {
                Some(place) if self.buffer_position.tick >= place => self.finish_first_move(),
                Some(_) | None => return,
            }
        }
    }

    fn finish_first_move(&mut self) {
        let Some(queued) = self.moves.pop_front() else { return };
        self.planner.first_move_finished();
        self.finished_tag = Some(queued.programmed.tag);
        if self.finished.len() == MAX_FINISHED_TAGS {
            self.finished.pop_front();
        }
        self.finished.push_back(queued.programmed.tag);
    }

    /// Finishes the lines that the axes have passed; call it at rest, before [`TrajectoryPlanner::discard_moves`]. A curve
    /// knows the ends of short lines only at its knots: pushed again, they would lead back.
    pub fn finish_passed_moves(&mut self) {
        let at = self.position().coordinates();
        loop {
            // Points that repeat make moves without a length: the moves on either side of them continue each other.
            let mut with_length =
                self.moves.iter().enumerate().filter(|(_, queued)| !queued.is_point_on_the_way()).map(|(at, _)| at);
            let (Some(first), Some(next)) = (with_length.next(), with_length.next()) else { return };
            if !self.moves[first].is_passed(&self.moves[next], at) {
                return;
            }
            (0..next).for_each(|_| self.finish_first_move());
        }
    }

    /// Discards every move; the axes stay where they are and a hold stays active. The unfinished moves can be pushed
    /// again, after [`TrajectoryPlanner::reset_to`] if an axis was moved meanwhile; an arc then starts with the radius of
    /// its new start point.
    ///
    /// # Panics
    /// When the axes are not at rest: a bug of the caller.
    pub fn discard_moves(&mut self) {
        self.reset_to(self.position());
    }

    /// End position of the buffer, mm.
    fn last_planned_position(&self) -> [f64; 3] {
        self.buffer.last().position
    }
}

/// A factor clamped to 0..=`most`; NaN gives 0.
fn clamp_factor(factor: f64, most: f64) -> f64 {
    if factor > 0.0 { factor.min(most) } else { 0.0 }
}

fn check_limits(limits: &MotionLimits) {
    let positive = |x: f64| x.is_finite() && x > 0.0;
    assert!(positive(limits.tick_s), "tick {} s", limits.tick_s);
    for (axis, l) in limits.axes.iter() {
        let good = positive(l.velocity_mm_s) && positive(l.acceleration_mm_s2) && positive(l.jerk_mm_s3);
        assert!(good, "limits of {axis}: {l:?}");
    }
}
