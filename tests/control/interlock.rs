//! The interlock table: which rule blocks a request.

use kt830::defs::mcode::Request;
use kt830::machine::ControlState;
use kt830::machine::interlock::{InterlockInputs, RuleOutcome, first_blocking_rule};
use kt830::machine::rules::RULES;

/// A machine on which everything is allowed.
fn ready() -> InterlockInputs {
    InterlockInputs {
        tailstock_on_kind: true,
        tailstock_enabled: true,
        tailstock_advanced: true,
        hydraulic_needed: true,
        hydraulic_checked: true,
        hydraulic_on: true,
        hydraulic_settled: true,
        pressure: true,
        control_state: ControlState { homed: true, ..ControlState::default() },
        ..InterlockInputs::default()
    }
}

fn outcome(request: Request, inputs: InterlockInputs) -> Option<RuleOutcome> {
    first_blocking_rule(RULES, request, &inputs).map(|rule| rule.outcome)
}

#[test]
fn k3_7_wheel_start_needs_hydraulics_their_delay_and_their_pressure() {
    assert_eq!(outcome(Request::WheelStart, ready()), None);
    let alarm = Some(RuleOutcome::Alarm(180));
    assert_eq!(outcome(Request::WheelStart, InterlockInputs { pressure: false, ..ready() }), alarm);
    assert_eq!(outcome(Request::WheelStart, InterlockInputs { hydraulic_settled: false, ..ready() }), alarm);
}

#[test]
fn k3_7_with_p270_zero_a_missing_pump_is_a_message() {
    let inputs = InterlockInputs { hydraulic_checked: false, pressure: false, ..ready() };
    assert_eq!(outcome(Request::WheelStart, inputs), None);
    let off = InterlockInputs { hydraulic_on: false, hydraulic_settled: false, ..inputs };
    assert_eq!(outcome(Request::WheelStart, off), Some(RuleOutcome::Deny));
}

#[test]
fn k3_7_with_p17_0_there_is_no_start_condition() {
    let inputs = InterlockInputs { hydraulic_needed: false, hydraulic_checked: false, ..ready() };
    let inputs = InterlockInputs { hydraulic_on: false, pressure: false, ..inputs };
    assert_eq!(outcome(Request::WheelStart, inputs), None);
}

#[test]
fn k3_5_hydraulics_are_not_switched_while_the_wheel_runs() {
    let turning = InterlockInputs { wheel_on: true, ..ready() };
    for request in [Request::HydraulicOn, Request::HydraulicOff] {
        assert_eq!(outcome(request, turning), Some(RuleOutcome::NoEffect));
        assert_eq!(outcome(request, ready()), None);
    }
}

#[test]
fn k3_3_k3_4_headstock_and_tailstock_exclude_each_other() {
    let turning = InterlockInputs { drive_on: true, ..ready() };
    assert_eq!(outcome(Request::TailstockRetract, turning), Some(RuleOutcome::Alarm(181)));
    let moving = InterlockInputs { tailstock_moving: true, ..ready() };
    assert_eq!(outcome(Request::WorkDriveHigh, moving), Some(RuleOutcome::Alarm(181)));
    let disabled = InterlockInputs { tailstock_enabled: false, drive_on: true, ..ready() };
    assert_eq!(outcome(Request::TailstockAdvance, disabled), Some(RuleOutcome::NoEffect));
}

#[test]
fn k3_7_a_latched_alarm_180_blocks_the_wheel_although_the_pressure_is_back() {
    let latched = InterlockInputs { hydraulic_latched: true, ..ready() };
    assert_eq!(outcome(Request::WheelStart, latched), Some(RuleOutcome::Deny));
}

#[test]
fn k3_7_alarm_180_bars_programs_that_start_the_wheel_not_mdi() {
    let mut alarm = InterlockInputs { hydraulic_alarm: true, pressure: false, ..ready() };
    assert_eq!(outcome(Request::CycleStart, alarm), None);
    alarm.control_state.starts_wheel = true;
    assert_eq!(outcome(Request::CycleStart, alarm), Some(RuleOutcome::Deny));
    assert_eq!(outcome(Request::MdiStart, alarm), None);
    assert_eq!(outcome(Request::HydraulicOn, alarm), None);
    alarm.hydraulic_alarm = false;
    assert_eq!(outcome(Request::CycleStart, alarm), None);
}

#[test]
fn b5_nothing_moves_while_the_drives_are_off() {
    let mut inputs = ready();
    inputs.control_state.drives_off = true;
    for request in [Request::Jog, Request::HomeAxes, Request::CycleStart] {
        assert_eq!(outcome(request, inputs), Some(RuleOutcome::Deny));
    }
}

#[test]
fn b5_cycle_start_needs_homing_and_no_alarm() {
    let mut inputs = ready();
    assert_eq!(outcome(Request::CycleStart, inputs), None);
    inputs.control_state.homed = false;
    assert_eq!(outcome(Request::CycleStart, inputs), Some(RuleOutcome::Alarm(100)));
    inputs.control_state.alarm_blocks = true;
    assert_eq!(outcome(Request::CycleStart, inputs), Some(RuleOutcome::Deny));
    // K3.7: alarm 180 blocks neither jogging nor homing.
    assert_eq!(outcome(Request::Jog, inputs), None);
    assert_eq!(outcome(Request::HomeAxes, inputs), None);
}
