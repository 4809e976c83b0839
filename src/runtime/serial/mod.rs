//! Program transfer over RS232: 8 data bits, no parity, one stop bit, XON/XOFF; port and baud rate are configurable.
//!
//! [`sheet`] defines the format, [`line`] sends and receives bytes, [`courier`] connects the line and the folder.
//! Source: spec L9, K7.8, B8 (300–399).

pub mod courier;
pub mod line;
pub mod sheet;

use crate::defs::alarm;
use crate::defs::text::Said;
use crate::link::files::Refusal;

/// Maximum size of a transmission, bytes: 25 minutes at 115 200 baud.
pub const SERIAL_LIMIT: usize = 16 * 1024 * 1024;

/// Why a transmission failed. Nothing was stored unless the detail says so.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// No port selected, or the port does not exist, is in use, or does not support the baud rate.
    Port(Said),
    /// Nothing was received, or the transmission stopped at this line.
    Silent(Option<u32>),
    /// The other side does not accept data: it sent XOFF, or it is not connected.
    Held,
    /// The data at this line (0: before the program) are not text: wrong baud rate or bad cable.
    Noise(u32),
    /// The other side sends 7 bits with parity.
    Parity,
    /// The data are text but not in the transmission format.
    Form(Said),
    /// Longer than this many bytes.
    TooLong(usize),
    /// The port has disappeared: the adapter was unplugged.
    Gone(Said),
    /// The program could not be stored.
    Store(Said),
    /// A program that cannot be sent unchanged.
    Text(Said),
    /// Cancelled by the operator.
    Cancelled,
}

impl Trouble {
    /// The alarm number; `None` when the operator has cancelled.
    #[must_use]
    pub const fn alarm(&self) -> Option<u16> {
        Some(match self {
            Self::Port(_) => alarm::SERIAL_PORT,
            Self::Silent(_) => alarm::SERIAL_SILENT,
            Self::Held => alarm::SERIAL_HELD,
            Self::Noise(_) => alarm::SERIAL_NOISE,
            Self::Parity => alarm::SERIAL_PARITY,
            Self::Form(_) => alarm::SERIAL_FORM,
            Self::TooLong(_) => alarm::SERIAL_TOO_LONG,
            Self::Gone(_) => alarm::SERIAL_GONE,
            Self::Store(_) => alarm::SERIAL_STORE,
            Self::Text(_) => alarm::SERIAL_TEXT,
            Self::Cancelled => return None,
        })
    }

    /// The position, or the message of the operating system.
    #[must_use]
    pub fn detail(&self) -> Said {
        match self {
            Self::Port(said) | Self::Form(said) | Self::Gone(said) | Self::Store(said) | Self::Text(said) => {
                said.clone()
            }
            Self::Silent(None) => Said::new("没有收到程序开头的 %", "no % of a program has come"),
            Self::Silent(Some(line)) => Said::new(format!("在第 {line} 行中断"), format!("broken off at line {line}")),
            Self::Noise(0) => Said::new("程序开头之前", "before the program"),
            Self::Noise(line) => Said::new(format!("第 {line} 行"), format!("line {line}")),
            Self::TooLong(most) => Said::new(format!("超过 {most} 字节"), format!("more than {most} bytes")),
            Self::Held => Said::new("发送没有完成", "the program was not sent to its end"),
            Self::Parity => Said::new("没有保存", "nothing was stored"),
            Self::Cancelled => Said::new("已取消", "cancelled"),
        }
    }
}

impl From<Trouble> for Refusal {
    fn from(trouble: Trouble) -> Self {
        match trouble.alarm() {
            Some(number) => Self::Alarm(number, trouble.detail()),
            None => Self::Because(trouble.detail()),
        }
    }
}
