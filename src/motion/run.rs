//! Runs: which queued moves blend into each other without a stop.
//!
//! Decides what ends a run, and fills a tolerance band with the next moves of a run. Knows nothing of plans.

use std::collections::VecDeque;

use super::budget::Budget;
use super::path::Queued;
use super::tube::{Piece, Tube, corner_speed, cosine};
use super::window::PIECES;
use super::{End, LEAST_FEED_MM_S, Limits, Rate};

/// Below this tolerance, mm, corners are exact stops: the curve through the set-points itself needs 0.5 µm.
const LEAST_TOLERANCE_MM: f64 = 0.001;
/// Corners sharper than this (cosine of the angle) are exact stops: a stop costs no time there.
const SHARPEST_COSINE: f64 = -0.8;
/// Minimum speed, mm/s, to avoid a division by zero.
const NO_SPEED: f64 = 1e-6;
/// Work units for adding a move.
const COST_ADD: usize = 500;
/// If at least this share of a move lies within the horizon, the whole move is added.
const WHOLE_FROM: f64 = 0.6;

/// How the motion continues after a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Then {
    /// With the move at this queue index, without a stop.
    Goes(usize),
    /// A stop.
    Stops,
    /// Unknown: the next move is not queued yet and could belong to the run.
    Open,
}

/// How the motion continues after the move at a queue index. Zero-length moves are skipped.
pub fn after(moves: &VecDeque<Queued>, place: usize) -> Then {
    let Some(this) = moves.get(place) else { return Then::Stops };
    for next in place + 1..=moves.len() {
        let Some(End::Continuous { tolerance_mm }) = moves.get(next - 1).map(|queued| queued.program.end) else {
            return Then::Stops;
        };
        if tolerance_mm < LEAST_TOLERANCE_MM {
            return Then::Stops;
        }
        let Some(queued) = moves.get(next) else { return Then::Open };
        if (this.program.rate == Rate::Rapid) != (queued.program.rate == Rate::Rapid) {
            return Then::Stops;
        }
        if !queued.segment.is_nothing() {
            let sharp = cosine(&this.segment, &queued.segment) < SHARPEST_COSINE;
            return if sharp { Then::Stops } else { Then::Goes(next) };
        }
    }
    Then::Open
}

/// Result of filling a tolerance band.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filled {
    /// The work budget is spent: continue in the next tick.
    NotYet,
    /// The run continues beyond the horizon, or the next move is not known yet.
    Open,
    /// The run ends within the horizon.
    AtItsEnd,
}

/// Fills a tolerance band with the next moves of a run.
#[derive(Clone, Copy, Debug)]
pub struct Filling {
    /// Index of the next move of the previous band to take over.
    pub copied: usize,
    /// Serial number of the next queued move, after the moves taken over.
    pub next: u64,
    /// Time left to the horizon, s.
    pub seconds: f64,
    /// Speed reached with constant acceleration, mm/s.
    pub speed: f64,
    /// That acceleration, mm/s².
    pub push: f64,
    /// Jerk at the start and end of an acceleration, mm/s³.
    pub jerk: f64,
    /// Distance along the contour from which the time counts, mm.
    pub from: f64,
    /// Factor on the programmed feeds.
    pub feed_override: f64,
}

impl Filling {
    /// Adds moves up to the horizon: first the rest of the previous band, then moves of the queue.
    pub fn fill(
        &mut self,
        tube: &mut Tube,
        before: &Tube,
        moves: &VecDeque<Queued>,
        limits: &Limits,
        budget: &mut Budget,
    ) -> Filled {
        let front = moves.front().map_or(0, |queued| queued.number);
        loop {
            if budget.is_spent() {
                return Filled::NotYet;
            }
            budget.take(COST_ADD);
            if self.seconds <= 0.0 && tube.length() > self.from {
                // The horizon is at the end of a move.
                return Filled::Open;
            }
            if let Some(piece) = before.pieces.get(self.copied) {
                self.copied += 1;
                self.next = piece.number;
                if self.add(tube, *piece) {
                    return Filled::Open;
                }
                if self.copied < before.pieces.len() {
                    continue;
                }
            } else {
                let Some(queued) = moves.get((self.next - front) as usize) else { return Filled::Open };
                if self.add(tube, piece(queued, limits)) {
                    return Filled::Open;
                }
            }
            match after(moves, (self.next - front) as usize) {
                Then::Stops => return Filled::AtItsEnd,
                Then::Open => return Filled::Open,
                Then::Goes(next) => self.next = front + next as u64,
            }
            if self.seconds <= 0.0 || tube.pieces.len() >= PIECES {
                return Filled::Open;
            }
        }
    }

    /// Adds a move; true if the horizon lies inside it.
    fn add(&mut self, tube: &mut Tube, mut piece: Piece) -> bool {
        if let Some(last) = tube.pieces.last() {
            // The tolerance at a corner is limited by the move before it.
            piece.tolerance = piece.tolerance.min(last.tolerance);
        }
        if piece.tolerance.is_infinite() {
            piece.tolerance = LEAST_TOLERANCE_MM;
        }
        piece.feed = piece.programmed * self.feed_override;
        piece.top = piece.feed.min(piece.most);
        let counted = (tube.length() + piece.segment.length() - self.from.max(tube.length())).max(0.0);
        let corner = tube.pieces.last().map_or(f64::INFINITY, |last| corner_speed(last, &piece, self.jerk));
        let slowed = self.speed.min(corner).min(piece.top);
        let speed = piece.top.min((slowed.powi(2) + 2.0 * self.push * counted).sqrt()).max(NO_SPEED);
        // A slow corner costs time for braking and accelerating, limited by acceleration and jerk.
        let fall = self.speed - slowed;
        let bends = 2.0 * (self.push / self.jerk).min((fall.max(0.0) / self.jerk).sqrt());
        let seconds = 2.0 * counted / (speed + slowed) + fall.max(0.0) / self.push * 0.5 + bends;
        let left = self.seconds.max(0.0);
        let cut = (self.speed + 0.5 * self.push * left).min(piece.top) * left;
        self.speed = speed;
        tube.add(piece);
        if seconds > self.seconds && cut < WHOLE_FROM * counted {
            tube.end = tube.length() - counted + cut;
            return true;
        }
        self.seconds -= seconds;
        false
    }
}

fn piece(queued: &Queued, limits: &Limits) -> Piece {
    let most = queued.segment.limits(limits).velocity_mm_s;
    let programmed = match queued.program.rate {
        Rate::Rapid => f64::MAX.sqrt(),
        Rate::Feed { mm_s } => mm_s.max(LEAST_FEED_MM_S),
    };
    let tolerance = match queued.program.end {
        End::Continuous { tolerance_mm } => tolerance_mm,
        End::ExactStop => f64::INFINITY,
    };
    Piece { segment: queued.segment, number: queued.number, most, programmed, feed: programmed, top: most, tolerance }
}
