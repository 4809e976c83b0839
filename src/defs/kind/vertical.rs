//! Vertical lathe-grinder (a vertical lathe with a grinding head on its right carriage): X wheel carriage (diameter),
//! Z along the table's axis; the table turns with the part clamped on it. Y by parameter. SINUMERIK 802D programs.
//! Source: spec sinumerik-802d.md, seed 002.

use super::panel::{DRESSING, FLUIDS, GAUGES, MachineUnits, SECOND_SPINDLE, TABLE, TRIAL, WHEEL, WHEEL_ALONE};
use super::ui::{GRINDER, GrindingForm, JOG_X, JOG_Y, JOG_Z, KindUi, WheelPose};
use super::{Dialect, KindFactory, KindPrograms, KindRow};
use crate::defs::equipment::Equipment::{Gauges, Hydraulics, RotaryTable, Wheel};
use crate::defs::page::Page;
use crate::defs::param::table;
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
            "VBORE.MPF" "L11.SPF" "L21.SPF" "L31.SPF" "L40.SPF" "RBORE.MPF" "RGRIND.MPF"
        },
    },
    axes: PerAxis([true, false, true]),
    home_order: &[Axis::X, Axis::Z, Axis::Y],
    wheel_axis: Axis::X,
    equipment: &[Wheel, RotaryTable, Hydraulics, Gauges],
    page_files: &[801, 802, 803],
    part_files: &[802],
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
        r_parameters: R_PARAMETERS,
        ..KindFactory::TABLE
    },
    machine_file: include_str!("../../../assets/machines/vertical.ron"),
    dressing_program: None,
    demo_story: Some(include_str!("../../../assets/stories/vertical.story")),
    film_stories: &[],
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
        panel: MachineUnits::new(&[WHEEL, TABLE.across(1), FLUIDS, DRESSING], &[GAUGES.across(4)]),
        wide_panel: MachineUnits::new(
            &[WHEEL_ALONE, TABLE.across(1), FLUIDS, DRESSING, TRIAL],
            &[SECOND_SPINDLE, GAUGES.across(4)],
        ),
        ..GRINDER
    },
};

/// The R parameters (S3): a ring of 200.5 mm ground to 200 mm (S4, S5). R11 and R12 follow from the machine data: the
/// wheel touches the diamond at X machine −50, Z machine −300; G54 is X −450, Z −500.
#[rustfmt::skip]
const R_PARAMETERS: &[(u16, f64)] = &[
    // The wheel: smallest, greatest and present diameter, width, limits of speed (R5: none), speed, radius of the edge.
    (1, 220.0), (2, 300.0), (3, 300.0), (4, 40.0), (5, 0.0), (6, 2_200.0), (7, 30.0), (9, 0.0),
    // The diamond: R11 is 2 · (450 − 50) + 300, R12 is 500 − 300. Block height, head angle, dwell (s), P79.
    (10, 0.5), (11, 1_100.0), (12, 200.0), (13, 40.0), (14, 0.0), (15, 0.2), (16, 35.0),
    // Finished sizes, sizes at the start; fine grinding, rough grinding, spark-out.
    (18, 200.0), (19, 35.0), (20, 200.5), (21, 105.0),
    (22, 0.005), (23, 1_200.0), (24, 4.0), (25, 0.05), (28, 0.02), (29, 800.0), (30, 25.0), (32, 3.0), (33, 1_200.0),
    // Dressing, clearance, middle point.
    (36, 0.03), (37, 0.02), (38, 600.0), (39, 0.1), (42, 0.1), (43, 0.1), (44, 1_500.0), (46, 700.0), (47, 250.0),
];
