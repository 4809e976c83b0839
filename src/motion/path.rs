//! Program motion: the move queue and the set-points along the moves.
//!
//! Owns the queue, the planner, the trail, the position of the axes on it, and hold, override and abort.
//!
//! An override below 100 % slows feed and corners alike and takes effect within a few ticks. An override above 100 %
//! raises the programmed feed of everything that is not on the trail yet: of an active stroke at once, of a blended run
//! from the next look-ahead window on, which is then planned immediately.

use std::collections::VecDeque;

use super::contour::Segment;
use super::planner::{Ask, Planner};
use super::trail::{Spot, Trail};
use super::warp::{History, StepLimits, Warp};
use super::{Limits, Move, Override, PathFull, Rate, SetPoint};
use crate::units::PerAxis;

/// Maximum number of queued moves.
pub const MOVES: usize = 256;
/// Maximum number of finished tags kept for [`Path::pop_finished`]; older tags are dropped.
pub const FINISHED_KEPT: usize = 1_024;
/// After this many ticks without reaching the requested rate, the rest of the plan is appended up to its end at rest.
const UNMET_MOST: u32 = 50;
/// A rate this near to the requested rate counts as reached.
const NEARLY_MET: f64 = 0.16;
/// Maximum feed override.
const FEED_OVERRIDE_MOST: f64 = 1.5;

/// A move in the queue.
#[derive(Clone, Copy, Debug)]
pub(super) struct Queued {
    pub program: Move,
    pub segment: Segment,
    /// Serial number since power-on.
    pub number: u64,
    /// Index on the trail at which the move is finished (one after its last set-point), once that is appended.
    pub ends_at: Option<u64>,
}

/// Program motion of all axes.
#[derive(Clone, Debug)]
pub struct Path {
    limits: Limits,
    steps: StepLimits,
    moves: VecDeque<Queued>,
    pushed: u64,
    finished: VecDeque<u32>,
    finished_tag: Option<u32>,
    planner: Planner,
    trail: Trail,
    spot: Spot,
    past: History,
    warp: Warp,
    /// Number of ticks in which the requested rate could not be reached.
    unmet: u32,
    held: bool,
    aborting: bool,
}

impl Path {
    /// A path with the axes at rest at `start`, mm.
    ///
    /// # Panics
    /// When a limit or the tick is not positive and finite, or a start is not finite: a bug of the caller.
    #[must_use]
    pub fn new(limits: Limits, start: PerAxis<f64>) -> Self {
        check_limits(&limits);
        let PerAxis(at) = start;
        assert!(at.iter().all(|x| x.is_finite()), "start {at:?}");
        let trail = Trail::standing(at);
        let spot = trail.resting_spot();
        Self {
            limits,
            steps: StepLimits::of(&limits),
            moves: VecDeque::with_capacity(MOVES),
            pushed: 0,
            finished: VecDeque::with_capacity(FINISHED_KEPT),
            finished_tag: None,
            planner: Planner::new(&limits),
            trail,
            spot,
            past: [at; 4],
            warp: Warp::steady(1.0),
            unmet: 0,
            held: false,
            aborting: false,
        }
    }

    /// Sets the limits for everything planned from now on.
    ///
    /// # Panics
    /// When the axes are not at rest with nothing queued, or a limit is not positive: bugs of the caller.
    pub fn set_limits(&mut self, limits: Limits) {
        assert!(self.is_done(), "limits changed while moves are queued");
        check_limits(&limits);
        self.limits = limits;
        self.steps = StepLimits::of(&limits);
        self.planner = Planner::new(&limits);
    }

    /// Appends a move to the queue.
    ///
    /// # Errors
    /// [`PathFull`] when [`Path::room`] is 0.
    ///
    /// # Panics
    /// When an end point, centre, feed or tolerance is not finite: a bug of the caller.
    pub fn push(&mut self, program: Move) -> Result<(), PathFull> {
        if self.room() == 0 {
            return Err(PathFull);
        }
        let finite = |p: PerAxis<f64>| p.0.iter().all(|x| x.is_finite());
        assert!(finite(program.to), "end point {:?}", program.to);
        if let Rate::Feed { mm_s } = program.rate {
            assert!(mm_s.is_finite(), "feed {mm_s}");
        }
        let from = self.moves.back().map_or(self.end_of_laid(), |last| last.program.to.0);
        let segment = Segment::new(from, program.to, program.shape);
        assert!(segment.length().is_finite(), "move {program:?}");
        self.moves.push_back(Queued { program, segment, number: self.pushed, ends_at: None });
        self.pushed += 1;
        Ok(())
    }

