//! Vibration of the wheel against the part (P5): its rim goes to and fro while it cuts, so that the part comes out a little
//! smaller and wavy.
//!
//! An unbalanced wheel pulls once in a turn, with its mass m and the eccentricity e of its centre of mass. The wheel head, with
//! its stiffness k, natural frequency f_n and damping ratio ζ, answers at r = f/f_n with the amplitude
//!
//!   a = m·e·ω²/k / √((1 − r²)² + (2ζr)²).
//!
//! Regenerative chatter of the wheel grows slowly as its rim wears, until it is dressed: with the dullness δ from 0 to 1
//!
//!   a = a_0·e^(g·δ).
//!
//! DECISION: it grows so with dullness; each turn renews the waviness, turns do not even out the waves of each other; the mass is
//! that of a new disc of corundum without a bore.
//! Sources: ISO 21940-11 (unbalance); I. Inasaki, B. Karpuschewski, H.-S. Lee, Grinding chatter – origin and suppression, CIRP
//! Annals 50/2 (2001) 515.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::file_error::{SimFileError, refuse_value, require_not_negative, require_positive_fields as positive};

/// Greatest natural frequency, Hz: the steps of the simulation are up to 4 ms long.
const NATURAL_LIMIT_HZ: f64 = 100.0;
/// Greatest amplitude of chatter with a dull wheel, µm.
const CHATTER_LIMIT_UM: f64 = 100.0;
/// Greatest eccentricity, µm: no wheel is mounted worse.
const ECCENTRICITY_LIMIT_UM: f64 = 1_000.0;
/// ζ. DECISION: a machine tool without dampers.
const DAMPING_RATIO: f64 = 0.05;

/// How the wheel vibrates; without it it runs true.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VibrationFile {
    /// Eccentricity of the wheel's centre of mass, µm.
    pub eccentricity_um: f64,
    /// Stiffness between wheel and part, N/µm.
    pub stiffness_n_um: f64,
    /// Amplitude of chatter with a sharp wheel, µm.
    pub chatter_um: f64,
    /// By how many powers of e it grows until the wheel is dull.
    pub chatter_growth: f64,
    /// Natural frequency of the wheel head, Hz.
    pub natural_hz: f64,
}

impl VibrationFile {
    pub(super) fn check(&self) -> Result<(), SimFileError> {
        positive!("vibration", self; stiffness_n_um natural_hz)?;
        require_not_negative("vibration.eccentricity_um", self.eccentricity_um)?;
        require_not_negative("vibration.chatter_um", self.chatter_um)?;
        require_not_negative("vibration.chatter_growth", self.chatter_growth)?;
        if self.natural_hz > NATURAL_LIMIT_HZ {
            return refuse_value("vibration.natural_hz", self.natural_hz, "must not exceed 100 Hz");
        }
        if self.eccentricity_um > ECCENTRICITY_LIMIT_UM {
            return refuse_value("vibration.eccentricity_um", self.eccentricity_um, "must not exceed 1000 µm");
        }
        match self.chatter_um(1.0) {
            um if um <= CHATTER_LIMIT_UM => Ok(()),
            um => refuse_value("vibration: chatter with a dull wheel", um, "must not exceed 100 µm"),
        }
    }

    /// Amplitude of the unbalance, µm.
    fn unbalance_um(&self, wheel: TurningWheel) -> f64 {
        let rad_s = TAU * wheel.turns_s;
        let r = wheel.turns_s / self.natural_hz;
        let answer = (1.0 - r * r).hypot(2.0 * DAMPING_RATIO * r).recip();
        wheel.mass_kg * self.eccentricity_um * 1e-6 * rad_s * rad_s / self.stiffness_n_um * answer
    }

    /// Amplitude of chatter, µm.
    fn chatter_um(&self, dullness: f64) -> f64 {
        self.chatter_um * (self.chatter_growth * dullness).exp()
    }
}

/// The properties of the wheel that decide how it vibrates.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurningWheel {
    pub turns_s: f64,
    pub mass_kg: f64,
    /// 0 sharp to 1 dull.
    pub dullness: f64,
}

/// The vibration of the wheel, step by step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vibration {
    /// Amplitude, µm.
    pub(super) amplitude_um: f64,
    /// How far the rim is towards the part, mm.
    pub(super) towards_mm: f64,
    /// Turns of the wheel and waves of chatter since the last whole one.
    turn: f64,
    wave: f64,
}

