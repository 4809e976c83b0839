//! KT-830GC, cylindrical grinder: X infeed (diameter), Z table, headstock with two speeds, tailstock. Y by parameter.
//! Source: spec K1, column GC.

use super::panel::{DRESSING, FLUIDS, GAUGES, MachineUnit, MachineUnits, SECOND_SPINDLE, TRIAL, WHEEL, WHEEL_ALONE};
use super::ui::{GRINDER, GrindingForm, JOG_Y, KindUi, WheelPose};
use super::{Dialect, KindFactory, KindPrograms, KindRow};
use crate::defs::equipment::Equipment::{Gauges, Headstock, Hydraulics, Tailstock, Wheel};
use crate::defs::key::Key;
use crate::defs::text::Text;
use crate::units::{Axis, PerAxis};

const HEADSTOCK: MachineUnit =
    MachineUnit::new(Text::new("头架", "HEAD"), &[Key::HeadstockHigh, Key::HeadstockLow, Key::HeadstockStop], 1);
/// The magnet is there with P16.0=1, between the others.
const MAGNET: MachineUnit = MachineUnit::new(Text::new("磁力", "MAG"), &[Key::Magnetise, Key::Demagnetise], 1);
const TAILSTOCK: MachineUnit =
    MachineUnit::new(Text::new("尾座", "TAILSTOCK"), &[Key::TailstockAdvance, Key::TailstockRetract], 2);

pub(super) static ROW: KindRow = KindRow {
    id: "gc",
    short_name: "GC",
    name: Text::new("KT-830GC 外圆磨床", "KT-830GC cylindrical grinder"),
    summary: "cylindrical",
    dialect: Dialect::LatheA,
    programs: KindPrograms::SHARED,
    axes: PerAxis([true, false, true]),
    home_order: &[Axis::X, Axis::Z, Axis::Y],
    wheel_axis: Axis::X,
    equipment: &[Wheel, Headstock, Tailstock, Hydraulics, Gauges],
    page_files: &[],
    part_files: &[],
    factory: KindFactory::TABLE,
    machine_file: include_str!("../../../assets/machines/gc.ron"),
    dressing_program: Some(1_011),
    demo_story: Some(include_str!("../../../assets/stories/first_part.story")),
    film_stories: &[
        include_str!("../../../assets/stories/film_gc.story"),
        include_str!("../../../assets/stories/film_batch.story"),
    ],
    ui: KindUi {
        // Seen from above: Z along the part, X to the wheel; X− moves the wheel to the part, towards the operator.
        drawing_planes: &[(Axis::Z, Axis::X)],
        grinding_forms: &[GrindingForm::Outside, GrindingForm::Bore],
        wheel_pose: Some(WheelPose { body: Axis::X, spindle: Axis::Z, position_is_centre: false }),
        jog_cross: [[Key::ZMinus, Key::ZPlus], [Key::XPlus, Key::XMinus], JOG_Y],
        panel: MachineUnits::new(&[WHEEL, HEADSTOCK, MAGNET, FLUIDS, DRESSING], &[TAILSTOCK, GAUGES]),
        wide_panel: MachineUnits::new(
            &[WHEEL_ALONE, HEADSTOCK, MAGNET, FLUIDS, DRESSING, TRIAL],
            &[SECOND_SPINDLE, TAILSTOCK, GAUGES],
        ),
        ..GRINDER
    },
};
