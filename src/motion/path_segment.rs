//! The programmed contour: lines and arcs, parametrised by the distance along them.
//!
//! The geometry of a single move; knows nothing of speed. The length of an arc is measured along its mean radius and
//! includes the third axis of a helix.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::{ArcDirection, AxisLimits, MotionLimits, MoveShape, dot, per_coordinate};
use crate::units::{Axis, MachinePos};

/// Shares of the axis limits on an arc, so that the vectors of acceleration and jerk stay below 1 in every direction.
/// Acceleration: 0.7 normal and 0.7 tangential, √(0.7² + 0.7²) = 0.99. Jerk: 0.4 + 0.3 (curvature) tangential and
/// 0.7 normal, the same.
const ARC_SHARE: f64 = 0.7;
const ARC_JERK_TANGENTIAL: f64 = 0.4;
const ARC_JERK_CURVATURE: f64 = 0.3;
/// A move shorter than this has no length, mm.
pub const MIN_LENGTH_MM: f64 = 1e-9;

/// Maximum number of reversal points of an arc.
const QUARTERS: usize = 4;

#[derive(Clone, Copy, Debug)]
enum SegmentForm {
    Line,
    Arc { center: [f64; 2], axes: [usize; 3], radius: [f64; 2], angle: f64, sweep: f64 },
}

/// One line or arc between two points.
#[derive(Clone, Copy, Debug)]
pub struct PathSegment {
    from: [f64; 3],
    to: [f64; 3],
    form: SegmentForm,
    length: f64,
    /// Unit direction vectors at the start and at the end.
    directions: [[f64; 3]; 2],
}

impl PathSegment {
    /// The contour of a move that starts at `from`.
    #[must_use]
    pub fn new(from: [f64; 3], to: MachinePos, shape: MoveShape) -> Self {
        let to = to.coordinates();
        let chord = distance(from, to);
        match shape {
            MoveShape::Line => Self::with_directions(from, to, SegmentForm::Line, chord),
            MoveShape::Arc { center, plane, direction: turn } => {
                let (first, second) = plane.axes();
                let axes = [first, second, plane.normal_axis()].map(|axis: Axis| axis as usize);
                let center = [center[first], center[second]];
                let polar = |p: [f64; 3]| {
                    let (x, y) = (p[axes[0]] - center[0], p[axes[1]] - center[1]);
                    (x.hypot(y), y.atan2(x))
                };
                let ((r0, a0), (r1, a1)) = (polar(from), polar(to));
                let ccw = (a1 - a0).rem_euclid(TAU);
                // An end on the ray of the start is a full turn, also where its radius differs within the tolerance.
                let closed = f64::midpoint(r0, r1) * ccw.min(TAU - ccw) <= MIN_LENGTH_MM;
                let sweep = match turn {
                    ArcDirection::Ccw if closed => TAU,
                    ArcDirection::Cw if closed => -TAU,
                    ArcDirection::Ccw => ccw,
                    ArcDirection::Cw => ccw - TAU,
                };
                let run = f64::midpoint(r0, r1) * sweep;
                let length = run.hypot(to[axes[2]] - from[axes[2]]);
                let form = SegmentForm::Arc { center, axes, radius: [r0, r1], angle: a0, sweep };
                Self::with_directions(from, to, form, length)
            }
        }
    }

    fn with_directions(from: [f64; 3], to: [f64; 3], form: SegmentForm, length: f64) -> Self {
        let mut this = Self { from, to, form, length, directions: [[0.0; 3]; 2] };
        let step = length * 1e-4;
        let toward = |a: [f64; 3], b: [f64; 3]| {
            let length = distance(a, b).max(MIN_LENGTH_MM);
            per_coordinate(|x| (b[x] - a[x]) / length)
        };
        this.directions = match form {
            SegmentForm::Line => [toward(from, to); 2],
            SegmentForm::Arc { .. } => [toward(from, this.at(step)), toward(this.at(length - step), to)],
        };
        this
    }

    /// Length, mm.
    #[must_use]
    pub const fn length(&self) -> f64 {
        self.length
    }

