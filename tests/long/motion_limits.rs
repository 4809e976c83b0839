//! Random paths, overrides and holds: velocity, acceleration, jerk and tolerance are kept in every tick.
//!
//! Everything is measured on the emitted set-points by differences over ticks, and the distance to the programmed
//! contour directly; nothing of the planner's own arithmetic is used. Source: spec, motion, the property test.

use kt830::motion::{
    ArcDirection, AxisLimits, CornerMode, MAX_WORK_PER_TICK, MotionLimits, MotionSpeed, Move, MoveShape, Override,
    TrajectoryPlanner,
};
use kt830::units::{MachinePos, PerAxis, Plane};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};

const TICK_S: f64 = 0.001;
/// Positions to 300 mm are rounded to 6e-14 mm; eight of those over (1 ms)³ are 5e-4 mm/s³, 1e-6 of 500 mm/s³.
const SLACK: f64 = 1e-6;
/// Moves before and after the active one that are looked at for the nearest: in a tick the axes pass 0.2 mm at most.
const AROUND: usize = 64;
/// Places of an arc looked at for the nearest.
const LOOKS: u32 = 48;
/// An axis may go beyond where the program leads it by a thousandth of the finest increment, mm.
const BEYOND: f64 = 1e-6;

fn limits() -> MotionLimits {
    let axis = |v, a, j| AxisLimits { velocity_mm_s: v, acceleration_mm_s2: a, jerk_mm_s3: j };
    let axes = PerAxis([axis(80.0, 800.0, 15_000.0), axis(100.0, 1_000.0, 20_000.0), axis(150.0, 1_500.0, 30_000.0)]);
    MotionLimits { axes, tick_s: TICK_S }
}

/// Sees every set-point and compares it with the limits and the contour.
struct Witness {
    limits: MotionLimits,
    past: [[f64; 3]; 4],
    contour: Vec<([f64; 3], Move)>,
    extent: [(f64, f64); 3],
    tolerance_mm: f64,
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|x| (a[x] - b[x]).powi(2)).sum::<f64>().sqrt()
}

/// From a point to a move that starts at `from`.
fn distance_to(from: [f64; 3], program: &Move, p: [f64; 3]) -> f64 {
    let to = program.to.coordinates();
    match program.shape {
        MoveShape::Line => {
            let d = [0, 1, 2].map(|x| to[x] - from[x]);
            let square: f64 = d.iter().map(|x| x * x).sum();
            let along = (0..3).map(|x| (p[x] - from[x]) * d[x]).sum::<f64>();
            let t = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
            distance(p, [0, 1, 2].map(|x| from[x] + t * d[x]))
        }
        MoveShape::Arc { center, plane, direction: turn } => {
            let arc = Arc::new(from, to, center.coordinates(), plane, turn);
            // Looked for everywhere, then closely around the best: on a steep helix the angle says little.
            let off = |part: f64| distance(p, arc.at(part));
            let best = (0..=LOOKS).map(|k| f64::from(k) / f64::from(LOOKS)).min_by(|a, b| off(*a).total_cmp(&off(*b)));
            let middle = best.unwrap_or_default();
            let (mut low, mut high) = (middle - 1.0 / f64::from(LOOKS), middle + 1.0 / f64::from(LOOKS));
            for _ in 0..40 {
                let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if off(a) < off(b) { high = b } else { low = a }
            }
            off(low.clamp(0.0, 1.0)).min(off(0.0)).min(off(1.0))
        }
    }
}

/// An arc, perhaps a helix, from its definition.
struct Arc {
    center: [f64; 3],
    axes: [usize; 3],
    from: [f64; 3],
    rise: f64,
    radius: f64,
    start: f64,
    sweep: f64,
}

