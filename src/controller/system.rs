//! System variables: machine data that a program can read and, in part, write.
//! Numbers follow FANUC: #1000 inputs, #1100 outputs, #2001 wear, #3001 times, #3901 counts, #5001 positions.
//! Source: spec B3, K4.3 (#438, #439).

use std::sync::Arc;

use super::offsets::in_range;
use super::planned::Planned;
use super::run::Run;
use super::{Controller, Effect};
use crate::defs::alarm;
use crate::defs::kind::Kind;
use crate::defs::mcode::Request;
use crate::defs::param::{self, Number, Params};
use crate::defs::text::Said;
use crate::defs::variable::{self, SystemVariables};
use crate::link::edit::Part;
use crate::machine::Answer;
use crate::nc::frames::OFFSETS;
use crate::nc::{Live, Settings, SpeedUnit, Turning, World};
use crate::units::{Axis, PerAxis};

/// System variables mapped to parameters.
pub const PARAM_VARIABLES: [(SystemVariables, Number); 6] = [
    (variable::PARTS_WANTED, param::PARTS_WANTED),
    (variable::WHEEL_DIAMETER, param::WHEEL_DIAMETER),
    (variable::WHEEL_WIDTH, param::WHEEL_WIDTH),
    (variable::PARTS_SINCE_DRESSING, param::PARTS_SINCE_DRESSING),
    (variable::DRESSING_INTERVAL, param::DRESSING_INTERVAL),
    (variable::DRESSINGS, param::DRESSINGS),
];
const SECONDS_OF_AN_HOUR: f64 = 3_600.0;
/// Threshold between off (0) and on (1) when a program writes an output.
const HALF: f64 = 0.5;
/// The offset tables: variable range and axis.
const WEAR: [(SystemVariables, Axis); 3] =
    [(variable::WEAR_X, Axis::X), (variable::WEAR_Z, Axis::Z), (variable::WEAR_Y, Axis::Y)];
const GEOMETRY: [(SystemVariables, Axis); 3] =
    [(variable::GEOMETRY_X, Axis::X), (variable::GEOMETRY_Z, Axis::Z), (variable::GEOMETRY_Y, Axis::Y)];

/// The machine as a running program sees it.
pub struct RunWorld<'a> {
    controller: &'a Controller,
    planned: &'a Planned,
    drained: bool,
}

impl<'a> RunWorld<'a> {
    /// The state at the end of read-ahead; `drained`: the machine has reached it.
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

    fn compensation(&self, tool: u32) -> PerAxis<f64> {
        self.planned.frames.compensation(tool)
    }

    fn tool(&self) -> u32 {
        self.planned.frames.tool
    }

    fn start(&self) -> PerAxis<f64> {
        let Some(start) = self.controller.lathe.start else { return self.position() };
        // L8: a tool change read ahead shifts the tip position by the same amount as the slides.
        let (there, now) = (self.planned.frames.shift, self.controller.frames.shift);
        self.planned.frames.work_from_machine(PerAxis::from_fn(|axis| start[axis] + there[axis] - now[axis]))
    }

    fn block_skip(&self) -> bool {
        self.controller.switches.block_skip
    }
}

/// Interpreter settings for a kind of machine with these parameters.
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
        turning: Turning {
            line_feed: params.get(param::LINE_FEED),
            arc_feed: params.get(param::ARC_FEED),
            rapid_z_per_x: params.get(param::RAPID_Z_PER_X),
            pulse_mm: params.get(param::PULSE),
            origin: PerAxis::from_fn(|axis| params.of_axis(param::HOME_X, axis)),
            arcs_opposite: !params.bit(param::ARCS_AS_ISO),
            spindle_rpm: params.get(param::WHEEL_RPM),
            most_rpm: params.get(param::WHEEL_RPM_MAX),
            run_up: (params.of_axis(param::ACCELERATION_X, Axis::Z), params.of_axis(param::JERK_X, Axis::Z)),
        },
        ..Settings::of(row.system)
    }
}

impl Controller {
    /// The value of a system variable; `None` if it is null or does not exist.
    #[must_use]
    pub fn system_value(&self, number: u32) -> Option<f64> {
        self.read_system(number).flatten()
    }

