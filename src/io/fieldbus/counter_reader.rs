//! The counter of a handwheel or of the encoder of the spindle, as turns and detents.

use super::channel::CounterChannel;
use super::description::MachineDescription;
use super::process_image::DeviceImage;

/// Reads a counter that wraps.
#[derive(Clone, Copy, Debug)]
pub struct CounterReader {
    channel: Option<CounterChannel>,
    before: Option<u32>,
    /// Counts that are less than a detent.
    rest: f64,
}

impl CounterReader {
    /// A reader that has not read; without a channel it reads 0.
    pub const fn new(channel: Option<CounterChannel>) -> Self {
        Self { channel, before: None, rest: 0.0 }
    }

    /// What a device counts begins anew.
    pub fn forget(&mut self, device: u16) {
        if self.channel.is_some_and(|channel| channel.device == device) {
            self.before = None;
        }
    }

    /// Revolutions since the last call.
    pub fn turns(&mut self, description: &MachineDescription, images: &[DeviceImage]) -> f64 {
        let Some(channel) = self.channel else { return 0.0 };
        let Some(image) = description.image_index(channel.device).and_then(|at| images.get(at)) else { return 0.0 };
        let raw = channel.field().read(&image.inputs);
        let before = self.before.replace(raw).unwrap_or(raw);
        let unused = 32 - u32::from(channel.bits.clamp(1, 32));
        let counts = (raw.wrapping_sub(before) << unused).cast_signed() >> unused;
        f64::from(counts) / channel.counts
    }

    /// Whole detents since the last call; what is less is kept.
    pub fn steps(&mut self, description: &MachineDescription, images: &[DeviceImage]) -> f64 {
        self.rest += self.turns(description, images);
        let whole = self.rest.trunc();
        self.rest -= whole;
        whole
    }
}
