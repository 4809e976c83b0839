//! One axis of the simulated machine: drive, leadscrew, slide and switches (P1).
//!
//! Motion law: the motor follows the set-point u as a critically damped second-order system,
//! x'' = ω²·(u − x) − 2ω·x'. Its servo lag at constant speed is 2/ω (20 ms at ω = 100 rad/s). The exact solution over
//! a tick with constant u is, with e = x − u and E = exp(−ω·dt),
//! e ← E·((1 + ω·dt)·e + dt·v), v ← E·((1 − ω·dt)·v − ω²·dt·e).
//! If it exceeds the drive's acceleration or jerk limit, the limited acceleration is integrated instead.
//! The slide follows the motor with backlash, plus the pitch error at its position (B7).

use super::contact::BouncingContact;
use super::machine_sections::{AxisFile, TablePoint};
use super::scatter::SlideScatter;
use crate::io::random::SplitMix64;

/// Backlash of a worn leadscrew at the minus stop, mm.
const WORN_PLAY_MM: f64 = 0.05;

/// The command to an axis in this tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisCommand {
    /// Set-point in the encoder's frame, mm.
    pub set_point_mm: f64,
    /// The drive is on; otherwise the brake stops and holds the axis.
    pub on: bool,
    /// The drive is on but the axis does not follow (fault `following-x`).
    pub following_lost: bool,
}

/// Logical states of the switches of an axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AxisSwitches {
    pub home: bool,
    pub limit_plus: bool,
    pub limit_minus: bool,
}

/// An axis has hit a hard stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct StopHit {
    /// The plus stop; otherwise the minus stop.
    pub plus: bool,
    /// Speed at the stop, mm/s, unsigned.
    pub speed_mm_s: f64,
}

/// Drive, leadscrew and slide.
#[derive(Clone, Debug)]
pub(super) struct SimAxis {
    file: AxisFile,
    /// Motor position, machine coordinates, mm.
    motor_mm: f64,
    /// Speed of the slide, mm/s.
    pub(super) velocity_mm_s: f64,
    accel_mm_s2: f64,
    /// The leadscrew is worn: its backlash grows towards the minus end (fault `worn-screw-x`).
    pub(super) screw_worn: bool,
    /// Slide position before pitch error and scatter, mm.
    nominal_slide_mm: f64,
    /// Actual slide position, machine coordinates, mm.
    pub(super) slide_mm: f64,
    /// Machine position at which the encoder reads zero, mm.
    pub(super) encoder_zero_mm: f64,
    /// Last set-point of the drive, mm; the encoder counts from it.
    last_set_point_mm: f64,
    coefficients: Coefficients,
    home: BouncingContact,
    limit_plus: BouncingContact,
    limit_minus: BouncingContact,
    /// Random deviation of the slide.
    pub(super) scatter: Option<SlideScatter>,
    /// How far heat has moved the slide towards minus, mm.
    pub(super) thermal_mm: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Coefficients {
    dt_s: f64,
    e_from_e: f64,
    e_from_v: f64,
    v_from_e: f64,
    v_from_v: f64,
}

impl Coefficients {
    fn new(omega: f64, dt_s: f64) -> Self {
        let decay = (-omega * dt_s).exp();
        Self {
            dt_s,
            e_from_e: decay * (1.0 + omega * dt_s),
            e_from_v: decay * dt_s,
            v_from_e: -decay * omega * omega * dt_s,
            v_from_v: decay * (1.0 - omega * dt_s),
        }
    }
}

impl SimAxis {
    /// An axis at rest at its power-on position, encoder at zero.
    pub(super) fn new(file: AxisFile) -> Self {
        let start = file.power_on_mm;
        let mut axis = Self {
            file,
            motor_mm: start,
            velocity_mm_s: 0.0,
            accel_mm_s2: 0.0,
            screw_worn: false,
            nominal_slide_mm: start,
            slide_mm: start,
            encoder_zero_mm: start,
            last_set_point_mm: 0.0,
            coefficients: Coefficients::default(),
            home: BouncingContact::default(),
            limit_plus: BouncingContact::default(),
            limit_minus: BouncingContact::default(),
            scatter: None,
            thermal_mm: 0.0,
        };
        axis.reset_at(start);
        axis
    }

