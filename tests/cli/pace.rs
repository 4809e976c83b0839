//! When the next tick of the control thread is due.

use std::time::Duration;

use kt830::host::pace::{DriftMeter, Pace, TickSchedule, WakeUp};

const TICK: Duration = Duration::from_millis(1);
/// P475 as delivered.
const MAX_STALL: Duration = Duration::from_millis(1_000);

#[test]
fn a_late_tick_of_a_real_machine_is_computed_once() {
    let mut schedule = TickSchedule::new(Pace::Real);
    assert_eq!(schedule.next_due(TICK), Some(TICK));
    assert_eq!(schedule.woke_up(TICK, TICK, MAX_STALL), WakeUp::OnTime);
    // The computer was away for 40 ms: one tick now, and the next one a whole tick later.
    assert_eq!(schedule.next_due(TICK), Some(2 * TICK));
    assert_eq!(schedule.woke_up(42 * TICK, TICK, MAX_STALL), WakeUp::Late);
    assert_eq!(schedule.next_due(TICK), Some(43 * TICK));
}

#[test]
fn ten_late_ticks_in_a_row_are_too_many_on_a_real_machine_only() {
    for (pace, told) in [(Pace::Real, WakeUp::TooOftenLate), (Pace::Simulated, WakeUp::Late)] {
        let mut schedule = TickSchedule::new(pace);
        let mut wake_ups = (0..10).map(|_| {
            let due = std::iter::repeat_with(|| schedule.next_due(TICK)).flatten().next().unwrap();
            schedule.woke_up(due + 30 * TICK, TICK, MAX_STALL)
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
        assert_eq!(schedule.woke_up((16 + behind) * TICK, TICK, MAX_STALL), WakeUp::Late);
        assert!((1..16).all(|_| schedule.next_due(TICK).is_none()), "sixteen ticks a wake-up");
        assert_eq!(schedule.next_due(TICK), Some(due * TICK));
    }
}

/// A process that stood still for longer than P475, once, has a name of its own on every machine.
#[test]
fn b5_a_stall_is_told_once_it_is_longer_than_its_parameter() {
    let ms = Duration::from_millis;
    for (pace, max_stall) in [(Pace::Real, 1_000), (Pace::Simulated, 1_000), (Pace::Real, 100), (Pace::Simulated, 300)]
    {
        for (stall, told) in [(max_stall - 10, WakeUp::Late), (max_stall + 10, WakeUp::Stalled)] {
            let mut schedule = TickSchedule::new(pace);
            let due = schedule.next_due(TICK).unwrap();
            assert_eq!(schedule.woke_up(due + ms(stall), TICK, ms(max_stall)), told, "{pace:?} {stall} ms");
        }
    }
}

/// Clocks that go up to 200 ppm apart, from any phase, with wake-ups that are late as they come: the ticks find the clock
/// of the bus and keep to it.
#[test]
fn p1_ticks_follow_the_clock_of_the_bus() {
    let mut random = 830_u64;
    let mut next = |below: u64| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) % below
    };
    for case in 0..60 {
        let tick = Duration::from_micros([500, 1_000, 2_000][case % 3]);
        let period = tick.as_nanos() as f64;
        let ppm = next(400) as f64 - 200.0;
        let phase = next(tick.as_nanos() as u64) as f64;
        let mut schedule = TickSchedule::new(Pace::Real);
        let (mut meter, mut errors) = (DriftMeter::default(), Vec::new());
        for at in 0..60_000_u32 {
            let due = schedule.next_due(tick).unwrap();
            let late = if next(1_000) == 0 { next(900) } else { next(40) } * 1_000;
            let woke = due + Duration::from_nanos(late);
            schedule.woke_up(woke, tick, MAX_STALL);
            // The clock of the bus at that moment; the frame is asked for in the middle of its cycle.
            let bus = woke.as_nanos() as f64 * (1.0 + ppm * 1e-6) + phase;
            meter.read(woke, bus as u64);
            let error = bus.rem_euclid(period) - period / 2.0;
            schedule.follow(error as i64, tick);
            if at > 30_000 {
                errors.push(error.abs());
            }
        }
        errors.sort_by(f64::total_cmp);
        // Wake-ups vary by 40 µs, so that half of them are within 10 µs of their middle; 200 ppm leave 16 × 0.4 µs.
        let median = errors[errors.len() / 2];
        assert!(median < 20_000.0, "{case}: {tick:?}, {ppm} ppm, {median} ns");
        // The last reading is 30 s or more from the first; a late wake-up of 0.9 ms is no reading of the drift.
        assert!((meter.drift_ppm() - ppm).abs() < 40.0, "{case}: {ppm} ppm, found {}", meter.drift_ppm());
    }
}

/// A wake-up that is late by most of a tick is no error of the clocks.
#[test]
fn p1_a_late_wake_up_moves_the_ticks_by_a_fiftieth_at_most() {
    let tick = Duration::from_millis(1);
    for error_ns in [480_000, -480_000, i64::MAX, i64::MIN] {
        let mut schedule = TickSchedule::new(Pace::Real);
        let first = schedule.next_due(tick).unwrap();
        schedule.follow(error_ns, tick);
        let moved = schedule.next_due(tick).unwrap().as_nanos() as i64 - (first + tick).as_nanos() as i64;
        assert_eq!(moved, -20_000 * error_ns.signum());
    }
}
