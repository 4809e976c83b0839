//! G78: positioning an axis by a gauge, in one or two contacts.
//!
//! The encoder position is latched in the tick of the unfiltered edge, so that input filter, servo lag and braking do
//! not matter. Source: spec K4.5.

use super::Controller;
use super::actions::ActionStatus;
use super::axes::SECONDS_PER_MINUTE;
use super::run::ProgramRun;
use crate::defs::alarm;
use crate::defs::mcode::{Gauge, Request};
use crate::defs::signal::Input;
use crate::defs::text::LocalizedText;
use crate::motion::{CornerMode, MotionSpeed, Move, MoveShape};
use crate::nc::GaugeMove;
use crate::units::{Axis, PerAxis};

/// The gauge inputs, P1 to P6.
pub const GAUGE_INPUTS: [Input; 6] =
    [Input::Gauge1, Input::Gauge2, Input::Gauge3, Input::Gauge4, Input::Gauge5, Input::Gauge6];

/// Results of the last G78 for the program: #434 to #437, mm as displayed.
pub type GaugePositions = [Option<f64>; 4];

/// Stage of a G78 cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum GaugeStage {
    /// Fast towards the part.
    Approach,
    /// Back-off from the first contact (single-contact cycle).
    BackOff,
    /// Slowly towards the part again, or on to the second signal (two-contact cycle).
    Fine,
    /// Retract at the end.
    Retract,
    /// M79: the arm goes in.
    ArmIn,
}

/// State of a G78 cycle.
#[derive(Clone, Copy, Debug)]
pub struct GaugeCycle {
    /// The request; its end is a machine coordinate.
    request: GaugeMove,
    stage: GaugeStage,
    /// Tag of this stage's move, once handed to the planner.
    tag: Option<u32>,
    /// Latched work coordinate of this stage's contact, mm displayed.
    latched: Option<f64>,
    /// Work coordinate of the first contact, mm displayed.
    first_contact: f64,
}

impl Controller {
    /// One tick of G78.
    pub(super) fn step_gauge(&mut self, run: &mut ProgramRun, asked: &GaugeMove) -> ActionStatus {
        let Some(mut gauging) = run.gauge_cycle else {
            return match self.is_settled(run) {
                Some(true) if self.gauge_signal(asked.first_input) => {
                    self.fail_gauge(alarm::GAUGE_SIGNAL_TOO_EARLY, asked.first_input)
                }
                Some(true) => {
                    let stage = GaugeStage::Approach;
                    run.gauge_cycle =
                        Some(GaugeCycle { request: *asked, stage, tag: None, latched: None, first_contact: 0.0 });
                    ActionStatus::Wait
                }
                Some(false) | None => ActionStatus::Wait,
            };
        };
        let did = self.gauge_stage(run, &mut gauging);
        run.gauge_cycle = matches!(did, ActionStatus::Wait).then_some(gauging);
        if run.gauge_cycle.is_none() {
            run.lookahead.machine_position = self.axes.set_point();
        }
        did
    }

    /// Latches a contact that occurs while the run brakes to a hold or is held.
    pub(super) fn latch_in_pause(&mut self, run: &mut ProgramRun) {
        let Some(mut gauging) = run.gauge_cycle.filter(|gauging| gauging.tag.is_some() && gauging.latched.is_none())
        else {
            return;
        };
        let asked = gauging.request;
        let awaited = match gauging.stage {
            GaugeStage::Approach => asked.first_input,
            GaugeStage::Fine => asked.second_input.unwrap_or(asked.first_input),
            GaugeStage::BackOff | GaugeStage::Retract | GaugeStage::ArmIn => return,
        };
        if self.gauge_signal(awaited) {
            gauging.latched = Some(self.displayed_work(asked.axis));
            self.axes.planner.abort();
            run.gauge_cycle = Some(gauging);
        }
    }

    fn gauge_stage(&mut self, run: &mut ProgramRun, gauging: &mut GaugeCycle) -> ActionStatus {
        if gauging.stage == GaugeStage::ArmIn {
            return if self.machine.is_settled(Request::Gauge(Gauge::Axial, false)) {
                ActionStatus::Done
            } else {
                ActionStatus::Wait
            };
        }
        let Some(tag) = gauging.tag else {
            return self.begin_stage(run, gauging);
        };
        let arrived = self.axes.planner.finished_tag() >= Some(tag) && self.axes.planner.is_at_rest();
        match gauging.stage {
            GaugeStage::BackOff | GaugeStage::Retract if !arrived => ActionStatus::Wait,
            GaugeStage::BackOff if self.gauge_signal(gauging.request.first_input) => {
                self.fail_gauge(alarm::GAUGE_SIGNAL_TOO_EARLY, gauging.request.first_input)
            }
            GaugeStage::BackOff => next_stage(gauging, GaugeStage::Fine),
            GaugeStage::Retract => {
                // The customer's text: M79 is executed automatically.
                self.request(Request::Gauge(Gauge::Axial, false));
                next_stage(gauging, GaugeStage::ArmIn)
            }
            GaugeStage::Approach | GaugeStage::Fine => self.latch_contact(gauging, arrived),
            GaugeStage::ArmIn => ActionStatus::Wait,
        }
    }

