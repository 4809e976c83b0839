//! The simulated machine: a model of a grinder or lathe that implements the same [`Backend`] as hardware (rows P1–P8).
//! [`Backend::read`] advances the model from the last `now` to this one under the outputs last written (axes, spindles,
//! hydraulics, contact of wheel and part), then returns terminals and encoders.
//! Files: `axis` drives and switches, `spindle`, `hydraulics`, `magnet`, `gauge`, `wheel` shape and wear, `surface` the
//! contact law, `cell_row`, `profile` and `plane` the cells, `obstacle`, `grinding` the contacts of the wheel, `scatter` seeded
//! variation, `wiring` terminals, `lathe` spindle, turret and bar of a lathe, `inputs` the input image, `fault` named
//! faults, `measure` and `report` queries and results, `drawing` the judgement of a part, `thermal` growth, `vibration` of
//! the wheel, `machine_variation` other machines of a kind. The machine file alone defines which axes and spindles exist.

mod axis;
mod bending;
mod cell_row;
mod contact;
mod contact_law;
mod drawing;
mod fault;
mod file_error;
mod gauge;
mod grinding;
mod heat;
mod hydraulics;
mod inputs;
mod interference_check;
mod lathe;
mod machine_file;
mod machine_sections;
mod machine_variation;
mod magnet;
mod measure;
mod obstacle;
mod part_file;
mod part_heat;
mod plane;
mod profile;
mod report;
mod roughness;
mod scatter;
mod spindle;
mod surface;
mod thermal;
mod vibration;
mod wheel;
mod wiring;

use self::axis::{AxisCommand, SimAxis};
use self::fault::ActiveFaults;
use self::gauge::{GaugeContact, Gauges};
use self::grinding::{Grinding, MachineState};
use self::hydraulics::{Hydraulics, StepTimes};
use self::lathe::SimLathe;
use self::magnet::{CoilCommand, SimMagnet};
use self::report::EventLog;
use self::spindle::GrinderSpindles;
use self::wheel::GrindingWheel;
use self::wiring::Wiring;
use super::random::SplitMix64;
use super::{Backend, InputImage, OutputImage};
use crate::defs::param::{self, Params};
use crate::defs::signal::{Output, OutputSet};
use crate::units::{Axis, MachinePos, Micros, PerAxis};

pub use self::bending::{InternalSpindleFile, ShaftFile};
pub use self::drawing::{Deviation, DrawingFeature, DrawingSize};
pub use self::fault::FaultError;
pub use self::file_error::SimFileError;
pub use self::interference_check::InterferenceCheck;
pub use self::machine_file::MachineFile;
pub use self::machine_sections::{
    AxisFile, CuttingFile, DresserFile, DriveFile, GaugesFile, HydraulicsFile, LayoutFile, MagnetFile, MainSpindleFile,
    PlateFile, ProbeFile, QuillFile, RollFile, ScatterFile, SecondSpindleFile, TablePoint, ToolFile, ToolTurretFile,
    WheelFile,
};
pub use self::machine_variation::{MachineVariation, VARIATIONS};
pub use self::measure::{ProcessState, WheelState};
pub use self::part_file::{
    BarFile, BlockFile, BodyFile, BodyKind, FaceDirection, FinishedSizeFile, GaugeSetupFile, OffsetPreset, PartFile,
    SlidePosition, SurfaceFile, TailstockFile,
};
pub use self::part_heat::PartHeatFile;
pub use self::report::{DiameterAt, EventKind, FaceAt, HeightAt, PartReport, SimEvent};
pub use self::roughness::SurfaceRoughness;
pub use self::thermal::ThermalFile;
pub use self::vibration::VibrationFile;

/// Longest step of the physics, µs; a longer tick is divided into several steps.
const STEP_LIMIT_US: u64 = 4_000;
/// Greatest number of steps in one tick; time beyond them is not simulated.
const STEPS_LIMIT: u64 = 50;

