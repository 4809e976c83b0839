//! The simulated machine of a tortured control, with what really passes between the two: planted bugs act here.

use std::hash::{BuildHasher, RandomState};
use std::sync::Arc;

use super::planted::PlantedBug;
use crate::defs::key::Key;
use crate::defs::param::Params;
use crate::defs::signal::{Input, Output, OutputSet, Terminals};
use crate::defs::text::LocalizedText;
use crate::host::hosted_machine::HostedMachine;
use crate::host::pace::{Pace, ThreadTimes};
use crate::host::simulated::HostedSimulation;
use crate::io::fieldbus::ClockReading;
use crate::io::random::SplitMix64;
use crate::io::sim::{PartFile, SimulatedMachine};
use crate::io::{Backend, InputImage, OutputImage};
use crate::link::bus::BusView;
use crate::link::command::Command;
use crate::link::simulation::{SimCommand, SimView};
use crate::units::{Axis, Micros};

/// How far a planted jump goes, mm.
const JUMP_MM: f64 = 0.05;

/// Steps that differ by less belong to one speed, mm.
const EVEN_MM: f64 = 1e-9;
/// Ticks after power-on before a bug acts: the inputs are read by then.
const QUIET_TICKS: u64 = 500;
/// In so many ticks the axes are homed.
const HOMING_TICKS: u64 = 10_000;

/// A simulated machine whose images can be looked at.
pub struct WatchedMachine {
    machine: HostedSimulation,
    params: Params,
    bug: Option<PlantedBug>,
    chance: SplitMix64,
    /// As the machine gave it.
    pub read: InputImage,
    /// As the machine got it.
    pub written: OutputImage,
    /// Outputs that a bug keeps on.
    stuck: OutputSet,
    /// Outputs that a bug has taken from the control.
    forced: &'static [(Output, bool)],
    /// The drives were on in the last tick.
    drives_were_on: bool,
    /// A bug keeps the tailstock's valve off.
    released: bool,
    /// RESET is among the commands of this tick.
    was_reset: bool,
    /// Set-point of X that the control wants, mm.
    wanted_mm: f64,
    /// What a bug adds to X, mm.
    offset_mm: f64,
    /// By how much a bug makes the step of this tick longer, mm.
    surplus_mm: f64,
    /// Its last step, mm.
    step_mm: f64,
    /// Ticks since the set-points came to rest.
    at_rest: u32,
    ticks: u64,
    powered: bool,
}

impl WatchedMachine {
    /// A machine; `params` say on which terminals its signals are.
    #[must_use]
    pub fn new(machine: HostedSimulation, params: Params, seed: u64, bug: Option<PlantedBug>) -> Self {
        Self {
            machine,
            params,
            bug,
            chance: SplitMix64::new(seed),
            read: InputImage::default(),
            written: OutputImage::default(),
            stuck: OutputSet::NONE,
            forced: &[],
            drives_were_on: false,
            released: false,
            was_reset: false,
            wanted_mm: 0.0,
            offset_mm: 0.0,
            surplus_mm: 0.0,
            step_mm: 0.0,
            at_rest: 0,
            ticks: 0,
            powered: true,
        }
    }

    /// How far a bug moves an axis from where the control wants it, mm.
    #[must_use]
    pub fn tampered_mm(&self, axis: Axis) -> f64 {
        if axis == Axis::X { self.offset_mm } else { 0.0 }
    }

    /// The power goes or comes.
    pub fn set_powered(&mut self, powered: bool) {
        self.powered = powered;
        (self.stuck, self.released, self.offset_mm) = (OutputSet::NONE, false, 0.0);
        (self.forced, self.ticks) = (&[], 0);
    }

    /// What the operator asks for in this tick; some bugs act on it.
    pub fn hear(&mut self, commands: &[Command]) {
        self.was_reset = commands.iter().any(|command| matches!(command, Command::Press(Key::Reset)));
        for command in commands {
            let Command::Press(key) = command else { continue };
            match (self.bug, key) {
                (Some(PlantedBug::KeyForces(own, outputs)), key) if own == *key => self.forced = outputs,
                (Some(PlantedBug::WheelIgnoresHydraulics), Key::WheelStart) if !self.is_on(Output::Hydraulic) => {
                    self.stuck.set(Output::Wheel, true);
                }
                (Some(PlantedBug::HydraulicsIgnoreWheel), Key::Hydraulic) if self.is_on(Output::Wheel) => {
                    self.stuck.set(Output::Hydraulic, true);
                }
                (Some(PlantedBug::TailstockIgnoresHeadstock), Key::TailstockRetract) => self.released = true,
                (Some(PlantedBug::MagnetIgnoresWheel), Key::Demagnetise) if self.is_on(Output::Wheel) => {
                    self.stuck.set(Output::Demagnetise, true);
                }
                (Some(PlantedBug::HeadstockIgnoresGuard), Key::HeadstockHigh)
                    if !self.is_active(Input::GuardClosed) =>
                {
                    self.stuck.set(Output::HeadstockHigh, true);
                }
                (Some(PlantedBug::TableIgnoresMagnet), Key::TableRotation) if !self.is_on(Output::Magnetise) => {
                    self.stuck.set(Output::TableRotation, true);
                }
                (_, Key::WheelStop | Key::Reset) => self.stuck = OutputSet::NONE,
                _ => {}
            }
        }
    }

