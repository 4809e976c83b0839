//! What a host asks of the machine beside reading and writing it in the tick.
//! Source: spec P1–P8, T1–T5.

use std::sync::Arc;

use super::pace::{Pace, ThreadTimes};
use crate::defs::param::Params;
use crate::defs::text::LocalizedText;
use crate::io::Backend;
use crate::io::fieldbus::ClockReading;
use crate::io::sim::{PartFile, SimulatedMachine};
use crate::link::bus::BusView;
use crate::link::simulation::{SimCommand, SimView};
use crate::units::Micros;

/// A machine under a host. A field bus implements the duties of a simulated machine with empty bodies: nothing is
/// inherited, so that no duty is forgotten.
pub trait HostedMachine: Backend {
    /// How strictly its ticks are kept.
    fn pace(&self) -> Pace;
    /// The core of the computer on which its ticks run; `None`: any.
    fn core(&self) -> Option<u16> {
        None
    }
    /// The ticks begin: a field bus goes into operation.
    fn begin(&mut self);
    /// The control gets its power back; the parameters are those it starts with.
    fn power_on(&mut self, params: &Params);
    /// Puts an unmachined part into the machine.
    fn mount_part(&mut self, part: &PartFile);
    /// A cycle has ended: keeps the sizes of its part.
    fn measure_finished_part(&mut self);
    /// Executes a command of the simulator page.
    fn simulate(&mut self, command: SimCommand);
    /// What the simulator page shows at `now`; `None` without a simulated machine.
    fn view(&mut self, now: Micros) -> Option<Arc<SimView>>;
    /// The simulated machine, if it is one.
    fn simulation(&mut self) -> Option<&mut SimulatedMachine>;
    /// What the bus page shows at `now`, with the times of the thread; `None` without a bus.
    fn bus_view(&mut self, now: Micros, times: &ThreadTimes) -> Option<Arc<BusView>>;
    /// The counters and times of its bus begin anew.
    fn clear_counters(&mut self);
    /// What the clock of its bus has said of this tick; `None` without such a clock.
    fn bus_clock(&mut self) -> Option<ClockReading>;
    /// How long it gets the safe image at the end; 0 for a simulated machine.
    fn settling_time(&self) -> Micros;
    /// What is wrong with its bus, once when it comes: the alarm and its detail. `None` without a bus.
    fn take_bus_fault(&mut self) -> Option<(u16, LocalizedText)>;
}
