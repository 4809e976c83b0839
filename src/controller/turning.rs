//! Lathe functions of a program: threads, homing to a switch, the tool post.
//! Source: spec L5, L6, L8.

use super::acts::Did;
use super::axes::MINUTE;
use super::homing::{Failure, Progress};
use super::run::{Doing, Run};
use super::{Controller, Homing};
use crate::defs::alarm;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::text::Said;
use crate::link::snapshot::ThreadCut;
use crate::machine::Answer;
use crate::motion::{Thread, ThreadMover};
use crate::units::{Axis, Micros, PerAxis};

/// Maximum number of recorded threads.
const THREADS: usize = 256;
/// Approach travel before the lead is measured, in leads, as the manual requires.
const APPROACH_LEADS: f64 = 3.0;
/// Window for measuring the spindle speed, µs.
const SPEED_WINDOW: u64 = 100_000;

/// The main spindle encoder.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpindleSeen {
    /// Revolutions since power-on, forward positive.
    pub turns: f64,
    since: Micros,
    before: f64,
    /// Speed, rpm, forward positive.
    pub rpm: f64,
}

impl SpindleSeen {
    /// Reads the encoder (revolutions) in this tick.
    pub fn read(&mut self, turns: f64, now: Micros) {
        self.turns = turns;
        let span = now.since(self.since);
        if span.0 >= SPEED_WINDOW {
            self.rpm = (turns - self.before) / span.as_secs_f64() * MINUTE;
            (self.before, self.since) = (turns, now);
        }
    }
}

/// State of the lathe functions.
#[derive(Clone, Debug, Default)]
pub struct Lathe {
    /// The main spindle.
    pub spindle: SpindleSeen,
    /// Measurement of the thread being cut.
    measuring: Option<Measured>,
    /// The threads cut since power-on.
    threads: Vec<ThreadCut>,
    /// Homing of an axis started by a program.
    pub homing: Option<Homing>,
    /// The tool-change point: tip position at the start of the last program, machine coordinates (L3).
    pub start: Option<PerAxis<f64>>,
}

/// Measured deviation of Z from its nominal position in a thread, mm.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    line: u32,
    lead_mm: f64,
    begun_mm: f64,
    least: f64,
    most: f64,
    ended_mm: f64,
}

impl Controller {
    /// The highest spindle speed for a lead, rpm.
    fn thread_limit(lead_mm: f64) -> f64 {
        1_200.0 / lead_mm - 80.0
    }

    /// Program, line and column of the thread code, or of its block if the code is modal from an earlier block.
    fn place_of_thread(&self) -> Said {
        let (program, line) = (self.place.program, self.place.line);
        let text = self.programs.get(program).and_then(|program| program.source.line(line)).unwrap_or_default();
        let found = ["G33", "G32"].into_iter().find_map(|code| text.to_ascii_uppercase().find(code)).unwrap_or(0);
        let (title, column) = (self.title(program), text[..found].chars().count() + 1);
        Said::new(format!("{title} 第{line}行 第{column}列"), format!("{title} line {line}, column {column}"))
    }

    /// One tick of a thread.
    pub(super) fn thread(&mut self, run: &mut Run, thread: &Thread) -> Did {
        if run.doing == Doing::Threading {
            return if self.axes.thread().is_some() { Did::Wait } else { Did::Done };
        }
        if self.is_settled(run) != Some(true) {
            return Did::Wait;
        }
        if self.machine.spindle_direction().is_none() || self.lathe.spindle.rpm.abs() < 1.0 {
            self.raise(alarm::SPINDLE_STANDS, Some(self.place_of_thread()));
            return Did::Wait;
        }
        let (rpm, limit) = (self.lathe.spindle.rpm.abs(), Self::thread_limit(thread.lead_mm));
        // The speed is measured: one or two rpm above the limit are no program fault.
        if rpm > limit * 1.01 + 1.0 {
            let (at, lead_mm) = (self.place_of_thread(), thread.lead_mm);
            let said = Said::new(
                format!("{}：主轴 {rpm:.0} r/min，导程 {lead_mm:.3} mm 最高 {limit:.0} r/min", at.zh),
                format!("{}: {rpm:.0} rpm, a lead of {lead_mm:.3} mm allows {limit:.0} rpm", at.en),
            );
            self.raise(alarm::THREAD_SPEED, Some(said));
            return Did::Wait;
        }
        let from = self.axes.set();
        self.axes.begin_thread(ThreadMover::new(
            *thread,
            from,
            self.axes.path_limits(&self.params),
            (self.lathe.spindle.turns, self.params.get(param::DRIVE_LAG) / 1_000.0),
        ));
        self.lathe.measuring = Some(Measured {
            line: self.place.line,
            lead_mm: thread.lead_mm,
            begun_mm: from[Axis::Z],
            least: f64::INFINITY,
            most: f64::NEG_INFINITY,
            ended_mm: from[Axis::Z],
        });
        run.doing = Doing::Threading;
        Did::Wait
    }