/// The simulated machine.
#[derive(Clone, Debug)]
pub struct SimulatedMachine {
    file: MachineFile,
    axes: PerAxis<Option<SimAxis>>,
    spindles: GrinderSpindles,
    hydraulics: Hydraulics,
    magnet: Option<SimMagnet>,
    gauges: Gauges,
    wheel: GrindingWheel,
    /// The internal grinding spindle that is swung in; its wheel is `wheel` then.
    internal: Option<InternalSpindleFile>,
    /// The wheel of the wheel head while the internal grinding spindle is swung in.
    outer_wheel: Option<GrindingWheel>,
    /// The wheel of the internal spindle that was swung out last.
    inner_wheel: Option<(InternalSpindleFile, GrindingWheel)>,
    /// Batch of the wheels: factors of grinding ratio and dulling.
    wheel_factors: [f64; 2],
    grinding: Grinding,
    /// Spindle, tool turret and bar of a lathe.
    lathe: Option<SimLathe>,
    wiring: Wiring,
    active_faults: ActiveFaults,
    log: EventLog,
    rng: SplitMix64,
    start_mm: MachinePos,
    tailstock_at_start: bool,
    /// A crash has tripped all drives. Cleared when the drives are off and the axes are at rest.
    tripped: bool,
    /// The wheel turns faster than its rated speed.
    overspeed: bool,
    now: Option<Micros>,
    seconds: f64,
    outputs: OutputImage,
    /// Outputs delayed by one tick (fault `bus-late`).
    delayed_outputs: Option<OutputImage>,
    active_outputs: OutputSet,
    image: InputImage,
    /// Latest image; a late bus delivers it one tick later.
    latest_image: InputImage,
    pending_detents: i32,
}

impl SimulatedMachine {
    /// A machine at power-on, wired as the parameters define, with or without a part.
    #[must_use]
    pub fn new(machine: MachineFile, part: Option<&PartFile>, wiring: &Params, seed: u64) -> Self {
        let axes = fitted_axes(&machine, wiring);
        let mut sim = Self {
            start_mm: MachinePos::from_fn(|axis| axes[axis].as_ref().map_or(0.0, |sim| sim.encoder_zero_mm)),
            axes,
            spindles: GrinderSpindles::new(&machine),
            hydraulics: Hydraulics::new(machine.hydraulics.clone()),
            magnet: machine.magnet.clone().map(SimMagnet::new),
            gauges: Gauges::new(machine.gauges.clone()),
            wheel: GrindingWheel::new(&machine.wheel, &machine.cutting),
            internal: None,
            outer_wheel: None,
            inner_wheel: None,
            wheel_factors: [1.0; 2],
            grinding: Grinding::new(&machine),
            lathe: machine.main_spindle.clone().zip(machine.tool_post.clone()).map(|(s, p)| SimLathe::new(s, p)),
            wiring: Wiring::new(wiring),
            active_faults: ActiveFaults::default(),
            log: EventLog::new(),
            rng: SplitMix64::new(seed),
            tailstock_at_start: true,
            tripped: false,
            overspeed: false,
            now: None,
            seconds: 0.0,
            outputs: OutputImage::default(),
            delayed_outputs: None,
            active_outputs: OutputSet::NONE,
            image: InputImage::default(),
            latest_image: InputImage::default(),
            pending_detents: 0,
            file: machine,
        };
        sim.apply_scatter(seed);
        sim.set_part(part);
        sim.apply_tool_shapes(wiring);
        sim
    }

    fn apply_tool_shapes(&mut self, params: &Params) {
        if let Some(turning) = &mut self.lathe {
            turning.apply_tool_shapes(params);
        }
    }

    /// Power-on with the current parameters: rewires the terminals and adds or removes the optional axis Y (P6.6).
    /// Everything else is kept.
    pub fn power_on(&mut self, wiring: &Params) {
        self.rewire(wiring);
        let mut axes = fitted_axes(&self.file, wiring);
        for axis in Axis::ALL {
            if let (Some(there), Some(kept)) = (&mut axes[axis], self.axes[axis].take()) {
                *there = kept;
            }
        }
        self.axes = axes;
    }

    /// Restarts the random numbers: bounce, noise, scatter and the next part follow the new seed.
    pub fn reseed(&mut self, seed: u64) {
        self.rng = SplitMix64::new(seed);
        self.apply_scatter(seed);
    }

    /// Loads a new part from its file, or removes the part. The axes do not move. A part for another kind of machine
    /// is not loaded.
    pub fn set_part(&mut self, part: Option<&PartFile>) {
        let part = part.filter(|part| part.kind == self.file.kind);
        self.log.begin_part();
        self.swing_spindle(part.and_then(|part| part.internal_spindle.clone()));
        self.grinding.set_part(part, &mut self.rng);
        if let Some(turning) = &mut self.lathe {
            turning.set_part(part);
        }
        if let Some(part) = part {
            self.start_mm = part.start_mm.machine();
            self.tailstock_at_start = part.tailstock_advanced;
            self.hydraulics.place_tailstock(part.tailstock_advanced);
        }
    }

