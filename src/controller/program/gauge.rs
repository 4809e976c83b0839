//! G78: positioning an axis by a gauge, in one or two contacts.
//!
//! The encoder position is latched by the drive, else in the tick of the unfiltered edge, so that input filter, servo lag
//! and braking do not matter. Source: spec K4.5.

use super::activity::{ActionStatus, Activity, GaugeCycle, GaugeStage};
use super::queue::check_soft_limits;
use super::run::ProgramRun;
use super::signal_place::{SignalPlace, await_signal};
use crate::controller::axes::SECONDS_PER_MINUTE;
use crate::controller::plant::{ControlPhase, Plant};
use crate::defs::alarm;
use crate::defs::mcode::{Gauge, Request};
use crate::defs::signal::Input;
use crate::defs::text::phrase;
use crate::motion::{CornerMode, MotionSpeed, MoveShape};
use crate::nc::{CONTACT_SKIP_SIGNAL, GaugeMove};
use crate::units::{Axis, MachinePos, Micros};

/// Amplifiers take a signal back late: the longest that it may outlast the retract between the two contacts.
const SIGNAL_GOES: Micros = Micros::from_millis(200);
/// A late signal has gone when it stays off for so long: contacts bounce.
const SIGNAL_STAYS_OFF: Micros = Micros::from_millis(20);
/// From this share of J on the axis counts as running at J.
const FINE_SPEED_SHARE: f64 = 0.99;

impl ProgramRun {
    /// One tick of G78.
    pub fn step_gauge(&mut self, plant: &mut Plant, asked: &GaugeMove) -> ActionStatus {
        let Activity::Gauge(mut gauging) = self.activity else {
            if self.is_settled(plant) {
                if gauge_signal(plant, asked.first_input) {
                    return fail_gauge(plant, alarm::GAUGE_SIGNAL_TOO_EARLY, asked.first_input);
                }
                self.activity = Activity::Gauge(GaugeCycle {
                    request: *asked,
                    stage: GaugeStage::Approach,
                    tag: None,
                    latched: None,
                    arrived_at: None,
                    released_at: None,
                    first_contact: 0.0,
                    at_fine_speed: false,
                    second_too_early: false,
                });
            }
            return ActionStatus::Wait;
        };
        watch_second(plant, &mut gauging);
        if let (true, Some(second)) = (gauging.second_too_early, asked.second_input) {
            return fail_gauge(plant, alarm::GAUGE_SECOND_TOO_EARLY, second);
        }
        let status = self.gauge_stage(plant, &mut gauging);
        if matches!(status, ActionStatus::Wait) {
            self.activity = Activity::Gauge(gauging);
        } else {
            self.activity = Activity::Idle;
            self.lookahead.machine_position = plant.axes.program_set_point();
        }
        status
    }

    /// Latches a contact of G31 that occurs while the run brakes to a hold, of G78 also while it is held.
    pub fn latch_in_pause(&mut self, plant: &mut Plant) {
        // Held, the axes may be moved by hand: what they touch then is no place of G31.
        let is_braking = matches!(plant.execution.phase, ControlPhase::Holding);
        if let Activity::Skip { tag, signal, latched, .. } = self.activity
            && is_braking
        {
            let latched = watch_skip(plant, signal, latched);
            self.activity = Activity::Skip { tag, signal, latched, arrived_at: None };
        }
        let Activity::Gauge(mut gauging) = self.activity else { return };
        watch_second(plant, &mut gauging);
        gauging.arrived_at = None;
        self.activity = Activity::Gauge(gauging);
        if gauging.tag.is_none() {
            return;
        }
        let asked = gauging.request;
        let awaited = match gauging.stage {
            GaugeStage::Approach => asked.first_input,
            GaugeStage::Fine => asked.second_input.unwrap_or(asked.first_input),
            GaugeStage::BackOff | GaugeStage::Retract | GaugeStage::ArmIn => return,
        };
        watch_contact(plant, &mut gauging, awaited);
        self.activity = Activity::Gauge(gauging);
    }