impl Vibration {
    /// One step; `chatters` while the wheel cuts.
    pub(super) fn step(&mut self, file: &VibrationFile, wheel: TurningWheel, chatters: bool, dt_s: f64) {
        self.turn = (self.turn + wheel.turns_s * dt_s).fract();
        self.wave = (self.wave + file.natural_hz * dt_s).fract();
        let chatter = if chatters { file.chatter_um(wheel.dullness) } else { 0.0 };
        let once = file.unbalance_um(wheel);
        let towards_um = once * (TAU * self.turn).sin() + chatter * (TAU * self.wave).sin();
        (self.amplitude_um, self.towards_mm) = (once + chatter, towards_um / 1_000.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: VibrationFile = VibrationFile {
        eccentricity_um: 160.0,
        stiffness_n_um: 50.0,
        chatter_um: 0.05,
        chatter_growth: 4.0,
        natural_hz: 100.0,
    };

    /// A wheel of Ø600 by 20 mm at this speed, rpm.
    fn wheel(rpm: f64, dullness: f64) -> TurningWheel {
        TurningWheel { turns_s: rpm / 60.0, mass_kg: 12.44, dullness }
    }

    /// ω = 2π·1100/60 = 115.19 rad/s; 12.44 kg·0.16 mm·13269 = 26.41 N over 50 N/µm: 0.528 µm; r = 0.18333 makes it 1.0347 times
    /// as much, 0.5465. At half the speed a quarter of 0.528 by 1.0085: 0.1332. At 300 turns/s, far above the resonance, the 35 g of a
    /// small wheel: 0.0354·0.16·3.553·10⁶/50 = 0.402 by 1/8.006: 0.050.
    #[test]
    fn p5_an_unbalanced_wheel_shakes_with_the_square_of_its_speed_up_to_the_resonance() {
        let small = TurningWheel { turns_s: 300.0, mass_kg: 0.035_4, dullness: 0.0 };
        for (wheel, um) in [(wheel(1_100.0, 0.0), 0.546_5), (wheel(550.0, 0.0), 0.133_2), (small, 0.050_3)] {
            let found = FILE.unbalance_um(wheel);
            assert!((found - um).abs() < 0.000_2, "{found} {um}");
        }
    }

    /// 0.05·e² = 0.369 at half its life, 0.05·e⁴ = 2.730 at its end.
    #[test]
    fn p5_chatter_grows_until_the_wheel_is_dressed() {
        for (dullness, um) in [(0.0, 0.05), (0.5, 0.369_5), (1.0, 2.729_9)] {
            assert!((FILE.chatter_um(dullness) - um).abs() < 0.000_1, "{dullness}");
        }
        let mut vibration = Vibration::default();
        vibration.step(&FILE, wheel(0.0, 1.0), false, 0.001);
        assert!(vibration.amplitude_um.abs() < 1e-12, "a wheel that stands is quiet");
    }

    /// With steps of 1 ms and of 4 ms.
    #[test]
    fn p5_a_vibrating_rim_goes_to_its_amplitude_and_no_farther() {
        for dt_s in [0.001, 0.004] {
            let mut vibration = Vibration::default();
            let far = (0..20_000).fold(0.0_f64, |far, _| {
                vibration.step(&FILE, wheel(1_100.0, 1.0), true, dt_s);
                far.max(1_000.0 * vibration.towards_mm.abs())
            });
            assert!(far <= vibration.amplitude_um && far > 0.95 * vibration.amplitude_um, "{far} at {dt_s}");
        }
    }

    #[test]
    fn p8_a_vibration_that_no_machine_has_is_refused() {
        for wrong in [
            VibrationFile { natural_hz: 101.0, ..FILE },
            VibrationFile { natural_hz: 0.0, ..FILE },
            VibrationFile { stiffness_n_um: 0.0, ..FILE },
            VibrationFile { eccentricity_um: 1_001.0, ..FILE },
            VibrationFile { chatter_um: -0.1, ..FILE },
            VibrationFile { chatter_growth: 7.7, ..FILE }, // 0.05·e^7.7 = 110 µm
            VibrationFile { chatter_growth: f64::NAN, ..FILE },
        ] {
            assert!(wrong.check().is_err(), "{wrong:?}");
        }
        assert!(FILE.check().is_ok());
    }
}
