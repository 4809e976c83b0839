//! Panel switches that change how a program runs: machine lock, auxiliary function lock (M/S/T), dry run.
//! Source: spec B5, K2.1.

use super::Controller;
use crate::defs::text::{LocalizedText, Text};

const WITH_RUN: Text = Text::new("程序未结束，不能切换", "a program is open: it is not switched now");

impl Controller {
    /// Machine lock: positions count but axes do not move. Switching it off shows the real positions again.
    pub(super) fn toggle_machine_lock(&mut self) {
        if !self.drives_on {
            return self.refuse(LocalizedText::new(
                "驱动未接通，不能机床锁",
                "the drives are off: the axes are not locked now",
            ));
        }
        if self.run.is_some() || !self.axes.is_at_rest() || self.jog.is_active() || self.retract.lamp_on() {
            return self.refuse(WITH_RUN);
        }
        if self.switches.machine_lock {
            self.release_machine_lock();
        } else {
            self.axes.switch_to_manual();
            self.axes.lock();
            self.switches.machine_lock = true;
        }
    }

    /// Machine lock off. Also called when the drives go off: displayed and real positions must then agree.
    pub(super) fn release_machine_lock(&mut self) {
        self.axes.unlock();
        self.switches.machine_lock = false;
    }

    /// M, S and T codes are read but not executed, except M00, M01, M30, M98 and M99.
    pub(super) fn toggle_aux_function_lock(&mut self) {
        self.switches.aux_function_lock = !self.switches.aux_function_lock;
    }

    /// Dry run: feed moves run at P89, mm/min.
    pub(super) fn toggle_dry_run(&mut self) {
        if self.run.is_some() {
            return self.refuse(WITH_RUN);
        }
        self.switches.dry_run = !self.switches.dry_run;
        if self.switches.dry_run {
            self.show_note(LocalizedText::new("空运行：进给按 P89 速度", "dry run: feeds run at P89"));
        }
    }
}