    /// Number of moves that can be pushed now; 0 while an abort brakes.
    #[must_use]
    pub fn room(&self) -> usize {
        if self.aborting { 0 } else { MOVES - self.moves.len() }
    }

    /// Advances by one tick and returns the set-point at its end.
    pub fn tick(&mut self, requested: Override) -> SetPoint {
        let requested = Override { feed: cut(requested.feed, FEED_OVERRIDE_MOST), rapid: cut(requested.rapid, 1.0) };
        // A verified change of rate relies on the end of a closed trail: nothing may be appended until it has ended.
        // An abort appends only what it needs until a change of rate to rest has been found.
        let wanted = !self.aborting || (self.trail.is_open() && self.warp.target() > 0.0);
        if wanted && (self.trail.is_open() || self.warp.is_steady()) {
            let ask = Ask {
                feed_override: requested.feed.max(1.0),
                braking: self.unmet > if self.held { 0 } else { UNMET_MOST },
                catching_up: !self.held && self.wanted_rate(requested) > self.warp.target(),
            };
            self.planner.tick(&mut self.moves, &mut self.trail, self.spot, ask);
        }
        self.steer(requested);
        let ahead = self.warp.step();
        self.spot = self.spot.later(ahead);
        let resting = self.trail.resting_spot();
        if self.spot.tick >= resting.tick {
            self.spot = resting;
        }
        let on = self.trail.on(self.spot);
        self.past = [self.past[1], self.past[2], self.past[3], on.at];
        self.finish_passed();
        if self.aborting && self.is_at_rest() {
            self.forget();
            (self.aborting, self.held) = (false, false);
            self.warp = Warp::steady(1.0);
        }
        let rate = self.warp.rate() / self.limits.tick_s;
        SetPoint { position: PerAxis(on.at), velocity_mm_s: PerAxis(on.step.map(|step| step * rate)) }
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
        self.warp.is_standing() || (self.spot.tick >= self.trail.end() && !self.trail.is_open())
    }

