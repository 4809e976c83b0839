//! Cutter radius compensation of a program: G41, G42 and G40.
//!
//! The blocks between G41 (or G42) and G40 wait here until the path of the cutter's centre beside their contour is known;
//! then they are returned with its moves. The first move after G41 leads to the contour, the first one after G40 away
//! from it. What must be executed before the next block is read cannot stand between the two.
//! Lengths are radius millimetres in work coordinates. Source: spec B2 (G40 G41 G42).

mod reading;
mod release;

use std::collections::VecDeque;

use super::block::{Block, BlockPlace};
use super::cutter::Compensation;
use super::fault::{BlockLocation, E, ErrorAt, ProgramFault};
use super::modal::ModalState;
use super::op::Op;
use super::op_effect::{OpEffect, OpMotion, WorkMove};
use crate::defs::program_number;
use crate::defs::text::arg::Arg;
use crate::geometry::{CutterPath, Gouge, GougeCause, OuterCorner, PlanePoint, PlaneSegment};
use crate::units::{Axis, PerAxis, Plane, WorkPos};

/// Segments of a contour that are known before the cutter enters the one before them.
pub const LOOK_AHEAD: usize = 100;
/// Segments of a contour that can be named: those ahead of the cutter and as many behind it.
const RECENT_SEGMENTS: usize = 256;
/// Operations of a block for which memory is taken at once.
const USUAL_BLOCK_OPS: usize = 4;
/// Most blocks that wait: those of the segments ahead, and those without a move between them.
const MAX_WAITING: usize = 400;
/// Moves shorter than this in the plane do not move the cutter along the contour, mm: a thousandth of the finest
/// increment.
pub(super) const MIN_LENGTH_MM: f64 = 1e-7;

/// What an operation of a waiting block is for the cutter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MoveRole {
    /// Nothing: it is returned as it is.
    None,
    /// A move across the contour's plane, or none: beside the contour it stays where it is in the plane.
    Across,
    /// The line to the contour.
    LeadIn,
    /// The segment of the contour with this number.
    Contour(usize),
    /// The line from the contour to the programmed point.
    LeadOut,
}

/// A block that waits for what follows it.
#[derive(Clone, Debug)]
struct WaitingBlock {
    place: BlockPlace,
    modals: ModalState,
    complete: bool,
    ops: Vec<(Op, MoveRole)>,
}

/// The cutter beside a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ActiveCutter {
    pub compensation: Compensation,
    pub plane: Plane,
}

impl ActiveCutter {
    /// The coordinates of a position in the plane.
    pub fn point(&self, position: WorkPos) -> PlanePoint {
        let (first, second) = self.plane.axes();
        [position[first], position[second]]
    }

    /// The centre when the programmed point is at a position.
    pub fn center(&self, position: WorkPos) -> PlanePoint {
        let ((first, second), cutter, tip) = (self.plane.axes(), self.compensation.cutter, self.point(position));
        [tip[0] - cutter.tip_from_center(first), tip[1] - cutter.tip_from_center(second)]
    }

    /// The position of the programmed point when the centre is at a place; outside the plane as `beside`.
    pub fn tip(&self, center: PlanePoint, beside: WorkPos) -> WorkPos {
        let ((first, second), cutter, mut to) = (self.plane.axes(), self.compensation.cutter, beside);
        to[first] = center[0] + cutter.tip_from_center(first);
        to[second] = center[1] + cutter.tip_from_center(second);
        to
    }
}

/// The mistake of a contour that a cutter does not fit.
pub(super) const fn gouge_error(cause: GougeCause) -> E {
    match cause {
        GougeCause::ArcTooSmall => E::ArcBelowCutter,
        GougeCause::SegmentTooShort => E::SegmentBelowCutter,
        GougeCause::Interference => E::CutterGouge,
    }
}

/// How far the contour is read.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ContourState {
    /// There is none, or it has been returned.
    None,
    /// From the lead-in on.
    Open(ActiveCutter),
    /// Its end is read; blocks of it may wait to be returned.
    Ended(ActiveCutter),
}

/// The mistake at which reading ended.
#[derive(Debug)]
struct ContourFault {
    fault: ProgramFault,
    /// The block that showed it was read; else the program still stands before it.
    block_read: bool,
}

