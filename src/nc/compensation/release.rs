//! Returns the waiting blocks with the moves of the cutter's centre. Source: spec B2 (G40 G41 G42), K6.3.

use std::f64::consts::FRAC_PI_2;

use super::{ActiveCutter, BlockCompensation, ContourState, LOOK_AHEAD, MIN_LENGTH_MM, MoveRole};
use crate::geometry::{PlanePoint, PlaneSegment};
use crate::nc::block::Block;
use crate::nc::op::{AxisSet, Feed, Op};
use crate::nc::op_effect::{OpEffect, OpMotion, WorkMove};
use crate::units::WorkPos;

/// How the moves of a contour become operations.
#[derive(Clone, Copy)]
struct CentreMoves<'o> {
    active: ActiveCutter,
    by: &'o WorkMove,
    /// The coordinate of the normal axis before the move.
    normal: f64,
}

impl BlockCompensation {
    /// Fills `block` with the next block whose path is known; false if there is none.
    pub fn release(&mut self, block: &mut Block) -> bool {
        let Some(waiting) = self.waiting.front() else { return false };
        let is_known = |number: usize| !self.is_open() || self.segments > number + LOOK_AHEAD + 1;
        let is_ready = |role: &MoveRole| match role {
            MoveRole::None | MoveRole::LeadOut => true,
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
        let moves = CentreMoves { active, by: &by, normal: self.normal };
        match role {
            MoveRole::None => ops.push(op),
            MoveRole::LeadIn => {
                if let Some(lead) = self.path.take() {
                    ops.push(moves.line(lead.path.at(1.0)));
                }
            }
            MoveRole::Contour(number) => {
                while self.path.next_final().is_some_and(|part| part.source == number) {
                    let Some(part) = self.path.take() else { break };
                    let is_last = self.path.next_final().is_none_or(|next| next.source != number);
                    moves.segment(&part.path, is_last, ops);
                }
            }
            MoveRole::LeadOut => {
                self.path.take();
                ops.push(moves.to(by.to));
            }
        }
        self.normal = by.to[active.plane.normal_axis()];
    }
}

impl CentreMoves<'_> {
    /// The position of the programmed point when the centre is at a place, at the end of the block or before.
    fn position(&self, center: PlanePoint, is_end: bool) -> WorkPos {
        let mut to = self.active.tip(center, self.by.to);
        if !is_end {
            to[self.active.plane.normal_axis()] = self.normal;
        }
        to
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

    fn line(&self, center: PlanePoint) -> Op {
        self.to(self.position(center, true))
    }

    /// Appends the moves along a piece of the centre's path.
    fn segment(&self, path: &PlaneSegment, is_last: bool, ops: &mut Vec<Op>) {
        if path.length() <= MIN_LENGTH_MM {
            return;
        }
        match (*path, self.by.feed) {
            (PlaneSegment::Line { .. }, _) => ops.push(self.to(self.position(path.at(1.0), is_last))),
            (PlaneSegment::Arc { center, sweep, .. }, Some(feed)) if !self.by.rapid => {
                ops.push(self.arc(path.at(1.0), center, sweep, feed, is_last));
            }
            // Around a corner at rapid speed along its tangents: never nearer than the radius.
            (PlaneSegment::Arc { .. }, _) => {
                let beyond = |fraction: f64, way: f64| {
                    let (at, direction) = (path.at(fraction), path.direction(fraction));
                    [at[0] + direction[0] * way, at[1] + direction[1] * way]
                };
                if let PlaneSegment::Arc { radius, sweep, .. } = *path {
                    let turn = sweep.abs().min(FRAC_PI_2);
                    let way = radius * (turn / 2.0).tan();
                    for corner in [beyond(0.0, way), beyond(1.0, -way), path.at(1.0)] {
                        ops.push(self.to(self.position(corner, is_last)));
                    }
                }
            }
        }
    }

    fn arc(&self, end: PlanePoint, center: PlanePoint, sweep: f64, feed: Feed, is_last: bool) -> Op {
        let (words, incremental) = self.axes();
        Op::Arc {
            to: self.position(end, is_last),
            center: self.position(center, is_last),
            plane: self.active.plane,
            turn: if sweep > 0.0 { 1 } else { -1 },
            feed,
            words,
            incremental,
        }
    }
}