    fn is_on(&self, output: Output) -> bool {
        self.written.terminals.is_closed(self.params.output_port(output))
    }

    /// Whether an input is active at the machine.
    #[must_use]
    pub fn is_active(&self, input: Input) -> bool {
        is_active(&self.params, self.read.terminals, input)
    }

    fn blind(&self, image: &mut InputImage, input: Input, active: bool) {
        let port = self.params.input_port(input);
        let inverted = port != 0 && self.params.inverted_inputs() >> (port - 1) & 1 == 1;
        image.terminals.set(port, active != inverted);
    }

    fn tamper_inputs(&self, image: &mut InputImage) {
        match self.bug {
            Some(PlantedBug::BlindToEmergencyStop) => self.blind(image, Input::EmergencyStop, false),
            Some(PlantedBug::BlindToPressure) => self.blind(image, Input::HydraulicPressure, true),
            Some(PlantedBug::BlindToGuard) => self.blind(image, Input::GuardClosed, true),
            _ => {}
        }
    }

    fn tamper_outputs(&mut self, image: &mut OutputImage) {
        let port = |output| self.params.output_port(output);
        let before = self.written.terminals;
        let stopped = self.is_active(Input::EmergencyStop);
        let keep = |terminals: &mut Terminals, output: Output| {
            terminals.set(port(output), terminals.is_closed(port(output)) || before.is_closed(port(output)));
        };
        match self.bug {
            Some(PlantedBug::WheelStaysOn) if stopped => keep(&mut image.terminals, Output::Wheel),
            Some(PlantedBug::CoolantStaysOn) if stopped => keep(&mut image.terminals, Output::Coolant),
            Some(PlantedBug::EmergencyStopUnclamps) if stopped => {
                for clamp in [Output::Tailstock, Output::Magnetise] {
                    image.terminals.set(port(clamp), false);
                }
            }
            Some(PlantedBug::DrivesStayOn) if stopped => image.drives_on = true,
            Some(PlantedBug::WheelStartsByItself) if self.ticks % 60_000 == 59_999 => {
                image.terminals.set(port(Output::Wheel), true);
            }
            Some(PlantedBug::TailstockIgnoresHeadstock) if self.released => {
                image.terminals.set(port(Output::Tailstock), false);
            }
            Some(PlantedBug::BothHeadstockSpeeds) if image.terminals.is_closed(port(Output::HeadstockHigh)) => {
                image.terminals.set(port(Output::HeadstockLow), true);
            }
            Some(PlantedBug::HeadstockOutlivesReset) => keep(&mut image.terminals, Output::HeadstockHigh),
            Some(PlantedBug::CoolantOutlivesTheProgram) => keep(&mut image.terminals, Output::Coolant),
            Some(PlantedBug::WheelOutlivesTheProgram) => keep(&mut image.terminals, Output::Wheel),
            Some(PlantedBug::ResetStopsCoolant) if self.was_reset => image.terminals.set(port(Output::Coolant), false),
            Some(PlantedBug::OutputsOutliveTheBus) if !self.read.bus_alive => keep(&mut image.terminals, Output::Wheel),
            Some(PlantedBug::OutputsOutliveThePower) if !self.powered => image.terminals = before,
            Some(PlantedBug::PumpStartsByPowerOn) if self.powered && self.ticks > QUIET_TICKS => {
                image.terminals.set(port(Output::Hydraulic), true);
            }
            _ => {}
        }
        self.forced.iter().for_each(|(output, on)| image.terminals.set(port(*output), *on));
        for output in self.stuck.iter() {
            let inverts = output == Output::Hydraulic;
            let on = !(inverts && image.terminals.is_closed(port(output)));
            image.terminals.set(port(output), on);
        }
        self.tamper_motion(image);
    }

