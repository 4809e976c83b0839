//! Tests of `kt830::defs::port_conflict`.

use kt830::defs::kind::Kind;
use kt830::defs::param::{ParamAddress, Params};
use kt830::defs::port_conflict::{PortConflict, input_conflicts, output_conflicts};
use kt830::defs::signal::{Input, Output};

#[test]
fn k6_1_the_factory_ports_have_no_conflict_on_any_kind() {
    for kind in Kind::ALL {
        let params = Params::factory(kind);
        assert_eq!(input_conflicts(&params), []);
        assert_eq!(output_conflicts(&params), []);
    }
}

#[test]
fn k6_1_two_functions_on_a_port_are_a_conflict_and_port_zero_is_none() {
    let mut params = Params::factory(Kind::Gc);
    let port = |number| ParamAddress { number, bit: None };
    params.write(port(301), 10.0).expect("a port");
    let found = output_conflicts(&params);
    assert_eq!(found, [PortConflict { port: 10, functions: vec![Output::Coolant, Output::Hydraulic] }]);
    params.write(port(301), 0.0).expect("a port");
    params.write(port(302), 0.0).expect("a port");
    assert_eq!(output_conflicts(&params), []);
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
        let outputs = output_conflicts(&params);
        for output in Output::ALL.iter().filter(|output| output.exists_on(kind)) {
            let shown = outputs.iter().any(|conflict| conflict.functions.contains(output));
            assert_eq!(shown, params.output_conflict(*output).is_some(), "{}", output.id());
        }
    }
}
