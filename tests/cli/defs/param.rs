//! Tests of `kt830::defs::param`.

use kt830::defs::kind::Kind;
use kt830::defs::param::*;
use kt830::defs::signal::{Input, Output};

#[test]
fn k3_factory_ports_are_the_seeds() {
    let params = Params::factory(Kind::Gc);
    let outputs = [(Output::HeadstockHigh, 16), (Output::HeadstockLow, 15), (Output::Hydraulic, 10)];
    for (output, port) in outputs {
        assert_eq!(params.output_port(output), port);
    }
    assert_eq!(params.output_port(Output::RadialGauge), 13);
    assert_eq!(params.output_port(Output::AxialGauge), 14);
    assert_eq!(params.output_port(Output::User5), 25);
    assert_eq!(params.output_port(Output::TowerGreen), 28);
    assert_eq!(params.input_port(Input::HydraulicPressure), 3);
    assert_eq!(params.input_port(Input::EmergencyStop), 4);
    assert_eq!(params.input_port(Input::Gauge6), 12);
    assert_eq!(params.input_port(Input::User10), 22);
    assert_eq!(params.input_port(Input::HomeZ), 25);
    assert_eq!(params.input_port(Input::LimitZMinus), 39);
    assert_eq!(params.input_port(Input::GuardClosed), 0);
}

#[test]
fn k3_normally_closed_inputs_are_the_emergency_stop_drives_and_limits() {
    let inverted = Params::factory(Kind::Gc).inverted_inputs();
    // Ports 4, 31…33 and 34…39.
    let expected: u64 = 1 << 3 | (30..39).map(|bit| 1_u64 << bit).sum::<u64>();
    assert_eq!(inverted, expected);
}

#[test]
fn k1_factory_bits_differ_by_kind() {
    let gc = Params::factory(Kind::Gc);
    let gs = Params::factory(Kind::Gs);
    assert!(!gc.bit(MAGNET_ENABLED) && !gc.bit(WHEEL_NEEDS_MAGNET) && gc.bit(TAILSTOCK_ENABLED));
    assert!(gs.bit(MAGNET_ENABLED) && gs.bit(WHEEL_NEEDS_MAGNET) && !gs.bit(TAILSTOCK_ENABLED));
}

#[test]
fn b6_a_value_out_of_range_is_refused_and_changes_nothing() {
    let mut params = Params::factory(Kind::Gc);
    let at = ParamAddress::parse("P270").unwrap();
    assert!(params.write(at, 60_001.0).is_err());
    assert!(params.write(at, f64::NAN).is_err());
    assert_eq!(params.read(at), Ok(3_000.0));
    assert!(params.write(ParamAddress::parse("P16.0").unwrap(), 2.0).is_err());
    assert!(params.write(ParamAddress::parse("P300").unwrap(), 65.0).is_err());
    assert_eq!(params.write(ParamAddress::parse("P499").unwrap(), 1.0), Err(ParamError::Unknown(499)));
}
