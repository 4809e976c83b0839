//! The state of a servo drive as the control sees it, and its faults in words.
//! Source: CiA 402-2 (IEC 61800-7-201), object 603Fh; CiA 301 error code classes.

use std::fmt;

use crate::defs::text::{LocalizedText, Text, phrase};

/// What a drive does. A set-point counts in [`Self::Enabled`] only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DriveState {
    /// Without torque.
    #[default]
    Off,
    /// It is to be on and does not follow yet: power stage, brake.
    SwitchingOn,
    /// It follows its set-point.
    Enabled,
    /// It has switched itself off. The error code; [`DriveFault::UNKNOWN`] until it is read.
    Fault(DriveFault),
}

impl DriveState {
    /// The fault, if there is one.
    #[must_use]
    pub const fn fault(self) -> Option<DriveFault> {
        match self {
            Self::Fault(fault) => Some(fault),
            Self::Off | Self::SwitchingOn | Self::Enabled => None,
        }
    }

    /// The state in words; a fault with its code.
    #[must_use]
    pub fn text(self) -> LocalizedText {
        match self {
            Self::Off => phrase!("断开", "off"),
            Self::SwitchingOn => phrase!("正在接通", "switching on"),
            Self::Enabled => phrase!("接通", "enabled"),
            Self::Fault(fault) => {
                let code = format_args!("{fault}");
                phrase!("故障 {code} {says}", "fault {code} {says}", code, says = fault.text())
            }
        }
    }

    /// The state as a number, for traces: 0 to 2, or 65 536 and the error code.
    #[must_use]
    pub const fn trace_number(self) -> u32 {
        match self {
            Self::Off => 0,
            Self::SwitchingOn => 1,
            Self::Enabled => 2,
            Self::Fault(DriveFault(code)) => 0x1_0000 | code as u32,
        }
    }

    /// The state of a number in a trace.
    #[must_use]
    pub const fn from_trace_number(number: u32) -> Option<Self> {
        match number {
            0 => Some(Self::Off),
            1 => Some(Self::SwitchingOn),
            2 => Some(Self::Enabled),
            0x1_0000..=0x1_ffff => Some(Self::Fault(DriveFault((number & 0xffff) as u16))),
            _ => None,
        }
    }
}

/// Error code of a drive, object 603Fh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveFault(pub u16);

/// Error codes with a meaning of their own; a code that is not here has the meaning of its class.
static FAULTS: &[(u16, Text)] = &[
    (0x2310, Text::new("电机持续过流", "continuous overcurrent")),
    (0x2320, Text::new("短路或接地", "short circuit or earth fault")),
    (0x3110, Text::new("主电源电压过高", "mains overvoltage")),
    (0x3120, Text::new("主电源电压过低", "mains undervoltage")),
    (0x3130, Text::new("主电源缺相", "mains phase missing")),
    (0x3210, Text::new("直流母线电压过高", "DC link overvoltage")),
    (0x3220, Text::new("直流母线电压过低", "DC link undervoltage")),
    (0x4210, Text::new("驱动器过热", "drive too hot")),
    (0x4310, Text::new("驱动器过热", "drive too hot")),
    (0x5441, Text::new("安全断开扭矩", "safe torque off")),
    (0x7121, Text::new("电机堵转", "motor blocked")),
    (0x7305, Text::new("编码器 1 故障", "encoder 1 fault")),
    (0x7306, Text::new("编码器 2 故障", "encoder 2 fault")),
    (0x7500, Text::new("通信中断", "communication lost")),
    (0x8611, Text::new("跟随误差过大", "following error too large")),
    (0x8612, Text::new("超出位置极限", "position limit")),
];

/// Classes of error codes by their upper digits: first the two-digit ones, then the one-digit ones.
static CLASSES: &[(u16, u16, Text)] = &[
    (0xff00, 0x2300, Text::new("输出侧电流", "current, output side")),
    (0xff00, 0x3200, Text::new("直流母线电压", "DC link voltage")),
    (0xff00, 0x7100, Text::new("功率部件", "power section")),
    (0xff00, 0x7300, Text::new("传感器", "sensor")),
    (0xff00, 0x8100, Text::new("通信", "communication")),
    (0xf000, 0x2000, Text::new("电流", "current")),
    (0xf000, 0x3000, Text::new("电压", "voltage")),
    (0xf000, 0x4000, Text::new("温度", "temperature")),
    (0xf000, 0x5000, Text::new("驱动器硬件", "drive hardware")),
    (0xf000, 0x6000, Text::new("驱动器软件或参数", "drive software or parameters")),
    (0xf000, 0x7000, Text::new("附加模块", "additional module")),
    (0xf000, 0x8000, Text::new("监控", "monitoring")),
];

/// Any other code.
static OTHER: Text = Text::new("见驱动器手册", "see the manual of the drive");

impl DriveFault {
    /// The drive is in a fault whose code has not been read.
    pub const UNKNOWN: Self = Self(0);

    /// Whether the position of an absolute encoder may be wrong: a fault of the sensor (CiA 402-2, 73xxh), one that only the
    /// manufacturer knows (FFxxh), or one without a code of its own (1000h).
    #[must_use]
    pub const fn may_concern_position(self) -> bool {
        matches!(self.0 & 0xff00, 0x7300 | 0xff00) || self.0 == 0x1000
    }

    /// What the code says.
    #[must_use]
    pub fn text(self) -> &'static Text {
        let exact = FAULTS.iter().find(|(code, _)| *code == self.0).map(|(_, text)| text);
        let of_class = || CLASSES.iter().find(|(mask, class, _)| self.0 & mask == *class).map(|(.., text)| text);
        exact.or_else(of_class).unwrap_or(&OTHER)
    }
}

impl fmt::Display for DriveFault {
    /// As manuals of drives write it: four hexadecimal digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04X}h", self.0)
    }
}
