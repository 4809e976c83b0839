//! Requests and data of the simulator page. On a real machine there is no simulated machine.
//! Source: spec P1–P8; tools.md (faults).

use crate::defs::signal::Input;
use crate::defs::text::LocalizedText;

/// One request to the simulated machine; the core never handles it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimCommand {
    /// Forces an input, logically on or off; `None` ends the forcing.
    Force(Input, Option<bool>),
    /// Starts or ends a fault by its name.
    Fault(&'static str, bool),
    /// Restores the unmachined workpiece.
    NewPart,
    /// Restores the freshly dressed wheel.
    SharpenWheel,
}

/// The working area of a lathe as drawn. Lengths in mm, radius; positions on the bar in workpiece coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LatheWorkspaceView {
    /// Workpiece zero, machine coordinates X, Z.
    pub zero_mm: (f32, f32),
    /// Z where the bar leaves the chuck.
    pub chuck_face_z_mm: f32,
    /// Length of a cell along Z.
    pub cell_mm: f32,
    /// Radius of each cell from the chuck to the end face.
    pub radius_mm: Vec<f32>,
    /// Radius of the raw bar.
    pub stock_radius_mm: f32,
    /// The chuck: Z from, Z to, radius.
    pub bodies: Vec<(f32, f32, f32)>,
    /// Offset of the active tool tip from the reference point of the slides, X, Z.
    pub tip_mm: (f32, f32),
    /// Outline of the tool: Z from the tip, height above it.
    pub outline_mm: Vec<(f32, f32)>,
}

/// The simulated machine as the page shows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimView {
    /// Inputs that are forced.
    pub forced: Vec<(Input, bool)>,
    /// Active faults.
    pub faults: Vec<&'static str>,
    /// Mean wheel diameter, mm.
    pub wheel_diameter_mm: f64,
    /// Wheel wear: 0 sharp, 1 dull.
    pub wheel_dullness: f64,
    /// Load of the wheel motor, percent.
    pub wheel_load_percent: f64,
    /// Sizes of the workpiece: name of the dimension, size in mm.
    pub sizes: Vec<(LocalizedText, f64)>,
    /// Events of the workpiece, newest last.
    pub events: Vec<LocalizedText>,
    /// The working area of a lathe (L10).
    pub lathe_workspace: Option<LatheWorkspaceView>,
}
