//! What is wrong with a field bus, in the words of the alarm.
//! Source: ETG.1000.6 (AL status codes).

use super::station::StationFault;
use crate::defs::alarm;
use crate::defs::text::{LocalizedText, Template, Text, phrase};

/// Vendor, product and revision of a device, as its EEPROM says them (object 1018h).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeviceIdentity {
    /// Vendor, assigned by the EtherCAT Technology Group.
    pub vendor: u32,
    /// Product, assigned by the vendor.
    pub product: u32,
    /// Revision. Where a description has none, 0, any one fits.
    pub revision: u32,
}

/// A fault of the bus. Devices are counted from 1 in the order of the cable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusFault {
    /// The network interface does not exist.
    NoInterface,
    /// The process may not send frames.
    NoPermission,
    /// Another process runs the bus.
    InUse,
    /// No frame comes back.
    NoReply,
    /// A frame came back late or never.
    FrameLost,
    /// There are more or fewer devices than the description has.
    DeviceCount {
        /// Devices of the description.
        expected: u16,
        /// Devices on the bus.
        found: u16,
    },
    /// Another device at this place.
    WrongDevice {
        /// Place on the bus.
        device: u16,
        /// Identity of the description.
        expected: DeviceIdentity,
        /// Identity of the device.
        found: DeviceIdentity,
    },
    /// The device has other process data than the description.
    ProcessDataSize {
        /// Place on the bus.
        device: u16,
        /// Bytes of inputs and outputs of the description.
        expected: (u16, u16),
        /// Bytes of inputs and outputs of the device.
        found: (u16, u16),
    },
    /// A device refuses an object of the description.
    ObjectRefused {
        /// Place on the bus.
        device: u16,
        /// Index of the object.
        object: u16,
    },
    /// A device does not answer; the cable before it is broken or it has no power.
    DeviceMissing {
        /// Place on the bus.
        device: u16,
    },
    /// A device has left its operational state.
    NotOperational {
        /// Place on the bus.
        device: u16,
        /// Its AL status code, 0 if it has none.
        al_status: u16,
    },
    /// A device that is to work at SYNC0 has no distributed clock.
    NoClock {
        /// Place on the bus.
        device: u16,
    },
    /// The clock of a device does not settle.
    ClockApart {
        /// Place on the bus.
        device: u16,
    },
    /// The reference clock of the bus has another time than before.
    ClockJumped,
    /// Not every device takes part in the exchange.
    WorkingCounter {
        /// Working counter of a whole exchange.
        expected: u16,
        /// Working counter that came back.
        found: u16,
    },
    /// A station beside the bus does not serve the control.
    StationSilent {
        /// Its number, from 101.
        station: u16,
        /// What was wrong in its last exchange.
        why: StationFault,
    },
    /// The inverter of the wheel is in a fault.
    InverterFault {
        /// Its code, as the manual of the inverter names it.
        code: u32,
    },
    /// The driver of the bus reports something else.
    Other,
}

/// A station and what is wrong with it.
const STATION: &Template = &Template::new("站 {station} {why}", "station {station} {why}", &["station", "why"]);

/// AL status codes that a fitter meets; others are shown as numbers.
static AL_STATUS: &[(u16, Text)] = &[
    (0x0000, Text::new("", "")),
    (0x0011, Text::new("状态切换无效", "invalid state change")),
    (0x0016, Text::new("邮箱配置无效", "invalid mailbox configuration")),
    (0x001b, Text::new("过程数据看门狗", "process data watchdog")),
    (0x001d, Text::new("输出配置无效", "invalid output configuration")),
    (0x001e, Text::new("输入配置无效", "invalid input configuration")),
    (0x0024, Text::new("输入映射无效", "invalid input mapping")),
    (0x0025, Text::new("输出映射无效", "invalid output mapping")),
    (0x002c, Text::new("SYNC 信号错误", "SYNC error")),
    (0x0050, Text::new("EEPROM 无法访问", "no access to the EEPROM")),
];

impl BusFault {
    /// The alarm that it is.
    #[must_use]
    pub const fn alarm(self) -> u16 {
        match self {
            Self::StationSilent { .. } => alarm::STATION_SILENT,
            Self::InverterFault { .. } => alarm::INVERTER_FAULT,
            _ => alarm::BUS_LOST,
        }
    }

