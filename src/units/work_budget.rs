//! Work budget of a tick, in counted units: reading of blocks, look-ahead and feed scaling are charged to it.
//!
//! Limits the work before the next set-point is due. Units are counted, never timed, so that the same calls give the
//! same set-points on every computer. One unit is about a nanosecond on the computer of docs/performance.md.

/// The work units of a tick: granted and spent.
#[derive(Clone, Copy, Debug)]
pub struct WorkBudget {
    granted: usize,
    spent: usize,
}

impl WorkBudget {
    /// A budget of `units`.
    #[must_use]
    pub const fn new(units: usize) -> Self {
        Self { granted: units, spent: 0 }
    }

    /// A budget that is never spent: work outside the tick.
    #[must_use]
    pub const fn unlimited() -> Self {
        Self::new(usize::MAX)
    }

    /// Whether no unit is left.
    #[must_use]
    pub const fn is_spent(&self) -> bool {
        self.spent >= self.granted
    }

    /// The units left.
    #[must_use]
    pub const fn left(&self) -> usize {
        self.granted.saturating_sub(self.spent)
    }

    /// The units spent; more than granted if the last step took more than was left.
    #[must_use]
    pub const fn spent(&self) -> usize {
        self.spent
    }

    /// What a part of the tick may take from this budget: at most `units`. It is charged by [`Self::spend`].
    #[must_use]
    pub fn share(&self, units: usize) -> Self {
        Self::new(units.min(self.left()))
    }

    /// Spends a cost.
    pub const fn spend(&mut self, cost: usize) {
        self.spent = self.spent.saturating_add(cost);
    }

    /// Spends `cost` units per item from `from` up to `end` and returns how far the pass may go: at least one item
    /// while units are left.
    pub fn spend_on_slice(&mut self, from: usize, end: usize, cost: usize) -> usize {
        let places = self.left().div_ceil(cost.max(1)).min(end.saturating_sub(from));
        self.spend(places * cost);
        from + places
    }
}