    fn gauge_stage(&mut self, plant: &mut Plant, gauging: &mut GaugeCycle) -> ActionStatus {
        if gauging.stage == GaugeStage::ArmIn {
            return ActionStatus::done_if(plant.machine.is_settled(Request::Gauge(Gauge::Axial, false)));
        }
        let Some(tag) = gauging.tag else {
            return self.begin_stage(plant, gauging);
        };
        let arrived = plant.axes.planner.finished_tag() >= Some(tag) && plant.axes.planner.is_at_rest();
        match gauging.stage {
            GaugeStage::BackOff | GaugeStage::Retract if !arrived => ActionStatus::Wait,
            GaugeStage::BackOff => await_release(plant, gauging),
            GaugeStage::Retract => {
                // The customer's text: M79 is executed automatically.
                plant.request(Request::Gauge(Gauge::Axial, false));
                next_stage(gauging, GaugeStage::ArmIn)
            }
            GaugeStage::Approach | GaugeStage::Fine => latch_contact(plant, gauging, arrived),
            GaugeStage::ArmIn => ActionStatus::Wait,
        }
    }

    fn begin_stage(&mut self, plant: &mut Plant, gauging: &mut GaugeCycle) -> ActionStatus {
        if !plant.axes.is_at_rest() {
            return ActionStatus::Wait;
        }
        let (asked, from) = (gauging.request, plant.axes.set_point());
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
        if let Err(forbidden) = check_soft_limits(axis, target, &plant.params) {
            let message = forbidden.text(&plant.params);
            plant.raise(alarm::SOFT_LIMIT, Some(message));
            return ActionStatus::Wait;
        }
        let mut to: MachinePos = from;
        to[axis] = target;
        let rate = MotionSpeed::Feed { mm_s: mm_min / SECONDS_PER_MINUTE };
        gauging.tag = self.push_move(plant, to, MoveShape::Line, rate, CornerMode::ExactStop);
        ActionStatus::Wait
    }
}

/// K4.5: the second signal counts once the axis runs at J. Before that (on the way to P, while it brakes from F, and in the
/// ramp to J) its place would be that of a fast axis: no measurement.
fn watch_second(plant: &Plant, gauging: &mut GaugeCycle) {
    let (GaugeStage::Approach | GaugeStage::Fine, Some(second)) = (gauging.stage, gauging.request.second_input) else {
        return;
    };
    let asked_mm_s = gauging.request.fine_mm_min / SECONDS_PER_MINUTE * plant.override_factors().feed;
    gauging.at_fine_speed |= gauging.stage == GaugeStage::Fine
        && gauging.tag.is_some()
        && plant.path_speed_mm_s() >= FINE_SPEED_SHARE * asked_mm_s;
    gauging.second_too_early |= !gauging.at_fine_speed && gauge_signal(plant, second);
}

/// Latches the contact, brakes the axis and starts the next stage once the axis is at rest.
fn latch_contact(plant: &mut Plant, gauging: &mut GaugeCycle, arrived: bool) -> ActionStatus {
    let (asked, fine) = (gauging.request, gauging.stage == GaugeStage::Fine);
    let awaited = if fine { asked.second_input.unwrap_or(asked.first_input) } else { asked.first_input };
    let multi = asked.second_input.is_some();
    watch_contact(plant, gauging, awaited);
    let first_on = plant.inputs.filtered.has(Input::GAUGES[gauge_index(asked.first_input)]);
    if fine && multi && gauging.latched.is_none() && !first_on {
        return fail_gauge(plant, alarm::GAUGE_SIGNAL_MISSING, asked.first_input);
    }
    match gauging.latched {
        // The axis lags behind its set-point: a late contact still counts.
        None if arrived && plant.axes.is_axis_in_position(asked.axis, &plant.params) => {
            fail_gauge(plant, alarm::GAUGE_SIGNAL_MISSING, awaited)
        }
        None if arrived => {
            plant.await_in_position(*gauging.arrived_at.get_or_insert(plant.now));
            ActionStatus::Wait
        }
        Some(place) if plant.axes.is_at_rest() => {
            let edge = place.work_position(plant)[asked.axis] * plant.displayed_per_mm(asked.axis);
            record_contact(plant, asked.axis, edge, fine, gauging.first_contact);
            if !fine {
                gauging.first_contact = edge;
            }
            let next = if multi { GaugeStage::Fine } else { GaugeStage::BackOff };
            next_stage(gauging, if fine { GaugeStage::Retract } else { next })
        }
        None | Some(_) => ActionStatus::Wait,
    }
}

