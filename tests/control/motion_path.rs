//! Stories of program motion: strokes, hold, abort, overrides, taking moves back.
#![allow(clippy::unwrap_used, clippy::expect_used)] // A test may fail so.

use kt830::motion::{
    AxisLimits, CornerMode, MAX_QUEUED_MOVES, MAX_WORK_PER_TICK, MotionLimits, MotionSpeed, Move, MoveQueueFull,
    MoveShape, Override, TrajectoryPlanner,
};
use kt830::units::{Axis, MachinePos, PerAxis};

/// Jerk is ample: a stroke is 0.2 s up, 0.8 s along, 0.2 s down, and 5 ms for each change of acceleration.
const AXIS: AxisLimits = AxisLimits { velocity_mm_s: 100.0, acceleration_mm_s2: 500.0, jerk_mm_s3: 100_000.0 };
const FULL: Override = Override::FULL;

fn path() -> TrajectoryPlanner {
    TrajectoryPlanner::new(MotionLimits { axes: PerAxis([AXIS; 3]), tick_s: 0.001 }, MachinePos::new([0.0; 3]))
}

fn line(x: f64, z: f64, tag: u32) -> Move {
    let rate = MotionSpeed::Feed { mm_s: 100.0 };
    Move { to: MachinePos::new([x, 0.0, z]), shape: MoveShape::Line, speed: rate, corner: CornerMode::ExactStop, tag }
}

/// Ticks until done.
fn finish(path: &mut TrajectoryPlanner) -> u32 {
    let mut ticks = 0;
    while !path.is_done() {
        path.tick(FULL);
        ticks += 1;
        assert!(ticks < 1_000_000, "never done");
    }
    ticks
}

fn ticks(path: &mut TrajectoryPlanner, count: u32, requested: Override) {
    for _ in 0..count {
        path.tick(requested);
    }
}

/// Ticks until at rest.
fn ticks_to_rest(path: &mut TrajectoryPlanner) -> u32 {
    (0..5_000)
        .find(|_| {
            let at_rest = path.is_at_rest();
            path.tick(FULL);
            at_rest
        })
        .expect("never at rest")
}

#[test]
fn twenty_strokes_with_infeed_cost_nothing_beyond_their_profiles() {
    let mut path = path();
    for stroke in 0..20_u32 {
        let z = if stroke % 2 == 0 { 100.0 } else { 0.0 };
        let infeed = f64::from(stroke) * 0.002;
        path.push(line(infeed, z, 2 * stroke)).unwrap();
        if stroke < 19 {
            path.push(line(infeed + 0.002, z, 2 * stroke + 1)).unwrap();
        }
    }
    let seconds = f64::from(finish(&mut path)) * 0.001;
    // 20 (100/100 + 100/500 + 500/100000) s, 19 infeeds of 4 (0.002 / (2 · 100000))^(1/3) s; a start on the next tick
    // and one tick at each end: 39 moves.
    let bound = 20.0 * 1.205 + 19.0 * 4.0 * (0.002_f64 / 200_000.0).cbrt();
    assert!(seconds >= bound && seconds < bound + 0.045, "{seconds} s, bound {bound} s");
}

#[test]
fn hold_brakes_in_the_least_time_and_resume_goes_on_to_the_end() {
    let mut path = path();
    path.push(line(0.0, 100.0, 7)).unwrap();
    ticks(&mut path, 500, FULL);
    path.hold();
    // 100 mm/s at 500 mm/s² and 5 ms of jerk: 205 ms; a few ticks for the change to begin and end.
    let braking = ticks_to_rest(&mut path);
    assert!((205..=215).contains(&braking), "{braking} ticks");
    assert!(path.is_holding() && !path.is_done());
    let stood = path.position();
    ticks(&mut path, 100, FULL);
    assert_eq!(path.position(), stood);
    path.resume();
    finish(&mut path);
    assert_eq!(path.position(), MachinePos::new([0.0, 0.0, 100.0]));
    assert_eq!((path.finished_tag(), path.pop_finished(), path.pop_finished()), (Some(7), Some(7), None));
}