/// The blocks between G41 and G40.
#[derive(Debug)]
pub(super) struct BlockCompensation {
    contour: ContourState,
    /// The end of the last block read, as programmed.
    programmed: WorkPos,
    /// The end of the last move returned.
    returned: WorkPos,
    /// How far the operator has moved the axes by hand since the blocks were read (K6.3).
    shift: PerAxis<f64>,
    path: CutterPath,
    /// Segments of the contour read so far.
    segments: usize,
    /// Program and line of the last segments, at their numbers modulo the length.
    lines: [(u32, u32); RECENT_SEGMENTS],
    waiting: VecDeque<WaitingBlock>,
    spare: Vec<WaitingBlock>,
    /// The mistake at which reading ended; every further call returns it.
    fault: Option<ContourFault>,
}

/// Why a block is refused, and which.
#[derive(Debug)]
pub(super) struct CompensationRefusal {
    pub location: BlockLocation,
    pub wrong: ErrorAt,
}

impl BlockCompensation {
    pub fn new(modals: &ModalState) -> Self {
        Self {
            contour: ContourState::None,
            programmed: WorkPos::default(),
            returned: WorkPos::default(),
            shift: PerAxis::default(),
            path: CutterPath::with_look_ahead(LOOK_AHEAD),
            segments: 0,
            lines: [(0, 0); RECENT_SEGMENTS],
            waiting: VecDeque::with_capacity(MAX_WAITING),
            spare: (0..MAX_WAITING).map(|_| WaitingBlock::new(modals)).collect(),
            fault: None,
        }
    }

    /// Forgets everything: another program begins.
    pub fn reset(&mut self) {
        (self.contour, self.fault, self.segments) = (ContourState::None, None, 0);
        self.shift = PerAxis::default();
        while let Some(block) = self.waiting.pop_front() {
            self.keep(block);
        }
    }

    /// Goes on behind a mistake without compensation: the blocks that wait are returned as programmed. True: the block that
    /// showed a mistake of the contour was read.
    pub fn abandon(&mut self) -> bool {
        self.contour = ContourState::None;
        self.waiting.iter_mut().flat_map(|block| &mut block.ops).for_each(|(_, role)| *role = MoveRole::None);
        self.fault.take().is_some_and(|ended| ended.block_read)
    }

    /// Whether the cutter is beside a contour whose blocks are being read.
    #[inline]
    pub const fn is_open(&self) -> bool {
        matches!(self.contour, ContourState::Open(_))
    }

    /// Whether a contour is open, has ended with a mistake, or waits to be returned.
    #[inline]
    pub fn is_idle(&self) -> bool {
        !self.is_open() && self.waiting.is_empty() && self.fault.is_none()
    }

    /// Whether blocks wait here.
    #[inline]
    pub fn has_blocks(&self) -> bool {
        !self.waiting.is_empty()
    }

    fn keep(&mut self, mut block: WaitingBlock) {
        block.ops.clear();
        self.spare.push(block);
    }

    /// Refuses a block that changes side, radius or plane beside a contour.
    fn check_unchanged(&self, modals: &ModalState, place: BlockPlace) -> Result<(), CompensationRefusal> {
        match self.contour {
            ContourState::Open(active)
                if modals.compensation.is_some_and(|wanted| wanted != active.compensation)
                    || modals.plane != active.plane =>
            {
                Err(place.refusal(E::CompensationChange, active.compensation.g()))
            }
            ContourState::Open(_) | ContourState::None | ContourState::Ended(_) => Ok(()),
        }
    }

    /// Takes the operations of a block. `from` is the position before it.
    fn accept(&mut self, block: &mut Block, from: WorkPos, place: BlockPlace) -> Result<(), CompensationRefusal> {
        if !self.is_open() {
            self.programmed = from;
        }
        let mut taken = self.spare.pop().unwrap_or_else(|| WaitingBlock::new(&block.modals));
        (taken.place, taken.modals, taken.complete) = (place, block.modals, block.complete);
        let mut accepted = Ok(());
        if let ContourState::Open(active) = self.contour {
            let is_cycle = block.is_cycle || block.modals.motion.is_cycle();
            if is_cycle || self.waiting.len() >= MAX_WAITING {
                let error = if is_cycle { E::NotInCompensation } else { E::CompensationWaits };
                accepted = Err(place.refusal(error, active.compensation.g()));
            }
        }
        for mut op in block.ops.drain(..) {
            let role = match &accepted {
                Ok(()) if !block.is_cycle => self.role_of(&mut op, &taken.modals, place),
                Ok(()) | Err(_) => Ok(MoveRole::None),
            };
            let role = role.unwrap_or_else(|refusal| {
                accepted = Err(refusal);
                MoveRole::None
            });
            taken.ops.push((op, role));
        }
        self.waiting.push_back(taken);
        accepted
    }

