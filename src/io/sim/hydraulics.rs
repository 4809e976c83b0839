//! Hydraulic pump and pressure switch, and the actuators that take time to move: tailstock, gauge arms,
//! oscillation cylinder, coolant flow, gears (P3).

use super::contact::BouncingContact;
use super::machine_sections::HydraulicsFile;
use crate::defs::signal::{Output, OutputSet};
use crate::io::random::SplitMix64;

/// A cylinder or arm that moves between two end positions, with a switch at each.
#[derive(Clone, Copy, Debug)]
pub(super) struct SimCylinder {
    /// Position: 0 at the back end, 1 at the front end.
    position: f64,
    rate_per_s: f64,
    front_contact: BouncingContact,
    back_contact: BouncingContact,
    /// State of the front switch.
    pub(super) front_switch: bool,
    /// State of the back switch.
    pub(super) back_switch: bool,
}

/// Command to a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CylinderCommand {
    Forward,
    Backward,
    Hold,
}

impl SimCylinder {
    /// At the back end; `whole_s` is the time for the whole way.
    fn new(whole_s: f64) -> Self {
        Self::at_end(whole_s.recip(), false)
    }

    fn at_end(rate_per_s: f64, front: bool) -> Self {
        Self {
            position: if front { 1.0 } else { 0.0 },
            rate_per_s,
            front_contact: BouncingContact::at_rest(front),
            back_contact: BouncingContact::at_rest(!front),
            front_switch: front,
            back_switch: !front,
        }
    }

    fn step(&mut self, push: CylinderCommand, tick: StepTimes, chance: &mut SplitMix64) {
        match push {
            CylinderCommand::Forward => self.position = (self.position + self.rate_per_s * tick.dt_s).min(1.0),
            CylinderCommand::Backward => self.position = (self.position - self.rate_per_s * tick.dt_s).max(0.0),
            CylinderCommand::Hold => {}
        }
        self.front_switch = self.front_contact.step(self.position >= 1.0, tick.dt_s, tick.bounce_s, chance);
        self.back_switch = self.back_contact.step(self.position <= 0.0, tick.dt_s, tick.bounce_s, chance);
    }

    /// Whether it is at the front end, regardless of the switch.
    pub(super) fn is_at_front(&self) -> bool {
        self.position >= 1.0
    }
}

/// Duration of a tick and of contact bounce, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepTimes {
    pub dt_s: f64,
    pub bounce_s: f64,
}

/// Pump, pressure and cylinders.
#[derive(Clone, Debug)]
pub(super) struct Hydraulics {
    file: HydraulicsFile,
    /// Present pressure, MPa.
    pub(super) pressure_mpa: f64,
    /// State of the pressure switch.
    pub(super) pressure_switch: bool,
    decay: (f64, f64),
    pub(super) tailstock: Option<SimCylinder>,
    pub(super) radial_arm: SimCylinder,
    pub(super) axial_arm: SimCylinder,
    pub(super) oscillation: SimCylinder,
    coolant_delay_s: f64,
    gear_delay_s: [f64; 4],
}

impl Hydraulics {
    /// Everything at rest: no pressure, tailstock and arms retracted.
    pub(super) fn new(file: HydraulicsFile) -> Self {
        Self {
            pressure_mpa: 0.0,
            pressure_switch: false,
            decay: (0.0, 1.0),
            tailstock: file.tailstock.as_ref().map(|quill| SimCylinder::new(quill.travel_s)),
            radial_arm: SimCylinder::new(file.gauge_arm_s),
            axial_arm: SimCylinder::new(file.gauge_arm_s),
            oscillation: SimCylinder::new(file.oscillation_mm / file.oscillation_mm_s),
            coolant_delay_s: file.coolant_s,
            gear_delay_s: [file.gear_s; 4],
            file,
        }
    }

    /// Sets full pressure and the tailstock position.
    pub(super) fn make_ready(&mut self, tailstock_advanced: bool) {
        self.pressure_mpa = self.file.pressure_mpa;
        self.pressure_switch = true;
        self.place_tailstock(tailstock_advanced);
    }

    /// Puts the tailstock at one end position.
    pub(super) fn place_tailstock(&mut self, advanced: bool) {
        if let Some(tailstock) = &mut self.tailstock {
            *tailstock = SimCylinder::at_end(tailstock.rate_per_s, advanced);
        }
    }

    /// Moves everything for one tick under the outputs; `leak` is the fault of lost pressure.
    pub(super) fn step(&mut self, on: OutputSet, leak: bool, tick: StepTimes, chance: &mut SplitMix64) {
        if tick.dt_s.total_cmp(&self.decay.0).is_ne() {
            self.decay = (tick.dt_s, (-tick.dt_s / self.file.time_constant_s).exp());
        }
        let target = if on.has(Output::Hydraulic) && !leak { self.file.pressure_mpa } else { 0.0 };
        self.pressure_mpa = target + (self.pressure_mpa - target) * self.decay.1;
        let edge = if self.pressure_switch { self.file.switch_off_mpa } else { self.file.switch_on_mpa };
        self.pressure_switch = self.pressure_mpa >= edge;
        let moves = self.pressure_mpa >= self.file.moves_from_mpa;
        let two_way = |front: bool| if front { CylinderCommand::Forward } else { CylinderCommand::Backward };
        if let Some(tailstock) = &mut self.tailstock {
            let push = if moves { two_way(on.has(Output::Tailstock)) } else { CylinderCommand::Hold };
            tailstock.step(push, tick, chance);
        }
        self.radial_arm.step(two_way(on.has(Output::RadialGauge)), tick, chance);
        self.axial_arm.step(two_way(on.has(Output::AxialGauge)), tick, chance);
        let oscillation = match (on.has(Output::OscillationForward), on.has(Output::OscillationBackward)) {
            (true, false) => CylinderCommand::Forward,
            (false, true) => CylinderCommand::Backward,
            (true, true) | (false, false) => CylinderCommand::Hold,
        };
        self.oscillation.step(oscillation, tick, chance);
        count_down(&mut self.coolant_delay_s, on.has(Output::Coolant), self.file.coolant_s, tick.dt_s);
        for (left, gear) in self.gear_delay_s.iter_mut().zip(Output::GEARS) {
            count_down(left, on.has(gear), self.file.gear_s, tick.dt_s);
        }
    }

    /// Whether coolant flows.
    pub(super) fn coolant_flows(&self) -> bool {
        self.coolant_delay_s <= 0.0
    }

    /// Whether a gear, 0 to 3, is in position.
    pub(super) fn gear_in(&self, gear: usize) -> bool {
        self.gear_delay_s[gear] <= 0.0
    }

    /// Distance of the tailstock from its advanced position, mm.
    pub(super) fn tailstock_retracted_mm(&self) -> f64 {
        let quill = self.tailstock.as_ref().zip(self.file.tailstock.as_ref());
        quill.map_or(0.0, |(tailstock, file)| (1.0 - tailstock.position) * file.travel_mm)
    }
}

/// Counts a delay down while on and restarts it when off.
fn count_down(left_s: &mut f64, on: bool, whole_s: f64, dt_s: f64) {
    *left_s = if on { (*left_s - dt_s).max(0.0) } else { whole_s };
}