#[test]
fn override_nothing_is_a_stop_and_half_is_half_the_speed() {
    let mut path = path();
    path.push(line(0.0, 100.0, 0)).unwrap();
    ticks(&mut path, 600, Override { feed: 0.5, rapid: 1.0 });
    assert!((path.path_speed_mm_s() - 50.0).abs() < 0.1, "{}", path.path_speed_mm_s());
    ticks(&mut path, 300, Override { feed: 0.0, rapid: 1.0 });
    assert!(path.is_at_rest() && !path.is_done() && !path.is_holding());
    finish(&mut path);
}

#[test]
fn override_above_full_raises_a_feed_but_never_an_axis_limit() {
    let mut path = path();
    path.push(Move { speed: MotionSpeed::Feed { mm_s: 40.0 }, ..line(0.0, 100.0, 0) }).unwrap();
    path.push(line(0.0, 0.0, 1)).unwrap();
    ticks(&mut path, 100, FULL);
    ticks(&mut path, 1_200, Override { feed: 1.5, rapid: 1.0 });
    assert!((path.path_speed_mm_s() - 60.0).abs() < 0.1, "{}", path.path_speed_mm_s());
    while path.active_tag() == Some(0) {
        path.tick(Override { feed: 1.5, rapid: 1.0 });
    }
    ticks(&mut path, 500, Override { feed: 1.5, rapid: 1.0 });
    assert!(path.path_speed_mm_s() <= 100.0, "{}", path.path_speed_mm_s());
}

#[test]
fn abort_brakes_forgets_and_reports_nothing() {
    let mut path = path();
    for tag in 0..3 {
        path.push(line(0.0, if tag % 2 == 0 { 100.0 } else { 0.0 }, tag)).unwrap();
    }
    ticks(&mut path, 500, FULL);
    path.abort();
    assert_eq!((path.free_slots(), path.push(line(0.0, 0.0, 9))), (0, Err(MoveQueueFull)));
    while !path.is_done() {
        path.tick(FULL);
    }
    assert_eq!((path.finished_tag(), path.remaining_moves(), path.is_holding()), (None, 0, false));
    assert!(path.position()[Axis::Z] < 75.0, "{:?}", path.position());
    path.push(line(0.0, 0.0, 10)).unwrap();
    finish(&mut path);
    assert_eq!(path.position(), MachinePos::new([0.0; 3]));
}

#[test]
fn moves_taken_back_in_a_hold_lead_on_from_where_the_handwheel_left_the_axis() {
    let mut path = path();
    for (tag, z) in [(1, 50.0), (2, 80.0), (3, 0.0)] {
        path.push(line(0.0, z, tag)).unwrap();
    }
    while path.active_tag() != Some(2) {
        path.tick(FULL);
    }
    ticks(&mut path, 50, FULL);
    path.hold();
    ticks_to_rest(&mut path);
    assert_eq!((path.active_tag(), path.remaining_moves()), (Some(2), 2));
    path.discard_moves();
    assert_eq!((path.active_tag(), path.remaining_moves()), (None, 0));
    let [_, _, z] = path.position().coordinates();
    path.reset_to(MachinePos::new([1.0, 0.0, z]));
    for (tag, z) in [(2, 80.0), (3, 0.0)] {
        path.push(line(0.0, z, tag)).unwrap();
    }
    ticks(&mut path, 50, FULL);
    assert_eq!(path.position(), MachinePos::new([1.0, 0.0, z]), "still held");
    path.resume();
    finish(&mut path);
    assert_eq!((path.position(), path.finished_tag()), (MachinePos::new([0.0; 3]), Some(3)));
}

#[test]
fn moves_of_no_length_finish_at_once_and_are_reported() {
    let mut path = path();
    for tag in 0..3 {
        path.push(line(0.0, 0.0, tag)).unwrap();
    }
    path.tick(FULL);
    assert!(path.is_done());
    assert_eq!([path.pop_finished(), path.pop_finished(), path.pop_finished()], [Some(0), Some(1), Some(2)]);
}

