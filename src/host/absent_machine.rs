//! A real machine whose description cannot be used: the pages work, nothing of the machine does. Never another machine in
//! its place. Source: spec P1; safety stance.

use std::sync::Arc;

use super::hosted_machine::HostedMachine;
use super::pace::{Pace, ThreadTimes};
use crate::defs::param::Params;
use crate::defs::text::LocalizedText;
use crate::io::fieldbus::ClockReading;
use crate::io::sim::{PartFile, SimulatedMachine};
use crate::io::{Backend, InputImage, OutputImage};
use crate::link::bus::BusView;
use crate::link::simulation::{SimCommand, SimView};
use crate::units::Micros;

/// A machine that does not answer.
#[derive(Clone, Copy, Debug, Default)]
pub struct AbsentMachine;

impl Backend for AbsentMachine {
    fn read(&mut self, _now: Micros) -> InputImage {
        InputImage { bus_alive: false, ..InputImage::default() }
    }

    fn write(&mut self, _now: Micros, _outputs: &OutputImage) {}

    fn rewire(&mut self, _params: &Params) {}
}

impl HostedMachine for AbsentMachine {
    fn pace(&self) -> Pace {
        Pace::Real
    }

    fn begin(&mut self) {}

    fn power_on(&mut self, _params: &Params) {}

    fn mount_part(&mut self, _part: &PartFile) {}

    fn measure_finished_part(&mut self) {}

    fn simulate(&mut self, _command: SimCommand) {}

    fn view(&mut self, _now: Micros) -> Option<Arc<SimView>> {
        None
    }

    fn simulation(&mut self) -> Option<&mut SimulatedMachine> {
        None
    }

    fn bus_view(&mut self, _now: Micros, _times: &ThreadTimes) -> Option<Arc<BusView>> {
        None
    }

    fn clear_counters(&mut self) {}

    fn bus_clock(&mut self) -> Option<ClockReading> {
        None
    }

    fn settling_time(&self) -> Micros {
        Micros(0)
    }

    fn take_bus_fault(&mut self) -> Option<(u16, LocalizedText)> {
        None
    }
}
