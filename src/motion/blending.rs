//! Runs: which queued moves blend into each other without a stop.
//!
//! Decides what ends a run, and fills a tolerance band with the next moves of a run. Lines too short to shape the curve are
//! joined into one. Knows nothing of plans.

use std::collections::VecDeque;

mod join;

use super::lookahead_window::MAX_WINDOW_MOVES;
use super::queued_move::QueuedMove;
use super::tolerance_band::{BandMove, SHARP_COSINE, ToleranceBand, corner_speed, cosine, turn};
use super::{CornerMode, MIN_FEED_MM_S, MotionLimits, MotionSpeed};
use crate::units::WorkBudget;

/// Below this tolerance, mm, corners are exact stops: the curve through the set-points itself needs 0.5 µm.
const MIN_TOLERANCE_MM: f64 = 0.001;
/// Corners sharper than this (cosine of the angle) are exact stops: a stop costs no time there.
const EXACT_STOP_COSINE: f64 = -0.8;
/// Minimum speed, mm/s, to avoid a division by zero.
const MIN_SPEED_MM_S: f64 = 1e-6;
/// Work units for adding a move.
const COST_ADD: usize = 500;
/// Where a corner's rounding reaches over this share of the moves beside it, it is part of a bend.
const BEND_SHARE: f64 = 0.3;
/// If at least this share of a move lies within the horizon, the whole move is added.
const WHOLE_MOVE_SHARE: f64 = 0.6;

/// How the motion continues after a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuation {
    /// With the move at this queue index, without a stop.
    ContinuesAt(usize),
    /// A stop.
    Stops,
    /// Unknown: the next move is not queued yet and could belong to the run.
    Unknown,
}

/// How the motion continues after the move at a queue index. Zero-length moves are skipped.
pub fn continuation(moves: &VecDeque<QueuedMove>, place: usize) -> Continuation {
    let Some(this) = moves.get(place) else { return Continuation::Stops };
    for next in place + 1..=moves.len() {
        let Some(CornerMode::Continuous { tolerance_mm }) = moves.get(next - 1).map(|queued| queued.programmed.corner)
        else {
            return Continuation::Stops;
        };
        if tolerance_mm < MIN_TOLERANCE_MM {
            return Continuation::Stops;
        }
        let Some(queued) = moves.get(next) else { return Continuation::Unknown };
        if (this.programmed.speed == MotionSpeed::Rapid) != (queued.programmed.speed == MotionSpeed::Rapid) {
            return Continuation::Stops;
        }
        if !queued.segment.has_no_length() {
            if this.is_slow != queued.is_slow {
                return Continuation::Stops;
            }
            let sharp = cosine(&this.segment, &queued.segment) < EXACT_STOP_COSINE;
            return if sharp { Continuation::Stops } else { Continuation::ContinuesAt(next) };
        }
    }
    Continuation::Unknown
}

/// Result of filling a tolerance band.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FillResult {
    /// The work budget is spent: continue in the next tick.
    Incomplete,
    /// The run continues beyond the horizon, or the next move is not known yet.
    RunContinues,
    /// The run ends within the horizon.
    RunEnds,
}

/// Fills a tolerance band with the next moves of a run.
#[derive(Clone, Copy, Debug)]
pub struct BandFiller {
    /// Index of the next move of the previous band to take over.
    pub copied: usize,
    /// Serial number of the next queued move, after the moves taken over.
    pub next: u64,
    /// Time left to the horizon, s.
    pub time_left_s: f64,
    /// Speed reached with constant acceleration, mm/s.
    pub speed: f64,
    /// That acceleration, mm/s²: half of what the slowest axis has.
    pub acceleration: f64,
    /// Jerk at the start and end of an acceleration, mm/s³.
    pub jerk: f64,
    /// Distance along the contour from which the time counts, mm.
    pub from: f64,
    /// Factor on the programmed feeds.
    pub feed_override: f64,
}

impl BandFiller {
    /// Adds moves up to the horizon: first the rest of the previous band, then moves of the queue.
    pub fn fill(
        &mut self,
        band: &mut ToleranceBand,
        before: &ToleranceBand,
        moves: &VecDeque<QueuedMove>,
        limits: &MotionLimits,
        budget: &mut WorkBudget,
    ) -> FillResult {
        let front = moves.front().map_or(0, |queued| queued.number);
        loop {
            if budget.is_spent() {
                return FillResult::Incomplete;
            }
            budget.spend(COST_ADD);
            if self.time_left_s <= 0.0 && band.length() > self.from {
                // The horizon is at the end of a move.
                return FillResult::RunContinues;
            }
            if let Some(piece) = before.moves.get(self.copied) {
                self.copied += 1;
                self.next = piece.numbers.1;
                if self.add(band, *piece) {
                    return FillResult::RunContinues;
                }
                if self.copied < before.moves.len() {
                    continue;
                }
            } else {
                let place = (self.next - front) as usize;
                if place >= moves.len() {
                    return FillResult::RunContinues;
                }
                let piece = join::join(moves, place, limits, budget);
                self.next = piece.numbers.1;
                if self.add(band, piece) {
                    return FillResult::RunContinues;
                }
            }
            match continuation(moves, (self.next - front) as usize) {
                Continuation::Stops => return FillResult::RunEnds,
                Continuation::Unknown => return FillResult::RunContinues,
                Continuation::ContinuesAt(next) => self.next = front + next as u64,
            }
            if self.time_left_s <= 0.0 || band.moves.len() >= MAX_WINDOW_MOVES {
                return FillResult::RunContinues;
            }
        }
    }

