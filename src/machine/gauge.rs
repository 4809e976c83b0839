//! Gauge arms and gears: outputs with end-position switches, where assigned.
//! Source: spec K3.9, K3.10, K4.5 (switches supervised when assigned), B4.

use super::stroke::Stroke;
use crate::defs::alarm;
use crate::defs::mcode::Gauge;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet, Output, OutputSet};
use crate::units::Micros;

/// One arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Arm {
    out: bool,
    stroke: Stroke,
}

/// Both arms, radial first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arms([Arm; 2]);

impl Default for Arms {
    fn default() -> Self {
        Self([Arm { out: false, stroke: Stroke::There }; 2])
    }
}

impl Arms {
    pub fn send(&mut self, gauge: Gauge, out: bool, now: Micros) {
        let arm = &mut self.0[gauge as usize];
        if arm.out != out || arm.stroke == Stroke::Lost {
            arm.out = out;
            arm.stroke.send(now);
        }
    }

    pub const fn is_going(&self, gauge: Gauge) -> bool {
        self.0[gauge as usize].stroke.is_going()
    }

    pub fn show(&self, on: &mut OutputSet) {
        on.set(Output::RadialGauge, self.0[0].out);
        on.set(Output::AxialGauge, self.0[1].out);
    }

    /// Returns the time-out alarm of each arm.
    pub fn watch(&mut self, now: Micros, inputs: InputSet, params: &Params) -> [Option<u16>; 2] {
        const SWITCHES: [[Input; 2]; 2] =
            [[Input::RadialArmIn, Input::RadialArmOut], [Input::AxialArmIn, Input::AxialArmOut]];
        [0, 1].map(|index| {
            let arm = &mut self.0[index];
            let switch = SWITCHES[index][usize::from(arm.out)];
            let late = arm.stroke.watch(now, (switch, inputs), params, param::GAUGE_ARM_TIME, Micros::ZERO);
            late.then_some(alarm::GAUGE_ARM_TIMEOUT)
        })
    }
}

/// The gear box: one output on at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gears(Option<(u8, Stroke)>);

impl Gears {
    /// Changes to a gear, 0 to 3.
    pub fn change(&mut self, gear: u8, now: Micros) {
        if !matches!(self.0, Some((present, Stroke::There | Stroke::Going { .. })) if present == gear) {
            self.0 = Some((gear, Stroke::Going { since: now }));
        }
    }

    pub const fn is_going(&self) -> bool {
        matches!(self.0, Some((_, Stroke::Going { .. })))
    }

    pub fn is_going_to(&self, output: Output) -> bool {
        matches!(self.0, Some((gear, Stroke::Going { .. })) if Output::GEARS[usize::from(gear) % 4] == output)
    }

    pub fn show(&self, on: &mut OutputSet) {
        if let Some((gear, _)) = self.0 {
            on.set(Output::GEARS[usize::from(gear) % 4], true);
        }
    }

    pub fn watch(&mut self, now: Micros, inputs: InputSet, params: &Params) -> Option<u16> {
        let (gear, stroke) = self.0.as_mut()?;
        let switch = Input::GEARS[usize::from(*gear) % 4];
        let unseen = params.millis(param::GEAR_TIME);
        let late = stroke.watch(now, (switch, inputs), params, param::GEAR_TIME, unseen);
        late.then_some(alarm::GEAR_TIMEOUT)
    }
}
