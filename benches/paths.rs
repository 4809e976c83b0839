//! Runs ten thousand short moves, then random contours and the benchmark paths, and compares their time with the optimum.
//!
//! The random contours are those of `contours/`. `KT830_WRITE_CONTOURS=DIR` writes them for the solver instead.
//! Reads every `*.json` in the folder named by `KT830_BENCH_PATHS`; prints name, seconds and the ratio to the
//! jerk-limited optimum. Fails if a limit or the tolerance is exceeded in any tick, or if a path `a…` exceeds 1.20.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

mod contours;

use kt830::motion::{AxisLimits, CornerMode, MotionLimits, MotionSpeed, Move, MoveShape, Override, TrajectoryPlanner};
use kt830::units::{MachinePos, PerAxis};
use serde_json::Value;
use std::time::Instant;

/// Relative tolerance of the checks: rounding at 300 mm, differenced three times over 1 ms, gives 5e-4 mm/s³.
const SLACK: f64 = 1e-6;
/// How much faster than the feed the axes may be.
const FEED_SLACK: f64 = 0.005;
const MAX_TICKS: u32 = 200_000;
/// Number of seeds of each class.
const SEEDS: u32 = 6;
/// Runs of each path; the shortest duration of each tick counts.
const RUNS: u32 = 5;

