//! The description of a real machine (`machine.ron`): its bus, its devices, and what their process data mean.
//! Parses and checks text; the caller reads the file.
//! Source: docs/manual, chapter "first start on a machine"; CiA 402-2 for the objects of drives.

use serde::Deserialize;

use super::bus_fault::DeviceIdentity;
use super::channel::CounterChannel;
use super::inverter::InverterDescription;
use super::process_image::{BitField, MAX_FIELD_BITS};
use super::station_description::{FIRST_STATION, MAX_STATIONS, StationDescription};
use super::touch_probe::{TOUCH_PROBE_FUNCTION, TouchProbe, TouchProbeDescription};
use crate::defs::kind::Kind;
use crate::defs::signal::PORTS;
use crate::units::{Axis, PerAxis};

/// Most devices of a bus: the stack reserves memory for them.
pub const MAX_DEVICES: usize = 32;
/// Most cores of a computer that the system can name.
const MAX_CORES: u16 = 1_024;
/// Most bytes of inputs, and of outputs, of a device.
const MAX_DEVICE_BYTES: u16 = 256;
/// Most entries in the inputs or the outputs of a device.
const MAX_ENTRIES: usize = 64;

/// Controlword.
pub const CONTROLWORD: u16 = 0x6040;
/// Statusword.
pub const STATUSWORD: u16 = 0x6041;
/// Mode of operation.
pub const MODE: u16 = 0x6060;
/// Target position, counts.
pub const TARGET_POSITION: u16 = 0x607a;
/// Actual position, counts.
pub const ACTUAL_POSITION: u16 = 0x6064;
/// Actual torque, 0.1 % of the rated one.
pub const ACTUAL_TORQUE: u16 = 0x6077;
/// Error code.
pub const ERROR_CODE: u16 = 0x603f;

/// Why a description is not taken.
#[derive(Debug, thiserror::Error)]
pub enum DescriptionError {
    /// It is no RON text of this form.
    #[error("{0}; see assets/machines/*_ethercat.ron for examples")]
    Syntax(#[from] ron::error::SpannedError),
    /// A value is wrong or missing.
    #[error("{place}: {rule}")]
    Wrong {
        /// Where: the names of the fields.
        place: String,
        /// What must hold.
        rule: &'static str,
    },
}

/// A real machine.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineDescription {
    /// Kind of machine.
    pub kind: Kind,
    /// The EtherCAT network.
    pub ethercat: EtherCatDescription,
    /// Core of the computer on which the control runs, from 0; any without it. Best one that serves nothing else
    /// (`isolcpus`).
    #[serde(default)]
    pub core: Option<u16>,
    /// The devices in the order of the cable.
    pub devices: Vec<DeviceDescription>,
    /// Stations on Modbus TCP: devices 101, 102 …
    #[serde(default)]
    pub stations: Vec<StationDescription>,
    /// Axis X.
    #[serde(default)]
    pub x: Option<ServoAxisDescription>,
    /// Axis Y.
    #[serde(default)]
    pub y: Option<ServoAxisDescription>,
    /// Axis Z.
    #[serde(default)]
    pub z: Option<ServoAxisDescription>,
    /// Inputs of devices to ports of the input terminals.
    #[serde(default)]
    pub inputs: Vec<DigitalChannels>,
    /// Ports of the output terminals to outputs of devices.
    #[serde(default)]
    pub outputs: Vec<DigitalChannels>,
    /// First analog output: speed of the wheel or of the main spindle.
    #[serde(default)]
    pub wheel_speed: Option<AnalogChannel>,
    /// Second analog output (`M63 S`).
    #[serde(default)]
    pub analog_2: Option<AnalogChannel>,
    /// The inverter of the wheel or of the main spindle.
    #[serde(default)]
    pub inverter: Option<InverterDescription>,
    /// Counter of the handwheel.
    #[serde(default)]
    pub handwheel: Option<CounterChannel>,
    /// Encoder of the main spindle.
    #[serde(default)]
    pub spindle_encoder: Option<CounterChannel>,
}

