//! The machine as the control meets it: levels in, levels and set-points out, once a tick.
//!
//! Behind [`Backend`] stand the simulated machine or a field bus; the control cannot tell which.
//! Source: spec P1–P8, style "time and hardware are arguments".

pub mod injector;
mod random;
pub mod sim;
pub mod trace;

use crate::defs::param::Params;
use crate::defs::signal::Terminals;
use crate::units::{Micros, PerAxis};

/// What the machine tells the control in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputImage {
    /// Input terminals as wired: before polarity and filter.
    pub terminals: Terminals,
    /// Encoder position of each axis, machine frame of the encoder, mm of slide travel (radius on X).
    /// Its zero is where the drive was switched on; homing finds the machine's zero.
    pub encoder_mm: PerAxis<f64>,
    /// Turns of the main spindle since power-on by its encoder, forward (M03) positive; 0 where there is none.
    pub spindle_turns: f64,
    /// Handwheel detents since the last tick, positive clockwise.
    pub handwheel_detents: i32,
    /// Whether the bus answered in this tick; the rest of the image is the last one known if it did not.
    pub bus_alive: bool,
}

/// What the control tells the machine in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputImage {
    /// Output terminals.
    pub terminals: Terminals,
    /// Set-point of each axis in the encoder's frame, mm of slide travel.
    pub set_point_mm: PerAxis<f64>,
    /// Whether the drives are switched on. Off: the axis is held by its brake.
    pub drives_on: bool,
    /// First analog output: wheel speed, 0…10 V.
    pub wheel_volts: f64,
    /// Second analog output (`M63 S`), 0…10 V.
    pub analog_2_volts: f64,
}

/// The machine, real or simulated.
pub trait Backend {
    /// The state of the machine at `now`.
    fn read(&mut self, now: Micros) -> InputImage;
    /// Hands over the outputs that hold from `now` on.
    fn write(&mut self, now: Micros, outputs: &OutputImage);
    /// The ports of functions have been assigned anew. Real wires are moved by hand; a simulated machine moves its own.
    fn rewire(&mut self, _params: &Params) {}
}
