//! The working area of a simulated lathe: bar, chuck and tool. The machine fills it, the pages draw it. Source: spec L10.

/// The working area as drawn. Lengths in mm, X as radius; positions on the bar in part coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LatheWorkspace {
    /// Work zero, machine coordinates X, Z.
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
