//! The simulated machine: a grinder in numbers behind the same [`Backend`] as real hardware (rows P1–P8).
//!
//! One tick: [`Backend::read`] moves the machine from the last `now` to this one under the outputs last written –
//! axes, spindles, hydraulics, contact of wheel and part – and shows its terminals and encoders.
//! The files: `axis` drives and switches, `spindle` wheel drive and workhead, `hydraulics`, `wheel` shape and wear,
//! `surface` the contact law, `grinding` who meets whom, `wiring` terminals, `inputs` what is shown, `fault` names, `measure`
//! and `report` what can be asked afterwards.
//! GS and GA get surfaces `y(x, z)`, a magnet and gauges (P3, P7) in the same places.

mod axis;
mod contact;
mod fault;
mod grinding;
mod hydraulics;
mod inputs;
mod machine_file;
mod measure;
mod part_file;
mod report;
mod spindle;
mod surface;
mod wheel;
mod wiring;

use self::axis::{Drive, SimAxis};
use self::fault::{Ailing, Fault, InputName};
use self::grinding::{Grinding, Scene};
use self::hydraulics::{Hydraulics, Tick, Valves};
use self::report::EventLog;
use self::spindle::Spindle;
use self::wheel::Wheel;
use self::wiring::Wiring;
use super::random::SplitMix64;
use super::{Backend, InputImage, OutputImage};
use crate::defs::param::Params;
use crate::defs::signal::{Output, OutputSet};
use crate::units::{Axis, Micros, PerAxis};

pub use self::fault::FaultError;
pub use self::machine_file::{
    Along, AxisFile, CuttingFile, DresserFile, HydraulicsFile, MachineFile, SimFileError, WheelFile, WorkheadFile,
};
pub use self::measure::WheelState;
pub use self::part_file::{Body, BodyFile, Looks, OffsetPreset, PartFile, Place, SurfaceFile, TailstockFile};
pub use self::report::{DiameterAt, Event, EventKind, FaceAt, HeightAt, PartReport};

/// Longest step of the physics, µs; a longer tick is cut into several.
const STEP_LIMIT_US: u64 = 4_000;
/// Most steps in one tick; what a longer silence brought is lost.
const STEPS_LIMIT: u64 = 50;

/// The simulated machine.
#[derive(Clone, Debug)]
pub struct SimulatedMachine {
    file: MachineFile,
    axes: PerAxis<Option<SimAxis>>,
    spindle: Spindle,
    workhead: Spindle,
    hydraulics: Hydraulics,
    wheel: Wheel,
    grinding: Grinding,
    wiring: Wiring,
    ailing: Ailing,
    log: EventLog,
    chance: SplitMix64,
    start_mm: PerAxis<f64>,
    tailstock_at_start: bool,
    /// A crash has tripped all drives; switching them off ends it once the axes stand.
    tripped: bool,
    now: Option<Micros>,
    seconds: f64,
    outputs: OutputImage,
    /// Outputs on their way over a late bus.
    outputs_late: Option<OutputImage>,
    on: OutputSet,
    image: InputImage,
    /// Last image made, for a late bus.
    fresh: InputImage,
    detents: i32,
}

impl SimulatedMachine {
    /// A machine whose power has just come, wired as the parameters say now, with a part in it or none.
    #[must_use]
    pub fn new(machine: MachineFile, part: Option<&PartFile>, wiring: &Params, seed: u64) -> Self {
        let power_on = |axis: &Option<SimAxis>| axis.as_ref().map_or(0.0, SimAxis::zero_mm);
        let axes = PerAxis([
            Some(SimAxis::new(machine.x.clone())),
            machine.y.clone().map(SimAxis::new),
            Some(SimAxis::new(machine.z.clone())),
        ]);
        let mut sim = Self {
            start_mm: PerAxis::from_fn(|axis| power_on(&axes[axis])),
            axes,
            spindle: Spindle::wheel(&machine.wheel),
            workhead: Spindle::workhead(&machine.workhead),
            hydraulics: Hydraulics::new(machine.hydraulics.clone()),
            wheel: Wheel::new(&machine.wheel, &machine.cutting),
            grinding: Grinding::new(&machine),
            wiring: Wiring::new(wiring),
            ailing: Ailing::default(),
            log: EventLog::new(),
            chance: SplitMix64::new(seed),
            tailstock_at_start: true,
            tripped: false,
            now: None,
            seconds: 0.0,
            outputs: OutputImage::default(),
            outputs_late: None,
            on: OutputSet::NONE,
            image: InputImage::default(),
            fresh: InputImage::default(),
            detents: 0,
            file: machine,
        };
        sim.set_part(part);
        sim
    }

    /// Begins the machine's chance anew: the next part, bounce and noise follow the seed.
    pub fn reseed(&mut self, seed: u64) {
        self.chance = SplitMix64::new(seed);
    }

