//! Jog state: jog keys, steps, handwheel.
//!
//! A jog key acts only while it is held and refreshed: without a refresh for the keep-alive time the axis stops.
//! Source: spec K2.3, K5.9, B5.

use super::axes::{Axes, MINUTE};
use crate::defs::key::{Key, Mode};
use crate::defs::param::{self, Params};
use crate::units::{Axis, Micros, PerAxis};

/// State of the manual controls.
#[derive(Clone, Debug)]
pub struct Hand {
    /// Jog keys that are down: direction (±1) and time of the last refresh.
    jog: PerAxis<Option<(f64, Micros)>>,
    /// Rapid jog (快速) is on.
    pub rapid: bool,
    /// Axis of the handwheel.
    pub axis: Axis,
    /// Step per detent, mm as displayed.
    pub step_mm: f64,
    /// Target of each axis, machine mm, and its maximum speed, mm/s; `None` is P67 (detents and steps).
    target: PerAxis<Option<(f64, Option<f64>)>>,
}

/// Limits of manual motion in this tick.
#[derive(Clone, Copy, Debug)]
pub struct HandLimits {
    /// Feed override factor.
    pub feed: f64,
    /// Rapid override factor.
    pub rapid: f64,
    /// The axis whose minus direction is slow because the wheel turns (K5.9).
    pub slow: Option<Axis>,
}

impl Default for Hand {
    fn default() -> Self {
        Self { jog: PerAxis::default(), rapid: false, axis: Axis::X, step_mm: 0.01, target: PerAxis::default() }
    }
}

impl Hand {
    /// A jog key is pressed.
    pub fn hold(&mut self, axis: Axis, direction: f64, now: Micros) {
        self.jog[axis] = Some((direction, now));
    }

    /// Refreshes a jog key that is down; other keys are ignored.
    pub fn keep(&mut self, key: Key, now: Micros) {
        if let Some((axis, direction)) = key.jog()
            && let Some((held, since)) = &mut self.jog[axis]
            && held.total_cmp(&direction).is_eq()
        {
            *since = now;
        }
    }

    /// A jog key is released.
    pub fn release(&mut self, axis: Axis) {
        self.jog[axis] = None;
    }

    /// Whether a jog key is down or an axis has a target, even if it does not move yet.
    #[must_use]
    pub fn is_leading(&self) -> bool {
        self.jog.iter().any(|(_, jog)| jog.is_some()) || self.target.iter().any(|(_, target)| target.is_some())
    }

    /// Releases all jog keys and drops all targets.
    pub fn let_go(&mut self) {
        self.jog = PerAxis::default();
        self.target = PerAxis::default();
    }

    /// Moves the target of an axis by `distance` mm of slide travel.
    pub fn nudge(&mut self, axis: Axis, distance: f64, axes: &Axes, params: &Params) {
        let from = self.target[axis].map_or(axes.set()[axis], |(target, _)| target);
        let mut to = from + distance;
        if axes.is_homed(axis) {
            let (low, high) = super::axes::soft_limits(params, axis);
            // Beyond a limit (L6: the origin may lie there) a step moves back by its length only.
            to = to.clamp(low.min(from), high.max(from));
        }
        self.target[axis] = Some((to, None));
    }

    /// Moves an axis to a machine coordinate (mm) at up to `speed_mm_s`. The soft limits apply.
    pub fn lead(&mut self, axis: Axis, to: f64, speed_mm_s: f64) {
        self.target[axis] = Some((to, Some(speed_mm_s)));
    }

    /// One tick: commands the movers. Returns whether a jog key was released because its refresh was lost.
    pub fn tick(&mut self, axes: &mut Axes, mode: Mode, now: Micros, params: &Params, limits: HandLimits) -> bool {
        let silence = Micros::from_millis_f64(params.get(param::JOG_KEEP_ALIVE));
        let mut lost = false;
        for axis in Axis::ALL {
            if let Some((_, heard)) = self.jog[axis]
                && now.since(heard) > silence
            {
                self.jog[axis] = None;
                lost = true;
            }
            let mover = &mut axes.movers[axis];
            match (self.jog[axis], self.target[axis]) {
                (Some((direction, _)), _) if mode == Mode::Manual => {
                    mover.velocity_target(direction * self.speed(axis, direction, params, limits));
                }
                (_, Some((target, speed))) => {
                    // A move to a target follows the feed override, as a jog does.
                    let speed = speed.map(|speed| speed * limits.feed);
                    let speed = speed.unwrap_or(params.get(param::HANDWHEEL_SPEED) / MINUTE);
                    let slow = limits.slow == Some(axis) && target < mover.position();
                    let most = if slow { params.get(param::WHEEL_ON_SPEED) / MINUTE } else { f64::INFINITY };
                    mover.position_target(target, speed.min(most));
                    if mover.is_at_rest() {
                        self.target[axis] = None;
                    }
                }
                (Some(_) | None, None) => mover.stop(),
            }
        }
        lost
    }

    /// Jog speed with override, mm/s. The slow direction of a turning wheel is limited and has no rapid.
    fn speed(&self, axis: Axis, direction: f64, params: &Params, limits: HandLimits) -> f64 {
        let slow = limits.slow == Some(axis) && direction < 0.0;
        let speed = match self.rapid && !slow {
            true => params.of_axis(param::RAPID_X, axis) * limits.rapid,
            false => params.get(param::JOG_SPEED) * limits.feed,
        };
        let speed = if slow { speed.min(params.get(param::WHEEL_ON_SPEED)) } else { speed };
        speed / MINUTE
    }
}
