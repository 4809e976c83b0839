//! Manual homing: the axis of a key, and the wheel axis before it.
//! Source: spec B5, K5.16.

use super::ON_LIMIT_SWITCH;
use crate::controller::axes::homing::HomingProgress;
use crate::controller::plant::{ControlEvent, ControlPhase, Homing, Plant};
use crate::defs::mcode::Request;
use crate::defs::text::{Text, phrase};
use crate::units::{Axis, PerAxis};

const OPEN_RUN: Text =
    Text::new("轴还在运动或程序未结束，先复位", "axes are still moving, or a program is active: press RESET");

/// Homes an axis; the wheel axis is always homed first (K5.16).
pub fn home_axis(plant: &mut Plant, axis: Axis) {
    if !plant.is_granted(Request::HomeAxes) {
        return;
    }
    let first = plant.kind.row().home_order.first().copied().unwrap_or(axis);
    let wanted = PerAxis::from_fn(|one| one == axis || one == first && plant.is_to_withdraw(first));
    match &mut plant.execution.phase {
        ControlPhase::Homing(Homing { queued: next, current: now }) => {
            let (now, waits) = (now.axis, now.axis != axis);
            next[axis] |= waits;
            plant.show_note(match waits {
                true => phrase!("{now} 轴正在回零，然后 {axis} 轴", "{now} is homing, then {axis}", now, axis),
                false => phrase!("{now} 轴正在回零", "{now} is homing", now),
            });
        }
        ControlPhase::Idle => next_homing(plant, wanted),
        ControlPhase::Running | ControlPhase::Holding | ControlPhase::Aborting => plant.refuse(OPEN_RUN),
        ControlPhase::Held | ControlPhase::Stopped => plant.refuse(OPEN_RUN),
    }
}

fn next_homing(plant: &mut Plant, mut wanted: PerAxis<bool>) {
    let Some(axis) = plant.kind.row().home_order.iter().copied().find(|axis| wanted[*axis]) else {
        return plant.transition(ControlEvent::Homed);
    };
    wanted[axis] = false;
    if plant.is_on_limit_switch(axis, plant.homing_direction(axis)) {
        plant.refuse(ON_LIMIT_SWITCH);
        return plant.transition(ControlEvent::Homed);
    }
    let now = plant.plan_homing(axis);
    plant.axes.switch_to_manual();
    plant.axes.lift_soft_limits(axis);
    plant.transition(ControlEvent::Home(Homing { current: now, queued: wanted }));
}

/// One tick of manual homing.
pub fn step_homing(plant: &mut Plant) {
    let ControlPhase::Homing(Homing { current: mut homing, queued }) = plant.execution.phase.clone() else { return };
    let axis = homing.axis;
    let progress = plant.tick_homing(&mut homing);
    if let ControlPhase::Homing(Homing { current, .. }) = &mut plant.execution.phase {
        *current = homing;
    }
    match progress {
        HomingProgress::Running => {}
        HomingProgress::SetZero { edge } => plant.apply_zero(axis, edge),
        HomingProgress::Done => {
            plant.axes.finish_homing(axis, &plant.params);
            next_homing(plant, queued);
        }
        HomingProgress::Failed(why) => plant.raise_homing_failed(axis, why),
    }
}
