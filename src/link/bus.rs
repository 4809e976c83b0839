//! The field bus of a real machine, as the bus page shows it.
//! Source: docs/manual, chapter "first start on a machine".

use std::sync::Arc;

use crate::defs::device_state::DeviceState;
use crate::defs::port_errors::{PORTS_OF_DEVICE, PortErrors};
use crate::defs::text::{LocalizedText, Text};
use crate::units::{Axis, Micros, Percentiles, TimeDistribution};

/// A device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BusDevice {
    /// Its name in the description of the machine.
    pub name: String,
    /// Vendor and product.
    pub identity: (u32, u32),
    /// Its state.
    pub state: DeviceState,
    /// Its drive, if it is one of an axis.
    pub drive: Option<BusDrive>,
    /// What its ports have counted.
    pub ports: [PortErrors; PORTS_OF_DEVICE],
}

/// The drive of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct BusDrive {
    /// The axis.
    pub axis: Axis,
    /// State, or fault with its code.
    pub state: LocalizedText,
    /// It is in a fault.
    pub tripped: bool,
    /// What its encoder counts (object 6064h), once it has been read.
    pub raw_count: Option<i32>,
    /// Torque in percent of the rated one, where it sends it.
    pub torque_percent: Option<f64>,
}

/// A station on Modbus TCP.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BusStation {
    /// Its number, from 101.
    pub number: u16,
    /// Its name in the description of the machine.
    pub name: String,
    /// Address and port.
    pub address: String,
    /// Its values are those of the machine.
    pub is_heard: bool,
    /// Age of its values.
    pub age: Micros,
    /// What was wrong in its last exchange.
    pub fault: Option<LocalizedText>,
    /// Exchanges without an answer.
    pub failures: u64,
    /// Time of an exchange.
    pub round_trip: Percentiles,
}

/// The inverter of the wheel or of the main spindle.
#[derive(Clone, Debug, PartialEq)]
pub struct BusInverter {
    /// Number of the device or station that reports it.
    pub device: u16,
    /// Actual speed, r/min, where it sends it.
    pub rpm: Option<f64>,
    /// Load of its motor in percent of the rated one, where it sends it.
    pub load_percent: Option<f64>,
    /// Its fault.
    pub fault: Option<LocalizedText>,
}

/// A line of the description of the machine.
#[derive(Clone, Debug, PartialEq)]
pub enum DescriptionLine {
    /// A device, a station, or another part of the machine begins.
    Heading(LocalizedText),
    /// One of its properties, and its value.
    Property(Text, String),
}

/// The distributed clocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BusClock {
    /// How far frames are from the time that the reference clock asks for.
    pub distance: TimeDistribution,
    /// How much faster than the computer's clock the reference clock goes, millionths.
    pub drift_ppm: f64,
}

/// What the computer has given to the thread of the control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ThreadRights {
    /// It goes before all other threads (`SCHED_FIFO`).
    pub has_priority: bool,
    /// Its memory is never swapped out, and its stack is there.
    pub has_locked_memory: bool,
    /// The core that the description asks for, and whether the thread runs there.
    pub core: Option<(u16, bool)>,
}

/// The bus.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BusView {
    /// Network interface.
    pub interface: String,
    /// What is wrong with it.
    pub fault: Option<LocalizedText>,
    /// The devices in the order of the cable.
    pub devices: Vec<BusDevice>,
    /// The stations beside it.
    pub stations: Vec<BusStation>,
    /// Exchanges, and those without a whole answer.
    pub cycles: u64,
    /// See `cycles`.
    pub lost: u64,
    /// Working counter of the last frame, and that of a whole exchange. `None` if the frame was lost.
    pub working_counter: Option<(u16, u16)>,
    /// How long a tick takes: exchange, computing, snapshot.
    pub execution: TimeDistribution,
    /// Time from sending a frame until it is back.
    pub round_trip: TimeDistribution,
    /// How late the thread of the control wakes up.
    pub wake_up: TimeDistribution,
    /// Rights of the thread of the control.
    pub rights: ThreadRights,
    /// The distributed clocks, if they are used.
    pub clock: Option<BusClock>,
    /// The inverter, if the description has one.
    pub inverter: Option<BusInverter>,
    /// The description of the machine.
    pub description: Arc<[DescriptionLine]>,
}
