//! The interlock table: which request is forbidden when, and why. One row per rule; no interlock exists elsewhere.
//!
//! Rules are evaluated from the top; the first that applies decides. They are pure functions of [`InterlockInputs`], so that
//! tests can cover all of them.
//! Source: spec K3, K5, "what stops what".

use super::ControlState;
use crate::defs::mcode::Request;
use crate::defs::text::Text;

/// The inputs of the rules: the state of the machine and of the control.
#[derive(Clone, Copy, Debug, Default)]
pub struct InterlockInputs {
    /// The emergency stop is pressed.
    pub e_stop: bool,
    /// The wheel's output is on.
    pub wheel_on: bool,
    /// Diameter and commanded speed together exceed the wheel's rating (P77, P79).
    pub wheel_too_fast: bool,
    /// P6.7: the wheel was changed and not dressed since (K5.17).
    pub wheel_undressed: bool,
    /// The workpiece drive (headstock, roll or table) is on.
    pub drive_on: bool,
    /// The drive turns the part on the magnet (GA).
    pub drive_carries_part: bool,
    /// The kind has a main spindle and a tool post.
    pub has_main_spindle: bool,
    /// The tool post is indexing.
    pub turret_moving: bool,
    /// The guard stopped the drive of a run that is still open.
    pub drive_stopped_by_guard: bool,
    /// The kind has a tailstock.
    pub tailstock_on_kind: bool,
    /// P16.2=1, and the kind has a tailstock.
    pub tailstock_enabled: bool,
    /// The tailstock is moving.
    pub tailstock_moving: bool,
    /// The end-switch signal went or did not come while the valve is on.
    pub tailstock_lost: bool,
    /// P6.5: the headstock needs the tailstock.
    pub tailstock_needed: bool,
    /// The part is clamped by the tailstock.
    pub tailstock_advanced: bool,
    /// P17.0=0: the wheel needs hydraulics.
    pub hydraulic_needed: bool,
    /// P17.0=0 and P270>0: the pressure signal is supervised.
    pub hydraulic_checked: bool,
    /// Alarm 180 stopped the wheel or a program and waits for RESET.
    pub hydraulic_latched: bool,
    /// The pump's output is on.
    pub hydraulic_on: bool,
    /// On for at least P270.
    pub hydraulic_settled: bool,
    /// The pressure switch is on.
    pub pressure: bool,
    /// The kind has a magnet, or P16.0 enables one.
    pub magnet_on_kind: bool,
    /// P16.0: the magnet is enabled.
    pub magnet_enabled: bool,
    /// P16.1: the wheel start needs a magnetised part.
    pub magnet_needed: bool,
    /// The magnet holds: magnetised for at least P81.
    pub magnetised: bool,
    /// The oscillation cylinder is running.
    pub cylinder_on: bool,
    /// P332 is assigned and the guard is not closed.
    pub guard_open: bool,
    /// The external hold is active.
    pub external_hold: bool,
    /// The requested port belongs to an interlocked function.
    pub port_owned: bool,
    /// The requested output has no port.
    pub port_missing: bool,
    /// Another function uses the port of the requested output.
    pub port_conflict: bool,
    /// State of the control.
    pub control_state: ControlState,
}

/// Effect of a rule on a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RuleOutcome {
    /// A message; the program continues.
    NoEffect,
    /// A message; a program waits before the block.
    Deny,
    /// An alarm; a program stops before the block.
    Alarm(u16),
}

/// One rule.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// Row of the specification that requires it.
    pub row: &'static str,
    /// The requests it forbids.
    pub forbids: fn(Request) -> bool,
    /// When it applies.
    pub applies: fn(&InterlockInputs) -> bool,
    /// Its effect.
    pub outcome: RuleOutcome,
    /// The reason, for the message line and the diagnosis page.
    pub reason: Text,
}

/// The first rule that forbids a request, if any.
#[must_use]
pub fn first_blocking_rule(rules: &'static [Rule], request: Request, facts: &InterlockInputs) -> Option<&'static Rule> {
    rules.iter().find(|rule| (rule.forbids)(request) && (rule.applies)(facts))
}

#[cfg(test)]
mod tests {
    use super::super::rules::RULES;
    use super::*;

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

    fn outcome(request: Request, facts: InterlockInputs) -> Option<RuleOutcome> {
        first_blocking_rule(RULES, request, &facts).map(|rule| rule.outcome)
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
        let facts = InterlockInputs { hydraulic_checked: false, pressure: false, ..ready() };
        assert_eq!(outcome(Request::WheelStart, facts), None);
        let off = InterlockInputs { hydraulic_on: false, hydraulic_settled: false, ..facts };
        assert_eq!(outcome(Request::WheelStart, off), Some(RuleOutcome::Deny));
    }

    #[test]
    fn k3_7_with_p17_0_there_is_no_start_condition() {
        let facts = InterlockInputs { hydraulic_needed: false, hydraulic_checked: false, ..ready() };
        let facts = InterlockInputs { hydraulic_on: false, pressure: false, ..facts };
        assert_eq!(outcome(Request::WheelStart, facts), None);
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
    fn b5_nothing_moves_while_the_drives_are_off() {
        let mut facts = ready();
        facts.control_state.drives_off = true;
        for request in [Request::Jog, Request::HomeAxes, Request::CycleStart] {
            assert_eq!(outcome(request, facts), Some(RuleOutcome::Deny));
        }
    }

    #[test]
    fn b5_cycle_start_needs_homing_and_no_alarm() {
        let mut facts = ready();
        assert_eq!(outcome(Request::CycleStart, facts), None);
        facts.control_state.homed = false;
        assert_eq!(outcome(Request::CycleStart, facts), Some(RuleOutcome::Alarm(100)));
        facts.control_state.alarm_blocks = true;
        assert_eq!(outcome(Request::CycleStart, facts), Some(RuleOutcome::Deny));
        // K3.7: alarm 180 blocks neither jogging nor homing.
        assert_eq!(outcome(Request::Jog, facts), None);
        assert_eq!(outcome(Request::HomeAxes, facts), None);
    }
}
