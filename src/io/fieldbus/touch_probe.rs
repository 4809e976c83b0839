//! The touch probe of a drive: it latches the encoder in the instant of the edge, without the filter of an input terminal
//! and the cycle of the bus. Source: CiA 402-2, objects 60B8h to 60BBh (touch probe 1).

use serde::Deserialize;

use super::process_image::{BitField, DeviceImage};

/// Touch probe function: what the drive is to latch.
pub const TOUCH_PROBE_FUNCTION: u16 = 0x60b8;
/// Touch probe status: what it has latched.
const TOUCH_PROBE_STATUS: u16 = 0x60b9;
/// Position at the rising edge of probe 1, counts; the object behind it is that of the falling edge.
const PROBE_POSITION: u16 = 0x60ba;

/// Bit 0 of function and status: probe 1 is on. Bits 1 to 3 of the function are 0: first event, input of probe 1.
const PROBE_ON: u32 = 1;
/// Highest number of a skip signal: 9 is the contact of the wheel.
const MAX_SIGNAL: u8 = 9;

/// A signal that is wired to probe 1 of a drive, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TouchProbeDescription {
    /// The skip signal of G31 and G78 (P): gauge signals 1 to 6, 9 the contact of the wheel.
    pub signal: u8,
    /// The signal comes with the falling edge.
    #[serde(default)]
    pub falling: bool,
}

impl TouchProbeDescription {
    /// Whether the signal has a possible number.
    #[must_use]
    pub const fn is_signal(self) -> bool {
        matches!(self.signal, 1..=6 | MAX_SIGNAL)
    }

    /// The object with the position of the edge.
    const fn position(self) -> u16 {
        PROBE_POSITION + self.falling as u16
    }

    /// Bits of the function that ask for the edge: 4 rising, 5 falling.
    fn edge(self) -> u32 {
        1 << (4 + u32::from(self.falling))
    }

    /// Bit of the status that tells of the edge: 1 rising, 2 falling.
    fn stored(self) -> u32 {
        1 << (1 + u32::from(self.falling))
    }
}

/// The probe of an axis.
#[derive(Clone, Copy, Debug)]
pub struct TouchProbe {
    described: TouchProbeDescription,
    function: BitField,
    status: BitField,
    position: BitField,
    /// Since it was armed the drive has said that nothing is stored: an edge from now on is a new one.
    is_clear: bool,
    armed: bool,
}

impl TouchProbe {
    /// The probe of a drive, where its process data has the objects: 60B8h (16 bits) in the outputs, 60B9h (16) and the
    /// position of the edge (32) in the inputs.
    pub fn new(
        described: TouchProbeDescription,
        outputs: impl Fn(u16) -> Option<BitField>,
        inputs: impl Fn(u16) -> Option<BitField>,
    ) -> Option<Self> {
        let function = outputs(TOUCH_PROBE_FUNCTION).filter(|field| field.bits == 16)?;
        let status = inputs(TOUCH_PROBE_STATUS).filter(|field| field.bits == 16)?;
        let position = inputs(described.position()).filter(|field| field.bits == 32)?;
        Some(Self { described, function, status, position, is_clear: false, armed: false })
    }

    /// The skip signal that it latches.
    #[must_use]
    pub const fn signal(&self) -> u8 {
        self.described.signal
    }

    /// Position of the edge since it was armed, counts; `None` before the edge.
    pub fn read(&mut self, image: &DeviceImage) -> Option<i32> {
        let status = self.status.read(&image.inputs);
        let is_stored = status & self.described.stored() != 0;
        self.is_clear |= self.armed && status & PROBE_ON != 0 && !is_stored;
        (self.armed && self.is_clear && is_stored).then(|| self.position.read_signed(&image.inputs))
    }

    /// Arms it for the next edge, or takes that back.
    pub fn write(&mut self, arm: bool, image: &mut DeviceImage) {
        self.is_clear &= arm;
        self.armed = arm;
        let word = if arm { PROBE_ON | self.described.edge() } else { 0 };
        self.function.write(&mut image.outputs, word);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Function in the outputs; status and position behind each other in the inputs.
    fn probe(falling: bool) -> TouchProbe {
        let field = |first, bits| Some(BitField { first, bits });
        let inputs = |object| match object {
            TOUCH_PROBE_STATUS => field(0, 16),
            0x60bb if falling => field(16, 32),
            0x60ba if !falling => field(16, 32),
            _ => None,
        };
        TouchProbe::new(TouchProbeDescription { signal: 9, falling }, |_| field(0, 16), inputs).unwrap()
    }

    fn image(status: u16, position: i32) -> DeviceImage {
        let inputs = status.to_le_bytes().into_iter().chain(position.to_le_bytes()).collect();
        DeviceImage { inputs, outputs: vec![0; 2] }
    }

    #[test]
    fn an_edge_counts_once_the_drive_has_said_that_nothing_is_stored() {
        for (falling, word, stored) in [(false, 0x11, 0b010), (true, 0x21, 0b100)] {
            let mut probe = probe(falling);
            assert_eq!(probe.read(&image(1 | stored, -7)), None, "it is not armed");
            let mut sent = image(0, 0);
            probe.write(true, &mut sent);
            assert_eq!(sent.outputs, [word, 0]);
            assert_eq!(probe.read(&image(1 | stored, -7)), None, "an edge of before");
            assert_eq!(probe.read(&image(1, 0)), None);
            assert_eq!(probe.read(&image(1 | stored, -70_000)), Some(-70_000));
            assert_eq!(probe.read(&image(0b111 ^ stored, 5)), None, "the other edge");
            probe.write(false, &mut sent);
            assert_eq!(sent.outputs, [0, 0]);
            assert_eq!(probe.read(&image(1 | stored, -70_000)), None);
        }
    }
}
