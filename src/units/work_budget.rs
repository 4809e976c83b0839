//! Work budget of a tick, in counted units: reading of blocks, look-ahead and feed scaling are charged to it.
//!
//! Limits the work before the next set-point is due. Units are counted, never timed, so that the same calls
//! give the same set-points on every computer. One unit is about a nanosecond on the computer of docs/performance.md.

/// The remaining work units of a tick.
#[derive(Clone, Copy, Debug)]
pub struct WorkBudget {
    left: usize,
}

impl WorkBudget {
    /// A budget of `units`.
    #[must_use]
    pub const fn new(units: usize) -> Self {
        Self { left: units }
    }

    /// A budget that is never spent: work outside the tick.
    #[must_use]
    pub const fn unlimited() -> Self {
        Self::new(usize::MAX)
    }

    /// Whether no unit is left.
    #[must_use]
    pub const fn is_spent(&self) -> bool {
        self.left == 0
    }

    /// The units left.
    #[must_use]
    pub const fn left(&self) -> usize {
        self.left
    }

    /// What the work of a tick may take from this budget: at most `units`.
    #[must_use]
    pub fn share(&self, units: usize) -> Self {
        Self::new(units.min(self.left))
    }

    /// Spends a cost, or all units that are left.
    pub const fn spend(&mut self, cost: usize) {
        self.left = self.left.saturating_sub(cost);
    }

    /// Spends `cost` units per item from `from` up to `end` and returns how far the pass may go: at least one item
    /// while units are left.
    pub fn spend_on_slice(&mut self, from: usize, end: usize, cost: usize) -> usize {
        let places = self.left.div_ceil(cost.max(1)).min(end.saturating_sub(from));
        self.spend(places * cost);
        from + places
    }
}
