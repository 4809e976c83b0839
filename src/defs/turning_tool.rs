//! The turning tools as defined by the operator: a shape and three sizes. Used by the simulated machine for cutting and
//! collisions, and by the pages for drawing. Source: spec L9 (tool definitions), L10.

use super::param::{self, NumberParam, Params};
use super::text::Text;

/// Slope of the flank of a turning tool: 1.5 mm over a width of 8 mm.
const FLANK_SLOPE: f64 = 0.1875;
/// Slope of the flanks of a 60° threading tool: tan 60°.
const THREADING_SLOPE: f64 = 1.732;
/// Distance from the edge to the shank, mm.
const SHANK_OFFSET_MM: f64 = 0.1;

/// A tool shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurningToolShape {
    /// Cuts towards the chuck.
    RightHand,
    /// Cuts in both directions.
    Neutral,
    /// Cuts along X only.
    Grooving,
    /// 60° thread profile.
    Threading,
}

impl TurningToolShape {
    /// All shapes; the parameter value is the index + 1.
    pub const ALL: [Self; 4] = [Self::RightHand, Self::Neutral, Self::Grooving, Self::Threading];

    /// Display name.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::RightHand => Text::new("外圆刀", "turning"),
            Self::Neutral => Text::new("尖刀", "neutral"),
            Self::Grooving => Text::new("切槽刀", "grooving"),
            Self::Threading => Text::new("螺纹刀", "threading"),
        }
    }
}

/// A turning tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurningTool {
    /// Its shape.
    pub shape: TurningToolShape,
    /// Width of the edge along Z, mm; half of it for shapes that cut in both directions.
    pub width_mm: f64,
    /// Height of the cutting edge above the tip, mm; the shank is above it.
    pub edge_mm: f64,
    /// Extent of the shank along Z from the tip, mm.
    pub shank_mm: f64,
}

/// Tool parameters of stations 1 to 4: shape, width, edge, shank.
pub const TOOL_PARAMS: [[NumberParam; 4]; 4] = [
    [param::TOOL_1_SHAPE, param::TOOL_1_WIDTH, param::TOOL_1_EDGE, param::TOOL_1_SHANK],
    [param::TOOL_2_SHAPE, param::TOOL_2_WIDTH, param::TOOL_2_EDGE, param::TOOL_2_SHANK],
    [param::TOOL_3_SHAPE, param::TOOL_3_WIDTH, param::TOOL_3_EDGE, param::TOOL_3_SHANK],
    [param::TOOL_4_SHAPE, param::TOOL_4_WIDTH, param::TOOL_4_EDGE, param::TOOL_4_SHANK],
];

impl TurningTool {
    /// The tool of a station, counted from 0.
    #[must_use]
    pub fn of_station(params: &Params, station: usize) -> Self {
        let [shape, width, edge, shank] = TOOL_PARAMS[station % TOOL_PARAMS.len()];
        let index = (params.get(shape) as usize).saturating_sub(1).min(TurningToolShape::ALL.len() - 1);
        let [width_mm, edge_mm, shank_mm] = [width, edge, shank].map(|number| params.get(number));
        Self { shape: TurningToolShape::ALL[index], width_mm, edge_mm, shank_mm }
    }

    /// Outline of the tool: pairs of Z from the tip (increasing) and height along X above the tip, mm.
    #[must_use]
    pub fn outline_mm(&self) -> Vec<(f64, f64)> {
        let (width, top) = (self.width_mm, self.edge_mm + SHANK_OFFSET_MM);
        let rise = |slope: f64| (width * slope).min(self.edge_mm);
        let edge: &[(f64, f64)] = match self.shape {
            TurningToolShape::RightHand => &[(0.0, 0.0), (width, rise(FLANK_SLOPE))],
            TurningToolShape::Neutral => &[(-width, rise(FLANK_SLOPE)), (0.0, 0.0), (width, rise(FLANK_SLOPE))],
            TurningToolShape::Grooving => &[(0.0, 0.0), (width, 0.0)],
            TurningToolShape::Threading => {
                &[(-width, rise(THREADING_SLOPE)), (0.0, 0.0), (width, rise(THREADING_SLOPE))]
            }
        };
        let shank = [(width + SHANK_OFFSET_MM, top), (self.shank_mm.max(width + 2.0 * SHANK_OFFSET_MM), top)];
        edge.iter().copied().chain(shank).collect()
    }
}
