//! Returns the waiting blocks with the moves of the cutter's centre. Source: spec B2 (G40 G41 G42), K6.3.

use super::{ActiveCutter, BlockCompensation, ContourState, LOOK_AHEAD, MIN_LENGTH_MM, MoveRole};
use crate::geometry::{PlanePoint, PlaneSegment};
use crate::nc::block::Block;
use crate::nc::op::{AxisSet, Op};
use crate::nc::op_effect::{OpEffect, OpMotion, WorkMove};
use crate::units::{Axis, PerAxis, WorkPos};

/// How the moves of a contour become operations.
#[derive(Clone, Copy)]
struct CentreMoves<'o> {
    active: ActiveCutter,
    by: &'o WorkMove,
    /// Where it begins.
    from: WorkPos,
    /// What the operator has moved by hand, of the axes that the block does not send to an absolute place.
    shift: PerAxis<f64>,
}

impl BlockCompensation {
    /// Fills `block` with the next block whose path is known; false if there is none.
    pub fn release(&mut self, block: &mut Block) -> bool {
        let Some(waiting) = self.waiting.front() else { return false };
        let is_known = |number: usize| !self.is_open() || self.segments > number + LOOK_AHEAD + 1;
        let is_ready = |role: &MoveRole| match role {
            MoveRole::None | MoveRole::Across | MoveRole::LeadOut => true,
            MoveRole::LeadIn => is_known(0),
            MoveRole::Contour(number) => is_known(*number),
        };
        if !waiting.ops.iter().all(|(_, role)| is_ready(role)) {
            return false;
        }
        let Some(mut ready) = self.waiting.pop_front() else { return false };
        block.clear();
        (block.location, block.modals, block.complete) = (ready.place.location, ready.modals, ready.complete);
        for (op, role) in ready.ops.drain(..) {
            self.release_op(op, role, &mut block.ops);
        }
        self.keep(ready);
        true
    }

    fn release_op(&mut self, op: Op, role: MoveRole, ops: &mut Vec<Op>) {
        let (ContourState::Open(active) | ContourState::Ended(active)) = self.contour else { return ops.push(op) };
        let OpEffect::Motion(OpMotion::Work(by)) = op.effect() else { return ops.push(op) };
        // K6.3: from an absolute word on the axis goes to its place.
        let absolute = |axis: &Axis| by.words.contains(*axis) && !by.incremental.contains(*axis);
        Axis::ALL.into_iter().filter(absolute).for_each(|axis| self.shift[axis] = 0.0);
        let moves = CentreMoves { active, by: &by, from: self.returned, shift: self.shift };
        match role {
            MoveRole::None => {
                ops.push(op);
                return;
            }
            MoveRole::Across => ops.extend(moves.across()),
            MoveRole::LeadIn => {
                if let Some(lead) = self.path.take() {
                    ops.push(moves.to(moves.position(lead.path.at(1.0), true)));
                }
            }
            MoveRole::Contour(number) => {
                let first = ops.len();
                while self.path.next_final().is_some_and(|part| part.source == number) {
                    let Some(part) = self.path.take() else { break };
                    let is_last = self.path.next_final().is_none_or(|next| next.source != number);
                    ops.extend(moves.segment(&part.path, is_last));
                }
                if ops.len() == first {
                    // The corner has taken its whole way in the plane.
                    ops.extend(moves.across());
                }
            }
            MoveRole::LeadOut => {
                self.path.take();
                ops.push(moves.to(WorkPos::from_fn(|axis| by.to[axis] + self.shift[axis])));
            }
        }
        if let Some(end) = ops.last().and_then(end_of) {
            self.returned = end;
        }
    }
}

fn end_of(op: &Op) -> Option<WorkPos> {
    match op.effect() {
        OpEffect::Motion(OpMotion::Work(by)) => Some(by.to),
        _ => None,
    }
}

impl CentreMoves<'_> {
    /// The position of the programmed point when the centre is at a place, at the end of the block or before.
    fn position(&self, center: PlanePoint, is_end: bool) -> WorkPos {
        let beside = if is_end { self.by.to } else { self.from };
        let to = self.active.tip(center, beside);
        let normal = self.active.plane.normal_axis();
        WorkPos::from_fn(|axis| if axis == normal && !is_end { to[axis] } else { to[axis] + self.shift[axis] })
    }

    /// The axes that a move names, and those with an incremental word. K6.3: an axis of the plane without a word stays
    /// where the handwheel left it, as in a block without compensation.
    fn axes(&self) -> (AxisSet, AxisSet) {
        let (first, second) = self.active.plane.axes();
        let both = AxisSet::of(first).with(AxisSet::of(second));
        let mut incremental = self.by.incremental;
        both.iter().filter(|axis| !self.by.words.contains(*axis)).for_each(|axis| incremental.insert(axis));
        (self.by.words.with(both), incremental)
    }

    fn to(&self, to: WorkPos) -> Op {
        let (words, incremental) = self.axes();
        match self.by.feed {
            Some(feed) if !self.by.rapid => Op::Feed { to, feed, words, incremental },
            feed => Op::Rapid { to, feed, words, incremental },
        }
    }

    /// The move of the axis across the plane; none if it stays.
    fn across(&self) -> Option<Op> {
        let (normal, mut to) = (self.active.plane.normal_axis(), self.from);
        to[normal] = self.by.to[normal] + self.shift[normal];
        if (to[normal] - self.from[normal]).abs() <= MIN_LENGTH_MM {
            return None;
        }
        let words = AxisSet::of(normal);
        let incremental = self.by.incremental.intersection(words);
        Some(match self.by.feed {
            Some(feed) if !self.by.rapid => Op::Feed { to, feed, words, incremental },
            feed => Op::Rapid { to, feed, words, incremental },
        })
    }

    /// The move along a piece of the centre's path; none without length.
    fn segment(&self, path: &PlaneSegment, is_last: bool) -> Option<Op> {
        if path.length() <= MIN_LENGTH_MM {
            return None;
        }
        let to = self.position(path.at(1.0), is_last);
        match (*path, self.by.feed) {
            (PlaneSegment::Arc { center, sweep, .. }, Some(feed)) => {
                let (words, incremental) = self.axes();
                let turn = if sweep > 0.0 { 1 } else { -1 };
                let (center, plane) = (self.position(center, is_last), self.active.plane);
                Some(Op::Arc { to, center, plane, turn, feed, words, incremental })
            }
            // Rapid moves have lines around their corners.
            (PlaneSegment::Line { .. } | PlaneSegment::Arc { .. }, _) => Some(self.to(to)),
        }
    }
}
