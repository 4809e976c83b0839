//! What the simulator page asks of the simulated machine and sees of it. Where a real machine is wired there is none.
//! Source: spec P1–P8; tools.md (faults).

use crate::defs::signal::Input;
use crate::defs::text::Said;

/// One request to the simulated machine; the control never sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimCommand {
    /// Forces an input, logically on or off; none lets it go.
    Force(Input, Option<bool>),
    /// Makes the machine suffer a fault by its name, or ends it.
    Fault(&'static str, bool),
    /// The part as it was before grinding.
    NewPart,
    /// The wheel as it comes from the dresser.
    Sharpen,
}

/// A lathe's working room as the drawing shows it. Lengths mm, radius; places of the bar in part coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoomView {
    /// The part's zero, machine coordinates X, Z.
    pub zero_mm: (f32, f32),
    /// Where the bar comes out of the chuck.
    pub z_from_mm: f32,
    /// Length of a cell.
    pub cell_mm: f32,
    /// Radius of each cell from the chuck to the face.
    pub radius_mm: Vec<f32>,
    /// Radius of the stock.
    pub stock_mm: f32,
    /// The chuck: from, to, radius.
    pub bodies: Vec<(f32, f32, f32)>,
    /// Where the tip of the tool in front stands off the slides' reference point, X, Z.
    pub tip_mm: (f32, f32),
    /// Its outline: Z from the tip, height over it.
    pub outline_mm: Vec<(f32, f32)>,
}

/// The simulated machine as the page shows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimView {
    /// Inputs that are forced.
    pub forced: Vec<(Input, bool)>,
    /// Faults that are suffered.
    pub faults: Vec<&'static str>,
    /// Wheel: mean diameter, mm.
    pub wheel_diameter_mm: f64,
    /// 0 sharp, 1 dull.
    pub wheel_dull: f64,
    /// Load of its motor, percent.
    pub wheel_load_percent: f64,
    /// Sizes of the part, mm: what is measured, and its size.
    pub sizes: Vec<(Said, f64)>,
    /// What happened to it, the latest last.
    pub events: Vec<Said>,
    /// The working room of a lathe (L10).
    pub room: Option<RoomView>,
}
