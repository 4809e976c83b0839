//! Servo oscillation: moves one axis to and fro between two reversal points, beside the program, with its own limits.
//!
//! The other axes belong to the program or to manual motion. A stroke ends when the axis is in position at the
//! reversal point; then its dwell begins. #438 and #439 are set in that tick and hold until the other reversal point.
//! Source: spec K4.3.

use super::axes::{SECONDS_PER_MINUTE, limits};
use super::lookahead_state::MoveRefusal;
use super::{ControlPhase, Controller};
use crate::defs::mcode::Request;
use crate::defs::param::{self, Params};
use crate::defs::signal::Output;
use crate::defs::text::{LocalizedText, Text};
use crate::machine::RequestResult;
use crate::motion::{AxisLimits, AxisMover};
use crate::units::{Axis, Micros};

/// Speed to which the ramp time D refers, mm/min.
const RAMP_SPEED_MM_MIN: f64 = 10_000.0;
/// Minimum double strokes per minute.
const MIN_STROKES_PER_MIN: f64 = 1.0;
/// Unit of P235 and P236, ms.
const DWELL_UNIT_MS: f64 = 4.0;
/// A stroke shorter than this, mm, counts as zero length.
pub const MIN_STROKE_MM: f64 = 1e-6;

const OSCILLATES: Text = Text::new("该轴在振荡中，先关闭振荡", "the axis oscillates: end the oscillation first");

/// Oscillation requested by G35 or by the key. Machine coordinates, radius mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OscillationStroke {
    /// The axis.
    pub axis: Axis,
    /// The far reversal point.
    pub to: f64,
    /// D: time to reach 10 m/min, ms; P240 if not given.
    pub ramp_ms: Option<f64>,
    /// Q: double strokes per minute; P241 if not given.
    pub strokes_min: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OscillationStep {
    Moving {
        forward: bool,
    },
    Dwelling {
        forward: bool,
        until: Micros,
    },
    /// Reset or e-stop: braking.
    Stopping,
}

/// State of an oscillating axis.
#[derive(Clone, Debug)]
pub struct Oscillation {
    axis: Axis,
    /// Started by a program or an MDI line, not by the key.
    started_by_run: bool,
    from: f64,
    to: f64,
    speed_mm_s: f64,
    mover: AxisMover,
    step: OscillationStep,
    /// G36: it ends at the next arrival at its start point.
    ending: bool,
    /// #438: in position forward; #439: backward.
    in_position: (bool, bool),
    last_forward_at: Option<Micros>,
    strokes_min: f64,
}

/// Result of one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OscillationStatus {
    Running,
    /// The axis is at rest and free again.
    Finished,
}

impl Oscillation {
    /// Starts with the next tick. Returns a text if values were limited.
    fn new(
        stroke: OscillationStroke,
        by_run: bool,
        from: f64,
        params: &Params,
        tick_s: f64,
    ) -> (Self, Option<LocalizedText>) {
        let axis = stroke.axis;
        let own = limits(params, tick_s).axes[axis];
        let length = (stroke.to - from).abs();
        let mut said: Vec<(String, String)> = Vec::new();
        let asked = stroke.strokes_min.unwrap_or_else(|| params.get(param::OSCILLATION_FREQUENCY));
        let strokes = asked.max(MIN_STROKES_PER_MIN);
        if strokes > asked {
            said.push((format!("Q{asked} 按 1 次/分"), format!("Q{asked} is taken as 1")));
        }
        // K4.3: v = 2·L·Q.
        let wanted = 2.0 * length * strokes;
        let most = params.get(param::OSCILLATION_SPEED).min(own.velocity_mm_s * SECONDS_PER_MINUTE);
        if wanted > most {
            said.push((
                format!("速度 {wanted:.0} 限为 {most:.0} mm/min"),
                format!("{wanted:.0} mm/min is held to {most:.0}"),
            ));
        }
        let ramp_ms = stroke.ramp_ms.unwrap_or_else(|| params.get(param::OSCILLATION_TIME_CONSTANT));
        let rapid_ms = 1_000.0 * RAMP_SPEED_MM_MIN / SECONDS_PER_MINUTE / own.acceleration_mm_s2;
        if ramp_ms < rapid_ms {
            said.push((
                format!("D{ramp_ms:.0} 按 {rapid_ms:.0} ms"),
                format!("D{ramp_ms:.0} is taken as {rapid_ms:.0} ms"),
            ));
        }
        let acceleration_mm_s2 = RAMP_SPEED_MM_MIN / SECONDS_PER_MINUTE / (ramp_ms.max(rapid_ms) / 1_000.0);
        let speed_mm_s = wanted.min(most) / SECONDS_PER_MINUTE;
        let bounds = AxisLimits { velocity_mm_s: speed_mm_s, acceleration_mm_s2, jerk_mm_s3: own.jerk_mm_s3 };
        let oscillation = Self {
            axis,
            started_by_run: by_run,
            from,
            to: stroke.to,
            speed_mm_s,
            mover: AxisMover::new(bounds, from, tick_s),
            step: OscillationStep::Moving { forward: true },
            ending: false,
            in_position: (false, false),
            last_forward_at: None,
            strokes_min: 0.0,
        };
        let clamped = (!said.is_empty()).then(|| {
            let join = |pick: fn(&(String, String)) -> &str| said.iter().map(pick).collect::<Vec<_>>().join("; ");
            LocalizedText::new(join(|text| &text.0), join(|text| &text.1))
        });
        (oscillation, clamped)
    }

