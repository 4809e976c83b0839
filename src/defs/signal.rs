//! Inputs and outputs by function: id, name, device and the parameter that assigns the port.
//! Source: spec K3 (ports), tools.md (ids).

use serde::{Deserialize, Serialize};

use super::equipment::{Needs, needs};
use super::text::Text;

/// Number of ports of a terminal block. Ports are numbered from 1; 0 is "not connected".
pub const PORTS: u8 = 64;

macro_rules! signals {
    ($(#[$meta:meta])* $name:ident { $($variant:ident = $id:literal, $param:literal, $needs:ident, $zh:literal, $en:literal;)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[repr(u8)]
        pub enum $name { $(#[doc = $en] $variant,)* }

        impl $name {
            /// All signals, in table order.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];
            /// Number of signals.
            pub const COUNT: usize = Self::ALL.len();

            /// The word used in stories, traces and on the diagnosis page.
            #[must_use]
            pub const fn id(self) -> &'static str {
                match self { $(Self::$variant => $id,)* }
            }

            /// The parameter that assigns the port.
            #[must_use]
            pub const fn port_param(self) -> u16 {
                match self { $(Self::$variant => $param,)* }
            }

            /// The device that it belongs to.
            #[must_use]
            pub const fn needs(self) -> Needs {
                match self { $(Self::$variant => needs!($needs),)* }
            }

            /// Display name.
            #[must_use]
            pub const fn name(self) -> Text {
                match self { $(Self::$variant => Text::new($zh, $en),)* }
            }

            /// The signal of an id.
            #[must_use]
            pub fn from_id(id: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|signal| signal.id() == id)
            }

            const fn bit(self) -> u128 {
                1 << (self as u8)
            }
        }
    };
}

signals! {
    /// A switch, drive or gauge that the control reads.
    Input {
        OscillationForwardEnd = "oscillation-forward-end", 228, Wheel, "振荡前进到位", "oscillation forward end";
        OscillationBackwardEnd = "oscillation-backward-end", 229, Wheel, "振荡后退到位", "oscillation backward end";
        HydraulicPressure = "hydraulic-pressure", 269, Hydraulics, "液压压力", "hydraulic pressure";
        EmergencyStop = "emergency-stop", 320, ANY, "急停", "emergency stop";
        TailstockAdvanced = "tailstock-advanced", 321, Tailstock, "尾座进到位", "tailstock advanced";
        TailstockRetracted = "tailstock-retracted", 322, Tailstock, "尾座退到位", "tailstock retracted";
        Gauge1 = "gauge-1", 323, Gauges, "量仪信号 1", "gauge signal 1";
        Gauge2 = "gauge-2", 324, Gauges, "量仪信号 2", "gauge signal 2";
        Gauge3 = "gauge-3", 325, Gauges, "量仪信号 3", "gauge signal 3";
        Gauge4 = "gauge-4", 326, Gauges, "量仪信号 4", "gauge signal 4";
        Gauge5 = "gauge-5", 327, Gauges, "量仪信号 5", "gauge signal 5";
        Gauge6 = "gauge-6", 328, Gauges, "量仪信号 6", "gauge signal 6";
        User1 = "user-1", 279, ANY, "用户输入 1 (M80)", "user input 1 (M80)";
        User2 = "user-2", 280, ANY, "用户输入 2 (M81)", "user input 2 (M81)";
        User3 = "user-3", 281, ANY, "用户输入 3 (M82)", "user input 3 (M82)";
        User4 = "user-4", 282, ANY, "用户输入 4 (M83)", "user input 4 (M83)";
        User5 = "user-5", 283, ANY, "用户输入 5 (M84)", "user input 5 (M84)";
        User6 = "user-6", 284, ANY, "用户输入 6 (M85)", "user input 6 (M85)";
        User7 = "user-7", 285, ANY, "用户输入 7 (M86)", "user input 7 (M86)";
        User8 = "user-8", 286, ANY, "用户输入 8 (M87)", "user input 8 (M87)";
        User9 = "user-9", 287, ANY, "用户输入 9 (M88)", "user input 9 (M88)";
        User10 = "user-10", 288, ANY, "用户输入 10 (M89)", "user input 10 (M89)";
        HomeX = "home-x", 329, ANY, "X 零点开关", "home switch X";
        HomeY = "home-y", 330, AxisY, "Y 零点开关", "home switch Y";
        HomeZ = "home-z", 331, ANY, "Z 零点开关", "home switch Z";
        GuardClosed = "guard-closed", 332, ANY, "防护门关", "guard closed";
        CoolantFlow = "coolant-flow", 333, ANY, "冷却液流量", "coolant flow";
        LubricationLevel = "lubrication-level", 334, ANY, "润滑油位", "lubrication level";
        ExternalStart = "external-start", 335, ANY, "外接启动", "external start";
        ExternalHold = "external-hold", 336, ANY, "外接暂停", "external hold";
        RadialArmOut = "radial-arm-out", 337, Gauges, "径向量仪伸出到位", "radial gauge arm out";
        RadialArmIn = "radial-arm-in", 338, Gauges, "径向量仪缩回到位", "radial gauge arm in";
        AxialArmOut = "axial-arm-out", 339, Gauges, "轴向量仪伸出到位", "axial gauge arm out";
        AxialArmIn = "axial-arm-in", 340, Gauges, "轴向量仪缩回到位", "axial gauge arm in";
        DriveX = "drive-x", 341, ANY, "X 驱动报警", "drive fault X";
        DriveY = "drive-y", 342, AxisY, "Y 驱动报警", "drive fault Y";
        DriveZ = "drive-z", 343, ANY, "Z 驱动报警", "drive fault Z";
        LimitXPlus = "limit-x-plus", 344, ANY, "X+ 限位", "limit switch X+";
        LimitXMinus = "limit-x-minus", 345, ANY, "X- 限位", "limit switch X-";
        LimitYPlus = "limit-y-plus", 346, AxisY, "Y+ 限位", "limit switch Y+";
        LimitYMinus = "limit-y-minus", 347, AxisY, "Y- 限位", "limit switch Y-";
        LimitZPlus = "limit-z-plus", 348, ANY, "Z+ 限位", "limit switch Z+";
        LimitZMinus = "limit-z-minus", 349, ANY, "Z- 限位", "limit switch Z-";
        Gear1In = "gear-1-in", 350, ANY, "1 档到位", "gear 1 engaged";
        Gear2In = "gear-2-in", 351, ANY, "2 档到位", "gear 2 engaged";
        Gear3In = "gear-3-in", 352, ANY, "3 档到位", "gear 3 engaged";
        Gear4In = "gear-4-in", 353, ANY, "4 档到位", "gear 4 engaged";
        Station1 = "station-1", 365, ToolTurret, "1 号刀位", "tool post station 1";
        Station2 = "station-2", 366, ToolTurret, "2 号刀位", "tool post station 2";
        Station3 = "station-3", 367, ToolTurret, "3 号刀位", "tool post station 3";
        Station4 = "station-4", 368, ToolTurret, "4 号刀位", "tool post station 4";
        PowerFail = "power-fail", 369, ANY, "供电中断", "supply fails";
        WheelContact = "wheel-contact", 358, Wheel, "砂轮接触 (声发射或功率)", "wheel contact (acoustic emission or power)";
    }
}

impl Input {
    /// The signals of the gauges, P1 to P6.
    pub const GAUGES: [Self; 6] = [Self::Gauge1, Self::Gauge2, Self::Gauge3, Self::Gauge4, Self::Gauge5, Self::Gauge6];
}

signals! {
    /// A contactor, valve or lamp that the control switches.
    Output {
        Wheel = "wheel", 300, Wheel, "砂轮", "wheel";
        Coolant = "coolant", 301, ANY, "冷却", "coolant";
        Lubrication = "lubrication", 302, ANY, "润滑", "lubrication";
        Tailstock = "tailstock", 303, Tailstock, "尾座", "tailstock";
        Magnetise = "magnetise", 304, MagneticChuck, "充磁", "magnetise";
        Demagnetise = "demagnetise", 305, MagneticChuck, "退磁", "demagnetise";
        SecondSpindle = "second-spindle", 306, Wheel, "第二主轴正转", "second spindle cw";
        SecondSpindleCcw = "second-spindle-ccw", 307, Wheel, "第二主轴反转", "second spindle ccw";
        OscillationForward = "oscillation-forward", 226, Wheel, "振荡前进", "oscillation forward";
        OscillationBackward = "oscillation-backward", 227, Wheel, "振荡后退", "oscillation backward";
        Hydraulic = "hydraulic", 273, Hydraulics, "液压", "hydraulic";
        RadialGauge = "radial-gauge", 271, Gauges, "径向(厚度)量仪", "radial (thickness) gauge";
        AxialGauge = "axial-gauge", 272, Gauges, "轴向(平面)量仪", "axial (plane) gauge";
        HeadstockHigh = "headstock-high", 153, Headstock, "头架高速", "headstock high";
        HeadstockLow = "headstock-low", 154, Headstock, "头架低速", "headstock low";
        DresserRoll = "dresser-roll", 153, DresserRoll, "滚轮", "dresser roll";
        TableRotation = "table-rotation", 153, RotaryTable, "台面旋转", "table rotation";
        Gear1 = "gear-1", 308, ANY, "1 档", "gear 1";
        Gear2 = "gear-2", 309, ANY, "2 档", "gear 2";
        Gear3 = "gear-3", 310, ANY, "3 档", "gear 3";
        Gear4 = "gear-4", 311, ANY, "4 档", "gear 4";
        User1 = "user-1", 274, ANY, "用户输出 1 (M50/M51)", "user output 1 (M50/M51)";
        User2 = "user-2", 275, ANY, "用户输出 2 (M52/M53)", "user output 2 (M52/M53)";
        User3 = "user-3", 276, ANY, "用户输出 3 (M54/M55)", "user output 3 (M54/M55)";
        User4 = "user-4", 277, ANY, "用户输出 4 (M56/M57)", "user output 4 (M56/M57)";
        User5 = "user-5", 278, ANY, "用户输出 5 (M58/M59)", "user output 5 (M58/M59)";
        TowerRed = "tower-red", 312, ANY, "三色灯红", "tower light red";
        TowerYellow = "tower-yellow", 313, ANY, "三色灯黄", "tower light yellow";
        TowerGreen = "tower-green", 314, ANY, "三色灯绿", "tower light green";
        SpindleForward = "spindle-forward", 360, MainSpindle, "主轴正转", "spindle forward";
        SpindleReverse = "spindle-reverse", 361, MainSpindle, "主轴反转", "spindle reverse";
        SpindleStop = "spindle-stop", 362, MainSpindle, "主轴停止", "spindle stop";
        TurretForward = "post-forward", 363, ToolTurret, "刀架正转", "tool post forward";
        TurretReverse = "post-reverse", 364, ToolTurret, "刀架反转锁紧", "tool post reverse, clamps";
    }
}

impl Output {
    /// The user outputs (M50 to M59).
    pub const USER: [Self; 5] = [Self::User1, Self::User2, Self::User3, Self::User4, Self::User5];
    /// The gear outputs (M41 to M44).
    pub const GEARS: [Self; 4] = [Self::Gear1, Self::Gear2, Self::Gear3, Self::Gear4];

    /// Whether it has no interlock and no sequence, so that a program may also switch it by its port.
    #[must_use]
    pub const fn is_freely_switchable(self) -> bool {
        matches!(
            self,
            Self::Coolant | Self::Lubrication | Self::User1 | Self::User2 | Self::User3 | Self::User4 | Self::User5
        )
    }
}

impl Input {
    /// The gear switches (M41 to M44).
    pub const GEARS: [Self; 4] = [Self::Gear1In, Self::Gear2In, Self::Gear3In, Self::Gear4In];
    /// The station switches of the tool turret (L8).
    pub const STATIONS: [Self; 4] = [Self::Station1, Self::Station2, Self::Station3, Self::Station4];
}

macro_rules! signal_set {
    ($(#[$meta:meta])* $set:ident of $signal:ident) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub struct $set(u128);

        impl $set {
            /// No signal is on.
            pub const NONE: Self = Self(0);

            /// The signals that are on in `self` and off in `other`.
            #[must_use]
            pub const fn without(self, other: Self) -> Self {
                Self(self.0 & !other.0)
            }

            /// Whether the signal is on.
            #[must_use]
            pub const fn has(self, signal: $signal) -> bool {
                self.0 & signal.bit() != 0
            }

            /// Switches the signal.
            pub const fn set(&mut self, signal: $signal, on: bool) {
                if on { self.0 |= signal.bit() } else { self.0 &= !signal.bit() }
            }

            /// The signals that are on, in table order.
            pub fn iter(self) -> impl Iterator<Item = $signal> {
                $signal::ALL.iter().copied().filter(move |signal| self.has(*signal))
            }
        }
    };
}

signal_set! {
    /// The inputs that are logically active.
    InputSet of Input
}
signal_set! {
    /// The outputs that are on.
    OutputSet of Output
}

/// The circuits of a terminal block: bit 0 is port 1. A set bit means that current flows through the terminal: the contact
/// of an input is closed to 0 V, the transistor of an output draws its load to 0 V. A fitter then measures 0 V there, which
/// pages and manual call 低 (low); an open terminal is at +24 V, 高 (high). A backend whose modules tell +24 V as 1 inverts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Terminals(pub u64);

impl Terminals {
    /// Whether current flows: the terminal is low. Port 0 and ports beyond the block are open.
    #[must_use]
    pub const fn is_closed(self, port: u8) -> bool {
        port >= 1 && port <= PORTS && self.0 >> (port - 1) & 1 == 1
    }

    /// Closes or opens the circuit of a port; port 0 and ports beyond the block are ignored.
    pub const fn set(&mut self, port: u8, on: bool) {
        if port >= 1 && port <= PORTS {
            let bit = 1 << (port - 1);
            if on { self.0 |= bit } else { self.0 &= !bit }
        }
    }
}
