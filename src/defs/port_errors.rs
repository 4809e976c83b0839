//! What the ports of a device on EtherCAT have counted: which cable is bad. Source: ETG.1000.4, registers 0300h to 0313h.

/// Ports of a device: 0 towards the control, 1 to 3 away from it.
pub const PORTS_OF_DEVICE: usize = 4;
/// Bytes of the registers 0300h to 0313h.
pub const PORT_REGISTERS: usize = 20;
/// Place of the counters of lost links among them (0310h).
const LOST_LINKS: usize = 16;

/// Errors of a port since the device has had power; the counters stop at 255.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PortErrors {
    /// Damaged frames and symbols.
    pub damaged: u8,
    /// Times that the link was lost.
    pub lost_links: u8,
}

impl PortErrors {
    /// The ports of a device, from its registers 0300h to 0313h.
    #[must_use]
    pub fn of_registers(bytes: [u8; PORT_REGISTERS]) -> [Self; PORTS_OF_DEVICE] {
        std::array::from_fn(|port| Self {
            damaged: bytes[2 * port].saturating_add(bytes[2 * port + 1]),
            lost_links: bytes[LOST_LINKS + port],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_symbols_of_a_port_are_side_by_side_and_its_lost_links_at_the_end() {
        let mut bytes = [0; PORT_REGISTERS];
        (bytes[2], bytes[3], bytes[17]) = (3, 4, 1);
        (bytes[0], bytes[1]) = (200, 100);
        let ports = PortErrors::of_registers(bytes);
        assert_eq!(ports[1], PortErrors { damaged: 7, lost_links: 1 });
        assert_eq!(ports[0], PortErrors { damaged: 255, lost_links: 0 });
        assert_eq!(ports[2..], [PortErrors::default(); 2]);
    }
}
