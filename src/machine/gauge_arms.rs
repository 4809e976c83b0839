//! Gauge arms and gears: outputs with end-position switches, where assigned.
//! Source: spec K3.9, K3.10, K4.5 (switches supervised when assigned), B4.

use super::two_position_actuator::TwoPositionActuator;
use crate::defs::alarm;
use crate::defs::mcode::Gauge;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet, Output, OutputSet};
use crate::units::Micros;

/// One arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct GaugeArm {
    out: bool,
    actuator: TwoPositionActuator,
}

/// Both arms, radial first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GaugeArms([GaugeArm; 2]);

impl Default for GaugeArms {
    fn default() -> Self {
        Self([GaugeArm { out: false, actuator: TwoPositionActuator::InPosition }; 2])
    }
}

impl GaugeArms {
    pub fn move_arm(&mut self, gauge: Gauge, out: bool, now: Micros) {
        let arm = &mut self.0[gauge as usize];
        if arm.out != out || arm.actuator == TwoPositionActuator::TimedOut {
            arm.out = out;
            arm.actuator.start(now);
        }
    }

    pub const fn is_moving(&self, gauge: Gauge) -> bool {
        self.0[gauge as usize].actuator.is_moving()
    }

    pub fn write_outputs(&self, on: &mut OutputSet) {
        on.set(Output::RadialGauge, self.0[0].out);
        on.set(Output::AxialGauge, self.0[1].out);
    }

    /// Returns the time-out alarm of each arm.
    pub fn supervise(&mut self, now: Micros, inputs: InputSet, params: &Params) -> [Option<u16>; 2] {
        const SWITCHES: [[Input; 2]; 2] =
            [[Input::RadialArmIn, Input::RadialArmOut], [Input::AxialArmIn, Input::AxialArmOut]];
        [0, 1].map(|index| {
            let arm = &mut self.0[index];
            let switch = SWITCHES[index][usize::from(arm.out)];
            let at_end = (params.input_port(switch) != 0).then(|| inputs.has(switch));
            let late = arm.actuator.supervise(now, at_end, params.millis(param::GAUGE_ARM_TIMEOUT), Micros::ZERO);
            late.then_some(alarm::GAUGE_ARM_TIMEOUT)
        })
    }
}

/// The gear box: one output on at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GearBox(Option<(u8, TwoPositionActuator)>);

impl GearBox {
    /// Changes to a gear, 0 to 3.
    pub fn change(&mut self, gear: u8, now: Micros) {
        if self.0.is_none_or(|(present, actuator)| present != gear || actuator == TwoPositionActuator::TimedOut) {
            self.0 = Some((gear, TwoPositionActuator::Moving { since: now }));
        }
    }

    pub const fn is_changing(&self) -> bool {
        matches!(self.0, Some((_, TwoPositionActuator::Moving { .. })))
    }

    pub fn is_changing_to(&self, output: Output) -> bool {
        matches!(self.0, Some((gear, TwoPositionActuator::Moving { .. })) if Output::GEARS[usize::from(gear) % 4] == output)
    }

    pub fn write_outputs(&self, on: &mut OutputSet) {
        if let Some((gear, _)) = self.0 {
            on.set(Output::GEARS[usize::from(gear) % 4], true);
        }
    }

    pub fn supervise(&mut self, now: Micros, inputs: InputSet, params: &Params) -> Option<u16> {
        let (gear, actuator) = self.0.as_mut()?;
        let switch = Input::GEARS[usize::from(*gear) % 4];
        let at_end = (params.input_port(switch) != 0).then(|| inputs.has(switch));
        let most = params.millis(param::GEAR_CHANGE_TIMEOUT);
        let late = actuator.supervise(now, at_end, most, most);
        late.then_some(alarm::GEAR_CHANGE_TIMEOUT)
    }
}
