//! A machine on a field bus, as a [`Backend`](super::Backend): process data to the images of the control and back, lost frames, the
//! safe image of a bus that is lost. It knows no driver: a [`FieldBus`] exchanges the process data.
//! [`FieldBusMachine::read`] exchanges the outputs last written for new inputs; so the frame leaves at the begin of a tick.
//! Stations on Modbus TCP are exchanged beside the tick; what they hand over is part of the same images.
//! Files: `description` and `station_description` the machine, `parameter_check` what its parameters exclude, `process_image` bit fields, `cia402` the state machine of a
//! drive, `servo_axis` an axis, `clock_watch` the clock of the bus, `touch_probe` what its drive latches, `station` a station, `inverter` the inverter of the wheel, `channel` places of values, `counter_reader` counters of the handwheel and of the spindle, `port_counters` which cable is bad, `bus_fault` what can be wrong.

pub mod bus_fault;
pub mod channel;
pub mod cia402;
pub mod clock_watch;
mod counter_reader;
pub mod description;
pub mod inverter;
mod parameter_check;
mod port_counters;
pub mod process_image;
pub mod servo_axis;
pub mod station;
pub mod station_description;
pub mod touch_probe;

use self::bus_fault::BusFault;
use self::clock_watch::ClockWatch;
use self::counter_reader::CounterReader;
use self::description::{AnalogChannel, DeviceDescription, MachineDescription};
use self::inverter::InverterReading;
use self::port_counters::PortCounters;
use self::process_image::{BitField, DeviceImage};
use self::servo_axis::{AxisSetPoint, ServoAxis};
use self::station::{Station, StationLink};
use self::station_description::FIRST_STATION;
use super::drive::{DriveFault, DriveState};
use super::{Backend, InputImage, OutputImage};
use crate::defs::device_state::DeviceState;
use crate::defs::param::Params;
use crate::defs::port_errors::{PORTS_OF_DEVICE, PortErrors};
use crate::defs::signal::Terminals;
use crate::units::{Axis, EncoderPos, Histogram, Micros, PerAxis};

/// A driver of a field bus.
pub trait FieldBus {
    /// Looks for the devices, compares them with their descriptions and brings them into operation, without torque.
    /// Takes up to some seconds. Nothing is enabled if a device differs.
    ///
    /// # Errors
    /// What is missing or different.
    fn connect(&mut self, devices: &[DeviceDescription], images: &mut [DeviceImage]) -> Result<(), BusFault>;

    /// Brings devices that have left operation back into it. The others keep their outputs.
    ///
    /// # Errors
    /// A device does not answer; or, as [`BusFault::NotOperational`], it has lost its settings and needs
    /// [`Self::connect`].
    fn recover(&mut self, images: &mut [DeviceImage]) -> Result<(), BusFault>;

    /// Sends the outputs and receives the inputs of one cycle.
    ///
    /// # Errors
    /// The frame is lost, or a device does not take part; inputs of the others are taken.
    fn exchange(&mut self, images: &mut [DeviceImage]) -> Result<(), BusFault>;

    /// State of a device as of the last exchange.
    fn device_state(&self, device: usize) -> DeviceState;

    /// How long the last frame took.
    fn round_trip(&self) -> Micros;

    /// Working counter of the last frame, and that of a whole exchange. `None` while frames are lost.
    fn working_counter(&self) -> Option<(u16, u16)>;

    /// What the reference clock has said of the last frame. `None` without distributed clocks, and while frames are lost.
    fn clock(&self) -> Option<ClockReading>;

    /// The error code of a drive (603Fh), by mailbox; `None` if it does not answer.
    fn read_error_code(&mut self, device: usize) -> Option<u16>;

    /// What the ports of a device have counted, after they have begun anew with `clears`; `None` if it does not answer, or
    /// the bus has no such counters.
    fn read_port_errors(&mut self, _device: usize, _clears: bool) -> Option<[PortErrors; PORTS_OF_DEVICE]> {
        None
    }
}

