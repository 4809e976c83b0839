//! Counts how the time of a random contour changes when only its description does, and when it is given more freedom.
//!
//! Contours are those of `contours/`, other seeds, at bands of 2, 5, 10 and 50 µm. The same contour cut in two at every line, moved, turned
//! with its limits, run backwards, or scaled with its limits should take the same time; with a wider band, a higher feed or
//! higher limits none should be slower. Prints for each change the share within 3 %, the median, the 99th of a hundred and
//! the worst. `KT830_CONTOURS=N` takes N contours of each class and band (default 60, that is 1 440).
#![allow(clippy::print_stdout, clippy::unwrap_used)]

mod contours;

use kt830::motion::{AxisLimits, CornerMode, MotionLimits, MotionSpeed, Move, MoveShape, Override, TrajectoryPlanner};
use kt830::units::{MachinePos, PerAxis};
use serde_json::Value;

/// Seeds from here on: no constant is chosen by them.
const FIRST_SEED: u32 = 1_000;
const DEFAULT_COUNT: u32 = 60;
/// A contour that takes longer has not ended, s.
const MOST_TICKS: u32 = 200_000;
/// How much the time may change.
const ALLOWED: f64 = 0.03;
/// A change in the other direction below this is none.
const SAME: f64 = 0.001;

/// Points, limits of X and Z, tolerance, feed; mm and s.
#[derive(Clone)]
struct Task {
    points: Vec<[f64; 2]>,
    limits: [AxisLimits; 2],
    tolerance_mm: f64,
    feed_mm_s: f64,
}

impl Task {
    fn of(value: &Value) -> Self {
        let number = |v: &Value| v.as_f64().unwrap();
        let limit = |name: &str, axis: usize| number(&value["limits"][name][axis]);
        let axis = |k| AxisLimits {
            velocity_mm_s: limit("v", k),
            acceleration_mm_s2: limit("a", k),
            jerk_mm_s3: limit("j", k),
        };
        Self {
            points: value["points"].as_array().unwrap().iter().map(|p| [number(&p[0]), number(&p[1])]).collect(),
            limits: [axis(0), axis(1)],
            tolerance_mm: number(&value["limits"]["tol"]),
            feed_mm_s: number(&value["limits"]["feed"]),
        }
    }

    fn seconds(&self) -> f64 {
        let [x, z] = self.limits;
        let limits = MotionLimits { axes: PerAxis([x, x, z]), tick_s: 0.001 };
        let at = |p: &[f64; 2]| MachinePos::new([p[0], 0.0, p[1]]);
        let mut planner = TrajectoryPlanner::new(limits, at(&self.points[0]));
        let mut moves = self.points[1..].iter().map(|p| Move {
            to: at(p),
            shape: MoveShape::Line,
            speed: MotionSpeed::Feed { mm_s: self.feed_mm_s },
            corner: CornerMode::Continuous { tolerance_mm: self.tolerance_mm },
            tag: 0,
        });
        let mut ticks = 0;
        while ticks == 0 || (!planner.is_done() && ticks < MOST_TICKS) {
            while planner.free_slots() > 0
                && let Some(next) = moves.next()
            {
                planner.push(next).unwrap();
            }
            planner.tick(Override::FULL);
            ticks += 1;
        }
        assert!(ticks < MOST_TICKS, "a contour does not end");
        f64::from(ticks) * limits.tick_s
    }

    fn map(&self, place: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        Self { points: self.points.iter().map(|p| place(*p)).collect(), ..self.clone() }
    }

    fn scaled_limits(&self, factor: f64) -> [AxisLimits; 2] {
        self.limits.map(|limit| AxisLimits {
            velocity_mm_s: limit.velocity_mm_s * factor,
            acceleration_mm_s2: limit.acceleration_mm_s2 * factor,
            jerk_mm_s3: limit.jerk_mm_s3 * factor,
        })
    }

    fn cut_in_two(&self) -> Self {
        let halves = self.points.windows(2).flat_map(|pair| {
            let middle = [0, 1].map(|k| f64::midpoint(pair[0][k], pair[1][k]));
            [middle, pair[1]]
        });
        Self { points: std::iter::once(self.points[0]).chain(halves).collect(), ..self.clone() }
    }

    fn turned(&self) -> Self {
        let [x, z] = self.limits;
        Self { limits: [z, x], ..self.map(|[x, z]| [-z, x]) }
    }

    fn backwards(&self) -> Self {
        Self { points: self.points.iter().rev().copied().collect(), ..self.clone() }
    }

    fn scaled(&self) -> Self {
        let doubled = self.map(|p| p.map(|x| 2.0 * x));
        Self {
            limits: self.scaled_limits(2.0),
            tolerance_mm: 2.0 * self.tolerance_mm,
            feed_mm_s: 2.0 * self.feed_mm_s,
            ..doubled
        }
    }
}

type Change = (&'static str, fn(&Task) -> Task);

const SAME_TIME: [Change; 5] = [
    ("every line cut in two", Task::cut_in_two),
    ("moved", |task| task.map(|[x, z]| [x + 13.7, z - 8.1])),
    ("turned by 90° with its limits", Task::turned),
    ("run backwards", Task::backwards),
    ("lengths and limits doubled", Task::scaled),
];
const NOT_SLOWER: [Change; 3] = [
    ("band twice as wide", |task| Task { tolerance_mm: 2.0 * task.tolerance_mm, ..task.clone() }),
    ("feed 20 % higher", |task| Task { feed_mm_s: 1.2 * task.feed_mm_s, ..task.clone() }),
    ("limits 20 % higher", |task| Task { limits: task.scaled_limits(1.2), ..task.clone() }),
];

/// Share of good ones, and the sorted changes at 50 %, 99 % and the end.
fn print(name: &str, band: &str, mut changes: Vec<f64>, good: impl Fn(f64) -> bool) {
    let share = changes.iter().filter(|change| good(**change)).count() as f64 / changes.len() as f64;
    changes.sort_by(f64::total_cmp);
    let at = |part: f64| 100.0 * changes[((changes.len() - 1) as f64 * part) as usize];
    println!(
        "| {name} | {band} | {} | {:.1} % | {:.1} / {:.1} / {:.1} % |",
        changes.len(),
        100.0 * share,
        at(0.5),
        at(0.99),
        at(1.0)
    );
}

fn main() {
    let count = std::env::var("KT830_CONTOURS").ok().and_then(|text| text.parse().ok()).unwrap_or(DEFAULT_COUNT);
    println!("| change | band | contours | good | median / 99 % / worst |");
    let mut runs = 0;
    for band_um in contours::TOLERANCES_UM {
        let tasks = (0..contours::CLASSES.len())
            .flat_map(|class| (0..count).map(move |seed| contours::contour(class, FIRST_SEED + seed, band_um)));
        let tasks: Vec<Task> = tasks.map(|value| Task::of(&value)).collect();
        let seconds: Vec<f64> = tasks.iter().map(Task::seconds).collect();
        let band = format!("{band_um} µm");
        let ratios = |change: fn(&Task) -> Task| -> Vec<f64> {
            tasks.iter().zip(&seconds).map(|(task, before)| change(task).seconds() / before - 1.0).collect()
        };
        for (name, change) in SAME_TIME {
            let away: Vec<f64> = ratios(change).into_iter().map(f64::abs).collect();
            print(name, &band, away, |by| by < ALLOWED);
        }
        for (name, change) in NOT_SLOWER {
            print(name, &band, ratios(change), |by| by < SAME);
        }
        runs += tasks.len() * (1 + SAME_TIME.len() + NOT_SLOWER.len());
    }
    println!("{runs} runs");
}