    /// Swings the internal grinding spindle in or out. Each spindle keeps its wheel; another internal spindle comes with a
    /// new one.
    fn swing_spindle(&mut self, internal: Option<InternalSpindleFile>) {
        if internal == self.internal {
            return;
        }
        let parked = match &internal {
            Some(file) if self.inner_wheel.as_ref().is_none_or(|(known, _)| known != file) => {
                let shape = file.wheel(&self.file.wheel);
                self.grinding.fit_inner_diamond();
                let mut wheel = GrindingWheel::new(&shape, &self.file.cutting);
                wheel.set_batch_factors(&shape, &self.file.cutting, self.wheel_factors);
                Some(wheel)
            }
            Some(_) => self.inner_wheel.take().map(|(_, wheel)| wheel),
            None => self.outer_wheel.take(),
        };
        let Some(next) = parked else { return };
        let before = std::mem::replace(&mut self.wheel, next);
        match std::mem::replace(&mut self.internal, internal) {
            Some(file) => self.inner_wheel = Some((file, before)),
            None => self.outer_wheel = Some(before),
        }
    }

    /// Sets the state in which a run starts, without the moves that lead to it (T3): axes at the part's start position,
    /// encoders at zero there, pressure present, tailstock as in the part file (advanced without a part), magnet on.
    /// The control must switch hydraulics, tailstock and magnet on in its first tick and take over
    /// [`Self::encoder_zero_mm`].
    pub fn make_ready(&mut self) {
        for axis in Axis::ALL {
            if let Some(sim) = &mut self.axes[axis] {
                sim.reset_at(self.start_mm[axis]);
            }
        }
        self.hydraulics.make_ready(self.tailstock_at_start);
        if let Some(magnet) = &mut self.magnet {
            magnet.make_ready();
        }
    }

    /// Turns the handwheel by a number of detents, positive clockwise.
    pub const fn turn_handwheel(&mut self, detents: i32) {
        self.pending_detents = self.pending_detents.saturating_add(detents);
    }

    /// Advances the machine by the time since the last read.
    fn advance(&mut self, now: Micros) {
        let span = now.since(self.now.unwrap_or(now)).0;
        self.now = Some(now);
        self.seconds = now.as_secs_f64();
        if span == 0 {
            return;
        }
        let steps = span.div_ceil(STEP_LIMIT_US).min(STEPS_LIMIT);
        let dt_s = (span as f64 / steps as f64).min(STEP_LIMIT_US as f64) / 1e6;
        (0..steps).for_each(|_| self.step(dt_s));
    }

    fn step(&mut self, dt_s: f64) {
        if let (Some(thermal), Some(infeed)) = (self.file.thermal, &mut self.axes[self.file.layout.infeed]) {
            infeed.thermal_mm = thermal.step_mm(infeed.thermal_mm, dt_s);
        }
        self.log.set_slides(self.slide_mm());
        let mut crashed = self.move_axes(dt_s);
        let on = self.active_outputs;
        self.spindles.step(&self.file, &self.outputs, on, dt_s);
        let tick = StepTimes { dt_s, bounce_s: self.file.bounce_s };
        self.hydraulics.step(on, self.active_faults.pressure_loss, tick, &mut self.rng);
        if let Some(magnet) = &mut self.magnet {
            magnet.step(CoilCommand::from_outputs(on.has(Output::Magnetise), on.has(Output::Demagnetise)), dt_s);
        }
        if let Some(turning) = &mut self.lathe {
            turning.step(on, self.outputs.wheel_volts, dt_s);
        }
        let scene = self.machine_state(dt_s);
        crashed |= match &mut self.lathe {
            Some(turning) => turning
                .cut(&scene)
                .is_some_and(|place| self.log.push(self.grinding.event(EventKind::Crash, place, &scene))),
            None => self.grinding.step(&scene, &mut self.wheel, &mut self.log),
        };
        self.check_overspeed(&scene);
        let is_out = self.hydraulics.radial_arm.is_at_front();
        let found = GaugeContact {
            oversize_um: is_out.then(|| self.grinding.oversize_um(&scene, self.wheel.width_mm)).flatten(),
            probe_deflection_mm: self.grinding.probe_deflection_mm(&scene),
        };
        self.gauges.step(found, dt_s, scene.coolant_flows, &mut self.rng);
        let standing = scene.speed_mm_s.0.iter().all(|v| v.abs() <= 0.0);
        self.tripped = crashed || (self.tripped && (self.outputs.drives_on || !standing));
    }