    /// Whether the move has no length.
    #[must_use]
    pub fn has_no_length(&self) -> bool {
        self.length <= MIN_LENGTH_MM
    }

    /// The point `limits_along` mm from the start; the end points are exact.
    #[must_use]
    pub fn at(&self, along: f64) -> [f64; 3] {
        if along <= 0.0 {
            return self.from;
        }
        if along >= self.length {
            return self.to;
        }
        let part = along / self.length;
        let mix = |axis: usize| self.from[axis] + (self.to[axis] - self.from[axis]) * part;
        match self.form {
            SegmentForm::Line => [mix(0), mix(1), mix(2)],
            SegmentForm::Arc { center, axes, radius, angle, sweep } => {
                let r = radius[0] + (radius[1] - radius[0]) * part;
                let (sin, cos) = (angle + sweep * part).sin_cos();
                let mut point = [0.0; 3];
                point[axes[0]] = center[0] + r * cos;
                point[axes[1]] = center[1] + r * sin;
                point[axes[2]] = mix(axes[2]);
                point
            }
        }
    }

    /// The nearest point to `point` between two distances along the segment: its distance along, mm, and the point.
    #[must_use]
    pub fn nearest(&self, point: [f64; 3], low: f64, high: f64) -> (f64, [f64; 3]) {
        match self.form {
            SegmentForm::Line => {
                let d = self.directions[0];
                let along = dot(per_coordinate(|x| point[x] - self.from[x]), d);
                let along = along.max(low.max(0.0)).min(high.min(self.length));
                (along, per_coordinate(|x| self.from[x] + along * d[x]))
            }
            SegmentForm::Arc { center, axes, angle, sweep, .. } => {
                // By the angle only: exact for a flat arc, and accurate enough within the tolerance band of a helix.
                let (x, y) = (point[axes[0]] - center[0], point[axes[1]] - center[1]);
                let turned = (sweep.signum() * (y.atan2(x) - angle)).rem_euclid(TAU);
                let whole = sweep.abs();
                let along = if turned <= whole {
                    turned / whole * self.length
                } else if turned - whole < TAU - turned {
                    self.length
                } else {
                    0.0
                };
                let along = along.max(low.max(0.0)).min(high.min(self.length));
                (along, self.at(along))
            }
        }
    }

    /// Greatest curvature, 1/mm; 0 of a line.
    #[must_use]
    pub fn curvature(&self) -> f64 {
        match self.form {
            SegmentForm::Line => 0.0,
            SegmentForm::Arc { radius, .. } => 1.0 / radius[0].min(radius[1]).max(MIN_LENGTH_MM),
        }
    }

    /// Unit direction vectors at the start and at the end.
    #[must_use]
    pub const fn directions(&self) -> [[f64; 3]; 2] {
        self.directions
    }

    /// Possible reversal points of an axis, in order, with their distance along: the quarter points of an arc, and the
    /// end of the segment.
    #[must_use]
    pub fn turning_points(&self) -> ([(f64, [f64; 3]); QUARTERS + 1], usize) {
        let mut points = [(self.length, self.to); QUARTERS + 1];
        let mut count = 0;
        if let SegmentForm::Arc { angle, sweep, .. } = self.form {
            let way = sweep.signum();
            let first = (angle * way / FRAC_PI_2).floor() + 1.0;
            for quarter in 0..QUARTERS {
                let turned = (first + quarter as f64) * FRAC_PI_2 - angle * way;
                if turned >= sweep.abs() {
                    break;
                }
                let along = turned / sweep.abs() * self.length;
                points[count] = (along, self.at(along));
                count += 1;
            }
        }
        points[count] = (self.length, self.to);
        (points, count + 1)
    }

