//! What a kind of machine is called and shows on its pages where kinds differ. Source: spec K1, L7–L9.

use super::kind::Kind;
use super::text::Text;
use crate::units::Axis;

/// The words and figures of a kind.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// The part turns in a main spindle and tools cut it; otherwise a wheel grinds it.
    pub turns_part: bool,
    /// What S drives.
    pub spindle: Text,
    /// What the process column shows last: strokes a minute, or the station in front.
    pub last: Text,
    /// What the analog outputs command.
    pub analog: [Text; 2],
    /// The page of single blocks.
    pub mdi: Text,
    /// The tab of the simulator page that shows the part.
    pub part: Text,
    /// Codes of the block pad, a touch each.
    pub codes: &'static [Text],
    /// The third and later rows of its signs hold the macro language's.
    pub macros: bool,
}

/// A form that is ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Diameters, cones and shoulders of a part that turns.
    Outside,
    /// A bore of a part that turns.
    Bore,
    /// Planes and walls of a part on a table that goes to and fro.
    Flat,
    /// A plane of a part on a table that turns.
    Ring,
}

/// How a wheel stands in a drawing.
#[derive(Clone, Copy, Debug)]
pub struct WheelPose {
    /// The axis towards which the body lies.
    pub body: Axis,
    /// The axis along its spindle.
    pub spindle: Axis,
    /// The position is that of its centre (S4), not of its foremost point.
    pub by_centre: bool,
}

const fn same(word: &'static str) -> Text {
    Text::new(word, word)
}

static GRINDER: Face = Face {
    turns_part: false,
    spindle: Text::new("砂轮", "wheel"),
    last: Text::new("振荡", "strokes"),
    analog: [
        Text::new("模拟量 1 砂轮转速", "analog 1 wheel speed"),
        Text::new("模拟量 2 工件转速", "analog 2 work speed"),
    ],
    mdi: Text::new("录入", "MDI"),
    part: Text::new("工件与砂轮", "PART, WHEEL"),
    codes: &[
        same("G00"),
        same("G01"),
        same("G04"),
        same("G50"),
        same("G54"),
        same("M03"),
        same("M05"),
        same("M08"),
        same("M09"),
    ],
    macros: true,
};

static LATHE: Face = Face {
    turns_part: true,
    spindle: Text::new("主轴", "spindle"),
    last: Text::new("刀位", "station"),
    analog: [Text::new("模拟量 1 主轴转速", "analog 1 spindle speed"), Text::new("模拟量 2", "analog 2")],
    mdi: Text::new("立即执行", "MDI"),
    part: Text::new("工件与刀具", "PART, TOOL"),
    codes: &[
        same("G00"),
        same("G01"),
        same("G22"),
        same("G23"),
        same("G33"),
        same("G92"),
        same("M03"),
        same("M05"),
        same("T10"),
    ],
    macros: false,
};

impl Kind {
    /// Its words and figures.
    #[must_use]
    pub const fn face(self) -> &'static Face {
        match self {
            Self::Gc | Self::Gs | Self::Ga | Self::Vertical => &GRINDER,
            Self::Lathe => &LATHE,
        }
    }

    /// The planes of its drawings, rightwards and upwards, the usual one first.
    #[must_use]
    pub const fn planes(self) -> &'static [(Axis, Axis)] {
        match self {
            // Seen from above: Z along the part, X to the wheel.
            Self::Gc | Self::Lathe => &[(Axis::Z, Axis::X)],
            Self::Gs => &[(Axis::X, Axis::Y), (Axis::Z, Axis::Y), (Axis::X, Axis::Z)],
            Self::Ga | Self::Vertical => &[(Axis::X, Axis::Z)],
        }
    }

    /// What it grinds.
    #[must_use]
    pub const fn grinds(self) -> &'static [Form] {
        match self {
            Self::Gc => &[Form::Outside],
            Self::Gs => &[Form::Flat],
            Self::Ga => &[Form::Ring],
            Self::Vertical => &[Form::Outside, Form::Bore],
            Self::Lathe => &[],
        }
    }

    /// How its wheel stands in a drawing; none where tools cut.
    #[must_use]
    pub const fn wheel_pose(self) -> Option<WheelPose> {
        let (body, spindle) = match self {
            Self::Gc | Self::Vertical => (Axis::X, Axis::Z),
            Self::Gs => (Axis::Y, Axis::Z),
            Self::Ga => (Axis::Z, Axis::X),
            Self::Lathe => return None,
        };
        Some(WheelPose { body, spindle, by_centre: matches!(self, Self::Vertical) })
    }

    /// The program that pictures of its pages are taken with.
    #[must_use]
    pub const fn shown(self) -> &'static str {
        match self {
            Self::Gc | Self::Gs | Self::Ga => "O1001",
            Self::Vertical => "VGRIND",
            Self::Lathe => "SHAFT",
        }
    }
}
