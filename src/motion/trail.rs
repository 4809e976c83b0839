//! The trail: nominal set-points laid ahead of the axes, and the smooth curve through them.
//!
//! Owns a ring of set-points, one for each tick at full rate. Knows nothing of how they were planned or how fast they
//! are followed. The curve takes them as control points of a uniform cubic B-spline, so its velocity, acceleration and
//! jerk are means of the first, second and third differences of the set-points and never exceed the greatest of them;
//! it passes a set-point at a distance of at most a·dt²/6 (0.25 µm at 1500 mm/s² and 1 ms), and through it at rest.

/// Set-points kept: those behind the axes, those ahead, and a reserve.
pub const PLACES: usize = 8_192;
/// Pads repeated in front of a start from rest, so that the curve at the present place stays as it was.
const PAD: u64 = 3;

/// One nominal set-point.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// X, Y, Z in mm.
    pub at: [f64; 3],
    /// The feed override this place was planned for, at least 1.
    pub planned_override: f64,
    /// Whether the rapid override rules here.
    pub rapid: bool,
}

/// Position and its first derivative by ticks.
#[derive(Clone, Copy, Debug)]
pub struct OnTrail {
    /// X, Y, Z in mm.
    pub at: [f64; 3],
    /// X, Y, Z in mm per tick at full rate.
    pub step: [f64; 3],
}

/// A moment on the trail: whole ticks and the fraction of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Whole ticks since the beginning of the trail.
    pub tick: u64,
    /// Fraction, 0 to below 1.
    pub part: f64,
}

impl Spot {
    /// The spot `ticks` later.
    #[must_use]
    pub fn later(self, ticks: f64) -> Self {
        let sum = self.part + ticks;
        let whole = sum.floor().max(0.0);
        Self { tick: self.tick + whole as u64, part: (sum - whole).clamp(0.0, 1.0) }
    }
}

/// The ring of nominal set-points.
#[derive(Clone, Debug)]
pub struct Trail {
    places: Vec<Place>,
    /// The number of the place after the last.
    end: u64,
    /// Whether the last place is in full motion and more must follow.
    open: bool,
}

impl Trail {
    /// A trail on which the axes stand at `at`.
    #[must_use]
    pub fn standing(at: [f64; 3]) -> Self {
        let place = Place { at, planned_override: 1.0, rapid: false };
        Self { places: vec![place; PLACES], end: PLACES as u64, open: false }
    }

    /// Forget everything and stand at `at`; returns the spot to stand on.
    pub fn stand(&mut self, at: [f64; 3]) -> Spot {
        self.places.fill(Place { at, planned_override: 1.0, rapid: false });
        self.open = false;
        self.resting_spot()
    }

    /// The spot from which on the curve stands still at the last place.
    #[must_use]
    pub const fn resting_spot(&self) -> Spot {
        Spot { tick: self.end, part: 0.0 }
    }

    /// The number of the place after the last.
    #[must_use]
    pub const fn end(&self) -> u64 {
        self.end
    }

    /// The last place.
    #[must_use]
    pub fn last(&self) -> Place {
        self.place(self.end - 1)
    }

    /// The place of a number; before the oldest kept the oldest, after the last the last.
    #[must_use]
    pub fn place(&self, number: u64) -> Place {
        let oldest = self.end - PLACES as u64;
        let number = number.clamp(oldest, self.end - 1);
        self.places[(number % PLACES as u64) as usize]
    }

    /// Repeat the last place as far as a start from rest needs it when the axes are at `spot`.
    pub fn pad_for_start(&mut self, spot: Spot) {
        while self.end < spot.tick + PAD {
            let last = self.last();
            self.push(last);
        }
    }

    /// Whether more places must follow; otherwise the axes stand still after the last.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.open
    }

    /// Say whether more places must follow.
    pub const fn set_open(&mut self, open: bool) {
        self.open = open;
    }

    /// Lay one place. The caller keeps the distance to the axes below [`PLACES`] less a few.
    pub fn push(&mut self, place: Place) {
        self.places[(self.end % PLACES as u64) as usize] = place;
        self.end += 1;
    }

    /// The curve at a spot.
    #[must_use]
    pub fn on(&self, spot: Spot) -> OnTrail {
        let t = spot.part;
        let before = self.place(spot.tick.saturating_sub(1)).at;
        let (here, next, after) =
            (self.place(spot.tick).at, self.place(spot.tick + 1).at, self.place(spot.tick + 2).at);
        let u = 1.0 - t;
        let step = [0, 1, 2].map(|x| {
            let (b, n, a) = (before[x] - here[x], next[x] - here[x], after[x] - here[x]);
            -u * u / 2.0 * b + (1.0 + t * (2.0 - 3.0 * t)) / 2.0 * n + t * t / 2.0 * a
        });
        OnTrail { at: spline(&[before, here, next, after], t), step }
    }
}

/// A uniform cubic B-spline: the point at `part` (0 to 1) of the interval with these four control points.
#[must_use]
pub fn spline(p: &[[f64; 3]], part: f64) -> [f64; 3] {
    let (t, u) = (part, 1.0 - part);
    let weight_next = (1.0 + 3.0 * t * (1.0 + t * u)) / 6.0;
    // Differences from the second, so that what stands comes out exactly and large coordinates lose nothing.
    [0, 1, 2].map(|x| {
        let (b, n, a) = (p[0][x] - p[1][x], p[2][x] - p[1][x], p[3][x] - p[1][x]);
        p[1][x] + (u * u * u / 6.0 * b + weight_next * n + t * t * t / 6.0 * a)
    })
}

#[cfg(test)]
mod tests {
    use super::{Place, Spot, Trail};

    #[test]
    fn a_start_from_rest_does_not_move_the_present() {
        let mut trail = Trail::standing([5.0; 3]);
        let spot = trail.resting_spot();
        trail.pad_for_start(spot);
        for k in 1..50 {
            trail.push(Place { at: [5.0 + f64::from(k); 3], planned_override: 1.0, rapid: false });
        }
        assert!((trail.on(spot).at[0] - 5.0).abs() < 1e-15);
        // A straight, even trail is followed evenly: after the pads, ten places on and a half.
        let even = trail.on(Spot { tick: trail.end() - 20, part: 0.5 });
        assert!((even.at[0] - (5.0 + 30.5)).abs() < 1e-12 && (even.step[0] - 1.0).abs() < 1e-12, "{even:?}");
    }
}
