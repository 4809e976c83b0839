//! The working area of a simulated grinding machine: part as ground, holders, wheel and dresser. The machine fills it, the
//! pages draw it. Lengths in mm, X as radius, part coordinates. Source: spec P2–P6, B6, H8.

use crate::units::{Axis, PerAxis};

/// What is ground: between two heights at each place along an axis, a section of the part.
#[derive(Clone, Debug, PartialEq)]
pub struct PartSection {
    /// The axis along which the places lie.
    pub along: Axis,
    /// The axis of the heights.
    pub height: Axis,
    /// The part turns: the section is there a second time, mirrored in the zero of this axis.
    pub mirrored: Option<Axis>,
    /// Place, least and greatest height; places increase.
    pub samples: Vec<[f64; 3]>,
}

/// Kinds of holders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HolderKind {
    /// 卡盘.
    Chuck,
    /// 尾座.
    Tailstock,
    /// 夹具.
    Fixture,
    /// 磁盘.
    Magnet,
}

/// What holds the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Holder {
    /// What it is.
    pub kind: HolderKind,
    /// Least and greatest coordinate along each axis; none along an axis where its end does not matter.
    pub extent: PerAxis<Option<(f64, f64)>>,
}

/// The dresser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DresserShape {
    /// Its point that touches the rim; of a roll the minus side of its nearest line.
    pub at_mm: PerAxis<f64>,
    /// It stands behind the wheel: its body extends towards plus of the infeed.
    pub behind: bool,
    /// Diameter and width of a roll; none for a diamond.
    pub roll_mm: Option<(f64, f64)>,
}

/// The working area.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GrindingWorkspace {
    /// Machine coordinates (slide travel) at which the foremost point of a new wheel is at the work zero.
    pub zero_mm: PerAxis<f64>,
    /// Sections of the part as it is now.
    pub part: Vec<PartSection>,
    /// What holds it.
    pub holders: Vec<Holder>,
    /// Radius of a new wheel.
    pub wheel_radius_mm: f64,
    /// Its width.
    pub wheel_width_mm: f64,
    /// Wear of each slice of the rim, from the minus side on.
    pub rim_wear_mm: Vec<f64>,
    /// Wear of the two sides: towards minus, towards plus.
    pub side_wear_mm: [f64; 2],
    /// Tangent of the swivel angle of the wheel head.
    pub swivel_tan: f64,
    /// The dresser, where one is fitted.
    pub dresser: Option<DresserShape>,
    /// The wheel removes something of the part.
    pub grinds: bool,
}
