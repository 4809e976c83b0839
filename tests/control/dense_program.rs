//! Programs of dense points: their rate in blocks a second, and what a hold, the hand and single block do in them.
//! Source: spec B2 (G64), B5, K6.3.

use std::fmt::Write;

use kt830::host::headless::HeadlessHost;
use kt830::units::Axis;

use crate::stories::{ready_with, tell};

/// Radius of the two arcs, mm.
const RADIUS_MM: f64 = 12.0;
/// The start, X as a radius; the machine is ready there.
const START: [f64; 2] = [-40.0, -150.0];

/// An S of two quarter turns from X-80 Z-150 in chords at F6000, with this many decimals.
fn s_in_chords(chord_mm: f64, decimals: usize) -> (String, usize) {
    let half_turn = std::f64::consts::PI;
    let count = (half_turn * RADIUS_MM / chord_mm).round() as usize;
    let mut text = String::from("G64 G98 G01 F6000\n");
    for k in 1..=count {
        let angle = half_turn * k as f64 / count as f64;
        let rest = half_turn - angle;
        let (x, z) = if angle <= half_turn / 2.0 {
            (1.0 - angle.cos(), angle.sin())
        } else {
            (1.0 + rest.cos(), 2.0 - rest.sin())
        };
        let (x, z) = (2.0 * (START[0] + RADIUS_MM * x), START[1] + RADIUS_MM * z);
        writeln!(text, "X{x:.decimals$} Z{z:.decimals$}").unwrap();
    }
    (text + "M30\n", count)
}

