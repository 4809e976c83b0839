//! Queued actions: everything a run does besides moving, executed in program order.
//! Source: spec B2, B3, K3.14, K4.

use std::sync::Arc;

use super::activity::{ActionStatus, Activity};
use super::gauge::watch_skip;
use super::queue::{MCall, PlannedMove, QueuedAction};
use super::run::{Origin, ProgramRun};
use crate::controller::plant::{ControlEvent, Plant};
use crate::controller::storage_request::StorageRequest;
use crate::defs::alarm;
use crate::defs::kind::Kind;
use crate::defs::mcode::{MCodeAction, Request};
use crate::defs::param;
use crate::defs::signal::Input;
use crate::defs::soft_key;
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, Template, phrase};
use crate::machine::RequestResult;
use crate::motion::{CornerMode, MotionSpeed, Move, MoveShape};
use crate::nc::{BlockLocation, CONTACT_SKIP_SIGNAL, CoordinateChange};
use crate::units::{MachinePos, Micros};

const CONTINUE: &Template = &Template::new("{text}：按循环启动继续", "{text}: cycle start continues", &["text"]);

impl ProgramRun {
    /// One tick of the action at the front of the queue.
    pub fn execute_action(&mut self, plant: &mut Plant, action: &QueuedAction) -> ActionStatus {
        match action {
            QueuedAction::SetVariable(variable, value) => {
                // The interpreter has already checked number and value.
                let _ = plant.write_variable(*variable, *value);
                ActionStatus::Done
            }
            QueuedAction::SetSystemVariable(number, value) => {
                ActionStatus::done_if(self.write_system_variable(plant, *number, *value))
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
            QueuedAction::Alarm(number, text, place) => self.raise_alarm(plant, (*number, text), *place),
            QueuedAction::Note(text) => {
                plant.show_program_message(text);
                ActionStatus::Done
            }
            QueuedAction::Print(text) => print_line(plant, text),
            QueuedAction::Oscillate(_) | QueuedAction::Message(_) | QueuedAction::EndOfText
                if !self.is_settled(plant) =>
            {
                ActionStatus::Wait
            }
            QueuedAction::Oscillate(stroke) => {
                plant.begin_oscillation(*stroke, true);
                ActionStatus::Done
            }
            QueuedAction::Message(text) => {
                plant.show_note(text.clone());
                plant.execution.stop_reason = Some(LocalizedText::phrase_of(CONTINUE, [], [text.clone()]));
                ActionStatus::Stop
            }
            QueuedAction::EndOfText => ActionStatus::EndRun,
        }
    }

    /// Changes the work coordinates; G50 once all motion is over, at the position reached.
    /// Raises an alarm of the program: one of `#3000`, a refused block, or a mistake with its remedy and its calls.
    fn raise_alarm(
        &mut self,
        plant: &mut Plant,
        (number, text): (u16, &LocalizedText),
        place: BlockLocation,
    ) -> ActionStatus {
        plant.execution.enter_block(place);
        raise_program_alarm(plant, number, text, place.program);
        if let Some(fault) = self.fault.take_if(|fault| fault.location == place) {
            plant.alarms.complete_words(number, fault.calls_phrase(), fault.remedy_phrase());
        }
        ActionStatus::Wait
    }

    fn change_coordinates(&mut self, plant: &mut Plant, change: CoordinateChange) -> ActionStatus {
        let at_rest = matches!(change, CoordinateChange::Set(_));
        if at_rest && !self.is_settled(plant) {
            return ActionStatus::Wait;
        }
        if let CoordinateChange::Tool { offset, .. } = change {
            plant.execution.called_offsets.call(usize::from(offset));
        }
        plant.change_coordinates(change);
        if at_rest {
            self.lookahead.work_offsets.clone_from(&plant.work.offsets);
        }
        ActionStatus::Done
    }

    /// Whether all motion is over and the axes are in position; after the time-out the alarm is raised.
    pub fn is_settled(&mut self, plant: &mut Plant) -> bool {
        if !plant.axes.is_at_rest() || plant.axes.is_in_position(&plant.params) {
            return plant.axes.is_at_rest();
        }
        let since = if let Activity::Settling { since } = self.activity { since } else { plant.now };
        self.activity = Activity::Settling { since };
        plant.await_in_position(since);
        false
    }

    fn m_code(&mut self, plant: &mut Plant, call: MCall) -> ActionStatus {
        if let Some(request) = call.request() {
            return self.request_m_code(plant, call, request);
        }
        match call.row.action {
            MCodeAction::OptionalStop if !plant.operator.switches.optional_stop => ActionStatus::Done,
            MCodeAction::ProgramStop | MCodeAction::OptionalStop | MCodeAction::ProgramEnd
                if !self.is_settled(plant) =>
            {
                ActionStatus::Wait
            }
            MCodeAction::ProgramStop | MCodeAction::OptionalStop => {
                plant.execution.stop_reason = Some(stop_reason(plant.kind, call));
                ActionStatus::Stop
            }
            MCodeAction::CountWorkpiece => {
                plant.count_part();
                plant.execution.parts_counted += u32::from(makes_parts(plant, self.origin));
                ActionStatus::Done
            }
            MCodeAction::ProgramEnd => {
                end_program(plant, self.origin);
                ActionStatus::EndRun
            }
            MCodeAction::AwaitInput(_) if plant.operator.switches.aux_function_lock => ActionStatus::Done,
            MCodeAction::AwaitInput(input) => self.await_input(plant, input),
            MCodeAction::ProgramFlow | MCodeAction::Request(_) | MCodeAction::Port(_) | MCodeAction::Pulse => {
                ActionStatus::Done
            }
        }
    }

    fn request_m_code(&mut self, plant: &mut Plant, call: MCall, request: Request) -> ActionStatus {
        if self.activity == Activity::AwaitUnit {
            return ActionStatus::done_if(plant.machine.is_settled(request));
        }
        if plant.operator.switches.aux_function_lock {
            return ActionStatus::Done;
        }
        let answer = plant.request(request);
        if let (RequestResult::Accepted, Request::WorkDriveHigh | Request::WorkDriveLow) = (answer, request) {
            let rpm = call.s.unwrap_or(0.0); // K3.4: M63 S
            plant.spindles.analog_2_rpm = rpm;
            let most = plant.params.get(param::ANALOG_2_RPM_MAX);
            if rpm > most {
                plant.refuse(phrase!(
                    "S{rpm} 超过第二模拟量最高转速，按 {most} 运行 (P65)",
                    "S{rpm} exceeds the second analog output: limited to {most} (P65)",
                    rpm,
                    most
                ));
            }
        }
        match answer {
            RequestResult::Accepted if call.row.waits => {
                self.activity = Activity::AwaitUnit;
                ActionStatus::done_if(plant.machine.is_settled(request))
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
        if let Activity::Dwell { until } = self.activity {
            return ActionStatus::done_if(plant.now >= until);
        }
        if plant.axes.is_at_rest() {
            self.activity = Activity::Dwell { until: plant.now + Micros::from_secs_f64(seconds) };
        }
        ActionStatus::Wait
    }

    /// G31: the position is latched by the drives, else in the tick of the signal edge; then the axes brake.
    fn step_skip(&mut self, plant: &mut Plant, planned: &PlannedMove, signal: u8) -> ActionStatus {
        let Activity::Skip { tag, latched, arrived_at, .. } = self.activity else {
            if signal == CONTACT_SKIP_SIGNAL && plant.params.input_port(Input::WheelContact) == 0 {
                plant.raise(alarm::INPUT_NOT_ASSIGNED, Some(Input::WheelContact.name().into()));
                return ActionStatus::Wait;
            }
            let most = plant.params.get(param::SKIP_SPEED_MAX);
            let Some(rate) = planned.speed.rate(plant.workpiece_rpm(), most) else {
                return raise_no_workpiece_drive(plant);
            };
            if let Some(tag) = self.push_move(plant, planned.to, planned.shape, rate, CornerMode::ExactStop) {
                self.activity = Activity::Skip { tag, signal, latched: None, arrived_at: None };
            }
            return ActionStatus::Wait;
        };
        let latched = watch_skip(plant, signal, latched);
        self.activity = Activity::Skip { tag, signal, latched, arrived_at };
        if let Some(place) = latched {
            if plant.axes.is_at_rest() {
                plant.work.skip_position = place.work_position(plant);
                self.lookahead.machine_position = plant.axes.program_set_point();
                return ActionStatus::Done;
            }
        } else if plant.axes.planner.finished_tag() >= Some(tag) {
            // The axes lag behind their set-points: a late contact still counts.
            if !plant.axes.is_in_position(&plant.params) {
                let since = arrived_at.unwrap_or(plant.now);
                self.activity = Activity::Skip { tag, signal, latched, arrived_at: Some(since) };
                plant.await_in_position(since);
                return ActionStatus::Wait;
            }
            // The end point, not the lagging actual position: it tells the program that no signal came.
            plant.work.skip_position = plant.work.offsets.work_from_machine(plant.axes.set_point());
            return ActionStatus::Done;
        }
        ActionStatus::Wait
    }

    /// Hands a move to the planner; its tag, or `None` while the planner is full.
    pub fn push_move(
        &mut self,
        plant: &mut Plant,
        to: MachinePos,
        shape: MoveShape,
        speed: MotionSpeed,
        corner: CornerMode,
    ) -> Option<u32> {
        let tag = self.next_tag;
        plant.axes.planner.push(Move { to, shape, speed, corner, tag }).ok()?;
        self.next_tag += 1;
        Some(tag)
    }
}

/// Raises an alarm of `#3000` with what its program says of it: cause, remedy, and the variable whose value is wrong (B8).
fn raise_program_alarm(plant: &mut Plant, number: u16, text: &LocalizedText, program: u32) {
    let (text, variable) = plant.program_alarm_words(number, text, program);
    plant.raise(number, Some(text));
    let programs = Arc::clone(&plant.work.programs);
    if let Some(help) = programs.get(program).and_then(|program| program.source.alarm_help(u32::from(number))) {
        plant.alarms.explain(number, help, variable);
    }
}

/// What M00 and M01 wait for.
fn stop_reason(kind: Kind, call: MCall) -> LocalizedText {
    let code = Arg::from(format_args!("M{:02}", call.row.code));
    match soft_key::f1_continues(kind) {
        true => phrase!(
            "{code} 程序暂停：按循环启动或 F1 继续",
            "{code}, the program waits: cycle start or F1 continues",
            code
        ),
        false => phrase!("{code} 程序暂停：按循环启动继续", "{code}, the program waits: cycle start continues", code),
    }
}

/// DPRNT: the line goes to the file of the day.
fn print_line(plant: &mut Plant, text: &Arg) -> ActionStatus {
    plant.store(StorageRequest::PrintLine(plant.date, text.clone()));
    ActionStatus::Done
}

/// G35 by cylinder, and G36: the stroke ends at its start point, then the next block runs (K4.3).
fn switch_cylinder(plant: &mut Plant, on: bool) -> ActionStatus {
    plant.operator.cylinder_by_key = false;
    let done = if on {
        matches!(plant.request(Request::CylinderOn), RequestResult::Accepted | RequestResult::NoEffect(_))
    } else {
        plant.axes.is_at_rest() && plant.end_oscillation()
    };
    ActionStatus::done_if(done)
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
            "feed per revolution needs the workpiece turning: start it with M63 first"
        )),
    );
    ActionStatus::Wait
}

/// Whether what a run counts is a part: not an air cut, not a dressing, no line of MDI, and no run that ends with its message
/// shown (`MSG`): that has refused itself.
fn makes_parts(plant: &Plant, origin: Origin) -> bool {
    let refuses_itself = plant.outbox.program_message.is_some();
    let dressing = plant.control_state().dressing_program;
    origin == Origin::Program && !plant.is_dry_or_locked() && !dressing && !refuses_itself
}

/// M30 (K3.14, K5.17).
fn end_program(plant: &mut Plant, origin: Origin) {
    if origin == Origin::Retract {
        return; // K6.4: the held run is not finished
    }
    plant.machine.program_end(&plant.params);
    let makes_parts = makes_parts(plant, origin);
    if plant.params.bit(param::COUNT_ON_M30) {
        plant.count_part();
        plant.execution.parts_counted += u32::from(makes_parts);
    }
    let really = origin == Origin::Program && !plant.is_dry_or_locked();
    let dressing = plant.control_state().dressing_program;
    plant.execution.part_finished = makes_parts;
    if really && plant.params.bit(param::WHEEL_UNDRESSED) && dressing {
        plant.store_param(param::WHEEL_UNDRESSED.address(), 0.0);
    }
}
