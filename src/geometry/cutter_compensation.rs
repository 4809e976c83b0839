//! Cutter radius compensation: the path of a cutter's centre beside a contour, and where the cutter would gouge it.
//!
//! The cutter is a circle. Its centre runs parallel to each segment. At an outer corner it rolls around the corner on an
//! arc, so that the corner stays sharp; at an inner corner the two parallels end where they cross. [`CutterPath`] takes a
//! contour segment by segment and keeps back so many that it sees what comes: nowhere is the centre nearer than the
//! radius to a segment of this stretch. Where it would be, the contour is refused, with the segments concerned.
//! Source: G41 and G42 of ISO 6983; corners as in LinuxCNC and FANUC type C.

use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_2, PI};

use super::plane_segment::{MIN_LENGTH_MM, PlanePoint, PlaneSegment, along, cross, distance};

/// Ends of parallels that are nearer than this are one point, mm: a thousandth of the finest increment.
const JOINED_MM: f64 = 1e-6;
/// The cutter may come nearer than its radius by this much, mm: rounding.
const NEARER_MM: f64 = 1e-6;

/// A turn this near to half a turn is a reversal, radians: rounding of directions.
const REVERSAL: f64 = 1e-9;

/// Pieces of the path that an inner corner may take away, and segments that it may leave out: parts of a straight
/// side of the contour, which turns by less than [`SAME_SIDE`] between them.
const MOST_LEFT_OUT: usize = 64;
/// Radians: a straight side that is divided into parts of 1 mm whose ends are rounded to 1 µm, twice.
const SAME_SIDE: f64 = 2e-3;

/// How the path goes around an outer corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OuterCorner {
    /// On an arc around the corner.
    Round,
    /// Along the tangents of that arc: for moves that cannot follow an arc.
    Square,
}

/// The side of the contour on which the cutter runs, seen in the direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompensationSide {
    /// G41.
    Left,
    /// G42.
    Right,
}

/// A segment of the path of the cutter's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompensatedSegment {
    /// Index of the contour's segment that it belongs to; the arc around a corner belongs to the segment after it.
    pub source: usize,
    /// The segment.
    pub path: PlaneSegment,
}

/// Why a cutter does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GougeCause {
    /// The radius of a hollow arc is not greater than that of the cutter.
    ArcTooSmall,
    /// At an inner corner the parallels do not cross: a segment is too short.
    SegmentTooShort,
    /// The cutter would cut into a segment that is not its neighbour, or into the end of its neighbour.
    Interference,
}

/// The place where a cutter does not fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gouge {
    /// Index of the segment that the cutter follows.
    pub segment: usize,
    /// Index of the segment that it would cut into.
    pub other: usize,
    /// The cause.
    pub cause: GougeCause,
}

/// A segment of the contour, with the rectangle around all that is nearer to it than the cutter's radius.
#[derive(Clone, Copy, Debug)]
struct ContourPart {
    source: usize,
    segment: PlaneSegment,
    around: [PlanePoint; 2],
}

/// What a piece of the path may not come near to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PathRole {
    /// Beside the contour: nearer than the radius to no segment.
    Beside,
    /// From the start to the contour, or from the contour to the end: the segment that it leads to or comes from is only
    /// not crossed, as the cutter touches its end.
    Lead,
}

/// A piece of the path, with the rectangle around it.
#[derive(Clone, Copy, Debug)]
struct PathPart {
    compensated: CompensatedSegment,
    role: PathRole,
    around: [PlanePoint; 2],
    /// Segments of the contour that came after it.
    seen: usize,
}

/// The path of a cutter's centre beside a contour that comes segment by segment.
///
/// The path begins and ends square to the contour, unless a lead-in or lead-out is given. A segment of the path is final
/// when the contour is known for `look_ahead` segments after it, or to its end.
#[derive(Clone, Debug)]
pub struct CutterPath {
    to_the_left: f64,
    look_ahead: usize,
    /// Where a lead-in begins.
    lead_from: Option<PlanePoint>,
    contour: VecDeque<ContourPart>,
    path: VecDeque<PathPart>,
    /// The last of `path` may still be cut at the next corner.
    open: bool,
    /// Segments since the last of `path` that are too short for an inner corner, and the mistake if none behind them fits.
    left_out: usize,
    corner_missed: Option<Gouge>,
    ended: bool,
}

