//! The rows of the parameter table: a number, a bit, and their address.

use serde::{Deserialize, Serialize};

use crate::defs::equipment::{Equipment, Needs};
use crate::defs::text::Text;

/// Who may change a parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum AccessLevel {
    /// Anyone at the panel.
    #[default]
    Operator,
    /// The user's password.
    User,
    /// The machine builder's password.
    Builder,
}

/// A numeric parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberParam {
    /// P number.
    pub number: u16,
    /// Display name.
    pub name: Text,
    /// Unit; empty for counts and ports.
    pub unit: &'static str,
    /// Minimum.
    pub min: f64,
    /// Maximum.
    pub max: f64,
    /// Factory value; a kind may have its own.
    pub factory: f64,
    /// Who may change it.
    pub level: AccessLevel,
    /// The device that it belongs to.
    pub needs: Needs,
}

/// The factory value of a bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactoryBit {
    /// 0.
    Off,
    /// 1.
    On,
    /// 1 on machines with the device.
    With(Equipment),
    /// 1 on machines without the device.
    Without(Equipment),
}

/// One bit of a bit parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitParam {
    /// P number.
    pub number: u16,
    /// Bit 0…7.
    pub bit: u8,
    /// Meaning of 1.
    pub name: Text,
    /// Factory value; a kind may have its own.
    pub factory: FactoryBit,
    /// Who may change it.
    pub level: AccessLevel,
    /// The device that it belongs to.
    pub needs: Needs,
}

impl BitParam {
    /// The address of the parameter.
    #[must_use]
    pub const fn address(self) -> ParamAddress {
        ParamAddress { number: self.number, bit: Some(self.bit) }
    }
}

impl NumberParam {
    /// The address of the parameter.
    #[must_use]
    pub const fn address(self) -> ParamAddress {
        ParamAddress { number: self.number, bit: None }
    }
}

/// The address of a parameter, written `P270` or `P16.0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ParamAddress {
    /// P number.
    pub number: u16,
    /// The bit, for bit parameters.
    pub bit: Option<u8>,
}

impl ParamAddress {
    /// Parses `P270`, `270`, `P16.0`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let digits = text.strip_prefix(['P', 'p']).unwrap_or(text);
        let (number, bit) = match digits.split_once('.') {
            Some((number, bit)) => (number, Some(bit.parse().ok()?)),
            None => (digits, None),
        };
        Some(Self { number: number.parse().ok()?, bit })
    }
}

impl std::fmt::Display for ParamAddress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "P{}", self.number)?;
        self.bit.map_or(Ok(()), |bit| write!(f, ".{bit}"))
    }
}
