//! System variables: machine data that a program can read and, in part, write.
//! Numbers follow FANUC: #1000 inputs, #1100 outputs, #2001 wear, #3001 times, #3901 counts, #5001 positions.
//! Source: spec B3, K4.3 (#438, #439).

use std::sync::Arc;

use super::lookahead_state::LookaheadState;
use super::offsets::offset_in_range;
use super::run::ProgramRun;
use super::{Controller, StorageRequest};
use crate::defs::alarm;
use crate::defs::kind::Kind;
use crate::defs::mcode::Request;
use crate::defs::param::{self, NumberParam, Params};
use crate::defs::system_variable::{self, SystemVariableRange};
use crate::defs::text::LocalizedText;
use crate::link::edit::OffsetPart;
use crate::machine::RequestResult;
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::nc::{ExternalState, LiveValue, NcSettings, SpeedUnit, SuperManSettings};
use crate::units::{Axis, PerAxis};

/// System variables mapped to parameters.
pub const PARAM_VARIABLES: [(SystemVariableRange, NumberParam); 6] = [
    (system_variable::PARTS_REQUIRED, param::PARTS_REQUIRED),
    (system_variable::WHEEL_DIAMETER, param::WHEEL_DIAMETER),
    (system_variable::WHEEL_WIDTH, param::WHEEL_WIDTH),
    (system_variable::PARTS_SINCE_DRESSING, param::PARTS_SINCE_DRESSING),
    (system_variable::DRESSING_INTERVAL, param::DRESSING_INTERVAL),
    (system_variable::DRESSING_COUNT, param::DRESSING_COUNT),
];
const SECONDS_PER_HOUR: f64 = 3_600.0;
/// Threshold between off (0) and on (1) when a program writes an output.
const SWITCH_THRESHOLD: f64 = 0.5;
/// The offset tables: variable range and axis.
const WEAR: [(SystemVariableRange, Axis); 3] =
    [(system_variable::WEAR_X, Axis::X), (system_variable::WEAR_Z, Axis::Z), (system_variable::WEAR_Y, Axis::Y)];
const GEOMETRY: [(SystemVariableRange, Axis); 3] = [
    (system_variable::GEOMETRY_X, Axis::X),
    (system_variable::GEOMETRY_Z, Axis::Z),
    (system_variable::GEOMETRY_Y, Axis::Y),
];

/// The machine as a running program sees it.
pub struct RunWorld<'a> {
    controller: &'a Controller,
    planned: &'a LookaheadState,
    drained: bool,
}

impl<'a> RunWorld<'a> {
    /// The state at the end of read-ahead; `drained`: the machine has reached it.
    pub const fn new(controller: &'a Controller, planned: &'a LookaheadState, drained: bool) -> Self {
        Self { controller, planned, drained }
    }
}

impl ExternalState for RunWorld<'_> {
    fn position(&self) -> PerAxis<f64> {
        self.planned.work_offsets.work_from_machine(self.planned.machine_position)
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        match self.controller.read_system_variable(number) {
            None => LiveValue::Unknown,
            Some(_) if !self.drained => LiveValue::Drain,
            Some(value) => LiveValue::Value(value),
        }
    }

    fn tool_compensation(&self, tool: u32) -> PerAxis<f64> {
        self.planned.work_offsets.tool_compensation(tool)
    }

    fn active_tool(&self) -> u32 {
        self.planned.work_offsets.tool
    }

    fn program_start(&self) -> PerAxis<f64> {
        let Some(start) = self.controller.lathe.tool_change_point else { return self.position() };
        // L8: a tool change read ahead shifts the tip position by the same amount as the slides.
        let (there, now) = (self.planned.work_offsets.shift, self.controller.work_offsets.shift);
        self.planned.work_offsets.work_from_machine(PerAxis::from_fn(|axis| start[axis] + there[axis] - now[axis]))
    }

    fn block_skip(&self) -> bool {
        self.controller.switches.block_skip
    }
}

