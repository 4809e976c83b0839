//! Feed truth at grinding feeds: where the contour allows it the path speed is the programmed feed, and a block takes its
//! length divided by its feed. Source: spec B2 (F, G64).
#![allow(clippy::unwrap_used)] // A test may fail so.

use kt830::motion::{
    ArcDirection, AxisLimits, CornerMode, MotionLimits, MotionSpeed, Move, MoveShape, Override, TrajectoryPlanner,
};
use kt830::units::{MachinePos, PerAxis, Plane};

const TICK_S: f64 = 0.001;
/// Axes as delivered: P30 to P38.
const AXIS: AxisLimits = AxisLimits { velocity_mm_s: 100.0, acceleration_mm_s2: 800.0, jerk_mm_s3: 20_000.0 };
const G64: CornerMode = CornerMode::Continuous { tolerance_mm: 0.01 };
/// Start and stop take the filter's width each: 2 × 18 ticks at 10 µm, and some to gather the moves.
const START_TICKS: u32 = 60;

fn path() -> TrajectoryPlanner {
    TrajectoryPlanner::new(MotionLimits { axes: PerAxis([AXIS; 3]), tick_s: TICK_S }, MachinePos::new([25.0, 0.0, 0.0]))
}

fn line(to: [f64; 3], mm_min: f64, tag: u32) -> Move {
    let speed = MotionSpeed::Feed { mm_s: mm_min / 60.0 };
    Move { to: MachinePos::new(to), shape: MoveShape::Line, speed, corner: G64, tag }
}

/// The set-points until done, with the active tag of each.
fn run(path: &mut TrajectoryPlanner, moves: &[Move]) -> Vec<([f64; 3], Option<u32>)> {
    let (mut trace, mut next) = (vec![(path.position().coordinates(), None)], 0);
    while next < moves.len() || !path.is_done() {
        while path.free_slots() > 0 && next < moves.len() {
            path.push(moves[next]).unwrap();
            next += 1;
        }
        let tag = path.active_tag();
        trace.push((path.tick(Override::FULL).position.coordinates(), tag));
        assert!(trace.len() < 4_000_000, "never done");
    }
    trace
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|x| (a[x] - b[x]).powi(2)).sum::<f64>().sqrt()
}

/// Speeds in mm/min, tick by tick.
fn speeds(trace: &[([f64; 3], Option<u32>)]) -> Vec<f64> {
    trace.windows(2).map(|pair| distance(pair[0].0, pair[1].0) / TICK_S * 60.0).collect()
}

/// X50 to X49.99, X49.98, X49.97 as diameters at F0.05: 5 µm of radius each, 6 s a block.
#[test]
fn b2_collinear_blocks_of_five_micrometres_run_at_their_feed_in_g64() {
    let moves = [24.995, 24.99, 24.985].map(|x| line([x, 0.0, 0.0], 0.05, 1));
    let mut path = path();
    let trace = run(&mut path, &moves);
    let speeds = speeds(&trace);
    let ramp = START_TICKS as usize;
    for (tick, speed) in speeds.iter().enumerate().take(speeds.len() - ramp).skip(ramp) {
        assert!((speed / 0.05 - 1.0).abs() < 0.005, "{speed} mm/min in tick {tick}");
    }
    let seconds = 3.0 * 0.005 / (0.05 / 60.0);
    assert!((speeds.len() as f64 * TICK_S - seconds).abs() < f64::from(START_TICKS) * TICK_S, "{}", speeds.len());
}

/// X49.9 at F0.5, then at F0.2: each block at its own feed.
#[test]
fn b2_a_change_of_feed_takes_effect_at_the_end_of_the_block() {
    let moves = [line([24.95, 0.0, 0.0], 0.5, 1), line([24.9, 0.0, 0.0], 0.2, 2)];
    let mut path = path();
    let trace = run(&mut path, &moves);
    for (tag, feed) in [(1, 0.5), (2, 0.2)] {
        let of_block: Vec<usize> = (1..trace.len()).filter(|at| trace[*at].1 == Some(tag)).collect();
        let ramp = START_TICKS as usize;
        for at in &of_block[ramp..of_block.len() - ramp] {
            let speed = distance(trace[*at].0, trace[at - 1].0) / TICK_S * 60.0;
            assert!((speed / feed - 1.0).abs() < 0.005, "F{feed}: {speed} in tick {at}");
        }
        // 0.05 mm at the feed.
        let seconds = of_block.len() as f64 * TICK_S;
        assert!((seconds - 0.05 / (feed / 60.0)).abs() < f64::from(START_TICKS) * TICK_S, "F{feed}: {seconds} s");
    }
}

