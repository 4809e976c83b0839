//! KT-830GA, rotary-table grinder: X cross slide, Z wheel head (down is minus), rotary table, magnet. Y by parameter.
//! Source: spec K1, column GA.

use super::panel::{DRESSING, FLUIDS, GAUGES, MAGNET, MachineUnits, SECOND_SPINDLE, TABLE, TRIAL, WHEEL, WHEEL_ALONE};
use super::ui::{GRINDER, GrindingForm, JOG_X, JOG_Y, JOG_Z, KindUi, PLANE_GAUGES, WheelPose};
use super::{Dialect, KindFactory, KindPrograms, KindRow};
use crate::defs::equipment::Equipment::{Gauges, Hydraulics, MagneticChuck, RotaryTable, Wheel};
use crate::defs::param::table;
use crate::defs::text::Text;
use crate::units::{Axis, PerAxis};

pub(super) static ROW: KindRow = KindRow {
    id: "ga",
    short_name: "GA",
    name: Text::new("KT-830GA 圆台磨床", "KT-830GA rotary table grinder"),
    summary: "rotary table",
    dialect: Dialect::Mill,
    programs: KindPrograms::SHARED,
    axes: PerAxis([true, false, true]),
    home_order: &[Axis::Z, Axis::X, Axis::Y],
    wheel_axis: Axis::Z,
    equipment: &[Wheel, RotaryTable, MagneticChuck, Hydraulics, Gauges],
    page_files: &[],
    part_files: &[],
    factory: KindFactory {
        numbers: &[
            (table::SOFT_MINUS_X, -400.0),
            (table::SOFT_MINUS_Z, -300.0),
            (table::WHEEL_DIAMETER, 500.0),
            (table::WHEEL_WIDTH, 40.0),
            (table::WHEEL_RATED_SPEED, 30.0),
            (table::DRESSING_PROGRAM_FIRST, 1_014.0),
            (table::DRESSING_PROGRAM_LAST, 1_014.0),
        ],
        bits: &[(table::RADIUS_PROGRAMMING, true)],
        ..KindFactory::TABLE
    },
    machine_file: include_str!("../../../assets/machines/ga.ron"),
    dressing_program: Some(1_014),
    demo_story: Some(include_str!("../../../assets/stories/first_part_ga.story")),
    film_stories: &[include_str!("../../../assets/stories/film_ga.story")],
    ui: KindUi {
        key_labels: PLANE_GAUGES,
        drawing_planes: &[(Axis::X, Axis::Z)],
        grinding_forms: &[GrindingForm::RotaryFlat],
        wheel_pose: Some(WheelPose { body: Axis::Z, spindle: Axis::X, position_is_centre: false }),
        // X moves across the table, Z− lowers the wheel.
        jog_cross: [JOG_X, JOG_Z, JOG_Y],
        panel: MachineUnits::new(&[WHEEL, MAGNET, FLUIDS, DRESSING], &[TABLE, GAUGES]),
        wide_panel: MachineUnits::new(
            &[WHEEL_ALONE, MAGNET, FLUIDS, DRESSING, TRIAL],
            &[SECOND_SPINDLE, TABLE, GAUGES],
        ),
        ..GRINDER
    },
};
