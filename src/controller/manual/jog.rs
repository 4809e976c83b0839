//! Manual motion: jog keys, steps and handwheel.
//! Source: spec K2.3, K5.9.

use super::homing::{home_axis, step_homing};
use super::{Manual, ON_LIMIT_SWITCH};
use crate::controller::axes::AxisOwner;
use crate::controller::axes::jog_demand::JogLimits;
use crate::controller::plant::{ControlPhase, Plant, STILL_MOVING};
use crate::controller::program::Program;
use crate::defs::key::{Key, Mode};
use crate::defs::mcode::Request;
use crate::defs::signal::Output;
use crate::defs::text::{Text, phrase};
use crate::units::Axis;

/// Coarsest step on the wheel axis while the wheel turns, mm displayed (K5.9).
const FINE_STEP_MM: f64 = 0.010_5;

const TOO_COARSE: Text =
    Text::new("砂轮启动后该轴倍率只能为 ×0.01", "with the wheel on, this axis allows only ×0.01 or finer");
const AT_SOFT_LIMIT: Text = Text::new("已到软限位，请向反方向移动", "at the soft limit: move the other way");

/// Handwheel detents: each changes the displayed coordinate by the step (K2.3).
pub fn turn_handwheel(plant: &mut Plant, program: &mut Program, detents: i32) {
    if plant.operator.mode != Mode::Handwheel {
        return plant.refuse(phrase!("手轮方式下手轮才有效", "the handwheel works in mode HANDWHEEL"));
    }
    if !plant.allows_manual_motion() {
        return plant.refuse(STILL_MOVING);
    }
    if !plant.is_granted(Request::Jog) || !program.detach_from_run(plant) {
        return;
    }
    let axis = plant.operator.handwheel_axis;
    if plant.refuse_oscillating(axis) {
        return;
    }
    let distance = f64::from(detents) * plant.operator.step_mm / plant.displayed_per_mm(axis);
    jog_by(plant, axis, distance);
}

/// A handwheel detent or a step. K5.9: with the wheel on, the wheel axis accepts no coarse detents, and no coarse step in
/// its slow direction.
fn jog_by(plant: &mut Plant, axis: Axis, distance: f64) {
    let is_limited = plant.operator.mode == Mode::Handwheel || distance < 0.0;
    if is_limited
        && plant.operator.step_mm > FINE_STEP_MM
        && axis == plant.kind.row().wheel_axis
        && plant.outputs.on.has(Output::Wheel)
    {
        return plant.refuse(TOO_COARSE);
    }
    if plant.is_on_limit_switch(axis, distance) {
        return plant.refuse(ON_LIMIT_SWITCH);
    }
    if plant.is_at_soft_limit(axis, distance) {
        return plant.refuse(AT_SOFT_LIMIT);
    }
    plant.jog.move_by(axis, distance, &plant.axes, &plant.params);
}

/// One tick of jog, handwheel or homing.
pub fn step_jog(plant: &mut Plant) {
    if plant.execution.phase.is_homing() {
        step_homing(plant);
    } else if matches!(plant.execution.phase, ControlPhase::Idle)
        || plant.allows_manual_motion() && plant.axes.owner() == AxisOwner::Manual
    {
        let limits = JogLimits {
            jog_mode: plant.operator.mode == Mode::Manual,
            rapid_jog: plant.operator.rapid_jog,
            feed: f64::from(plant.operator.overrides.feed) / 100.0,
            rapid: plant.override_factors().rapid,
            slow_axis: plant.outputs.on.has(Output::Wheel).then_some(plant.kind.row().wheel_axis),
        };
        plant.axes.switch_to_manual();
        if plant.jog.tick(&mut plant.axes, plant.now, &plant.params, limits) {
            plant.refuse(phrase!("按键信号中断，轴已停止", "key signal lost: the axis has stopped"));
        }
    }
}

impl Manual {
    /// An axis key: jogs, steps, homes, or returns to the dressing point.
    pub fn axis_key(&mut self, plant: &mut Plant, program: &mut Program, key: Key) {
        let Some((axis, direction)) = key.jog_direction() else { return };
        if plant.refuse_oscillating(axis) {
            return;
        }
        match plant.operator.mode {
            Mode::Manual if self.dressing.return_active => self.return_to_dress_point(plant, program, axis),
            Mode::Home => home_axis(plant, axis),
            Mode::Manual | Mode::Step if !plant.allows_manual_motion() => plant.refuse(STILL_MOVING),
            Mode::Manual => {
                if plant.is_on_limit_switch(axis, direction) {
                    plant.refuse(ON_LIMIT_SWITCH);
                } else if plant.operator.overrides.feed == 0 && !plant.operator.rapid_jog {
                    plant.refuse(phrase!("进给倍率为 0，轴不动", "the feed override is 0: the axis does not move"));
                } else if plant.is_at_soft_limit(axis, direction) {
                    plant.refuse(AT_SOFT_LIMIT);
                } else if plant.is_granted(Request::Jog) && program.detach_from_run(plant) {
                    plant.jog.press_jog_key(axis, direction, plant.now);
                }
            }
            Mode::Step => {
                if plant.is_granted(Request::Jog) && program.detach_from_run(plant) {
                    let distance = direction * plant.step_length_mm() / plant.displayed_per_mm(axis);
                    jog_by(plant, axis, distance);
                }
            }
            Mode::Edit | Mode::Auto | Mode::Mdi | Mode::Handwheel => {
                plant.refuse(phrase!("手动、单步或机械零点方式下轴键才有效", "axis keys work in JOG, STEP and HOME"));
            }
        }
    }
}
