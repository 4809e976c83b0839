//! Queued actions: everything a run does besides moving, executed in program order.
//! Source: spec B2, B3, K3.14, K4.

use std::sync::Arc;

use super::gauge::SIGNALS;
use super::oscillation::Stroke;
use super::run::{Act, Doing, MCall, Origin, PlannedMove, Run};
use super::{Controller, Effect, Event, Switches};
use crate::defs::alarm;
use crate::defs::mcode::{Action, Request};
use crate::defs::param;
use crate::defs::signal::{Input, Output};
use crate::defs::text::Said;
use crate::machine::Answer;
use crate::motion::{End, Move};
use crate::nc::{Memory, SpeedMode, VariableError};
use crate::units::{Micros, PerAxis};

/// Status of a queued action after one tick.
pub(super) enum Did {
    Done,
    /// Not finished; called again in the next tick.
    Wait,
    /// Done; the run stops until cycle start.
    Stop,
    /// The run is over.
    Close,
}

impl Controller {
    pub(super) fn act(&mut self, run: &mut Run, act: &Act) -> Did {
        match act {
            Act::Set(variable, value) => {
                // The interpreter has already checked number and value.
                let _ = self.store_variable(*variable, *value);
                Did::Done
            }
            Act::SetSystem(number, value) => {
                if self.write_system(run, *number, *value) {
                    Did::Done
                } else {
                    Did::Wait
                }
            }
            Act::SpeedLimit(rpm) => {
                self.wheel_rpm_limit = Some(*rpm);
                Did::Done
            }
            Act::Preset(values) => self.preset(run, values),
            Act::Frames(frames) => {
                self.carry_start(frames.shift);
                self.put_frames(frames);
                Did::Done
            }
            Act::Machine(call) => self.m_code(run, *call),
            Act::Gauge(asked) => self.gauge(run, asked),
            Act::Oscillate(stroke) => self.oscillate(run, *stroke),
            Act::Cylinder(on) => self.cylinder(*on),
            Act::Thread(thread) => self.thread(run, thread),
            Act::Home(axis) => self.home_by_program(run, *axis),
            Act::Post(station) => self.post(run, *station),
            Act::Dwell(seconds) => self.dwell(run, *seconds),
            Act::Wheel(..) if self.switches.mst_lock => Did::Done,
            Act::Wheel(value, mode) => {
                self.set_wheel_speed(*value, *mode);
                Did::Done
            }
            Act::Skip(planned, signal) => self.skip(run, planned, *signal),
            Act::Alarm(number, text, place) => {
                self.place = *place;
                self.raise(*number, Some(text.clone()));
                Did::Wait
            }
            Act::Note(text) => self.tell_note(text),
            Act::Message(text) => match self.is_settled(run) {
                Some(true) => {
                    self.say(text.clone());
                    Did::Stop
                }
                _ => Did::Wait,
            },
            Act::Finish => match self.is_settled(run) {
                Some(true) => Did::Close,
                _ => Did::Wait,
            },
        }
    }

    fn oscillate(&mut self, run: &mut Run, stroke: Stroke) -> Did {
        match self.is_settled(run) {
            Some(true) => {
                self.begin_oscillation(stroke, true);
                Did::Done
            }
            Some(false) | None => Did::Wait,
        }
    }

    /// G35 by cylinder, and G36: the stroke ends at its start point, then the next block runs (K4.3).
    fn cylinder(&mut self, on: bool) -> Did {
        let done = if on {
            matches!(self.ask(Request::CylinderOn), Answer::Taken | Answer::NoEffect(_))
        } else {
            self.axes.is_at_rest() && self.end_oscillation()
        };
        if done { Did::Done } else { Did::Wait }
    }

    /// G50: sets the work coordinates of the present position once all motion is over.
    fn preset(&mut self, run: &mut Run, values: &PerAxis<Option<f64>>) -> Did {
        match self.is_settled(run) {
            Some(true) => {
                let mut frames = self.frames.clone();
                frames.preset(self.axes.set(), values);
                self.put_frames(&frames);
                run.planned.frames = Arc::new(frames);
                Did::Done
            }
            Some(false) | None => Did::Wait,
        }
    }

