//! Queued actions: everything a run does besides moving, executed in program order.
//! Source: spec B2, B3, K3.14, K4.

use super::activity::{ActionStatus, Activity, GAUGE_INPUTS};
use super::queue::{MCall, PlannedMove, QueuedAction};
use super::run::{Origin, ProgramRun};
use crate::controller::axes::oscillation::OscillationStroke;
use crate::controller::plant::{ControlEvent, Plant};
use crate::defs::alarm;
use crate::defs::mcode::{MCodeAction, Request};
use crate::defs::param;
use crate::defs::signal::Input;
use crate::defs::text::{LocalizedText, phrase};
use crate::machine::RequestResult;
use crate::motion::{CornerMode, Move};
use crate::nc::CoordinateChange;
use crate::units::Micros;

impl ProgramRun {
    /// One tick of the action at the front of the queue.
    pub fn execute_action(&mut self, plant: &mut Plant, act: &QueuedAction) -> ActionStatus {
        match act {
            QueuedAction::SetVariable(variable, value) => {
                // The interpreter has already checked number and value.
                let _ = plant.store_variable(*variable, *value);
                ActionStatus::Done
            }
            QueuedAction::SetSystemVariable(number, value) => {
                if self.write_system_variable(plant, *number, *value) {
                    ActionStatus::Done
                } else {
                    ActionStatus::Wait
                }
            }
            QueuedAction::WheelSpeedLimit(rpm) => {
                plant.spindles.wheel_rpm_limit = Some(*rpm);
                ActionStatus::Done
            }
            QueuedAction::ChangeCoordinates(change) => self.change_coordinates(plant, *change),
            QueuedAction::ChangeTool(station, by) => {
                plant.change_tool(*station, *by);
                ActionStatus::Done
            }
            QueuedAction::MCode(call) => self.m_code(plant, *call),
            QueuedAction::Gauge(asked) => self.step_gauge(plant, asked),
            QueuedAction::Oscillate(stroke) => self.begin_servo_oscillation(plant, *stroke),
            QueuedAction::Cylinder(on) => switch_cylinder(plant, *on),
            QueuedAction::Thread(thread) => self.step_thread(plant, thread),
            QueuedAction::Home(axis) => self.step_program_homing(plant, *axis),
            QueuedAction::IndexTurret(station) => self.step_turret(plant, *station),
            QueuedAction::Dwell(seconds) => self.dwell(plant, *seconds),
            QueuedAction::WheelSpeed(..) if plant.operator.switches.aux_function_lock => ActionStatus::Done,
            QueuedAction::WheelSpeed(value, mode) => {
                plant.set_wheel_speed(*value, *mode);
                ActionStatus::Done
            }
            QueuedAction::Skip(planned, signal) => self.step_skip(plant, planned, *signal),
            QueuedAction::Alarm(number, text, place) => {
                plant.execution.current_block = *place;
                plant.raise(*number, Some(text.clone()));
                ActionStatus::Wait
            }
            QueuedAction::Note(text) => {
                plant.show_program_message(text);
                ActionStatus::Done
            }
            QueuedAction::Message(text) => match self.is_settled(plant) {
                Some(true) => {
                    plant.show_note(text.clone());
                    ActionStatus::Stop
                }
                _ => ActionStatus::Wait,
            },
            QueuedAction::EndOfText => match self.is_settled(plant) {
                Some(true) => ActionStatus::EndRun,
                _ => ActionStatus::Wait,
            },
        }
    }

    fn begin_servo_oscillation(&mut self, plant: &mut Plant, stroke: OscillationStroke) -> ActionStatus {
        match self.is_settled(plant) {
            Some(true) => {
                plant.begin_oscillation(stroke, true);
                ActionStatus::Done
            }
            Some(false) | None => ActionStatus::Wait,
        }
    }

    /// Changes the work coordinates; G50 once all motion is over, at the position reached.
    fn change_coordinates(&mut self, plant: &mut Plant, change: CoordinateChange) -> ActionStatus {
        let at_rest = matches!(change, CoordinateChange::Set(_));
        if at_rest && self.is_settled(plant) != Some(true) {
            return ActionStatus::Wait;
        }
        plant.change_coordinates(change);
        if at_rest {
            self.lookahead.work_offsets.clone_from(&plant.work.offsets);
        }
        ActionStatus::Done
    }