impl CutterPath {
    /// Memory for `look_ahead` segments after each; no cutter yet.
    #[must_use]
    pub fn with_look_ahead(look_ahead: usize) -> Self {
        let memory = look_ahead.min(4_096);
        Self {
            to_the_left: 0.0,
            look_ahead,
            lead_from: None,
            contour: VecDeque::with_capacity(2 * memory + 2),
            path: VecDeque::with_capacity(2 * memory + 4),
            open: false,
            left_out: 0,
            corner_missed: None,
            ended: false,
        }
    }

    /// Begins a contour, in the same memory. With `lead_from`, a lead-in line runs from this point of the centre to the
    /// begin of the path; its source is that of the first segment. `radius` in mm.
    ///
    /// # Panics
    /// When the radius is not positive and finite: a bug of the caller.
    pub fn begin(&mut self, side: CompensationSide, radius: f64, lead_from: Option<PlanePoint>) {
        assert!(radius.is_finite() && radius > 0.0, "cutter radius {radius}");
        self.to_the_left = if side == CompensationSide::Left { radius } else { -radius };
        self.lead_from = lead_from;
        self.contour.clear();
        self.path.clear();
        (self.open, self.left_out, self.ended) = (false, 0, false);
    }

    const fn radius(&self) -> f64 {
        self.to_the_left.abs()
    }

    /// Appends a segment; it begins where the last one ends. One without length is left out.
    ///
    /// # Errors
    /// [`Gouge`]: the cutter does not fit. The path is of no use any more.
    pub fn push(&mut self, source: usize, segment: &PlaneSegment, corner: OuterCorner) -> Result<(), Gouge> {
        if segment.length() <= MIN_LENGTH_MM {
            return Ok(());
        }
        let too_small = Gouge { segment: source, other: source, cause: GougeCause::ArcTooSmall };
        let mut parallel = segment.parallel(self.to_the_left).ok_or(too_small)?;
        let around = grown(segment.bounds(), self.radius());
        let before = self.contour.back().copied();
        self.contour.push_back(ContourPart { source, segment: *segment, around });
        let first_open = self.path.len().saturating_sub(usize::from(self.open));
        self.path.iter_mut().for_each(|part| part.seen += 1);
        if let Some(before) = before {
            match self.join(&before, (source, segment), parallel, corner)? {
                Some(joined) => parallel = joined,
                // What it comes near to is looked at when the corner is cut.
                None => return Ok(()),
            }
        } else if let Some(from) = self.lead_from.take() {
            let lead = PlaneSegment::line(from, parallel.at(0.0));
            self.append(CompensatedSegment { source, path: lead }, PathRole::Lead);
        }
        let last = self.contour.len() - 1;
        let unchecked = last - std::mem::take(&mut self.left_out).min(last);
        // An inner corner may have taken pieces away.
        let first_open = first_open.min(self.path.len().saturating_sub(1));
        // What was final already meets the new segment; what has become final meets all.
        (0..first_open).try_for_each(|part| self.check(part, unchecked..last + 1))?;
        (first_open..self.path.len()).try_for_each(|part| self.check(part, 0..last + 1))?;
        self.append(CompensatedSegment { source, path: parallel }, PathRole::Beside);
        self.open = true;
        self.forget();
        Ok(())
    }

    /// Ends the contour. With `lead_to`, a lead-out line runs from the end of the path to this point of the centre; its
    /// source is `source`.
    ///
    /// # Errors
    /// As [`Self::push`].
    pub fn end(&mut self, source: usize, lead_to: Option<PlanePoint>) -> Result<(), Gouge> {
        self.ended = true;
        if let (1.., Some(missed)) = (self.left_out, self.corner_missed) {
            return Err(missed);
        }
        let first_open = self.path.len().saturating_sub(usize::from(self.open));
        if let (Some(to), Some(last)) = (lead_to, self.path.back()) {
            let lead = PlaneSegment::line(last.compensated.path.at(1.0), to);
            self.append(CompensatedSegment { source, path: lead }, PathRole::Lead);
        }
        self.open = false;
        (first_open..self.path.len()).try_for_each(|part| self.check(part, 0..self.contour.len()))
    }

