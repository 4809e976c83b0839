//! A machine on a field bus, as a [`Backend`](super::Backend): process data to the images of the control and back, lost frames, the
//! safe image of a bus that is lost. It knows no driver: a [`FieldBus`] exchanges the process data.
//! [`FieldBusMachine::read`] exchanges the outputs last written for new inputs; so the frame leaves at the begin of a tick.
//! Files: `description` the machine, `process_image` bit fields, `cia402` the state machine of a drive, `servo_axis` an axis,
//! `bus_fault` what can be wrong.

pub mod bus_fault;
pub mod cia402;
pub mod description;
pub mod process_image;
pub mod servo_axis;

use self::bus_fault::BusFault;
use self::description::{AnalogChannel, CounterChannel, DeviceDescription, MachineDescription};
use self::process_image::{BitField, DeviceImage};
use self::servo_axis::{AxisSetPoint, ServoAxis};
use super::drive::{DriveFault, DriveState};
use super::{Backend, InputImage, OutputImage};
use crate::defs::device_state::DeviceState;
use crate::defs::param::Params;
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

    /// The error code of a drive (603Fh), by mailbox; `None` if it does not answer.
    fn read_error_code(&mut self, device: usize) -> Option<u16>;
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
    images: Vec<DeviceImage>,
    axes: PerAxis<Option<ServoAxis>>,
    handwheel: CounterReader,
    spindle: CounterReader,
    state: BusState,
    statistics: BusStatistics,
    round_trips: Histogram,
    inputs: InputImage,
    /// The inputs have been read at least once.
    has_inputs: bool,
    /// A fault that has not been reported yet.
    report: Option<BusFault>,
    /// RESET: the bus is set up again before the next exchange.
    reconnect: bool,
    /// RESET: until then drives in a fault are reset.
    reset_until: Option<Micros>,
}

impl<F: FieldBus> FieldBusMachine<F> {
    /// Opens the bus. Where a device is missing or differs, the machine stands still and says so; RESET tries again.
    pub fn open(description: MachineDescription, bus: F) -> Self {
        let device_of = |device: u16| description.devices.get(usize::from(device).saturating_sub(1));
        let axes = PerAxis::from_fn(|axis| {
            description.axes()[axis].and_then(|servo| ServoAxis::new(servo, device_of(servo.device)?))
        });
        let images = description.devices.iter().map(|device| {
            let (inputs, outputs) = device.process_data_bytes();
            DeviceImage { inputs: vec![0; usize::from(inputs)], outputs: vec![0; usize::from(outputs)] }
        });
        let mut machine = Self {
            images: images.collect(),
            axes,
            handwheel: CounterReader::new(description.handwheel),
            spindle: CounterReader::new(description.spindle_encoder),
            bus,
            description,
            state: BusState::Down(BusFault::NoReply),
            statistics: BusStatistics::default(),
            round_trips: Histogram::default(),
            inputs: InputImage::default(),
            has_inputs: false,
            report: None,
            reconnect: false,
            reset_until: None,
        };
        machine.connect();
        machine
    }

