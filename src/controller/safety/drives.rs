//! Supervision of the servo drives: faults, drives that do not come on or go off by themselves, and their reset.
//! Source: spec B5, B8, table "what stops what"; CiA 402-2 for the states of a drive.

use crate::controller::plant::Plant;
use crate::defs::alarm::{self, Reaction};
use crate::defs::signal::Input;
use crate::defs::text::{LocalizedText, phrase};
use crate::io::drive::{DriveFault, DriveState};
use crate::units::{Axis, Micros, PerAxis};

/// The fault signals of the drives, by axis.
const DRIVES: [Input; 3] = [Input::DriveX, Input::DriveY, Input::DriveZ];
/// Longest time from switching on until a drive follows: power stage, state machine and brake take less than a second.
const SWITCH_ON_LIMIT: Micros = Micros::from_millis(5_000);
/// How long RESET goes on while drives leave their fault or a bus is set up again.
const RESET_LIMIT: Micros = Micros::from_millis(2_000);

/// Alarms of devices: RESET goes on until their cause is gone.
const OF_DEVICES: [u16; 4] = [alarm::DRIVE_FAULT, alarm::BUS_LOST, alarm::STATION_SILENT, alarm::INVERTER_FAULT];

impl Plant {
    /// Whether every drive is on and follows its set-point.
    pub fn drives_follow(&self) -> bool {
        self.outputs.drives_on && self.axes.present().all(|axis| self.drive(axis) == DriveState::Enabled)
    }

    /// The axes whose drives do not follow: their set-points are their actual positions. The others hold theirs.
    pub fn axes_without_drive(&self) -> PerAxis<bool> {
        PerAxis::from_fn(|axis| !self.outputs.drives_on || self.drive(axis) != DriveState::Enabled)
    }

    /// Whether a drive reports a fault, over the bus or by its signal.
    pub fn has_drive_fault(&self) -> bool {
        self.axes.present().any(|axis| self.has_tripped(axis))
    }

    fn drive(&self, axis: Axis) -> DriveState {
        self.inputs.image.drives[axis]
    }

    fn has_tripped(&self, axis: Axis) -> bool {
        self.drive(axis).fault().is_some() || self.inputs.filtered.has(DRIVES[axis as usize])
    }

    /// Faults, drives that went off, and drives that do not come on.
    pub fn supervise_drives(&mut self) {
        self.continue_reset();
        // An emergency stop takes the power from the drives, and RESET gives it back: that they are not ready meanwhile is
        // no fault of theirs.
        let is_returning = !self.outputs.drives_on && self.outputs.drives.reset_until.is_some();
        let is_unpowered = self.alarms.has(alarm::EMERGENCY_STOP) || is_returning;
        let counts = |axis| !is_unpowered || self.drive(axis).fault().is_some();
        let faults = PerAxis::from_fn(|axis| self.axes.is_present(axis) && self.has_tripped(axis) && counts(axis));
        for axis in Axis::ALL {
            if self.drive(axis).fault().is_some_and(DriveFault::may_concern_position) {
                self.axes.doubt(axis);
            }
        }
        if faults.0.contains(&true) {
            self.report_tripped(faults);
        }
        self.supervise_switching();
        self.outputs.drives.before = self.inputs.image.drives;
    }

    /// A crash trips all drives at once: the moving axes are reported. A code that is read later is added.
    fn report_tripped(&mut self, mut faults: PerAxis<bool>) {
        let awaited = std::mem::take(&mut self.outputs.drives.code_awaited);
        if !self.alarms.has(alarm::DRIVE_FAULT) {
            let moving = PerAxis::from_fn(|axis| faults[axis] && self.is_moving(axis));
            if moving.0.contains(&true) {
                faults = moving;
            }
            self.raise(alarm::DRIVE_FAULT, Some(self.fault_words(faults)));
            self.axes.clear_homed();
        } else if awaited.0.contains(&true) {
            faults = awaited;
            if !self.is_code_missing(faults) {
                self.alarms.complete(alarm::DRIVE_FAULT, self.fault_words(faults));
            }
        } else {
            return;
        }
        if self.is_code_missing(faults) {
            self.outputs.drives.code_awaited = faults;
        }
    }

