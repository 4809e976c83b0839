//! The parameters: number, bit, name, unit, range, factory value and access level, and the values of a machine.
//! Source: the customer's numbers (P4.4 … P349) and spec K3, K4, B7; numbers 30 to 99 are defined by this project.

mod error;
pub(super) mod row;
pub(super) mod table;

pub use error::ParamError;
pub use row::*;
pub use table::*;
use table::{factory_input_port, factory_output_port};

use super::fitted::Fitted;
use super::kind::Kind;
use super::signal::{Input, Output, PORTS};
use crate::units::{Axis, Micros};

/// Exclusive upper limit of parameter numbers.
pub const PARAM_LIMIT: usize = 500;

impl BitParam {
    /// Its factory value on a kind of machine.
    #[must_use]
    pub fn factory_on(&self, kind: Kind) -> bool {
        let row = kind.row();
        let own = row.factory.bits.iter().find(|(bit, _)| bit.address() == self.address());
        own.map_or_else(
            || match self.factory {
                FactoryBit::Off => false,
                FactoryBit::On => true,
                FactoryBit::With(device) => row.has(device),
                FactoryBit::Without(device) => !row.has(device),
            },
            |(_, value)| *value,
        )
    }
}

impl NumberParam {
    /// Its minimum and maximum on a kind of machine.
    #[must_use]
    pub fn range_on(&self, kind: Kind) -> (f64, f64) {
        let own = kind.row().factory.ranges.iter().find(|(row, ..)| row.number == self.number);
        own.map_or((self.min, self.max), |(_, min, max)| (*min, *max))
    }
}

impl From<Kind> for Fitted {
    /// A machine of the kind as delivered.
    fn from(kind: Kind) -> Self {
        Self { kind, axis_y: Y_FITTED.factory_on(kind), magnet: MAGNET_ENABLED.factory_on(kind) }
    }
}

/// All parameter values of one machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// The kind of machine; selects the ranges.
    kind: Kind,
    numbers: Box<[f64; PARAM_LIMIT]>,
    bits: Box<[u8; PARAM_LIMIT]>,
}

impl Params {
    /// The factory values of a kind.
    #[must_use]
    pub fn factory(kind: Kind) -> Self {
        let mut params = Self { kind, numbers: Box::new([0.0; PARAM_LIMIT]), bits: Box::new([0; PARAM_LIMIT]) };
        NUMBERS.iter().for_each(|row| params.numbers[usize::from(row.number)] = row.factory);
        for (row, value) in kind.row().factory.numbers {
            params.numbers[usize::from(row.number)] = *value;
        }
        for input in Input::ALL {
            params.numbers[usize::from(input.port_param())] = f64::from(factory_input_port(*input));
        }
        for output in Output::ALL {
            params.numbers[usize::from(output.port_param())] = f64::from(factory_output_port(*output));
        }
        BITS.iter().for_each(|row| params.put_bit(row.number, row.bit, row.factory_on(kind)));
        params
    }

    /// Takes over all values of `other`, in place.
    pub fn copy_from(&mut self, other: &Self) {
        self.kind = other.kind;
        self.numbers.copy_from_slice(&*other.numbers);
        self.bits.copy_from_slice(&*other.bits);
    }

    fn put_bit(&mut self, number: u16, bit: u8, on: bool) {
        let byte = &mut self.bits[usize::from(number)];
        if on { *byte |= 1 << bit } else { *byte &= !(1 << bit) }
    }

    /// The value of a number parameter.
    #[must_use]
    pub fn get(&self, row: NumberParam) -> f64 {
        self.numbers[usize::from(row.number)]
    }

    /// Whether a bit is 1.
    #[must_use]
    pub fn bit(&self, row: BitParam) -> bool {
        self.bits[usize::from(row.number)] >> row.bit & 1 == 1
    }

    /// Decimals of a displayed length, mm: 3, with P22.2 4.
    #[must_use]
    pub fn length_decimals(&self) -> usize {
        if self.bit(FINE_DISPLAY) { 4 } else { 3 }
    }

    /// The port of an input; 0 is not connected.
    #[must_use]
    pub fn input_port(&self, input: Input) -> u8 {
        self.numbers[usize::from(input.port_param())] as u8
    }

