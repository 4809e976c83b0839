//! The phases of a run.

use kt830::machine::phase::{PhaseEvent, RunPhase};

fn check(phase: RunPhase, event: PhaseEvent, expected: RunPhase) {
    assert_eq!(phase.after(event), expected, "{phase:?} after {event:?}");
}

#[test]
fn b5_a_run_is_held_resumed_stopped_and_left() {
    check(RunPhase::Idle, PhaseEvent::Start, RunPhase::Running);
    check(RunPhase::Running, PhaseEvent::Hold, RunPhase::Holding);
    check(RunPhase::Holding, PhaseEvent::AtRest, RunPhase::Held);
    check(RunPhase::Held, PhaseEvent::Start, RunPhase::Running);
    check(RunPhase::Running, PhaseEvent::Stop, RunPhase::Stopped);
    check(RunPhase::Stopped, PhaseEvent::Start, RunPhase::Running);
    check(RunPhase::Held, PhaseEvent::Abort, RunPhase::Aborting);
    check(RunPhase::Aborting, PhaseEvent::AtRest, RunPhase::Idle);
    check(RunPhase::Running, PhaseEvent::Finish, RunPhase::Idle);
}

#[test]
fn b5_what_means_nothing_changes_nothing() {
    check(RunPhase::Holding, PhaseEvent::Start, RunPhase::Holding);
    check(RunPhase::Aborting, PhaseEvent::Start, RunPhase::Aborting);
    check(RunPhase::Homing(()), PhaseEvent::Start, RunPhase::Homing(()));
    check(RunPhase::Running, PhaseEvent::Home(()), RunPhase::Running);
    check(RunPhase::Held, PhaseEvent::Home(()), RunPhase::Held);
    check(RunPhase::Idle, PhaseEvent::Hold, RunPhase::Idle);
    check(RunPhase::Homing(()), PhaseEvent::Hold, RunPhase::Aborting);
}
