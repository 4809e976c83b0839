//! The supply of the machine fails (P369): everything stops as in an emergency stop, the place of the run is kept, and a
//! turning wheel leaves the part by P379 while the energy of the drives lasts.
//! Source: spec B5 (restart after an interruption), K5.18 (wheel axis and direction); safety stance.

use super::Program;
use crate::controller::plant::{ControlEvent, ControlPhase, Plant};
use crate::defs::alarm::{self, Reaction};
use crate::defs::param;
use crate::defs::signal::{Input, Output};

/// What the wheel does after the supply has failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PowerFailRetract {
    /// It stays.
    #[default]
    Stays,
    /// It is withdrawn as soon as the axes have braked.
    Due,
    /// It is being withdrawn.
    Moving,
}

impl Program {
    /// One tick: reacts to the signal of the supply. Another cause that stops everything stops the retract, too.
    pub fn supervise_supply(&mut self, plant: &mut Plant) {
        let other = |number: u16| number != alarm::POWER_FAIL && alarm::reaction(number) == Reaction::StopAll;
        let forbidden = plant.alarms.present().iter().any(|alarm| other(alarm.number));
        if forbidden && std::mem::take(&mut self.power_fail) == PowerFailRetract::Moving {
            plant.axes.brake();
        }
        if !plant.inputs.filtered.has(Input::PowerFail) || plant.alarms.has(alarm::POWER_FAIL) {
            return;
        }
        let is_asked = plant.params.get(param::POWER_FAIL_RETRACT) > 0.0 && plant.outputs.on.has(Output::Wheel);
        let can_move = plant.axes.is_homed(plant.kind.row().wheel_axis) && plant.drives_follow();
        self.keep_run_position(plant);
        plant.raise(alarm::POWER_FAIL, None);
        if is_asked && can_move && !forbidden && !plant.axes.is_locked() {
            self.power_fail = PowerFailRetract::Due;
            // The drives stay on until the wheel has been withdrawn.
            if !matches!(plant.execution.phase, ControlPhase::Aborting) {
                plant.transition(ControlEvent::Abort);
            }
        }
    }

    /// The axes have come to rest: withdraws the wheel if that is due. True: they move again.
    pub(super) fn withdraws_at_power_fail(&mut self, plant: &mut Plant) -> bool {
        if std::mem::take(&mut self.power_fail) != PowerFailRetract::Due {
            return false;
        }
        self.power_fail = PowerFailRetract::Moving;
        plant.axes.switch_to_manual();
        let axis = plant.kind.row().wheel_axis;
        let to = plant.axes.set_point()[axis] + plant.params.get(param::POWER_FAIL_RETRACT);
        // The bounds of the mover are the soft limits.
        plant.axes.movers[axis].set_position_target(to, f64::INFINITY);
        true
    }
}
