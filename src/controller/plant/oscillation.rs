//! Servo oscillation beside the program: start, end, stop and flags.
//! Source: spec K4.3.

use super::{Plant, displayed_per_mm};
use crate::controller::axes::oscillation::{Oscillation, OscillationStatus, OscillationStroke};
use crate::defs::alarm;
use crate::defs::mcode::Request;
use crate::defs::param::{self, Params};
use crate::defs::signal::Output;
use crate::defs::text::Text;
use crate::machine::phase::RunPhase;
use crate::units::Axis;

const OSCILLATES: Text = Text::new("该轴在振荡中，先关闭振荡", "the axis is oscillating: stop the oscillation first");

/// The oscillation of the key and of M35 alone: axis (P238) and other end (P239), work coordinate of the slide.
pub fn key_stroke(params: &Params) -> (Axis, f64) {
    let axis = if params.get(param::OSCILLATION_AXIS) < 0.5 { Axis::X } else { Axis::Z };
    (axis, params.get(param::OSCILLATION_POSITION) / displayed_per_mm(params, axis))
}

impl Plant {
    /// The axis that oscillates by servo.
    pub fn oscillating_axis(&self) -> Option<Axis> {
        self.oscillation.as_ref().map(|oscillation| oscillation.axis)
    }

    /// The oscillation was started by the key: a held program does not know of it (K4.3).
    pub fn oscillates_by_key(&self) -> bool {
        let servo = self.oscillation.as_ref().is_some_and(|oscillation| !oscillation.started_by_run);
        servo || self.operator.cylinder_by_key && self.machine.cylinder_is_on()
    }

    /// Whether an axis or the cylinder oscillates.
    pub fn is_oscillating(&self) -> bool {
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
    pub fn measured_strokes_min(&self) -> Option<f64> {
        self.oscillation.as_ref().map(|oscillation| oscillation.strokes_min).filter(|strokes| *strokes > 0.0)
    }

    /// One tick of the oscillation.
    pub fn step_oscillation(&mut self) {
        if !self.is_oscillating() {
            self.alarms.clear(alarm::OSCILLATING_AT_START);
        }
        let Some(mut oscillation) = self.oscillation.take() else { return };
        // K5.13: all axes stop, and none moves by the closing of the door alone; the same after a standstill of the computer.
        let paused = self.alarms.has(alarm::GUARD_OPEN) || self.alarms.has(alarm::CONTROL_STALLED);
        match (paused, &self.execution.phase) {
            (true, phase) if phase.is_run_open() => oscillation.set_paused(true),
            (_, RunPhase::Running) => oscillation.set_paused(false),
            _ => {}
        }
        let axis = oscillation.axis;
        let in_position = self.axes.is_axis_in_position(axis, &self.params);
        match oscillation.tick(self.now, in_position, &self.params) {
            OscillationStatus::Running => {
                let mover = &oscillation.mover;
                self.axes.set_oscillation(Some((axis, mover.position(), mover.velocity_mm_s())));
                self.oscillation = Some(oscillation);
            }
            OscillationStatus::Finished => self.axes.set_oscillation(None),
        }
    }

    /// G35 and the key: starts oscillation between the present set-point and the given reversal point.
    pub fn begin_oscillation(&mut self, stroke: OscillationStroke, by_run: bool) {
        let from = self.axes.set_point()[stroke.axis];
        let tick_s = self.axes.tick_time().as_secs_f64();
        let (oscillation, clamped) = Oscillation::new(stroke, by_run, from, &self.params, tick_s);
        self.oscillation = Some(oscillation);
        if let Some(message) = clamped {
            self.refuse(message);
        }
    }

    /// G36 and the key: ends the oscillation at its start point. True when nothing oscillates by servo any more.
    pub fn end_oscillation(&mut self) -> bool {
        if self.machine.cylinder_is_on() {
            self.request(Request::CylinderOff);
        }
        if let Some(oscillation) = &mut self.oscillation {
            oscillation.end_at_start();
        }
        self.oscillation.is_none()
    }

    /// Reset and e-stop: brakes the axis at once.
    pub fn stop_oscillation(&mut self) {
        if let Some(oscillation) = &mut self.oscillation {
            oscillation.stop();
        }
    }

    /// Whether no set-point moves; an axis that goes on oscillating does not count.
    pub fn has_braked(&self) -> bool {
        self.axes.is_at_rest() && !self.oscillation.as_ref().is_some_and(Oscillation::is_stopping)
    }

    /// Refuses manual motion of an oscillating axis. True if refused.
    pub fn refuse_oscillating(&mut self, axis: Axis) -> bool {
        let oscillates = self.oscillating_axis() == Some(axis);
        if oscillates {
            self.refuse(OSCILLATES);
        }
        oscillates
    }

    /// The lamp of the key: servo or cylinder oscillates, or a valve is on.
    pub fn oscillation_lamp(&self) -> bool {
        let cylinder = [Output::OscillationForward, Output::OscillationBackward];
        self.is_oscillating() || cylinder.iter().any(|output| self.outputs.on.has(*output))
    }
}