    /// What an operation is for the cutter; appends its segment to the contour.
    fn role_of(
        &mut self,
        op: &mut Op,
        modals: &ModalState,
        place: BlockPlace,
    ) -> Result<MoveRole, CompensationRefusal> {
        let motion = match op.effect() {
            OpEffect::Motion(OpMotion::Work(by)) if by.skip_signal.is_none() => Some(by),
            _ => None,
        };
        let ContourState::Open(active) = self.contour else {
            return match (motion, modals.compensation) {
                (Some(by), Some(wanted)) if wanted.cutter.radius_mm > 0.0 => {
                    self.lead_in(&by, ActiveCutter { compensation: wanted, plane: modals.plane }, place)
                }
                _ => Ok(MoveRole::None),
            };
        };
        let Some(by) = motion else { return self.other_op(op, active, modals, place) };
        let from = std::mem::replace(&mut self.programmed, by.to);
        let (start, end) = (active.point(from), active.point(by.to));
        let is_across = by.arc.is_none() && is_short(start, end);
        if is_across && (modals.compensation.is_some() || !names_plane(&by, active.plane)) {
            return Ok(MoveRole::Across);
        }
        if modals.compensation.is_none() {
            return self.lead_out(&by, active, place);
        }
        let normal = active.plane.normal_axis();
        if by.arc.is_some() && (by.to[normal] - from[normal]).abs() > MIN_LENGTH_MM {
            // A helix beside a contour would have to be divided with its corners.
            return Err(place.refusal(E::NotInCompensation, active.compensation.g()));
        }
        let segment = match by.arc {
            None => Some(PlaneSegment::line(start, end)),
            Some(arc) => PlaneSegment::arc(start, end, active.point(arc.center), arc.turn > 0),
        };
        let Some(segment) = segment else { return Err(place.refusal(E::ArcRadius, active.compensation.g())) };
        if segment.length() <= MIN_LENGTH_MM {
            return Ok(MoveRole::Across);
        }
        let number = self.segments;
        self.segments += 1;
        self.lines[number % RECENT_SEGMENTS] = (place.location.program, place.location.line);
        let corner = if by.rapid { OuterCorner::Square } else { OuterCorner::Round };
        self.path.push(number, &segment, corner).map_err(|gouge| self.gouge(gouge, active, place))?;
        Ok(MoveRole::Contour(number))
    }

    /// The first move after G41: the line to the contour.
    fn lead_in(
        &mut self,
        by: &WorkMove,
        wanted: ActiveCutter,
        place: BlockPlace,
    ) -> Result<MoveRole, CompensationRefusal> {
        let compensation = wanted.compensation;
        let (start, end) = (wanted.point(self.programmed), wanted.point(by.to));
        if by.arc.is_some() {
            return Err(place.refusal(E::CompensationLead, compensation.g()));
        }
        let before = std::mem::replace(&mut self.programmed, by.to);
        if is_short(start, end) {
            return Ok(MoveRole::None);
        }
        self.path.begin(compensation.side, compensation.cutter.radius_mm, Some(wanted.center(before)));
        (self.contour, self.segments) = (ContourState::Open(wanted), 0);
        (self.returned, self.shift) = (before, PerAxis::default());
        Ok(MoveRole::LeadIn)
    }

    /// The first move after G40: the line from the contour to the programmed point.
    fn lead_out(
        &mut self,
        by: &WorkMove,
        active: ActiveCutter,
        place: BlockPlace,
    ) -> Result<MoveRole, CompensationRefusal> {
        if by.arc.is_some() {
            return Err(place.refusal(E::CompensationLead, 40));
        }
        self.end_contour(Some(active.center(by.to)), place)?;
        Ok(MoveRole::LeadOut)
    }

