//! 超人 (SuperMan) lathe: X cross slide (diameter), Z carriage, main spindle with encoder, tool turret with four stations.
//! No wheel, no hydraulics, no gauges.
//! Source: spec superman-lathe.md, seed 001.

use super::panel::{MachineUnit, MachineUnits, TRIAL};
use super::ui::{JOG_Y, KindUi, same};
use super::{Dialect, KindFactory, KindPrograms, KindRow};
use crate::defs::equipment::Equipment::{MainSpindle, ToolTurret};
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::param::table;
use crate::defs::text::Text;
use crate::units::{Axis, PerAxis};

const MAIN_SPINDLE: MachineUnit =
    MachineUnit::new(Text::new("主轴", "SPDL"), &[Key::SpindleForward, Key::SpindleReverse, Key::SpindleStop], 2);
const FLUIDS: MachineUnit = MachineUnit::new(Text::new("液体", "FLUIDS"), &[Key::Coolant, Key::Lubrication], 2);
const TURRET: MachineUnit = MachineUnit::new(Text::new("刀架", "POST"), &[Key::ToolTurret], 4);

pub(super) static ROW: KindRow = KindRow {
    id: "lathe",
    short_name: "LATHE",
    name: Text::new("超人车床", "SuperMan lathe"),
    summary: "超人",
    dialect: Dialect::SuperMan,
    programs: KindPrograms {
        folder: "lathe",
        by_name: true,
        shipped: &[
            ("SHAFT.NC", include_bytes!("../../../programs/lathe/SHAFT.NC")),
            ("TEST.NC", include_bytes!("../../../programs/lathe/TEST.NC")),
        ],
    },
    axes: PerAxis([true, false, true]),
    home_order: &[Axis::X, Axis::Z, Axis::Y],
    wheel_axis: Axis::X,
    equipment: &[MainSpindle, ToolTurret],
    page_files: &[],
    part_files: &[],
    factory: KindFactory {
        numbers: &[
            (table::RAPID_X, 2_000.0),
            (table::RAPID_Z, 4_000.0),
            (table::WHEEL_RPM_MAX, 5_000.0),
            (table::WHEEL_RPM, 200.0),
            (table::WHEEL_DIAMETER, 10.0),
            (table::HYDRAULIC_DELAY, 0.0),
            (table::HOME_FAST, 2_000.0),
        ],
        // L2: rapid 2000–6000 mm/min on Z, half of that on X.
        ranges: &[(table::RAPID_X, 1_000.0, 3_000.0), (table::RAPID_Z, 2_000.0, 6_000.0)],
        ..KindFactory::TABLE
    },
    machine_file: include_str!("../../../assets/machines/lathe.ron"),
    dressing_program: None,
    demo_story: Some(include_str!("../../../assets/stories/shaft.story")),
    film_stories: &[],
    ui: KindUi {
        spindle_name: Text::new("主轴", "spindle"),
        last_process_item: Text::new("刀位", "station"),
        analog_output_names: [
            Text::new("模拟量 1 主轴转速", "analog 1 spindle speed"),
            Text::new("模拟量 2", "analog 2"),
        ],
        part_tab: Text::new("工件与刀具", "PART, TOOL"),
        mdi_codes: same!["G00" "G01" "G22" "G23" "G33" "G92" "M03" "M05" "T10"],
        has_macros: false,
        page_titles: &[(Page::Mdi, Text::new("立即执行", "MDI"))],
        key_labels: &[],
        drawing_planes: &[(Axis::Z, Axis::X)],
        grinding_forms: &[],
        wheel_pose: None,
        picture_program: "SHAFT",
        jog_cross: [[Key::ZMinus, Key::ZPlus], [Key::XPlus, Key::XMinus], JOG_Y],
        panel: MachineUnits::new(&[MAIN_SPINDLE, FLUIDS], &[TURRET]),
        wide_panel: MachineUnits::new(&[MAIN_SPINDLE, FLUIDS, TRIAL], &[TURRET.across(5)]),
    },
};