    fn tamper_motion(&mut self, image: &mut OutputImage) {
        let port = |output| self.params.output_port(output);
        let wanted = image.set_point_mm[Axis::X];
        let step = wanted - std::mem::replace(&mut self.wanted_mm, wanted);
        let step_before = std::mem::replace(&mut self.step_mm, step);
        let (slows, is_even) = (step.abs() < step_before.abs(), (step - step_before).abs() < EVEN_MM);
        self.at_rest = if step.abs() > 0.0 { 0 } else { self.at_rest.saturating_add(1) };
        if !image.drives_on {
            self.offset_mm = 0.0;
        }
        let were_on = std::mem::replace(&mut self.drives_were_on, image.drives_on);
        let goes_on = image.drives_on && !were_on;
        match self.bug {
            Some(PlantedBug::DrivesGoOnElsewhere) if goes_on => self.offset_mm = 2.0 * JUMP_MM,
            Some(PlantedBug::AxisCreeps) if image.drives_on => self.offset_mm += 1e-5,
            Some(PlantedBug::AxisJumps) if image.drives_on && self.ticks % 30_000 == 29_999 => {
                self.offset_mm += JUMP_MM
            }
            // While its speed is even, the surplus grows by 20 mm/s², within what the rule of acceleration leaves.
            Some(PlantedBug::AxisIsFast) if step < 0.0 && self.ticks > HOMING_TICKS => {
                self.surplus_mm += if is_even { 2e-5 } else { 0.0 };
                self.offset_mm -= self.surplus_mm;
            }
            Some(PlantedBug::AxisIsFast) => self.surplus_mm = 0.0,
            // What is left of the way to a stop is left out: below 10 mm/s.
            Some(PlantedBug::AxisStopsDead) if image.drives_on && slows && step.abs() < 0.01 => {
                self.offset_mm -= step;
            }
            // Three seconds at 0.02 mm/s.
            Some(PlantedBug::AxisRunsOn) if image.drives_on && (1..3_000).contains(&self.at_rest) => {
                self.offset_mm += 2e-5;
            }
            // On its way in the minus direction it gets ahead by a hundredth, up to 1 mm; homing comes before.
            Some(PlantedBug::SoftLimitIsLate) if image.drives_on && self.ticks > HOMING_TICKS => {
                self.offset_mm = (self.offset_mm + 0.01 * step.min(0.0)).max(-1.0);
            }
            // The surplus grows by 1 mm/s².
            Some(PlantedBug::SlowJogIsFast) if step < 0.0 && image.terminals.is_closed(port(Output::Wheel)) => {
                self.surplus_mm += 1e-6;
                self.offset_mm -= self.surplus_mm;
            }
            Some(PlantedBug::SlowJogIsFast) => self.surplus_mm = 0.0,
            Some(PlantedBug::CourseIsRandom) => {
                // Keys of the standard library's hashes differ from run to run.
                self.chance = SplitMix64::new(RandomState::new().hash_one(self.ticks));
                self.offset_mm = self.chance.next_unit() * 1e-9;
            }
            _ => {}
        }
        image.set_point_mm[Axis::X] = wanted + self.offset_mm;
    }
}

/// Whether an input is active, by the wiring that the parameters tell.
#[must_use]
pub fn is_active(params: &Params, terminals: Terminals, input: Input) -> bool {
    let port = params.input_port(input);
    let inverted = port != 0 && params.inverted_inputs() >> (port - 1) & 1 == 1;
    port != 0 && terminals.is_closed(port) != inverted
}

impl Backend for WatchedMachine {
    fn read(&mut self, now: Micros) -> InputImage {
        self.read = self.machine.read(now);
        let mut image = self.read;
        self.tamper_inputs(&mut image);
        image
    }

    fn write(&mut self, now: Micros, outputs: &OutputImage) {
        let mut image = *outputs;
        if self.bug.is_some() {
            self.tamper_outputs(&mut image);
        }
        self.ticks += 1;
        self.written = image;
        self.machine.write(now, &image);
    }

    fn rewire(&mut self, params: &Params) {
        self.params = params.clone();
        self.machine.rewire(params);
    }
}

impl HostedMachine for WatchedMachine {
    fn pace(&self) -> Pace {
        self.machine.pace()
    }

    fn begin(&mut self) {
        self.machine.begin();
    }

    fn power_on(&mut self, params: &Params) {
        self.params = params.clone();
        self.machine.power_on(params);
    }

    fn mount_part(&mut self, part: &PartFile) {
        self.machine.mount_part(part);
    }

    fn measure_finished_part(&mut self) {
        self.machine.measure_finished_part();
    }

    fn simulate(&mut self, command: SimCommand) {
        self.machine.simulate(command);
    }

    fn view(&mut self, now: Micros) -> Option<Arc<SimView>> {
        self.machine.view(now)
    }

    fn simulation(&mut self) -> Option<&mut SimulatedMachine> {
        self.machine.simulation()
    }

    fn bus_view(&mut self, now: Micros, times: &ThreadTimes) -> Option<Arc<BusView>> {
        self.machine.bus_view(now, times)
    }

    fn clear_counters(&mut self) {
        self.machine.clear_counters();
    }

    fn bus_clock(&mut self) -> Option<ClockReading> {
        self.machine.bus_clock()
    }

    fn settling_time(&self) -> Micros {
        self.machine.settling_time()
    }

    fn take_bus_fault(&mut self) -> Option<(u16, LocalizedText)> {
        self.machine.take_bus_fault()
    }
}
