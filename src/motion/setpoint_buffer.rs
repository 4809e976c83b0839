//! Set-point buffer: nominal set-points ahead of the axes, and the smooth curve through them.
//!
//! A ring buffer of set-points, one per tick at full rate. Knows nothing of how they were planned or how fast they are
//! followed. They are the control points of a uniform cubic B-spline, so velocity, acceleration and jerk of the curve
//! are means of the first, second and third differences of the set-points and never exceed the largest of them. The
//! curve passes a set-point at a distance of at most a·dt²/6 (0.25 µm at 1500 mm/s² and 1 ms), and exactly at rest.

use super::per_coordinate;

/// Capacity in set-points: those behind the axes, those ahead, and a reserve.
pub const BUFFER_CAPACITY: usize = 8_192;
/// Set-points repeated before a start from rest, so that the curve at the present position does not change.
const START_PADDING: u64 = 3;

/// One nominal set-point.
#[derive(Clone, Copy, Debug)]
pub struct NominalSetpoint {
    /// X, Y, Z in mm.
    pub position: [f64; 3],
    /// The feed override it was planned for, at least 1.
    pub planned_override: f64,
    /// Whether the rapid override applies here.
    pub is_rapid: bool,
}

/// Position and its first derivative per tick.
#[derive(Clone, Copy, Debug)]
pub struct BufferSample {
    /// X, Y, Z in mm.
    pub position: [f64; 3],
    /// X, Y, Z in mm per tick at full rate.
    pub step: [f64; 3],
}

/// The curve at a place: the position, and its derivatives by the index of the set-points; the third up to the next
/// set-point, and behind it.
#[derive(Clone, Copy, Debug)]
pub struct LocalCurve {
    /// X, Y, Z in mm.
    pub position: [f64; 3],
    /// mm per tick at full rate.
    pub first: [f64; 3],
    /// mm per tick².
    pub second: [f64; 3],
    /// mm per tick³.
    pub third: [[f64; 3]; 2],
}

/// A position on the buffer: whole ticks and a fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BufferPosition {
    /// Whole ticks since the start of the buffer.
    pub tick: u64,
    /// Fraction, 0 to below 1.
    pub fraction: f64,
}

impl BufferPosition {
    /// The position `ticks` later.
    #[must_use]
    pub fn later(self, ticks: f64) -> Self {
        let sum = self.fraction + ticks;
        let whole = sum.floor().max(0.0);
        Self { tick: self.tick + whole as u64, fraction: (sum - whole).clamp(0.0, 1.0) }
    }
}

/// The ring buffer of nominal set-points.
#[derive(Clone, Debug)]
pub struct SetpointBuffer {
    setpoints: Vec<NominalSetpoint>,
    /// Index after the last set-point.
    end: u64,
    /// Whether the last set-point is in motion, so that more must follow.
    open: bool,
}

impl SetpointBuffer {
    /// A buffer with the axes at rest at `at`, mm.
    #[must_use]
    pub fn at_rest(at: [f64; 3]) -> Self {
        let place = NominalSetpoint { position: at, planned_override: 1.0, is_rapid: false };
        Self { setpoints: vec![place; BUFFER_CAPACITY], end: BUFFER_CAPACITY as u64, open: false }
    }

    /// Discards everything and rests at `at`, mm; returns the position of rest on the buffer.
    pub fn reset_to(&mut self, at: [f64; 3]) -> BufferPosition {
        self.setpoints.fill(NominalSetpoint { position: at, planned_override: 1.0, is_rapid: false });
        self.open = false;
        self.rest_position()
    }

    /// The position from which on the curve rests at the last set-point.
    #[must_use]
    pub const fn rest_position(&self) -> BufferPosition {
        BufferPosition { tick: self.end, fraction: 0.0 }
    }

    /// Index after the last set-point.
    #[must_use]
    pub const fn end(&self) -> u64 {
        self.end
    }

    /// The last set-point.
    #[must_use]
    pub fn last(&self) -> NominalSetpoint {
        self.setpoint(self.end - 1)
    }

    /// The set-point of an index, clamped to the oldest and the last one.
    #[must_use]
    pub fn setpoint(&self, number: u64) -> NominalSetpoint {
        let oldest = self.end - BUFFER_CAPACITY as u64;
        let number = number.clamp(oldest, self.end - 1);
        self.setpoints[(number % BUFFER_CAPACITY as u64) as usize]
    }