#[test]
fn a_full_queue_refuses() {
    let mut path = path();
    for tag in 0..MAX_QUEUED_MOVES as u32 {
        path.push(line(0.0, f64::from(tag + 1), tag)).unwrap();
    }
    assert_eq!((path.free_slots(), path.push(line(0.0, 0.0, 0))), (0, Err(MoveQueueFull)));
}

/// Short moves are queued in thousands, so that they do not run out; long ones are not, so that what is changed in a program
/// acts soon: no more than 256 of them, or two seconds.
#[test]
fn more_moves_are_queued_where_they_are_short() {
    // 1 mm at 100 mm/s is 10 ms, and 2 µm 20 µs.
    for (length_mm, expected) in [(1.0, 256), (0.002, MAX_QUEUED_MOVES)] {
        let mut path = path();
        let mut count = 0_u32;
        while path.free_slots() > 0 {
            count += 1;
            path.push(line(0.0, length_mm * f64::from(count), count)).unwrap();
        }
        assert_eq!(count as usize, expected, "{length_mm} mm");
    }
}

#[test]
fn distance_to_go_is_to_the_end_of_the_active_move() {
    let mut path = path();
    path.push(line(0.0, 100.0, 0)).unwrap();
    path.push(line(0.0, 30.0, 1)).unwrap();
    ticks(&mut path, 300, FULL);
    let ([_, _, at], PerAxis([_, _, to_go])) = (path.position().coordinates(), path.distance_to_go());
    assert!((at + to_go - 100.0).abs() < 1e-12);
}

/// A quarter of a circle of 20 mm in chords of 1°, sagitta 0.8 µm.
fn chords(path: &mut TrajectoryPlanner) {
    for k in 1..=90_u32 {
        let (sin, cos) = f64::from(k).to_radians().sin_cos();
        let end = CornerMode::Continuous { tolerance_mm: 0.01 };
        path.push(Move { corner: end, ..line(20.0 - 20.0 * cos, 20.0 * sin, k) }).unwrap();
    }
}

#[test]
fn short_chords_are_one_curve_and_every_tag_is_reported_in_order() {
    let mut path = path();
    chords(&mut path);
    let mut slowest = f64::INFINITY;
    let mut tags = Vec::new();
    while !path.is_done() {
        path.tick(FULL);
        tags.extend(path.pop_finished());
        if matches!(path.active_tag(), Some(20..=70)) {
            slowest = slowest.min(path.path_speed_mm_s());
        }
    }
    // √(a r) = 100 mm/s at 500 mm/s² on 20 mm; a stop would be 0.
    assert!(slowest > 50.0, "{slowest} mm/s");
    assert_eq!(tags, (1..=90).collect::<Vec<_>>());
}

#[test]
fn hold_in_a_curve_comes_to_rest_soon() {
    let mut path = path();
    chords(&mut path);
    while path.active_tag() < Some(45) {
        path.tick(FULL);
    }
    path.hold();
    // From 100 mm/s at half of 500 mm/s², the other half bending the path: 400 ms.
    let braking = ticks_to_rest(&mut path);
    assert!(braking < 500, "{braking} ticks");
    path.resume();
    finish(&mut path);
}

/// Holds at many moments of a run along `points` at 100 mm/s: the way to rest, and that from the same speed on a line, mm.
fn ways_to_rest(points: &[[f64; 2]]) -> Vec<(f64, f64)> {
    let axis = AxisLimits { velocity_mm_s: 200.0, acceleration_mm_s2: 1_500.0, jerk_mm_s3: 20_000.0 };
    let limits = MotionLimits { axes: PerAxis([axis; 3]), tick_s: 0.001 };
    let mut path = TrajectoryPlanner::new(limits, MachinePos::new([points[0][0], 0.0, points[0][1]]));
    let mut rest = points[1..].iter();
    let corner = CornerMode::Continuous { tolerance_mm: 0.01 };
    let fill = |path: &mut TrajectoryPlanner, rest: &mut std::slice::Iter<'_, [f64; 2]>| {
        while path.free_slots() > 0
            && let Some([x, z]) = rest.next()
        {
            path.push(Move { corner, ..line(*x, *z, 0) }).unwrap();
        }
    };
    let (mut ways, mut tick) = (Vec::new(), 0);
    while tick == 0 || !path.is_done() {
        fill(&mut path, &mut rest);
        let before = path.path_speed_mm_s();
        path.tick(FULL);
        tick += 1;
        let speed = path.path_speed_mm_s();
        if tick % 37 == 0 && speed > 5.0 && speed <= before {
            let (mut held, mut rest, mut way) = (path.clone(), rest.clone(), 0.0);
            held.hold();
            while !held.is_at_rest() {
                fill(&mut held, &mut rest);
                held.tick(FULL);
                way += held.path_speed_mm_s() * 0.001;
            }
            let (a, j) = (axis.acceleration_mm_s2, axis.jerk_mm_s3);
            let time = if speed >= a * a / j { speed / a + a / j } else { 2.0 * (speed / j).sqrt() };
            ways.push((way, speed * time / 2.0));
        }
    }
    ways
}

