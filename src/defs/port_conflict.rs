//! Ports assigned to more than one function: shown on the diagnosis page and refused by the interlock table.
//! Source: spec K6.1. Functions that never exist on the same kind may share a port (P153). Port 0 is "not connected".

use super::kind::Kind;
use super::param::Params;
use super::signal::{Input, Output, PORTS};

/// One port that is assigned to several functions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortConflict<T> {
    /// The port.
    pub port: u8,
    /// The functions assigned to it.
    pub functions: Vec<T>,
}

/// Input ports with more than one function.
#[must_use]
pub fn input_conflicts(params: &Params) -> Vec<PortConflict<Input>> {
    conflicts(Input::ALL.iter().copied(), |input| params.input_port(input))
}

/// Output ports with more than one function.
#[must_use]
pub fn output_conflicts(kind: Kind, params: &Params) -> Vec<PortConflict<Output>> {
    let used = Output::ALL.iter().copied().filter(|output| output.exists_on(kind));
    conflicts(used, |output| params.output_port(output))
}

fn conflicts<T: Copy>(used: impl Iterator<Item = T>, port: impl Fn(T) -> u8) -> Vec<PortConflict<T>> {
    let mut ports: Vec<PortConflict<T>> =
        (1..=PORTS).map(|port| PortConflict { port, functions: Vec::new() }).collect();
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
        assert_eq!(found, [PortConflict { port: 10, functions: vec![Output::Coolant, Output::Hydraulic] }]);
        params.write(port(301), 0.0).expect("a port");
        params.write(port(302), 0.0).expect("a port");
        assert_eq!(output_conflicts(Kind::Gc, &params), []);
        params.write(port(332), 3.0).expect("a port");
        let found = input_conflicts(&params);
        assert_eq!(found, [PortConflict { port: 3, functions: vec![Input::HydraulicPressure, Input::GuardClosed] }]);
    }

    #[test]
    fn k6_1_the_page_names_the_conflicts_that_the_interlock_refuses() {
        for kind in Kind::ALL {
            let mut params = Params::factory(kind);
            for (number, port) in [(301, 10.0), (303, 10.0), (323, 13.0)] {
                params.write(ParamAddress { number, bit: None }, port).expect("a port");
            }
            let outputs = output_conflicts(kind, &params);
            for output in Output::ALL.iter().filter(|output| output.exists_on(kind)) {
                let shown = outputs.iter().any(|conflict| conflict.functions.contains(output));
                assert_eq!(shown, params.output_conflict(kind, *output).is_some(), "{}", output.id());
            }
        }
    }
}