/// The EtherCAT network. The cycle is the control's own (P58).
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EtherCatDescription {
    /// Network interface of the computer, e.g. `enp2s0`. It serves nothing else.
    pub interface: String,
    /// How long a frame may take, µs; less than the cycle.
    #[serde(default = "default_reply_time_us")]
    pub reply_time_us: u64,
    /// Lost frames in a row that are bridged; one more is an alarm.
    #[serde(default = "default_bridged_frames")]
    pub bridged_frames: u32,
    /// The clocks of the devices are synchronised, and the tick follows them. Without it the computer's clock counts.
    #[serde(default)]
    pub distributed_clocks: Option<ClockDescription>,
}

/// The distributed clocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClockDescription {
    /// Period of SYNC0, µs: the cycle of the control (P58).
    pub cycle_us: u32,
    /// From SYNC0 until the frame passes the first clock, µs; half the cycle without it: most room for either to be late.
    #[serde(default)]
    pub shift_us: Option<u32>,
}

impl ClockDescription {
    /// From SYNC0 until the frame passes the first clock, µs.
    #[must_use]
    pub fn shift_us(self) -> u32 {
        self.shift_us.unwrap_or(self.cycle_us / 2)
    }
}

const fn default_reply_time_us() -> u64 {
    500
}

const fn default_bridged_frames() -> u32 {
    2
}

/// A device of the bus.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviceDescription {
    /// What it is, for the fitter.
    pub name: String,
    /// Vendor.
    pub vendor: u32,
    /// Product.
    pub product: u32,
    /// Revision; without it any one fits.
    #[serde(default)]
    pub revision: u32,
    /// Its process data outputs, in their order.
    #[serde(default)]
    pub outputs: Vec<PdoEntry>,
    /// Its process data inputs, in their order.
    #[serde(default)]
    pub inputs: Vec<PdoEntry>,
    /// Whether the entries are written to the device at the start (objects 1600h, 1A00h, 1C12h, 1C13h).
    #[serde(default)]
    pub assign: bool,
    /// Whether it works at SYNC0 of the distributed clocks.
    #[serde(default)]
    pub sync0: bool,
    /// Objects that are written at the start.
    #[serde(default)]
    pub startup: Vec<SdoWrite>,
}

impl DeviceDescription {
    /// Its identity.
    #[must_use]
    pub const fn identity(&self) -> DeviceIdentity {
        DeviceIdentity { vendor: self.vendor, product: self.product, revision: self.revision }
    }

    /// Its touch probe, if it is a drive that has the objects.
    #[must_use]
    pub fn touch_probe(&self, described: TouchProbeDescription) -> Option<TouchProbe> {
        TouchProbe::new(described, |object| field_of(&self.outputs, object), |object| field_of(&self.inputs, object))
    }

    /// Bytes of its inputs and outputs.
    #[must_use]
    pub fn process_data_bytes(&self) -> (u16, u16) {
        let bits = |entries: &[PdoEntry]| entries.iter().map(|entry| u32::from(entry.total_bits())).sum::<u32>();
        let bytes = |entries: &[PdoEntry]| u16::try_from(bits(entries).div_ceil(8)).unwrap_or(u16::MAX);
        (bytes(&self.inputs), bytes(&self.outputs))
    }
}

/// An entry of process data, or several equal ones in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PdoEntry {
    /// Index of the object; 0 is a gap.
    pub object: u16,
    /// Subindex; of several entries that of the first one.
    #[serde(default)]
    pub sub: u8,
    /// Bits of the entry, 1 to 32.
    pub bits: u16,
    /// Number of entries, with rising subindices.
    #[serde(default = "one")]
    pub count: u16,
}

const fn one() -> u16 {
    1
}

impl PdoEntry {
    const fn total_bits(self) -> u16 {
        self.bits.saturating_mul(self.count)
    }
}

/// An object that is written at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SdoWrite {
    /// Index.
    pub object: u16,
    /// Subindex.
    #[serde(default)]
    pub sub: u8,
    /// Length, bits: 8, 16 or 32.
    pub bits: u16,
    /// Value; a negative one in two's complement.
    pub value: i64,
}

