//! Manual motion: jog keys, steps, handwheel, and homing.
//! Source: spec K2.3, K5.9, K5.16, B5.

use super::axes::{Owner, soft_limits};
use super::hand::HandLimits;
use super::homing::{AxisHoming, HomingPlan, Progress};
use super::{Controller, Event, Homing, MINUTE_HZ, Phase};
use crate::defs::key::{Key, Mode};
use crate::defs::mcode::Request;
use crate::defs::param::{self, Bit};
use crate::defs::signal::{Input, Output};
use crate::defs::text::{Said, Text};
use crate::machine::Answer;
use crate::units::{Axis, PerAxis};

/// Coarsest step on the wheel axis while the wheel turns, mm displayed (K5.9).
const FINE_STEP_MM: f64 = 0.010_5;

const INTO_LIMIT: Text = Text::new("限位方向，请向反方向移开", "onto the limit switch: move the other way");
const AT_SOFT_LIMIT: Text = Text::new("已到软限位，请向反方向移动", "at the software limit: move the other way");
const STILL_MOVING: Text = Text::new("轴还在运动，请稍候", "the axes still move");
const OPEN_RUN: Text =
    Text::new("轴还在运动或程序未结束，先复位", "axes still move, or a program is open: press RESET");

impl Controller {
    /// Handwheel detents: each changes the displayed coordinate by the step (K2.3).
    pub(super) fn turn_handwheel(&mut self, detents: i32) {
        if self.mode != Mode::Handwheel {
            return self.refuse(Said::new("手轮方式下手轮才有效", "the handwheel works in mode HANDWHEEL"));
        }
        if !self.is_free_for_hand() {
            return self.refuse(STILL_MOVING);
        }
        if !matches!(self.ask(Request::MoveByHand), Answer::Taken) || !self.part_from_run() {
            return;
        }
        let axis = self.hand.axis;
        if self.refuse_oscillating(axis) {
            return;
        }
        let distance = f64::from(detents) * self.hand.step_mm / self.displayed_per_mm(axis);
        self.step_by(axis, distance);
    }

    /// Whether a homed axis is at the soft limit in this direction.
    fn is_at_soft_limit(&self, axis: Axis, direction: f64) -> bool {
        let (low, high) = soft_limits(&self.params, axis);
        let at = self.axes.set()[axis];
        let width = self.params.get(param::IN_POSITION);
        self.axes.is_homed(axis) && if direction > 0.0 { at >= high - width } else { at <= low + width }
    }

    /// A handwheel detent or a step. K5.9: with the wheel on, the wheel axis accepts no coarse steps.
    fn step_by(&mut self, axis: Axis, distance: f64) {
        let coarse = self.hand.step_mm > FINE_STEP_MM;
        if coarse && axis == self.row.slow_axis && self.output_set.has(Output::Wheel) {
            return self.refuse(Said::new(
                "砂轮启动后该轴倍率只能为 ×0.01",
                "with the wheel on this axis takes ×0.01 and finer",
            ));
        }
        if self.runs_into_limit(axis, distance) {
            return self.refuse(INTO_LIMIT);
        }
        if self.is_at_soft_limit(axis, distance) {
            return self.refuse(AT_SOFT_LIMIT);
        }
        self.hand.nudge(axis, distance, &self.axes, &self.params);
    }

    pub(super) fn axis_key(&mut self, key: Key) {
        let Some((axis, direction)) = key.jog() else { return };
        if self.refuse_oscillating(axis) {
            return;
        }
        match self.mode {
            Mode::Manual if self.dress.returning => self.return_to_dress_point(axis),
            Mode::Home => self.home_axis(axis),
            Mode::Manual | Mode::Step if !self.is_free_for_hand() => self.refuse(STILL_MOVING),
            Mode::Manual => {
                if self.runs_into_limit(axis, direction) {
                    self.refuse(INTO_LIMIT);
                } else if self.overrides.feed == 0 && !self.hand.rapid {
                    self.refuse(Said::new("进给倍率为 0，轴不动", "the feed override is 0: the axis stands"));
                } else if self.is_at_soft_limit(axis, direction) {
                    self.refuse(AT_SOFT_LIMIT);
                } else if matches!(self.ask(Request::MoveByHand), Answer::Taken) && self.part_from_run() {
                    self.hand.hold(axis, direction, self.now);
                }
            }
            Mode::Step => {
                if matches!(self.ask(Request::MoveByHand), Answer::Taken) && self.part_from_run() {
                    let distance = direction * self.step_length_mm() / self.displayed_per_mm(axis);
                    self.step_by(axis, distance);
                }
            }
            Mode::Edit | Mode::Auto | Mode::Mdi | Mode::Handwheel => {
                self.refuse(Said::new("手动、单步或机械零点方式下轴键才有效", "axis keys work in JOG, STEP and HOME"));
            }
        }
    }

