//! The centre of an arc by radius or by offsets. Source: spec B2, S1.

use crate::units::{Plane, WorkPos};

/// Shorter chords and radii count as zero, mm.
const MIN_LENGTH_MM: f64 = 1e-9;

/// The centre of an arc by its radius; a negative radius is the major arc. `None` if no such arc reaches the end. The
/// radius of a half circle may be too small by `tolerance_mm`, the rounding of the text.
pub(super) fn centre_by_radius(
    (from, to): (WorkPos, WorkPos),
    plane: Plane,
    turn: i8,
    radius: f64,
    tolerance_mm: f64,
) -> Option<WorkPos> {
    let (first, second) = plane.axes();
    let (a, b) = (to[first] - from[first], to[second] - from[second]);
    let chord = a.hypot(b);
    let half = chord / 2.0;
    if chord <= MIN_LENGTH_MM || radius.abs() <= f64::EPSILON || radius.abs() + tolerance_mm < half {
        return None;
    }
    let height = (radius * radius - half * half).max(0.0).sqrt();
    // The centre is to the left of the chord for a counter-clockwise minor arc. A negative R is the major arc.
    let side = f64::from(turn) * radius.signum();
    let mut center = from;
    center[first] = (from[first] + to[first]) / 2.0 - side * height * b / chord;
    center[second] = (from[second] + to[second]) / 2.0 + side * height * a / chord;
    Some(center)
}

/// The radius of an arc around a centre, and the distance of its end from the circle, mm.
pub(super) fn radius_and_end_error((from, to): (WorkPos, WorkPos), center: WorkPos, plane: Plane) -> (f64, f64) {
    let (first, second) = plane.axes();
    let radius = |point: WorkPos| (point[first] - center[first]).hypot(point[second] - center[second]);
    let (start, end) = (radius(from), radius(to));
    (start, (start - end).abs())
}
