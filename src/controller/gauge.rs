//! G78: positioning an axis by a gauge, in one or two contacts.
//!
//! The encoder position is latched in the tick of the unfiltered edge, so that input filter, servo lag and braking do
//! not matter. Source: spec K4.5.

use super::Controller;
use super::acts::Did;
use super::axes::MINUTE;
use super::run::Run;
use crate::defs::alarm;
use crate::defs::mcode::{Gauge, Request};
use crate::defs::signal::Input;
use crate::defs::text::Said;
use crate::motion::{End, Move, Rate, Shape};
use crate::nc::Gauging;
use crate::units::{Axis, PerAxis};

/// The gauge inputs, P1 to P6.
pub const SIGNALS: [Input; 6] =
    [Input::Gauge1, Input::Gauge2, Input::Gauge3, Input::Gauge4, Input::Gauge5, Input::Gauge6];

/// Results of the last G78 for the program: #434 to #437, mm as displayed.
pub type Found = [Option<f64>; 4];

/// Stage of a G78 cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// Fast towards the part.
    Approach,
    /// Back-off from the first contact (single-contact cycle).
    Back,
    /// Slowly towards the part again, or on to the second signal (two-contact cycle).
    Fine,
    /// Retract at the end.
    Retract,
    /// M79: the arm goes in.
    ArmIn,
}

/// State of a G78 cycle.
#[derive(Clone, Copy, Debug)]
pub struct GaugeRun {
    /// The request; its end is a machine coordinate.
    asked: Gauging,
    stage: Stage,
    /// Tag of this stage's move, once handed to the planner.
    tag: Option<u32>,
    /// Latched work coordinate of this stage's contact, mm displayed.
    edge: Option<f64>,
    /// Work coordinate of the first contact, mm displayed.
    first: f64,
}

impl Controller {
    /// One tick of G78.
    pub(super) fn gauge(&mut self, run: &mut Run, asked: &Gauging) -> Did {
        let Some(mut gauging) = run.gauging else {
            return match self.is_settled(run) {
                Some(true) if self.signal(asked.first) => self.gauge_fails(alarm::GAUGE_BEFORE, asked.first),
                Some(true) => {
                    let stage = Stage::Approach;
                    run.gauging = Some(GaugeRun { asked: *asked, stage, tag: None, edge: None, first: 0.0 });
                    Did::Wait
                }
                Some(false) | None => Did::Wait,
            };
        };
        let did = self.gauge_stage(run, &mut gauging);
        run.gauging = matches!(did, Did::Wait).then_some(gauging);
        if run.gauging.is_none() {
            run.planned.machine = self.axes.set();
        }
        did
    }

    /// Latches a contact that occurs while the run brakes to a hold or is held.
    pub(super) fn latch_in_pause(&mut self, run: &mut Run) {
        let Some(mut gauging) = run.gauging.filter(|gauging| gauging.tag.is_some() && gauging.edge.is_none()) else {
            return;
        };
        let asked = gauging.asked;
        let awaited = match gauging.stage {
            Stage::Approach => asked.first,
            Stage::Fine => asked.second.unwrap_or(asked.first),
            Stage::Back | Stage::Retract | Stage::ArmIn => return,
        };
        if self.signal(awaited) {
            gauging.edge = Some(self.shown(asked.axis));
            self.axes.path.abort();
            run.gauging = Some(gauging);
        }
    }

    fn gauge_stage(&mut self, run: &mut Run, gauging: &mut GaugeRun) -> Did {
        if gauging.stage == Stage::ArmIn {
            return if self.machine.is_settled(Request::Gauge(Gauge::Axial, false)) { Did::Done } else { Did::Wait };
        }
        let Some(tag) = gauging.tag else {
            return self.begin_stage(run, gauging);
        };
        let arrived = self.axes.path.finished_tag() >= Some(tag) && self.axes.path.is_at_rest();
        match gauging.stage {
            Stage::Back | Stage::Retract if !arrived => Did::Wait,
            Stage::Back if self.signal(gauging.asked.first) => {
                self.gauge_fails(alarm::GAUGE_BEFORE, gauging.asked.first)
            }
            Stage::Back => next(gauging, Stage::Fine),
            Stage::Retract => {
                // The customer's text: M79 is executed automatically.
                self.ask(Request::Gauge(Gauge::Axial, false));
                next(gauging, Stage::ArmIn)
            }
            Stage::Approach | Stage::Fine => self.watch_edge(gauging, arrived),
            Stage::ArmIn => Did::Wait,
        }
    }