    /// What is wrong, and where: the detail of the alarm.
    #[must_use]
    pub fn text(self) -> LocalizedText {
        match self {
            Self::NoInterface => phrase!("没有该网络接口", "there is no such network interface"),
            Self::NoPermission => {
                phrase!(
                    "没有网络权限：setcap cap_net_raw，见“第一次启动”",
                    "no permission for the network: setcap cap_net_raw, see \"first start\""
                )
            }
            Self::InUse => phrase!("另一个程序正在使用总线", "another program runs the bus"),
            Self::NoReply => phrase!("没有设备应答", "no device answers"),
            Self::FrameLost => phrase!("报文丢失", "frames are lost"),
            Self::DeviceCount { expected, found } => {
                phrase!(
                    "应有 {expected} 个设备，找到 {found} 个",
                    "{expected} devices expected, {found} found",
                    expected,
                    found
                )
            }
            Self::WrongDevice { device, expected, found } => wrong_device(device, expected, found),
            Self::ProcessDataSize { device, expected: (inputs, outputs), found: (has_inputs, has_outputs) } => phrase!(
                "设备 {device}：应有输入/输出 {inputs}/{outputs} 字节，找到 {has_inputs}/{has_outputs}",
                "device {device}: {inputs}/{outputs} bytes of inputs/outputs expected, {has_inputs}/{has_outputs} found",
                device,
                inputs,
                outputs,
                has_inputs,
                has_outputs
            ),
            Self::ObjectRefused { device, object } => {
                let object = format_args!("{object:04X}h");
                phrase!("设备 {device} 拒绝对象 {object}", "device {device} refuses object {object}", device, object)
            }
            Self::DeviceMissing { device } => {
                phrase!("设备 {device} 没有应答", "device {device} does not answer", device)
            }
            Self::NoClock { device } => {
                phrase!("设备 {device} 没有分布时钟", "device {device} has no distributed clock", device)
            }
            Self::ClockApart { device } => {
                phrase!("设备 {device} 的时钟没有同步", "the clock of device {device} does not settle", device)
            }
            Self::ClockJumped => phrase!("总线时钟跳变", "the clock of the bus has jumped"),
            Self::NotOperational { device, al_status } => not_operational(device, al_status),
            Self::WorkingCounter { expected, found } => {
                phrase!(
                    "工作计数器 {found}，应为 {expected}",
                    "working counter {found} instead of {expected}",
                    found,
                    expected
                )
            }
            Self::StationSilent { station, why } => LocalizedText::phrase_of(STATION, [station.into()], [why.text()]),
            Self::InverterFault { code } => phrase!("代码 {code}", "code {code}", code),
            Self::Other => phrase!("总线驱动程序错误", "error of the bus driver"),
        }
    }
}

/// The code in words, where it is known.
fn not_operational(device: u16, al_status: u16) -> LocalizedText {
    let code = format_args!("{al_status:04X}h");
    match AL_STATUS.iter().find(|(known, _)| *known == al_status) {
        Some((_, says)) => phrase!(
            "设备 {device} 不在运行状态 {code} {says}",
            "device {device} is not operational {code} {says}",
            device,
            code,
            says
        ),
        None => {
            phrase!("设备 {device} 不在运行状态 {code}", "device {device} is not operational {code}", device, code)
        }
    }
}

/// Revisions are told where they differ alone.
fn wrong_device(device: u16, expected: DeviceIdentity, found: DeviceIdentity) -> LocalizedText {
    if (expected.vendor, expected.product) == (found.vendor, found.product) {
        let (expected, found) = (format_args!("{:X}h", expected.revision), format_args!("{:X}h", found.revision));
        return phrase!(
            "设备 {device}：应为版本 {expected}，找到 {found}",
            "device {device}: revision {expected} expected, {found} found",
            device,
            expected,
            found
        );
    }
    let expected = format_args!("{:X}h/{:X}h", expected.vendor, expected.product);
    let found = format_args!("{:X}h/{:X}h", found.vendor, found.product);
    phrase!(
        "设备 {device}：应为 {expected}，找到 {found}",
        "device {device}: {expected} expected, {found} found",
        device,
        expected,
        found
    )
}
