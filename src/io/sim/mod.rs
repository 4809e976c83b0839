//! The simulated machine: a grinder in numbers behind the same [`Backend`] as real hardware (rows P1–P8).
//!
//! One tick: [`Backend::read`] moves the machine from the last `now` to this one under the outputs last written –
//! axes, spindles, hydraulics, contact of wheel and part – and shows its terminals and encoders.
//! The files: `axis` drives and switches, `spindle` all that turns, `hydraulics`, `magnet`, `gauge`, `wheel` shape and
//! wear, `surface` the contact law, `profile` and `plane` the cells, `obstacle`, `grinding` who meets whom, `scatter` what the seed changes, `wiring`
//! terminals, `turning` a lathe's spindle, post and bar, `inputs` what is shown, `fault` names, `measure` and `report` what can be asked afterwards.
//! What a kind of machine is made of stands in its file alone: which axis takes the wheel to the part and what turns.

mod axis;
mod contact;
mod fault;
mod gauge;
mod grinding;
mod hydraulics;
mod inputs;
mod lathe_rehearsal;
mod machine_file;
mod machine_rows;
mod magnet;
mod measure;
mod obstacle;
mod part_file;
mod plane;
mod profile;
mod report;
mod scatter;
mod spindle;
mod surface;
mod turning;
mod wheel;
mod wiring;

use self::axis::{Drive, SimAxis};
use self::fault::Ailing;
use self::gauge::{Found, Gauges};
use self::grinding::{Grinding, Scene};
use self::hydraulics::{Hydraulics, Tick, Valves};
use self::magnet::{Current, Magnet};
use self::report::EventLog;
use self::spindle::Spindles;
use self::turning::Turning;
use self::wheel::Wheel;
use self::wiring::Wiring;
use super::random::SplitMix64;
use super::{Backend, InputImage, OutputImage};
use crate::defs::param::{self, Params};
use crate::defs::signal::{Output, OutputSet};
use crate::units::{Axis, Micros, PerAxis};

pub use self::fault::FaultError;
pub use self::lathe_rehearsal::LatheRehearsal;
pub use self::machine_file::{MachineFile, SimFileError};
pub use self::machine_rows::{
    Along, AxisFile, CuttingFile, DresserFile, DriveFile, GaugesFile, HydraulicsFile, LayoutFile, MagnetFile,
    MainSpindleFile, PlateFile, ProbeFile, QuillFile, RollFile, ScatterFile, SecondSpindleFile, ToolFile, ToolPostFile,
    WheelFile,
};
pub use self::measure::WheelState;
pub use self::part_file::{
    BarFile, BlockFile, Body, BodyFile, FinishedFile, GaugeFile, Looks, OffsetPreset, PartFile, Place, SurfaceFile,
    TailstockFile,
};
pub use self::report::{DiameterAt, Event, EventKind, FaceAt, HeightAt, PartReport};
pub use self::turning::LatheScene;

/// Longest step of the physics, µs; a longer tick is cut into several.
const STEP_LIMIT_US: u64 = 4_000;
/// Most steps in one tick; what a longer silence brought is lost.
const STEPS_LIMIT: u64 = 50;

/// The simulated machine.
#[derive(Clone, Debug)]
pub struct SimulatedMachine {
    file: MachineFile,
    axes: PerAxis<Option<SimAxis>>,
    spindles: Spindles,
    hydraulics: Hydraulics,
    magnet: Option<Magnet>,
    gauges: Gauges,
    wheel: Wheel,
    grinding: Grinding,
    /// Spindle, tool post and bar of a lathe.
    turning: Option<Turning>,
    wiring: Wiring,
    ailing: Ailing,
    log: EventLog,
    chance: SplitMix64,
    start_mm: PerAxis<f64>,
    tailstock_at_start: bool,
    /// A crash has tripped all drives; switching them off ends it once the axes stand.
    tripped: bool,
    /// The wheel turns faster than it is made for.
    overspeed: bool,
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
        let axes = fitted(&machine, wiring);
        let mut sim = Self {
            start_mm: PerAxis::from_fn(|axis| axes[axis].as_ref().map_or(0.0, SimAxis::zero_mm)),
            axes,
            spindles: Spindles::new(&machine),
            hydraulics: Hydraulics::new(machine.hydraulics.clone()),
            magnet: machine.magnet.clone().map(Magnet::new),
            gauges: Gauges::new(machine.gauges.clone()),
            wheel: Wheel::new(&machine.wheel, &machine.cutting),
            grinding: Grinding::new(&machine),
            turning: machine.main_spindle.clone().zip(machine.tool_post.clone()).map(|(s, p)| Turning::new(s, p)),
            wiring: Wiring::new(wiring),
            ailing: Ailing::default(),
            log: EventLog::new(),
            chance: SplitMix64::new(seed),
            tailstock_at_start: true,
            tripped: false,
            overspeed: false,
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
        sim.scatter(seed);
        sim.set_part(part);
        sim.shape_tools(wiring);
        sim
    }

    fn shape_tools(&mut self, params: &Params) {
        if let Some(turning) = &mut self.turning {
            turning.shape_tools(params);
        }
    }

    /// The power comes again, with the parameters of now: the terminals are wired as they say, and an axis Y that they fit
    /// (P6.6) is there, or not. All else stays as it was.
    pub fn power_on(&mut self, wiring: &Params) {
        self.rewire(wiring);
        let mut axes = fitted(&self.file, wiring);
        for axis in Axis::ALL {
            if let (Some(there), Some(kept)) = (&mut axes[axis], self.axes[axis].take()) {
                *there = kept;
            }
        }
        self.axes = axes;
    }

