//! Panel switches that change how a program runs: machine lock, auxiliary function lock (M/S/T), dry run.
//! Source: spec B5, K2.1.

use super::Parts;
use crate::controller::plant::Plant;
use crate::defs::text::{Text, phrase};

const DRIVES_OFF: Text = Text::new("驱动未接通，不能机床锁", "the drives are off: machine lock is not possible");
const WITH_RUN: Text = Text::new("程序未结束，不能切换", "a program is active: it cannot be switched now");

/// Machine lock: positions count but axes do not move. Switching it off shows the real positions again.
pub fn toggle_machine_lock(parts: &mut Parts<'_>) {
    if !parts.plant.drives_follow() {
        return parts.plant.refuse(DRIVES_OFF);
    }
    let plant = &parts.plant;
    let moving = !plant.axes.is_at_rest() || plant.jog.is_active() || plant.is_oscillating();
    if parts.program.is_open() || moving || parts.program.retract.lamp_on() {
        return parts.plant.refuse(WITH_RUN);
    }
    if parts.plant.axes.is_locked() {
        parts.plant.axes.unlock();
    } else {
        parts.plant.axes.switch_to_manual();
        parts.plant.axes.lock();
    }
}

/// M, S and T codes are read but not executed, except M00, M01, M30, M98 and M99.
pub fn toggle_aux_function_lock(plant: &mut Plant) {
    plant.operator.switches.aux_function_lock = !plant.operator.switches.aux_function_lock;
}

/// Dry run: feed moves run at P89, mm/min.
pub fn toggle_dry_run(parts: &mut Parts<'_>) {
    if parts.program.is_open() {
        return parts.plant.refuse(WITH_RUN);
    }
    parts.plant.operator.switches.dry_run = !parts.plant.operator.switches.dry_run;
    if parts.plant.operator.switches.dry_run {
        parts.plant.show_note(phrase!("空运行：进给按 P89 速度", "dry run: feeds at P89"));
    }
}