    /// The port of an output; 0 is not connected.
    #[must_use]
    pub fn output_port(&self, output: Output) -> u8 {
        self.numbers[usize::from(output.port_param())] as u8
    }

    /// What the machine is fitted with.
    #[must_use]
    pub fn fitted(&self) -> Fitted {
        Fitted { kind: self.kind, axis_y: self.bit(Y_FITTED), magnet: self.bit(MAGNET_ENABLED) }
    }

    /// Another output of the machine that is assigned to the same port (K6.1).
    #[must_use]
    pub fn output_conflict(&self, output: Output) -> Option<Output> {
        let (port, fitted) = (self.output_port(output), self.fitted());
        if port == 0 || !output.exists_on(fitted) {
            return None;
        }
        let shares = |other: Output| other != output && self.output_port(other) == port && other.exists_on(fitted);
        Output::ALL.iter().copied().find(|other| shares(*other))
    }

    /// A number parameter in milliseconds, as a time span.
    #[must_use]
    pub fn millis(&self, row: NumberParam) -> Micros {
        Micros::from_millis_f64(self.get(row))
    }

    /// Bit mask of the input ports with inverted level (normally closed contacts); bit 0 is port 1.
    #[must_use]
    pub fn inverted_inputs(&self) -> u64 {
        let rows = [INPUTS_INVERTED_4, INPUTS_INVERTED_3, INPUTS_INVERTED_2, INPUTS_INVERTED_1];
        rows.into_iter().fold(0, |mask, row| mask << 16 | (self.get(row) as u64 & 0xFFFF))
    }

    /// The value for an axis, of three consecutive parameters X, Y, Z; `x` is the first.
    #[must_use]
    pub fn get_axis(&self, x: NumberParam, axis: Axis) -> f64 {
        self.numbers[usize::from(x.number) + axis as usize]
    }

    /// The value at an address, bits as 0 or 1.
    ///
    /// # Errors
    /// The address is not in the table.
    pub fn read(&self, at: ParamAddress) -> Result<f64, ParamError> {
        let value = match at.bit {
            Some(bit) => find_bit(at.number, bit).map(|row| f64::from(u8::from(self.bit(*row)))),
            None => find_number(at.number, self.kind).map(|_| self.numbers[usize::from(at.number)]),
        };
        value.ok_or(ParamError::Unknown(at.number))
    }

    /// Stores a value at an address.
    ///
    /// # Errors
    /// The address is not in the table, or the value is outside its range; the old value stays.
    pub fn write(&mut self, at: ParamAddress, value: f64) -> Result<(), ParamError> {
        if let Some(bit) = at.bit {
            find_bit(at.number, bit).ok_or(ParamError::Unknown(at.number))?;
            let on = match value {
                v if v.total_cmp(&0.0).is_eq() => false,
                v if v.total_cmp(&1.0).is_eq() => true,
                value => return Err(ParamError::Bit { number: at.number, bit, value }),
            };
            self.put_bit(at.number, bit, on);
            return Ok(());
        }
        let (min, max, whole) = find_number(at.number, self.kind).ok_or(ParamError::Unknown(at.number))?;
        if !(min..=max).contains(&value) {
            return Err(ParamError::Range { number: at.number, min, max, value });
        }
        if whole && value.fract().abs() > 0.0 {
            return Err(ParamError::NotWhole { number: at.number, value });
        }
        self.numbers[usize::from(at.number)] = value;
        Ok(())
    }
}

fn find_bit(number: u16, bit: u8) -> Option<&'static BitParam> {
    BITS.iter().find(|row| row.number == number && row.bit == bit)
}

/// Range of a number parameter or port on a kind, and whether it must be a whole number (parameters without a unit).
fn find_number(number: u16, kind: Kind) -> Option<(f64, f64, bool)> {
    if let Some(row) = NUMBERS.iter().find(|row| row.number == number) {
        let (min, max) = row.range_on(kind);
        return Some((min, max, row.unit.is_empty()));
    }
    is_port(number).then_some((0.0, f64::from(PORTS), true))
}

/// Whether a parameter assigns a port.
#[must_use]
pub fn is_port(number: u16) -> bool {
    Input::ALL.iter().any(|input| input.port_param() == number)
        || Output::ALL.iter().any(|output| output.port_param() == number)
}