impl Arc {
    fn new(from: [f64; 3], to: [f64; 3], center: [f64; 3], plane: Plane, turn: ArcDirection) -> Self {
        let ((a, b), c) = (plane.axes(), plane.normal_axis());
        let axes = [a, b, c].map(|axis| axis as usize);
        let polar = |q: [f64; 3]| (q[axes[1]] - center[axes[1]]).atan2(q[axes[0]] - center[axes[0]]);
        let sense = if turn == ArcDirection::Ccw { 1.0 } else { -1.0 };
        let sweep = sense * (sense * (polar(to) - polar(from))).rem_euclid(TAU);
        let radius = (from[axes[0]] - center[axes[0]]).hypot(from[axes[1]] - center[axes[1]]);
        Self { center, axes, from, rise: to[axes[2]] - from[axes[2]], radius, start: polar(from), sweep }
    }

    fn at(&self, part: f64) -> [f64; 3] {
        let (sin, cos) = (self.start + self.sweep * part).sin_cos();
        let mut q = [0.0; 3];
        q[self.axes[0]] = self.center[self.axes[0]] + self.radius * cos;
        q[self.axes[1]] = self.center[self.axes[1]] + self.radius * sin;
        q[self.axes[2]] = self.from[self.axes[2]] + self.rise * part;
        q
    }
}

/// The farthest that the contour goes in each axis, low and high.
fn extent(contour: &[([f64; 3], Move)]) -> [(f64, f64); 3] {
    let mut box_ = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    let mut see = |q: [f64; 3]| {
        for (bound, x) in box_.iter_mut().zip(q) {
            *bound = (bound.0.min(x), bound.1.max(x));
        }
    };
    for (from, m) in contour {
        see(*from);
        see(m.to.coordinates());
        if let MoveShape::Arc { center, plane, direction: turn } = m.shape {
            let arc = Arc::new(*from, m.to.coordinates(), center.coordinates(), plane, turn);
            for quarter in -8..=8 {
                let part = (f64::from(quarter) * FRAC_PI_2 - arc.start) / arc.sweep;
                if (0.0..=1.0).contains(&part) {
                    see(arc.at(part));
                }
            }
        }
    }
    box_
}

impl Witness {
    /// `done` moves have been reported as finished.
    fn sees(&mut self, p: [f64; 3], done: usize) {
        self.past = [self.past[1], self.past[2], self.past[3], p];
        let q = &self.past;
        for (axis, l) in self.limits.axes.iter() {
            let x = axis as usize;
            let v = (q[3][x] - q[2][x]) / TICK_S;
            let a = (q[3][x] - 2.0 * q[2][x] + q[1][x]) / TICK_S.powi(2);
            let j = (q[3][x] - 3.0 * (q[2][x] - q[1][x]) - q[0][x]) / TICK_S.powi(3);
            assert!(v.abs() <= l.velocity_mm_s * (1.0 + SLACK), "{axis} velocity {v}");
            assert!(a.abs() <= l.acceleration_mm_s2 * (1.0 + SLACK), "{axis} acceleration {a}");
            assert!(j.abs() <= l.jerk_mm_s3 * (1.0 + SLACK), "{axis} jerk {j}");
        }
        let near = &self.contour[done.saturating_sub(AROUND)..(done + AROUND).min(self.contour.len())];
        let off = near.iter().map(|(from, m)| distance_to(*from, m, p)).fold(f64::INFINITY, f64::min);
        assert!(off <= self.tolerance_mm, "{off} mm off the contour");
        for (x, (low, high)) in p.into_iter().zip(self.extent) {
            assert!(x >= low - BEYOND && x <= high + BEYOND, "{x} is beyond {low} to {high}");
        }
    }
}

#[derive(Clone, Debug)]
struct Leg {
    by: [f64; 3],
    arc: Option<(f64, bool, Plane, bool)>,
    rapid: bool,
    feed: f64,
    exact: bool,
}

fn length() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => Just(0.0),
        3 => -0.02..0.02_f64,
        4 => -1.0..1.0_f64,
        3 => -15.0..15.0_f64,
    ]
}

