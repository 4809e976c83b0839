//! Vibration of the wheel against the part (P5): its rim goes to and fro while it cuts, so that the part comes out a little
//! smaller and wavy.
//!
//! An unbalanced wheel pulls once in a turn, with its mass m and the eccentricity e of its centre of mass. Far below the
//! resonance the amplitude is the force over the stiffness:
//!
//!   a = m·e·ω²/k.
//!
//! Regenerative chatter of the wheel grows slowly as its rim wears, until it is dressed: with the dullness δ from 0 to 1
//!
//!   a = a_0·e^(g·δ).
//!
//! DECISION: each turn renews the waviness; turns do not even out the waves of each other.
//! Sources: ISO 21940-11 (unbalance); I. Inasaki, B. Karpuschewski, H.-S. Lee, Grinding chatter – origin and suppression, CIRP
//! Annals 50/2 (2001) 515.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::file_error::{SimFileError, require_not_negative, require_positive_fields as positive};

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
        require_not_negative("vibration.chatter_growth", self.chatter_growth)
    }

    /// Amplitude of the unbalance, µm.
    fn unbalance_um(&self, wheel: TurningWheel) -> f64 {
        let rad_s = TAU * wheel.turns_s;
        wheel.mass_kg * self.eccentricity_um * 1e-6 * rad_s * rad_s / self.stiffness_n_um
    }

    /// Amplitude of chatter, µm.
    fn chatter_um(&self, dullness: f64) -> f64 {
        self.chatter_um * (self.chatter_growth * dullness).exp()
    }
}

/// What of the wheel decides how it vibrates.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurningWheel {
    pub turns_s: f64,
    pub mass_kg: f64,
    /// 0 sharp to 1 dull.
    pub dullness: f64,
}

/// The vibration of the wheel at a moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vibration {
    /// Amplitude, µm.
    pub(super) amplitude_um: f64,
    /// How far the rim is towards the part, mm.
    pub(super) towards_mm: f64,
}

impl Vibration {
    /// At a time; `chatters` while the wheel cuts.
    pub(super) fn at(file: &VibrationFile, seconds: f64, wheel: TurningWheel, chatters: bool) -> Self {
        let chatter = if chatters { file.chatter_um(wheel.dullness) } else { 0.0 };
        let once = file.unbalance_um(wheel);
        let wave = |hz: f64| (TAU * (hz * seconds).fract()).sin();
        let towards_um = once * wave(wheel.turns_s) + chatter * wave(file.natural_hz);
        Self { amplitude_um: once + chatter, towards_mm: towards_um / 1_000.0 }
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
        natural_hz: 120.0,
    };

    /// A wheel of Ø600 by 20 mm at this speed, rpm.
    fn wheel(rpm: f64, dullness: f64) -> TurningWheel {
        TurningWheel { turns_s: rpm / 60.0, mass_kg: 12.44, dullness }
    }

    /// ω = 2π·1100/60 = 115.19 rad/s; 12.44 kg·0.16 mm·13269 = 26.41 N over 50 N/µm: 0.528 µm; at half the speed a quarter.
    #[test]
    fn p5_an_unbalanced_wheel_shakes_with_the_square_of_its_speed() {
        let whole = FILE.unbalance_um(wheel(1_100.0, 0.0));
        assert!((whole - 0.528_2).abs() < 0.000_1, "{whole}");
        assert!((FILE.unbalance_um(wheel(550.0, 0.0)) * 4.0 - whole).abs() < 1e-12);
    }

    /// 0.05·e² = 0.369 at half its life, 0.05·e⁴ = 2.730 at its end.
    #[test]
    fn p5_chatter_grows_until_the_wheel_is_dressed() {
        for (dullness, um) in [(0.0, 0.05), (0.5, 0.369_5), (1.0, 2.729_9)] {
            assert!((FILE.chatter_um(dullness) - um).abs() < 0.000_1, "{dullness}");
        }
        assert!(
            (Vibration::at(&FILE, 0.0, wheel(0.0, 1.0), false).amplitude_um).abs() < 1e-12,
            "a wheel that stands is quiet"
        );
    }

    #[test]
    fn p5_a_vibrating_rim_stays_within_its_amplitude() {
        let at = |tick: u32| Vibration::at(&FILE, f64::from(tick) * 0.001, wheel(1_100.0, 1.0), true);
        let far = (0..5_000).map(|tick| 1_000.0 * at(tick).towards_mm.abs()).fold(0.0, f64::max);
        let amplitude = at(0).amplitude_um;
        assert!(far <= amplitude && far > 0.98 * amplitude, "{far} {amplitude}");
    }
}
