//! Spindles: wheel, workhead or table, dressing roll, second spindle. Speeds rise and fall at constant rates (P2).

use super::machine_file::MachineFile;
use super::machine_sections::{DriveFile, RollFile, SecondSpindleFile, WheelFile};
use crate::defs::signal::{Output, OutputSet};
use crate::io::OutputImage;

/// Below this an analog output commands no speed, V: the motor then runs at its fixed speed.
const MIN_SPEED_VOLTS: f64 = 0.05;
/// Full scale of an analog output, V.
const FULL_VOLTS: f64 = 10.0;

/// A motor with its run-up and coast-down.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spindle {
    /// Present speed, rpm.
    pub(super) rpm: f64,
    /// Last commanded speed above zero, rpm.
    commanded_rpm: f64,
    accel_rpm_s: f64,
    decel_rpm_s: f64,
}

impl Spindle {
    /// The wheel: runs up under power and coasts down without brake.
    pub(super) fn wheel(file: &WheelFile) -> Self {
        let full = file.mains_rpm;
        let (accel_rpm_s, decel_rpm_s) = (full / file.run_up_s, full / file.coast_down_s);
        Self { rpm: 0.0, commanded_rpm: full, accel_rpm_s, decel_rpm_s }
    }

    /// Workhead, table or roll: decelerates as fast as it accelerates.
    pub(super) fn driven(file: &DriveFile) -> Self {
        let rate = file.high_rpm / file.run_up_s;
        Self { rpm: 0.0, commanded_rpm: file.high_rpm, accel_rpm_s: rate, decel_rpm_s: rate }
    }

    /// Moves the speed towards `target_rpm` for one tick; zero is off.
    pub(super) fn step(&mut self, target_rpm: f64, dt_s: f64) {
        if target_rpm > 0.0 {
            self.commanded_rpm = target_rpm;
        }
        self.rpm = if self.rpm < target_rpm {
            (self.rpm + self.accel_rpm_s * dt_s).min(target_rpm)
        } else {
            (self.rpm - self.decel_rpm_s * dt_s).max(target_rpm)
        };
    }

    /// Whether it is fast enough to cut: at least half of the last commanded speed.
    pub(super) fn can_cut(&self) -> bool {
        self.rpm >= 0.5 * self.commanded_rpm
    }
}

/// Commanded wheel speed, rpm. DECISION: switched on without a voltage the wheel runs at mains speed, as a motor on a
/// contactor does; a program without S still grinds.
pub(super) fn wheel_target_rpm(file: &WheelFile, on: bool, volts: f64) -> f64 {
    match (on, volts > MIN_SPEED_VOLTS) {
        (false, _) => 0.0,
        (true, false) => file.mains_rpm,
        (true, true) => file.rpm_at_10_v * volts.min(FULL_VOLTS) / FULL_VOLTS,
    }
}

/// Commanded speed of workhead, table or roll, rpm. High has priority over low, a voltage over both fixed speeds.
pub(super) fn drive_target_rpm(file: &DriveFile, high: bool, low: bool, volts: f64) -> f64 {
    match (high || low, volts > MIN_SPEED_VOLTS) {
        (false, _) => 0.0,
        (true, true) => (file.greatest_rpm * volts / FULL_VOLTS).clamp(file.least_rpm, file.greatest_rpm),
        (true, false) if high => file.high_rpm,
        (true, false) => file.low_rpm,
    }
}

/// A spindle with one speed and two directions.
#[derive(Clone, Debug)]
pub(super) struct ReversibleSpindle {
    file: SecondSpindleFile,
    /// Present speed, rpm, clockwise positive.
    pub(super) rpm: f64,
}

impl ReversibleSpindle {
    /// DECISION: with both directions commanded it stops, as with interlocked contactors.
    fn step(&mut self, clockwise: bool, counter: bool, dt_s: f64) {
        let target = match (clockwise, counter) {
            (true, false) => self.file.rpm,
            (false, true) => -self.file.rpm,
            (true, true) | (false, false) => 0.0,
        };
        let most = self.file.rpm / self.file.run_up_s * dt_s;
        self.rpm += (target - self.rpm).clamp(-most, most);
    }
}

/// The spindles of a grinder.
#[derive(Clone, Debug)]
pub(super) struct GrinderSpindles {
    pub(super) wheel: Spindle,
    pub(super) workhead: Option<Spindle>,
    pub(super) table: Option<Spindle>,
    pub(super) roll: Option<Spindle>,
    pub(super) second: ReversibleSpindle,
}

impl GrinderSpindles {
    /// Everything at rest.
    pub(super) fn new(file: &MachineFile) -> Self {
        Self {
            wheel: Spindle::wheel(&file.wheel),
            workhead: file.workhead.as_ref().map(Spindle::driven),
            table: file.table.as_ref().map(Spindle::driven),
            roll: roll(file).map(|roll| Spindle::driven(&roll.drive)),
            second: ReversibleSpindle { file: file.second_spindle.clone(), rpm: 0.0 },
        }
    }

    /// One tick under the outputs.
    pub(super) fn step(&mut self, file: &MachineFile, outputs: &OutputImage, on: OutputSet, dt_s: f64) {
        let (wheel_volts, volts) = (outputs.wheel_volts, outputs.analog_2_volts);
        self.wheel.step(wheel_target_rpm(&file.wheel, on.has(Output::Wheel), wheel_volts), dt_s);
        if let (Some(spindle), Some(drive)) = (&mut self.workhead, &file.workhead) {
            let (high, low) = (on.has(Output::HeadstockHigh), on.has(Output::HeadstockLow));
            spindle.step(drive_target_rpm(drive, high, low, volts), dt_s);
        }
        if let (Some(spindle), Some(drive)) = (&mut self.table, &file.table) {
            spindle.step(drive_target_rpm(drive, on.has(Output::TableRotation), false, volts), dt_s);
        }
        if let (Some(spindle), Some(roll)) = (&mut self.roll, roll(file)) {
            spindle.step(drive_target_rpm(&roll.drive, on.has(Output::DresserRoll), false, volts), dt_s);
        }
        self.second.step(on.has(Output::SecondSpindle), on.has(Output::SecondSpindleCcw), dt_s);
    }

    /// Speed of the part, rpm, on workhead or table.
    pub(super) fn part_rpm(&self) -> f64 {
        rpm_of(self.workhead).max(rpm_of(self.table))
    }
}

/// The speed of a spindle, rpm; zero where there is none.
pub(super) fn rpm_of(spindle: Option<Spindle>) -> f64 {
    spindle.map_or(0.0, |spindle| spindle.rpm)
}

fn roll(file: &MachineFile) -> Option<&RollFile> {
    file.dresser.as_ref().and_then(|dresser| dresser.roll.as_ref())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;

    #[test]
    fn p2_the_wheel_runs_up_in_eight_seconds_and_coasts_for_sixty() {
        let file = MachineFile::builtin(Kind::Gc).unwrap().wheel;
        let mut wheel = Spindle::wheel(&file);
        (0..7_900).for_each(|_| wheel.step(1_000.0, 0.001));
        assert!(wheel.rpm < 1_000.0 && wheel.can_cut());
        (0..200).for_each(|_| wheel.step(1_000.0, 0.001));
        assert!((wheel.rpm - 1_000.0).abs() < 1e-9);
        (0..59_900).for_each(|_| wheel.step(0.0, 0.001));
        assert!(wheel.rpm > 0.0 && !wheel.can_cut(), "it still turns");
        (0..200).for_each(|_| wheel.step(0.0, 0.001));
        assert!(wheel.rpm <= 0.0);
    }
}
