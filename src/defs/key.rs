//! The panel keys: id, label, group, which kinds have them, and whether they act while a program runs.
//! Source: spec K2, H2, tools.md (ids).

use serde::{Deserialize, Serialize};

use super::kind::Kind;
use super::signal::Output;
use super::text::Text;
use crate::units::Axis;

/// A group of keys on the panel (H2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
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

/// A mode of the control (B5).
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

    /// The word of stories (`mode jog` is manual).
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        Some(match id {
            "edit" => Self::Edit,
            "auto" => Self::Auto,
            "mdi" => Self::Mdi,
            "home" => Self::Home,
            "handwheel" => Self::Handwheel,
            "step" => Self::Step,
            "jog" | "manual" => Self::Manual,
            _ => return None,
        })
    }

    /// The key that chooses the mode.
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

/// What a key's lamp shows: always the real thing, never the wish (K2.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lamp {
    /// The key has no lamp.
    None,
    /// An output is on.
    Output(Output),
    /// An output is off although its unit may be asked for (stop keys).
    OutputOff(Output),
    /// A state of the control that the core sets by itself.
    Control,
}

const ALL: &[Kind] = &Kind::ALL;
const GC: &[Kind] = &[Kind::Gc];
const GS: &[Kind] = &[Kind::Gs];
const TABLE: &[Kind] = &[Kind::Ga, Kind::Vertical];
const LATHE: &[Kind] = &[Kind::Lathe];
const GRIND: &[Kind] = &[Kind::Gc, Kind::Gs, Kind::Ga, Kind::Vertical];
const GS_GA: &[Kind] = &[Kind::Gs, Kind::Ga];

/// One row of the key table.
#[derive(Clone, Copy, Debug)]
pub struct KeyRow {
    /// The word of stories.
    pub id: &'static str,
    /// Label: Chinese 2–4 characters, English.
    pub label: Text,
    /// Group on the panel.
    pub group: Group,
    /// Kinds that have the key.
    pub kinds: &'static [Kind],
    /// Whether it acts while a program runs (K2.2).
    pub in_run: bool,
    /// What its lamp shows.
    pub lamp: Lamp,
}

