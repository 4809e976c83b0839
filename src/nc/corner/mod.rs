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

/// The angle of a line, radian, from the first axis of the plane (Z in ZX), counter-clockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum LineAngle {
    /// None, or it has given the other coordinate.
    #[default]
    None,
    /// The line has no end: the next block gives it.
    Open(f64),
    /// The line has an end: it meets the open line before it.
    End(f64),
}

/// A word of a corner: its byte, and its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CornerWord {
    pub at: usize,
    pub name: &'static str,
}

/// What a block asks of the end of its line or arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CornerWords {
    /// The chamfer or rounding, and its word.
    pub corner: Option<Corner>,
    pub corner_word: CornerWord,
    /// The angle of the line, and its word.
    pub angle: LineAngle,
    pub angle_word: CornerWord,
    /// The rounding is that of RNDM: where no move follows, or it does not fit, there is none.
    pub is_modal: bool,
    /// Where the move begins.
    pub from: WorkPos,
    /// The plane.
    pub plane: Plane,
}

impl CornerWords {
    /// The same words of a move that begins elsewhere, because the corner before it ends there.
    pub fn beginning_at(self, from: WorkPos) -> Self {
        let angle = if matches!(self.angle, LineAngle::End(_)) { LineAngle::None } else { self.angle };
        Self { from, angle, ..self }
    }

    /// Whether the end of the move hangs on the move behind it.
    pub fn is_open(&self) -> bool {
        self.corner.is_some() || matches!(self.angle, LineAngle::Open(_))
    }

    /// Whether the move can do without the one behind it.
    pub fn is_optional(&self) -> bool {
        self.is_modal && !matches!(self.angle, LineAngle::Open(_))
    }

    /// The word that a mistake is about.
    pub fn word_of(&self, mistake: E) -> CornerWord {
        match mistake {
            E::AngleWithoutEnd | E::AngleWithEnd | E::LinesParallel | E::AngleAway => self.angle_word,
            _ => self.corner_word,
        }
    }

    /// Ends the move `op` of these words where its corner to `next` begins; returns the corner, and where `next` begins.
    /// `next` has words of its own if it also has a corner.
    ///
    /// # Errors
    /// The mistake of the corner; nothing was changed.
    pub fn join(&self, op: &mut Op, next: &Op, next_words: Option<&Self>) -> Result<(Option<Op>, WorkPos), E> {
        let (mut first, second) = (self.path_of(op)?, self.path_of(next)?);
        match (self.angle, next_words.map_or(LineAngle::None, |words| words.angle)) {
            (LineAngle::Open(angle), LineAngle::End(end_angle)) => {
                first.to = self.meeting_point((first.to, angle), (second.to, end_angle))?;
            }
            (LineAngle::Open(_), _) => return Err(E::AngleWithoutEnd),
            (_, LineAngle::End(_)) => return Err(E::AngleWithEnd),
            (_, LineAngle::Open(_)) => return Err(E::CornerBeforeAngle),
            (_, LineAngle::None) => {}
        }
        let corner = self.corner.map_or(Ok(None), |corner| {
            // What is left of the first one, if the corner before it has taken from it.
            let one = self.segment(self.from, &first)?.ok_or(E::CornerDoesNotFit)?;
            let other = self.segment(first.to, &second)?.ok_or(E::CornerWithoutMove)?;
            corner.between(&one, &other).map_err(|mistake| match mistake {
                CornerMistake::DoesNotFit => E::CornerDoesNotFit,
                CornerMistake::ChamferAtArc => E::ChamferAtArc,
            })
        });
        let corner = if self.is_modal { corner.unwrap_or_default() } else { corner? };
        let place = |point: PlanePoint| self.place(point, first.to);
        if let Op::Feed { to, words, .. } | Op::Arc { to, words, .. } = op {
            *to = corner.map_or(first.to, |joint| place(joint.at(0.0)));
            if matches!(self.angle, LineAngle::Open(_)) {
                *words = self.plane_axes();
            }
        }
        let (Some(joint), Some(feed)) = (corner, first.feed) else { return Ok((None, first.to)) };
        let to = place(joint.at(1.0));
        let (words, incremental) = self.corner_axes(&first);
        let op = match joint {
            PlaneSegment::Line { .. } => Op::Feed { to, feed, words, incremental },
            PlaneSegment::Arc { center, sweep, .. } => {
                let (center, turn) = (place(center), if sweep > 0.0 { 1 } else { -1 });
                Op::Arc { to, center, plane: self.plane, turn, feed, words, incremental }
            }
        };
        Ok((Some(op), to))
    }

    /// The mistake if no line or arc follows.
    pub fn without_move(&self) -> E {
        if matches!(self.angle, LineAngle::Open(_)) { E::AngleWithoutEnd } else { E::CornerWithoutMove }
    }

    /// The line or arc of an operation at feed.
    fn path_of(&self, op: &Op) -> Result<WorkMove, E> {
        match op.effect() {
            OpEffect::Motion(OpMotion::Work(by)) if !by.rapid && by.skip_signal.is_none() => Ok(by),
            _ => Err(self.without_move()),
        }
    }

    /// The segment of a move in the plane, if it has a length. A move across the plane has none.
    fn segment(&self, from: WorkPos, by: &WorkMove) -> Result<Option<PlaneSegment>, E> {
        let normal = self.plane.normal_axis();
        let (start, end) = (self.point(from), self.point(by.to));
        let segment = match by.arc {
            None => Some(PlaneSegment::line(start, end)),
            Some(arc) => PlaneSegment::arc(start, end, self.point(arc.center), arc.turn > 0),
        };
        let in_plane = (by.to[normal] - from[normal]).abs() <= MIN_LENGTH_MM;
        let segment = segment.filter(|_| in_plane).ok_or(E::CornerWithoutMove)?;
        Ok(Some(segment).filter(|segment| segment.length() > MIN_LENGTH_MM))
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
        let to_end = [end[0] - start[0], end[1] - start[1]];
        let way = (to_end[0] * b[1] - to_end[1] * b[0]) / sine;
        let rest = (to_end[1] * a[0] - to_end[0] * a[1]) / sine;
        if way.min(rest) < -MIN_LENGTH_MM {
            return Err(E::AngleAway);
        }
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

    fn plane_axes(&self) -> AxisSet {
        let (one, other) = self.plane.axes();
        AxisSet::of(one).with(AxisSet::of(other))
    }

    /// The axes that a corner names, and those that keep what the operator has moved by hand (K6.3): as in the move
    /// before it.
    fn corner_axes(&self, first: &WorkMove) -> (AxisSet, AxisSet) {
        let both = self.plane_axes();
        let mut incremental = first.incremental;
        both.iter().filter(|axis| !first.words.contains(*axis)).for_each(|axis| incremental.insert(axis));
        (both, incremental)
    }
}
