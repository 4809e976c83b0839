//! A line or an arc of the contour of a cycle, and moves. Lengths are radius millimetres in work coordinates.
//! Source: spec B2 (G70–G73).

use super::op::{AxisSet, Feed, Op};
use super::op_effect::{OpEffect, OpMotion};
use crate::units::{Axis, PerAxis, WorkPos};

/// Shorter distances count as zero, mm; far below the resolution.
pub(super) const MIN_LENGTH_MM: f64 = 1e-7;

/// An arc whose end is rounded may go beyond it by this, mm: the tolerance of arc ends.
const ROUNDED_END_MM: f64 = 0.01;

/// One line or arc of the contour.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContourSegment {
    pub from: WorkPos,
    pub to: WorkPos,
    /// Centre of an arc, and its turn (−1 or 1).
    pub arc: Option<(WorkPos, i8)>,
    pub rapid: bool,
    /// The index of its operation.
    pub source: usize,
}

impl ContourSegment {
    /// The segment shifted by `by`.
    pub fn shifted(&self, by: PerAxis<f64>) -> Self {
        let arc = self.arc.map(|(center, turn)| (center + by, turn));
        Self { from: self.from + by, to: self.to + by, arc, ..*self }
    }

    /// The segment shifted by `by`, as an operation with the cycle's feed.
    pub fn to_op(self, by: PerAxis<f64>, feed: Feed) -> Op {
        let (to, both) = (self.to + by, [Axis::X, Axis::Z]);
        match self.arc {
            None if self.rapid => rapid_to(to, &both),
            None => feed_to(to, feed, &both),
            Some((center, turn)) => Op::Arc {
                to,
                center: center + by,
                plane: crate::units::Plane::Zx,
                turn,
                feed,
                words: axis_set(&both),
                incremental: AxisSet::NONE,
            },
        }
    }

    /// Whether it moves only in the direction of `way` in both axes.
    pub fn is_monotone(&self, way: PerAxis<f64>) -> bool {
        let goes = |axis: Axis| (self.to[axis] - self.from[axis]) * way[axis] >= -MIN_LENGTH_MM;
        goes(Axis::X) && goes(Axis::Z) && !self.passes_extreme()
    }

    /// Whether it goes along an axis in one direction (1 or −1) only.
    pub fn goes_along(&self, axis: Axis, way: f64) -> bool {
        let quarters = if axis == Axis::X { [1, 3] } else { [0, 2] };
        (self.to[axis] - self.from[axis]) * way >= -MIN_LENGTH_MM && quarters.iter().all(|at| !self.passes(*at))
    }

    /// The parts before and behind the extreme of an axis that an arc passes; the second one only if it does.
    pub fn split_at_extreme(&self, axis: Axis) -> [Option<Self>; 2] {
        let quarters = if axis == Axis::X { [1, 3] } else { [0, 2] };
        let passed = quarters.into_iter().find(|quarter| self.passes(*quarter));
        let (Some(quarter), Some((center, _))) = (passed, self.arc) else { return [Some(*self), None] };
        let radius = (self.from[Axis::X] - center[Axis::X]).hypot(self.from[Axis::Z] - center[Axis::Z]);
        let mut extreme = center;
        extreme[axis] += if quarter < 2 { radius } else { -radius };
        [Some(Self { to: extreme, ..*self }), Some(Self { from: extreme, ..*self })]
    }

    /// Whether an arc passes an extreme of an axis between its ends.
    fn passes_extreme(&self) -> bool {
        (0..4).any(|quarter| self.passes(quarter))
    }

    /// Whether an arc passes a quarter between its ends: 0 is Z+, 1 X+, 2 Z−, 3 X−.
    fn passes(&self, quarter: u8) -> bool {
        let Some((center, turn)) = self.arc else { return false };
        // Angles with Z to the right and X up; counter-clockwise is positive.
        let angle = |at: WorkPos| (at[Axis::X] - center[Axis::X]).atan2(at[Axis::Z] - center[Axis::Z]);
        let sense = f64::from(turn);
        let swept = |to: f64| (sense * (to - angle(self.from))).rem_euclid(std::f64::consts::TAU);
        let at = swept(f64::from(quarter) * std::f64::consts::FRAC_PI_2);
        let whole = swept(angle(self.to));
        // How far the arc goes beyond its nearer end: a rounded end is no turn.
        let radius = (self.from[Axis::X] - center[Axis::X]).hypot(self.from[Axis::Z] - center[Axis::Z]);
        at < whole && radius * (1.0 - at.min(whole - at).cos()) > ROUNDED_END_MM
    }

    /// The coordinate on the other axis where the segment crosses `level` of an axis.
    pub fn crossing_at(&self, axis: Axis, level: f64) -> Option<f64> {
        let (low, high) = (self.from[axis].min(self.to[axis]), self.from[axis].max(self.to[axis]));
        if level < low - MIN_LENGTH_MM || level > high + MIN_LENGTH_MM {
            return None;
        }
        let along = other_axis(axis);
        let Some((center, _)) = self.arc else {
            let way = self.to[axis] - self.from[axis];
            let part = if way.abs() > MIN_LENGTH_MM { (level - self.from[axis]) / way } else { 0.0 };
            return Some(self.from[along] + part * (self.to[along] - self.from[along]));
        };
        let radius = (self.from[axis] - center[axis]).hypot(self.from[along] - center[along]);
        let half = (radius * radius - (level - center[axis]).powi(2)).max(0.0).sqrt();
        let (first, second) = (self.from[along].min(self.to[along]), self.from[along].max(self.to[along]));
        // The arc is monotone: only one of the two points lies between the ends.
        let outside = |place: f64| (first - place).max(place - second).max(0.0);
        let [near, far] = [center[along] - half, center[along] + half];
        Some(if outside(near) <= outside(far) { near } else { far })
    }
}

fn axis_set(axes: &[Axis]) -> AxisSet {
    axes.iter().fold(AxisSet::NONE, |set, axis| set.with(AxisSet::of(*axis)))
}

pub(super) fn rapid_to(to: WorkPos, axes: &[Axis]) -> Op {
    Op::Rapid { to, feed: None, words: axis_set(axes), incremental: AxisSet::NONE }
}

pub(super) fn feed_to(to: WorkPos, feed: Feed, axes: &[Axis]) -> Op {
    Op::Feed { to, feed, words: axis_set(axes), incremental: AxisSet::NONE }
}

pub(super) const fn other_axis(axis: Axis) -> Axis {
    match axis {
        Axis::X => Axis::Z,
        Axis::Y | Axis::Z => Axis::X,
    }
}

/// Returns from the end of the contour to the start: first away from the part, then along it.
pub(super) fn return_to_start(ops: &mut Vec<Op>, start: WorkPos, across: Axis) {
    let Some(end) = ops.iter().rev().find_map(end_point) else { return };
    let mut out = end;
    out[across] = start[across];
    ops.push(rapid_to(out, &[across]));
    ops.push(rapid_to(start, &[other_axis(across)]));
}

/// Where a move ends.
pub(super) fn end_point(op: &Op) -> Option<WorkPos> {
    match op.effect() {
        OpEffect::Motion(OpMotion::Work(by)) => Some(by.to),
        _ => None,
    }
}