macro_rules! keys {
    ($($variant:ident = $id:literal, $zh:literal, $en:literal, $group:ident, $kinds:ident, $in_run:literal, $lamp:expr;)*) => {
        /// A key of the panel or of the control screen.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[repr(u8)]
        pub enum Key { $(#[doc = $en] $variant,)* }

        impl Key {
            /// All keys in table order.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];
            /// How many there are.
            pub const COUNT: usize = Self::ALL.len();

            /// The row of the key.
            #[must_use]
            pub const fn row(self) -> KeyRow {
                match self {
                    $(Self::$variant => KeyRow {
                        id: $id, label: Text::new($zh, $en), group: Group::$group,
                        kinds: $kinds, in_run: $in_run, lamp: $lamp,
                    },)*
                }
            }
        }
    };
}

use Lamp::{Control, None as Dark, Output as Out, OutputOff};

keys! {
    ModeEdit = "mode-edit", "编辑", "EDIT", Mode, ALL, false, Control;
    ModeAuto = "mode-auto", "自动", "AUTO", Mode, ALL, false, Control;
    ModeMdi = "mode-mdi", "录入", "MDI", Mode, ALL, false, Control;
    ModeHome = "mode-home", "机械零点", "HOME", Mode, ALL, false, Control;
    ModeHandwheel = "mode-handwheel", "手轮", "HANDWHL", Mode, ALL, false, Control;
    ModeStep = "mode-step", "单步", "STEP", Mode, ALL, false, Control;
    ModeManual = "mode-manual", "手动", "JOG", Mode, ALL, false, Control;
    SingleBlock = "single-block", "单段", "SINGLE", Switch, ALL, true, Control;
    BlockSkip = "block-skip", "跳段", "SKIP", Switch, ALL, true, Control;
    OptionalStop = "optional-stop", "选择停", "OPT STOP", Switch, ALL, true, Control;
    MachineLock = "machine-lock", "机床锁", "LOCK", Switch, ALL, false, Control;
    MstLock = "mst-lock", "辅助锁", "MST LOCK", Switch, ALL, false, Control;
    DryRun = "dry-run", "空运行", "DRY RUN", Switch, ALL, false, Control;
    CycleStart = "cycle-start", "循环启动", "START", Run, ALL, true, Control;
    FeedHold = "feed-hold", "进给保持", "HOLD", Run, ALL, true, Control;
    Reset = "reset", "复位", "RESET", Run, ALL, true, Dark;
    EmergencyStop = "emergency-stop", "急停", "E-STOP", Run, ALL, true, Control;
    FeedOverrideUp = "feed-override-up", "进给倍率+", "FEED +", Override, ALL, true, Dark;
    FeedOverrideDown = "feed-override-down", "进给倍率-", "FEED -", Override, ALL, true, Dark;
    RapidF0 = "rapid-f0", "快速F0", "RAPID F0", Override, ALL, true, Control;
    Rapid25 = "rapid-25", "快速25%", "RAPID 25", Override, ALL, true, Control;
    Rapid50 = "rapid-50", "快速50%", "RAPID 50", Override, ALL, true, Control;
    Rapid100 = "rapid-100", "快速100%", "RAPID 100", Override, ALL, true, Control;
    SpindleOverrideUp = "spindle-override-up", "主轴倍率+", "SPDL +", Override, ALL, true, Dark;
    SpindleOverrideDown = "spindle-override-down", "主轴倍率-", "SPDL -", Override, ALL, true, Dark;
    XPlus = "x-plus", "X+", "X+", Jog, ALL, false, Dark;
    XMinus = "x-minus", "X-", "X-", Jog, ALL, false, Dark;
    YPlus = "y-plus", "Y+", "Y+", Jog, ALL, false, Dark;
    YMinus = "y-minus", "Y-", "Y-", Jog, ALL, false, Dark;
    ZPlus = "z-plus", "Z+", "Z+", Jog, ALL, false, Dark;
    ZMinus = "z-minus", "Z-", "Z-", Jog, ALL, false, Dark;
    Rapid = "rapid", "快速", "RAPID", Jog, ALL, false, Control;
    HandwheelX = "handwheel-x", "手轮X", "WHEEL X", Handwheel, ALL, false, Control;
    HandwheelY = "handwheel-y", "手轮Y", "WHEEL Y", Handwheel, ALL, false, Control;
    HandwheelZ = "handwheel-z", "手轮Z", "WHEEL Z", Handwheel, ALL, false, Control;
    Step0001 = "step-0.001", "×0.001", "×0.001", Handwheel, ALL, false, Control;
    Step001 = "step-0.01", "×0.01", "×0.01", Handwheel, ALL, false, Control;
    Step01 = "step-0.1", "×0.1", "×0.1", Handwheel, ALL, false, Control;
    WheelStart = "wheel-start", "砂轮启动", "WHEEL ON", Wheel, GRIND, false, Out(Output::Wheel);
    WheelStop = "wheel-stop", "砂轮停止", "WHEEL OFF", Wheel, GRIND, false, OutputOff(Output::Wheel);
    SecondSpindle = "second-spindle", "第二主轴", "SPINDLE 2", Wheel, GRIND, false, Out(Output::SecondSpindle);
    SpindleForward = "spindle-forward", "主轴正转", "SPDL CW", Workpiece, LATHE, false, Control;
    SpindleReverse = "spindle-reverse", "主轴反转", "SPDL CCW", Workpiece, LATHE, false, Control;
    SpindleStop = "spindle-stop", "主轴停止", "SPDL STOP", Workpiece, LATHE, false, Control;
    ToolPost = "tool-post", "换刀", "TOOL", Clamping, LATHE, false, Control;
    HeadstockHigh = "headstock-high", "头架高速", "HEAD HIGH", Workpiece, GC, false, Out(Output::HeadstockHigh);
    HeadstockLow = "headstock-low", "头架低速", "HEAD LOW", Workpiece, GC, false, Out(Output::HeadstockLow);
    HeadstockStop = "headstock-stop", "头架停止", "HEAD STOP", Workpiece, GC, false, Control;
    DresserRoll = "dresser-roll", "滚轮", "ROLL", Workpiece, GS, false, Out(Output::DresserRoll);
    TableRotation = "table-rotation", "台面旋转", "TABLE", Workpiece, TABLE, false, Out(Output::TableRotation);
    TailstockAdvance = "tailstock-advance", "尾座进", "TAIL IN", Clamping, GC, false, Out(Output::Tailstock);
    TailstockRetract = "tailstock-retract", "尾座退", "TAIL OUT", Clamping, GC, false, OutputOff(Output::Tailstock);
    Magnetise = "magnetise", "充磁", "MAGNET", Clamping, GS_GA, false, Out(Output::Magnetise);
    Demagnetise = "demagnetise", "退磁", "DEMAG", Clamping, GS_GA, false, Out(Output::Demagnetise);
    Coolant = "coolant", "冷却", "COOLANT", Fluids, ALL, true, Out(Output::Coolant);
    Lubrication = "lubrication", "润滑", "LUBE", Fluids, ALL, true, Out(Output::Lubrication);
    Hydraulic = "hydraulic", "液压", "HYDRAUL", Fluids, GRIND, false, Out(Output::Hydraulic);
    RadialGauge = "radial-gauge", "径向量仪", "RADIAL", Gauges, GRIND, false, Out(Output::RadialGauge);
    AxialGauge = "axial-gauge", "轴向量仪", "AXIAL", Gauges, GRIND, false, Out(Output::AxialGauge);
    Oscillation = "oscillation", "振荡", "OSCILL", Dressing, GRIND, false, Control;
    DressReturn = "dress-return", "回修整点", "DRESS PT", Dressing, GRIND, false, Control;
    WheelRetract = "wheel-retract", "一键回退", "RETRACT", Dressing, GRIND, true, Control;
    AddressX = "address-x", "X", "X", Screen, ALL, true, Dark;
    AddressY = "address-y", "Y", "Y", Screen, ALL, true, Dark;
    AddressZ = "address-z", "Z", "Z", Screen, ALL, true, Dark;
    Input = "input", "输入", "INPUT", Screen, ALL, true, Dark;
    Cancel = "cancel", "取消", "CANCEL", Screen, ALL, true, Dark;
    F1 = "f1", "F1", "F1", Screen, ALL, true, Dark;
    F2 = "f2", "F2", "F2", Screen, ALL, true, Dark;
    F3 = "f3", "F3", "F3", Screen, ALL, true, Dark;
    F4 = "f4", "F4", "F4", Screen, ALL, true, Dark;
    F5 = "f5", "F5", "F5", Screen, ALL, true, Dark;
    NextRow = "next-row", "▶", "NEXT", Screen, ALL, true, Dark;
}

impl Key {
    /// The word of stories.
    #[must_use]
    pub const fn id(self) -> &'static str {
        self.row().id
    }

    /// The label.
    #[must_use]
    pub const fn label(self) -> Text {
        self.row().label
    }

    /// The label as drawn on a kind's panel: short where the caption of the group says the rest.
    #[must_use]
    pub const fn face(self, kind: Kind) -> Text {
        match self {
            // K1: on surface and rotary-table grinders the gauges measure thickness and plane.
            Self::RadialGauge if matches!(kind, Kind::Gs | Kind::Ga) => Text::new("厚度", "THICK"),
            Self::AxialGauge if matches!(kind, Kind::Gs | Kind::Ga) => Text::new("平面", "PLANE"),
            Self::ModeHandwheel => Text::new("手轮", "MPG"),
            Self::OptionalStop => Text::new("选择停", "M01"),
            Self::MstLock => Text::new("辅助锁", "MST"),
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

    /// Whether a kind has the key.
    #[must_use]
    pub fn is_on(self, kind: Kind) -> bool {
        self.row().kinds.contains(&kind)
    }

    /// The key of an id or of a Chinese label on a kind, in full or as drawn; a label that two keys share names none.
    #[must_use]
    pub fn from_word(word: &str, kind: Kind) -> Option<Self> {
        let on_kind = || Self::ALL.iter().copied().filter(move |key| key.is_on(kind));
        let only = |text: fn(Self, Kind) -> Text| {
            let mut matches = on_kind().filter(|key| text(*key, kind).zh == word);
            matches.next().filter(|_| matches.next().is_none())
        };
        on_kind()
            .find(|key| key.id() == word)
            .or_else(|| only(|key, _| key.label()))
            .or_else(|| only(Self::name_on))
            .or_else(|| only(Self::face))
    }

    /// The full label on a kind. K1: on surface and rotary-table grinders the gauges measure thickness and plane.
    #[must_use]
    pub const fn name_on(self, kind: Kind) -> Text {
        match self {
            Self::RadialGauge if matches!(kind, Kind::Gs | Kind::Ga) => Text::new("厚度量仪", "THICKNESS"),
            Self::AxialGauge if matches!(kind, Kind::Gs | Kind::Ga) => Text::new("平面量仪", "PLANE"),
            _ => self.label(),
        }
    }

    /// Axis and sign of a jog key.
    #[must_use]
    pub const fn jog(self) -> Option<(Axis, f64)> {
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

    /// The axis that a key names: jog, handwheel and address keys.
    #[must_use]
    pub const fn axis(self) -> Option<Axis> {
        match self {
            Self::XPlus | Self::XMinus | Self::HandwheelX | Self::AddressX => Some(Axis::X),
            Self::YPlus | Self::YMinus | Self::HandwheelY | Self::AddressY => Some(Axis::Y),
            Self::ZPlus | Self::ZMinus | Self::HandwheelZ | Self::AddressZ => Some(Axis::Z),
            _ => None,
        }
    }

    /// The jog key of an axis and a sign.
    #[must_use]
    pub const fn of_jog(axis: Axis, plus: bool) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn k2_1_every_key_has_its_own_id() {
        for (i, key) in Key::ALL.iter().enumerate() {
            assert!(Key::ALL[..i].iter().all(|other| other.id() != key.id()), "{} twice", key.id());
        }
    }

    #[test]
    fn k2_1_kinds_differ_in_clamping_and_workpiece_keys() {
        assert_eq!(Key::from_word("尾座进", Kind::Gc), Some(Key::TailstockAdvance));
        assert_eq!(Key::from_word("尾座进", Kind::Gs), None);
        assert_eq!(Key::from_word("充磁", Kind::Gc), None);
        assert_eq!(Key::from_word("demagnetise", Kind::Ga), Some(Key::Demagnetise));
        // As drawn, where one key only is drawn so.
        for (word, kind, key) in [
            ("厚度量仪", Kind::Gs, Key::RadialGauge),
            ("平面", Kind::Ga, Key::AxialGauge),
            ("径向", Kind::Gc, Key::RadialGauge),
            ("高速", Kind::Gc, Key::HeadstockHigh),
            ("25%", Kind::Gc, Key::Rapid25),
            ("X", Kind::Gc, Key::AddressX),
        ] {
            assert_eq!(Key::from_word(word, kind), Some(key), "{word}");
        }
        assert_eq!(Key::from_word("停止", Kind::Gc), None);
    }

    #[test]
    fn k2_2_in_a_run_only_fluids_and_run_keys_act() {
        let dead = [Key::WheelStart, Key::Hydraulic, Key::HeadstockHigh, Key::ModeManual, Key::XPlus, Key::DryRun];
        let alive = [Key::Coolant, Key::Lubrication, Key::CycleStart, Key::Reset, Key::SingleBlock, Key::BlockSkip];
        assert!(dead.iter().all(|key| !key.row().in_run));
        assert!(alive.iter().all(|key| key.row().in_run));
    }
}
