//! A hand on the simulated machine: it switches outputs and streams set-points, as the control does.

#![allow(dead_code, reason = "every test file uses its part of the rig")]

use kt830::defs::kind::{GrindingForm, Kind};
use kt830::defs::param::{ParamAddress, Params};
use kt830::defs::signal::{Input, Output};
use kt830::io::sim::{EventKind, MachineFile, PartFile, SimulatedMachine};
use kt830::io::{Backend, InputImage, OutputImage};
use kt830::units::{Axis, EncoderPos, Micros, PerAxis};

/// Acceleration of the hand, mm/s²: the control's.
const ACCEL_MM_S2: f64 = 800.0;

pub struct Rig {
    pub sim: SimulatedMachine,
    pub now: Micros,
    pub tick: Micros,
    pub seen: InputImage,
    pub out: OutputImage,
    pub params: Params,
    g54: PerAxis<f64>,
    diameters: bool,
}

/// The machine ready for a run with the part of a program.
pub fn ready(program: u32) -> Rig {
    ready_with(program, |_, _| ())
}

/// The same after changes to machine and part.
pub fn ready_with(program: u32, change: impl FnOnce(&mut MachineFile, &mut PartFile)) -> Rig {
    ready_wired(program, |_| (), change)
}

/// The same with other parameters.
pub fn ready_wired(
    program: u32,
    wire: impl FnOnce(&mut Params),
    change: impl FnOnce(&mut MachineFile, &mut PartFile),
) -> Rig {
    let mut part = PartFile::builtin(program).unwrap().unwrap();
    let mut machine = MachineFile::builtin(part.kind).unwrap();
    change(&mut machine, &mut part);
    let mut params = Params::factory(part.kind);
    wire(&mut params);
    let mut rig = rig(machine, Some(&part), params);
    rig.sim.make_ready();
    rig.out.drives_on = true;
    for output in [Output::Hydraulic, Output::Tailstock, Output::Magnetise] {
        rig.out.terminals.set(rig.params.output_port(output), true);
    }
    rig.sim.write(rig.now, &rig.out);
    rig.step();
    rig
}

/// The machine whose power has just come, without a part.
pub fn cold() -> Rig {
    cold_of(Kind::Gc)
}

/// The same of any kind.
pub fn cold_of(kind: Kind) -> Rig {
    rig(MachineFile::builtin(kind).unwrap(), None, Params::factory(kind))
}

/// A cold machine with its drives on.
pub fn driven_of(kind: Kind) -> Rig {
    driven_with(kind, |_| ())
}

/// The same after a change of the machine.
pub fn driven_with(kind: Kind, change: impl FnOnce(&mut MachineFile)) -> Rig {
    let mut machine = MachineFile::builtin(kind).unwrap();
    change(&mut machine);
    let mut rig = rig(machine, None, Params::factory(kind));
    rig.out.drives_on = true;
    rig.step();
    rig
}

/// The program whose part goes into a kind of machine.
pub fn program_of(kind: Kind) -> u32 {
    match kind.ui().grinding_forms {
        [GrindingForm::Flat, ..] => 1007,
        [GrindingForm::RotaryFlat, ..] => 1010,
        [] | [GrindingForm::Outside | GrindingForm::Bore, ..] => 1002,
    }
}

/// Connects an input that has no port by factory.
pub fn connect(params: &mut Params, input: Input, port: u8) {
    params.write(ParamAddress { number: input.port_param(), bit: None }, f64::from(port)).unwrap();
}

fn rig(machine: MachineFile, part: Option<&PartFile>, params: Params) -> Rig {
    let mut rig = Rig {
        diameters: machine.kind == Kind::Gc,
        sim: SimulatedMachine::new(machine, part, &params, 1),
        now: Micros::ZERO,
        tick: Micros(1_000),
        seen: InputImage::default(),
        out: OutputImage::default(),
        params,
        g54: part.map_or(PerAxis([0.0; 3]), |part| part.g54_mm.displacement()),
    };
    rig.step();
    rig
}

impl Rig {
    pub fn step(&mut self) {
        self.now = self.now + self.tick;
        self.seen = self.sim.read(self.now);
        self.sim.write(self.now, &self.out);
    }

    pub fn wait(&mut self, seconds: f64) {
        let until = self.now + Micros::from_secs_f64(seconds);
        while self.now < until {
            self.step();
        }
    }

    pub fn switch(&mut self, output: Output, on: bool) {
        let port = self.params.output_port(output);
        self.out.terminals.set(port, on);
        self.step();
    }

    /// The input as the control would read it, unfiltered.
    pub fn input(&self, input: Input) -> bool {
        let port = self.params.input_port(input);
        assert_ne!(port, 0, "{} is not connected", input.id());
        self.seen.terminals.is_closed(port) != (self.params.inverted_inputs() >> (port - 1) & 1 == 1)
    }

    /// Wheel and workhead, table or roll up to speed.
    pub fn spin(&mut self) {
        self.switch(Output::Wheel, true);
        self.switch(Output::HeadstockHigh, true); // on GA and GS the same port turns table and roll
        self.wait(9.0);
    }

    /// A straight way to work coordinates, X as a diameter on GC, at a feed of slide travel; ends when the set-point is
    /// there.
    pub fn go(&mut self, x: f64, z: f64, feed_mm_min: f64) {
        let y = self.out.set_point_mm[Axis::Y] + self.sim.encoder_zero_mm()[Axis::Y] - self.g54[Axis::Y];
        self.go_xyz(x, y, z, feed_mm_min);
    }

    /// The same with three axes.
    pub fn go_xyz(&mut self, x: f64, y: f64, z: f64, feed_mm_min: f64) {
        let zero = self.sim.encoder_zero_mm();
        let part = PerAxis([if self.diameters { x / 2.0 } else { x }, y, z]);
        let to = EncoderPos::from_fn(|axis| part[axis] + self.g54[axis] - zero[axis]);
        let from = self.out.set_point_mm;
        let way = Axis::ALL.map(|axis| (to[axis] - from[axis]).powi(2)).iter().sum::<f64>().sqrt();
        let dt = self.tick.as_secs_f64();
        let (mut gone, mut speed) = (0.0_f64, 0.0_f64);
        while gone < way {
            let stopping = (2.0 * ACCEL_MM_S2 * (way - gone)).sqrt().max(0.001);
            speed = (speed + ACCEL_MM_S2 * dt).min(feed_mm_min / 60.0).min(stopping);
            gone = (gone + speed * dt).min(way);
            let share = gone / way;
            self.out.set_point_mm = EncoderPos::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * share);
            self.step();
        }
        self.out.set_point_mm = to;
        self.step();
    }

    /// Jogs one axis by machine travel at a speed, as a plain ramp of set-points.
    pub fn jog(&mut self, axis: Axis, by_mm: f64, speed_mm_s: f64) {
        let ticks = (by_mm.abs() / speed_mm_s / self.tick.as_secs_f64()).round() as u32;
        let from = self.out.set_point_mm[axis];
        for tick in 1..=ticks {
            self.out.set_point_mm[axis] = from + by_mm * f64::from(tick) / f64::from(ticks);
            self.step();
        }
    }

    pub fn events(&self) -> Vec<EventKind> {
        self.sim.events().iter().map(|event| event.kind).collect()
    }
}
