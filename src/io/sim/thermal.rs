//! Thermal growth: a machine that starts cold moves its wheel towards the part by some micrometres in the first hour, a
//! gauge shows too much (A7). First order: ẋ = (growth − x)/τ, from zero at power-on.

use serde::{Deserialize, Serialize};

use super::file_error::{SimFileError, require_not_negative, require_positive_fields as positive};

/// Thermal growth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThermalFile {
    /// How far the wheel has come towards the part, or what a gauge shows too much, once everything is warm, µm.
    pub growth_um: f64,
    /// Time constant, s.
    pub time_constant_s: f64,
}

impl ThermalFile {
    pub(super) fn check(&self, name: &str) -> Result<(), SimFileError> {
        require_not_negative(&format!("{name}.growth_um"), self.growth_um.abs())?;
        positive!(name, self; time_constant_s)
    }

    /// Growth in a step of `dt_s` from `mm` on, mm.
    pub(super) fn step_mm(&self, mm: f64, dt_s: f64) -> f64 {
        mm - (self.growth_um / 1_000.0 - mm) * (-dt_s / self.time_constant_s).exp_m1()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p8_after_one_time_constant_63_percent_have_grown() {
        let file = ThermalFile { growth_um: 10.0, time_constant_s: 600.0 };
        let mm = (0..600_000).fold(0.0, |mm, _| file.step_mm(mm, 0.001));
        // 10 µm · (1 − 1/e)
        assert!((mm - 0.006_321).abs() < 1e-6, "{mm}");
    }
}
