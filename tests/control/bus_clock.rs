//! The reference clock of the bus jumps: seen in the frame in which it happens, and never because a frame was late.

use kt830::defs::key::Key;
use kt830::io::drive::DriveState;
use kt830::io::fieldbus::ClockReading;
use kt830::io::fieldbus::clock_watch::ClockWatch;
use kt830::io::random::SplitMix64;
use kt830::units::Axis;

use crate::field_bus::Shop;

/// Sent at `sent_ns`, back after `trip_ns`; the clock was passed in between and is `ahead_ns` of this computer.
fn reading(sent_ns: u64, trip_ns: u64, passed_after_ns: u64, ahead_ns: u64) -> ClockReading {
    assert!(passed_after_ns <= trip_ns);
    ClockReading { error_ns: 0, time_ns: sent_ns + passed_after_ns + ahead_ns, sent_ns, received_ns: sent_ns + trip_ns }
}

/// A thousand clocks up to 200 ppm off, with frames that take from 30 µs to 8 ms and cycles that are missed for up to
/// 0.5 s: none has jumped. Then one jumps by more than the last two frames took.
#[test]
fn b8_a_jump_of_the_clock_is_seen_and_a_late_frame_is_none() {
    let mut random = SplitMix64::new(830);
    for case in 0..1_000 {
        let ppm = 400.0 * random.next_unit() - 200.0;
        let mut watch = ClockWatch::default();
        let (mut now, mut trips) = (1_000_000_u64, [0_u64; 2]);
        let mut clock = |sent: u64, jumped: i64, random: &mut SplitMix64| {
            let trip =
                if random.next_unit() < 0.02 { 8e6 * random.next_unit() } else { 30e3 + 60e3 * random.next_unit() }
                    as u64;
            let passed = (random.next_unit() * trip as f64) as u64;
            let ahead = 5e9 + ppm * 1e-6 * (sent + passed) as f64 + jumped as f64;
            trips = [trips[1], trip];
            (reading(sent, trip, passed, ahead as u64), trips[0] + trips[1])
        };
        for frame in 0..500 {
            now += if random.next_unit() < 0.01 { (500e6 * random.next_unit()) as u64 } else { 1_000_000 };
            let (reading, _) = clock(now, 0, &mut random);
            // The next frame leaves when this one is back.
            now = reading.received_ns;
            assert!(!watch.has_jumped(reading), "{case}: frame {frame}");
        }
        now += 1_000_000;
        let (mut read, window) = clock(now, 0, &mut random);
        // Beyond what the times of two frames leave open, and the drift that is let pass: 1000 ppm of 10 ms at most.
        let by = window as i64 + 25_000;
        read.time_ns = read.time_ns.saturating_add_signed(if case % 2 == 0 { by } else { -by });
        assert!(watch.has_jumped(read), "{case}: {by} ns");
        // What follows keeps to the new time.
        watch.forget();
        assert!(!watch.has_jumped(read));
    }
}

#[test]
fn b8_a_clock_that_jumps_stops_the_machine_and_reset_sets_the_clocks_anew() {
    let mut shop = Shop::new(None, 0);
    let tick = |shop: &mut Shop, at: &mut u64, ahead_ns: u64| {
        *at += 1_000_000;
        shop.devices.clock.set(Some(reading(*at, 70_000, 35_000, ahead_ns)));
        shop.ticks(1);
    };
    let mut at = 0;
    for _ in 0..200 {
        tick(&mut shop, &mut at, 7_000_000_000);
    }
    shop.jog(Key::ZPlus, 0);
    for _ in 0..40 {
        tick(&mut shop, &mut at, 7_000_000_000);
    }
    assert!(shop.alarms().is_empty() && !shop.host.controller().is_at_rest());
    tick(&mut shop, &mut at, 7_000_400_000);
    assert_eq!(shop.alarms(), ["402 I/O bus not responding: the clock of the bus has jumped"]);
    for _ in 0..500 {
        tick(&mut shop, &mut at, 7_000_400_000);
    }
    assert!(shop.host.controller().is_at_rest() && !shop.host.trace_row().outputs.drives_on);
    assert_eq!(shop.devices.connected.get(), 1);
    shop.host.send(kt830::link::Command::Release(Key::ZPlus));
    shop.host.send(kt830::link::Command::Press(Key::Reset));
    for _ in 0..200 {
        tick(&mut shop, &mut at, 7_000_400_000);
    }
    assert!(shop.alarms().is_empty(), "{:?}", shop.alarms());
    assert_eq!(shop.devices.connected.get(), 2, "all devices are set up, and their clocks with them");
    assert_eq!(shop.drive(Axis::Z), DriveState::Enabled);
}

/// A clock of 32 bits begins anew every 4.3 s: that is no jump, and a jump beside it is one.
#[test]
fn b8_a_clock_of_32_bits_may_begin_anew() {
    let mut watch = ClockWatch::default();
    let bits_32 = |mut read: ClockReading| {
        read.time_ns %= 1 << 32;
        read
    };
    for tick in 0..20_000_u64 {
        assert!(!watch.has_jumped(bits_32(reading(tick * 1_000_000, 70_000, 35_000, 9_000))), "tick {tick}");
    }
    let mut jumped = bits_32(reading(20_000_000_000, 70_000, 35_000, 9_000));
    jumped.time_ns += 400_000;
    assert!(watch.has_jumped(jumped));
}
