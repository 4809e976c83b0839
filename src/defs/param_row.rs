//! All parameters of a machine as one list: bits, numbers and ports with name, unit, range, factory value and level.
//! Source: spec B6, K6.1; the rows are defined in `param` and `signal`.

use super::fitted::Fitted;
use super::param::{AccessLevel, BITS, NUMBERS, ParamAddress, Params, is_port};
use super::signal::{Input, Output, PORTS};
use super::text::{LocalizedText, Template, Text, phrase};

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
            ParamType::Bit => phrase!("0 或 1", "0 or 1"),
            ParamType::Number => {
                let words = format!("{min} … {max} {}", self.unit);
                LocalizedText::new(words.trim_end(), words.trim_end())
            }
            ParamType::Input(_) | ParamType::Output(_) => {
                phrase!("{min} … {max} (0 未接)", "{min} … {max} (0 none)", min, max)
            }
        }
    }
}

/// Every parameter of what a machine is fitted with: bits, then numbers, then ports, each by number.
#[must_use]
pub fn rows(machine: impl Into<Fitted>) -> Vec<ParamRow> {
    let machine = machine.into();
    let (kind, factory) = (machine.kind, Params::factory(machine.kind));
    let row = |address, name: LocalizedText, (min, max), level, param_type| {
        // `read` uses the same tables, so every address is found.
        let factory = factory.read(address).unwrap_or(f64::NAN);
        ParamRow { address, name, unit: "", min, max, factory, level, param_type }
    };
    let bits = BITS.iter().filter(|bit| machine.meets(bit.needs));
    let bits = bits.map(|bit| row(bit.address(), bit.name.into(), (0.0, 1.0), bit.level, ParamType::Bit));
    let mut rows: Vec<ParamRow> = bits.collect();
    let numbers = NUMBERS.iter().filter(|number| machine.meets(number.needs)).map(|number| {
        let range = number.range_on(kind);
        let shown = row(number.address(), number.name.into(), range, number.level, ParamType::Number);
        ParamRow { unit: number.unit, ..shown }
    });
    let port = |number, name, sort| {
        row(ParamAddress { number, bit: None }, name, (0.0, f64::from(PORTS)), AccessLevel::Builder, sort)
    };
    let inputs = Input::ALL.iter().filter(|input| input.exists_on(machine));
    let inputs = inputs.map(|input| port(input.port_param(), input_port_name(*input), ParamType::Input(*input)));
    let outputs = Output::ALL.iter().filter(|output| output.exists_on(machine));
    let outputs =
        outputs.map(|output| port(output.port_param(), output_port_name(*output), ParamType::Output(*output)));
    let mut numbers: Vec<ParamRow> = numbers.collect();
    let mut ports: Vec<ParamRow> = inputs.chain(outputs).collect();
    numbers.sort_by_key(|row| row.address);
    ports.sort_by_key(|row| row.address);
    rows.append(&mut numbers);
    rows.append(&mut ports);
    rows
}

fn input_port_name(input: Input) -> LocalizedText {
    port_name(Text::new("输入口", "input port"), input.name())
}

fn output_port_name(output: Output) -> LocalizedText {
    port_name(Text::new("输出口", "output port"), output.name())
}

fn port_name(way: Text, name: Text) -> LocalizedText {
    const OF_SIGNAL: &Template = &Template::new("{way}：{name}", "{way}: {name}", &["way", "name"]);
    LocalizedText::phrase_of(OF_SIGNAL, [], [way.into(), name.into()])
}

/// The name of a parameter of what a machine is fitted with; `None` if it has none there.
#[must_use]
pub fn name_of(at: ParamAddress, machine: impl Into<Fitted>) -> Option<LocalizedText> {
    let machine = machine.into();
    if let Some(bit) = at.bit {
        let row = BITS.iter().find(|row| (row.number, row.bit) == (at.number, bit) && machine.meets(row.needs))?;
        return Some(row.name.into());
    }
    let number = NUMBERS.iter().find(|row| row.number == at.number && machine.meets(row.needs));
    let input = || Input::ALL.iter().find(|input| input.port_param() == at.number && input.exists_on(machine));
    let output = || Output::ALL.iter().find(|output| output.port_param() == at.number && output.exists_on(machine));
    number
        .map(|row| row.name.into())
        .or_else(|| input().map(|input| input_port_name(*input)))
        .or_else(|| output().map(|output| output_port_name(*output)))
}

/// The address of every parameter, also of devices that a machine lacks: a backup has them all.
pub fn addresses() -> impl Iterator<Item = ParamAddress> {
    let ports =
        Input::ALL.iter().map(|input| input.port_param()).chain(Output::ALL.iter().map(|output| output.port_param()));
    let numbers = NUMBERS.iter().map(|number| number.number).chain(ports);
    let numbers = numbers.map(|number| ParamAddress { number, bit: None });
    BITS.iter().map(|bit| bit.address()).chain(numbers)
}

/// The access level of a parameter; `None` if it does not exist.
#[must_use]
pub fn access_level(at: ParamAddress) -> Option<AccessLevel> {
    match at.bit {
        Some(bit) => BITS.iter().find(|row| (row.number, row.bit) == (at.number, bit)).map(|row| row.level),
        None => {
            let number = NUMBERS.iter().find(|row| row.number == at.number).map(|row| row.level);
            number.or_else(|| is_port(at.number).then_some(AccessLevel::Builder))
        }
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
