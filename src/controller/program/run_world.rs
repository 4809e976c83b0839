//! The machine as a running program sees it, and what it writes to it by system variables.
//! Source: spec B3, K4.2, K5.17, L8.

use super::lookahead_state::LookaheadState;
use super::run::{Origin, ProgramRun};
use crate::controller::plant::{Plant, offset_in_range};
use crate::controller::storage_request::StorageRequest;
use crate::defs::alarm;
use crate::defs::grinding_phase::GrindingPhase;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::system_variable;
use crate::defs::text::phrase;
use crate::link::edit::OffsetPart;
use crate::machine::RequestResult;
use crate::nc::{self, ExternalState, LiveValue, OriginPlace, ToolOffsetPlace};
use crate::units::{PerAxis, WorkPos};

/// Threshold between off (0) and on (1) when a program writes an output.
const SWITCH_THRESHOLD: f64 = 0.5;

/// The machine as a running program sees it.
pub struct RunWorld<'a> {
    plant: &'a Plant,
    lookahead: &'a LookaheadState,
    drained: bool,
    /// A value of the machine was read.
    pub was_asked: bool,
}

impl<'a> RunWorld<'a> {
    /// The state at the end of read-ahead; `drained`: the machine has reached it.
    pub const fn new(plant: &'a Plant, lookahead: &'a LookaheadState, drained: bool) -> Self {
        Self { plant, lookahead, drained, was_asked: false }
    }
}

impl ExternalState for RunWorld<'_> {
    fn position(&self) -> WorkPos {
        self.lookahead.work_offsets.work_from_machine(self.lookahead.machine_position)
    }

    fn system_variable(&mut self, number: u32) -> LiveValue {
        self.was_asked = true;
        match self.plant.read_system_variable(number) {
            None => LiveValue::Unknown,
            Some(_) if !self.drained => LiveValue::Drain,
            Some(value) => LiveValue::Value(value),
        }
    }

    fn tool_compensation(&self, tool: u32) -> PerAxis<f64> {
        self.lookahead.work_offsets.tool_compensation(tool)
    }

    fn cutter(&self, offset: usize) -> nc::CutterShape {
        self.lookahead.work_offsets.cutter_of(offset)
    }

    fn active_tool(&self) -> u32 {
        self.lookahead.work_offsets.tool
    }

    fn program_start(&self) -> WorkPos {
        let Some(start) = self.plant.work.tool_change_point else { return self.position() };
        // L8: a tool change read ahead shifts the tip position by the same amount as the slides.
        let (there, now) = (self.lookahead.work_offsets.shift, self.plant.work.offsets.shift);
        self.lookahead.work_offsets.work_from_machine(start + there - now)
    }

    fn block_skip(&self) -> bool {
        self.plant.operator.switches.block_skip
    }
}

impl ProgramRun {
    /// Writes a system variable for a program. False: refused, with the alarm raised.
    pub fn write_system_variable(&mut self, plant: &mut Plant, number: u32, value: Option<f64>) -> bool {
        let value = value.unwrap_or(0.0);
        if let Some(index) = system_variable::OUTPUTS.index(number) {
            let request = Request::Port(index as u8 + 1, value.abs() >= SWITCH_THRESHOLD);
            return matches!(plant.request(request), RequestResult::Accepted | RequestResult::NoEffect(_));
        }
        match system_variable::find(number) {
            Some(&system_variable::WHEEL_DIAMETER) => return self.record_dressing(plant, value),
            Some(&system_variable::MILLISECONDS) => plant.work.timer_offset[0] = value - plant.milliseconds(),
            Some(&system_variable::HOURS) => plant.work.timer_offset[1] = value - plant.hours(),
            // The interpreter has checked their values.
            Some(&system_variable::SINGLE_BLOCK_CONTROL) => plant.work.program_controls.single_block = value as u8,
            Some(&system_variable::HOLD_CONTROL) => plant.work.program_controls.hold = value as u8,
            Some(&system_variable::CONTACT_SEEN) => plant.work.contact_seen = value.abs() >= SWITCH_THRESHOLD,
            // A retract is no phase of the cycle that it interrupts.
            Some(&system_variable::PHASE) if self.origin == Origin::Retract => {}
            Some(&system_variable::PHASE) => {
                plant.execution.phases.enter(GrindingPhase::of_number(value as u32), plant.now);
            }
            Some(&system_variable::PARTS_DONE) => {
                plant.work.part_count = value.max(0.0) as u32;
                plant.store(StorageRequest::PartCount(plant.work.part_count));
            }
            Some(&system_variable::PARTS_REQUIRED) => plant.store_param(param::PARTS_REQUIRED.address(), value),
            Some(_) | None => return self.write_offset(plant, number, value),
        }
        true
    }