    /// A value of an axis; zero if the machine does not have it.
    fn axis_value(&self, axis: Axis, value: impl Fn(&SimAxis) -> f64) -> f64 {
        self.axes[axis].as_ref().map_or(0.0, value)
    }

    fn machine_state(&self, dt_s: f64) -> MachineState {
        MachineState {
            seconds: self.seconds,
            dt_s,
            slide_mm: self.slide_mm(),
            speed_mm_s: PerAxis::from_fn(|axis| self.axis_value(axis, |sim| sim.velocity_mm_s)),
            wheel: self.spindles.wheel,
            wheel_m_s: self.wheel().peripheral_m_s,
            part_rpm: self.spindles.part_rpm(),
            on_table: self.file.table.is_some(),
            coolant_flows: self.hydraulics.coolant_flows() && !self.active_faults.coolant_missing,
            roll_rpm: self.roll_rpm(),
            tailstock_retracted_mm: self.hydraulics.tailstock_retracted_mm(),
            part_held: self.magnet.as_ref().is_none_or(SimMagnet::holds),
            probe_out: self.hydraulics.axial_arm.is_at_front(),
        }
    }

    /// Logs one event when the wheel exceeds its rated peripheral speed.
    fn check_overspeed(&mut self, scene: &MachineState) {
        let over = scene.wheel_m_s > self.file.wheel.rated_m_s;
        if over && !self.overspeed {
            self.log.push(self.grinding.event(EventKind::Overspeed, "wheel", scene));
        }
        self.overspeed = over;
    }

    /// Moves the axes; true if one has hit its hard stop at crash speed.
    fn move_axes(&mut self, dt_s: f64) -> bool {
        let mut crashed = false;
        for axis in Axis::ALL {
            let drive = AxisCommand {
                set_point_mm: self.outputs.set_point_mm[axis],
                on: self.outputs.drives_on && !self.tripped && !self.active_faults.drive[axis],
                following_lost: self.active_faults.following[axis],
            };
            let Some(sim) = &mut self.axes[axis] else { continue };
            let Some(struck) = sim.step(drive, dt_s) else { continue };
            if struck.speed_mm_s < self.file.cutting.stop_crash_mm_s {
                continue;
            }
            let at = self.grinding.event(EventKind::Crash, stop_name(axis, struck.plus), &self.machine_state(dt_s));
            crashed |= self.log.push(SimEvent { speed: struck.speed_mm_s * 60.0, ..at });
        }
        crashed
    }

    fn apply_outputs(&mut self, outputs: &OutputImage) {
        self.outputs = *outputs;
        self.active_outputs = self.wiring.outputs(outputs.terminals);
    }
}

impl Backend for SimulatedMachine {
    fn read(&mut self, now: Micros) -> InputImage {
        if self.active_faults.silent_ticks == 0
            && self.active_faults.late_ticks == 0
            && let Some(late) = self.delayed_outputs.take()
        {
            self.apply_outputs(&late);
        }
        let before = self.now.unwrap_or(now);
        self.advance(now);
        let mut made = self.input_image(now.since(before));
        if self.active_faults.silent_ticks > 0 {
            self.active_faults.silent_ticks -= 1;
            self.image.bus_alive = false;
            self.image.handwheel_detents = 0;
            return self.image;
        }
        made.handwheel_detents = std::mem::take(&mut self.pending_detents);
        if self.active_faults.late_ticks > 0 {
            // The first late tick has no answer; each following one delivers the image of the tick before.
            self.active_faults.late_ticks -= 1;
            let first = !std::mem::replace(&mut self.active_faults.was_late, true);
            let before = std::mem::replace(&mut self.latest_image, made);
            self.image = InputImage { bus_alive: !first, ..before };
            return self.image;
        }
        self.active_faults.was_late = false;
        self.latest_image = made;
        self.image = made;
        made
    }

    fn rewire(&mut self, params: &Params) {
        self.wiring.rewire(params);
        self.apply_tool_shapes(params);
        self.active_outputs = self.wiring.outputs(self.outputs.terminals);
    }

    fn write(&mut self, _now: Micros, outputs: &OutputImage) {
        if self.active_faults.silent_ticks > 0 {
            return; // the outputs do not arrive
        }
        if self.active_faults.late_ticks > 0 {
            if let Some(late) = self.delayed_outputs.replace(*outputs) {
                self.apply_outputs(&late);
            }
            return;
        }
        self.delayed_outputs = None;
        self.apply_outputs(outputs);
    }
}

/// The axes that machine file and parameters define.
fn fitted_axes(machine: &MachineFile, params: &Params) -> PerAxis<Option<SimAxis>> {
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