/// Blocks of 1 µm at F60, 1 µm a tick: the axes do not stop between them, and every block is reported in order.
#[test]
fn b2_blocks_of_a_micrometre_are_one_motion() {
    let moves: Vec<Move> = (1..=2_000).map(|k| line([25.0, 0.0, f64::from(k) * 0.001], 60.0, k)).collect();
    let mut path = path();
    let trace = run(&mut path, &moves);
    let ticks = trace.len() as f64;
    assert!((2_000.0..2_000.0 + f64::from(START_TICKS)).contains(&ticks), "{ticks}");
    let finished: Vec<u32> = std::iter::from_fn(|| path.pop_finished()).collect();
    assert!(finished.windows(2).all(|pair| pair[1] == pair[0] + 1) && finished.last() == Some(&2_000));
}

/// A slow stage between fast ones: the fast ones end at rest, and the slow one runs at its feed.
#[test]
fn b2_a_slow_block_between_fast_ones_keeps_its_feed() {
    let moves = [
        line([20.0, 0.0, 0.0], 2_000.0, 1),
        line([19.99, 0.0, 0.0], 0.6, 2),
        line([19.98, 0.0, 0.0], 0.3, 3),
        line([19.0, 0.0, 5.0], 2_000.0, 4),
    ];
    let mut path = path();
    let trace = run(&mut path, &moves);
    for (tag, feed) in [(2, 0.6), (3, 0.3)] {
        let of_block: Vec<usize> = (1..trace.len()).filter(|at| trace[*at].1 == Some(tag)).collect();
        let (first, last) = (of_block[START_TICKS as usize], of_block[of_block.len() - START_TICKS as usize]);
        let speed = distance(trace[last].0, trace[first].0) / ((last - first) as f64 * TICK_S) * 60.0;
        assert!((speed / feed - 1.0).abs() < 0.001, "F{feed}: {speed}");
    }
    assert!(distance(path.position().coordinates(), [19.0, 0.0, 5.0]) < 1e-12);
}

/// The feed along an arc, and around a corner of 90°, within 10 µm and never beyond the corner.
#[test]
fn b2_slow_arcs_and_corners_keep_feed_and_tolerance() {
    let arc =
        MoveShape::Arc { center: MachinePos::new([24.0, 0.0, 0.0]), plane: Plane::Zx, direction: ArcDirection::Cw };
    // A quarter turn of 1 mm radius from X25 Z0 to X24 Z1, then on in Z, then a corner towards X.
    let mut moves = [line([24.0, 0.0, 1.0], 60.0, 1), line([24.0, 0.0, 1.1], 60.0, 2), line([23.9, 0.0, 1.1], 60.0, 3)];
    moves[0].shape = arc;
    let mut path = path();
    let trace = run(&mut path, &moves);
    let speeds = speeds(&trace);
    let of_arc = std::f64::consts::FRAC_PI_2 * 1_000.0;
    let ramp = START_TICKS as usize;
    for speed in &speeds[ramp..of_arc as usize - ramp] {
        assert!((speed / 60.0 - 1.0).abs() < 0.005, "{speed}");
    }
    let seconds = speeds.len() as f64 * TICK_S;
    assert!((seconds - (of_arc / 1_000.0 + 0.2)).abs() < f64::from(START_TICKS) * TICK_S, "{seconds}");
    for (point, _) in &trace {
        assert!(point[2] <= 1.1 + 1e-9 && point[0] >= 23.9 - 1e-9, "{point:?}");
        let (x, z) = (point[0], point[2]);
        let on_arc = if x >= 24.0 { ((x - 24.0).hypot(z) - 1.0).abs() } else { f64::INFINITY };
        let on_lines = f64::min((x - 24.0).abs(), (z - 1.1).abs());
        assert!(on_arc.min(on_lines) <= 0.01, "{point:?}");
    }
}