    /// Measures the thread being cut, from the Z and spindle encoders of the same tick.
    pub(super) fn measure_thread(&mut self) {
        let Some(mut measured) = self.lathe.measuring else { return };
        let actual = self.axes.actual()[Axis::Z];
        match self.axes.thread() {
            Some(mover) => {
                // Note 5: the run-up must be over after three leads; measure from there in any case.
                let far = (actual - measured.begun_mm).abs() >= APPROACH_LEADS * measured.lead_mm;
                if let Some(belongs) = mover.belongs_mm(self.lathe.spindle.turns).filter(|_| far) {
                    let off = actual - belongs;
                    measured.least = measured.least.min(off);
                    measured.most = measured.most.max(off);
                    measured.ended_mm = actual;
                }
                self.lathe.measuring = Some(measured);
            }
            None => {
                self.lathe.measuring = None;
                if measured.most >= measured.least && self.lathe.threads.len() < THREADS {
                    self.lathe.threads.push(ThreadCut {
                        line: measured.line,
                        lead_mm: measured.lead_mm,
                        length_mm: (measured.ended_mm - measured.begun_mm).abs(),
                        error_mm: measured.most - measured.least,
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
    pub(super) fn home_by_program(&mut self, run: &mut Run, axis: Axis) -> Did {
        if run.doing != Doing::Homing {
            if self.is_settled(run) != Some(true) {
                return Did::Wait;
            }
            self.axes.give_to_hand();
            self.axes.unbound(axis);
            self.lathe.homing = Some(Homing { now: self.plan_homing(axis), next: Default::default() });
            run.doing = Doing::Homing;
            return Did::Wait;
        }
        let Some(mut homing) = self.lathe.homing.take() else {
            self.axes.give_to_path();
            return Did::Done;
        };
        let progress = self.tick_homing(&mut homing.now);
        match progress {
            Progress::Going => self.lathe.homing = Some(homing),
            Progress::SetZero { edge } => {
                self.found_zero(axis, edge);
                self.lathe.homing = Some(homing);
            }
            Progress::Done => self.axes.finish_homing(axis, &self.params),
            Progress::Failed(why) => self.homing_failed(axis, why),
        }
        Did::Wait
    }

    /// Sets the zero of an axis: its switch was at `edge` in present machine coordinates and is from now on at the
    /// coordinate of the parameter. The tool-change point keeps its physical position (L3).
    pub(super) fn found_zero(&mut self, axis: Axis, edge: f64) {
        let coordinate = self.params.of_axis(param::HOME_X, axis);
        self.axes.set_zero(axis, edge, coordinate);
        if let Some(start) = &mut self.lathe.start {
            start[axis] += coordinate - edge;
        }
    }

    /// Raises the alarm of a failed homing.
    pub(super) fn homing_failed(&mut self, axis: Axis, why: Failure) {
        let n = param::HOME_X.number + axis as u16;
        let said = match why {
            Failure::NoSwitch => Said::new(axis.to_string(), axis.to_string()),
            Failure::NoZero => Said::new(
                format!("{axis} 到不了零点坐标 P{n}={:.3}", self.params.of_axis(param::HOME_X, axis)),
                format!("{axis} does not come to its coordinate P{n}={:.3}", self.params.of_axis(param::HOME_X, axis)),
            ),
        };
        self.raise(alarm::HOMING_FAILED, Some(said));
    }

    /// Shifts the tool-change point with the slides when a tool compensation is applied.
    pub(super) fn carry_start(&mut self, shift: PerAxis<f64>) {
        if let Some(start) = &mut self.lathe.start {
            *start = PerAxis::from_fn(|axis| start[axis] + shift[axis] - self.frames.shift[axis]);
        }
    }

    /// Run start: sets the tool-change point (programs only) and reads the present tool from its switch (L3, L8).
    pub(super) fn begin_turning(&mut self, program: bool) {
        if program {
            self.lathe.start = Some(self.axes.set());
        }
        if let Some(station) = crate::machine::turning::found(self.inputs) {
            self.frames.tool = u32::from(station);
        }
    }

    /// One tick of the tool post.
    pub(super) fn post(&mut self, run: &mut Run, station: u8) -> Did {
        let request = Request::Post(station);
        if run.doing == Doing::Settling {
            return if self.machine.is_settled(request) { Did::Done } else { Did::Wait };
        }
        if self.switches.mst_lock {
            return Did::Done;
        }
        if self.is_settled(run) != Some(true) {
            return Did::Wait;
        }
        if matches!(self.ask(request), Answer::Taken) {
            run.doing = Doing::Settling;
        } else {
            self.happen(super::Event::Hold);
        }
        Did::Wait
    }
}