fn leg() -> impl Strategy<Value = Leg> {
    let plane = prop_oneof![Just(Plane::Zx), Just(Plane::Xy), Just(Plane::Yz)];
    let arc = prop_oneof![2 => Just(None), 1 => (-1.5..1.5_f64, any::<bool>(), plane, any::<bool>()).prop_map(Some)];
    let by = (length(), length(), length(), any::<bool>());
    // Grinding feeds as well; their moves are so short that each takes less than a second.
    let feed = prop_oneof![2 => 5.0..200.0_f64, 1 => (0.0..4.5_f64).prop_map(|decades| 1e-3 * 10_f64.powf(decades))];
    (by, arc, 0..8_u8, feed, 0..4_u8).prop_map(|((x, y, z, flat), arc, rapid, feed, exact)| Leg {
        by: [x, if flat { 0.0 } else { y }, z].map(|mm| if feed < 5.0 { mm * feed * 0.05 } else { mm }),
        arc,
        rapid: rapid == 0,
        feed,
        exact: exact == 0,
    })
}

/// What happens every few ticks: hold, resume or an override.
#[derive(Clone, Copy, Debug)]
enum Event {
    Hold,
    Resume,
    Feed(f64),
    Rapid(f64),
}

fn event() -> impl Strategy<Value = (u16, Event)> {
    let what = prop_oneof![
        Just(Event::Hold),
        Just(Event::Resume),
        (0.0..1.5_f64).prop_map(Event::Feed),
        Just(Event::Feed(1.0)),
        Just(Event::Feed(0.0)),
        (0.0..1.0_f64).prop_map(Event::Rapid),
    ];
    (0..120_u16, what)
}

fn program(legs: &[Leg], tolerance_mm: f64) -> Vec<([f64; 3], Move)> {
    let mut from = [0.0_f64; 3];
    legs.iter()
        .zip(0_u32..)
        .map(|(leg, tag)| {
            let mut to = [0, 1, 2].map(|x| from[x] + leg.by[x]);
            let mut shape = MoveShape::Line;
            if let Some((bulge, ccw, plane, flat)) = leg.arc {
                // The centre lies off the middle of the chord by `bulge` chords; a helix unless flat.
                let ((a, b), c) = (plane.axes(), plane.normal_axis());
                let [a, b, c] = [a, b, c].map(|axis| axis as usize);
                let (u, v) = (to[a] - from[a], to[b] - from[b]);
                if u.hypot(v) > 1e-3 {
                    to[c] = if flat { from[c] } else { to[c] };
                    let mut center = [0.0; 3];
                    center[a] = from[a] + u / 2.0 - bulge * v;
                    center[b] = from[b] + v / 2.0 + bulge * u;
                    let turn = if ccw { ArcDirection::Ccw } else { ArcDirection::Cw };
                    shape = MoveShape::Arc { center: MachinePos::new(center), plane, direction: turn };
                }
            }
            let rate = if leg.rapid { MotionSpeed::Rapid } else { MotionSpeed::Feed { mm_s: leg.feed } };
            let end = if leg.exact { CornerMode::ExactStop } else { CornerMode::Continuous { tolerance_mm } };
            let start = std::mem::replace(&mut from, to);
            (start, Move { to: MachinePos::new(to), shape, speed: rate, corner: end, tag })
        })
        .collect()
}

/// A move may be handed in this many ticks after the one before.
const LONGEST_GAP: u16 = 400;

/// No stop and no planning costs more than this, s.
const STOP_S: f64 = 0.5;

