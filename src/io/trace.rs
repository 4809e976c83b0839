//! Inputs and outputs of a tick as text: one line that parses back to the same bits.
//! Source: style "recorded traces become tests".

use std::fmt;

use super::{InputImage, OutputImage};
use crate::units::Micros;

/// One recorded tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TraceRow {
    /// Controller time.
    pub now: Micros,
    /// Read from the machine.
    pub inputs: InputImage,
    /// Written to the machine.
    pub outputs: OutputImage,
}

/// The first line of a trace: the column names. Terminals are hexadecimal, bit 0 is port 1.
pub const HEADER: &str = "now_us,inputs,encoder_x,encoder_y,encoder_z,spindle_turns,detents,bus_alive,\
outputs,set_x,set_y,set_z,drives_on,wheel_volts,analog_2_volts";

impl fmt::Display for TraceRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (i, o) = (&self.inputs, &self.outputs);
        let [ex, ey, ez] = i.encoder_mm.coordinates();
        let [sx, sy, sz] = o.set_point_mm.coordinates();
        write!(f, "{},{:x},{ex},{ey},{ez},{},", self.now.0, i.terminals.0, i.spindle_turns)?;
        write!(f, "{},{},{:x},", i.handwheel_detents, u8::from(i.bus_alive), o.terminals.0)?;
        write!(f, "{sx},{sy},{sz},{},{},{}", u8::from(o.drives_on), o.wheel_volts, o.analog_2_volts)
    }
}
