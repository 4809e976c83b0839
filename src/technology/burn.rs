//! When a steel burns: above a specific energy that falls with the depth of cut.
//!
//! With the depth of cut a of one turn (or stroke) of the part, its speed v_w, and the equivalent diameter
//! d_e = d_s·d_w/(d_s + d_w) of wheel and part, the limit is
//!
//!   u* = u_0 + B·d_e^(1/4)·a^(−3/4)·v_w^(−1/2).
//!
//! A wheel of the specific energy u burns the part from the removal rate Q'w = a·v_w on, with a from u = u*:
//!
//!   Q'w = (B·d_e^(1/4)/(u − u_0))^(4/3) · v_w^(1/3).
//!
//! Source: S. Malkin, R. B. Lenz, CIRP Annals 27 (1978) 233.

/// u_0, J/mm³: below it nothing burns.
const BURN_ENERGY_J_MM3: f64 = 6.2;
/// B, for J/mm³, mm and mm/s.
const BURN_FACTOR: f64 = 7.2;

/// Removal rate per width from which a wheel of the specific energy `energy_j_mm3` burns a steel, mm³/(mm·s); infinite
/// where it never does.
#[must_use]
pub fn burn_limit_mm2_s(energy_j_mm3: f64, equivalent_mm: f64, work_mm_s: f64) -> f64 {
    let above = energy_j_mm3 - BURN_ENERGY_J_MM3;
    if above <= 0.0 {
        return f64::INFINITY;
    }
    (BURN_FACTOR * equivalent_mm.powf(0.25) / above).powf(4.0 / 3.0) * work_mm_s.cbrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: d_e = 600·40/640 = 37.5 mm, d_e^(1/4) = 2.47461; v_w = π·40·200/60 = 418.88 mm/s.
    /// a = (7.2·2.47461/(20.4665·38.8))^(4/3) = 0.0063282 mm; Q'w = 2.6508.
    #[test]
    fn p5_the_burn_limit_is_that_of_malkin_and_lenz() {
        let limit = burn_limit_mm2_s(45.0, 37.5, 418.88);
        assert!((limit - 2.650_8).abs() < 0.001, "{limit}");
        // Twice the energy above u_0: 2^(-4/3); an eighth of the speed: a half.
        assert!((burn_limit_mm2_s(83.8, 37.5, 418.88) / limit - 0.396_85).abs() < 1e-5);
        assert!((burn_limit_mm2_s(45.0, 37.5, 418.88 / 8.0) / limit - 0.5).abs() < 1e-9);
        assert!(burn_limit_mm2_s(6.0, 37.5, 418.88).is_infinite());
    }
}