    /// Whether all motion is over and the axes are in position; `None` after the time-out, with the alarm raised.
    pub fn is_settled(&mut self, plant: &mut Plant) -> Option<bool> {
        if !plant.axes.is_at_rest() {
            return Some(false);
        }
        if plant.axes.is_in_position(&plant.params) {
            return Some(true);
        }
        let since = match self.activity {
            Activity::Settling { since } => since,
            Activity::Idle
            | Activity::AwaitUnit
            | Activity::Dwell { .. }
            | Activity::AwaitInput(_)
            | Activity::Skip { .. }
            | Activity::Gauge(_)
            | Activity::Thread
            | Activity::Homing => {
                self.activity = Activity::Settling { since: plant.now };
                plant.now
            }
        };
        if plant.now.since(since) > Micros::from_millis_f64(plant.params.get(param::IN_POSITION_TIMEOUT)) {
            plant.raise(alarm::IN_POSITION_TIMEOUT, None);
            return None;
        }
        Some(false)
    }

    fn m_code(&mut self, plant: &mut Plant, call: MCall) -> ActionStatus {
        if let Some(request) = call.request() {
            return self.request_m_code(plant, call, request);
        }
        match call.row.action {
            MCodeAction::OptionalStop if !plant.operator.switches.optional_stop => ActionStatus::Done,
            MCodeAction::ProgramStop | MCodeAction::OptionalStop => match self.is_settled(plant) {
                Some(true) => ActionStatus::Stop,
                Some(false) | None => ActionStatus::Wait,
            },
            MCodeAction::CountWorkpiece => {
                plant.count_part();
                ActionStatus::Done
            }
            MCodeAction::ProgramEnd => match self.is_settled(plant) {
                Some(true) => {
                    end_program(plant, self.origin);
                    ActionStatus::EndRun
                }
                Some(false) | None => ActionStatus::Wait,
            },
            MCodeAction::AwaitInput(_) if plant.operator.switches.aux_function_lock => ActionStatus::Done,
            MCodeAction::AwaitInput(input) => self.await_input(plant, input),
            MCodeAction::ProgramFlow | MCodeAction::Request(_) | MCodeAction::Port(_) | MCodeAction::Pulse => {
                ActionStatus::Done
            }
        }
    }

    fn request_m_code(&mut self, plant: &mut Plant, call: MCall, request: Request) -> ActionStatus {
        if self.activity == Activity::AwaitUnit {
            return if plant.machine.is_settled(request) { ActionStatus::Done } else { ActionStatus::Wait };
        }
        if plant.operator.switches.aux_function_lock {
            return ActionStatus::Done;
        }
        let answer = plant.request(request);
        if let (Some(rpm), RequestResult::Accepted, Request::WorkDriveHigh | Request::WorkDriveLow) =
            (call.s, answer, request)
        {
            plant.spindles.analog_2_rpm = rpm; // K3.4: M63 S
            let most = plant.params.get(param::ANALOG_2_RPM_MAX);
            if rpm > most {
                plant.refuse(phrase!(
                    "S{rpm} 超过第二模拟量最高转速，按 {most} 运行 (P65)",
                    "S{rpm} is above the second analog output: it gives {most} (P65)",
                    rpm,
                    most
                ));
            }
        }
        match answer {
            RequestResult::Accepted if call.row.waits => {
                self.activity = Activity::AwaitUnit;
                if plant.machine.is_settled(request) { ActionStatus::Done } else { ActionStatus::Wait }
            }
            RequestResult::Accepted | RequestResult::NoEffect(_) => ActionStatus::Done,
            // The block waits as in a feed hold; cycle start requests it again.
            RequestResult::Denied(_) => {
                plant.transition(ControlEvent::Hold);
                ActionStatus::Wait
            }
            RequestResult::Alarm(..) => ActionStatus::Wait,
        }
    }

    fn await_input(&mut self, plant: &mut Plant, input: Input) -> ActionStatus {
        if plant.inputs.filtered.has(input) {
            return ActionStatus::Done;
        }
        if self.activity == Activity::Idle {
            let port = plant.params.input_port(input);
            if port == 0 {
                plant.raise(alarm::INPUT_NOT_ASSIGNED, Some(input.name().into()));
                return ActionStatus::Wait;
            }
            self.activity = Activity::AwaitInput(input);
            plant.show_note(awaited_input_text(input, port));
        }
        ActionStatus::Wait
    }

