//! Why a value of a parameter is refused. Source: spec B7.

use crate::defs::text::{LocalizedText, phrase};

/// Why a value was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParamError {
    /// No such parameter.
    Unknown(u16),
    /// The value lies outside the range.
    Range {
        /// P number.
        number: u16,
        /// Minimum.
        min: f64,
        /// Maximum.
        max: f64,
        /// The refused value.
        value: f64,
    },
    /// The value is not a whole number (ports, counts and codes).
    NotWhole {
        /// P number.
        number: u16,
        /// The refused value.
        value: f64,
    },
    /// A bit takes 0 or 1.
    Bit {
        /// P number.
        number: u16,
        /// Bit.
        bit: u8,
        /// The refused value.
        value: f64,
    },
}

impl ParamError {
    /// The message.
    #[must_use]
    pub fn text(self) -> LocalizedText {
        match self {
            Self::Unknown(number) => phrase!("没有参数 P{number}", "there is no parameter P{number}", number),
            Self::Range { number, min, max, value } => phrase!(
                "P{number} 范围 {min} 到 {max}，不能为 {value}",
                "P{number} must be {min} to {max}, not {value}",
                number,
                min,
                max,
                value
            ),
            Self::NotWhole { number, value } => phrase!(
                "P{number} 应为整数，不能为 {value}",
                "P{number} must be a whole number, not {value}",
                number,
                value
            ),
            Self::Bit { number, bit, value } => phrase!(
                "P{number}.{bit} 只能为 0 或 1，不能为 {value}",
                "P{number}.{bit} must be 0 or 1, not {value}",
                number,
                bit,
                value
            ),
        }
    }
}

impl std::fmt::Display for ParamError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text().en())
    }
}

impl std::error::Error for ParamError {}
