//! Programs over RS232: 8 data bits, no parity, one stop bit, XON/XOFF; port and baud rate are data.
//!
//! [`sheet`] knows what stands on the line, [`line`] sends and receives it, [`courier`] stands between it and the folder.
//! Source: spec L9, K7.8, B8 (300–399).

pub mod courier;
pub mod line;
pub mod sheet;

use crate::defs::alarm;
use crate::defs::text::Said;
use crate::link::files::Refusal;

/// The largest transmission, bytes: 25 minutes at 115 200 baud.
pub const SERIAL_LIMIT: usize = 16 * 1024 * 1024;

/// Why a transmission came to nothing. Nothing was stored, except where it says so.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// The port is not chosen, not there, taken, or refuses the baud rate.
    Port(Said),
    /// Nothing has come, or it broke off at this line.
    Silent(Option<u32>),
    /// The other side does not take what is sent: it holds it by XOFF, or nobody is there.
    Held,
    /// What came at this line (0: before the program) is no text: another baud rate, a bad cable.
    Noise(u32),
    /// The other side sends 7 bits with parity.
    Parity,
    /// It is text, but no program as it goes over a line.
    Form(Said),
    /// Longer than this many bytes.
    TooLong(usize),
    /// The port has gone: an adapter was pulled out.
    Gone(Said),
    /// The folder does not take it.
    Store(Said),
    /// A program that cannot be sent as it stands.
    Text(Said),
    /// The operator has ended it.
    Cancelled,
}

impl Trouble {
    /// Its alarm; none where the operator has ended it.
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

    /// The place or the system's own words.
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
