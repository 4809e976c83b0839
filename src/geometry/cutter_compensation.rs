//! Cutter radius compensation: the path of a cutter's centre beside a contour, and where the cutter would gouge it.
//!
//! The cutter is a circle. Its centre runs parallel to each segment. At an outer corner it rolls around the corner on an
//! arc, so that the corner stays sharp; at an inner corner the two parallels end where they cross. The result is compared
//! with the whole contour: nowhere is the centre nearer than the radius. Where it would be, the contour is refused, with
//! the segments concerned. Source: G41 and G42 of ISO 6983; corners as in LinuxCNC and FANUC type C.

use std::f64::consts::PI;

use super::plane_segment::{MIN_LENGTH_MM, PlaneSegment, cross, distance};

/// Ends of parallels that are nearer than this are one point, mm: a thousandth of the finest increment.
const JOINED_MM: f64 = 1e-6;
/// The cutter may come nearer than its radius by this much, mm: rounding.
const NEARER_MM: f64 = 1e-6;

/// A turn this near to half a turn is a reversal, radians: rounding of directions.
const REVERSAL: f64 = 1e-9;

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

/// Writes the path of the cutter's centre beside a connected contour to `path`, whose content is replaced.
///
/// `radius` in mm. Segments without length are left out. The path begins and ends square to the ends of the contour, so a
/// closed contour must begin within a side, not in an inner corner. The caller hands in the whole contour from G41 to G40:
/// the paths of its parts would not join. The work grows with the square of the number of segments.
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
    assert!(radius.is_finite() && radius > 0.0, "cutter radius {radius}");
    path.clear();
    let result = append_parallels(contour, side, radius, path).and_then(|()| check_distance(contour, radius, path));
    if result.is_err() {
        path.clear();
    }
    result
}

fn append_parallels(
    contour: &[PlaneSegment],
    side: CompensationSide,
    radius: f64,
    path: &mut Vec<CompensatedSegment>,
) -> Result<(), Gouge> {
    let to_the_left = if side == CompensationSide::Left { radius } else { -radius };
    let mut before: Option<(usize, &PlaneSegment)> = None;
    for (source, segment) in contour.iter().enumerate().filter(|(_, segment)| segment.length() > MIN_LENGTH_MM) {
        let too_small = Gouge { segment: source, other: source, cause: GougeCause::ArcTooSmall };
        let mut parallel = segment.parallel(to_the_left).ok_or(too_small)?;
        if let (Some(last), Some((previous, before))) = (path.last_mut(), before)
            && distance(last.path.at(1.0), parallel.at(0.0)) > JOINED_MM
        {
            let [into, out_of] = [before.direction(1.0), segment.direction(0.0)];
            let turn = cross(into, out_of).atan2(into[0] * out_of[0] + into[1] * out_of[1]);
            if turn * to_the_left > 0.0 && turn.abs() < PI - REVERSAL {
                let too_short = Gouge { segment: previous, other: source, cause: GougeCause::SegmentTooShort };
                let (on_last, on_next) = inner_crossing(&last.path, &parallel).ok_or(too_short)?;
                last.path = last.path.part(0.0, on_last);
                parallel = parallel.part(on_next, 1.0);
            } else {
                let [from, corner] = [last.path.at(1.0), segment.at(0.0)];
                let start = (from[1] - corner[1]).atan2(from[0] - corner[0]);
                // A reversal is rounded on the side of the cutter.
                let sweep = -turn.abs() * to_the_left.signum();
                let path_around = PlaneSegment::Arc { center: corner, radius, start, sweep };
                path.push(CompensatedSegment { source, path: path_around });
            }
        }
        path.push(CompensatedSegment { source, path: parallel });
        before = Some((source, segment));
    }
    Ok(())
}

/// Fractions of two parallels at an inner corner at which they cross; of two crossings the one that removes less.
fn inner_crossing(last: &PlaneSegment, next: &PlaneSegment) -> Option<(f64, f64)> {
    let removed = |(on_last, on_next): &(f64, f64)| (1.0 - on_last) * last.length() + on_next * next.length();
    last.crossings(next).into_iter().flatten().min_by(|a, b| removed(a).total_cmp(&removed(b)))
}

/// Checks that the path is nowhere nearer to the contour than the radius.
fn check_distance(contour: &[PlaneSegment], radius: f64, path: &[CompensatedSegment]) -> Result<(), Gouge> {
    for part in path {
        for (other, segment) in contour.iter().enumerate() {
            if part.path.distance_between(segment) < radius - NEARER_MM {
                return Err(Gouge { segment: part.source, other, cause: GougeCause::Interference });
            }
        }
    }
    Ok(())
}