/// Ticks within which a contour is done: every move from rest to rest at its feed, with as long a stop, twice over.
fn most_ticks(contour: &[([f64; 3], Move)]) -> u64 {
    let limits = limits();
    let (mut a, mut j) = (f64::INFINITY, f64::INFINITY);
    for (_, l) in limits.axes.iter() {
        (a, j) = (a.min(l.acceleration_mm_s2), j.min(l.jerk_mm_s3));
    }
    let seconds = |(from, m): &([f64; 3], Move)| {
        let feed = match m.speed {
            MotionSpeed::Feed { mm_s } => mm_s.min(80.0),
            MotionSpeed::Rapid => 80.0,
        };
        let length = match m.shape {
            MoveShape::Line => distance(*from, m.to.coordinates()),
            MoveShape::Arc { center, plane, direction: turn } => {
                let arc = Arc::new(*from, m.to.coordinates(), center.coordinates(), plane, turn);
                (arc.radius * arc.sweep).hypot(arc.rise)
            }
        };
        // An arc is slower than its feed where its radius asks for it: v ≤ ∛(0.3 j r²) and √(0.7 a r).
        let radius = match m.shape {
            MoveShape::Line => f64::INFINITY,
            MoveShape::Arc { center, plane, direction: turn } => {
                Arc::new(*from, m.to.coordinates(), center.coordinates(), plane, turn).radius.max(1e-3)
            }
        };
        let feed = feed.min((0.3 * j * radius * radius).cbrt()).min((0.7 * a * radius).sqrt());
        length / feed + 2.0 * (feed / a + a / j) + STOP_S
    };
    (contour.iter().map(seconds).sum::<f64>() * 2.0 / TICK_S) as u64
}

/// What happens to a contour: events, and the gaps after which its moves are handed in.
#[derive(Clone, Debug, Default)]
struct Play {
    events: Vec<(u16, Event)>,
    gaps: Vec<u16>,
}

/// Plays it; returns every set-point.
fn run(legs: &[Leg], play: &Play, tolerance_mm: f64) -> Vec<[f64; 3]> {
    let contour = program(legs, tolerance_mm);
    let mut path = TrajectoryPlanner::new(limits(), MachinePos::default());
    let end = contour.last().map_or([0.0; 3], |(_, m)| m.to.coordinates());
    let tags: Vec<u32> = contour.iter().map(|(_, m)| m.tag).collect();
    let moves: Vec<Move> = contour.iter().map(|(_, m)| *m).collect();
    let (mut next, mut due, mut tick) = (0, 0_u64, 0_u64);
    let most = most_ticks(&contour) + u64::from(LONGEST_GAP) * contour.len() as u64;
    let mut witness =
        Witness { limits: limits(), past: [[0.0; 3]; 4], extent: extent(&contour), contour, tolerance_mm };
    let mut ov = Override::FULL;
    let (mut seen, mut trace) = (Vec::new(), Vec::new());
    let mut step = |path: &mut TrajectoryPlanner, ov: Override| {
        while next < moves.len() && due <= tick && path.free_slots() > 0 {
            assert_eq!(path.push(moves[next]), Ok(()));
            next += 1;
            due += u64::from(play.gaps.get(next).copied().unwrap_or(0));
        }
        tick += 1;
        let at = path.tick(ov).position.coordinates();
        witness.sees(at, seen.len());
        trace.push(at);
        seen.extend(std::iter::from_fn(|| path.pop_finished()));
        assert!(path.work_of_last_tick() <= MAX_WORK_PER_TICK);
        next == moves.len()
    };
    for (wait, event) in &play.events {
        for _ in 0..*wait {
            step(&mut path, ov);
        }
        match *event {
            Event::Hold => path.hold(),
            Event::Resume => path.resume(),
            Event::Feed(factor) => ov.feed = factor,
            Event::Rapid(factor) => ov.rapid = factor,
        }
    }
    path.resume();
    for _ in 0..most {
        if step(&mut path, Override::FULL) && path.is_done() {
            break;
        }
    }
    assert!(path.is_done(), "never done: {} moves left after {most} ticks", path.remaining_moves());
    assert_eq!(seen, tags);
    assert!(distance(path.position().coordinates(), end) <= 1e-9, "ended at {:?}, not {end:?}", path.position());
    trace
}

