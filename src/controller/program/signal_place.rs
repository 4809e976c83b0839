//! Where a skip signal came: as the tick has seen it, and as the touch probes of the drives have latched it.
//! Source: spec B2 (G31), K4.5 (G78); CiA 402-2, touch probe.

use crate::controller::plant::Plant;
use crate::units::{MachinePos, PerAxis, WorkPos};

/// How late the tick may see a signal: filter of the input terminal and cycles of the bus, s.
const LATENESS_S: f64 = 0.02;
/// Beside it: servo lag that changes, and compensation, mm.
const SLACK_MM: f64 = 0.02;

/// The place of a skip signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalPlace {
    signal: u8,
    /// Actual position in the tick that has seen it.
    seen: MachinePos,
    /// How far the axes may have gone before, mm. A latch farther away is that of another edge.
    reach_mm: PerAxis<f64>,
}

impl SignalPlace {
    /// A signal that comes in this tick.
    pub fn seen(plant: &Plant, signal: u8) -> Self {
        let velocity = plant.axes.velocity_mm_s();
        let reach_mm = PerAxis::from_fn(|axis| velocity[axis].abs() * LATENESS_S + SLACK_MM);
        Self { signal, seen: plant.axes.actual(), reach_mm }
    }

    /// Work coordinates of the place: of each axis what its drive has latched, else what the tick has seen.
    #[must_use]
    pub fn work_position(&self, plant: &Plant) -> WorkPos {
        let latches = &plant.inputs.image.latches;
        let machine = MachinePos::from_fn(|axis| {
            let latch = latches[axis].filter(|latch| latch.signal == self.signal);
            let at = latch.and_then(|latch| plant.axes.position_at(axis, latch.encoder_mm));
            let near = at.filter(|at| (at - self.seen[axis]).abs() <= self.reach_mm[axis]);
            near.unwrap_or(self.seen[axis])
        });
        plant.work.offsets.work_from_machine(machine)
    }
}
