//! The error counters of the ports of all devices, read one device after the other.

use crate::defs::port_errors::{PORTS_OF_DEVICE, PortErrors};
use crate::units::Micros;

/// Time between two readings.
const READ_INTERVAL: Micros = Micros::from_millis(50);

/// What the ports of each device have counted, as it was read last.
#[derive(Clone, Debug)]
pub struct PortCounters {
    errors: Vec<[PortErrors; PORTS_OF_DEVICE]>,
    /// The counters of these devices are to begin anew.
    clearing: Vec<bool>,
    /// The device that is read next, and when.
    next: usize,
    read_at: Micros,
}

impl PortCounters {
    /// Counters of so many devices.
    #[must_use]
    pub fn new(devices: usize) -> Self {
        Self {
            errors: vec![Default::default(); devices],
            clearing: vec![false; devices],
            next: 0,
            read_at: Micros::ZERO,
        }
    }

    /// What the ports of a device have counted.
    #[must_use]
    pub fn of_device(&self, device: usize) -> [PortErrors; PORTS_OF_DEVICE] {
        self.errors.get(device).copied().unwrap_or_default()
    }

    /// All counters are to begin anew, each device in its turn.
    pub fn clear(&mut self) {
        self.clearing.fill(true);
    }

    /// Reads a device, if it is time for the next one; one that does not answer keeps its figures. `read` is told whether
    /// the counters of the device begin anew first.
    pub fn step(&mut self, now: Micros, read: impl FnOnce(usize, bool) -> Option<[PortErrors; PORTS_OF_DEVICE]>) {
        let Some(known) = self.errors.get_mut(self.next).filter(|_| now >= self.read_at) else { return };
        self.read_at = now + READ_INTERVAL;
        if let Some(found) = read(self.next, self.clearing[self.next]) {
            (*known, self.clearing[self.next]) = (found, false);
        }
        self.next = (self.next + 1) % self.errors.len();
    }
}
