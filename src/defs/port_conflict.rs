//! Ports assigned to more than one function: shown on the diagnosis page and refused by the interlock table.
//! Source: spec K6.1. Functions that never exist on the same kind may share a port (P153). Port 0 is "not connected".

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
    let fitted = params.fitted();
    conflicts(Input::ALL.iter().copied().filter(|input| input.exists_on(fitted)), |input| params.input_port(input))
}

/// Output ports with more than one function.
#[must_use]
pub fn output_conflicts(params: &Params) -> Vec<PortConflict<Output>> {
    let fitted = params.fitted();
    let used = Output::ALL.iter().copied().filter(|output| output.exists_on(fitted));
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
