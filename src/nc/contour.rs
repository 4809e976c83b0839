//! Cycles over a contour in the program: roughing in strokes, pattern repeating, finishing.
//! Works on the operations of the contour's blocks, in work coordinates, radius mm; does not read text.
//! Source: spec B2 (G70–G73).

use super::block::Block;
use super::flow::{Flow, Place};
use super::op::{AxisSet, Feed, Op};
use super::op_effect::{OpEffect, OpMotion, WorkMove};
use crate::defs::program_error::ProgramError as E;
use crate::units::{Axis, PerAxis, WorkPos};

/// Most blocks of a contour.
pub(super) const MAX_CONTOUR_BLOCKS: usize = 500;
/// Most strokes of one cycle.
const MAX_STROKES: usize = 2_000;
/// Shorter distances count as zero, mm; far below the resolution.
const MIN_LENGTH_MM: f64 = 1e-7;

/// A cycle as programmed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ContourCycle {
    /// N of the contour's first and last block.
    pub first_block: u32,
    pub last_block: u32,
    /// The byte of the cycle's G code, for mistakes in its contour.
    pub at: usize,
    /// Finishing allowance: the contour is shifted by it. Radius mm.
    pub allowance: PerAxis<f64>,
    pub kind: CycleKind,
}

/// A cycle whose contour is not read yet, and the start of its own block.
#[derive(Debug)]
pub(crate) struct PendingCycle {
    pub cycle: ContourCycle,
    pub block_start: Place,
}

/// The kind of cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CycleKind {
    /// G70: one pass with the feeds of the contour's blocks.
    Finish,
    /// G71 (infeed X), G72 (infeed Z): strokes along the other axis, `depth` mm each, then one pass along the contour.
    Roughing { infeed: Axis, depth: f64, escape: f64, feed: Feed },
    /// G73: `passes` passes along the contour; the first is shifted by `shift`, the last is not.
    Pattern { shift: PerAxis<f64>, passes: u32, feed: Feed },
}

/// One line or arc of the contour.
#[derive(Clone, Copy, Debug)]
struct ContourSegment {
    from: WorkPos,
    to: WorkPos,
    /// Centre of an arc, and its turn (−1 or 1).
    arc: Option<(WorkPos, i8)>,
    rapid: bool,
}

/// Memory for reading contours.
pub(crate) struct ContourMemory {
    /// The position in the program before the contour.
    pub flow: Flow,
    pub block: Block,
    /// The operations of the contour's blocks.
    pub ops: Vec<Op>,
    segments: Vec<ContourSegment>,
}

impl ContourMemory {
    pub fn new(flow: Flow, block: Block) -> Self {
        let (ops, segments) = (Vec::with_capacity(MAX_CONTOUR_BLOCKS), Vec::with_capacity(MAX_CONTOUR_BLOCKS));
        Self { flow, block, ops, segments }
    }

    /// Appends the operations of the cycle from a starting point to `ops`.
    ///
    /// # Errors
    /// The mistake in the contour; `ops` may hold a part of the cycle then.
    pub fn expand(&mut self, cycle: &ContourCycle, start: WorkPos, ops: &mut Vec<Op>) -> Result<(), E> {
        self.read_segments(start)?;
        let segments = &self.segments;
        let Some(first) = segments.first() else { return Err(E::ContourEmpty) };
        // The axis that approaches the contour first also retracts first.
        let across = if (first.to[Axis::X] - start[Axis::X]).abs() > MIN_LENGTH_MM { Axis::X } else { Axis::Z };
        match cycle.kind {
            CycleKind::Finish => {
                ops.extend_from_slice(&self.ops);
                return_to_start(ops, start, across);
            }
            CycleKind::Roughing { infeed, depth, escape, feed } => {
                RoughingCycle { infeed, depth, escape, feed, start, allowance: cycle.allowance }
                    .expand(segments, ops)?;
            }
            CycleKind::Pattern { shift, passes, feed } => {
                for pass in 0..passes {
                    let part = if passes > 1 { f64::from(passes - 1 - pass) / f64::from(passes - 1) } else { 0.0 };
                    let by = PerAxis::from_fn(|axis| cycle.allowance[axis] + part * shift[axis]);
                    let begin = start + by;
                    ops.push(rapid_to(begin, &[Axis::X, Axis::Z]));
                    segments.iter().for_each(|segment| ops.push(segment.to_op(by, feed)));
                    return_to_start(ops, begin, across);
                }
                ops.push(rapid_to(start, &[Axis::X, Axis::Z]));
            }
        }
        Ok(())
    }