fn play() -> impl Strategy<Value = Play> {
    let gap = prop_oneof![3 => Just(0_u16), 2 => 0..12_u16, 2 => 0..LONGEST_GAP];
    let gaps = prop_oneof![1 => Just(Vec::new()), 1 => prop::collection::vec(gap, 12)];
    (prop::collection::vec(event(), 0..12), gaps).prop_map(|(events, gaps)| Play { events, gaps })
}

/// A chain of short legs that bends little, with a corner or a reversal now and then: what a drawing program writes.
fn chain(legs: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Leg>> {
    let bend = prop_oneof![8 => -0.1..0.1_f64, 1 => -3.1..3.1_f64, 1 => 3.0..3.3_f64];
    let step = (0.001..0.5_f64, bend, -0.05..0.05_f64);
    (prop::collection::vec(step, legs), 5.0..200.0_f64).prop_map(|(steps, feed)| {
        let mut way = 0.0_f64;
        let leg = |(length, bend, rise): (f64, f64, f64)| {
            way += bend;
            let by = [length * way.cos(), length * rise, length * way.sin()];
            Leg { by, arc: None, rapid: false, feed, exact: false }
        };
        steps.into_iter().map(leg).collect()
    })
}

/// That many cases, or `PROPTEST_CASES`; new ones in every run, or those of `PROPTEST_RNG_SEED`.
fn cases(count: u32) -> ProptestConfig {
    let from_environment = ProptestConfig::default();
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() { from_environment.cases } else { count };
    ProptestConfig { cases, max_shrink_iters: 200, failure_persistence: None, ..from_environment }
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn every_limit_is_kept_in_every_tick(
        legs in prop::collection::vec(leg(), 1..12),
        play in play(),
        tolerance_mm in prop_oneof![Just(0.01), 0.002..0.2_f64],
    ) {
        run(&legs, &play, tolerance_mm);
    }

    #[test]
    fn and_along_chains_of_short_moves(
        legs in chain(10..70),
        play in play(),
        tolerance_mm in prop_oneof![Just(0.01), 0.002..0.2_f64],
    ) {
        run(&legs, &play, tolerance_mm);
    }
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn the_same_play_gives_the_same_set_points(legs in chain(10..70), play in play()) {
        prop_assert_eq!(run(&legs, &play, 0.01), run(&legs, &play, 0.01));
    }

    #[test]
    fn long_chains_run_through_a_full_queue(legs in chain(600..2_000), play in play()) {
        run(&legs, &play, 0.01);
    }
}

/// A chain at one feed.
fn chain_of(steps: &[[f64; 3]], feed: f64) -> Vec<Leg> {
    steps.iter().map(|by| Leg { by: *by, arc: None, rapid: false, feed, exact: false }).collect()
}

/// A single move ends with jerk; a slow run that follows at once adds its own.
#[test]
fn a_slow_run_after_a_single_move_keeps_the_jerk_limit() {
    let mut steps = [[0.001, 0.0, 0.0]; 10];
    (steps[1][0], steps[3][0]) = (0.497_058_335_341_892_6, 0.164_487_499_790_764);
    let play = Play { events: Vec::new(), gaps: vec![0, 4, 4, 0, 0, 0, 0, 0, 0, 0] };
    run(&chain_of(&steps, 10.047_256_741_307_987), &play, 0.189_700_733_194_408_72);
}

/// The deviation has its peak between two checked points, at a bend that is passed fast for its tolerance.
#[test]
fn a_peak_of_the_deviation_between_two_checked_points_is_seen() {
    let ten = [
        [0.182_330_741_351_782_23, 0.0, -0.283_539_421_982_720_53],
        [0.116_805_915_181_233_66, 0.0, -0.166_386_882_803_408_52],
        [0.170_896_696_233_935_55, 0.0, -0.256_425_331_320_469_6],
        [0.170_891_014_731_647_42, 0.0, -0.227_047_182_744_868_65],
        [0.237_465_583_967_242_77, 0.0, -0.352_468_377_841_069],
        [0.140_238_928_535_619_23, -0.007_015_516_011_316_211, -0.204_127_484_040_720_5],
        [-0.172_123_625_000_988_74, 0.0, 0.279_717_350_013_111_54],
        [-0.015_173_349_182_929_695, 0.0, -0.024_554_003_132_721_065],
        [-0.118_496_247_530_831_42, 0.0, -0.194_397_918_270_235_53],
        [-0.192_347_632_492_819_22, -0.009_155_439_125_016_63, -0.283_001_725_969_670_16],
        [-0.251_342_299_068_538_67, -0.010_475_072_041_509_692, -0.403_983_648_842_012_9],
        [0.021_174_099_561_442_446, 0.0, 0.045_129_970_613_120_345],
        [0.060_133_203_066_780_95, 0.0, 0.145_782_587_804_575_34],
        [0.108_508_740_510_309_12, 0.0, 0.203_454_035_601_264_77],
        [0.168_082_636_148_291_2, 0.019_700_976_246_753_33, 0.373_630_764_872_490_5],
        [-0.087_781_957_705_075_53, 0.008_885_712_135_032_284, -0.297_856_677_456_689_1],
        [-0.070_323_757_950_251_05, -0.008_233_428_879_802_926, -0.253_687_849_529_355],
        [-0.124_381_458_529_133_74, -0.017_407_723_254_832_75, -0.398_955_486_265_274_55],
        [-0.108_305_002_617_164_2, 0.001_073_044_314_285_704_4, -0.383_676_854_460_895_06],
        [-0.006_750_009_321_875_929, -0.001_159_873_325_501_796_4, -0.026_775_280_254_212_434],
        [-0.000_441_810_595_138_621_2, -0.000_066_773_451_558_624, -0.001_414_356_442_543_727_4],
        [-0.131_230_545_356_400_52, -0.013_190_710_068_792_582, -0.402_467_488_671_797_66],
        [-0.037_741_354_155_196_18, 0.004_812_245_224_884_427, -0.131_335_142_114_771_93],
        [-0.088_970_507_231_392, -0.015_985_483_049_229_778, -0.423_161_795_581_383_06],
        [-0.112_147_061_376_955_33, 0.016_397_726_719_192_433, -0.462_433_574_165_576_23],
        [-0.068_074_886_544_554_72, -0.014_409_053_263_897_591, -0.350_149_040_898_636_85],
        [-0.009_415_056_334_171_635, 0.000_376_439_528_214_853_5, -0.073_665_461_837_860_64],
        [-0.083_237_126_441_726_9, 0.015_059_756_927_554_551, -0.460_557_611_576_957_96],
        [0.024_109_646_856_507_714, 0.005_513_589_981_742_134, 0.117_595_426_207_281_5],
        [0.041_612_427_377_085_21, -0.012_098_781_216_580_961, 0.293_139_602_283_093_8],
    ];
    let events = [(97, 0.197_917_846_765_097_72), (100, 1.478_114_814_043_621_5), (221, 1.0), (5, 0.0), (42, 1.0)];
    let events = events.map(|(wait, factor)| (wait, Event::Feed(factor))).to_vec();
    run(&chain_of(&ten, 46.928_501_426_303_89), &Play { events, gaps: Vec::new() }, 0.01);
    let two = [
        [0.177_549_936_131_050_16, 0.0, -0.002_964_839_806_796_313_7],
        [0.456_972_115_324_821_74, -0.021_073_931_931_120_82, -0.002_743_600_267_408_862],
        [-0.206_095_629_076_205_46, 0.0, -0.057_684_512_707_156_64],
        [-0.091_175_812_334_297_83, 0.0, -0.023_696_123_383_994_475],
        [-0.454_989_836_897_406_85, 0.000_830_646_795_122_137, -0.163_782_014_260_746_46],
        [-0.260_040_808_617_187_7, 0.0, -0.085_768_534_133_114_65],
        [-0.393_337_050_502_903_8, 0.0, -0.109_964_499_379_825_03],
        [-0.271_777_168_613_985_5, 0.0, -0.046_020_226_931_865_395],
        [0.000_990_495_650_520_53, 0.0, 0.000_137_544_052_215_689_6],
        [0.000_974_067_826_623_848_2, 0.0, 0.000_226_256_202_426_127_85],
        [0.000_960_437_069_838_795, 0.0, 0.000_278_497_100_307_112_3],
        [0.000_945_593_108_765_394_4, 0.0, 0.000_325_351_613_881_654_37],
        [0.000_955_837_392_754_318_3, 0.0, 0.000_293_896_033_679_645_3],
        [0.000_975_274_624_041_821_7, 0.0, 0.000_220_996_397_482_138_24],
        [-0.000_973_039_034_637_777_5, 0.0, -0.000_230_640_493_129_853_5],
        [-0.000_960_638_628_372_256_1, 0.0, -0.000_277_801_054_135_995_54],
        [-0.000_949_977_201_303_662_5, 0.0, -0.000_312_319_254_935_171_64],
        [0.221_655_663_313_958_33, 0.0, 0.090_742_014_428_867_5],
        [0.251_041_140_352_788_24, 0.0, 0.106_402_056_712_822_32],
        [0.440_564_165_260_526_05, -0.013_607_901_425_074_358, 0.226_883_913_788_049_1],
        [0.218_628_389_163_505_13, 0.0, 0.089_126_307_446_735_2],
        [0.036_643_565_752_861_01, -0.001_606_422_962_284_399_7, 0.018_697_996_526_239_685],
        [0.288_965_821_671_674, 0.002_533_815_789_996_183_5, 0.127_892_767_325_269_14],
    ];
    let events = vec![(101, Event::Hold), (86, Event::Resume)];
    run(&chain_of(&two, 138.072_412_732_904_87), &Play { events, gaps: Vec::new() }, 0.002_068_724_562_704_994_2);
}

/// Two lines that are joined have less tolerance than the line behind their corner, which lies between two checked points.
#[test]
fn at_a_corner_each_line_has_its_own_tolerance() {
    let legs = [
        [0.368_674_139_762_804_9, 0.0, 0.035_105_068_269_335_56],
        [0.409_633_078_480_919_57, 0.0, 0.250_980_242_683_907_1],
        [0.022_973_286_905_591_556, 0.000_904_619_566_660_108_8, 0.015_059_759_221_963_183],
        [0.163_339_664_937_787_34, 0.0, 0.107_074_622_602_676_24],
        [-0.198_232_986_219_637_34, -0.011_202_083_065_359_69, 0.131_178_412_161_380_6],
        [-0.085_234_993_955_806_62, 0.003_900_580_540_434_412_3, 0.061_809_900_215_705_746],
        [-0.132_646_161_656_647_53, 0.0, 0.101_905_438_287_626_7],
        [-0.112_678_653_939_034_28, 0.0, 0.095_259_685_441_612_7],
        [-0.014_033_236_655_664_78, 0.0, 0.010_617_352_661_700_127],
        [-0.070_556_179_689_286_75, 0.0, -0.075_579_088_382_465_45],
        [-0.208_384_249_985_964_64, 0.0, -0.208_118_680_006_030_84],
        [-0.116_795_723_125_386_77, 0.0, -0.116_646_875_801_998_12],
    ];
    let events = vec![(93, Event::Feed(0.0)), (1, Event::Feed(0.0)), (71, Event::Hold), (0, Event::Hold)];
    let gaps = vec![0, 4, 0, 10, 0, 0, 0, 27, 0, 37, 4, 0];
    run(&chain_of(&legs, 85.706_869_276_874_27), &Play { events, gaps }, 0.01);
}