    /// Latches the contact, brakes the axis and starts the next stage once the axis is at rest.
    fn latch_contact(&mut self, gauging: &mut GaugeCycle, arrived: bool) -> ActionStatus {
        let (asked, fine) = (gauging.request, gauging.stage == GaugeStage::Fine);
        let awaited = if fine { asked.second_input.unwrap_or(asked.first_input) } else { asked.first_input };
        let multi = asked.second_input.is_some();
        if gauging.latched.is_none() && self.gauge_signal(awaited) {
            gauging.latched = Some(self.displayed_work(asked.axis));
            self.axes.planner.abort();
        }
        if fine && multi && gauging.latched.is_none() && !self.inputs.has(GAUGE_INPUTS[gauge_index(asked.first_input)])
        {
            return self.fail_gauge(alarm::GAUGE_SIGNAL_MISSING, asked.first_input);
        }
        match gauging.latched {
            // The axis lags behind its set-point: a late contact still counts.
            None if arrived && self.axes.is_axis_in_position(asked.axis, &self.params) => {
                self.fail_gauge(alarm::GAUGE_SIGNAL_MISSING, awaited)
            }
            Some(edge) if self.axes.is_at_rest() => {
                self.record_contact(asked.axis, edge, fine, gauging.first_contact);
                if !fine {
                    gauging.first_contact = edge;
                }
                next_stage(
                    gauging,
                    match (fine, multi) {
                        (true, _) => GaugeStage::Retract,
                        (false, true) => GaugeStage::Fine,
                        (false, false) => GaugeStage::BackOff,
                    },
                )
            }
            None | Some(_) => ActionStatus::Wait,
        }
    }

    /// Records a contact in #434 to #437.
    fn record_contact(&mut self, axis: Axis, edge: f64, fine: bool, first: f64) {
        self.gauge_positions[0] = Some(self.displayed_work(Axis::X));
        if fine {
            self.gauge_positions[2] = Some(edge);
            self.gauge_positions[3] = Some(edge - first);
        } else {
            debug_assert!(axis != Axis::X, "G78 goes along Z or Y");
            self.gauge_positions = [self.gauge_positions[0], Some(edge), None, None];
        }
    }

    fn begin_stage(&mut self, run: &mut ProgramRun, gauging: &mut GaugeCycle) -> ActionStatus {
        if !self.axes.is_at_rest() {
            return ActionStatus::Wait;
        }
        let (asked, from) = (gauging.request, self.axes.set_point());
        let axis = asked.axis;
        let away = -(asked.to - from[axis]).signum();
        let (target, mm_min) = match gauging.stage {
            GaugeStage::Approach => (asked.to, asked.fast_mm_min),
            GaugeStage::Fine => (asked.to, asked.fine_mm_min),
            GaugeStage::BackOff | GaugeStage::Retract | GaugeStage::ArmIn => {
                (from[axis] + away * asked.retract_mm, asked.fast_mm_min)
            }
        };
        // B5: the target of the back-off is known only now.
        if let Err(forbidden) = super::run::check_soft_limits(axis, target, &self.params) {
            let said = self.refusal_text(&forbidden);
            self.raise(alarm::SOFT_LIMIT, Some(said));
            return ActionStatus::Wait;
        }
        let mut to: PerAxis<f64> = from;
        to[axis] = target;
        let tag = run.next_tag;
        let rate = MotionSpeed::Feed { mm_s: mm_min / SECONDS_PER_MINUTE };
        if self
            .axes
            .planner
            .push(Move { to, shape: MoveShape::Line, speed: rate, corner: CornerMode::ExactStop, tag })
            .is_ok()
        {
            run.next_tag += 1;
            gauging.tag = Some(tag);
        }
        ActionStatus::Wait
    }

    /// Fails the cycle: the gauge arm retracts and the alarm ends the run.
    fn fail_gauge(&mut self, number: u16, signal: u8) -> ActionStatus {
        self.request(Request::Gauge(Gauge::Axial, false));
        self.raise(number, Some(LocalizedText::new(format!("量仪信号 {signal}"), format!("gauge signal {signal}"))));
        ActionStatus::Wait
    }

    fn gauge_signal(&self, number: u8) -> bool {
        self.raw_inputs.has(GAUGE_INPUTS[gauge_index(number)])
    }

    /// The work coordinate of an axis from its encoder, as displayed.
    fn displayed_work(&self, axis: Axis) -> f64 {
        self.work_position()[axis] * self.displayed_per_mm(axis)
    }
}

const fn next_stage(gauging: &mut GaugeCycle, stage: GaugeStage) -> ActionStatus {
    gauging.stage = stage;
    gauging.tag = None;
    gauging.latched = None;
    ActionStatus::Wait
}

fn gauge_index(signal: u8) -> usize {
    usize::from(signal.clamp(1, 6)) - 1
}
