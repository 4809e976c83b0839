//! Jog demand: what jog keys, steps and handwheel demand of the movers.
//!
//! A jog key acts only while it is held and refreshed: without a refresh for the keep-alive time the axis stops.
//! Source: spec K2.3, K5.9, B5.

use super::{Axes, SECONDS_PER_MINUTE, soft_limits};
use crate::defs::key::Key;
use crate::defs::param::{self, Params};
use crate::units::{Axis, Micros, PerAxis};

/// The demands of manual motion.
#[derive(Clone, Debug, Default)]
pub struct JogDemand {
    /// Jog keys that are down: direction (±1) and time of the last refresh.
    held_keys: PerAxis<Option<(f64, Micros)>>,
    /// Target of each axis, machine mm, and its maximum speed, mm/s; `None` is P67 (detents and steps).
    target: PerAxis<Option<(f64, Option<f64>)>>,
}

/// Limits of manual motion in this tick.
#[derive(Clone, Copy, Debug)]
pub struct JogLimits {
    /// Mode JOG is selected: jog keys act.
    pub jog_mode: bool,
    /// Rapid jog (快速) is on.
    pub rapid_jog: bool,
    /// Feed override factor.
    pub feed: f64,
    /// Rapid override factor.
    pub rapid: f64,
    /// The axis whose minus direction is slow because the wheel turns (K5.9).
    pub slow_axis: Option<Axis>,
}

impl JogDemand {
    /// A jog key is pressed.
    pub fn press_jog_key(&mut self, axis: Axis, direction: f64, now: Micros) {
        self.held_keys[axis] = Some((direction, now));
    }

    /// Refreshes a jog key that is down; other keys are ignored.
    pub fn keep_alive(&mut self, key: Key, now: Micros) {
        if let Some((axis, direction)) = key.jog_direction()
            && let Some((held, since)) = &mut self.held_keys[axis]
            && held.total_cmp(&direction).is_eq()
        {
            *since = now;
        }
    }

    /// A jog key is released.
    pub fn release_jog_key(&mut self, axis: Axis) {
        self.held_keys[axis] = None;
    }

    /// Whether a jog key is down or an axis has a target, even if it does not move yet.
    #[must_use]
    pub fn is_active(&self) -> bool {
        self.held_keys.iter().any(|(_, jog)| jog.is_some()) || self.target.iter().any(|(_, target)| target.is_some())
    }

    /// Whether an axis moves to a given point (回修整点, not a step).
    pub fn moves_to_point(&self) -> bool {
        self.target.iter().any(|(_, target)| matches!(target, Some((_, Some(_)))))
    }

    /// The target of an axis, machine mm, if it has one.
    pub fn target(&self, axis: Axis) -> Option<f64> {
        self.target[axis].map(|(target, _)| target)
    }

    /// Releases all jog keys and drops all targets.
    pub fn stop_all(&mut self) {
        self.held_keys = PerAxis::default();
        self.target = PerAxis::default();
    }

    /// Moves the target of an axis by `distance` mm of slide travel.
    pub fn move_by(&mut self, axis: Axis, distance: f64, axes: &Axes, params: &Params) {
        let from = self.target[axis].map_or(axes.set_point()[axis], |(target, _)| target);
        let mut to = from + distance;
        if axes.is_homed(axis) {
            let (low, high) = soft_limits(params, axis);
            // Beyond a limit (L6: the origin may lie there) a step moves back by its length only.
            to = to.clamp(low.min(from), high.max(from));
        }
        self.target[axis] = Some((to, None));
    }

    /// Moves an axis to a machine coordinate (mm) at up to `speed_mm_s`. The soft limits apply.
    pub fn move_to(&mut self, axis: Axis, to: f64, speed_mm_s: f64) {
        self.target[axis] = Some((to, Some(speed_mm_s)));
    }

    /// One tick: commands the movers. Returns whether a jog key was released because its refresh was lost.
    pub fn tick(&mut self, axes: &mut Axes, now: Micros, params: &Params, limits: JogLimits) -> bool {
        let silence = Micros::from_millis_f64(params.get(param::JOG_KEEP_ALIVE));
        let mut lost = false;
        for axis in Axis::ALL {
            if let Some((_, heard)) = self.held_keys[axis]
                && now.since(heard) > silence
            {
                self.held_keys[axis] = None;
                lost = true;
            }
            let mover = &mut axes.movers[axis];
            match (self.held_keys[axis], self.target[axis]) {
                (Some((direction, _)), _) if limits.jog_mode => {
                    mover.set_velocity_target(direction * jog_speed(axis, direction, params, limits));
                }
                (_, Some((target, speed))) => {
                    // A move to a target follows the feed override, as a jog does.
                    let speed = speed.map(|speed| speed * limits.feed);
                    let speed = speed.unwrap_or(params.get(param::HANDWHEEL_SPEED) / SECONDS_PER_MINUTE);
                    let slow = limits.slow_axis == Some(axis) && target < mover.position();
                    let most = if slow { params.get(param::WHEEL_ON_INFEED_SPEED) } else { f64::INFINITY };
                    mover.set_position_target(target, speed.min(most / SECONDS_PER_MINUTE));
                    if mover.is_at_rest() {
                        self.target[axis] = None;
                    }
                }
                (Some(_) | None, None) => mover.stop(),
            }
        }
        lost
    }
}

/// Jog speed with override, mm/s. The slow direction of a turning wheel is limited and has no rapid.
fn jog_speed(axis: Axis, direction: f64, params: &Params, limits: JogLimits) -> f64 {
    let slow = limits.slow_axis == Some(axis) && direction < 0.0;
    let speed = match limits.rapid_jog && !slow {
        true => params.get_axis(param::RAPID_X, axis) * limits.rapid,
        false => params.get(param::JOG_SPEED) * limits.feed,
    };
    let speed = if slow { speed.min(params.get(param::WHEEL_ON_INFEED_SPEED)) } else { speed };
    speed / SECONDS_PER_MINUTE
}