    fn connect(&mut self) {
        // Nothing of the time before is sent again.
        self.images.iter_mut().for_each(|image| image.outputs.fill(0));
        let mut connected = Err(BusFault::NoReply);
        for _ in 0..CONNECT_ATTEMPTS {
            connected = self.bus.connect(&self.description.devices, &mut self.images);
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

    /// RESET: what is left of a lost bus goes on; only a device that has lost its settings makes all of them start anew.
    fn reconnect(&mut self) {
        if matches!(self.state, BusState::Lost(_)) {
            match self.bus.recover(&mut self.images) {
                Ok(()) => return self.state = BusState::Running(0),
                Err(BusFault::NotOperational { .. }) => {}
                Err(fault) => return self.fail(BusState::Lost(fault), fault),
            }
        }
        self.connect();
    }

    fn fail(&mut self, state: BusState, fault: BusFault) {
        (self.state, self.report) = (state, Some(fault));
    }

    /// Takes the fault that has come since the last call.
    pub const fn take_fault(&mut self) -> Option<BusFault> {
        self.report.take()
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

    /// State of a device, by its index.
    #[must_use]
    pub fn device_state(&self, device: usize) -> DeviceState {
        self.bus.device_state(device)
    }

    /// State of the drive of an axis, as of the last tick.
    #[must_use]
    pub const fn drive_state(&self, axis: Axis) -> DriveState {
        self.inputs.drives.0[axis as usize]
    }

    /// How long the safe image is to be sent at the end: until every brake holds.
    #[must_use]
    pub fn settling_time(&self) -> Micros {
        let slowest = self.axes.0.iter().flatten().map(ServoAxis::engage_time).max();
        SAFE_IMAGE_TIME + slowest.unwrap_or_default()
    }

    /// Counts of cycles and lost frames.
    #[must_use]
    pub const fn statistics(&self) -> BusStatistics {
        self.statistics
    }

    /// One exchange; returns whether the inputs are those of this tick: of a lost bus those of the devices that are left.
    fn exchange(&mut self) -> bool {
        self.statistics.cycles += 1;
        let exchanged = self.bus.exchange(&mut self.images);
        self.statistics.lost += u64::from(exchanged.is_err());
        if exchanged.is_ok() {
            self.round_trips.add(self.bus.round_trip());
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

    /// Decodes the inputs of the devices.
    fn decode(&mut self, now: Micros) {
        self.has_inputs = true;
        let images = &self.images;
        for axis in self.axes.0.iter_mut().flatten() {
            if let Some(image) = images.get(axis.device) {
                axis.read(now, image);
            }
        }
        let mut terminals = Terminals::default();
        for block in &self.description.inputs {
            let Some(image) = image_of(images, block.device) else { continue };
            block.channels().for_each(|(bit, port)| terminals.set(port, bit.read(&image.inputs) == 1));
        }
        self.inputs.terminals = terminals;
        self.inputs.handwheel_detents = self.handwheel.steps(images) as i32;
        self.inputs.spindle_turns += self.spindle.turns(images);
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
            }
            if let Some((port, release)) = servo.brake_release() {
                terminals.set(port, release);
            }
        }
        for block in &self.description.outputs {
            let Some(image) = image_of_mut(&mut self.images, block.device) else { continue };
            for (bit, port) in block.channels() {
                bit.write(&mut image.outputs, u32::from(terminals.is_closed(port)));
            }
        }
        for (channel, volts) in
            [(self.description.wheel_speed, outputs.wheel_volts), (self.description.analog_2, outputs.analog_2_volts)]
        {
            write_analog(channel, volts, &mut self.images);
        }
        self.reconnect |= outputs.fault_reset;
        // Last: all outputs of this tick are in the image.
        self.read_error_code(outputs.drives_on);
    }

    fn rewire(&mut self, _params: &Params) {}
}

fn image_of(images: &[DeviceImage], device: u16) -> Option<&DeviceImage> {
    images.get(usize::from(device).checked_sub(1)?)
}

fn image_of_mut(images: &mut [DeviceImage], device: u16) -> Option<&mut DeviceImage> {
    images.get_mut(usize::from(device).checked_sub(1)?)
}

/// Full scale of the analog outputs, V.
const FULL_SCALE_VOLTS: f64 = 10.0;

fn write_analog(channel: Option<AnalogChannel>, volts: f64, images: &mut [DeviceImage]) {
    let Some(channel) = channel else { return };
    let Some(image) = image_of_mut(images, channel.device) else { return };
    // The largest value of a signed field; the description says whether 10 V are more.
    let most = f64::from(i32::MAX >> (32 - u32::from(channel.bits.clamp(1, 32))));
    let counts = (volts / FULL_SCALE_VOLTS * channel.counts_at_10_v).round().clamp(-most, most) as i32;
    BitField { first: channel.bit, bits: channel.bits }.write(&mut image.outputs, counts.cast_unsigned());
}

/// Reads a counter that wraps.
#[derive(Clone, Copy, Debug)]
struct CounterReader {
    channel: Option<CounterChannel>,
    before: Option<u32>,
    /// Counts that are less than a detent.
    rest: f64,
}

impl CounterReader {
    const fn new(channel: Option<CounterChannel>) -> Self {
        Self { channel, before: None, rest: 0.0 }
    }

    /// Revolutions since the last call.
    fn turns(&mut self, images: &[DeviceImage]) -> f64 {
        let Some(channel) = self.channel else { return 0.0 };
        let Some(image) = image_of(images, channel.device) else { return 0.0 };
        let raw = BitField { first: channel.bit, bits: channel.bits }.read(&image.inputs);
        let before = self.before.replace(raw).unwrap_or(raw);
        let unused = 32 - u32::from(channel.bits.clamp(1, 32));
        let counts = (raw.wrapping_sub(before) << unused).cast_signed() >> unused;
        f64::from(counts) / channel.counts
    }

    /// Whole detents since the last call; what is less is kept.
    fn steps(&mut self, images: &[DeviceImage]) -> f64 {
        self.rest += self.turns(images);
        let whole = self.rest.trunc();
        self.rest -= whole;
        whole
    }
}
