//! Cycles over a contour in the program: roughing in strokes, pattern repeating, finishing.
//! Works on the operations of the contour's blocks, in work coordinates, radius mm; does not read text.
//! Source: spec B2 (G70–G73).

use std::sync::Arc;

use super::block::Block;
use super::contour_compensation::{ContourCutter, ContourMistake, offset_segments};
use super::contour_return::{is_return_free, return_axis};
use super::contour_segment::{ContourSegment, MIN_LENGTH_MM, other_axis, rapid_to, return_to_start};
use super::flow::{Flow, Place};
use super::op::{Feed, Op};
use super::op_effect::{OpEffect, OpMotion, WorkMove};
use super::roughing::{PocketMemory, RoughingCycle};
use super::source::Source;
use crate::defs::program_error::ProgramError as E;
use crate::defs::text::arg::Arg;
use crate::geometry::CutterPath;
use crate::units::{Axis, PerAxis, WorkPos};

/// Most blocks of a contour.
pub(super) const MAX_CONTOUR_BLOCKS: usize = 500;

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

/// Memory for reading contours.
pub(crate) struct ContourMemory {
    /// The position in the program before the contour.
    pub flow: Flow,
    pub block: Block,
    /// The operations of the contour's blocks, each with the line of its block (from 1).
    pub ops: Vec<(Op, u32)>,
    /// Program and byte of the contour's first block.
    pub place: (u32, usize),
    /// The contour that was roughed last, and along which axis the infeeds were.
    roughed: Option<((u32, usize), Axis)>,
    /// The cutter that runs beside the contour.
    pub cutter: Option<ContourCutter>,
    segments: Vec<ContourSegment>,
    path: CutterPath,
    pockets: PocketMemory,
}

impl ContourMemory {
    pub fn new(flow: Flow, block: Block) -> Self {
        let (ops, segments) = (Vec::with_capacity(MAX_CONTOUR_BLOCKS), Vec::with_capacity(MAX_CONTOUR_BLOCKS));
        let path = CutterPath::with_look_ahead(MAX_CONTOUR_BLOCKS);
        let (place, roughed, pockets) = ((0, 0), None, PocketMemory::default());
        Self { flow, block, ops, place, roughed, cutter: None, segments, path, pockets }
    }

    /// Forgets the program before: another one begins.
    pub fn begin(&mut self, source: Arc<Source>) {
        self.flow.begin(source);
        self.roughed = None;
    }

    /// Appends the operations of the cycle from a starting point to `ops`.
    ///
    /// # Errors
    /// The mistake in the contour; `ops` may hold a part of the cycle then.
    pub fn expand(&mut self, cycle: &ContourCycle, start: WorkPos, ops: &mut Vec<Op>) -> Result<(), ContourMistake> {
        let wrong = |error: E| (error, Default::default());
        let is_finish = matches!(cycle.kind, CycleKind::Finish);
        let is_roughing = matches!(cycle.kind, CycleKind::Roughing { .. });
        self.read_segments(start).map_err(wrong)?;
        let Some(first) = self.segments.first().copied() else { return Err(wrong(E::ContourEmpty)) };
        let has_pockets = self.names_both_axes();
        if let CycleKind::Roughing { infeed, .. } = cycle.kind
            && !has_pockets
            && (first.to[other_axis(infeed)] - start[other_axis(infeed)]).abs() > MIN_LENGTH_MM
        {
            return Err(wrong(E::ContourStart));
        }
        let Self { ops: contour, segments, path, .. } = self;
        let line = |source: usize| contour.get(source).map_or(0, |(_, line)| *line);
        if let Some(cutter) = self.cutter {
            offset_segments(segments, cutter, path, line)?;
        }
        let segments = &self.segments;
        let first_axis = if (first.to[Axis::X] - start[Axis::X]).abs() > MIN_LENGTH_MM { Axis::X } else { Axis::Z };
        let roughed = self.roughed.filter(|(place, _)| is_finish && *place == self.place);
        let across = roughed.map_or_else(|| return_axis(segments, first_axis), |(_, infeed)| infeed);
        if !is_roughing && !is_return_free(segments, start, across) {
            return Err(wrong(E::ContourReturn));
        }
        match cycle.kind {
            CycleKind::Finish => {
                self.push_finishing_pass(ops);
                return_to_start(ops, start, across);
            }
            CycleKind::Roughing { infeed, depth, escape, feed } => {
                let leads_out = self.cutter.is_some_and(|cutter| cutter.leads_out);
                RoughingCycle { infeed, depth, escape, feed, start, allowance: cycle.allowance, has_pockets }
                    .expand(segments, leads_out, &mut self.pockets, ops)
                    .map_err(|(error, of)| {
                        (error, [of.map_or(Arg::None, |of| Arg::from(line(of.source))), Arg::None])
                    })?;
                self.roughed = Some((self.place, infeed));
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

    /// Whether the first move of the contour names X and Z: FANUC's type II of G71 and G72, with pockets.
    fn names_both_axes(&self) -> bool {
        let first = self.ops.iter().find_map(|(op, _)| contour_move(op).ok().flatten());
        first.is_some_and(|by| by.words.contains(Axis::X) && by.words.contains(Axis::Z))
    }

    /// The operations of the blocks, with the offset moves if a cutter runs beside the contour.
    fn push_finishing_pass(&self, ops: &mut Vec<Op>) {
        for (source, (op, _)) in self.ops.iter().enumerate() {
            let feed = match contour_move(op) {
                Ok(Some(by)) if self.cutter.is_some() => by.feed,
                Ok(_) | Err(_) => {
                    ops.push(op.clone());
                    continue;
                }
            };
            for segment in self.segments.iter().filter(|segment| segment.source == source) {
                ops.push(segment.to_op(PerAxis::default(), feed.unwrap_or(Feed::PerMinute(0.0))));
            }
        }
    }

    /// The lines and arcs of the contour, which begins at `start`.
    fn read_segments(&mut self, start: WorkPos) -> Result<(), E> {
        let mut from = start;
        self.segments.clear();
        for (source, (op, _)) in self.ops.iter().enumerate() {
            let Some(by) = contour_move(op)? else { continue };
            let arc = by.arc.map(|arc| (arc.center, arc.turn));
            self.segments.push(ContourSegment { from, to: by.to, arc, rapid: by.rapid, source });
            from = by.to;
        }
        Ok(())
    }
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