    /// Homes an axis; the wheel axis is always homed first (K5.16).
    fn home_axis(&mut self, axis: Axis) {
        if !matches!(self.ask(Request::HomeAxes), Answer::Taken) {
            return;
        }
        let mut wanted = PerAxis::default();
        wanted[axis] = true;
        let first = self.row.home_order.first().copied().unwrap_or(axis);
        if !self.axes.is_homed(first) {
            wanted[first] = true;
        }
        match &mut self.phase {
            Phase::Homing(Homing { next, now }) => {
                let (now, waits) = (now.axis, now.axis != axis);
                next[axis] |= waits;
                self.say(Said::new(
                    format!("{now} 轴正在回零{}", if waits { format!("，然后 {axis} 轴") } else { String::new() }),
                    format!("{now} is homing{}", if waits { format!(", then {axis}") } else { String::new() }),
                ));
            }
            Phase::Idle => self.next_homing(wanted),
            Phase::Running | Phase::Holding | Phase::Held | Phase::Stopped | Phase::Aborting => {
                self.refuse(OPEN_RUN);
            }
        }
    }

    fn next_homing(&mut self, mut wanted: PerAxis<bool>) {
        let Some(axis) = self.row.home_order.iter().copied().find(|axis| wanted[*axis]) else {
            return self.happen(Event::Homed);
        };
        wanted[axis] = false;
        if self.runs_into_limit(axis, self.home_direction(axis)) {
            self.refuse(INTO_LIMIT);
            return self.happen(Event::Homed);
        }
        let now = self.plan_homing(axis);
        self.axes.give_to_hand();
        self.axes.unbound(axis);
        self.happen(Event::Home(Homing { now, next: wanted }));
    }

    fn home_direction(&self, axis: Axis) -> f64 {
        let minus: Bit = [param::HOME_MINUS_X, param::HOME_MINUS_Y, param::HOME_MINUS_Z][axis as usize];
        if self.params.bit(minus) { -1.0 } else { 1.0 }
    }

    /// Speeds and maximum travel of an axis to its home switch.
    pub(super) fn plan_homing(&self, axis: Axis) -> AxisHoming {
        let direction = self.home_direction(axis);
        // K5.9: with the wheel turning, its minus direction is slow.
        let slow = axis == self.row.slow_axis && direction < 0.0 && self.output_set.has(Output::Wheel);
        let most = if slow { self.params.get(param::WHEEL_ON_SPEED) } else { f64::INFINITY };
        let plan = HomingPlan {
            direction,
            fast_mm_s: self.params.get(param::HOME_FAST).min(most) * MINUTE_HZ,
            slow_mm_s: self.params.get(param::HOME_SLOW) * MINUTE_HZ,
            travel_mm: self.params.get(param::HOMING_TRAVEL),
            coordinate: self.params.of_axis(param::HOME_X, axis),
            past: self.row.homes_past_switch(),
            width_mm: self.params.get(param::IN_POSITION),
        };
        AxisHoming::new(axis, plan)
    }

    /// One tick of homing an axis.
    pub(super) fn tick_homing(&mut self, homing: &mut AxisHoming) -> Progress {
        const SWITCHES: [Input; 3] = [Input::HomeX, Input::HomeY, Input::HomeZ];
        let (axis, switch) = (homing.axis, SWITCHES[homing.axis as usize]);
        let at = self.axes.actual()[axis];
        homing.tick(&mut self.axes.movers[axis], self.inputs.has(switch), self.raw.has(switch), at)
    }

    /// One tick of jog, handwheel or homing.
    pub(super) fn step_hand(&mut self) {
        if let Phase::Homing(Homing { now, next }) = self.phase.clone() {
            let (axis, mut homing) = (now.axis, now);
            let progress = self.tick_homing(&mut homing);
            if let Phase::Homing(Homing { now, .. }) = &mut self.phase {
                *now = homing;
            }
            match progress {
                Progress::Going => {}
                Progress::SetZero { edge } => {
                    self.found_zero(axis, edge);
                }
                Progress::Done => {
                    self.axes.finish_homing(axis, &self.params);
                    self.next_homing(next);
                }
                Progress::Failed(why) => self.homing_failed(axis, why),
            }
        } else if matches!(self.phase, Phase::Idle) || self.is_free_for_hand() && self.axes.owner() == Owner::Hand {
            let limits = HandLimits {
                feed: f64::from(self.overrides.feed) / 100.0,
                rapid: self.rate().rapid,
                slow: self.output_set.has(Output::Wheel).then_some(self.row.slow_axis),
            };
            let (mode, now) = (self.mode, self.now);
            self.axes.give_to_hand();
            if self.hand.tick(&mut self.axes, mode, now, &self.params, limits) {
                self.refuse(Said::new("按键信号中断，轴已停止", "the key was lost: the axis has stopped"));
            }
        }
    }
}
