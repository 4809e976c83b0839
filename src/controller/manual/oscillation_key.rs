//! The key 振荡: starts and ends an oscillation by hand.
//! Source: spec K4.3.

use crate::controller::axes::oscillation::{MIN_STROKE_MM, OscillationStroke};
use crate::controller::plant::{Plant, STILL_MOVING, key_stroke};
use crate::controller::program::move_refusal::MoveRefusal;
use crate::controller::program::queue::check_soft_limits;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::units::Axis;

/// Key 振荡: G35 with P238 to P241; pressed again, G36.
pub fn toggle_oscillation(plant: &mut Plant) {
    if plant.is_oscillating() {
        plant.end_oscillation();
        return;
    }
    if plant.params.bit(param::OSCILLATION_BY_CYLINDER) {
        plant.operator.cylinder_by_key = plant.is_granted(Request::CylinderOn);
        return;
    }
    let (axis, work) = key_stroke(&plant.params);
    if !plant.allows_manual_motion() || !plant.axes.is_at_rest() {
        return plant.refuse(STILL_MOVING);
    }
    if !plant.is_granted(Request::Jog) {
        return;
    }
    let to = work + plant.work.offsets.machine_minus_work(axis);
    if let Err(forbidden) = check_stroke(plant, axis, to) {
        let message = forbidden.text(&plant.params);
        return plant.refuse(message);
    }
    plant.begin_oscillation(OscillationStroke { axis, to, ramp_ms: None, strokes_min: None }, false);
}

fn check_stroke(plant: &Plant, axis: Axis, to: f64) -> Result<(), MoveRefusal> {
    if !plant.axes.is_homed(axis) {
        return Err(MoveRefusal::NotHomed);
    }
    if (to - plant.axes.set_point()[axis]).abs() < MIN_STROKE_MM {
        return Err(MoveRefusal::NoStroke(axis));
    }
    check_soft_limits(axis, to, &plant.params)
}