    /// Puts the axis at rest at a machine position and zeroes its encoder there, unless that is absolute.
    pub(super) fn reset_at(&mut self, machine_mm: f64) {
        self.motor_mm = machine_mm;
        self.nominal_slide_mm = machine_mm;
        self.encoder_zero_mm = if self.file.absolute { 0.0 } else { machine_mm };
        self.last_set_point_mm = machine_mm - self.encoder_zero_mm;
        self.velocity_mm_s = 0.0;
        self.accel_mm_s2 = 0.0;
        self.slide_mm = machine_mm + interpolate(&self.file.pitch_error_mm, machine_mm);
        self.home = BouncingContact::at_rest(self.at_home());
        self.limit_plus = BouncingContact::at_rest(self.slide_mm >= self.file.limit_plus_mm);
        self.limit_minus = BouncingContact::at_rest(self.slide_mm <= self.file.limit_minus_mm);
    }

    pub(super) const fn is_absolute(&self) -> bool {
        self.file.absolute
    }

    /// Encoder reading, mm. DECISION: it counts in steps of the resolution from the last set-point (as interpolating
    /// drives do), so that an axis in position reads its set-point exactly.
    pub(super) fn encoder_mm(&self) -> f64 {
        let off = self.motor_mm - self.encoder_zero_mm - self.last_set_point_mm;
        self.last_set_point_mm + (off / self.file.resolution_mm).round() * self.file.resolution_mm
    }

    /// Moves the axis for one tick; returns the hit if it runs onto a hard stop.
    pub(super) fn step(&mut self, drive: AxisCommand, dt_s: f64) -> Option<StopHit> {
        // The drive ignores a set-point that is not finite; the control's own assertions find the cause.
        if drive.on && drive.set_point_mm.is_finite() {
            self.last_set_point_mm = drive.set_point_mm;
        }
        if drive.on && !drive.following_lost {
            self.follow(dt_s)
        } else {
            self.brake(dt_s)
        }
        self.move_slide()
    }

    fn follow(&mut self, dt_s: f64) {
        if dt_s.total_cmp(&self.coefficients.dt_s).is_ne() {
            self.coefficients = Coefficients::new(self.file.following_rad_s, dt_s);
        }
        let c = self.coefficients;
        let target = self.encoder_zero_mm + self.last_set_point_mm;
        let error = self.motor_mm - target;
        let wanted_v = c.v_from_e * error + c.v_from_v * self.velocity_mm_s;
        let wanted_a = (wanted_v - self.velocity_mm_s) / dt_s;
        let swing = self.file.jerk_mm_s3 * dt_s;
        let limit = self.file.accel_mm_s2;
        let least = (self.accel_mm_s2 - swing).max(-limit);
        let most = (self.accel_mm_s2 + swing).min(limit);
        if wanted_a >= least && wanted_a <= most {
            self.motor_mm = target + c.e_from_e * error + c.e_from_v * self.velocity_mm_s;
            self.velocity_mm_s = wanted_v;
            self.accel_mm_s2 = wanted_a;
        } else {
            // `least` exceeds `limit` only after braking; the final min keeps the order.
            let accel = wanted_a.max(least).min(most);
            self.motor_mm += (self.velocity_mm_s + 0.5 * accel * dt_s) * dt_s;
            self.velocity_mm_s += accel * dt_s;
            self.accel_mm_s2 = accel;
        }
    }

    fn brake(&mut self, dt_s: f64) {
        self.accel_mm_s2 = 0.0;
        let speed = self.velocity_mm_s.abs();
        if speed <= 0.0 {
            return;
        }
        let drop = self.file.brake_mm_s2 * dt_s;
        if drop >= speed {
            self.motor_mm += self.velocity_mm_s * speed / (2.0 * self.file.brake_mm_s2);
            self.velocity_mm_s = 0.0;
        } else {
            let left = self.velocity_mm_s * (1.0 - drop / speed);
            self.motor_mm += 0.5 * (self.velocity_mm_s + left) * dt_s;
            self.velocity_mm_s = left;
        }
    }