    fn tick(&mut self, now: Micros, in_position: bool, params: &Params) -> OscillationStatus {
        let rest = self.mover.is_at_rest();
        match self.step {
            OscillationStep::Stopping if rest => return OscillationStatus::Finished,
            OscillationStep::Stopping => {}
            OscillationStep::Moving { forward } => {
                let end = if forward { self.to } else { self.from };
                let there = rest && (self.mover.position() - end).abs() < MIN_STROKE_MM && in_position;
                if there && !forward && self.ending {
                    return OscillationStatus::Finished;
                }
                if there {
                    self.arrive(forward, now, params);
                } else {
                    self.mover.set_position_target(end, self.speed_mm_s);
                }
            }
            OscillationStep::Dwelling { forward: false, .. } if self.ending => return OscillationStatus::Finished,
            OscillationStep::Dwelling { forward, until } if now >= until || self.ending => {
                self.step = OscillationStep::Moving { forward: !forward };
                self.mover.set_position_target(if forward { self.from } else { self.to }, self.speed_mm_s);
            }
            OscillationStep::Dwelling { .. } => {}
        }
        self.mover.tick();
        OscillationStatus::Running
    }

    fn arrive(&mut self, forward: bool, now: Micros, params: &Params) {
        let dwell = if forward { param::OSCILLATION_DWELL_FORWARD } else { param::OSCILLATION_DWELL_BACKWARD };
        self.in_position = (forward, !forward);
        let until = now + Micros::from_millis_f64(DWELL_UNIT_MS * params.get(dwell));
        self.step = OscillationStep::Dwelling { forward, until };
        if forward && let Some(last) = self.last_forward_at.replace(now) {
            self.strokes_min = SECONDS_PER_MINUTE / now.since(last).as_secs_f64();
        }
    }

    /// G36: a forward stroke reverses at once; the oscillation ends at its start point.
    const fn end_at_start(&mut self) {
        self.ending = true;
        if let OscillationStep::Moving { forward: true } = self.step {
            self.step = OscillationStep::Moving { forward: false };
        }
    }
}

impl Controller {
    /// The axis that oscillates by servo.
    pub(super) fn oscillating_axis(&self) -> Option<Axis> {
        self.oscillation.as_ref().map(|oscillation| oscillation.axis)
    }

    /// The oscillation was started by the key in a pause: the held program does not know of it (K4.3).
    pub(super) fn oscillates_by_key(&self) -> bool {
        self.oscillation.as_ref().is_some_and(|oscillation| !oscillation.started_by_run)
    }

    /// Whether an axis or the cylinder oscillates.
    pub(super) fn is_oscillating(&self) -> bool {
        self.oscillation.is_some() || self.machine.cylinder_is_on()
    }

    /// #438 and #439.
    #[must_use]
    pub fn oscillation_flags(&self) -> (bool, bool) {
        let servo = self.oscillation.as_ref().map(|oscillation| oscillation.in_position);
        let (forward, backward) = servo.unwrap_or_else(|| self.machine.cylinder_flags());
        if self.params.bit(param::SWAP_OSCILLATION_FLAGS) { (backward, forward) } else { (forward, backward) }
    }

