//! Inputs and outputs of a tick as text: one line that parses back to the same bits.
//! Source: style "recorded traces become tests".

use std::fmt;

use super::drive::DriveState;
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

/// The first line of a trace: the column names. Terminals are hexadecimal, bit 0 is port 1. In
/// `absolute` bit 0 is X, bit 1 Y, bit 2 Z. A latch is `signal:mm`, or empty, as is a torque.
pub const HEADER: &str = "now_us,inputs,encoder_x,encoder_y,encoder_z,absolute,latch_x,latch_y,latch_z,torque_x,torque_y,torque_z,spindle_turns,detents,drive_x,drive_y,drive_z,bus_alive,station_silent,inverter_tripped,\
outputs,set_x,set_y,set_z,drives_on,fault_reset,awaited_signal,wheel_volts,analog_2_volts";

impl fmt::Display for TraceRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (i, o) = (&self.inputs, &self.outputs);
        let [ex, ey, ez] = i.encoder_mm.coordinates();
        let [sx, sy, sz] = o.set_point_mm.coordinates();
        let absolute =
            i.absolute.iter().fold(0_u8, |bits, (axis, is_absolute)| bits | u8::from(*is_absolute) << axis as u8);
        write!(f, "{},{:x},{ex},{ey},{ez},{absolute},", self.now.0, i.terminals.0)?;
        for latch in i.latches.0 {
            latch.map_or(Ok(()), |latch| write!(f, "{}:{}", latch.signal, latch.encoder_mm))?;
            f.write_str(",")?;
        }
        for torque in i.torque_percent.0 {
            torque.map_or(Ok(()), |percent| write!(f, "{percent}"))?;
            f.write_str(",")?;
        }
        write!(f, "{},", i.spindle_turns)?;
        let [dx, dy, dz] = i.drives.0.map(DriveState::trace_number);
        let [alive, silent, tripped] = [i.bus_alive, i.station_silent, i.inverter_tripped].map(u8::from);
        write!(f, "{},{dx},{dy},{dz},{alive},{silent},{tripped},", i.handwheel_detents)?;
        write!(f, "{:x},{sx},{sy},{sz},", o.terminals.0)?;
        let (on, reset) = (u8::from(o.drives_on), u8::from(o.fault_reset));
        write!(f, "{on},{reset},{},{},{}", o.awaited_signal, o.wheel_volts, o.analog_2_volts)
    }
}