/// Machine coordinates of X (radius) and Z.
fn place(rig: &HeadlessHost) -> [f64; 2] {
    let at = rig.controller().outputs().set_point_mm;
    [at[Axis::X], at[Axis::Z]]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Distance of a place from the S that begins at `from`, mm.
fn off_contour(from: [f64; 2], at: [f64; 2]) -> f64 {
    let (x, z) = (at[0] - from[0], at[1] - from[1]);
    // First arc: centre (R, 0) from (0, 0) to (R, R); second: centre (R, 2R) from (R, R) to (2R, 2R).
    let first = ((x - RADIUS_MM).hypot(z) - RADIUS_MM).abs();
    let second = ((x - RADIUS_MM).hypot(z - 2.0 * RADIUS_MM) - RADIUS_MM).abs();
    if z <= RADIUS_MM { first } else { second }
}

/// Ticks from the first changed set-point to the last, of a run that is started here.
fn ticks_in_motion(rig: &mut HeadlessHost) -> usize {
    tell(rig, "mode auto\nkey cycle-start");
    let (mut last, mut first_tick, mut last_tick) = (place(rig), None, 0);
    for tick in 0..60_000 {
        rig.step();
        let at = place(rig);
        if distance(at, last) > 0.0 {
            first_tick = first_tick.or(Some(tick));
            last_tick = tick;
        }
        if first_tick.is_some() && tick > last_tick + 500 {
            break;
        }
        last = at;
    }
    last_tick - first_tick.unwrap() + 1
}

#[test]
fn b2_a_program_of_points_of_micrometres_runs_at_five_thousand_blocks_a_second_and_more() {
    for (chord_mm, decimals) in [(0.002, 6), (0.01, 6), (0.01, 3)] {
        let (text, blocks) = s_in_chords(chord_mm, decimals);
        let mut rig = ready_with(&text);
        let ticks = ticks_in_motion(&mut rig);
        tell(&mut rig, "expect no alarm\nexpect X -32 ±0.001\nexpect Z -126 ±0.001");
        let rate = blocks as f64 / (ticks as f64 / 1_000.0);
        assert!(rate >= 5_000.0, "{rate} blocks/s with chords of {chord_mm} mm, {decimals} decimals");
    }
}

/// A hold in dense points, moved axes, and the rest: what is programmed as places is reached, along the contour.
#[test]
fn k6_3_a_held_run_of_dense_points_returns_to_its_contour() {
    let (text, _) = s_in_chords(0.005, 6);
    for hold_ms in [150, 275, 400] {
        let mut rig = ready_with(&text);
        let from = place(&rig);
        tell(&mut rig, &format!("mode auto\nkey cycle-start\nwait {hold_ms} ms\nkey feed-hold\nwait 0.3 s"));
        tell(&mut rig, "expect state held\nhandwheel X -10 x0.1\nwait 0.5 s");
        let held = place(&rig);
        tell(&mut rig, "mode auto\nkey cycle-start");
        let (mut back_mm, mut off_mm): (f64, f64) = (0.0, 0.0);
        for _ in 0..3_000 {
            rig.step();
            let at = place(&rig);
            back_mm = back_mm.max(held[1] - at[1]);
            // The way back to the contour is one block long.
            if at[1] > held[1] + 0.05 {
                off_mm = off_mm.max(off_contour(from, at));
            }
        }
        tell(&mut rig, "expect state idle\nexpect no alarm\nexpect X -32 ±0.001\nexpect Z -126 ±0.001");
        assert!(back_mm < 0.01, "{back_mm} mm back after {hold_ms} ms");
        assert!(off_mm < 0.012, "{off_mm} mm beside the contour after {hold_ms} ms");
    }
}

/// Single block in dense points stops on the contour and goes on from there: nothing is run back, nothing left out.
#[test]
fn b5_single_block_in_dense_points_never_runs_back() {
    let (text, _) = s_in_chords(0.005, 6);
    for stop_ms in [150, 275, 400] {
        let mut rig = ready_with(&text);
        let from = place(&rig);
        tell(&mut rig, &format!("mode auto\nkey cycle-start\nwait {stop_ms} ms\nkey single-block"));
        let (mut farthest, mut back_mm): (f64, f64) = (f64::MIN, 0.0);
        let mut watch = |rig: &mut HeadlessHost, ticks: usize| {
            for _ in 0..ticks {
                rig.step();
                let at = place(rig);
                back_mm = back_mm.max(farthest - at[1]);
                farthest = farthest.max(at[1]);
                assert!(off_contour(from, at) < 0.012, "{at:?} is {} mm beside the contour", off_contour(from, at));
            }
        };
        watch(&mut rig, 500);
        tell(&mut rig, "expect state stopped");
        for _ in 0..3 {
            tell(&mut rig, "key cycle-start");
            watch(&mut rig, 300);
            tell(&mut rig, "expect state stopped");
        }
        tell(&mut rig, "key single-block\nkey cycle-start");
        watch(&mut rig, 3_000);
        tell(&mut rig, "expect state idle\nexpect no alarm\nexpect X -32 ±0.001\nexpect Z -126 ±0.001");
        // The stop may be as far beside the contour as the tolerance allows.
        assert!(back_mm < 0.01, "{back_mm} mm back after {stop_ms} ms");
    }
}

/// A hold names the block at which the axes stand, and what the passed blocks assign is done. Single block in the hold goes
/// on with the rest of that block, not with all that was planned.
#[test]
fn b5_a_hold_in_dense_points_shows_the_block_of_the_axes_and_single_block_goes_on_from_it() {
    let (text, _) = s_in_chords(0.005, 6);
    let mut text: Vec<String> = text.lines().map(str::to_owned).collect();
    text.insert(0, "#500=0".to_owned());
    let text: Vec<String> =
        text.into_iter().map(|line| if line.starts_with('X') { line + "\n#500=#500+1" } else { line }).collect();
    let mut rig = ready_with(&text.join("\n"));
    let from = place(&rig);
    tell(&mut rig, "mode auto\nkey cycle-start\nwait 275 ms\nkey feed-hold\nwait 1 s\nexpect state held");
    // Where the axes stand, as the number of chords along the S.
    let at = place(&rig);
    let angle = |at: [f64; 2]| {
        let (x, z) = (at[0] - from[0], at[1] - from[1]);
        if z <= RADIUS_MM {
            z.atan2(RADIUS_MM - x)
        } else {
            std::f64::consts::PI - (2.0 * RADIUS_MM - z).atan2(x - RADIUS_MM)
        }
    };
    let stands = angle(at) * RADIUS_MM / 0.005;
    let counted = |rig: &HeadlessHost| rig.controller().variable(500).unwrap();
    // A joined line is half a knot, some 0.2 mm at this speed.
    assert!(
        (counted(&rig) - stands).abs() < 60.0,
        "{} assignments where the axes are at block {stands}",
        counted(&rig)
    );
    let line = f64::from(rig.controller().current_block().line);
    assert!((line / 2.0 - stands).abs() < 60.0, "line {line} where the axes are at block {stands}");
    tell(&mut rig, "key single-block\nkey cycle-start\nwait 0.5 s\nexpect state stopped");
    assert!(distance(place(&rig), at) < 0.02, "one block: {} mm", distance(place(&rig), at));
    for _ in 0..5 {
        let before = place(&rig);
        tell(&mut rig, "key cycle-start\nwait 0.3 s\nexpect state stopped");
        let way = distance(place(&rig), before);
        assert!(way < 0.011, "{way} mm");
    }
    assert!(distance(place(&rig), at) > 0.005, "it goes on");
    tell(
        &mut rig,
        "key single-block\nkey cycle-start\nwait until idle max 20 s\nexpect no alarm\nexpect Z -126 ±0.001",
    );
    assert!((counted(&rig) - (std::f64::consts::PI * RADIUS_MM / 0.005).round()).abs() < 0.5, "{}", counted(&rig));
}
