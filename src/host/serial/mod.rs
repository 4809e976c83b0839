//! Program transfer over RS232: 8 data bits, no parity, one stop bit, XON/XOFF; port and baud rate are configurable.
//!
//! [`format`] defines the format, [`port`] sends and receives bytes, [`transfer`] connects the line and the folder.
//! Source: spec L9, K7.8, B8 (300–399).

pub mod format;
pub mod port;
pub mod transfer;

use crate::defs::alarm;
use crate::defs::text::{LocalizedText, phrase};
use crate::link::files::Refusal;

/// Maximum size of a transmission, bytes: 25 minutes at 115 200 baud.
pub const SERIAL_LIMIT: usize = 16 * 1024 * 1024;

/// Why a transmission failed. Nothing was stored unless the detail says so.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SerialError {
    /// No port selected, or the port does not exist, is in use, or does not support the baud rate.
    Port(LocalizedText),
    /// Nothing was received, or the transmission stopped at this line.
    NoData(Option<u32>),
    /// The other side does not accept data: it sent XOFF, or it is not connected.
    NotAccepted,
    /// The data at this line (0: before the program) are not text: wrong baud rate or bad cable.
    Noise(u32),
    /// The other side sends 7 bits with parity.
    Parity,
    /// The data are text but not in the transmission format.
    BadFormat(LocalizedText),
    /// Longer than this many bytes.
    TooLong(usize),
    /// The port has disappeared: the adapter was unplugged.
    Disconnected(LocalizedText),
    /// The program could not be stored.
    NotStored(LocalizedText),
    /// A program that cannot be sent unchanged.
    NotSendable(LocalizedText),
    /// Cancelled by the operator.
    Cancelled,
}

impl SerialError {
    /// The alarm number; `None` when the operator has cancelled.
    #[must_use]
    pub const fn alarm(&self) -> Option<u16> {
        Some(match self {
            Self::Port(_) => alarm::SERIAL_PORT_NOT_OPEN,
            Self::NoData(_) => alarm::SERIAL_RECEIVE_TIMEOUT,
            Self::NotAccepted => alarm::SERIAL_SEND_TIMEOUT,
            Self::Noise(_) => alarm::SERIAL_GARBLED,
            Self::Parity => alarm::SERIAL_PARITY,
            Self::BadFormat(_) => alarm::SERIAL_BAD_FORMAT,
            Self::TooLong(_) => alarm::SERIAL_TOO_LONG,
            Self::Disconnected(_) => alarm::SERIAL_DISCONNECTED,
            Self::NotStored(_) => alarm::SERIAL_FILE_ERROR,
            Self::NotSendable(_) => alarm::SERIAL_NOT_SENDABLE,
            Self::Cancelled => return None,
        })
    }

    /// The position, or the message of the operating system.
    #[must_use]
    pub fn detail(&self) -> LocalizedText {
        match self {
            Self::Port(message)
            | Self::BadFormat(message)
            | Self::Disconnected(message)
            | Self::NotStored(message)
            | Self::NotSendable(message) => message.clone(),
            Self::NoData(None) => phrase!("没有收到程序开头的 %", "no % of a program was received"),
            Self::NoData(Some(line)) => {
                phrase!("在第 {line} 行中断", "interrupted at line {line}", line = *line)
            }
            Self::Noise(0) => phrase!("程序开头之前", "before the program"),
            Self::Noise(line) => phrase!("第 {line} 行", "line {line}", line = *line),
            Self::TooLong(most) => phrase!("超过 {most} 字节", "more than {most} bytes", most = *most),
            Self::NotAccepted => phrase!("发送没有完成", "the program was not sent completely"),
            Self::Parity => phrase!("没有保存", "nothing was stored"),
            Self::Cancelled => phrase!("已取消", "cancelled"),
        }
    }
}

impl From<SerialError> for Refusal {
    fn from(trouble: SerialError) -> Self {
        trouble.alarm().map_or_else(|| Self::Other(trouble.detail()), |number| Self::Alarm(number, trouble.detail()))
    }
}