    /// Estimated speed, mm/s, between two moves: of the corner, or of the bend that short moves make together; and whether it is
    /// a corner. Bends of chords of different lengths seem to vary from joint to joint, and nothing brakes for that.
    fn joint_speed(&self, before: &BandMove, after: &BandMove) -> (f64, bool) {
        let corner = corner_speed(before, after, self.jerk);
        let turn = turn(before, after);
        let chord_mm = f64::midpoint(before.segment.length(), after.segment.length());
        // A corner is rounded over 6 ε/turn on either side.
        if 6.0 * before.tolerance.min(after.tolerance) < BEND_SHARE * turn * chord_mm {
            return (corner, true);
        }
        let curvature = turn / chord_mm;
        let bend = (2.0 * self.acceleration / curvature).sqrt().min((self.jerk / curvature.powi(2)).cbrt());
        (corner.max(bend), false)
    }

    /// Adds a move; true if the horizon lies inside it.
    fn add(&mut self, band: &mut ToleranceBand, mut piece: BandMove) -> bool {
        if let Some(last) = band.moves.last() {
            // The tolerance at a corner is limited by the move before it.
            piece.programmed_tolerance = piece.programmed_tolerance.min(last.programmed_tolerance);
        }
        if piece.programmed_tolerance.is_infinite() {
            piece.programmed_tolerance = MIN_TOLERANCE_MM;
        }
        piece.tolerance = piece.programmed_tolerance - piece.joined_deviation;
        piece = piece.with_override(self.feed_override);
        let counted = (band.length() + piece.segment.length() - self.from.max(band.length())).max(0.0);
        let (joint, is_corner) =
            band.moves.last().map_or((f64::INFINITY, false), |last| self.joint_speed(last, &piece));
        let slowed = self.speed.min(joint).min(piece.top_speed);
        let speed =
            piece.top_speed.min((slowed.powi(2) + 2.0 * self.acceleration * counted).sqrt()).max(MIN_SPEED_MM_S);
        // A slow corner costs time for braking and accelerating, limited by acceleration and jerk.
        let fall = self.speed - slowed;
        let ramps = 2.0 * (self.acceleration / self.jerk).min((fall.max(0.0) / self.jerk).sqrt());
        let corner_s = if is_corner { fall.max(0.0) / self.acceleration * 0.5 + ramps } else { 0.0 };
        let seconds = 2.0 * counted / (speed + slowed) + corner_s;
        let left = self.time_left_s.max(0.0);
        let cut = (self.speed + 0.5 * self.acceleration * left).min(piece.top_speed) * left;
        self.speed = speed;
        band.add(piece);
        if seconds > self.time_left_s && cut < WHOLE_MOVE_SHARE * counted {
            band.end = band.length() - counted + cut;
            return true;
        }
        self.time_left_s -= seconds;
        false
    }
}

/// Approximate time of a move by itself at its programmed speed, s. After a sharp corner it starts nearly from rest.
pub fn approximate_s(before: Option<&QueuedMove>, queued: &QueuedMove, limits: &MotionLimits) -> f64 {
    let length = queued.segment.length();
    if queued.segment.has_no_length() {
        return 0.0;
    }
    let most = queued.segment.limits(limits).velocity_mm_s;
    let seconds = match queued.programmed.speed {
        MotionSpeed::Rapid => length / most,
        MotionSpeed::Feed { mm_s } => length / mm_s.max(MIN_FEED_MM_S).min(most),
    };
    let is_corner = before.is_some_and(|before| cosine(&before.segment, &queued.segment) < SHARP_COSINE);
    // What lies within the tolerance of a corner is rounded with it.
    let straight = (length - 2.0 * queued.tolerance_mm).max(0.0);
    let from_rest = if is_corner { 4.0 * (straight / (2.0 * limits.least().jerk_mm_s3)).cbrt() } else { 0.0 };
    seconds + from_rest
}

/// A queued move as one of a tolerance band, without override.
pub fn band_move(queued: &QueuedMove, limits: &MotionLimits) -> BandMove {
    let most = queued.segment.limits(limits).velocity_mm_s;
    let programmed = match queued.programmed.speed {
        MotionSpeed::Rapid => f64::MAX.sqrt(),
        MotionSpeed::Feed { mm_s } => mm_s.max(MIN_FEED_MM_S),
    };
    let tolerance = match queued.programmed.corner {
        CornerMode::Continuous { tolerance_mm } => tolerance_mm,
        CornerMode::ExactStop => f64::INFINITY,
    };
    BandMove {
        segment: queued.segment,
        numbers: (queued.number, queued.number),
        max_speed: most,
        programmed_speed: programmed,
        feed: programmed,
        top_speed: most,
        programmed_tolerance: tolerance,
        joined_deviation: 0.0,
        tolerance,
    }
}