/// A servo axis.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoAxisDescription {
    /// Number of its drive in `devices`, from 1.
    pub device: u16,
    /// Encoder counts for 1 mm of the slide (radius on X), gear and screw included.
    pub counts_per_mm: f64,
    /// The counts rise where the axis moves in its minus direction.
    #[serde(default)]
    pub reversed: bool,
    /// Its encoder keeps the position without power: the axis needs no homing.
    #[serde(default)]
    pub absolute: Option<AbsoluteEncoder>,
    /// The skip signal that is wired to touch probe 1 of its drive, too.
    #[serde(default)]
    pub touch_probe: Option<TouchProbeDescription>,
    /// Highest speed of motor and screw, mm/s of the slide; the rapid traverse of the control may not exceed it.
    #[serde(default)]
    pub highest_mm_s: Option<f64>,
    /// Its holding brake, if the drive does not switch it itself.
    #[serde(default)]
    pub brake: Option<BrakeDescription>,
}

/// An absolute encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AbsoluteEncoder {
    /// Its count (object 6064h) at the machine zero.
    pub zero_counts: i32,
}

/// A holding brake.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BrakeDescription {
    /// Output port that releases it.
    pub port: u8,
    /// From the release until the axis may move, s.
    pub release_s: f64,
    /// From the end of the release until the brake holds and the torque may go, s.
    pub engage_s: f64,
}

/// Bits of a device and the ports of the terminals that they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DigitalChannels {
    /// Number of the device, from 1; of a station, from 101.
    pub device: u16,
    /// First bit in its process data, from 0.
    #[serde(default)]
    pub bit: u16,
    /// Number of bits.
    #[serde(default = "one")]
    pub count: u16,
    /// Port of the first bit, from 1.
    pub port: u8,
}

impl DigitalChannels {
    /// Bit and port of each channel.
    pub fn channels(self) -> impl Iterator<Item = (BitField, u8)> {
        (0..self.count).map(move |at| (BitField { first: self.bit + at, bits: 1 }, self.port + at as u8))
    }
}

/// An analog output.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnalogChannel {
    /// Number of the device, from 1; of a station, from 101.
    pub device: u16,
    /// First bit in its outputs.
    pub bit: u16,
    /// Bits of the value.
    pub bits: u16,
    /// Value at 10 V.
    pub counts_at_10_v: f64,
}

pub(super) fn wrong(place: impl Into<String>, rule: &'static str) -> DescriptionError {
    DescriptionError::Wrong { place: place.into(), rule }
}

/// Returns an error unless a condition holds.
pub(super) fn require(holds: bool, place: &str, rule: &'static str) -> Result<(), DescriptionError> {
    if holds { Ok(()) } else { Err(wrong(place, rule)) }
}

impl MachineDescription {
    /// Parses and checks a description.
    ///
    /// # Errors
    /// The syntax error with line and column, or the first value that is wrong.
    pub fn parse(text: &str) -> Result<Self, DescriptionError> {
        let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        let description: Self = options.from_str(text)?;
        description.check()?;
        Ok(description)
    }

    /// The servo axes.
    #[must_use]
    pub fn axes(&self) -> PerAxis<Option<&ServoAxisDescription>> {
        PerAxis([self.x.as_ref(), self.y.as_ref(), self.z.as_ref()])
    }

    /// Place of a device among the images: first those of the bus, then the stations.
    #[must_use]
    pub fn image_index(&self, number: u16) -> Option<usize> {
        match number.checked_sub(FIRST_STATION) {
            Some(station) => {
                let station = usize::from(station);
                (station < self.stations.len()).then(|| self.devices.len() + station)
            }
            None => usize::from(number).checked_sub(1).filter(|at| *at < self.devices.len()),
        }
    }

    /// Bytes of inputs and outputs of each device and station, in the order of the images.
    pub fn process_data_bytes(&self) -> impl Iterator<Item = (u16, u16)> {
        let devices = self.devices.iter().map(DeviceDescription::process_data_bytes);
        devices.chain(self.stations.iter().map(StationDescription::process_data_bytes))
    }

    /// The device of a number on the bus, from 1.
    fn device(&self, number: u16, place: &str) -> Result<&DeviceDescription, DescriptionError> {
        let found = usize::from(number).checked_sub(1).and_then(|at| self.devices.get(at));
        found.ok_or_else(|| wrong(place, "there is no device of this number in `devices`; they count from 1"))
    }