/// The reference clock of the distributed clocks as a frame passed it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClockReading {
    /// How much later than asked, ns; earlier is negative.
    pub error_ns: i64,
    /// Its time, ns.
    pub time_ns: u64,
    /// When the frame was sent, by the clock of this computer, ns.
    pub sent_ns: u64,
    /// When it was back, by the clock of this computer, ns.
    pub received_ns: u64,
}

/// Whether the bus serves the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BusState {
    /// The devices are not those of the description, or there is no bus: nothing is sent.
    Down(BusFault),
    /// All devices take part. So many frames in a row are missing.
    Running(u32),
    /// Devices are missing. Those that are left get their outputs on, so that their axes stop along the path.
    Lost(BusFault),
}

/// Cycles of the bus and what became of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BusStatistics {
    /// Exchanges.
    pub cycles: u64,
    /// Exchanges without an answer, or without the answer of a device.
    pub lost: u64,
}

/// A machine on a field bus.
pub struct FieldBusMachine<F> {
    bus: F,
    description: MachineDescription,
    /// The devices of the bus, then the stations.
    images: Vec<DeviceImage>,
    stations: Vec<Station>,
    axes: PerAxis<Option<ServoAxis>>,
    handwheel: CounterReader,
    spindle: CounterReader,
    state: BusState,
    statistics: BusStatistics,
    round_trips: Histogram,
    clock_errors: Histogram,
    clock_watch: ClockWatch,
    ports: PortCounters,
    inputs: InputImage,
    /// The inputs have been read at least once.
    has_inputs: bool,
    /// Code of the fault of the inverter; 0 is none.
    inverter_fault: u32,
    /// Faults that have not been reported yet: of the bus, of a station, of the inverter.
    reports: [Option<BusFault>; 3],
    /// RESET: the bus is set up again before the next exchange.
    reconnect: bool,
    /// RESET: a station that is silent is reported again.
    state_again: bool,
    /// RESET: until then drives in a fault are reset.
    reset_until: Option<Micros>,
}

impl<F: FieldBus> FieldBusMachine<F> {
    /// A machine whose bus is not in operation yet. `links` are the drivers of the stations, in their order.
    pub fn new(description: MachineDescription, bus: F, links: Vec<Box<dyn StationLink>>) -> Self {
        assert_eq!(description.stations.len(), links.len(), "every station has a driver");
        let device_of = |device: u16| description.devices.get(usize::from(device).saturating_sub(1));
        let axes = PerAxis::from_fn(|axis| {
            description.axes()[axis].and_then(|servo| ServoAxis::new(servo, device_of(servo.device)?))
        });
        let images = description.process_data_bytes().map(|(inputs, outputs)| DeviceImage {
            inputs: vec![0; usize::from(inputs)],
            outputs: vec![0; usize::from(outputs)],
        });
        let stations = links.into_iter().zip(&description.stations);
        let stations = stations.map(|(link, station)| Station::new(link, Micros::from_millis(station.max_age_ms)));
        Self {
            images: images.collect(),
            stations: stations.collect(),
            axes,
            handwheel: CounterReader::new(description.handwheel),
            spindle: CounterReader::new(description.spindle_encoder),
            ports: PortCounters::new(description.devices.len()),
            bus,
            description,
            state: BusState::Down(BusFault::NoReply),
            statistics: BusStatistics::default(),
            round_trips: Histogram::default(),
            clock_errors: Histogram::default(),
            clock_watch: ClockWatch::default(),
            inputs: InputImage::default(),
            has_inputs: false,
            inverter_fault: 0,
            reports: [None; 3],
            reconnect: false,
            state_again: false,
            reset_until: None,
        }
    }