fn distance_to_line(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> f64 {
    let (dx, dz) = (b[0] - a[0], b[1] - a[1]);
    let square = dx * dx + dz * dz;
    let t = if square > 0.0 { (((p[0] - a[0]) * dx + (p[1] - a[1]) * dz) / square).clamp(0.0, 1.0) } else { 0.0 };
    (p[0] - a[0] - t * dx).hypot(p[1] - a[1] - t * dz)
}

/// Returns seconds, ratio, and whether all limits were kept. `costs` keeps the least duration of each tick, µs.
fn run(value: &Value, costs: &mut Vec<f64>, say: bool) -> (f64, Option<f64>, bool) {
    let number = |v: &Value| v.as_f64().unwrap();
    let limit = |name: &str, k: usize| number(&value["limits"][name][k]);
    let axis =
        |k| AxisLimits { velocity_mm_s: limit("v", k), acceleration_mm_s2: limit("a", k), jerk_mm_s3: limit("j", k) };
    let (x, z) = (axis(0), axis(1));
    let limits = MotionLimits { axes: PerAxis([x, x, z]), tick_s: 0.001 };
    let tolerance_mm = number(&value["limits"]["tol"]);
    let mm_s = number(&value["limits"]["feed"]);
    let points: Vec<[f64; 2]> =
        value["points"].as_array().unwrap().iter().map(|p| [number(&p[0]), number(&p[1])]).collect();
    let mut path = TrajectoryPlanner::new(limits, MachinePos::new([points[0][0], 0.0, points[0][1]]));
    let mut moves = points[1..].iter().map(|p| Move {
        to: MachinePos::new([p[0], 0.0, p[1]]),
        shape: MoveShape::Line,
        speed: MotionSpeed::Feed { mm_s },
        corner: CornerMode::Continuous { tolerance_mm },
        tag: 0,
    });
    let start = path.position().coordinates();
    let mut past = [start; 4];
    let (mut kept, mut worst, mut ticks, mut fastest) = (true, [0.0_f64; 4], 0, 0.0_f64);
    let mut waited = None;
    while ticks == 0 || (!path.is_done() && ticks < MAX_TICKS) {
        while path.free_slots() > 0
            && let Some(m) = moves.next()
        {
            path.push(m).unwrap();
        }
        let before = Instant::now();
        let p = path.tick(Override::FULL).position.coordinates();
        let spent = before.elapsed().as_secs_f64() * 1e6;
        // The same calls do the same work, so a longer duration in one run comes from elsewhere.
        match costs.get_mut(ticks as usize) {
            Some(cost) => *cost = cost.min(spent),
            None => costs.push(spent),
        }
        ticks += 1;
        if path.path_speed_mm_s() > 0.0 && waited.is_none() {
            waited = Some(ticks);
        }
        past = [past[1], past[2], past[3], p];
        fastest = fastest.max(path.path_speed_mm_s() / mm_s);
        for (k, l) in [(0, x), (2, z)] {
            let v = (past[3][k] - past[2][k]) * 1e3 / l.velocity_mm_s;
            let a = (past[3][k] - 2.0 * past[2][k] + past[1][k]) * 1e6 / l.acceleration_mm_s2;
            let j = (past[3][k] - 3.0 * (past[2][k] - past[1][k]) - past[0][k]) * 1e9 / l.jerk_mm_s3;
            worst = [worst[0].max(v.abs()), worst[1].max(a.abs()), worst[2].max(j.abs()), worst[3]];
        }
        let off = points.windows(2).map(|w| distance_to_line(w[0], w[1], [p[0], p[2]])).fold(f64::INFINITY, f64::min);
        worst[3] = worst[3].max(off / tolerance_mm);
    }
    kept &= worst.iter().all(|w| *w <= 1.0 + SLACK) && fastest <= 1.0 + FEED_SLACK && path.is_done();
    let end = points[points.len() - 1];
    kept &= (past[3][0] - end[0]).hypot(past[3][2] - end[1]) <= 1e-9;
    if !kept {
        println!("  used {worst:.4?} feed {fastest:.4}");
    }
    if say {
        let mean = costs.iter().sum::<f64>() / costs.len() as f64;
        costs.sort_by(f64::total_cmp);
        let part = |share: f64| costs[((costs.len() - 1) as f64 * share) as usize];
        println!(
            "  used v {:.4} a {:.4} j {:.4} tolerance {:.3} feed {fastest:.4}; starts in tick {}",
            worst[0],
            worst[1],
            worst[2],
            worst[3],
            waited.unwrap_or(0)
        );
        println!("  tick mean {mean:.1} µs, p50 {:.1}, p99.9 {:.1}, worst {:.1}", part(0.5), part(0.999), part(1.0));
    }
    let seconds = f64::from(ticks) * 0.001;
    let ratio = value["seconds"]["jerk_limited_optimum"].as_f64().map(|least| seconds / least);
    (seconds, ratio, kept)
}

/// Tick duration for ten thousand chords of 0.3 mm along a wave at 40 mm/s, axes as delivered (P30–P38).
fn many_moves() {
    const MOVES: u32 = 10_000;
    let axis = |v| AxisLimits { velocity_mm_s: v, acceleration_mm_s2: 800.0, jerk_mm_s3: 20_000.0 };
    let limits = MotionLimits { axes: PerAxis([axis(100.0), axis(100.0), axis(10_000.0 / 60.0)]), tick_s: 0.001 };
    let mut costs: Vec<f64> = Vec::new();
    for _ in 0..RUNS {
        let mut path = TrajectoryPlanner::new(limits, MachinePos::new([0.0; 3]));
        let (mut next, mut ticks, mut rests) = (0_u32, 0, 0);
        while next < MOVES || !path.is_done() {
            while path.free_slots() > 0 && next < MOVES {
                next += 1;
                let z = 0.3 * f64::from(next);
                let end = CornerMode::Continuous { tolerance_mm: 0.01 };
                let to = MachinePos::new([5.0 * (z / 8.0).sin(), 0.0, z]);
                path.push(Move {
                    to,
                    shape: MoveShape::Line,
                    speed: MotionSpeed::Feed { mm_s: 40.0 },
                    corner: end,
                    tag: next,
                })
                .unwrap();
            }
            let before = Instant::now();
            path.tick(Override::FULL);
            let spent = before.elapsed().as_secs_f64() * 1e6;
            match costs.get_mut(ticks) {
                Some(cost) => *cost = cost.min(spent),
                None => costs.push(spent),
            }
            ticks += 1;
            rests += u32::from(ticks > 200 && !path.is_done() && path.path_speed_mm_s() <= 0.0);
        }
        assert!(rests <= 8, "{rests} ticks at rest");
    }
    let seconds = costs.len() as f64 * 0.001;
    let mean = costs.iter().sum::<f64>() / costs.len() as f64;
    costs.sort_by(f64::total_cmp);
    let part = |share: f64| costs[((costs.len() - 1) as f64 * share) as usize];
    println!(
        "{MOVES} moves {seconds:.3} s: tick mean {mean:.1} µs, p50 {:.1}, p99 {:.1}, p99.9 {:.1}, worst {:.1}",
        part(0.5),
        part(0.99),
        part(0.999),
        part(1.0)
    );
}

/// Every contour of the table at every tolerance: class, seed and contour.
fn all_contours() -> impl Iterator<Item = (usize, u32, Value)> {
    (0..contours::CLASSES.len()).flat_map(|class| {
        (0..SEEDS).flat_map(move |seed| {
            contours::TOLERANCES_UM.map(|tolerance| (class, seed, contours::contour(class, seed, tolerance)))
        })
    })
}

/// The fastest times that are known, s, by name.
fn optima() -> Value {
    serde_json::from_str(include_str!("contours/optima.json")).unwrap()
}

/// Runs the random contours whose fastest time is known; prints median and worst ratio per class and tolerance, for the
/// contours at hand and for those held out. Returns whether every limit was kept.
fn random_contours() -> bool {
    let optima = optima();
    let (mut kept_all, mut ratios) = (true, std::collections::BTreeMap::<(usize, u32, bool), Vec<f64>>::new());
    let (mut known, mut count) = (0, 0);
    for (class, seed, mut contour) in all_contours() {
        count += 1;
        let name = contour["name"].as_str().unwrap_or_default().to_owned();
        let Some(least) = optima[&name].as_f64() else {
            println!("{name}: the solver found no time");
            continue;
        };
        known += 1;
        contour["seconds"]["jerk_limited_optimum"] = least.into();
        let (seconds, ratio, kept) = run(&contour, &mut Vec::new(), false);
        if std::env::var_os("KT830_BENCH_VERBOSE").is_some() || !kept {
            println!("{name} {seconds:.3} of {least:.3}{}", if kept { "" } else { " EXCEEDED" });
        }
        kept_all &= kept;
        let tolerance_um = (contour["limits"]["tol"].as_f64().unwrap_or_default() * 1e3).round() as u32;
        ratios.entry((class, tolerance_um, seed % 2 == 1)).or_default().extend(ratio);
    }
    for ((class, tolerance_um, is_held), mut ratios) in ratios {
        ratios.sort_by(f64::total_cmp);
        let (median, worst) = (ratios[ratios.len() / 2], ratios[ratios.len() - 1]);
        let (class, held) = (contours::CLASSES[class].0, if is_held { "held" } else { "    " });
        println!(
            "{class:8} {tolerance_um:2} µm {held} {:2} contours: median {median:.3} worst {worst:.3}",
            ratios.len()
        );
    }
    println!("{known} of {count} contours");
    kept_all && known > 0
}

/// Blocks a second on an S of two arcs of 12 mm cut into points of `chord_mm`, at 100 mm/s or what the axes allow, with the
/// reader's most blocks a tick; the points are rounded to a grid.
fn block_rate(chord_mm: f64, grid_mm: f64) {
    const RADIUS_MM: f64 = 12.0;
    const BLOCKS_PER_TICK: usize = 16;
    let axis = |v| AxisLimits { velocity_mm_s: v, acceleration_mm_s2: 800.0, jerk_mm_s3: 20_000.0 };
    let limits = MotionLimits { axes: PerAxis([axis(100.0), axis(100.0), axis(10_000.0 / 60.0)]), tick_s: 0.001 };
    // Two quarter turns, one to the left and one to the right.
    let count = (std::f64::consts::PI * RADIUS_MM / chord_mm).round() as u32;
    let at = |k: u32| {
        let angle = std::f64::consts::PI * f64::from(k) / f64::from(count);
        let turn = std::f64::consts::FRAC_PI_2;
        if angle <= turn {
            [RADIUS_MM * (1.0 - angle.cos()), 0.0, RADIUS_MM * angle.sin()]
        } else {
            let rest = std::f64::consts::PI - angle;
            [RADIUS_MM * (1.0 + rest.cos()), 0.0, RADIUS_MM * (2.0 - rest.sin())]
        }
    };
    let mut path = TrajectoryPlanner::new(limits, MachinePos::new([0.0; 3]));
    let (mut next, mut costs) = (1, Vec::new());
    while next <= count || !path.is_done() {
        for _ in 0..BLOCKS_PER_TICK.min(path.free_slots()) {
            if next <= count {
                let corner = CornerMode::Continuous { tolerance_mm: 0.01 };
                let speed = MotionSpeed::Feed { mm_s: 100.0 };
                let to = MachinePos::new(at(next).map(|x| (x / grid_mm).round() * grid_mm));
                path.push(Move { to, shape: MoveShape::Line, speed, corner, tag: next }).unwrap();
                next += 1;
            }
        }
        let before = Instant::now();
        path.tick(Override::FULL);
        costs.push(before.elapsed().as_secs_f64() * 1e6);
    }
    let ticks = costs.len();
    costs.sort_by(f64::total_cmp);
    println!(
        "points of {:4.0} µm on a grid of {} µm: {:6.0} blocks/s, {:.2} s; tick p50 {:.1} µs, p99.9 {:.1}, worst {:.1}",
        chord_mm * 1e3,
        grid_mm * 1e3,
        f64::from(count) / (ticks as f64 * 0.001),
        ticks as f64 * 0.001,
        costs[ticks / 2],
        costs[(ticks - 1) * 999 / 1000],
        costs[ticks - 1]
    );
}

fn main() {
    if let Some(folder) = std::env::var_os("KT830_WRITE_CONTOURS") {
        for (_, _, contour) in all_contours() {
            let file = format!("{}.json", contour["name"].as_str().unwrap_or_default());
            std::fs::write(std::path::Path::new(&folder).join(file), contour.to_string()).unwrap();
        }
        return;
    }
    many_moves();
    for (chord_mm, grid_mm) in [(0.002, 1e-6), (0.01, 1e-6), (0.02, 1e-6), (0.05, 1e-6), (0.002, 0.001), (0.01, 0.001)]
    {
        block_rate(chord_mm, grid_mm);
    }
    let kept = random_contours();
    let folder = std::env::var("KT830_BENCH_PATHS")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/bench").to_owned());
    let Ok(listing) = std::fs::read_dir(&folder) else {
        println!("no folder {folder}: its paths are not measured");
        std::process::exit(i32::from(!kept));
    };
    let mut files: Vec<_> = listing.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "json"));
    files.sort();
    let mut good = kept;
    for file in files {
        let value: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        let name = value["name"].as_str().unwrap_or("?").to_owned();
        let mut costs = Vec::new();
        for _ in 1..RUNS {
            run(&value, &mut costs, false);
        }
        let (seconds, ratio, kept) = run(&value, &mut costs, std::env::var_os("KT830_BENCH_VERBOSE").is_some());
        let shown = ratio.map_or_else(|| "-".to_owned(), |r| format!("{r:.3}"));
        println!("{name} {seconds:.3} {shown}{}", if kept { "" } else { " EXCEEDED" });
        good &= kept && !(name.starts_with('a') && ratio.is_some_and(|r| r > 1.20));
    }
    if !good {
        std::process::exit(1);
    }
}