/// Interpreter settings for a kind of machine with these parameters.
#[must_use]
pub fn nc_settings(kind: Kind, params: &Params) -> NcSettings {
    let row = crate::machine::kind::find(kind);
    NcSettings {
        diameter: !params.bit(param::RADIUS_PROGRAMMING),
        axes: row.fitted(params),
        least_increment_mm: params.bit(param::INTEGERS_AS_LEAST_INCREMENTS).then_some(0.001),
        inch: false,
        tolerance_mm: params.get(param::PATH_TOLERANCE),
        arc_tolerance_mm: 0.01,
        speed_unit: if params.bit(param::S_IS_SURFACE_SPEED) { SpeedUnit::MetresPerSecond } else { SpeedUnit::Rpm },
        jump_input: params.get(param::JUMP_INPUT) as u32,
        tool_count: TOOL_OFFSET_COUNT as u32,
        oscillation_by_cylinder: params.bit(param::OSCILLATION_BY_CYLINDER),
        rapid_mm_min: PerAxis::from_fn(|axis| params.get_axis(param::RAPID_X, axis)),
        superman: SuperManSettings {
            line_feed: params.get(param::DEFAULT_LINE_FEED),
            arc_feed: params.get(param::DEFAULT_ARC_FEED),
            rapid_z_per_x: params.get(param::RAPID_Z_PER_X),
            increment_mm: params.get(param::LEAST_INPUT_INCREMENT),
            origin: PerAxis::from_fn(|axis| params.get_axis(param::HOME_X, axis)),
            arcs_reversed: !params.bit(param::ISO_ARC_DIRECTION),
            spindle_rpm: params.get(param::WHEEL_RPM),
            max_rpm: params.get(param::WHEEL_RPM_MAX),
            z_accel_jerk: (params.get_axis(param::ACCELERATION_X, Axis::Z), params.get_axis(param::JERK_X, Axis::Z)),
        },
        ..NcSettings::for_dialect(row.dialect)
    }
}

impl Controller {
    /// The value of a system variable; `None` if it is null or does not exist.
    #[must_use]
    pub fn system_variable(&self, number: u32) -> Option<f64> {
        self.read_system_variable(number).flatten()
    }