/// Latches the contact of a stage of G78 and brakes the axis.
fn watch_contact(plant: &mut Plant, gauging: &mut GaugeCycle, awaited: u8) {
    gauging.latched = watch(plant, awaited, gauging.latched);
}

/// Latches the signal of a G31 and brakes the axes.
pub fn watch_skip(plant: &mut Plant, signal: u8, latched: Option<SignalPlace>) -> Option<SignalPlace> {
    let found = watch(plant, signal, latched);
    plant.execution.gauged |= found.is_some() && signal != CONTACT_SKIP_SIGNAL;
    found
}

/// Where an awaited signal has come so far. With it the axes brake; until they stand the drives may tell the place.
fn watch(plant: &mut Plant, signal: u8, latched: Option<SignalPlace>) -> Option<SignalPlace> {
    let mut found = latched;
    match &mut found {
        Some(place) => place.take_latches(plant),
        None if skip_signal(plant, signal) => {
            found = Some(SignalPlace::seen(plant, signal));
            plant.axes.planner.abort();
        }
        None => {}
    }
    await_signal(plant, signal, found.as_ref());
    found
}

/// Behind the back-off the signal goes, at the latest after [`SIGNAL_GOES`]; a contact that bounces has gone once it stays off.
fn await_release(plant: &mut Plant, gauging: &mut GaugeCycle) -> ActionStatus {
    let input = gauging.request.first_input;
    if gauge_signal(plant, input) {
        gauging.released_at = None;
        let since = *gauging.arrived_at.get_or_insert(plant.now);
        if plant.now.since(since) >= SIGNAL_GOES {
            return fail_gauge(plant, alarm::GAUGE_SIGNAL_TOO_EARLY, input);
        }
        return ActionStatus::Wait;
    }
    let is_late = gauging.arrived_at.is_some();
    let released = *gauging.released_at.get_or_insert(plant.now);
    if is_late && plant.now.since(released) < SIGNAL_STAYS_OFF {
        return ActionStatus::Wait;
    }
    next_stage(gauging, GaugeStage::Fine)
}

/// Records a contact in #434 to #437.
fn record_contact(plant: &mut Plant, axis: Axis, edge: f64, fine: bool, first: f64) {
    plant.work.gauge_positions[0] = Some(displayed_work(plant, Axis::X));
    if fine {
        plant.work.gauge_positions[2] = Some(edge);
        plant.work.gauge_positions[3] = Some(edge - first);
    } else {
        assert!(axis != Axis::X, "G78 goes along Z or Y");
        plant.work.gauge_positions = [plant.work.gauge_positions[0], Some(edge), None, None];
    }
}

/// Fails the cycle: the gauge arm retracts and the alarm ends the run.
fn fail_gauge(plant: &mut Plant, number: u16, signal: u8) -> ActionStatus {
    plant.request(Request::Gauge(Gauge::Axial, false));
    plant.raise(number, Some(phrase!("量仪信号 {signal}", "gauge signal {signal}", signal)));
    ActionStatus::Wait
}

/// Whether a gauge signal (1 to 6) is on, before the input filter.
pub fn gauge_signal(plant: &Plant, number: u8) -> bool {
    plant.inputs.raw.has(Input::GAUGES[gauge_index(number)])
}

/// Whether a skip signal of G31 is on, before the input filter.
pub fn skip_signal(plant: &Plant, number: u8) -> bool {
    match number {
        CONTACT_SKIP_SIGNAL => plant.inputs.raw.has(Input::WheelContact),
        gauge => gauge_signal(plant, gauge),
    }
}

/// The work coordinate of an axis from its encoder, as displayed.
fn displayed_work(plant: &Plant, axis: Axis) -> f64 {
    plant.work_position()[axis] * plant.displayed_per_mm(axis)
}

const fn next_stage(gauging: &mut GaugeCycle, stage: GaugeStage) -> ActionStatus {
    gauging.stage = stage;
    gauging.tag = None;
    gauging.latched = None;
    gauging.arrived_at = None;
    gauging.released_at = None;
    ActionStatus::Wait
}

fn gauge_index(signal: u8) -> usize {
    usize::from(signal.clamp(1, 6)) - 1
}
