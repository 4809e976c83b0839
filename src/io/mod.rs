//! The interface between control and machine: input terminals in, output terminals and set-points out, once a tick.
//!
//! A [`Backend`] is the simulated machine or a field bus; the control does not know which.
//! Source: spec P1–P8, style "time and hardware are arguments".

pub mod drive;
#[cfg(target_os = "linux")]
pub mod ethercat;
pub mod fieldbus;
pub mod random;
pub mod sim;
pub mod trace;

use self::drive::DriveState;
use crate::defs::param::Params;
use crate::defs::signal::Terminals;
use crate::units::{EncoderPos, Micros, PerAxis};

/// The inputs of one tick, from the machine to the control.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputImage {
    /// Circuits of the input terminals as wired, before polarity and debounce.
    pub terminals: Terminals,
    /// Encoder position of each axis in the encoder's frame, mm of slide travel (radius on X).
    /// Zero is where the drive was switched on; homing finds the machine zero. Of an absolute encoder it is the machine
    /// zero itself.
    pub encoder_mm: EncoderPos,
    /// Axes with an absolute encoder that has been read.
    pub absolute: PerAxis<bool>,
    /// What the touch probes of the drives have latched since [`OutputImage::awaited_signal`] is theirs.
    pub latches: PerAxis<Option<ProbeLatch>>,
    /// Torque of the drive of each axis in percent of the rated one, where it sends it.
    pub torque_percent: PerAxis<Option<f64>>,
    /// Revolutions of the main spindle since power-on by its encoder, forward (M03) positive; 0 without such a spindle.
    pub spindle_turns: f64,
    /// Handwheel detents since the last tick, positive clockwise.
    pub handwheel_detents: i32,
    /// State of the drive of each axis.
    pub drives: PerAxis<DriveState>,
    /// Whether the bus answered in this tick. If not, the other fields hold the last known values.
    pub bus_alive: bool,
    /// Whether a station beside the bus has not answered for too long. Its inputs hold their last values.
    pub station_silent: bool,
    /// Whether the inverter of the wheel reports a fault.
    pub inverter_tripped: bool,
}

/// What the touch probe of a drive has latched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeLatch {
    /// The skip signal.
    pub signal: u8,
    /// The encoder's position at its edge, mm.
    pub encoder_mm: f64,
}

/// The outputs of one tick, from the control to the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputImage {
    /// Circuits of the output terminals; closed is on.
    pub terminals: Terminals,
    /// Set-point of each axis in the encoder's frame, mm of slide travel.
    pub set_point_mm: EncoderPos,
    /// Whether the drives are to be on. If off, the brakes hold the axes.
    pub drives_on: bool,
    /// RESET in this tick: drives in a fault are to be reset, and a bus that was lost is set up again.
    pub fault_reset: bool,
    /// The skip signal (P of G31 and G78) that is awaited; 0 for none. Touch probes wired to it are armed.
    pub awaited_signal: u8,
    /// First analog output: speed of the wheel (of the main spindle on a lathe), 0…10 V.
    pub wheel_volts: f64,
    /// Second analog output (`M63 S`), 0…10 V.
    pub analog_2_volts: f64,
}

/// The machine, real or simulated.
pub trait Backend {
    /// Reads the inputs at `now`.
    fn read(&mut self, now: Micros) -> InputImage;
    /// Writes the outputs that apply from `now` on.
    fn write(&mut self, now: Micros, outputs: &OutputImage);
    /// Functions were assigned to other ports, or the shape of a lathe tool was changed. A simulated machine follows;
    /// on a field bus the wires are moved by hand, and there is nothing to do.
    fn rewire(&mut self, params: &Params);
}
