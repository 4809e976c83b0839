//! Vertical lathe-grinder (a vertical lathe with a grinding head on its right carriage): X wheel carriage (diameter),
//! Z along the table's axis; the table turns with the part clamped on it. Y by parameter. SINUMERIK 802D programs.
//! Source: spec sinumerik-802d.md, seed 002.

use super::panel::{DRESSING, FLUIDS, GAUGES, MachineUnits, SECOND_SPINDLE, TABLE, TRIAL, WHEEL, WHEEL_ALONE};
use super::ui::{GRINDER, GrindingForm, JOG_X, JOG_Y, JOG_Z, KindUi, WheelPose};
use super::{Dialect, KindFactory, KindPrograms, KindRow};
use crate::defs::equipment::Equipment::{Gauges, Hydraulics, RotaryTable, Wheel};
use crate::defs::page::Page;
use crate::defs::param::table;
use crate::defs::r_parameter_name;
use crate::defs::text::Text;
use crate::units::{Axis, PerAxis};

macro_rules! shipped {
    ($($name:literal)*) => {
        &[$(($name, include_bytes!(concat!("../../../programs/802d/", $name)))),*]
    };
}

pub(super) static ROW: KindRow = KindRow {
    id: "vertical",
    short_name: "802D",
    name: Text::new("立式车磨床 802D", "vertical lathe-grinder 802D"),
    summary: "lathe-grinder, 802D",
    dialect: Dialect::Sinumerik,
    programs: KindPrograms {
        folder: "802d",
        by_name: false,
        shipped: shipped! {
            "VGRIND.MPF" "L1.SPF" "L3.SPF" "L10.SPF" "L20.SPF" "L30.SPF"
            "VBORE.MPF" "L11.SPF" "L21.SPF" "L31.SPF" "RBORE.MPF" "RGRIND.MPF"
        },
    },
    axes: PerAxis([true, false, true]),
    home_order: &[Axis::X, Axis::Z, Axis::Y],
    wheel_axis: Axis::X,
    equipment: &[Wheel, RotaryTable, Hydraulics, Gauges],
    page_files: &[801, 802, 803],
    factory: KindFactory {
        numbers: &[
            (table::SOFT_MINUS_X, -450.0),
            (table::SOFT_MINUS_Z, -600.0),
            (table::WHEEL_DIAMETER, 300.0),
            (table::WHEEL_WIDTH, 40.0),
            (table::WHEEL_RATED_SPEED, 35.0),
            (table::WHEEL_RPM_MAX, 2_500.0),
            (table::WHEEL_RPM, 1_500.0),
            (table::HEADSTOCK_RPM_HIGH, 60.0),
            (table::HEADSTOCK_RPM_LOW, 60.0),
        ],
        r_parameters: r_parameter_name::R_FACTORY,
        ..KindFactory::TABLE
    },
    machine_file: include_str!("../../../assets/machines/vertical.ron"),
    demo_story: Some(include_str!("../../../assets/stories/vertical.story")),
    ui: KindUi {
        // S3: the grinding page shows the R parameters.
        page_titles: &[(Page::Grinding, Text::new("R 参数", "R parameters"))],
        drawing_planes: &[(Axis::X, Axis::Z)],
        grinding_forms: &[GrindingForm::Outside, GrindingForm::Bore],
        // S4: the position is that of the wheel centre.
        wheel_pose: Some(WheelPose { body: Axis::X, spindle: Axis::Z, position_is_centre: true }),
        picture_program: "VGRIND",
        // X moves across the table, Z− lowers the wheel.
        jog_cross: [JOG_X, JOG_Z, JOG_Y],
        panel: MachineUnits { beside: &[WHEEL, TABLE.across(1), FLUIDS, DRESSING], below: &[GAUGES.across(4)] },
        wide_panel: MachineUnits {
            beside: &[WHEEL_ALONE, TABLE.across(1), FLUIDS, DRESSING, TRIAL],
            below: &[SECOND_SPINDLE, GAUGES.across(4)],
        },
        ..GRINDER
    },
};
