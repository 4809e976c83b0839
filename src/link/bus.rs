//! The field bus of a real machine, as the bus page shows it.
//! Source: docs/manual, chapter "first start on a machine".

use crate::defs::device_state::DeviceState;
use crate::defs::text::LocalizedText;
use crate::units::{Axis, Percentiles};

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
    /// Exchanges, and those without a whole answer.
    pub cycles: u64,
    /// See `cycles`.
    pub lost: u64,
    /// Time from sending a frame until it is back.
    pub round_trip: Percentiles,
    /// How late the thread of the control wakes up.
    pub wake_up: Percentiles,
}
