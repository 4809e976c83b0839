//! Manual motion: jog keys, steps, handwheel, and homing.
//! Source: spec K2.3, K5.9, K5.16, B5.

use super::axes::{AxisOwner, soft_limits};
use super::homing::{AxisHoming, HomingPlan, HomingProgress};
use super::jog_state::JogLimits;
use super::{ControlEvent, ControlPhase, Controller, Homing, MM_S_PER_MM_MIN};
use crate::defs::key::{Key, Mode};
use crate::defs::mcode::Request;
use crate::defs::param::{self, BitParam};
use crate::defs::signal::{Input, Output};
use crate::defs::text::{LocalizedText, Text};
use crate::machine::RequestResult;
use crate::units::{Axis, PerAxis};

/// Coarsest step on the wheel axis while the wheel turns, mm displayed (K5.9).
const FINE_STEP_MM: f64 = 0.010_5;

const ON_LIMIT_SWITCH: Text = Text::new("限位方向，请向反方向移开", "onto the limit switch: move the other way");
const AT_SOFT_LIMIT: Text = Text::new("已到软限位，请向反方向移动", "at the software limit: move the other way");
const STILL_MOVING: Text = Text::new("轴还在运动，请稍候", "the axes still move");
const OPEN_RUN: Text =
    Text::new("轴还在运动或程序未结束，先复位", "axes still move, or a program is open: press RESET");

impl Controller {
    /// Handwheel detents: each changes the displayed coordinate by the step (K2.3).
    pub(super) fn turn_handwheel(&mut self, detents: i32) {
        if self.mode != Mode::Handwheel {
            return self.refuse(LocalizedText::new("手轮方式下手轮才有效", "the handwheel works in mode HANDWHEEL"));
        }
        if !self.allows_manual_motion() {
            return self.refuse(STILL_MOVING);
        }
        if !matches!(self.request(Request::Jog), RequestResult::Accepted) || !self.detach_from_run() {
            return;
        }
        let axis = self.jog.axis;
        if self.refuse_oscillating(axis) {
            return;
        }
        let distance = f64::from(detents) * self.jog.step_mm / self.displayed_per_mm(axis);
        self.jog_by(axis, distance);
    }

    /// Whether a homed axis is at the soft limit in this direction.
    fn is_at_soft_limit(&self, axis: Axis, direction: f64) -> bool {
        let (low, high) = soft_limits(&self.params, axis);
        let at = self.axes.set_point()[axis];
        let width = self.params.get(param::IN_POSITION);
        self.axes.is_homed(axis) && if direction > 0.0 { at >= high - width } else { at <= low + width }
    }

    /// A handwheel detent or a step. K5.9: with the wheel on, the wheel axis accepts no coarse steps.
    fn jog_by(&mut self, axis: Axis, distance: f64) {
        let coarse = self.jog.step_mm > FINE_STEP_MM;
        if coarse && axis == self.kind_row.wheel_axis && self.output_set.has(Output::Wheel) {
            return self.refuse(LocalizedText::new(
                "砂轮启动后该轴倍率只能为 ×0.01",
                "with the wheel on this axis takes ×0.01 and finer",
            ));
        }
        if self.is_on_limit_switch(axis, distance) {
            return self.refuse(ON_LIMIT_SWITCH);
        }
        if self.is_at_soft_limit(axis, distance) {
            return self.refuse(AT_SOFT_LIMIT);
        }
        self.jog.move_by(axis, distance, &self.axes, &self.params);
    }

    pub(super) fn axis_key(&mut self, key: Key) {
        let Some((axis, direction)) = key.jog_direction() else { return };
        if self.refuse_oscillating(axis) {
            return;
        }
        match self.mode {
            Mode::Manual if self.dressing.return_active => self.return_to_dress_point(axis),
            Mode::Home => self.home_axis(axis),
            Mode::Manual | Mode::Step if !self.allows_manual_motion() => self.refuse(STILL_MOVING),
            Mode::Manual => {
                if self.is_on_limit_switch(axis, direction) {
                    self.refuse(ON_LIMIT_SWITCH);
                } else if self.overrides.feed == 0 && !self.jog.rapid {
                    self.refuse(LocalizedText::new("进给倍率为 0，轴不动", "the feed override is 0: the axis stands"));
                } else if self.is_at_soft_limit(axis, direction) {
                    self.refuse(AT_SOFT_LIMIT);
                } else if matches!(self.request(Request::Jog), RequestResult::Accepted) && self.detach_from_run() {
                    self.jog.press_jog_key(axis, direction, self.now);
                }
            }
            Mode::Step => {
                if matches!(self.request(Request::Jog), RequestResult::Accepted) && self.detach_from_run() {
                    let distance = direction * self.step_length_mm() / self.displayed_per_mm(axis);
                    self.jog_by(axis, distance);
                }
            }
            Mode::Edit | Mode::Auto | Mode::Mdi | Mode::Handwheel => {
                self.refuse(LocalizedText::new(
                    "手动、单步或机械零点方式下轴键才有效",
                    "axis keys work in JOG, STEP and HOME",
                ));
            }
        }
    }