    fn is_code_missing(&self, faults: PerAxis<bool>) -> bool {
        faults.iter().any(|(axis, tripped)| *tripped && self.drive(axis).fault() == Some(DriveFault::UNKNOWN))
    }

    /// The first axis that has tripped with a code, and what it says; without a code all axes that have tripped.
    fn fault_words(&self, faults: PerAxis<bool>) -> LocalizedText {
        let known = |fault: &DriveFault| *fault != DriveFault::UNKNOWN;
        let coded = |axis: Axis| {
            let fault = if faults[axis] { self.drive(axis).fault().filter(known) } else { None };
            fault.map(|fault| (axis, fault))
        };
        let Some((axis, fault)) = Axis::ALL.into_iter().find_map(coded) else { return axis_names(faults) };
        let code = format_args!("{fault}");
        phrase!("{axis} {code} {says}", "{axis} {code} {says}", axis, code, says = fault.text())
    }

    /// A drive that goes off while it is to be on, or does not come on, is a fault, too.
    fn supervise_switching(&mut self) {
        if !self.outputs.drives_on || self.drives_follow() {
            self.outputs.drives.switching_since = None;
        }
        if !self.outputs.drives_on || self.drives_follow() || self.alarms.has(alarm::DRIVE_FAULT) {
            return;
        }
        let lost = |axis: &Axis| {
            self.outputs.drives.before[*axis] == DriveState::Enabled && self.drive(*axis) != DriveState::Enabled
        };
        let gone = self.axes.present().find(lost);
        let since = *self.outputs.drives.switching_since.get_or_insert(self.now);
        let late = self.now.since(since) > SWITCH_ON_LIMIT;
        let missing = self.axes.present().find(|axis| late && self.drive(*axis) != DriveState::Enabled);
        let words = match (gone, missing) {
            (Some(axis), _) => phrase!("{axis} 自行断开", "{axis} has switched itself off", axis),
            (None, Some(axis)) => phrase!("{axis} 没有接通", "{axis} does not switch on", axis),
            (None, None) => return,
        };
        self.raise(alarm::DRIVE_FAULT, Some(words));
        self.axes.clear_homed();
    }

    /// Whether the bus and the stations beside it serve the control, and no inverter is in a fault.
    fn are_devices_whole(&self) -> bool {
        let image = &self.inputs.image;
        image.bus_alive && !image.station_silent && !image.inverter_tripped
    }

    /// RESET acts on the drives and the bus, and goes on until their faults are gone.
    pub fn begin_fault_reset(&mut self) {
        self.outputs.fault_reset = true;
        let waits = self.has_drive_fault() || !self.are_devices_whole();
        self.outputs.drives.reset_until = waits.then(|| self.now + RESET_LIMIT);
    }

    fn continue_reset(&mut self) {
        let Some(until) = self.outputs.drives.reset_until else { return };
        let is_whole = self.are_devices_whole() && !self.has_drive_fault();
        if is_whole || self.now > until {
            self.outputs.drives.reset_until = None;
        }
        if is_whole {
            // What came after RESET waits for the next one.
            self.alarms.reset(|number| !OF_DEVICES.contains(&number));
            let stopped = self.machine.is_e_stopped() || self.alarms.has_reaction(Reaction::StopAll);
            self.outputs.drives_on = !stopped;
        }
    }
}

/// The letters of the axes that are set.
fn axis_names(axes: PerAxis<bool>) -> LocalizedText {
    let mut named = Axis::ALL.into_iter().filter(|axis| axes[*axis]);
    match (named.next(), named.next(), named.next()) {
        (Some(a), Some(b), Some(c)) => phrase!("{a} {b} {c}", "{a} {b} {c}", a, b, c),
        (Some(a), Some(b), None) => phrase!("{a} {b}", "{a} {b}", a, b),
        (Some(a), ..) => phrase!("{a}", "{a}", a),
        (None, ..) => LocalizedText::default(),
    }
}
