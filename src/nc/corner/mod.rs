//! Corners and angles of lines: `,C` `,R` `,A`, and CHF, CHR, RND, RNDM, ANG of SINUMERIK.
//!
//! A line or arc with a corner waits until the move behind it is read; then its end, the chamfer or rounding, and the
//! start of the next move are known. Lengths are radius millimetres in work coordinates. Source: spec B2, S1.

mod reading;
mod stage;

pub(super) use stage::CornerStage;

use super::op::{AxisSet, Op};
use super::op_effect::{OpEffect, OpMotion, WorkMove};
use crate::defs::program_error::ProgramError as E;
use crate::geometry::{Corner, CornerMistake, PlanePoint, PlaneSegment};
use crate::units::{Plane, WorkPos};

/// Moves across the plane of a corner, and lengths, below this are none, mm.
const MIN_LENGTH_MM: f64 = 1e-7;
/// Sine of the angle below which two lines do not meet.
const PARALLEL_SINE: f64 = 1e-6;

/// What a block asks of the end of its line or arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CornerWords {
    /// The chamfer or rounding.
    pub corner: Option<Corner>,
    /// The angle of a line without an end, radian: the next block gives the end.
    pub open_angle: Option<f64>,
    /// The angle of a line with an end, radian: the line before it is open.
    pub end_angle: Option<f64>,
    /// RNDM: where no move follows, or the rounding does not fit, there is none.
    pub is_modal: bool,
    /// Where the move begins.
    pub from: WorkPos,
    /// The plane.
    pub plane: Plane,
    /// The byte of the word, and its name.
    pub at: usize,
    pub name: &'static str,
}

impl CornerWords {
    /// Ends the move `op` of these words where its corner to `next` begins, and returns the corner and its end. `next`
    /// has words of its own if it also has a corner.
    ///
    /// # Errors
    /// The mistake of the corner; nothing was changed.
    pub fn join(&self, op: &mut Op, next: &Op, next_words: Option<&Self>) -> Result<Option<(Op, WorkPos)>, E> {
        let (mut first, second) = (self.path_of(op)?, self.path_of(next)?);
        if let Some(angle) = self.open_angle {
            let end_angle = next_words.and_then(|words| words.end_angle).ok_or(E::AngleWithoutEnd)?;
            first.to = self.meeting_point((first.to, angle), (second.to, end_angle))?;
        } else if next_words.is_some_and(|words| words.end_angle.is_some()) {
            return Err(E::AngleWithEnd);
        }
        let corner = self.corner.map_or(Ok(None), |corner| {
            let (one, other) = (self.segment(self.from, &first)?, self.segment(first.to, &second)?);
            corner.between(&one, &other).map_err(|mistake| match mistake {
                CornerMistake::DoesNotFit => E::CornerDoesNotFit,
                CornerMistake::ChamferAtArc => E::ChamferAtArc,
            })
        })?;
        let place = |point: PlanePoint| self.place(point, first.to);
        let end = corner.map_or(first.to, |joint| place(joint.at(0.0)));
        if let Op::Feed { to, words, .. } | Op::Arc { to, words, .. } = op {
            *to = end;
            if self.open_angle.is_some() {
                let (first, second) = self.plane.axes();
                *words = AxisSet::of(first).with(AxisSet::of(second));
            }
        }
        Ok(corner.and_then(|joint| {
            let (to, feed) = (place(joint.at(1.0)), first.feed?);
            let (words, incremental) = self.corner_axes(&first);
            let op = match joint {
                PlaneSegment::Line { .. } => Op::Feed { to, feed, words, incremental },
                PlaneSegment::Arc { center, sweep, .. } => {
                    let (center, turn) = (place(center), if sweep > 0.0 { 1 } else { -1 });
                    Op::Arc { to, center, plane: self.plane, turn, feed, words, incremental }
                }
            };
            Some((op, to))
        }))
    }

    /// The line or arc of an operation at feed.
    fn path_of(&self, op: &Op) -> Result<WorkMove, E> {
        let no_move = if self.open_angle.is_some() { E::AngleWithoutEnd } else { E::CornerWithoutMove };
        match op.effect() {
            OpEffect::Motion(OpMotion::Work(by)) if !by.rapid && by.skip_signal.is_none() => Ok(by),
            _ => Err(no_move),
        }
    }

    /// The segment of a move in the plane. A move across the plane has none.
    fn segment(&self, from: WorkPos, by: &WorkMove) -> Result<PlaneSegment, E> {
        let normal = self.plane.normal_axis();
        let (start, end) = (self.point(from), self.point(by.to));
        let segment = match by.arc {
            None => Some(PlaneSegment::line(start, end)),
            Some(arc) => PlaneSegment::arc(start, end, self.point(arc.center), arc.turn > 0),
        };
        let stays = (by.to[normal] - from[normal]).abs() <= MIN_LENGTH_MM;
        segment.filter(|segment| stays && segment.length() > MIN_LENGTH_MM).ok_or(E::CornerWithoutMove)
    }

    /// Where a line from the start of this move meets the line that ends at a place; each has its angle.
    fn meeting_point(&self, (beside, angle): (WorkPos, f64), (end, end_angle): (WorkPos, f64)) -> Result<WorkPos, E> {
        let (start, end) = (self.point(self.from), self.point(end));
        let direction = |angle: f64| [angle.cos(), angle.sin()];
        let (a, b) = (direction(angle), direction(end_angle));
        let sine = a[0] * b[1] - a[1] * b[0];
        if sine.abs() < PARALLEL_SINE {
            return Err(E::LinesParallel);
        }
        let way = ((end[0] - start[0]) * b[1] - (end[1] - start[1]) * b[0]) / sine;
        Ok(self.place([start[0] + way * a[0], start[1] + way * a[1]], beside))
    }

    fn point(&self, position: WorkPos) -> PlanePoint {
        let (first, second) = self.plane.axes();
        [position[first], position[second]]
    }

    /// A position in the plane; outside of it as `beside`.
    fn place(&self, point: PlanePoint, beside: WorkPos) -> WorkPos {
        let ((first, second), mut to) = (self.plane.axes(), beside);
        (to[first], to[second]) = (point[0], point[1]);
        to
    }

    /// The axes that a corner names, and those that keep what the operator has moved by hand (K6.3): as in the move
    /// before it.
    fn corner_axes(&self, first: &WorkMove) -> (AxisSet, AxisSet) {
        let (one, other) = self.plane.axes();
        let both = AxisSet::of(one).with(AxisSet::of(other));
        let mut incremental = first.incremental;
        both.iter().filter(|axis| !first.words.contains(*axis)).for_each(|axis| incremental.insert(axis));
        (both, incremental)
    }
}