    /// The next segment of the path, if it is final.
    pub fn next_final(&self) -> Option<&CompensatedSegment> {
        let first = self.path.front().filter(|part| self.ended || part.seen > self.look_ahead)?;
        (self.path.len() > usize::from(self.open)).then_some(&first.compensated)
    }

    /// The end of the path so far.
    #[must_use]
    pub fn end_point(&self) -> Option<PlanePoint> {
        self.path.back().map(|last| last.compensated.path.at(1.0))
    }

    /// Takes the next segment of the path, if it is final.
    pub fn take(&mut self) -> Option<CompensatedSegment> {
        let next = *self.next_final()?;
        self.path.pop_front();
        Some(next)
    }

    fn append(&mut self, compensated: CompensatedSegment, role: PathRole) {
        let around = compensated.path.bounds();
        self.path.push_back(PathPart { compensated, role, around, seen: 0 });
    }

    /// Joins the path to the parallel of the next segment; returns the latter from the corner on. `None`: the segment is
    /// too short for an inner corner and is left out, if those behind it go on in its direction.
    fn join(
        &mut self,
        before: &ContourPart,
        (source, segment): (usize, &PlaneSegment),
        parallel: PlaneSegment,
        corner: OuterCorner,
    ) -> Result<Option<PlaneSegment>, Gouge> {
        let Some(end) = self.path.back().map(|last| last.compensated.path.at(1.0)) else { return Ok(Some(parallel)) };
        if self.left_out == 0 && distance(end, parallel.at(0.0)) <= JOINED_MM {
            return Ok(Some(parallel));
        }
        let turn = turn_between(&before.segment, segment);
        let is_inner = turn * self.to_the_left > 0.0 && turn.abs() < PI - REVERSAL;
        if self.left_out > 0 || is_inner {
            let mut too_short = Gouge { segment: before.source, other: source, cause: GougeCause::SegmentTooShort };
            match self.corner_missed {
                Some(missed) if self.left_out > 0 => too_short = missed,
                Some(_) | None => self.corner_missed = Some(too_short),
            }
            if self.left_out > 0 && !is_same_side(&before.segment, segment) {
                return Err(too_short);
            }
            if let Some(joined) = self.cut_inner_corner(&parallel) {
                return Ok(Some(joined));
            }
            self.left_out += 1;
            return if self.left_out > MOST_LEFT_OUT { Err(too_short) } else { Ok(None) };
        }
        let around = segment.at(0.0);
        let start = (end[1] - around[1]).atan2(end[0] - around[0]);
        // A reversal is rounded on the side of the cutter.
        let sweep = -turn.abs() * self.to_the_left.signum();
        let arc = PlaneSegment::Arc { center: around, radius: self.radius(), start, sweep };
        if corner == OuterCorner::Round {
            self.append(CompensatedSegment { source, path: arc }, PathRole::Beside);
            return Ok(Some(parallel));
        }
        let way = self.radius() * (sweep.abs().min(FRAC_PI_2) / 2.0).tan();
        let mut from = end;
        for to in
            [along(end, arc.direction(0.0), way), along(parallel.at(0.0), arc.direction(1.0), -way), parallel.at(0.0)]
        {
            if distance(from, to) > JOINED_MM {
                self.append(CompensatedSegment { source, path: PlaneSegment::line(from, to) }, PathRole::Beside);
                from = to;
            }
        }
        Ok(Some(parallel))
    }

    /// Ends the path where it crosses the next parallel, and returns that from there on. Pieces at its end that go on in
    /// one direction are taken away if only the one before them crosses.
    fn cut_inner_corner(&mut self, parallel: &PlaneSegment) -> Option<PlaneSegment> {
        for left in 0..=MOST_LEFT_OUT {
            let index = self.path.len().checked_sub(left + 1)?;
            let piece = self.path.get(index).filter(|piece| piece.role == PathRole::Beside)?;
            if let Some((on_last, on_next)) = inner_crossing(&piece.compensated.path, parallel) {
                self.path.truncate(index + 1);
                let last = self.path.back_mut()?;
                last.compensated.path = last.compensated.path.part(0.0, on_last);
                last.around = last.compensated.path.bounds();
                return Some(parallel.part(on_next, 1.0));
            }
            let before = self.path.get(index.checked_sub(1)?)?;
            if !is_same_side(&before.compensated.path, &piece.compensated.path) {
                return None;
            }
        }
        None
    }