    /// Bytes of inputs and outputs of a device or a station.
    fn bytes_of(&self, number: u16, place: &str) -> Result<(u16, u16), DescriptionError> {
        let found = self.image_index(number).and_then(|at| self.process_data_bytes().nth(at));
        let rule = "there is no device of this number: those of `devices` count from 1, those of `stations` from 101";
        found.ok_or_else(|| wrong(place, rule))
    }

    fn check_stations(&self) -> Result<(), DescriptionError> {
        require(self.stations.len() <= MAX_STATIONS, "stations", "there must be at most 8 stations")?;
        for (station, number) in self.stations.iter().zip(FIRST_STATION..) {
            if let Some((field, rule)) = station.fault() {
                return Err(wrong(format!("station {number}: {field}"), rule));
            }
        }
        Ok(())
    }

    fn check(&self) -> Result<(), DescriptionError> {
        let EtherCatDescription { interface, reply_time_us, bridged_frames, distributed_clocks } = &self.ethercat;
        require(!interface.is_empty(), "ethercat.interface", "the network interface must have a name")?;
        require((50..=50_000).contains(reply_time_us), "ethercat.reply_time_us", "must be 50 to 50 000 µs")?;
        let is_core = self.core.is_none_or(|core| core < MAX_CORES);
        require(is_core, "core", "must be the number of a core of the computer, from 0")?;
        require(*bridged_frames <= 20, "ethercat.bridged_frames", "must be 0 to 20")?;
        let has_sync0 = self.devices.iter().any(|device| device.sync0);
        let rule = "SYNC0 needs both: `distributed_clocks`, and `sync0: true` at the devices that work at it";
        require(has_sync0 == distributed_clocks.is_some(), "ethercat.distributed_clocks", rule)?;
        if let Some(clocks) = distributed_clocks {
            let place = "ethercat.distributed_clocks";
            require((100..=20_000).contains(&clocks.cycle_us), place, "cycle_us must be 100 to 20 000 µs")?;
            require(clocks.shift_us() < clocks.cycle_us, place, "shift_us must be less than cycle_us")?;
        }
        require((1..=MAX_DEVICES).contains(&self.devices.len()), "devices", "there must be 1 to 32 devices")?;
        for (at, device) in self.devices.iter().enumerate() {
            check_entries(device, at + 1)?;
        }
        self.check_stations()?;
        self.check_digital("inputs", &self.inputs, |(inputs, _)| inputs)?;
        self.check_digital("outputs", &self.outputs, |(_, outputs)| outputs)?;
        let fitted = self.axes();
        for (axis, servo) in fitted.iter() {
            if let Some(servo) = servo {
                self.check_axis(axis, servo)?;
            }
        }
        require(fitted[Axis::X].is_some() && fitted[Axis::Z].is_some(), "x, z", "every machine has the axes X and Z")?;
        for (place, analog) in [("wheel_speed", self.wheel_speed), ("analog_2", self.analog_2)] {
            let Some(analog) = analog else { continue };
            let (_, bytes) = self.bytes_of(analog.device, place)?;
            check_field(place, BitField { first: analog.bit, bits: analog.bits }, bytes)?;
            require(analog.counts_at_10_v.is_normal(), place, "counts_at_10_v must not be 0")?;
        }
        for (place, counter) in [("handwheel", self.handwheel), ("spindle_encoder", self.spindle_encoder)] {
            let Some(counter) = counter else { continue };
            let (bytes, _) = self.bytes_of(counter.device, place)?;
            check_field(place, counter.field(), bytes)?;
            require(counter.counts.is_normal(), place, "counts must not be 0")?;
        }
        self.check_inverter()?;
        self.check_overlaps()
    }

    fn check_inverter(&self) -> Result<(), DescriptionError> {
        let Some(inverter) = &self.inverter else { return Ok(()) };
        for (place, device, field, is_output) in inverter.fields() {
            let (inputs, outputs) = self.bytes_of(device, place)?;
            check_field(place, field, if is_output { outputs } else { inputs })?;
        }
        inverter.mistake().map_or(Ok(()), |(place, rule)| Err(wrong(place, rule)))
    }

