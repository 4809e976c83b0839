//! Thread passes: Z follows the spindle.

use kt830::motion::{AxisLimits, MotionLimits, Setpoint, ThreadMover, ThreadPass};
use kt830::units::{Axis, MachinePos, PerAxis};

const TICK_S: f64 = 0.001;

fn limits() -> MotionLimits {
    let axis = AxisLimits { velocity_mm_s: 66.0, acceleration_mm_s2: 800.0, jerk_mm_s3: 20_000.0 };
    MotionLimits { axes: PerAxis([axis; 3]), tick_s: TICK_S }
}

/// Cuts from Z 0 to −50 with a spindle that starts at `phase` turns; returns set-points and worst error, mm.
fn cut(lead_mm: f64, rpm: f64, phase: f64) -> (Vec<Setpoint>, f64) {
    let to = MachinePos::new([lead_mm + 1.0, 0.0, -50.0]);
    let thread = ThreadPass { run_out_start: MachinePos::new([0.0, 0.0, -48.8]), run_out_end: to, lead_mm };
    let mut mover = ThreadMover::new(thread, MachinePos::default(), limits(), phase, 0.0);
    let (mut points, mut worst, mut turns) = (Vec::new(), 0.0_f64, phase);
    while !mover.is_finished() {
        turns += rpm / 60.0 * TICK_S;
        // An encoder with 4800 steps per turn.
        let seen = (turns * 4_800.0).floor() / 4_800.0;
        let point = mover.tick(seen);
        if let Some(z) = mover.nominal_z_mm(turns).filter(|_| mover.is_synchronized()) {
            worst = worst.max((point.position[Axis::Z] - z).abs());
        }
        points.push(point);
        assert!(points.len() < 60_000, "the thread does not end");
    }
    (points, worst)
}

#[test]
fn l5_z_keeps_its_lead_within_a_micrometre_at_the_limit_speed() {
    // N = 1200/T − 80: 720 rpm at 1.5 mm, 220 at 4 mm, 20 at 12 mm, 4720 at 0.25 mm.
    for (lead, rpm) in [(1.5, 720.0), (4.0, 220.0), (12.0, 20.0), (0.25, 4_720.0)] {
        let (_, worst) = cut(lead, rpm, 0.3);
        assert!(worst < 0.002, "lead {lead}: {worst} mm");
    }
}

#[test]
fn l5_the_run_out_ends_at_z_with_two_leads_and_two_millimetres_of_diameter() {
    let (points, _) = cut(3.0, 320.0, 0.0);
    let end = points.last().unwrap().position;
    assert!((end[Axis::Z] + 50.0).abs() < 1e-9 && (end[Axis::X] - 4.0).abs() < 1e-9, "{end:?}");
    // X stays until the last 1.2 mm.
    assert!(points.iter().all(|point| point.position[Axis::Z] > -48.8 || point.position[Axis::Z] >= -50.0 - 1e-9));
    let early = points.iter().filter(|point| point.position[Axis::Z] > -48.79);
    assert!(early.clone().all(|point| point.position[Axis::X] < 1e-9 || point.velocity_mm_s[Axis::Z] > -1e-9));
}

/// A drive like the simulated one: critically damped, 2/ω = 20 ms, the set-point held for a tick.
#[derive(Default)]
struct SecondOrderDrive {
    at: f64,
    velocity: f64,
}

impl SecondOrderDrive {
    fn step(&mut self, set: f64) -> f64 {
        const OMEGA: f64 = 100.0;
        let (off, decay) = (self.at - set, (-OMEGA * TICK_S).exp());
        self.at = set + decay * ((1.0 + OMEGA * TICK_S) * off + TICK_S * self.velocity);
        self.velocity = decay * ((1.0 - OMEGA * TICK_S) * self.velocity - OMEGA * OMEGA * TICK_S * off);
        self.at
    }
}