    /// Checks that a piece of the path keeps its distance from some segments of the contour.
    fn check(&self, part: usize, others: std::ops::Range<usize>) -> Result<(), Gouge> {
        let Some(PathPart { compensated, role, around, .. }) = self.path.get(part) else { return Ok(()) };
        for other in self.contour.range(others).filter(|other| overlap(around, &other.around)) {
            // A lead belongs to the first segment, a lead-out follows the last one.
            let is_neighbour = other.source == compensated.source
                || self.ended && self.contour.back().is_some_and(|last| last.source == other.source);
            let nearest = match role {
                PathRole::Lead if is_neighbour => NEARER_MM,
                PathRole::Beside | PathRole::Lead => self.radius(),
            };
            if compensated.path.distance_between(&other.segment) < nearest - NEARER_MM / 2.0 {
                return Err(Gouge {
                    segment: compensated.source,
                    other: other.source,
                    cause: GougeCause::Interference,
                });
            }
        }
        Ok(())
    }

    /// Forgets what is too far behind to be gouged.
    fn forget(&mut self) {
        let kept = self.path.front().map_or(0, |part| part.seen).saturating_add(self.look_ahead).saturating_add(1);
        while self.contour.len() > kept {
            self.contour.pop_front();
        }
    }
}

/// Writes the path of the cutter's centre beside a whole contour to `path`, whose content is replaced.
///
/// `radius` in mm. Segments without length are left out. The path begins and ends square to the ends of the contour, so a
/// closed contour must begin within a side, not in an inner corner. The work grows with the square of the number of
/// segments.
///
/// # Errors
/// [`Gouge`] at the first place where the cutter does not fit; `path` is empty then.
///
/// # Panics
/// When the radius is not positive and finite: a bug of the caller.
pub fn compensate(
    contour: &[PlaneSegment],
    side: CompensationSide,
    radius: f64,
    path: &mut Vec<CompensatedSegment>,
) -> Result<(), Gouge> {
    path.clear();
    let mut cutter = CutterPath::with_look_ahead(contour.len());
    cutter.begin(side, radius, None);
    contour.iter().enumerate().try_for_each(|(source, segment)| cutter.push(source, segment, OuterCorner::Round))?;
    cutter.end(contour.len(), None)?;
    path.extend(std::iter::from_fn(|| cutter.take()));
    Ok(())
}

/// Whether a line goes on in the direction of the line before it.
fn is_same_side(first: &PlaneSegment, second: &PlaneSegment) -> bool {
    let lines = matches!((first, second), (PlaneSegment::Line { .. }, PlaneSegment::Line { .. }));
    lines && turn_between(first, second).abs() <= SAME_SIDE
}

/// The turn from the end of one segment to the start of the next, radians; counter-clockwise positive.
fn turn_between(first: &PlaneSegment, second: &PlaneSegment) -> f64 {
    let [into, out_of] = [first.direction(1.0), second.direction(0.0)];
    cross(into, out_of).atan2(into[0] * out_of[0] + into[1] * out_of[1])
}

/// Fractions of two parallels at an inner corner at which they cross; of two crossings the one that removes less.
fn inner_crossing(last: &PlaneSegment, next: &PlaneSegment) -> Option<(f64, f64)> {
    let removed = |(on_last, on_next): &(f64, f64)| (1.0 - on_last) * last.length() + on_next * next.length();
    last.crossings(next).into_iter().flatten().min_by(|a, b| removed(a).total_cmp(&removed(b)))
}

/// A rectangle with a margin.
fn grown([low, high]: [PlanePoint; 2], by: f64) -> [PlanePoint; 2] {
    [[low[0] - by, low[1] - by], [high[0] + by, high[1] + by]]
}

fn overlap([low, high]: &[PlanePoint; 2], [other_low, other_high]: &[PlanePoint; 2]) -> bool {
    (0..2).all(|axis| low[axis] <= other_high[axis] && other_low[axis] <= high[axis])
}