    /// Ends the contour.
    fn end_contour(&mut self, lead_to: Option<PlanePoint>, place: BlockPlace) -> Result<(), CompensationRefusal> {
        let ContourState::Open(active) = self.contour else { return Ok(()) };
        self.contour = ContourState::Ended(active);
        if self.segments == 0 {
            return Err(place.refusal(E::CompensationWithoutContour, active.compensation.g()));
        }
        self.path.end(self.segments, lead_to).map_err(|gouge| self.gouge(gouge, active, place))
    }

    /// An operation that does not move the cutter.
    fn other_op(
        &mut self,
        op: &mut Op,
        active: ActiveCutter,
        modals: &ModalState,
        place: BlockPlace,
    ) -> Result<MoveRole, CompensationRefusal> {
        if op.may_stand_in_contour() {
            return Ok(MoveRole::None);
        }
        let ends_program = matches!(op, Op::M { code: 2 | 30, .. });
        if modals.compensation.is_some() && !ends_program {
            return Err(place.refusal(E::NotInCompensation, active.compensation.g()));
        }
        // Behind G40, or at the end of the program, nothing of the contour follows.
        self.end_contour(None, place)?;
        self.correct_start(op, active);
        Ok(MoveRole::None)
    }

    /// A move behind G40 that does not lead out (G28, G30, G31) was read from the programmed point; it begins at the end
    /// of the path: what it does not name, or names as a distance, counts from there.
    fn correct_start(&self, op: &mut Op, active: ActiveCutter) {
        let (Op::ReturnToReference { via: to, words, incremental, .. } | Op::Skip { to, words, incremental, .. }) = op
        else {
            return;
        };
        let Some(center) = self.path.end_point() else { return };
        let end = active.tip(center, self.programmed);
        for axis in Axis::ALL.into_iter().filter(|axis| !words.contains(*axis) || incremental.contains(*axis)) {
            to[axis] += end[axis] - self.programmed[axis];
        }
    }

    /// The operator has moved the axes by hand in a hold (K6.3).
    pub fn shift_by_hand(&mut self, by: PerAxis<f64>) {
        if self.has_blocks() {
            self.shift = PerAxis::from_fn(|axis| self.shift[axis] + by[axis]);
        }
    }

    /// The mistake of a contour that the cutter gouges.
    fn gouge(
        &self,
        Gouge { segment, other, cause }: Gouge,
        active: ActiveCutter,
        place: BlockPlace,
    ) -> CompensationRefusal {
        let block_of = |role: MoveRole| {
            let has = |block: &&WaitingBlock| block.ops.iter().any(|(_, of)| *of == role);
            self.waiting.iter().find(has)
        };
        // A segment does not gouge itself: the lead-in crosses it.
        let is_lead_in = segment == other && cause == GougeCause::Interference;
        let segment = if is_lead_in { MoveRole::LeadIn } else { MoveRole::Contour(segment) };
        let radius = Arg::from(format_args!("{:.3}", active.compensation.cutter.radius_mm));
        let BlockPlace { location, at } = block_of(segment).map_or(place, |block| block.place);
        let (program, line) = self.lines[other % RECENT_SEGMENTS];
        let other = match program == location.program {
            true => Arg::from(format_args!("{line}")),
            false => Arg::from(format_args!("{line} ({})", program_number::name_of(program))),
        };
        CompensationRefusal { location, wrong: ErrorAt { at, error: gouge_error(cause), details: [radius, other] } }
    }
}

fn is_short(from: PlanePoint, to: PlanePoint) -> bool {
    (to[0] - from[0]).hypot(to[1] - from[1]) <= MIN_LENGTH_MM
}

/// Whether a move names an axis of a plane.
fn names_plane(by: &WorkMove, plane: Plane) -> bool {
    let (first, second) = plane.axes();
    by.words.contains(first) || by.words.contains(second)
}

impl WaitingBlock {
    fn new(modals: &ModalState) -> Self {
        let ops = Vec::with_capacity(USUAL_BLOCK_OPS);
        Self { place: BlockPlace::default(), modals: *modals, complete: true, ops }
    }
}

impl BlockPlace {
    /// Refuses the block; the detail is a G code.
    fn refusal(self, error: E, g: u8) -> CompensationRefusal {
        let details = [Arg::from(format_args!("G{g}")), Arg::None];
        CompensationRefusal { location: self.location, wrong: ErrorAt { at: self.at, error, details } }
    }
}
