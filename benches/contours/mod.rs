//! Random contours of six classes, and their fastest times.
//!
//! A contour is given by its class and a seed; points, limits and feed follow from them. Its fastest time at a tolerance
//! stands in `optima.json`: found by IPOPT with `optimum.py`, jerk-limited (see there for what it is worth). Contours of odd seeds
//! are held out: no constant of the planner is chosen by them.

use kt830::io::random::SplitMix64;
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// Tolerances for which the fastest time is known, µm.
pub const TOLERANCES_UM: [u32; 4] = [2, 5, 10, 50];
/// Draws the points of a contour, mm.
type Draw = fn(&mut Random) -> Vec<[f64; 2]>;
/// The classes.
pub const CLASSES: [(&str, Draw); 6] = [
    ("arcs", arcs),
    ("corners", corners),
    ("dense", dense),
    ("rounded", rounded),
    ("short", short),
    ("spline", spline),
];

/// Numbers in a range.
pub struct Random(SplitMix64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.next_unit()
    }

    fn count(&mut self, low: u32, high: u32) -> u32 {
        self.between(f64::from(low), f64::from(high) + 1.0) as u32
    }

    fn sign(&mut self) -> f64 {
        if self.0.next_bool() { 1.0 } else { -1.0 }
    }
}

/// Goes forward from point to point.
struct Pen {
    points: Vec<[f64; 2]>,
    heading: f64,
}

impl Pen {
    fn new(heading: f64) -> Self {
        Self { points: vec![[0.0, 0.0]], heading }
    }

    fn line(&mut self, length: f64) {
        let [x, z] = self.points[self.points.len() - 1];
        self.points.push([x + length * self.heading.sin(), z + length * self.heading.cos()]);
    }

    /// Chords of an arc, each of the same length.
    fn arc(&mut self, radius: f64, sweep: f64, chord: f64) {
        let count = (radius * sweep.abs() / chord).ceil().max(2.0);
        let step = sweep / count;
        for _ in 0..count as u32 {
            self.heading += step / 2.0;
            self.line(2.0 * radius * (step.abs() / 2.0).sin());
            self.heading += step / 2.0;
        }
    }
}

/// Arcs of 4 to 15 mm radius, bent to and fro, in chords of 0.4 to 1 mm.
fn arcs(random: &mut Random) -> Vec<[f64; 2]> {
    let mut pen = Pen::new(random.between(0.0, TAU));
    let (chord, mut side) = (random.between(0.4, 1.0), random.sign());
    for _ in 0..random.count(2, 3) {
        pen.arc(random.between(4.0, 15.0), side * random.between(0.8, 1.8), chord);
        side = -side;
    }
    pen.points
}

/// Lines of 3 to 20 mm with corners of 20 to 100°.
fn corners(random: &mut Random) -> Vec<[f64; 2]> {
    let mut pen = Pen::new(random.between(0.0, TAU));
    for _ in 0..random.count(5, 8) {
        pen.line(random.between(3.0, 20.0));
        pen.heading += random.sign() * random.between(20.0, 100.0).to_radians();
    }
    pen.points
}

/// A wave in chords of 50 to 150 µm.
fn dense(random: &mut Random) -> Vec<[f64; 2]> {
    let (chord, height, length) = (random.between(0.05, 0.15), random.between(0.2, 1.5), random.between(2.0, 6.0));
    let at = |k: u32| {
        let z = f64::from(k) * chord;
        [height * (z * TAU / length).sin(), z]
    };
    (0..=90).map(at).collect()
}

/// Lines of 2 to 12 mm joined by radii of 0.5 to 4 mm in chords of 5°.
fn rounded(random: &mut Random) -> Vec<[f64; 2]> {
    let mut pen = Pen::new(random.between(0.0, TAU));
    pen.line(random.between(2.0, 12.0));
    for _ in 0..random.count(2, 4) {
        let (radius, sweep) = (random.between(0.5, 4.0), random.sign() * random.between(0.5, 1.6));
        pen.arc(radius, sweep, radius * 5_f64.to_radians());
        pen.line(random.between(2.0, 12.0));
    }
    pen.points
}

/// Lines of 0.3 to 1.5 mm with corners of 5 to 80°.
fn short(random: &mut Random) -> Vec<[f64; 2]> {
    let mut pen = Pen::new(random.between(0.0, TAU));
    for _ in 0..random.count(15, 25) {
        pen.line(random.between(0.3, 1.5));
        pen.heading += random.sign() * random.between(5.0, 80.0).to_radians();
    }
    pen.points
}

/// A smooth curve as a drawing program writes it: chords that deviate by 3 µm.
fn spline(random: &mut Random) -> Vec<[f64; 2]> {
    const DEVIATION_MM: f64 = 0.003;
    let waves: Vec<[f64; 3]> = (1..=3)
        .map(|k| [random.between(-2.0, 2.0) / f64::from(k), f64::from(k) * TAU / 25.0, random.between(0.0, TAU)])
        .collect();
    let of = |f: &dyn Fn(&[f64; 3]) -> f64| waves.iter().map(f).sum::<f64>();
    let (mut points, mut z) = (Vec::new(), 0.0_f64);
    while z < 25.0 {
        let slope = of(&|[a, w, p]| a * w * (w * z + p).cos());
        let bend = of(&|[a, w, p]| -a * w * w * (w * z + p).sin());
        points.push([of(&|[a, w, p]| a * (w * z + p).sin()), z]);
        let curvature = (bend.abs() / (1.0 + slope * slope).powf(1.5)).max(0.01);
        z += ((8.0 * DEVIATION_MM / curvature).sqrt() / slope.hypot(1.0)).min(1.5);
    }
    points
}

/// A contour in the form of the bench files, without its time.
pub fn contour(class: usize, seed: u32, tolerance_um: u32) -> Value {
    let (name, points) = CLASSES[class];
    let mut random = Random(SplitMix64::new(u64::from(seed) * CLASSES.len() as u64 + class as u64));
    let points = points(&mut random);
    let mut axes = [[0.0; 3]; 2];
    for axis in &mut axes {
        let acceleration = random.between(400.0, 1_500.0);
        // A ramp of the acceleration takes 20 to 100 ms.
        *axis = [random.between(80.0, 160.0), acceleration, acceleration / random.between(0.02, 0.1)];
    }
    let limit = |k: usize| [axes[0][k], axes[1][k]];
    json!({
        "name": format!("{name}-{seed}-{tolerance_um}"),
        "points": points,
        "limits": {
            "v": limit(0), "a": limit(1), "j": limit(2),
            "feed": random.between(20.0, 120.0),
            "tol": f64::from(tolerance_um) / 1_000.0,
        },
        "seconds": {},
    })
}
