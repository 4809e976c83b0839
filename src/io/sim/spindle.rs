//! Wheel drive and workhead: a speed that climbs and falls at a steady rate (P2).

use super::machine_file::{WheelFile, WorkheadFile};

/// Below this an analog output carries no speed, V: the motor then runs at its fixed speed.
const NO_VOLTS: f64 = 0.05;
/// Full scale of an analog output, V.
const FULL_VOLTS: f64 = 10.0;

/// A motor with its run-up and coast-down.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spindle {
    rpm: f64,
    /// Last speed asked for that was not zero.
    asked_rpm: f64,
    rise_rpm_s: f64,
    fall_rpm_s: f64,
}

impl Spindle {
    /// The wheel: run-up under power, coast-down without.
    pub(super) fn wheel(file: &WheelFile) -> Self {
        Self {
            rpm: 0.0,
            asked_rpm: file.mains_rpm,
            rise_rpm_s: file.mains_rpm / file.run_up_s,
            fall_rpm_s: file.mains_rpm / file.coast_down_s,
        }
    }

    /// The workhead: braked as fast as it starts.
    pub(super) fn workhead(file: &WorkheadFile) -> Self {
        let rate = file.high_rpm / file.run_up_s;
        Self { rpm: 0.0, asked_rpm: file.high_rpm, rise_rpm_s: rate, fall_rpm_s: rate }
    }

    /// Moves the speed towards `target_rpm`; zero is off.
    pub(super) fn step(&mut self, target_rpm: f64, dt_s: f64) {
        if target_rpm > 0.0 {
            self.asked_rpm = target_rpm;
        }
        self.rpm = if self.rpm < target_rpm {
            (self.rpm + self.rise_rpm_s * dt_s).min(target_rpm)
        } else {
            (self.rpm - self.fall_rpm_s * dt_s).max(target_rpm)
        };
    }

    /// Speed now, rpm.
    pub(super) const fn rpm(&self) -> f64 {
        self.rpm
    }

    /// Fast enough to cut: at least half of the speed last asked for.
    pub(super) fn cuts(&self) -> bool {
        self.rpm >= 0.5 * self.asked_rpm
    }
}

/// Speed asked of the wheel. DECISION: switched on without a voltage it runs at mains speed, as a wheel motor on its
/// contactor does; a program that never says S still grinds.
pub(super) fn wheel_target(file: &WheelFile, on: bool, volts: f64) -> f64 {
    match (on, volts > NO_VOLTS) {
        (false, _) => 0.0,
        (true, false) => file.mains_rpm,
        (true, true) => file.rpm_at_10_v * volts.min(FULL_VOLTS) / FULL_VOLTS,
    }
}

/// Speed asked of the workhead; high wins over low, a voltage over both fixed speeds.
pub(super) fn workhead_target(file: &WorkheadFile, high: bool, low: bool, volts: f64) -> f64 {
    match (high || low, volts > NO_VOLTS) {
        (false, _) => 0.0,
        (true, true) => (file.greatest_rpm * volts / FULL_VOLTS).clamp(file.least_rpm, file.greatest_rpm),
        (true, false) if high => file.high_rpm,
        (true, false) => file.low_rpm,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;
    use crate::io::sim::MachineFile;

    #[test]
    fn p2_the_wheel_runs_up_in_eight_seconds_and_coasts_for_sixty() {
        let file = MachineFile::builtin(Kind::Gc).unwrap().wheel;
        let mut wheel = Spindle::wheel(&file);
        for _ in 0..7_900 {
            wheel.step(1_000.0, 0.001);
        }
        assert!(wheel.rpm() < 1_000.0 && wheel.cuts());
        for _ in 0..200 {
            wheel.step(1_000.0, 0.001);
        }
        assert!((wheel.rpm() - 1_000.0).abs() < 1e-9);
        for _ in 0..59_900 {
            wheel.step(0.0, 0.001);
        }
        assert!(wheel.rpm() > 0.0 && !wheel.cuts(), "it still turns");
        for _ in 0..200 {
            wheel.step(0.0, 0.001);
        }
        assert!(wheel.rpm() <= 0.0);
    }

    #[test]
    fn p2_a_voltage_sets_the_speed_and_none_is_the_mains() {
        let file = MachineFile::builtin(Kind::Gc).unwrap();
        assert!((wheel_target(&file.wheel, true, 5.0) - 630.0).abs() < 1e-9);
        assert!((wheel_target(&file.wheel, true, 0.0) - 1_000.0).abs() < 1e-9);
        assert!(wheel_target(&file.wheel, false, 5.0) <= 0.0);
        assert!((workhead_target(&file.workhead, false, true, 0.5) - 30.0).abs() < 1e-9, "15 rpm is below its least");
        assert!((workhead_target(&file.workhead, true, false, 0.0) - 200.0).abs() < 1e-9);
    }
}