    fn write_offset(&mut self, plant: &mut Plant, number: u32, value: f64) -> bool {
        if let Some((place, index)) = OriginPlace::of_variable(number) {
            let Some(axis) = plant.axes.present().nth(index) else { return true };
            if !offset_in_range(OffsetPart::Geometry, value) {
                let message = phrase!("#{number} = {value}", "#{number} = {value}", number, value);
                plant.raise(alarm::OFFSET_RANGE, Some(message));
                return false;
            }
            let mut origin = plant.work.offsets.origin(place);
            origin[axis] = value / plant.displayed_per_mm(axis);
            plant.work.offsets.set_origin(place, origin);
            plant.note_origin(place);
            self.lookahead.work_offsets.clone_from(&plant.work.offsets);
            return true;
        }
        if let Some(changed) = plant.work.offsets.set_cutter_variable(number, value) {
            match changed {
                Ok(index) => plant.note_offset(index),
                Err(_) => {
                    plant.raise(
                        alarm::OFFSET_RANGE,
                        Some(phrase!("#{number} = {value}", "#{number} = {value}", number, value)),
                    );
                    return false;
                }
            }
            self.lookahead.work_offsets.clone_from(&plant.work.offsets);
            return true;
        }
        if let Some(place) = ToolOffsetPlace::of_variable(number) {
            if !offset_in_range(if place.is_wear { OffsetPart::Wear } else { OffsetPart::Geometry }, value) {
                let message = phrase!("#{number} = {value}", "#{number} = {value}", number, value);
                plant.raise(alarm::OFFSET_RANGE, Some(message));
                return false;
            }
            plant.work.offsets.set_tool_offset_value(place, value / plant.displayed_per_mm(place.axis));
            plant.note_offset(place.index);
            self.lookahead.work_offsets.clone_from(&plant.work.offsets);
        }
        true
    }

    /// Records a new wheel diameter, mm, written by a program. False: refused, with the alarm raised.
    pub fn record_dressing(&mut self, plant: &mut Plant, diameter_mm: f64) -> bool {
        if plant.is_dry_or_locked() {
            plant.show_note(phrase!(
                "锁定或空运行：修整不计入砂轮直径",
                "machine lock or dry run: the dressing is not counted"
            ));
            return true;
        }
        let before = plant.params.get(param::WHEEL_DIAMETER);
        let refusal = if diameter_mm > before || diameter_mm < param::WHEEL_DIAMETER.min {
            Some(phrase!(
                "#5801={diameter_mm:.4}，现直径 {before:.4}",
                "#5801={diameter_mm:.4}, current diameter {before:.4}",
                diameter_mm,
                before
            ))
        } else if plant.work.offsets.tool_offset == 0 {
            Some(phrase!("没有刀补生效", "no tool offset is active"))
        } else {
            None
        };
        if let Some(why) = refusal {
            plant.raise(alarm::WHEEL_DIAMETER_REFUSED, Some(why));
            return false;
        }
        let lost_mm = (before - diameter_mm) / 2.0;
        let (axis, index) = (plant.kind.row().wheel_axis, plant.work.offsets.tool_offset - 1);
        plant.work.offsets.wear[index][axis] -= lost_mm;
        plant.note_offset(index);
        self.lookahead.work_offsets.clone_from(&plant.work.offsets);
        if let Some(point) = &mut plant.work.dress_points[axis] {
            *point += lost_mm * plant.params.get(param::DRESSING_POINT_SIDE);
            plant.outbox.requests.push(StorageRequest::DressPoint(axis, Some(*point)));
        }
        self.lookahead.dress_points = plant.work.dress_points;
        plant.store_param(param::WHEEL_DIAMETER.address(), diameter_mm);
        plant.store_param(param::DRESSING_COUNT.address(), plant.params.get(param::DRESSING_COUNT) + 1.0);
        plant.store_param(param::PARTS_SINCE_DRESSING.address(), 0.0);
        true
    }
}
