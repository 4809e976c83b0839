//! A line or an arc in a plane: directions, distances, intersections, offset.

use std::f64::consts::TAU;

/// First and second coordinate, mm.
pub type PlanePoint = [f64; 2];

/// Fractions of a segment beyond its ends that still count as on it: rounding of coordinates up to 1 m.
const FRACTION_TOLERANCE: f64 = 1e-9;
/// The centre of an arc is moved by at most this, mm: four times what a program that rounds to 5 µm needs for a quarter.
pub const MAX_CENTER_SHIFT_MM: f64 = 0.02;
/// A length below this is none, mm.
pub(super) const MIN_LENGTH_MM: f64 = 1e-9;

/// A line or an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneSegment {
    /// A straight line.
    Line {
        /// Start, mm.
        from: PlanePoint,
        /// End, mm.
        to: PlanePoint,
    },
    /// An arc, at most a full circle.
    Arc {
        /// Centre, mm.
        center: PlanePoint,
        /// Radius, mm; positive.
        radius: f64,
        /// Angle of the start, radians.
        start: f64,
        /// Angle from start to end, radians: counter-clockwise positive, −2π to 2π.
        sweep: f64,
    },
}

fn minus(a: PlanePoint, b: PlanePoint) -> PlanePoint {
    [a[0] - b[0], a[1] - b[1]]
}

/// The point at a distance from another one along a direction.
pub(super) fn along(from: PlanePoint, direction: PlanePoint, distance: f64) -> PlanePoint {
    [from[0] + direction[0] * distance, from[1] + direction[1] * distance]
}