    /// Limits of speed, acceleration and jerk along the segment that keep the limits of every axis.
    #[must_use]
    pub fn limits(&self, limits: &MotionLimits) -> AxisLimits {
        match self.form {
            SegmentForm::Line => {
                let share = |axis: Axis| (self.to[axis as usize] - self.from[axis as usize]).abs() / self.length;
                limits_along(limits, share)
            }
            SegmentForm::Arc { axes, radius, .. } => {
                let linear = (self.to[axes[2]] - self.from[axes[2]]).abs() / self.length;
                let share = |axis: Axis| if axis as usize == axes[2] { linear } else { 1.0 };
                let AxisLimits { velocity_mm_s: v, acceleration_mm_s2: a, jerk_mm_s3: j } = limits_along(limits, share);
                let r = radius[0].min(radius[1]).max(MIN_LENGTH_MM);
                let velocity_mm_s = v.min((ARC_SHARE * a * r).sqrt()).min((ARC_JERK_CURVATURE * j * r * r).cbrt());
                let across = ARC_SHARE * j * r / (3.0 * velocity_mm_s);
                let acceleration_mm_s2 = (ARC_SHARE * a).min(across);
                AxisLimits { velocity_mm_s, acceleration_mm_s2, jerk_mm_s3: ARC_JERK_TANGENTIAL * j }
            }
        }
    }
}

/// Limits along a direction in which each axis has a share, 0 to 1.
fn limits_along(limits: &MotionLimits, share: impl Fn(Axis) -> f64) -> AxisLimits {
    let least = |of: fn(&AxisLimits) -> f64| {
        limits.axes.iter().map(|(axis, l)| of(l) / share(axis).max(1e-12)).fold(f64::INFINITY, f64::min)
    };
    AxisLimits {
        velocity_mm_s: least(|l| l.velocity_mm_s),
        acceleration_mm_s2: least(|l| l.acceleration_mm_s2),
        jerk_mm_s3: least(|l| l.jerk_mm_s3),
    }
}

/// Distance between two points, mm.
#[must_use]
#[inline]
pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    square_distance(a, b).sqrt()
}

/// Square of the distance between two points, mm².
#[inline]
#[must_use]
pub fn square_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let off = per_coordinate(|x| a[x] - b[x]);
    dot(off, off)
}

#[cfg(test)]
mod tests {
    use super::PathSegment;
    use crate::motion::{ArcDirection, MoveShape};
    use crate::units::{MachinePos, Plane};
    use std::f64::consts::{FRAC_1_SQRT_2, PI};

    fn arc(turn: ArcDirection, to: [f64; 3]) -> PathSegment {
        // In ZX from Z+ (X 0, Z 10) about the origin.
        let shape = MoveShape::Arc { center: MachinePos::new([0.0; 3]), plane: Plane::Zx, direction: turn };
        PathSegment::new([0.0, 0.0, 10.0], MachinePos::new(to), shape)
    }

    fn check_middle(segment: &PathSegment, length: f64, middle: [f64; 3]) {
        assert!((segment.length() - length).abs() < 1e-9, "{}", segment.length());
        let at = segment.at(length / 2.0);
        assert!((0..3).all(|x| (at[x] - middle[x]).abs() < 1e-9), "{at:?}");
    }

    #[test]
    fn counter_clockwise_in_zx_leads_from_z_plus_to_x_plus() {
        let half = 10.0 * FRAC_1_SQRT_2;
        check_middle(&arc(ArcDirection::Ccw, [10.0, 0.0, 0.0]), 5.0 * PI, [half, 0.0, half]);
        check_middle(&arc(ArcDirection::Cw, [10.0, 0.0, 0.0]), 15.0 * PI, [-half, 0.0, -half]);
    }

    #[test]
    fn the_same_point_again_is_a_full_turn_and_the_third_axis_makes_it_a_helix() {
        check_middle(&arc(ArcDirection::Ccw, [0.0, 0.0, 10.0]), 20.0 * PI, [0.0, 0.0, -10.0]);
        check_middle(&arc(ArcDirection::Cw, [0.0, 5.0, 10.0]), (20.0 * PI).hypot(5.0), [0.0, 2.5, -10.0]);
    }

    #[test]
    fn b2_an_end_on_the_ray_of_the_start_is_a_full_turn_either_way() {
        // The radius may differ by the arc tolerance of 0.01 mm: 2π · (10 + 10.005)/2.
        for direction in [ArcDirection::Ccw, ArcDirection::Cw] {
            let length = arc(direction, [0.0, 0.0, 10.005]).length();
            assert!((length - 20.005 * PI).abs() < 1e-9, "{direction:?}: {length}");
        }
    }
}
