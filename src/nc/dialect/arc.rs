//! The centre of an arc, however it is written. Source: spec B2, S1.

use crate::nc::op::Plane;
use crate::units::PerAxis;

/// Below this a chord or a radius is none, mm.
const NOTHING_MM: f64 = 1e-9;

/// The centre of an arc by its radius: below zero the major arc. `None` if no such arc reaches the end; a half circle may
/// miss its radius by `tolerance_mm`, the rounding of the text.
pub(super) fn centre_by_radius(
    (from, to): (PerAxis<f64>, PerAxis<f64>),
    plane: Plane,
    turn: i8,
    radius: f64,
    tolerance_mm: f64,
) -> Option<PerAxis<f64>> {
    let (first, second) = plane.axes();
    let (a, b) = (to[first] - from[first], to[second] - from[second]);
    let chord = a.hypot(b);
    let half = chord / 2.0;
    if chord <= NOTHING_MM || radius.abs() <= f64::EPSILON || radius.abs() + tolerance_mm < half {
        return None;
    }
    let height = (radius * radius - half * half).max(0.0).sqrt();
    // The centre lies to the left of the way for a counter-clockwise minor arc; R below zero is the major arc.
    let side = f64::from(turn) * radius.signum();
    let mut center = from;
    center[first] = (from[first] + to[first]) / 2.0 - side * height * b / chord;
    center[second] = (from[second] + to[second]) / 2.0 + side * height * a / chord;
    Some(center)
}

/// The radius of an arc about a centre, and how far its end lies off the circle, mm.
pub(super) fn radius_and_miss(
    (from, to): (PerAxis<f64>, PerAxis<f64>),
    center: PerAxis<f64>,
    plane: Plane,
) -> (f64, f64) {
    let (first, second) = plane.axes();
    let radius = |point: PerAxis<f64>| (point[first] - center[first]).hypot(point[second] - center[second]);
    let (start, end) = (radius(from), radius(to));
    (start, (start - end).abs())
}
