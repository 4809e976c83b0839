//! Servo oscillation: moves one axis to and fro between two reversal points, beside the program, with its own limits.
//!
//! The other axes belong to the program or to manual motion. A stroke ends when the axis is in position at the
//! reversal point; then its dwell begins. #438 and #439 are set in that tick and hold until the other reversal point.
//! Source: spec K4.3.

use super::{SECONDS_PER_MINUTE, limits};
use crate::defs::param::{self, Params};
use crate::defs::text::{LocalizedText, Template, phrase};
use crate::motion::{AxisLimits, AxisMover};
use crate::units::{Axis, Micros};

/// Several limited values.
const LIST: &Template = &Template::new("{message}; {next}", "{message}; {next}", &["message", "next"]);
/// Speed to which the ramp time D refers, mm/min.
const RAMP_SPEED_MM_MIN: f64 = 10_000.0;
/// Minimum double strokes per minute.
const MIN_STROKES_PER_MIN: f64 = 1.0;
/// Unit of P235 and P236, ms.
const DWELL_UNIT_MS: f64 = 4.0;
/// A stroke shorter than this, mm, counts as zero length.
pub const MIN_STROKE_MM: f64 = 1e-6;

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
    /// Moving to a reversal point: forward to the far one.
    Moving { forward: bool },
    /// In position at a reversal point.
    Dwelling { forward: bool, until: Micros },
    /// Reset or e-stop: braking.
    Stopping,
}

/// State of an oscillating axis.
#[derive(Clone, Debug)]
pub struct Oscillation {
    /// The axis.
    pub axis: Axis,
    /// Started by a program or an MDI line, not by the key.
    pub started_by_run: bool,
    from: f64,
    to: f64,
    speed_mm_s: f64,
    /// Its mover.
    pub mover: AxisMover,
    step: OscillationStep,
    /// G36: it ends at the next arrival at its start point.
    ending: bool,
    /// It rests until the run goes on.
    paused: bool,
    /// #438: in position forward; #439: backward.
    pub in_position: (bool, bool),
    begun_at: Option<Micros>,
    last_forward_at: Option<Micros>,
    /// Measured double strokes per minute, first from a half stroke; 0 before its end.
    pub strokes_min: f64,
}

/// Result of one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OscillationStatus {
    /// In progress.
    Running,
    /// The axis is at rest and free again.
    Finished,
}

impl Oscillation {
    /// Starts with the next tick. Returns a text if values were limited.
    #[must_use]
    pub fn new(
        stroke: OscillationStroke,
        by_run: bool,
        from: f64,
        params: &Params,
        tick_s: f64,
    ) -> (Self, Option<LocalizedText>) {
        let axis = stroke.axis;
        let own = limits(params, tick_s).axes[axis];
        let length = (stroke.to - from).abs();
        let asked = stroke.strokes_min.unwrap_or_else(|| params.get(param::OSCILLATION_FREQUENCY));
        let strokes = asked.max(MIN_STROKES_PER_MIN);
        // K4.3: v = 2·L·Q.
        let wanted = 2.0 * length * strokes;
        let most = params.get(param::OSCILLATION_SPEED).min(own.velocity_mm_s * SECONDS_PER_MINUTE);
        let ramp_ms = stroke.ramp_ms.unwrap_or_else(|| params.get(param::OSCILLATION_TIME_CONSTANT));
        let rapid_ms = 1_000.0 * RAMP_SPEED_MM_MIN / SECONDS_PER_MINUTE / own.acceleration_mm_s2;
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
            paused: false,
            in_position: (false, false),
            begun_at: None,
            last_forward_at: None,
            strokes_min: 0.0,
        };
        let limited = [
            (strokes > asked).then(|| phrase!("Q{asked} 按 1 次/分", "Q{asked} is replaced by 1", asked)),
            (wanted > most).then(|| {
                phrase!(
                    "速度 {wanted:.0} 限为 {most:.0} mm/min",
                    "{wanted:.0} mm/min is limited to {most:.0}",
                    wanted,
                    most
                )
            }),
            (ramp_ms < rapid_ms).then(|| {
                phrase!(
                    "D{ramp_ms:.0} 按 {rapid_ms:.0} ms",
                    "D{ramp_ms:.0} is replaced by {rapid_ms:.0} ms",
                    ramp_ms,
                    rapid_ms
                )
            }),
        ];
        let clamped =
            limited.into_iter().flatten().reduce(|message, next| LocalizedText::phrase_of(LIST, [], [message, next]));
        (oscillation, clamped)
    }

    /// One tick; `in_position`: the axis has followed its set-point.
    pub fn tick(&mut self, now: Micros, in_position: bool, params: &Params) -> OscillationStatus {
        let rest = self.mover.is_at_rest();
        self.begun_at = self.begun_at.or(Some(now));
        match self.step {
            OscillationStep::Stopping if rest => return OscillationStatus::Finished,
            OscillationStep::Stopping => {}
            OscillationStep::Moving { .. } | OscillationStep::Dwelling { .. } if self.paused => self.mover.stop(),
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
        if forward {
            let stroke = match (self.last_forward_at.replace(now), self.begun_at) {
                (Some(last), _) => now.since(last).as_secs_f64(),
                (None, begun) => 2.0 * until.since(begun.unwrap_or(now)).as_secs_f64(),
            };
            self.strokes_min = SECONDS_PER_MINUTE / stroke;
        }
    }

    /// The way to the end point of the present stroke, mm; 0 while it dwells or stops.
    pub fn way_to_end(&self) -> f64 {
        match self.step {
            OscillationStep::Moving { forward } => (if forward { self.to } else { self.from }) - self.mover.position(),
            OscillationStep::Dwelling { .. } | OscillationStep::Stopping => 0.0,
        }
    }

    /// G36: a forward stroke reverses at once; the oscillation ends at its start point.
    pub const fn end_at_start(&mut self) {
        if self.ending {
            return;
        }
        (self.ending, self.paused) = (true, false);
        if let OscillationStep::Moving { forward: true } = self.step {
            self.step = OscillationStep::Moving { forward: false };
        }
    }

    /// Brakes and rests, or goes on with its stroke.
    pub const fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
    }

    /// Whether it brakes to its end.
    #[must_use]
    pub const fn is_stopping(&self) -> bool {
        matches!(self.step, OscillationStep::Stopping)
    }

    /// Reset and e-stop: brakes the axis at once.
    pub fn stop(&mut self) {
        self.step = OscillationStep::Stopping;
        self.mover.emergency_stop();
    }
}
