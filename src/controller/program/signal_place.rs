//! Where a skip signal came: as the tick has seen it, and as the touch probes of the drives have latched it.
//! Source: spec B2 (G31), K4.5 (G78); CiA 402-2, touch probe.

use crate::controller::plant::Plant;
use crate::units::{Axis, MachinePos, PerAxis, WorkPos};

/// How late the tick may see a signal: filter of the input terminal and cycles of the bus, s.
const LATENESS_S: f64 = 0.02;
/// Beside it: noise of the encoder, and compensation, mm.
const SLACK_MM: f64 = 0.02;

/// The place of a skip signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalPlace {
    signal: u8,
    /// Actual position in the tick that has seen it.
    seen: MachinePos,
    /// How far the axes may have gone before, mm. A latch farther away is that of another edge.
    reach_mm: PerAxis<f64>,
    /// What the drives have latched, machine coordinates.
    latched: PerAxis<Option<f64>>,
}

impl SignalPlace {
    /// A signal that comes in this tick. The axes lag: one whose set-point stands may still move.
    pub fn seen(plant: &Plant, signal: u8) -> Self {
        let (asked, actual) = (plant.axes.velocity_mm_s(), plant.axes.actual_velocity_mm_s());
        let reach_mm = PerAxis::from_fn(|axis| asked[axis].abs().max(actual[axis].abs()) * LATENESS_S + SLACK_MM);
        let mut place = Self { signal, seen: plant.axes.actual(), reach_mm, latched: PerAxis::default() };
        place.take_latches(plant);
        place
    }

    /// Takes what the drives have latched; in every tick until the axes stand, for the latch may come after the signal.
    pub fn take_latches(&mut self, plant: &Plant) {
        for axis in Axis::ALL {
            let latch = plant.inputs.image.latches[axis].filter(|latch| latch.signal == self.signal);
            let at = latch.and_then(|latch| plant.axes.position_at(axis, latch.encoder_mm));
            let near = at.filter(|at| (at - self.seen[axis]).abs() <= self.reach_mm[axis]);
            self.latched[axis] = self.latched[axis].or(near);
        }
    }

    /// Work coordinates of the place: of each axis what its drive has latched, else what the tick has seen.
    #[must_use]
    pub fn work_position(&self, plant: &Plant) -> WorkPos {
        let machine = MachinePos::from_fn(|axis| self.latched[axis].unwrap_or(self.seen[axis]));
        plant.work.offsets.work_from_machine(machine)
    }
}

/// Arms the touch probes for a signal in this tick. A latch that no signal follows was a pulse of noise: the probes are
/// armed anew.
pub fn await_signal(plant: &mut Plant, signal: u8, place: Option<&SignalPlace>) {
    let is_latched = plant.inputs.image.latches.0.iter().flatten().any(|latch| latch.signal == signal);
    let alone_for = if is_latched && place.is_none() { plant.execution.latch_ticks + 1 } else { 0 };
    let is_noise = f64::from(alone_for) * plant.axes.tick_time().as_secs_f64() > LATENESS_S;
    plant.execution.latch_ticks = alone_for;
    plant.execution.awaited_signal = if is_noise { 0 } else { signal };
}
