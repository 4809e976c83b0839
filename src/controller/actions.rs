//! Queued actions: everything a run does besides moving, executed in program order.
//! Source: spec B2, B3, K3.14, K4.

use std::sync::Arc;

use super::gauge::GAUGE_INPUTS;
use super::oscillation::OscillationStroke;
use super::run::{Activity, MCall, Origin, PlannedMove, ProgramRun, QueuedAction};
use super::{ControlEvent, Controller, PanelSwitches, StorageRequest};
use crate::defs::alarm;
use crate::defs::mcode::{MCodeAction, Request};
use crate::defs::param;
use crate::defs::signal::{Input, Output};
use crate::defs::text::LocalizedText;
use crate::machine::RequestResult;
use crate::motion::{CornerMode, Move};
use crate::nc::{CommonVariables, SpeedMode, VariableError};
use crate::units::{Micros, PerAxis};

/// Status of a queued action after one tick.
pub(super) enum ActionStatus {
    Done,
    /// Not finished; called again in the next tick.
    Wait,
    /// Done; the run stops until cycle start.
    Stop,
    /// The run is over.
    EndRun,
}

impl Controller {
    pub(super) fn execute_action(&mut self, run: &mut ProgramRun, act: &QueuedAction) -> ActionStatus {
        match act {
            QueuedAction::SetVariable(variable, value) => {
                // The interpreter has already checked number and value.
                let _ = self.store_variable(*variable, *value);
                ActionStatus::Done
            }
            QueuedAction::SetSystemVariable(number, value) => {
                if self.write_system_variable(run, *number, *value) {
                    ActionStatus::Done
                } else {
                    ActionStatus::Wait
                }
            }
            QueuedAction::WheelSpeedLimit(rpm) => {
                self.wheel_rpm_limit = Some(*rpm);
                ActionStatus::Done
            }
            QueuedAction::SetCoordinateSystem(values) => self.set_coordinate_system(run, values),
            QueuedAction::SetWorkOffsets(frames) => {
                self.shift_tool_change_point(frames.shift);
                self.set_work_offsets(frames);
                ActionStatus::Done
            }
            QueuedAction::MCode(call) => self.m_code(run, *call),
            QueuedAction::Gauge(asked) => self.step_gauge(run, asked),
            QueuedAction::Oscillate(stroke) => self.begin_servo_oscillation(run, *stroke),
            QueuedAction::Cylinder(on) => self.switch_cylinder(*on),
            QueuedAction::Thread(thread) => self.step_thread(run, thread),
            QueuedAction::Home(axis) => self.step_program_homing(run, *axis),
            QueuedAction::IndexTurret(station) => self.step_turret(run, *station),
            QueuedAction::Dwell(seconds) => self.dwell(run, *seconds),
            QueuedAction::WheelSpeed(..) if self.switches.aux_function_lock => ActionStatus::Done,
            QueuedAction::WheelSpeed(value, mode) => {
                self.set_wheel_speed(*value, *mode);
                ActionStatus::Done
            }
            QueuedAction::Skip(planned, signal) => self.step_skip(run, planned, *signal),
            QueuedAction::Alarm(number, text, place) => {
                self.current_block = *place;
                self.raise(*number, Some(text.clone()));
                ActionStatus::Wait
            }
            QueuedAction::Note(text) => self.show_program_message(text),
            QueuedAction::Message(text) => match self.is_settled(run) {
                Some(true) => {
                    self.show_note(text.clone());
                    ActionStatus::Stop
                }
                _ => ActionStatus::Wait,
            },
            QueuedAction::EndOfText => match self.is_settled(run) {
                Some(true) => ActionStatus::EndRun,
                _ => ActionStatus::Wait,
            },
        }
    }

    fn begin_servo_oscillation(&mut self, run: &mut ProgramRun, stroke: OscillationStroke) -> ActionStatus {
        match self.is_settled(run) {
            Some(true) => {
                self.begin_oscillation(stroke, true);
                ActionStatus::Done
            }
            Some(false) | None => ActionStatus::Wait,
        }
    }

    /// G35 by cylinder, and G36: the stroke ends at its start point, then the next block runs (K4.3).
    fn switch_cylinder(&mut self, on: bool) -> ActionStatus {
        let done = if on {
            matches!(self.request(Request::CylinderOn), RequestResult::Accepted | RequestResult::NoEffect(_))
        } else {
            self.axes.is_at_rest() && self.end_oscillation()
        };
        if done { ActionStatus::Done } else { ActionStatus::Wait }
    }

    /// G50: sets the work coordinates of the present position once all motion is over.
    fn set_coordinate_system(&mut self, run: &mut ProgramRun, values: &PerAxis<Option<f64>>) -> ActionStatus {
        match self.is_settled(run) {
            Some(true) => {
                let mut frames = self.work_offsets.clone();
                frames.set_coordinates(self.axes.set_point(), values);
                self.set_work_offsets(&frames);
                run.lookahead.work_offsets = Arc::new(frames);
                ActionStatus::Done
            }
            Some(false) | None => ActionStatus::Wait,
        }
    }

