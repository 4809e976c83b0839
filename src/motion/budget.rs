//! The work of a tick, counted.
//!
//! Owns how much of a plan may be worked on before the next set-point is due. Units are counted, never timed, so that
//! the same calls give the same set-points on every machine; one unit is about a nanosecond on the machine of
//! docs/performance.md.

/// What is left of the work of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    left: usize,
}

impl Budget {
    /// So many units.
    #[must_use]
    pub const fn new(units: usize) -> Self {
        Self { left: units }
    }

    /// Whether nothing is left.
    #[must_use]
    pub const fn is_spent(&self) -> bool {
        self.left == 0
    }

    /// What is left, in units.
    #[must_use]
    pub const fn left(&self) -> usize {
        self.left
    }

    /// Takes a cost, or all that is left.
    pub const fn take(&mut self, cost: usize) {
        self.left = self.left.saturating_sub(cost);
    }

    /// How far a pass from `from` to `end` may go at so much a place; takes the cost. At least one place while
    /// anything is left.
    pub fn slice(&mut self, from: usize, end: usize, cost: usize) -> usize {
        let places = self.left.div_ceil(cost.max(1)).min(end.saturating_sub(from));
        self.take(places * cost);
        from + places
    }
}
