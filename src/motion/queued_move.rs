//! A move in the queue of the trajectory planner.

use std::collections::VecDeque;

use super::path_segment::PathSegment;
use super::{CornerMode, Move, dot, per_coordinate};

/// Maximum number of queued moves.
pub const MAX_QUEUED_MOVES: usize = 4_096;
/// Beyond this number, moves are queued only as long as together they last less than [`MAX_QUEUED_S`]: what is changed in a
/// program or a variable during a run acts behind them.
pub const MIN_QUEUED_MOVES: usize = 256;
pub const MAX_QUEUED_S: f64 = 2.0;

/// The queue, the next move first.
pub(super) type MoveQueue = VecDeque<QueuedMove>;

/// A move in the queue.
#[derive(Clone, Copy, Debug)]
pub(super) struct QueuedMove {
    pub programmed: Move,
    pub segment: PathSegment,
    /// Allowed deviation from the contour, mm: its own, at an exact stop that of the move before.
    pub tolerance_mm: f64,
    /// Whether it can be part of a slow run.
    pub is_slow: bool,
    /// Serial number since power-on.
    pub number: u64,
    /// Approximate time at its end, s, counted over all moves since power-on at their programmed speeds.
    pub ends_s: f64,
    /// Index on the buffer at which the move is finished (one after its last set-point), once that is appended.
    pub end_index: Option<u64>,
}

impl QueuedMove {
    /// Whether it has no length and no stop.
    pub fn is_point_on_the_way(&self) -> bool {
        self.segment.has_no_length() && self.programmed.corner != CornerMode::ExactStop
    }

    /// Whether a point of the curve lies beyond the end of this line and beside the line that continues it, within the
    /// tolerance. Where the contour turns by 90° or more, the axes may still be before the end.
    pub fn is_passed(&self, next: &Self, point: [f64; 3]) -> bool {
        let is_line = |queued: &Self| queued.segment.curvature() <= 0.0 && !queued.segment.has_no_length();
        if self.programmed.corner == CornerMode::ExactStop || !is_line(self) || !is_line(next) {
            return false;
        }
        let end = self.programmed.to.coordinates();
        let beyond = per_coordinate(|x| point[x] - end[x]);
        let [own, following] = [self, next].map(|queued| queued.segment.directions()[1]);
        let along = dot(beyond, following);
        let beside = per_coordinate(|x| beyond[x] - along * following[x]);
        dot(own, following) > 0.0
            && dot(beyond, own) >= 0.0
            && along >= 0.0
            && dot(beside, beside).sqrt() <= self.tolerance_mm
    }
}