    /// S: wheel speed in rpm, or as surface speed by the wheel diameter P77.
    fn set_wheel_speed(&mut self, value: f64, mode: SpeedMode) {
        self.wheel_speed = (value, mode);
        if self.output_set.has(Output::Wheel) && self.output_wheel_rpm() < self.commanded_wheel_rpm() {
            self.refuse(LocalizedText::new(
                "S 超过砂轮额定线速度，按额定转速运行 (P77 P79)",
                "S exceeds the wheel's rating: it runs at the rating (P77, P79)",
            ));
        }
    }

    /// Whether all motion is over and the axes are in position; `None` after the time-out, with the alarm raised.
    pub(super) fn is_settled(&mut self, run: &mut ProgramRun) -> Option<bool> {
        if !self.axes.is_at_rest() {
            return Some(false);
        }
        if self.axes.is_in_position(&self.params) {
            return Some(true);
        }
        let since = *run.settling_since.get_or_insert(self.now);
        if self.now.since(since) > Micros::from_millis_f64(self.params.get(param::IN_POSITION_TIMEOUT)) {
            self.raise(alarm::IN_POSITION_TIMEOUT, None);
            return None;
        }
        Some(false)
    }

    fn m_code(&mut self, run: &mut ProgramRun, call: MCall) -> ActionStatus {
        if let Some(request) = call.request() {
            return self.request_m_code(run, call, request);
        }
        match call.row.action {
            MCodeAction::OptionalStop if !self.switches.optional_stop => ActionStatus::Done,
            MCodeAction::ProgramStop | MCodeAction::OptionalStop => match self.is_settled(run) {
                Some(true) => ActionStatus::Stop,
                Some(false) | None => ActionStatus::Wait,
            },
            MCodeAction::CountWorkpiece => {
                self.count_part();
                ActionStatus::Done
            }
            MCodeAction::ProgramEnd => match self.is_settled(run) {
                Some(true) => {
                    self.end_program(run.origin);
                    ActionStatus::EndRun
                }
                Some(false) | None => ActionStatus::Wait,
            },
            MCodeAction::AwaitInput(_) if self.switches.aux_function_lock => ActionStatus::Done,
            MCodeAction::AwaitInput(input) => self.await_input(run, input),
            MCodeAction::ProgramFlow | MCodeAction::Request(_) | MCodeAction::Port(_) | MCodeAction::Pulse => {
                ActionStatus::Done
            }
        }
    }

    /// M30 (K3.14, K5.17).
    fn end_program(&mut self, origin: Origin) {
        if origin == Origin::Retract {
            return; // K6.4: the held run is not finished
        }
        self.machine.program_end(&self.params);
        if self.params.bit(param::COUNT_ON_M30) {
            self.count_part();
        }
        let PanelSwitches { machine_lock, aux_function_lock: mst_lock, dry_run, .. } = self.switches;
        let really = origin == Origin::Program && !machine_lock && !mst_lock && !dry_run;
        if really && self.params.bit(param::WHEEL_UNDRESSED) && self.control_state().dressing_program {
            self.store_param(param::WHEEL_UNDRESSED.address(), 0.0);
        }
    }

    fn request_m_code(&mut self, run: &mut ProgramRun, call: MCall, request: Request) -> ActionStatus {
        if run.activity == Activity::Settling {
            return if self.machine.is_settled(request) { ActionStatus::Done } else { ActionStatus::Wait };
        }
        if self.switches.aux_function_lock {
            return ActionStatus::Done;
        }
        let answer = self.request(request);
        if let (Some(rpm), RequestResult::Accepted, Request::WorkDriveHigh | Request::WorkDriveLow) =
            (call.s, answer, request)
        {
            self.analog_2_rpm = rpm; // K3.4: M63 S
            let most = self.params.get(param::ANALOG_2_RPM_MAX);
            if rpm > most {
                self.refuse(LocalizedText::new(
                    format!("S{rpm} 超过第二模拟量最高转速，按 {most} 运行 (P65)"),
                    format!("S{rpm} is above the second analog output: it gives {most} (P65)"),
                ));
            }
        }
        match answer {
            RequestResult::Accepted if call.row.waits => {
                run.activity = Activity::Settling;
                if self.machine.is_settled(request) { ActionStatus::Done } else { ActionStatus::Wait }
            }
            RequestResult::Accepted | RequestResult::NoEffect(_) => ActionStatus::Done,
            // The block waits as in a feed hold; cycle start requests it again.
            RequestResult::Denied(_) => {
                self.transition(ControlEvent::Hold);
                ActionStatus::Wait
            }
            RequestResult::Alarm(..) => ActionStatus::Wait,
        }
    }

