//! All parameters of a kind as one list: bits, numbers and ports with name, unit, range, factory value and level.
//! Source: spec B6, K6.1; the rows are defined in `param` and `signal`.

use super::kind::Kind;
use super::param::{AccessLevel, BITS, NUMBERS, ParamAddress, Params};
use super::signal::{Input, Output, PORTS};
use super::text::{LocalizedText, Text};

/// The type of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParamType {
    /// 0 or 1.
    Bit,
    /// A number.
    Number,
    /// An input port.
    Input(Input),
    /// An output port.
    Output(Output),
}

/// One parameter as listed on the parameter page.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamRow {
    /// Its address.
    pub address: ParamAddress,
    /// Display name.
    pub name: LocalizedText,
    /// Unit; empty for bits, counts and ports.
    pub unit: &'static str,
    /// Minimum.
    pub min: f64,
    /// Maximum.
    pub max: f64,
    /// Factory value on the kind.
    pub factory: f64,
    /// Who may change it.
    pub level: AccessLevel,
    /// Its type.
    pub param_type: ParamType,
}

impl ParamRow {
    /// The allowed range with its unit.
    #[must_use]
    pub fn range(&self) -> LocalizedText {
        let (min, max) = (self.min, self.max);
        match self.param_type {
            ParamType::Bit => LocalizedText::new("0 或 1", "0 or 1"),
            ParamType::Number => {
                let words = format!("{min} … {max} {}", self.unit);
                LocalizedText::new(words.trim_end(), words.trim_end())
            }
            ParamType::Input(_) | ParamType::Output(_) => {
                LocalizedText::new(format!("{min} … {max} (0 未接)"), format!("{min} … {max} (0 none)"))
            }
        }
    }
}

/// Every parameter of a kind: bits, then numbers, then ports, each by number.
#[must_use]
pub fn rows(kind: Kind) -> Vec<ParamRow> {
    let factory = Params::factory(kind);
    // `read` uses the same tables, so every address is found.
    let factory = |at| factory.read(at).unwrap_or(f64::NAN);
    let mut rows: Vec<ParamRow> = BITS
        .iter()
        .map(|row| {
            let at = ParamAddress { number: row.number, bit: Some(row.bit) };
            let (name, level, sort) = (row.name.into(), row.level, ParamType::Bit);
            ParamRow { address: at, name, unit: "", min: 0.0, max: 1.0, factory: factory(at), level, param_type: sort }
        })
        .collect();
    let numbers = NUMBERS.iter().map(|row| {
        let at = ParamAddress { number: row.number, bit: None };
        let ((min, max), name, sort) = (row.range_on(kind), row.name.into(), ParamType::Number);
        ParamRow {
            address: at,
            name,
            unit: row.unit,
            min,
            max,
            factory: factory(at),
            level: row.level,
            param_type: sort,
        }
    });
    let port = |number, name: Text, way: Text, sort| {
        let at = ParamAddress { number, bit: None };
        let name = LocalizedText::new(format!("{}：{}", way.zh, name.zh), format!("{}: {}", way.en, name.en));
        let (max, level) = (f64::from(PORTS), AccessLevel::Builder);
        ParamRow { address: at, name, unit: "", min: 0.0, max, factory: factory(at), level, param_type: sort }
    };
    let (into, out_of) = (Text::new("输入口", "input port"), Text::new("输出口", "output port"));
    let inputs = Input::ALL.iter().map(|input| port(input.port_param(), input.name(), into, ParamType::Input(*input)));
    let on_kind = Output::ALL.iter().filter(|output| output.exists_on(kind));
    let outputs = on_kind.map(|output| port(output.port_param(), output.name(), out_of, ParamType::Output(*output)));
    let mut numbers: Vec<ParamRow> = numbers.collect();
    let mut ports: Vec<ParamRow> = inputs.chain(outputs).collect();
    numbers.sort_by_key(|row| row.address);
    ports.sort_by_key(|row| row.address);
    rows.append(&mut numbers);
    rows.append(&mut ports);
    rows
}

/// The access level of a parameter; `None` if it does not exist.
#[must_use]
pub fn access_level(at: ParamAddress) -> Option<AccessLevel> {
    match at.bit {
        Some(bit) => BITS.iter().find(|row| (row.number, row.bit) == (at.number, bit)).map(|row| row.level),
        None => NUMBERS.iter().find(|row| row.number == at.number).map(|row| row.level).or_else(|| {
            let port = Input::ALL.iter().any(|input| input.port_param() == at.number)
                || Output::ALL.iter().any(|output| output.port_param() == at.number);
            port.then_some(AccessLevel::Builder)
        }),
    }
}

impl AccessLevel {
    /// The name shown.
    #[must_use]
    pub const fn name(self) -> &'static Text {
        match self {
            Self::Operator => const { &Text::new("操作", "operator") },
            Self::User => const { &Text::new("用户", "user") },
            Self::Builder => const { &Text::new("机床厂", "builder") },
        }
    }
}