    /// Repeats the last set-point as often as a start from rest at `spot` needs.
    pub fn pad_for_start(&mut self, spot: BufferPosition) {
        while self.end < spot.tick + START_PADDING {
            let last = self.last();
            self.push(last);
        }
    }

    /// Whether more set-points must follow; otherwise the axes rest after the last.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.open
    }

    /// Sets whether more set-points must follow.
    pub const fn set_open(&mut self, open: bool) {
        self.open = open;
    }

    /// Appends a set-point. The caller keeps the distance to the axes a few set-points below [`BUFFER_CAPACITY`].
    pub fn push(&mut self, place: NominalSetpoint) {
        self.setpoints[(self.end % BUFFER_CAPACITY as u64) as usize] = place;
        self.end += 1;
    }

    /// The curve at a position on the buffer.
    #[must_use]
    pub fn sample(&self, spot: BufferPosition) -> BufferSample {
        let t = spot.fraction;
        let points = self.points_around(spot.tick);
        BufferSample { position: spline(&points, t), step: spline_step(&points, t) }
    }

    /// The curve with its derivatives at a position on the buffer.
    #[must_use]
    pub fn local_curve(&self, spot: BufferPosition) -> LocalCurve {
        let t = spot.fraction;
        let points = self.points_around(spot.tick);
        let [before, here, next, after] = points;
        let last = self.setpoint(spot.tick + 3).position;
        let bend = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| per_coordinate(|x| (c[x] - b[x]) - (b[x] - a[x]));
        let (start, end, far) = (bend(before, here, next), bend(here, next, after), bend(next, after, last));
        let third = [per_coordinate(|x| end[x] - start[x]), per_coordinate(|x| far[x] - end[x])];
        LocalCurve {
            position: spline(&points, t),
            first: spline_step(&points, t),
            second: per_coordinate(|x| start[x] + t * third[0][x]),
            third,
        }
    }

    /// The set-points before, at and after an index that shape the curve from there to the next.
    fn points_around(&self, tick: u64) -> [[f64; 3]; 4] {
        let before = self.setpoint(tick.saturating_sub(1)).position;
        let [here, next, after] = [0, 1, 2].map(|k| self.setpoint(tick + k).position);
        [before, here, next, after]
    }
}

/// A uniform cubic B-spline: the point at `part` (0 to 1) of the interval with these four control points.
#[must_use]
pub fn spline(p: &[[f64; 3]], part: f64) -> [f64; 3] {
    let (t, u) = (part, 1.0 - part);
    let weight_next = (1.0 + 3.0 * t * (1.0 + t * u)) / 6.0;
    // Differences from the second point: a position at rest is exact, and large coordinates lose no precision.
    per_coordinate(|x| {
        let (b, n, a) = (p[0][x] - p[1][x], p[2][x] - p[1][x], p[3][x] - p[1][x]);
        p[1][x] + (u * u * u / 6.0 * b + weight_next * n + t * t * t / 6.0 * a)
    })
}

/// The first derivative of [`spline`], per interval.
fn spline_step(p: &[[f64; 3]; 4], part: f64) -> [f64; 3] {
    let (t, u) = (part, 1.0 - part);
    per_coordinate(|x| {
        let (b, n, a) = (p[0][x] - p[1][x], p[2][x] - p[1][x], p[3][x] - p[1][x]);
        -u * u / 2.0 * b + (1.0 + t * (2.0 - 3.0 * t)) / 2.0 * n + t * t / 2.0 * a
    })
}

#[cfg(test)]
mod tests {
    use super::{BufferPosition, NominalSetpoint, SetpointBuffer};

    #[test]
    fn a_start_from_rest_does_not_move_the_present() {
        let mut buffer = SetpointBuffer::at_rest([5.0; 3]);
        let spot = buffer.rest_position();
        buffer.pad_for_start(spot);
        for k in 1..50 {
            buffer.push(NominalSetpoint { position: [5.0 + f64::from(k); 3], planned_override: 1.0, is_rapid: false });
        }
        assert!((buffer.sample(spot).position[0] - 5.0).abs() < 1e-15);
        // A straight buffer at constant speed: after the padding, 30.5 set-points on.
        let even = buffer.sample(BufferPosition { tick: buffer.end() - 20, fraction: 0.5 });
        assert!((even.position[0] - (5.0 + 30.5)).abs() < 1e-12 && (even.step[0] - 1.0).abs() < 1e-12, "{even:?}");
    }
}