    /// S: wheel speed in rpm, or as surface speed by the wheel diameter P77.
    fn set_wheel_speed(&mut self, value: f64, mode: SpeedMode) {
        self.wheel_speed = (value, mode);
        if self.output_set.has(Output::Wheel) && self.wheel_rpm_given() < self.commanded_wheel_rpm() {
            self.refuse(Said::new(
                "S 超过砂轮额定线速度，按额定转速运行 (P77 P79)",
                "S exceeds the wheel's rating: it runs at the rating (P77, P79)",
            ));
        }
    }

    /// Whether all motion is over and the axes are in position; `None` after the time-out, with the alarm raised.
    pub(super) fn is_settled(&mut self, run: &mut Run) -> Option<bool> {
        if !self.axes.is_at_rest() {
            return Some(false);
        }
        if self.axes.is_in_position(&self.params) {
            return Some(true);
        }
        let since = *run.settle_since.get_or_insert(self.now);
        if self.now.since(since) > Micros::from_millis_f64(self.params.get(param::DRAIN_TIME)) {
            self.raise(alarm::IN_POSITION_TIMEOUT, None);
            return None;
        }
        Some(false)
    }

    fn m_code(&mut self, run: &mut Run, call: MCall) -> Did {
        if let Some(request) = call.request() {
            return self.m_request(run, call, request);
        }
        match call.row.action {
            Action::OptionalStop if !self.switches.optional_stop => Did::Done,
            Action::Pause | Action::OptionalStop => match self.is_settled(run) {
                Some(true) => Did::Stop,
                Some(false) | None => Did::Wait,
            },
            Action::Count => {
                self.count_part();
                Did::Done
            }
            Action::End => match self.is_settled(run) {
                Some(true) => {
                    self.end_program(run.origin);
                    Did::Close
                }
                Some(false) | None => Did::Wait,
            },
            Action::AwaitInput(_) if self.switches.mst_lock => Did::Done,
            Action::AwaitInput(input) => self.await_input(run, input),
            Action::Flow | Action::Ask(_) | Action::Port(_) | Action::Pulse => Did::Done,
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
        let Switches { machine_lock, mst_lock, dry_run, .. } = self.switches;
        let really = origin == Origin::Program && !machine_lock && !mst_lock && !dry_run;
        if really && self.params.bit(param::WHEEL_UNDRESSED) && self.around().dressing {
            self.keep_param(param::WHEEL_UNDRESSED.address(), 0.0);
        }
    }

    fn m_request(&mut self, run: &mut Run, call: MCall, request: Request) -> Did {
        if run.doing == Doing::Settling {
            return if self.machine.is_settled(request) { Did::Done } else { Did::Wait };
        }
        if self.switches.mst_lock {
            return Did::Done;
        }
        let answer = self.ask(request);
        if let (Some(rpm), Answer::Taken, Request::DriveHigh | Request::DriveLow) = (call.s, answer, request) {
            self.analog_2_rpm = rpm; // K3.4: M63 S
            let most = self.params.get(param::ANALOG_2_RPM_MAX);
            if rpm > most {
                self.refuse(Said::new(
                    format!("S{rpm} 超过第二模拟量最高转速，按 {most} 运行 (P65)"),
                    format!("S{rpm} is above the second analog output: it gives {most} (P65)"),
                ));
            }
        }
        match answer {
            Answer::Taken if call.row.waits => {
                run.doing = Doing::Settling;
                if self.machine.is_settled(request) { Did::Done } else { Did::Wait }
            }
            Answer::Taken | Answer::NoEffect(_) => Did::Done,
            // The block waits as in a feed hold; cycle start requests it again.
            Answer::Denied(_) => {
                self.happen(Event::Hold);
                Did::Wait
            }
            Answer::Refused(..) => Did::Wait,
        }
    }

    fn await_input(&mut self, run: &mut Run, input: Input) -> Did {
        if self.inputs.has(input) {
            self.waiting_for = None;
            return Did::Done;
        }
        if run.doing == Doing::Nothing {
            let (name, port) = (input.name(), self.params.input_port(input));
            if port == 0 {
                self.raise(alarm::INPUT_MISSING, Some(name.into()));
                return Did::Wait;
            }
            run.doing = Doing::AwaitInput(input);
            let what =
                Said::new(format!("等待{}，输入口 {port}", name.zh), format!("waiting for {}, port {port}", name.en));
            self.say(what.clone());
            self.waiting_for = Some(what);
        }
        Did::Wait
    }

    fn dwell(&mut self, run: &mut Run, seconds: f64) -> Did {
        match run.doing {
            Doing::Dwell { until } if self.now >= until => Did::Done,
            Doing::Dwell { .. } => Did::Wait,
            Doing::Nothing
            | Doing::Settling
            | Doing::AwaitInput(_)
            | Doing::Threading
            | Doing::Homing
            | Doing::Skipping { .. } => {
                if self.axes.is_at_rest() {
                    run.doing = Doing::Dwell { until: self.now + Micros::from_secs_f64(seconds) };
                }
                Did::Wait
            }
        }
    }

    /// G31: the position is latched in the tick of the signal edge, then the axes brake.
    fn skip(&mut self, run: &mut Run, planned: &PlannedMove, signal: u8) -> Did {
        let input = SIGNALS[usize::from(signal.clamp(1, 6)) - 1];
        match run.doing {
            Doing::Nothing
            | Doing::Settling
            | Doing::Dwell { .. }
            | Doing::AwaitInput(_)
            | Doing::Threading
            | Doing::Homing => {
                let tag = run.next_tag;
                let most = self.params.get(param::SKIP_SPEED_MAX);
                let Some(rate) = planned.speed.rate(self.drive_rpm(), most) else { return self.no_drive() };
                let pushed = Move { to: planned.to, shape: planned.shape, rate, end: End::ExactStop, tag };
                if self.axes.path.push(pushed).is_ok() {
                    run.next_tag += 1;
                    run.doing = Doing::Skipping { tag, latched: false };
                }
                Did::Wait
            }
            Doing::Skipping { tag, latched: false } => {
                if self.raw.has(input) {
                    self.skip_position = self.work();
                    self.axes.path.abort();
                    run.doing = Doing::Skipping { tag, latched: true };
                } else if self.axes.path.finished_tag() >= Some(tag) {
                    // The end point, not the lagging actual position: it tells the program that no signal came.
                    self.skip_position = self.frames.work_from_machine(self.axes.set());
                    return Did::Done;
                }
                Did::Wait
            }
            Doing::Skipping { latched: true, .. } if self.axes.is_at_rest() => {
                run.planned.machine = self.axes.set();
                Did::Done
            }
            Doing::Skipping { latched: true, .. } => Did::Wait,
        }
    }

    pub(super) fn no_drive(&mut self) -> Did {
        self.raise(
            alarm::DRIVE_BLOCKED,
            Some(Said::new(
                "每转进给需要工件转动，先用 M63 启动",
                "a feed per revolution needs the workpiece turning: M63 first",
            )),
        );
        Did::Wait
    }

    /// Sets a common variable at execution time; retained variables are also stored on disk.
    pub(super) fn store_variable(&mut self, variable: u32, value: Option<f64>) -> Result<(), VariableError> {
        self.memory.set(variable, value)?;
        // A run suspended by the retract has its own copy.
        if let Some(waiting) = self.retract.waiting_run() {
            let _ = waiting.interpreter.variable_edited(variable, value);
        }
        if Memory::is_retained(variable) {
            self.effects.push(Effect::Variable(variable, value));
        }
        Ok(())
    }

    fn put_frames(&mut self, frames: &super::Frames) {
        for number in 1..=crate::nc::frames::OFFSETS {
            let (geometry, wear) = (frames.geometry[number - 1], frames.wear[number - 1]);
            if wear != self.frames.wear[number - 1] {
                self.effects.push(Effect::Offset { number, geometry, wear });
            }
        }
        self.frames.clone_from(frames);
    }

    pub(super) fn count_part(&mut self) {
        self.parts += 1;
        self.effects.push(Effect::Parts(self.parts));
        self.count_since_dressing();
    }
}
