//! Lathe functions of a program: threads, homing to a switch, the tool post.
//! Source: spec L5, L6, L8.

use super::actions::ActionStatus;
use super::axes::SECONDS_PER_MINUTE;
use super::homing::{HomingFailure, HomingProgress};
use super::run::{Activity, ProgramRun};
use super::{Controller, Homing};
use crate::defs::alarm;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::text::LocalizedText;
use crate::link::snapshot::ThreadCut;
use crate::machine::RequestResult;
use crate::motion::{ThreadMover, ThreadPass};
use crate::nc::ThreadMove;
use crate::units::{Axis, Micros, PerAxis};

/// Maximum number of recorded threads.
const MAX_THREADS: usize = 256;
/// Approach travel before the lead is measured, in leads, as the manual requires.
const APPROACH_LEADS: f64 = 3.0;
/// Window for measuring the spindle speed, µs.
const SPEED_WINDOW_US: u64 = 100_000;

/// The main spindle encoder.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpindleEncoder {
    /// Revolutions since power-on, forward positive.
    pub turns: f64,
    window_start: Micros,
    window_start_turns: f64,
    /// Speed, rpm, forward positive.
    pub rpm: f64,
}

impl SpindleEncoder {
    /// Reads the encoder (revolutions) in this tick.
    pub fn read(&mut self, turns: f64, now: Micros) {
        self.turns = turns;
        let span = now.since(self.window_start);
        if span.0 >= SPEED_WINDOW_US {
            self.rpm = (turns - self.window_start_turns) / span.as_secs_f64() * SECONDS_PER_MINUTE;
            (self.window_start_turns, self.window_start) = (turns, now);
        }
    }
}

/// State of the lathe functions.
#[derive(Clone, Debug, Default)]
pub struct Lathe {
    /// The main spindle.
    pub spindle: SpindleEncoder,
    /// Measurement of the thread being cut.
    measurement: Option<ThreadMeasurement>,
    /// The threads cut since power-on.
    threads: Vec<ThreadCut>,
    /// Homing of an axis started by a program.
    pub homing: Option<Homing>,
    /// The tool-change point: tip position at the start of the last program, machine coordinates (L3).
    pub tool_change_point: Option<PerAxis<f64>>,
}

/// Measured deviation of Z from its nominal position in a thread, mm.
#[derive(Clone, Copy, Debug)]
pub struct ThreadMeasurement {
    line: u32,
    lead_mm: f64,
    start_mm: f64,
    least_mm: f64,
    greatest_mm: f64,
    end_mm: f64,
}

impl Controller {
    /// Program, line and column of the thread code, or of its block if the code is modal from an earlier block.
    fn thread_location(&self) -> LocalizedText {
        let (program, line) = (self.current_block.program, self.current_block.line);
        let text = self.programs.get(program).and_then(|program| program.source.line(line)).unwrap_or_default();
        let found = ["G33", "G32"].into_iter().find_map(|code| text.to_ascii_uppercase().find(code)).unwrap_or(0);
        let (title, column) = (self.program_title(program), text[..found].chars().count() + 1);
        LocalizedText::new(format!("{title} 第{line}行 第{column}列"), format!("{title} line {line}, column {column}"))
    }

    /// One tick of a thread.
    pub(super) fn step_thread(&mut self, run: &mut ProgramRun, thread: &ThreadPass) -> ActionStatus {
        if run.activity == Activity::Threading {
            return if self.axes.thread().is_some() { ActionStatus::Wait } else { ActionStatus::Done };
        }
        if self.is_settled(run) != Some(true) {
            return ActionStatus::Wait;
        }
        if self.machine.spindle_direction().is_none() || self.lathe.spindle.rpm.abs() < 1.0 {
            self.raise(alarm::SPINDLE_NOT_TURNING, Some(self.thread_location()));
            return ActionStatus::Wait;
        }
        let (rpm, limit) = (self.lathe.spindle.rpm.abs(), ThreadMove::max_spindle_rpm(thread.lead_mm));
        // The speed is measured: one or two rpm above the limit are no program fault.
        if rpm > limit * 1.01 + 1.0 {
            let (at, lead_mm) = (self.thread_location(), thread.lead_mm);
            let said = LocalizedText::new(
                format!("{}：主轴 {rpm:.0} r/min，导程 {lead_mm:.3} mm 最高 {limit:.0} r/min", at.zh),
                format!("{}: {rpm:.0} rpm, a lead of {lead_mm:.3} mm allows {limit:.0} rpm", at.en),
            );
            self.raise(alarm::THREAD_SPEED, Some(said));
            return ActionStatus::Wait;
        }
        let from = self.axes.set_point();
        self.axes.begin_thread(ThreadMover::new(
            *thread,
            from,
            self.axes.path_limits(&self.params),
            (self.lathe.spindle.turns, self.params.get(param::SERVO_LAG) / 1_000.0),
        ));
        self.lathe.measurement = Some(ThreadMeasurement {
            line: self.current_block.line,
            lead_mm: thread.lead_mm,
            start_mm: from[Axis::Z],
            least_mm: f64::INFINITY,
            greatest_mm: f64::NEG_INFINITY,
            end_mm: from[Axis::Z],
        });
        run.activity = Activity::Threading;
        ActionStatus::Wait
    }