    /// Moves the slide with the motor, as far as the hard stops.
    fn move_slide(&mut self) -> Option<StopHit> {
        // Towards plus the screw pushes at once; towards minus it first takes up the backlash.
        let play = interpolate(&self.file.backlash_mm, self.motor_mm) + self.worn_play_mm();
        self.nominal_slide_mm = self.nominal_slide_mm.max(self.motor_mm).min(self.motor_mm + play);
        let off_mm = self.scatter.as_mut().map_or(0.0, |scatter| scatter.deviation_mm(self.nominal_slide_mm));
        let pitch_mm = interpolate(&self.file.pitch_error_mm, self.nominal_slide_mm);
        self.slide_mm = self.nominal_slide_mm + pitch_mm + off_mm - self.thermal_mm;
        let plus = self.slide_mm > self.file.stop_plus_mm;
        if !plus && self.slide_mm >= self.file.stop_minus_mm {
            return None;
        }
        let stop = if plus { self.file.stop_plus_mm } else { self.file.stop_minus_mm };
        self.motor_mm += stop - self.slide_mm;
        self.nominal_slide_mm += stop - self.slide_mm;
        self.slide_mm = stop;
        let speed_mm_s = self.velocity_mm_s.abs();
        self.velocity_mm_s = 0.0;
        self.accel_mm_s2 = 0.0;
        Some(StopHit { plus, speed_mm_s })
    }

    /// Extra backlash of a worn leadscrew, mm: none at the plus stop, `WORN_PLAY_MM` at the minus stop.
    fn worn_play_mm(&self) -> f64 {
        let AxisFile { stop_plus_mm, stop_minus_mm, .. } = self.file;
        if self.screw_worn {
            WORN_PLAY_MM * (stop_plus_mm - self.motor_mm) / (stop_plus_mm - stop_minus_mm)
        } else {
            0.0
        }
    }

    fn at_home(&self) -> bool {
        let beyond_mm = self.slide_mm - self.file.home_edge_mm;
        let on_mm = if self.file.home_at_plus { beyond_mm } else { -beyond_mm };
        on_mm >= 0.0 && self.file.home_width_mm.is_none_or(|width_mm| on_mm <= width_mm)
    }

    /// The switches after this tick, with contact bounce.
    pub(super) fn switches(&mut self, dt_s: f64, bounce_s: f64, chance: &mut SplitMix64) -> AxisSwitches {
        let (home, slide) = (self.at_home(), self.slide_mm);
        AxisSwitches {
            home: self.home.step(home, dt_s, bounce_s, chance),
            limit_plus: self.limit_plus.step(slide >= self.file.limit_plus_mm, dt_s, bounce_s, chance),
            limit_minus: self.limit_minus.step(slide <= self.file.limit_minus_mm, dt_s, bounce_s, chance),
        }
    }
}

/// Interpolates a table over position; constant beyond its ends, zero if empty.
fn interpolate(table: &[TablePoint], position_mm: f64) -> f64 {
    let (Some(first), Some(last)) = (table.first(), table.last()) else { return 0.0 };
    if position_mm <= first.0 {
        return first.1;
    }
    let after = table.partition_point(|row| row.0 < position_mm);
    let Some(b) = table.get(after) else { return last.1 };
    let a = table[after - 1];
    a.1 + (b.1 - a.1) * (position_mm - a.0) / (b.0 - a.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;
    use crate::io::sim::MachineFile;

    const DT: f64 = 0.001;

    #[test]
    fn p1_a_step_of_the_set_point_keeps_the_drives_limits_and_settles() {
        for set_point_mm in [0.01, 1.0, 20.0, -100.0] {
            let mut x = SimAxis::new(MachineFile::builtin(Kind::Gc).unwrap().x);
            let (mut v, mut a) = (0.0, 0.0);
            for _ in 0..3_000 {
                x.step(AxisCommand { set_point_mm, on: true, following_lost: false }, DT);
                let accel = (x.velocity_mm_s - v) / DT;
                assert!(accel.abs() <= 3_000.0 + 1e-6 && (accel - a).abs() <= 400_000.0 * DT + 1e-6);
                (v, a) = (x.velocity_mm_s, accel);
            }
            let off_mm = x.motor_mm - x.encoder_zero_mm - set_point_mm;
            assert!(off_mm.abs() < 0.001, "{set_point_mm}: {off_mm}");
        }
    }
}