    /// The lines and arcs of the contour, which begins at `start`.
    fn read_segments(&mut self, start: WorkPos) -> Result<(), E> {
        let mut from = start;
        self.segments.clear();
        for op in &self.ops {
            let Some(by) = contour_move(op)? else { continue };
            let arc = by.arc.map(|arc| (arc.center, arc.turn));
            self.segments.push(ContourSegment { from, to: by.to, arc, rapid: by.rapid });
            from = by.to;
        }
        Ok(())
    }
}

fn axis_set(axes: &[Axis]) -> AxisSet {
    axes.iter().fold(AxisSet::NONE, |set, axis| set.with(AxisSet::of(*axis)))
}

fn rapid_to(to: WorkPos, axes: &[Axis]) -> Op {
    Op::Rapid { to, feed: None, words: axis_set(axes), incremental: AxisSet::NONE }
}

fn feed_to(to: WorkPos, feed: Feed, axes: &[Axis]) -> Op {
    Op::Feed { to, feed, words: axis_set(axes), incremental: AxisSet::NONE }
}

const fn other_axis(axis: Axis) -> Axis {
    match axis {
        Axis::X => Axis::Z,
        Axis::Y | Axis::Z => Axis::X,
    }
}

/// Returns from the end of the contour to the start: first away from the part, then along it.
fn return_to_start(ops: &mut Vec<Op>, start: WorkPos, across: Axis) {
    let Some(end) = ops.iter().rev().find_map(end_point) else { return };
    let mut out = end;
    out[across] = start[across];
    ops.push(rapid_to(out, &[across]));
    ops.push(rapid_to(start, &[other_axis(across)]));
}

fn end_point(op: &Op) -> Option<WorkPos> {
    contour_move(op).ok().flatten().map(|by| by.to)
}

/// The move of an operation of a contour. Speed and path mode have none: they act in the finishing pass only.
///
/// # Errors
/// The operation must not be in a contour.
pub(crate) fn contour_move(op: &Op) -> Result<Option<WorkMove>, E> {
    match op.effect() {
        OpEffect::Motion(OpMotion::Work(by)) if by.skip_signal.is_none() => Ok(Some(by)),
        OpEffect::Speed(..) | OpEffect::PathMode(_) => Ok(None),
        OpEffect::Motion(_) | OpEffect::Coordinates(_) | OpEffect::IndexTurret { .. } => Err(E::ContourCode),
        OpEffect::Oscillation(_) | OpEffect::Dwell(_) | OpEffect::SpeedLimit(_) => Err(E::ContourCode),
        OpEffect::MCode(_) | OpEffect::Variable(..) | OpEffect::SystemVariable(..) => Err(E::ContourCode),
        OpEffect::Message(_) => Err(E::ContourCode),
    }
}

impl ContourSegment {
    /// The segment shifted by `by`.
    fn shifted(&self, by: PerAxis<f64>) -> Self {
        let arc = self.arc.map(|(center, turn)| (center + by, turn));
        Self { from: self.from + by, to: self.to + by, arc, rapid: self.rapid }
    }

