//! Internal signals of the control, shown on the diagnosis page beside the inputs and outputs.
//! Source: spec B6 (internal signals).

use crate::defs::equipment::{Equipment, Needs};
use crate::defs::text::Text;

macro_rules! internals {
    ($($variant:ident = $id:literal, $needs:expr, $zh:literal, $en:literal;)*) => {
        /// An internal signal of the control.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum InternalSignal { $(#[doc = $en] $variant,)* }

        impl InternalSignal {
            /// All of them, in table order.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// The id used in stories and tests.
            #[must_use]
            pub const fn id(self) -> &'static str {
                match self { $(Self::$variant => $id,)* }
            }

            /// The device that it belongs to.
            #[must_use]
            pub const fn needs(self) -> Needs {
                match self { $(Self::$variant => $needs,)* }
            }

            /// The name shown.
            #[must_use]
            pub const fn name(self) -> Text {
                match self { $(Self::$variant => Text::new($zh, $en),)* }
            }
        }
    };
}

internals! {
    DrivesOn = "drives-on", None, "驱动接通", "drives on";
    BusAlive = "bus-alive", None, "总线正常", "bus alive";
    EmergencyStopped = "emergency-stopped", None, "急停生效", "emergency stop active";
    ScreenEmergencyStop = "screen-emergency-stop", None, "屏幕急停按下", "screen e-stop pressed";
    AlarmBlocksStart = "alarm-blocks-start", None, "报警禁止启动", "alarm blocks start";
    HomedX = "homed-x", None, "X 已回零", "X homed";
    HomedY = "homed-y", Some(Equipment::AxisY), "Y 已回零", "Y homed";
    HomedZ = "homed-z", None, "Z 已回零", "Z homed";
    MovingX = "moving-x", None, "X 运动中", "X moving";
    MovingY = "moving-y", Some(Equipment::AxisY), "Y 运动中", "Y moving";
    MovingZ = "moving-z", None, "Z 运动中", "Z moving";
    InPosition = "in-position", None, "各轴到位", "axes in position";
    ProgramOpen = "run-open", None, "程序未结束", "program active";
    Running = "running", None, "程序运行", "program running";
    Held = "held", None, "进给保持", "feed hold";
    Waiting = "waiting", None, "等待输入", "waiting for an input";
    Homing = "homing", None, "正在回零", "homing";
    SingleBlock = "single-block", None, "单段", "single block";
    BlockSkip = "block-skip", None, "跳段", "block skip";
    OptionalStop = "optional-stop", None, "选择停", "optional stop";
    RapidJog = "rapid-by-hand", None, "手动快速", "manual rapid";
    WheelRunUp = "wheel-run-up", Some(Equipment::Wheel), "砂轮启动延时中", "wheel running up";
    WorkpieceDrive = "workpiece-drive", None, "头架/滚轮/台面转动", "workpiece drive on";
    TailstockMoving = "tailstock-moving", Some(Equipment::Tailstock), "尾座动作中", "tailstock moving";
    TailstockClamped = "tailstock-clamped", Some(Equipment::Tailstock), "尾座已顶紧", "tailstock advanced";
    HydraulicSettled = "hydraulic-settled", Some(Equipment::Hydraulics), "液压延时到", "hydraulic delay over";
    HydraulicLatched = "hydraulic-latched", Some(Equipment::Hydraulics), "报警 180 待复位", "180 waits for RESET";
}

/// The set of signals that are on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct InternalSignalSet(u64);

impl InternalSignalSet {
    /// Whether a signal is on.
    #[must_use]
    pub const fn has(self, state: InternalSignal) -> bool {
        self.0 >> (state as u8) & 1 == 1
    }

    /// The set with a signal added if it is on.
    #[must_use]
    pub const fn with(self, state: InternalSignal, on: bool) -> Self {
        if on { Self(self.0 | 1 << (state as u8)) } else { self }
    }
}
