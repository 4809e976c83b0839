//! Where an arc goes: what the soft limits have to look at besides its end. Source: spec B5.

use crate::units::{Axis, PerAxis};

/// Whether an arc passes a point of its circle.
pub fn passes(
    from: PerAxis<f64>,
    to: PerAxis<f64>,
    center: PerAxis<f64>,
    (first, second): (Axis, Axis),
    ccw: bool,
    point: PerAxis<f64>,
) -> bool {
    let angle = |at: PerAxis<f64>| (at[second] - center[second]).atan2(at[first] - center[first]);
    let sense = if ccw { 1.0 } else { -1.0 };
    let swept = |to: f64| (sense * (to - angle(from))).rem_euclid(std::f64::consts::TAU);
    let whole = swept(angle(to));
    whole < 1e-9 || swept(angle(point)) < whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b5_an_arc_is_checked_where_it_bulges() {
        // From angle 0 (Z+) counter-clockwise to 180°: it passes the summit at X+, not the one at X−.
        let center = PerAxis([0.0, 0.0, 0.0]);
        let (from, to) = (PerAxis([0.0, 0.0, 10.0]), PerAxis([0.0, 0.0, -10.0]));
        let plane = (Axis::Z, Axis::X);
        let (up, down) = (PerAxis([10.0, 0.0, 0.0]), PerAxis([-10.0, 0.0, 0.0]));
        assert!(passes(from, to, center, plane, true, up) && !passes(from, to, center, plane, true, down));
        assert!(passes(from, to, center, plane, false, down) && !passes(from, to, center, plane, false, up));
        assert!(passes(from, from, center, plane, true, down), "a full circle passes everything");
    }
}