/// The feed is kept from above, too: lines, radii, waves and zigzags at feeds that only some places let the axes reach. A window
/// that begins in motion ran up to 0.8 % faster.
#[test]
fn b2_no_smooth_run_is_faster_than_its_feed() {
    let mut random = 1_u64;
    let mut next = |from: f64, to: f64| {
        // Knuth's linear congruential generator (MMIX).
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        from + (to - from) * ((random >> 11) as f64 / (1_u64 << 53) as f64)
    };
    for contour in 0..100 {
        let (feed, tolerance_mm) = (next(10.0, 80.0), [0.005, 0.01, 0.05][contour % 3]);
        let corner = CornerMode::Continuous { tolerance_mm };
        let (mut at, mut heading, mut moves) = ([25.0, 0.0, 0.0], 0.0_f64, Vec::new());
        let bend = next(0.02, 0.3);
        for tag in 0..80 {
            let length = next(0.5, 4.0);
            heading += match contour % 4 {
                0 => next(-0.5, 0.5),
                1 => bend,
                2 => bend * (f64::from(tag) * 0.3).sin(),
                _ => next(-1.5, 1.5) * f64::from(u8::from(tag % 8 == 0)),
            };
            at = [at[0] + length * heading.sin(), 0.0, at[2] + length * heading.cos()];
            moves.push(Move { corner, ..line(at, feed * 60.0, tag) });
        }
        let mut path = path();
        let trace = run(&mut path, &moves);
        let fastest = speeds(&trace).into_iter().fold(0.0, f64::max) / 60.0;
        assert!(fastest <= feed * 1.005, "contour {contour}: {fastest} mm/s of {feed}");
    }
}

/// A hold in a slow run stops within the filter's width, and the run goes on to its end at its feed.
#[test]
fn b2_a_slow_run_is_held_resumed_and_slowed() {
    let mut path = path();
    for k in 1..=20 {
        path.push(line([25.0 - 0.01 * f64::from(k), 0.0, 0.0], 6.0, k)).unwrap();
    }
    let tick = |path: &mut TrajectoryPlanner, count: u32, factor: f64| {
        for _ in 0..count {
            path.tick(Override { feed: factor, rapid: 1.0 });
        }
    };
    tick(&mut path, 500, 1.0);
    assert!((path.path_speed_mm_s() * 60.0 - 6.0).abs() < 0.03);
    path.hold();
    tick(&mut path, 100, 1.0);
    assert!(path.is_at_rest(), "held within 0.1 s");
    let stood = path.position();
    tick(&mut path, 2_000, 1.0);
    assert_eq!(path.position(), stood);
    path.resume();
    tick(&mut path, 500, 0.5);
    assert!((path.path_speed_mm_s() * 60.0 - 3.0).abs() < 0.03, "{}", path.path_speed_mm_s() * 60.0);
    tick(&mut path, 1_000, 1.2);
    assert!((path.path_speed_mm_s() * 60.0 - 7.2).abs() < 0.04, "{}", path.path_speed_mm_s() * 60.0);
    path.abort();
    tick(&mut path, 100, 1.0);
    assert!(path.is_done(), "an abort discards the rest");
}

/// An S of two quarter turns of 12 mm in chords, the points rounded to a grid, at 100 mm/s.
fn s_in_chords(chord_mm: f64, grid_mm: f64) -> Vec<Move> {
    const RADIUS_MM: f64 = 12.0;
    let count = (std::f64::consts::PI * RADIUS_MM / chord_mm).round();
    let turn = std::f64::consts::FRAC_PI_2;
    let at = |k: f64| {
        let angle = std::f64::consts::PI * k / count;
        let rest = std::f64::consts::PI - angle;
        let (x, z) =
            if angle <= turn { (1.0 - angle.cos(), angle.sin()) } else { (1.0 + rest.cos(), 2.0 - rest.sin()) };
        [25.0 + RADIUS_MM * x, 0.0, RADIUS_MM * z].map(|x| (x / grid_mm).round() * grid_mm)
    };
    (1..=count as u32).map(|k| line(at(f64::from(k)), 6_000.0, k)).collect()
}