#[test]
fn b2_a_run_resumes_at_once_whatever_the_hold_has_tried() {
    let mut path = path();
    let end = CornerMode::Continuous { tolerance_mm: 0.01 };
    for k in 1..=200 {
        path.push(Move { corner: end, ..line(0.0, f64::from(k), k) }).unwrap();
    }
    ticks(&mut path, 400, FULL);
    for _ in 0..60 {
        ticks(&mut path, 7, FULL);
        let mut held = path.clone();
        held.hold();
        ticks_to_rest(&mut held);
        held.resume();
        let start = (0..).find(|_| held.tick(FULL).velocity_mm_s[Axis::Z] >= 97.0).unwrap();
        // 100 mm/s at 500 mm/s², and 5 ms for the jerk: 205 ms; twice that where little of the run is on the buffer.
        assert!(start <= 410, "{start} ticks");
    }
}

#[test]
fn b2_a_hold_in_chords_at_their_limits_brakes_nearly_as_on_a_line() {
    // Before, no change of rate was found there and the plan was run to its end: up to 18 times the way on a line.
    for chord in [0.02, 0.1, 0.5, 2.0] {
        let along = |at: f64| (0..=(80.0 / chord) as u32).map(move |k| f64::from(k) * chord * at);
        let zigzag: Vec<_> = along(1.0).map(|z| [4.0 * (z / 20.0 - (z / 20.0 + 0.5).floor()).abs(), z]).collect();
        let arc: Vec<_> = along(1.0 / 12.0).map(|turn| [12.0 * turn.cos(), 12.0 * turn.sin()]).collect();
        for (name, points) in [("zigzag", zigzag), ("arc", arc)] {
            // Braking in a bend or a corner takes longer than on a line: the axis that turns needs its jerk for that.
            for (way, line) in ways_to_rest(&points) {
                assert!(way <= 1.5 * line + 2.0, "{name} of {chord} mm: {way:.2} mm, {line:.2} on a line");
            }
        }
    }
}

/// A sine of 5 mm over `count` chords of 0.1 mm along Z, fed as room allows; calls `see` after every tick.
fn sine(path: &mut TrajectoryPlanner, count: u32, mut see: impl FnMut(&TrajectoryPlanner)) {
    let end = CornerMode::Continuous { tolerance_mm: 0.01 };
    let at = |k: u32| (5.0 * (f64::from(k) / 60.0).sin(), 0.1 * f64::from(k));
    let mut next = 1;
    while next <= count || !path.is_done() {
        while path.free_slots() > 0 && next <= count {
            let (x, z) = at(next);
            path.push(Move { corner: end, ..line(x, z, next) }).unwrap();
            next += 1;
        }
        path.tick(FULL);
        see(path);
    }
}

#[test]
fn two_thousand_chords_never_rest_between_the_first_and_the_last() {
    let mut path = path();
    let mut started = false;
    let mut rests = 0;
    sine(&mut path, 2_000, |path| {
        started |= path.path_speed_mm_s() > 0.0;
        rests += u32::from(started && !path.is_done() && path.path_speed_mm_s() <= 0.0);
    });
    // At the very end a plan stands for a few ticks until the last difference is nothing.
    assert!(rests <= 8, "{rests} ticks at rest");
}

