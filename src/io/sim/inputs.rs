//! The input image of a tick: the state of every switch by function, then the terminal levels (P1, P3, P7, P8).

use super::super::InputImage;
use super::super::drive::DriveState;
use super::SimulatedMachine;
use super::axis::{AxisSwitches, SimAxis};
use super::lathe::SimLathe;
use crate::defs::signal::{Input, InputSet, Terminals};
use crate::units::{Axis, EncoderPos, Micros, PerAxis};

/// The inputs of an axis: home, limit plus, limit minus, drive.
const AXIS_INPUTS: PerAxis<[Input; 4]> = PerAxis([
    [Input::HomeX, Input::LimitXPlus, Input::LimitXMinus, Input::DriveX],
    [Input::HomeY, Input::LimitYPlus, Input::LimitYMinus, Input::DriveY],
    [Input::HomeZ, Input::LimitZPlus, Input::LimitZMinus, Input::DriveZ],
]);

impl SimulatedMachine {
    /// The image of this tick, without the handwheel.
    pub(super) fn input_image(&mut self, dt: Micros) -> InputImage {
        let logical = self.logical_inputs(dt.as_secs_f64());
        let mut terminals = self.wiring.terminals(logical, &mut self.rng);
        if self.active_faults.supply_loss {
            terminals = Terminals::default();
        }
        InputImage {
            terminals,
            encoder_mm: EncoderPos::from_fn(|axis| self.axis_value(axis, SimAxis::encoder_mm)),
            absolute: PerAxis::from_fn(|axis| self.axes[axis].as_ref().is_some_and(SimAxis::is_absolute)),
            // Its drives send no torque and have no probes: every signal is an input.
            torque_percent: PerAxis::default(),
            latches: PerAxis::default(),
            spindle_turns: self.lathe.as_ref().map_or(0.0, SimLathe::encoder_turns),
            handwheel_detents: 0,
            drives: self.drive_states(),
            bus_alive: true,
            station_silent: false,
            inverter_tripped: false,
        }
    }

    /// The drives of the simulated machine come on at once; their faults are signals.
    fn drive_states(&self) -> PerAxis<DriveState> {
        let on = if self.outputs.drives_on { DriveState::Enabled } else { DriveState::Off };
        PerAxis::from_fn(|axis| if self.axes[axis].is_some() { on } else { DriveState::Off })
    }

    fn logical_inputs(&mut self, dt_s: f64) -> InputSet {
        let mut set = InputSet::NONE;
        for axis in Axis::ALL {
            let Some(sim) = &mut self.axes[axis] else { continue };
            let AxisSwitches { home, limit_plus, limit_minus } = sim.switches(dt_s, self.file.bounce_s, &mut self.rng);
            let fault = self.tripped || self.active_faults.drive[axis];
            for (input, on) in AXIS_INPUTS[axis].into_iter().zip([home, limit_plus, limit_minus, fault]) {
                set.set(input, on);
            }
        }
        let h = &self.hydraulics;
        set.set(Input::HydraulicPressure, h.pressure_switch);
        set.set(Input::TailstockAdvanced, h.tailstock.is_some_and(|tailstock| tailstock.front_switch));
        set.set(Input::TailstockRetracted, h.tailstock.is_some_and(|tailstock| tailstock.back_switch));
        set.set(Input::RadialArmOut, h.radial_arm.front_switch);
        set.set(Input::RadialArmIn, h.radial_arm.back_switch);
        set.set(Input::AxialArmOut, h.axial_arm.front_switch);
        set.set(Input::AxialArmIn, h.axial_arm.back_switch);
        set.set(Input::OscillationForwardEnd, h.oscillation.front_switch);
        set.set(Input::OscillationBackwardEnd, h.oscillation.back_switch);
        set.set(Input::CoolantFlow, h.coolant_flows() && !self.active_faults.coolant_missing);
        set.set(Input::LubricationLevel, !self.active_faults.lubrication_missing);
        set.set(Input::GuardClosed, true);
        set.set(Input::WheelContact, self.grinding.removes);
        Input::GEARS.into_iter().enumerate().for_each(|(gear, input)| set.set(input, h.gear_in(gear)));
        if let Some(turning) = &self.lathe {
            for (station, input) in Input::STATIONS.into_iter().enumerate() {
                set.set(input, turning.at_station(station));
            }
        }
        if !self.active_faults.gauge_dead {
            let g = &self.gauges;
            set.set(Input::Gauge1, g.stage(0));
            set.set(Input::Gauge2, g.stage(1));
            set.set(Input::Gauge3, g.stage(2));
            // The last stage of the radial gauge and the touch of the axial gauge share one signal (K4.5).
            set.set(Input::Gauge4, g.stage(3) || g.touching());
            set.set(Input::Gauge6, g.second_stage());
        }
        set
    }
}
