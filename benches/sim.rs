//! Measures the tick of the simulated machine alone: at rest, everything moving, wheel on the part.
//! `cargo bench --bench sim`

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a bench prints its figures")]

use std::time::Instant;

use kt830::defs::kind::Kind;
use kt830::defs::param::Params;
use kt830::defs::signal::Output;
use kt830::io::sim::{MachineFile, PartFile, SimulatedMachine};
use kt830::io::{Backend, OutputImage};
use kt830::units::{Axis, Micros};

/// Ticks of one measurement.
const TICKS: u64 = 200_000;

struct Bench {
    sim: SimulatedMachine,
    out: OutputImage,
    params: Params,
    tick: u64,
}

impl Bench {
    fn new(program: u32) -> Self {
        let part = PartFile::builtin(program).unwrap().unwrap();
        let params = Params::factory(part.kind);
        let mut sim = SimulatedMachine::new(MachineFile::builtin(part.kind).unwrap(), Some(&part), &params, 1);
        sim.make_ready();
        let out = OutputImage { drives_on: true, ..OutputImage::default() };
        let mut bench = Self { sim, out, params, tick: 0 };
        bench.switch(&[Output::Hydraulic, Output::Tailstock, Output::Magnetise]);
        bench
    }

    fn switch(&mut self, outputs: &[Output]) {
        outputs.iter().for_each(|output| self.out.terminals.set(self.params.output_port(*output), true));
    }

    /// Runs the ticks while `hand` moves the set-points; returns the ns per tick.
    fn run(&mut self, ticks: u64, mut hand: impl FnMut(u64, &mut OutputImage)) -> f64 {
        let begun = Instant::now();
        for tick in 0..ticks {
            self.tick += 1;
            std::hint::black_box(self.sim.read(Micros(self.tick * 1_000)));
            hand(tick, &mut self.out);
            self.sim.write(Micros(self.tick * 1_000), &self.out);
        }
        begun.elapsed().as_nanos() as f64 / ticks as f64
    }
}

/// Triangle wave from 0 to `way` mm and back, `per_tick` mm per tick.
fn triangle_wave(tick: u64, way: f64, per_tick: f64) -> f64 {
    let along = (tick as f64 * per_tick) % (2.0 * way);
    if along < way { along } else { 2.0 * way - along }
}

fn main() {
    for (kind, program) in [(Kind::Gc, 1_002), (Kind::Gs, 1_007), (Kind::Ga, 1_010)] {
        let mut bench = Bench::new(program);
        println!("{:<4} nothing moves          {:6.0} ns a tick", kind.id(), bench.run(TICKS, |_, _| ()));
        bench.switch(&[Output::Wheel, Output::HeadstockHigh, Output::RadialGauge]);
        let spinning = bench.run(TICKS, |tick, out| out.set_point_mm[Axis::X] = triangle_wave(tick, 20.0, 0.05));
        println!("{:<4} all turns, X moves      {spinning:6.0} ns a tick", kind.id());
    }
    let mut bench = Bench::new(1_007);
    bench.switch(&[Output::Wheel]);
    // From X-30 Y60 Z-45: 55 mm across to Z10, down to Y20.12, then further down at 0.5 µm/s.
    bench.run(20_000, |tick, out| out.set_point_mm[Axis::Z] = (tick as f64 * 0.05).min(55.0));
    bench.run(20_000, |tick, out| out.set_point_mm[Axis::Y] = -(tick as f64 * 0.01).min(39.88));
    let grinding = bench.run(TICKS, |tick, out| {
        out.set_point_mm[Axis::X] = triangle_wave(tick, 260.0, 0.2);
        out.set_point_mm[Axis::Y] = -39.88 - tick as f64 * 5e-7;
    });
    println!("gs   grinds a plane         {grinding:6.0} ns a tick, {} events", bench.sim.events().len());
}