    /// A system variable; `None` if it does not exist, `Some(None)` for null.
    pub(super) fn read_system_variable(&self, number: u32) -> Option<Option<f64>> {
        let switched = |on: bool| Some(f64::from(u8::from(on)));
        let of = |range: SystemVariableRange| range.index(number);
        if let Some(index) = of(system_variable::INPUTS) {
            let inverted = self.params.inverted_inputs() >> index & 1 == 1;
            return Some(switched(self.image.terminals.level(index as u8 + 1) ^ inverted));
        }
        if let Some(index) = of(system_variable::OUTPUTS) {
            // Switching by the previous block counts at once, one tick before it reaches the terminals.
            return Some(switched(self.outputs_now().1.level(index as u8 + 1)));
        }
        if let Some(index) = of(system_variable::GAUGE_POSITIONS) {
            return Some(self.gauge_positions[index]);
        }
        if let Some(value) = self.read_offset(number).map(Some).or_else(|| self.read_position(number)) {
            return Some(value);
        }
        Some(match *system_variable::find(number)? {
            system_variable::OSCILLATION => {
                let (forward, backward) = self.oscillation_flags();
                switched(if number == system_variable::OSCILLATION.first { forward } else { backward })
            }
            system_variable::MILLISECONDS => Some(self.milliseconds() + self.timer_offset[0]),
            system_variable::HOURS => Some(self.hours() + self.timer_offset[1]),
            system_variable::PARTS_DONE => Some(f64::from(self.part_count)),
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
        self.now.as_secs_f64() / SECONDS_PER_HOUR
    }

    fn read_offset(&self, number: u32) -> Option<f64> {
        let of = |table: &[(SystemVariableRange, Axis)], values: &[PerAxis<f64>; TOOL_OFFSET_COUNT]| {
            let (index, axis) = offset_and_axis(table, number)?;
            Some(values[index][axis] * self.displayed_per_mm(axis))
        };
        of(&WEAR, &self.work_offsets.wear).or_else(|| of(&GEOMETRY, &self.work_offsets.geometry))
    }

    /// A position; `Some(None)`, null, for an axis that this machine does not have.
    fn read_position(&self, number: u32) -> Option<Option<f64>> {
        let ranges = [
            system_variable::BLOCK_END,
            system_variable::MACHINE_POSITION,
            system_variable::WORK_POSITION,
            system_variable::SKIP_POSITION,
        ];
        let (which, index) = ranges.iter().enumerate().find_map(|(at, range)| Some((at, range.index(number)?)))?;
        let Some(axis) = self.axes.present().nth(index) else { return Some(None) };
        let place = match which {
            0 => self.work_offsets.work_from_machine(self.axes.set_point()),
            1 => self.axes.actual(),
            2 => self.work_position(),
            _ => self.skip_position,
        };
        Some(Some(place[axis] * self.displayed_per_mm(axis)))
    }

    /// Writes a system variable for a program. False: refused, with the alarm raised.
    pub(super) fn write_system_variable(&mut self, run: &mut ProgramRun, number: u32, value: Option<f64>) -> bool {
        let value = value.unwrap_or(0.0);
        if let Some(index) = system_variable::OUTPUTS.index(number) {
            let request = Request::Port(index as u8 + 1, value.abs() >= SWITCH_THRESHOLD);
            return matches!(self.request(request), RequestResult::Accepted | RequestResult::NoEffect(_));
        }
        match system_variable::find(number) {
            Some(&system_variable::WHEEL_DIAMETER) => return self.record_dressing(run, value),
            Some(&system_variable::MILLISECONDS) => self.timer_offset[0] = value - self.milliseconds(),
            Some(&system_variable::HOURS) => self.timer_offset[1] = value - self.hours(),
            Some(&system_variable::PARTS_DONE) => {
                self.part_count = value.max(0.0) as u32;
                self.storage_requests.push(StorageRequest::PartCount(self.part_count));
            }
            Some(&system_variable::PARTS_REQUIRED) => self.store_param(param::PARTS_REQUIRED.address(), value),
            Some(_) | None => return self.write_offset(run, number, value),
        }
        true
    }

    fn write_offset(&mut self, run: &mut ProgramRun, number: u32, value: f64) -> bool {
        for (table, wear) in [(&WEAR, true), (&GEOMETRY, false)] {
            if let Some((index, axis)) = offset_and_axis(table, number) {
                if !offset_in_range(if wear { OffsetPart::Wear } else { OffsetPart::Geometry }, value) {
                    let said = format!("#{number} = {value}");
                    self.raise(alarm::OFFSET_RANGE, Some(LocalizedText::new(said.clone(), said)));
                    return false;
                }
                let value = value / self.displayed_per_mm(axis);
                let place = if wear { &mut self.work_offsets.wear } else { &mut self.work_offsets.geometry };
                place[index][axis] = value;
                self.store_offset(index);
                run.lookahead.work_offsets = Arc::new(self.work_offsets.clone());
            }
        }
        true
    }

    /// Stores a changed offset (index from 0) on disk.
    pub(super) fn store_offset(&mut self, index: usize) {
        let (geometry, wear) = (self.work_offsets.geometry[index], self.work_offsets.wear[index]);
        self.storage_requests.push(StorageRequest::Offset { number: index + 1, geometry, wear });
    }
}

/// The offset table that a variable belongs to.
pub(super) fn offset_part_of_variable(number: u32) -> Option<OffsetPart> {
    let of = |table| offset_and_axis(table, number).is_some();
    if of(&WEAR) { Some(OffsetPart::Wear) } else { of(&GEOMETRY).then_some(OffsetPart::Geometry) }
}

/// The offset index and axis of a variable number.
fn offset_and_axis(table: &[(SystemVariableRange, Axis)], number: u32) -> Option<(usize, Axis)> {
    table.iter().find_map(|(range, axis)| Some((range.index(number)?, *axis)))
}