pub(super) fn dot(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The component of a × b normal to the plane: positive if b is to the left of a.
pub(super) fn cross(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn norm(a: PlanePoint) -> f64 {
    a[0].hypot(a[1])
}

/// Distance between two points, mm.
pub(super) fn distance(a: PlanePoint, b: PlanePoint) -> f64 {
    norm(minus(a, b))
}

fn polar(angle: f64) -> PlanePoint {
    let (sin, cos) = angle.sin_cos();
    [cos, sin]
}

/// The direction turned left by a quarter.
pub(super) fn left_of(direction: PlanePoint) -> PlanePoint {
    [-direction[1], direction[0]]
}

impl PlaneSegment {
    /// A line.
    #[must_use]
    pub const fn line(from: PlanePoint, to: PlanePoint) -> Self {
        Self::Line { from, to }
    }

    /// An arc between two points; from a point to itself it is a full circle.
    ///
    /// A centre that is nearer to one end, as a program rounds it, is moved so that the arc meets both ends. None if it
    /// would move by more than [`MAX_CENTER_SHIFT_MM`]: wrong, or an arc that is nearly a full circle.
    #[must_use]
    pub fn arc(from: PlanePoint, to: PlanePoint, center: PlanePoint, is_ccw: bool) -> Option<Self> {
        let chord = minus(to, from);
        let square = dot(chord, chord);
        let is_full = square <= MIN_LENGTH_MM * MIN_LENGTH_MM;
        let middle = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
        let beside = if is_full { 0.0 } else { dot(minus(center, middle), chord) / square };
        if beside.abs() * square.sqrt() > MAX_CENTER_SHIFT_MM {
            return None;
        }
        let center = along(center, chord, -beside);
        let angle = |point: PlanePoint| (point[1] - center[1]).atan2(point[0] - center[0]);
        let ccw = (angle(to) - angle(from)).rem_euclid(TAU);
        let sweep = match (is_ccw, is_full) {
            (true, true) => TAU,
            (false, true) => -TAU,
            (true, false) => ccw,
            (false, false) => ccw - TAU,
        };
        Some(Self::Arc { center, radius: distance(from, center), start: angle(from), sweep })
    }

    /// The point at a fraction, 0 to 1, of the length.
    #[must_use]
    pub fn at(&self, fraction: f64) -> PlanePoint {
        match *self {
            Self::Line { from, to } => along(from, minus(to, from), fraction),
            Self::Arc { center, radius, start, sweep } => along(center, polar(start + sweep * fraction), radius),
        }
    }

    /// Length, mm.
    #[must_use]
    pub fn length(&self) -> f64 {
        match *self {
            Self::Line { from, to } => distance(from, to),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// Unit vector of the direction of travel at a fraction of the length.
    #[must_use]
    pub fn direction(&self, fraction: f64) -> PlanePoint {
        match *self {
            Self::Line { from, to } => {
                let chord = minus(to, from);
                let length = norm(chord).max(MIN_LENGTH_MM);
                [chord[0] / length, chord[1] / length]
            }
            Self::Arc { start, sweep, .. } => {
                let tangent = left_of(polar(start + sweep * fraction));
                [tangent[0] * sweep.signum(), tangent[1] * sweep.signum()]
            }
        }
    }

    /// The part between two fractions.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        match *self {
            Self::Line { .. } => Self::line(self.at(from), self.at(to)),
            Self::Arc { center, radius, start, sweep } => {
                Self::Arc { center, radius, start: start + sweep * from, sweep: sweep * (to - from) }
            }
        }
    }

    /// Lowest and highest coordinates; of an arc those of its circle.
    #[must_use]
    pub(super) fn bounds(&self) -> [PlanePoint; 2] {
        match *self {
            Self::Line { from, to } => {
                [[from[0].min(to[0]), from[1].min(to[1])], [from[0].max(to[0]), from[1].max(to[1])]]
            }
            Self::Arc { center, radius, .. } => {
                [[center[0] - radius, center[1] - radius], [center[0] + radius, center[1] + radius]]
            }
        }
    }

    /// The parallel segment at a distance to the left, mm; negative to the right. None for an arc whose centre is not
    /// farther than that on this side.
    #[must_use]
    pub fn parallel(&self, to_the_left: f64) -> Option<Self> {
        match *self {
            Self::Line { from, to } => {
                let normal = left_of(self.direction(0.0));
                Some(Self::line(along(from, normal, to_the_left), along(to, normal, to_the_left)))
            }
            Self::Arc { center, radius, start, sweep } => {
                let radius = radius - to_the_left * sweep.signum();
                (radius > MIN_LENGTH_MM).then_some(Self::Arc { center, radius, start, sweep })
            }
        }
    }

    /// The fraction at which a point lies, if it lies on the segment; the point is on its line or circle.
    fn fraction_of(&self, point: PlanePoint) -> Option<f64> {
        let fraction = match *self {
            Self::Line { from, to } => {
                let chord = minus(to, from);
                dot(minus(point, from), chord) / dot(chord, chord).max(MIN_LENGTH_MM * MIN_LENGTH_MM)
            }
            Self::Arc { center, start, sweep, .. } => {
                let angle = (point[1] - center[1]).atan2(point[0] - center[0]);
                let turned = ((angle - start) * sweep.signum()).rem_euclid(TAU);
                // Just before the start is there too.
                let turned = if TAU - turned < FRACTION_TOLERANCE * TAU { 0.0 } else { turned };
                turned / sweep.abs().max(FRACTION_TOLERANCE)
            }
        };
        (-FRACTION_TOLERANCE..=1.0 + FRACTION_TOLERANCE).contains(&fraction).then(|| fraction.clamp(0.0, 1.0))
    }

    /// Distance of a point from the segment, mm.
    #[must_use]
    pub fn distance_to(&self, point: PlanePoint) -> f64 {
        let of_ends = distance(point, self.at(0.0)).min(distance(point, self.at(1.0)));
        if self.length() <= MIN_LENGTH_MM {
            return of_ends;
        }
        match *self {
            Self::Line { from, .. } => match self.fraction_of(point) {
                Some(_) => cross(self.direction(0.0), minus(point, from)).abs(),
                None => of_ends,
            },
            Self::Arc { center, radius, .. } => match self.fraction_of(point) {
                Some(_) => (distance(point, center) - radius).abs(),
                None => of_ends,
            },
        }
    }

    /// Smallest distance between two segments, mm; 0 where they cross or touch.
    ///
    /// It is at an end of one of them, or where the common normal is: on the line through the centres, or through the
    /// centre and square to the line.
    #[must_use]
    pub fn distance_between(&self, other: &Self) -> f64 {
        if self.crossings(other).iter().any(Option::is_some) {
            return 0.0;
        }
        let ends = |of: &Self, to: &Self| to.distance_to(of.at(0.0)).min(to.distance_to(of.at(1.0)));
        let least = ends(self, other).min(ends(other, self));
        least.min(self.distance_at_normals(other)).min(other.distance_at_normals(self))
    }

    /// Smallest distance from the points of this arc whose normal can also be normal to the other segment.
    fn distance_at_normals(&self, other: &Self) -> f64 {
        let Self::Arc { center, radius, .. } = *self else { return f64::INFINITY };
        let normal = match *other {
            Self::Line { .. } => left_of(other.direction(0.0)),
            Self::Arc { center: other_center, .. } => minus(other_center, center),
        };
        let length = norm(normal);
        if length <= MIN_LENGTH_MM {
            return f64::INFINITY;
        }
        let points = [1.0, -1.0].map(|side| along(center, normal, side * radius / length));
        let on_arc = points.into_iter().filter(|point| self.fraction_of(*point).is_some());
        on_arc.map(|point| other.distance_to(point)).fold(f64::INFINITY, f64::min)
    }

    /// Fractions of this and of the other segment at which they cross or touch.
    #[must_use]
    pub fn crossings(&self, other: &Self) -> [Option<(f64, f64)>; 2] {
        if self.length().min(other.length()) <= MIN_LENGTH_MM {
            return [None; 2];
        }
        let points = match (self, other) {
            (Self::Line { from, .. }, Self::Line { .. }) => {
                let (a, b) = (self.direction(0.0), other.direction(0.0));
                let sine = cross(a, b);
                let to_other = minus(other.at(0.0), *from);
                let point = along(*from, a, cross(to_other, b) / sine);
                [(sine.abs() > FRACTION_TOLERANCE).then_some(point), None]
            }
            (Self::Line { from, .. }, Self::Arc { center, radius, .. })
            | (Self::Arc { center, radius, .. }, Self::Line { from, .. }) => {
                let line = if matches!(self, Self::Line { .. }) { self } else { other };
                let direction = line.direction(0.0);
                let foot = along(*from, direction, dot(minus(*center, *from), direction));
                let square = radius * radius - distance(foot, *center).powi(2);
                both_sides(foot, direction, square)
            }
            (Self::Arc { center: a, radius: ra, .. }, Self::Arc { center: b, radius: rb, .. }) => {
                let between = minus(*b, *a);
                let length = norm(between);
                if length <= MIN_LENGTH_MM {
                    return [None; 2];
                }
                let direction = [between[0] / length, between[1] / length];
                let way = (length * length + ra * ra - rb * rb) / (2.0 * length);
                both_sides(along(*a, direction, way), left_of(direction), ra * ra - way * way)
            }
        };
        points.map(|point| {
            let point = point?;
            Some((self.fraction_of(point)?, other.fraction_of(point)?))
        })
    }
}

/// The points at ±√`square` from `foot`; none if it is negative beyond rounding.
fn both_sides(foot: PlanePoint, direction: PlanePoint, square: f64) -> [Option<PlanePoint>; 2] {
    if square < -MIN_LENGTH_MM {
        return [None; 2];
    }
    let half = square.max(0.0).sqrt();
    [Some(along(foot, direction, -half)), Some(along(foot, direction, half))]
}
