//! Functions and terminals of the machine: assignment, polarity, forced inputs (rows P1, P8, K6.1).

use crate::bench::{Rig, cold};
use kt830::defs::param::ParamAddress;
use kt830::defs::signal::{Input, Output};
use kt830::io::Backend;

/// Forces an input; whether the circuit of a port is closed then.
fn closed_after(rig: &mut Rig, input: &str, on: Option<bool>, port: u8) -> bool {
    rig.sim.force_input(input, on).unwrap();
    rig.step();
    rig.seen.terminals.is_closed(port)
}

#[test]
fn p1_a_normally_closed_contact_is_closed_at_rest_and_its_terminal_low() {
    let mut rig = cold();
    // Port 4 emergency stop, 34 limit X+; port 3 hydraulic pressure is normally open.
    let rest = rig.seen.terminals;
    assert!(rest.is_closed(4) && rest.is_closed(34) && !rest.is_closed(3));
    assert!(!closed_after(&mut rig, Input::LimitXPlus.id(), Some(true), 34));
    assert!(closed_after(&mut rig, Input::HydraulicPressure.id(), Some(true), 3));
}

#[test]
fn p8_a_forced_input_is_logical_and_a_port_too() {
    let mut rig = cold();
    for name in [Input::EmergencyStop.id(), "4"] {
        assert!(!closed_after(&mut rig, name, Some(true), 4), "{name}");
        assert!(closed_after(&mut rig, name, None, 4), "{name}");
    }
}

#[test]
fn k6_1_a_function_moves_to_its_new_port() {
    // The guard of the simulated machine is closed; its switch has no port by factory.
    let mut rig = cold();
    assert!(rig.params.input_port(Input::GuardClosed) == 0 && !rig.seen.terminals.is_closed(60));
    rig.params.write(ParamAddress::parse("P332").unwrap(), 60.0).unwrap();
    rig.sim.rewire(&rig.params);
    rig.step();
    assert!(rig.seen.terminals.is_closed(60));
}

#[test]
fn p1_outputs_follow_the_parameters() {
    let mut rig = cold();
    assert_eq!(rig.params.output_port(Output::Hydraulic), 10);
    rig.out.terminals.set(10, true);
    rig.wait(0.1);
    assert!(rig.sim.pressure_mpa() > 0.0 && rig.sim.wheel().rpm <= 0.0);
}