    /// Homes an axis; the wheel axis is always homed first (K5.16).
    fn home_axis(&mut self, axis: Axis) {
        if !matches!(self.request(Request::HomeAxes), RequestResult::Accepted) {
            return;
        }
        let mut wanted = PerAxis::default();
        wanted[axis] = true;
        let first = self.kind_row.home_order.first().copied().unwrap_or(axis);
        if !self.axes.is_homed(first) {
            wanted[first] = true;
        }
        match &mut self.phase {
            ControlPhase::Homing(Homing { queued: next, current: now }) => {
                let (now, waits) = (now.axis, now.axis != axis);
                next[axis] |= waits;
                self.show_note(LocalizedText::new(
                    format!("{now} 轴正在回零{}", if waits { format!("，然后 {axis} 轴") } else { String::new() }),
                    format!("{now} is homing{}", if waits { format!(", then {axis}") } else { String::new() }),
                ));
            }
            ControlPhase::Idle => self.next_homing(wanted),
            ControlPhase::Running
            | ControlPhase::Holding
            | ControlPhase::Held
            | ControlPhase::Stopped
            | ControlPhase::Aborting => {
                self.refuse(OPEN_RUN);
            }
        }
    }

    fn next_homing(&mut self, mut wanted: PerAxis<bool>) {
        let Some(axis) = self.kind_row.home_order.iter().copied().find(|axis| wanted[*axis]) else {
            return self.transition(ControlEvent::Homed);
        };
        wanted[axis] = false;
        if self.is_on_limit_switch(axis, self.home_direction(axis)) {
            self.refuse(ON_LIMIT_SWITCH);
            return self.transition(ControlEvent::Homed);
        }
        let now = self.plan_homing(axis);
        self.axes.switch_to_manual();
        self.axes.lift_soft_limits(axis);
        self.transition(ControlEvent::Home(Homing { current: now, queued: wanted }));
    }

    fn home_direction(&self, axis: Axis) -> f64 {
        let minus: BitParam = [param::HOME_MINUS_X, param::HOME_MINUS_Y, param::HOME_MINUS_Z][axis as usize];
        if self.params.bit(minus) { -1.0 } else { 1.0 }
    }

    /// Speeds and maximum travel of an axis to its home switch.
    pub(super) fn plan_homing(&self, axis: Axis) -> AxisHoming {
        let direction = self.home_direction(axis);
        // K5.9: with the wheel turning, its minus direction is slow.
        let slow = axis == self.kind_row.wheel_axis && direction < 0.0 && self.output_set.has(Output::Wheel);
        let most = if slow { self.params.get(param::WHEEL_ON_INFEED_SPEED) } else { f64::INFINITY };
        let plan = HomingPlan {
            direction,
            fast_mm_s: self.params.get(param::HOME_FAST).min(most) * MM_S_PER_MM_MIN,
            slow_mm_s: self.params.get(param::HOME_SLOW) * MM_S_PER_MM_MIN,
            travel_mm: self.params.get(param::HOMING_TRAVEL),
            coordinate: self.params.get_axis(param::HOME_X, axis),
            over_switch: self.kind_row.homes_over_switch(),
            width_mm: self.params.get(param::IN_POSITION),
        };
        AxisHoming::new(axis, plan)
    }

    /// One tick of homing an axis.
    pub(super) fn tick_homing(&mut self, homing: &mut AxisHoming) -> HomingProgress {
        const SWITCHES: [Input; 3] = [Input::HomeX, Input::HomeY, Input::HomeZ];
        let (axis, switch) = (homing.axis, SWITCHES[homing.axis as usize]);
        let at = self.axes.actual()[axis];
        homing.tick(&mut self.axes.movers[axis], self.inputs.has(switch), self.raw_inputs.has(switch), at)
    }

    /// One tick of jog, handwheel or homing.
    pub(super) fn step_jog(&mut self) {
        if let ControlPhase::Homing(Homing { current: now, queued: next }) = self.phase.clone() {
            let (axis, mut homing) = (now.axis, now);
            let progress = self.tick_homing(&mut homing);
            if let ControlPhase::Homing(Homing { current: now, .. }) = &mut self.phase {
                *now = homing;
            }
            match progress {
                HomingProgress::Running => {}
                HomingProgress::SetZero { edge } => {
                    self.apply_zero(axis, edge);
                }
                HomingProgress::Done => {
                    self.axes.finish_homing(axis, &self.params);
                    self.next_homing(next);
                }
                HomingProgress::Failed(why) => self.raise_homing_failed(axis, why),
            }
        } else if matches!(self.phase, ControlPhase::Idle)
            || self.allows_manual_motion() && self.axes.owner() == AxisOwner::Manual
        {
            let limits = JogLimits {
                feed: f64::from(self.overrides.feed) / 100.0,
                rapid: self.override_factors().rapid,
                slow_axis: self.output_set.has(Output::Wheel).then_some(self.kind_row.wheel_axis),
            };
            let (mode, now) = (self.mode, self.now);
            self.axes.switch_to_manual();
            if self.jog.tick(&mut self.axes, mode, now, &self.params, limits) {
                self.refuse(LocalizedText::new("按键信号中断，轴已停止", "the key was lost: the axis has stopped"));
            }
        }
    }
}