#[test]
fn l5_note_5_the_axis_itself_is_in_step_after_three_leads_at_the_limit_speed() {
    for (lead, rpm) in [(0.25, 4_720.0), (0.35, 3_300.0), (0.5, 2_320.0), (1.5, 720.0), (12.0, 20.0)] {
        for sense in [1.0, -1.0] {
            let thread = ThreadPass {
                run_out_start: MachinePos::new([0.0, 0.0, -48.8]),
                run_out_end: MachinePos::new([1.0, 0.0, -50.0]),
                lead_mm: lead,
            };
            // The spindle has turned forward before, whichever way it turns now.
            let mut turns = 1_000.3;
            let mut mover = ThreadMover::new(thread, MachinePos::default(), limits(), turns, 0.02);
            let (mut drive, mut least, mut most) = (SecondOrderDrive::default(), f64::INFINITY, f64::NEG_INFINITY);
            let mut highest = 0.0_f64;
            for tick in 0.. {
                assert!(tick < 200_000, "lead {lead}: the thread does not end");
                turns += sense * rpm / 60.0 * TICK_S;
                let before = drive.velocity;
                let at = drive.step(mover.tick((turns * 4_800.0).floor() / 4_800.0).position[Axis::Z]);
                highest = highest.max((drive.velocity - before).abs() / TICK_S);
                assert!(at < 0.001, "lead {lead}: it goes back to {at}");
                if mover.is_finished() {
                    break;
                }
                if let Some(belongs) = mover.nominal_z_mm(turns).filter(|_| -at >= 3.0 * lead) {
                    (least, most) = (least.min(at - belongs), most.max(at - belongs));
                }
            }
            assert!((0.0..0.005).contains(&(most - least)), "lead {lead}: {least} to {most}");
            // The set-point asks for more, so that the axis itself has its 800 mm/s²; a twentieth for the encoder's steps.
            assert!(highest < 840.0, "lead {lead}: {highest} mm/s²");
        }
    }
}

#[test]
fn l5_every_pass_finds_the_same_phase() {
    // The spindle keeps turning between two passes: the second pass must follow the same groove.
    let lead = 1.5;
    let at = |phase: f64| {
        let (points, _) = cut(lead, 720.0, phase);
        let ticks = points.iter().position(|point| point.position[Axis::Z] < -30.0).unwrap();
        let turns = phase + 720.0 / 60.0 * TICK_S * (ticks + 1) as f64;
        (points[ticks].position[Axis::Z] + lead * turns).rem_euclid(lead)
    };
    let (first, second) = (at(0.1), at(17.73));
    let apart = (first - second).abs().min(lead - (first - second).abs());
    assert!(apart < 0.002, "{apart}");
}

#[test]
fn l5_the_axes_keep_their_limits() {
    let (points, _) = cut(1.5, 720.0, 0.0);
    for pair in points.windows(2) {
        for axis in [Axis::X, Axis::Z] {
            let velocity = (pair[1].position[axis] - pair[0].position[axis]) / TICK_S;
            assert!(velocity.abs() < 66.0, "{axis} {velocity}");
        }
    }
}

#[test]
fn l5_reset_brakes_within_a_millimetre() {
    let thread = ThreadPass {
        run_out_start: MachinePos::new([0.0, 0.0, -48.8]),
        run_out_end: MachinePos::new([2.5, 0.0, -50.0]),
        lead_mm: 1.5,
    };
    let mut mover = ThreadMover::new(thread, MachinePos::default(), limits(), 0.0, 0.0);
    let mut turns = 0.0;
    while !mover.is_synchronized() {
        turns += 0.012;
        mover.tick(turns);
    }
    let from = mover.tick(turns + 0.012).position[Axis::Z];
    mover.abort();
    let mut at = from;
    while !mover.is_finished() {
        at = mover.tick(turns).position[Axis::Z];
    }
    // v²/2a = 18²/1600 = 0.2 mm plus the jerk phases.
    assert!((at - from).abs() < 1.0);
}