    /// Puts another part in, fresh from its file, or takes the part out. The axes stay where they are.
    pub fn set_part(&mut self, part: Option<&PartFile>) {
        self.grinding.set_part(part, &mut self.chance);
        if let Some(part) = part {
            self.start_mm = PerAxis([part.start_mm.x, part.start_mm.y, part.start_mm.z]);
            self.tailstock_at_start = part.tailstock_advanced;
            self.hydraulics.place_tailstock(part.tailstock_advanced);
        }
    }

    /// Makes the machine ready for a run without the way there (T3): axes at the part's start position with their
    /// encoders at zero there, pressure present, tailstock as the part wants it (advanced without a part).
    /// The control must switch hydraulic and tailstock on itself, and learn [`Self::encoder_zero_mm`].
    pub fn start_ready(&mut self) {
        for axis in Axis::ALL {
            if let Some(sim) = &mut self.axes[axis] {
                sim.place(self.start_mm[axis]);
            }
        }
        self.hydraulics.make_ready(self.tailstock_at_start);
    }

    /// Whether a text names a fault that this machine can suffer; for a story to be checked before it is played.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn check_fault(text: &str) -> Result<(), FaultError> {
        self::fault::Fault::parse(text, false).map(drop)
    }

    /// Makes the machine suffer a fault by name.
    ///
    /// # Errors
    /// The name, its input or its number of ticks is wrong; nothing is changed then.
    pub fn fault(&mut self, text: &str) -> Result<(), FaultError> {
        self.suffer(Fault::parse(text, false)?, true);
        Ok(())
    }

    /// Ends a fault by the same name; the number of ticks may be left out.
    ///
    /// # Errors
    /// The name or its input is wrong.
    pub fn clear_fault(&mut self, text: &str) -> Result<(), FaultError> {
        self.suffer(Fault::parse(text, true)?, false);
        Ok(())
    }

    /// The names of all faults; NAME stands for an input's id, N for a number of ticks.
    #[must_use]
    pub const fn fault_names() -> &'static [&'static str] {
        fault::names()
    }

    /// Forces an input, by id or port, logically on or off whatever its polarity; `None` lets it go.
    ///
    /// # Errors
    /// Neither an input's id nor a port.
    pub fn force_input(&mut self, name_or_port: &str, on: Option<bool>) -> Result<(), FaultError> {
        match InputName::parse(name_or_port)? {
            InputName::Input(input) => self.wiring.force(input, on),
            InputName::Port(port) => self.wiring.force_port(port, on),
        }
        Ok(())
    }

    /// Turns the machine's own handwheel, detents, positive clockwise.
    pub const fn turn_handwheel(&mut self, detents: i32) {
        self.detents = self.detents.saturating_add(detents);
    }

    fn suffer(&mut self, fault: Fault, present: bool) {
        match fault {
            Fault::StuckOn(input) => self.wiring.stick(input, present.then_some(true)),
            Fault::StuckOff(input) => self.wiring.stick(input, present.then_some(false)),
            Fault::Bounce(input) => self.wiring.bounce(input, present),
            Fault::PressureLoss => self.ailing.pressure_loss = present,
            Fault::Drive(axis) => self.ailing.drive[axis] = present,
            Fault::Following(axis) => self.ailing.following[axis] = present,
            Fault::GaugeDead => self.ailing.gauge_dead = present,
            Fault::CoolantMissing => self.ailing.coolant_missing = present,
            Fault::LubricationMissing => self.ailing.lubrication_missing = present,
            Fault::SupplyLoss => self.ailing.supply_loss = present,
            Fault::BusLate(ticks) => self.ailing.late_ticks = if present { ticks } else { 0 },
            Fault::BusSilent(ticks) => self.ailing.silent_ticks = if present { ticks } else { 0 },
        }
    }

    /// Moves the machine on by the span since the last read.
    fn advance(&mut self, now: Micros) {
        let span = now.since(self.now.unwrap_or(now)).0;
        self.now = Some(now);
        self.seconds = now.as_secs_f64();
        if span == 0 {
            return;
        }
        let steps = span.div_ceil(STEP_LIMIT_US).min(STEPS_LIMIT);
        let dt_s = (span as f64 / steps as f64).min(STEP_LIMIT_US as f64) / 1e6;
        for _ in 0..steps {
            self.step(dt_s);
        }
    }

    fn step(&mut self, dt_s: f64) {
        let mut crashed = self.move_axes(dt_s);
        let on = self.on;
        self.spindle
            .step(spindle::wheel_target(&self.file.wheel, on.has(Output::Wheel), self.outputs.wheel_volts), dt_s);
        let (high, low) = (on.has(Output::HeadstockHigh), on.has(Output::HeadstockLow));
        self.workhead.step(spindle::workhead_target(&self.file.workhead, high, low, self.outputs.analog_2_volts), dt_s);
        let tick = Tick { dt_s, bounce_s: self.file.bounce_s };
        self.hydraulics.step(&valves(on), self.ailing.pressure_loss, tick, &mut self.chance);
        let axis = |axis: Axis| self.axes[axis].as_ref().map_or((0.0, 0.0), |a| (a.slide_mm(), a.velocity_mm_s()));
        let ((x_mm, vx_mm_s), (z_mm, vz_mm_s)) = (axis(Axis::X), axis(Axis::Z));
        let scene = Scene {
            seconds: self.seconds,
            dt_s,
            x_mm,
            z_mm,
            vx_mm_s,
            vz_mm_s,
            wheel: self.spindle,
            part_rpm: self.workhead.rpm(),
            tailstock_back_mm: self.hydraulics.tailstock_back_mm(),
        };
        crashed |= self.grinding.step(&scene, &mut self.wheel, &mut self.log);
        let standing = vx_mm_s.abs() + vz_mm_s.abs() <= 0.0;
        self.tripped = crashed || (self.tripped && (self.outputs.drives_on || !standing));
    }

    /// True: an axis has run onto its stop at speed.
    fn move_axes(&mut self, dt_s: f64) -> bool {
        let mut crashed = false;
        for axis in Axis::ALL {
            let drive = Drive {
                set_point_mm: self.outputs.set_point_mm[axis],
                on: self.outputs.drives_on && !self.tripped && !self.ailing.drive[axis],
                lost: self.ailing.following[axis],
            };
            let Some(sim) = &mut self.axes[axis] else { continue };
            let Some(struck) = sim.step(drive, dt_s) else { continue };
            if struck.speed_mm_s < self.file.cutting.stop_crash_mm_s {
                continue;
            }
            crashed = true;
            let (x, z) = self.grinding.part_place(self.slide_mm());
            let place = stop_name(axis, struck.plus);
            let (kind, seconds, speed) = (EventKind::Crash, self.seconds, struck.speed_mm_s * 60.0);
            self.log.push(Event { kind, seconds, place, x, z, speed });
        }
        crashed
    }

    fn take(&mut self, outputs: &OutputImage) {
        self.outputs = *outputs;
        self.on = self.wiring.outputs(outputs.terminals);
    }
}

