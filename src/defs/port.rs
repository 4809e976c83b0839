//! Which inputs and outputs a machine has, and which of them were given the same port.
//! Source: spec K6.1. Functions of which only one can exist on a kind share a port without a conflict (P153); port 0 is
//! "not connected"; a function that is switched off by its parameter takes no port.

use super::kind::Kind;
use super::param::{self, Params};
use super::signal::{Input, Output, PORTS};

/// Whether a kind has an output.
#[must_use]
pub const fn is_of_kind(output: Output, kind: Kind) -> bool {
    match output {
        Output::HeadstockHigh | Output::HeadstockLow => matches!(kind, Kind::Gc),
        Output::DresserRoll => matches!(kind, Kind::Gs),
        Output::TableRotation => matches!(kind, Kind::Ga),
        _ => true,
    }
}

/// Whether an output is in use on a machine with these parameters.
#[must_use]
pub fn uses_output(output: Output, kind: Kind, params: &Params) -> bool {
    match output {
        Output::Tailstock => params.bit(param::TAILSTOCK_ENABLED),
        Output::Magnetise | Output::Demagnetise => params.bit(param::MAGNET_ENABLED),
        output => is_of_kind(output, kind),
    }
}

/// Whether an input is in use on a machine with these parameters.
#[must_use]
pub fn uses_input(input: Input, params: &Params) -> bool {
    match input {
        Input::TailstockAdvanced | Input::TailstockRetracted => params.bit(param::TAILSTOCK_ENABLED),
        Input::HomeY | Input::DriveY | Input::LimitYPlus | Input::LimitYMinus => params.bit(param::Y_FITTED),
        _ => true,
    }
}

/// One port that several functions were given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conflict<T> {
    /// The port.
    pub port: u8,
    /// Its functions.
    pub functions: Vec<T>,
}

/// Input ports with more than one function.
#[must_use]
pub fn input_conflicts(params: &Params) -> Vec<Conflict<Input>> {
    let used = Input::ALL.iter().copied().filter(|input| uses_input(*input, params));
    conflicts(used, |input| params.input_port(input))
}

/// Output ports with more than one function.
#[must_use]
pub fn output_conflicts(kind: Kind, params: &Params) -> Vec<Conflict<Output>> {
    let used = Output::ALL.iter().copied().filter(|output| uses_output(*output, kind, params));
    conflicts(used, |output| params.output_port(output))
}

fn conflicts<T: Copy>(used: impl Iterator<Item = T>, port: impl Fn(T) -> u8) -> Vec<Conflict<T>> {
    let mut ports: Vec<Conflict<T>> = (1..=PORTS).map(|port| Conflict { port, functions: Vec::new() }).collect();
    for function in used {
        if let Some(at) = port(function).checked_sub(1).and_then(|index| ports.get_mut(usize::from(index))) {
            at.functions.push(function);
        }
    }
    ports.retain(|conflict| conflict.functions.len() > 1);
    ports
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::param::ParamAddress;

    #[test]
    fn k6_1_the_factory_ports_have_no_conflict_on_any_kind() {
        for kind in Kind::ALL {
            let params = Params::factory(kind);
            assert_eq!(input_conflicts(&params), []);
            assert_eq!(output_conflicts(kind, &params), []);
        }
    }

    #[test]
    fn k6_1_two_functions_on_a_port_are_a_conflict_and_port_zero_is_none() {
        let mut params = Params::factory(Kind::Gc);
        let port = |number| ParamAddress { number, bit: None };
        params.write(port(301), 10.0).expect("a port");
        let found = output_conflicts(Kind::Gc, &params);
        assert_eq!(found, [Conflict { port: 10, functions: vec![Output::Coolant, Output::Hydraulic] }]);
        params.write(port(301), 0.0).expect("a port");
        params.write(port(302), 0.0).expect("a port");
        assert_eq!(output_conflicts(Kind::Gc, &params), []);
        params.write(port(332), 3.0).expect("a port");
        let found = input_conflicts(&params);
        assert_eq!(found, [Conflict { port: 3, functions: vec![Input::HydraulicPressure, Input::GuardClosed] }]);
    }

    #[test]
    fn k6_1_a_function_that_is_switched_off_takes_no_port() {
        let mut params = Params::factory(Kind::Gs);
        params.write(ParamAddress { number: 303, bit: None }, 10.0).expect("a port");
        assert_eq!(output_conflicts(Kind::Gs, &params), [], "GS has no tailstock: P16.2=0");
        params.write(ParamAddress { number: 16, bit: Some(2) }, 1.0).expect("a bit");
        assert_eq!(output_conflicts(Kind::Gs, &params).len(), 1);
    }
}