    /// Every bit of the outputs has one writer: a wheel speed in the place of a target position would move an axis.
    fn check_overlaps(&self) -> Result<(), DescriptionError> {
        let mut written: Vec<(u16, u16, String)> = Vec::new();
        let mut claim = |device: u16, field: BitField, place: String| {
            (field.first..field.first + field.bits).for_each(|bit| written.push((device, bit, place.clone())));
        };
        for (axis, servo) in self.axes().iter().filter_map(|(axis, servo)| Some((axis, (*servo)?))) {
            let outputs = &self.device(servo.device, "axes")?.outputs;
            let objects = [CONTROLWORD, TARGET_POSITION, MODE, TOUCH_PROBE_FUNCTION];
            for field in objects.into_iter().filter_map(|object| field_of(outputs, object)) {
                claim(servo.device, field, format!("axis {axis}"));
            }
        }
        for (at, block) in self.outputs.iter().enumerate() {
            block.channels().for_each(|(bit, _)| claim(block.device, bit, format!("outputs[{at}]")));
        }
        for (place, analog) in [("wheel_speed", self.wheel_speed), ("analog_2", self.analog_2)] {
            if let Some(AnalogChannel { device, bit, bits, .. }) = analog {
                claim(device, BitField { first: bit, bits }, place.to_owned());
            }
        }
        if let Some(reset) = self.inverter.as_ref().and_then(|inverter| inverter.reset) {
            claim(reset.device, reset.field(), "inverter.reset".to_owned());
        }
        written.sort();
        let twice = written.windows(2).find(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1));
        twice.map_or(Ok(()), |pair| {
            let (device, bit, place) = &pair[1];
            let place = format!("{place} and {}: bit {bit} of device {device}", pair[0].2);
            Err(wrong(place, "an output has one writer"))
        })
    }

    fn check_axis(&self, axis: Axis, servo: &ServoAxisDescription) -> Result<(), DescriptionError> {
        let place = axis.letter().to_ascii_lowercase().to_string();
        let device = self.device(servo.device, &format!("{place}.device"))?;
        let rule = "must be greater than 0; `reversed: true` turns the direction";
        require(servo.counts_per_mm.is_normal() && servo.counts_per_mm > 0.0, &format!("{place}.counts_per_mm"), rule)?;
        let rule = "must be greater than 0 and finite";
        let is_speed = servo.highest_mm_s.is_none_or(|speed| speed.is_normal() && speed > 0.0);
        require(is_speed, &format!("{place}.highest_mm_s"), rule)?;
        for (object, entries, bits) in [
            (CONTROLWORD, &device.outputs, 16),
            (TARGET_POSITION, &device.outputs, 32),
            (STATUSWORD, &device.inputs, 16),
            (ACTUAL_POSITION, &device.inputs, 32),
        ] {
            let rule = "its drive needs 6040h (16 bits) and 607Ah (32) in its outputs, 6041h (16) and 6064h (32) in its inputs";
            require(field_of(entries, object).is_some_and(|field| field.bits == bits), &place, rule)?;
        }
        let is_set = device.startup.iter().any(|write| write.object == MODE);
        let rule = "its drive needs the mode 6060h in its outputs (8 bits), or in `startup` with the value 8";
        require(is_set || field_of(&device.outputs, MODE).is_some_and(|field| field.bits == 8), &place, rule)?;
        if let Some(probe) = servo.touch_probe {
            let place = format!("{place}.touch_probe");
            require(probe.is_signal(), &place, "the signal must be 1 to 6, or 9")?;
            let rule = "its drive needs 60B8h (16 bits) in its outputs, 60B9h (16) and 60BAh (32; `falling`: 60BBh) in its inputs";
            require(device.touch_probe(probe).is_some(), &place, rule)?;
        }
        let same =
            self.axes().iter().filter(|(_, other)| other.is_some_and(|other| other.device == servo.device)).count();
        require(same == 1, &format!("{place}.device"), "two axes have the same drive")?;
        if let Some(brake) = &servo.brake {
            let place = format!("{place}.brake");
            require((1..=PORTS).contains(&brake.port), &place, "the port must be 1 to 64")?;
            let is_its = |block: &&DigitalChannels| block.channels().any(|(_, port)| port == brake.port);
            let wired = self.outputs.iter().find(is_its);
            require(wired.is_some(), &place, "its port is not among the outputs")?;
            let on_bus = wired.is_some_and(|block| block.device < FIRST_STATION);
            require(on_bus, &place, "a brake is on the bus: a station may be silent when it must engage")?;
            let with_port =
                |other: &&ServoAxisDescription| other.brake.as_ref().is_some_and(|at| at.port == brake.port);
            let sharing = self.axes().0.into_iter().flatten().filter(with_port).count();
            require(sharing == 1, &place, "two axes have the same port")?;
            let times = [brake.release_s, brake.engage_s];
            require(times.iter().all(|time| (0.0..=2.0).contains(time)), &place, "the times must be 0 to 2 s")?;
        }
        Ok(())
    }

    /// Checks that the channels exist, and that no port is given twice.
    fn check_digital(
        &self,
        place: &str,
        channels: &[DigitalChannels],
        side: impl Fn((u16, u16)) -> u16,
    ) -> Result<(), DescriptionError> {
        let mut used = [false; PORTS as usize];
        for (at, block) in channels.iter().enumerate() {
            let place = format!("{place}[{at}]");
            let bytes = side(self.bytes_of(block.device, &place)?);
            let last = u16::from(block.port).saturating_add(block.count);
            require(block.port >= 1 && block.count >= 1 && last <= u16::from(PORTS) + 1, &place, "ports are 1 to 64")?;
            let end = block.bit.saturating_add(block.count);
            require(end <= bytes.saturating_mul(8), &place, "the device has not so many bits")?;
            for (_, port) in block.channels() {
                let taken = std::mem::replace(&mut used[usize::from(port) - 1], true);
                require(!taken, &place, "a port is given twice")?;
            }
        }
        Ok(())
    }
}