    /// Brings the bus into operation; the ticks follow at once, because the watchdogs of the devices run from now on. Where
    /// a device is missing or differs, the machine stands still and says so; RESET tries again.
    pub fn connect(&mut self) {
        // Nothing of the time before is sent again.
        self.images.iter_mut().for_each(|image| image.outputs.fill(0));
        self.clock_watch.forget();
        let mut connected = Err(BusFault::NoReply);
        for _ in 0..CONNECT_ATTEMPTS {
            let devices = &self.description.devices;
            connected = self.bus.connect(devices, &mut self.images[..devices.len()]);
            // A frame may be late while the computer starts; what differs stays different.
            if !matches!(connected, Err(BusFault::NoReply | BusFault::Other)) {
                break;
            }
        }
        match connected {
            Ok(()) => self.state = BusState::Running(0),
            Err(fault) => self.fail(BusState::Down(fault), fault),
        }
    }

    /// Whether an exchange with every station has been tried.
    #[must_use]
    pub fn are_stations_tried(&mut self) -> bool {
        let stations = self.stations.iter_mut().zip(self.images.iter_mut().skip(self.description.devices.len()));
        stations.fold(true, |tried, (station, image)| station.take(Micros::ZERO, image) && tried)
    }

    /// RESET: what is left of a lost bus goes on; only a device that has lost its settings, or the time, makes all of them
    /// start anew.
    fn reconnect(&mut self) {
        self.stations.iter_mut().for_each(|station| station.hold(RECONNECT_TIME));
        if matches!(self.state, BusState::Lost(fault) if fault != BusFault::ClockJumped) {
            match self.bus.recover(&mut self.images[..self.description.devices.len()]) {
                Ok(()) => return self.state = BusState::Running(0),
                Err(BusFault::NotOperational { .. }) => {}
                Err(fault) => return self.fail(BusState::Lost(fault), fault),
            }
        }
        self.connect();
    }

    fn fail(&mut self, state: BusState, fault: BusFault) {
        (self.state, self.reports[0]) = (state, Some(fault));
    }

    /// Takes a fault that has come since the last call.
    pub fn take_fault(&mut self) -> Option<BusFault> {
        self.reports.iter_mut().find_map(Option::take)
    }

    /// The stations, in the order of their description.
    #[must_use]
    pub fn stations(&self) -> &[Station] {
        &self.stations
    }

    /// What each station sends and gets.
    #[must_use]
    pub fn station_images(&self) -> &[DeviceImage] {
        &self.images[self.description.devices.len()..]
    }

    /// What is wrong with the bus now.
    #[must_use]
    pub const fn fault(&self) -> Option<BusFault> {
        match self.state {
            BusState::Running(_) => None,
            BusState::Down(fault) | BusState::Lost(fault) => Some(fault),
        }
    }

    /// The description.
    #[must_use]
    pub const fn description(&self) -> &MachineDescription {
        &self.description
    }

    /// Times from sending a frame until it is back.
    #[must_use]
    pub const fn round_trips(&self) -> &Histogram {
        &self.round_trips
    }

    /// Working counter of the frame of this tick, and that of a whole exchange; `None` if the frame was lost.
    #[must_use]
    pub fn working_counter(&self) -> Option<(u16, u16)> {
        self.bus.working_counter()
    }

    /// What the reference clock has said of the frame of this tick; `None` without such a clock.
    #[must_use]
    pub fn clock(&self) -> Option<ClockReading> {
        self.bus.clock()
    }

    /// Distances of the frames from the time that the reference clock asks for.
    #[must_use]
    pub const fn clock_errors(&self) -> &Histogram {
        &self.clock_errors
    }

    /// State of a device, by its index.
    #[must_use]
    pub fn device_state(&self, device: usize) -> DeviceState {
        self.bus.device_state(device)
    }

    /// What the ports of a device have counted, by its index, as they were read last.
    #[must_use]
    pub fn port_errors(&self, device: usize) -> [PortErrors; PORTS_OF_DEVICE] {
        self.ports.of_device(device)
    }

    /// State of the drive of an axis, as of the last tick.
    #[must_use]
    pub const fn drive_state(&self, axis: Axis) -> DriveState {
        self.inputs.drives.0[axis as usize]
    }

