//! The interlock table: which request is forbidden when, and why. One row per rule; no interlock exists elsewhere.
//!
//! Rules are evaluated from the top; the first that applies decides. They are pure functions of [`InterlockInputs`], so that
//! tests can cover all of them.
//! Source: spec K3, K5, "what stops what".

use super::ControlState;
use crate::defs::mcode::Request;
use crate::defs::start_step::StartStep;
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
    /// The end-switch signal went or did not come: nobody knows where the quill stands.
    pub tailstock_lost: bool,
    /// P6.5: the headstock needs the tailstock.
    pub tailstock_needed: bool,
    /// The part is clamped by the tailstock.
    pub tailstock_advanced: bool,
    /// P17.0=0: the wheel needs hydraulics.
    pub hydraulic_needed: bool,
    /// P17.0=0 and P270>0: the pressure signal is supervised.
    pub hydraulic_checked: bool,
    /// Alarm 180 is active.
    pub hydraulic_alarm: bool,
    /// Alarm 180 stopped the wheel or a program and waits for RESET.
    pub hydraulic_latched: bool,
    /// The pump's output is on.
    pub hydraulic_on: bool,
    /// On for at least P270.
    pub hydraulic_settled: bool,
    /// The pressure switch is on.
    pub pressure: bool,
    /// A magnet is fitted.
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
    /// The condition of a cycle start that it checks, if any.
    pub step: Option<StartStep>,
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
pub fn first_blocking_rule(rules: &'static [Rule], request: Request, state: &InterlockInputs) -> Option<&'static Rule> {
    rules.iter().find(|rule| (rule.forbids)(request) && (rule.applies)(state))
}