    /// A system variable; `None` if it does not exist, `Some(None)` for null.
    pub(super) fn read_system(&self, number: u32) -> Option<Option<f64>> {
        let switched = |on: bool| Some(f64::from(u8::from(on)));
        let of = |range: SystemVariables| range.index(number);
        if let Some(index) = of(variable::INPUTS) {
            let inverted = self.params.inverted_inputs() >> index & 1 == 1;
            return Some(switched(self.image.terminals.level(index as u8 + 1) ^ inverted));
        }
        if let Some(index) = of(variable::OUTPUTS) {
            // Switching by the previous block counts at once, one tick before it reaches the terminals.
            return Some(switched(self.switched_on().1.level(index as u8 + 1)));
        }
        if let Some(index) = of(variable::GAUGE_FOUND) {
            return Some(self.gauge_found[index]);
        }
        if let Some(value) = self.read_offset(number).map(Some).or_else(|| self.read_position(number)) {
            return Some(value);
        }
        Some(match *variable::find(number)? {
            variable::OSCILLATION => {
                let (forward, backward) = self.oscillation_flags();
                switched(if number == variable::OSCILLATION.first { forward } else { backward })
            }
            variable::MILLISECONDS => Some(self.milliseconds() + self.timer_offset[0]),
            variable::HOURS => Some(self.hours() + self.timer_offset[1]),
            variable::PARTS_DONE => Some(f64::from(self.parts)),
            range => {
                let (_, row) = PARAM_VARIABLES.iter().find(|(of, _)| *of == range)?;
                Some(self.params.get(*row))
            }
        })
    }

    /// Whole milliseconds since power-on.
    const fn milliseconds(&self) -> f64 {
        (self.now.0 / 1_000) as f64
    }

    fn hours(&self) -> f64 {
        self.now.as_secs_f64() / SECONDS_OF_AN_HOUR
    }

    fn read_offset(&self, number: u32) -> Option<f64> {
        let of = |table: &[(SystemVariables, Axis)], values: &[PerAxis<f64>; OFFSETS]| {
            let (index, axis) = offset_of(table, number)?;
            Some(values[index][axis] * self.displayed_per_mm(axis))
        };
        of(&WEAR, &self.frames.wear).or_else(|| of(&GEOMETRY, &self.frames.geometry))
    }

    /// A position; `Some(None)`, null, for an axis that this machine does not have.
    fn read_position(&self, number: u32) -> Option<Option<f64>> {
        let ranges = [variable::BLOCK_END, variable::MACHINE, variable::WORK, variable::SKIP];
        let (which, index) = ranges.iter().enumerate().find_map(|(at, range)| Some((at, range.index(number)?)))?;
        let Some(axis) = self.axes.present().nth(index) else { return Some(None) };
        let place = match which {
            0 => self.frames.work_from_machine(self.axes.set()),
            1 => self.axes.actual(),
            2 => self.work(),
            _ => self.skip_position,
        };
        Some(Some(place[axis] * self.displayed_per_mm(axis)))
    }

    /// Writes a system variable for a program. False: refused, with the alarm raised.
    pub(super) fn write_system(&mut self, run: &mut Run, number: u32, value: Option<f64>) -> bool {
        let value = value.unwrap_or(0.0);
        if let Some(index) = variable::OUTPUTS.index(number) {
            let request = Request::Port(index as u8 + 1, value.abs() >= HALF);
            return matches!(self.ask(request), Answer::Taken | Answer::NoEffect(_));
        }
        match variable::find(number) {
            Some(&variable::WHEEL_DIAMETER) => return self.book_dressing(run, value),
            Some(&variable::MILLISECONDS) => self.timer_offset[0] = value - self.milliseconds(),
            Some(&variable::HOURS) => self.timer_offset[1] = value - self.hours(),
            Some(&variable::PARTS_DONE) => {
                self.parts = value.max(0.0) as u32;
                self.effects.push(Effect::Parts(self.parts));
            }
            Some(&variable::PARTS_WANTED) => self.keep_param(param::PARTS_WANTED.address(), value),
            Some(_) | None => return self.write_offset(run, number, value),
        }
        true
    }

    fn write_offset(&mut self, run: &mut Run, number: u32, value: f64) -> bool {
        for (table, wear) in [(&WEAR, true), (&GEOMETRY, false)] {
            if let Some((index, axis)) = offset_of(table, number) {
                if !in_range(if wear { Part::Wear } else { Part::Geometry }, value) {
                    let said = format!("#{number} = {value}");
                    self.raise(alarm::OFFSET_RANGE, Some(Said::new(said.clone(), said)));
                    return false;
                }
                let value = value / self.displayed_per_mm(axis);
                let place = if wear { &mut self.frames.wear } else { &mut self.frames.geometry };
                place[index][axis] = value;
                self.keep_offset(index);
                run.planned.frames = Arc::new(self.frames.clone());
            }
        }
        true
    }

    /// Stores a changed offset (index from 0) on disk.
    pub(super) fn keep_offset(&mut self, index: usize) {
        let (geometry, wear) = (self.frames.geometry[index], self.frames.wear[index]);
        self.effects.push(Effect::Offset { number: index + 1, geometry, wear });
    }
}

/// The offset table that a variable belongs to.
pub(super) fn offset_of_variable(number: u32) -> Option<Part> {
    let of = |table| offset_of(table, number).is_some();
    if of(&WEAR) { Some(Part::Wear) } else { of(&GEOMETRY).then_some(Part::Geometry) }
}

/// The offset index and axis of a variable number.
fn offset_of(table: &[(SystemVariables, Axis)], number: u32) -> Option<(usize, Axis)> {
    table.iter().find_map(|(range, axis)| Some((range.index(number)?, *axis)))
}
