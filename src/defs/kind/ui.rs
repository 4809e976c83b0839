//! What the pages and the panel show differently by kind of machine: labels, drawings, keys. Source: spec K1, L7–L9.

use super::panel::MachineUnits;
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::text::Text;
use crate::units::Axis;

/// Labels, drawings and panel layout of one kind.
#[derive(Clone, Copy, Debug)]
pub struct KindUi {
    /// Name of the spindle that S commands.
    pub spindle_name: Text,
    /// Last item of the process column: strokes per minute, or the active turret station.
    pub last_process_item: Text,
    /// Names of the two analog outputs.
    pub analog_output_names: [Text; 2],
    /// Title of the simulator tab that shows the part.
    pub part_tab: Text,
    /// One-touch codes of the MDI pad.
    pub mdi_codes: &'static [Text],
    /// The pad has the characters of the macro language, from its third row on.
    pub has_macros: bool,
    /// Page titles that differ from the page table.
    pub page_titles: &'static [(Page, Text)],
    /// Key labels that differ from the key table.
    pub key_labels: &'static [KeyLabel],
    /// The drawing planes as (axis to the right, axis upwards), the default one first.
    pub drawing_planes: &'static [(Axis, Axis)],
    /// The shapes it can grind; empty for a lathe.
    pub grinding_forms: &'static [GrindingForm],
    /// Orientation of the wheel in a drawing; `None` for a lathe.
    pub wheel_pose: Option<WheelPose>,
    /// The program used for screenshots of its pages.
    pub picture_program: &'static str,
    /// Jog keys of the cross: left and right, up and down, and on the diagonal away from and towards the operator.
    pub jog_cross: [[Key; 2]; 3],
    /// The machine units on the panel, four key columns wide where all that is standard is fitted.
    pub panel: MachineUnits,
    /// The machine units on the wide panel, five key columns wide.
    pub wide_panel: MachineUnits,
}

/// The labels of a key on one kind.
#[derive(Clone, Copy, Debug)]
pub struct KeyLabel {
    /// The key.
    pub key: Key,
    /// The full label.
    pub full: Text,
    /// The label on the panel.
    pub short: Text,
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

/// Words that are the same in both languages.
macro_rules! same {
    ($($word:literal)*) => { &[$(Text::new($word, $word)),*] };
}
pub(super) use same;

/// The jog keys of each axis in the order of [`KindUi::jog_cross`].
pub(super) const JOG_X: [Key; 2] = [Key::XMinus, Key::XPlus];
pub(super) const JOG_Y: [Key; 2] = [Key::YPlus, Key::YMinus];
pub(super) const JOG_Z: [Key; 2] = [Key::ZPlus, Key::ZMinus];

/// The labels that the grinders share; each kind adds its drawings and its panel.
pub(super) const GRINDER: KindUi = KindUi {
    spindle_name: Text::new("砂轮", "wheel"),
    last_process_item: Text::new("振荡", "strokes"),
    analog_output_names: [
        Text::new("模拟量 1 砂轮转速", "analog 1 wheel speed"),
        Text::new("模拟量 2 工件转速", "analog 2 work speed"),
    ],
    part_tab: Text::new("工件与砂轮", "PART, WHEEL"),
    mdi_codes: same!["G00" "G01" "G04" "G50" "G54" "M03" "M05" "M08" "M09"],
    has_macros: true,
    page_titles: &[],
    key_labels: &[],
    drawing_planes: &[],
    grinding_forms: &[],
    wheel_pose: None,
    picture_program: "O1001",
    jog_cross: [JOG_X, JOG_Y, JOG_Z],
    panel: MachineUnits::new(&[], &[]),
    wide_panel: MachineUnits::new(&[], &[]),
};

/// K1: on surface and rotary-table grinders the gauges measure thickness and plane.
pub(super) const PLANE_GAUGES: &[KeyLabel] = &[
    KeyLabel {
        key: Key::RadialGauge, full: Text::new("厚度量仪", "THICKNESS"), short: Text::new("厚度", "THICK")
    },
    KeyLabel { key: Key::AxialGauge, full: Text::new("平面量仪", "PLANE"), short: Text::new("平面", "PLANE") },
];
