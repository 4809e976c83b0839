//! System variables: what a program can read of the machine, and the little that it can write.
//! Numbers follow FANUC's: #1000 inputs, #1100 outputs, #2001 wear, #3001 times, #3901 counts, #5001 positions.
//! Source: spec B3, K4.3 (#438, #439).

use super::run::Planned;
use super::{Controller, Effect};
use crate::defs::kind::Kind;
use crate::defs::param::{self, Params};
use crate::defs::signal::PORTS;
use crate::nc::frames::OFFSETS;
use crate::nc::{Live, Settings, SpeedUnit, World};
use crate::units::{Axis, PerAxis};

/// First numbers of the ranges.
const INPUTS: u32 = 1_000;
const OUTPUTS: u32 = 1_100;
const WEAR: [(u32, Axis); 3] = [(2_001, Axis::X), (2_101, Axis::Z), (2_401, Axis::Y)];
const GEOMETRY: [(u32, Axis); 3] = [(2_701, Axis::X), (2_801, Axis::Z), (2_451, Axis::Y)];
const MILLISECONDS: u32 = 3_001;
const HOURS: u32 = 3_002;
const PARTS_DONE: u32 = 3_901;
const PARTS_WANTED: u32 = 3_902;
const BLOCK_END: u32 = 5_001;
const MACHINE: u32 = 5_021;
const WORK: u32 = 5_041;
const SKIP: u32 = 5_061;

/// The world as a running program sees it.
pub struct RunWorld<'a> {
    controller: &'a Controller,
    planned: &'a Planned,
    drained: bool,
}

impl<'a> RunWorld<'a> {
    /// The world at the end of what has been read; `drained` when the machine has got there.
    pub const fn new(controller: &'a Controller, planned: &'a Planned, drained: bool) -> Self {
        Self { controller, planned, drained }
    }
}

impl World for RunWorld<'_> {
    fn position(&self) -> PerAxis<f64> {
        self.planned.frames.work_from_machine(self.planned.machine)
    }

    fn system(&mut self, number: u32) -> Live {
        match self.controller.read_system(number) {
            None => Live::Unknown,
            Some(_) if !self.drained => Live::Drain,
            Some(value) => Live::Value(value),
        }
    }

    fn block_skip(&self) -> bool {
        self.controller.switches.block_skip
    }
}

/// How a machine of a kind with these parameters reads its programs.
#[must_use]
pub fn nc_settings(kind: Kind, params: &Params) -> Settings {
    let row = crate::machine::kind::find(kind);
    Settings {
        diameter: !params.bit(param::RADIUS_PROGRAMMING),
        axes: row.fitted(params),
        least_increment_mm: params.bit(param::LEAST_INCREMENT).then_some(0.001),
        inch: false,
        tolerance_mm: params.get(param::PATH_TOLERANCE),
        arc_tolerance_mm: 0.01,
        speed_unit: if params.bit(param::SPEED_AT_THE_RIM) { SpeedUnit::MetresPerSecond } else { SpeedUnit::Rpm },
        jump_input: params.get(param::JUMP_INPUT) as u32,
        tools: OFFSETS as u32,
        oscillation_by_cylinder: params.bit(param::OSCILLATION_BY_CYLINDER),
        rapid_mm_min: PerAxis::from_fn(|axis| params.of_axis(param::RAPID_X, axis)),
        ..Settings::of(kind.system())
    }
}

impl Controller {
    /// The value of a system variable, as a program reads it.
    #[must_use]
    pub fn system_value(&self, number: u32) -> Option<f64> {
        self.read_system(number).flatten()
    }

    /// A system variable; `None` if there is no such, `Some(None)` for null.
    pub(super) fn read_system(&self, number: u32) -> Option<Option<f64>> {
        let switched = |on: bool| Some(Some(f64::from(u8::from(on))));
        match number {
            434..=437 => Some(self.gauge_found[(number - 434) as usize]),
            438 => switched(self.oscillation_flags().0),
            439 => switched(self.oscillation_flags().1),
            INPUTS..OUTPUTS if number - INPUTS < u32::from(PORTS) => {
                let port = (number - INPUTS + 1) as u8;
                let level = self.image.terminals.level(port);
                switched(level ^ (self.params.inverted_inputs() >> (port - 1) & 1 == 1))
            }
            OUTPUTS..1_200 if number - OUTPUTS < u32::from(PORTS) => {
                switched(self.outputs.terminals.level((number - OUTPUTS + 1) as u8))
            }
            MILLISECONDS => Some(Some((self.now.0 / 1_000) as f64)),
            HOURS => Some(Some(self.now.as_secs_f64() / 3_600.0)),
            PARTS_DONE => Some(Some(f64::from(self.parts))),
            PARTS_WANTED => Some(Some(self.params.get(param::PARTS_WANTED))),
            _ => self.read_offset(number).or_else(|| self.read_position(number)).map(Some),
        }
    }

    fn read_offset(&self, number: u32) -> Option<f64> {
        let of = |table: &[(u32, Axis)], values: &[PerAxis<f64>; OFFSETS]| {
            let (index, axis) = offset_of(table, number)?;
            Some(values[index][axis] * self.displayed_per_mm(axis))
        };
        of(&WEAR, &self.frames.wear).or_else(|| of(&GEOMETRY, &self.frames.geometry))
    }

    fn read_position(&self, number: u32) -> Option<f64> {
        let first = [BLOCK_END, MACHINE, WORK, SKIP].into_iter().rev().find(|first| number >= *first)?;
        let axis = self.axes.present().nth((number - first) as usize)?;
        let place = match first {
            BLOCK_END => self.frames.work_from_machine(self.axes.set()),
            MACHINE => self.axes.actual(),
            WORK => self.work(),
            _ => self.skip_position,
        };
        Some(place[axis] * self.displayed_per_mm(axis))
    }

    /// Writes the few system variables that a program may write: wear, geometry and counts.
    pub(super) fn write_system(&mut self, number: u32, value: Option<f64>) {
        let value = value.unwrap_or(0.0);
        if number == PARTS_DONE {
            self.parts = value.max(0.0) as u32;
            self.effects.push(Effect::Parts(self.parts));
            return;
        }
        for (table, wear) in [(&WEAR, true), (&GEOMETRY, false)] {
            if let Some((index, axis)) = offset_of(table, number) {
                let value = value / self.displayed_per_mm(axis);
                let place = if wear { &mut self.frames.wear } else { &mut self.frames.geometry };
                place[index][axis] = value;
                let (geometry, wear) = (self.frames.geometry[index], self.frames.wear[index]);
                self.effects.push(Effect::Offset { number: index + 1, geometry, wear });
                if let Some(run) = &mut self.run {
                    run.planned.frames = std::sync::Arc::new(self.frames.clone());
                }
            }
        }
    }
}

/// Which offset and axis a number of a table names.
fn offset_of(table: &[(u32, Axis)], number: u32) -> Option<(usize, Axis)> {
    table.iter().find_map(|(first, axis)| {
        let index = number.checked_sub(*first)? as usize;
        (index < OFFSETS).then_some((index, *axis))
    })
}