    /// The segment shifted by `by`, as an operation with the cycle's feed.
    fn to_op(self, by: PerAxis<f64>, feed: Feed) -> Op {
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
    fn is_monotone(&self, way: PerAxis<f64>) -> bool {
        let goes = |axis: Axis| (self.to[axis] - self.from[axis]) * way[axis] >= -MIN_LENGTH_MM;
        goes(Axis::X) && goes(Axis::Z) && !self.passes_extreme()
    }

    /// Whether an arc passes an extreme of an axis between its ends.
    fn passes_extreme(&self) -> bool {
        let Some((center, turn)) = self.arc else { return false };
        // Angles with Z to the right and X up; counter-clockwise is positive.
        let angle = |at: WorkPos| (at[Axis::X] - center[Axis::X]).atan2(at[Axis::Z] - center[Axis::Z]);
        let sense = f64::from(turn);
        let swept = |to: f64| (sense * (to - angle(self.from))).rem_euclid(std::f64::consts::TAU);
        let whole = swept(angle(self.to));
        (0..4).any(|quarter| {
            let at = swept(f64::from(quarter) * std::f64::consts::FRAC_PI_2);
            at > 1e-6 && at < whole - 1e-6
        })
    }

    /// The coordinate on the other axis where the segment crosses `level` of an axis.
    fn crossing_at(&self, axis: Axis, level: f64) -> Option<f64> {
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

/// The roughing cycles G71 and G72.
struct RoughingCycle {
    infeed: Axis,
    depth: f64,
    escape: f64,
    feed: Feed,
    start: WorkPos,
    allowance: PerAxis<f64>,
}

/// One stroke of a roughing cycle.
struct RoughingStroke {
    /// Coordinate of the infeed axis.
    level: f64,
    /// Where it meets the contour, or the end of the contour.
    end: f64,
    /// Signs of the infeed and of the cut.
    down: f64,
    along: f64,
    /// The infeed is at rapid speed.
    rapid_infeed: bool,
}

impl RoughingCycle {
    fn expand(&self, segments: &[ContourSegment], ops: &mut Vec<Op>) -> Result<(), E> {
        let (a, b) = (self.infeed, other_axis(self.infeed));
        let [first, rest @ ..] = segments else { return Err(E::ContourEmpty) };
        let (Some(last), at) = (rest.last(), first.to) else { return Err(E::ContourEmpty) };
        if (at[b] - self.start[b]).abs() > MIN_LENGTH_MM {
            return Err(E::ContourStart);
        }
        let way = |from: WorkPos, to: WorkPos, axis: Axis| {
            let way = to[axis] - from[axis];
            if way.abs() > MIN_LENGTH_MM { way.signum() } else { 0.0 }
        };
        let (down, along) = (way(self.start, at, a), way(at, last.to, b));
        if down == 0.0 || along == 0.0 {
            return Err(E::ContourStart);
        }
        let mut allowed = PerAxis::default();
        allowed[a] = -down;
        allowed[b] = along;
        if !rest.iter().all(|segment| segment.is_monotone(allowed)) {
            return Err(E::ContourNotMonotone);
        }
        let bottom = at[a] + self.allowance[a];
        for stroke in 1..=MAX_STROKES {
            let level = self.start[a] + down * self.depth * stroke as f64;
            if (bottom - level) * down <= MIN_LENGTH_MM {
                break;
            }
            if stroke == MAX_STROKES {
                return Err(E::ContourStrokes);
            }
            let meets = rest.iter().find_map(|segment| segment.shifted(self.allowance).crossing_at(a, level));
            let end = meets.unwrap_or(last.to[b] + self.allowance[b]);
            self.push_stroke(ops, &RoughingStroke { level, end, down, along, rapid_infeed: first.rapid });
        }
        self.push_contour_pass(ops, first.rapid, bottom, rest);
        Ok(())
    }

    /// One stroke: infeed to a level, along it, retract at 45°, return.
    fn push_stroke(&self, ops: &mut Vec<Op>, stroke: &RoughingStroke) {
        let &RoughingStroke { level, end, down, along, rapid_infeed } = stroke;
        let (a, b) = (self.infeed, other_axis(self.infeed));
        if (end - self.start[b]) * along <= MIN_LENGTH_MM {
            return;
        }
        let mut at = self.start;
        at[a] = level;
        ops.push(if rapid_infeed { rapid_to(at, &[a]) } else { feed_to(at, self.feed, &[a]) });
        at[b] = end;
        ops.push(feed_to(at, self.feed, &[b]));
        // The retract must not pass the start in either axis.
        let room = ((level - self.start[a]) * down).min((end - self.start[b]) * along);
        let escape = self.escape.min(room.max(0.0));
        at[a] -= down * escape;
        at[b] -= along * escape;
        ops.push(feed_to(at, self.feed, &[a, b]));
        at[b] = self.start[b];
        ops.push(rapid_to(at, &[b]));
    }

    /// One pass along the contour with its allowance, and return to the start.
    fn push_contour_pass(&self, ops: &mut Vec<Op>, rapid_infeed: bool, bottom: f64, rest: &[ContourSegment]) {
        let (a, b) = (self.infeed, other_axis(self.infeed));
        let mut at = self.start;
        at[b] += self.allowance[b];
        ops.push(rapid_to(at, &[a, b]));
        at[a] = bottom;
        ops.push(if rapid_infeed { rapid_to(at, &[a]) } else { feed_to(at, self.feed, &[a]) });
        rest.iter().for_each(|segment| ops.push(segment.to_op(self.allowance, self.feed)));
        return_to_start(ops, self.start, a);
    }
}