    fn dwell(&mut self, plant: &mut Plant, seconds: f64) -> ActionStatus {
        match self.activity {
            Activity::Dwell { until } if plant.now >= until => ActionStatus::Done,
            Activity::Dwell { .. } => ActionStatus::Wait,
            Activity::Idle
            | Activity::Settling { .. }
            | Activity::AwaitUnit
            | Activity::AwaitInput(_)
            | Activity::Skip { .. }
            | Activity::Gauge(_)
            | Activity::Thread
            | Activity::Homing => {
                if plant.axes.is_at_rest() {
                    self.activity = Activity::Dwell { until: plant.now + Micros::from_secs_f64(seconds) };
                }
                ActionStatus::Wait
            }
        }
    }

    /// G31: the position is latched in the tick of the signal edge, then the axes brake.
    fn step_skip(&mut self, plant: &mut Plant, planned: &PlannedMove, signal: u8) -> ActionStatus {
        let input = GAUGE_INPUTS[usize::from(signal.clamp(1, 6)) - 1];
        match self.activity {
            Activity::Idle
            | Activity::Settling { .. }
            | Activity::AwaitUnit
            | Activity::Dwell { .. }
            | Activity::AwaitInput(_)
            | Activity::Gauge(_)
            | Activity::Thread
            | Activity::Homing => {
                let tag = self.next_tag;
                let most = plant.params.get(param::SKIP_SPEED_MAX);
                let Some(rate) = planned.speed.rate(plant.workpiece_rpm(), most) else {
                    return raise_no_workpiece_drive(plant);
                };
                let pushed =
                    Move { to: planned.to, shape: planned.shape, speed: rate, corner: CornerMode::ExactStop, tag };
                if plant.axes.planner.push(pushed).is_ok() {
                    self.next_tag += 1;
                    self.activity = Activity::Skip { tag, latched: false };
                }
                ActionStatus::Wait
            }
            Activity::Skip { tag, latched: false } => {
                if plant.inputs.raw.has(input) {
                    plant.work.skip_position = plant.work_position();
                    plant.axes.planner.abort();
                    self.activity = Activity::Skip { tag, latched: true };
                } else if plant.axes.planner.finished_tag() >= Some(tag) {
                    // The end point, not the lagging actual position: it tells the program that no signal came.
                    plant.work.skip_position = plant.work.offsets.work_from_machine(plant.axes.set_point());
                    return ActionStatus::Done;
                }
                ActionStatus::Wait
            }
            Activity::Skip { latched: true, .. } if plant.axes.is_at_rest() => {
                self.lookahead.machine_position = plant.axes.set_point();
                ActionStatus::Done
            }
            Activity::Skip { latched: true, .. } => ActionStatus::Wait,
        }
    }
}

/// G35 by cylinder, and G36: the stroke ends at its start point, then the next block runs (K4.3).
fn switch_cylinder(plant: &mut Plant, on: bool) -> ActionStatus {
    let done = if on {
        matches!(plant.request(Request::CylinderOn), RequestResult::Accepted | RequestResult::NoEffect(_))
    } else {
        plant.axes.is_at_rest() && plant.end_oscillation()
    };
    if done { ActionStatus::Done } else { ActionStatus::Wait }
}

/// The text shown while a program waits for an input.
pub fn awaited_input_text(input: Input, port: u8) -> LocalizedText {
    phrase!("等待{input}，输入口 {port}", "waiting for {input}, port {port}", input, port)
}

/// Raises the alarm of a feed per revolution without rotation.
pub fn raise_no_workpiece_drive(plant: &mut Plant) -> ActionStatus {
    plant.raise(
        alarm::WORK_DRIVE_BLOCKED,
        Some(phrase!(
            "每转进给需要工件转动，先用 M63 启动",
            "a feed per revolution needs the workpiece turning: M63 first"
        )),
    );
    ActionStatus::Wait
}

/// M30 (K3.14, K5.17).
fn end_program(plant: &mut Plant, origin: Origin) {
    if origin == Origin::Retract {
        return; // K6.4: the held run is not finished
    }
    plant.machine.program_end(&plant.params);
    if plant.params.bit(param::COUNT_ON_M30) {
        plant.count_part();
    }
    let really = origin == Origin::Program && !plant.is_dry_or_locked();
    if really && plant.params.bit(param::WHEEL_UNDRESSED) && plant.control_state().dressing_program {
        plant.store_param(param::WHEEL_UNDRESSED.address(), 0.0);
    }
}
