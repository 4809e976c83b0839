//! When the next tick of the control thread is due.

use std::time::Duration;

use kt830::host::pace::{Pace, TickSchedule, WakeUp};

const TICK: Duration = Duration::from_millis(1);

#[test]
fn a_late_tick_of_a_real_machine_is_computed_once() {
    let mut schedule = TickSchedule::new(Pace::Real);
    assert_eq!(schedule.next_due(TICK), Some(TICK));
    assert_eq!(schedule.woke_up(TICK, TICK), WakeUp::OnTime);
    // The computer was away for 40 ms: one tick now, and the next one a whole tick later.
    assert_eq!(schedule.next_due(TICK), Some(2 * TICK));
    assert_eq!(schedule.woke_up(42 * TICK, TICK), WakeUp::Late);
    assert_eq!(schedule.next_due(TICK), Some(43 * TICK));
}

#[test]
fn ten_late_ticks_in_a_row_are_too_many_on_a_real_machine_only() {
    for (pace, told) in [(Pace::Real, WakeUp::TooOftenLate), (Pace::Simulated, WakeUp::Late)] {
        let mut schedule = TickSchedule::new(pace);
        let mut wake_ups = (0..10).map(|_| {
            let due = std::iter::repeat_with(|| schedule.next_due(TICK)).flatten().next().unwrap();
            schedule.woke_up(due + 30 * TICK, TICK)
        });
        assert!(wake_ups.by_ref().take(9).all(|wake_up| wake_up == WakeUp::Late), "{pace:?}");
        assert_eq!(wake_ups.next(), Some(told));
    }
}

#[test]
fn a_simulated_machine_makes_up_for_fifty_ticks_and_drops_more() {
    for (behind, due) in [(49, 32), (51, 16 + 51 + 16)] {
        let mut schedule = TickSchedule::new(Pace::Simulated);
        assert_eq!(schedule.next_due(TICK), Some(16 * TICK));
        assert_eq!(schedule.woke_up((16 + behind) * TICK, TICK), WakeUp::Late);
        assert!((1..16).all(|_| schedule.next_due(TICK).is_none()), "sixteen ticks a wake-up");
        assert_eq!(schedule.next_due(TICK), Some(due * TICK));
    }
}

/// A process that stood still for more than a second, once, has a name of its own on every machine.
#[test]
fn b5_a_stall_is_told_once_it_is_longer_than_a_second() {
    for pace in [Pace::Real, Pace::Simulated] {
        let mut schedule = TickSchedule::new(pace);
        let due = schedule.next_due(TICK).unwrap();
        assert_eq!(schedule.woke_up(due + Duration::from_millis(990), TICK), WakeUp::Late, "{pace:?}");
        let mut schedule = TickSchedule::new(pace);
        let due = schedule.next_due(TICK).unwrap();
        assert_eq!(schedule.woke_up(due + Duration::from_millis(1_010), TICK), WakeUp::Stalled, "{pace:?}");
    }
}
