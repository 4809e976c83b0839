//! A Modbus TCP station in the description of a machine: an I/O island or a frequency inverter, and its registers.
//! Source: Modbus Application Protocol V1.1b3 (tables, limits of a request); docs/manual, chapter "first start on a machine".

use core::net::SocketAddr;

use serde::Deserialize;

/// Stations are devices 101, 102 …: a device that is added to the bus does not change their numbers.
pub const FIRST_STATION: u16 = 101;
/// Most stations.
pub const MAX_STATIONS: usize = 8;
/// Most blocks of inputs, and of outputs, of a station.
const MAX_BLOCKS: usize = 8;
/// Most registers and bits that a request reads.
const MAX_READ: (u16, u16) = (125, 2_000);
/// Most registers and bits that a request writes.
const MAX_WRITTEN: (u16, u16) = (120, 1_920);

/// A station. It is exchanged beside the cycle of the control, every `period_ms`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StationDescription {
    /// What it is, for the fitter.
    pub name: String,
    /// IP address and port, e.g. `192.168.1.20:502`.
    pub address: SocketAddr,
    /// Unit identifier; of a gateway the address of the device behind it.
    #[serde(default = "one")]
    pub unit: u8,
    /// Time from one exchange to the next, ms.
    #[serde(default = "default_period_ms")]
    pub period_ms: u64,
    /// How long it may take to connect, and to answer a request, ms.
    #[serde(default = "default_timeout_ms")]
    pub timeout_ms: u64,
    /// Age at which its values are no longer those of the machine, ms: the machine stops. Outputs that the control has not
    /// renewed for as long go off.
    #[serde(default = "default_max_age_ms")]
    pub max_age_ms: u64,
    /// What is read, in this order.
    #[serde(default)]
    pub inputs: Vec<ModbusBlock>,
    /// What is written, in this order.
    #[serde(default)]
    pub outputs: Vec<ModbusBlock>,
}

const fn one() -> u8 {
    1
}

const fn default_period_ms() -> u64 {
    20
}

const fn default_timeout_ms() -> u64 {
    100
}

const fn default_max_age_ms() -> u64 {
    300
}

/// A table of a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum ModbusTable {
    /// Bits that are read and written.
    Coils,
    /// Bits that are read.
    DiscreteInputs,
    /// Registers of 16 bits that are read and written.
    HoldingRegisters,
    /// Registers of 16 bits that are read.
    InputRegisters,
}

impl ModbusTable {
    /// Whether its entries are bits.
    #[must_use]
    pub const fn is_bits(self) -> bool {
        matches!(self, Self::Coils | Self::DiscreteInputs)
    }

    const fn is_writable(self) -> bool {
        matches!(self, Self::Coils | Self::HoldingRegisters)
    }
}

/// Entries of a table in a row: one request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModbusBlock {
    /// The table.
    pub table: ModbusTable,
    /// Address of the first entry, from 0, as in the request.
    pub from: u16,
    /// Number of entries.
    pub count: u16,
}

impl ModbusBlock {
    /// Bytes of the block in the process data. Bits fill up a whole byte; a register has its lower byte first.
    #[must_use]
    pub const fn bytes(self) -> u16 {
        if self.table.is_bits() { self.count.div_ceil(8) } else { self.count.saturating_mul(2) }
    }

    fn fits(self, (registers, bits): (u16, u16)) -> bool {
        let most = if self.table.is_bits() { bits } else { registers };
        (1..=most).contains(&self.count) && u32::from(self.from) + u32::from(self.count) <= 0x1_0000
    }
}

impl StationDescription {
    /// Bytes of its inputs and outputs.
    #[must_use]
    pub fn process_data_bytes(&self) -> (u16, u16) {
        let bytes = |blocks: &[ModbusBlock]| blocks.iter().map(|block| block.bytes()).sum();
        (bytes(&self.inputs), bytes(&self.outputs))
    }

    /// What is wrong with it: the field and the rule.
    pub(super) fn fault(&self) -> Option<(&'static str, &'static str)> {
        let holds = [
            (self.address.port() != 0, "address", "the port must not be 0; that of Modbus TCP is 502"),
            ((5..=1_000).contains(&self.period_ms), "period_ms", "must be 5 to 1 000 ms"),
            ((5..=5_000).contains(&self.timeout_ms), "timeout_ms", "must be 5 to 5 000 ms"),
            (self.max_age_ms >= 2 * self.period_ms, "max_age_ms", "must be at least twice `period_ms`"),
            (
                self.max_age_ms >= self.period_ms + self.timeout_ms,
                "max_age_ms",
                "must be at least `period_ms` and `timeout_ms` together",
            ),
            (self.max_age_ms <= 5_000, "max_age_ms", "must be at most 5 000 ms"),
            (
                self.inputs.len().max(self.outputs.len()) <= MAX_BLOCKS,
                "inputs, outputs",
                "there must be at most 8 blocks",
            ),
            (!self.inputs.is_empty(), "inputs", "something must be read: the answer shows that the station is there"),
            (
                self.inputs.iter().all(|block| block.fits(MAX_READ)),
                "inputs",
                "a block has 1 to 125 registers or 1 to 2 000 bits, and ends at address 65 535",
            ),
            (
                self.outputs.iter().all(|block| block.table.is_writable()),
                "outputs",
                "coils and holding registers alone can be written",
            ),
            (
                self.outputs.iter().all(|block| block.fits(MAX_WRITTEN)),
                "outputs",
                "a block has 1 to 120 registers or 1 to 1 920 bits, and ends at address 65 535",
            ),
        ];
        holds.into_iter().find(|(holds, ..)| !holds).map(|(_, field, rule)| (field, rule))
    }
}
