//! Dense points of changing feed and tolerance, with exact stops and empty moves: limits in every tick, each block once
//! and in order (row B2).

use std::f64::consts::{PI, TAU};

use kt830::motion::{AxisLimits, CornerMode, MotionLimits, MotionSpeed, Move, MoveShape, Override, TrajectoryPlanner};
use kt830::units::{MachinePos, PerAxis};

/// Blocks of a chain.
const BLOCKS: u32 = 1_500;

/// Numbers of a seed (xorshift).
struct Random(u64);

impl Random {
    fn share(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    fn one_of<const N: usize>(&mut self, choices: [f64; N]) -> f64 {
        choices[((self.share() * N as f64) as usize).min(N - 1)]
    }
}

fn limits() -> MotionLimits {
    let axis = |velocity_mm_s| AxisLimits { velocity_mm_s, acceleration_mm_s2: 800.0, jerk_mm_s3: 20_000.0 };
    MotionLimits { axes: PerAxis([axis(100.0), axis(100.0), axis(166.0)]), tick_s: 0.001 }
}

/// A random chain of short lines on a grid; now and then a long one, a corner, an empty move or an exact stop.
fn chain(random: &mut Random) -> Vec<Move> {
    let (grid, base) = (random.one_of([1e-6, 1e-4, 1e-3]), random.one_of([0.002, 0.005, 0.01, 0.03, 0.1]));
    let (mut tolerance_mm, mut mm_s, chord) = (base, random.between(20.0, 100.0), random.between(0.002, 0.05));
    let (mut at, mut way, mut bend, mut rise) = ([0.0_f64; 3], random.between(0.0, TAU), 0.0, 0.0);
    let mut block = |tag: u32| {
        if random.share() < 0.01 {
            (bend, rise) = (random.between(-4.0, 4.0) * chord, random.between(-0.3, 0.3));
        }
        way += if random.share() < 0.006 { random.between(-PI, PI) } else { bend };
        let jitter = if random.share() < 0.05 { random.between(-2.5, 2.5) } else { 0.0 };
        let length = match random.share() {
            share if share < 0.02 => 0.0,
            share if share < 0.024 => random.between(0.1, 3.0),
            _ => chord * random.between(0.3, 1.3),
        };
        let step = if jitter == 0.0 { length } else { length.min(0.2 * tolerance_mm) };
        let (sine, cosine) = (way + jitter).sin_cos();
        at = [at[0] + step * cosine, at[1] + step * rise, at[2] + step * sine].map(|x| (x / grid).round() * grid);
        if random.share() < 0.02 {
            mm_s = random.between(20.0, 100.0);
        }
        if random.share() < 0.01 {
            tolerance_mm = base * random.one_of([1.0, 0.3, 0.1, 3.0, 10.0]);
        }
        let exact = random.share() < 0.002;
        let corner = if exact { CornerMode::ExactStop } else { CornerMode::Continuous { tolerance_mm } };
        Move { to: MachinePos::new(at), shape: MoveShape::Line, speed: MotionSpeed::Feed { mm_s }, corner, tag }
    };
    (1..=BLOCKS).map(&mut block).collect()
}

/// Runs a chain; names the first tick and axis beyond a limit.
fn run(seed: u64) -> Result<(), String> {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let (moves, limits) = (chain(&mut random), limits());
    let mut path = TrajectoryPlanner::new(limits, MachinePos::new([0.0; 3]));
    let (mut next, mut ended, mut past) = (0, 0, [[0.0; 3]; 4]);
    for tick in 0..120_000_u32 {
        if next == moves.len() && path.is_done() {
            return (ended == BLOCKS).then_some(()).ok_or_else(|| format!("seed {seed}: {ended} blocks ended"));
        }
        for _ in 0..path.free_slots().min(16).min(moves.len() - next) {
            path.push(moves[next]).unwrap();
            next += 1;
        }
        past = [past[1], past[2], past[3], path.tick(Override::FULL).position.coordinates()];
        for (index, (axis, limit)) in limits.axes.iter().enumerate() {
            let [a, b, c, d] = past.map(|point| point[index]);
            let shares = [
                (d - c) / 1e-3 / limit.velocity_mm_s,
                (d - 2.0 * c + b) / 1e-6 / limit.acceleration_mm_s2,
                (d - 3.0 * c + 3.0 * b - a) / 1e-9 / limit.jerk_mm_s3,
            ];
            // Rounding of set-points: 1e-16 of 100 mm in the third difference is 1e-5 of the jerk.
            if shares.iter().any(|share| share.abs() > 1.00002) {
                return Err(format!(
                    "seed {seed}, tick {tick}, {axis}: speed, acceleration, jerk {shares:?} of the limit"
                ));
            }
        }
        while let Some(tag) = path.pop_finished() {
            if tag != ended + 1 {
                return Err(format!("seed {seed}: block {tag} behind block {ended}"));
            }
            ended = tag;
        }
    }
    Err(format!("seed {seed}: not done"))
}

/// With the limits of one programmed line for all of a joined one, some of these exceeded the jerk of an axis by up to
/// 16 %.
#[test]
fn b2_dense_points_of_changing_feed_and_tolerance_keep_the_limits() {
    let wrong: Vec<_> = (1..=60).filter_map(|seed| run(seed).err()).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