    /// Latches the contact, brakes the axis and starts the next stage once the axis is at rest.
    fn watch_edge(&mut self, gauging: &mut GaugeRun, arrived: bool) -> Did {
        let (asked, fine) = (gauging.asked, gauging.stage == Stage::Fine);
        let awaited = if fine { asked.second.unwrap_or(asked.first) } else { asked.first };
        let multi = asked.second.is_some();
        if gauging.edge.is_none() && self.signal(awaited) {
            gauging.edge = Some(self.shown(asked.axis));
            self.axes.path.abort();
        }
        if fine && multi && gauging.edge.is_none() && !self.inputs.has(SIGNALS[index(asked.first)]) {
            return self.gauge_fails(alarm::GAUGE_POSITIONING, asked.first);
        }
        match gauging.edge {
            // The axis lags behind its set-point: a late contact still counts.
            None if arrived && self.axes.is_axis_in_position(asked.axis, &self.params) => {
                self.gauge_fails(alarm::GAUGE_POSITIONING, awaited)
            }
            Some(edge) if self.axes.is_at_rest() => {
                self.note_contact(asked.axis, edge, fine, gauging.first);
                if !fine {
                    gauging.first = edge;
                }
                next(
                    gauging,
                    match (fine, multi) {
                        (true, _) => Stage::Retract,
                        (false, true) => Stage::Fine,
                        (false, false) => Stage::Back,
                    },
                )
            }
            None | Some(_) => Did::Wait,
        }
    }

    /// Records a contact in #434 to #437.
    fn note_contact(&mut self, axis: Axis, edge: f64, fine: bool, first: f64) {
        self.gauge_found[0] = Some(self.shown(Axis::X));
        if fine {
            self.gauge_found[2] = Some(edge);
            self.gauge_found[3] = Some(edge - first);
        } else {
            debug_assert!(axis != Axis::X, "G78 goes along Z or Y");
            self.gauge_found = [self.gauge_found[0], Some(edge), None, None];
        }
    }

    fn begin_stage(&mut self, run: &mut Run, gauging: &mut GaugeRun) -> Did {
        if !self.axes.is_at_rest() {
            return Did::Wait;
        }
        let (asked, from) = (gauging.asked, self.axes.set());
        let axis = asked.axis;
        let away = -(asked.to - from[axis]).signum();
        let (target, mm_min) = match gauging.stage {
            Stage::Approach => (asked.to, asked.fast_mm_min),
            Stage::Fine => (asked.to, asked.fine_mm_min),
            Stage::Back | Stage::Retract | Stage::ArmIn => (from[axis] + away * asked.retract_mm, asked.fast_mm_min),
        };
        // B5: the target of the back-off is known only now.
        if let Err(forbidden) = super::run::within(axis, target, &self.params) {
            let said = self.forbidden(&forbidden);
            self.raise(alarm::SOFT_LIMIT, Some(said));
            return Did::Wait;
        }
        let mut to: PerAxis<f64> = from;
        to[axis] = target;
        let tag = run.next_tag;
        let rate = Rate::Feed { mm_s: mm_min / MINUTE };
        if self.axes.path.push(Move { to, shape: Shape::Line, rate, end: End::ExactStop, tag }).is_ok() {
            run.next_tag += 1;
            gauging.tag = Some(tag);
        }
        Did::Wait
    }

    /// Fails the cycle: the gauge arm retracts and the alarm ends the run.
    fn gauge_fails(&mut self, number: u16, signal: u8) -> Did {
        self.ask(Request::Gauge(Gauge::Axial, false));
        self.raise(number, Some(Said::new(format!("量仪信号 {signal}"), format!("gauge signal {signal}"))));
        Did::Wait
    }

    fn signal(&self, number: u8) -> bool {
        self.raw.has(SIGNALS[index(number)])
    }

    /// The work coordinate of an axis from its encoder, as displayed.
    fn shown(&self, axis: Axis) -> f64 {
        self.work()[axis] * self.displayed_per_mm(axis)
    }
}

const fn next(gauging: &mut GaugeRun, stage: Stage) -> Did {
    gauging.stage = stage;
    gauging.tag = None;
    gauging.edge = None;
    Did::Wait
}

fn index(signal: u8) -> usize {
    usize::from(signal.clamp(1, 6)) - 1
}
