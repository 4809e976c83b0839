//! Places of values in the process data of devices and stations.

use serde::Deserialize;

use super::process_image::BitField;

/// A counter of a device.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CounterChannel {
    /// Number of the device, from 1; of a station, from 101.
    pub device: u16,
    /// First bit in its inputs.
    pub bit: u16,
    /// Bits of the counter; it wraps.
    pub bits: u16,
    /// Counts of one detent of a handwheel, of one revolution of a spindle, or of 1 r/min of an inverter; negative if it counts
    /// backwards.
    pub counts: f64,
}

impl CounterChannel {
    /// Its place in the inputs of the device.
    #[must_use]
    pub const fn field(self) -> BitField {
        BitField { first: self.bit, bits: self.bits }
    }
}

/// A number that a device sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WordChannel {
    /// Number of the device, from 1; of a station, from 101.
    pub device: u16,
    /// First bit in its inputs.
    pub bit: u16,
    /// Bits of the number.
    pub bits: u16,
}

impl WordChannel {
    /// Its place in the inputs of the device.
    #[must_use]
    pub const fn field(self) -> BitField {
        BitField { first: self.bit, bits: self.bits }
    }
}

/// A bit that a device gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BitChannel {
    /// Number of the device, from 1; of a station, from 101.
    pub device: u16,
    /// Bit in its outputs.
    pub bit: u16,
}

impl BitChannel {
    /// Its place in the outputs of the device.
    #[must_use]
    pub const fn field(self) -> BitField {
        BitField { first: self.bit, bits: 1 }
    }
}