    /// Whether every move is finished and the axes are at rest.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.moves.is_empty() && self.is_at_rest()
    }

    /// Brakes along the path to rest within the limits, then discards all moves and any hold. Until then [`Path::room`]
    /// is 0. Discarded moves are not reported as finished.
    pub fn abort(&mut self) {
        (self.aborting, self.held) = (true, true);
        if self.is_at_rest() {
            self.forget();
            (self.aborting, self.held) = (false, false);
            self.warp = Warp::steady(1.0);
        }
    }

    /// Discards every move and sets the position, mm (after a jog in a hold, homing and the like); a hold stays active.
    ///
    /// # Panics
    /// When the axes are not at rest: a bug of the caller.
    pub fn clear_at(&mut self, position: PerAxis<f64>) {
        assert!(self.is_at_rest(), "cleared in motion");
        self.moves.clear();
        self.planner.clear();
        self.spot = self.trail.stand(position.0);
        self.past = [position.0; 4];
        self.warp = Warp::steady(if self.held { 0.0 } else { 1.0 });
    }

    /// Moves every unfinished move to `out`, the interrupted one first, in order and with tags. The axes stay where
    /// they are; a hold stays active. The moves can be pushed again, after [`Path::clear_at`] if an axis was moved
    /// meanwhile; an arc then starts with the radius of its new start point.
    ///
    /// # Panics
    /// When the axes are not at rest: a bug of the caller.
    pub fn drain_unfinished(&mut self, out: &mut Vec<Move>) {
        out.extend(self.moves.iter().map(|queued| queued.program));
        self.clear_at(self.position());
    }

    /// Number of unfinished moves, including the active one.
    #[must_use]
    pub fn remaining_moves(&self) -> usize {
        self.moves.len()
    }

    /// The tag of the active or next move.
    #[must_use]
    pub fn active_tag(&self) -> Option<u32> {
        self.moves.front().map(|queued| queued.program.tag)
    }

    /// The tag of the last finished move; all moves before it are finished, too.
    #[must_use]
    pub const fn finished_tag(&self) -> Option<u32> {
        self.finished_tag
    }

    /// Takes the next tag of a finished move; each is returned once, in order. The newest [`FINISHED_KEPT`] are kept.
    pub fn pop_finished(&mut self) -> Option<u32> {
        self.finished.pop_front()
    }

    /// The position of the last set-point, mm.
    #[must_use]
    pub const fn position(&self) -> PerAxis<f64> {
        PerAxis(self.past[3])
    }

    /// Signed distance from the last set-point to the end of the active move, mm; zero without an active move.
    #[must_use]
    pub fn distance_to_go(&self) -> PerAxis<f64> {
        let at = self.position();
        self.moves
            .front()
            .map_or(PerAxis([0.0; 3]), |queued| PerAxis::from_fn(|axis| queued.program.to[axis] - at[axis]))
    }

    /// Units of planning work in the last tick; counted, not timed, and never above [`WORK_MOST`].
    #[must_use]
    pub const fn work_of_last_tick(&self) -> usize {
        self.planner.work()
    }

    /// Average speed along the path in the last tick, mm/s.
    #[must_use]
    pub fn path_speed_mm_s(&self) -> f64 {
        super::contour::distance(self.past[3], self.past[2]) / self.limits.tick_s
    }

    /// The rate requested by hold and override at the present position.
    fn wanted_rate(&self, requested: Override) -> f64 {
        let place = self.trail.place(self.spot.tick + 1);
        match (self.held, place.rapid) {
            (true, _) => 0.0,
            (false, true) => requested.rapid,
            (false, false) => (requested.feed / place.planned_override).min(1.0),
        }
    }

    /// Starts a change to the requested rate.
    fn steer(&mut self, requested: Override) {
        let target = self.wanted_rate(requested);
        if (target - self.warp.target()).abs() <= 0.0 {
            self.unmet = 0;
            return;
        }
        if self.spot.tick >= self.trail.end() {
            // At rest with an empty trail: the rate can change at once.
            self.warp = Warp::steady(target);
            self.unmet = 0;
        } else {
            self.warp.aim(target, &self.trail, self.spot, &self.past, &self.steps);
            let met = (target - self.warp.target()).abs() <= NEARLY_MET;
            self.unmet = if met { 0 } else { self.unmet.saturating_add(1) };
        }
    }

    fn finish_passed(&mut self) {
        while let Some(queued) = self.moves.front() {
            match queued.ends_at {
                Some(place) if self.spot.tick >= place => {
                    let tag = queued.program.tag;
                    self.moves.pop_front();
                    self.planner.forget_first();
                    self.finished_tag = Some(tag);
                    if self.finished.len() == FINISHED_KEPT {
                        self.finished.pop_front();
                    }
                    self.finished.push_back(tag);
                }
                Some(_) | None => return,
            }
        }
    }

    fn forget(&mut self) {
        self.clear_at(self.position());
    }

    /// End position of the trail, mm.
    fn end_of_laid(&self) -> [f64; 3] {
        self.trail.last().at
    }
}

/// A factor clamped to 0..=`most`; NaN gives 0.
fn cut(factor: f64, most: f64) -> f64 {
    if factor > 0.0 { factor.min(most) } else { 0.0 }
}

fn check_limits(limits: &Limits) {
    let positive = |x: f64| x.is_finite() && x > 0.0;
    assert!(positive(limits.tick_s), "tick {} s", limits.tick_s);
    for (axis, l) in limits.axes.iter() {
        let good = positive(l.velocity_mm_s) && positive(l.acceleration_mm_s2) && positive(l.jerk_mm_s3);
        assert!(good, "limits of {axis}: {l:?}");
    }
}
