//! Runs: which queued moves may flow into each other.
//!
//! Owns the rule of what ends a run, and the filling of a tube with the next moves of one. Knows nothing of plans.

use std::collections::VecDeque;

use super::budget::Budget;
use super::path::Queued;
use super::tube::{Piece, Tube, corner_speed, cosine};
use super::window::PIECES;
use super::{End, LEAST_FEED_MM_S, Limits, Rate};

/// Below this tolerance, mm, corners are exact stops: the curve through the set-points needs half a micrometre itself.
const LEAST_TOLERANCE_MM: f64 = 0.001;
/// Turns sharper than this (cosine of the angle) are exact stops: stopping costs nothing there.
const SHARPEST_COSINE: f64 = -0.8;
/// So slow nothing is divided by it, mm/s.
const NO_SPEED: f64 = 1e-6;
/// Units of work of adding a move.
const COST_ADD: usize = 500;
/// A move that leaves less than this part of itself beyond the horizon is taken whole.
const WHOLE_FROM: f64 = 0.6;

/// What follows a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Then {
    /// The move of this place in the queue, without a stop.
    Goes(usize),
    /// A stop.
    Stops,
    /// Not known yet: what comes next could belong to the run.
    Open,
}

/// What follows the move at a place of the queue. Moves of no length are passed over.
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

/// How filling a tube ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filled {
    /// The work of the tick was spent: go on.
    NotYet,
    /// The horizon lies in or at the end of a move that goes on, or the run is longer than is known yet.
    Open,
    /// The run ends there.
    AtItsEnd,
}

/// Filling a tube with the next moves of a run.
#[derive(Clone, Copy, Debug)]
pub struct Filling {
    /// The next piece of the tube before to be taken over.
    pub copied: usize,
    /// The number of the next move of the queue, once there is nothing more to take over.
    pub next: u64,
    /// Time left to the horizon, s.
    pub seconds: f64,
    /// The speed reached by an even acceleration, and that acceleration: mm/s, mm/s².
    pub speed: f64,
    /// See `speed`.
    pub push: f64,
    /// The jerk with which it begins and ends, mm/s³.
    pub jerk: f64,
    /// Distance along the tube from which it counts, mm.
    pub from: f64,
    /// Feeds are raised by this.
    pub feed_override: f64,
}

impl Filling {
    /// Adds moves up to the horizon: those of the tube before that are left, then those of the queue.
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
                // The horizon fell on the end of a move.
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

    /// Adds a piece; true when the horizon lies in it.
    fn add(&mut self, tube: &mut Tube, mut piece: Piece) -> bool {
        if let Some(last) = tube.pieces.last() {
            // A corner may be rounded by no more than the move before it allows.
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
        // A corner that slows costs a change of speed down and up, with its acceleration and its jerk.
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
