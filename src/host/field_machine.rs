//! A machine on a field bus under a host: the duties of a simulated machine are empty, the part is the operator's.
//! Source: spec P1–P8; safety stance.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::description_lines::description_lines;
use super::hosted_machine::HostedMachine;
use super::pace::{Pace, ThreadTimes};
use crate::defs::param::Params;
use crate::defs::text::LocalizedText;
use crate::io::fieldbus::bus_fault::BusFault;
use crate::io::fieldbus::description::MachineDescription;
use crate::io::fieldbus::inverter::InverterReading;
use crate::io::fieldbus::station::StationFault;
use crate::io::fieldbus::station_description::FIRST_STATION;
use crate::io::fieldbus::{ClockReading, FieldBus, FieldBusMachine};
use crate::io::sim::{PartFile, SimulatedMachine};
use crate::io::{Backend, InputImage, OutputImage};
use crate::link::bus::{BusClock, BusDevice, BusDrive, BusInverter, BusStation, BusView, DescriptionLine};
use crate::link::simulation::{SimCommand, SimView};
use crate::units::{Axis, Micros};

/// The view of the bus page is built anew so often.
const VIEW_INTERVAL: Micros = Micros::from_millis(250);

/// Longest wait for the stations beside the bus at the start.
const STATION_TIME: Duration = Duration::from_millis(1_000);

/// A machine on a field bus, and what its page shows.
pub struct HostedFieldBus<F> {
    machine: FieldBusMachine<F>,
    description: Arc<[DescriptionLine]>,
    view: Arc<BusView>,
    viewed_at: Option<Micros>,
}

impl<F: FieldBus> HostedFieldBus<F> {
    /// A host's machine on a bus.
    #[must_use]
    pub fn new(machine: FieldBusMachine<F>) -> Self {
        let description = description_lines(machine.description()).into();
        Self { machine, description, view: Arc::default(), viewed_at: None }
    }

    fn build_view(&self, times: &ThreadTimes) -> BusView {
        let Self { machine, .. } = self;
        let description = machine.description();
        let fitted = description.axes();
        let drive_of = |number: u16| {
            let is_its = |axis: &Axis| fitted[*axis].is_some_and(|servo| servo.device == number);
            let axis = Axis::ALL.into_iter().find(is_its)?;
            let state = machine.drive_state(axis);
            Some(BusDrive {
                axis,
                state: state.text(),
                tripped: state.fault().is_some(),
                raw_count: machine.raw_count(axis),
                torque_percent: machine.torque_percent(axis),
            })
        };
        let devices = description.devices.iter().zip(1..).map(|(device, number)| BusDevice {
            name: device.name.clone(),
            identity: (device.vendor, device.product),
            state: machine.device_state(usize::from(number) - 1),
            drive: drive_of(number),
            ports: machine.port_errors(usize::from(number) - 1),
        });
        let numbered = description.stations.iter().zip(FIRST_STATION..).zip(machine.stations());
        let stations = numbered.map(|((described, number), station)| {
            let health = station.health();
            BusStation {
                number,
                name: described.name.clone(),
                address: described.address.to_string(),
                is_heard: !station.is_silent(),
                age: station.age(),
                fault: health.fault.or(health.locked).map(StationFault::text),
                failures: health.failures,
                round_trip: station.round_trips().percentiles(),
            }
        });
        let counted = machine.statistics();
        BusView {
            interface: description.ethercat.interface.clone(),
            fault: machine.fault().map(BusFault::text),
            devices: devices.collect(),
            stations: stations.collect(),
            cycles: counted.cycles,
            lost: counted.lost,
            working_counter: machine.working_counter(),
            execution: times.executions.distribution(),
            round_trip: machine.round_trips().distribution(),
            wake_up: times.wake_ups.distribution(),
            rights: times.rights,
            clock: description.ethercat.distributed_clocks.map(|_| BusClock {
                distance: machine.clock_errors().distribution(),
                drift_ppm: times.bus_clock.drift_ppm(),
            }),
            inverter: machine.inverter().map(|reading| inverter_view(description, reading)),
            description: Arc::clone(&self.description),
        }
    }
}

/// What the inverter reports.
fn inverter_view(description: &MachineDescription, reading: InverterReading) -> BusInverter {
    let InverterReading { rpm, load_percent, fault_code: code } = reading;
    let device = description.inverter.as_ref().map_or(0, |inverter| inverter.fault.device);
    let fault = (code != 0).then(|| fault_text(description, BusFault::InverterFault { code }));
    BusInverter { device, rpm, load_percent, fault }
}

/// A fault in words; those of an inverter are in the description of the machine.
fn fault_text(description: &MachineDescription, fault: BusFault) -> LocalizedText {
    let BusFault::InverterFault { code } = fault else { return fault.text() };
    let known = description.inverter.as_ref().and_then(|inverter| inverter.words(code));
    known.map_or_else(|| fault.text(), |(zh, en)| LocalizedText::new(format!("{code} {zh}"), format!("{code} {en}")))
}

impl<F: FieldBus> Backend for HostedFieldBus<F> {
    fn read(&mut self, now: Micros) -> InputImage {
        self.machine.read(now)
    }

    fn write(&mut self, now: Micros, outputs: &OutputImage) {
        self.machine.write(now, outputs);
    }

    fn rewire(&mut self, params: &Params) {
        self.machine.rewire(params);
    }
}

impl<F: FieldBus> HostedMachine for HostedFieldBus<F> {
    fn pace(&self) -> Pace {
        Pace::Real
    }

    fn core(&self) -> Option<u16> {
        self.machine.description().core
    }

    fn begin(&mut self) {
        // Their first values are there before the first tick.
        let end = Instant::now() + STATION_TIME;
        while !self.machine.are_stations_tried() && Instant::now() < end {
            std::thread::sleep(Duration::from_millis(1));
        }
        self.machine.connect();
    }

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

    fn clear_counters(&mut self) {
        self.machine.clear_counters();
        self.viewed_at = None;
    }

    fn bus_clock(&mut self) -> Option<ClockReading> {
        self.machine.clock()
    }

    fn bus_view(&mut self, now: Micros, times: &ThreadTimes) -> Option<Arc<BusView>> {
        if self.viewed_at.is_none_or(|at| now.since(at) >= VIEW_INTERVAL) {
            self.viewed_at = Some(now);
            self.view = Arc::new(self.build_view(times));
        }
        Some(Arc::clone(&self.view))
    }

    fn settling_time(&self) -> Micros {
        self.machine.settling_time()
    }

    fn take_bus_fault(&mut self) -> Option<(u16, LocalizedText)> {
        let fault = self.machine.take_fault()?;
        Some((fault.alarm(), fault_text(self.machine.description(), fault)))
    }
}
