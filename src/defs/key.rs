//! The panel keys: id, label, group, the device they belong to, and whether they work while a program runs.
//! Source: spec K2, H2, tools.md (ids).

use serde::{Deserialize, Serialize};

use super::equipment::{Needs, needs};
use super::signal::Output;
use super::text::Text;
use crate::units::Axis;

/// A group of keys on the panel (H2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KeyGroup {
    /// 编辑 … 手动
    Mode,
    /// 单段 … 空运行
    Switch,
    /// 循环启动 进给保持 复位 急停
    Run,
    /// 倍率
    Override,
    /// Axis keys.
    Jog,
    /// 手轮
    Handwheel,
    /// 砂轮
    Wheel,
    /// 头架, 滚轮, 台面
    Workpiece,
    /// 尾座, 充磁
    Clamping,
    /// 冷却 润滑 液压
    Fluids,
    /// 量仪
    Gauges,
    /// 修整, 振荡, 回退
    Dressing,
    /// Keys of the control screen: soft keys, address keys, 输入, 取消.
    Screen,
}

/// An operating mode of the control (B5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Mode {
    /// 编辑
    Edit,
    /// 自动
    Auto,
    /// 录入
    Mdi,
    /// 机械零点
    Home,
    /// 手轮
    Handwheel,
    /// 单步
    Step,
    /// 手动
    #[default]
    Manual,
}

impl Mode {
    /// All modes in panel order.
    pub const ALL: [Self; 7] =
        [Self::Edit, Self::Auto, Self::Mdi, Self::Home, Self::Handwheel, Self::Step, Self::Manual];

    /// The mode of a word in a story (`mode jog` is manual).
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        let id = if id == "jog" { "manual" } else { id };
        Self::ALL.into_iter().find(|mode| mode.key().id().strip_prefix("mode-") == Some(id))
    }

    /// The key that selects the mode.
    #[must_use]
    pub const fn key(self) -> Key {
        match self {
            Self::Edit => Key::ModeEdit,
            Self::Auto => Key::ModeAuto,
            Self::Mdi => Key::ModeMdi,
            Self::Home => Key::ModeHome,
            Self::Handwheel => Key::ModeHandwheel,
            Self::Step => Key::ModeStep,
            Self::Manual => Key::ModeManual,
        }
    }

    /// The name in the status line.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Edit => Text::new("编辑方式", "edit"),
            Self::Auto => Text::new("自动方式", "auto"),
            Self::Mdi => Text::new("录入方式", "MDI"),
            Self::Home => Text::new("机械零点", "home"),
            Self::Handwheel => Text::new("手轮方式", "handwheel"),
            Self::Step => Text::new("单步方式", "step"),
            Self::Manual => Text::new("手动方式", "manual"),
        }
    }
}

/// What a key's lamp shows: always the actual state, never the requested one (K2.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lamp {
    /// The key has no lamp.
    None,
    /// An output is on.
    Output(Output),
    /// An output is off (stop keys).
    OutputOff(Output),
    /// A state of the control, set by the core.
    Control,
}

/// One row of the key table.
#[derive(Clone, Copy, Debug)]
pub struct KeyRow {
    /// The word used in stories.
    pub id: &'static str,
    /// Label: Chinese 2–4 characters, English.
    pub label: Text,
    /// Key group on the panel.
    pub group: KeyGroup,
    /// The device that it belongs to.
    pub needs: Needs,
    /// Whether it works while a program runs (K2.2).
    pub active_in_run: bool,
    /// What its lamp shows.
    pub lamp: Lamp,
    /// Function and conditions.
    pub help: Text,
}