#[test]
fn override_above_full_reaches_a_smooth_run_within_a_second() {
    let mut path = path();
    let end = CornerMode::Continuous { tolerance_mm: 0.01 };
    let rate = MotionSpeed::Feed { mm_s: 40.0 };
    let mut next = 0_u32;
    let mut run = |path: &mut TrajectoryPlanner, count: u32, feed: f64| {
        for _ in 0..count {
            while path.free_slots() > 0 {
                next += 1;
                let z = 0.5 * f64::from(next);
                path.push(Move { corner: end, speed: rate, ..line(5.0 * (z / 12.0).sin(), z, next) }).unwrap();
            }
            path.tick(Override { feed, rapid: 1.0 });
        }
        path.path_speed_mm_s()
    };
    let speed = run(&mut path, 1_000, 1.0);
    assert!((speed - 40.0).abs() < 1.0, "{speed} mm/s");
    let speed = run(&mut path, 1_000, 1.5);
    assert!((speed - 60.0).abs() < 1.5, "{speed} mm/s");
    // Down it acts at once: 10 mm/s at half of 500 mm/s² are 40 ms.
    let speed = run(&mut path, 150, 1.25);
    assert!((speed - 50.0).abs() < 1.5, "{speed} mm/s");
}

#[test]
fn planning_is_spread_over_ticks_and_the_start_does_not_wait_long() {
    let mut path = path();
    let (mut ticks, mut waited, mut most) = (0_u32, None, 0);
    sine(&mut path, 600, |path| {
        ticks += 1;
        most = most.max(path.work_of_last_tick());
        if path.path_speed_mm_s() > 0.0 && waited.is_none() {
            waited = Some(ticks);
        }
    });
    assert!(most <= MAX_WORK_PER_TICK, "{most} units in a tick");
    assert!(waited <= Some(35), "first movement in tick {waited:?}");
}

#[test]
fn b2_strokes_with_rounded_corners_meet_their_ends_and_never_go_beyond() {
    // Beside the way back every point is near the contour; the end itself must be met within the tolerance, too.
    let strokes = [(0.01, 0.002), (0.01, 0.0005), (0.05, 0.004), (0.005, 0.001), (0.002, 0.001)];
    // The step between two strokes is square, or a point of two moves that stands out by half its length.
    for ((tolerance_mm, pitch_mm), point_mm) in strokes.into_iter().flat_map(|s| [(s, 0.0), (s, s.1 / 2.0)]) {
        let mut path = path();
        let corner = CornerMode::Continuous { tolerance_mm };
        for stroke in 0..12_u32 {
            let x = if stroke % 2 == 0 { 50.0 } else { 0.0 };
            let z = f64::from(stroke) * -pitch_mm;
            let outward = if stroke % 2 == 0 { point_mm } else { -point_mm };
            path.push(Move { corner, ..line(x, z, 3 * stroke) }).unwrap();
            path.push(Move { corner, ..line(x + outward, z - pitch_mm / 2.0, 3 * stroke + 1) }).unwrap();
            path.push(Move { corner, ..line(x, z - pitch_mm, 3 * stroke + 2) }).unwrap();
        }
        // A stroke has ended where the axis has come back by 5 mm.
        let (mut extreme, mut sign, mut turns) = (0.0_f64, 1.0, Vec::new());
        while !path.is_done() {
            let x = path.tick(FULL).position.coordinates()[0];
            assert!((-point_mm - 1e-6..=50.0 + point_mm + 1e-6).contains(&x), "{x}");
            if sign * (x - extreme) > 0.0 {
                extreme = x;
            } else if (x - extreme).abs() > 5.0 {
                turns.push(extreme);
                (extreme, sign) = (x, -sign);
            }
        }
        assert_eq!(turns.len(), 11, "{turns:?}");
        for turn in turns {
            let missed = (turn + point_mm).min(50.0 + point_mm - turn);
            assert!(
                missed <= tolerance_mm,
                "{missed} mm from the end at {tolerance_mm} mm, strokes {pitch_mm} mm apart, {point_mm} out"
            );
        }
    }
}
