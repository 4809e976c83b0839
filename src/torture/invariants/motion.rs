//! Invariants of motion: no axis moves without a cause, faster than it may, or beyond a soft limit.
//! Source: spec K2.3, K5.9, B5; safety stance.

use super::{BRAKING, Moment};
use crate::controller::{Controller, soft_limits};
use crate::defs::key::{Key, Mode};
use crate::defs::param;
use crate::defs::signal::Output;
use crate::link::command::Command;
use crate::units::{Axis, Micros, PerAxis};

/// Longest move that one press begins: a step, or the way to a dressing point.
const PRESS_MOVE: Micros = Micros::from_millis(60_000);
/// Detents of the handwheel are followed at P67.
const HANDWHEEL_MOVE: Micros = Micros::from_millis(60_000);
/// A step of a set-point that counts as motion, mm: compensation of the leadscrew rounds.
const STILL_MM: f64 = 1e-9;
/// How far a set-point may be from the axis when the drives go on, mm: backlash and its compensation.
const SWITCH_ON_MM: f64 = 0.05;
/// How far a set-point may be beyond a soft limit, mm: rounding.
const LIMIT_TOLERANCE_MM: f64 = 1e-6;
/// Above the rapid speed: compensation of the leadscrew adds to it.
const SPEED_TOLERANCE: f64 = 1.05;
/// Above the acceleration: compensation of leadscrew and backlash adds to it.
const ACCELERATION_TOLERANCE: f64 = 1.05;
/// Seconds of a minute.
const MINUTE_S: f64 = 60.0;

/// What motion was allowed by, and where the axes were.
#[derive(Default)]
pub struct MotionRules {
    /// Until when axes may move.
    allowed_until: Micros,
    /// What moves by itself was begun by a key or a program.
    own_motion: bool,
    before: Option<PerAxis<f64>>,
    /// Steps of the last tick, mm; `None` while the drives are off, and in the tick in which they go on.
    steps_before: Option<PerAxis<f64>>,
    drives_on: bool,
    e_stopped_at: Option<Micros>,
    homed: PerAxis<bool>,
    beyond_mm: PerAxis<f64>,
    /// The limit of the wheel axis in the slow direction, mm/min, and since when it holds (K5.9).
    slow: Option<(f64, Micros)>,
}

impl MotionRules {
    pub(super) fn check(&mut self, moment: &Moment<'_>) -> Result<(), String> {
        if !moment.powered {
            *self = Self::default();
            return Ok(());
        }
        self.note_causes(moment);
        self.note_slow_direction(moment);
        self.check_drives(moment)?;
        let written = moment.machine.written;
        let set = PerAxis(written.set_point_mm.coordinates());
        let before = self.before.replace(set).filter(|_| written.drives_on);
        let was_on = std::mem::replace(&mut self.drives_on, written.drives_on);
        let Some(before) = before else {
            self.steps_before = None;
            return Ok(());
        };
        if !was_on {
            // The drives go on where the axes stand.
            let at = PerAxis(moment.machine.read.encoder_mm.coordinates());
            let jump = moment.controller.axes_present().find(|axis| (set[*axis] - at[*axis]).abs() > SWITCH_ON_MM);
            return jump.map_or(Ok(()), |axis| Err(format!("{axis} jumps when the drives go on")));
        }
        let steps = PerAxis::from_fn(|axis| set[axis] - before[axis]);
        let steps_before = self.steps_before.replace(steps);
        let tick_s = moment.controller.tick_time().as_secs_f64();
        for axis in moment.controller.axes_present() {
            let step = steps[axis];
            if step.abs() > STILL_MM && moment.now > self.allowed_until {
                return Err(format!("{axis} moves by {step:.6} mm without a cause"));
            }
            let rapid = moment.controller.params().get_axis(param::RAPID_X, axis) / MINUTE_S;
            if step.abs() > rapid * tick_s * SPEED_TOLERANCE {
                return Err(format!(
                    "{axis} moves at {:.1} mm/s, above its rapid speed {rapid:.1}",
                    step.abs() / tick_s
                ));
            }
            if let Some(steps_before) = steps_before {
                let acceleration = (step - steps_before[axis]).abs() / (tick_s * tick_s);
                let most = highest_acceleration(moment.controller, axis);
                if acceleration > most * ACCELERATION_TOLERANCE {
                    return Err(format!("{axis} accelerates by {acceleration:.0} mm/s², more than {most:.0}"));
                }
            }
            self.check_soft_limits(moment, axis)?;
        }
        self.check_slow_direction(moment, &steps)
    }