    /// Measures the thread being cut, from the Z and spindle encoders of the same tick.
    pub(super) fn measure_thread(&mut self) {
        let Some(mut measured) = self.lathe.measurement else { return };
        let actual = self.axes.actual()[Axis::Z];
        match self.axes.thread() {
            Some(mover) => {
                // Note 5: the run-up must be over after three leads; measure from there in any case.
                let far = (actual - measured.start_mm).abs() >= APPROACH_LEADS * measured.lead_mm;
                if let Some(belongs) = mover.nominal_z_mm(self.lathe.spindle.turns).filter(|_| far) {
                    let off = actual - belongs;
                    measured.least_mm = measured.least_mm.min(off);
                    measured.greatest_mm = measured.greatest_mm.max(off);
                    measured.end_mm = actual;
                }
                self.lathe.measurement = Some(measured);
            }
            None => {
                self.lathe.measurement = None;
                if measured.greatest_mm >= measured.least_mm && self.lathe.threads.len() < MAX_THREADS {
                    self.lathe.threads.push(ThreadCut {
                        line: measured.line,
                        lead_mm: measured.lead_mm,
                        length_mm: (measured.end_mm - measured.start_mm).abs(),
                        error_mm: measured.greatest_mm - measured.least_mm,
                    });
                }
            }
        }
    }

    /// The threads cut since power-on with their lead error, mm; at most 256.
    #[must_use]
    pub fn threads(&self) -> &[ThreadCut] {
        &self.lathe.threads
    }

    /// One tick of homing by a program.
    pub(super) fn step_program_homing(&mut self, run: &mut ProgramRun, axis: Axis) -> ActionStatus {
        if run.activity != Activity::Homing {
            if self.is_settled(run) != Some(true) {
                return ActionStatus::Wait;
            }
            self.axes.switch_to_manual();
            self.axes.lift_soft_limits(axis);
            self.lathe.homing = Some(Homing { current: self.plan_homing(axis), queued: Default::default() });
            run.activity = Activity::Homing;
            return ActionStatus::Wait;
        }
        let Some(mut homing) = self.lathe.homing.take() else {
            self.axes.switch_to_program();
            return ActionStatus::Done;
        };
        let progress = self.tick_homing(&mut homing.current);
        match progress {
            HomingProgress::Running => self.lathe.homing = Some(homing),
            HomingProgress::SetZero { edge } => {
                self.apply_zero(axis, edge);
                self.lathe.homing = Some(homing);
            }
            HomingProgress::Done => self.axes.finish_homing(axis, &self.params),
            HomingProgress::Failed(why) => self.raise_homing_failed(axis, why),
        }
        ActionStatus::Wait
    }

    /// Sets the zero of an axis: its switch was at `edge` in present machine coordinates and is from now on at the
    /// coordinate of the parameter. The tool-change point keeps its physical position (L3).
    pub(super) fn apply_zero(&mut self, axis: Axis, edge: f64) {
        let coordinate = self.params.get_axis(param::HOME_X, axis);
        self.axes.set_zero(axis, edge, coordinate);
        if let Some(start) = &mut self.lathe.tool_change_point {
            start[axis] += coordinate - edge;
        }
    }

    /// Raises the alarm of a failed homing.
    pub(super) fn raise_homing_failed(&mut self, axis: Axis, why: HomingFailure) {
        let n = param::HOME_X.number + axis as u16;
        let said = match why {
            HomingFailure::NoSwitch => LocalizedText::new(axis.to_string(), axis.to_string()),
            HomingFailure::NotAtZero => LocalizedText::new(
                format!("{axis} 到不了零点坐标 P{n}={:.3}", self.params.get_axis(param::HOME_X, axis)),
                format!("{axis} does not come to its coordinate P{n}={:.3}", self.params.get_axis(param::HOME_X, axis)),
            ),
        };
        self.raise(alarm::HOMING_FAILED, Some(said));
    }

    /// Shifts the tool-change point with the slides when a tool compensation is applied.
    pub(super) fn shift_tool_change_point(&mut self, shift: PerAxis<f64>) {
        if let Some(start) = &mut self.lathe.tool_change_point {
            *start = PerAxis::from_fn(|axis| start[axis] + shift[axis] - self.work_offsets.shift[axis]);
        }
    }

    /// Run start: sets the tool-change point (programs only) and reads the present tool from its switch (L3, L8).
    pub(super) fn start_lathe_program(&mut self, program: bool) {
        if program {
            self.lathe.tool_change_point = Some(self.axes.set_point());
        }
        if let Some(station) = crate::machine::lathe::station_in_position(self.inputs) {
            self.work_offsets.tool = u32::from(station);
        }
    }

    /// One tick of the tool post.
    pub(super) fn step_turret(&mut self, run: &mut ProgramRun, station: u8) -> ActionStatus {
        let request = Request::ToolTurret(station);
        if run.activity == Activity::Settling {
            return if self.machine.is_settled(request) { ActionStatus::Done } else { ActionStatus::Wait };
        }
        if self.switches.aux_function_lock {
            return ActionStatus::Done;
        }
        if self.is_settled(run) != Some(true) {
            return ActionStatus::Wait;
        }
        if matches!(self.request(request), RequestResult::Accepted) {
            run.activity = Activity::Settling;
        } else {
            self.transition(super::ControlEvent::Hold);
        }
        ActionStatus::Wait
    }
}