macro_rules! keys {
    ($($variant:ident = $id:literal, $zh:literal, $en:literal, $group:ident, $needs:ident, $in_run:literal, $lamp:expr,
        $help_zh:literal, $help_en:literal;)*) => {
        /// A key of the panel or of the control screen.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[repr(u8)]
        pub enum Key { $(#[doc = $en] $variant,)* }

        impl Key {
            /// All keys in table order.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];
            /// Number of keys.
            pub const COUNT: usize = Self::ALL.len();

            /// The row of the key.
            #[must_use]
            pub const fn row(self) -> KeyRow {
                match self {
                    $(Self::$variant => KeyRow {
                        id: $id, label: Text::new($zh, $en), group: KeyGroup::$group,
                        needs: needs!($needs), active_in_run: $in_run, lamp: $lamp,
                        help: Text::new($help_zh, $help_en),
                    },)*
                }
            }
        }
    };
}

use Lamp::{Control, None as Dark, Output as Out, OutputOff};

keys! {
    ModeEdit = "mode-edit", "编辑", "EDIT", Mode, ANY, false, Control,
        "编辑方式：在程序页和目录页改程序。", "Mode EDIT: edit programs on the program page and in the directory.";
    ModeAuto = "mode-auto", "自动", "AUTO", Mode, ANY, false, Control,
        "自动方式：循环启动执行当前程序。", "Mode AUTO: cycle start runs the current program.";
    ModeMdi = "mode-mdi", "录入", "MDI", Mode, ANY, false, Control,
        "录入方式：在录入页输入一行，按输入备好，再按循环启动执行。", "Mode MDI: type a line on the MDI page, INPUT makes it ready, cycle start executes it.";
    ModeHome = "mode-home", "机械零点", "HOME", Mode, ANY, false, Control,
        "机械零点方式：按轴键回零；开机后先回零，软限位才有效。", "Mode HOME: the axis keys start homing; soft limits act only after homing.";
    ModeHandwheel = "mode-handwheel", "手轮", "HANDWHL", Mode, ANY, false, Control,
        "手轮方式：选轴和倍率后转手轮。", "Mode HANDWHEEL: choose axis and step, then turn the handwheel.";
    ModeStep = "mode-step", "单步", "STEP", Mode, ANY, false, Control,
        "单步方式：每按一次轴键走一个倍率步。", "Mode STEP: each press of an axis key moves one step.";
    ModeManual = "mode-manual", "手动", "JOG", Mode, ANY, false, Control,
        "手动方式：按住轴键移动，松开停止。", "Mode JOG: an axis moves while its key is held.";
    SingleBlock = "single-block", "单段", "SINGLE", Switch, ANY, true, Control,
        "灯亮：每段后停，按循环启动走下一段。运行中可切换。", "Lit: the program stops after every block; cycle start runs the next one. Can be switched during a run.";
    BlockSkip = "block-skip", "跳段", "SKIP", Switch, ANY, true, Control,
        "灯亮：以 / 开头的程序段不执行。", "Lit: blocks that begin with / are skipped.";
    OptionalStop = "optional-stop", "选择停", "OPT STOP", Switch, ANY, true, Control,
        "灯亮：M01 处停止。", "Lit: the program stops at M01.";
    MachineLock = "machine-lock", "机床锁", "LOCK", Switch, ANY, false, Control,
        "灯亮：坐标走、轴不动，用来试程序。轴静止且没有程序时才能切换。", "Lit: positions count but the axes do not move, for testing a program. Switch it only with no program active and the axes at rest.";
    AuxFunctionLock = "mst-lock", "辅助锁", "MST LOCK", Switch, ANY, false, Control,
        "灯亮：M、S、T 不输出（M00 M01 M30 M31 M98 M99 除外）。", "Lit: M, S and T codes are not executed, except M00, M01, M30, M31, M98, M99.";
    DryRun = "dry-run", "空运行", "DRY RUN", Switch, ANY, false, Control,
        "灯亮：进给按 P89，砂轮不启动；砂轮停着才能启动。运行中不能切换。", "Lit: feeds at P89, the wheel does not start and must be off. Cannot be switched during a run.";
    CycleStart = "cycle-start", "循环启动", "START", Run, ANY, true, Control,
        "启动程序、备好的录入行，或继续暂停的程序。不能启动时信息行说明原因。", "Starts the program or the MDI line that is ready, or continues after a hold. The message line shows why it cannot start.";
    FeedHold = "feed-hold", "进给保持", "HOLD", Run, ANY, true, Control,
        "轴减速停住，程序保持；循环启动继续。暂停中所有键有效。", "The axes stop, the program stays active; cycle start continues. All keys work during the hold.";
    Reset = "reset", "复位", "RESET", Run, ANY, true, Dark,
        "结束程序、运动、振荡和头架，清除已排除原因的报警。砂轮、冷却、液压、磁力、尾座不变。", "Ends program, motion, oscillation and workpiece drive, clears alarms whose cause is gone. Wheel, fluids, magnet and tailstock stay as they are.";
    EmergencyStop = "emergency-stop", "急停", "E-STOP", Run, ANY, true, Control,
        "立即停轴，关砂轮、头架、冷却、振荡；液压、磁力、尾座不变。再按一次松开，然后复位。", "Stops axes at once; wheel, workpiece drive, coolant, oscillation off; hydraulics, magnet, tailstock stay. Press again to release, then RESET.";
    FeedOverrideUp = "feed-override-up", "进给倍率+", "FEED +", Override, ANY, true, Dark,
        "进给倍率加 10 %，最高 150 %。", "Feed override up by 10 %, to 150 %.";
    FeedOverrideDown = "feed-override-down", "进给倍率-", "FEED -", Override, ANY, true, Dark,
        "进给倍率减 10 %，到 0 % 停。", "Feed override down by 10 %; at 0 % the axes stop.";
    RapidF0 = "rapid-f0", "快速F0", "RAPID F0", Override, ANY, true, Control,
        "快速倍率 F0：按参数的最低快速。", "Rapid override F0: the lowest rapid speed, set by parameter.";
    Rapid25 = "rapid-25", "快速25%", "RAPID 25", Override, ANY, true, Control,
        "快速倍率 25 %。", "Rapid override 25 %.";
    Rapid50 = "rapid-50", "快速50%", "RAPID 50", Override, ANY, true, Control,
        "快速倍率 50 %。", "Rapid override 50 %.";
    Rapid100 = "rapid-100", "快速100%", "RAPID 100", Override, ANY, true, Control,
        "快速倍率 100 %。", "Rapid override 100 %.";
    SpindleOverrideUp = "spindle-override-up", "主轴倍率+", "SPDL +", Override, ANY, true, Dark,
        "主轴倍率加 10 %，最高 120 %。", "Spindle override up by 10 %, to 120 %.";
    SpindleOverrideDown = "spindle-override-down", "主轴倍率-", "SPDL -", Override, ANY, true, Dark,
        "主轴倍率减 10 %，最低 50 %。", "Spindle override down by 10 %, to 50 %.";
    XPlus = "x-plus", "X+", "X+", Jog, ANY, false, Dark,
        "X 轴正向：手动按住移动，单步走一步，机械零点方式回零。", "X plus: jogs while held, one step in STEP, homes in HOME.";
    XMinus = "x-minus", "X-", "X-", Jog, ANY, false, Dark,
        "X 轴负向：手动按住移动，单步走一步，机械零点方式回零。", "X minus: jogs while held, one step in STEP, homes in HOME.";
    YPlus = "y-plus", "Y+", "Y+", Jog, ANY, false, Dark,
        "Y 轴正向：手动按住移动，单步走一步，机械零点方式回零。", "Y plus: jogs while held, one step in STEP, homes in HOME.";
    YMinus = "y-minus", "Y-", "Y-", Jog, ANY, false, Dark,
        "Y 轴负向：手动按住移动，单步走一步，机械零点方式回零。", "Y minus: jogs while held, one step in STEP, homes in HOME.";
    ZPlus = "z-plus", "Z+", "Z+", Jog, ANY, false, Dark,
        "Z 轴正向：手动按住移动，单步走一步，机械零点方式回零。", "Z plus: jogs while held, one step in STEP, homes in HOME.";
    ZMinus = "z-minus", "Z-", "Z-", Jog, ANY, false, Dark,
        "Z 轴负向：手动按住移动，单步走一步，机械零点方式回零。", "Z minus: jogs while held, one step in STEP, homes in HOME.";
    Rapid = "rapid", "快速", "RAPID", Jog, ANY, false, Control,
        "手动时与轴键同按：以快速移动。砂轮转动时慢方向无效。", "With an axis key: jogs at rapid speed. No effect towards the part while the wheel turns.";
    HandwheelX = "handwheel-x", "手轮X", "WHEEL X", Handwheel, ANY, false, Control,
        "手轮接 X 轴。", "The handwheel moves X.";
    HandwheelY = "handwheel-y", "手轮Y", "WHEEL Y", Handwheel, ANY, false, Control,
        "手轮接 Y 轴。", "The handwheel moves Y.";
    HandwheelZ = "handwheel-z", "手轮Z", "WHEEL Z", Handwheel, ANY, false, Control,
        "手轮接 Z 轴。", "The handwheel moves Z.";
    Step0001 = "step-0.001", "×0.001", "×0.001", Handwheel, ANY, false, Control,
        "手轮、单步每格 0.001 mm。", "Handwheel and step: 0.001 mm.";
    Step001 = "step-0.01", "×0.01", "×0.01", Handwheel, ANY, false, Control,
        "手轮、单步每格 0.01 mm。", "Handwheel and step: 0.01 mm.";
    Step01 = "step-0.1", "×0.1", "×0.1", Handwheel, ANY, false, Control,
        "手轮、单步每格 0.1 mm；砂轮转动时慢方向的轴不能用。", "Handwheel and step: 0.1 mm; refused on the infeed axis while the wheel turns.";
    WheelStart = "wheel-start", "砂轮启动", "WHEEL ON", Wheel, Wheel, false, Out(Output::Wheel),
        "启动砂轮：液压开并有压力、需要时已充磁、防护门关。不满足时报警 180 或说明原因。", "Starts the wheel. Needs hydraulics on with pressure, the part magnetised where required, guard closed; otherwise alarm 180 or the reason.";
    WheelStop = "wheel-stop", "砂轮停止", "WHEEL OFF", Wheel, Wheel, false, OutputOff(Output::Wheel),
        "断开砂轮，惯性停转；灯亮表示已断开。", "Wheel off; it coasts to a stop. Lit while it is off.";
    SecondSpindle = "second-spindle", "第二主轴", "SPINDLE 2", Wheel, Wheel, false, Out(Output::SecondSpindle),
        "第二主轴启动、停止。", "Second spindle on and off.";
    SpindleForward = "spindle-forward", "主轴正转", "SPDL CW", Workpiece, MainSpindle, false, Control,
        "主轴正转。", "Spindle forward.";
    SpindleReverse = "spindle-reverse", "主轴反转", "SPDL CCW", Workpiece, MainSpindle, false, Control,
        "主轴反转。", "Spindle in reverse.";
    SpindleStop = "spindle-stop", "主轴停止", "SPDL STOP", Workpiece, MainSpindle, false, Control,
        "主轴停止。", "Spindle off.";
    ToolTurret = "tool-post", "换刀", "TOOL", Clamping, ToolTurret, false, Control,
        "刀架转到下一刀位；轴静止时有效。", "The tool post turns to the next station.";
    HeadstockHigh = "headstock-high", "头架高速", "HEAD HIGH", Workpiece, Headstock, false, Out(Output::HeadstockHigh),
        "头架高速；尾座动作中报警 181。", "Headstock at high speed; alarm 181 while the tailstock moves.";
    HeadstockLow = "headstock-low", "头架低速", "HEAD LOW", Workpiece, Headstock, false, Out(Output::HeadstockLow),
        "头架低速；尾座动作中报警 181。", "Headstock at low speed; alarm 181 while the tailstock moves.";
    HeadstockStop = "headstock-stop", "头架停止", "HEAD STOP", Workpiece, Headstock, false, Control,
        "头架停止。", "Headstock off.";
    DresserRoll = "dresser-roll", "滚轮", "ROLL", Workpiece, DresserRoll, false, Out(Output::DresserRoll),
        "滚轮启动、停止。", "Dresser roll on and off.";
    TableRotation = "table-rotation", "台面旋转", "TABLE", Workpiece, RotaryTable, false, Out(Output::TableRotation),
        "台面旋转启动、停止；圆台磨须先充磁。", "Table on and off; GA: magnetise first.";
    TailstockAdvance = "tailstock-advance", "尾座进", "TAIL IN", Clamping, Tailstock, false, Out(Output::Tailstock),
        "尾座前进夹紧，P16.2=1 有效；头架转动时报警 181。", "Tailstock advances and clamps, with P16.2=1; alarm 181 while the headstock turns.";
    TailstockRetract = "tailstock-retract", "尾座退", "TAIL OUT", Clamping, Tailstock, false, OutputOff(Output::Tailstock),
        "尾座退回；头架转动时报警 181。", "Tailstock retracts; alarm 181 while the headstock turns.";
    Magnetise = "magnetise", "充磁", "MAGNET", Clamping, MagneticChuck, false, Out(Output::Magnetise),
        "充磁，P81 后为已充磁；再按断磁。", "Magnet on, it holds after P81; press again for off.";
    Demagnetise = "demagnetise", "退磁", "DEMAG", Clamping, MagneticChuck, false, Out(Output::Demagnetise),
        "退磁 P82 后断开；台面或砂轮转动时拒绝。", "Demagnetises for P82, then off; refused while table or wheel turns.";
    Coolant = "coolant", "冷却", "COOLANT", Fluids, ANY, true, Out(Output::Coolant),
        "冷却液开关，运行中也有效。", "Coolant on and off, also during a run.";
    Lubrication = "lubrication", "润滑", "LUBE", Fluids, ANY, true, Out(Output::Lubrication),
        "润滑开关，运行中也有效。", "Lubrication on and off, also during a run.";
    Hydraulic = "hydraulic", "液压", "HYDRAUL", Fluids, Hydraulics, false, Out(Output::Hydraulic),
        "液压泵开关；砂轮转动时无效。复位和急停不关液压。", "Hydraulic pump on and off; no effect while the wheel runs. RESET and emergency stop do not switch it off.";
    RadialGauge = "radial-gauge", "径向量仪", "RADIAL", Gauges, Gauges, false, Out(Output::RadialGauge),
        "径向（平磨、圆台磨：厚度）量仪伸出、缩回，同 M70 M75。", "Radial (GS, GA: thickness) gauge out and in, as M70, M75.";
    AxialGauge = "axial-gauge", "轴向量仪", "AXIAL", Gauges, Gauges, false, Out(Output::AxialGauge),
        "轴向（平磨、圆台磨：平面）量仪伸出、缩回，同 M78 M79。", "Axial (GS, GA: plane) gauge out and in, as M78, M79.";
    Oscillation = "oscillation", "振荡", "OSCILL", Dressing, Wheel, false, Control,
        "振荡开关：轴 P238、位置 P239、时间常数 P240、次数 P241。灯亮时启动新程序报警 182。", "Oscillation on and off: axis P238, position P239, time constant P240, strokes P241. Starting a program while it is on: alarm 182.";
    DressReturn = "dress-return", "回修整点", "DRESS PT", Dressing, Wheel, false, Control,
        "灯亮后按轴键，该轴以 P243 回修整点；再按、换方式或复位灯灭。灯灭时轴键是手动。", "Lit: an axis key moves the axis to its dressing point at P243. Off: press again, another mode or RESET; axis keys then jog.";
    WheelRetract = "wheel-retract", "一键回退", "RETRACT", Dressing, Wheel, true, Control,
        "P4.4=1：停程序并执行 O9000 退砂轮；再按执行 O9001 回来，循环启动继续。", "With P4.4=1: holds the program and runs O9000 to retract the wheel; press again: O9001 returns it, cycle start continues.";
    AddressX = "address-x", "X", "X", Screen, ANY, true, Dark,
        "地址键 X：位置页相对坐标上设修整点、清相对坐标时选轴。", "Address X: selects the axis for the dressing point on the relative position page.";
    AddressY = "address-y", "Y", "Y", Screen, ANY, true, Dark,
        "地址键 Y：位置页相对坐标上设修整点、清相对坐标时选轴。", "Address Y: selects the axis for the dressing point on the relative position page.";
    AddressZ = "address-z", "Z", "Z", Screen, ANY, true, Dark,
        "地址键 Z：位置页相对坐标上设修整点、清相对坐标时选轴。", "Address Z: selects the axis for the dressing point on the relative position page.";
    Input = "input", "输入", "INPUT", Screen, ANY, true, Dark,
        "输入：确认所键入的值，或回答问题。", "INPUT: accepts the typed value, or answers a question.";
    Cancel = "cancel", "取消", "CANCEL", Screen, ANY, true, Dark,
        "取消：清除所键入的值，恢复原值。", "CANCEL: discards the typed value, the old value stays.";
    F1 = "f1", "F1", "F1", Screen, ANY, true, Dark,
        "当前软键行的第 1 个键。", "Key 1 of the current soft key row.";
    F2 = "f2", "F2", "F2", Screen, ANY, true, Dark,
        "当前软键行的第 2 个键。", "Key 2 of the current soft key row.";
    F3 = "f3", "F3", "F3", Screen, ANY, true, Dark,
        "当前软键行的第 3 个键。", "Key 3 of the current soft key row.";
    F4 = "f4", "F4", "F4", Screen, ANY, true, Dark,
        "当前软键行的第 4 个键。", "Key 4 of the current soft key row.";
    F5 = "f5", "F5", "F5", Screen, ANY, true, Dark,
        "当前软键行的第 5 个键。", "Key 5 of the current soft key row.";
    NextRow = "next-row", "▶", "NEXT", Screen, ANY, true, Dark,
        "软键翻到下一行。", "The next row of soft keys.";
    PreviousRow = "previous-row", "◀", "PREVIOUS", Screen, ANY, true, Dark,
        "软键翻回上一行。", "The previous row of soft keys.";
}

impl Key {
    /// The word used in stories.
    #[must_use]
    pub const fn id(self) -> &'static str {
        self.row().id
    }

    /// The label.
    #[must_use]
    pub const fn label(self) -> Text {
        self.row().label
    }

    /// The label on the panel: shortened where the group caption gives the context.
    #[must_use]
    pub(super) const fn short(self) -> Text {
        match self {
            Self::ModeHandwheel => Text::new("手轮", "MPG"),
            Self::OptionalStop => Text::new("选择停", "M01"),
            Self::AuxFunctionLock => Text::new("辅助锁", "MST"),
            Self::MachineLock => Text::new("机床锁", "LOCK"),
            Self::DryRun => Text::new("空运行", "DRY"),
            Self::FeedOverrideUp | Self::SpindleOverrideUp | Self::FeedOverrideDown | Self::SpindleOverrideDown => {
                Text::new("", "")
            }
            Self::RapidF0 => Text::new("F0", "F0"),
            Self::Rapid25 => Text::new("25%", "25%"),
            Self::Rapid50 => Text::new("50%", "50%"),
            Self::Rapid100 => Text::new("100%", "100%"),
            Self::HandwheelX => Text::new("X", "X"),
            Self::HandwheelY => Text::new("Y", "Y"),
            Self::HandwheelZ => Text::new("Z", "Z"),
            Self::WheelStart => Text::new("启动", "START"),
            Self::WheelStop => Text::new("停止", "STOP"),
            Self::SecondSpindle => Text::new("第二主轴", "SPDL 2"),
            Self::SpindleForward => Text::new("正转", "CW"),
            Self::SpindleReverse => Text::new("反转", "CCW"),
            Self::SpindleStop => Text::new("停止", "STOP"),
            Self::HeadstockHigh => Text::new("高速", "HIGH"),
            Self::HeadstockLow => Text::new("低速", "LOW"),
            Self::HeadstockStop => Text::new("停止", "STOP"),
            Self::TailstockAdvance => Text::new("进", "IN"),
            Self::TailstockRetract => Text::new("退", "OUT"),
            Self::Coolant => Text::new("冷却", "COOL"),
            Self::Lubrication => Text::new("润滑", "LUBE"),
            Self::Hydraulic => Text::new("液压", "HYDR"),
            Self::RadialGauge => Text::new("径向", "RADIAL"),
            Self::AxialGauge => Text::new("轴向", "AXIAL"),
            Self::TableRotation => Text::new("台面旋转", "ROTATE"),
            Self::DressReturn => Text::new("回修整点", "POINT"),
            Self::WheelRetract => Text::new("一键回退", "RETRACT"),
            _ => self.label(),
        }
    }

    /// Axis and sign of a jog key.
    #[must_use]
    pub const fn jog_direction(self) -> Option<(Axis, f64)> {
        Some(match self {
            Self::XPlus => (Axis::X, 1.0),
            Self::XMinus => (Axis::X, -1.0),
            Self::YPlus => (Axis::Y, 1.0),
            Self::YMinus => (Axis::Y, -1.0),
            Self::ZPlus => (Axis::Z, 1.0),
            Self::ZMinus => (Axis::Z, -1.0),
            _ => return None,
        })
    }

    /// The axis of a jog, handwheel or address key.
    #[must_use]
    pub const fn axis(self) -> Option<Axis> {
        match self {
            Self::XPlus | Self::XMinus | Self::HandwheelX | Self::AddressX => Some(Axis::X),
            Self::YPlus | Self::YMinus | Self::HandwheelY | Self::AddressY => Some(Axis::Y),
            Self::ZPlus | Self::ZMinus | Self::HandwheelZ | Self::AddressZ => Some(Axis::Z),
            _ => None,
        }
    }

    /// The jog key of an axis and a direction.
    #[must_use]
    pub const fn from_jog(axis: Axis, plus: bool) -> Self {
        match (axis, plus) {
            (Axis::X, true) => Self::XPlus,
            (Axis::X, false) => Self::XMinus,
            (Axis::Y, true) => Self::YPlus,
            (Axis::Y, false) => Self::YMinus,
            (Axis::Z, true) => Self::ZPlus,
            (Axis::Z, false) => Self::ZMinus,
        }
    }
}