    /// Once the axes have braked, an emergency stop switches the drives off.
    fn check_drives(&mut self, moment: &Moment<'_>) -> Result<(), String> {
        self.e_stopped_at = moment.is_e_stopped().then(|| self.e_stopped_at.unwrap_or(moment.now));
        let late = self.e_stopped_at.is_some_and(|since| moment.now.since(since) > BRAKING);
        match late && moment.machine.written.drives_on {
            true => Err("the drives stay on in an emergency stop".to_owned()),
            false => Ok(()),
        }
    }

    /// What makes axes move, and what ends it.
    fn note_causes(&mut self, moment: &Moment<'_>) {
        let now = moment.now;
        let keep_alive = moment.controller.params().millis(param::JOG_KEEP_ALIVE);
        let mut allow = |time: Micros| self.allowed_until = self.allowed_until.max(now + time);
        let controller = moment.controller;
        let moves_by_itself = controller.own_motion().is_some() || controller.is_oscillating();
        if controller.state().is_active() || self.own_motion && moves_by_itself {
            allow(BRAKING);
        }
        for command in moment.commands {
            match command {
                Command::Press(key) if key.jog_direction().is_some() && controller.mode() == Mode::Step => {
                    allow(PRESS_MOVE);
                }
                Command::Press(_) | Command::StillHeld(_) => allow(keep_alive + BRAKING),
                Command::Handwheel(_) => allow(HANDWHEEL_MOVE),
                _ => {}
            }
        }
        self.own_motion = moves_by_itself && (self.own_motion || now <= self.allowed_until);
        if moment.pressed(|key| key == Key::Reset) || moment.is_e_stopped() {
            self.allowed_until = self.allowed_until.min(now + BRAKING);
        }
    }

    /// K5.9: with the wheel on, the jog of the wheel axis is slow in its minus direction.
    fn note_slow_direction(&mut self, moment: &Moment<'_>) {
        let controller = moment.controller;
        let jogs = controller.mode() == Mode::Manual && !controller.state().is_active() && !self.own_motion;
        let holds = jogs && moment.outputs_on.has(Output::Wheel);
        let limit = controller.params().get(param::WHEEL_ON_INFEED_SPEED);
        let before = self.slow.filter(|(known, _)| known.to_bits() == limit.to_bits());
        self.slow = holds.then(|| before.unwrap_or((limit, moment.now)));
    }

    fn check_slow_direction(&self, moment: &Moment<'_>, steps: &PerAxis<f64>) -> Result<(), String> {
        let axis = moment.controller.kind().row().wheel_axis;
        let tick_min = moment.controller.tick_time().as_secs_f64() / MINUTE_S;
        let too_fast = self.slow.filter(|(limit, since)| {
            moment.now.since(*since) > BRAKING && -steps[axis] > limit * tick_min * SPEED_TOLERANCE
        });
        let told = |limit| {
            format!("K5.9: {axis} is jogged minus at {:.0} mm/min, P242 is {limit:.0}", -steps[axis] / tick_min)
        };
        too_fast.map_or(Ok(()), |(limit, _)| Err(told(limit)))
    }

    /// A homed axis never goes farther beyond a soft limit than it was.
    fn check_soft_limits(&mut self, moment: &Moment<'_>, axis: Axis) -> Result<(), String> {
        let homed = moment.controller.is_homed(axis);
        let (low, high) = soft_limits(moment.controller.params(), axis);
        let at = moment.controller.set_point()[axis] + moment.machine.tampered_mm(axis);
        let beyond = (low - at).max(at - high).max(0.0);
        let was = std::mem::replace(&mut self.beyond_mm[axis], beyond);
        let was_homed = std::mem::replace(&mut self.homed[axis], homed);
        if homed && was_homed && beyond > was + LIMIT_TOLERANCE_MM {
            return Err(format!("{axis} goes {beyond:.4} mm beyond its soft limit"));
        }
        Ok(())
    }
}

/// The highest acceleration of a set-point, mm/s². In a thread the lag T of the drives is compensated ahead, by
/// T·v + T²/4·a: the axis keeps its limits, its set-point is beyond them by T·jerk and by a step of the jerk.
fn highest_acceleration(controller: &Controller, axis: Axis) -> f64 {
    let params = controller.params();
    let most = params.get_axis(param::ACCELERATION_X, axis);
    if !controller.is_threading() {
        return most;
    }
    let (jerk, lag_s) = (params.get_axis(param::JERK_X, axis), params.millis(param::SERVO_LAG).as_secs_f64());
    // At the top of a short run-up the jerk changes its sign, by twice itself.
    most + lag_s * jerk + lag_s * lag_s / 4.0 * 2.0 * jerk / controller.tick_time().as_secs_f64()
}
