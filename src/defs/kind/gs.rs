//! KT-830GS, surface grinder: X table, Y wheel head (down is minus), Z cross slide; magnet and dresser roll.
//! Source: spec K1, column GS.

use super::panel::{
    DRESSING, FLUIDS, GAUGES, MAGNET, MachineUnit, MachineUnits, SECOND_SPINDLE, TRIAL, WHEEL, WHEEL_ALONE,
};
use super::ui::{GRINDER, GrindingForm, JOG_X, JOG_Y, JOG_Z, KindUi, PLANE_GAUGES, WheelPose};
use super::{Dialect, KindFactory, KindPrograms, KindRow};
use crate::defs::equipment::Equipment::{DresserRoll, Gauges, Hydraulics, MagneticChuck, Wheel};
use crate::defs::key::Key;
use crate::defs::param::table;
use crate::defs::text::Text;
use crate::units::{Axis, PerAxis};

const ROLL: MachineUnit = MachineUnit::new(Text::new("修整器", "DRESSER"), &[Key::DresserRoll], 2);

pub(super) static ROW: KindRow = KindRow {
    id: "gs",
    short_name: "GS",
    name: Text::new("KT-830GS 平面磨床", "KT-830GS surface grinder"),
    summary: "surface",
    dialect: Dialect::Mill,
    programs: KindPrograms::SHARED,
    axes: PerAxis([true, true, true]),
    home_order: &[Axis::Y, Axis::Z, Axis::X],
    wheel_axis: Axis::Y,
    equipment: &[Wheel, DresserRoll, MagneticChuck, Hydraulics, Gauges],
    page_files: &[],
    part_files: &[],
    factory: KindFactory {
        numbers: &[
            (table::SOFT_MINUS_X, -600.0),
            (table::SOFT_MINUS_Z, -300.0),
            (table::WHEEL_DIAMETER, 500.0),
            (table::WHEEL_WIDTH, 40.0),
            (table::WHEEL_RATED_SPEED, 30.0),
            (table::DRESSING_PROGRAM_FIRST, 1_013.0),
            (table::DRESSING_PROGRAM_LAST, 1_013.0),
        ],
        bits: &[(table::RADIUS_PROGRAMMING, true), (table::Y_FITTED, true)],
        ..KindFactory::TABLE
    },
    machine_file: include_str!("../../../assets/machines/gs.ron"),
    dressing_program: Some(1_013),
    demo_story: Some(include_str!("../../../assets/stories/first_part_gs.story")),
    film_stories: &[include_str!("../../../assets/stories/film_gs.story")],
    ui: KindUi {
        key_labels: PLANE_GAUGES,
        drawing_planes: &[(Axis::X, Axis::Y), (Axis::Z, Axis::Y), (Axis::X, Axis::Z)],
        grinding_forms: &[GrindingForm::Flat],
        wheel_pose: Some(WheelPose { body: Axis::Y, spindle: Axis::Z, position_is_centre: false }),
        // X moves the table sideways, Y− lowers the wheel, Z moves away from the operator.
        jog_cross: [JOG_X, JOG_Y, JOG_Z],
        panel: MachineUnits::new(&[WHEEL, MAGNET, FLUIDS, DRESSING], &[ROLL, GAUGES]),
        wide_panel: MachineUnits::new(&[WHEEL_ALONE, MAGNET, FLUIDS, DRESSING, TRIAL], &[SECOND_SPINDLE, ROLL, GAUGES]),
        ..GRINDER
    },
};