/// The place of an object in the process data.
#[must_use]
pub fn field_of(entries: &[PdoEntry], object: u16) -> Option<BitField> {
    let mut first = 0;
    for entry in entries {
        if entry.object == object && entry.sub == 0 {
            return Some(BitField { first, bits: entry.bits });
        }
        first += entry.total_bits();
    }
    None
}

fn check_entries(device: &DeviceDescription, number: usize) -> Result<(), DescriptionError> {
    for (side, entries) in [("inputs", &device.inputs), ("outputs", &device.outputs)] {
        let place = format!("devices[{number}].{side}");
        let count: usize = entries.iter().map(|entry| usize::from(entry.count)).sum();
        require(count <= MAX_ENTRIES, &place, "there must be at most 64 entries")?;
        let fits = |entry: &PdoEntry| (1..=MAX_FIELD_BITS).contains(&entry.bits) && entry.count >= 1;
        require(entries.iter().all(fits), &place, "an entry has 1 to 32 bits, and a count of at least 1")?;
        let last = |entry: &PdoEntry| u32::from(entry.sub) + u32::from(entry.count) - 1;
        require(entries.iter().all(|entry| last(entry) <= 255), &place, "the last subindex must be at most 255")?;
    }
    let (inputs, outputs) = device.process_data_bytes();
    let rule = "a device has at most 256 bytes of inputs and of outputs";
    require(inputs.max(outputs) <= MAX_DEVICE_BYTES, &format!("devices[{number}]"), rule)?;
    let place = format!("devices[{number}].startup");
    let fits = |write: &SdoWrite| {
        let range = 1_i64 << write.bits.min(32);
        matches!(write.bits, 8 | 16 | 32) && (-range / 2..range).contains(&write.value)
    };
    require(device.startup.iter().all(fits), &place, "an object has 8, 16 or 32 bits, and a value that fits")
}

fn check_field(place: &str, field: BitField, bytes: u16) -> Result<(), DescriptionError> {
    require((1..=MAX_FIELD_BITS).contains(&field.bits), place, "the value must have 1 to 32 bits")?;
    let end = field.first.saturating_add(field.bits);
    require(end <= bytes.saturating_mul(8), place, "the device has not so many bits")
}