impl Backend for SimulatedMachine {
    fn read(&mut self, now: Micros) -> InputImage {
        if self.ailing.silent_ticks == 0
            && self.ailing.late_ticks == 0
            && let Some(late) = self.outputs_late.take()
        {
            self.take(&late);
        }
        let before = self.now.unwrap_or(now);
        self.advance(now);
        let mut made = self.show(now.since(before));
        if self.ailing.silent_ticks > 0 {
            self.ailing.silent_ticks -= 1;
            self.image.bus_alive = false;
            self.image.handwheel_detents = 0;
            return self.image;
        }
        made.handwheel_detents = std::mem::take(&mut self.detents);
        if self.ailing.late_ticks > 0 {
            // The first late tick has no answer; the following ones have that of the tick before.
            self.ailing.late_ticks -= 1;
            let first = !std::mem::replace(&mut self.ailing.late_before, true);
            let before = std::mem::replace(&mut self.fresh, made);
            self.image = InputImage { bus_alive: !first, ..before };
            return self.image;
        }
        self.ailing.late_before = false;
        self.fresh = made;
        self.image = made;
        made
    }

    fn rewire(&mut self, params: &Params) {
        self.wiring.rewire(params);
        self.on = self.wiring.outputs(self.outputs.terminals);
    }

    fn write(&mut self, _now: Micros, outputs: &OutputImage) {
        if self.ailing.silent_ticks > 0 {
            return; // it never arrives
        }
        if self.ailing.late_ticks > 0 {
            if let Some(late) = self.outputs_late.replace(*outputs) {
                self.take(&late);
            }
            return;
        }
        self.outputs_late = None;
        self.take(outputs);
    }
}

const fn stop_name(axis: Axis, plus: bool) -> &'static str {
    match (axis, plus) {
        (Axis::X, true) => "hard stop X+",
        (Axis::X, false) => "hard stop X-",
        (Axis::Y, true) => "hard stop Y+",
        (Axis::Y, false) => "hard stop Y-",
        (Axis::Z, true) => "hard stop Z+",
        (Axis::Z, false) => "hard stop Z-",
    }
}

fn valves(on: OutputSet) -> Valves {
    Valves {
        pump: on.has(Output::Hydraulic),
        tailstock: on.has(Output::Tailstock),
        radial_gauge: on.has(Output::RadialGauge),
        axial_gauge: on.has(Output::AxialGauge),
        oscillation_forward: on.has(Output::OscillationForward),
        oscillation_backward: on.has(Output::OscillationBackward),
        coolant: on.has(Output::Coolant),
        gears: [Output::Gear1, Output::Gear2, Output::Gear3, Output::Gear4].map(|gear| on.has(gear)),
    }
}