    /// Torque of the drive of an axis in percent of the rated one, where it sends it.
    #[must_use]
    pub fn torque_percent(&self, axis: Axis) -> Option<f64> {
        self.axes[axis].as_ref().and_then(ServoAxis::torque_percent)
    }

    /// What the encoder of an axis counts, once it has been read.
    #[must_use]
    pub fn raw_count(&self, axis: Axis) -> Option<i32> {
        self.axes[axis].as_ref().and_then(ServoAxis::raw_count)
    }

    /// What the inverter reports, if there is one.
    #[must_use]
    pub fn inverter(&self) -> Option<InverterReading> {
        let inverter = self.description.inverter.as_ref()?;
        let image = |device| self.images.get(self.description.image_index(device)?);
        Some(inverter.reading(self.inverter_fault, image))
    }

    /// How long the safe image is to be sent at the end: until every brake holds.
    #[must_use]
    pub fn settling_time(&self) -> Micros {
        let slowest = self.axes.0.iter().flatten().map(ServoAxis::engage_time).max();
        SAFE_IMAGE_TIME + slowest.unwrap_or_default()
    }

    /// Counts and times begin anew; those of the ports while the drives are off.
    pub fn clear_counters(&mut self) {
        self.statistics = BusStatistics::default();
        self.round_trips.clear();
        self.clock_errors.clear();
        self.stations.iter_mut().for_each(Station::clear_times);
        self.ports.clear();
    }

    /// Counts of cycles and lost frames.
    #[must_use]
    pub const fn statistics(&self) -> BusStatistics {
        self.statistics
    }

    /// One exchange; returns whether the inputs are those of this tick: of a lost bus those of the devices that are left.
    fn exchange(&mut self) -> bool {
        self.statistics.cycles += 1;
        let exchanged = self.bus.exchange(&mut self.images[..self.description.devices.len()]);
        self.statistics.lost += u64::from(exchanged.is_err());
        if exchanged.is_ok() {
            self.round_trips.add(self.bus.round_trip());
            if let Some(reading) = self.bus.clock() {
                self.clock_errors.add(Micros(reading.error_ns.unsigned_abs() / 1_000));
                if self.clock_watch.has_jumped(reading) && matches!(self.state, BusState::Running(_)) {
                    self.fail(BusState::Lost(BusFault::ClockJumped), BusFault::ClockJumped);
                }
            }
        }
        match (self.state, exchanged) {
            (BusState::Running(_), Ok(())) => self.state = BusState::Running(0),
            (BusState::Running(missing), Err(fault)) if missing >= self.description.ethercat.bridged_frames => {
                self.fail(BusState::Lost(fault), fault);
            }
            (BusState::Running(missing), Err(_)) => self.state = BusState::Running(missing + 1),
            (BusState::Lost(_) | BusState::Down(_), _) => {}
        }
        let came_back = |fault: &BusFault| !matches!(fault, BusFault::FrameLost | BusFault::NoReply);
        exchanged.is_ok() || matches!((self.state, exchanged), (BusState::Lost(_), Err(fault)) if came_back(&fault))
    }

    /// Takes what the stations have sent. The counters of a silent one begin anew: what was turned meanwhile moves nothing.
    fn read_stations(&mut self, now: Micros) {
        let places = self.images.iter_mut().skip(self.description.devices.len());
        for ((station, image), number) in self.stations.iter_mut().zip(places).zip(FIRST_STATION..) {
            let was_silent = station.is_silent();
            let falls_silent = station.read(now, image);
            if (falls_silent || self.state_again && station.is_silent()) && self.reports[1].is_none() {
                self.reports[1] = Some(BusFault::StationSilent { station: number, why: station.why() });
            }
            if was_silent {
                [&mut self.handwheel, &mut self.spindle].into_iter().for_each(|counter| counter.forget(number));
            }
        }
        self.state_again = false;
        self.inputs.station_silent = self.stations.iter().any(Station::is_silent);
    }