    /// Measured double strokes per minute; `None` before the second stroke.
    pub(super) fn measured_strokes_min(&self) -> Option<f64> {
        self.oscillation.as_ref().map(|oscillation| oscillation.strokes_min).filter(|strokes| *strokes > 0.0)
    }

    /// One tick of the oscillation.
    pub(super) fn step_oscillation(&mut self) {
        let Some(mut oscillation) = self.oscillation.take() else { return };
        let axis = oscillation.axis;
        let in_position = self.axes.is_axis_in_position(axis, &self.params);
        match oscillation.tick(self.now, in_position, &self.params) {
            OscillationStatus::Running => {
                self.axes.set_oscillation(Some((
                    axis,
                    oscillation.mover.position(),
                    oscillation.mover.velocity_mm_s(),
                )));
                self.oscillation = Some(oscillation);
            }
            OscillationStatus::Finished => self.axes.set_oscillation(None),
        }
    }

    /// G35 and the key: starts oscillation between the present set-point and the given reversal point.
    pub(super) fn begin_oscillation(&mut self, stroke: OscillationStroke, by_run: bool) {
        let from = self.axes.set_point()[stroke.axis];
        let tick_s = self.tick_time.as_secs_f64();
        let (oscillation, clamped) = Oscillation::new(stroke, by_run, from, &self.params, tick_s);
        self.oscillation = Some(oscillation);
        if let Some(said) = clamped {
            self.refuse(said);
        }
    }

    /// G36 and the key: ends the oscillation at its start point. True when nothing oscillates by servo any more.
    pub(super) fn end_oscillation(&mut self) -> bool {
        if self.machine.cylinder_is_on() {
            self.request(Request::CylinderOff);
        }
        if let Some(oscillation) = &mut self.oscillation
            && !oscillation.ending
        {
            oscillation.end_at_start();
        }
        self.oscillation.is_none()
    }

    /// Reset and e-stop: brakes the axis at once.
    pub(super) fn stop_oscillation(&mut self) {
        if let Some(oscillation) = &mut self.oscillation {
            oscillation.step = OscillationStep::Stopping;
            oscillation.mover.emergency_stop();
        }
    }

    /// Key 振荡: G35 with P238 to P241; pressed again, G36.
    pub(super) fn toggle_oscillation(&mut self) {
        if self.is_oscillating() {
            self.end_oscillation();
            return;
        }
        if self.params.bit(param::OSCILLATION_BY_CYLINDER) {
            self.request(Request::CylinderOn);
            return;
        }
        let axis = if self.params.get(param::OSCILLATION_AXIS) < 0.5 { Axis::X } else { Axis::Z };
        if !matches!(self.phase, ControlPhase::Idle | ControlPhase::Held | ControlPhase::Stopped)
            || !self.axes.is_at_rest()
        {
            return self.refuse(LocalizedText::new("轴还在运动，请稍候", "the axes still move"));
        }
        if !matches!(self.request(Request::Jog), RequestResult::Accepted) {
            return;
        }
        let work = self.params.get(param::OSCILLATION_POSITION) / self.displayed_per_mm(axis);
        let to = work + self.work_offsets.machine_minus_work(axis);
        if let Err(forbidden) = self.check_stroke(axis, to) {
            let said = self.refusal_text(&forbidden);
            return self.refuse(said);
        }
        self.begin_oscillation(OscillationStroke { axis, to, ramp_ms: None, strokes_min: None }, false);
    }

    fn check_stroke(&self, axis: Axis, to: f64) -> Result<(), MoveRefusal> {
        if !self.axes.is_homed(axis) || (to - self.axes.set_point()[axis]).abs() < MIN_STROKE_MM {
            return Err(MoveRefusal::NoStroke(axis));
        }
        super::run::check_soft_limits(axis, to, &self.params)
    }

    /// Refuses manual motion of an oscillating axis. True if refused.
    pub(super) fn refuse_oscillating(&mut self, axis: Axis) -> bool {
        let oscillates = self.oscillating_axis() == Some(axis);
        if oscillates {
            self.refuse(OSCILLATES);
        }
        oscillates
    }

    /// The lamp of the key: servo or cylinder oscillates, or a valve is on.
    pub(super) fn oscillation_lamp(&self) -> bool {
        let cylinder = [Output::OscillationForward, Output::OscillationBackward];
        self.is_oscillating() || cylinder.iter().any(|output| self.output_set.has(*output))
    }
}