    /// Begins the machine's chance anew: the next part, bounce, noise and scatter follow the seed.
    pub fn reseed(&mut self, seed: u64) {
        self.chance = SplitMix64::new(seed);
        self.scatter(seed);
    }

    /// Puts another part in, fresh from its file, or takes the part out. The axes stay where they are. A part
    /// for another kind of machine does not fit in.
    pub fn set_part(&mut self, part: Option<&PartFile>) {
        let part = part.filter(|part| part.kind == self.file.kind);
        self.log.begin_part();
        self.grinding.set_part(part, &mut self.chance);
        if let Some(turning) = &mut self.turning {
            turning.set_part(part);
        }
        if let Some(part) = part {
            self.start_mm = PerAxis([part.start_mm.x, part.start_mm.y, part.start_mm.z]);
            self.tailstock_at_start = part.tailstock_advanced;
            self.hydraulics.place_tailstock(part.tailstock_advanced);
        }
    }

    /// Makes the machine ready for a run without the way there (T3): axes at the part's start position with their
    /// encoders at zero there, pressure present, tailstock as the part wants it (advanced without a part), magnetised.
    /// The control must switch hydraulic, tailstock and magnetise on itself in its first tick, and learn
    /// [`Self::encoder_zero_mm`].
    pub fn start_ready(&mut self) {
        for axis in Axis::ALL {
            if let Some(sim) = &mut self.axes[axis] {
                sim.place(self.start_mm[axis]);
            }
        }
        self.hydraulics.make_ready(self.tailstock_at_start);
        if let Some(magnet) = &mut self.magnet {
            magnet.make_ready();
        }
    }

    /// Turns the machine's own handwheel, detents, positive clockwise.
    pub const fn turn_handwheel(&mut self, detents: i32) {
        self.detents = self.detents.saturating_add(detents);
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
        self.log.stand(PerAxis::from_fn(|axis| self.axes[axis].as_ref().map_or(0.0, SimAxis::slide_mm)));
        let mut crashed = self.move_axes(dt_s);
        let on = self.on;
        self.spindles.step(&self.file, on, (self.outputs.wheel_volts, self.outputs.analog_2_volts), dt_s);
        let tick = Tick { dt_s, bounce_s: self.file.bounce_s };
        self.hydraulics.step(&valves(on), self.ailing.pressure_loss, tick, &mut self.chance);
        if let Some(magnet) = &mut self.magnet {
            magnet.step(Current::of(on.has(Output::Magnetise), on.has(Output::Demagnetise)), dt_s);
        }
        if let Some(turning) = &mut self.turning {
            turning.drive(on, self.outputs.wheel_volts, dt_s);
        }
        let scene = self.scene(dt_s);
        crashed |= match &mut self.turning {
            Some(turning) => turning
                .cut(&scene)
                .is_some_and(|place| self.log.push(self.grinding.event(EventKind::Crash, place, &scene))),
            None => self.grinding.step(&scene, &mut self.wheel, &mut self.log),
        };
        self.supervise_speed(&scene);
        let found = Found {
            over_um: if self.hydraulics.radial_arm.is_out() { self.grinding.over_um() } else { None },
            pressed_mm: self.grinding.pressed_mm(&scene),
        };
        self.gauges.step(found, dt_s, &mut self.chance);
        let standing = scene.speed_mm_s.0.iter().all(|v| v.abs() <= 0.0);
        self.tripped = crashed || (self.tripped && (self.outputs.drives_on || !standing));
    }

    fn scene(&self, dt_s: f64) -> Scene {
        let of = |axis: Axis, value: fn(&SimAxis) -> f64| self.axes[axis].as_ref().map_or(0.0, value);
        Scene {
            seconds: self.seconds,
            dt_s,
            slide_mm: PerAxis::from_fn(|axis| of(axis, SimAxis::slide_mm)),
            speed_mm_s: PerAxis::from_fn(|axis| of(axis, SimAxis::velocity_mm_s)),
            wheel: self.spindles.wheel,
            wheel_m_s: self.wheel().peripheral_m_s,
            part_rpm: self.spindles.part_rpm(),
            roll_rpm: self.spindles.roll_rpm(),
            tailstock_back_mm: self.hydraulics.tailstock_back_mm(),
            held: self.magnet.as_ref().is_none_or(Magnet::holds),
            probe_out: self.hydraulics.axial_arm.is_out(),
        }
    }

    /// Tells once that the wheel turns faster than it is made for.
    fn supervise_speed(&mut self, scene: &Scene) {
        let over = scene.wheel_m_s > self.file.wheel.rated_m_s;
        if over && !self.overspeed {
            self.log.push(self.grinding.event(EventKind::Overspeed, "wheel", scene));
        }
        self.overspeed = over;
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
            let at = self.grinding.event(EventKind::Crash, stop_name(axis, struck.plus), &self.scene(dt_s));
            crashed |= self.log.push(Event { speed: struck.speed_mm_s * 60.0, ..at });
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
        self.shape_tools(params);
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

/// The axes of a machine, as its file and the parameters say.
fn fitted(machine: &MachineFile, params: &Params) -> PerAxis<Option<SimAxis>> {
    machine.axes(params.bit(param::Y_FITTED)).map(|file| file.cloned().map(SimAxis::new))
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