    /// Decodes the inputs of devices and stations.
    fn decode(&mut self, now: Micros) {
        self.has_inputs = true;
        let (description, images) = (&self.description, &self.images);
        for axis in self.axes.0.iter_mut().flatten() {
            if let Some(image) = images.get(axis.device) {
                axis.read(now, image);
            }
        }
        let mut terminals = Terminals::default();
        for block in &description.inputs {
            let Some(image) = description.image_index(block.device).and_then(|at| images.get(at)) else { continue };
            block.channels().for_each(|(bit, port)| terminals.set(port, bit.read(&image.inputs) == 1));
        }
        self.inputs.terminals = terminals;
        self.inputs.handwheel_detents = self.handwheel.steps(description, images) as i32;
        self.inputs.spindle_turns += self.spindle.turns(description, images);
        let code = description
            .inverter
            .as_ref()
            .map_or(0, |inverter| inverter.fault_code(|device| images.get(description.image_index(device)?)));
        if code != 0 && code != self.inverter_fault {
            self.reports[2] = Some(BusFault::InverterFault { code });
        }
        (self.inverter_fault, self.inputs.inverter_tripped) = (code, code != 0);
    }

    /// Port counters are read while the drives are without torque: another frame takes time. They go on counting
    /// meanwhile, and behind a lost frame the drives go off.
    fn read_port_errors(&mut self, now: Micros, drives_on: bool) {
        if !drives_on && !matches!(self.state, BusState::Down(_)) {
            let bus = &mut self.bus;
            self.ports.step(now, |device, clears| bus.read_port_errors(device, clears));
        }
    }

    fn write_inverter_reset(&mut self) {
        let Some(reset) = self.description.inverter.as_ref().and_then(|inverter| inverter.reset) else { return };
        let place = self.description.image_index(reset.device);
        if let Some(image) = place.and_then(|at| self.images.get_mut(at)) {
            reset.field().write(&mut image.outputs, u32::from(self.reset_until.is_some()));
        }
    }

    /// The code of a fault is read once the drives are without torque: a mailbox takes longer than a cycle.
    fn read_error_code(&mut self, drives_on: bool) {
        if drives_on || !matches!(self.state, BusState::Running(_)) {
            return;
        }
        let Some(axis) = self.axes.0.iter_mut().flatten().find(|axis| axis.is_code_missing()) else { return };
        // A drive without a code has the generic one.
        let code = self.bus.read_error_code(axis.device).filter(|code| *code != 0).unwrap_or(GENERIC_ERROR);
        axis.set_fault(DriveFault(code));
    }
}

/// How long the safe image is sent at the end, beside the time of the brakes: drives take some cycles to switch off.
const SAFE_IMAGE_TIME: Micros = Micros::from_millis(300);
/// How long RESET resets drives: those behind a bus that is set up again report their faults after it.
const RESET_TIME: Micros = Micros::from_millis(1_000);
/// How long a new start of the bus may take, without a tick that renews the outputs of stations.
const RECONNECT_TIME: Micros = Micros::from_millis(10_000);
/// Attempts to connect while nothing answers.
const CONNECT_ATTEMPTS: u32 = 3;
/// Error code "generic error" (CiA 301).
const GENERIC_ERROR: u16 = 0x1000;

