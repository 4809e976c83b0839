//! Labels and drawing data of the pages that differ by kind of machine. Source: spec K1, L7–L9.

use super::kind::Kind;
use super::text::Text;
use crate::units::Axis;

/// The kind-dependent labels of the pages.
#[derive(Clone, Copy, Debug)]
pub struct KindUi {
    /// True for a lathe: a main spindle turns the part and tools cut it. False for a grinder.
    pub is_lathe: bool,
    /// Name of the spindle that S commands.
    pub spindle_name: Text,
    /// Last item of the process column: strokes per minute, or the active turret station.
    pub last_process_item: Text,
    /// Names of the two analog outputs.
    pub analog_output_names: [Text; 2],
    /// Title of the MDI page.
    pub mdi_title: Text,
    /// Title of the simulator tab that shows the part.
    pub part_tab: Text,
    /// One-touch codes of the MDI pad.
    pub mdi_codes: &'static [Text],
    /// The pad has the characters of the macro language, from its third row on.
    pub has_macros: bool,
}

/// A shape that can be ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrindingForm {
    /// Diameters, cones and shoulders of a rotating part.
    Outside,
    /// A bore of a rotating part.
    Bore,
    /// Planes and walls of a part on a reciprocating table.
    Flat,
    /// A plane of a part on a rotary table.
    RotaryFlat,
}

/// Orientation of the wheel in a drawing.
#[derive(Clone, Copy, Debug)]
pub struct WheelPose {
    /// The axis in whose plus direction the wheel body lies.
    pub body: Axis,
    /// The axis parallel to its spindle.
    pub spindle: Axis,
    /// The axis position is that of the wheel centre (S4), not of its foremost point.
    pub position_is_centre: bool,
}

const fn same(word: &'static str) -> Text {
    Text::new(word, word)
}

static GRINDER: KindUi = KindUi {
    is_lathe: false,
    spindle_name: Text::new("砂轮", "wheel"),
    last_process_item: Text::new("振荡", "strokes"),
    analog_output_names: [
        Text::new("模拟量 1 砂轮转速", "analog 1 wheel speed"),
        Text::new("模拟量 2 工件转速", "analog 2 work speed"),
    ],
    mdi_title: Text::new("录入", "MDI"),
    part_tab: Text::new("工件与砂轮", "PART, WHEEL"),
    mdi_codes: &[
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
    has_macros: true,
};

static LATHE: KindUi = KindUi {
    is_lathe: true,
    spindle_name: Text::new("主轴", "spindle"),
    last_process_item: Text::new("刀位", "station"),
    analog_output_names: [Text::new("模拟量 1 主轴转速", "analog 1 spindle speed"), Text::new("模拟量 2", "analog 2")],
    mdi_title: Text::new("立即执行", "MDI"),
    part_tab: Text::new("工件与刀具", "PART, TOOL"),
    mdi_codes: &[
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
    has_macros: false,
};

impl Kind {
    /// The page labels of the kind.
    #[must_use]
    pub const fn ui(self) -> &'static KindUi {
        match self {
            Self::Gc | Self::Gs | Self::Ga | Self::Vertical => &GRINDER,
            Self::Lathe => &LATHE,
        }
    }

    /// The drawing planes as (axis to the right, axis upwards), the default one first.
    #[must_use]
    pub const fn drawing_planes(self) -> &'static [(Axis, Axis)] {
        match self {
            // Seen from above: Z along the part, X to the wheel.
            Self::Gc | Self::Lathe => &[(Axis::Z, Axis::X)],
            Self::Gs => &[(Axis::X, Axis::Y), (Axis::Z, Axis::Y), (Axis::X, Axis::Z)],
            Self::Ga | Self::Vertical => &[(Axis::X, Axis::Z)],
        }
    }

    /// The shapes it can grind; empty for a lathe.
    #[must_use]
    pub const fn grinding_forms(self) -> &'static [GrindingForm] {
        match self {
            Self::Gc => &[GrindingForm::Outside],
            Self::Gs => &[GrindingForm::Flat],
            Self::Ga => &[GrindingForm::RotaryFlat],
            Self::Vertical => &[GrindingForm::Outside, GrindingForm::Bore],
            Self::Lathe => &[],
        }
    }

    /// Orientation of the wheel in a drawing; `None` for a lathe.
    #[must_use]
    pub const fn wheel_pose(self) -> Option<WheelPose> {
        let (body, spindle) = match self {
            Self::Gc | Self::Vertical => (Axis::X, Axis::Z),
            Self::Gs => (Axis::Y, Axis::Z),
            Self::Ga => (Axis::Z, Axis::X),
            Self::Lathe => return None,
        };
        Some(WheelPose { body, spindle, position_is_centre: matches!(self, Self::Vertical) })
    }

    /// The program used for screenshots of its pages.
    #[must_use]
    pub const fn picture_program(self) -> &'static str {
        match self {
            Self::Gc | Self::Gs | Self::Ga => "O1001",
            Self::Vertical => "VGRIND",
            Self::Lathe => "SHAFT",
        }
    }
}