/// Lines too short to shape the curve are joined: 5 000 blocks a second and more, from rest to rest, within the tolerance of
/// the programmed points, and each block is reported where the axes pass its end.
#[test]
fn b2_points_of_micrometres_run_at_five_thousand_blocks_a_second_and_more() {
    // 37.7 mm: 18 850 blocks of 2 µm, 3 770 of 10 µm; the last with what a post-processor with three decimals writes.
    for (chord_mm, grid_mm) in [(0.002, 1e-6), (0.01, 1e-6), (0.002, 0.001), (0.01, 0.001)] {
        let moves = s_in_chords(chord_mm, grid_mm);
        let mut path = path();
        let (mut next, mut ticks, mut finished) = (0, 0_u32, 0_usize);
        let (mut passed, mut last) = (0, path.position().coordinates());
        let mut past = [last; 4];
        while next < moves.len() || !path.is_done() {
            // What the reader gives in a tick.
            for _ in 0..path.free_slots().min(16).min(moves.len() - next) {
                path.push(moves[next]).unwrap();
                next += 1;
            }
            let at = path.tick(Override::FULL).position.coordinates();
            ticks += 1;
            past = [past[1], past[2], past[3], at];
            for [a, b, c, d] in (0..3).map(|x| past.map(|point| point[x])) {
                // Differences over a tick, as shares of the limits. Rounding at 50 mm, differenced three times: 1e-5 of the jerk.
                let speed = (d - c) / TICK_S / AXIS.velocity_mm_s;
                let acceleration = (d - 2.0 * c + b) / TICK_S.powi(2) / AXIS.acceleration_mm_s2;
                let jerk = (d - 3.0 * c + 3.0 * b - a) / TICK_S.powi(3) / AXIS.jerk_mm_s3;
                assert!([speed, acceleration, jerk].iter().all(|share| share.abs() <= 1.0 + 1e-5), "tick {ticks}");
            }
            // The nearest end point from the last one on.
            let ahead = passed..moves.len().min(passed + 400);
            let off = |k: &usize| distance(at, moves[*k].to.coordinates());
            passed = ahead.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(passed);
            assert!(off(&passed) <= 0.01 + chord_mm, "{at:?} is {} mm from the contour", off(&passed));
            while let Some(tag) = path.pop_finished() {
                finished += 1;
                assert_eq!(tag as usize, finished, "every block in order");
            }
            // A plan knows at its knots, 4.8 ms apart at 10 µm, which moves have ended.
            let early = finished as f64 - passed as f64;
            let step_mm = distance(at, last);
            assert!(
                early.abs() * chord_mm <= 0.03 + 6.0 * step_mm,
                "{finished} blocks are finished where the axes are at block {passed}, {chord_mm} mm"
            );
            last = at;
        }
        assert_eq!(finished, moves.len());
        let rate = moves.len() as f64 / (f64::from(ticks) * TICK_S);
        assert!(rate >= 5_000.0, "{rate} blocks/s with points of {chord_mm} mm on a grid of {grid_mm} mm");
    }
}

/// The same with a feed hold and another override on the way: no block is lost or reported twice.
#[test]
fn b2_joined_blocks_survive_hold_and_override() {
    let moves = s_in_chords(0.005, 0.001);
    let mut path = path();
    let (mut next, mut ticks, mut finished) = (0, 0_u32, Vec::new());
    while next < moves.len() || !path.is_done() {
        while path.free_slots() > 0 && next < moves.len() {
            path.push(moves[next]).unwrap();
            next += 1;
        }
        match ticks {
            150 | 420 => path.hold(),
            380 | 600 => path.resume(),
            _ => {}
        }
        let feed = if ticks < 250 { 1.0 } else { 1.3 };
        path.tick(Override { feed, rapid: 1.0 });
        ticks += 1;
        assert!(ticks < 10_000, "never done");
        while let Some(tag) = path.pop_finished() {
            finished.push(tag);
        }
    }
    assert_eq!(finished, (1..=moves.len() as u32).collect::<Vec<_>>());
    assert!(distance(path.position().coordinates(), moves[moves.len() - 1].to.coordinates()) < 1e-9);
}