impl<F: FieldBus> Backend for FieldBusMachine<F> {
    fn read(&mut self, now: Micros) -> InputImage {
        if std::mem::take(&mut self.reconnect) && !matches!(self.state, BusState::Running(_)) {
            self.reconnect();
        }
        self.inputs.handwheel_detents = 0;
        self.read_stations(now);
        let is_fresh = !matches!(self.state, BusState::Down(_)) && self.exchange();
        match self.state {
            _ if is_fresh => self.decode(now),
            BusState::Running(_) => self.axes.0.iter_mut().flatten().for_each(ServoAxis::extrapolate),
            BusState::Down(_) | BusState::Lost(_) => {}
        }
        if matches!(self.state, BusState::Lost(_)) {
            for axis in self.axes.0.iter_mut().flatten() {
                if self.bus.device_state(axis.device) != DeviceState::Operational {
                    axis.lose();
                }
            }
        }
        self.inputs.bus_alive = self.has_inputs && matches!(self.state, BusState::Running(_));
        let (axes, alive) = (&self.axes, self.inputs.bus_alive);
        self.inputs.encoder_mm = EncoderPos::from_fn(|axis| axes[axis].as_ref().map_or(0.0, ServoAxis::encoder_mm));
        self.inputs.absolute = PerAxis::from_fn(|axis| axes[axis].as_ref().is_some_and(ServoAxis::is_absolute));
        self.inputs.latches = PerAxis::from_fn(|axis| axes[axis].as_ref().and_then(ServoAxis::latch));
        self.inputs.torque_percent = PerAxis::from_fn(|axis| axes[axis].as_ref().and_then(ServoAxis::torque_percent));
        self.inputs.drives = PerAxis::from_fn(|axis| match &axes[axis] {
            Some(servo) if alive => servo.state(now),
            Some(_) | None => DriveState::Off,
        });
        self.inputs
    }

    fn write(&mut self, now: Micros, outputs: &OutputImage) {
        if outputs.fault_reset {
            self.reset_until = Some(now + RESET_TIME);
        }
        let reset_over = self.reset_until.is_some_and(|until| now >= until);
        if reset_over {
            self.reset_until = None;
        }
        let mut terminals = outputs.terminals;
        for axis in Axis::ALL {
            let Some(servo) = &mut self.axes[axis] else { continue };
            if outputs.fault_reset {
                servo.reset_fault();
            }
            if reset_over {
                servo.end_reset();
            }
            let asked = AxisSetPoint { position_mm: outputs.set_point_mm[axis], on: outputs.drives_on };
            if let Some(image) = self.images.get_mut(servo.device) {
                servo.write(now, asked, image);
                servo.arm_probe(outputs.awaited_signal, image);
            }
            if let Some((port, release)) = servo.brake_release() {
                terminals.set(port, release);
            }
        }
        for block in &self.description.outputs {
            let place = self.description.image_index(block.device);
            let Some(image) = place.and_then(|at| self.images.get_mut(at)) else { continue };
            for (bit, port) in block.channels() {
                bit.write(&mut image.outputs, u32::from(terminals.is_closed(port)));
            }
        }
        for (channel, volts) in
            [(self.description.wheel_speed, outputs.wheel_volts), (self.description.analog_2, outputs.analog_2_volts)]
        {
            let Some(channel) = channel else { continue };
            let place = self.description.image_index(channel.device);
            if let Some(image) = place.and_then(|at| self.images.get_mut(at)) {
                write_analog(channel, volts, image);
            }
        }
        self.write_inverter_reset();
        // The stations of a machine that another process runs are left alone.
        if self.state != BusState::Down(BusFault::InUse) {
            let places = self.images.iter().skip(self.description.devices.len());
            self.stations.iter_mut().zip(places).for_each(|(station, image)| station.write(image));
        }
        if outputs.fault_reset {
            self.stations.iter_mut().for_each(Station::release);
            self.state_again = true;
        }
        self.reconnect |= outputs.fault_reset;
        // Last: all outputs of this tick are in the image.
        self.read_error_code(outputs.drives_on);
        self.read_port_errors(now, outputs.drives_on);
    }

    fn rewire(&mut self, _params: &Params) {}
}

/// Full scale of the analog outputs, V.
const FULL_SCALE_VOLTS: f64 = 10.0;

fn write_analog(channel: AnalogChannel, volts: f64, image: &mut DeviceImage) {
    // The largest value of a signed field; the description says whether 10 V are more.
    let most = f64::from(i32::MAX >> (32 - u32::from(channel.bits.clamp(1, 32))));
    let counts = (volts / FULL_SCALE_VOLTS * channel.counts_at_10_v).round().clamp(-most, most) as i32;
    BitField { first: channel.bit, bits: channel.bits }.write(&mut image.outputs, counts.cast_unsigned());
}