    fn await_input(&mut self, run: &mut ProgramRun, input: Input) -> ActionStatus {
        if self.inputs.has(input) {
            self.waiting_for = None;
            return ActionStatus::Done;
        }
        if run.activity == Activity::Idle {
            let (name, port) = (input.name(), self.params.input_port(input));
            if port == 0 {
                self.raise(alarm::INPUT_NOT_ASSIGNED, Some(name.into()));
                return ActionStatus::Wait;
            }
            run.activity = Activity::AwaitInput(input);
            let what = LocalizedText::new(
                format!("等待{}，输入口 {port}", name.zh),
                format!("waiting for {}, port {port}", name.en),
            );
            self.show_note(what.clone());
            self.waiting_for = Some(what);
        }
        ActionStatus::Wait
    }

    fn dwell(&mut self, run: &mut ProgramRun, seconds: f64) -> ActionStatus {
        match run.activity {
            Activity::Dwell { until } if self.now >= until => ActionStatus::Done,
            Activity::Dwell { .. } => ActionStatus::Wait,
            Activity::Idle
            | Activity::Settling
            | Activity::AwaitInput(_)
            | Activity::Threading
            | Activity::Homing
            | Activity::Skipping { .. } => {
                if self.axes.is_at_rest() {
                    run.activity = Activity::Dwell { until: self.now + Micros::from_secs_f64(seconds) };
                }
                ActionStatus::Wait
            }
        }
    }

    /// G31: the position is latched in the tick of the signal edge, then the axes brake.
    fn step_skip(&mut self, run: &mut ProgramRun, planned: &PlannedMove, signal: u8) -> ActionStatus {
        let input = GAUGE_INPUTS[usize::from(signal.clamp(1, 6)) - 1];
        match run.activity {
            Activity::Idle
            | Activity::Settling
            | Activity::Dwell { .. }
            | Activity::AwaitInput(_)
            | Activity::Threading
            | Activity::Homing => {
                let tag = run.next_tag;
                let most = self.params.get(param::SKIP_SPEED_MAX);
                let Some(rate) = planned.speed.rate(self.workpiece_rpm(), most) else {
                    return self.raise_no_workpiece_drive();
                };
                let pushed =
                    Move { to: planned.to, shape: planned.shape, speed: rate, corner: CornerMode::ExactStop, tag };
                if self.axes.planner.push(pushed).is_ok() {
                    run.next_tag += 1;
                    run.activity = Activity::Skipping { tag, latched: false };
                }
                ActionStatus::Wait
            }
            Activity::Skipping { tag, latched: false } => {
                if self.raw_inputs.has(input) {
                    self.skip_position = self.work_position();
                    self.axes.planner.abort();
                    run.activity = Activity::Skipping { tag, latched: true };
                } else if self.axes.planner.finished_tag() >= Some(tag) {
                    // The end point, not the lagging actual position: it tells the program that no signal came.
                    self.skip_position = self.work_offsets.work_from_machine(self.axes.set_point());
                    return ActionStatus::Done;
                }
                ActionStatus::Wait
            }
            Activity::Skipping { latched: true, .. } if self.axes.is_at_rest() => {
                run.lookahead.machine_position = self.axes.set_point();
                ActionStatus::Done
            }
            Activity::Skipping { latched: true, .. } => ActionStatus::Wait,
        }
    }

    pub(super) fn raise_no_workpiece_drive(&mut self) -> ActionStatus {
        self.raise(
            alarm::WORK_DRIVE_BLOCKED,
            Some(LocalizedText::new(
                "每转进给需要工件转动，先用 M63 启动",
                "a feed per revolution needs the workpiece turning: M63 first",
            )),
        );
        ActionStatus::Wait
    }

    /// Sets a common variable at execution time; retained variables are also stored on disk.
    pub(super) fn store_variable(&mut self, variable: u32, value: Option<f64>) -> Result<(), VariableError> {
        self.memory.set(variable, value)?;
        // A run suspended by the retract has its own copy.
        if let Some(waiting) = self.retract.suspended_run() {
            let _ = waiting.interpreter.update_variable(variable, value);
        }
        if CommonVariables::is_retained(variable) {
            self.storage_requests.push(StorageRequest::Variable(variable, value));
        }
        Ok(())
    }

    fn set_work_offsets(&mut self, frames: &super::WorkOffsets) {
        for number in 1..=crate::nc::work_offsets::TOOL_OFFSET_COUNT {
            let (geometry, wear) = (frames.geometry[number - 1], frames.wear[number - 1]);
            if wear != self.work_offsets.wear[number - 1] {
                self.storage_requests.push(StorageRequest::Offset { number, geometry, wear });
            }
        }
        self.work_offsets.clone_from(frames);
    }

    pub(super) fn count_part(&mut self) {
        self.part_count += 1;
        self.storage_requests.push(StorageRequest::PartCount(self.part_count));
        self.count_since_dressing();
    }
}
