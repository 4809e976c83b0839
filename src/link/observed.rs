//! A snapshot with the time of day of its tick: what the network tells is as old as that, whenever it is told.

use super::snapshot::Snapshot;
use crate::units::Micros;

/// A snapshot and when it was taken.
#[derive(Clone, Debug)]
pub struct ObservedSnapshot {
    /// The state.
    pub snapshot: Snapshot,
    /// The end of its tick, since 1970, UTC.
    pub taken: Micros,
}
